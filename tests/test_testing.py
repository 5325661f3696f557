"""The tests that every design gets: defects that are planted in it are found, and one that is not is named."""

from collections.abc import Callable
from dataclasses import replace

import pytest

from synth import Constant, Signal, Step, build_block, stage, testing
from synth.block import Block, Exprs
from synth.declare.stage import Stage
from synth.verify import agree
from tests import levitator

PID = levitator.design()


def test_every_planted_defect_is_found() -> None:
    names = [name for name, _ in testing.variants(PID.DESIGN)]
    assert {"sign of pid_z_p", "slew of i2 doubled", "bad_samples", "range of z wider"} <= set(names)
    assert len(names) == len(set(names)) == 19
    assert testing.undetected_defects(PID.DESIGN) == []


def test_a_defect_that_the_reference_shares_is_named() -> None:
    """A reference that was written from the wrong C cannot tell the same defect."""
    wrong = dict(testing.variants(PID.DESIGN))["slew of i2 doubled"]

    assert testing.undetected_defects(replace(PID.DESIGN, reference=witness(wrong))) == ["slew of i2 doubled"]


def squaring(effect: float) -> Stage:
    """Return a stage whose law squares a constant, with a reference that agrees with it."""
    around, time = PID.DESIGN.interface, PID.DESIGN.controller.time

    def law(u: Exprs, x: Exprs, k: Exprs) -> Step:
        force = u["z_held"] * (1 - effect * (k["per_length"] * u["z_held"]) ** 2)
        return Step({"i1_demand": 1e4 * force, "i2_demand": 1e4 * u["x_held"]})

    inputs: list[Signal] = [around.held("z"), around.held("x")]
    outputs = [around.demand("i1"), around.demand("i2")]
    constants = [Constant("per_length", 100.0, "1/m", "data sheet")]
    block = build_block("law", time, law, inputs=inputs, outputs=outputs, constants=constants)
    made = stage.controller("squaring", time, around, [block])
    return replace(PID.DESIGN, controller=made, reference=witness(made.block))


def witness(block: Block) -> Callable[[agree.Columns, agree.Columns], tuple[agree.Columns, agree.Columns, object]]:
    def step(x: agree.Columns, u: agree.Columns) -> tuple[agree.Columns, agree.Columns, object]:
        stepped = agree.casadi(block)(x, u)
        return stepped.states, stepped.outputs, stepped.faults

    return step


@pytest.mark.parametrize(("effect", "undetected"), [(1.0, []), (1e-20, ["law_per_length doubled"])])
def test_a_constant_that_is_squared_is_doubled_instead_of_negated(effect: float, undetected: list[str]) -> None:
    """The sign of 1/l in 1 - (z/l)^2 is no defect; one that has no effect at all is named."""
    assert testing.undetected_defects(squaring(effect)) == undetected


def test_the_test_names_the_defect_that_the_reference_shares() -> None:
    with pytest.raises(AssertionError, match="law_per_length doubled; write the reference from the equations"):
        testing.test_defects_that_are_planted_are_found(squaring(1e-20))
