"""A companion is verified against its reference in random, edge and recorded steps; a planted defect is detected."""

from typing import Any

import numpy as np
import pytest

from synth.block import Exprs, Step, build
from synth.blocks.guard import safety
from synth.composition import compose
from synth.declare.companion import Companion
from synth.reference import guard
from synth.signals import Signal
from synth.timing import Discrete
from synth.verify import standard, suite
from tests.verify.test_stimuli import STAGE

TIME, IN, OUT = Discrete(1e-3), Signal("u", "A", -2.0, 2.0), Signal("i", "A", -4.0, 4.0)
RUN = {"replay": {"u": np.linspace(-1, 1, 50)}}


def law(u: Exprs, x: Exprs, k: Exprs) -> Step:
    return Step({"i": 1.5 * u["u_held"]})


HELD = Signal("u_held", "A", -2.0, 2.0)
PARTS = [
    safety.guard(TIME, [safety.GuardedInput(IN, 0.0, False)], 5),
    build("gain", TIME, law, inputs=[HELD], outputs=[OUT], tag="1.5 u"),
]
BLOCK = compose("amplifier", PARTS, inputs=["u"], outputs=["i"])


def reference(factor: float) -> Any:
    def step(state: Any, inputs: Any) -> Any:
        accepted = guard.accept(state, inputs, {"u": (-2.0, 2.0)})
        return accepted.after, {"i": factor * accepted.values["u"]}, accepted.word.astype(np.uint32)

    return step


@pytest.mark.parametrize(("factor", "passes"), [(1.5, True), (1.5000001, False)])
def test_its_reference_agrees_unless_it_is_wrong(factor: float, passes: bool) -> None:
    companion = Companion(BLOCK.name, lambda: BLOCK, reference=reference(factor), floor=1.0)
    rng = np.random.default_rng(1)
    compared, single = standard.compare(companion, "amplifier", STAGE, RUN, rng, (500, 200))
    checks = suite.exact_checks(compared, "A")
    assert {a.what for a in compared} == {f"amplifier, {n}" for n in ("random steps", "edge steps", "replay")}
    assert all(c.passed for c in checks) == passes and single.worst < 1e-6
