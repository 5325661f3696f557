"""Constants of the maglev controller's loops in 60 digits, without the toolkit: regulator, internal model, filter.

plant    e'' = w;   xi' = Phi xi + N e + E (u limited - u),   Phi with the eigenvalues 0, +-i w0           F(13)-(15)
gain     w = K (e, e', xi) that minimises the integral of z' Q z + w^2                                           F(16)
sample   xi = T eta with the next values sum+ = sum + e and, a rotation, p+ = p + c q, q+ = q - p+ + e     F(17)
"""

from collections.abc import Sequence
from dataclasses import dataclass
from math import pi

import mpmath  # type: ignore[import-untyped]
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

SAMPLES_PER_S = 1000
FILTER = 1000  # rad/s, w of the derivative filter s w^2/(s + w)^2, F section III
OMEGA0 = 1.5 * pi  # rad/s, F section IV-B
ANTI_WINDUP = 7e-5  # each entry of E_x = E_z, F section IV-A


def gain(weights: Sequence[float]) -> Array:
    """Return K (5,) of w = K (e, e', xi) that minimises the integral of z' diag(weights) z + w^2. F(16).

    The closed loop p(s) = d(s) - K n(s), d = s^3 (s^2 + w0^2), n = (s (s^2 + w0^2), s^2 (s^2 + w0^2), 1, s, s^2), is
    the stable factor of the symmetric root locus p(s) p(-s) = d(s) d(-s) + sum_i q_i n_i(s) n_i(-s).
    """
    with mpmath.workdps(60):
        # p(s) p(-s) is a polynomial in s^2. Its roots are the squares of the poles.
        q, w2 = [mpmath.mpf(weight) for weight in weights], mpmath.mpf(OMEGA0) ** 2
        in_s_squared = np.polyadd(np.polymul([-1, q[1], -q[0], 0], [1, 2 * w2, w2**2]), [q[4], -q[3], q[2]])
        squares = mpmath.polyroots(list(in_s_squared), maxsteps=500, extraprec=400)
        p = np.array([1])
        for square in squares:
            p = np.polymul(p, [1, mpmath.sqrt(square)])
        p4, p3, p2, p1, p0 = (mpmath.re(v) for v in p[1:])
        K = w2 - p3, -p4, -p0, w2 * (p3 - w2) - p1, w2 * p4 - p2
        return np.array([float(v) for v in K])


@dataclass(frozen=True)
class InternalModel:
    """One sample of the internal model in eta = (sum, p, q), T of xi = T eta, and the anti-windup input E of eta."""

    c: mpmath.mpf
    T: mpmath.matrix
    E: mpmath.matrix

    def in_eta(self, K: Array) -> Array:
        """Return K (5,) on (e, e', eta) from K on (e, e', xi)."""
        with mpmath.workdps(60):
            K_eta = mpmath.matrix([K[2:].tolist()]) * self.T
            return np.array([K[0], K[1], *(float(K_eta[0, j]) for j in range(3))])


def internal_model() -> InternalModel:
    """Return the internal model of one period in eta. F(14), (15), (17).

    Both forms are driven by e alone, hence (N, Phi N, Phi^2 N) = T (B, A B, A^2 B). The anti-windup is added to p
    before q is computed from p.
    """
    with mpmath.workdps(60):
        a, w2 = mpmath.mpf(ANTI_WINDUP), mpmath.mpf(OMEGA0) ** 2
        rows = [[0, 1, 0, 0, a], [0, 0, 1, 0, a], [0, -w2, 0, 1, a], [0] * 5, [0] * 5]  # of (xi, e, u limited - u)
        transition = mpmath.expm(mpmath.matrix(rows) / SAMPLES_PER_S)
        c = 3 - transition[0, 0] - transition[1, 1] - transition[2, 2]  # the trace of a rotation by w T is 2 cos(w T)
        A = mpmath.matrix([[1, 0, 0], [0, 1, c], [0, -1, 1 - c]])
        T = _controllability_matrix(transition[:3, :3], transition[:3, 3]) * mpmath.inverse(
            _controllability_matrix(A, mpmath.matrix([1, 0, 1]))
        )
        E = mpmath.lu_solve(T, transition[:3, 4])
        E[2] += E[1]
        return InternalModel(c, T, E)


def _controllability_matrix(A: mpmath.matrix, B: mpmath.matrix) -> mpmath.matrix:
    columns = [B, A * B, A * A * B]
    return mpmath.matrix([[column[i] for column in columns] for i in range(3)])


def derivative_filter() -> tuple[float, float, float]:
    """Return fade, rho, h of s <- fade s + d, r <- fade r + s + rho s_before, v = h r, d = q - q_prev. F section III.

    This is v = s w^2/(s+w)^2 q, exact for q linear between samples. A unit step of q gives v = w^2 t exp(-w t). A ramp
    of q from 0 to 1 over one period T gives the mean of that response over the last T; its samples add up to 1/T.
    """
    with mpmath.workdps(60):
        wT = mpmath.mpf(FILTER) / SAMPLES_PER_S
        fade = mpmath.exp(-wT)
        hT = 1 - (1 + wT) * fade
        return float(fade), float((1 - fade) ** 2 / hT - 1), float(hT * SAMPLES_PER_S)
