"""Linear quadratic Gaussian control (MATLAB `lqg`, `lqgreg`): the gain of `lqr` on the estimate of `kalman`, u = K x^.

                         +--> [q' = y - r] --- q ---+           q+ = q + T (y - r) in discrete time
                         |                          v
     y --(+)-------------+--> [estimator] -- x^ --> [K] ---+---> u
          ^                         ^                      |
          |                         +----------------------+
     measurement noise

The controller computes the integral states q of chosen outputs itself, without error; only the plant's states are
estimated. They are recognised among the gain's states by their names, ``<output>_integral`` as in
`lqr.with_integrators`, and add an input ``<output>_reference``. The poles of the loop are those of A + B K, with the
integrators, and those of the estimator (separation principle). Source: Anderson, Moore, Optimal Control (1990),
chapter 8.

Initial state of an estimator from its first measurement, which avoids the transient from 0.

    x^[0] = x_0 + G (y[0] - C x_0 - D u[0]),      G = E C' (C E C')^-1,      E = diag(d)^2

x_0 are prior values of the states and d their standard deviations. Of all x^ that reproduce the measurement, it is the
nearest to x_0 relative to d. An unobserved state, or one with the deviation 0, starts at its prior value. x^[0] is the
limit of the first correction of a Kalman filter (`square_root_kalman.update`) for an initial covariance s E, s large. G
is computed in ball arithmetic and rounded once.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import flint
import numpy as np
import scipy.linalg
import scipy.optimize

from synth import arguments, show
from synth.analyse.loops import interconnect
from synth.analyse.numerics import precise
from synth.analyse.numerics.magnitude import equilibrated
from synth.errors import ModelError, SignalError
from synth.statespace import Array, Complex, StateSpace, System, of, readonly
from synth.synthesise.feedback import lqr
from synth.synthesise.observers import kalman
from synth.timing import Continuous, common

INTEGRAL = "_integral"


@show.result
class Controller:
    """A gain on an estimator: `compensator` from y, references and other known inputs to u, and the closed `loop`.

    The loop has the inputs ``<state>_disturbance`` (on x' or x+), ``<output>_noise``, then those of the compensator
    except y; its outputs are y and u.
    """

    gain: lqr.Gain
    estimator: kalman.Estimator
    compensator: StateSpace
    loop: StateSpace

    @property
    def poles(self) -> Complex:
        """Eigenvalues of the closed loop, in 1/s or in z."""
        return self.loop.poles

    @property
    def separation(self) -> float:
        """The largest distance of a pole of the loop from its counterpart among those of regulator and estimator.

        Relative in continuous time, absolute in z. It is small when the gain was designed for the estimator's model.
        """
        designed = np.concatenate([self.gain.poles, self.estimator.poles])
        size = np.abs(designed) if isinstance(self.loop.time, Continuous) else np.ones(len(designed))
        distances = np.abs(self.poles[:, None] - designed) / size
        return float(distances[scipy.optimize.linear_sum_assignment(distances)].max())

    def sheet(self) -> show.Sheet:
        """Return the poles of the two designs, the separation and the compensator."""
        inner = self.compensator.sheet()
        texts = [", ".join(show.number(s) for s in part.poles) for part in (self.gain, self.estimator)]
        lines = (
            f"poles of the regulator {texts[0]}; of the estimator {texts[1]}",
            f"separation: the poles of the loop lie within {self.separation:.1e} of these",
            f"compensator: {inner.title}",
        )
        title = f"LQG controller of {', '.join(self.gain.inputs)} from {', '.join(self.estimator.model.outputs)}"
        return show.Sheet(title, lines, inner.tables)


@arguments.checked
def predictor(gain: lqr.Gain, estimator: kalman.Estimator) -> Controller:
    """Return the controller whose u uses only earlier samples; a whole period is available to compute it.

    Raises TimingError for different times; SignalError when the gain's states are not the estimator's and integrals of
    its outputs, or the estimator does not know its inputs; ModelError for an algebraic loop without a solution.
    """
    return _controller(gain, estimator, estimator.predictor())


@arguments.checked
def current(gain: lqr.Gain, estimator: kalman.Estimator) -> Controller:
    """Return the controller whose u also uses the sample of the same instant. Raises as `predictor`."""
    return _controller(gain, estimator, estimator.current())


def _controller(gain: lqr.Gain, estimator: kalman.Estimator, estimator_form: StateSpace) -> Controller:
    model = estimator.model
    common(gain.time, model.time)
    regulated = integrals(gain, model)
    integrators = _integrators(model, regulated)
    others = tuple(name for name in model.inputs if name not in gain.inputs)
    external = (*model.outputs, *(f"{y}_reference" for y in regulated), *others)
    parts = (
        estimator_form,
        integrators.renamed({y: f"{y}_measured" for y in regulated}),
        _feedback(gain, estimator_form, integrators),
    )
    wires = {f"{y}_measured": {y: 1.0} for y in regulated}
    compensator = interconnect.connect(parts, external, gain.inputs, wires)
    return Controller(gain, estimator, compensator, _loop(model, compensator, others))


def _feedback(gain: lqr.Gain, estimator_form: StateSpace, integrators: StateSpace) -> StateSpace:
    """Return u = K (x^, q) as a static model."""
    names = tuple(x if x in integrators.states else f"{x}_estimate" for x in gain.states)
    m, n = gain.K.shape
    units = {**estimator_form.units, **integrators.units}
    no_states = (np.zeros((0, 0)), np.zeros((0, n)), np.zeros((m, 0)))
    return StateSpace(*no_states, gain.K, (), names, gain.inputs, gain.time, units)


def _loop(model: StateSpace, compensator: StateSpace, others: Sequence[str]) -> StateSpace:
    """Return the compensator around the plant with noise on its states and outputs."""
    n, p = model.C.T.shape
    on_states = tuple(f"{name}_disturbance" for name in model.states)
    on_outputs = tuple(f"{name}_noise" for name in model.outputs)
    known = tuple(name for name in compensator.inputs if name not in model.outputs)
    D = np.hstack([model.D, np.zeros((p, n))])
    units = {**model.units, **{f"{y}_noise": model.unit(y) for y in model.outputs if y in model.units}}
    plant = replace(model, B=np.hstack([model.B, np.eye(n)]), D=D, inputs=(*model.inputs, *on_states))
    wires = {f"{name}_measured": {name: 1.0} for name in others}
    wires |= {y: {y: 1.0, f"{y}_noise": 1.0} for y in model.outputs}
    parts = (plant, compensator.renamed({name: f"{name}_measured" for name in others}))
    outputs = (*model.outputs, *compensator.outputs)
    joined = interconnect.connect(parts, (*on_states, *on_outputs, *known), outputs, wires)
    return replace(joined, units={**units, **joined.units})


@arguments.checked
def integrals(gain: lqr.Gain, model: StateSpace) -> tuple[str, ...]:
    """Return the outputs of a model whose integrals are among the gain's states.

    Raises SignalError when the other states or the inputs are not the model's.
    """
    extra = tuple(x for x in gain.states if x not in model.states)
    outputs = tuple(x.removesuffix(INTEGRAL) for x in extra)
    missing = [x for x in model.states if x not in gain.states]
    missing += [x for x, y in zip(extra, outputs, strict=True) if y == x or y not in model.outputs]
    inputs = [u for u in gain.inputs if u not in model.inputs]
    if inputs and not missing:
        j = gain.inputs.index(inputs[0])
        raise SignalError(
            f"the input '{inputs[0]}' is not both in the gain and in the estimator's model, which has "
            f"{', '.join(model.inputs) or 'no inputs'}: if the G of the estimator names it, it counts as noise alone; "
            f"give its column of B instead, `G=B[:, [{j}]]`, and it stays an input; otherwise design the gain for that "
            "model"
        )
    if missing:
        raise SignalError(
            f"'{missing[0]}' is not both in the gain and in the estimator's model: design the gain for that model, or "
            "for `lqr.with_integrators` of it"
        )
    return outputs


def _integrators(model: StateSpace, outputs: Sequence[str]) -> StateSpace:
    """Return q' = y - r, or q+ = q + T (y - r), for some outputs, with names and units as `lqr.with_integrators`."""
    references = tuple(f"{y}_reference" for y in outputs)
    sums = interconnect.integrals(model, {f"{y}{INTEGRAL}": y for y in outputs})
    units = dict(sums.units) | {r: model.unit(y) for y, r in zip(outputs, references, strict=True) if y in model.units}
    D = np.zeros((len(outputs), 2 * len(outputs)))
    return replace(sums, B=np.hstack([sums.B, -sums.B]), D=D, inputs=(*outputs, *references), units=units)


ENDS = ("_estimate", "_predicted")
RANK_TOLERANCE = 1e-11  # of the largest singular value, rows and columns scaled: a smaller one is rounding error


@dataclass(frozen=True, eq=False)
class Start:
    """The initial state x = a + G u at the first sample: a (n,) and G (n, m)."""

    a: Array
    G: Array


@arguments.checked
def from_measurement(
    estimator: System,
    plant: System,
    measured: Sequence[str] | None = None,
    *,
    values: Mapping[str, float] | None = None,
    deviations: Mapping[str, float] | None = None,
) -> Start:
    """Return the initial state of a sampled estimator, or of a controller that contains one, from a first measurement.

    The estimates are its states ``<state>_estimate`` or ``<state>_predicted``, for each state of the plant; its other
    states start at 0. `measured` names the plant's outputs to start from, by default all that the estimator takes.
    `values` {state: x_0} are 0 and `deviations` {state: d} are 1 where left out, both in the states' units. Give
    deviations where an output is a sum of states with different units.

    Raises SignalError for unknown names, a number that is not finite or a deviation below 0; TimingError for different
    times; ModelError when C diag(d) does not have full row rank.
    """
    model, whole = of(estimator), of(plant)
    common(model.time, whole.time)
    rows = _estimate_rows(model, whole)
    outputs = _measured_outputs(model, whole, measured)
    part = whole.select(outputs, whole.inputs)
    x_0 = _state_values("value", values, whole.states, 0.0)
    d = _state_values("deviation", deviations, whole.states, 1.0)
    if (d < 0).any():
        raise SignalError(
            f"the deviation of '{whole.states[int(np.argmin(d))]}' at the start is below 0: give 0 or more"
        )
    _require_independent(part, d)
    start = precise.round_correctly(lambda: _start_map(part, x_0, d), "the start of the estimator")
    columns = _input_columns(model, part)
    a, G = np.zeros(len(model.states)), np.zeros((len(model.states), len(model.inputs)))
    for row, i in rows.items():
        a[row] = start[i, 0]
        G[row, [column for column, _ in columns]] = start[i, [1 + source for _, source in columns]]
    return Start(readonly(a), readonly(G))


def _estimate_rows(model: StateSpace, plant: StateSpace) -> dict[int, int]:
    """Return {index of an estimate among the estimator's states: index of its state in the plant}."""
    places = {f"{x}{end}": i for i, x in enumerate(plant.states) for end in ENDS}
    rows = {row: places[name] for row, name in enumerate(model.states) if name in places}
    if missing := [x for i, x in enumerate(plant.states) if i not in rows.values()]:
        raise SignalError(
            f"the estimator's states are {', '.join(model.states) or 'none'}: '{missing[0]}_estimate' or "
            f"'{missing[0]}_predicted' is missing; give an estimator of all states of the plant"
        )
    return rows


def _measured_outputs(model: StateSpace, plant: StateSpace, measured: Sequence[str] | None) -> tuple[str, ...]:
    taken = tuple(y for y in plant.outputs if y in model.inputs)
    outputs = taken if measured is None else arguments.as_name_list("measured outputs", measured)
    if unknown := [y for y in outputs if y not in taken]:
        raise SignalError(f"'{unknown[0]}' is not an output of the plant that the estimator takes: {', '.join(taken)}")
    if not outputs:
        raise SignalError(
            f"the estimator takes {', '.join(model.inputs) or 'nothing'}, none of which is an output of the plant "
            f"({', '.join(plant.outputs)}): it cannot start from a measurement"
        )
    return outputs


def _input_columns(model: StateSpace, part: StateSpace) -> list[tuple[int, int]]:
    """Return (index among the estimator's inputs, index in (y, u) of the plant) for each signal."""
    places = [(model.inputs.index(y), k) for k, y in enumerate(part.outputs)]
    for k, u in enumerate(part.inputs, len(part.outputs)):
        names = [name for name in (u, f"{u}_limited") if name in model.inputs]
        if names:
            places.append((model.inputs.index(names[0]), k))
        elif part.D[:, k - len(part.outputs)].any():
            raise SignalError(
                f"the outputs depend directly on '{u}', which the estimator does not take: start from others"
            )
    return places


def _state_values(what: str, entries: Mapping[str, float] | None, states: Sequence[str], default: float) -> Array:
    known = {} if entries is None else entries
    if not isinstance(known, Mapping) or [name for name in known if name not in states]:
        raise SignalError(f"the start has the {what}s {entries!r}: give {{state: {what}}} for {', '.join(states)}")
    numbers = arguments.real(f"{what}s at the start", [known.get(x, default) for x in states])
    if numbers.shape != (len(states),) or not np.isfinite(numbers).all():
        raise SignalError(f"the start has the {what}s {entries!r}: give finite numbers")
    return numbers


def _require_independent(part: StateSpace, d: Array) -> None:
    """Raise ModelError when C diag(d) has no right inverse, in any units."""
    values = np.linalg.svd(equilibrated(part.C * d)[0], compute_uv=False)
    if len(part.outputs) > len(part.states) or values[-1] <= RANK_TOLERANCE * values[0]:
        raise ModelError(
            f"the outputs {', '.join(part.outputs)} are linearly dependent in the states that may change: no "
            "initial state explains them all; start from fewer outputs in `measured`, or give more states a "
            "deviation above 0"
        )


def _start_map(part: StateSpace, x_0: Array, d: Array) -> flint.arb_mat:
    """Return [(I - G C) x_0, G, -G D] (n, 1 + p + m) in balls."""
    C, E = precise.matrix(part.C), precise.matrix(np.diag(d))
    shown = C * E
    G = E * (shown * shown.transpose()).solve(shown).transpose()
    start = precise.matrix(x_0[:, None])
    parts = [start - G * (C * start), G]
    parts += [-(G * precise.matrix(part.D))] if part.D.size else []
    return flint.arb_mat([[M[i, j] for M in parts for j in range(M.ncols())] for i in range(len(x_0))])
