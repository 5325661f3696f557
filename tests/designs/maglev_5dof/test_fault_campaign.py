"""What single faults do to this stage today: a lost gap encoder, and an encoder of x that freezes in motion."""

import numpy as np
import pytest

from designs.maglev_5dof import control
from designs.maglev_5dof.design import DESIGN
from synth import standard_tasks
from synth.progress import silent
from synth.simulate import campaign, injections
from synth.simulate.campaign import FaultRun

pytestmark = pytest.mark.slow

PLANTS = 4


def runs(target: str, kind: str, condition: str) -> list[FaultRun]:
    """Return the runs of a permanent fault on the nominal plant and wrong ones."""
    assert DESIGN.stage is not None
    rig = campaign.with_stops(standard_tasks.rig(DESIGN.stage, DESIGN.scalar))
    faults = [i for i in injections.derive(rig.stage) if (i.target, i.kind, i.duration) == (target, kind, "permanent")]
    chosen = next(c for c in campaign.motion_and_standstill(rig) if c.name == condition)
    return [run for i in range(PLANTS) for run in campaign.run(rig, i, chosen, silent, faults)[1]]


def test_an_encoder_of_x_that_freezes_in_motion_is_never_noticed_and_x_ends_at_its_stop() -> None:
    frozen = runs("x", "frozen", campaign.IN_MOTION)
    assert len(frozen) == 2 * PLANTS
    assert all(run.notice_s == np.inf and not run.named for run in frozen)
    # m/s; the commutation stays at the frozen position, too, which takes away thrust
    assert all(run.impacts["x"] > 0.5 for run in frozen) and 0.9 < max(run.impacts["x"] for run in frozen) < 1.3


def test_a_lost_gap_encoder_is_named_at_once_and_the_safe_output_ends_at_the_lower_stop() -> None:
    for j in control.MOTORS:
        lost = runs(f"y{j}", "not finite", campaign.AT_REST)
        assert all(run.named and not run.wrong_names and run.notice_s == 0 for run in lost)
        assert all(run.latch_s == pytest.approx((control.BAD_SAMPLES - 1) * 1e-3) for run in lost)
        assert all(0.38 < run.impacts["y"] < 0.47 for run in lost)  # m/s, from 25 mm


def test_pairs_of_faults_are_the_redundant_gap_encoders_and_each_sensor_with_its_motor() -> None:
    """The four gap encoders see three coordinates, y1 + y3 = y2 + y4; x and z have one encoder each."""
    assert DESIGN.stage is not None
    gaps = {f"y{j}" for j in control.MOTORS}
    pairs = injections.sensor_pairs(DESIGN.stage)
    assert len(pairs) == 6 and all(set(pair) <= gaps for pair in pairs)
    motors = {sensor: current[-1] for sensor, current in injections.driven_sensors(DESIGN.stage)}  # i_a1 .. i_c4
    assert motors == {"y1": "1", "y2": "2", "y3": "3", "y4": "4", "x": "2", "z": "1"}
