"""Instruction counts and decision coverage of N calls, from the recorded instruction trace.

    instructions[k] = sum over functions of by_function[f][k]
    decision        = an instruction that executes or not, depending on the flags or on a register against zero

Every fetched instruction counts once, even if it is predicated false, because the core spends a cycle on it. Three
kinds of instruction are decisions: a conditional branch (b<cond>, cbz, cbnz), the first instruction of an IT block, and
the first one after a new comparison inside the block; the remaining instructions of the block depend on the same
decision. VSEL, VMAXNM and VMINNM select a value and are not decisions. The targets of a table branch (tbb, tbh) are not
analysed.

Instruction trace of an emulated core, recorded by a compiled hook.

The emulator calls its code hook after it has tested the condition of an IT block, so the record lacks instructions that
are predicated false. It contains every conditional branch, taken or not. `trace` restores the missing instructions.

State trajectory of emitted C: x_0 from `init`, x_{k+1} = step(x_k, u_k).
"""

import ctypes
from collections.abc import Collection, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from importlib import resources
from types import MappingProxyType
from typing import Any, NamedTuple

import numpy as np
from capstone import CS_ARCH_ARM, CS_MODE_MCLASS, CS_MODE_THUMB, Cs, CsInsn
from capstone.arm import (
    ARM_CC_AL,
    ARM_INS_B,
    ARM_INS_BL,
    ARM_INS_BLX,
    ARM_INS_BX,
    ARM_INS_CBNZ,
    ARM_INS_CBZ,
    ARM_INS_IT,
    ARM_INS_TBB,
    ARM_INS_TBH,
    ARM_REG_PC,
)
from numpy.typing import ArrayLike, NDArray
from unicorn import UC_HOOK_CODE, Uc, UcError, arm_const
from unicorn.unicorn_py3.unicorn import uclib

from synth.errors import SynthError
from synth.execute import compile as host_compiler
from synth.execute import elf, host
from synth.execute.host import Records


def states(
    controller: host.Controller, inputs: Mapping[str, ArrayLike], changed: Mapping[str, float] = MappingProxyType({})
) -> Records:
    """Return the states x_0 .. x_N (N + 1,) from `init` with `changed` states, under input columns (N,) or constants.

    Raises SignalError as `host.Controller.init` and `replay`.
    """
    n = host.length(inputs)
    input_records = controller.records(inputs, n)
    states, outputs = np.zeros(n + 1, controller.state), np.zeros((), controller.outputs)
    states[0] = controller.init(changed)
    step = ctypes.CFUNCTYPE(ctypes.c_uint32, *[ctypes.c_void_p] * 3)(controller.step_address)
    state_address, size = states.ctypes.data, states.itemsize
    input_address, width = input_records.ctypes.data, input_records.itemsize
    for k in range(n):
        states[k + 1] = states[k]
        step(state_address + (k + 1) * size, input_address + k * width, outputs.ctypes.data)
    return states


CAPACITY = 1 << 20


class _Recorder(ctypes.Structure):
    """`recorder_t` of recorder.c, member for member."""

    _fields_ = [
        ("capacity", ctypes.c_int64),
        ("count", ctypes.c_int64),
        ("address", ctypes.c_void_p),
        ("read_register", ctypes.c_void_p),
        ("sp", ctypes.c_int32),
        ("lowest_sp", ctypes.c_uint32),
    ]


@dataclass(frozen=True, eq=False)
class Record:
    """R instructions of n calls: their addresses (R,), and the count up to the end of each call (n,)."""

    addresses: NDArray[np.uint32]
    ends: NDArray[np.int64]


class Recorder:
    """A buffer of executed instructions; `end_call` after each call, `take` when `is_filling` and at the end."""

    def __init__(self, capacity: int) -> None:
        self._addresses = np.empty(capacity, np.uint32)
        self._ends: list[int] = []
        self.memory = _Recorder(
            capacity=capacity,
            address=self._addresses.ctypes.data,
            read_register=ctypes.cast(uclib.uc_reg_read, ctypes.c_void_p).value,
            sp=arm_const.UC_ARM_REG_SP,
            lowest_sp=0xFFFFFFFF,
        )

    @property
    def is_filling(self) -> bool:
        """Whether less than half of the buffer is left."""
        return bool(2 * self.memory.count > self.memory.capacity)

    @property
    def lowest_sp(self) -> int:
        """The lowest stack pointer before any recorded instruction."""
        return int(self.memory.lowest_sp)

    def end_call(self) -> None:
        """Mark the end of a call; raise SynthError when it executed more instructions than the buffer holds."""
        if self.memory.count > self.memory.capacity:
            raise SynthError(
                f"one call executed {self.memory.count} instructions, {self.memory.capacity // 2} can be recorded: "
                "measure a smaller function"
            )
        self._ends.append(self.memory.count)

    def take(self) -> Record:
        """Return the record and empty the buffer."""
        n = self.memory.count
        record = Record(self._addresses[:n].copy(), np.array(self._ends, dtype=np.int64))
        self.memory.count, self._ends = 0, []
        return record


@contextmanager
def attach(engine: Uc, capacity: int = CAPACITY) -> Iterator[Recorder]:
    """Record every instruction that the engine executes within the `with` block."""
    recorder, handle = Recorder(capacity), ctypes.c_size_t()
    callback = ctypes.cast(_library().synth_record, ctypes.c_void_p)
    # hook_add of the Python binding accepts only Python functions, which take ten times as long as this one.
    everything = ctypes.c_uint64(1), ctypes.c_uint64(0)
    status = uclib.uc_hook_add(
        engine._uch, ctypes.byref(handle), UC_HOOK_CODE, callback, ctypes.byref(recorder.memory), *everything
    )
    if status:
        raise UcError(status)
    engine.ctl_flush_tb()  # discard code that was translated without the hook
    try:
        yield recorder
    finally:
        uclib.uc_hook_del(engine._uch, handle)
        engine.ctl_flush_tb()


def _library() -> Any:
    text = resources.files("synth.execute").joinpath("recorder.c").read_text(encoding="utf-8")
    return ctypes.CDLL(str(host_compiler.shared_library({"recorder.c": text})))


_BRANCHES = (ARM_INS_B, ARM_INS_BL, ARM_INS_BLX, ARM_INS_BX, ARM_INS_CBNZ, ARM_INS_CBZ, ARM_INS_TBB, ARM_INS_TBH)


@dataclass(frozen=True, eq=False)
class Code:
    """The I instructions of an image in order of address.

    `conditional` marks conditional branches, cbz, cbnz and predicated instructions; `transfers` marks those that may
    change the program counter; `decides` marks decisions. `function` is an index into the program's functions, their
    number for none.
    """

    program: elf.Program
    instructions: tuple[CsInsn, ...]
    address: NDArray[np.int64]
    conditional: NDArray[np.bool_]
    transfers: NDArray[np.bool_]
    decides: NDArray[np.bool_]
    function: NDArray[np.intp]


@dataclass(frozen=True, eq=False)
class Trace:
    """M instructions of n calls: index into Code (M,), whether each took effect (M,), count up to each call's end (n,).

    An instruction has no effect if it is predicated false, or if it is a conditional branch that is not taken.
    """

    index: NDArray[np.intp]
    passed: NDArray[np.bool_]
    ends: NDArray[np.int64]

    @property
    def lengths(self) -> NDArray[np.int64]:
        """Instructions of each call, (n,)."""
        return np.diff(self.ends, prepend=0)


class Site(NamedTuple):
    """A decision: its address, function and text, and how often its condition was true and false."""

    address: int
    function: str
    text: str
    taken: int
    not_taken: int

    @property
    def missing(self) -> str:
        """The outcome that was not covered: "", "taken", "not taken" or "reached"."""
        if not self.taken and not self.not_taken:
            return "reached"
        return "" if self.taken and self.not_taken else "not taken" if self.taken else "taken"


@dataclass(frozen=True, eq=False)
class Counts:
    """Instructions of n calls by function (n, F + 1); how often each of I instructions was executed and passed (I,)."""

    by_function: NDArray[np.int64]
    executed: NDArray[np.int64]
    passed: NDArray[np.int64]


def decode(program: elf.Program) -> Code:
    """Disassemble every instruction of a program; raise SynthError at bytes that are not instructions."""
    engine = Cs(CS_ARCH_ARM, CS_MODE_THUMB | CS_MODE_MCLASS)
    engine.detail = True
    instructions = tuple(i for region in program.regions if region.thumb for i in _disassemble(engine, region))
    address = np.array([i.address for i in instructions], dtype=np.int64)
    return Code(
        program=program,
        instructions=instructions,
        address=address,
        conditional=np.array([_is_conditional(i) for i in instructions], dtype=bool),
        transfers=np.array([(i.id in _BRANCHES or ARM_REG_PC in i.regs_access()[1]) for i in instructions], dtype=bool),
        decides=_decisions(instructions),
        function=program.function_at(address),
    )


def reconstruct_path(code: Code, record: Record) -> Trace:
    """Return the execution path of a record, with the predicated instructions that it skipped in IT blocks.

    Raises SynthError when the path leaves the instructions of the program.
    """
    at = np.minimum(np.searchsorted(code.address, record.addresses), len(code.address) - 1)
    _require_instructions(code, at, record)
    after = np.append(at[1:], 0)
    after[record.ends - 1] = -1
    # An instruction that does not branch is followed by the next one that is not predicated false.
    skipped = np.where(code.transfers[at], 0, after - at - 1)
    unconditional = np.append(0, np.cumsum(~code.conditional))
    if (skipped < 0).any() or (unconditional[at + 1 + skipped] != unconditional[at + 1]).any():
        raise SynthError("execution skipped instructions that are not predicated, need a path that the code allows")
    shown = 1 + skipped
    places = np.cumsum(shown) - shown
    passed = np.zeros(shown.sum(), dtype=bool)
    passed[places] = ~(code.conditional[at] & code.transfers[at]) | (after != at + 1)
    index = np.repeat(at - places, shown) + np.arange(len(passed))
    return Trace(index, passed, np.cumsum(shown)[record.ends - 1])


def count(code: Code, trace: Trace) -> Counts:
    """Count a trace by call and function, and by instruction."""
    n, functions, size = len(trace.ends), len(code.program.functions) + 1, len(code.address)
    call = np.repeat(np.arange(n), trace.lengths)
    cells = np.bincount(call * functions + code.function[trace.index], minlength=n * functions)
    executed = np.bincount(trace.index, minlength=size)
    return Counts(cells.reshape(n, functions), executed, np.bincount(trace.index[trace.passed], minlength=size))


def join(parts: Sequence[Counts]) -> Counts:
    """Concatenate the counts of consecutive parts of a trace."""
    return Counts(
        np.concatenate([part.by_function for part in parts]),
        np.sum([part.executed for part in parts], axis=0),
        np.sum([part.passed for part in parts], axis=0),
    )


def by_function(code: Code, counts: Counts) -> dict[str, NDArray[np.int64]]:
    """Return the instructions of each call (N,) by function, the most expensive first, without unused functions."""
    names = [*(f.name for f in code.program.functions), elf.OUTSIDE]
    totals = counts.by_function.sum(axis=0)
    ordered = np.argsort(-totals, kind="stable")
    return {names[f]: counts.by_function[:, f].copy() for f in ordered if totals[f]}


def sites(code: Code, counts: Counts, functions: Collection[str]) -> tuple[Site, ...]:
    """Return every decision in the named functions, in order of address."""
    names = [*(f.name for f in code.program.functions), elf.OUTSIDE]
    return tuple(
        Site(
            address=int(code.address[i]),
            function=names[code.function[i]],
            text=f"{code.instructions[i].mnemonic} {code.instructions[i].op_str}".strip(),
            taken=int(counts.passed[i]),
            not_taken=int(counts.executed[i] - counts.passed[i]),
        )
        for i in np.flatnonzero(code.decides)
        if names[code.function[i]] in functions
    )


def _disassemble(engine: Cs, region: elf.Region) -> list[CsInsn]:
    instructions = list(engine.disasm(region.content, region.address))
    read = sum(i.size for i in instructions)
    # Linkers pad up to the next function with bytes that need not be instructions: fewer than one word.
    if len(region.content) - read >= 4:
        raise SynthError(f"machine code: found no Thumb instruction at {region.address + read:#x}, need one")
    return instructions


def _require_instructions(code: Code, at: NDArray[np.intp], record: Record) -> None:
    outside = code.address[at] != record.addresses
    if outside.any():
        raise SynthError(f"execution reached {record.addresses[outside][0]:#x}, need an instruction of the image there")


def _is_conditional(instruction: CsInsn) -> bool:
    # For IT itself the disassembler gives the condition of the block that follows.
    predicated = instruction.id != ARM_INS_IT and instruction.cc not in (0, ARM_CC_AL)
    return predicated or instruction.id in (ARM_INS_CBZ, ARM_INS_CBNZ)


def _decisions(instructions: tuple[CsInsn, ...]) -> NDArray[np.bool_]:
    decides = np.zeros(len(instructions), dtype=bool)
    decided = False  # whether a decision already depends on the current flags
    for i, instruction in enumerate(instructions):
        conditional = _is_conditional(instruction)
        decides[i] = conditional and (not decided or instruction.id in _BRANCHES)
        decided = conditional and not instruction.update_flags
    return decides
