"""Random stimuli: drawn in a fixed order, inside the ranges, at their edges, and near recorded steps."""

import numpy as np
import pytest

from synth.app import standard_tasks
from synth.verify import sampling, steps, stimuli
from tests import levitator

PID = levitator.design()
BLOCK = PID.DESIGN.controller.block
N = 4000


def test_states_come_before_inputs_and_a_seed_gives_the_same_steps() -> None:
    states, inputs = sampling.anywhere(BLOCK, np.random.default_rng(1), N)
    rng = np.random.default_rng(1)
    for s in BLOCK.states:
        low, high = s.signal.low, s.signal.high
        expected = rng.integers(int(low), int(high) + 1, N) if s.integer else rng.uniform(low, high, N)
        np.testing.assert_array_equal(states[s.name], expected)
    for signal in BLOCK.inputs:
        np.testing.assert_array_equal(inputs[signal.name], rng.uniform(signal.low, signal.high, N))


def test_a_quarter_of_the_edge_inputs_is_special() -> None:
    _, inputs = sampling.edge_steps(BLOCK, np.random.default_rng(2), N)
    z = inputs["z"]
    special = np.isin(z, sampling.edge_values(BLOCK.inputs[0])) | np.isnan(z)
    assert 0.2 < special.mean() < 0.3
    beyond = np.nextafter(6e-4, 1), np.nextafter(-6e-4, -1)
    assert {6e-4, -6e-4, *beyond, np.inf, 5e-324, 1e300} <= set(z.tolist())
    assert BLOCK.inputs[0].low < beyond[0]


def test_edge_sampling_keeps_the_other_values() -> None:
    others = np.linspace(-1e-4, 1e-4, N)
    drawn = sampling.at_edges(BLOCK.inputs[0], np.random.default_rng(3), N, others)
    assert 0.7 < np.mean(drawn == others) < 0.8


def test_whole_numbers_and_margins() -> None:
    whole = sampling.states_anywhere(BLOCK, np.random.default_rng(4), N, whole=["pid_z_v"])
    assert set(np.unique(whole["pid_z_v"])) <= {-4.0, -3.0, -2.0, -1.0, 0.0, 1.0, 2.0, 3.0, 4.0, 5.0}
    inside = sampling.states_anywhere(BLOCK, np.random.default_rng(4), N, 0.25)
    assert np.abs(inside["pid_z_integral"]).max() == pytest.approx(3.0)


def test_steps_in_operation_are_near_recorded_ones() -> None:
    rig = standard_tasks.rig(PID.DESIGN, np.float64)
    inputs = stimuli.closed_loop(rig, 500).measured
    recorded = steps.record(rig.controller, "loop", inputs)
    states, drawn = sampling.operating_steps(BLOCK, np.random.default_rng(5), N, recorded)
    assert set(states) == {s.name for s in BLOCK.states} and set(drawn) == {s.name for s in BLOCK.inputs}
    for s in BLOCK.states:
        assert (states[s.name] >= s.signal.low).all() and (states[s.name] <= s.signal.high).all()
    known = np.unique(recorded.states["pid_z_v"])
    gap = np.min(np.abs(states["pid_z_v"][:, None] - known[None, :]), axis=1)
    assert np.median(gap) < 1e-3 and np.mean(gap > 0) > 0.9
