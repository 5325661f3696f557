"""Equations in the comments of the shipped C hold at random states and inputs, with each name meaning one value."""

import re
from collections.abc import Callable, Mapping
from typing import Any, NamedTuple

import numpy as np
import pytest

from designs.maglev_5dof.design import DESIGN as MAGLEV
from designs.maglev_5dof_precise.design import DESIGN as PRECISE
from designs.planar_6dof_leadlag.design import DESIGN as LEADLAG
from designs.planar_6dof_lqg.design import DESIGN as LQG
from synth.block import Block
from synth.declare.stage import Stage
from synth.emit import pipeline
from synth.emit.c import equations
from synth.emit.passes import parts
from synth.emit.program import lower
from synth.emit.program.lower import Program

DESIGNS = {
    "maglev_5dof": MAGLEV,
    "maglev_5dof_precise": PRECISE,
    "planar_6dof_leadlag": LEADLAG,
    "planar_6dof_lqg": LQG,
}
LOADS = ("input", "state", "constant")
SAMPLES = 6
RELATIVE = 1e-4  # numbers stand with six digits
NAMED = ("log", "sin", "cos", "tanh", "sinh", "cosh", "sqrt", "floor")
FUNCTIONS: dict[str, Callable[..., Any]] = {name: getattr(np, name) for name in NAMED}
FUNCTIONS |= {"asin": np.arcsin, "atan": np.arctan, "max": max, "min": min, "abs": abs}
FUNCTIONS["limit"] = lambda x, high: max(min(x, high), -high)


class Stated(NamedTuple):
    """An equation as it is stated for a Block, with the nodes that its names stand for."""

    block: str
    equation: equations.Equation
    named: Mapping[str, int]


def stated(p: Program, monkeypatch: pytest.MonkeyPatch) -> list[Stated]:
    """Return every equation that is made for the comments, in signals and in variables."""
    owner, of_mark = parts.by_node(p), {k: named.block for named, k in p.marks}
    made, equation = list[Stated](), equations._Text.equation

    def recorded(self: Any, name: str, k: int) -> equations.Equation:
        result = equation(self, name, k)
        fits = self._equation(name, k, equations.LONGEST).text
        named: dict[str, int] = {}
        for nodes in ({} if fits else self.variables, self.names):
            for at, word in sorted(nodes.items()):
                if word not in named or of_mark.get(at, owner[at]) == self.block:
                    named[word] = at
        made.append(Stated(self.block, result, named))
        return result

    monkeypatch.setattr(equations._Text, "equation", recorded)
    equations.by_block(p, frozenset(p.labels.values()))
    monkeypatch.setattr(equations._Text, "equation", equation)
    return [each for each in made if each.equation.text]


def values(p: Program, block: Block, rng: np.random.Generator) -> list[float]:
    """Return the value of each node for random states and inputs."""
    ranges = {s.name: (s, False) for s in block.inputs} | {s.name: (s.signal, s.integer) for s in block.states}
    constants = {c.name: c.value for c in block.constants}
    operations = {
        name: lambda *a, of=of: np.asarray(of(*a), float) for name, of in lower.OPERATIONS.items()
    } | {"clamp": lambda x, low, high: np.clip(x, low, high), "bit": lambda *_: np.array(0.0)}  # fmt: skip
    known = {}
    for k, node in enumerate(p.nodes):
        if node.op == "constant":
            known[k] = np.array(np.sign(node.value or 1) * constants[node.name])
        elif node.op in LOADS:
            signal, integer = ranges[node.name]
            value = rng.uniform(max(signal.low, -1e3), min(signal.high, 1e3))
            known[k] = np.array(round(value) if integer else value)
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr(lower, "OPERATIONS", operations)
        by_node = lower.evaluate(p, range(len(p.nodes)), known)
    return [float(by_node[k]) for k in range(len(p.nodes))]


def python(text: str) -> str:
    text = text.replace(" is set", " != 0").replace(", else", " else").replace("^", "**")
    return re.sub(r"\|([^|]*)\|", r"abs(\1)", text)


def violations(block: Block, monkeypatch: pytest.MonkeyPatch) -> dict[tuple[str, str], str]:
    """Return the equations that do not hold, or of which a name has two meanings."""
    p, rng, wrong = pipeline.reduce(block, np.float32).composed, np.random.default_rng(1), {}
    made = stated(p, monkeypatch)
    signals = {named.signal.name for named, k in p.marks if p.nodes[k].op not in equations._LEAVES}
    assert len(made) > 100
    for _ in range(SAMPLES):
        at = values(p, block, rng)
        for of, e, named in made:
            names = dict(e.counts)
            for k, node in enumerate(p.nodes):
                if node.op in LOADS:
                    local = equations._local(node.name, of)
                    names[node.name if local in signals else local] = at[k] * np.sign(node.value or 1)
            for word in {*equations.NAME.findall(e.text)} & named.keys():
                if names.get(word, at[named[word]]) != at[named[word]]:
                    wrong[of, e.name] = f"'{word}' has two meanings in {e.text}"
                names[word] = at[named[word]]
            got = eval(python(e.text), {"__builtins__": {}}, FUNCTIONS | names)
            got = bool(got) if p.nodes[e.node].op in ("and", "or", "not") else got
            if abs(got - at[e.node]) > RELATIVE * max(abs(at[e.node]), 1e-6):
                wrong[of, e.name] = f"{got:g} instead of {at[e.node]:g}: {e.text}"
    return wrong


def block_of(design: Stage) -> Block:
    return design.controller.block.rounded(np.float32)


@pytest.mark.parametrize("name", DESIGNS)
def test_each_equation_holds(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    assert violations(block_of(DESIGNS[name]), monkeypatch) == {}


def test_a_name_with_two_meanings_is_found(monkeypatch: pytest.MonkeyPatch) -> None:
    """The yaw of the last sample is a state of `sensing` that has the local name of its signal."""
    leaf = equations._Text._leaf

    def shortened(self: Any, node: Any) -> Any:
        self.signals = set()
        return leaf(self, node)

    monkeypatch.setattr(equations._Text, "_leaf", shortened)
    wrong = violations(block_of(LEADLAG), monkeypatch)
    assert ("sensing", "r_1") in wrong
