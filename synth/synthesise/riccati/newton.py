"""Newton's method on a balanced Riccati equation in double precision, the residual evaluated to twice that.

    X <- X + Y,   the residual F(X) plus Y's linear (Lyapunov or Stein) terms under Ac = A - B L equal to zero

The step needs few digits, the residual many: X ends within rounding of the solution unless the linear equation is
singular within rounding (iterative refinement). After a small step D the residual follows from the last one, exactly,

    continuous  F(X + D) = F(X) + Ac'D + D Ac - M' R^-1 M,      M = B'D,      L(X + D) = L(X) + R^-1 M
    discrete    F(X + D) = F(X) + Ac'D Ac - D - M' S^-1 M,      M = B'D Ac,   L(X + D) = L(X) + S^-1 M,  S at X + D

and these sums, of the size of D, need no more than double precision.
"""

from dataclasses import dataclass, replace

import numpy as np

from synth.statespace import Array, Complex
from synth.synthesise.riccati import doubling
from synth.synthesise.riccati.doubling import Bilinear, Decay
from synth.synthesise.riccati.equation import Equation, Solution, sizes

ROUNDED = 2.0**-52  # of sqrt(X_ii X_jj), times n: an error that only makes up for the rounding of X
FINE = 1e-10  # likewise: an error that is enough where the linear equation is rigid
RIGID = 1e13  # condition above which the linear equation is solved to a few digits, and steps gain no more
STALLED = 1e-6  # likewise: errors below it should shrink each time
KEPT = 1e-8  # likewise: after an error this small the linear equation of the last step does
SMALL = 1e-10  # likewise: from an error this small the residual may follow
STEPS = 60  # from a loop that is stable but far from the best, each step halves what is too much
CANCELLED = 1e-9  # of its terms: a row of L below it is judged by this, as 1e-15 of the terms is rounding error
LOOSER = 1e-2  # how much closer X is to be known than what its error adds to L, of which L is rid in the end


@dataclass(frozen=True, eq=False)
class Certified:
    """A solution of a balanced equation with what `riccati.Riccati` tells of it.

    `error` is the forward error, or what it adds to L, as far as that counts; `poles` (n,) are those of its loop.
    """

    solution: Solution
    residual: float
    forward_error: float
    condition: float
    error: float
    poles: Complex


@np.errstate(all="ignore")
def refined(equation: Equation, X: Array, bilinear: Bilinear) -> Certified | None:
    """Return the solution that Newton's method reaches from X (n, n).

    Returns None when a loop on the way does not decay, or R or S is not positive definite in double precision. How near
    it came is told by its `error`.
    """
    X = (X + X.T) / 2  # the residual is that of a symmetric X
    last, decay, best, T, condition = np.inf, None, None, None, np.inf
    try:
        defect, L = equation.residual(X)
        for _ in range(STEPS):
            closed = equation.A - equation.B @ L
            decay = decay if decay and last < KEPT else doubling.decay(closed, bilinear)
            if decay is None:
                return None
            now = _Iterate.of(equation, Solution(X, L, closed, defect, decay.gathered(defect)))
            if not np.isfinite(now.error):
                return None
            if T is None and now.error < STALLED:
                T = equation.terms(X)
                condition = _condition(T, now.size, decay)
            stalled = T is not None and now.error > last / 2
            best = now if best is None or not stalled else best
            if T is not None and (stalled or now.is_fine(condition)):
                return best.certified(equation, T, condition)
            X, last = X + now.solution.step, now.error
            follows = now.error < SMALL and now.error * condition < 1
            defect, L = now.followed(equation, X) if follows else equation.residual(X)
    except np.linalg.LinAlgError:
        return None
    return None


@dataclass(frozen=True, eq=False)
class _Iterate:
    """A solution on the way, with what its step adds to L, its sizes, its forward error and its error."""

    solution: Solution
    added: Array
    size: Array
    forward_error: float
    error: float

    @staticmethod
    def of(equation: Equation, found: Solution) -> "_Iterate":
        size = sizes(found.X)
        step = found.step if equation.continuous else found.step @ found.closed
        added = np.linalg.solve(equation.weight(found.X), equation.B.T @ step)
        more, L = (np.abs(v / size).max(axis=1) for v in (added, found.L))
        forward = float((np.abs(found.step) / size / size[:, None]).max())
        if not (LOOSER * more <= FINE * L).all():
            L = np.maximum(L, CANCELLED * (equation.gain_terms(found.X) / size).max(axis=1))
        error = max(forward, LOOSER * float((more / np.where(L > 0, L, 1.0)).max()))
        return _Iterate(found, np.asarray(added), size, forward, error)

    def is_fine(self, condition: float) -> bool:
        """Tell whether the error is that of rounding, or small where another step would hardly lessen it."""
        return self.error <= (FINE if condition > RIGID else ROUNDED * len(self.size))

    def followed(self, equation: Equation, X: Array) -> tuple[Array, Array]:
        """Return residual and L at an X (n, n) near this one."""
        D, Ac = X - self.solution.X, self.solution.closed
        DAc = D @ Ac
        M = equation.B.T @ (D if equation.continuous else DAc)
        added = np.linalg.solve(equation.weight(X), M)
        linear = DAc + DAc.T if equation.continuous else Ac.T @ DAc - D
        defect = self.solution.defect + linear - M.T @ added
        return (defect + defect.T) / 2, self.solution.L + added

    def certified(self, equation: Equation, T: Array, condition: float) -> Certified:
        """Return the solution with L for X + step, which resolves more of X than X's own rounding leaves."""
        L = self.solution.L + self.added
        found = replace(self.solution, L=L, closed=equation.A - equation.B @ L)
        return Certified(found, _beside(found.defect, T), self.forward_error, condition, self.error, found.poles())


@np.errstate(all="ignore")
def certified(equation: Equation, found: Solution, bilinear: Bilinear) -> Certified:
    """Return the certificate of a solution of any origin; its condition is infinite where its loop does not decay."""
    T, decay = equation.terms(found.X), doubling.decay(found.closed, bilinear)
    now = _Iterate.of(equation, found)
    condition = np.inf if decay is None else _condition(T, now.size, decay)
    return Certified(found, _beside(found.defect, T), now.forward_error, condition, now.error, found.poles())


def _beside(defect: Array, T: Array) -> float:
    """Return the largest |d_ij| over the greater of T_ij and sqrt(T_ii T_jj).

    T_ii has a floor: the terms of a state that costs nothing are the rounding error of a zero, and measure no defect.
    """
    root = sizes(T)
    return float((np.abs(defect) / np.maximum(T, root * root[:, None])).max())


def _condition(T: Array, size: Array, decay: Decay) -> float:
    """Return what relative changes of the terms, |dT_ij| <= T_ij, do to X_ij over s_i s_j at most; sizes s.

    They make dT <= diag(s_i sum_j T_ij / s_j), and the linear equation of Newton's step keeps that order.
    """
    changed = decay.gathered(np.diag(size * (T / size).sum(axis=1)))
    return float((changed.diagonal() / (size * size)).max())


@np.errstate(all="ignore")
def evaluated(equation: Equation, L: Array, bilinear: Bilinear) -> Array | None:
    """Return the cost X (n, n) of the feedback u = -L x; None when its loop does not decay.

    From there Newton's method falls to the solution without fail (Kleinman 1968, Hewer 1971).
    """
    decay = doubling.decay(equation.A - equation.B @ L, bilinear)
    NL = equation.N @ L
    return None if decay is None else decay.gathered(equation.Q + L.T @ equation.R @ L - NL - NL.T)
