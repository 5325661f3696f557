"""Instruction-set simulation of a Cortex-M core: call functions of a linked image and measure the calls.

The emulator is unicorn with the nearest application core, which executes the same Thumb instructions with the same
arithmetic. The floating-point modes are those after reset (round to nearest, no flush to zero, no default NaN); they
are checked before and after every run. The emulator models no caches, wait states or interrupts. Its instruction counts
are exact, its run time says nothing about the core.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from unicorn import UC_ARCH_ARM, UC_MODE_THUMB, Uc, UcError, arm_const

from synth.errors import SignalError, SynthError
from synth.execute import cross, cycles, elf, trace

_CPUS = {"cortex-m4f": arm_const.UC_CPU_ARM_CORTEX_A15, "cortex-m7": arm_const.UC_CPU_ARM_MAX}
_PAGE = 0x1000
STACK, STACK_BYTES = 0x20000000, 0x10000
HEAP, HEAP_END = 0x30000000, 0xF0000000
_RETURN = HEAP_END
_PAINT = b"\xa5\x5a\xc3\x3c"
_REGISTERS = tuple(getattr(arm_const, f"UC_ARM_REG_R{n}") for n in range(4))


@dataclass(frozen=True, eq=False)
class Cost:
    """Measured cost of N calls on the core.

    `instructions` (N,) is the total and `by_function` (N,) its parts by name, the most expensive first; inlined code
    counts for the caller. `stack_bytes` is the largest stack use of any call, with libm and arguments on the stack.
    `cycles` is an estimate from a published table, not a measurement, and None for a core without such a table. `sites`
    are the decisions in the functions of the sources.
    """

    instructions: NDArray[np.int64]
    by_function: Mapping[str, NDArray[np.int64]]
    cycles: cycles.Cycles | None
    stack_bytes: int
    sites: tuple[trace.Site, ...]

    @property
    def missing(self) -> tuple[trace.Site, ...]:
        """Decisions for which at least one direction was not covered."""
        return tuple(site for site in self.sites if site.missing)


class Calls(NamedTuple):
    """N calls: the returned words (N,) and the cost."""

    results: NDArray[np.uint32]
    cost: Cost


@dataclass(frozen=True, eq=False)
class Image:
    """A program in the memory of an emulated core; `boot` makes one.

    Addresses are those of the core. Memory keeps its contents from call to call. `covered` names the functions whose
    decisions are reported.
    """

    program: elf.Program
    core: str
    covered: frozenset[str]
    engine: Uc

    @cached_property
    def code(self) -> trace.Code:
        """The program's instructions."""
        return trace.decode(self.program)

    def reserve(self, size: int) -> int:
        """Reserve `size` zeroed bytes and return their address, a multiple of 4096."""
        address = max([HEAP, *(end + 1 for begin, end, _ in self.engine.mem_regions() if begin < HEAP_END)])
        pages = -(-max(size, 1) // _PAGE) * _PAGE
        if address + pages > HEAP_END:
            raise SynthError(
                f"memory of the core: {size} bytes do not fit below {HEAP_END:#x}: run fewer steps at once"
            )
        self.engine.mem_map(address, pages)
        return address

    def place(self, array: NDArray[Any]) -> int:
        """Copy an array into fresh memory, byte for byte, and return its address."""
        address = self.reserve(array.nbytes)
        self.write(address, array.tobytes())
        return address

    def write(self, address: int, content: bytes) -> None:
        """Write bytes; raise SynthError where no memory is reserved."""
        try:
            self.engine.mem_write(address, content)
        except UcError as error:
            raise SynthError(
                f"memory of the core: {len(content)} bytes at {address:#x} are not reserved: reserve them"
            ) from error

    def read(self, address: int, size: int) -> bytes:
        """Return `size` bytes; raise SynthError where no memory is reserved."""
        try:
            return bytes(self.engine.mem_read(address, size))
        except UcError as error:
            raise SynthError(
                f"memory of the core: {size} bytes at {address:#x} are not reserved: reserve them"
            ) from error

    def call(self, function: str, *arguments: int) -> int:
        """Call a function with words (integers, addresses) as arguments and return the word in r0.

        Raises CompileError for a function that is not in the image, SynthError when the core stops before it returns.
        """
        return int(self.calls(function, np.array([arguments], dtype=np.int64))[0])

    def calls(self, function: str, arguments: NDArray[np.integer[Any]]) -> NDArray[np.uint32]:
        """Call a function N times, with the rows of `arguments` (N, n); return the words in r0, (N,).

        Raises CompileError and SynthError as `call`.
        """
        begin = self.program.address(function)
        self._require_plain_floats()
        results = np.array([self._call(function, begin, row) for row in arguments.tolist()], dtype=np.uint32)
        self._require_plain_floats()
        return results

    def measure(self, function: str, arguments: NDArray[np.integer[Any]]) -> Calls:
        """Call as `calls` does and measure every call.

        Raises CompileError and SynthError as `call`, and SignalError when there is no call.
        """
        if not len(arguments):
            raise SignalError(f"measurement of '{function}': found 0 calls, need 1 or more: give arguments")
        begin, results = self.program.address(function), []
        parts: list[tuple[trace.Counts, cycles.Cycles | None]] = []
        self.write(STACK, _PAINT * (STACK_BYTES // len(_PAINT)))
        self._require_plain_floats()
        with trace.attach(self.engine) as record:
            for row in arguments.tolist():
                results.append(self._call(function, begin, row))
                record.end_call()
                if record.is_filling or len(results) == len(arguments):
                    parts.append(self._evaluate(record.take()))
        self._require_plain_floats()
        return Calls(np.array(results, dtype=np.uint32), self._cost(parts, record.lowest_sp))

    @cached_property
    def _timing(self) -> cycles.Timing:
        return cycles.timing(self.code)

    def _evaluate(self, record: trace.Record) -> tuple[trace.Counts, cycles.Cycles | None]:
        path = trace.reconstruct_path(self.code, record)
        has_table = self.core == "cortex-m4f"
        return trace.count(self.code, path), cycles.estimate(self._timing, path) if has_table else None

    def _cost(self, parts: Sequence[tuple[trace.Counts, cycles.Cycles | None]], lowest_sp: int) -> Cost:
        counts = trace.join([part for part, _ in parts])
        estimates = [estimate for _, estimate in parts if estimate is not None]
        return Cost(
            instructions=counts.by_function.sum(axis=1),
            by_function=trace.by_function(self.code, counts),
            cycles=cycles.join(estimates) if estimates else None,
            stack_bytes=STACK + STACK_BYTES - min(lowest_sp, self._lowest_written_address()),
            sites=trace.sites(self.code, counts, self.covered),
        )

    def _lowest_written_address(self) -> int:
        words = np.frombuffer(self.read(STACK, STACK_BYTES), np.uint8).reshape(-1, len(_PAINT))
        touched = np.flatnonzero((words != np.frombuffer(_PAINT, np.uint8)).ravel())
        return STACK + (int(touched[0]) if touched.size else STACK_BYTES)

    def _call(self, function: str, begin: int, arguments: Sequence[int]) -> int:
        engine, stacked = self.engine, arguments[4:]
        top = STACK + STACK_BYTES - 8 * (-(-len(stacked) // 2))  # the ABI requires multiples of eight
        if stacked:
            self.write(top, np.array(stacked, dtype=np.int64).astype(np.uint32).tobytes())
        registers = [(r, value & 0xFFFFFFFF) for r, value in zip(_REGISTERS, arguments, strict=False)]
        engine.reg_write_batch([*registers, (arm_const.UC_ARM_REG_SP, top), (arm_const.UC_ARM_REG_LR, _RETURN | 1)])
        try:
            engine.emu_start(begin | 1, _RETURN)
        except UcError as error:
            at = engine.reg_read(arm_const.UC_ARM_REG_PC)
            raise SynthError(
                f"'{function}' on the emulated {self.core}: {error} at {at:#x}; need code that stays within its own "
                f"memory, its arguments and {STACK_BYTES} bytes of stack: correct the sources or the arguments"
            ) from error
        return int(engine.reg_read(arm_const.UC_ARM_REG_R0))

    def _require_plain_floats(self) -> None:
        fpscr = self.engine.reg_read(arm_const.UC_ARM_REG_FPSCR)
        cross.require_plain_floats(f"the emulated {self.core}", fpscr)


def boot(program: elf.Program, core: str, covered: frozenset[str]) -> Image:
    """Load a program into a core after reset; `covered` names the functions whose decisions are reported."""
    engine = Uc(UC_ARCH_ARM, UC_MODE_THUMB, _CPUS[core])
    coprocessors = engine.reg_read(arm_const.UC_ARM_REG_C1_C0_2)
    engine.reg_write(arm_const.UC_ARM_REG_C1_C0_2, coprocessors | 0xF << 20)
    engine.reg_write(arm_const.UC_ARM_REG_FPEXC, 1 << 30)
    pages = {
        page for s in program.segments for page in range(s.address // _PAGE, -(-(s.address + len(s.content)) // _PAGE))
    }
    for page in sorted(pages):
        engine.mem_map(page * _PAGE, _PAGE)
    for segment in program.segments:
        engine.mem_write(segment.address, segment.content)
    engine.mem_map(STACK, STACK_BYTES)
    engine.mem_map(_RETURN, _PAGE)
    return Image(program, core, covered, engine)
