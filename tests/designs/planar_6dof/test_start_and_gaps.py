"""Hall channels that are bad from the first sample on, or now and then, on the stage: off the middle, tilted."""

from collections.abc import Callable
from types import ModuleType

import numpy as np
import pytest
from numpy.typing import NDArray

from designs.planar_6dof import loop as loops
from designs.planar_6dof_leadlag import design as leadlag
from designs.planar_6dof_lqg import design as lqg
from models import planar_stage
from synth.simulate.faults import campaign
from synth.simulate.rig import Rig
from synth.simulate.scenario import Override, Trajectory, sample_times

POSE = {"x": 0.021, "y": -0.017, "phi": 4e-3, "theta": 1e-3, "psi": -1e-3}  # m, rad
LATCH, SUSPECTS = 1 << 31, 0b111111 << 15
TWISTED = 5, 6  # plants of the campaign with the largest torques about Z, one of each sign


def run(rig: Rig, channel: str, bad: Callable[[int], NDArray[np.bool_]], duration: float) -> Trajectory:
    """Run at rest in POSE; the channel is NaN in the samples that `bad` returns for their number."""
    n = len(sample_times(duration, rig.period_s))
    overrides = {channel: Override(bad(n), np.full(n, np.nan))}
    return loops.simulate(rig, duration, {a: np.full(n, v) for a, v in POSE.items()}, POSE, overrides=overrides)


@pytest.mark.parametrize("channel", planar_stage.HALL)
@pytest.mark.parametrize("package", [leadlag, lqg])
def test_no_current_flows_before_the_hall_voltages_are_complete(package: ModuleType, channel: str) -> None:
    rig = loops.of(package.subject().block)
    healed = run(rig, channel, lambda n: np.arange(n) < 4, 0.4)
    currents = np.array([healed.commands[s.name] for s in planar_stage.INPUTS])
    assert not currents[:, :4].any() and currents[:, 4].any()
    assert not healed.faults[4:].any() and not (healed.faults & LATCH).any()
    assert max(abs(healed[axis] - POSE[axis]).max() for axis in "xy") < 2.5e-3 and abs(healed["phi"]).max() < 0.015


@pytest.mark.parametrize("package", [leadlag, lqg])
def test_a_channel_that_is_lost_from_the_start_leaves_the_platen_at_rest(package: ModuleType) -> None:
    rig = loops.of(package.subject().block)
    lost = run(rig, "V_ay", lambda n: np.ones(n, bool), 0.4)
    assert lost.faults[-1] & LATCH and not np.array([lost.commands[s.name] for s in planar_stage.INPUTS]).any()
    assert all(abs(lost[axis][-1] - POSE[axis]) < 1e-6 for axis in ("x", "y", "phi"))


def now_and_then(n: int) -> NDArray[np.bool_]:
    """Return a tenth of n samples, at random."""
    return np.asarray(np.random.default_rng(3).uniform(size=n) < 0.1)


@pytest.mark.parametrize("number", TWISTED)
@pytest.mark.parametrize("package", [leadlag, lqg])
def test_bad_samples_now_and_then_do_not_latch(package: ModuleType, number: int) -> None:
    """A torque that is not modelled turns the platen a little in each of them, and the next measurement corrects it."""
    rig = campaign.machine_number(loops.of(package.subject().block), number)
    for channel in ("V_ax", "V_by"):
        some = run(rig, channel, now_and_then, 6.0)
        assert not (some.faults & (LATCH | SUSPECTS)).any()
        assert abs(some["phi"]).max() < 0.01
