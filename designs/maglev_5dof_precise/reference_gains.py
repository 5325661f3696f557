"""Constants of the precise controller in high precision, without the toolkit: gains, internal models, observers.

plant    e'' = w;   m(d/dt) xi1 = e, xi_k+1 = xi_k',   m(s) = s (s^2 + w0^2) (s^2 + 4 w0^2) (s^2 + 9 w0^2)
gain     w = K (e, e', xi) that minimises the integral of q_e e^2 + q_v e'^2 + w^2 and of q_e (1, 2) v_i^2 |z_i|^2,
         where e drives the mode z_i: z' = e for the integrator, z' = j w_i z + e for the others
sample   sum+ = sum + e;  p+ = p + c q, q+ = q - p+ + e for each other mode;   xi = T (sum, p1, q1, ..)
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from math import exp, pi
from typing import Any

import mpmath  # type: ignore[import-untyped]
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

PERIOD, OMEGA0 = mpmath.mpf(1) / 1000, 1.5 * pi  # s, rad/s
MODES = (0.0, OMEGA0, 2 * OMEGA0, 3 * OMEGA0)
DIGITS = 160  # the controllability matrices of seven slow modes are close to singular


def factor(w: float) -> list[Any]:
    """Return the polynomial of a mode, highest power first."""
    return [mpmath.mpf(1), mpmath.mpf(0), mpmath.mpf(w) ** 2] if w else [mpmath.mpf(1), mpmath.mpf(0)]


def product(modes: Sequence[float]) -> Any:
    """Return the product of the polynomials of some modes."""
    m = np.array([mpmath.mpf(1)])
    for w in modes:
        m = np.polymul(m, factor(w))
    return m


def square(n: Any) -> Any:
    """Return n(s) n(-s) as a polynomial in s^2, highest power first."""
    mirrored = [c * (-1) ** k for k, c in enumerate(reversed(list(n)))][::-1]
    return np.polymul(n, mirrored)[::-1][::2][::-1]


def gain(weights: Sequence[float], speeds: Sequence[float]) -> tuple[Array, Any]:
    """Return K (2,) on (e, e') and K on xi; the closed loop is the stable factor of the symmetric root locus."""
    with mpmath.workdps(DIGITS):
        modes = MODES[: len(speeds)]
        m, (q_e, q_v) = product(modes), weights
        d = np.polymul([mpmath.mpf(1), 0, 0], m)
        total = np.polyadd(square(d), mpmath.mpf(q_e) * square(m))
        total = np.polyadd(total, mpmath.mpf(q_v) * square(np.polymul([mpmath.mpf(1), 0], m)))
        for w, speed in zip(modes, speeds, strict=True):
            others = product([o for o in modes if o != w])
            weight = (2 if w else 1) * mpmath.mpf(speed) ** 2 * q_e
            total = np.polyadd(total, weight * square(np.polymul([mpmath.mpf(1), 0], others) if w else others))
            total = np.polyadd(total, weight * mpmath.mpf(w) ** 2 * square(others))
        p = np.array([mpmath.mpf(1)])
        for root in mpmath.polyroots(list(total / total[0]), maxsteps=2000, extraprec=2000):
            p = np.polymul(p, [1, mpmath.sqrt(root)])
        difference = [mpmath.re(c) for c in np.polysub(d, p)][1:]  # K_de s m + K_e m + the rest, of degree 8
        k_de = difference[0]
        without = np.polysub(difference, k_de * np.polymul([mpmath.mpf(1), 0], m))[1:]
        k_e = without[0]
        on_xi = np.polysub(without, k_e * m)[1:][::-1]
        return np.array([float(k_e), float(k_de)]), on_xi


@cache
def coordinates(count: int) -> tuple[Array, Any]:
    """Return c = 2 - 2 cos(w T) of the first modes, and T with xi = T eta, for the error held over a period."""
    with mpmath.workdps(DIGITS):
        m, n = list(product(MODES[:count]))[::-1], 2 * count - 1
        rows = mpmath.zeros(n + 1)
        for i in range(n - 1):
            rows[i, i + 1] = 1
        for j in range(n):
            rows[n - 1, j] = -m[j]
        rows[n - 1, n] = 1
        step = mpmath.expm(rows * PERIOD)
        c = [2 - 2 * mpmath.cos(mpmath.mpf(w) * PERIOD) for w in MODES[1:count]]
        A, B = mpmath.eye(n), mpmath.matrix([1] + [0, 1] * (count - 1))
        for i, value in enumerate(c):
            p, q = 1 + 2 * i, 2 + 2 * i
            A[p, q], A[q, p], A[q, q] = value, -1, 1 - value
        T = _controllability(step[:n, :n], step[:n, n]) * mpmath.inverse(_controllability(A, B))
        return np.array([float(v) for v in c]), T


def _controllability(A: Any, B: Any) -> Any:
    columns = [B]
    for _ in range(len(A) - 1):
        columns.append(A * columns[-1])
    return mpmath.matrix([[column[i] for column in columns] for i in range(len(A))])


@dataclass(frozen=True)
class Observer:
    """Gains of an observer with the triple pole exp(-bandwidth T)."""

    alpha: float
    beta: float
    gamma: float


def on_eta(weights: Sequence[float], speeds: Sequence[float]) -> Array:
    """Return K on (e, e', eta)."""
    first, on_xi = gain(weights, speeds)
    _, T = coordinates(len(speeds))
    with mpmath.workdps(DIGITS):
        rounded = mpmath.matrix([[mpmath.mpf(float(v)) for v in on_xi]]) * T
        return np.array([*first, *(float(rounded[0, j]) for j in range(len(T)))])


def observer(bandwidth: float) -> Observer:
    """Return the gains for a bandwidth in rad/s."""
    T = float(PERIOD)
    p = exp(-bandwidth * T)
    return Observer(1 - p**3, 1.5 * (1 - p) ** 2 * (1 + p) / T, (1 - p) ** 3 / T**2)
