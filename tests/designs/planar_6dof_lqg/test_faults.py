"""Hall channels that fail under the LQG controller, on the stage: bridged, braked, and the amplitude of all of them."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from designs.planar_6dof import failures, interface, motion
from designs.planar_6dof import loop as loops
from designs.planar_6dof_lqg.design import subject
from models import hall_sections, planar_stage
from synth.simulate import campaign
from synth.simulate.rig import Rig
from synth.simulate.scenario import Trajectory, sample_times
from synth.simulate.sensors import Override
from synth.statespace import Array

SPEED, FAILS, DURATION = {"x": 0.115, "y": -0.08}, 0.4, 0.9  # m/s (0.14 together), s
AMPLITUDE, BRAKING = 1 << hall_sections.AMPLITUDE_BIT, 1 << 30


@cache
def rig() -> Rig:
    return loops.of(subject().block)


def run(rig: Rig, channel: str = "", samples: int = 0, value: float = np.nan) -> Trajectory:
    """Run a ramp at 0.14 m/s, in which a channel shows a value in some samples."""
    time = sample_times(DURATION, rig.period_s)
    start = {axis: -0.45 * v for axis, v in SPEED.items()}
    references = {axis: start[axis] + v * np.maximum(time - 0.1, 0) for axis, v in SPEED.items()}
    first = round(FAILS / rig.period_s)
    bad = np.isin(np.arange(len(time)), range(first, first + samples))
    overrides = {channel: Override(bad, np.full(len(time), value))} if channel else {}
    return loops.simulate(rig, DURATION, references, start, overrides=overrides)


def excursion(one: Trajectory, other: Trajectory) -> float:
    return max(float(np.abs(one[axis] - other[axis]).max()) for axis in "xy")


def rates(result: Trajectory) -> tuple[Array, Array]:
    """Return speed and yaw rate (N,)."""
    return np.hypot(result["vx"], result["vy"]), np.abs(result["wphi"])


@pytest.mark.parametrize("channel", planar_stage.HALL)
def test_four_bad_samples_in_motion_cost_50_um_at_most(channel: str) -> None:
    healthy, faulty = run(rig()), run(rig(), channel, interface.BAD_SAMPLES - 1)
    assert not healthy.faults.any() and not (faulty.faults >> 31).any()
    assert excursion(healthy, faulty) < 50e-6


def test_a_wrong_prediction_does_not_bridge() -> None:
    """Planted: the acceleration of the prediction has the wrong sign."""
    block = subject().block
    off = [replace(c, value=-c.value) if c.name == "reckoning_x_half_step" else c for c in block.constants]
    wrong = loops.of(replace(block, constants=tuple(off)))
    healthy, faulty = run(wrong), run(wrong, "V_cy", interface.BAD_SAMPLES - 1)
    assert healthy.faults.any() or excursion(healthy, faulty) > 5e-6


@pytest.mark.parametrize(("channel", "value"), [("V_ax", np.nan), ("V_cy", 9.0), ("V_by", np.nan)])
def test_a_lost_channel_in_motion_leaves_no_speed(channel: str, value: float) -> None:
    result = run(rig(), channel, 10_000, value)
    latch = int(np.argmax(result.faults >> 31 & 1))
    first = round(FAILS / rig().period_s)
    assert latch - first == interface.BAD_SAMPLES + motion_samples() - 1
    assert (result.faults[first + interface.BAD_SAMPLES - 1] & BRAKING) > 0
    speed, yaw = rates(result)
    assert speed[latch:].max() < 0.05 and yaw[latch:].max() < 0.2


def motion_samples() -> int:
    return interface.BRAKING


def test_without_braking_the_platen_coasts(monkeypatch: pytest.MonkeyPatch) -> None:
    """Planted: the braking removes nothing of the rates worth the name."""
    monkeypatch.setattr(motion, "SHARE", 1e-3)
    subject.cache_clear()
    result = run(loops.of(subject().block), "V_ax", 10_000)
    subject.cache_clear()
    assert rates(result)[0][-1] > 0.05


@pytest.mark.parametrize("factor", [0.9, 1.1])
@pytest.mark.parametrize("plant", [0, 3])
def test_another_amplitude_by_a_tenth_is_no_fault(plant: int, factor: float) -> None:
    perturbed = campaign.plant_number(rig().plant, plant)
    sensitivity = factor * perturbed.parameter("sensitivity").value
    assert not run(replace(rig(), plant=perturbed.with_parameters(sensitivity=sensitivity))).faults.any()


def test_an_amplitude_that_jumps_has_its_own_bit_and_names_no_channel() -> None:
    at_rest = loops.simulate(rig(), 0.5, {}, failures.START)
    time, first = sample_times(0.5, rig().period_s), 200
    late = np.arange(len(time)) >= first
    overrides = {n: Override(late, 1.25 * np.asarray(at_rest.measured[n], dtype=float)) for n in planar_stage.HALL}
    result = loops.simulate(rig(), 0.5, {}, failures.START, overrides=overrides)
    word = int(np.bitwise_or.reduce(result.faults))
    named = [f for f in rig().controller.manifest["faults"] if f.get("suspect") and word >> f["bit"] & 1]
    assert word & AMPLITUDE and not named
