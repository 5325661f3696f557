"""Discrete state-space model as a Block (Simulink "Discrete State-Space"): x+ = A x + B u, y = C x + D u.

An entry of 0 produces no code, and an entry of 1 or -1 no multiplication. Every other entry is a Constant,
``<output>_from_<u>`` or ``next_<state>_from_<u>``: emission rounds it once, and the C shows which entry it is.

From FEWEST coefficients on, rows of [A, B] or of [C, D] that have most columns in common are dot products with the same
values (`block.dot`): the C has a loop over an array of them. It adds the columns of the array from left to right, then
a row's other entries. A sparse row stays a sum, as the loop would multiply its zeros, and so does a small matrix. On a
Cortex-M4F the LQG of 4, 8 and 24 masses (`benchmarks/chain.py`) takes 1.2, 1.2 and 1.1 times the instructions with
arrays; its flash is 0.7, 0.4 and 0.3 of that with sums, which have 444, 1600 and 13778 lines.

With a Start the state is a after init. The first step takes x = a + G u, limited to its range, with its own inputs u.
An estimate then begins at the first measurement (`lqg.from_measurement`), without a transient from 0.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import casadi as ca
import numpy as np

from synth import arguments
from synth.block import Block, Constant, Exprs, State, Step, build, clip, dot
from synth.errors import SignalError
from synth.law import label
from synth.signals import Signal, signal_names
from synth.statespace import Array, StateSpace, System, of
from synth.synthesise.observers.lqg import Start
from synth.timing import Discrete, period

FEWEST = 256  # coefficients of a table that are not 0
FILLED = 0.75  # least share of each column of a table that is not 0
STARTED = Signal("started", "1", 0, 1, "the first sample is over")


@dataclass(frozen=True, eq=False)
class _Row:
    """The signal that one row of [A, B] or [C, D] computes, and its `values` (n + m,) over states and inputs."""

    label: str
    signal: Signal
    values: Array


@arguments.checked
def block(
    name: str,
    system: System,
    *,
    inputs: Sequence[Signal],
    outputs: Sequence[Signal],
    states: Sequence[Signal] = (),
    tag: str,
    start: Start | None = None,
) -> Block:
    """Return the step of a sampled model; the signals have its names and its order.

    States are limited to their ranges. They start at 0 or, with a `start`, from the first inputs; an additional state
    ``started`` then marks that the first sample is over.

    Raises TimingError for a continuous model; SignalError when a signal is not the model's, a name is listed twice, or
    a start does not fit the model.
    """
    model = of(system)
    time = Discrete(period(model.time))
    for kind, signals in (("inputs", inputs), ("outputs", outputs), ("states", states)):
        _require_same(name, kind, signal_names(signals), getattr(model, kind))
    columns = (*states, *inputs)
    next = [_Row(f"next_{s.name}", s, v) for s, v in zip(states, np.hstack([model.A, model.B]), strict=True)]
    out = [_Row(s.name, s, v) for s, v in zip(outputs, np.hstack([model.C, model.D]), strict=True)]
    first = [] if start is None else _start_rows(name, model, start, states)
    tables = _tables(next, len(states)) | _tables(out, len(states))
    constants = [
        Constant(_name(row, c), float(v), _unit(row.signal, c), f"{tag}: {row.label} from {c.name}")
        for row in (*next, *out, *first)
        for c, v in zip(columns, row.values, strict=True)
        if v not in (0, 1, -1)
    ]

    def law(u: Exprs, x: Exprs, k: Exprs) -> Step:
        current = {**x, **u}

        def total(row: _Row, begin: ca.SX) -> ca.SX:
            common = tables.get(row.label, [])
            terms = [
                (c, float(v)) for j, (c, v) in enumerate(zip(columns, row.values, strict=True)) if v and j not in common
            ]
            factors = [k.get(_name(row, columns[j]), ca.SX(float(row.values[j]))) for j in common]
            begin = begin + dot(factors, [current[columns[j].name] for j in common]) if common else begin
            return sum((k.get(_name(row, c), v) * current[c.name] for c, v in terms), start=begin)

        initial = {row.signal.name: clip(total(row, x[row.signal.name]), row.signal) for row in first}
        current |= {name: ca.if_else(x[STARTED.name], x[name], value) for name, value in initial.items()}
        next_values = {row.signal.name: total(row, ca.SX(0)) for row in next}
        next_values |= {} if start is None else {STARTED.name: ca.SX(1)}
        label(current=current, next_values=next_values)
        return Step({row.signal.name: total(row, ca.SX(0)) for row in out}, next_values)

    after_init = np.zeros(len(states)) if start is None else start.a
    block_states = [State(s, float(v)) for s, v in zip(states, after_init, strict=True)]
    block_states += [] if start is None else [State(STARTED, 0, integer=True)]
    return build(name, time, law, inputs=inputs, outputs=outputs, states=block_states, constants=constants, tag=tag)


def _tables(rows: Sequence[_Row], n: int) -> dict[str, list[int]]:
    """Return by label of each row that becomes one of a table the columns of this table; the first n are of states.

    The rows of a table have most of the columns of the fullest one that is left. All of them depend on its inputs: a
    coefficient of 0 would count as a dependence, which may close an algebraic loop.
    """
    tables: dict[str, list[int]] = {}
    left = {row.label: row.values != 0 for row in rows if row.values.any()}
    while left:
        fullest = max(left.values(), key=np.count_nonzero)
        alike = {label: entries for label, entries in left.items() if entries[fullest].mean() >= FILLED}
        share = np.mean([*alike.values()], axis=0)
        columns = np.flatnonzero(share >= np.where(np.arange(len(share)) < n, FILLED, 1))
        if sum(entries[columns].sum() for entries in alike.values()) >= FEWEST:
            tables |= dict.fromkeys(alike, columns.tolist())
        left = {label: entries for label, entries in left.items() if label not in alike}
    return tables


def _start_rows(name: str, model: StateSpace, start: Start, states: Sequence[Signal]) -> list[_Row]:
    """Return the rows of G, over states and inputs, of the states on which the first inputs act."""
    n, m = model.B.shape
    if not isinstance(start, Start):
        raise SignalError(f"block '{name}': the start is a {type(start).__name__}: give a Start")
    if (start.a.shape, start.G.shape) != ((n,), (n, m)) or not np.isfinite([*start.a, *start.G.ravel()]).all():
        raise SignalError(
            f"block '{name}': the start is {start.a.shape} and {start.G.shape}: give finite numbers of {(n,)} and "
            f"{(n, m)}, the model's states by its inputs"
        )
    rows = [_Row(f"start_{s.name}", s, np.concatenate([np.zeros(n), g])) for s, g in zip(states, start.G, strict=True)]
    return [row for row in rows if row.values.any()]


def _require_same(name: str, kind: str, actual: Sequence[str], required: Sequence[str]) -> None:
    if tuple(actual) != tuple(required):
        raise SignalError(
            f"block '{name}': the {kind} given are {', '.join(actual) or 'none'}, but the model's are "
            f"{', '.join(required) or 'none'}: give one signal for each, in this order"
        )


def _name(row: _Row, column: Signal) -> str:
    return f"{row.label}_from_{column.name}"


def _unit(row: Signal, column: Signal) -> str:
    """Return the unit of the row's signal over the column's; `m s` over `m` is `s`."""
    if row.unit.startswith(f"{column.unit} "):
        return row.unit.removeprefix(f"{column.unit} ")
    return f"{row.unit}/" + column.unit.translate({ord(" "): "/", ord("/"): " "})
