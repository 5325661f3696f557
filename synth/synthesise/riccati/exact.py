"""Riccati equations in ball arithmetic: X and L are correct to the last bit of double, the same on every machine.

X is the limit of doubling (module `equation`) in high precision: X = X0 + Y, with A - B L(X0), R or S at X0 and the
left side at X0 in place of A, R, Q. From X0 = 0 the doubling converges to the least cost, which need not stabilise;
from another X0 it misses the stabilising solution only by coincidence. A step of Newton's method (Kleinman 1968, Hewer
1971) removes its rounding errors; the linear equation Omega(Y) = -F(X) is solved as below, with A - B L for A.

The X after it is enclosed by the residual F (Sun 1997, residual bounds). A diagonal W > 0, an H and numbers with

    Omega(H) <= -W,     H <= mu W,     |F(X)| <= e W,     |eigenvalues of B S^-1 B'H| <= gamma     (R in place of S)

where |F| <= e W stands for -e W <= F <= e W, bound the terms of second order in F(X + Y) by
t^2 gamma mu W / (1 - t gamma) for all |Y| <= t H. Where, for t = 2 e,

    2 t gamma mu + t gamma < 1,

Y -> -Omega^-1(F(X) + terms of second order) maps these Y to themselves: by Brouwer's theorem X + Y solves the equation
for one of them. Its loop is stable, as H remains its Lyapunov function; so it is the stabilising solution, which is
unique, and |Y_ij| <= t sqrt(H_ii H_jj). The number of bits is raised until these balls, and those of L, decide to which
double each entry rounds. The poles are those of A - B L before it is rounded.

Lyapunov and Stein equations of a stable matrix A in ball arithmetic, with balls that contain the solution.

    continuous  Omega(Y) = A'Y + Y A = -W,     discrete  Omega(Y) = A'Y A - Y = -W

They are solved by squaring the bilinear image of A (Smith 1968, module `equation`). Its powers are balls: where one is
below 1, A is stable. Omega^-1 then reverses the order of symmetric matrices, and an H with Omega(H) <= -S < 0 bounds
what a defect V adds to Y:

    -e S <= V <= e S     implies     -e H <= Omega^-1(V) <= e H,     |Omega^-1(V)_ij| <= e sqrt(H_ii H_jj)

Eigenvalues of an exactly given matrix in ball arithmetic, and the stability of its modes beyond rounding error.

The eigenvalues of a matrix of doubles are computed in the precision in force and rounded once. This includes those of a
Jordan block, which double precision scatters by a root of its precision. The only error left is that of rounding the
matrix itself.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import flint
import numpy as np
from numpy.typing import NDArray

from synth.analyse import discretise
from synth.analyse.numerics import precise
from synth.analyse.structure import structure
from synth.errors import ModelError
from synth.statespace import Array, Complex
from synth.synthesise.riccati import equation
from synth.synthesise.riccati.equation import Bilinear, Equation, Solution, sizes
from synth.timing import Continuous, Time


def ball(values: Array) -> flint.arb_mat:
    """Return the doubles of a matrix, exactly, also of one without rows or columns."""
    return precise.matrix(values) if values.size else flint.arb_mat(*values.shape)


def decays(poles: Complex, time: Time) -> NDArray[np.bool_]:
    """Tell for each pole whether its mode decays by more than rounding error."""
    if isinstance(time, Continuous):
        return poles.real < -structure.DECAY * np.abs(poles).max(initial=0.0)
    return np.abs(poles) < 1 - structure.DECAY


def unstable_pole(A: Array, time: Time) -> complex | None:
    """Return the fastest growing eigenvalue of A (n, n) of those that do not decay, None where all decay.

    An eigenvalue counts as not decaying if rounding of A may stop its decay: Re s >= -DECAY |w|' |A|, with the unit
    left eigenvector w of the balanced A, or |z| >= 1 - DECAY. A slow mode is thus not compared with the fast ones.
    """
    if not len(A):
        return None
    D = discretise.balancing(A)
    balanced = A * D / D[:, None]
    values, w = np.linalg.eig(balanced.T)
    return _fastest_growing(values, w, balanced, time)


def exact_unstable_pole(F: flint.arb_mat, time: Time) -> complex | None:
    """Return the pole of `unstable_pole`, computed in the precision in force."""
    if not F.nrows():
        return None
    A = precise.rounded(F)
    D = discretise.balancing(A)
    balanced = precise.matrix(np.diag(1 / D)) * F * precise.matrix(np.diag(D))
    values, left = flint.acb_mat(balanced).eig(left=True, algorithm="approx")
    w = np.array([[complex(v) for v in row] for row in left.tolist()]).T
    poles = np.array([_without_rounding(complex(v)) for v in values])
    return _fastest_growing(poles, _with_unit_columns(w), A * D / D[:, None], time)


def _with_unit_columns(w: Complex) -> Complex:
    """Return unit columns, and ones, which no unit vector exceeds, for a column that a Jordan block leaves open."""
    with np.errstate(invalid="ignore", over="ignore", divide="ignore"):
        unit = w / np.linalg.norm(w, axis=0)
    return np.where(np.isfinite(unit).all(axis=0), unit, 1.0 + 0j)


def _fastest_growing(values: Complex, w: Complex, balanced: Array, time: Time) -> complex | None:
    """Return the value that grows fastest, None where all decay; w (n, n) has the unit left eigenvectors as columns."""
    if isinstance(time, Continuous):
        growth = values.real + structure.DECAY * np.linalg.norm(np.abs(w).T @ np.abs(balanced), axis=1)
    else:
        growth = np.abs(values) - 1 + structure.DECAY
    return complex(values[np.argmax(growth)]) if growth.max() >= 0 else None


def eigenvalues(F: flint.arb_mat) -> Complex:
    """Return the eigenvalues (n,) of a square matrix, sorted, computed in the precision in force, rounded once."""
    if not F.nrows():
        return np.zeros(0, dtype=np.complex128)
    values = flint.acb_mat(F).eig(algorithm="approx")
    return np.sort_complex(np.array([_without_rounding(complex(v)) for v in values], dtype=np.complex128))


def _without_rounding(value: complex) -> complex:
    """Return a value whose real or imaginary part is 0 where it is rounding error of the other."""
    least = 1e-30 * abs(value)
    real, imaginary = (v if abs(v) > least else 0.0 for v in (value.real, value.imag))
    return complex(real, imaginary)


Mat = flint.arb_mat

PASSES = 150  # doublings


def operator(A: Mat, Y: Mat, continuous: bool) -> Mat:
    """Return Omega(Y)."""
    YA = Y * A
    return YA + YA.transpose() if continuous else A.transpose() * YA - Y


@dataclass(frozen=True, eq=False)
class StableMap:
    """A stable A, as the powers A_d^1, A_d^2, A_d^4 .. of its bilinear image, with J and g."""

    A: Mat
    powers: Sequence[Mat]
    J: Mat
    g: flint.arb
    continuous: bool

    def gramian(self, W: Mat) -> Mat:
        """Return Y with Omega(Y) = -W for a symmetric W, to the precision in force but without a bound of its error."""
        Y = (self.J.transpose() * W * self.J * self.g).mid()
        for A in self.powers:
            Y = (Y + A.transpose() * Y * A).mid()
        return symmetric(Y)

    def majorant(self, size: Array) -> Mat | None:
        """Return an H for S = diag(size)^2, with powers of 2; None where this precision does not prove it."""
        D = precise.matrix(np.diag(1 / size))
        S = precise.matrix(np.diag(size * size))
        H = self.gramian(S * 2)
        return H if frobenius(D * (operator(self.A, H, self.continuous) + S * 2) * D) < 1 else None


def stable_map(A: Mat, bilinear: Bilinear) -> StableMap | None:
    """Return A as a StableMap, None where this precision does not show that it is stable."""
    one, c, k = precise.identity(A.nrows()), flint.arb(bilinear.c), flint.arb(bilinear.k)
    shift, g = (c, 2 * c) if bilinear.continuous else (k, 1 - k * k)
    try:
        J = (one * c - A if bilinear.continuous else one + A * k).inv()
    except ZeroDivisionError:
        return None
    powers = [(A + one * shift) * J]
    for _ in range(PASSES):
        size = frobenius(powers[-1])
        if size < flint.arb(2) ** (-flint.ctx.prec // 2):
            return StableMap(A, powers, J, g, bilinear.continuous)
        if not size < 1e300:
            break
        powers.append(powers[-1] * powers[-1])
    return None


def solution(A: Mat, W: Mat, continuous: bool) -> Mat:
    """Return balls that contain Y; raise ZeroDivisionError where this precision does not prove that A is stable."""
    decay = stable_map(A, Bilinear(precise.norm(A) if continuous else 1.0, continuous))
    if decay is None:
        raise ZeroDivisionError
    Y = decay.gramian(W)
    size = powers_of_two(Y)
    H, D = decay.majorant(size), precise.matrix(np.diag(1 / size))
    if H is None:
        raise ZeroDivisionError
    return balls(Y, H, frobenius(D * (operator(A, Y, continuous) + W) * D))


def powers_of_two(Y: Mat) -> Array:
    """Return sqrt(Y_ii) (n,) to a power of 2, with a floor."""
    return np.asarray(np.exp2(np.round(np.log2(sizes(precise.rounded(Y))))))


def balls(Y: Mat, H: Mat, e: flint.arb) -> Mat:
    """Return Y_ij with the radius e sqrt(H_ii H_jj)."""
    n, root = Y.nrows(), [H[i, i].sqrt() for i in range(Y.nrows())]
    return Mat([[Y[i, j] + flint.arb(0, (e * root[i] * root[j]).upper()) for j in range(n)] for i in range(n)])


def symmetric(Y: Mat) -> Mat:
    """Return the midpoints of (Y + Y') / 2."""
    return ((Y + Y.transpose()) * flint.arb(0.5)).mid()


def frobenius(M: Mat) -> flint.arb:
    """Return an upper bound of the Frobenius norm, which no eigenvalue exceeds."""
    return sum((abs(v).upper() ** 2 for v in M.entries()), flint.arb(0)).sqrt().upper()


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
        return operator(self.A, X, self.bilinear.continuous) + self.Q - (cross.transpose() + self.N) * self.feedback(X)

    def loop(self, X: Mat) -> Mat:
        """Return Ac."""
        return self.A - self.B * self.feedback(X)

    def enclosure(self, X: Mat) -> Mat | None:
        """Return balls that contain the stabilising solution near X, None where this precision does not prove it.

        Raises ZeroDivisionError when R or S may be singular.
        """
        decay, size = stable_map(self.loop(X), self.bilinear), powers_of_two(X)
        H = None if decay is None else decay.majorant(size)
        if H is None:
            return None
        root, D = precise.matrix(np.diag(size)), precise.matrix(np.diag(1 / size))
        e, mu = frobenius(D * self.residual(X) * D), frobenius(D * H * D)
        gamma = frobenius(root * self.B * self.weight(X).solve(self.B.transpose()) * H * D)
        t = 2 * e
        return balls(X, H, t) if 2 * t * gamma * mu + t * gamma < 1 else None


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
        decay = stable_map(closed, problem.bilinear)
        step = np.full_like(X, np.inf) if decay is None else _bounds(decay.gramian(defect))
        poles = eigenvalues(closed.mid())
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
    for _ in range(PASSES):
        inverse = (one + G * H).inv().mid()
        V, A_t = inverse * A, A.transpose()
        step = A_t * H * V
        G, H, A = symmetric(G + A * inverse * G * A_t), symmetric(H + step), (A * V).mid()
        if not precise.norm(H) < 1e300:
            return None
        if precise.norm(step) <= tolerance * precise.norm(H):
            X = X0 + H
            decay = stable_map(p.loop(X), p.bilinear)
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
    poles = eigenvalues(closed)
    defect, error = _bounds(problem.residual(balls)), _bounds(balls - X)
    return Solution(rounded, gain, precise.rounded(closed), defect, error, poles)


def _bounds(balls: Mat) -> Array:
    """Return an upper bound of each entry's absolute value."""
    bounds = np.array([float(abs(v).upper()) for v in balls.entries()]).reshape(balls.nrows(), balls.ncols())
    return np.where(np.isnan(bounds), np.inf, bounds)
