"""Horner's rule for several variables at once: superword parallelism within the program of one machine.

    v_j = c_0 + t_j (c_1 + t_j (c_2 + ...)),   j = 1 .. m     one vector of m variables, the same coefficients

Chains of fused products with the same coefficients, and of which none needs the other, form a group. Each lane of the
vector goes through the operations of its chain, so the bits are the same. Larsen and Amarasinghe, Exploiting Superword
Level Parallelism with Multimedia Instruction Sets, PLDI 2000.
"""

from collections.abc import Sequence
from dataclasses import dataclass

from synth.emit.program.lower import Program

WIDTHS = (2, 4, 8)  # doubles in a vector


@dataclass(frozen=True)
class Chain:
    """v = fma(t, ... fma(t, terms[0], terms[1]) ..., terms[-1]): the nodes of t, of the terms, and of v."""

    variable: int
    terms: tuple[int, ...]
    value: int


Group = tuple[Chain, ...]


def groups(program: Program) -> list[Group]:
    """Return the groups of two to eight chains."""
    chains, levels = _chains(program), _levels(program)
    alike: dict[tuple[int, tuple[int, ...]], list[Chain]] = {}
    for chain in chains:
        alike.setdefault((levels[chain.value], chain.terms), []).append(chain)
    parts = [tuple(each[k : k + WIDTHS[-1]]) for each in alike.values() for k in range(0, len(each), WIDTHS[-1])]
    return [part for part in parts if len(part) > 1]


def schedule(program: Program) -> list[int | Group]:
    """Return the nodes and groups of a memoryless function in an order of computation: each after all that it needs."""
    group_of = {chain.value: group for group in groups(program) for chain in group}
    order: list[int | Group] = []
    done = set[int]()
    waiting = [*program.outputs.values()]
    while waiting:
        k = waiting[-1]
        group = group_of.get(k)
        needs = program.nodes[k].args if group is None else {a for c in group for a in (c.variable, *c.terms)}
        missing = [a for a in needs if a not in done]
        waiting += missing
        if not missing:
            waiting.pop()
        if not missing and k not in done:
            order.append(k if group is None else group)
            done |= {k} if group is None else {chain.value for chain in group}
    return order


def _chains(program: Program) -> list[Chain]:
    """Return the longest chains of at least two fused products whose inner values nothing else reads."""
    users, chains = program.users(), dict[int, Chain]()
    for k, node in enumerate(program.nodes):
        if node.op != "fma":
            continue
        t, a, c = node.args
        before = chains.get(a)
        if before is not None and before.variable == t and users[a] == [k] and a not in program.outputs.values():
            del chains[a]
            chains[k] = Chain(t, (*before.terms, c), k)
        else:
            chains[k] = Chain(t, (a, c), k)
    return [chain for chain in chains.values() if len(chain.terms) > 2]


def _levels(program: Program) -> list[int]:
    """Return for each node the largest number of fused products on a path to it; it grows along every path."""
    levels: list[int] = []
    for node in program.nodes:
        levels.append((node.op == "fma") + max((levels[a] for a in node.args), default=0))
    return levels


def lines(group: Group, number: int, terms: Sequence[str]) -> list[str]:
    """Return the C of a group for one machine, with the `number` in its names; `terms` are doubles in C."""
    width = next(w for w in WIDTHS if w >= len(group))
    variables = [f"n{chain.variable}[0]" for chain in group]
    v, t, q = f"vd{width}", f"t{number}", f"q{number}"
    steps = [f"{q} = {v}_fma({t}, {q}, {v}_all({c}));" for c in terms[1:]]
    return [
        f"const {v} {t} = {{{', '.join(variables + variables[:1] * (width - len(group)))}}};",
        f"{v} {q} = {v}_all({terms[0]});",
        *steps,
        *(f"const vd n{chain.value} = {{{q}[{j}]}};" for j, chain in enumerate(group)),
    ]
