"""Linear quadratic regulators, u = K x (the sign is inside K, as in F(16)).

lqr    min int (x'Qx + u'Ru + 2 x'Nu) dt,            continuous model, or the sum for a sampled one
lqrd   the same integral for a continuous model whose input is held over each period T:

       int_0^T (x'Qx + u'Ru) dt = [x; u]' W [x; u],   W = int_0^T M(t)' diag(Q, R) M(t) dt

       with M(t) = exp([[A, B], [0, 0]] t), which has a cross term even where Q and R have none; W by Van Loan (1978).
"""

from dataclasses import dataclass

import flint
import numpy as np
import scipy.linalg
from numpy.typing import ArrayLike, NDArray

from synth.analyse import discretise, precise
from synth.statespace import Array, StateSpace, readonly
from synth.synthesise import riccati
from synth.timing import Time


@dataclass(frozen=True, eq=False)
class Gain:
    """State feedback u = K x, K (m, n), with the weights that it minimises and its certificate."""

    K: Array
    Q: Array
    R: Array
    N: Array
    states: tuple[str, ...]
    inputs: tuple[str, ...]
    time: Time
    certificate: riccati.Riccati

    @property
    def poles(self) -> NDArray[np.complex128]:
        """Eigenvalues of A + B K, in 1/s or in z."""
        return self.certificate.poles


@dataclass(frozen=True, eq=False)
class SampledCost:
    """The held model over one period and the weights Q, R, N of the exact cost integral."""

    model: StateSpace
    Q: Array
    R: Array
    N: Array


def lqr(model: StateSpace, Q: ArrayLike, R: ArrayLike, N: ArrayLike | None = None) -> Gain:
    """Return the optimal gain of a model in its own time; Q (n, n), R (m, m), N (n, m).

    Raises as `riccati.solve`.
    """
    found = riccati.solve(model, Q, R, N)
    cross = np.zeros(model.B.shape) if N is None else N
    weights = (readonly(Q), readonly(R), readonly(cross))
    return Gain(readonly(-found.L), *weights, model.states, model.inputs, model.time, found)


def lqrd(model: StateSpace, Q: ArrayLike, R: ArrayLike, period_s: float) -> Gain:
    """Return the optimal gain for a continuous model whose input is held over `period_s`, for the continuous cost.

    Raises TimingError for a sampled model; else as `riccati.solve`.
    """
    cost = sampled_cost(model, Q, R, period_s)
    return lqr(cost.model, cost.Q, cost.R, cost.N)


def sampled_cost(model: StateSpace, Q: ArrayLike, R: ArrayLike, period_s: float) -> SampledCost:
    """Return the held model and its exact weights over one period.

    Raises TimingError for a sampled model; SignalError for weights as `riccati.solve`; ModelError as
    `precise.resolved`.
    """
    Q, R, _ = riccati.checked_weights(model, Q, R, None)
    held = discretise.zero_order_hold(model, period_s)
    n, m = model.B.shape
    F = np.block([[model.A, model.B], [np.zeros((m, n + m))]])
    H = np.block([[-F.T, scipy.linalg.block_diag(Q, R)], [np.zeros((n + m, n + m)), F]])

    def compute() -> flint.arb_mat:
        E = (precise.matrix(H) * flint.arb(period_s)).exp()
        k = range(n + m)
        M = flint.arb_mat([[E[n + m + i, n + m + j] for j in k] for i in k])
        G = flint.arb_mat([[E[i, n + m + j] for j in k] for i in k])
        return M.transpose() * G

    W = precise.resolved(compute, f"the cost over {period_s:g} s")
    W = (W + W.T) / 2
    return SampledCost(held, readonly(W[:n, :n]), readonly(W[n:, n:]), readonly(W[:n, n:]))


def cost_ratio(model: StateSpace, gain: Gain, Q: ArrayLike, R: ArrayLike, period_s: float) -> float:
    """Return the cost of using `gain` at a sample period over that of `lqrd`, for the worst initial state.

    Infinite when the sampled loop with `gain` is unstable. The model is continuous, the gain of any origin. A state of
    which the optimal cost is zero is left aside.

    Raises as `lqrd`.
    """
    cost = sampled_cost(model, Q, R, period_s)
    best = lqr(cost.model, cost.Q, cost.R, cost.N)
    closed = cost.model.A + cost.model.B @ gain.K
    if np.abs(np.linalg.eigvals(closed)).max() >= 1:
        return np.inf
    K, N = gain.K, cost.N
    step = cost.Q + K.T @ cost.R @ K + N @ K + (N @ K).T
    X, least = scipy.linalg.solve_discrete_lyapunov(closed.T, step), best.certificate.X
    size = np.sqrt(np.diag(least))
    d = 1 / np.where(size > 0, size, 1.0)
    values, V = np.linalg.eigh(d[:, None] * least * d)
    costly = values > 1e-13 * values[-1]
    W = d[:, None] * V[:, costly] / np.sqrt(values[costly])
    return float(np.linalg.eigvalsh(W.T @ (X + X.T) @ W / 2)[-1])
