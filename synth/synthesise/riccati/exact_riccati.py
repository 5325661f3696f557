"""Riccati equations in ball arithmetic: X and L are correct to the last bit of double, the same on every machine.

Newton's method (Kleinman 1968, Hewer 1971) starts near the stabilising solution. Without such a start it begins at the
limit Y of doubling (module `doubling`) in high precision: X = X0 + Y, with A - B L(X0), R or S at X0 and the left side
at X0 in place of A, R, Q. From X0 = 0 the doubling converges to the least cost, which need not stabilise; from another
X0 it misses the stabilising solution only by coincidence. Each step solves

    continuous  Ac'X + X Ac + Q - N L - L'N' + L'R L = 0,     discrete  Ac'X Ac - X + Q - N L - L'N' + L'R L = 0

with Ac = A - B L and the L of the last X. These are n^2 equations at once, which suits up to a dozen states. The number
of bits is raised until the ball of the last step determines each entry to far below half an ulp. The poles are those
of A - B L before it is rounded.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace

import flint
import numpy as np

from synth.analyse import precise
from synth.errors import ModelError
from synth.statespace import Array, Complex
from synth.synthesise.riccati import exact_eigenvalues
from synth.synthesise.riccati.equation import Equation, Solution, decays

Mat = flint.arb_mat

BITS = (precise.BITS, 4 * precise.BITS, 16 * precise.BITS)
STEPS = 30
HALVED = 8  # steps in a row that only halve the error: a pole lies on the stability boundary
PASSES = 200  # doublings
CONVERGENCE_TOLERANCE = 1e-20  # of H: a smaller increment ends the doubling
CLEAR = 1e-15  # of a pole: a slower decay counts as none


@dataclass(frozen=True, eq=False)
class _Problem:
    A: Mat
    B: Mat
    Q: Mat
    R: Mat
    N: Mat
    continuous: bool

    def weight(self, X: Mat) -> Mat:
        """Return R or S."""
        return self.R if self.continuous else self.R + self.B.transpose() * X * self.B

    def feedback(self, X: Mat) -> Mat:
        """Return L for X."""
        XB = self.B.transpose() * X
        return precise.midpoints(self.weight(X).solve((XB if self.continuous else XB * self.A) + self.N.transpose()))

    def residual(self, X: Mat) -> Mat:
        """Return the equation's left side at X."""
        if self.continuous:
            cross = X * self.B + self.N
            gain = self.R.solve(cross.transpose())
            return self.A.transpose() * X + X * self.A - cross * gain + self.Q
        cross = self.A.transpose() * X * self.B + self.N
        gain = self.weight(X).solve(cross.transpose())
        return self.A.transpose() * X * self.A - X - cross * gain + self.Q

    def newton(self, X: Mat) -> Mat:
        """Return the next iterate as balls: the cost of the feedback L(X), from a linear (Lyapunov, Stein) equation.

        Raises ZeroDivisionError when the loop has poles s + s' = 0 (s s' = 1 in discrete time) in this precision.
        """
        return self.cost(self.feedback(X))

    def cost(self, L: Mat) -> Mat:
        """Return the cost of the feedback u = -L x as balls, where its loop is stable. Raises as `newton`."""
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


def solve(equation: Equation, start: Array | None = None) -> Solution:
    """Return the stabilising solution; a `start` (n, n) near it makes the doubling unnecessary.

    Raises ModelError when neither converges to it.
    """
    for bits in BITS:
        started = False
        with precise.precision(bits):
            problem = _problem(equation)
            for begin in _starts(problem, start):
                X, started = _newton_limit(problem, begin), True
                solution = None if X is None else _rounded_solution(problem, X)
                if X is not None and solution is not None and np.isfinite(solution.step).all():
                    return _with_rounding_distance(solution, X)
        if not started and bits > BITS[0]:  # more bits did not make the doubling converge: precision is not the cause
            break
    raise ModelError(
        f"Newton's method on the Riccati equation does not converge within {bits} bits, or a step has no solution, "
        "or its loop is not stable: scale the weights or the states, or leave out modes that are nearly uncontrollable"
    )


def certify(equation: Equation, X: Array) -> Solution:
    """Return a symmetric X (n, n) of any origin with its L, residual and Newton step.

    Raises ModelError when its L leaves the closed loop singular.
    """
    with precise.precision():
        try:
            return _rounded_solution(_problem(equation), precise.matrix(X))
        except ZeroDivisionError as error:
            raise ModelError(
                "the Newton step from this X has no solution: its closed loop has poles s + s' = 0 (s s' = 1 in "
                "discrete time)"
            ) from error


def _problem(e: Equation) -> _Problem:
    A, B, Q, R, N = (precise.matrix(v) for v in (e.A, e.B, e.Q, e.R, e.N))
    return _Problem(A, B, Q, R, N, e.continuous)


def _newton_limit(problem: _Problem, X: Mat) -> Mat | None:
    """Return the limit of Newton's method, None when this precision does not determine it.

    Each step squares the error; the last one leaves 1e-70.
    """
    last, slow_steps = np.inf, 0
    for _ in range(STEPS):
        try:
            balls = problem.newton(X)
        except ZeroDivisionError:
            return None
        previous, X = X, precise.midpoints(balls)
        change = precise.norm(X - previous)
        if change <= 1e-40 * precise.norm(X):
            return X if _is_resolved(balls) else None
        slow_steps, last = (slow_steps + 1 if change > last / 4 else 0), change
        if slow_steps > HALVED:
            return None
    return None


def _is_resolved(balls: Mat) -> bool:
    """Tell whether each entry is accurate to far below half an ulp, or is far smaller than the largest."""
    least = precise.ZERO * precise.norm(balls)
    return all(v.rel_accuracy_bits() >= 64 or abs(v) < least for v in balls.entries())


def _with_rounding_distance(solution: Solution, X: Mat) -> Solution:
    """Return the solution with its distance from X, which has far more bits, where Newton's step overestimates it.

    The step overestimates it where rounding X changes the loop, e.g. for X of size 1e17 and L a small difference.
    """
    distance = _bounds(precise.matrix(solution.X) - X)
    return replace(solution, step=np.where(solution.step > 2 * distance, distance, solution.step))


def _starts(problem: _Problem, start: Array | None) -> Iterator[Mat]:
    if start is not None:
        yield precise.matrix(start)
    one = precise.identity(problem.A.nrows())
    for size in (flint.arb(0), _cost_scale(problem)):
        limit = _doubling_limit(problem, one * size)
        if limit is not None:
            yield limit


def _cost_scale(p: _Problem) -> flint.arb:
    return flint.arb((precise.norm(p.Q) + precise.norm(p.R) / precise.norm(p.B) ** 2) if precise.norm(p.B) else 1.0)


def _doubling_limit(p: _Problem, X0: Mat) -> Mat | None:
    """Return the limit of doubling from X0, None where it diverges or its loop is not stable."""
    one = precise.identity(p.A.nrows())
    try:
        A, G, H = p.A - p.B * p.feedback(X0), p.B * p.weight(X0).solve(p.B.transpose()), p.residual(X0)
        A, G, H = (precise.midpoints(Y) for Y in (A, G, H))
        if p.continuous:
            A, G, H = _bilinear_transform(A, G, H)
        for _ in range(PASSES):
            inverse = precise.midpoints((one + G * H).inv())
            V, A_t = inverse * A, A.transpose()
            step = A_t * H * V
            G, H, A = (precise.midpoints(Y) for Y in (G + A * inverse * G * A_t, H + step, A * V))
            G, H = (G + G.transpose()) * flint.arb(0.5), (H + H.transpose()) * flint.arb(0.5)
            if not precise.norm(H) < 1e300:
                return None
            if precise.norm(step) <= CONVERGENCE_TOLERANCE * precise.norm(H):
                X = X0 + H
                poles = exact_eigenvalues.eigenvalues(precise.midpoints(p.A - p.B * p.feedback(X)))
                return X if _decays_clearly(poles, p.continuous) else None
    except ZeroDivisionError:
        return None
    return None


def _decays_clearly(poles: Complex, continuous: bool) -> bool:
    """Tell whether a loop is stable by more than the tolerance of the doubling."""
    if continuous:
        return bool((poles.real < -CLEAR * np.abs(poles)).all())
    return bool((np.abs(poles) < 1 - CLEAR).all())


def _bilinear_transform(A: Mat, G: Mat, H: Mat) -> tuple[Mat, Mat, Mat]:
    """Return the discrete equation with the same solution, by z = (c + s) / (c - s)."""
    c = flint.arb(max(map(precise.norm, (A, G, H))) * A.nrows() or 1.0)  # beyond the eigenvalues of A
    one = precise.identity(A.nrows())
    J = precise.midpoints((A - one * c).inv())
    W = precise.midpoints((A.transpose() - one * c + H * J * G).inv())
    return one + W.transpose() * (2 * c), J * G * W * (2 * c), W * H * J * (2 * c)


def _rounded_solution(problem: _Problem, X: Mat) -> Solution:
    """Return X and its gain L, each rounded once, with residual and Newton step of the rounded X.

    The step is infinite where the loop is not stable: X is then near another solution.
    """
    L = problem.feedback(X)
    rounded = precise.rounded(X)
    ball = precise.matrix(rounded)
    closed = problem.A - problem.B * L
    poles = exact_eigenvalues.eigenvalues(precise.midpoints(closed))
    defect, step = _bounds(problem.residual(ball)), _bounds(problem.newton(ball) - ball)
    step = step if decays(poles, problem.continuous) else np.full_like(step, np.inf)
    return Solution(rounded, precise.rounded(L), precise.rounded(closed), defect, step, poles)


def _bounds(balls: Mat) -> Array:
    """Return an upper bound of each entry's absolute value."""
    bounds = np.array([float(abs(v).upper()) for v in balls.entries()]).reshape(balls.nrows(), balls.ncols())
    return np.where(np.isnan(bounds), np.inf, bounds)
