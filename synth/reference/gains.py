"""Gains in high precision (mpmath), by other algorithms than the toolkit's: reference of `synthesise`.

    lqrd                 discrete Riccati equation by structure-preserving doubling, cost of a period by Van Loan
    symmetric_root_locus    continuous LQR of e'' = w with an internal model, by the stable factor of p(s) p(-s)
    leapfrog             sample of an internal model in the coordinates of the C: sum+ = sum + e for the frequency 0,
                         p+ = p + c q, q+ = q - p+ + e for each other one

A matrix is one of mpmath, computed in the caller's precision: `with mpmath.workdps(60)`.
"""

from collections.abc import Sequence
from fractions import Fraction
from math import exp
from typing import Any

import mpmath  # type: ignore[import-untyped]
import numpy as np

Matrix = Any  # of mpmath
Polynomial = Any  # coefficients of mpmath, highest power first
RELATIVE = mpmath.mpf(10) ** -40  # change of X at which the doubling ends: the next one is of the square of this
DIGITS = 160  # the controllability matrices of several slow modes are close to singular


def number(value: float | Fraction) -> Any:
    """Return a number in the working precision."""
    return mpmath.mpf(value.numerator) / value.denominator if isinstance(value, Fraction) else mpmath.mpf(value)


def diagonal(A: Matrix, B: Matrix) -> Matrix:
    """Return diag(A, B)."""
    M = mpmath.zeros(A.rows + B.rows, A.cols + B.cols)
    M[: A.rows, : A.cols], M[A.rows :, A.cols :] = A, B
    return M


def gramian(F: Matrix, W: Matrix, T: float | Fraction) -> tuple[Matrix, Matrix]:
    """Return exp(F T) and the integral over a period of exp(F' t) W exp(F t) (Van Loan 1978)."""
    n, size = F.rows, mpmath.mnorm(W)  # a large W asks for more terms
    Z = diagonal(-F.T, F)
    Z[:n, n:] = W / size
    E = mpmath.expm(Z * number(T), method="taylor")
    return E[n:, n:], E[n:, n:].T * E[:n, n:] * size


def riccati(A: Matrix, B: Matrix, Q: Matrix, R: Matrix, N: Matrix) -> tuple[Matrix, Matrix]:
    """Return X and K of A'XA - X - (A'XB + N) (R + B'XB)^-1 (B'XA + N') + Q = 0 by structured doubling."""
    inverse = mpmath.inverse(R)
    a, g, h = A - B * inverse * N.T, B * inverse * B.T, Q - N * inverse * N.T
    one = mpmath.eye(A.rows)
    step = h
    while mpmath.mnorm(step) > mpmath.mnorm(h) * RELATIVE:
        w = mpmath.inverse(one + g * h)
        step = a.T * h * w * a
        a, g, h = a * w * a, g + a * w * g * a.T, h + step
    return h, mpmath.inverse(R + B.T * h * B) * (B.T * h * A + N.T)


def lqrd(A: Matrix, B: Matrix, weights: Sequence[float], R: float, T: float | Fraction) -> tuple[Matrix, Matrix]:
    """Return X and K of u = -K x for the integral of x' diag(weights) x + R u^2, one input held over a period."""
    n = A.rows
    F = mpmath.zeros(n + 1)
    F[:n, :n], F[:n, n] = A, B
    E, W = gramian(F, mpmath.diag([*weights, R]), T)
    return riccati(E[:n, :n], E[:n, n], W[:n, :n], W[n:, n:], W[:n, n:])


def controllability(A: Matrix, B: Matrix) -> Matrix:
    """Return (B, A B, A^2 B, ...)."""
    M, column = mpmath.zeros(A.rows), B
    for j in range(A.rows):
        M[:, j] = column
        column = A * column
    return M


def mode(w: float) -> Polynomial:
    """Return the polynomial of a mode: s, or s^2 + w^2."""
    return [mpmath.mpf(1), mpmath.mpf(0), mpmath.mpf(w) ** 2] if w else [mpmath.mpf(1), mpmath.mpf(0)]


def product(modes: Sequence[float]) -> Polynomial:
    """Return the product of the polynomials of some modes."""
    m = np.array([mpmath.mpf(1)])
    for w in modes:
        m = np.polymul(m, mode(w))
    return m


def companion(modes: Sequence[float]) -> Matrix:
    """Return Phi with Phi xi_k = xi_k+1, whose poles are those of the modes."""
    p = list(product(modes))[::-1]
    n = len(p) - 1
    Phi = mpmath.zeros(n)
    for i in range(n):
        Phi[n - 1, i] = -p[i]
        if i:
            Phi[i - 1, i] = 1
    return Phi


def leapfrog(modes: Sequence[float], T: float | Fraction) -> tuple[Matrix, Matrix]:
    """Return one sample of eta as (A, B): sum, then p and q by rising frequency."""
    w = sorted(v for v in modes if v)
    n = 1 + 2 * len(w)
    A, B = mpmath.eye(n), mpmath.zeros(n, 1)
    B[0] = 1
    for k, v in enumerate(w):
        c, p = 4 * mpmath.sin(mpmath.mpf(v) * number(T) / 2) ** 2, 1 + 2 * k
        A[p, p + 1], A[p + 1, p], A[p + 1, p + 1], B[p + 1] = c, -1, 1 - c, 1
    return A, B


def zero_order_hold(A: Matrix, B: Matrix, T: float | Fraction) -> tuple[Matrix, Matrix]:
    """Return A and B of one sample with the inputs held."""
    n, m = A.rows, B.cols
    F = mpmath.zeros(n + m)
    F[:n, :n], F[:n, n:] = A, B
    E = mpmath.expm(F * number(T))
    return E[:n, :n], E[:n, n:]


def to_leapfrog(modes: Sequence[float], T: float | Fraction) -> Matrix:
    """Return R of xi = R eta, for xi' = Phi xi + N e with e held over a period."""
    Phi = companion(modes)
    N = mpmath.zeros(Phi.rows, 1)
    N[Phi.rows - 1] = 1
    return controllability(*zero_order_hold(Phi, N, T)) * mpmath.inverse(controllability(*leapfrog(modes, T)))


def _square(n: Polynomial) -> Polynomial:
    """Return n(s) n(-s) as a polynomial in s^2."""
    mirrored = [c * (-1) ** k for k, c in enumerate(reversed(list(n)))][::-1]
    return np.polymul(n, mirrored)[::-1][::2][::-1]


def symmetric_root_locus(modes: Sequence[float], costs: Sequence[tuple[Any, Polynomial]]) -> list[Any]:
    """Return K on (e, e', xi) of w = K (e, e', xi) for e'' = w with an internal model m(s) xi1 = e, xi_k+1 = xi_k'.

    It minimises the integral of w^2 and of the weights times squares of n(s) xi1, by `costs` of (weight, n). With
    d = s^2 m, the closed loop p is the stable factor of p(s) p(-s) = d(s) d(-s) + sum of weight n(s) n(-s).
    """
    m, s = product(modes), [mpmath.mpf(1), mpmath.mpf(0)]
    d = np.polymul(s, np.polymul(s, m))
    total = _square(d)
    for weight, n in costs:
        total = np.polyadd(total, weight * _square(n))
    p = np.array([mpmath.mpf(1)])
    for root in mpmath.polyroots(list(total / total[0]), maxsteps=2000, extraprec=2000):
        p = np.polymul(p, [1, mpmath.sqrt(root)])
    difference = [mpmath.re(c) for c in np.polysub(d, p)][1:]  # K_de s m + K_e m + K_xi (1, s, ..)
    on_rate = difference[0]
    remainder = np.polysub(difference, on_rate * np.polymul(s, m))[1:]
    on_error = remainder[0]
    return [on_error, on_rate, *np.polysub(remainder, on_error * m)[1:][::-1]]


def triple_pole(w: float, T: float) -> tuple[float, float, float]:
    """Return the gains on position, rate and disturbance of the observer of q'' = a + d with the pole exp(-w T)."""
    p = exp(-w * T)
    return 1 - p**3, 1.5 * (1 - p) ** 2 * (1 + p) / T, (1 - p) ** 3 / T**2


def on_leapfrog(K: Any, modes: Sequence[float], T: float | Fraction) -> Any:
    """Return K on (e, e', eta) in doubles from K on (e, e', xi) in doubles."""
    with mpmath.workdps(DIGITS):
        R = to_leapfrog(modes, T)
        on_eta = mpmath.matrix([[mpmath.mpf(float(k)) for k in K[2:]]]) * R
    return np.array([*K[:2], *(float(on_eta[0, j]) for j in range(R.rows))])


def derivative_filter(w: float, T: float | Fraction) -> tuple[float, float, float]:
    """Return fade, rho, h of s <- fade s + d, r <- fade r + s + rho s_before, v = h r, d = q - q_prev.

    This is v = s w^2/(s+w)^2 q, exact for q linear between samples (`blocks.derivative_filter`). A unit step of q gives
    v = w^2 t exp(-w t). A ramp of q from 0 to 1 over one period gives the mean of that response over the last period;
    its samples add up to 1/T.
    """
    with mpmath.workdps(DIGITS):
        wT = mpmath.mpf(w) * number(T)
        fade = mpmath.exp(-wT)
        hT = 1 - (1 + wT) * fade
        return float(fade), float((1 - fade) ** 2 / hT - 1), float(hT / number(T))
