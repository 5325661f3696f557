"""Hall channels that fail under the lead-lag controller, on the stage: bridged, and braked before the latch."""

from collections.abc import Mapping
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from designs.planar_6dof import faults, interface
from designs.planar_6dof import loop as loops
from designs.planar_6dof_leadlag.design import DESIGN, subject
from models import planar_stage
from synth.fault import BRAKING_BIT, LATCH_BIT
from synth.simulate.faults import campaign
from synth.simulate.rig import Rig
from tests.designs.planar_6dof.faulty_runs import (
    FAILS,
    LARGEST_SPEED,
    LARGEST_YAW_RATE,
    SPEEDS,
    after_sticking,
    campaign_excursions,
    excursion,
    rates,
    run,
)

WRONG_PLANTS = (3, 4, 12)  # of the campaign, those with the largest yaw rates after a channel sticks or drops to 0
LEFT = LARGEST_SPEED, LARGEST_YAW_RATE


@cache
def rig() -> Rig:
    return loops.of(subject().block)


def on_plant(number: int, amplitude: float = 1.0) -> Rig:
    """Return the loop of a wrong plant of the campaign with another amplitude of all Hall voltages."""
    machine = campaign.machine_number(rig(), number)
    sensitivity = amplitude * machine.plant.parameter("sensitivity").value
    return replace(machine, plant=machine.plant.with_parameters(sensitivity=sensitivity))


@pytest.mark.parametrize("speed", SPEEDS)
@pytest.mark.parametrize("channel", planar_stage.HALL)
def test_four_bad_samples_in_motion_cost_50_um_at_most(channel: str, speed: Mapping[str, float]) -> None:
    healthy = run(rig(), speed=speed)
    faulty = run(rig(), channel, interface.BAD_SAMPLES - 1, speed=speed)
    assert not healthy.faults.any() and not (faulty.faults >> LATCH_BIT).any()
    assert excursion(healthy, faulty) < faults.BRIDGED


@pytest.mark.parametrize("plant", WRONG_PLANTS)
def test_four_bad_samples_cost_50_um_at_most_where_torques_are_not_modelled(plant: int) -> None:
    assert campaign_excursions(DESIGN, subject().block, plant).max() < faults.BRIDGED


@pytest.mark.parametrize(("channel", "value"), [("V_ax", np.nan), ("V_cy", 9.0), ("V_by", np.nan), ("d1", np.nan)])
@pytest.mark.parametrize(("plant", "amplitude"), [(0, 1.0), (3, 1.0), (12, 1.1), (4, 0.9)])
def test_a_lost_channel_in_motion_leaves_no_speed(channel: str, value: float, plant: int, amplitude: float) -> None:
    result = run(on_plant(plant, amplitude), channel, 10_000, value)
    latch, first = int(np.argmax(result.faults >> LATCH_BIT & 1)), round(FAILS / rig().period_s)
    assert latch - first == interface.BAD_SAMPLES + interface.BRAKING - 1
    assert result.faults[first + interface.BAD_SAMPLES - 1] >> BRAKING_BIT & 1
    assert (np.array([r[latch:].max() for r in rates(result)]) < LEFT).all()


@pytest.mark.parametrize("channel", planar_stage.HALL)
def test_a_stuck_channel_leaves_no_speed(channel: str) -> None:
    assert (after_sticking(rig(), channel).max(axis=0) < LEFT).all()


@pytest.mark.parametrize("plant", WRONG_PLANTS)
def test_a_stuck_channel_leaves_no_speed_on_wrong_plants(plant: int) -> None:
    assert (after_sticking(on_plant(plant), "V_ax").max(axis=0) < LEFT).all()
