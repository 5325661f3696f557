"""Certificates: bounds of a polynomial program's relative error at every number of the scalar type in the range.

float32   Every x with |x| >= tau is checked, with separate and with fused rounding of multiply-adds. For each run of up
          to 2^15 neighbouring x the reference is a short polynomial in double about their middle, from the enclosure of
          the function; the bound of its error is added. tau is 0, or the smallest power of two that keeps the work
          within WORK. With a parity x > 0 covers x < 0, because the program and G have the parity exactly. For
          |x| < tau the bound is that of float64:
float64   |p - f| <= |p - G| + |G - f| + rounding, in ball arithmetic on each of PIECES pieces. If f has a zero at
          x = 0, every term is divided by x first; the bound then holds except where f or p is subnormal.
"""

import itertools
from collections.abc import Iterator
from dataclasses import dataclass

import flint
import numpy as np
from numpy.typing import NDArray

from synth.emit.approx import polynomial
from synth.emit.approx.enclosure import Enclosure, one_norm
from synth.emit.approx.polynomial import Polynomial, Scalars

WORK = 3.2e8  # limit of values times (coefficients + 8): less than a second
RUN = 2**15
PIECES = 128
SWEEPS = 16  # every 16th run is checked in one sweep, so that a failure shows early


@dataclass(frozen=True)
class Certificate:
    """An upper bound of the relative error, and how many values were checked one by one.

    The check stops where the error exceeds the allowed one; then `max_relative_error` is a lower bound.
    """

    max_relative_error: float
    checked_values: int


@dataclass(frozen=True)
class Run:
    """Consecutive floats from sign * first to sign * last; `first` and `last` are bit patterns."""

    first: int
    last: int
    sign: int

    @property
    def x(self) -> Scalars:
        """Return the floats."""
        patterns = np.arange(self.first, self.last + 1, dtype=np.uint32)
        return patterns.view(np.float32) * np.float32(self.sign)


def certify(p: Polynomial, g: Enclosure, allowed: float) -> Certificate:
    """Bound the relative error of `p` as an approximation of the function that `g` encloses."""
    low, high = (flint.arb(0), g.high) if p.parity != "none" else (g.low, g.high)
    if p.scalar is np.float64:
        return Certificate(bound_in_balls(p, g, low, high), 0)
    sides = _sides(float(low), float(high))
    tau = _threshold(sides, len(p.coefficients))
    certificate = _check_floats(p, g, sides, tau, allowed)
    left, right = max(low, flint.arb(-tau), key=float), min(high, flint.arb(tau), key=float)
    if certificate.max_relative_error > allowed or not left < right:
        return certificate
    return Certificate(
        max(certificate.max_relative_error, bound_in_balls(p, g, left, right)), certificate.checked_values
    )


def bound_in_balls(p: Polynomial, g: Enclosure, low: flint.arb, high: flint.arb) -> float:
    """Bound the relative error on [low, high] in ball arithmetic; inf if there is no finite bound."""
    worst = 0.0
    # The pieces are shortest at the ends of the range, where the error of a best polynomial oscillates fastest.
    inner = [(low + high - (high - low) * (flint.arb(k) / PIECES).cos_pi()) / 2 for k in range(1, PIECES)]
    for left, right in itertools.pairwise([low, *(x.mid() for x in inner), high]):
        x = ((left + right) / 2).mid()
        half = (right - x).max(x - left).upper()
        b, c = g.expansion(x, half), polynomial.expansion(p, x, half, g.power)
        distance = one_norm((flint.arb_poly(c) - flint.arb_poly(b)).coeffs()) + g.error
        rounding = polynomial.rounding_bound(p, x + flint.arb(0, half), g.power)
        worst = max(worst, _ratio(distance + rounding, abs(b[0]) - one_norm(b[1:]) - g.error))
    return worst


def _ratio(error: flint.arb, value: flint.arb) -> float:
    """Return a double not below error / value; inf unless the value is provably positive."""
    bound = error / value
    return float(np.nextafter(float(bound.upper()), np.inf)) if value > 0 and bound.is_finite() else np.inf


def _sides(low: float, high: float) -> list[tuple[float, float, int]]:
    """Return (least, largest, sign) of |x| for each sign in the range."""
    sides = [(max(low, 0.0), high, 1), (max(-high, 0.0), -low, -1)]
    return [side for side in sides if side[1] > 0]


def _pattern(x: float) -> int:
    return int(np.float32(abs(x)).view(np.uint32))


def _count(sides: list[tuple[float, float, int]], tau: float) -> int:
    return sum(max(_pattern(high) - _pattern(max(low, tau)) + 1, 0) for low, high, _ in sides)


def _threshold(sides: list[tuple[float, float, int]], coefficients: int) -> float:
    most = WORK / (coefficients + 8)
    if _count(sides, 0.0) <= most:
        return 0.0
    return next((2.0**k for k in range(-126, 128) if _count(sides, 2.0**k) <= most), np.inf)


def _runs(sides: list[tuple[float, float, int]], tau: float) -> Iterator[Run]:
    for low, high, sign in sides:
        first, last = _pattern(max(low, tau)), _pattern(high)
        for base in range(first - first % RUN, last + 1, RUN):
            yield Run(max(first, base), min(last, base + RUN - 1), sign)


def _check_floats(
    p: Polynomial, g: Enclosure, sides: list[tuple[float, float, int]], tau: float, allowed: float
) -> Certificate:
    worst, count, runs = 0.0, 0, list(_runs(sides, tau))
    for run in itertools.chain.from_iterable(runs[k::SWEEPS] for k in range(SWEEPS)):
        x = run.x
        truth, bound = reference_values(g, x)
        variants = (
            polynomial.run(p, x, multiply_add)
            for multiply_add in (polynomial.multiply_then_add, polynomial.fused_multiply_add)
        )
        error = (float(np.max([np.max(np.abs((computed - truth) / truth)) for computed in variants])) + bound) / (
            1 - bound
        )
        count += len(x)
        if not error <= allowed:
            return Certificate(error if np.isfinite(error) else np.inf, count)
        worst = max(worst, error)
    return Certificate(worst, count)


def reference_values(g: Enclosure, x: Scalars) -> tuple[NDArray[np.float64], float]:
    """Return f in double at sorted floats x, all different from 0, and one bound of the relative error of each.

    The bound includes the rounding of a difference from f and of its quotient by f.
    """
    wide = x.astype(np.float64)
    middle = float(wide[0] + wide[-1]) / 2
    half = max(abs(float(wide[-1]) - middle), abs(middle) * 2.0**-30)
    b = g.expansion(flint.arb(middle), flint.arb(half))
    c = [float(v) for v in b]
    small = 2.0**-44 * abs(c[0])
    while len(c) > 1 and abs(c[-1]) < small:
        small -= abs(c.pop())
    w, value = (wide - middle) / half, np.full(len(x), c[-1])
    for term in c[-2::-1]:
        value *= w
        value += term
    # Two operations per term, as many again for w, and four for x g, the difference and the quotient.
    error = g.error + one_norm([v - d for v, d in zip(b, c, strict=False)]) + one_norm(b[len(c) :])
    error += flint.arb(2) ** -52 * (2 * len(c) + 4) * one_norm(b)
    return value * wide if g.power else value, _ratio(error, flint.arb(float(np.min(np.abs(value)))) - error)
