"""Steps must be what they say: a recording is the replay, draws keep their bounds, fault runs reach the latch."""

import numpy as np
import pytest

from benchmarks import axes
from synth.errors import SignalError
from synth.execute import host
from synth.verify import steps


@pytest.fixture(scope="module")
def controller() -> host.Controller:
    made = axes.emitted(2, np.float32)
    return host.load(made.files, made.manifest)


def test_a_recording_is_the_replay(controller: host.Controller) -> None:
    rng = np.random.default_rng(1)
    inputs = {n: rng.uniform(-0.2, 0.2, 300) for n in ("q1", "q2", "r1")} | {"r2": 0.01}
    found = steps.recorded(controller, "random", inputs)
    replay = controller.replay(inputs)
    taken = steps.taken(controller, found)
    assert len(found) == 300 and found.states[0].tobytes() == controller.init().tobytes()
    assert all(taken.outputs[n].tobytes() == v.tobytes() for n, v in replay.outputs.items())
    assert np.array_equal(taken.faults, replay.faults) and len(set(replay.faults.tolist())) > 3
    assert taken.states[:-1].tobytes() == found.states[1:].tobytes()
    assert taken.states[-1].tobytes() == replay.state.tobytes()


def test_parts_joins_and_thinning_keep_the_steps(controller: host.Controller) -> None:
    one = steps.in_range(controller, 50)
    both = steps.joined("both", [one, one.part(slice(0, 10))])
    assert len(both) == 60 and both.inputs[50:].tobytes() == one.inputs[:10].tobytes()
    thin = steps.thinned(both, 7)
    assert len(thin) == 7 and thin.inputs[0] == both.inputs[0] and thin.inputs[-1] == both.inputs[-1]
    assert len(steps.thinned(one, 1000)) == 50
    loop = steps.recorded(controller, "loop", {"q1": np.zeros(3), "q2": 0, "r1": 0, "r2": 0}, closed_loop=True)
    assert steps.joined("loops", [loop, loop]).closed_loop and not steps.joined("mixed", [loop, one]).closed_loop
    with pytest.raises(SignalError, match="found no part"):
        steps.joined("none", [])


def test_draws_keep_the_bounds_of_states_and_leave_those_of_inputs(controller: host.Controller) -> None:
    found = steps.drawn(controller, 4000)
    for field in controller.manifest["structs"]["state"]["fields"]:
        values = found.states[field["name"]]
        assert values.min() == field["low"] and values.max() == field["high"]
    assert np.isnan(found.inputs["q1"]).any() and (found.inputs["r1"] > 0.05).any()
    inside = steps.in_range(controller, 500).inputs
    assert np.all(np.abs(inside["q1"]) <= 0.1) and np.all(np.abs(inside["r2"]) <= 0.05)


def test_fault_runs_reach_the_latch_and_stay(controller: host.Controller) -> None:
    found = steps.faulty(controller, dict.fromkeys(("q1", "q2", "r1", "r2"), 0.01))
    words = steps.taken(controller, found).faults
    assert {0, 1, 2, 3, 1 << 31, 1 << 31 | 1, 1 << 31 | 3} == set(words.tolist())
    assert np.count_nonzero(words == 1 << 31) == 2 * steps.LATCHED  # the position alone, and both inputs
    assert not steps.taken(controller, steps.without_faults(controller, found)).faults.any()


def test_an_input_that_is_not_known_is_named(controller: host.Controller) -> None:
    with pytest.raises(SignalError, match=r"missing \['q2', 'r2'\]"):
        steps.faulty(controller, {"q1": 0.0, "r1": 0.0})
