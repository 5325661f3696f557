"""Sound encoders with noise and errors of scale are never named."""

from collections.abc import Iterable
from dataclasses import replace

import casadi as ca
import numpy as np
import pytest

from designs.maglev import fault_handling, platen
from designs.maglev_5dof.design import DESIGN
from designs.maglev_5dof_precise.design import DESIGN as PRECISE
from models import maglev_stage, pmlsm
from synth.app import standard_tasks
from synth.declare.effects import Readings
from synth.plant import Plant
from synth.simulate import conditions, effects
from synth.simulate.faults import campaign
from synth.simulate.rig import Rig
from synth.simulate.scenario import Trajectory, sample_times
from tests.designs.maglev_5dof.test_fault_campaign import with_defect

pytestmark = pytest.mark.slow

RIGS = {d.name: campaign.with_stops(standard_tasks.rig(d, d.scalar)) for d in (DESIGN, PRECISE)}
LIFT_S = 1.5


def courses(rig: Rig, time: np.ndarray, lifts: bool) -> dict[str, np.ndarray]:
    """Return the 4-DOF tracking; if it `lifts` off, from the stop at first, and with all but y faded in."""
    moving = {f"{n}_ref": course for n, course in platen.COURSES.items()}
    if not lifts:
        return conditions.profiles(rig.stage.interface, moving, time)
    later = conditions.profiles(rig.stage.interface, moving, np.maximum(time - LIFT_S, 0.0))
    stop = platen.AXES[0].reference.high
    up = np.clip(time / LIFT_S, 0.0, 1.0) * (later["y_ref"][0] - stop) + stop
    fade = np.clip(time - LIFT_S, 0.0, 1.0)
    return {n: np.where(time < LIFT_S, up, r) if n == "y_ref" else fade * r for n, r in later.items()}


def disturbed(rig: Rig, plant: int, lifts: bool, *wrong: Readings, duration_s: float = 10.0) -> Trajectory:
    """Return the tracking on a plant of the campaign with wrong readings."""
    machine = effects.with_effects(replace(campaign.machine_number(rig, plant), seed=plant), wrong)
    references = courses(machine, sample_times(duration_s, machine.period_s), lifts)
    start = {"y": platen.GAP[1]} if lifts else campaign.start_of(machine, references)
    return machine.run(duration_s, start, references)


def alarms(name: str, lifts: bool, gain_error: float, plants: Iterable[int], duration_s: float) -> list[int]:
    """Return the plants on which a sound encoder with noise of a count and a wrong scale sets a bit."""
    wrong = Readings(gain_error=gain_error, noise=fault_handling.SOUND.noise)
    return [i for i in plants if disturbed(RIGS[name], i, lifts, wrong, duration_s=duration_s).faults.any()]


@pytest.mark.parametrize("name", RIGS)
@pytest.mark.parametrize("lifts", [False, True])
@pytest.mark.parametrize("gain_error", [1e-3, -1e-3])
def test_noise_of_a_count_on_every_encoder_and_a_wrong_scale_set_no_bit(
    name: str, lifts: bool, gain_error: float
) -> None:
    assert not alarms(name, lifts, gain_error, (0, 5, 12), 10.0)


@pytest.mark.whole
@pytest.mark.parametrize("name", RIGS)
@pytest.mark.parametrize("lifts", [False, True])
@pytest.mark.parametrize("gain_error", [0.0, 1e-3, -1e-3])
def test_a_minute_on_17_plants_with_noise_of_a_count_and_a_wrong_scale_sets_no_bit(
    name: str, lifts: bool, gain_error: float
) -> None:
    assert not alarms(name, lifts, gain_error, range(17), 60.0)


def test_a_threshold_that_does_not_follow_the_noise_names_sound_encoders() -> None:
    """The planted defect: the threshold of a quiet machine, and the gate of frozen codes without noise."""
    wrong = Readings(noise=fault_handling.SOUND.noise)
    quiet = with_defect(RIGS[DESIGN.name], "residual_0) <= state->bound_0", "residual_0) <= 2.3e-9f")
    assert np.bitwise_or.reduce(disturbed(quiet, 0, False, wrong).faults) >> 11 & 0xF
    gate = with_defect(RIGS[PRECISE.name], "frozen_gate = 8.2e-05f", "frozen_gate = 4e-05f")
    assert any(np.bitwise_or.reduce(disturbed(gate, i, False, wrong).faults) >> 15 & 3 for i in range(3))


@pytest.mark.parametrize("name", RIGS)
@pytest.mark.parametrize("share", [-1e-3, 1e-3])
def test_a_wrong_scale_does_not_wind_the_law_up_on_the_stop(name: str, share: float) -> None:
    """The reading on the stop is 31 um wrong, and no set-point is nearer than 50 um."""
    machine = effects.with_effects(RIGS[name], [Readings(gain_error=share)])
    run = machine.run(30.0, {"y": platen.GAP[1]}, {"y_ref": np.full(30_000, platen.AXES[0].reference.high)})
    currents = np.array([run.commands[f"i_d{j}"] for j in platen.MOTORS])
    assert not run.faults.any() and np.abs(currents[:, -1] - currents[:, 5000]).max() < 0.3  # A


def test_the_safe_output_lowers_level_plants_and_not_every_tilted_one_from_the_upper_stop() -> None:
    def falls(plant: Plant, tilt: float) -> float:
        p, r = maglev_stage.nominal(plant), plant.parameter("r").value
        gaps = [platen.GAP[0] + r * np.sin(s * tilt) for s in (0, 1, 0, -1)]
        i_d, i_q = ca.SX(platen.SAFE_CURRENT), ca.SX(0.0)
        lift = sum(float(pmlsm.normal_force(ca.SX(g), i_d, i_q, p, pmlsm.STRESS)) for g in gaps)
        return plant.parameter("G").value + lift / plant.parameter("M_y").value

    plants = [campaign.plant_number(maglev_stage.plant(), i) for i in range(17)]
    assert min(falls(plant, 0.0) for plant in plants) > 1.0  # m/s^2, downwards
    assert min(falls(plant, platen.HELD_UP) for plant in plants) > 0.0 > min(falls(plant, 8e-3) for plant in plants)
