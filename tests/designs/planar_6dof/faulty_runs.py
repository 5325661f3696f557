"""Runs of a planar controller in which a Hall channel fails, and what is left of the motion."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from designs.planar_6dof import loop as loops
from synth.app import standard_tasks
from synth.base.progress import silent
from synth.block import Block
from synth.declare.stage import Stage
from synth.simulate.faults import campaign, injections
from synth.simulate.faults.campaign import FaultRun
from synth.simulate.rig import Rig
from synth.simulate.scenario import Override, Trajectory, sample_times
from synth.statespace import Array

SPEEDS = ({"x": 0.115, "y": -0.08}, {"x": -0.099, "y": -0.099})  # m/s, 0.14 together
FAILS, DURATION = 0.4, 0.9  # s
STUCK_DURATION, COAST = 2.4, 0.5  # s; after the latch
LARGEST_SPEED, LARGEST_YAW_RATE = 0.05, 0.2  # m/s, rad/s
SHORT_LOSS = "V_ax", "not finite", "short"
MOVING, OFF_THE_MIDDLE = 1, 2  # conditions of the campaign


def ramp(rate: float, start: float, time: Array) -> Array:
    """Return set-points (N,) that rest for 0.1 s and then move as far as the travel allows."""
    return np.clip(start + rate * np.maximum(time - 0.1, 0), -0.098, 0.098)


def run(
    rig: Rig,
    channel: str = "",
    samples: int = 0,
    value: Array | float = np.nan,
    speed: Mapping[str, float] = SPEEDS[0],
    duration: float = DURATION,
) -> Trajectory:
    """Run a ramp in which a channel shows a value in some samples."""
    time = sample_times(duration, rig.period_s)
    start = {axis: -0.17 * v for axis, v in speed.items()}  # within half a pitch of the middle, as init needs it
    references = {axis: ramp(v, start[axis], time) for axis, v in speed.items()}
    first = round(FAILS / rig.period_s)
    bad = np.isin(np.arange(len(time)), range(first, first + samples))
    overrides = {channel: Override(bad, np.broadcast_to(value, len(time)))} if channel else {}
    return loops.simulate(rig, duration, references, start, overrides=overrides)


def stuck_value(rig: Rig, channel: str, speed: Mapping[str, float], duration: float) -> Array:
    """Return what a channel reads (N,) whose field sticks at the failure: the noise stays, so no code repeats."""
    healthy = run(rig, speed=speed, duration=FAILS + 0.1)
    sensor = next(s for s in rig.stage.interface.sensors if s.name == channel)
    noise = np.random.default_rng(1).normal(0, sensor.noise, len(sample_times(duration, rig.period_s)))
    value = float(np.asarray(healthy.measured[channel])[round(FAILS / rig.period_s)])
    return np.asarray(sensor.resolution * np.round((value + noise) / sensor.resolution))


def excursion(one: Trajectory, other: Trajectory) -> float:
    return max(float(np.abs(one[axis] - other[axis]).max()) for axis in "xy")


def rates(result: Trajectory) -> tuple[Array, Array]:
    """Return speed and yaw rate (N,)."""
    return np.hypot(result["vx"], result["vy"]), np.abs(result["wphi"])


def after_sticking(rig: Rig, channel: str) -> Array:
    """Return (N, 2) speed and yaw rate half a second after the latch, for a channel that sticks in six motions."""
    left = []
    for size in (0.02, 0.08, 0.14):
        for direction in (0.5, 3.9):
            speed = {"x": size * np.cos(direction), "y": size * np.sin(direction)}
            value = stuck_value(rig, channel, speed, STUCK_DURATION)
            result = run(rig, channel, 10_000, value, speed, STUCK_DURATION)
            at = int(np.argmax(result.faults >> 31 & 1)) + round(COAST / rig.period_s)
            left.append([r[min(at, len(r) - 1)] for r in rates(result)] if result.faults[-1] >> 31 else [9.0, 9.0])
    return np.array(left)


def campaign_runs(
    design: Stage, block: Block, plant: int, condition: int, fault: tuple[str, str, str]
) -> list[FaultRun]:
    """Return the runs of a fault, with target, kind and duration, in a condition of the campaign."""
    declared = standard_tasks.rig(design, design.scalar)
    stage = campaign.with_stops(replace(declared, controller=loops.of(block).controller))
    injected = [i for i in injections.derive(stage.stage) if (i.target, i.kind, i.duration) == fault]
    _, runs = campaign.run(stage, plant, campaign.motion_and_standstill(stage)[condition], silent, injected)
    return list(runs)


def campaign_excursions(design: Stage, block: Block, plant: int) -> Array:
    """Return the excursions (2, 2) of x and y, m, after four bad samples of V_ax in the campaign's motion."""
    runs = campaign_runs(design, block, plant, MOVING, SHORT_LOSS)
    return np.array([[r.excursion[axis] for axis in "xy"] for r in runs])
