"""Hall channels that fail under the LQG controller, on the stage: bridged, braked, and the amplitude of all of them."""

from collections.abc import Mapping
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from designs.planar_6dof import failures, faults, interface
from designs.planar_6dof import loop as loops
from designs.planar_6dof.sensing import sections
from designs.planar_6dof_lqg.design import DESIGN, subject
from models import planar_stage
from synth.base.progress import silent
from synth.errors import SignalError
from synth.simulate.faults import campaign
from synth.simulate.rig import Rig
from synth.simulate.scenario import Override, Trajectory, sample_times
from tests.designs.planar_6dof.faulty_runs import (
    FAILS,
    LARGEST_SPEED,
    LARGEST_YAW_RATE,
    SPEEDS,
    after_sticking,
    campaign_excursions,
    excursion,
    ramp,
    rates,
    run,
)

pytestmark = pytest.mark.whole

WRONG_PLANTS = (8, 1, 2, 3, 6)  # of the campaign, those with the largest torques that are not modelled
AMPLITUDE, BRAKING, LATCH = 1 << sections.AMPLITUDE_BIT, 1 << 30, 1 << 31


@cache
def rig() -> Rig:
    return loops.of(subject().block)


# Bridged


@pytest.mark.parametrize("speed", SPEEDS)
@pytest.mark.parametrize("channel", planar_stage.HALL)
def test_four_bad_samples_in_motion_cost_50_um_at_most(channel: str, speed: Mapping[str, float]) -> None:
    healthy = run(rig(), speed=speed)
    faulty = run(rig(), channel, interface.BAD_SAMPLES - 1, speed=speed)
    assert not healthy.faults.any() and not (faulty.faults & LATCH).any()
    assert excursion(healthy, faulty) < 50e-6


@pytest.mark.parametrize("plant", WRONG_PLANTS)
def test_four_bad_samples_cost_50_um_at_most_where_torques_are_not_modelled(plant: int) -> None:
    assert campaign_excursions(DESIGN, subject().block, plant).max() < faults.BRIDGED


# Braked


@pytest.mark.parametrize(("channel", "value"), [("V_ax", np.nan), ("V_cy", 9.0), ("V_by", np.nan)])
def test_a_lost_channel_in_motion_leaves_no_speed(channel: str, value: float) -> None:
    result = run(rig(), channel, 10_000, value)
    latch = int(np.argmax(result.faults >> 31 & 1))
    first = round(FAILS / rig().period_s)
    assert latch - first == interface.BAD_SAMPLES + interface.BRAKING - 1
    assert (result.faults[first + interface.BAD_SAMPLES - 1] & BRAKING) > 0
    speed, yaw = rates(result)
    assert speed[latch:].max() < LARGEST_SPEED and yaw[latch:].max() < LARGEST_YAW_RATE


@pytest.mark.parametrize("channel", planar_stage.HALL)
def test_a_stuck_channel_leaves_no_speed(channel: str) -> None:
    assert (after_sticking(rig(), channel).max(axis=0) < (LARGEST_SPEED, LARGEST_YAW_RATE)).all()


# The amplitude of all voltages


def turning(rig: Rig, factor: float, plant: int) -> Trajectory:
    """Run a ramp of x with an oscillating yaw on a perturbed plant with another amplitude."""
    machine = campaign.machine_number(rig, plant)
    sensitivity = factor * machine.plant.parameter("sensitivity").value
    time = sample_times(1.5, rig.period_s)
    references = {"x": ramp(0.1, -0.02, time), "phi": 7.8e-3 * np.sin(20 * np.pi * time)}
    scaled = replace(machine, plant=machine.plant.with_parameters(sensitivity=sensitivity))
    return loops.simulate(scaled, 1.5, references, {"x": -0.02})


@pytest.mark.parametrize("factor", [0.9, 1.1])
@pytest.mark.parametrize("plant", [0, 1, 3, 6, 8, 14])
def test_another_amplitude_by_a_tenth_is_no_fault(plant: int, factor: float) -> None:
    assert not turning(rig(), factor, plant).faults.any()


def test_an_amplitude_that_jumps_has_its_own_bit_beside_all_six_channels() -> None:
    at_rest = loops.simulate(rig(), 0.5, {}, failures.START)
    time, first = sample_times(0.5, rig().period_s), 200
    late = np.arange(len(time)) >= first
    overrides = {n: Override(late, 1.25 * np.asarray(at_rest.measured[n], dtype=float)) for n in planar_stage.HALL}
    result = loops.simulate(rig(), 0.5, {}, failures.START, overrides=overrides)
    word = int(np.bitwise_or.reduce(result.faults))
    suspects = {f["suspect"] for f in rig().controller.manifest["faults"] if f.get("suspect") and word >> f["bit"] & 1}
    assert word & AMPLITUDE and suspects == set(planar_stage.HALL)


def test_an_operating_point_in_another_pitch_is_refused() -> None:
    """The Hall voltages repeat: at init the controller takes 37 mm for -13.8 mm, and moves on by a pitch."""
    stage = rig().stage
    points = {"in another pitch": {"x_ref": 0.037, "y_ref": 0.0098}}
    off = campaign.with_stops(
        replace(rig(), stage=replace(stage, faults=replace(faults.CAMPAIGN, operating_points=points)))
    )
    (condition,) = (c for c in campaign.motion_and_standstill(off) if c.name.endswith("pitch"))
    with pytest.raises(SignalError, match=r"another pitch: without a fault 'x' is 0\.05.* m from 'x_ref' = 0.037 m"):
        campaign.run(off, 0, condition, silent, [])
