"""Phasors: cosine and sine of an angle, computed once and rotated by products; range reduction of angles and positions.

A sine over a large range of angles has zeros, which no polynomial can follow to a relative error. An angle is therefore
divided by 2^m, and m doublings recover its sine and cosine:

    s <- s c,  c <- 1 - s^2/2^(2n+1),   n = m-1 .. 0,   from  s = 2^m sin(angle/2^m),  c = cos(angle/2^m)

The doublings multiply errors by at most 2^m. Every s is limited, the last one to 1 and the others to 2, because
interval arithmetic would otherwise double its bound at each step.

A position along a period is reduced before it is scaled to an angle, so a long travel costs no accuracy (Cody, Waite):

    n = floor(position/period + 1/2),   distance = (position - n high) - n low,   high + low = period

`high` has HIGH_BITS bits. Then n high and the first difference are exact for |n| < 2^(24 - HIGH_BITS), and the distance
has one rounding. For a quarter q of the angle of a distance within half a period, cos q = sqrt(1 - sin^2 q), and

    h = sin q cos q,   cos 4q = 1 - 8 h^2,   sin 4q = h (4 - 8 sin^2 q)

have the absolute error `quarter_angle_error`, although both have zeros.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from math import ceil, frexp, ldexp, log2, pi

import casadi as ca

from synth.block import Certificate, Constant, clip
from synth.blocks.estimate.glsdc import NamedExpressions
from synth.errors import SignalError
from synth.law import label
from synth.signals import Signal, quotient_unit

MAX_ANGLE = 1.2  # rad: the largest angle whose sine and cosine are approximated by polynomials
HIGH_BITS = 12  # bits of the leading part of a period
MARGIN = 2e-3  # of half a period: more than rounding may add to a distance, see `_distance_bound`
SLACK = 1e-3  # relative, of certified limits
UNIT, TWICE = Signal("unit", "1", -1, 1), Signal("twice", "1", -2, 2)


@dataclass(frozen=True, eq=False)
class Phasor:
    """Cosine and sine of an angle, times a length: also a vector in the plane."""

    cosine: ca.SX
    sine: ca.SX

    def times(self, by: "Phasor") -> "Phasor":
        """Return the product with another phasor: this one rotated by its angle."""
        sine = self.sine * by.cosine + self.cosine * by.sine
        return Phasor(self.cosine * by.cosine - self.sine * by.sine, sine)

    def scaled(self, by: ca.SX) -> "Phasor":
        """Return this phasor times a number."""
        return Phasor(by * self.cosine, by * self.sine)


@dataclass(frozen=True, eq=False)
class Distance:
    """The distance of a position from the nearest whole multiple of a period, with its certificate for `Step`.

    `numbers` are those of the period that the C names.
    """

    signal: Signal
    value: ca.SX
    certificate: Certificate
    numbers: tuple[Constant, ...]


def of(angle: ca.SX) -> Phasor:
    """Return the phasor of a small angle."""
    return Phasor(ca.cos(angle), ca.sin(angle))


def halvings(limit: float) -> int:
    """Return the number of halvings that bring an angle of up to `limit` rad below MAX_ANGLE, at least 1."""
    return max(1, ceil(log2(limit / MAX_ANGLE)))


def by_range_reduction(angle: ca.SX, halvings: int, name: str, named: NamedExpressions) -> Phasor:
    """Return the phasor of an angle by range reduction; `named` receives cos(angle/2^m) and 2^m sin(angle/2^m)."""
    return _by_doubling(angle, halvings, name, named, (TWICE, UNIT))[0]


def by_certified_reduction(
    angle: ca.SX, halvings: int, name: str, named: NamedExpressions
) -> tuple[Phasor, dict[str, Certificate]]:
    """Return the phasor as `by_range_reduction`, and certificates for `Step` of its limits, which then cost nothing.

    An error e of the polynomials and u of each operation is multiplied by 2^m at most: the sine errs by less than
    2^m 8 (e + 4 u).
    """
    limits = [Signal(f"{name}_{n}", "1", -h * (1 + SLACK), h * (1 + SLACK)) for n, h in (("doubled", 2), ("full", 1))]
    result, values = _by_doubling(angle, halvings, name, named, limits)
    named += zip(limits, values, strict=True)
    return result, {s.name: partial(_doubled_bound, round(s.high), halvings) for s in limits}


def _doubled_bound(size: int, halvings: int, u: float, e: float) -> float:
    return size * (1 + 2**halvings * 8 * (e + 4 * u))


def _by_doubling(
    angle: ca.SX, halvings: int, name: str, named: NamedExpressions, limits: Sequence[Signal]
) -> tuple[Phasor, list[ca.SX]]:
    """Return the phasor, and its limited values."""
    sines, c = [2**halvings * ca.sin(angle / 2**halvings)], ca.cos(angle / 2**halvings)
    for function, value in (("sine", sines[0]), ("cosine", c)):
        about = f"of 1/{2**halvings} of it" + (f", times {2**halvings}" if function == "sine" else "")
        named.append((Signal(f"{name}_{function}", "1", -(2**halvings), 2**halvings, about), value))
    for left in reversed(range(halvings)):
        s = sines[-1] if left else clip(sines[-1], limits[0])
        sines.append(s * c)
        c = 1 - s**2 / 2 ** (2 * left + 1)
    full = clip(sines[-1], limits[1])
    label(name, sines=sines[:-1])
    return Phasor(c, full), [s, full]


def within_period(position: ca.SX, bounds: Signal, period: float, name: str) -> Distance:
    """Return the distance of a position within `bounds` from the nearest whole multiple of a period, in its unit.

    But for rounding it is within half a period: at most period/2 (1 + MARGIN).

    Raises SignalError for a period that is not positive, and for a position of more than 2^(23 - HIGH_BITS) periods.
    """
    limit = max(abs(bounds.low), abs(bounds.high))
    whole = ceil(limit / period + 0.5) if period > 0 else 0
    if not 0 < whole <= 2 ** (23 - HIGH_BITS):
        raise SignalError(
            f"'{bounds.name}' is up to {limit:g} {bounds.unit} in periods of {period:g}: give a positive period, and "
            f"at most {2 ** (23 - HIGH_BITS)} periods of travel"
        )
    exponent = frexp(period)[1] - HIGH_BITS
    high = ldexp(round(ldexp(period, -exponent)), exponent)
    n = ca.floor(position * (1 / period) + (whole + 0.5)) - whole
    half = period / 2 * (1 + MARGIN)
    signal = Signal(f"distance_{name}", bounds.unit, -half, half, f"of {bounds.name} from a whole period")
    value = clip((position - n * high) - n * (period - high), signal)
    unit, about = bounds.unit, f"the wavelength, {period:.9g} {bounds.unit}"
    numbers = (
        Constant("inverse_wavelength", 1 / period, quotient_unit("1", unit), f"1 over {about}"),
        Constant("wavelength_high", high, unit, f"{about}, in {HIGH_BITS} bits: its multiples are exact"),
        Constant("wavelength_low", period - high, unit, f"{about}, less wavelength_high"),
    )
    label(name, n=n)
    return Distance(signal, value, lambda u, e: _distance_bound(period, whole, u), numbers)


def quarter_angle_error(u: float, e: float) -> float:
    """Return a bound on the absolute error of `by_quarter_angle` of length 1, at the computed distance.

    u is the unit roundoff and e the relative error of the polynomial of sin q, its rounding included. An error e of
    sin q turns q by e tan q, the angle by up to 4 e (1 + 4 MARGIN). h^2 then has a relative error of 7 u, so 1 - 8 h^2
    errs by up to 19 u, and the sine by less.
    """
    return 4 * e * (1 + 4 * MARGIN) + 24 * u


def _distance_bound(period: float, whole: int, u: float) -> float:
    """Return a bound on a distance: position/period errs by at most 4 u `whole`, the rest by less than that."""
    return period * (0.5 + 8 * whole * u)


def by_quarter_angle(distance: ca.SX, period: float, name: str, named: NamedExpressions, length: float = 1.0) -> Phasor:
    """Return the phasor of `length` at 2 pi distance/period for a distance within half a period.

    `named` receives the sine of a quarter of the angle.
    """
    sine = ca.sin(pi / (2 * period) * distance)
    h = sine * ca.sqrt(1 - sine**2)
    named.append((Signal(f"quarter_sine_{name}", "1", -1, 1), sine))
    label(name, h=h)
    return Phasor(length - 8 * length * h**2, h * (4 * length - 8 * length * sine**2))
