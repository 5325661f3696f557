"""Bit-exact comparison of emitted C on an emulated Cortex-M with the same C on the host.

    unicorn    every step from the recorded state x_k: outputs, fault word and x_{k+1}; by induction the replay from
               `init` then equals that of the host
    QEMU       the replay itself, on an M-class core with start-up code: outputs, fault words and the last state

Contraction is off. With contraction the last bits depend on the compiler; `drift` measures how far a replay from `init`
then deviates from the host. QEMU and arm-none-eabi-gcc are used if they are installed.
"""

import shutil
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from synth.check import Check
from synth.emit.write import EmittedCode
from synth.errors import DesignError
from synth.execute import cross, host, image, qemu, target
from synth.verify import agree, steps
from synth.verify.steps import Steps

Columns = Mapping[str, NDArray[Any]]
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


def verify(emitted: EmittedCode, inputs: Columns, core: str, progress: Callable[[str], None]) -> tuple[Check, ...]:
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


def drift(emitted: EmittedCode, inputs: Columns, core: str, floor: agree.Floor = None, compiler: str = "gcc") -> Drift:
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
