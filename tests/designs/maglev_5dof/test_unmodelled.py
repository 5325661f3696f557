"""Sound encoders with noise and errors of scale are never named; an encoder of x or z with the wrong sign is."""

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
from synth.signals import Signal
from synth.simulate import conditions, effects
from synth.simulate.faults import campaign
from synth.simulate.rig import Rig
from synth.simulate.scenario import Trajectory, sample_times
from tests.designs.maglev_5dof.test_fault_campaign import with_defect

pytestmark = pytest.mark.slow

RIGS = {d.name: campaign.with_stops(standard_tasks.rig(d, d.scalar)) for d in (DESIGN, PRECISE)}
LIFT_S = 1.5
ONSET = 1000


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


@pytest.mark.parametrize("name", RIGS)
@pytest.mark.parametrize("lifts", [False, True])
@pytest.mark.parametrize("gain_error", [1e-3, -1e-3])
def test_noise_of_a_count_on_every_encoder_and_a_wrong_scale_set_no_bit(
    name: str, lifts: bool, gain_error: float
) -> None:
    wrong = Readings(gain_error=gain_error, noise=fault_handling.SOUND.noise)
    for plant in (0, 5, 12):
        assert not disturbed(RIGS[name], plant, lifts, wrong).faults.any()


def test_a_threshold_that_does_not_follow_the_noise_names_sound_encoders() -> None:
    """The planted defect: the threshold of a quiet machine, and the gate of frozen codes without noise."""
    wrong = Readings(noise=fault_handling.SOUND.noise)
    quiet = with_defect(RIGS[DESIGN.name], "size <= redundancy_threshold_0", "size <= 4.8e-5f")
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


def misreads(rig: Rig, axis: str, gain: float, onset: int, origin: float, n: int) -> Rig:
    """Return the rig whose encoder counts a distance from `origin` `gain` times, from a sample on."""
    plant = rig.plant
    i, q = [o.name for o in plant.outputs].index(axis), [s.name for s in plant.states].index(axis)
    x, u, p = (ca.SX.sym(letter, n) for letter, n in zip("xup", map(plant.f.size1_in, range(3)), strict=True))
    active, y = ca.SX.sym("active"), plant.h(x, u, p)
    y[i] += (gain - 1) * active * (x[q] - origin)
    names, inputs = [x, ca.vertcat(u, active), p], (*plant.inputs, Signal("active", "1", 0, 1))
    f, h = ca.Function("f", names, [plant.f(x, u, p)]), ca.Function("h", names, [y])
    wrong = Plant(plant.name, plant.states, inputs, plant.outputs, plant.parameters, f, h)
    return replace(rig, plant=wrong, forcing={**rig.forcing, "active": (np.arange(n) >= onset).astype(float)})


@pytest.mark.parametrize("name", RIGS)
@pytest.mark.parametrize("axis", ["x", "z"])
@pytest.mark.parametrize("plant", [0, 6])
def test_an_encoder_that_counts_backwards_from_rest_is_named_and_touches_slowly(
    name: str, axis: str, plant: int
) -> None:
    """Reversed at its set-point, where nothing tells at first: the prediction leaves it as the platen runs away."""
    rig, n = campaign.machine_number(RIGS[name], plant), 3000
    run = misreads(rig, axis, -1.0, ONSET, 0.0, n).run(3.0, {"y": 0.025})
    bits = np.flatnonzero(run.faults)
    assert ONSET <= bits[0] < ONSET + 250 and run.faults[bits[0]] >> 15 + "xz".index(axis) & 1
    assert run.impacts[axis] < 0.10 and run.impacts["y"] < 0.02  # m/s
    unseen = with_defect(rig, "away = 0.0003f", "away = 9.0f")  # the planted defect
    assert misreads(unseen, axis, -1.0, ONSET, 0.0, n).run(3.0, {"y": 0.025}).impacts[axis] > 0.15


@pytest.mark.parametrize("name", RIGS)
def test_missed_calls_are_not_taken_for_a_reading_that_leaves_its_prediction(name: str) -> None:
    rig, n = RIGS[name], 3000
    references = courses(rig, sample_times(3.0, rig.period_s), False)
    for plant, onset in ((0, 1000), (5, 1333), (12, 1166)):
        missed = (np.arange(n) >= onset) & (np.arange(n) < onset + 40)
        run = campaign.machine_number(rig, plant).run(
            3.0, campaign.start_of(rig, references), references, missed=missed
        )
        assert not any(np.bitwise_or.reduce(run.faults) >> b & 1 for b in (15, 16, 31))


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
