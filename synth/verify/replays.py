"""Recorded inputs of a closed loop, repeated by the witnesses of a step from where the compiled C was.

    c64         runs from `init` to the end, and gives the state in which each part of PART samples begins
    casadi      runs from `init` to the end as well, so what would add up over a long run shows
    reference   begins each part in the state of the C; all parts of all runs advance side by side

The reference thus computes each step, and a deviation has PART samples to add up. Its states after each part are
compared with those in which the next part begins.

Bit-exact comparison of emitted C on an emulated Cortex-M with the same C on the host.

    unicorn    every step from the recorded state x_k: outputs, fault word and x_{k+1}; by induction the replay from
               `init` then equals that of the host
    QEMU       the replay itself, on an M-class core with start-up code: outputs, fault words and the last state

Contraction is off. With contraction the last bits depend on the compiler; `drift` measures how far a replay from `init`
then deviates from the host. QEMU and arm-none-eabi-gcc are used if they are installed.
"""

import shutil
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from synth.check import Check
from synth.emit.write import EmittedCode
from synth.errors import DesignError
from synth.execute import cross, host, image, qemu, target
from synth.verify import agree, steps
from synth.verify.agree import CasadiWitness, Columns, StepResults, Witness
from synth.verify.steps import Steps

TargetColumns = Mapping[str, NDArray[Any]]
SCALARS = {"cortex-m4f": "float32", "cortex-m7": "float64"}


@dataclass(frozen=True)
class Drift:
    """Deviation of a replay with contraction from the host: worst |i' - i| / max(floor, |i|), its output and step.

    `faults` counts the samples with different fault words.
    """

    core: str
    compiler: str
    steps: int
    worst: float
    output: str
    step: int
    faults: int


@dataclass(frozen=True, eq=False)
class _HostResults:
    """Results of the host: the steps, and outputs, fault words and states (N,) after each."""

    sequence: Steps
    after: host.Batch


def verify(
    emitted: EmittedCode, inputs: TargetColumns, core: str, progress: Callable[[str], None]
) -> tuple[Check, ...]:
    """Replay inputs (N,) on the core by every installed compiler and emulator; count values that differ in any bit.

    Raises DesignError when the core has no hardware for the scalar type, CompileError when no cross compiler is
    installed or the C is refused, SignalError for invalid inputs.
    """
    scalar = emitted.manifest["scalar"]
    cross.find_core(core)
    if SCALARS[core] != scalar:
        raise DesignError(f"{core}: found C in {scalar}, need {SCALARS[core]}, which it has hardware for: emit that")
    controller = host.load(emitted.files, emitted.manifest)
    sequence = steps.record(controller, "replay", inputs)
    expected = _HostResults(sequence, steps.evaluate(controller, sequence))
    checks: list[Check] = []
    for compiler in cross.available():
        if scalar == "float32":
            checks.append(_double_symbols_check(emitted, compiler))
        progress(f"{len(sequence)} steps on {core}, {compiler}, unicorn")
        emulated = target.load(emitted.files, emitted.manifest, core, compiler)
        checks += _identity_checks(f"{core}, {compiler}, unicorn", expected, _step_each(emulated, sequence))
    if shutil.which("qemu-system-arm") and "gcc" in cross.available():
        progress(f"{len(sequence)} steps on {core}, gcc, QEMU")
        board = qemu.load(emitted.files, emitted.manifest, core)
        checks += _identity_checks(f"{core}, gcc, QEMU", expected, _as_batch(board.replay(inputs)))
    return tuple(checks)


def drift(
    emitted: EmittedCode, inputs: TargetColumns, core: str, floor: agree.Floor = None, compiler: str = "gcc"
) -> Drift:
    """Replay inputs (N,) with contraction and compare with the host, which computes without it.

    For outputs smaller than their floor, see `agree.floors`, the difference is relative to the floor.

    Raises CompileError when the compiler is not installed, SignalError for invalid inputs or an invalid floor.
    """
    expected = host.load(emitted.files, emitted.manifest).replay(inputs)
    contracted = target.load(emitted.files, emitted.manifest, core, compiler, cross.CONTRACTED).replay(inputs)
    fields = emitted.manifest["structs"]["output"]["fields"]
    least = agree.floors(floor, {f["name"]: (f["low"], f["high"]) for f in fields})
    gaps = {}
    for name, i in expected.outputs.items():
        value = i.astype(np.float64)
        gaps[name] = np.abs(contracted.outputs[name].astype(np.float64) - value) / np.maximum(
            least[name], np.abs(value)
        )
    worst = max(gaps, key=lambda name: float(gaps[name].max()))
    step = int(np.argmax(gaps[worst]))
    faults_differ = int(np.count_nonzero(contracted.faults != expected.faults))
    return Drift(core, compiler, len(expected.faults), float(gaps[worst][step]), worst, step, faults_differ)


def _double_symbols_check(emitted: EmittedCode, compiler: str) -> Check:
    symbols = cross.double_symbols(host.code(emitted.files), compiler)
    about = f"undefined symbols of double arithmetic in the object: {', '.join(symbols) or 'none'}"
    return Check(f"cortex-m4f, {compiler}: double-precision symbols", len(symbols), 0, "symbols", about)


def _step_each(emulated: target.Target, sequence: Steps) -> host.Batch:
    """Take one step on the core from each state of the sequence."""
    machine = image.boot(emulated.program, emulated.core, emulated.covered)
    n = len(sequence)
    states, inputs, outputs = np.ascontiguousarray(sequence.states), sequence.inputs, np.zeros(n, emulated.outputs)
    at = [machine.place(records) for records in (states, inputs, outputs)]
    sizes = [records.itemsize for records in (states, inputs, outputs)]
    arguments = np.array(at) + np.arange(n)[:, np.newaxis] * np.array(sizes)
    faults = machine.calls(emulated.manifest["functions"]["step"], arguments)
    after, output_records = (
        np.frombuffer(machine.read(address, records.nbytes), records.dtype)
        for address, records in ((at[0], states), (at[2], outputs))
    )
    return host.Batch(host.columns(output_records), faults, after)


def _as_batch(replay: host.Replay) -> host.Batch:
    return host.Batch(replay.outputs, replay.faults, replay.state.reshape(1))


def _identity_checks(where: str, expected: _HostResults, actual: host.Batch) -> Sequence[Check]:
    """Count output samples, states and fault words that differ from the host in any bit."""
    states_after = expected.after.states[-len(actual.states) :]  # a replay gives only the last state
    outputs = {n: _count_differing(v, actual.outputs[n]) for n, v in expected.after.outputs.items()}
    states = {n: _count_differing(states_after[n], actual.states[n]) for n in states_after.dtype.names or ()}
    faults = _count_differing(expected.after.faults, actual.faults)
    steps = len(expected.sequence)
    return (
        Check(f"{where}: outputs that differ", sum(outputs.values()), 0, "values", _summary(steps, "steps", outputs)),
        Check(
            f"{where}: states that differ",
            sum(states.values()),
            0,
            "values",
            _summary(len(states_after), "states", states),
        ),
        Check(f"{where}: fault words that differ", faults, 0, "steps", f"{steps} steps"),
    )


def _count_differing(expected: NDArray[Any], actual: NDArray[Any]) -> int:
    a, b = (np.frombuffer(v.tobytes(), np.uint8).reshape(len(v), -1) for v in (expected, actual))
    return int(np.count_nonzero((a != b).any(axis=1)))


def _summary(n: int, kind: str, counts: Mapping[str, int]) -> str:
    differing = [f"{name} {count} times" for name, count in counts.items() if count]
    return "; ".join([f"{len(counts)} members of {n} {kind}", *differing[:3]])


PART = 1000  # samples that a reference computes one after the other: NumPy takes as long for one part as for many


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
