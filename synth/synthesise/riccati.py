"""Algebraic Riccati equations with a certificate.

    continuous  A'X + XA - (XB + N) R^-1 (B'X + N') + Q = 0,          L = R^-1 (B'X + N'),             A - B L stable
    discrete    A'XA - X - (A'XB + N) S^-1 (B'XA + N') + Q = 0,       L = S^-1 (B'XA + N'),            A - B L stable
                                             S = R + B'XB

for A (n, n), B (n, m), Q (n, n) >= 0, R (m, m) > 0, N (n, m). SciPy's solution is the start of Newton's method
(Kleinman 1968, Hewer 1971) in ball arithmetic, so that X and L come out correct to the last bit of double and alike on
every machine. The certificate is of the rounded X: its residual, and one further Newton step as its distance from the
solution.
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

    `poles` are those of A - B L; `residual` bounds the largest entry of the equation's residual at the rounded X over
    that of Q; `forward_error` estimates the largest error of X over its largest entry; `least_eigenvalue` is that of X.
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
        entries = precise.middle(operator.solve(right)).entries()
        Y = flint.arb_mat(n, n, entries)
        return precise.middle((Y + Y.transpose()) * flint.arb(0.5))


def solve(model: StateSpace, Q: ArrayLike, R: ArrayLike, N: ArrayLike | None = None) -> Riccati:
    """Solve the Riccati equation of a model's A, B in its own time; Q (n, n), R (m, m), N (n, m), zero if left out.

    Raises SignalError for matrices that do not fit, an asymmetric Q or R, an indefinite Q or an R that is not positive
    definite; ModelError when (A, B) is not stabilisable or (Q, A) not detectable, naming the mode and its states.
    """
    n, m = model.B.shape
    Q, R = _symmetric("Q", Q, n), _symmetric("R", R, m)
    N = np.zeros((n, m)) if N is None else np.asarray(N, dtype=np.float64)
    if N.shape != (n, m):
        raise SignalError(f"the cross weight N is {N.shape}: {n} states and {m} inputs need {(n, m)}")
    _check_weights(Q, R, N)
    structure.require_stabilisable(model.A, model.B, model.states, model.inputs, model.time)
    shifted = model.A - model.B @ np.linalg.solve(R, N.T)
    structure.require_detectable(shifted, Q - N @ np.linalg.solve(R, N.T), model.states, "Q", model.time)
    continuous = isinstance(model.time, Continuous)
    start = _start(model.A, model.B, Q, R, N, continuous)
    with precise.precision():
        return _refined(_Problem(*map(precise.matrix, (model.A, model.B, Q, R, N)), continuous), precise.matrix(start))


def _refined(problem: _Problem, X: Mat) -> Riccati:
    for _ in range(8):
        previous, X = X, problem.newton(X)
        if precise.norm(X - previous) <= 1e-40 * precise.norm(X):
            break
    else:
        raise ModelError("Newton's method on the Riccati equation does not settle: scale the weights or the states")
    L = readonly(precise.rounded(problem.feedback(X)))
    shipped = readonly(precise.rounded(X))
    ball = precise.matrix(shipped)
    scale = max(precise.norm(problem.Q), 1e-300)
    closed = precise.rounded(problem.A - problem.B * problem.feedback(X))
    return Riccati(
        X=shipped,
        L=L,
        poles=np.sort_complex(np.linalg.eigvals(closed).astype(np.complex128)),
        residual=precise.norm(problem.residual(ball)) / scale,
        forward_error=precise.norm(problem.newton(ball) - ball) / precise.norm(X),
        least_eigenvalue=float(np.linalg.eigvalsh(shipped).min()),
    )


def _start(A: Array, B: Array, Q: Array, R: Array, N: Array, continuous: bool) -> Array:
    solver = scipy.linalg.solve_continuous_are if continuous else scipy.linalg.solve_discrete_are
    try:
        return solver(A, B, Q, R, s=N)
    except np.linalg.LinAlgError as error:
        raise ModelError(
            f"the Riccati equation has no stabilising solution within double precision ({error}): "
            "scale the weights and the states so that they are of like size"
        ) from error


def _symmetric(name: str, value: ArrayLike, n: int) -> Array:
    matrix = np.asarray(value, dtype=np.float64)
    if matrix.shape != (n, n) or not np.isfinite(matrix).all():
        raise SignalError(f"the weight {name} is {matrix.shape}: give a finite matrix of {(n, n)}")
    if not np.array_equal(matrix, matrix.T):
        i, j = np.argwhere(matrix != matrix.T)[0]
        raise SignalError(
            f"the weight {name} is not symmetric: [{i}, {j}] is {matrix[i, j]}, [{j}, {i}] {matrix[j, i]}"
        )
    return matrix


def _check_weights(Q: Array, R: Array, N: Array) -> None:
    least = float(np.linalg.eigvalsh(R).min())
    if least <= 0:
        raise SignalError(
            f"the weight R has the eigenvalue {least:.3g}: it must be positive definite; weight each input"
        )
    lowest = float(np.linalg.eigvalsh(Q - N @ np.linalg.solve(R, N.T)).min())
    if lowest < -1e-12 * max(1.0, float(np.abs(Q).max())):
        raise SignalError(f"Q - N R^-1 N' has the eigenvalue {lowest:.3g}: the cost must be positive semidefinite")
