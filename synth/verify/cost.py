"""Cost of a step on a core: instructions, estimated cycles, bytes, and decision coverage.

    issued      fetched instructions, including those predicated false, because the core spends a cycle on each
    executed    instructions that were not predicated false
    share       issued / (clock x period), assuming one cycle per instruction; it is not a worst-case bound

This module holds the data; `meter` measures it.

Operation counts of the emitted program by kind: arithmetic, comparisons and logic, choices, loads and stores.

A polynomial counts as the products and sums of its evaluation, a limit to +-h as one operation. Both branches of every
choice count, although a step takes only one.

Line table of a linked image: source file and line of a machine address, from the DWARF data of -g (`addr2line`).

For inlined code the line table names the line in the inlined function. `calls` gives the lines of the calls that were
inlined into a function, and what is called.
"""

from bisect import bisect_right
from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np
from elftools.dwarf.compileunit import CompileUnit
from elftools.dwarf.die import DIE
from elftools.dwarf.dwarfinfo import DWARFInfo
from elftools.dwarf.ranges import BaseAddressEntry
from elftools.elf.elffile import ELFFile
from numpy.typing import NDArray

from synth.block import Block
from synth.emit import pipeline
from synth.emit.program.lower import Program
from synth.show import Table

_KINDS = {"sq": "mul", "twice": "mul", "inv": "div", "clamp": "limit", "choose": "choice", "when": "choice"}
_KINDS |= dict.fromkeys(("lt", "le", "eq", "ne"), "compare") | dict.fromkeys(("and", "or", "not", "bit"), "logic")
_KINDS |= {"input": "load input", "state": "load state", "constant": "load constant", "literal": "load constant"}


def of_block(block: Block, scalar: type[np.floating]) -> dict[str, int]:
    """Count the operations of the C of a Block in a scalar type, the most frequent kind first.

    Raises EmitError as `emit`.
    """
    return of_program(pipeline.reduce(block.rounded(scalar), scalar).program)


def of_program(program: Program) -> dict[str, int]:
    """Count the operations of a program."""
    counts = Counter(_KINDS.get(n.op, n.op) for n in program.nodes if n.op not in ("polynomial", "product", "row"))
    for node in program.nodes:
        if node.op == "product":
            rows, columns = np.shape(program.matrices[node.name].values)
            counts += Counter({"mul": rows * columns, "add": rows * (columns - 1)})
        if node.op == "polynomial":
            c = program.polynomials[node.name].coefficients
            counts += Counter({"mul": len(c) - 1, "add": sum(1 for value in c[:-1] if value)})
    kept = sum(program.nodes[k].op == "state" and program.nodes[k].name == name for name, k in program.next.items())
    counts["store"] = len(program.outputs) + len(program.next) - kept
    return dict(counts.most_common())


@dataclass(frozen=True)
class Lines:
    """Rows of the line table in order of address; each row is valid up to the next. `read` returns one."""

    addresses: tuple[int, ...]
    places: tuple[tuple[str, int], ...]

    def at(self, address: int) -> tuple[str, int]:
        """Return file name and line, from 1, of an address; ("", 0) if no row covers it."""
        k = bisect_right(self.addresses, address) - 1
        return self.places[k] if k >= 0 else ("", 0)


def read(path: Path) -> Lines:
    """Read the line table of a linked image; it is empty without -g."""
    by_address: dict[int, tuple[str, int]] = {}
    with path.open("rb") as file:
        elf = ELFFile(file)
        if elf.has_dwarf_info():
            info = elf.get_dwarf_info()
            for unit in info.iter_CUs():
                name = Path(unit.get_top_DIE().get_full_path()).name
                program = info.line_program_for_CU(unit)
                rows = [entry.state for entry in program.get_entries() if entry.state] if program else []
                by_address |= {row.address: (name, row.line) for row in rows if not row.end_sequence}
    ordered = sorted(by_address)
    return Lines(tuple(ordered), tuple(by_address[a] for a in ordered))


@dataclass(frozen=True)
class Call:
    """An inlined call: addresses low <= a < high, its line in the caller, and the function that is called."""

    low: int
    high: int
    line: int
    function: str


def calls(path: Path, function: str) -> tuple[Call, ...]:
    """Return the calls that were inlined into a function, each before those inside it; empty without -g."""
    with path.open("rb") as file:
        elf = ELFFile(file)
        if not elf.has_dwarf_info():
            return ()
        info = elf.get_dwarf_info()
        return tuple(
            Call(low, high, die.attributes["DW_AT_call_line"].value, _name(die.get_DIE_from_attribute(_ORIGIN)))
            for unit in info.iter_CUs()
            for top in unit.get_top_DIE().iter_children()
            if top.tag == "DW_TAG_subprogram" and _name(top) == function
            for die in _inlined_calls(top)
            for low, high in _ranges(info, unit, die)
            if low < high
        )


_ORIGIN = "DW_AT_abstract_origin"


def _name(die: DIE) -> str:
    attribute = die.attributes.get("DW_AT_name")
    return attribute.value.decode() if attribute else ""


def _inlined_calls(die: DIE) -> Iterator[DIE]:
    """Yield the inlined calls below an entry, each before those inside it."""
    for child in die.iter_children():
        if child.tag == "DW_TAG_inlined_subroutine":
            yield child
        if child.tag in ("DW_TAG_inlined_subroutine", "DW_TAG_lexical_block"):
            yield from _inlined_calls(child)


def _ranges(info: DWARFInfo, unit: CompileUnit, die: DIE) -> Iterator[tuple[int, int]]:
    if "DW_AT_low_pc" in die.attributes:
        low, high = die.attributes["DW_AT_low_pc"].value, die.attributes["DW_AT_high_pc"]
        yield low, high.value if high.form == "DW_FORM_addr" else low + high.value
    elif "DW_AT_ranges" in die.attributes:
        start = unit.get_top_DIE().attributes.get("DW_AT_low_pc")
        base = start.value if start else 0
        lists = info.range_lists()
        assert lists is not None, "ranges without their section"
        for entry in lists.get_range_list_at_offset(die.attributes["DW_AT_ranges"].value, cu=unit):
            if isinstance(entry, BaseAddressEntry):
                base = entry.base_address
            else:
                shift = 0 if entry.is_absolute else base
                yield entry.begin_offset + shift, entry.end_offset + shift


CLOCK_HZ = 168e6
SYNTH, LAW_ALONE = "synth", "synth, law alone"
NOTE = (
    "Instructions, not cycles, counted on the steps that were run; they do not bound the worst case. The share of the "
    "period assumes one cycle per instruction at 168 MHz. The cycles are estimated from the timing table that Arm "
    "publishes, for memory without wait states; no time was measured."
)


@dataclass(frozen=True)
class Summary:
    """Minimum, mean and maximum of a count over some steps."""

    least: int
    mean: float
    most: int

    def __str__(self) -> str:
        return f"{self.least} .. {self.mean:.0f} .. {self.most}"


@dataclass(frozen=True)
class Memory:
    """Bytes: instructions, constants in flash, static RAM, state and signals of the caller, and stack.

    Code and constants include every function that the step calls, libm too; signals are inputs and outputs.
    """

    code: int
    constants: int
    data: int
    state: int
    signals: int
    stack: int

    @property
    def working(self) -> int:
        """RAM that a step uses: state, inputs, outputs, stack and static data."""
        return self.state + self.signals + self.stack + self.data


@dataclass(frozen=True)
class StepCost:
    """Cost of the step of one generator by one build, over the steps that all generators share.

    `cycles` are the low and the high estimate. `functions` are mean instructions per step, the most expensive first.
    `doubles` counts the symbols of double arithmetic in the generated code. `difference` is the worst difference of an
    output from the host, relative to its range.
    """

    generator: str
    build: str
    steps: int
    issued: Summary
    executed: Summary
    cycles: tuple[Summary, Summary]
    functions: Mapping[str, float]
    memory: Memory
    doubles: int
    difference: float


@dataclass(frozen=True)
class SequenceCost:
    """Instructions of the emitted C in one named sequence, by one build."""

    name: str
    build: str
    steps: int
    issued: Summary


@dataclass(frozen=True)
class Coverage:
    """Decision coverage of the machine code of a step, by one build; `missing` lists uncovered outcomes."""

    build: str
    decisions: int
    missing: tuple[str, ...]

    @property
    def both(self) -> int:
        """Number of decisions with both outcomes covered."""
        return self.decisions - len(self.missing)


@dataclass(frozen=True)
class Cost:
    """Cost of one design on one core.

    `operations` counts the operations of the emitted program by kind; `absent` says what was not measured, and why.
    """

    design: str
    core: str
    period_s: float
    compared: tuple[StepCost, ...]
    sequences: tuple[SequenceCost, ...]
    coverage: tuple[Coverage, ...]
    operations: Mapping[str, int]
    absent: tuple[str, ...]

    def share(self, issued: float) -> float:
        """Return the fraction of the period that these instructions take at one cycle each."""
        return issued / (CLOCK_HZ * self.period_s)

    def ratio(self, figures: StepCost) -> float:
        """Return the mean instructions of a generator relative to the first generator by the same build."""
        first = next(f for f in self.compared if f.build == figures.build)
        return figures.issued.mean / first.issued.mean

    @property
    def most(self) -> Mapping[str, int]:
        """Maximum instructions of any step of the emitted C, by build."""
        return {b: max(m.issued.most for m in self.sequences if m.build == b) for b in self.builds}

    @property
    def builds(self) -> tuple[str, ...]:
        """The builds that were measured."""
        return tuple(dict.fromkeys(m.build for m in self.sequences))

    @property
    def arithmetic(self) -> int:
        """Number of arithmetic operations of the program, both branches of every choice included."""
        return sum(n for name, n in self.operations.items() if not name.startswith(("load", "store", "choice")))

    def document(self) -> Mapping[str, Any]:
        """Return the cost as a JSON document."""
        worst = self.most
        return asdict(self) | {
            "clock_hz": CLOCK_HZ,
            "note": NOTE,
            "ratios": [{"generator": f.generator, "build": f.build, "ratio": self.ratio(f)} for f in self.compared],
            "shares": {build: self.share(most) for build, most in worst.items()},
            "most": worst,
            "instructions_per_operation": {
                f.build: f.issued.mean / self.arithmetic for f in self.compared if f.generator == SYNTH
            },
        }


def summarise(values: NDArray[np.int64]) -> Summary:
    """Return minimum, mean and maximum of a count (N,), N >= 1."""
    return Summary(int(values.min()), float(values.mean()), int(values.max()))


def tables(cost: Cost) -> tuple[Table, ...]:
    """Return the cost as tables, for a terminal or a page."""
    return (
        _comparison_table(cost),
        _memory_table(cost),
        _function_table(cost),
        _sequence_table(cost),
        _coverage_table(cost),
        _operation_table(cost),
    )


def _comparison_table(cost: Cost) -> Table:
    columns = (
        *("generator", "build", "issued", "executed", "ratio", "period, %"),
        *("cycles, estimate", "output error / range"),
    )
    rows = tuple(
        (
            *(f.generator, f.build, str(f.issued), str(f.executed)),
            *(f"{cost.ratio(f):.2f}", f"{100 * cost.share(f.issued.mean):.3g}"),
            *(f"{f.cycles[0].mean:.0f} .. {f.cycles[1].mean:.0f}", f"{f.difference:.1e}"),
        )
        for f in cost.compared
    )
    steps = cost.compared[0].steps
    caption = f"Instructions per step, least .. mean .. most, {cost.core}, over the same {steps} closed-loop steps"
    return Table(caption, columns, rows)


def _memory_table(cost: Cost) -> Table:
    columns = (
        *("generator", "build", "code", "constants", "RAM of libm", "state", "inputs, outputs", "stack", "RAM in all"),
        "double symbols",
    )
    rows = []
    for f in cost.compared:
        m = f.memory
        sizes = (m.code, m.constants, m.data, m.state, m.signals, m.stack, m.working)
        rows.append((f.generator, f.build, *map(str, sizes), str(f.doubles)))
    return Table("Bytes, including the functions of libm that the step calls", columns, tuple(rows))


def _function_table(cost: Cost) -> Table:
    rows = tuple(
        (f.generator, f.build, ", ".join(f"{name} {mean:.0f}" for name, mean in f.functions.items()))
        for f in cost.compared
    )
    return Table(
        "Mean instructions per step by function, the most expensive first", ("generator", "build", "functions"), rows
    )


def _sequence_table(cost: Cost) -> Table:
    by_name: dict[str, list[SequenceCost]] = {}
    for m in cost.sequences:
        by_name.setdefault(m.name, []).append(m)
    rows = [(name, str(parts[0].steps), *(str(m.issued) for m in parts)) for name, parts in by_name.items()]
    rows.append(("most", "", *(f"{n}: {100 * cost.share(n):.3g} % of the period" for n in cost.most.values())))
    caption = "Instructions of the emitted C by sequence: least .. mean .. most"
    return Table(caption, ("sequence", "steps", *cost.builds), tuple(rows))


def _coverage_table(cost: Cost) -> Table:
    rows = tuple((c.build, str(c.decisions), str(c.both), "\n".join(c.missing) or "none") for c in cost.coverage)
    caption = "Decisions in the machine code of the emitted step"
    return Table(caption, ("build", "decisions", "seen both ways", "missing"), rows)


def _operation_table(cost: Cost) -> Table:
    emitted = [f for f in cost.compared if f.generator == SYNTH]
    caption = f"Operations of the program, both branches of every choice: {cost.arithmetic} of arithmetic and logic"
    rows = [(name, str(n)) for name, n in cost.operations.items()]
    rows += [(f"instructions per operation, {f.build}", f"{f.issued.mean / cost.arithmetic:.2f}") for f in emitted]
    return Table(caption, ("operation", "count"), tuple(rows))
