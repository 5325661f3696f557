"""Initial state of an estimator from its first measurement, which avoids the transient from 0.

    x^[0] = x_0 + G (y[0] - C x_0 - D u[0]),      G = E C' (C E C')^-1,      E = diag(d)^2

x_0 are prior values of the states and d their standard deviations. Of all x^ that reproduce the measurement, it is the
nearest to x_0 relative to d. An unobserved state, or one with the deviation 0, starts at its prior value. x^[0] is the
limit of the first correction of a Kalman filter (`square_root_kalman.update`) for an initial covariance s E, s large. G
is computed in ball arithmetic and rounded once.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import flint
import numpy as np

from synth import arguments
from synth.analyse.numerics import precise
from synth.analyse.numerics.equilibrate import equilibrated
from synth.errors import ModelError, SignalError
from synth.statespace import Array, StateSpace, System, of, readonly
from synth.timing import common

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
