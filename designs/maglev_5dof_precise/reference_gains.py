"""Constants of the precise controller in high precision: gains on errors and internal models.

plant    e'' = w;   m(d/dt) xi1 = e, xi_k+1 = xi_k',   m(s) = s (s^2 + w0^2) (s^2 + 4 w0^2) (s^2 + 9 w0^2)
gain     w = K (e, e', xi) that minimises the integral of q_e e^2 + q_v e'^2 + w^2 and of q_e (1, 2) v_i^2 |z_i|^2,
         where e drives the mode z_i: z' = e for the integrator, z' = j w_i z + e for the others
sample   sum+ = sum + e;  p+ = p + c q, q+ = q - p+ + e for each other mode;   xi = T (sum, p1, q1, ..)
"""

from collections.abc import Sequence
from math import pi
from typing import Any

import mpmath  # type: ignore[import-untyped]
import numpy as np
from numpy.typing import NDArray

from synth.reference import gains

Array = NDArray[np.float64]

PERIOD, OMEGA0 = 1e-3, 1.5 * pi  # s, rad/s
MODES = (0.0, OMEGA0, 2 * OMEGA0, 3 * OMEGA0)


def costs(modes: Sequence[float], weights: Sequence[float], speeds: Sequence[float]) -> list[tuple[Any, Any]]:
    """Return the weights with their polynomials over xi1: of e, of e', and of the states of each mode."""
    s, m = [mpmath.mpf(1), mpmath.mpf(0)], gains.product(modes)
    terms = [(mpmath.mpf(weights[0]), m), (mpmath.mpf(weights[1]), np.polymul(s, m))]
    for w, speed in zip(modes, speeds, strict=True):
        others = gains.product([o for o in modes if o != w])
        weight = (2 if w else 1) * mpmath.mpf(speed) ** 2 * weights[0]
        terms += [(weight, np.polymul(s, others) if w else others), (weight * mpmath.mpf(w) ** 2, others)]
    return terms


def on_eta(weights: Sequence[float], speeds: Sequence[float]) -> Array:
    """Return K on (e, e', eta)."""
    modes = MODES[: len(speeds)]
    with mpmath.workdps(gains.DIGITS):
        K = gains.symmetric_root_locus(modes, costs(modes, weights, speeds))
        return gains.on_leapfrog(np.array([float(v) for v in K]), modes, PERIOD)


def coordinates() -> Array:
    """Return c = 2 - 2 cos(w T) of the modes other than the integrator."""
    with mpmath.workdps(gains.DIGITS):
        A, _ = gains.leapfrog(MODES, PERIOD)
        return np.array([float(A[i, i + 1]) for i in range(1, A.rows, 2)])
