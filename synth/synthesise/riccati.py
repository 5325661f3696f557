"""Algebraic Riccati equations with a certificate.

    continuous  A'X + XA - (XB + N) R^-1 (B'X + N') + Q = 0,          L = R^-1 (B'X + N'),             A - B L stable
    discrete    A'XA - X - (A'XB + N) S^-1 (B'XA + N') + Q = 0,       L = S^-1 (B'XA + N'),            A - B L stable
                                             S = R + B'XB

for A (n, n), B (n, m), Q (n, n) >= 0, R (m, m) > 0, N (n, m). SciPy's solution is the start of Newton's method
(Kleinman 1968, Hewer 1971) in ball arithmetic, so that X and L come out correct to the last bit of double and alike on
every machine. The certificate is of the rounded X: its residual, and one further Newton step as its distance from the
solution. `certify` gives it for an X of any origin.
"""

from dataclasses import dataclass

import flint
import numpy as np
import scipy.linalg
from numpy.typing import ArrayLike, NDArray

from synth.analyse import precise, structure
from synth.errors import ModelError, SignalError
from synth.statespace import Array, StateSpace, readonly
from synth.timing import Continuous

Mat = flint.arb_mat


@dataclass(frozen=True, eq=False)
class Riccati:
    """The stabilising solution X (n, n) and L (m, n), u = -L x, with its certificate.

    `poles` are those of A - B L, in 1/s or in z; `residual` bounds the largest entry of the equation's residual at the
    rounded X over that of Q; `forward_error` estimates the largest error of X over its largest entry;
    `least_eigenvalue` is that of X.
    """

    X: Array
    L: Array
    poles: NDArray[np.complex128]
    residual: float
    forward_error: float
    least_eigenvalue: float


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
        """Return the next iterate: the cost of the feedback L(X), from a linear (Lyapunov or Stein) equation."""
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
        try:
            Y = flint.arb_mat(n, n, precise.middle(operator.solve(right)).entries())
        except ZeroDivisionError as error:
            raise ModelError(
                "a Newton step of the Riccati equation has no solution: its closed loop has poles s + s' = 0 "
                "(s s' = 1 in discrete time); start nearer to the stabilising solution or scale the weights"
            ) from error
        return precise.middle((Y + Y.transpose()) * flint.arb(0.5))


def certify(model: StateSpace, Q: ArrayLike, R: ArrayLike, X: ArrayLike, N: ArrayLike | None = None) -> Riccati:
    """Return a symmetric X (n, n) of any origin with its L and its certificate; arguments else as for `solve`.

    Raises SignalError as `solve`, or when X does not fit; ModelError when its L leaves the closed loop singular.
    """
    Q, R, N = checked_weights(model, Q, R, N)
    X = _symmetric("X", X, len(model.A))
    with precise.precision():
        problem = _problem(model, Q, R, N)
        return _certified(problem, precise.matrix(X))


def solve(model: StateSpace, Q: ArrayLike, R: ArrayLike, N: ArrayLike | None = None) -> Riccati:
    """Solve the Riccati equation of a model's A, B in its own time; Q (n, n), R (m, m), N (n, m), zero if left out.

    Raises SignalError for matrices that do not fit, an asymmetric Q or R, an indefinite Q or an R that is not positive
    definite; ModelError when (A, B) is not stabilisable or (Q, A) not detectable, naming the mode and its states, or
    when no stabilising solution is found.
    """
    Q, R, N = checked_weights(model, Q, R, N)
    structure.require_stabilisable(model.A, model.B, model.states, model.inputs, model.time)
    shifted = model.A - model.B @ np.linalg.solve(R, N.T)
    structure.require_detectable(shifted, Q - N @ np.linalg.solve(R, N.T), model.states, "Q", model.time)
    start = _start(model, Q, R, N)
    with precise.precision():
        problem = _problem(model, Q, R, N)
        found = _certified(problem, _refined(problem, precise.matrix(start)))
    stable = found.poles.real < 0 if problem.continuous else np.abs(found.poles) < 1
    if not stable.all():
        raise ModelError(
            f"the Riccati equation's solution leaves the pole {found.poles[~stable][0]:.4g}, which does not decay: "
            "scale the weights and the states so that they are of like size"
        )
    return found


def checked_weights(model: StateSpace, Q: ArrayLike, R: ArrayLike, N: ArrayLike | None) -> tuple[Array, Array, Array]:
    """Return the weights as arrays (n, n), (m, m), (n, m).

    Raises SignalError for matrices that do not fit, an asymmetric or indefinite Q, or an R that is not positive
    definite.
    """
    n, m = model.B.shape
    Q, R = _symmetric("Q", Q, n), _symmetric("R", R, m)
    N = np.zeros((n, m)) if N is None else np.asarray(N, dtype=np.float64)
    if N.shape != (n, m) or not np.isfinite(N).all():
        raise SignalError(f"the cross weight N is {N.shape}: {n} states and {m} inputs need a finite one of {(n, m)}")
    _check_definite(Q, R, N)
    return Q, R, N


def _problem(model: StateSpace, Q: Array, R: Array, N: Array) -> _Problem:
    A, B = precise.matrix(model.A), precise.matrix(model.B)
    continuous = isinstance(model.time, Continuous)
    return _Problem(A, B, precise.matrix(Q), precise.matrix(R), precise.matrix(N), continuous)


def _refined(problem: _Problem, X: Mat) -> Mat:
    """Return Newton's limit; its steps square the error, so that the last leaves some 1e-70."""
    for _ in range(30):
        previous, X = X, problem.newton(X)
        if precise.norm(X - previous) <= 1e-40 * precise.norm(X):
            return X
    raise ModelError("Newton's method on the Riccati equation does not settle: scale the weights or the states")


def _certified(problem: _Problem, X: Mat) -> Riccati:
    L = problem.feedback(X)
    shipped = readonly(precise.rounded(X))
    ball = precise.matrix(shipped)
    closed = precise.rounded(problem.A - problem.B * L)
    return Riccati(
        X=shipped,
        L=readonly(precise.rounded(L)),
        poles=np.sort_complex(np.linalg.eigvals(closed).astype(np.complex128)),
        residual=precise.norm(problem.residual(ball)) / (precise.norm(problem.Q) or 1.0),
        forward_error=precise.norm(problem.newton(ball) - ball) / (precise.norm(X) or 1.0),
        least_eigenvalue=float(np.linalg.eigvalsh(shipped).min()),
    )


def _start(model: StateSpace, Q: Array, R: Array, N: Array) -> Array:
    continuous = isinstance(model.time, Continuous)
    solver = scipy.linalg.solve_continuous_are if continuous else scipy.linalg.solve_discrete_are
    try:
        return solver(model.A, model.B, Q, R, s=N)
    except np.linalg.LinAlgError as error:
        raise ModelError(
            f"the Riccati equation has no stabilising solution within double precision ({error}): "
            "scale the weights and the states so that they are of like size"
        ) from error


def _symmetric(name: str, value: ArrayLike, n: int) -> Array:
    matrix = np.asarray(value, dtype=np.float64)
    if matrix.shape != (n, n) or not np.isfinite(matrix).all():
        raise SignalError(f"the matrix {name} is {matrix.shape}: give a finite one of {(n, n)}")
    if not np.array_equal(matrix, matrix.T):
        i, j = np.argwhere(matrix != matrix.T)[0]
        raise SignalError(
            f"the matrix {name} is not symmetric: [{i}, {j}] is {matrix[i, j]}, [{j}, {i}] is {matrix[j, i]}; "
            "give (M + M') / 2"
        )
    return matrix


def _check_definite(Q: Array, R: Array, N: Array) -> None:
    least = float(np.linalg.eigvalsh(R).min())
    if least <= 0:
        raise SignalError(
            f"the weight R has the eigenvalue {least:.3g}: it must be positive definite; weight each input"
        )
    lowest = float(np.linalg.eigvalsh(Q - N @ np.linalg.solve(R, N.T)).min())
    if lowest < -1e-12 * max(1.0, float(np.abs(Q).max())):
        raise SignalError(
            f"Q - N R^-1 N' has the eigenvalue {lowest:.3g}: the cost must be positive semidefinite; raise Q or lower N"
        )
