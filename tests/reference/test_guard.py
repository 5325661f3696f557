"""The NumPy guard and safe output agree with `blocks.safety`, and each planted difference is detected."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from synth.blocks.guard import safe_output, safety
from synth.composition import compose
from synth.reference import guard
from synth.signals import Signal
from synth.timing import Discrete
from synth.verify import agree, sampling

TIME = Discrete(1e-3)
INPUTS = [
    safety.GuardedInput(Signal("y", "m", -1.0, 2.0), 0.5, True),
    safety.GuardedInput(Signal("v", "V", -5.0, 5.0), 0.0, True, held=False),
    safety.GuardedInput(Signal("r", "m", -0.5, 0.5), 0.0, False),
]
OUTPUT = Signal("i", "A", -3.0, 3.0)
LIMITS = {g.signal.name: (g.signal.low, g.signal.high) for g in INPUTS}
BAD, GOOD, SLEW, SAFE = 3, 4, 100.0, {"i": 1.0}
COMPUTED = Signal("i_computed", "A", -3.0, 3.0)


def block(good: int) -> Any:
    law = safety.Safety(BAD, SAFE, {"i": SLEW}, "it is heavy")
    parts = [safety.guard(TIME, INPUTS, BAD, good_samples=good), safe_output.block(TIME, [OUTPUT], law)]
    return compose("guarded", parts, inputs=["y", "v", "r", "i_computed"], outputs=["y_held", "v_held", "r_held", "i"])


def step(
    state: Any,
    inputs: Any,
    bad: int = BAD,
    latched_bit: bool = True,
    zeroed: tuple[str, ...] = ("v",),
    good: int = GOOD,
) -> Any:
    accepted = guard.accept(state, inputs, LIMITS, zeroed)
    complete = accepted.good["y"] & accepted.good["v"]
    after = accepted.after | guard.count(state, complete, bad, good)
    word = guard.fault_word(accepted.word, after) if latched_bit else accepted.word.astype(np.uint32)
    outputs, last = guard.slew(state, {"i": inputs["i_computed"]}, after["guard_latched"] > 0, SLEW * 1e-3, SAFE)
    return after | last, {f"{n}_held": v for n, v in accepted.values.items()} | outputs, word


def worst(of: Callable[[Any, Any], Any], good: int = GOOD) -> float:
    whole = block(good)
    states, inputs = sampling.edge_steps(whole, np.random.default_rng(1), 4000)
    inputs["i_computed"] = np.clip(np.nan_to_num(inputs["i_computed"]), -3.0, 3.0)
    if "guard_last_v" in states:
        raise AssertionError("a voltage that is not held has a state")
    pair = ("numpy", agree.reference(of)(states, inputs)), ("casadi", agree.casadi(whole)(states, inputs))
    a = agree.compare("edge steps", *pair, None, whole)
    return max(a.worst, a.state_worst) if not a.faults_differ else np.inf


def test_it_agrees_with_the_block() -> None:
    assert worst(step) < 1e-15 and worst(lambda x, u: step(x, u, good=0), 0) < 1e-15


@pytest.mark.parametrize("defect", [{"bad": 4}, {"latched_bit": False}, {"good": 0}, {"good": 3}])
def test_a_planted_defect_is_detected(defect: dict[str, Any]) -> None:
    assert worst(lambda x, u: step(x, u, **defect)) > 1e-3


BRAKING = 3


def worst_of_braking(stored: Callable[[Any, Any, Any], Any]) -> float:
    """Return the largest deviation of a guard that brakes and whose output is `stored` before a latch."""
    law = safety.Safety(BAD + BRAKING, SAFE, {"i": SLEW}, "it is heavy", braking=BRAKING)
    parts = [safety.guard(TIME, INPUTS, BAD, braking=BRAKING), safe_output.block(TIME, [OUTPUT], law, ["i"])]
    whole = compose("braking", parts, inputs=["y", "v", "r", "i_computed"], outputs=["i"])

    def step_of_braking(state: Any, inputs: Any) -> Any:
        accepted, left = guard.accept(state, inputs, LIMITS, ("v",)), state["guard_left"]
        complete = accepted.good["y"] & accepted.good["v"] & (left > BRAKING)
        after = accepted.after | guard.count(state, complete, BAD + BRAKING)
        word = guard.fault_word(accepted.word + (1 << 30) * (~complete & (left <= BRAKING + 1)), after)
        latched = after["guard_latched"] > 0
        outputs, last = guard.slew(state, {"i": inputs["i_computed"]}, latched, SLEW * 1e-3, SAFE)
        return after | stored(state, last, latched), outputs, word

    states, inputs = sampling.edge_steps(whole, np.random.default_rng(1), 4000)
    inputs["i_computed"] = np.clip(np.nan_to_num(inputs["i_computed"]), -3.0, 3.0)
    pair = ("numpy", agree.reference(step_of_braking)(states, inputs)), ("casadi", agree.casadi(whole)(states, inputs))
    a = agree.compare("edge steps", *pair, None, whole)
    return max(a.worst, a.state_worst) if not a.faults_differ else np.inf


def test_what_is_stored_before_a_latch_agrees_with_the_block() -> None:
    assert worst_of_braking(guard.stored_before_latch) < 1e-15
    assert worst_of_braking(lambda state, last, latched: last) > 1e-3


def test_the_initial_state_names_every_state() -> None:
    whole = block(GOOD)
    assert set(guard.initial_state(LIMITS, ["i"], BAD, ["v"])) == {s.name for s in whole.states}


def test_a_law_stands_still_once_latched() -> None:
    after = guard.frozen({"x": np.zeros(2)}, {"x": np.ones(2)}, np.array([True, False]))
    assert after["x"].tolist() == [0.0, 1.0]
