"""Missing calls in the 4-DOF tracking: 40 end in no contact, and no law that follows the course survives 60."""

import numpy as np
import pytest

from designs.maglev import platen
from designs.maglev.fault_handling import MISSED_CALLS
from designs.maglev_5dof.design import DESIGN
from models import maglev_stage
from studies.maglev.held_currents import PERIOD_S, STATES, course, machine
from synth.app import standard_tasks
from synth.simulate.faults import campaign
from synth.simulate.scenario import Trajectory, sample_times
from tests.designs.maglev_5dof import full_plant

WRONG_PLANTS = (1, 6)  # of the campaign: with stronger magnets, so the gap is less stable
CLIMBING = (20.5 / 24, 21 / 24)  # phases of the course in which the platen approaches its upper stop
SETTLED, FREQUENCY = 10.0, platen.COURSES["y"].frequency  # s, from which on the paper measures; rad/s
ON_COURSE = [STATES.index(maglev_stage.RATE[q]) for q in maglev_stage.RATE]


def missed_bit() -> int:
    """Return the bit of the fault word that reports missed calls."""
    assert DESIGN is not None
    faults = standard_tasks.rig(DESIGN, DESIGN.scalar).controller.manifest["faults"]
    return next(int(f["bit"]) for f in faults if f.get("input") == "missed_calls")


def onset(phase: float) -> int:
    """Return the first sample at a phase of the course after SETTLED."""
    periods = np.ceil(SETTLED * FREQUENCY / (2 * np.pi)) + phase
    return round(periods * 2 * np.pi / FREQUENCY / PERIOD_S)


def tracking(plant: int, phase: float, missed: int) -> Trajectory:
    """Run the 4-DOF tracking, settled, and miss calls at a phase of its course."""
    assert DESIGN is not None
    rig, first = campaign.with_stops(standard_tasks.rig(DESIGN, DESIGN.scalar)), onset(phase)
    duration_s = (first + missed + 250) * PERIOD_S
    time = sample_times(duration_s, PERIOD_S)
    references = {f"{axis}_ref": sine(time) for axis, sine in platen.COURSES.items()}
    start = {axis: float(references[f"{axis}_ref"][0]) for axis in ("y", "x", "z")}
    k = np.arange(len(time))
    return campaign.machine_number(rig, plant).run(
        duration_s, start, references, missed=(k >= first) & (k < first + missed)
    )


@pytest.mark.parametrize("phase", CLIMBING)
@pytest.mark.parametrize("plant", WRONG_PLANTS)
def test_no_currents_that_follow_the_course_survive_60_missing_calls(plant: int, phase: float) -> None:
    """With the plant and its state known exactly, and with the largest currents afterwards."""
    best = machine(plant).bound(phase, 60)
    assert best.y < -50e-6 and best.theta > 1e-3 and abs(best.split) < 6


@pytest.mark.parametrize("plant", [0, *WRONG_PLANTS])
def test_currents_that_follow_the_course_survive_40_missing_calls(plant: int) -> None:
    """Planted: a bound that finds a contact everywhere would say so here."""
    assert min(machine(plant).bound(phase, 40).least for phase in CLIMBING) > 0.8e-3


def test_60_missing_calls_need_an_acceleration_within_a_hundredth_of_the_weight() -> None:
    """On the nominal plant: 0.1 m/s^2 too much towards the stop is a contact, with the right one there is none."""
    phase = CLIMBING[1]
    assert 0.3e-3 < machine(0).bound(phase, 60).y < 0.5e-3
    assert machine(0).bound(phase, 60, -0.1).y < 0


def test_the_currents_of_the_bound_accelerate_the_platen_along_the_course() -> None:
    """The currents are those of the independent model in NumPy, too."""
    for phase in CLIMBING:
        x, acceleration = course(phase)
        i = machine(0).currents(x, acceleration, 1.0, np.r_[np.ones(4), 0.0, 0.0])
        assert i is not None and i[0] + i[2] - i[1] - i[3] == pytest.approx(1.0, abs=1e-9)
        motors = np.r_[i[:4], i[5], i[4], i[5], i[4]]  # u_z drives motors 1 and 3
        rates = full_plant.plant(x, motors, full_plant.reference_stage.Parameters())
        assert rates[ON_COURSE] == pytest.approx(acceleration, rel=1e-3, abs=1e-3)


@pytest.mark.slow
@pytest.mark.parametrize("phase", [0.0, *CLIMBING])
@pytest.mark.parametrize("plant", [0, *WRONG_PLANTS])
def test_40_missing_calls_end_in_no_contact_and_60_are_reported(plant: int, phase: float) -> None:
    healthy = tracking(plant, phase, 0)
    missed = tracking(plant, phase, MISSED_CALLS)
    assert missed.impacts == healthy.impacts and not missed.faults.any()
    reported = tracking(plant, phase, 60).faults
    first = onset(phase) + 60
    assert not reported[:first].any() and reported[first] >> missed_bit() & 1
