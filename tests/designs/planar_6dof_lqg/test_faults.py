"""Hall channels that fail under the LQG controller, on the stage: bridged, braked, and the amplitude of all of them."""

from collections.abc import Mapping
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from designs.planar_6dof import failures, faults, interface, lqg, motion
from designs.planar_6dof import loop as loops
from designs.planar_6dof_lqg.design import DESIGN, subject
from models import hall_sections, planar_stage
from synth import standard_tasks
from synth.block import Block
from synth.progress import silent
from synth.simulate import campaign, injections
from synth.simulate.rig import Rig
from synth.simulate.scenario import Trajectory, sample_times
from synth.simulate.sensors import Override
from synth.statespace import Array

SPEEDS = ({"x": 0.115, "y": -0.08}, {"x": -0.099, "y": -0.099})  # m/s, 0.14 together
FAILS, DURATION = 0.4, 0.9  # s
STUCK_DURATION, COAST = 2.4, 0.5  # s; after the latch
LARGEST_SPEED, LARGEST_YAW_RATE = 0.05, 0.2  # m/s, rad/s
SHORT_LOSS = "V_ax", "not finite", "short"
WRONG_PLANTS = (8, 1, 2, 3, 6)  # of the campaign, those with the largest torques that are not modelled
AMPLITUDE, BRAKING, LATCH = 1 << hall_sections.AMPLITUDE_BIT, 1 << 30, 1 << 31


@cache
def rig() -> Rig:
    return loops.of(subject().block)


def ramp(rate: float, start: float, time: Array) -> Array:
    """Return set-points (N,) that rest for 0.1 s and then move as far as the travel allows."""
    return np.clip(start + rate * np.maximum(time - 0.1, 0), -0.098, 0.098)


def run(
    rig: Rig,
    channel: str = "",
    samples: int = 0,
    value: float = np.nan,
    speed: Mapping[str, float] = SPEEDS[0],
    duration: float = DURATION,
) -> Trajectory:
    """Run a ramp in which a channel shows a value in some samples."""
    time = sample_times(duration, rig.period_s)
    start = {axis: -0.17 * v for axis, v in speed.items()}  # within half a pitch of the middle, as init needs it
    references = {axis: ramp(v, start[axis], time) for axis, v in speed.items()}
    first = round(FAILS / rig.period_s)
    bad = np.isin(np.arange(len(time)), range(first, first + samples))
    overrides = {channel: Override(bad, np.full(len(time), value))} if channel else {}
    return loops.simulate(rig, duration, references, start, overrides=overrides)


def excursion(one: Trajectory, other: Trajectory) -> float:
    return max(float(np.abs(one[axis] - other[axis]).max()) for axis in "xy")


def rates(result: Trajectory) -> tuple[Array, Array]:
    """Return speed and yaw rate (N,)."""
    return np.hypot(result["vx"], result["vy"]), np.abs(result["wphi"])


# Bridged


@pytest.mark.parametrize("speed", SPEEDS)
@pytest.mark.parametrize("channel", planar_stage.HALL)
def test_four_bad_samples_in_motion_cost_50_um_at_most(channel: str, speed: Mapping[str, float]) -> None:
    healthy = run(rig(), speed=speed)
    faulty = run(rig(), channel, interface.BAD_SAMPLES - 1, speed=speed)
    assert not healthy.faults.any() and not (faulty.faults & LATCH).any()
    assert excursion(healthy, faulty) < 50e-6


def test_a_wrong_prediction_does_not_bridge() -> None:
    """Planted: the acceleration of the prediction has the wrong sign."""
    block = subject().block
    off = [replace(c, value=-c.value) if c.name == "reckoning_x_half_step" else c for c in block.constants]
    wrong = loops.of(replace(block, constants=tuple(off)))
    healthy, faulty = run(wrong), run(wrong, "V_cy", interface.BAD_SAMPLES - 1)
    assert healthy.faults.any() or excursion(healthy, faulty) > 5e-6


def campaign_excursions(block: Block, plant: int) -> Array:
    """Return the excursions (2, 2) of x and y, m, after four bad samples of V_ax in the campaign's motion."""
    assert DESIGN.stage is not None
    declared = standard_tasks.rig(DESIGN.stage, DESIGN.scalar)
    stage = campaign.with_stops(replace(declared, controller=loops.of(block).controller))
    moving = next(c for c in campaign.motion_and_standstill(stage) if c.name == campaign.IN_MOTION)
    losses = [i for i in injections.derive(stage.stage) if (i.target, i.kind, i.duration) == SHORT_LOSS]
    _, runs = campaign.run(stage, plant, moving, silent, losses)
    return np.array([[r.excursion[axis] for axis in "xy"] for r in runs])


@pytest.mark.parametrize("plant", WRONG_PLANTS)
def test_four_bad_samples_cost_50_um_at_most_where_torques_are_not_modelled(plant: int) -> None:
    assert campaign_excursions(subject().block, plant).max() < faults.BRIDGED


def test_without_the_last_innovation_the_yaw_jumps(monkeypatch: pytest.MonkeyPatch) -> None:
    """Planted: a bad sample takes the predicted yaw as it is."""
    monkeypatch.setattr(
        hall_sections, "_bridge", lambda u, *_: {a: u[s.name] for a, s in hall_sections.PREDICTED.items()}
    )
    assert campaign_excursions(lqg.controller(planar_stage.plant()), WRONG_PLANTS[0]).max() > faults.BRIDGED


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


def test_without_braking_the_platen_coasts(monkeypatch: pytest.MonkeyPatch) -> None:
    """Planted: the braking removes nothing of the rates worth the name."""
    monkeypatch.setattr(motion, "SHARE", 1e-3)
    result = run(loops.of(lqg.controller(planar_stage.plant())), "V_ax", 10_000)
    assert rates(result)[0][-1] > LARGEST_SPEED


def after_sticking(rig: Rig, channel: str) -> Array:
    """Return (N, 2) speed and yaw rate half a second after the latch, for a channel that sticks in six motions."""
    left = []
    for size in (0.02, 0.08, 0.14):
        for direction in (0.5, 3.9):
            speed = {"x": size * np.cos(direction), "y": size * np.sin(direction)}
            healthy = run(rig, speed=speed, duration=STUCK_DURATION)
            value = float(np.asarray(healthy.measured[channel])[round(FAILS / rig.period_s)])
            result = run(rig, channel, 10_000, value, speed, STUCK_DURATION)
            at = int(np.argmax(result.faults >> 31 & 1)) + round(COAST / rig.period_s)
            left.append([r[min(at, len(r) - 1)] for r in rates(result)] if result.faults[-1] >> 31 else [9.0, 9.0])
    return np.array(left)


@pytest.mark.parametrize("channel", planar_stage.HALL)
def test_a_stuck_channel_leaves_no_speed(channel: str) -> None:
    assert (after_sticking(rig(), channel).max(axis=0) < (LARGEST_SPEED, LARGEST_YAW_RATE)).all()


def test_fast_filters_learn_the_motion_of_a_stuck_channel(monkeypatch: pytest.MonkeyPatch) -> None:
    """Planted: the poles of the prediction are 0.8."""
    monkeypatch.setattr(motion, "POLE", dict.fromkeys(motion.POLE, 0.8))
    left = after_sticking(loops.of(lqg.controller(planar_stage.plant())), "V_ay")
    assert (left > (LARGEST_SPEED, LARGEST_YAW_RATE)).any()


# The amplitude of all voltages


def turning(rig: Rig, factor: float, plant: int) -> Trajectory:
    """Run a ramp of x with an oscillating yaw on a perturbed plant with another amplitude."""
    perturbed = campaign.plant_number(rig.plant, plant)
    sensitivity = factor * perturbed.parameter("sensitivity").value
    time = sample_times(1.5, rig.period_s)
    references = {"x": ramp(0.1, -0.02, time), "phi": 7.8e-3 * np.sin(20 * np.pi * time)}
    stage = replace(rig, plant=perturbed.with_parameters(sensitivity=sensitivity))
    return loops.simulate(stage, 1.5, references, {"x": -0.02})


@pytest.mark.parametrize("factor", [0.9, 1.1])
@pytest.mark.parametrize("plant", [0, 1, 3, 6, 8, 14])
def test_another_amplitude_by_a_tenth_is_no_fault(plant: int, factor: float) -> None:
    assert not turning(rig(), factor, plant).faults.any()


def test_without_the_scale_another_amplitude_latches(monkeypatch: pytest.MonkeyPatch) -> None:
    """Planted: the scale of the voltages stays near 1."""
    monkeypatch.setattr(hall_sections, "SCALE", replace(hall_sections.SCALE, low=0.99, high=1.01))
    assert (turning(loops.of(lqg.controller(planar_stage.plant())), 1.1, 8).faults & LATCH).any()


def test_an_amplitude_that_jumps_has_its_own_bit_beside_all_six_channels() -> None:
    at_rest = loops.simulate(rig(), 0.5, {}, failures.START)
    time, first = sample_times(0.5, rig().period_s), 200
    late = np.arange(len(time)) >= first
    overrides = {n: Override(late, 1.25 * np.asarray(at_rest.measured[n], dtype=float)) for n in planar_stage.HALL}
    result = loops.simulate(rig(), 0.5, {}, failures.START, overrides=overrides)
    word = int(np.bitwise_or.reduce(result.faults))
    suspects = {f["suspect"] for f in rig().controller.manifest["faults"] if f.get("suspect") and word >> f["bit"] & 1}
    assert word & AMPLITUDE and suspects == set(planar_stage.HALL)
