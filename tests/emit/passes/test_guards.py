"""Guards of inputs: one call an input, the bits of the fault word, and the values of the Block without them."""

from dataclasses import replace

import casadi as ca
import numpy as np
import pytest

from synth.block import Block, State, Step, build
from synth.blocks.guard import safe_output
from synth.blocks.guard.safety import GuardedInput, Safety, guard
from synth.composition import compose
from synth.emit.write import emit
from synth.execute import compile as compiler
from synth.execute import host
from synth.signals import Signal
from synth.timing import Discrete
from tests import tolerances
from tests.emit import one_step
from tests.emit.proof import test_safe
from tests.emit.proof.test_safe import GUARDED

TIME = Discrete(1e-3)
FORCE = Signal("force", "N", -1, 1)
SAFETY = Safety(3, {"force": 0.25}, {"force": 100.0}, "a spring centres it")
F32 = np.float32


def stage(low: float = -1, held: bool = True, second: bool = True) -> Block:
    """Return a guarded sum of inputs; the last one is a set-point."""
    signals = [Signal("a", "m", low, 1), Signal("b", "m", 0.25, 2), Signal("wish", "m", -0.5, 0.5)]
    signals = signals if second else [signals[0], signals[2]]
    law = build(
        "law",
        TIME,
        lambda u, x, k: Step({"force_computed": ca.sum1(ca.vcat([u[f"{s.name}_held"] for s in signals])) / 8}),
        inputs=[Signal(f"{s.name}_held", "m", s.low, s.high) for s in signals],
        outputs=[Signal("force_computed", "N", -9, 9)],
    )
    guarded = [GuardedInput(s, max(s.low, 0.0), s.name != "wish", held) for s in signals]
    blocks = [guard(TIME, guarded, 3), law, safe_output.block(TIME, [FORCE], SAFETY)]
    return compose("stage", blocks, inputs=[s.name for s in signals], outputs=["force"])


def test_each_input_is_one_call() -> None:
    text = emit(stage(), F32).files["stage.c"]
    assert "accepted.a = stage_hold_within(in->a, 1.0f, &state->guard.last_a, 0x00000001u, faults);" in text
    assert "accepted.b = stage_hold(in->b, 0.25f, 2.0f, &state->guard.last_b, 0x00000002u, faults);" in text
    assert "accepted.wish = stage_hold_within(in->wish, 0.5f, &state->guard.last_wish, 0x00000004u, faults);" in text
    assert "(faults & 0x00000003u) == 0u" in text  # the measurements alone


@pytest.mark.parametrize("held", [True, False])
def test_a_guard_alone_includes_what_it_calls(held: bool) -> None:
    """The test of a range -high .. high calls fabsf, also where nothing else in the file does."""
    wish = Signal("wish", "m", -0.5, 0.5)
    law = build(
        "law",
        TIME,
        lambda u, x, k: Step({"force": u["wish_held"]}),
        inputs=[replace(wish, name="wish_held")],
        outputs=[FORCE],
    )
    blocks = [guard(TIME, [GuardedInput(wish, 0.0, False, held)], 3), law]
    files = emit(compose("stage", blocks, inputs=["wish"], outputs=["force"]), F32).files
    assert files["stage.c"].count("fabsf(") == 1
    compiler.check(host.code(files))


def test_an_input_that_is_not_held_needs_no_state() -> None:
    text = emit(stage(held=False), F32).files["stage.c"]
    assert "stage_replace_within(in->a, 1.0f, guard_refused_a, 0x00000001u, faults);" in text
    assert "stage_replace(in->b, 0.25f, 2.0f, guard_refused_b, 0x00000002u, faults);" in text
    assert "stage_hold" not in text and "stage_guard_inputs(in, &faults)" in text


@pytest.mark.parametrize("scalar", [np.float32, np.float64])
@pytest.mark.parametrize("held", [True, False])
@pytest.mark.parametrize("low", [-1, -0.5])
def test_replays_follow_casadi(scalar: type[np.floating], held: bool, low: float) -> None:
    block = stage(low, held)
    made = emit(block, scalar)
    controller, f, x = host.load(made.files, made.manifest), block.function(), block.initial
    rng = np.random.default_rng(1)
    samples = rng.uniform(-1, 2, (60, 3))
    samples[rng.random((60, 3)) < 0.2] = np.nan
    samples = scalar(samples).astype(float)
    state = controller.init()
    for sample in samples:
        u = np.where(np.isnan(sample), 1e9, sample)  # CasADi's comparisons with NaN differ
        next, y = f(x, u)
        x = next.full().ravel()
        step = controller.step(state, dict(zip(("a", "b", "wish"), sample, strict=True)))
        np.testing.assert_allclose([state[s.name] for s in block.states], x, rtol=1e-6, atol=1e-7)
        assert step.outputs["force"] == pytest.approx(y.full().ravel()[0], rel=1e-5, abs=1e-6)
        refused = [not s.low <= value <= s.high for s, value in zip(block.inputs, sample, strict=True)]
        assert step.faults == sum(bad << i for i, bad in enumerate(refused)) + (int(state["guard_latched"]) << 31)


def test_an_input_that_the_law_reads_as_it_is_keeps_its_range_test() -> None:
    """The range test of a state is no guard of an input, and a word with other bits is a variable of its own."""
    level = Signal("level", "1", -2, 2)

    def law(u: dict[str, ca.SX], x: dict[str, ca.SX], k: dict[str, ca.SX]) -> Step:
        inside = ca.fabs(x["level"] + u["a"]) <= 2
        return Step({"y": u["a"]}, {"level": ca.if_else(inside, x["level"] + u["a"], x["level"])})

    block = build(
        "plain",
        TIME,
        law,
        inputs=[Signal("a", "1", -1, 1)],
        outputs=[Signal("y", "1", -1, 1)],
        states=[State(level, 0)],
    )
    text = emit(block, F32).files["plain.c"]
    assert "_hold" not in text and "faults" not in text


def test_what_is_computed_under_its_guards_has_the_values_of_casadi() -> None:
    blocks = [replace(test_safe.make(law, *test_safe.BOTH_SIDES), name=f"made{k}") for k, law in enumerate(GUARDED)]
    assert not one_step.differing_from_casadi(blocks, np.float64, rtol=tolerances.of("folded"))


def test_a_quotient_of_two_arms_is_computed_where_one_of_them_is() -> None:
    law: test_safe.Law = lambda u: (  # noqa: E731
        ca.if_else(ca.fabs(u["z"]) > 0.1, 1 / u["z"], 0)
        + ca.if_else(u["w"] > 1.5 - u["z"], 0.5 / u["z"] + 1 / u["z"], 0)
    )
    text = emit(test_safe.make(law, *test_safe.BOTH_SIDES), F32).files["made.c"]
    assert text.count("1.0f / z") == 1 and "test || " in text
