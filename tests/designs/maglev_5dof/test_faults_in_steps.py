"""Encoders of x and z that freeze or jump inside a large step of the set-point, and the wide gates for them."""

import numpy as np
import pytest

from designs.maglev_5dof.design import DESIGN
from designs.maglev_5dof_precise.design import DESIGN as PRECISE
from synth.app import standard_tasks
from synth.simulate.faults import campaign
from synth.simulate.rig import Rig
from synth.simulate.scenario import Trajectory, sample_times
from tests.designs.maglev_5dof.test_fault_campaign import with_defect

pytestmark = pytest.mark.slow

STEP, SIZE = 1000, 0.06  # sample, m
RIGS = {d.name: campaign.with_stops(standard_tasks.rig(d, d.scalar)) for d in (DESIGN, PRECISE)}


def in_a_step(
    rig: Rig, sensor: str, after: int, jumps: float = 0.0, plant: int = 0, duration: float = 2.5
) -> Trajectory:
    """Return a run in which an encoder freezes, or `jumps` by so many m, so many samples `after` a step of 60 mm."""
    time = sample_times(duration, rig.period_s)
    k = np.arange(len(time))
    rig = campaign.machine_number(rig, plant)
    start, references = {sensor: -SIZE / 2}, {f"{sensor}_ref": np.where(k < STEP, -SIZE / 2, SIZE / 2)}
    if not jumps:
        return rig.run(duration, start, references, lags={sensor: np.clip(k - STEP - after + 1, 0, None)})
    noise = {sensor: np.where(k < STEP + after, 0.0, jumps)}
    return rig.run(duration, start, references, noise=noise)


def notice(run: Trajectory, sensor: str, after: int) -> float:
    """Return the samples from the onset to the first bit that names the sensor; inf for never."""
    named = np.flatnonzero(run.faults >> (15 + "xz".index(sensor)) & 1)
    return float(named[0] - STEP - after) if len(named) else np.inf


@pytest.mark.parametrize("name", RIGS)
@pytest.mark.parametrize("sensor", ["x", "z"])
@pytest.mark.parametrize("after", [80, 150])
def test_an_encoder_that_freezes_in_a_large_step_is_named_within_20_ms(name: str, sensor: str, after: int) -> None:
    for plant in (0, 1):
        run = in_a_step(RIGS[name], sensor, after, plant=plant)
        assert 0 < notice(run, sensor, after) <= 20


@pytest.mark.parametrize("sensor", ["x", "z"])
@pytest.mark.parametrize("after", [250, 300])
def test_an_encoder_that_freezes_where_the_platen_turns_round_does_not_drive_it_into_its_stop(
    sensor: str, after: int
) -> None:
    assert max(in_a_step(RIGS[DESIGN.name], sensor, after, plant=i).impacts[sensor] for i in (0, 1, 5)) < 0.1  # m/s


@pytest.mark.parametrize("name", RIGS)
@pytest.mark.parametrize("jumps", [1e-3, -0.02])
def test_an_encoder_that_jumps_in_a_large_step_is_named_at_once(name: str, jumps: float) -> None:
    for sensor, after in (("x", 100), ("z", 120)):
        assert notice(in_a_step(RIGS[name], sensor, after, jumps), sensor, after) == 0


def from_the_start(rig: Rig) -> float:
    """Return when an encoder of x that stands still from the start, at 30 mm, is named in a step after 20 samples."""
    k = np.arange(300)
    moves = {"x_ref": np.where(k < 20, 0.03, -0.03)}
    run = rig.run(0.3, {"x": 0.03}, moves, lags={"x": k})
    return float(np.argmax(run.faults >> 15 & 1))


def test_the_remembered_prediction_starts_where_the_encoder_does() -> None:
    """The planted defect remembers 0 until the code changes, which it never does."""
    rig = RIGS[DESIGN.name]
    planted = with_defect(rig, "(ready != 0u) ? before_next_if_ready : accepted", "before_next_if_ready")
    assert 20 < from_the_start(rig) < 50 and not 0 < from_the_start(planted) < 50
