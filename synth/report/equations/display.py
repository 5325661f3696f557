"""Equations as blocks of a page: definitions and rates of a plant, and the Blocks of a controller in order."""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace

from markupsafe import Markup
from sympy.core.parameters import distribute

from synth.block import Block
from synth.plant import Plant
from synth.report import page
from synth.report.equations import copies, derive, glyphs, mathml, proof
from synth.report.equations.copies import EquationWithCopies, GroupWithCopies
from synth.report.equations.derive import Equation, Group, NamedTerms
from synth.report.notation import number, readable
from synth.signals import Signal, per_second

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
        return tuple(_formulas(shown) for shown in copies.of_groups(groups))


def block(block: Block, folded: Collection[str] = ()) -> tuple[page.Formulas | page.Folded, ...]:
    """Return the equations of each Block of a composition, checked by `proof`; those named in `folded` are collapsed.

    Raises ModelError where the displayed equations differ from the Block.
    """
    with distribute(False):
        groups = derive.block(block)
        proof.block(block, groups)
        shown = {g.group.title: _formulas(g) for g in copies.of_groups(groups)}
    return tuple(_fold(f) if name in folded or len(f.rows) > MAX_SHOWN_EQUATIONS else f for name, f in shown.items())


def signals(caption: str, signals: Sequence[Signal]) -> page.Table:
    """Return a table of signals: symbol, name in the code, unit, range and meaning."""
    rows = tuple((glyphs.symbol(s.name), s.name, readable(s.unit), s.low, s.high, s.about) for s in signals)
    return page.Table(caption, ("symbol", "name", "unit", "from", "to", "is"), rows)


def constants(block: Block) -> page.Table:
    """Return a table of the constants of a Block: name in the code, value, unit and source."""
    rows = tuple((c.name, c.value, readable(c.unit), c.source) for c in block.constants)
    return page.Table("Constants", ("name", "value", "unit", "computed from"), rows, digits=7)


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
        others = "<mo>,</mo>".join(glyphs.markup(group.name(names.get(name, name))) for _, names in shown.copies)
        parts.append(f"{mathml.display(others)} for {mathml.display(glyphs.markup(group.name(name)))}")
    return Markup("likewise" + (f", with {'; '.join(parts)}" if parts else ""))


def _substitutions(names: Mapping[str, str]) -> str:
    pairs = (f"{mathml.display(glyphs.markup(b))} for {mathml.display(glyphs.markup(a))}" for a, b in names.items())
    return ", ".join(pairs)


def _unit_and_range(equation: Equation) -> tuple[str, str]:
    signal = equation.signal
    if signal is None:
        return "", ""
    if equation.mark == "rate":
        return readable(per_second(signal.unit)), ""
    return readable(signal.unit), f"{number(signal.low)} … {number(signal.high)}"
