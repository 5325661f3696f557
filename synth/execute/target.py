"""Processor-in-the-loop execution of emitted C on an emulated Cortex-M core, with measurement.

state', out_k, faults_k = step(state, in_k),  k = 0 .. N-1
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from synth.execute import cross, elf, host
from synth.execute.image import Cost, Image, boot


class Measured(NamedTuple):
    """A replay on the core, and the cost of its steps."""

    replay: host.Replay
    cost: Cost


@dataclass(frozen=True, eq=False)
class Target:
    """Emitted C with the contract `init(state)`, `faults = step(state, in, out)` on a core; `load` makes one.

    It takes and returns the same records as `host.Controller`. Every run starts with the core after reset. `covered`
    names the functions for which decision coverage is reported.
    """

    manifest: Mapping[str, Any]
    inputs: np.dtype[np.void]
    outputs: np.dtype[np.void]
    state: np.dtype[np.void]
    core: str
    program: elf.Program
    covered: frozenset[str]

    def init(self) -> host.Records:
        """Return the state after `init`, a record of shape ()."""
        image = boot(self.program, self.core, self.covered)
        address = image.reserve(self.state.itemsize)
        image.call(self.manifest["functions"]["init"], address)
        return _records(image, address, np.zeros((), self.state))

    def replay(self, inputs: Mapping[str, ArrayLike], state: host.Records | None = None) -> host.Replay:
        """Run N steps from a copy of `state`, or from `init`; inputs are columns (N,) or constants.

        Raises SignalError as `host.Controller.replay`, SynthError when the core stops before the last step.
        """
        run = self._prepare(inputs, state)
        return self._collect(run, run.image.calls(self.manifest["functions"]["step"], run.arguments))

    def measure(self, inputs: Mapping[str, ArrayLike], state: host.Records | None = None) -> Measured:
        """Run as `replay` does and measure every step.

        Raises SignalError and SynthError as `replay`, and SignalError when there are no steps.
        """
        run = self._prepare(inputs, state)
        calls = run.image.measure(self.manifest["functions"]["step"], run.arguments)
        return Measured(self._collect(run, calls.results), calls.cost)

    def _prepare(self, inputs: Mapping[str, ArrayLike], state: host.Records | None) -> "_Run":
        start = self.init() if state is None else state
        host.require_states(self.manifest, self.state, start, ())
        n = host.length(inputs)
        image = boot(self.program, self.core, self.covered)
        inputs_address = image.place(host.records(self.manifest, self.inputs, inputs, n))
        state_address, outputs_address = image.place(start), image.reserve(n * self.outputs.itemsize)
        steps = np.arange(n, dtype=np.int64)
        columns = (
            np.full(n, state_address),
            inputs_address + steps * self.inputs.itemsize,
            outputs_address + steps * self.outputs.itemsize,
        )
        return _Run(image, np.stack(columns, axis=1), state_address, outputs_address)

    def _collect(self, run: "_Run", faults: NDArray[np.uint32]) -> host.Replay:
        outputs = _records(run.image, run.outputs, np.zeros(len(faults), self.outputs))
        return host.Replay(host.columns(outputs), faults, _records(run.image, run.state, np.zeros((), self.state)))


class _Run(NamedTuple):
    """A core prepared for N steps: their arguments (N, 3), and the addresses of state and outputs in its memory."""

    image: Image
    arguments: NDArray[np.int64]
    state: int
    outputs: int


def load(
    files: Mapping[str, str],
    manifest: Mapping[str, Any],
    core: str = "cortex-m4f",
    compiler: str = "zig",
    flags: Sequence[str] = (),
) -> Target:
    """Build emitted C for a core, "cortex-m4f" or "cortex-m7", with the compiler "zig" or "gcc".

    Files that are neither .c nor .h are ignored; `flags` come after `cross.FLAGS`.

    Raises DesignError and CompileError as `host.load`, and CompileError as `cross.link`.
    """
    dtypes = {role: host.dtype(role, manifest) for role in ("input", "output", "state")}
    code = host.code(files)
    sources = {**code, "synth_layout.c": elf.assertions(files, manifest)}
    entries = [manifest["functions"][name] for name in ("step", "init")]
    program, step_program = (  # the second one is without init, and shows which functions belong to a step
        elf.read(cross.link(sources, kept_functions, core, compiler, flags))
        for kept_functions in (entries, entries[:1])
    )
    for entry in entries:
        program.address(entry)  # raises CompileError if the function is missing
    covered = cross.functions(code, core, compiler, flags) & {f.name for f in step_program.functions}
    return Target(manifest, dtypes["input"], dtypes["output"], dtypes["state"], core, program, covered)


def _records(image: Image, address: int, like: host.Records) -> host.Records:
    """Return a copy of the records at an address, with the type and the shape of `like`."""
    content = np.frombuffer(image.read(address, like.nbytes), like.dtype)
    return content.reshape(like.shape).copy()
