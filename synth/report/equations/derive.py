"""Equations of a plant and of a Block as named SymPy expressions, derived from their CasADi expressions.

    plant   dx/dt = f(x, u, p),  y = h(x, u, p)          Block   x+ = f(x, u, k),  y = h(x, u, k)

Internal signals of a composition keep their names; unnamed subexpressions get names, see `symbolic`.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Literal

import casadi as ca
import sympy as sp

from synth.block import Block
from synth.emit.program import lower
from synth.emit.program.lower import Node
from synth.errors import ModelError
from synth.plant import Plant, symbols
from synth.report.equations import mathml, symbolic
from synth.signals import Signal

Symbols = Mapping[str, ca.SX]
NamedTerms = Callable[[Symbols, Symbols, Symbols], Mapping[str, ca.SX]]
Mark = Literal["", "rate", "next"]


@dataclass(frozen=True)
class Equation:
    """`name` = `expression`, of the Block `owner`; `mark` says if the left side is a rate dx/dt or a next state x+.

    `order` is the position in the computation, `signal` has the declared unit and range. `shape` is the structure of
    the expression without names, and these names.
    """

    name: str
    expression: sp.Expr
    order: int
    shape: tuple[object, tuple[str, ...]]
    owner: str = ""
    mark: Mark = ""
    signal: Signal | None = None

    @property
    def key(self) -> str:
        """A key that identifies the equation."""
        return f"{self.name} {self.mark}".strip()

    @property
    def limits(self) -> tuple[float, float] | None:
        """The range of its signal, which a saturation displayed without bounds refers to; None without a signal."""
        return None if self.signal is None else (self.signal.low, self.signal.high)

    @property
    def shown(self) -> sp.Expr:
        """The displayed right side: a saturation at the range of the signal has no bounds."""
        sat = symbolic.opaque("sat")
        unbounded = {
            limited: sat(limited.args[0])
            for limited in sp.preorder_traversal(self.expression)
            if type(limited).__name__ == "sat" and _bounds(limited) == self.limits
        }
        return self.expression.xreplace(unbounded)


def _bounds(limited: sp.Expr) -> tuple[float, ...]:
    return tuple(float(b) for b in limited.args[1:] if b.is_number)


@dataclass(frozen=True)
class Group:
    """Equations of one Block or of a plant; `local` maps names to displayed names that differ."""

    title: str
    equations: tuple[Equation, ...]
    tag: str = ""
    local: Mapping[str, str] = field(default_factory=dict)

    def name(self, name: str) -> str:
        """Return the displayed form of a name."""
        return self.local.get(name, name)

    def left(self, equation: Equation) -> str:
        """Return the left side of an equation as MathML."""
        name = mathml.markup(self.name(equation.name))
        if equation.mark == "rate":
            return f'<mover accent="true">{name}<mo>˙</mo></mover>'
        return f"<msup><mrow>{name}</mrow><mo>+</mo></msup>" if equation.mark == "next" else name

    def shown(self, equation: Equation) -> sp.Expr:
        """Return the right side of an equation in displayed names."""
        shown = equation.shown
        return shown.xreplace({s: symbolic.symbol(self.name(s.name)) for s in shown.free_symbols})

    def right(self, equation: Equation) -> str:
        """Return the right side of an equation as MathML."""
        return mathml.expression(self.shown(equation))


def plant_function(plant: Plant, terms: NamedTerms | None = None) -> tuple[ca.Function, dict[str, int]]:
    """Return a plant as a function of one column (x, u, p), and the row of each result by name.

    The results are the expressions of `terms`, the rates, as ``<state> rate``, and the outputs.
    """
    x, u, p = symbols(plant.states), symbols(plant.inputs), symbols(plant.parameters)
    inside = dict(terms(x, u, p)) if terms else {}
    columns = [[*group.values()] for group in (x, u, p)]
    vectors = [ca.vcat(column) for column in columns]
    exprs = [*(ca.SX(e) for e in inside.values()), plant.f(*vectors), plant.h(*vectors)]
    names = [*inside, *(f"{s.name} rate" for s in plant.states), *(s.name for s in plant.outputs)]
    f = ca.Function("plant", [ca.vcat([symbol for column in columns for symbol in column])], [ca.vcat(exprs)])
    return f, {name: k for k, name in enumerate(names)}


def plant(plant: Plant, terms: NamedTerms | None = None) -> tuple[Group, ...]:
    """Return the definitions of a plant, and the derivatives of its states.

    `terms(x, u, p)` gives names to expressions that the physics computes, such as forces.

    Raises ModelError for a named expression that the physics does not compute.
    """
    f, places = plant_function(plant, terms)
    loads = [("load", s.name) for group in (plant.states, plant.inputs, plant.parameters) for s in group]
    nodes, results = lower.walk(f, loads, {}, symbolic.UNARY_TOO, symbolic.BINARY_TOO)
    at = {name: results[k] for name, k in places.items()}
    rates, outputs = {s: at.pop(f"{s.name} rate") for s in plant.states}, {s.name: s for s in plant.outputs}
    names = {k: n.name for k, n in enumerate(nodes) if n.op == "load"}
    ends = [*rates.values(), *(at[name] for name in outputs)]
    needed, _ = symbolic.live(nodes, ends)
    if unused := [name for name, k in at.items() if k not in needed]:
        raise ModelError(
            f"the physics of plant '{plant.name}' does not compute {', '.join(unused)}: name what it computes, built "
            "in the same way"
        )
    inside = _definitions(nodes, names, at, ends, outputs)
    states = {s.name for s in plant.states}
    inside = [e for e in inside if e.name not in states]  # a state that is also an output
    cut = _name_nodes(nodes, names, at, ends)
    moving = tuple(
        Equation(s.name, symbolic.expression(nodes, cut, k), k, symbolic.shape(nodes, cut, k), "", "rate", s)
        for s, k in rates.items()
    )
    groups = (Group("Definitions", tuple(inside)), Group("States", moving))
    return tuple(_with_distinct_names(g) for g in groups if g.equations)


def block(block: Block) -> tuple[Group, ...]:
    """Return the equations of a Block: for each Block of the composition its signals and its next states."""
    program = lower.program(block)
    nodes = program.nodes
    names = {k: n.name for k, n in enumerate(nodes) if n.op in ("input", "state", "constant")}
    marked = {named.signal.name: named for named, _ in program.marks}
    at = {named.signal.name: k for named, k in program.marks}
    ends = [*at.values(), *program.next.values()]
    inside = _definitions(nodes, names, at, ends, {name: named.signal for name, named in marked.items()})
    inside = [replace(e, owner=marked[e.name].block) if e.name in marked else e for e in inside]
    signals, cut = {s.name: s.signal for s in block.states}, _name_nodes(nodes, names, at, ends)
    next_states = [
        Equation(
            n,
            symbolic.symbol(cut[k]) if k in cut else symbolic.expression(nodes, cut, k),
            k,
            symbolic.shape(nodes, cut, k, signals[n]),
            program.owner(n),
            "next",
            signals[n],
        )
        for n, k in program.next.items()
    ]
    tags = {named.block: named.tag for named, _ in block.computed_signals}
    equations = [*_assign_owners(inside, next_states), *next_states]
    owners = dict.fromkeys([*program.titles, *(e.owner for e in equations)])
    private = [s.name for s in block.states] + [c.name for c in block.constants]
    groups = []
    for owner in owners:
        members = tuple(e for e in equations if e.owner == owner)
        local = {n: n[len(owner) + 1 :] for n in private if owner and n.startswith(f"{owner}_")}
        if members:
            groups.append(_with_distinct_names(Group(owner or block.name, members, tags.get(owner, ""), local)))
    return tuple(groups)


def _name_nodes(
    nodes: Sequence[Node], names: Mapping[int, str], at: Mapping[str, int], ends: Sequence[int]
) -> dict[int, str]:
    """Return the names of loads, named values and further parts by node; the first name of a node counts."""
    first = {k: name for name, k in reversed([*at.items()])}
    return symbolic.name_parts(nodes, first | dict(names), ends)


def _definitions(
    nodes: Sequence[Node],
    names: Mapping[int, str],
    at: Mapping[str, int],
    ends: Sequence[int],
    signals: Mapping[str, Signal],
) -> list[Equation]:
    """Return the definition of each named value and part in the order of computation, and of further names."""
    cut = _name_nodes(nodes, names, at, ends)
    needed, _ = symbolic.live(nodes, ends)
    equations = []
    for k in needed:
        if k in cut and k not in names and nodes[k].args:
            signal = signals.get(cut[k])
            shape = symbolic.shape(nodes, cut, k, signal)
            equations.append(Equation(cut[k], symbolic.expression(nodes, cut, k), k, shape, signal=signal))
    for name, k in at.items():
        if cut.get(k, name) != name:
            equations.append(Equation(name, symbolic.symbol(cut[k]), k, ("same", (cut[k],)), signal=signals.get(name)))
        elif not nodes[k].args and k not in names:
            equations.append(Equation(name, symbolic.expression(nodes, {}, k), k, (name, ()), signal=signals.get(name)))
    return equations


def _assign_owners(inside: Sequence[Equation], next_states: Sequence[Equation]) -> list[Equation]:
    """Return definitions in which each part without an owner belongs to the last Block that reads it."""
    owner = {e.name: e.owner for e in inside if e.owner}
    signals = set(owner)
    for e in sorted([*inside, *next_states], key=lambda e: -e.order):
        equation_owner = e.owner or owner.get(e.name, "")
        for s in e.expression.free_symbols:
            if s.name not in signals and equation_owner:
                owner[s.name] = equation_owner
    return [replace(e, owner=owner.get(e.name, "")) for e in inside]


def _with_distinct_names(group: Group) -> Group:
    """Return a group whose displayed names all differ: of two equal ones the second is written literally."""
    names = {e.name for e in group.equations} | {s.name for e in group.equations for s in e.expression.free_symbols}
    local: dict[str, str] = {}
    used: set[str] = set()
    for name in sorted(names, key=lambda n: (n in group.local, n)):
        choices = (text for text in (group.name(name), name, f"={name}") if mathml.markup(text) not in used)
        local[name] = next(choices)
        used.add(mathml.markup(local[name]))
    return replace(group, local={name: text for name, text in local.items() if text != name})
