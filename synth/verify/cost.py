"""Cost of a step on a core: instructions, estimated cycles, bytes, and decision coverage.

    issued      fetched instructions, including those predicated false, because the core spends a cycle on each
    executed    instructions that were not predicated false
    share       issued / (clock x period), assuming one cycle per instruction; it is not a worst-case bound

This module holds the data; `meter` measures it.
"""

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

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


class Table(NamedTuple):
    """A caption, columns, and rows of texts."""

    caption: str
    columns: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]


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
