"""Cycle estimate for a Cortex-M4, from an instruction trace and the timings that Arm publishes.

    cycles = sum of the table's rows + refills of the pipeline + waits for operands - overlaps

This is an estimate, not a measurement. It assumes memory without wait states, aligned data and no interrupts. Where
the manual gives a range (the refill P is 1 to 3, a load may or may not be pipelined, an IT may be folded), `low` takes
the least and `high` the most. Arm publishes no such table for the Cortex-M7, which issues two instructions at once.

Reference: Arm, Cortex-M4 Processor Technical Reference Manual, revision r0p1, DDI 0439D.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from capstone import CS_AC_READ, CS_AC_WRITE, CsInsn
from capstone.arm import (
    ARM_OP_MEM,
    ARM_OP_REG,
    ARM_REG_D0,
    ARM_REG_LR,
    ARM_REG_PC,
    ARM_REG_R0,
    ARM_REG_S0,
    ARM_REG_SP,
)
from numpy.typing import NDArray

from synth.errors import SynthError
from synth.execute import trace

REFILL = (1, 3)  # P of section 3.3.1

_CORE, _DSP, _FPU = "section 3.3.1, table 3-1", "section 3.3.1, table 3-2", "section 7.2.3, table 7-1"
_PAIRS = "section 3.3.2"


class Row(NamedTuple):
    """Instructions that take `low` to `high` cycles, plus `each` for every register word in their list.

    `kind` selects the rule for interaction with neighbouring instructions.
    """

    mnemonics: str
    low: int
    high: int
    source: str
    each: int = 0
    kind: str = ""


TABLE = (
    Row("mov movs movw movt mvn add addw adc adr sub subw sbc rsb", 1, 1, _CORE, kind="integer"),
    Row("mul mla mls smull umull smlal umlal ssat usat cmp cmn", 1, 1, _CORE, kind="integer"),
    Row("and eor orr orn bic tst teq lsl lsr asr ror rrx clz", 1, 1, _CORE, kind="integer"),
    Row("sxth sxtb uxth uxtb ubfx sbfx bfc bfi rev rev16 revsh rbit", 1, 1, _CORE, kind="integer"),
    Row("nop hint clrex sev", 1, 1, _CORE),
    Row("sdiv udiv", 2, 12, f"{_CORE}, note a", kind="integer"),
    Row("ldr ldrb ldrh ldrsb ldrsh", 2, 2, f"{_CORE}, note b; {_PAIRS}", kind="load"),
    Row("str strb strh", 1, 2, f"{_CORE}, note b; {_PAIRS}: always one with an immediate offset", kind="store"),
    Row("ldrd strd", 3, 3, f"{_CORE}: 1 + N"),
    Row("ldm ldmdb stm stmdb push pop", 1, 1, f"{_CORE}: 1 + N", each=1),
    Row("b bl bx blx cbz cbnz", 1, 1, f"{_CORE}, note c: 1, or 1 + P when it branches", kind="branch"),
    Row("tbb tbh", 2, 3, f"{_CORE}: 2 + P; {_PAIRS}: at least six", kind="branch"),
    Row("it", 0, 1, f"{_CORE}, note d: folded onto a 16-bit instruction before it", kind="it"),
    Row("mrs msr", 1, 2, _CORE),
    Row("dmb dsb isb", 1, 4, f"{_CORE}: 1 + B"),
    Row("smmla smmls smmul smmlar smmlsr smmulr smlabb smlabt smlatb smlatt smulbb smulbt", 1, 1, _DSP, kind="integer"),
    Row("smultb smultt smulwb smulwt smlawb smlawt smlald umaal uxtab uxtah sxtab sxtah", 1, 1, _DSP, kind="integer"),
    Row("pkhbt pkhtb sel uadd8 usub8 qadd qsub", 1, 1, _DSP, kind="integer"),
    Row("vabs vneg vmov.float fconsts vcmp vcmpe vmrs fmstat vmsr", 1, 1, _FPU, kind="float"),
    Row("vmov", 1, 2, f"{_FPU}: 2 for a float to or from a core register, 1 for half a double", kind="float"),
    Row("vmov.pair", 2, 2, _FPU, kind="float"),
    Row("vadd vsub vmul vnmul vcvt vcvtr vcvtb vcvtt", 1, 1, _FPU, kind="arithmetic"),
    Row("vmla vmls vnmla vnmls vfma vfms vfnma vfnms", 3, 3, _FPU, kind="accumulate"),
    Row("vdiv vsqrt", 14, 14, f"{_FPU}, first note: integer instructions go on meanwhile", kind="divide"),
    Row("vldr", 1, 1, f"{_FPU}: 2, or 3 for a double", each=1, kind="float load"),
    Row("vstr", 1, 1, f"{_FPU}: 2, or 3 for a double", each=1, kind="float store"),
    Row("vldm vldmia vldmdb vstm vstmia vstmdb vpush vpop", 1, 1, f"{_FPU}: 1 + N, or 1 + 2N", each=1, kind="float"),
)
_ROWS = {name: row for row in TABLE for name in row.mnemonics.split()}
_UNKNOWN = "unknown"
_NO_ROW = Row("", 0, 0, "", kind=_UNKNOWN)
# Their result is available one cycle late: section 7.2.3, second note.
_LATE_RESULT = ("arithmetic", "accumulate", "divide")
_FPU_KINDS = (*_LATE_RESULT, "float", "float load", "float store")
_CORE_BITS = {ARM_REG_R0 + n: 1 << n for n in range(13)} | {ARM_REG_SP: 1 << 13, ARM_REG_LR: 1 << 14}
_FLOAT_BITS = {ARM_REG_S0 + n: 1 << n for n in range(32)} | {ARM_REG_D0 + n: 3 << 2 * n for n in range(16)}


@dataclass(frozen=True, eq=False)
class Cycles:
    """Estimated cycles of N calls, each between `low` and `high` (N,); not measured."""

    low: NDArray[np.int64]
    high: NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class Timing:
    """Timing data of each of I instructions; register masks have one bit per register.

    `float_reads` leaves out the addend of a multiply-accumulate, which is read one cycle later than the factors.
    """

    code: trace.Code
    low: NDArray[np.int64]
    high: NDArray[np.int64]
    kind: NDArray[np.str_]
    refills: NDArray[np.bool_]
    literal: NDArray[np.bool_]
    wide: NDArray[np.bool_]
    writes: NDArray[np.int64]
    addresses: NDArray[np.int64]
    float_writes: NDArray[np.int64]
    float_reads: NDArray[np.int64]

    def is_kind(self, *kinds: str) -> NDArray[np.bool_]:
        """Whether each instruction is of one of these kinds, (I,)."""
        return np.isin(self.kind, kinds)


def timing(code: trace.Code) -> Timing:
    """Return the timing data of the instructions of an image."""
    facts = [_instruction_timing(i) for i in code.instructions]
    columns = {name: np.array([getattr(f, name) for f in facts]) for name in _InstructionTiming._fields}
    return Timing(code=code, **columns)


def estimate(timing: Timing, path: trace.Trace) -> Cycles:
    """Estimate the cycles of the n calls of a trace.

    Raises SynthError when the trace contains an instruction that has no row in the table.
    """
    i, passed = path.index, path.passed
    _require_timings(timing, i)
    starts = path.ends - path.lengths
    low, high = np.where(passed, timing.low[i], 1), np.where(passed, timing.high[i], 1)
    refills = timing.refills[i] & passed
    waits = _waits(timing, path)
    low += waits + REFILL[0] * refills - _is_pipelined(timing, path) + _is_unfolded(timing, path)
    # The load of a literal may collide with an instruction fetch: section 3.3.2.
    high += waits + REFILL[1] * refills + (timing.literal[i] & passed)
    low -= _overlaps(timing, path, low)
    return Cycles(np.add.reduceat(low, starts), np.add.reduceat(high, starts))


def join(parts: Sequence[Cycles]) -> Cycles:
    """Concatenate the cycles of consecutive parts of a trace."""
    return Cycles(np.concatenate([p.low for p in parts]), np.concatenate([p.high for p in parts]))


def _require_timings(timing: Timing, index: NDArray[np.intp]) -> None:
    unknown = (timing.kind == _UNKNOWN)[index]
    if unknown.any():
        instruction = timing.code.instructions[index[unknown][0]]
        raise SynthError(
            f"cycles: `{instruction.mnemonic} {instruction.op_str}` at {instruction.address:#x} has no row in the "
            "Cortex-M4's table, needs one: add it with its source"
        )


def _predecessors(path: trace.Trace) -> tuple[NDArray[np.intp], NDArray[np.bool_]]:
    """Return the index of the preceding instruction, and whether it belongs to the same call and both took effect."""
    took_effect = np.append(False, path.passed[:-1]) & path.passed
    took_effect[path.ends - path.lengths] = False
    return np.append(path.index[:1], path.index[:-1]), took_effect


def _waits(timing: Timing, path: trace.Trace) -> NDArray[np.bool_]:
    """Return where one cycle is lost: on a late result used at once, or on an address computed just before."""
    i, (before, effective) = path.index, _predecessors(path)
    late = timing.is_kind(*_LATE_RESULT)[before] & (timing.float_writes[before] & timing.float_reads[i] != 0)
    address = timing.is_kind("integer")[before] & (timing.writes[before] & timing.addresses[i] != 0)
    return effective & (late | address)


def _is_pipelined(timing: Timing, path: trace.Trace) -> NDArray[np.bool_]:
    """Return which loads or stores save a cycle: those after a load, unless the loaded value is their address."""
    i, (before, effective) = path.index, _predecessors(path)
    loads, single = timing.is_kind("load", "float load"), timing.is_kind("load", "store", "float load", "float store")
    free = timing.writes[before] & timing.addresses[i] == 0
    return effective & loads[before] & single[i] & free & (timing.low[i] > 1)


def _is_unfolded(timing: Timing, path: trace.Trace) -> NDArray[np.bool_]:
    """Return which IT instructions cost a cycle: those whose predecessor is not a narrow instruction."""
    before = np.append(path.index[:1], path.index[:-1])
    alone = timing.wide[before]
    alone[path.ends - path.lengths] = True
    return timing.is_kind("it")[path.index] & alone


def _overlaps(timing: Timing, path: trace.Trace, low: NDArray[np.int64]) -> NDArray[np.int64]:
    """Return the cycles of each division or root that overlap with integer instructions before the next FPU one."""
    saved = np.zeros(len(low), dtype=np.int64)
    divisions = np.flatnonzero(timing.is_kind("divide")[path.index] & path.passed)
    on_fpu = np.flatnonzero(timing.is_kind(*_FPU_KINDS)[path.index])
    elapsed = np.append(0, np.cumsum(low))
    following = np.append(on_fpu, len(low))[np.searchsorted(on_fpu, divisions, side="right")]
    end = path.ends[np.searchsorted(path.ends, divisions, side="right")]
    meanwhile = elapsed[np.minimum(following, end)] - elapsed[divisions + 1]
    longest = timing.low[path.index[divisions]] - 1
    saved[divisions] = np.where(following < end, np.minimum(meanwhile, longest), longest)
    return saved


class _InstructionTiming(NamedTuple):
    """The entries of Timing for one instruction."""

    low: int
    high: int
    kind: str
    refills: bool
    literal: bool
    wide: bool
    writes: int
    addresses: int
    float_writes: int
    float_reads: int


def _instruction_timing(instruction: CsInsn) -> _InstructionTiming:
    row = _ROWS.get(_name(instruction), _NO_ROW)
    memory = [o.mem for o in instruction.operands if o.type == ARM_OP_MEM]
    written = instruction.regs_access()[1]
    words = row.each * _register_words(instruction)
    # A store always takes one cycle only with an immediate offset.
    indexed = row.kind == "store" and any(m.index for m in memory)
    return _InstructionTiming(
        low=row.low + words + indexed,
        high=row.high + words,
        kind=row.kind,
        refills=row.kind == "branch" or ARM_REG_PC in written,
        literal=any(m.base == ARM_REG_PC for m in memory) and row.kind in ("load", "float load"),
        wide=instruction.size == 4,
        writes=_mask(written, _CORE_BITS),
        addresses=_mask(_address_registers(instruction), _CORE_BITS),
        float_writes=_mask(_operands(instruction, CS_AC_WRITE), _FLOAT_BITS),
        float_reads=_mask(_operands(instruction, CS_AC_READ)[row.kind == "accumulate" :], _FLOAT_BITS),
    )


def _name(instruction: CsInsn) -> str:
    """Return the row name of an instruction; double arithmetic gets a name without a row, as no Cortex-M4 has it."""
    name = str(instruction.insn_name())
    if ".f64" in instruction.mnemonic:
        return f"{name}.f64"
    if name != "vmov":
        return name
    core = sum(o.type == ARM_OP_REG and o.reg in _CORE_BITS for o in instruction.operands)
    return ("vmov.float", "vmov", "vmov.pair")[core]


def _register_words(instruction: CsInsn) -> int:
    """Return the number of register words that a register list, or a VLDR or VSTR, transfers."""
    registers = [o.reg for o in instruction.operands if o.type == ARM_OP_REG]
    floats = sum(_FLOAT_BITS[r].bit_count() for r in registers if r in _FLOAT_BITS)
    based = str(instruction.insn_name()).startswith(("ldm", "stm"))
    return floats or len(registers) - based


def _address_registers(instruction: CsInsn) -> list[int]:
    name = str(instruction.insn_name())
    if name.endswith(("push", "pop")):
        return [ARM_REG_SP]
    if name.startswith(("ldm", "stm", "vldm", "vstm")):
        return [instruction.operands[0].reg]
    return [r for o in instruction.operands if o.type == ARM_OP_MEM for r in (o.mem.base, o.mem.index)]


def _operands(instruction: CsInsn, access: int) -> list[int]:
    """Return the operand registers that are read, or written; a register list is read by a store, else written."""
    name = str(instruction.insn_name())
    if name.startswith(("vpush", "vstm", "vpop", "vldm")):
        stores = name.startswith(("vpush", "vstm"))
        return [o.reg for o in instruction.operands if stores == (access == CS_AC_READ)]
    return [o.reg for o in instruction.operands if o.type == ARM_OP_REG and o.access & access]


def _mask(registers: Iterable[int], bits: Mapping[int, int]) -> int:
    mask = 0
    for register in registers:
        mask |= bits.get(register, 0)
    return mask
