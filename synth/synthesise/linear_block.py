"""A sampled linear model as a Block: x+ = A x + B u, y = C x + D u.

An entry of 0 costs nothing and one of 1 or -1 no multiplication. Every other entry is a Constant, ``<output>_from_<u>``
or ``next_<state>_from_<u>``, so that emission rounds it once and the C shows where it belongs.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import casadi as ca
import numpy as np

from synth import arguments
from synth.block import Block, Constant, Exprs, State, Step, build
from synth.errors import SignalError
from synth.signals import Signal, names
from synth.statespace import Array, System, of
from synth.timing import Discrete, period


@dataclass(frozen=True, eq=False)
class _Row:
    """What one row of [A, B] or [C, D] computes, `values` (n + m,) over states and inputs."""

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
) -> Block:
    """Return the step of a sampled model whose signals are given in its order and by its names.

    States start at 0 and are limited to their ranges.

    Raises TimingError for a continuous model; SignalError when a signal is not the model's, or a name stands twice.
    """
    model = of(system)
    time = Discrete(period(model.time))
    for kind, given in (("inputs", inputs), ("outputs", outputs), ("states", states)):
        _require_same(name, kind, names(given), getattr(model, kind))
    columns = (*states, *inputs)
    next = [_Row(f"next_{s.name}", s, v) for s, v in zip(states, np.hstack([model.A, model.B]), strict=True)]
    out = [_Row(s.name, s, v) for s, v in zip(outputs, np.hstack([model.C, model.D]), strict=True)]
    constants = [
        Constant(_name(row, c), float(v), _unit(row.signal, c), f"{tag}: {row.label} from {c.name}")
        for row in (*next, *out)
        for c, v in zip(columns, row.values, strict=True)
        if v not in (0, 1, -1)
    ]

    def law(u: Exprs, x: Exprs, k: Exprs) -> Step:
        now = {**x, **u}

        def total(row: _Row) -> ca.SX:
            terms = [(c, float(v)) for c, v in zip(columns, row.values, strict=True) if v]
            return sum((k.get(_name(row, c), v) * now[c.name] for c, v in terms), start=ca.SX(0))

        return Step({row.signal.name: total(row) for row in out}, {row.signal.name: total(row) for row in next})

    kept = [State(s, 0.0) for s in states]
    return build(name, time, law, inputs=inputs, outputs=outputs, states=kept, constants=constants, tag=tag)


def _require_same(name: str, kind: str, given: Sequence[str], known: Sequence[str]) -> None:
    if tuple(given) != tuple(known):
        raise SignalError(
            f"block '{name}': the {kind} given are {', '.join(given) or 'none'}, but the model's are "
            f"{', '.join(known) or 'none'}: give one signal for each, in this order"
        )


def _name(row: _Row, column: Signal) -> str:
    return f"{row.label}_from_{column.name}"


def _unit(row: Signal, column: Signal) -> str:
    """Return the unit of the row's signal over the column's."""
    return f"{row.unit}/" + column.unit.translate({ord(" "): "/", ord("/"): " "})
