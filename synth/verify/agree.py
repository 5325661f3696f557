"""Back-to-back comparison of independent implementations of one step (x, u) -> (x', y, faults).

Each implementation is a witness: it serves as the oracle for the others.

    reference   NumPy, written from the equations of the paper, with independently computed gains
    casadi      evaluation of the Block by CasADi
    casadi_c    C of the Block by CasADi's code generator, double precision
    c64, c32    the emitted C in double and in single precision

The difference of an output v from r is |v - r| / max(floor, |r|). The floor is in the unit of the output: one number
for all outputs, one for each output by name, or by default the largest magnitude in the declared range. The difference
of next states is relative to the width of the declared range of the state. Every witness receives the same bits:
samples are generated once, in the scalar type of the less precise witness.
"""

import inspect
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from synth import arguments, show
from synth.base import column_maps
from synth.block import Block
from synth.emit.c import c_text
from synth.errors import SignalError, design_lines
from synth.execute import compile as host_compiler
from synth.execute import host

Columns = Mapping[str, NDArray[Any]]
Floor = float | Mapping[str, float] | None
CHUNK = 256  # samples per call of CasADi's mapaccum: it takes longer to make for more of them, and saves no time


@dataclass(frozen=True)
class StepResults:
    """N steps: outputs and next states as columns (N,) by name, fault words (N,)."""

    outputs: Columns
    states: Columns
    faults: NDArray[np.uint32]


@dataclass(frozen=True)
class Agreement:
    """Difference of `second` from `first` over `samples` steps: the worst output difference, its signal and sample.

    `state_worst` is the worst difference of a next state, and `state` its name. `ulps` is the worst output difference
    in units in the last place of the scalar type of `second`; `faults_differ` counts samples with different fault
    words. `authority_worst` is the worst difference of next states relative to declared magnitudes, where there are.
    `disagreement` shows where the two part, once a difference is too large (`verify.disagreement`).
    """

    first: str
    second: str
    what: str
    samples: int
    worst: float
    signal: str
    sample: int
    ulps: float
    faults_differ: int
    state_worst: float
    state: str
    authority_worst: float | None = None
    disagreement: show.Shown | None = None


Witness = Callable[[Columns, Columns], StepResults]


def compare(
    what: str,
    first: tuple[str, StepResults],
    second: tuple[str, StepResults],
    floor: Floor,
    block: Block,
    scalar: type[np.floating] = np.float64,
    authority: Mapping[str, float] | None = None,
) -> Agreement:
    """Compare outputs, fault words and next states of two witnesses of the same N steps of a Block.

    The difference of a NaN is infinite. A recorded run has the states after its last step only. That of a next state is
    relative to max(authority, |x|) as well, for states with an `authority`: a magnitude far below their bounds.

    Raises SignalError for no sample, and as `floors`.
    """
    (name, r), (other, v) = first, second
    if not len(r.faults):
        raise SignalError(f"{what}: there is no sample in which to compare {name} with {other}: give at least one")
    sizes = _scales(r, floor, block)
    outputs, states = differences(r, v, floor, block)
    signal, sample, worst = _worst(outputs)
    state, _, state_worst = _worst(states)
    gaps = {n: _absolute_difference(r.outputs[n], v.outputs[n]) for n in sizes}
    ulps = max(float(np.max(gap / np.spacing(sizes[n].astype(scalar)).astype(np.float64))) for n, gap in gaps.items())
    faults_differ = int(np.count_nonzero(np.asarray(r.faults) != np.asarray(v.faults)))
    of_authority = [
        float(np.max(_absolute_difference(r.states[n], v.states[n]) / np.maximum(np.abs(r.states[n]), size)))
        for n, size in (authority or {}).items()
    ]
    return Agreement(
        name, other, what, len(r.faults), worst, signal, sample, ulps, faults_differ, state_worst, state,
        max(of_authority, default=None),
    )  # fmt: skip


def differences(
    first: StepResults, second: StepResults, floor: Floor, block: Block
) -> tuple[dict[str, NDArray[np.float64]], dict[str, NDArray[np.float64]]]:
    """Return the differences in each step of outputs and of next states (N,) by name, infinite for NaN.

    Raises SignalError as `floors`.
    """
    sizes, widths = _scales(first, floor, block), {s.name: s.signal.high - s.signal.low for s in block.states}
    outputs = {n: _absolute_difference(first.outputs[n], second.outputs[n]) / size for n, size in sizes.items()}
    return outputs, {n: _absolute_difference(first.states[n], second.states[n]) / width for n, width in widths.items()}


def _scales(results: StepResults, floor: Floor, block: Block) -> dict[str, NDArray[np.float64]]:
    """Return the scale (N,) of the relative difference of each output."""
    least = floors(floor, {s.name: (s.low, s.high) for s in block.outputs})
    return {n: np.maximum(least[n], np.abs(np.asarray(results.outputs[n], dtype=np.float64))) for n in least}


def floors(floor: Floor, ranges: Mapping[str, tuple[float, float]]) -> dict[str, float]:
    """Return the floor of each output; the default is the largest magnitude in its range (low, high).

    Raises SignalError for a floor of an unknown output, or one that is not finite and positive.
    """
    by_output = floor if isinstance(floor, Mapping) else {} if floor is None else dict.fromkeys(ranges, floor)
    if unknown := [n for n in by_output if n not in ranges]:
        raise SignalError(
            f"floor of '{unknown[0]}': it is not one of the outputs {', '.join(ranges)}: correct the name"
        )
    least = {n: by_output.get(n, max(abs(low), abs(high)) or 1.0) for n, (low, high) in ranges.items()}
    for name, value in least.items():
        if not 0 < value < np.inf:
            raise SignalError(f"floor of '{name}' is {value}: give a finite positive number in the output's unit")
    return least


def _absolute_difference(expected: Any, actual: Any) -> NDArray[np.float64]:
    with np.errstate(invalid="ignore"):
        gap = np.abs(np.asarray(actual, dtype=np.float64) - np.asarray(expected, dtype=np.float64))
    return np.atleast_1d(np.where(np.isfinite(gap), gap, np.inf))


def _worst(differences: Mapping[str, NDArray[np.float64]]) -> tuple[str, int, float]:
    """Return the name, the sample and the size of the largest difference."""
    name = max(differences, key=lambda n: float(np.max(differences[n])), default="")
    if not name:
        return "", 0, 0.0
    k = int(np.argmax(differences[name]))
    return name, k, float(differences[name][k])


def emitted_c(controller: host.Controller) -> Witness:
    """Return emitted C as a witness: one step from each of N states."""

    def step(states: Columns, inputs: Columns) -> StepResults:
        n = len(next(iter(inputs.values())))
        records = np.zeros(n, controller.state)
        fillers = {n for n in states if n.endswith("reserved")} - {*(controller.state.names or ())}  # of the other type
        for name in states.keys() - fillers:
            records[name] = states[name]
        batch = controller.batch(records, inputs)
        return StepResults(batch.outputs, host.columns(batch.states), batch.faults)

    return step


def casadi(block: Block) -> Witness:
    """Return CasADi's evaluation of the Block as a witness."""
    return CasadiWitness(block, _with_fault_word(block))


def casadi_own_c(block: Block, flags: Sequence[str] = ()) -> Witness:
    """Return CasADi's own C of the Block, compiled here, as a witness."""
    f = _with_fault_word(block)
    library = host_compiler.shared_library(c_text.functions([f], f"{block.name}_casadi"), flags)
    return CasadiWitness(block, ca.external(f.name(), str(library)))


def reference(step: Callable[..., tuple[Columns, Columns, Any]], block: Block | None = None) -> Witness:
    """Return a NumPy step(state, inputs) -> (state', outputs, faults) as a witness.

    A step with a third parameter `bounds` reads the declared ends (low, high) of each state of the `block` by name.
    Constants that may change are among the states, and stay as they are.

    Calling it raises SignalError for a name that the step does not find, and for columns of another shape.
    """

    if block is not None and "bounds" in inspect.signature(step).parameters:
        step = partial(step, bounds={s.name: (s.signal.low, s.signal.high) for s in block.states})

    def witness(states: Columns, inputs: Columns) -> StepResults:
        shape = np.shape(next(iter((inputs or states).values())))
        try:
            results: Any = step(states, inputs)
        except KeyError as error:
            raise SignalError(
                f"the reference looks up {error} and does not find it: the states are {', '.join(states)}, the inputs "
                f"{', '.join(inputs)}"
            ) from error
        except ValueError as error:
            place = next((line for line in reversed(design_lines(error)) if line), "a line of its own")
            raise SignalError(
                f"the reference stops at {place}: {error}: states and inputs have the shape {shape}, compute in it"
            ) from error
        held = {n: states[n] for n in (block.tunable if block else ())}
        return _step_results((held | {**results[0]}, *results[1:]) if held else results, shape)

    return witness


def _step_results(results: Any, shape: tuple[int, ...]) -> StepResults:
    """Return what a reference has returned; raise SignalError for no triple and for columns of another shape."""
    if not (isinstance(results, tuple) and len(results) == 3 and all(isinstance(r, Mapping) for r in results[:2])):
        raise SignalError(
            f"the reference returns {arguments.describe(results)}: return three values, the next states by name, the "
            "outputs by name and the fault words"
        )
    after, outputs, faults = results
    columns = {f"state '{n}'": v for n, v in after.items()} | {f"output '{n}'": v for n, v in outputs.items()}
    for what, column in columns.items():
        if np.shape(column) != shape:
            raise SignalError(
                f"the reference returns {what} of shape {np.shape(column)}, needed is {shape}: compute it for each step"
            )
    words = np.asarray(faults, dtype=np.uint32)
    if words.shape not in ((), shape):
        raise SignalError(f"the reference returns fault words of shape {words.shape}, needed is {shape}")
    return StepResults(outputs, after, np.array(np.broadcast_to(words, shape)))


def casadi_of_constants(block: Block) -> Callable[[Mapping[str, float]], Witness]:
    """Return CasADi's evaluation of the Block as a witness, for values of its constants by name.

    The expressions are prepared once, so another witness with other values costs its evaluation alone.
    """
    x, u, k = (
        ca.vcat([block.symbol[s.name] for s in signals]) for signals in (block.states, block.inputs, block.constants)
    )
    f = ca.Function(f"{block.name}_of_constants", [x, u, k], ca.cse(_expressions(block)))
    evaluation = CasadiWitness(block, f)

    def witness(values: Mapping[str, float]) -> Witness:
        column = np.array([values.get(c.name, c.value) for c in block.constants])
        return lambda states, inputs: evaluation.at(states, inputs, column)

    return witness


def _with_fault_word(block: Block) -> ca.Function:
    """Return (x, u) -> (x', y, fault word)."""
    x, u = (ca.vcat([block.symbol[s.name] for s in signals]) for signals in (block.states, block.inputs))
    symbols, values = [block.symbol[c.name] for c in block.constants], [ca.SX(c.value) for c in block.constants]
    expressions = _expressions(block)
    expressions = ca.substitute(expressions, symbols, values) if symbols else expressions
    return ca.Function(f"{block.name}_witness", [x, u], ca.cse(expressions))


def _expressions(block: Block) -> list[ca.SX]:
    """Return next states, outputs and fault word of a Block, whose constants are symbols."""
    next = ca.vcat([block.next[s.name] for s in block.states])
    y = ca.vcat([block.output[s.name] for s in block.outputs])
    word = sum((2.0**b.bit * ca.if_else(block.output[b.output], 1, 0) for b in block.faults), start=ca.SX(0))
    return [ca.densify(each) for each in (next, y, word)]


@dataclass(frozen=True, eq=False)
class CasadiWitness:
    """A CasADi function (x, u) -> (x', y, fault word) of a Block as a witness."""

    block: Block
    function: ca.Function

    def __call__(self, states: Columns, inputs: Columns) -> StepResults:
        """Return one step from each of N states."""
        return self.at(states, inputs)

    def at(self, states: Columns, inputs: Columns, *others: NDArray[np.float64]) -> StepResults:
        """Return one step from each of N states, with other arguments of the function, one for all."""
        return self._unstack(*column_maps.map_columns(self.function, *self._stack(states, inputs), *others))

    def run(self, states: Columns, inputs: Columns) -> StepResults:
        """Return N consecutive steps from one state; CasADi's mapaccum runs the loop, which avoids a call per step."""
        x, u = self._stack(states, inputs)
        x, recorded = x.reshape(-1, 1), []
        for first in range(0, u.shape[1], CHUNK):
            part = u[:, first : first + CHUNK]
            after, y, word = column_maps.chain_columns(self.function, x, part)
            x = after[:, -1:]
            recorded.append((y, word))
        outputs, words = (np.hstack(rows) for rows in zip(*recorded, strict=True))
        return self._unstack(x, outputs, words)

    def _stack(self, states: Columns, inputs: Columns) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        x = [np.asarray(states[s.name], dtype=np.float64) for s in self.block.states]
        u = [np.asarray(inputs[s.name], dtype=np.float64) for s in self.block.inputs]
        return np.array(x), np.array(u)

    def _unstack(self, after: NDArray[np.float64], y: NDArray[np.float64], word: NDArray[np.float64]) -> StepResults:
        outputs = {s.name: row for s, row in zip(self.block.outputs, y, strict=True)}
        states = {s.name: row for s, row in zip(self.block.states, after, strict=True)}
        return StepResults(outputs, states, word[0].astype(np.uint32))
