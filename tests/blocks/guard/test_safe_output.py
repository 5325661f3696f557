"""Safe output: the target once latched, in flight and once landed, and what is refused."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest

from synth.block import Block, Safety, State, Step, build
from synth.blocks.guard import safe_output
from synth.blocks.guard.safety import GuardedInput, guard
from synth.composition import compose
from synth.signals import Signal
from synth.timing import Discrete

TIME = Discrete(1e-3)
OUTPUTS = [Signal(n, "A", -3.0, 3.0) for n in ("i_1", "i_2", "u")]
SAFE = Safety(5, {"i_1": 2.0, "i_2": 2.0, "u": 0.0}, dict.fromkeys(("i_1", "i_2", "u"), 500.0), "rests")
LANDED = replace(SAFE, landed_output={"i_1": 0.0, "i_2": 0.5, "u": 0.0})


def after_latch(safety: Safety, landed: float | None) -> dict[str, float]:
    """Return the outputs 20 samples after a latch from 1 A."""
    block = safe_output.block(TIME, OUTPUTS, safety)
    step, x = block.function(), np.ones(3)
    flags = {"latched": 1.0} | ({} if landed is None else {"rests": landed})
    u = [({f"{s.name}_computed": 1.0 for s in OUTPUTS} | flags)[s.name] for s in block.inputs]
    for _ in range(20):
        x, y = (np.array(v).ravel() for v in step(x, u))
    return dict(zip((s.name for s in OUTPUTS), y, strict=False))


def test_a_latch_in_flight_and_one_once_landed_have_their_own_values() -> None:
    assert after_latch(SAFE, None) == {"i_1": 2.0, "i_2": 2.0, "u": 0.0}
    assert after_latch(LANDED, 0.0) == {"i_1": 2.0, "i_2": 2.0, "u": 0.0}
    assert after_latch(LANDED, 1.0) == {"i_1": 0.0, "i_2": 0.5, "u": 0.0}


def test_values_that_do_not_differ_need_no_flag() -> None:
    block = safe_output.block(TIME, OUTPUTS, replace(SAFE, landed_output=SAFE.safe_output))
    assert "rests" not in [s.name for s in block.inputs]


CURRENT, READING = Signal("i", "A", -3.0, 3.0), Signal("reading", "m", -1.0, 1.0)
SLEW = 0.5  # A in a sample


def currents(bad: Sequence[bool], guarding: Block, unread: Sequence[str]) -> tuple[list[float], int]:
    """Return the current in each sample, which a law changes by 2 A from one to the next, and the first latched one."""
    state = State(replace(CURRENT, name="sign"), 1.0)
    law = build("law", TIME, lambda u, x, k: Step({"i_computed": x["sign"]}, {"sign": -x["sign"]}), inputs=[],
                outputs=[replace(CURRENT, name="i_computed")], states=[state], tag="alternating")  # fmt: skip
    assert guarding.safety is not None
    safe = replace(guarding.safety, safe_output={"i": 0.0}, slew_per_s={"i": SLEW * 1e3})
    block = compose(
        "stage", [guarding, law, safe_output.block(TIME, [CURRENT], safe, unread)], inputs=["reading"], outputs=["i"]
    )
    step, x, values, latched = block.function(), block.initial, [], []
    for is_bad in bad:
        x, y = (np.array(v).ravel() for v in step(x, [np.nan if is_bad else 0.0]))
        values.append(float(y[0]))
        latched.append(x[[s.name for s in block.states].index("guard_latched")] > 0)
    return values, latched.index(True)


@pytest.mark.parametrize("bad_samples", [1, 2, 5])
@pytest.mark.parametrize("braking", [1, 2, 3, 24])
@pytest.mark.parametrize("good", [0, 1])
def test_the_slew_starts_from_the_last_output_though_it_is_seldom_stored(
    bad_samples: int, braking: int, good: int
) -> None:
    bad = [False] * 3 + [True] * (bad_samples - 1) + [False] * good + [True] * 40
    guarding = guard(TIME, [GuardedInput(READING, 0.0, True)], bad_samples, braking=braking)
    values, first = currents(bad, guarding, ["i"])
    assert abs(values[first] - values[first - 1]) == pytest.approx(SLEW)
    assert values == currents(bad, guarding, [])[0]


def test_an_output_that_is_stored_too_late_is_found() -> None:
    guarding = guard(TIME, [GuardedInput(READING, 0.0, True)], 5, braking=24)
    late = replace(guarding, output={**guarding.output, "may_latch": guarding.symbol["left"] <= 1})
    values, first = currents([False] * 3 + [True] * 40, late, ["i"])
    assert abs(values[first] - values[first - 1]) > SLEW
