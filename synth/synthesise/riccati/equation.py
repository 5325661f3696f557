"""The continuous and the discrete algebraic Riccati equation: scaling, the sizes of its terms, and a solution.

continuous  A'X + XA - P R^-1 P' + Q = 0,         P = XB + N,                     L = R^-1 P'
discrete    A'XA - X - P S^-1 P' + Q = 0,         P = A'XB + N, S = R + B'XB,     L = S^-1 P'

Smith's doubling for Stein and Lyapunov equations in double precision, and the bilinear map of a Riccati equation.

    Y = A'Y A + W                   Y <- Y + A'Y A,  A <- A^2

Y increases to the solution (Smith 1968); each pass doubles the horizon, and the slowest pole determines the number of
passes. A bilinear map therefore first shifts the poles towards z = 0; Y is the same for the mapped equation:

    continuous  z = (c + s) / (c - s)        J = (c I - A)^-1,  A_d = (A + c I) J,  g = 2 c,      k = -1
    discrete    z <- (z + k) / (1 + k z)     J = (I + k A)^-1,  A_d = (A + k I) J,  g = 1 - k^2,  k = (c - 1) / (c + 1)

and W_d = g J'W J. c is close to the geometric mean of |s| over the poles of the optimal loop, or of |z - 1| / 2.

A Riccati equation in balanced coordinates x = D z, u = E v, with diagonal D (n, n), E (m, m) of powers of 2.

In these coordinates R has a unit diagonal and A, B R^-1 B' and Q are of similar size. What counts as rounding error
therefore does not depend on the units of the signals.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from synth.analyse import discretise
from synth.statespace import Array, Complex

MIN_COST = 2.0**-52  # of the largest diagonal entry of balanced X: below it the cost of a state is zero within rounding


@dataclass(frozen=True, eq=False)
class Equation:
    """A (n, n), B (n, m), Q (n, n), R (m, m), N (n, m)."""

    A: Array
    B: Array
    Q: Array
    R: Array
    N: Array
    continuous: bool

    def scaled(self, D: Array, E: Array) -> "Equation":
        """Return the equation for x = D z, u = E v, whose solution is D X D; diagonals (n,), (m,)."""
        row, column = D[:, None], E[:, None]
        A, B = self.A * D / row, self.B * E / row
        return Equation(A, B, self.Q * D * row, self.R * E * column, self.N * E * row, self.continuous)

    def scales(self) -> tuple[Array, Array]:
        """Return powers of 2, D (n,) and E (m,), that scale R's diagonal to 1 and balance A, B R^-1 B' and Q.

        For an input without weight, |R| + |B'QB| takes the place of R.
        """
        r = np.diag(self.R)
        if not self.continuous:
            r = np.where(r > 0, r, np.abs(r) + np.abs(np.diag(self.B.T @ self.Q @ self.B)))
        E = np.exp2(-np.round(np.log2(np.where(r > 0, r, 1.0)) / 2))
        n, B = len(self.A), np.abs(self.B * E)
        M = np.empty((2 * n, 2 * n))
        M[:n, :n], M[:n, n:], M[n:, :n], M[n:, n:] = self.A, B @ B.T, self.Q, self.A.T
        size = discretise.balancing(M)
        return np.exp2(np.round(np.log2(size[:n] / size[n:]) / 2)), E

    def weight(self, X: Array) -> Array:
        """Return R or S."""
        return self.R if self.continuous else self.R + self.B.T @ X @ self.B

    def terms(self, X: Array) -> Array:
        """Return the sum (n, n) of the absolute values of the equation's terms at X."""
        A, B, X, N = np.abs(self.A), np.abs(self.B), np.abs(X), np.abs(self.N)
        XA, BX = X @ A, B.T @ X
        linear, P = (XA + XA.T, BX + N.T) if self.continuous else (A.T @ XA + X, BX @ A + N.T)
        return np.asarray(linear + np.abs(self.Q) + P.T @ np.abs(np.linalg.inv(self.weight(X))) @ P)


@dataclass(frozen=True, eq=False)
class Solution:
    """X (n, n) and L (m, n) with the closed loop A - B L, the equation's residual `defect` at X and Newton's step.

    `exact_poles` (n,) are the poles of the loop from ball arithmetic, more exact than those of the rounded A - B L.
    """

    X: Array
    L: Array
    closed: Array
    defect: Array
    step: Array
    exact_poles: Complex | None = None

    def scaled(self, D: Array, E: Array) -> "Solution":
        """Return the solution of `Equation.scaled(D, E)` for this solution of the equation."""
        row = D[:, None]
        both = D * row
        L, closed = self.L * D / E[:, None], self.closed * D / row
        return Solution(self.X * both, L, closed, self.defect * both, self.step * both, self.exact_poles)

    def poles(self) -> Complex:
        """Return the closed loop's poles (n,)."""
        if self.exact_poles is not None:
            return self.exact_poles
        return np.sort_complex(np.linalg.eigvals(self.closed).astype(np.complex128))


def decays(poles: Complex, continuous: bool) -> bool:
    """Tell whether a loop with these poles is stable."""
    return bool((poles.real < 0).all() if continuous else (np.abs(poles) < 1).all())


def sizes(X: Array) -> Array:
    """Return sqrt(X_ii) (n,) of a balanced X, or of its equation's terms, with a floor for states without cost."""
    diagonal = np.abs(X.diagonal())
    return np.asarray(np.sqrt(np.maximum(diagonal, MIN_COST * float(diagonal.max()) or 1.0)))


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


@dataclass(frozen=True)
class Certificate:
    """What `riccati.Riccati` reports of a solution; the condition is infinite where its loop is not stable."""

    residual: float
    forward_error: float
    condition: float


@dataclass(frozen=True, eq=False)
class Balance:
    """The scaled equation, the scales D (n,), E (m,) of states and inputs, and the bilinear map for doubling."""

    scaled: Equation
    D: Array
    E: Array
    bilinear: Bilinear

    @staticmethod
    def of(equation: Equation) -> "Balance":
        D, E = equation.scales()
        scaled = equation.scaled(D, E)
        return Balance(scaled, D, E, bilinear_map(scaled))

    @np.errstate(all="ignore")
    def certify(self, solution: Solution) -> Certificate:
        """Return the certificate of any solution of the original equation."""
        solution = solution.scaled(self.D, self.E)
        T, decay = self.scaled.terms(solution.X), stable_map(solution.closed, self.bilinear)
        size = sizes(solution.X)
        condition = np.inf if decay is None else _condition(T, size, decay)
        forward_error = float((np.abs(solution.step) / size / size[:, None]).max())
        return Certificate(_relative_residual(solution.defect, T), forward_error, condition)

    def least_eigenvalue(self, X: Array, forward_error: float) -> float:
        """Return the least eigenvalue of balanced X over its states' sizes; 0 if the error of X exceeds it."""
        X = X * self.D * self.D[:, None]
        size = sizes(X)
        least = float(np.linalg.eigvalsh(X / size / size[:, None])[0])
        known = len(X) * max(forward_error, 2.0**-52)
        return 0.0 if np.isfinite(known) and abs(least) <= known else least


def _relative_residual(defect: Array, T: Array) -> float:
    """Return the largest |d_ij| over the greater of T_ij and sqrt(T_ii T_jj).

    T_ii has a floor, as the terms of a state without cost are rounding errors of zero.
    """
    root = sizes(T)
    return float((np.abs(defect) / np.maximum(T, root * root[:, None])).max())


def _condition(T: Array, size: Array, decay: StableMap) -> float:
    """Return the largest change of X_ij / (s_i s_j), sizes s, for relative changes |dT_ij| <= T_ij of the terms.

    They give dT <= diag(s_i sum_j T_ij / s_j), and the linear equation of Newton's step preserves that order.
    """
    changed = decay.gramian(np.diag(size * (T / size).sum(axis=1)))
    return float((changed.diagonal() / (size * size)).max())
