"""Recorded inputs of a closed loop, repeated by the witnesses of a step from where the compiled C was.

    c64         runs from `init` to the end, and gives the state in which each part of PART samples begins
    casadi      runs from `init` to the end as well, so what would add up over a long run shows
    reference   begins each part in the state of the C; all parts of all runs advance side by side

The reference thus computes each step, and a deviation has PART samples to add up. Its states after each part are
compared with those in which the next part begins.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any

import numpy as np

from synth.execute import host
from synth.verify.agree import CasadiWitness, Columns, StepResults, Witness

PART = 5000  # samples that a reference computes one after the other


@dataclass(frozen=True)
class Part:
    """Consecutive steps of a replay: the state by name in which they begin, their inputs (N,), and their results."""

    start: Mapping[str, float]
    inputs: Columns
    steps: StepResults


def run(witness: Witness, states: Mapping[str, float], inputs: Columns) -> StepResults:
    """Run a witness from one state over N consecutive recorded inputs, (N,) or (N, copies), step by step."""
    n, *copies = shape = next(iter(inputs.values())).shape
    current: Columns = {name: np.full(copies or 1, value) for name, value in states.items()}
    if isinstance(witness, CasadiWitness) and not copies:
        return witness.run(current, inputs)
    columns = {name: values.reshape(n, *(copies or [1])) for name, values in inputs.items()}
    rows: list[StepResults] = []
    for k in range(n):
        stepped = witness(current, {name: values[k] for name, values in columns.items()})
        current = stepped.states
        rows.append(StepResults(stepped.outputs, {}, stepped.faults))
    outputs = {name: np.reshape([row.outputs[name] for row in rows], shape) for name in rows[0].outputs}
    return StepResults(outputs, current, np.reshape([row.faults for row in rows], shape))


def run_each(witness: Witness, starts: Sequence[Mapping[str, float]], runs: Sequence[Columns]) -> list[StepResults]:
    """Run a witness over recorded inputs (N,) of several runs, each from its own state, side by side."""
    lengths = [len(next(iter(inputs.values()))) for inputs in runs]
    order, ends = sorted(range(len(runs)), key=lambda j: -lengths[j]), sorted({0, *lengths})
    parts: list[list[StepResults]] = [[] for _ in runs]
    current: Mapping[str, Any] = {name: np.array([starts[j][name] for j in order]) for name in starts[0]}
    for first, last in pairwise(ends):
        active = [j for j in order if lengths[j] >= last]
        inputs = {name: np.stack([runs[j][name][first:last] for j in active], axis=1) for name in runs[0]}
        combined = run(witness, {name: value[: len(active)] for name, value in current.items()}, inputs)
        current = combined.states
        for k, j in enumerate(active):
            parts[j].append(_select_run(combined, k))
    return [replace(_concatenate(of_run), states=of_run[-1].states) for of_run in parts]


def _select_run(combined: StepResults, k: int) -> StepResults:
    """Return one of several runs side by side."""
    outputs = {name: value[:, k] for name, value in combined.outputs.items()}
    return StepResults(
        outputs, {name: value[k : k + 1] for name, value in combined.states.items()}, combined.faults[:, k]
    )


def _concatenate(parts: Sequence[StepResults]) -> StepResults:
    """Return consecutive parts of a run as one, with the states after each part."""
    outputs, states = (
        {name: np.concatenate([columns[name] for columns in each]) for name in each[0]}
        for each in ([part.outputs for part in parts], [part.states for part in parts])
    )
    return StepResults(outputs, states, np.concatenate([part.faults for part in parts]))


def replay(controller: host.Controller, inputs: Columns) -> StepResults:
    """Run emitted C from `init` over N consecutive recorded inputs."""
    return _run_from(controller, controller.init(), inputs)[0]


def replay_in_parts(controller: host.Controller, inputs: Columns, samples: int = PART) -> list[Part]:
    """Run emitted C from `init` over N consecutive recorded inputs; return its parts of at most `samples`."""
    parts, state = [], controller.init()
    for first in range(0, host.length(inputs), samples):
        recorded = {name: values[first : first + samples] for name, values in inputs.items()}
        start = {name: float(state[name]) for name in state.dtype.names or ()}
        steps, state = _run_from(controller, state, recorded)
        parts.append(Part(start, recorded, steps))
    return parts


def repeat(witness: Witness, runs: Sequence[Sequence[Part]]) -> list[tuple[StepResults, StepResults]]:
    """Return each replayed run computed by a witness, beside what the C computed, with the states that are compared.

    CasADi runs from `init` to the end. A witness that takes single steps begins each part in the state of the C, so all
    parts of all runs advance side by side; the states after each part are compared.
    """
    if isinstance(witness, CasadiWitness):
        return [_repeat_whole(witness, run) for run in runs]
    parts = [part for run in runs for part in run]
    stepped = iter(run_each(witness, [part.start for part in parts], [part.inputs for part in parts]))
    return [(_concatenate([next(stepped) for _ in run]), _concatenate([part.steps for part in run])) for run in runs]


def _repeat_whole(witness: CasadiWitness, parts: Sequence[Part]) -> tuple[StepResults, StepResults]:
    inputs = {name: np.concatenate([part.inputs[name] for part in parts]) for name in parts[0].inputs}
    c64 = _concatenate([part.steps for part in parts])
    return run(witness, parts[0].start, inputs), replace(c64, states=parts[-1].steps.states)


def _run_from(controller: host.Controller, start: host.Records, inputs: Columns) -> tuple[StepResults, host.Records]:
    replay = controller.replay(inputs, start)
    state = {name: np.atleast_1d(replay.state[name]) for name in replay.state.dtype.names or ()}
    return StepResults(replay.outputs, state, replay.faults), replay.state
