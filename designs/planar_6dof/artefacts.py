"""Files committed beside the C of a planar controller: gains and test vectors.

The test vectors are a second of a closed loop with noise. The platen starts at rest near the corner of a pitch and
moves across the corner and back in x and y, and across a border of the sections, while it yaws, lifts and tilts. A Hall
channel is out of range for three samples and a set-point for ten.
"""

from collections.abc import Mapping
from math import pi
from typing import Any

import numpy as np
from numpy.typing import NDArray

from designs.planar_6dof import filtering, vertical
from designs.planar_6dof.loop import Array, simulate
from synth.blocks.laws import lead_lag as lead_lag_block
from synth.emit.c import digits
from synth.simulate.rig import Rig
from synth.simulate.scenario import sample_times
from synth.simulate.sensors import Override
from synth.synthesise.classical import lead_lag
from synth.timing import Discrete

STEPS = 1000
START = {"x": 0.024, "y": -0.0245}  # m: a pitch ends at 25.4 mm, other sensors are read from 31.75 mm on
STROKE = {"x": 0.0095, "y": -0.009, "phi": 2e-3, "z": 5e-5, "theta": 2e-4, "psi": -2e-4}  # m, rad
CHANNEL, BAD, VOLTS = "V_ay", slice(700, 703), 9.0  # the converter's range is 10 V, the sensor's 5 V
SET_POINT, BAD_REFERENCE, TOO_FAR = "x_ref", slice(800, 810), 0.2  # m


def record_inputs(rig: Rig) -> Mapping[str, NDArray[Any]]:
    """Return the inputs (STEPS,) of the test vectors' closed loop."""
    T = rig.period_s
    references = reference_paths(sample_times(STEPS * T, T))
    references["x"][BAD_REFERENCE] = TOO_FAR
    mask = np.zeros(STEPS, dtype=bool)
    mask[BAD] = True
    bad = {CHANNEL: Override(mask, np.full(STEPS, VOLTS))}
    return simulate(rig, STEPS * T, references, START, overrides=bad).measured


def reference_paths(time: Array) -> dict[str, Array]:
    """Return set-points (N,) by axis at times (N,) in s: forward and back once, x and y at different times."""
    part = time / time[-1]
    there = {axis: (1 - np.cos(2 * pi * part)) / 2 for axis in STROKE} | {"y": np.sin(pi * part) ** 4}
    return {axis: START.get(axis, 0.0) + way * there[axis] for axis, way in STROKE.items()}


def compensators(parts: Mapping[str, lead_lag.LeadLag]) -> dict[str, Any]:
    """Return lead-lag compensators by axis, continuous and sampled, with the error of the sampled one."""
    return {axis: _compensator(axis, sampled, sampled.continuous) for axis, sampled in parts.items()}


def _compensator(axis: str, sampled: lead_lag.LeadLag, continuous: lead_lag.Compensator) -> dict[str, Any]:
    return {
        "equation": f"({vertical.EQUATION[axis]})",
        "continuous": {"gain": continuous.gain, "zeros": list(continuous.zeros), "poles": list(continuous.poles)},
        "sampled": {
            "gain": sampled.gain,
            "zeros": [digits.significant(z.real, 12) for z in sampled.zeros],
            "poles": [digits.significant(lead_lag_block.pole(sampled), 12), 1.0],
        },
        "certificate": {
            "at_rad_s": digits.significant(sampled.frequency, 6),
            "gain_error": digits.significant(sampled.gain_error, 3),
            "phase_error_degrees": digits.significant(sampled.phase_error, 3),
        },
    }


def filters(time: Discrete) -> dict[str, Any]:
    """Return the Kalman filters (6)-(16) by axis: noises, gain, poles and the certificate of the gain."""
    return {axis: _filter(axis, time) for axis in filtering.AXES}


def _filter(axis: str, time: Discrete) -> dict[str, Any]:
    estimator = filtering.estimator(axis, time)
    return {
        "states": list(filtering.STATES),
        "jerk_variance": filtering.JERK[axis],
        "deviation": filtering.DEVIATION,
        "gain": [float(v) for v in estimator.M[:, 0]],
        "poles": [digits.pole(z) for z in estimator.poles],
        "certificate": digits.certificate(estimator.certificate),
    }
