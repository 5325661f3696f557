"""Grouping: the statements of a Block stand together, and whatever the order, none comes before what it needs."""

import random
from collections.abc import Sequence
from itertools import groupby
from typing import Any

import casadi as ca
import pytest

from synth.block import Block, State, Step, build
from synth.composition import compose
from synth.emit.passes import fold, grouping, schedule
from synth.emit.passes.outline import Branch, Let, Owners, Statement, Store, reads
from synth.emit.program import lower
from synth.emit.program.lower import Program
from tests.emit.dyadic import TIME, signal


def chains(names: Sequence[str] = ("x", "y", "z")) -> Block:
    """Return Blocks that each compute a chain of signals and a state, declared in turns: x1, y1, z1, x2, ..."""

    def law(u: Any, x: Any, k: Any, name: str) -> Step:
        first = u[f"e_{name}"] * 2 + x["s"]
        second = first * u[f"e_{name}"] + 0.25
        return Step({f"w_{name}": second * first - x["s"]}, {"s": ca.fmax(ca.fmin(second, 4), -4)})

    blocks = [
        build(
            name,
            TIME,
            lambda u, x, k, name=name: law(u, x, k, name),
            inputs=[signal(f"e_{name}")],
            outputs=[signal(f"w_{name}", -1e6, 1e6)],
            states=[State(signal("s", -4, 4), 0)],
        )
        for name in names
    ]
    return compose("chains", blocks, inputs=[f"e_{n}" for n in names], outputs=[f"w_{n}" for n in names])


def faults(p: Program, block: Sequence[Statement], first_only: bool = False) -> list[str]:
    """Return what comes before its operands, and loads of a state that come behind its store."""
    looked = block[:1] if first_only else block
    places = {s.node: i for i, s in enumerate(block) if isinstance(s, Let)}
    places |= {c: i for i, s in enumerate(block) if isinstance(s, Branch) for c, _ in s.choices}
    early = [f"{i} before {k}" for i, s in enumerate(looked) for k in reads(p, [s]) if places.get(k, -1) > i]
    loads = {
        p.nodes[s.node].name: i for i, s in enumerate(block) if isinstance(s, Let) and p.nodes[s.node].op == "state"
    }
    late = [
        s.name
        for i, s in enumerate(looked)
        if isinstance(s, Store) and s.struct == "state" and loads.get(s.name, -1) > i
    ]
    return early + late


def sections(p: Program, block: Sequence[Statement]) -> int:
    owners = [Owners(p).main(s) for s in block if not (isinstance(s, Let) and p.nodes[s.node].op in ("state", "input"))]
    return len([owner for owner, _ in groupby(owners)])


def in_turns(p: Program, block: Sequence[Statement], seed: int) -> list[Statement]:
    """Return the statements in a random order in which each comes behind what it needs."""
    left, order, rng = list(block), list[Statement](), random.Random(seed)
    while left:
        free = [i for i, s in enumerate(left) if not faults(p, [s, *left[:i], *left[i + 1 :]], first_only=True)]
        order.append(left.pop(rng.choice(free)))
    return order


@pytest.mark.parametrize("seed", range(8))
def test_statements_of_a_block_stand_together_behind_what_they_need(seed: int) -> None:
    p = fold.folded(lower.program(chains()))
    mixed = in_turns(p, schedule.statements(p), seed)
    made = grouping.in_groups(p, mixed, Owners(p))
    assert not faults(p, mixed) and not faults(p, made)
    assert sorted(map(repr, made)) == sorted(map(repr, mixed))
    assert sections(p, made) == 3 < sections(p, mixed)


def test_a_planted_order_is_found() -> None:
    p = fold.folded(lower.program(chains()))
    made = schedule.statements(p)
    assert not faults(p, made) and faults(p, made[::-1])
    store = next(s for s in made if isinstance(s, Store) and s.struct == "state")
    load = next(s for s in made if isinstance(s, Let) and p.nodes[s.node] == lower.Node("state", name=store.name))
    assert faults(p, [s for s in made if s is not load] + [load])
