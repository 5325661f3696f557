"""Verification of emitted C: NumPy reference, CasADi, CasADi's own C, and the C in double and in single precision.

Random steps are drawn by `random_steps`, each sample independent. Recorded inputs of closed loops, in double precision,
are replayed from `init`: a tour over pitches and sections in both directions in all six axes, a step that saturates the
motors, bad samples up to the latch, and a stuck Hall channel.

Near a threshold, single precision may decide differently from double, for example whether sensors contradict each
other. Random steps are compared where both decide alike, and the share of the others is reported. The effect of single
precision is measured by the path of the stage over a long tour.
"""

from dataclasses import replace
from math import pi

import numpy as np

from designs.planar_6dof import allocation, cost_stimuli, failures, interface, random_steps
from designs.planar_6dof.interface import Subject
from designs.planar_6dof.loop import Array, growing_circle, simulate
from models import planar_stage
from synth.check import Check
from synth.simulate.faults import sensor_faults
from synth.simulate.rig import Rig
from synth.simulate.scenario import Override, Trajectory, sample_times
from synth.timing import Discrete
from synth.verify import agree
from synth.verify.sampling import Columns
from synth.verify.standard import Stimuli

QUICK_REPLAY, WHOLE_REPLAY = 5.0, 60.0  # s of a closed loop that the witnesses replay
FLOOR = cost_stimuli.FLOOR
AT_A_LIMIT = (0.02, 0.5)  # share of random steps: some, and few enough for limits not to hide differences
REJECTED_SHARE = 0.15  # share of random steps with a present or past contradiction of the sensors
COUNTS = dict.fromkeys(interface.PITCHES, 0.01)  # m: more than rounding, and less than a pitch
LATCHED = 0.02  # share of random steps: those with many bad samples in a row
LONG = 60.0  # s
RADIUS, RATE, GROWTH = 0.06, pi / 2, 2.0  # m, rad/s, s: six pitches in 4 s, at 0.1 m/s
TILTS = {"phi": 5e-3, "z": 5e-5, "theta": 5e-4, "psi": 5e-4}  # m, rad
SHORT = 1.0  # s
# m, rad: single against double with noise but ideal converters, at most 1 % of the noise of raw x or y, 2 % of phi, and
# half of the laser noise in z, theta or psi. Without converters a voltage repeats in single precision now and then; the
# watch over repeated codes then goes on a sample later, and so does the scale, which turns the raw yaw.
LARGEST = {"x": 1e-7, "y": 1e-7, "phi": 1e-5, "z": 1e-8, "theta": 1e-7, "psi": 1e-6}
# m, rad rms: with converters, where a count of 0.84 um or 0.1 mrad sometimes differs; a tenth of the noise
COUNTED = {"x": 1.3e-6, "y": 1.3e-6, "phi": 3e-5}

# The test vectors are a second of a closed loop with noise. The platen starts at rest near the corner of a pitch and
# moves across the corner and back in x and y, and across a border of the sections, while it yaws, lifts and tilts. A
# Hall channel is out of range for three samples and a set-point for ten.
STEPS = 1000
START = {"x": 0.024, "y": -0.0245}  # m: a pitch ends at 25.4 mm, other sensors are read from 31.75 mm on
STROKE = {"x": 0.0095, "y": -0.009, "phi": 2e-3, "z": 5e-5, "theta": 2e-4, "psi": -2e-4}  # m, rad
CHANNEL, BAD, VOLTS = "V_ay", slice(700, 703), 9.0  # the converter's range is 10 V, the sensor's 5 V
SET_POINT, BAD_REFERENCE, TOO_FAR = "x_ref", slice(800, 810), 0.2  # m


def stimuli(subject: Subject) -> Stimuli:
    """Return what drives the verification of a controller."""
    most = allocation.authority(planar_stage.plant())
    return Stimuli(
        random=lambda block, n: random_steps.operating_steps(subject, planar_stage.plant(), n),
        edge=random_steps.edge_steps,
        random_checks=share_checks,
        runs=lambda rig, whole: record_runs(rig, subject.step, WHOLE_REPLAY if whole else QUICK_REPLAY),
        path_checks=single_against_double,
        vectors=record_inputs,
        further=cost_stimuli.stimuli,
        floor=FLOOR,
        edge_floor=FLOOR,
        unit="A",
        counts=COUNTS,
        authority={s: most[random_steps.axis_of(s)] for s in random_steps.law_states(subject.block)},
    )


def share_checks(states: Columns, c64: agree.StepResults) -> list[Check]:
    """Return the shares of random steps at limits, with a rejected position, and without a computed law."""
    least, most = AT_A_LIMIT
    limited = float(np.mean(random_steps.is_saturated(c64.outputs)))
    before, after = states["sensing_contradiction_left"], c64.states["sensing_contradiction_left"]
    passed_over = float(np.mean(after != np.maximum(before - 1, 0)))  # an accepted sample decrements it
    return [
        Check("share of random steps at a limit", limited, most, "1"),
        Check("share of random steps within all limits", 1 - limited, 1 - least, "1"),
        Check("share of random steps that sensing passes over", passed_over, REJECTED_SHARE, "1"),
        Check("share of random steps that latch", float(np.mean(c64.states["guard_latched"])), LATCHED, "1"),
    ]


def tour(duration_s: float, time: Discrete) -> dict[str, Array]:
    """Return set-points (N,) by axis: a circle that grows to RADIUS, and sinusoidal yaw, lift and tilts."""
    t = sample_times(duration_s, time.period_s)
    return growing_circle(t, RADIUS, RATE, GROWTH) | {
        a: high * np.sin((k + 1.3) * t) for k, (a, high) in enumerate(TILTS.items())
    }


def record_runs(loop: Rig, step: float, replay_s: float) -> dict[str, Trajectory]:
    """Record the replayed runs: the tour, a saturated step, bad samples up to the latch, a stuck sensor."""
    time, sticks = Discrete(loop.period_s), failures.failures("stuck", failures.SPEED, sensors=["V_ax"])
    t = sample_times(SHORT, loop.period_s)
    return {
        f"replay of {replay_s:g} s": simulate(loop, replay_s, tour(replay_s, time), {}),
        "replay of a saturated step": simulate(loop, SHORT, {"x": np.where(t < 0.2, 0.0, step)}, {}),
        "replay of faults": simulate(loop, SHORT, tour(SHORT, time), {}, overrides=bad_samples(t)),
        "replay of a sensor that sticks": sensor_faults.responses(sticks, loop)[0].run,
    }


def bad_samples(t: Array) -> dict[str, Override]:
    """Return single bad samples of V_bx and a set-point, four in a row of d1, and V_ay bad permanently at the end."""
    k = np.arange(len(t))
    row = k - int(np.argmax(t >= 0.5))
    masks = {
        "V_bx": k % 120 == 119,
        "y_ref": k % 150 == 149,
        "d1": (row >= 0) & (row < interface.BAD_SAMPLES - 1),
        "V_ay": t > 0.8,
    }
    return {name: Override(mask, np.full(len(t), np.nan)) for name, mask in masks.items()}


def single_against_double(double: Rig, single: Rig) -> list[Check]:
    """Compare the paths of the stage in both precisions over LONG, with noise: maximum, and rms with converters."""
    references, about, checks = tour(LONG, Discrete(double.period_s)), f"{LONG:g} s of the tour", []
    for quantised, limits, what, kind in ((False, LARGEST, "", ""), (True, COUNTED, ", with converters", " rms")):
        pair = (replace(loop, quantised=quantised) for loop in (double, single))
        one, two = (simulate(loop, LONG, references, {}) for loop in pair)
        for axis, limit in limits.items():
            off, unit = one[axis] - two[axis], "m" if axis in "xyz" else "rad"
            size = float(np.sqrt(np.mean(off**2)) if quantised else np.abs(off).max())
            checks.append(Check(f"single less double, {axis}{what}", size, limit, f"{unit}{kind}", about))
    return checks


def record_inputs(rig: Rig) -> Columns:
    """Return the inputs (STEPS,) of the test vectors' closed loop."""
    T = rig.period_s
    references = reference_paths(sample_times(STEPS * T, T))
    references["x"][BAD_REFERENCE] = TOO_FAR
    mask = np.zeros(STEPS, dtype=bool)
    mask[BAD] = True
    bad = {CHANNEL: Override(mask, np.full(STEPS, VOLTS))}
    return dict(simulate(rig, STEPS * T, references, START, overrides=bad).measured)


def reference_paths(time: Array) -> dict[str, Array]:
    """Return set-points (N,) by axis at times (N,) in s: forward and back once, x and y at different times."""
    part = time / time[-1]
    there = {axis: (1 - np.cos(2 * pi * part)) / 2 for axis in STROKE} | {"y": np.sin(pi * part) ** 4}
    return {axis: START.get(axis, 0.0) + way * there[axis] for axis, way in STROKE.items()}
