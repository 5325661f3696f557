"""What is committed under generated_c/: the estimators of two and of three sensors, their numbers and test vectors.

The vectors begin where nothing is known of the place but that the body is at rest, with 1 mV of noise. One voltage is
out of range for three samples; then the body sets out across pitches while it yaws, and in the end a voltage of another
sensor is out of range for longer than until the latch.
"""

from collections.abc import Mapping
from dataclasses import asdict
from math import pi
from typing import Any

import numpy as np

from designs.hall_position import shipped
from designs.hall_position.glsdc import channels
from designs.hall_position.trust import motions
from designs.hall_position.trust.motions import Numbers, Pose
from synth.emit.c import digits

STEPS, REST = 1000, 200  # samples, of them at rest
START = {"X": 0.011, "Y": 0.034, "yaw": 0.03}  # m, rad
WAY = {"X": 0.12, "Y": -0.09, "yaw": -0.08}  # m, rad: over two pitches in 1 s
OUT, BAD, LOST = 9.0, slice(150, 153), slice(900, 910)  # V; of V_ay and of V_bx
SEED = 2009


def recording(name: str, scalar: type[np.floating]) -> dict[str, Numbers]:
    """Return the inputs (N,) of an estimator's test vectors, V."""
    V = motions.noisy(shipped.array(name), way(), SEED)
    V[BAD, 0, 1] = OUT
    V[LOST, 1, 0] = OUT
    return motions.named(V.astype(scalar))


def of_three(inputs: Mapping[str, Any], outputs: Mapping[str, Any]) -> dict[str, Numbers]:
    """Return those of three sensors beside `inputs` of two, in their scalar type."""
    return recording(shipped.THREE, inputs["V_ax"].dtype.type)


def way() -> Pose:
    """Return the poses (N,) of the test vectors: at rest, then there without a jerk."""
    part = np.clip((np.arange(STEPS) - REST) / (STEPS - REST), 0, 1)
    along = part - np.sin(2 * pi * part) / (2 * pi)
    return Pose(**{name: START[name] + WAY[name] * along for name in START})


def gains(name: str, scalar: type[np.floating]) -> dict[str, Any]:
    """Return what gains.json says of an estimator: model, sensors, tuning, and where the numbers are from."""
    array = shipped.array(name)
    return {
        "model": "B_X = alpha sin(w X) + beta sin(5 w X), B_Y likewise in Y: (2), for the fabricated matrix at 3 mm",
        "alpha_V": array.alpha,
        "beta_V": array.beta,
        "pitch_m": array.pitch,
        "deviation_V": array.deviation,
        "positions_pitches": [list(place) for place in shipped.PLACES[name]],
        "period_s": shipped.TIME.period_s,
        "method": "modified Gaussian least squares differential correction (GLSDC), Fig. 9, a fixed number a sample",
        "tuning": {k: digits.cut(v, 12) if isinstance(v, float) else v for k, v in asdict(shipped.TUNING).items()},
        "bad_samples": channels.BAD_SAMPLES,
    }
