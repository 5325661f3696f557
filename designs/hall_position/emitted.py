"""What is committed under generated_c/: the estimators of two and of three sensors, their numbers and test vectors.

The vectors begin where nothing is known of the place but that the body is at rest, with 1 mV of noise. One voltage is
out of range for three samples; then the body sets out across pitches while it yaws, and in the end a voltage of another
sensor is out of range for longer than until the latch.
"""

from dataclasses import asdict, replace
from math import pi
from typing import Any

import numpy as np

from designs.hall_position import shipped
from designs.hall_position.glsdc import channels, estimator
from designs.hall_position.glsdc.parameters import Array
from designs.hall_position.trust import motions
from designs.hall_position.trust.motions import Numbers, Pose
from synth.emit import write
from synth.emit.c import digits, vectors
from synth.execute import host

STEPS, REST = 1000, 200  # samples, of them at rest
START = {"X": 0.011, "Y": 0.034, "yaw": 0.03}  # m, rad
WAY = {"X": 0.12, "Y": -0.09, "yaw": -0.08}  # m, rad: over two pitches in 1 s
OUT, BAD, LOST = 9.0, slice(150, 153), slice(900, 910)  # V; of V_ay and of V_bx
SEED = 2009


def emitted(scalar: type[np.floating]) -> dict[str, write.Emitted]:
    """Return the files of hall_position and hall_position_three in a scalar type, by folder."""
    return {name: _emitted(name, scalar) for name in shipped.PLACES}


def _emitted(name: str, scalar: type[np.floating]) -> write.Emitted:
    block, error = shipped.block(name), estimator.SURROGATE_ERROR[scalar]
    files = write.emit(block, scalar, {"design": design(name)}, error=error)
    given = motions.named(measured(shipped.array(name)))
    answered = host.load(files.files, files.manifest).replay(given)
    text = vectors.document({n: v.astype(scalar) for n, v in given.items()}, answered.outputs, answered.faults)
    return replace(files, files={**files.files, "vectors.json": text})


def measured(array: Array) -> Numbers:
    """Return the voltages (N, sensors, 2) of the test vectors, V."""
    found = motions.noisy(array, way(), SEED)
    found[BAD, 0, 1] = OUT
    found[LOST, 1, 0] = OUT
    return found


def way() -> Pose:
    """Return the poses (N,) of the test vectors: at rest, then there without a jerk."""
    part = np.clip((np.arange(STEPS) - REST) / (STEPS - REST), 0, 1)
    along = part - np.sin(2 * pi * part) / (2 * pi)
    return Pose(**{name: START[name] + WAY[name] * along for name in START})


def design(name: str) -> dict[str, Any]:
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
