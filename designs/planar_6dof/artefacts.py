"""The gains.json of a planar controller: compensators and filters."""

from collections.abc import Mapping
from typing import Any

from designs.planar_6dof import filtering, vertical
from synth.blocks.laws import lead_lag as lead_lag_block
from synth.synthesise import digits
from synth.synthesise.classical import lead_lag
from synth.timing import Discrete


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
