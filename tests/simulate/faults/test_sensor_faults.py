"""Experiments of failing sensors: what is measured and checked, with a planted defect for each check."""

from dataclasses import replace

import numpy as np
import pytest

from synth.app import standard_tasks
from synth.declare.experiments import SensorFaults
from synth.errors import SignalError
from synth.fault import LATCH_BIT
from synth.simulate import experiments
from synth.simulate.faults import sensor_faults
from synth.simulate.faults.sensor_faults import Response
from synth.simulate.rig import Rig
from synth.simulate.scenario import Trajectory
from tests.verify.test_stimuli import STAGE

BAD = STAGE.interface.bad_samples
LOST = SensorFaults("not finite", [s.name for s in STAGE.interface.sensors], at_s=0.1, duration_s=0.4)


def knows(rig: Rig, run: Trajectory) -> np.ndarray:
    """A law that knows of every fault from the first sample on."""
    return np.ones(len(run.time), dtype=bool)


KNOWN = replace(LOST, contradicted=knows, isolation=2)
NAMED = "samples from a contradiction to the sensor's name, braking or the latch"
LATCHED = "samples from a contradiction to the latch"


@pytest.fixture(scope="module")
def rig() -> Rig:
    return standard_tasks.rig(STAGE, np.float64)


@pytest.fixture(scope="module")
def lost(rig: Rig) -> Response:
    return sensor_faults.responses(LOST, rig)[0]


@pytest.fixture(scope="module")
def frozen(rig: Rig) -> Response:
    return sensor_faults.responses(replace(LOST, kind="frozen"), rig)[0]


def failing(f: Response, declared: SensorFaults = LOST) -> set[str]:
    return {c.name for c in sensor_faults.checks(declared, [f]) if not c.passed}


def test_a_lost_sensor_is_named_at_once_and_latches(lost: Response) -> None:
    assert lost.detection == 0 and lost.latch == BAD - 1 and lost.others == () and len(lost.words) == lost.sample + BAD
    assert lost.run.time[lost.sample] >= LOST.at_s > lost.run.time[lost.sample - 1]
    assert all(lost.slew_rate(a) <= a.slew_per_s * (1 + 1e-9) and lost.left(a) == 0 for a in STAGE.interface.actuators)
    assert all(lost.excursion(q) <= deviation.max() for q, deviation in lost.deviations.items())


def test_a_sensor_that_freezes_at_rest_keeps_its_last_reading(frozen: Response) -> None:
    shown = frozen.run.measured[frozen.sensor][frozen.sample - 1 :]
    assert (shown == shown[0]).all() and frozen.detection == frozen.latch == np.inf
    assert all(frozen.slew_rate(a) == 0 == frozen.left(a) for a in STAGE.interface.actuators)
    for q, deviation in frozen.deviations.items():
        assert frozen.excursion(q) == deviation[frozen.sample :].max()


def test_a_sensor_that_drops_to_zero_reads_zero_from_the_fault_on(rig: Rig) -> None:
    zero = sensor_faults.responses(replace(LOST, kind="zero"), rig)[0]
    assert not zero.run.measured[zero.sensor][zero.sample :].any()


def test_each_check_fails_for_its_defect(lost: Response, frozen: Response) -> None:
    late, early = replace(lost, sample=lost.sample - 1), replace(lost, sample=lost.sample + 1)
    assert failing(lost) == set() and failing(late) == {"samples until the latch"}
    assert failing(early) == {"samples with a fault before the failure"}
    names = [a.name for a in STAGE.interface.actuators]
    on = {name: np.where(np.arange(len(lost.run.time)) < lost.end, 0.0, 1e3) for name in names}
    assert failing(replace(lost, run=replace(lost.run, commands=on))) == {
        "change of a command from the latch on",
        "command left at the end after a latch",
    }
    noticed = replace(lost, contradicted=0.0)
    assert failing(noticed, KNOWN) == failing(replace(noticed, contradicted=-2.0), KNOWN) == set()
    assert failing(replace(noticed, contradicted=-3.0), KNOWN) == {NAMED, LATCHED}
    never = replace(noticed, run=replace(lost.run, faults=lost.run.faults & ~np.uint32(1 << LATCH_BIT)))
    assert failing(never, KNOWN) == {LATCHED, "sensors whose failure is not noticed"}
    assert failing(frozen, KNOWN) == {"sensors whose failure is not noticed"}
    assert failing(frozen, replace(KNOWN, unnoticed=np.inf)) == set()


def test_the_experiment_shows_the_worst_run_with_the_figures_of_each_sensor(rig: Rig, lost: Response) -> None:
    by_sensor = experiments.result(replace(KNOWN, label="known_at_once"), rig)
    assert by_sensor.name == "known_at_once" and all(c.passed for c in by_sensor.checks)
    assert by_sensor.figures[f"samples until {lost.sensor} is named"] == 0
    assert by_sensor.figures[f"samples until {lost.sensor} is contradicted"] == 0
    shares = experiments.result(replace(KNOWN, motions=({}, {})), rig)
    assert shares.figures["runs"] == 2 * len(KNOWN.sensors) and shares.figures["with a contradiction, %"] == 100
    unknown = experiments.result(replace(LOST, motions=({}, {})), rig)
    assert unknown.figures["latched by other means alone, %"] == 100


def test_what_cannot_be_run_is_refused(rig: Rig) -> None:
    with pytest.raises(SignalError, match=r"a fault 'rust' of .*: choose one of not finite, .*zero.*, of "):
        sensor_faults.responses(replace(LOST, kind="rust"), rig)
    with pytest.raises(SignalError, match="a fault 'not finite' of nose: choose one of"):
        sensor_faults.responses(replace(LOST, sensors=["nose"]), rig)
    with pytest.raises(SignalError, match="on no sample is faulty, or all are"):
        sensor_faults.responses(replace(LOST, at_s=LOST.duration_s - 1e-6), rig)
    with pytest.raises(SignalError, match=r"a fault from 0 s on in 0\.4 s: give at least one of each"):
        replace(LOST, at_s=0.0)
