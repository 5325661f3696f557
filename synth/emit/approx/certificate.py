"""Certified bound of the largest relative error of a polynomial approximation in floating point (Sollya `supnorm`).

    e = max |p(x) - f(x)| / |f(x)|  over every number x of the scalar type in the range

p is the polynomial as C evaluates it, with every rounding error (`polynomial`), and f is the approximated function,
which `enclosure` gives as f(x) = x^m g(x) with a polynomial G close to g, m = 0 or 1.

float32   The x with |x| >= tau are divided into chunks of up to 2^15 neighbours. Branch and bound: the chunk with the
          largest bound in ball arithmetic is checked value by value, once with separate and once with fused
          multiply-adds, until no bound exceeds the largest error found, which is then the largest of all. Reference
          values of f come from G, expanded about the middle of the chunk, truncated and evaluated in double; a bound
          of the error of these values is part of the result. tau is 0, or the smallest power of two that keeps the
          number of operations within MAX_OPERATIONS. If f is even or odd, so are p and x^m G, exactly; the check of
          x > 0 then also holds for x < 0. For |x| < tau the bound is that of float64:
float64   |p - f| <= |p - x^m G| + |x^m G - f| + rounding, in ball arithmetic on each of PIECES pieces. For m = 1 every
          term is divided by x, because f vanishes at x = 0; the bound then holds except where f or p is subnormal.
"""

import heapq
import itertools
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cache
from typing import NamedTuple, Self

import flint
import numpy as np
from numpy.typing import NDArray

from synth.emit.approx import polynomial
from synth.emit.approx.enclosure import Enclosure, one_norm
from synth.emit.approx.polynomial import Polynomial, Scalars

MAX_OPERATIONS = 3.2e8  # number of x times (number of coefficients + 8); they take about a second
CHUNK_SIZE = 2**15
GROUP_SIZE = 2**18  # a group of chunks is divided only where its bound exceeds the largest error
PIECES = 128


@dataclass(frozen=True)
class Certificate:
    """An upper bound of the relative error, and how many x were checked one by one.

    The check stops at the first chunk whose error exceeds the tolerance; then `max_relative_error` belongs to it.
    """

    max_relative_error: float
    checked_values: int


class Magnitudes(NamedTuple):
    """The numbers of one sign in the range: low <= |x| <= high."""

    low: float
    high: float
    sign: int


@dataclass(frozen=True)
class Chunk:
    """Consecutive floats from sign * first to sign * last; `first` and `last` are bit patterns."""

    first: int
    last: int
    sign: int

    @property
    def x(self) -> Scalars:
        """Return the floats."""
        patterns = np.arange(self.first, self.last + 1, dtype=np.uint32)
        return patterns.view(np.float32) * np.float32(self.sign)

    @property
    def ends(self) -> tuple[flint.arb, flint.arb]:
        """Return the least and the largest of the floats."""
        near, far = np.array([self.first, self.last], dtype=np.uint32).view(np.float32).tolist()
        return (flint.arb(near), flint.arb(far)) if self.sign > 0 else (flint.arb(-far), flint.arb(-near))

    def divide(self, size: int) -> Iterator[Self]:
        """Yield parts of at most `size` floats that begin at multiples of `size`."""
        for base in range(self.first - self.first % size, self.last + 1, size):
            yield replace(self, first=max(self.first, base), last=min(self.last, base + size - 1))


def certify(p: Polynomial, g: Enclosure, tolerance: float) -> Certificate:
    """Bound the relative error of `p` as an approximation of the function that `g` encloses."""
    low, high = (flint.arb(0), g.high) if p.parity != "none" else (g.low, g.high)
    if p.scalar is np.float64:
        return Certificate(relative_error_bound(p, g, low, high), 0)
    ranges = _magnitudes(float(low), float(high))
    tau = _threshold(ranges, len(p.coefficients))
    certificate = _check_floats(p, g, list(_chunks(ranges, tau)), tolerance)
    left, right = max(low, flint.arb(-tau), key=float), min(high, flint.arb(tau), key=float)
    if certificate.max_relative_error > tolerance or not left < right:
        return certificate
    near_zero = relative_error_bound(p, g, left, right)
    return Certificate(max(certificate.max_relative_error, near_zero), certificate.checked_values)


def relative_error_bound(p: Polynomial, g: Enclosure, low: flint.arb, high: flint.arb) -> float:
    """Bound the relative error at all x in [low, high] by ball arithmetic; inf if there is no finite bound."""
    # Chebyshev points: the error of a best polynomial oscillates fastest at the ends of the range.
    points = [(low + high - (high - low) * (flint.arb(k) / PIECES).cos_pi()) / 2 for k in range(1, PIECES)]
    ends = itertools.pairwise([low, *(x.mid() for x in points), high])
    return max(_piece_bound(p, g, left, right) for left, right in ends)


def _piece_bound(p: Polynomial, g: Enclosure, low: flint.arb, high: flint.arb) -> float:
    """Bound the relative error at all x in [low, high] by one expansion about the middle."""
    x = ((low + high) / 2).mid()
    half = (high - x).max(x - low).upper()
    # Coefficients of G and of p / x^m on this piece, in w = -1 .. 1.
    b, c = g.expansion(x, half), polynomial.expansion(p, x, half, g.power)
    distance = one_norm((flint.arb_poly(c) - flint.arb_poly(b)).coeffs()) + g.error
    rounding = polynomial.rounding_bound(p, x + flint.arb(0, half), g.power)
    least = abs(b[0]) - one_norm(b[1:]) - g.error
    return _upper_quotient(distance + rounding, least)


def _upper_quotient(error: flint.arb, value: flint.arb) -> float:
    """Return a double not below error / value; inf unless the value is provably positive."""
    bound = error / value
    return float(np.nextafter(float(bound.upper()), np.inf)) if value > 0 and bound.is_finite() else np.inf


def _magnitudes(low: float, high: float) -> list[Magnitudes]:
    ranges = [Magnitudes(max(low, 0.0), high, 1), Magnitudes(max(-high, 0.0), -low, -1)]
    return [r for r in ranges if r.high > 0]


def _bit_pattern(x: float) -> int:
    return int(np.float32(abs(x)).view(np.uint32))


def _float_count(ranges: Sequence[Magnitudes], tau: float) -> int:
    """Return the number of floats with |x| >= tau."""
    return sum(max(_bit_pattern(r.high) - _bit_pattern(max(r.low, tau)) + 1, 0) for r in ranges)


def _threshold(ranges: Sequence[Magnitudes], coefficients: int) -> float:
    """Return tau for a polynomial with so many coefficients."""
    max_count = MAX_OPERATIONS / (coefficients + 8)
    if _float_count(ranges, 0.0) <= max_count:
        return 0.0
    return next((2.0**k for k in range(-126, 128) if _float_count(ranges, 2.0**k) <= max_count), np.inf)


def _chunks(ranges: Sequence[Magnitudes], tau: float) -> Iterator[Chunk]:
    """Yield the floats with |x| >= tau, by sign."""
    for r in ranges:
        first, last = _bit_pattern(max(r.low, tau)), _bit_pattern(r.high)
        if first <= last:
            yield Chunk(first, last, r.sign)


def _check_floats(p: Polynomial, g: Enclosure, chunks: Sequence[Chunk], tolerance: float) -> Certificate:
    """Return the largest relative error in the chunks, by branch and bound."""
    queue: list[tuple[float, int, Chunk]] = []  # minus a bound, then the order of the chunks, which decides ties

    def put(parts: Iterator[Chunk]) -> None:
        for part in parts:
            heapq.heappush(queue, (-_chunk_bound(p, g, part), part.sign * part.first, part))

    for chunk in chunks:
        put(chunk.divide(GROUP_SIZE))
    worst, count = 0.0, 0
    while queue and -queue[0][0] > worst:
        chunk = heapq.heappop(queue)[-1]
        if chunk.last - chunk.first >= CHUNK_SIZE:
            put(chunk.divide(CHUNK_SIZE))
            continue
        x = chunk.x
        error = _chunk_error(p, g, x)
        count += len(x)
        if not error <= tolerance:
            return Certificate(error if np.isfinite(error) else np.inf, count)
        worst = max(worst, error)
    return Certificate(worst, count)


def _chunk_bound(p: Polynomial, g: Enclosure, chunk: Chunk) -> float:
    return _piece_bound(p, g, *chunk.ends)


def _chunk_error(p: Polynomial, g: Enclosure, x: Scalars) -> float:
    """Bound the relative error at the floats x, with separate and with fused multiply-adds.

    For the reference r with |r - f| <= d |f|, |r| <= |f| / (1 - d), so |p - f| / |f| <= (|p - r| / |r| + d) / (1 - d).
    """
    r, d = reference_values(g, x, _places_in_chunk(float(x[-1]) > 0) if len(x) == CHUNK_SIZE else None)
    largest = []
    for multiply_add in (polynomial.multiply_then_add, polynomial.fused_multiply_add):
        error = polynomial.run(p, x, multiply_add) - r
        error /= r
        largest.append(np.max(np.abs(error, out=error)))
    return (float(np.max(largest)) + d) / (1 - d)


@cache
def _places_in_chunk(rising: bool) -> NDArray[np.float64]:
    """Return (x - middle) / half for the floats of a whole chunk: evenly spaced, they have one exponent."""
    steps = np.arange(CHUNK_SIZE) - (CHUNK_SIZE - 1) / 2
    return (steps if rising else -steps) / steps[-1]


def reference_values(
    g: Enclosure, x: Scalars, w: NDArray[np.float64] | None = None
) -> tuple[NDArray[np.float64], float]:
    """Return f in double at sorted floats x, none of them 0, and a bound d of the relative error that holds for all.

    `w` is (x - middle) / half where it is known. d also covers the rounding errors of the caller, who computes
    (p - f) / f in double.
    """
    first, last = float(x[0]), float(x[-1])
    middle = (first + last) / 2
    half = max(abs(last - middle), abs(middle) * 2.0**-30)
    w = (x.astype(np.float64) - middle) / half if w is None else w
    b = g.expansion(flint.arb(middle), flint.arb(half))
    c = [float(v) for v in b]
    allowance = 2.0**-44 * abs(c[0])  # for the sum of the coefficients that are cut off
    while len(c) > 1 and abs(c[-1]) < allowance:
        allowance -= abs(c.pop())
    value = np.full(len(x), c[-1])
    for coefficient in c[-2::-1]:
        value *= w
        value += coefficient
    error = g.error + one_norm([b_k - c_k for b_k, c_k in zip(b, c, strict=False)]) + one_norm(b[len(c) :])
    # Units of 2^-53: two for each term of Horner's rule, two for each power of w, and eight for x g and for the
    # caller's difference and quotient, which need three.
    error += flint.arb(2) ** -52 * (2 * len(c) + 4) * one_norm(b)
    least = flint.arb(float(np.min(np.abs(value)))) - error
    return value * x if g.power else value, _upper_quotient(error, least)
