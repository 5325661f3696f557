"""Equations as blocks of a page: definitions and rates of a plant, and the Blocks of a controller in order.

Equations of equal form: shown once, with the names that the others have instead.

Two equations have equal form when renaming the symbols of one, as displayed, gives the other.
"""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace

import sympy as sp
from markupsafe import Markup
from sympy.core.parameters import distribute

from synth import show
from synth.block import Block
from synth.plant import Plant
from synth.report import page
from synth.report.equations import derive, mathml, proof, symbolic
from synth.report.equations.derive import Equation, Group, NamedTerms
from synth.report.notation import number, readable
from synth.signals import Signal, per_second

MIN_OPERATIONS = 4  # operations: shorter equations are shown in full


@dataclass(frozen=True)
class EquationWithCopies:
    """A displayed equation, and the equations of equal form with their replaced names."""

    equation: Equation
    copies: tuple[tuple[Equation, Mapping[str, str]], ...] = ()


@dataclass(frozen=True)
class GroupWithCopies:
    """A displayed group of equations, and the groups of equal form with their replaced names."""

    group: Group
    equations: tuple[EquationWithCopies, ...]
    copies: tuple[tuple[Group, Mapping[str, str]], ...] = ()


def of_groups(groups: Sequence[Group]) -> tuple[GroupWithCopies, ...]:
    """Return the distinct groups, each with the groups of equal form."""
    first: list[tuple[Group, list[tuple[Group, Mapping[str, str]]]]] = []
    for group in groups:
        for source, copies in first:
            if (names := _group_names(source, group)) is not None:
                copies.append((group, names))
                break
        else:
            first.append((group, []))
    return tuple(GroupWithCopies(g, of_equations(g), tuple(copies)) for g, copies in first)


def of_equations(group: Group) -> tuple[EquationWithCopies, ...]:
    """Return the distinct equations of a group, each with the equations of equal form."""
    first: list[tuple[Equation, list[tuple[Equation, Mapping[str, str]]]]] = []
    for equation in group.equations:
        for source, copies in first:
            if sp.count_ops(source.shown) < MIN_OPERATIONS or source.mark != equation.mark:
                continue
            if (names := names_in_place(source, equation)) is not None:
                copies.append((equation, names))
                break
        else:
            first.append((equation, []))
    return tuple(EquationWithCopies(e, tuple(copies)) for e, copies in first)


def names_in_place(source: Equation, other: Equation) -> dict[str, str] | None:
    """Return the renaming that turns the right side of one equation into that of the other, None without one."""
    if source.shape[0] != other.shape[0] or len(source.shape[1]) != len(other.shape[1]):
        return None
    names = dict(zip(source.shape[1], other.shape[1], strict=True))
    changed = {symbolic.symbol(a): symbolic.symbol(b) for a, b in names.items()}
    if source.shown.xreplace(changed) != other.shown:
        return None
    return {a: b for a, b in names.items() if a != b}


def _group_names(source: Group, other: Group) -> dict[str, str] | None:
    """Return the renaming of displayed names that turns one group into the other, None without one."""
    if len(source.equations) != len(other.equations) or source.title == other.title:
        return None
    whole: dict[str, str] = {}
    for a, b in zip(source.equations, other.equations, strict=True):
        names = names_in_place(a, b)
        if names is None or a.mark != b.mark:
            return None
        names = dict(zip(a.shape[1], b.shape[1], strict=True)) | {a.name: b.name}
        if any(whole.get(k, v) != v for k, v in names.items()):
            return None
        whole |= names
    parts = {e.name for e in source.equations if e.signal is None}
    shown = {source.name(a): other.name(b) for a, b in whole.items() if a not in parts}
    return {a: b for a, b in shown.items() if a != b} if len(set(whole.values())) == len(whole) else None


LEGEND = (
    "The equations are derived from the expressions that the C is generated from, and compared with them at "
    f"{proof.POINTS} random points. Unnamed subexpressions are numbered. A number that ends with an ellipsis is "
    "truncated. sat saturates at the lower and upper bound shown with it, or else at the range of the signal; a flag "
    "is 1 if it is true."
)
MAX_SHOWN_EQUATIONS = 12  # largest number of equations of a Block that are not collapsed


def plant(plant: Plant, terms: NamedTerms | None = None) -> tuple[page.Formulas, ...]:
    """Return the equations of a plant, checked by `proof`; `terms` as in `derive.plant`.

    Raises ModelError where the displayed equations differ from the plant.
    """
    with distribute(False):  # no distribution of a factor over a sum
        groups = derive.plant(plant, terms)
        proof.plant(plant, groups, terms)
        return tuple(_formulas(shown) for shown in of_groups(groups))


def block(block: Block, folded: Collection[str] = ()) -> tuple[page.Formulas | page.Folded, ...]:
    """Return the equations of each Block of a composition, checked by `proof`; those named in `folded` are collapsed.

    Raises ModelError where the displayed equations differ from the Block.
    """
    with distribute(False):
        groups = derive.block(block)
        proof.block(block, groups)
        shown = {g.group.title: _formulas(g) for g in of_groups(groups)}
    return tuple(_fold(f) if name in folded or len(f.rows) > MAX_SHOWN_EQUATIONS else f for name, f in shown.items())


def signals(caption: str, signals: Sequence[Signal]) -> show.Table:
    """Return a table of signals: symbol, name in the code, unit, range and meaning."""
    rows = tuple((mathml.symbol(s.name), s.name, readable(s.unit), s.low, s.high, s.about) for s in signals)
    return show.Table(caption, ("symbol", "name", "unit", "from", "to", "is"), rows)


def constants(block: Block) -> show.Table:
    """Return a table of the constants of a Block: name in the code, value, unit and source."""
    rows = tuple((c.name, c.value, readable(c.unit), c.source) for c in block.constants)
    return show.Table("Constants", ("name", "value", "unit", "computed from"), rows, digits=7)


def _fold(formulas: page.Formulas) -> page.Folded:
    title = f"{formulas.title}, {len(formulas.rows)} lines"
    return page.Folded(title, (replace(formulas, title=""),))


def _formulas(shown: GroupWithCopies) -> page.Formulas:
    group = shown.group
    title = f"{group.title}: {group.tag}" if group.tag else group.title
    rows = [row for each in shown.equations for row in _rows(group, each)]
    also = tuple((g.title, Markup(_substitutions(names))) for g, names in shown.copies)
    return page.Formulas(title, tuple(rows), also)


def _rows(group: Group, shown: EquationWithCopies) -> list[page.Formula]:
    equation = shown.equation
    math = mathml.display(group.left(equation), "<mo>=</mo>", group.right(equation))
    rows = [page.Formula(Markup(math), *_unit_and_range(equation))]
    if shown.copies:
        left = "<mo>,</mo>".join(group.left(other) for other, _ in shown.copies)
        rows.append(page.Formula(Markup(mathml.display(left)), "", "", _describe_copies(group, shown)))
    return rows


def _describe_copies(group: Group, shown: EquationWithCopies) -> Markup:
    """Return the names that replace each name of the equation in its copies."""
    changed = list(dict.fromkeys(name for _, names in shown.copies for name in names))
    parts = []
    for name in changed:
        others = "<mo>,</mo>".join(mathml.markup(group.name(names.get(name, name))) for _, names in shown.copies)
        parts.append(f"{mathml.display(others)} for {mathml.display(mathml.markup(group.name(name)))}")
    return Markup("likewise" + (f", with {'; '.join(parts)}" if parts else ""))


def _substitutions(names: Mapping[str, str]) -> str:
    pairs = (f"{mathml.display(mathml.markup(b))} for {mathml.display(mathml.markup(a))}" for a, b in names.items())
    return ", ".join(pairs)


def _unit_and_range(equation: Equation) -> tuple[str, str]:
    signal = equation.signal
    if signal is None:
        return "", ""
    if equation.mark == "rate":
        return readable(per_second(signal.unit)), ""
    return readable(signal.unit), f"{number(signal.low)} … {number(signal.high)}"
