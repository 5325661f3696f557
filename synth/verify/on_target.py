"""The emitted C as machine code of a Cortex-M against the same C on this machine, bit by bit.

    unicorn    every step from the recorded state x_k: outputs, fault word and x_{k+1}, so that by induction the
               replay from `init` is the host's
    QEMU       the replay itself, on an M-class core with start-up code: outputs, fault words and the last state

Contraction is off. With it on, the last bits are another compiler's choice: `drift` says how far a replay from `init`
goes from the host's then, as a figure. Needs the extra `target`; QEMU and arm-none-eabi-gcc serve where they are.
"""

import shutil
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from synth.check import Check
from synth.emit.write import Emitted
from synth.errors import DesignError
from synth.execute import cross, host, image, qemu, target
from synth.verify import agree, steps
from synth.verify.steps import Steps

Columns = Mapping[str, NDArray[Any]]
SCALARS = {"cortex-m4f": "float32", "cortex-m7": "float64"}


@dataclass(frozen=True)
class Drift:
    """How far a replay goes from the host's with contraction on: worst |i' - i| / max(floor, |i|), its output and step.

    `faults` counts the samples whose fault words are unlike.
    """

    core: str
    compiler: str
    steps: int
    worst: float
    output: str
    step: int
    faults: int


@dataclass(frozen=True, eq=False)
class _Host:
    """What this machine computes: the steps, and outputs, fault words and states (N,) after each."""

    given: Steps
    after: host.Batch


def verify(emitted: Emitted, inputs: Columns, core: str, told: Callable[[str], None]) -> tuple[Check, ...]:
    """Replay inputs (N,) on the core, by every compiler and emulator that is installed; count what differs in any bit.

    Raises DesignError when the core has no hardware for the scalar type, CompileError when no cross compiler is there
    or the C is refused, SignalError for inputs that do not fit.
    """
    scalar = emitted.manifest["scalar"]
    cross.find_core(core)
    if SCALARS[core] != scalar:
        raise DesignError(f"{core}: found C in {scalar}, need {SCALARS[core]}, which it has hardware for: emit that")
    controller = host.load(emitted.files, emitted.manifest)
    given = steps.recorded(controller, "replay", inputs)
    expected = _Host(given, steps.taken(controller, given))
    checks: list[Check] = []
    for compiler in cross.available():
        if scalar == "float32":
            checks.append(_single(emitted, compiler))
        told(f"{len(given)} steps on {core}, {compiler}, unicorn")
        found = target.load(emitted.files, emitted.manifest, core, compiler)
        checks += _unlike(f"{core}, {compiler}, unicorn", expected, _stepped(found, given))
    if shutil.which("qemu-system-arm") and "gcc" in cross.available():
        told(f"{len(given)} steps on {core}, gcc, QEMU")
        board = qemu.load(emitted.files, emitted.manifest, core)
        checks += _unlike(f"{core}, gcc, QEMU", expected, _replayed(board.replay(inputs)))
    return tuple(checks)


def drift(emitted: Emitted, inputs: Columns, core: str, floor: agree.Floor = None, compiler: str = "gcc") -> Drift:
    """Replay inputs (N,) with contraction on and compare with the host's, where it is off.

    Below its floor, as `agree.floors` has it, a difference of an output is absolute.

    Raises CompileError when the compiler is not installed, SignalError for inputs or a floor that do not fit.
    """
    expected = host.load(emitted.files, emitted.manifest).replay(inputs)
    found = target.load(emitted.files, emitted.manifest, core, compiler, cross.CONTRACTED).replay(inputs)
    fields = emitted.manifest["structs"]["output"]["fields"]
    least = agree.floors(floor, {f["name"]: (f["low"], f["high"]) for f in fields})
    gaps = {}
    for name, i in expected.outputs.items():
        value = i.astype(np.float64)
        gaps[name] = np.abs(found.outputs[name].astype(np.float64) - value) / np.maximum(least[name], np.abs(value))
    worst = max(gaps, key=lambda name: float(gaps[name].max()))
    step = int(np.argmax(gaps[worst]))
    unlike = int(np.count_nonzero(found.faults != expected.faults))
    return Drift(core, compiler, len(expected.faults), float(gaps[worst][step]), worst, step, unlike)


def _single(emitted: Emitted, compiler: str) -> Check:
    found = cross.double_symbols(host.code(emitted.files), compiler)
    about = f"undefined symbols of double arithmetic in the object: {', '.join(found) or 'none'}"
    return Check(f"cortex-m4f, {compiler}: double-precision symbols", len(found), 0, "symbols", about)


def _stepped(found: target.Target, given: Steps) -> host.Batch:
    """Take one step from each of the given states on the core."""
    machine = image.boot(found.program, found.core, found.own)
    n = len(given)
    states, inputs, outputs = np.ascontiguousarray(given.states), given.inputs, np.zeros(n, found.outputs)
    at = [machine.place(records) for records in (states, inputs, outputs)]
    sizes = [records.itemsize for records in (states, inputs, outputs)]
    arguments = np.array(at) + np.arange(n)[:, np.newaxis] * np.array(sizes)
    faults = machine.calls(found.manifest["functions"]["step"], arguments)
    after, taken = (
        np.frombuffer(machine.read(address, records.nbytes), records.dtype)
        for address, records in ((at[0], states), (at[2], outputs))
    )
    return host.Batch(host.columns(taken), faults, after)


def _replayed(replay: host.Replay) -> host.Batch:
    return host.Batch(replay.outputs, replay.faults, replay.state.reshape(1))


def _unlike(where: str, expected: _Host, found: host.Batch) -> Sequence[Check]:
    """Count output samples, states and fault words that are not the host's to the last bit."""
    known = expected.after.states[-len(found.states) :]  # a replay tells the last alone
    outputs = {n: _other_bits(v, found.outputs[n]) for n, v in expected.after.outputs.items()}
    states = {n: _other_bits(known[n], found.states[n]) for n in known.dtype.names or ()}
    faults = _other_bits(expected.after.faults, found.faults)
    steps = len(expected.given)
    return (
        Check(f"{where}: outputs with other bits", sum(outputs.values()), 0, "values", _first(steps, "steps", outputs)),
        Check(
            f"{where}: states with other bits", sum(states.values()), 0, "values", _first(len(known), "states", states)
        ),
        Check(f"{where}: other fault words", faults, 0, "steps", f"{steps} steps"),
    )


def _other_bits(expected: NDArray[Any], found: NDArray[Any]) -> int:
    a, b = (np.frombuffer(v.tobytes(), np.uint8).reshape(len(v), -1) for v in (expected, found))
    return int(np.count_nonzero((a != b).any(axis=1)))


def _first(n: int, of: str, counts: Mapping[str, int]) -> str:
    unlike = [f"{name} {count} times" for name, count in counts.items() if count]
    return "; ".join([f"{len(counts)} members of {n} {of}", *unlike[:3]])
