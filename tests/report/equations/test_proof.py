"""Derived equations of a plant and of a composition; planted defects are reported by name."""

from collections.abc import Callable, Mapping
from dataclasses import replace

import casadi as ca
import pytest
import sympy as sp

from synth.block import Block, Constant, State, Step, build, clip, table
from synth.composition import compose
from synth.errors import ModelError
from synth.plant import Plant, Symbols
from synth.plant import build as build_plant
from synth.report.equations import derive, display, proof
from synth.report.equations.derive import Group
from synth.report.equations.symbolic import opaque, symbol
from synth.signals import Parameter, Signal
from synth.timing import Discrete

TIME = Discrete(1e-3)
SINES = table("sines", [0.0, 0.7, 1.0, 0.7])


def plant() -> Plant:
    """Return a pendulum on two springs with forces of equal form."""
    states = [Signal("theta", "rad", -1, 1, "tilt"), Signal("wtheta", "rad/s", -5, 5)]
    inputs = [Signal("g1", "m", -1, 1), Signal("g2", "m", -1, 1)]
    parameters = [Parameter("k_s", 3.0, "N/m", 0.1, "measured"), Parameter("b", 0.2, "m", 0.0, "drawing")]

    def physics(x: Symbols, u: Symbols, p: Symbols) -> tuple[dict[str, ca.SX], dict[str, ca.SX]]:
        F = forces(x, u, p)
        pull = F["F1"] - F["F2"]
        return {"theta": x["wtheta"], "wtheta": pull - ca.sin(x["theta"]) * 9.81}, {"theta": x["theta"], "pull": pull}

    outputs = [Signal("theta", "rad", -1, 1), Signal("pull", "N", -50, 50)]
    return build_plant("pendulum", states, inputs, outputs, parameters, physics)


def forces(x: Symbols, u: Symbols, p: Symbols) -> dict[str, ca.SX]:
    def force(g: ca.SX) -> ca.SX:
        stretched = g - p["b"] * ca.sin(x["theta"])
        return p["k_s"] * stretched / ca.sqrt(1 + stretched**2) * ca.exp(-stretched)

    return {"F1": force(u["g1"]), "F2": force(u["g2"])}


def axis(name: str) -> Block:
    """Return a limited integral with a choice and a table."""
    e, w = Signal(f"e_{name}", "m", -1, 1), Signal(f"w_{name}", "m", -2, 2)
    states = [State(Signal("sum", "m", -3, 3), 0.0), State(Signal("left", "1", 0, 3), 0, True)]

    def law(u: Mapping[str, ca.SX], x: Mapping[str, ca.SX], k: Mapping[str, ca.SX]) -> Step:
        fast = ca.logic_and(ca.fabs(u[e.name]) > 0.5, x["left"] <= 1)
        demand = ca.if_else(fast, k["k_e"] * u[e.name] + x["sum"], ca.fmin(x["sum"], SINES(x["left"])))
        left = ca.if_else(fast, 3, ca.if_else(x["left"] > 0, x["left"] - 1, 0))
        return Step({w.name: clip(demand, w)}, {"sum": x["sum"] + u[e.name], "left": left})

    return build(f"axis_{name}", TIME, law, inputs=[e], outputs=[w], states=states, constants=[GAIN], tag="(3)")


GAIN = Constant("k_e", 1.5, "1", "chosen")


def controller() -> Block:
    both = Signal("both", "m", -4, 4)

    def law(u: Mapping[str, ca.SX], x: Mapping[str, ca.SX], k: Mapping[str, ca.SX]) -> Step:
        return Step({"both": u["w_x"] + u["w_y"] / 3})

    mix = build("mix", TIME, law, inputs=[Signal(f"w_{n}", "m", -2, 2) for n in "xy"], outputs=[both])
    return compose("two", [axis("x"), axis("y"), mix], inputs=["e_x", "e_y"], outputs=["both"])


def test_a_plant_is_shown_with_its_names_and_equal_forms_once() -> None:
    groups = derive.plant(plant(), forces)
    proof.plant(plant(), groups, forces)
    names = [e.name for g in groups for e in g.equations]
    assert {"F1", "F2", "pull", "theta", "wtheta"} <= set(names) and names.count("theta") == 1
    shown = display.of_groups(groups)[0].equations
    alike = {s.equation.name: [c.name for c, _ in s.copies] for s in shown if s.copies}
    assert alike["F1"] == ["F2"]


def test_a_composition_is_shown_by_blocks_and_equal_forms_once() -> None:
    groups = derive.block(controller())
    proof.block(controller(), groups)
    assert [g.title for g in groups] == ["axis_x", "axis_y", "mix"]
    (first, second), mix = display.of_groups(groups)[0].copies[0], display.of_groups(groups)[1]
    assert first.title == "axis_y" and second == {"e_x": "e_y", "w_x": "w_y"} and mix.group.title == "mix"
    formulas = display.block(controller())
    assert len(formulas) == 2 and formulas[0].title == "axis_x: (3)"


def test_expressions_that_the_physics_does_not_compute_are_refused() -> None:
    def stranger(x: Symbols, u: Symbols, p: Symbols) -> dict[str, ca.SX]:
        return {"F3": u["g1"] ** 3}

    with pytest.raises(ModelError, match="does not compute F3"):
        derive.plant(plant(), stranger)


def planted(groups: tuple[Group, ...], name: str, change: Callable[[sp.Expr], sp.Expr]) -> tuple[Group, ...]:
    """Return the groups with one equation changed."""
    matching = [e for g in groups for e in g.equations if e.name == name]
    assert matching
    return tuple(
        replace(
            g,
            equations=tuple(
                replace(e, expression=change(e.expression)) if e is matching[0] else e for e in g.equations
            ),
        )
        for g in groups
    )


@pytest.mark.parametrize(
    ("name", "change"),
    [
        ("F2", lambda e: e.subs(symbol("k_s"), symbol("b"))),
        ("F1", lambda e: -e),
        ("pull", lambda e: e.args[0]),
        ("wtheta", lambda e: e.subs(sp.Float(9.81), sp.Float(9.8))),
        ("theta", lambda e: 1.000001 * e),
    ],
)
def test_a_changed_equation_of_a_plant_is_noticed(name: str, change: Callable[[sp.Expr], sp.Expr]) -> None:
    groups = planted(derive.plant(plant(), forces), name, change)
    with pytest.raises(ModelError, match="as shown is off by"):
        proof.plant(plant(), groups, forces)


@pytest.mark.parametrize(
    ("name", "change"),
    [
        ("w_x", lambda e: opaque("sat")(e.args[0], -2, sp.Float(1.999))),
        ("w_x", lambda e: e.subs(symbol("axis_x_k_e"), symbol("axis_y_k_e"))),
        ("axis_x_sum", lambda e: e.args[0]),
        ("axis_y_left", lambda e: opaque("choose")(opaque("not")(e.args[0]), *e.args[1:])),
        ("both", lambda e: e.subs(sp.Rational(1, 3), sp.Rational(1, 4))),
    ],
)
def test_a_changed_equation_of_a_block_is_noticed(name: str, change: Callable[[sp.Expr], sp.Expr]) -> None:
    groups = planted(derive.block(controller()), name, change)
    with pytest.raises(ModelError, match=f"'({name}|both)' as shown is off by"):
        proof.block(controller(), groups)


def test_names_that_would_look_alike_are_written_out() -> None:
    def law(u: Mapping[str, ca.SX], x: Mapping[str, ca.SX], k: Mapping[str, ca.SX]) -> Step:
        return Step({"y": u["g1"] - u["g_1"]})

    inputs = [Signal("g1", "m", -1, 1), Signal("g_1", "m", -1, 1)]
    (group,) = derive.block(build("twins", TIME, law, inputs=inputs, outputs=[Signal("y", "m", -2, 2)]))
    right = group.right(group.equations[0])
    assert "<msub>" in right and ("<mi>g_1</mi>" in right or "<mi>g1</mi>" in right)
    proof.block(build("twins", TIME, law, inputs=inputs, outputs=[Signal("y", "m", -2, 2)]), (group,))
