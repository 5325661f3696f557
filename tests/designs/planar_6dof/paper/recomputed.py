"""Rows of the audit of Y recomputed alone, from another plant or another print, and what each row follows from."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace

import numpy as np

from designs.planar_6dof.paper import rows
from models import planar_stage
from synth.plant import Plant
from synth.report import audit
from synth.report.audit import Published, Row

PLANT, PRINTED = planar_stage.plant(), rows.published_rows()
RECORDED = {"Y-34", "Y-35", "Y-40", "Y-41"}  # rows of a loop's records
INSENSITIVE = {  # by row: what its formulas name, but 1 % of it moves no figure
    "Y-12": {"Y-5.per_ampere", "Y-6.per_ampere"},  # H is that of an observer: no input enters it
    "Y-26": {"a"},  # motor C is longer than the motors A and B beside each other
    "Y-32": {
        "Izz",
        *(f"Y-{n}.{name}" for n in (7, 8) for name in ("gain", "lead", "lag", "reset")),
    },  # stable is stable
    "Y-37": {"Y-5.per_ampere", "Y-6.per_ampere", "Y-7.rate_lqg"},  # what is pushed at all is moved
    "Y-39": {"Y-39.p0"},  # a large one is soon forgotten
}

Prints = Mapping[str, Published]


def ids(optimal: bool) -> list[str]:
    """Return the rows of the stage that belong to one of the designs."""
    return [name for name in PRINTED if name not in RECORDED and (name in rows.OPTIMAL) == optimal]


def numbers(names: Sequence[str]) -> list[str]:
    """Return what some rows print, such as Y-4.G."""
    return [f"{name}.{number}" for name in names for number in PRINTED[name].numbers]


def one(name: str, plant: Plant = PLANT, published: Prints = PRINTED) -> Row:
    return audit.recompute(published[name], rows.scope(plant, published))


def recorded(name: str, **functions: Callable[..., object]) -> Row:
    """Return a row of records that some functions give in place of a loop."""
    scope = rows.scope()
    return audit.recompute(PRINTED[name], replace(scope, functions={**scope.functions, **functions}))


def readers(names: Sequence[str]) -> dict[str, set[str]]:
    """Return for each row what its formulas name: it cannot depend on another printed number."""
    return {name: {n for formula in PRINTED[name].computed.values() for n in formula.identifiers} for name in names}


def with_other_digits(texts: Mapping[str, str]) -> dict[str, Published]:
    """Return what is printed with other digits for some numbers, such as {"Y-4.G": "2e-5"}."""
    published = dict(PRINTED)
    for source, text in texts.items():
        name, number = source.split(".")
        of = published[name]
        published[name] = replace(of, numbers={**of.numbers, number: replace(of[number], text=text)})
    return published


def differs(before: Row, after: Row) -> bool:
    """Whether a figure changed by more than rounding, or came to exist or ceased to."""
    old, new = (np.array([f.value for f in r.recomputed]) for r in (before, after))
    return not np.allclose(old, new, rtol=1e-7, atol=1e-12, equal_nan=True)


def wrong_dependences(before: Mapping[str, Row], after: Mapping[str, Row], source: str) -> list[str]:
    """Return the rows that moved without declaring the source, or declare it and did not move."""
    wrong = {n: (differs(before[n], r), source in r.depends) for n, r in after.items()}
    return [n for n, (moves, declared) in wrong.items() if moves != (declared and source not in INSENSITIVE.get(n, ()))]


def assert_a_number_moves_what_depends_on_it(
    nominal: Mapping[str, Row], reads: Mapping[str, set[str]], source: str
) -> set[str]:
    """Check each row that reads a printed number against a print with 1 % more; return which these are."""
    name, number = source.split(".")
    other = with_other_digits({source: repr(PRINTED[name][number].value * 1.01)})
    after = {n: one(n, published=other) for n, seen in reads.items() if source in seen}
    assert not wrong_dependences(nominal, after, source)
    assert {n for n, r in nominal.items() if source in r.depends} <= set(after)
    return set(after)
