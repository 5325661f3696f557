"""Riccati equations in ball arithmetic: X and L are correct to the last bit of double, the same on every machine.

X is the limit of doubling (module `equation`) in high precision: X = X0 + Y, with A - B L(X0), R or S at X0 and the
left side at X0 in place of A, R, Q. From X0 = 0 the doubling converges to the least cost, which need not stabilise;
from another X0 it misses the stabilising solution only by coincidence. A step of Newton's method (Kleinman 1968, Hewer
1971) removes its rounding errors; the linear equation Omega(Y) = -F(X) is that of `exact_lyapunov`, with A - B L for A.

The X after it is enclosed by the residual F (Sun 1997, residual bounds). A diagonal W > 0, an H and numbers with

    Omega(H) <= -W,     H <= mu W,     |F(X)| <= e W,     |eigenvalues of B S^-1 B'H| <= gamma     (R in place of S)

where |F| <= e W stands for -e W <= F <= e W, bound the terms of second order in F(X + Y) by
t^2 gamma mu W / (1 - t gamma) for all |Y| <= t H. Where, for t = 2 e,

    2 t gamma mu + t gamma < 1,

Y -> -Omega^-1(F(X) + terms of second order) maps these Y to themselves: by Brouwer's theorem X + Y solves the equation
for one of them. Its loop is stable, as H remains its Lyapunov function; so it is the stabilising solution, which is
unique, and |Y_ij| <= t sqrt(H_ii H_jj). The number of bits is raised until these balls, and those of L, decide to which
double each entry rounds. The poles are those of A - B L before it is rounded.
"""

from dataclasses import dataclass

import flint
import numpy as np

from synth.analyse.numerics import precise
from synth.errors import ModelError
from synth.statespace import Array
from synth.synthesise.riccati import equation, exact_lyapunov
from synth.synthesise.riccati.equation import Equation, Solution
from synth.synthesise.riccati.exact_lyapunov import frobenius, symmetric

Mat = flint.arb_mat

BITS = (precise.BITS, 4 * precise.BITS, 16 * precise.BITS)


@dataclass(frozen=True, eq=False)
class _Problem:
    A: Mat
    B: Mat
    Q: Mat
    R: Mat
    N: Mat
    bilinear: equation.Bilinear

    def weight(self, X: Mat) -> Mat:
        """Return R or S."""
        return self.R if self.bilinear.continuous else self.R + self.B.transpose() * X * self.B

    def feedback(self, X: Mat) -> Mat:
        """Return L for X; raise ZeroDivisionError when R or S may be singular."""
        XB = self.B.transpose() * X
        return self.weight(X).solve((XB if self.bilinear.continuous else XB * self.A) + self.N.transpose())

    def residual(self, X: Mat) -> Mat:
        """Return the equation's left side F at X."""
        cross = self.B.transpose() * X * (precise.identity(X.nrows()) if self.bilinear.continuous else self.A)
        return (
            exact_lyapunov.operator(self.A, X, self.bilinear.continuous)
            + self.Q
            - (cross.transpose() + self.N) * self.feedback(X)
        )

    def loop(self, X: Mat) -> Mat:
        """Return Ac."""
        return self.A - self.B * self.feedback(X)

    def enclosure(self, X: Mat) -> Mat | None:
        """Return balls that contain the stabilising solution near X, None where this precision does not prove it.

        Raises ZeroDivisionError when R or S may be singular.
        """
        decay, size = exact_lyapunov.stable_map(self.loop(X), self.bilinear), exact_lyapunov.powers_of_two(X)
        H = None if decay is None else decay.majorant(size)
        if H is None:
            return None
        root, D = precise.matrix(np.diag(size)), precise.matrix(np.diag(1 / size))
        e, mu = frobenius(D * self.residual(X) * D), frobenius(D * H * D)
        gamma = frobenius(root * self.B * self.weight(X).solve(self.B.transpose()) * H * D)
        t = 2 * e
        return exact_lyapunov.balls(X, H, t) if 2 * t * gamma * mu + t * gamma < 1 else None


def solve(equation: Equation) -> Solution:
    """Return the stabilising solution; its `step` is the distance of the rounded X from it.

    Raises ModelError when the doubling does not converge to it.
    """
    for bits in BITS:
        converged = False
        with precise.precision(bits):
            problem = _problem(equation)
            one = precise.identity(len(equation.A))
            for X0 in (one * 0, one * _cost_scale(problem)):
                try:
                    X = _doubling_limit(problem, X0)
                    solution = None if X is None else _rounded_solution(problem, X)
                except ZeroDivisionError:  # a matrix may be singular
                    continue
                if solution is not None:
                    return solution
                converged = converged or X is not None
        if not converged and bits > BITS[0]:  # more bits did not make the doubling converge: precision is not the cause
            break
    raise ModelError(
        f"the doubling of the Riccati equation does not converge within {bits} bits, or its loop is not stable: "
        "scale the weights or the states, or leave out modes that are nearly uncontrollable"
    )


def certify(equation: Equation, X: Array) -> Solution:
    """Return a symmetric X (n, n) of any origin with its L, residual and Newton step.

    The step is infinite where the loop is not stable: X is then near another solution. Raises ModelError when R or S
    is singular.
    """
    with precise.precision():
        problem, balls = _problem(equation), precise.matrix(X)
        try:
            defect, L = problem.residual(balls), problem.feedback(balls)
        except ZeroDivisionError as error:
            raise ModelError("R + B'XB is singular: this X has no gain; certify one that stabilises") from error
        closed = problem.A - problem.B * L
        decay = exact_lyapunov.stable_map(closed, problem.bilinear)
        step = np.full_like(X, np.inf) if decay is None else _bounds(decay.gramian(defect))
        poles = exact_lyapunov.eigenvalues(closed.mid())
        return Solution(X, precise.rounded(L), precise.rounded(closed), _bounds(defect), step, poles)


def _problem(e: Equation) -> _Problem:
    A, B, Q, R, N = (precise.matrix(v) for v in (e.A, e.B, e.Q, e.R, e.N))
    return _Problem(A, B, Q, R, N, equation.bilinear_map(e.scaled(*e.scales())))


def _cost_scale(p: _Problem) -> flint.arb:
    return flint.arb((precise.norm(p.Q) + precise.norm(p.R) / precise.norm(p.B) ** 2) if precise.norm(p.B) else 1.0)


def _doubling_limit(p: _Problem, X0: Mat) -> Mat | None:
    """Return the limit of doubling from X0, after Newton's step; None where there is none or its loop is not stable.

    Raises ZeroDivisionError when a matrix may be singular.
    """
    one, tolerance = precise.identity(p.A.nrows()), 2.0 ** (-flint.ctx.prec // 4)  # the next increment is its square
    A, G, H = p.loop(X0).mid(), (p.B * p.weight(X0).solve(p.B.transpose())).mid(), p.residual(X0).mid()
    if p.bilinear.continuous:
        A, G, H = _bilinear_transform(A, G, H)
    for _ in range(exact_lyapunov.PASSES):
        inverse = (one + G * H).inv().mid()
        V, A_t = inverse * A, A.transpose()
        step = A_t * H * V
        G, H, A = symmetric(G + A * inverse * G * A_t), symmetric(H + step), (A * V).mid()
        if not precise.norm(H) < 1e300:
            return None
        if precise.norm(step) <= tolerance * precise.norm(H):
            X = X0 + H
            decay = exact_lyapunov.stable_map(p.loop(X), p.bilinear)
            return None if decay is None else (X + decay.gramian(p.residual(X))).mid()
    return None


def _bilinear_transform(A: Mat, G: Mat, H: Mat) -> tuple[Mat, Mat, Mat]:
    """Return the discrete equation with the same solution, by z = (c + s) / (c - s)."""
    c = flint.arb(max(map(precise.norm, (A, G, H))) * A.nrows() or 1.0)  # beyond the eigenvalues of A
    one = precise.identity(A.nrows())
    J = (A - one * c).inv().mid()
    W = (A.transpose() - one * c + H * J * G).inv().mid()
    return one + W.transpose() * (2 * c), J * G * W * (2 * c), W * H * J * (2 * c)


def _rounded_solution(problem: _Problem, near: Mat) -> Solution | None:
    """Return X and its gain L, rounded, with the residual and the error of X; None where the balls leave it open."""
    X = problem.enclosure(near)
    if X is None:
        return None
    L = problem.feedback(X)
    rounded, gain = precise.doubles(X), precise.doubles(L)
    if rounded is None or gain is None or not (np.isfinite(rounded).all() and np.isfinite(gain).all()):
        return None
    balls, closed = precise.matrix(rounded), (problem.A - problem.B * L).mid()
    poles = exact_lyapunov.eigenvalues(closed)
    defect, error = _bounds(problem.residual(balls)), _bounds(balls - X)
    return Solution(rounded, gain, precise.rounded(closed), defect, error, poles)


def _bounds(balls: Mat) -> Array:
    """Return an upper bound of each entry's absolute value."""
    bounds = np.array([float(abs(v).upper()) for v in balls.entries()]).reshape(balls.nrows(), balls.ncols())
    return np.where(np.isnan(bounds), np.inf, bounds)
