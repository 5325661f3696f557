"""What a law computes several times is one function; the C computes the same bits; planted differences are refused."""

from dataclasses import replace

import casadi as ca
import numpy as np
import pytest
from numpy.typing import NDArray

from synth.block import Block, Step, build
from synth.emit import pipeline
from synth.emit.lower import Node, Program
from synth.emit.passes import calls, fragments, routine
from synth.emit.passes.routine import Group
from synth.emit.passes.surroundings import Graph
from synth.emit.write import EmittedCode, emit
from synth.execute import host
from synth.signals import Signal
from tests.emit.dyadic import TIME

F32 = np.float32
COUNT = 6
INPUTS = [f"u_{n}" for n in range(3 * COUNT)]


def law(seed: int) -> tuple[list[str], Block]:
    """Return a Block that computes one random expression of three inputs six times, and the names of its outputs."""
    rng = np.random.default_rng(seed)
    shape = [(int(rng.integers(4)), int(rng.integers(99)), int(rng.integers(99))) for _ in range(14)]
    outputs = [f"y_{n}" for n in range(COUNT)]

    def once(u: list[ca.SX]) -> ca.SX:
        values = list(u)
        for op, first, second in shape:
            a, b = values[first % len(values)], values[-1 - second % 3]
            made = [a + b, a * b, a - 0.5 * b, ca.if_else(a < b, b - a, 0.25 * a)][op]
            values.append(ca.fmax(ca.fmin(made, 2), -2))
        return values[-1] + values[-2]

    def step(u: dict[str, ca.SX], x: dict[str, ca.SX], k: dict[str, ca.SX]) -> Step:
        return Step({y: once([u[f"u_{3 * n + i}"] for i in range(3)]) for n, y in enumerate(outputs)})

    inputs = [Signal(name, "1", -1, 1) for name in INPUTS]
    return outputs, build("law", TIME, step, inputs=inputs, outputs=[Signal(y, "1", -4, 4) for y in outputs])


def program(block: Block) -> Program:
    return pipeline.reduce(block.rounded(F32), F32).program


def groups(p: Program) -> list[Group]:
    return fragments.fragments(p, frozenset())


@pytest.mark.parametrize("seed", range(8))
def test_c_with_functions_has_the_bits_of_the_flat_c(seed: int, monkeypatch: pytest.MonkeyPatch) -> None:
    outputs, block = law(seed)
    ours = emit(block, F32)
    monkeypatch.setattr(pipeline, "_shorter", lambda *_: [])
    flat = emit(block, F32)
    rng = np.random.default_rng(seed)
    u = {name: rng.uniform(-1, 1, 400).astype(F32) for name in INPUTS}
    first, second = (_replay(e, u) for e in (ours, flat))
    for y in outputs:
        assert first[y].tobytes() == second[y].tobytes()


def _replay(emitted: EmittedCode, u: dict[str, NDArray[np.floating]]) -> dict[str, NDArray[np.floating]]:
    return dict(host.load(emitted.files, emitted.manifest).replay(u).outputs)


def test_what_is_computed_six_times_is_one_function() -> None:
    _, block = law(0)
    text = emit(block, F32).files["law.c"]
    assert "6 calls in the step" in text
    assert len(groups(program(block))[0]) == COUNT


def test_fragments_are_apart_convex_and_of_one_form() -> None:
    for seed in range(4):
        p = program(law(seed)[1])
        graph = Graph.of(p, frozenset())
        seen: set[int] = set()
        for group in groups(p):
            assert len({form.shape for _, form in group}) == 1
            for part, _ in group:
                assert seen.isdisjoint(part.region)
                seen |= part.region
                assert graph.is_convex(sum(1 << k for k in part.region), sorted(part.region))


def test_a_region_with_a_node_between_its_nodes_is_not_convex() -> None:
    """The planted defect: the first and the last of a chain without what lies between."""
    nodes = (Node("input", name="u"), Node("sq", (0,)), Node("neg", (1,)), Node("sq", (2,)))
    graph = Graph.of(Program(nodes, (), {"y": 3}, {}), frozenset())
    assert graph.is_convex(0b1110, [1, 2, 3])
    assert not graph.is_convex(0b1010, [1, 3])


@pytest.mark.parametrize("op", ["sub", "min"])
def test_another_operation_is_no_part_of_the_group(op: str) -> None:
    """The planted defect: one operation of one fragment is another one."""
    p = program(law(0)[1])
    part, _ = groups(p)[0][0]
    place = next(k for k in sorted(part.region) if p.nodes[k].op in ("add", "mul"))
    nodes = tuple(replace(n, op=op) if k == place else n for k, n in enumerate(p.nodes))
    with_place = [group for group in groups(replace(p, nodes=nodes)) if any(place in q.region for q, _ in group)]
    assert all(len(group) < COUNT for group in with_place)


def test_a_value_with_another_type_in_the_function_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    p = program(law(0)[1])
    group = groups(p)[0]
    assert routine.keeps_kinds(p, group, {})
    true = routine.kinds
    monkeypatch.setattr(routine, "kinds", lambda q: ["integer"] * len(q.nodes) if q is not p else true(q))
    assert not routine.keeps_kinds(p, group, {})


def test_each_call_computes_before_its_results_are_read() -> None:
    p = program(law(1)[1])
    made = calls.outlined(p, {}, groups(p))
    assert all(a < k for k, node in enumerate(made.nodes) for a in node.args)
