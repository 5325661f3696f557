"""The continuous and the discrete algebraic Riccati equation: scaling, the sizes of its terms, and a solution.

continuous  A'X + XA - P R^-1 P' + Q = 0,         P = XB + N,                     L = R^-1 P'
discrete    A'XA - X - P S^-1 P' + Q = 0,         P = A'XB + N, S = R + B'XB,     L = S^-1 P'
"""

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
