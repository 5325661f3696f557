"""Newton's method on a balanced Riccati equation in double precision, with the residual in twice double precision.

    X <- X + Y,   the residual F(X) plus Y's linear (Lyapunov or Stein) terms under Ac = A - B L equal to zero

The step needs few digits, the residual many (iterative refinement). X converges to within rounding of the solution
unless the linear equation is singular within rounding. After a small step D the residual follows from the last one,

    continuous  F(X + D) = F(X) + Ac'D + D Ac - M' R^-1 M,      M = B'D,      L(X + D) = L(X) + R^-1 M
    discrete    F(X + D) = F(X) + Ac'D Ac - D - M' S^-1 M,      M = B'D Ac,   L(X + D) = L(X) + S^-1 M,  S at X + D

exactly. These sums are of the size of D and need only double precision.
"""

from dataclasses import dataclass, replace

import numpy as np

from synth.statespace import Array, Complex
from synth.synthesise.riccati import doubling
from synth.synthesise.riccati.doubling import Bilinear, StableMap
from synth.synthesise.riccati.equation import Equation, Solution, sizes

ROUNDING_ERROR = 2.0**-52  # of sqrt(X_ii X_jj), times n: an error of the size of the rounding of X
SUFFICIENT_ERROR = 1e-10  # likewise: a sufficient error where the linear equation is ill-conditioned
MAX_CONDITION = 1e13  # condition above which the linear equation has few correct digits and steps gain nothing
DECREASE_BELOW = 1e-6  # likewise: errors below it should decrease in each step
REUSED = 1e-8  # likewise: below this error the linear equation of the last step is used again
UPDATE_BELOW = 1e-10  # likewise: below this error the residual is updated, not evaluated
STEPS = 60  # far from the optimum each step only halves the excess of X
CANCELLED = 1e-9  # of its terms: the floor for a row of L, as 1e-15 of the terms is rounding error
GAIN_ERROR_WEIGHT = 1e-2  # weight of the error that X adds to L, which the final correction of L removes


@dataclass(frozen=True, eq=False)
class CertifiedSolution:
    """A solution of a balanced equation with the certificate that `riccati.Riccati` reports.

    `error` is the larger of the forward error and its weighted effect on L; `poles` (n,) are those of the loop.
    """

    solution: Solution
    residual: float
    forward_error: float
    condition: float
    error: float
    poles: Complex


@np.errstate(all="ignore")
def refine(equation: Equation, X: Array, bilinear: Bilinear) -> CertifiedSolution | None:
    """Return the solution to which Newton's method converges from X (n, n).

    Returns None when the loop of an iterate is not stable, or R or S is not positive definite in double precision. Its
    `error` states the accuracy.
    """
    X = (X + X.T) / 2  # the residual is that of a symmetric X
    last, decay, best, T, condition = np.inf, None, None, None, np.inf
    try:
        defect, L = equation.residual(X)
        for _ in range(STEPS):
            closed = equation.A - equation.B @ L
            decay = decay if decay and last < REUSED else doubling.stable_map(closed, bilinear)
            if decay is None:
                return None
            iterate = _Iterate.of(equation, Solution(X, L, closed, defect, decay.gramian(defect)))
            if not np.isfinite(iterate.error):
                return None
            if T is None and iterate.error < DECREASE_BELOW:
                T = equation.terms(X)
                condition = _condition(T, iterate.size, decay)
            stalled = T is not None and iterate.error > last / 2
            best = iterate if best is None or not stalled else best
            if T is not None and (stalled or iterate.is_fine(condition)):
                return best.certify(equation, T, condition)
            X, last = X + iterate.solution.step, iterate.error
            follows = iterate.error < UPDATE_BELOW and iterate.error * condition < 1
            defect, L = iterate.update_residual(equation, X) if follows else equation.residual(X)
    except np.linalg.LinAlgError:
        return None
    return None


@dataclass(frozen=True, eq=False)
class _Iterate:
    """An iterate, with the change `added` that its step makes to L, its sizes, its forward error and its error."""

    solution: Solution
    added: Array
    size: Array
    forward_error: float
    error: float

    @staticmethod
    def of(equation: Equation, solution: Solution) -> "_Iterate":
        size = sizes(solution.X)
        step = solution.step if equation.continuous else solution.step @ solution.closed
        added = np.linalg.solve(equation.weight(solution.X), equation.B.T @ step)
        added_L, L = (np.abs(v / size).max(axis=1) for v in (added, solution.L))
        forward = float((np.abs(solution.step) / size / size[:, None]).max())
        if not (GAIN_ERROR_WEIGHT * added_L <= SUFFICIENT_ERROR * L).all():
            L = np.maximum(L, CANCELLED * (equation.gain_terms(solution.X) / size).max(axis=1))
        error = max(forward, GAIN_ERROR_WEIGHT * float((added_L / np.where(L > 0, L, 1.0)).max()))
        return _Iterate(solution, np.asarray(added), size, forward, error)

    def is_fine(self, condition: float) -> bool:
        """Tell whether the error is within rounding, or small where another step would not reduce it much."""
        return self.error <= (SUFFICIENT_ERROR if condition > MAX_CONDITION else ROUNDING_ERROR * len(self.size))

    def update_residual(self, equation: Equation, X: Array) -> tuple[Array, Array]:
        """Return residual and L at an X (n, n) near this iterate."""
        D, Ac = X - self.solution.X, self.solution.closed
        DAc = D @ Ac
        M = equation.B.T @ (D if equation.continuous else DAc)
        added = np.linalg.solve(equation.weight(X), M)
        linear = DAc + DAc.T if equation.continuous else Ac.T @ DAc - D
        defect = self.solution.defect + linear - M.T @ added
        return (defect + defect.T) / 2, self.solution.L + added

    def certify(self, equation: Equation, T: Array, condition: float) -> CertifiedSolution:
        """Return the solution with L for X + step, which is more accurate than L for the rounded X."""
        L = self.solution.L + self.added
        solution = replace(self.solution, L=L, closed=equation.A - equation.B @ L)
        return CertifiedSolution(
            solution,
            _relative_residual(solution.defect, T),
            self.forward_error,
            condition,
            self.error,
            solution.poles(),
        )


@np.errstate(all="ignore")
def certify(equation: Equation, solution: Solution, bilinear: Bilinear) -> CertifiedSolution:
    """Return the certificate of any solution; its condition is infinite where its loop is not stable."""
    T, decay = equation.terms(solution.X), doubling.stable_map(solution.closed, bilinear)
    now = _Iterate.of(equation, solution)
    condition = np.inf if decay is None else _condition(T, now.size, decay)
    return CertifiedSolution(
        solution, _relative_residual(solution.defect, T), now.forward_error, condition, now.error, solution.poles()
    )


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
