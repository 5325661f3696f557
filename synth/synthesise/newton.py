"""Newton's method on a balanced Riccati equation in double precision, the residual evaluated to twice that.

    X <- X + Y,   the residual F(X) plus Y's linear (Lyapunov or Stein) terms under Ac = A - B L equal to zero

The step needs few digits, the residual many: X ends within rounding of the solution unless the linear equation is
singular within rounding (iterative refinement). After a small step D the residual follows from the last one, exactly,

    continuous  F(X + D) = F(X) + Ac'D + D Ac - M' R^-1 M,      M = B'D,      L(X + D) = L(X) + R^-1 M
    discrete    F(X + D) = F(X) + Ac'D Ac - D - M' S^-1 M,      M = B'D Ac,   L(X + D) = L(X) + S^-1 M,  S at X + D

and these sums, of the size of D, need no more than double precision.
"""

from dataclasses import replace

import numpy as np

from synth.statespace import Array
from synth.synthesise import doubling
from synth.synthesise.doubling import Bilinear, Decay
from synth.synthesise.equation import Equation, Solution, sizes

ROUNDED = 2.0**-52  # of sqrt(X_ii X_jj), times n: an error that only makes up for the rounding of X
STALLED = 1e-6  # likewise: errors below it should shrink each time
KEPT = 1e-3  # likewise: after an error this small the linear equation of the last step does
STEPS = 60  # from a loop that is stable but far from the best, each step halves what is too much


@np.errstate(all="ignore")
def refined(equation: Equation, X: Array, bilinear: Bilinear) -> Solution | None:
    """Return the solution that Newton's method reaches from X (n, n).

    Returns None when a loop on the way does not decay, or R or S is not positive definite in double precision. How near
    it came is told by its `step`.
    """
    X = (X + X.T) / 2  # the residual is that of a symmetric X
    last, decay, found, known = np.inf, None, None, np.inf
    try:
        defect, L = equation.residual(X)
        for _ in range(STEPS):
            closed = equation.A - equation.B @ L
            decay = decay if decay and last < KEPT else doubling.decay(closed, bilinear)
            if decay is None:
                return None
            now = Solution(X, L, closed, defect, decay.gathered(defect))
            error = now.error(equation)
            if not np.isfinite(error):
                return None
            stalled = error < STALLED and error > last / 2
            if found is None or not stalled:
                found = now
            if error <= ROUNDED * len(X) or stalled:
                return certified(equation, found.corrected(equation), decay)
            if error < STALLED and known == np.inf:
                known = _condition(equation.terms(X), X, decay)
            X, last = X + now.step, error
            defect, L = _followed(now, equation, X) if _follows(error, known) else equation.residual(X)
    except np.linalg.LinAlgError:
        return None
    return None


def _follows(error: float, condition: float) -> bool:
    """Tell whether rounding in `_followed` stays far below that of X: it is that of a double, times the step."""
    return error * condition < 1.0


def _followed(last: Solution, equation: Equation, X: Array) -> tuple[Array, Array]:
    """Return residual and L at an X (n, n) near the last."""
    D, Ac = X - last.X, last.closed
    DAc = D @ Ac
    M = equation.B.T @ (D if equation.continuous else DAc)
    added = np.linalg.solve(equation.weight(X), M)
    linear = DAc + DAc.T if equation.continuous else Ac.T @ DAc - D
    defect = last.defect + linear - M.T @ added
    return (defect + defect.T) / 2, last.L + added


def certified(equation: Equation, found: Solution, decay: Decay | None) -> Solution:
    """Return a solution with its residual and its condition, infinite where its loop has no decay.

    Both are told beside the sum T of the equation's absolute terms. Of the residual d the largest |d_ij| / t_ij counts,
    t_ij the greater of T_ij and sqrt(T_ii T_jj). Relative changes of the terms, |dT_ij| <= T_ij, make
    dT <= diag(T 1), and the linear equation of Newton's step keeps that order.
    """
    T = equation.terms(found.X)
    root = np.sqrt(np.diag(T))
    beside = np.maximum(T, root * root[:, None])
    residual = float(np.divide(np.abs(found.defect), beside, out=np.zeros_like(T), where=beside > 0).max())
    return replace(found, residual=residual, condition=np.inf if decay is None else _condition(T, found.X, decay))


def _condition(T: Array, X: Array, decay: Decay) -> float:
    return float((np.diag(decay.gathered(np.diag(T.sum(axis=1)))) / sizes(X) ** 2).max())


@np.errstate(all="ignore")
def evaluated(equation: Equation, L: Array, bilinear: Bilinear) -> Array | None:
    """Return the cost X (n, n) of the feedback u = -L x; None when its loop does not decay.

    From there Newton's method falls to the solution without fail (Kleinman 1968, Hewer 1971).
    """
    decay = doubling.decay(equation.A - equation.B @ L, bilinear)
    NL = equation.N @ L
    return None if decay is None else decay.gathered(equation.Q + L.T @ equation.R @ L - NL - NL.T)
