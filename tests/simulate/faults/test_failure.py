"""Sensor failures in closed loop: the sensor is identified at once or never; commands go to their safe values."""

import numpy as np

from synth.app import standard_tasks
from synth.simulate.faults import failure_experiments
from synth.simulate.faults.failure_experiments import Failure
from tests.verify.test_stimuli import STAGE

AT, DURATION = 0.1, 0.4  # s


def fail(shown: float | None) -> Failure:
    rig = standard_tasks.rig(STAGE, np.float64)
    point = rig.stage.interface.set_points[0]
    n = round(DURATION / rig.period_s)
    course = np.full(n, rig.at_rest()[point.name])
    return failure_experiments.fail(
        rig, rig.stage.interface.sensors[0].name, shown, AT, DURATION, {point.name: course}, {}
    )


def test_a_nan_sensor_is_identified_and_latches() -> None:
    f, bad = fail(np.nan), STAGE.interface.bad_samples
    assert (
        f.samples_to_detection == 0
        and f.samples_to_latch == bad - 1
        and f.misidentified_sensors == ()
        and len(f.words) == f.sample + bad
    )
    assert f.run.time[f.sample] >= AT > f.run.time[f.sample - 1]
    rates = [a.slew_per_s for a in STAGE.interface.actuators]
    assert f.max_slew_rate() <= max(rates) * (1 + 1e-9) and f.final_command() == 0
    assert f.excursion <= f.deviation.max()


def test_a_sensor_that_sticks_at_rest_keeps_its_reading() -> None:
    f = fail(None)
    name, k = f.sensor, f.sample
    shown = f.run.measured[name][k:]
    assert (
        (shown == shown[0]).all()
        and f.samples_to_detection is None
        and f.samples_to_latch is None
        and f.max_slew_rate() == 0 == f.final_command()
    )
    assert f.excursion == f.deviation[k:].max()
