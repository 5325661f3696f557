"""What single faults do to this stage: lost and frozen encoders at rest and in motion, and two lost at once."""

import math
from dataclasses import replace
from itertools import product

import numpy as np
import pytest

from designs.maglev_5dof import control
from designs.maglev_5dof.design import DESIGN
from synth import standard_tasks
from synth.progress import silent
from synth.simulate import campaign, injections
from synth.simulate.campaign import FaultRun
from synth.simulate.injections import Injection
from synth.simulate.sensors import Override

pytestmark = pytest.mark.slow

PLANTS = 4


def runs(target: str, kind: str, condition: str) -> list[FaultRun]:
    """Return the runs of a permanent fault on the nominal plant and wrong ones."""
    assert DESIGN.stage is not None
    rig = campaign.with_stops(standard_tasks.rig(DESIGN.stage, DESIGN.scalar))
    faults = [i for i in injections.derive(rig.stage) if (i.target, i.kind, i.duration) == (target, kind, "permanent")]
    chosen = next(c for c in campaign.motion_and_standstill(rig) if c.name == condition)
    return [run for i in range(PLANTS) for run in campaign.run(rig, i, chosen, silent, faults)[1]]


def test_an_encoder_of_x_that_freezes_in_motion_is_named_within_20_ms_and_the_platen_lands() -> None:
    frozen = runs("x", "frozen", campaign.IN_MOTION)
    assert len(frozen) == 2 * PLANTS
    assert all(run.named and not run.wrong_names and run.notice_s <= 0.02 for run in frozen)
    assert all(run.impacts["x"] == 0 and 0 < run.impacts["y"] < 0.02 for run in frozen)  # m/s
    assert all(math.isfinite(run.latch_s) for run in frozen)


@pytest.mark.parametrize("kind", ["not finite", "frozen"])
def test_a_lost_gap_encoder_is_named_and_the_loop_continues(kind: str) -> None:
    for j in control.MOTORS:
        lost = runs(f"y{j}", kind, campaign.IN_MOTION)
        assert all(run.named and not run.wrong_names and run.notice_s <= 0.05 for run in lost)
        assert all(math.isinf(run.latch_s) and not any(run.impacts.values()) for run in lost)
        assert max(run.excursion["y"] for run in lost) < 40e-6


@pytest.mark.parametrize("pair", [("y1", "y3"), ("y2", "y4"), ("y1", "y2"), ("y3", "y4")])
def test_without_two_gap_encoders_the_platen_lands_below_a_tenth_of_a_metre_per_second(pair: tuple[str, str]) -> None:
    rig = campaign.with_stops(standard_tasks.rig(DESIGN.stage, DESIGN.scalar))
    motion = next(c for c in campaign.motion_and_standstill(rig) if c.name == campaign.IN_MOTION)
    k = np.arange(round(motion.duration_s / rig.period_s))
    for i, onset in product(range(PLANTS), motion.onsets):
        perturbed = replace(rig, plant=campaign.plant_number(rig.plant, i))
        lost = {name: Override(k >= onset, np.full(len(k), np.nan)) for name in pair}
        run = perturbed.run(motion.duration_s, motion.start, motion.references, overrides=lost)
        assert 0 < run.impacts["y"] < 0.1 and run["y"][-1] == pytest.approx(control.GAP[1])  # m/s


def test_without_its_detection_a_frozen_encoder_of_x_harms_the_machine() -> None:
    """The negative control: neither excluded sensors nor a landing, so x runs away."""
    rig = campaign.with_stops(standard_tasks.rig_without_latch(DESIGN.stage, DESIGN.scalar))
    faults = [Injection("sensor", "x", "frozen", "permanent")]
    motion = next(c for c in campaign.motion_and_standstill(rig) if c.name == campaign.IN_MOTION)
    assert all(run.impacts["x"] > 0.5 for run in campaign.run(rig, 0, motion, silent, faults)[1])  # m/s


def test_pairs_of_faults_are_the_redundant_gap_encoders_and_each_sensor_with_its_motor() -> None:
    """The four gap encoders see three coordinates, y1 + y3 = y2 + y4; x and z have one encoder each."""
    assert DESIGN.stage is not None
    gaps = {f"y{j}" for j in control.MOTORS}
    pairs = injections.sensor_pairs(DESIGN.stage)
    assert len(pairs) == 6 and all(set(pair) <= gaps for pair in pairs)
    motors = {sensor: current[-1] for sensor, current in injections.driven_sensors(DESIGN.stage)}  # i_a1 .. i_c4
    assert motors == {"y1": "1", "y2": "2", "y3": "3", "y4": "4", "x": "2", "z": "1"}
