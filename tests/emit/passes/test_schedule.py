"""Schedules, executed: statements that load, store and branch give what the program gives, node by node.

The machine's states change as they are stored, so that a state that is loaded too late is found out.
"""

from collections import ChainMap
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache
from itertools import chain
from typing import Any

import casadi as ca
import numpy as np
import pytest

from synth.block import Block, State, Step
from synth.emit import pipeline
from synth.emit.passes import fold, schedule
from synth.emit.passes.schedule import Assign, Branch, Let, Regions, Statement, Store
from synth.emit.pipeline import Reduced
from synth.emit.program import lower
from synth.emit.program.lower import Program
from tests.emit import dyadic, hazards
from tests.emit.dyadic import signal
from tests.emit.semantics import interpret, value

SEEDS = range(80)


@dataclass
class Machine:
    """Executes statements; its asserts express what every schedule must satisfy."""

    program: Program
    memory: dict[str, Any]
    stored: dict[tuple[str, str], Any] = field(default_factory=dict)
    computed: set[int] = field(default_factory=set)

    def block(self, statements: Sequence[Statement], known: ChainMap[int, Any]) -> None:
        for s in statements:
            if isinstance(s, Let):
                assert s.node not in self.computed, "computed twice"
                self.computed.add(s.node)
                node = self.program.nodes[s.node]
                assert node.op != "state" or ("state", node.name) not in self.stored, "loaded after it is stored"
                known[s.node] = value(node, [self.read(a, known) for a in node.args], self.memory)
            elif isinstance(s, Store):
                assert (s.struct, s.name) not in self.stored, "stored twice"
                self.stored[s.struct, s.name] = self.read(s.node, known)
                if s.struct == "state":
                    self.memory[s.name] = self.read(s.node, known)
            elif isinstance(s, Assign):
                self.assign(s, known)
            elif isinstance(s, Branch):
                self.branch(s, known)

    def branch(self, s: Branch, known: ChainMap[int, Any]) -> None:
        for choice, start in s.choices:
            known[choice] = None if start is None else self.read(start, known)
        side = s.then if self.read(s.condition, known) != 0 else s.other
        self.block(side, known.new_child())

    def assign(self, s: Assign, known: ChainMap[int, Any]) -> None:
        scope = next(scope for scope in known.maps if s.choice in scope)
        assert scope is not known.maps[0], "assigned where it is declared"
        scope[s.choice] = self.read(s.node, known)

    def read(self, k: int, known: ChainMap[int, Any]) -> Any:
        node = self.program.nodes[k]
        if node.op in schedule.INLINE:
            return value(node, [], self.memory)
        assert known[k] is not None, "read before it is assigned"
        return known[k]


def execute(program: Program, statements: Sequence[Statement], loads: Mapping[str, Any]) -> dict[str, Any]:
    """Return outputs, next states and word after the statements of a program."""
    machine = Machine(program, dict(loads))
    machine.block(statements, ChainMap())
    stored = {f"next {n}": machine.memory[n] for n in program.next}
    stored |= {n: machine.stored.get(("out", n)) for n in program.outputs}
    return stored | {"word": machine.stored.get(("word", ""))}


def reference_results(program: Program, loads: Mapping[str, Any]) -> dict[str, Any]:
    values = interpret(program, loads)
    results = {f"next {n}": values[k] for n, k in program.next.items()} | {
        n: values[k] for n, k in program.outputs.items()
    }
    return results | {"word": None if program.word is None else values[program.word]}


def lower_block(block: Block) -> Program:
    return fold.folded(lower.program(block))


@cache
def random_block(make: Callable[[int], Block], seed: int) -> Block:
    return make(seed)


def reduce(block: Block) -> Reduced:
    return pipeline.reduce(block, np.float64, libm=True)


def is_right(printed: Reduced) -> bool:
    """Whether the statements of a program pass the machine and give what the program gives."""
    program, block = printed.program, printed.block
    x, u = dyadic.samples(block, 12)
    try:
        statements = schedule.statements(program)
        for k in range(x.shape[1]):
            loads = {s.name: float(v) for s, v in zip(block.states, x[:, k], strict=True)}
            loads |= {s.name: float(v) for s, v in zip(block.inputs, u[:, k], strict=True)}
            loads |= {c.name: c.value for c in block.constants}
            if execute(program, statements, loads) != reference_results(program, loads):
                return False
    except (AssertionError, KeyError):
        return False
    return True


def defects(blocks: Sequence[Block]) -> list[str]:
    """Return the names of Blocks whose statements fail the machine or give something else than the program."""
    return [block.name for block in blocks if not is_right(reduce(block))]


@pytest.mark.slow
def test_hazards_are_scheduled_right() -> None:
    assert not defects(hazards.BLOCKS)


@pytest.mark.slow
def test_random_blocks_are_scheduled_right() -> None:
    makers = dyadic.random_block, dyadic.random_holding_block
    reduced = [reduce(random_block(makers[seed // 4 % 2], seed)) for seed in SEEDS]
    assert not [printed.block.name for printed in reduced if not is_right(printed)]
    branches = [s for r in reduced for s in everywhere(schedule.statements(r.program)) if isinstance(s, Branch)]
    assert len(branches) > 100 and any(isinstance(s, Branch) for b in branches for s in (*b.then, *b.other))


def stored_at_once(self: Any, d: Any) -> None:
    """Meet a demand without loading the old value of its state first."""
    if d in self.pending:
        self._compute(d.node)
        if d in self.pending:
            del self.pending[d]
            self.out.append(schedule._store_statement(d))


def held_though_it_decides(self: Any, choice: int, k: int) -> bool:
    """Treat a state that a choice holds as unread although it is also the condition."""
    places = [d.destination for d in self.demands.get(choice, ())]
    alone = self.p.nodes[choice].args[1:].count(k) == 1 and not self.is_read(choice)
    return alone and all(self.is_load(k, q) for q in places)


PLANTED: dict[str, Callable[..., Any]] = {
    "_meet": stored_at_once,
    "_only_keeps": held_though_it_decides,
    "_states_stored_first": lambda self, choices: set(),
    "_skips_operand": lambda self, user, k, chosen: (
        user in self.written_of or (user in chosen and self._only_keeps(user, k))
    ),
    "is_read": lambda self, choice: False,
    "is_load": lambda self, k, place: place[0] == "state" and self.p.nodes[k].op == "state",
}


@pytest.mark.slow
@pytest.mark.parametrize("name", PLANTED)
def test_a_planted_defect_is_found(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    makers = dyadic.random_block, dyadic.random_holding_block
    drawn = (random_block(make, seed) for seed in SEEDS[:40] for make in makers)  # up to the first that finds it
    monkeypatch.setattr(schedule._Level if name == "_meet" else Regions, name, PLANTED[name])
    assert any(defects([b]) for b in chain(hazards.BLOCKS, drawn))


def everywhere(statements: Sequence[Statement]) -> Iterator[Statement]:
    for s in statements:
        yield s
        if isinstance(s, Branch):
            yield from everywhere((*s.then, *s.other))


def operations(program: Program, statements: Sequence[Statement]) -> set[str]:
    return {program.nodes[s.node].op for s in everywhere(statements) if isinstance(s, Let)}


def stores(statements: Sequence[Statement]) -> list[str]:
    return [s.name for s in everywhere(statements) if isinstance(s, Store)]


def only_branch(statements: Sequence[Statement]) -> Branch:
    (branch,) = (s for s in statements if isinstance(s, Branch))
    return branch


def one(law: Callable[..., Step], outputs: str = "y", states: Sequence[State] = ()) -> Program:
    return lower_block(hazards.make("one", law, outputs, states))


def unlimited(program: Program) -> Program:
    """Return a program without the limits, which range analysis drops: the next states are the choices themselves."""
    return program.substituted({k: n.args[0] for k, n in enumerate(program.nodes) if n.op in ("min", "max", "clamp")})


def test_a_value_that_one_side_needs_is_computed_on_that_side_only() -> None:
    def law(u: Any, x: Any, k: Any) -> Step:
        a, b, c = u["a"], u["b"], u["c"]
        both = ca.exp(a) + 1
        return Step({"y": ca.if_else(a < b, ca.sin(c) * both, ca.cos(c) - both), "z": ca.if_else(a < b, ca.tanh(c), c)})

    program = one(law, "y z")
    statements = schedule.statements(program)
    branch = only_branch(statements)
    assert operations(program, branch.then) >= {"sin", "tanh"} and operations(program, branch.other) >= {"cos"}
    outside = operations(program, [s for s in statements if not isinstance(s, Branch)])
    assert "exp" in outside and not outside & {"sin", "cos", "tanh"}
    assert stores(branch.then) == stores(branch.other) == ["y", "z"]


def test_a_value_that_is_used_elsewhere_is_computed_outside() -> None:
    def law(u: Any, x: Any, k: Any) -> Step:
        s = ca.sin(u["c"])
        return Step({"y": ca.if_else(u["a"] < u["b"], s * 3 + u["a"] * 5, u["c"] * 7 - 1), "z": s})

    program = one(law, "y z")
    branch = only_branch(schedule.statements(program))
    assert "sin" not in operations(program, (*branch.then, *branch.other))


def test_a_side_that_holds_a_state_does_not_store_it() -> None:
    def law(u: Any, x: Any, k: Any) -> Step:
        go = u["a"] < u["b"]
        return Step({"y": x["x"]}, {"x": ca.if_else(go, u["c"], x["x"]), "z": ca.if_else(go, x["z"], u["b"])})

    states = [State(signal(n, -4, 4), 0) for n in ("x", "z")]
    program = unlimited(one(law, states=states))
    branch = only_branch(schedule.statements(program))
    assert (stores(branch.then), stores(branch.other)) == (["x"], ["z"])
    assert [n for n in stores(schedule.statements(program)) if n in ("x", "z")] == ["x", "z"]


def test_an_unchanged_state_is_neither_loaded_nor_stored() -> None:
    program = Program((lower.Node("state", name="x"), lower.Node("input", name="a")), (), {"y": 1}, {"x": 0})
    assert schedule.statements(program) == (Let(1), Store("out", "y", 1))


def test_a_short_choice_stays_a_choice() -> None:
    program = one(lambda u, x, k: Step({"y": ca.if_else(u["a"] < u["b"], u["a"], 2 * u["b"])}))
    assert not any(isinstance(s, Branch) for s in schedule.statements(program))


@pytest.mark.parametrize("count", [2, 3])
def test_more_than_two_short_choices_become_an_if(count: int) -> None:
    names = "pqr"[:count]

    def law(u: Any, x: Any, k: Any) -> Step:
        return Step({n: ca.if_else(u["a"] < u["b"], u[first], 0.5) for n, first in zip(names, "abc", strict=False)})

    branches = [s for s in schedule.statements(one(law, " ".join(names))) if isinstance(s, Branch)]
    assert len(branches) == (count > 2)


def loads(program: Program, statements: Sequence[Statement]) -> list[str]:
    nodes = [program.nodes[s.node] for s in everywhere(statements) if isinstance(s, Let)]
    return [n.name for n in nodes if n.op == "state"]


def test_a_state_is_loaded_on_the_side_that_reads_it_if_it_is_stored_later() -> None:
    def law(u: Any, x: Any, k: Any) -> Step:
        a, b, c = u["a"], u["b"], u["c"]
        inner = ca.if_else(b < c, ca.sin(x["late"]) * b, ca.exp(c) * b)
        y = ca.if_else(a < b, inner, c)
        return Step({"y": y, "z": ca.if_else(a < b, ca.cos(x["early"]), c)}, {"late": y, "early": c})

    program = unlimited(one(law, "y z", hazards.real("late", "early")))
    statements = schedule.statements(program)
    branch = only_branch(statements)
    assert loads(program, only_branch(branch.then).then) == loads(program, branch.then) == ["late"]
    assert loads(program, [s for s in statements if s is not branch]) == ["early"]


def test_a_state_held_by_another_if_is_loaded_where_it_is_read() -> None:
    def law(u: Any, x: Any, k: Any) -> Step:
        read, turn, latched = u["a"] < 0, u["b"] < 0, u["c"] < 0
        y = ca.if_else(read, ca.sin(x["x"]) * u["b"], u["c"])
        return Step({"y": y}, {"x": ca.if_else(latched, x["x"], ca.if_else(turn, ca.cos(y), x["x"]))})

    program = unlimited(one(law, states=hazards.real("x")))
    statements = schedule.statements(program)
    first, second = (s for s in statements if isinstance(s, Branch))
    assert loads(program, first.then) == loads(program, statements) == ["x"]
    assert depth([second]) == 2 and stores([second]) == ["x"]


def depth(statements: Sequence[Statement]) -> int:
    return max((1 + depth((*s.then, *s.other)) for s in statements if isinstance(s, Branch)), default=0)


def test_choices_inside_a_side_become_ifs_there() -> None:
    def law(u: Any, x: Any, k: Any) -> Step:
        y = ca.sin(u["a"]) * u["b"]
        for i in range(6):
            y = ca.if_else(u["a"] < i, y + ca.cos(u["b"] * (i + 2)), ca.tanh(u["c"] - i) * 3)
        return Step({"y": y})

    assert depth(schedule.statements(one(law))) == 6
