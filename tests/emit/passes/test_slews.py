"""Rate limits: recognised in one form alone, and computed as written."""

import casadi as ca
import numpy as np
import pytest

from synth.block import Block, State, Step, build
from synth.emit.write import emit
from synth.execute import host
from synth.signals import Signal
from synth.timing import Discrete


def block(kind: str) -> Block:
    def law(u: dict[str, ca.SX], x: dict[str, ca.SX], k: dict[str, ca.SX]) -> Step:
        last, step = x["last"], 0.25
        up = last + step
        down = last - (step if kind != "other step" else 0.5)
        next = ca.fmax(ca.fmin(u["a"], up), down)
        return Step({"y": next + (up if kind == "sum read twice" else 0)}, {"last": next})

    signals = [Signal(n, "1", -2, 2) for n in ("a", "last")]
    return build(
        "slewing",
        Discrete(1e-3),
        law,
        inputs=signals[:1],
        outputs=[Signal("y", "1", -5, 5)],
        states=[State(signals[1], 0)],
    )


@pytest.mark.parametrize("kind", ["slew", "other step", "sum read twice"])
def test_a_rate_limit_is_one_call_in_its_own_form_alone(kind: str) -> None:
    made = emit(block(kind), np.float32)
    assert ("slewing_slew(" in made.files["slewing.c"]) == (kind == "slew")
    controller, last = host.load(made.files, made.manifest), 0.0
    a = np.random.default_rng(2).uniform(-2, 2, 100).astype(np.float32)
    for value, y in zip(a, controller.replay({"a": a}).outputs["y"], strict=True):
        up, down = (
            np.float32(last) + np.float32(0.25),
            np.float32(last) - np.float32(0.5 if kind == "other step" else 0.25),
        )
        last = max(min(value, up), down)
        assert y == last + (up if kind == "sum read twice" else 0)
