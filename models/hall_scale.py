"""Scale of the Hall voltages of `models.hall_sections`: the nominal amplitude over the estimated one.

    scale <- scale - gain (m_x + m_y)    m_x, m_y: squared amplitudes of two pairs less those of the field

1 / (4 power_0) corrects the whole error of the scale. Good samples do so until the guard is ready, later ones a part.
"""

import casadi as ca

from models import hall_calibration
from synth.block import Constant, clip
from synth.signals import Signal

SCALE_RANGE = 0.84, 1.2  # of voltages
SCALE_MIDDLE, SCALE_HALF_RANGE = sum(SCALE_RANGE) / 2, (SCALE_RANGE[1] - SCALE_RANGE[0]) / 2
SCALE_GAIN = 1e-3  # of the error of the scale, what a sample corrects
SCALE = Signal("scale", "1", *SCALE_RANGE, "nominal amplitude of the voltages over the estimated one")


def gains(cal: hall_calibration.Calibration, samples: int) -> list[Constant]:
    """Return the gains of the first good samples and of later ones, 1/V^2, for one correction in so many `samples`."""
    per_scale, gain = 1 / (4 * cal.power[0]), samples * SCALE_GAIN
    return [
        Constant("first_scale_gain", per_scale, "1/V^2", "1 / (4 sensing_power_0): the whole error of the scale"),
        Constant("scale_gain", gain * per_scale, "1/V^2", f"{gain:g} / (4 sensing_power_0)"),
    ]


def numbers() -> list[Constant]:
    """Return the numbers that the C names."""
    values = {"middle": SCALE_MIDDLE, "half_range": SCALE_HALF_RANGE}
    texts = {"middle": "middle of", "half_range": "half of"}
    ends = f"{SCALE_RANGE[0]:g} .. {SCALE_RANGE[1]:g}"
    return [
        Constant(f"scale_{name}", value, "1", f"{texts[name]} the range of the scale, {ends}")
        for name, value in values.items()
    ]


def limit_scale(scale: ca.SX) -> ca.SX:
    """Return a scale within its range, by its distance to the middle: one comparison where it is inside."""
    return SCALE_MIDDLE + clip(scale - SCALE_MIDDLE, Signal("distance", "1", -SCALE_HALF_RANGE, SCALE_HALF_RANGE))
