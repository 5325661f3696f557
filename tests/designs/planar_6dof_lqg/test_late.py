"""Set-points that the LQG controller follows late set a status bit, which no alarm counts."""

from dataclasses import replace

import numpy as np
import pytest

from designs.planar_6dof import loop as loops
from designs.planar_6dof import lqg
from designs.planar_6dof_lqg.design import subject
from models import planar_stage
from synth.simulate.rig import Rig
from synth.simulate.scenario import Trajectory, sample_times

SLOW, FAST = {"x": 0.1, "y": 0.25}, {"x": 0.2, "y": 0.45}  # m/s: below and above k ERROR / (k1 T + k2)
FROM, START = 0.1, -0.02  # s, m


@pytest.fixture(scope="module")
def rig() -> Rig:
    return loops.of(subject().block)


def ramp(rig: Rig, axis: str, rate: float) -> Trajectory:
    """Run a set-point that rests, moves at a rate in m/s, and rests again."""
    time = sample_times(1.4, rig.period_s)
    reference = START + rate * np.clip(time - FROM, 0, 0.1 / rate)
    return loops.simulate(rig, 1.4, {axis: reference}, {axis: START})


@pytest.mark.parametrize("axis", SLOW)
def test_a_fast_set_point_sets_its_own_bit_and_a_slow_one_none(rig: Rig, axis: str) -> None:
    slow, fast = ramp(rig, axis, SLOW[axis]), ramp(rig, axis, FAST[axis])
    bit = 1 << lqg.LATE[axis]
    assert not slow.status.any() and not slow.faults.any() and not fast.faults.any()
    assert set(fast.status.tolist()) == {0, bit}
    late = np.flatnonzero(fast.status) * rig.period_s
    behind = np.abs(fast.measured[f"{axis}_ref"] - fast[axis])
    assert behind.max() > lqg.ERROR[axis] and late[0] > FROM
    assert fast.status[-1] == 0 and behind[fast.status == 0].max() < 1.1 * lqg.ERROR[axis]


def test_a_distant_set_point_is_followed_at_the_speed_that_the_c_states(rig: Rig) -> None:
    limited = {a.name: lqg.fastest(a) for a in lqg.axes(planar_stage.plant()) if a.name in lqg.ERROR}
    for axis, speed in limited.items():
        distant = np.full(len(sample_times(0.3, rig.period_s)), 0.09)
        run = loops.simulate(rig, 0.3, {axis: distant}, {axis: START})
        assert run[f"v{axis}"].max() > 0.95 * speed
        assert run[f"v{axis}"][200] == pytest.approx(speed, rel=0.03)


def test_the_replayed_words_contain_the_status(rig: Rig) -> None:
    run = ramp(rig, "x", FAST["x"])
    words = rig.controller.replay(dict(run.measured)).faults
    np.testing.assert_array_equal(words, run.faults | run.status)


def test_without_the_kind_a_step_is_a_false_alarm(rig: Rig) -> None:
    """The planted defect: the same bits, declared as faults."""
    block = subject().block
    alarms = replace(block, faults=tuple(replace(f, status=False) for f in block.faults))
    assert ramp(loops.of(alarms), "x", FAST["x"]).faults.any()
