"""Configuration of the estimators with protection levels, of three and of four sensors.

The places of four sensors have the least 97 % quantile, over the pitch and yaws within 10 degrees, of the levels in X,
Y and the yaw (over 40 rad/m) that a search of 20,000 random layouts and 250 perturbations of each of the five best has
reached. Those of three sensors are the result of `python -m studies.hall.protected.layout`.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np

from designs.hall_position import config
from designs.hall_position.protected import estimator
from designs.hall_position.protected.parameters import Tuning
from models import hall_motions as motions
from models.hall_array import Pair
from models.hall_motions import Numbers
from models.hall_two_waves import PlanarArray as Array
from synth import stage
from synth.block import Block
from synth.errors import DesignError

NAME, THREE = "hall_position_four", "hall_position_three"
PLACES: Mapping[str, tuple[Pair, ...]] = MappingProxyType(
    {
        NAME: ((0.046, -0.072), (-0.178, -0.277), (-0.399, -0.478), (0.259, 0.122)),
        THREE: ((0.238, -0.27), (-0.425, 0.404), (-0.087, 0.063)),
    }
)  # pitches
USUAL = Tuning()
# Residual of a voltage after a calibration with an error map, and limits in proportion to it.
CALIBRATED = Tuning(model_error=5e-3, position_limit=5e-4, yaw_limit=0.022)
# Three sensors need the calibration. Levels may be wider than the error that counts as wrong, as what a fault does is
# mostly less; while a sensor is excluded there is one redundant voltage, and they may not.
CALIBRATED_THREE = replace(
    CALIBRATED,
    position_limit=1.5e-3,
    yaw_limit=0.066,
    excluded_limits=0.01,
    all_sensors=True,  # with the two that an exclusion leaves, more than one place fits
    largest_phase=0.02,  # 0.16 mm: with a larger deviation almost every level is above its limit
    largest_yaw=0.008,
    largest_amplitude=0.02,
)
TUNINGS: Mapping[str, Tuning] = MappingProxyType({NAME: USUAL, THREE: CALIBRATED_THREE})


@dataclass(frozen=True)
class Promise:
    """What the header promises: the least share of starts at rest that are valid within so many samples, up to a yaw in
    degrees to either side, and the largest share with an error above a level after a fault of one sensor.

    That share is of the valid samples of four sensors, and of all samples of three, few of which are then valid.
    """

    starts: float
    samples: int
    exceeded: float
    yaw: float = 9.0


PROMISES: Mapping[str, Promise] = MappingProxyType({NAME: Promise(0.99, 120, 1e-3), THREE: Promise(0.8, 120, 5e-4)})
VECTORS, SEED = 1000, 2011
REST, DISPLACEMENT, START = 150, (0.12, -0.09, -0.08), (0.011, -0.016, 0.03)  # samples; m, m, rad
REFUSED, DEAD, FROZEN = slice(300, 304), slice(450, 550), slice(700, 760)  # samples of faults


def array(name: str = NAME) -> Array:
    """Return the array of an estimator: positions, field in V and noise; raise DesignError for an unknown name."""
    if name not in tuple(PLACES):
        raise DesignError(f"'{name}' has no protection levels: give one of {', '.join(PLACES)}")
    return config.array_at(PLACES[name])


@cache
def block(tuning: Tuning | None = None, name: str = NAME) -> Block:
    """Return the guarded estimator, with the tuning that ships if none is given; raise DesignError as `array`."""
    return estimator.guarded_estimator(name, array(name), config.TIME, tuning or TUNINGS[name])


def header_notes(name: str) -> list[str]:
    """Return for which bodies and voltages the estimate and its protection levels hold."""
    of, promise = TUNINGS[name], PROMISES[name]
    start, four, three = stage.read_notes(
        Path(__file__).with_name("header.md"),
        yaw=promise.yaw,
        starts=100 * promise.starts,
        longest=promise.samples * config.TIME.period_s,
        pitches=of.pitches,
        exceeded=100 * promise.exceeded,
        error=1e3 * of.model_error,
    )
    return [f"{start} {three if name == THREE else four}"]


def gains(scalar: type[np.floating], name: str = NAME) -> dict[str, Any]:
    """Return the content of gains.json."""
    return config.document(
        PLACES[name],
        TUNINGS[name],
        "a (alpha sin(w X) + beta sin(5 w X)), a the amplitude, likewise in Y, the fabricated matrix at 3 mm",
        "weighted least squares with integrity monitoring, exclusion of a sensor, and a sweep of starts",
    )


def vectors(inputs: Mapping[str, Any], outputs: Mapping[str, Any], name: str = NAME) -> dict[str, Numbers]:
    """Return the inputs of the test vectors, in the scalar type of the `inputs` of two sensors.

    The body rests and then moves; a voltage is out of range, a sensor is dead, and the last converter freezes.
    """
    scalar = inputs["V_ax"].dtype.type
    pose = motions.rest_then_move(VECTORS, REST, START, DISPLACEMENT)
    V = motions.noisy(array(name), pose, SEED)
    V[REFUSED, 0, 1], V[DEAD, 2] = 9.0, 0.0
    V[FROZEN, -1, 0] = V[FROZEN.start, -1, 0]
    return motions.by_input(V.astype(scalar))
