"""Riccati equations in ball arithmetic: X and L correct to the last bit of double, alike on every machine.

Newton's method (Kleinman 1968, Hewer 1971) from any start near the stabilising solution,

    continuous  Ac'X + X Ac + Q - N L - L'N' + L'R L = 0,     discrete  Ac'X Ac - X + Q - N L - L'N' + L'R L = 0

with Ac = A - B L, L that of the last X. Each step solves n^2 equations at once: for states of a dozen or fewer. More
bits are taken until the ball of the last step's solution tells each entry to far below half an ulp.
"""

from dataclasses import dataclass

import flint
import numpy as np

from synth.analyse import precise
from synth.errors import ModelError
from synth.statespace import Array
from synth.synthesise.equation import Equation, Solution

Mat = flint.arb_mat

BITS = (precise.BITS, 4 * precise.BITS, 16 * precise.BITS)
STEPS = 30


@dataclass(frozen=True, eq=False)
class _Problem:
    A: Mat
    B: Mat
    Q: Mat
    R: Mat
    N: Mat
    continuous: bool

    def feedback(self, X: Mat) -> Mat:
        """Return L for X."""
        if self.continuous:
            return precise.middle(self.R.solve(self.B.transpose() * X + self.N.transpose()))
        S = self.R + self.B.transpose() * X * self.B
        return precise.middle(S.solve(self.B.transpose() * X * self.A + self.N.transpose()))

    def residual(self, X: Mat) -> Mat:
        """Return the equation's left side at X."""
        if self.continuous:
            cross = X * self.B + self.N
            gain = self.R.solve(cross.transpose())
            return self.A.transpose() * X + X * self.A - cross * gain + self.Q
        cross = self.A.transpose() * X * self.B + self.N
        gain = (self.R + self.B.transpose() * X * self.B).solve(cross.transpose())
        return self.A.transpose() * X * self.A - X - cross * gain + self.Q

    def newton(self, X: Mat) -> Mat:
        """Return the next iterate as balls: the cost of the feedback L(X), from a linear (Lyapunov, Stein) equation.

        Raises ZeroDivisionError when its closed loop has poles s + s' = 0 (s s' = 1 in discrete time) to these bits.
        """
        L = self.feedback(X)
        closed = (self.A - self.B * L).transpose()
        cost = self.Q + L.transpose() * self.R * L - self.N * L - (self.N * L).transpose()
        n = closed.nrows()
        one = precise.identity(n)
        if self.continuous:
            operator = precise.kronecker(closed, one) + precise.kronecker(one, closed)
        else:
            operator = precise.kronecker(closed, closed) - precise.identity(n * n)
        right = flint.arb_mat([[-v] for v in cost.entries()])
        Y = flint.arb_mat(n, n, operator.solve(right).entries())
        return (Y + Y.transpose()) * flint.arb(0.5)


def solve(equation: Equation, start: Array) -> Solution:
    """Return the solution near `start` (n, n), which must be close enough for Newton's method to reach it.

    Raises ModelError when it does not.
    """
    for bits in BITS:
        with precise.precision(bits):
            problem = _problem(equation)
            X = _limit(problem, precise.matrix(start))
            if X is not None:
                return _found(problem, X)
    raise ModelError(
        f"Newton's method on the Riccati equation does not settle within {BITS[-1]} bits, or a step has no solution: "
        "start nearer to the stabilising solution, scale the weights or the states, or leave out modes that hardly move"
    )


def certify(equation: Equation, X: Array) -> Solution:
    """Return a symmetric X (n, n) of any origin with its L, residual and Newton step.

    Raises ModelError when its L leaves the closed loop singular.
    """
    with precise.precision():
        try:
            return _found(_problem(equation), precise.matrix(X))
        except ZeroDivisionError as error:
            raise ModelError(
                "the Newton step from this X has no solution: its closed loop has poles s + s' = 0 (s s' = 1 in "
                "discrete time)"
            ) from error


def _problem(e: Equation) -> _Problem:
    A, B, Q, R, N = (precise.matrix(v) for v in (e.A, e.B, e.Q, e.R, e.N))
    return _Problem(A, B, Q, R, N, e.continuous)


def _limit(problem: _Problem, X: Mat) -> Mat | None:
    """Return Newton's limit, None when it is not told by these bits; steps square the error: the last leaves 1e-70."""
    for _ in range(STEPS):
        try:
            balls = problem.newton(X)
        except ZeroDivisionError:
            return None
        previous, X = X, precise.middle(balls)
        if precise.norm(X - previous) <= 1e-40 * precise.norm(X):
            return X if _tells(balls) else None
    return None


def _tells(balls: Mat) -> bool:
    """Tell whether each entry is known to far below half an ulp, or is far below the largest."""
    least = precise.ZERO * precise.norm(balls)
    return all(v.rel_accuracy_bits() >= 64 or abs(v) < least for v in balls.entries())


def _found(problem: _Problem, X: Mat) -> Solution:
    """Return X and the L that belongs to it, each rounded once; the rest is that of the rounded X."""
    L = problem.feedback(X)
    shipped = precise.rounded(X)
    ball = precise.matrix(shipped)
    closed = precise.rounded(problem.A - problem.B * L)
    defect, step = _bounds(problem.residual(ball)), _bounds(problem.newton(ball) - ball)
    return Solution(shipped, precise.rounded(L), closed, defect, step)


def _bounds(balls: Mat) -> Array:
    """Return an upper bound of each entry's absolute value."""
    found = np.array([float(abs(v).upper()) for v in balls.entries()]).reshape(balls.nrows(), balls.ncols())
    return np.where(np.isnan(found), np.inf, found)
