"""Linear quadratic regulators (MATLAB `lqr`, `dlqr`, `lqrd`), u = K x (the sign is inside K, as in F(16)).

    lqr    min int (x'Qx + u'Ru + 2 x'Nu) dt for a continuous model, or the sum for a sampled one
    lqrd   the same integral for a continuous model whose input is held over each period T:

           int_0^T (x'Qx + u'Ru + 2 x'Nu) dt = [x; u]' W [x; u],   W = int_0^T M(t)' [Q, N; N', R] M(t) dt

           with M(t) = exp([[A, B], [0, 0]] t), which has a cross term even for N = 0 (Van Loan 1978);
           the input may be delayed (below)

    u --->[ x' = A x + B u, or x+ ]--- x ---+          y = C x + D u,  q' = y, or q+ = q + T y
    ^                                       |
    +------------------[ K ]<---------------+

`with_integrators` adds the states q (MATLAB `lqi`). The computation is in ball arithmetic: the gains are the same on
every machine.

The LQR cost of one period under zero-order hold, with the input delayed by (d + f) T, 0 <= f < 1.

In the period k the plant of `analyse.loop.sampled` has the input h = u[k-d-1] for the first f T, then v = u[k-d]:

    int_0^T (x'Qx + u'Ru + 2 x'Nu) dt = [x; h; v]' W [x; h; v],   W = W_1(f T) + M' W_2((1-f) T) M

W_1 weights (x, h), W_2 weights (x, v), and M maps (x, h, v) to (x, v) at f T; for f = 0 there is no h. The cost of the
periods k .. k+d-1 is fixed before u[k] is chosen. u[k] is therefore weighted by the period k+d in which it acts. There
(x, h) follows from the delayed inputs as P z[k], with the state z of the delayed model and the rows P of x and h of its
A^d. The sum

    sum_k [P z[k]; u[k]]' W [P z[k]; u[k]]

is the integral from d T on. Its optimal gain is that of the model without the d samples of delay, applied to P z.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
import scipy.linalg
from numpy.typing import ArrayLike, NDArray

from synth import arguments, show
from synth.analyse import discretise
from synth.analyse.loops import interconnect, loop
from synth.analyse.numerics import precise
from synth.analyse.structure import structure
from synth.errors import ModelError, SignalError, TimingError
from synth.statespace import Array, StateSpace, System, of, readonly
from synth.synthesise.riccati import equation, riccati, weights
from synth.timing import Continuous, Discrete, Time, period


@dataclass(frozen=True, eq=False)
class PeriodCost:
    """The sampled model and the weight W (n + m, n + m) on its states and inputs."""

    model: StateSpace
    W: Array


def over_period(plant: StateSpace, W: Array, period_s: float, delay_s: float) -> PeriodCost:
    """Return the sampled plant with hold and delay, and its equivalent of the weight W (n + m, n + m) on (x, u).

    Each step is rounded once, from ball arithmetic.

    Raises TimingError and ModelError as `loop.sampled` and `discretise.gramian`.
    """
    (n, m), F = plant.B.shape, _input_matrix(plant)
    if isinstance(delay_s, float | int) and delay_s == 0:
        held = discretise.gramian(F, W, period_s)
        model = replace(plant, A=held.M[:n, :n], B=held.M[:n, n:], time=Discrete(float(period_s)))
        return PeriodCost(model, held.W)
    delayed = loop.sampled(plant, period_s, delay_s)
    whole, fraction = _whole_and_fraction(delay_s / period_s)
    period_weight = _weight_of_period(F, W, m, period_s, fraction)
    if not whole:
        return PeriodCost(delayed, period_weight)
    P = _power(delayed.A, whole)[: len(period_weight) - m]
    return PeriodCost(delayed, _congruence(scipy.linalg.block_diag(P, np.eye(m)), period_weight))


def _input_matrix(plant: StateSpace) -> Array:
    n, m = plant.B.shape
    return np.vstack([np.hstack([plant.A, plant.B]), np.zeros((m, n + m))])


def _weight_of_period(F: Array, W: Array, m: int, period_s: float, fraction: float) -> Array:
    """Return the weight on (x, h, v), or (x, v) without a fraction."""
    if not fraction:
        return discretise.gramian(F, W, period_s).W
    first = discretise.gramian(F, W, fraction * period_s)
    second = discretise.gramian(F, W, (1 - fraction) * period_s).W
    M = scipy.linalg.block_diag(first.M, np.eye(m))
    M = np.delete(M, np.s_[len(F) - m : len(F)], axis=0)  # h no longer acts
    return scipy.linalg.block_diag(first.W, np.zeros((m, m))) + _congruence(M, second)


def _whole_and_fraction(samples: float) -> tuple[int, float]:
    """Return a delay as whole samples and a fraction of one, as `loop.sampled` does."""
    whole = round(samples)
    return (whole, 0.0) if abs(samples - whole) < loop.DELAY_ROUNDING else (int(samples), samples - int(samples))


def _power(A: Array, k: int) -> Array:
    return precise.round_correctly(lambda: precise.matrix(A) ** k, "the delayed model over its delay")


def _congruence(M: Array, W: Array) -> Array:
    """Return M' W M, symmetric."""
    balls = precise.matrix(M)
    product = precise.round_correctly(lambda: balls.transpose() * precise.matrix(W) * balls, "the weight")
    return np.asarray((product + product.T) / 2)


@show.result
class Gain:
    """State feedback u = K x, K (m, n), with the weights of its cost and its certificate.

    An entry of K has the unit of its input over that of its state, as far as `units` contains them.
    """

    K: Array
    Q: Array
    R: Array
    N: Array
    states: tuple[str, ...]
    inputs: tuple[str, ...]
    time: Time
    certificate: riccati.Riccati
    units: Mapping[str, str] = field(default_factory=dict)

    @property
    def poles(self) -> NDArray[np.complex128]:
        """Eigenvalues of A + B K, in 1/s or in z."""
        return self.certificate.poles

    def sheet(self) -> show.Sheet:
        """Return the certificate, the gain by name and the poles."""
        rows, columns = (
            [show.with_unit(name, self.units.get(name, "")) for name in names] for names in (self.inputs, self.states)
        )
        title = f"Optimal gain u = K x in {self.time}: {len(rows)} inputs, {len(columns)} states"
        tables = (show.feedback(show.matrix("K", self.K, rows, columns)), weights.table(self.poles, self.time))
        return show.Sheet(title, self.certificate.lines(), tables)


@show.result
class SampledCost:
    """The held model over one period and the weights Q, R, N of the exact cost integral."""

    model: StateSpace
    Q: Array
    R: Array
    N: Array

    def sheet(self) -> show.Sheet:
        """Return the weights as one table."""
        names = (*self.model.states, *self.model.inputs)
        table = show.matrix("", weights.joint_weight(self.Q, self.R, self.N), names, names)
        return show.Sheet(f"Cost over one period in {self.model.time}: weights [Q, N; N', R]", tables=(table,))


@arguments.checked
def lqr(system: System, Q: weights.Weight, R: weights.Weight, N: ArrayLike | None = None) -> Gain:
    """Return the optimal gain of a model in its own time; Q (n, n), R (m, m), N (n, m).

    Q and R are matrices, diagonals or {name: weight}. The certificate reports an unstable mode that is not observable
    in Q, and an indefinite Q. Raises as `riccati.solve`.
    """
    model = of(system)
    return _gain(model, riccati.solve(model, Q, R, N))


def _gain(model: StateSpace, solution: riccati.Riccati) -> Gain:
    cost = solution.Q, solution.R, solution.N
    return Gain(readonly(-solution.L), *cost, model.states, model.inputs, model.time, solution, model.units)


@arguments.checked
def lqrd(
    system: System,
    Q: weights.Weight,
    R: weights.Weight,
    period_s: float,
    N: ArrayLike | None = None,
    delay_s: float = 0.0,
) -> Gain:
    """Return the optimal gain for a continuous model whose input is held over `period_s`, for the continuous cost.

    With inputs delayed by `delay_s` the states are those of `loop.sampled`, including the delayed inputs, and the cost
    weights the inputs in the period in which they act.

    Raises TimingError for a sampled model, or a delay as `loop.sampled`; ModelError when only the choice of the period
    makes the model not stabilisable; else as `riccati.solve`.
    """
    model = of(system)
    return _sampled_gain(model, sampled_cost(model, Q, R, period_s, N, delay_s))


def _sampled_gain(model: StateSpace, cost: SampledCost) -> Gain:
    try:
        return _gain(cost.model, riccati.solve_matrices(cost.model, cost.Q, cost.R, cost.N))
    except ModelError:
        _require_period(model, cost.model)
        raise


def _require_period(model: StateSpace, held: StateSpace) -> None:
    """Raise ModelError when sampling with this period makes a stabilisable model not stabilisable.

    This happens when modes of the continuous model differ by a multiple of 2 pi i / T (Kalman, Ho, Narendra 1963).
    """
    structure.check_stabilisable(model)
    try:
        structure.check_stabilisable(held)
    except ModelError as error:
        fastest = float(np.abs(model.poles.imag).max())
        advice = f", below {np.pi / fastest:.4g} s" if fastest else ""
        raise ModelError(
            f"the input stabilises the continuous model, but not when it is held over {period(held.time):.6g} s, at "
            "which modes cannot be distinguished from their samples: take another period, preferably a shorter "
            f"one{advice}"
        ) from error


@arguments.checked
def sampled_cost(
    system: System,
    Q: weights.Weight,
    R: weights.Weight,
    period_s: float,
    N: ArrayLike | None = None,
    delay_s: float = 0.0,
) -> SampledCost:
    """Return the sampled model and its exact weights over one period, with the input delayed by `delay_s`.

    Raises TimingError for a sampled model, or a delay as `loop.sampled`; SignalError for weights as `riccati.solve`;
    ModelError as `discretise.gramian`.
    """
    model = of(system)
    Q, R, N = riccati.weight_matrices(model, Q, R, N)
    if not isinstance(model.time, Continuous):
        raise TimingError(
            f"the cost over a period needs a continuous model, but this one is in {model.time}: give the "
            "continuous model"
        )
    held = over_period(model, weights.joint_weight(Q, R, N), period_s, delay_s)
    W, n = held.W, len(held.model.A)
    return SampledCost(held.model, readonly(W[:n, :n]), readonly(W[n:, n:]), readonly(W[:n, n:]))


@arguments.checked
def cost_ratio(
    system: System,
    gain: Gain,
    Q: weights.Weight,
    R: weights.Weight,
    period_s: float,
    N: ArrayLike | None = None,
) -> float:
    """Return the cost of using `gain` at a sample period over that of `lqrd`, for the worst initial state.

    The ratio is infinite when the sampled loop with `gain` is unstable. The model is continuous, and any gain may be
    given: for that of `lqr` the ratio is the price of emulation. A state with zero optimal cost is ignored.

    Raises SignalError when the gain is for other states or inputs; ModelError when the optimal cost is zero from every
    state, or negative from one; else as `lqrd`.
    """
    model = of(system)
    K, cost = _gain_matrix(gain, model), sampled_cost(model, Q, R, period_s, N)
    optimal = _sampled_gain(model, cost).certificate
    least = optimal.X
    if optimal.least_eigenvalue < 0:
        raise ModelError(
            "the optimal cost is negative from some states and the ratio is meaningless: give semidefinite weights"
        )
    size = np.sqrt(np.maximum(np.diag(least), 0.0))
    if not size.any():
        raise ModelError("the optimal cost is zero from every state and the ratio is undefined: weight a state")
    d = 1 / np.where(size > 0, size, 1.0)
    NK = cost.N @ K
    step, unit = cost.Q + K.T @ cost.R @ K + NK + NK.T, d * d[:, None]
    decay = equation.stable_map((cost.model.A + cost.model.B @ K) * d / d[:, None], equation.Bilinear(1.0, False))
    if decay is None:
        return np.inf
    values, V = np.linalg.eigh(least * unit)
    costly = values > 1e-13 * values[-1]
    W = V[:, costly] / np.sqrt(values[costly])
    return float(np.linalg.eigvalsh(W.T @ decay.gramian(step * unit) @ W)[-1])


def _gain_matrix(gain: Gain, model: StateSpace) -> Array:
    """Return K (m, n) of a gain for this model; raise SignalError for a gain of another model."""
    if (gain.states, gain.inputs) != (model.states, model.inputs):
        raise SignalError(
            f"the gain is from {', '.join(gain.states)} to {', '.join(gain.inputs)}, the model has the states "
            f"{', '.join(model.states)} and the inputs {', '.join(model.inputs)}: give the gain of this model"
        )
    K = arguments.matrix("K", gain.K)
    if K.shape != model.B.T.shape or not np.isfinite(K).all():
        raise SignalError(f"the gain K is {K.shape}: this model needs a finite one of {model.B.T.shape}")
    return K


@arguments.checked
def with_integrators(system: System, outputs: Sequence[str]) -> StateSpace:
    """Return the model with a state ``<output>_integral`` for each of some outputs: q' = y, or q+ = q + T y.

    They follow the states, with the unit of y times s, and are also outputs (Y(31), Y(32)).

    Raises SignalError for an unknown or duplicate output.
    """
    model = of(system)
    model.select(outputs, ())
    sums = interconnect.integrals(model, {f"{y}_integral": y for y in outputs})
    wires = {f"{y}_measured": {y: 1.0} for y in outputs}
    parts = (model, sums.renamed({y: f"{y}_measured" for y in outputs}))
    return interconnect.connect(parts, model.inputs, (*model.outputs, *sums.outputs), wires)
