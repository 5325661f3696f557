"""Execution of emitted C on QEMU's Cortex-M boards, a second emulator that is independent of `target`.

    state', out_k, faults_k = step(state, in_k),  k = 0 .. N-1

The boards are MPS2 with application note 386 (Cortex-M4F) or 500 (Cortex-M7), which QEMU models as M-class cores with
an FPU. arm-none-eabi-gcc builds the image with the start-up code of qemu.c; samples pass through semihosting files.
"""

import shutil
import subprocess
import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from importlib import resources
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from synth.errors import CompileError, SynthError
from synth.execute import compile as host_compiler
from synth.execute import cross, elf, host

_EMULATOR = "qemu-system-arm"
_MACHINES = {"cortex-m4f": "mps2-an386", "cortex-m7": "mps2-an500"}
_OPTIONS = ("-nographic", "-monitor", "none", "-serial", "none", "-semihosting-config", "enable=on,target=native")
# Timeouts against C that does not terminate. Start-up and a step take milliseconds, on a busy machine seconds.
_TIMEOUT_S, _TIMEOUT_PER_STEP_S = 1800.0, 0.1
_MEMORY = """MEMORY { flash : ORIGIN = 0x00000000, LENGTH = 4M  ram : ORIGIN = 0x20000000, LENGTH = 4M }
SECTIONS {
    .text : { KEEP(*(.vectors)) *(.text*) *(.rodata*) . = ALIGN(4); } > flash
    .ARM.exidx : { *(.ARM.exidx*) } > flash
    .data : ALIGN(8) { synth_data = .; *(.data*) . = ALIGN(4); synth_data_end = .; } > ram AT> flash
    synth_data_stored = LOADADDR(.data);
    .bss (NOLOAD) : ALIGN(8) { synth_bss = .; *(.bss*) *(COMMON) . = ALIGN(4); synth_bss_end = .; } > ram
    synth_stack_top = ORIGIN(ram) + LENGTH(ram);
}
ENTRY(synth_reset)
"""
_CONTRACT = """{includes}
#define STATE {state}
#define INPUT {input}
#define OUTPUT {output}
#define INIT {init}
#define STEP {step}
"""


@dataclass(frozen=True, eq=False)
class Board:
    """Emitted C with the contract `init(state)`, `faults = step(state, in, out)` on a board; `load` makes one.

    It takes and returns the same records as `host.Controller`. Every run starts from reset.
    """

    manifest: Mapping[str, Any]
    inputs: np.dtype[np.void]
    outputs: np.dtype[np.void]
    state: np.dtype[np.void]
    core: str
    image: Path

    def init(self) -> host.Records:
        """Return the state after `init`, a record of shape ()."""
        return self._run(np.zeros(0, self.inputs), None).state

    def replay(self, inputs: Mapping[str, ArrayLike], state: host.Records | None = None) -> host.Replay:
        """Run N steps from a copy of `state`, or from `init`; inputs are columns (N,) or constants.

        Raises SignalError as `host.Controller.replay`, SynthError when the board stops before the last step.
        """
        if state is not None:
            host.require_states(self.manifest, self.state, state, ())
        return self._run(host.records(self.manifest, self.inputs, inputs, host.length(inputs)), state)

    def _run(self, inputs: host.Records, state: host.Records | None) -> host.Replay:
        start = np.zeros((), self.state) if state is None else state
        head = np.array([len(inputs), state is None], dtype="<u4")
        step = np.dtype([("out", self.outputs), ("faults", "<u4")])
        end = np.dtype([("state", self.state), ("fpscr", "<u4")])
        size = len(inputs) * step.itemsize + end.itemsize
        response = _exchange(self.core, self.image, head.tobytes() + start.tobytes() + inputs.tobytes(), len(inputs))
        if len(response) != size:
            raise SynthError(f"QEMU's {self.core}: found {len(response)} bytes of response, need {size}: run it again")
        steps, last = np.frombuffer(response[: -end.itemsize], step), np.frombuffer(response[-end.itemsize :], end)
        cross.require_plain_floats(f"QEMU's {self.core}", int(last["fpscr"][0]))
        return host.Replay(host.columns(steps["out"]), steps["faults"].copy(), last["state"].copy().reshape(()))


def load(
    files: Mapping[str, str], manifest: Mapping[str, Any], core: str = "cortex-m4f", flags: Sequence[str] = ()
) -> Board:
    """Build emitted C, with start-up code, for the board of a core, "cortex-m4f" or "cortex-m7".

    Files that are neither .c nor .h are ignored; `flags` come after `cross.FLAGS`.

    Raises CompileError when QEMU or the cross compiler is not on the PATH, DesignError and CompileError as `host.load`.
    """
    _require_emulator()
    dtypes = {role: host.dtype(role, manifest) for role in ("input", "output", "state")}
    startup = resources.files("synth.execute").joinpath("qemu.c").read_text(encoding="utf-8")
    sources = host.code(files)
    support_files = {
        "synth_layout.c": elf.assertions(files, manifest),
        "synth_qemu.c": startup,
        "contract.h": _contract(sources, manifest),
        "synth_mps2.ld": _MEMORY,
    }
    options = [*cross.FLAGS, *cross.SECTIONS, *flags, "-static", "-Wl,--gc-sections", "-T", "synth_mps2.ld"]
    compiler = cross.find_compiler(core, "gcc")
    image = host_compiler.build({**sources, **support_files}, options, "board.elf", compiler, libraries=("-lm",))
    return Board(manifest, dtypes["input"], dtypes["output"], dtypes["state"], core, image)


def _contract(files: Mapping[str, str], manifest: Mapping[str, Any]) -> str:
    return _CONTRACT.format(
        includes="\n".join(f'#include "{name}"' for name in sorted(files) if name.endswith(".h")),
        **{role: manifest["structs"][role]["type"] for role in ("state", "input", "output")},
        **{name: manifest["functions"][name] for name in ("init", "step")},
    )


def _exchange(core: str, image: Path, request: bytes, steps: int) -> bytes:
    """Run an image once, let it read the bytes `request`, and return the bytes of its response."""
    command = [_require_emulator(), "-M", _MACHINES[core], *_OPTIONS, "-kernel", str(image)]
    with tempfile.TemporaryDirectory(prefix="synth-qemu-") as folder:
        (Path(folder) / "request").write_bytes(request)
        timeout_s = _TIMEOUT_S + _TIMEOUT_PER_STEP_S * steps
        try:
            done = subprocess.run(command, cwd=folder, capture_output=True, text=True, timeout=timeout_s)
        except subprocess.TimeoutExpired as error:
            raise SynthError(f"QEMU's {core}: found no end after {timeout_s:.0f} s, need one: correct the C") from error
        if done.returncode != 0:
            raise SynthError(
                f"QEMU's {core}: found status {done.returncode} ({done.stderr.strip() or 'a fault of the core'}), 0 is "
                "needed: correct the C, or a memory access in it"
            )
        return (Path(folder) / "response").read_bytes()


def _require_emulator() -> str:
    path = shutil.which(_EMULATOR)
    if not path:
        raise CompileError(f"emulator: found no {_EMULATOR} on the PATH, need QEMU for Arm: install qemu-system-arm")
    return path
