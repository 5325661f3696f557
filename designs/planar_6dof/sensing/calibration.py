"""Calibration of the Hall sensors: amplitude of the field, fits of position, slope and power, scale of the voltages.

    S(t) = sin t + b sin 5t + d sin 9t,   C(t) = cos t + b cos 5t + d cos 9t     t = 2 pi X / l; b, d = A_5/A_1, A_9/A_1

    t         = r (p_0 + p_1 r^2 + ..),         r = S / C in -1 .. 1, meeting pi/4 at r = 1
    S'        = C^3 (q_0 + q_1 S^2)
    S^2 + C^2 = g_0 + g_1 (S C)^2 + g_2 (S C)^4

Each is a least-squares fit over POINTS points of one or two sections, in ball arithmetic with each coefficient rounded
once, which gives the same bits on every machine. The angle of C + i S is t + arg(1 + b e^4it + d e^8it), and t is an
odd function of r alone: the first fit combines arctangent and calibration.

The scale of the voltages is the nominal amplitude over the estimated one:

    scale <- scale - gain (m_x + m_y)    m_x, m_y: squared amplitudes of two pairs less those of the field

1 / (4 power_0) corrects the whole error of the scale. Good samples do so until the guard is ready, later ones a part.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from math import pi

import casadi as ca
import flint

from models import halbach
from synth.analyse.numerics import precise
from synth.block import Constant, clip
from synth.plant import Plant
from synth.signals import Signal

POINTS = 64
TERMS = 4  # of the position: errors of 55 um at most with 3, 9.5 um with 4, 6.4 um with 5, 3.3 um with 7
SCALE_RANGE = 0.84, 1.2  # of voltages
SCALE_MIDDLE, SCALE_HALF_RANGE = sum(SCALE_RANGE) / 2, (SCALE_RANGE[1] - SCALE_RANGE[0]) / 2
SCALE_GAIN = 1e-3  # of the error of the scale, what a sample corrects
SCALE = Signal("scale", "1", *SCALE_RANGE, "nominal amplitude of the voltages over the estimated one")


@dataclass(frozen=True)
class Calibration:
    """Amplitude A in V, pitch l in m, and the fits in powers of volts.

    `position` are the coefficients in m of r, r^3, ..; `slope` those of c^3, c^3 s^2 in 3 pi/2 A S', a voltage per rad;
    `power` those of 1, (s c)^2, (s c)^4 in s^2 + c^2, for s = A S, c = A C.
    """

    amplitude: float
    pitch: float
    position: tuple[float, ...]
    slope: tuple[float, ...]
    power: tuple[float, ...]

    @property
    def volts_per_metre(self) -> float:
        """The slope of the fundamental where it is 0, V/m."""
        return self.amplitude * (2 * pi / self.pitch)


@dataclass(frozen=True)
class _Wave:
    """S, C and S' at a point."""

    s: flint.arb
    c: flint.arb
    slope: flint.arb


def of(plant: Plant) -> Calibration:
    """Return the calibration for the field at the sensors' nominal height."""
    return _calibrate(*(plant.parameter(name).value for name in ("l", "Delta", "mu0_M0", "height", "sensitivity")))


@cache
def _calibrate(*values: float) -> Calibration:
    with precise.precision():
        l, Delta, m, height, sensitivity = (flint.arb(v) for v in values)
        A = {n: sensitivity * _amplitude(n, l, Delta, m, height) for n in halbach.HARMONICS}
        parts = {n: a / A[1] for n, a in A.items()}
        t = [flint.arb.pi() * (2 * j + 1) / (8 * POINTS) for j in range(POINTS)]
        sections = [_wave(2 * v, parts) for v in t]
        slope = _least_squares([[o.c**3, o.c**3 * o.s**2] for o in sections], [o.slope for o in sections])
        shapes = [[flint.arb(1), (o.s * o.c) ** 2, (o.s * o.c) ** 4] for o in sections]
        power = _least_squares(shapes, [o.s**2 + o.c**2 for o in sections])
        D, radian = 3 * flint.arb.pi() / 2, l / (2 * flint.arb.pi())
        return Calibration(
            float(A[1]),
            float(l),
            tuple(float(v * radian) for v in _position(t, parts)),
            tuple(float(D * v / A[1] ** (2 * k + 2)) for k, v in enumerate(slope)),
            tuple(float(v * A[1] ** (2 - 4 * k)) for k, v in enumerate(power)),
        )


def _amplitude(n: int, l: flint.arb, Delta: flint.arb, m: flint.arb, z: flint.arb) -> flint.arb:
    k = n * flint.arb.pi()
    w = 2 * k / l
    return 4 / k * (k / 4).sin() * m * (1 - (-w * Delta).exp()) * (-w * z).exp()


def _wave(t: flint.arb, parts: Mapping[int, flint.arb]) -> _Wave:
    zero = flint.arb(0)
    return _Wave(
        sum((a * (n * t).sin() for n, a in parts.items()), start=zero),
        sum((a * (n * t).cos() for n, a in parts.items()), start=zero),
        sum((n * a * (n * t).cos() for n, a in parts.items()), start=zero),
    )


def _position(t: Sequence[flint.arb], parts: Mapping[int, flint.arb]) -> list[flint.arb]:
    """Return the p_k: t = r (pi/4 + (1 - r^2) Q(r^2)), multiplied out."""
    waves = [_wave(v, parts) for v in t]
    r = [o.s / o.c for o in waves]
    eighth, zero = flint.arb.pi() / 4, flint.arb(0)
    shapes = [[v * (1 - v**2) * v ** (2 * k) for k in range(TERMS - 1)] for v in r]
    Q = _least_squares(shapes, [angle - v * eighth for angle, v in zip(t, r, strict=True)])
    p = [a - b for a, b in zip([*Q, zero], [zero, *Q], strict=True)]
    return [p[0] + eighth, *p[1:]]


def _least_squares(rows: Sequence[Sequence[flint.arb]], targets: Sequence[flint.arb]) -> list[flint.arb]:
    """Return the coefficients that minimise the sum of the squares of rows x coefficients - targets."""
    M, y = flint.arb_mat([list(row) for row in rows]), flint.arb_mat([[v] for v in targets])
    return list((M.transpose() * M).solve(M.transpose() * y).entries())


def scale_gains(cal: Calibration, samples: int) -> list[Constant]:
    """Return the gains of first good samples and of later ones, 1/V^2, for one correction in so many `samples`."""
    per_scale, gain = 1 / (4 * cal.power[0]), samples * SCALE_GAIN
    return [
        Constant("first_scale_gain", per_scale, "1/V^2", "1 / (4 sensing_power_0): the whole error of the scale"),
        Constant("scale_gain", gain * per_scale, "1/V^2", f"{gain:g} / (4 sensing_power_0)"),
    ]


def scale_numbers() -> list[Constant]:
    """Return the numbers of the scale that the C names."""
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
