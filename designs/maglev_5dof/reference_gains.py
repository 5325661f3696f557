"""Constants of the maglev controller's loops in 60 digits: regulator, internal model, filter.

plant    e'' = w;   xi' = Phi xi + N e + E (u limited - u),   Phi with the eigenvalues 0, +-i w0           F(13)-(15)
gain     w = K (e, e', xi) that minimises the integral of z' Q z + w^2                                           F(16)
sample   xi = T eta with the next values sum+ = sum + e and, a rotation, p+ = p + c q, q+ = q - p+ + e     F(17)
"""

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import pi

import mpmath  # type: ignore[import-untyped]
import numpy as np
from numpy.typing import NDArray

from synth.reference import gains

Array = NDArray[np.float64]

PERIOD = Fraction(1, 1000)  # s
FILTER = 1000  # rad/s, w of the derivative filter s w^2/(s + w)^2, F section III
OMEGA0 = 1.5 * pi  # rad/s, F section IV-B
MODES = (0.0, OMEGA0)
ANTI_WINDUP = 7e-5  # each entry of E_x = E_z, F section IV-A


def gain(weights: Sequence[float]) -> Array:
    """Return K (5,) of w = K (e, e', xi) that minimises the integral of z' diag(weights) z + w^2. F(16)."""
    with mpmath.workdps(60):
        m = gains.product(MODES)
        n = (m, np.polymul([1, 0], m), [1], [1, 0], [1, 0, 0])  # of e, e', xi1, xi2, xi3 over xi1
        K = gains.symmetric_root_locus(MODES, [(mpmath.mpf(q), of) for q, of in zip(weights, n, strict=True)])
        return np.array([float(v) for v in K])


@dataclass(frozen=True)
class InternalModel:
    """One sample of the internal model in eta = (sum, p, q), T of xi = T eta, and the anti-windup input E of eta."""

    c: mpmath.mpf
    T: mpmath.matrix
    E: mpmath.matrix


def internal_model() -> InternalModel:
    """Return the internal model of one period in eta; its anti-windup is added to p before q follows. F(14)-(17)."""
    with mpmath.workdps(60):
        T, a = gains.to_leapfrog(MODES, PERIOD), mpmath.mpf(ANTI_WINDUP)
        _, held = gains.zero_order_hold(gains.companion(MODES), mpmath.matrix([a, a, a]), PERIOD)
        E = mpmath.lu_solve(T, held)
        E[2] += E[1]
        return InternalModel(gains.leapfrog(MODES, PERIOD)[0][1, 2], T, E)


def on_eta(weights: Sequence[float]) -> Array:
    """Return K (5,) on (e, e', eta)."""
    return gains.on_leapfrog(gain(weights), MODES, PERIOD)


def derivative_filter() -> tuple[float, float, float]:
    """Return fade, rho, h of the filter. F section III."""
    return gains.derivative_filter(FILTER, PERIOD)
