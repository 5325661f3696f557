"""Smith's doubling for Stein and Lyapunov equations in double precision, and the bilinear map of a Riccati equation.

    Y = A'Y A + W                   Y <- Y + A'Y A,  A <- A^2

Y increases to the solution (Smith 1968); each pass doubles the horizon, and the slowest pole determines the number of
passes. A bilinear map therefore first shifts the poles towards z = 0; Y is the same for the mapped equation:

    continuous  z = (c + s) / (c - s)        J = (c I - A)^-1,  A_d = (A + c I) J,  g = 2 c,      k = -1
    discrete    z <- (z + k) / (1 + k z)     J = (I + k A)^-1,  A_d = (A + k I) J,  g = 1 - k^2,  k = (c - 1) / (c + 1)

and W_d = g J'W J. c is close to the geometric mean of |s| over the poles of the optimal loop, or of |z - 1| / 2.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from synth.statespace import Array
from synth.synthesise.riccati.equation import Equation

PASSES = 60  # doublings: 2^60 periods; a recursion that has not converged by then diverges
DECAYED = 1e-2  # of a state: the remainder of Y is the square of this
FACTORS = (1.0, 2.0, 4.0)  # of the mean rate: the rates c that are tried
# Of c J, or of (1 + k) J: c is then far from the eigenvalues of A.
MAX_RMS_SINGULAR_VALUE = 10.0


@dataclass(frozen=True)
class Bilinear:
    """The bilinear map of rate c, in 1/s in continuous time, without unit in discrete time."""

    c: float
    continuous: bool

    @property
    def k(self) -> float:
        """The map's shift."""
        return -1.0 if self.continuous else (self.c - 1) / (self.c + 1)

    @property
    def g(self) -> float:
        """The map's gain."""
        return 2 * self.c if self.continuous else 4 * self.c / (1 + self.c) ** 2

    def resolvent(self, A: Array) -> Array | None:
        """Return J (n, n), None where A has an eigenvalue that is mapped to infinity."""
        one = np.eye(len(A))
        try:
            return np.asarray(np.linalg.inv(self.c * one - A if self.continuous else one + self.k * A))
        except np.linalg.LinAlgError:
            return None

    def map_matrix(self, A: Array, J: Array) -> Array:
        """Return A_d (n, n)."""
        return A @ J + (self.c if self.continuous else self.k) * J


@dataclass(frozen=True, eq=False)
class StableMap:
    """A stable A, as the powers A_d^1, A_d^2, A_d^4 .. (n, n) of its bilinear image, with J and g."""

    powers: Sequence[Array]
    J: Array
    g: float

    def gramian(self, W: Array) -> Array:
        """Return Y (n, n) for a symmetric W (n, n): A'Y + Y A + W = 0, or A'Y A - Y + W = 0."""
        Y = self.g * (self.J.T @ W @ self.J)
        for A in self.powers:
            Y = Y + A.T @ Y @ A
        return (Y + Y.T) / 2


@np.errstate(all="ignore")
def stable_map(A: Array, bilinear: Bilinear) -> StableMap | None:
    """Return A of dx/dt = A x, or x+ = A x, as a StableMap; None when it is not stable."""
    J = bilinear.resolvent(A)
    if J is None:
        return None
    powers = [bilinear.map_matrix(A, J)]
    for _ in range(PASSES):
        size = float(np.vdot(powers[-1], powers[-1]))
        if size < DECAYED * DECAYED:
            return StableMap(powers[:-1] or powers, J, bilinear.g)
        if not size < 1e300:
            break
        powers.append(powers[-1] @ powers[-1])
    return None


def bilinear_map(equation: Equation) -> Bilinear:
    """Return the bilinear map for the poles of the optimal loop, with a rate away from the eigenvalues of A."""
    c, tried = _mean_rate(equation), []
    for bilinear in (Bilinear(factor * c, equation.continuous) for factor in FACTORS):
        J = bilinear.resolvent(equation.A)
        unit = bilinear.c if equation.continuous else 1 + bilinear.k
        tried.append(np.inf if J is None else unit * float(np.linalg.norm(J)))
        if tried[-1] < MAX_RMS_SINGULAR_VALUE * np.sqrt(len(equation.A)):
            return bilinear
    return Bilinear(FACTORS[int(np.argmin(tried))] * c, equation.continuous)


def _mean_rate(e: Equation) -> float:
    """Return the geometric mean of |s|, or of |z - 1| / 2 but at most 1, from the determinant of the pencil."""
    try:
        (A, G, Q), one = _standard_form(e), np.eye(len(e.A))
    except np.linalg.LinAlgError:  # R is not positive definite, which only discrete time allows
        return 1.0
    if e.continuous:
        above = _mean_log_eigenvalue(A, -G, -Q, -A.T)
        with np.errstate(over="ignore"):
            size = max(float(np.linalg.norm(M)) for M in (A, G, Q))
        largest = np.log(size if np.isfinite(size) else max(float(np.abs(M).max()) for M in (A, G, Q)))
        return float(np.exp(above if above > largest - 30 else largest))
    above = _mean_log_eigenvalue(A - one, -G, -Q, one - A.T)
    return float(np.exp(min(max(above, -30.0), np.log(2.0)))) / 2


def _mean_log_eigenvalue(*quarters: Array) -> float:
    """Return the mean of log |eigenvalue| of a block matrix."""
    P, Q, R, S = quarters
    M = np.concatenate([np.concatenate([P, Q], axis=1), np.concatenate([R, S], axis=1)])
    return float(np.linalg.slogdet(M)[1]) / len(M)


def _standard_form(e: Equation) -> tuple[Array, Array, Array]:
    """Return A - B R^-1 N', B R^-1 B' and Q - N R^-1 N'."""
    whitened = _whiten(e.R, np.concatenate([e.B.T, e.N.T], axis=1))
    B, N = whitened[:, : len(e.A)], whitened[:, len(e.A) :]
    return e.A - B.T @ N, B.T @ B, e.Q - N.T @ N


def _whiten(R: Array, right: Array) -> Array:
    """Return F^-1 Y with R = F F' (Cholesky); raise LinAlgError when R is not positive definite."""
    return np.asarray(np.linalg.solve(np.linalg.cholesky(R), right), dtype=np.float64)
