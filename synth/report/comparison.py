"""Section on two designs of one stage side by side: experiments on the same machines, margins, and instructions."""

from collections.abc import Mapping
from dataclasses import dataclass

from synth import show
from synth.analyse.loops import robustness
from synth.report import page
from synth.report.page import Section, Text
from synth.show import Table
from synth.simulate import study
from synth.simulate.study import StudyTable, Summary
from synth.verify.cost import Cost

TITLE = "Comparison"
ABOUT = (
    "Both designs run the same experiments on the same machines, drawn within the tolerances. Nominal: the machine "
    "without deviations. 95 %: the value that 95 % of the machines do not exceed. Worst: the largest value, a lower "
    "bound of the worst case. The limits of the designs may differ, so their yields need not compare."
)
MARGINS = (
    "The least over the operating points and the corners of the tolerances; the disk margin is the certified lower "
    "bound of the nominal plant with all actuators and sensors varied at once."
)
STATISTICS = ("nominal", "95 %", "worst")


@dataclass(frozen=True, eq=False)
class Side:
    """One of the designs: its study, its least margins by name, and the cost of its step, None if not measured."""

    name: str
    study: StudyTable
    margins: Mapping[str, float]
    cost: Cost | None


def tables(sides: tuple[Side, Side]) -> tuple[Table, ...]:
    """Return the tables of limited values, other values, margins, and instructions where both were measured."""
    first, second = sides
    margins = tuple((_with_unit(n), v, second.margins[n]) for n, v in first.margins.items() if n in second.margins)
    columns = ("what", "unit", *(f"{statistic} {letter}" for statistic in STATISTICS for letter in "AB"))
    limits = {**first.study.limits, **second.study.limits}
    values = {row[0]: row for row in _experiments(first.study, second.study)}
    limited, others = (tuple(row for n, row in values.items() if (n in limits) == is_in) for is_in in (True, False))
    captions = f"Limited values on {len(first.study.rows)} machines: A {first.name}, B {second.name}", "Other values"
    return (
        *(Table(caption, columns, rows, 3) for caption, rows in zip(captions, (limited, others), strict=True)),
        Table("Least margins", ("margin", first.name, second.name), margins),
        *_instructions(sides),
    )


def _with_unit(margin: str) -> str:
    unit = robustness.REQUIREMENTS[margin].unit if margin in robustness.REQUIREMENTS else "1"
    return margin.replace("_", " ") + ("" if unit == "1" else f", {unit}")


def _experiments(*studies: StudyTable) -> tuple[tuple[show.Cell, ...], ...]:
    """Return a row for each value of an experiment that one of the designs has, as most have both."""
    first, second = ({s.name: s for s in study.summarise(table)} for table in studies)
    return tuple(_row(name, first.get(name), second.get(name)) for name in dict.fromkeys([*first, *second]))


def _row(name: str, *summaries: Summary | None) -> tuple[show.Cell, ...]:
    unit = next(s.unit for s in summaries if s)
    values = [(s.nominal, s.percentile_95, s.worst) if s else ("",) * len(STATISTICS) for s in summaries]
    return (name, unit, *(value for pair in zip(*values, strict=True) for value in pair))


def _instructions(sides: tuple[Side, Side]) -> tuple[Table, ...]:
    first, second = (_means(side.cost) for side in sides)
    rows = tuple((*key, first[key], second[key], second[key] / first[key]) for key in first if key in second)
    columns = ("C", "build", *(side.name for side in sides), "ratio")
    return (Table("Mean instructions of a step, Cortex-M4F", columns, rows),) if rows else ()


def _means(cost: Cost | None) -> dict[tuple[str, str], float]:
    """Return the mean issued instructions by generator and build, of what this toolkit emits."""
    compared = cost.compared if cost else ()
    return {(c.generator, c.build): c.issued.mean for c in compared if c.generator.startswith("synth")}


def notes(sides: tuple[Side, Side]) -> list[str]:
    """Return the yields as sentences, and why machines have no result."""
    return [f"{side.name}: {note}" for side in sides for note in study.yield_notes(side.study)]


def section(sides: tuple[Side, Side]) -> Section:
    """Return the section: what is compared, the yields, and the tables."""
    limited, others, margins, *instructions = tables(sides)
    text = Text("\n\n".join([ABOUT, *notes(sides)]))
    return Section(TITLE, (text, limited, Text(MARGINS), margins, *instructions, others))


def page_text(sides: tuple[Side, Side]) -> str:
    """Return a page with the section alone, as HTML."""
    first, second = sides
    return page.render(page.Report(second.name, f"Comparison with {first.name}", (section(sides),)))
