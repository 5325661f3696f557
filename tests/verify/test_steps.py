"""Stimuli: a recording equals the replay, random steps keep their bounds, fault runs reach the latch."""

import numpy as np
import pytest

from benchmarks import axes
from synth.errors import SignalError
from synth.execute import host
from synth.verify import steps


@pytest.fixture(scope="module")
def controller() -> host.Controller:
    made = axes.emit(2, np.float32)
    return host.load(made.files, made.manifest)


def test_a_recording_is_the_replay(controller: host.Controller) -> None:
    rng = np.random.default_rng(1)
    inputs = {n: rng.uniform(-0.2, 0.2, 300) for n in ("q1", "q2", "r1")} | {"r2": 0.01}
    recording = steps.record(controller, "random", inputs)
    replay = controller.replay(inputs)
    taken = steps.evaluate(controller, recording)
    assert len(recording) == 300 and recording.states[0].tobytes() == controller.init().tobytes()
    assert all(taken.outputs[n].tobytes() == v.tobytes() for n, v in replay.outputs.items())
    assert np.array_equal(taken.faults, replay.faults) and len(set(replay.faults.tolist())) > 3
    assert taken.states[:-1].tobytes() == recording.states[1:].tobytes()
    assert taken.states[-1].tobytes() == replay.state.tobytes()


def test_parts_joins_and_thinning_keep_the_steps(controller: host.Controller) -> None:
    one = steps.in_range(controller, 50)
    both = steps.concatenate("both", [one, one.part(slice(0, 10))])
    assert len(both) == 60 and both.inputs[50:].tobytes() == one.inputs[:10].tobytes()
    thin = steps.thinned(both, 7)
    assert len(thin) == 7 and thin.inputs[0] == both.inputs[0] and thin.inputs[-1] == both.inputs[-1]
    assert len(steps.thinned(one, 1000)) == 50
    loop = steps.record(controller, "loop", {"q1": np.zeros(3), "q2": 0, "r1": 0, "r2": 0}, closed_loop=True)
    assert (
        steps.concatenate("loops", [loop, loop]).closed_loop and not steps.concatenate("mixed", [loop, one]).closed_loop
    )
    with pytest.raises(SignalError, match="found no part"):
        steps.concatenate("none", [])


def test_random_states_are_within_bounds_and_inputs_also_outside(controller: host.Controller) -> None:
    selected = steps.random_steps(controller, 4000)
    for field in controller.manifest["structs"]["state"]["fields"]:
        values = selected.states[field["name"]]
        assert values.min() == field["low"] and values.max() == field["high"]
    assert np.isnan(selected.inputs["q1"]).any() and (selected.inputs["r1"] > 0.05).any()
    inside = steps.in_range(controller, 500).inputs
    assert np.all(np.abs(inside["q1"]) <= 0.1) and np.all(np.abs(inside["r2"]) <= 0.05)


def test_fault_runs_reach_the_latch_and_stay(controller: host.Controller) -> None:
    selected = steps.fault_steps(controller, dict.fromkeys(("q1", "q2", "r1", "r2"), 0.01))
    words = steps.evaluate(controller, selected).faults
    assert {0, 1, 2, 3, 1 << 31, 1 << 31 | 1, 1 << 31 | 3} == set(words.tolist())
    assert np.count_nonzero(words == 1 << 31) == 2 * steps.LATCHED  # the position alone, and both inputs
    assert not steps.evaluate(controller, steps.without_faults(controller, selected)).faults.any()


def test_some_states_are_resampled_and_others_kept(controller: host.Controller) -> None:
    original = steps.in_range(controller, 3000)
    selected = steps.resampled(controller, original, "resampled")
    assert selected.inputs.tobytes() == original.inputs.tobytes() and selected.name == "resampled"
    names = [f["name"] for f in controller.manifest["structs"]["state"]["fields"]]
    changed = np.sum([selected.states[n] != original.states[n] for n in names], axis=0)
    assert 0.25 < np.mean(changed == 0) < 0.75 and changed.max() > len(names) / 3
    for field in controller.manifest["structs"]["state"]["fields"]:
        values = selected.states[field["name"]]
        assert values.min() == field["low"] and values.max() == field["high"]


def test_edges_are_on_both_sides_of_the_accepted_range(controller: host.Controller) -> None:
    good = steps.record(controller, "good", dict.fromkeys(("q1", "q2", "r1", "r2"), np.full(5, 0.01)))
    selected = steps.edge_steps(controller, good)
    words, q = steps.evaluate(controller, selected).faults, selected.inputs["q1"]
    high = np.float32(0.1)
    for value, bad in ((high, 0), (np.nextafter(high, np.float32(1)), 1), (np.nextafter(high, np.float32(0)), 0)):
        assert words[q == value].tolist() == [bad] and words[q == -value].tolist() == [bad]
    assert np.all(sum(selected.inputs[n] != np.float32(0.01) for n in ("q1", "q2", "r1", "r2")) == 1)


def test_perturbed_steps_stay_close_and_within_bounds(controller: host.Controller) -> None:
    original = steps.random_steps(controller, 500)
    selected = steps.perturbed(controller, original, "perturbed", 3, 1e-4)
    assert len(selected) == 1500
    for field in controller.manifest["structs"]["state"]["fields"]:
        off = selected.states[field["name"]].astype(float) - np.tile(original.states[field["name"]], 3)
        wide = field["high"] - field["low"]
        assert np.abs(off).max() < 1.01e-4 * wide and np.any(off != 0) == (field["ctype"] == "float")
        assert selected.states[field["name"]].max() <= field["high"]


def test_rare_steps_have_rare_fault_words(controller: host.Controller) -> None:
    bad = steps.fault_steps(controller, dict.fromkeys(("q1", "q2", "r1", "r2"), 0.01))
    usual = steps.record(controller, "usual", dict.fromkeys(("q1", "q2", "r1", "r2"), np.full(3000, 0.01)))
    selected = steps.rarest(controller, steps.concatenate("mixed", [usual, bad]), len(bad) // 2)
    words = steps.evaluate(controller, selected).faults
    assert len(selected) == len(bad) // 2 and selected.name == "rare among mixed"
    assert set(words.tolist()) == set(steps.evaluate(controller, bad).faults.tolist())


def test_steps_at_ends_are_found_and_there_may_be_none(controller: host.Controller) -> None:
    drawn = steps.random_steps(controller, 3000)
    selected = steps.at_range_ends(controller, drawn, 5)
    out = steps.evaluate(controller, selected).outputs
    for name in ("i1", "i2"):
        assert np.count_nonzero(out[name] == 5) >= 5 <= np.count_nonzero(out[name] == -5)
    near = steps.evaluate(controller, steps.at_range_ends(controller, drawn, 10**6, 0.2)).outputs["i1"]
    assert np.count_nonzero(near > 3.0) > np.count_nonzero(near == 5) > 5
    rest = steps.record(controller, "rest", dict.fromkeys(("q1", "q2", "r1", "r2"), np.zeros(3)))
    with pytest.raises(SignalError, match="'rest, at ends': found no part"):
        steps.at_range_ends(controller, rest, 5)


def test_an_input_that_is_not_known_is_named(controller: host.Controller) -> None:
    with pytest.raises(SignalError, match=r"missing \['q2', 'r2'\]"):
        steps.fault_steps(controller, {"q1": 0.0, "r1": 0.0})
