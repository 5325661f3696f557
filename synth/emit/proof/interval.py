"""Interval arithmetic of floating-point operations: bounds of computed values for arguments in intervals.

Let F be an operation f as the processor computes it. For intervals X_1, X_2 this module returns Y with F(x_1, x_2) in Y
for all x_i in X_i. Rounding to nearest is monotone, so the ends of Y are computed ends: where f increases, F(high)
bounds F(x) exactly. Subnormal numbers are assumed to be computed, not flushed to zero.

An Interval holds n intervals at once (vectorised), so many boxes of arguments cost little more than one.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import reduce
from math import inf
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[Any]
Mask = NDArray[np.bool_]

PIECES = 64  # of a polynomial's range


@dataclass(frozen=True, eq=False)
class Interval:
    """Intervals low..high (n,) of the scalar type, ends included; `nan` (n,): the value may also be NaN."""

    low: Array
    high: Array
    nan: Mask

    @property
    def sides(self) -> tuple[Array, Array, Mask]:
        """The arrays."""
        return self.low, self.high, self.nan

    @property
    def finite(self) -> Mask:
        """Whether every value is a finite number."""
        return np.isfinite(self.low) & np.isfinite(self.high) & ~self.nan

    @property
    def empty(self) -> Mask:
        """Whether the interval contains no value."""
        return (self.low > self.high) & ~self.nan

    @property
    def zero(self) -> Mask:
        """Whether 0 is among the values."""
        return (self.low <= 0) & (self.high >= 0)

    @property
    def infinite(self) -> Mask:
        """Whether an infinity is among the values."""
        return np.isinf(self.low) | np.isinf(self.high)


def interval(low: float, high: float, nan: bool, scalar: type[np.floating]) -> Interval:
    """Return one interval; its ends are rounded to the scalar type."""
    with np.errstate(over="ignore"):
        return Interval(np.array([low], scalar), np.array([high], scalar), np.array([nan]))


def point(value: float, scalar: type[np.floating]) -> Interval:
    """Return the interval that holds one value, rounded to the scalar type."""
    return interval(value, value, False, scalar)


def intersection(a: Interval, b: Interval) -> Interval:
    """Return the intersection of two intervals."""
    return Interval(np.maximum(a.low, b.low), np.minimum(a.high, b.high), a.nan & b.nan)


def hull(a: Interval, b: Interval) -> Interval:
    """Return the hull of two intervals; if one is empty, the other."""
    no_a, no_b = a.low > a.high, b.low > b.high
    low = np.where(no_a, b.low, np.where(no_b, a.low, np.minimum(a.low, b.low)))
    high = np.where(no_a, b.high, np.where(no_b, a.high, np.maximum(a.high, b.high)))
    return Interval(low, high, a.nan | b.nan)


def unrounded(a: Interval, positive: Mask | bool = False) -> Interval:
    """Return an enclosure of an exact product whose rounded value lies in `a`; where `positive` it is not below 0."""
    bound = a.low.dtype.type(inf)
    low = np.nextafter(a.low, -bound)
    return Interval(np.where(positive, np.maximum(low, 0), low), np.nextafter(a.high, bound), a.nan)


def truth(a: Interval) -> Interval:
    """Return the truth value in C as a subset of 0..1; NaN differs from 0 and is true."""
    never = (a.low == 0) & (a.high == 0) & ~a.nan
    return _logical(~a.zero, ~never, a.low.dtype.type)


def _logical(surely: Mask, possibly: Mask, scalar: type[np.floating]) -> Interval:
    return Interval(surely.astype(scalar), possibly.astype(scalar), np.zeros_like(surely))


def _hull(candidates: list[Array], nan: Mask) -> Interval:
    return Interval(reduce(np.minimum, candidates), reduce(np.maximum, candidates), nan)


def _add(a: Interval, b: Interval) -> Interval:
    low, high = a.low + b.low, a.high + b.high
    undefined = ((a.high == inf) & (b.low == -inf)) | ((a.low == -inf) & (b.high == inf))
    return Interval(np.where(np.isnan(low), -inf, low), np.where(np.isnan(high), inf, high), a.nan | b.nan | undefined)


def _neg(a: Interval) -> Interval:
    return Interval(-a.high, -a.low, a.nan)


def _mul(a: Interval, b: Interval) -> Interval:
    ends = [x * y for x in (a.low, a.high) for y in (b.low, b.high)]
    undefined = (a.zero & b.infinite) | (a.infinite & b.zero)
    # 0 times an infinite end represents 0 times the finite numbers before it.
    return _hull([np.where(np.isnan(e), 0, e) for e in ends], a.nan | b.nan | undefined)


def _sq(a: Interval) -> Interval:
    ends = [a.low * a.low, a.high * a.high]
    squares = _hull(ends, a.nan)
    return Interval(np.where(a.zero, 0, squares.low), squares.high, a.nan)


def _div(a: Interval, b: Interval) -> Interval:
    ends = [x / y for x in (a.low, a.high) for y in (b.low, b.high)]
    quotient = _hull([np.where(np.isnan(e), 0, e) for e in ends], a.nan | b.nan)
    nan = quotient.nan | (a.zero & b.zero) | (a.infinite & b.infinite)
    return Interval(np.where(b.zero, -inf, quotient.low), np.where(b.zero, inf, quotient.high), nan)


def _inv(a: Interval) -> Interval:
    one = np.ones_like(a.low)
    return _div(Interval(one, one, np.zeros_like(a.nan)), a)


def _fabs(a: Interval) -> Interval:
    low, high = np.abs(a.low), np.abs(a.high)
    return Interval(np.where(a.zero, 0, np.minimum(low, high)), np.maximum(low, high), a.nan)


def _min(a: Interval, b: Interval) -> Interval:
    # (a < b) ? a : b gives b when either is NaN
    high = np.where(a.nan, b.high, np.minimum(a.high, b.high))
    return Interval(np.minimum(a.low, b.low), high, b.nan)


def _max(a: Interval, b: Interval) -> Interval:
    low = np.where(a.nan, b.low, np.maximum(a.low, b.low))
    return Interval(low, np.maximum(a.high, b.high), b.nan)


def _clamp(x: Interval, low: Interval, high: Interval) -> Interval:
    # fabs(x) <= high ? x : (x < 0) ? low : high, where low is -high; for a negative high the result is never x
    limited, odd = _max(_min(x, high), low), (high.low < 0) | high.nan
    outer = _hull([limited.low, limited.high, low.low, low.high, high.low, high.high], low.nan | high.nan)
    return Interval(np.where(odd, outer.low, limited.low), np.where(odd, outer.high, limited.high), outer.nan)


def _sqrt(a: Interval) -> Interval:
    return Interval(np.sqrt(np.maximum(a.low, 0)), np.sqrt(np.maximum(a.high, 0)), a.nan | (a.low < 0))


def _fmod(a: Interval, b: Interval) -> Interval:
    size, up = _fabs(b), a.low.dtype.type(inf)
    below = np.nextafter(size.high, -up)  # |fmod(a, b)| < |b|
    low, high = np.maximum(np.minimum(a.low, 0), -below), np.minimum(np.maximum(a.high, 0), below)
    # Between two multiples of one b the result rises with a; across one of them it falls.
    first, last = np.fmod(a.low, b.high), np.fmod(a.high, b.high)
    narrow = ((a.low >= 0) | (a.high <= 0)) & (np.nextafter(a.high - a.low, up) < size.low) & (b.low == b.high)
    rises = (narrow & (first <= last)) | (_fabs(a).high < size.low)
    nan = a.nan | b.nan | b.zero | a.infinite
    return Interval(
        np.where(rises, np.where(narrow, first, a.low), low), np.where(rises, np.where(narrow, last, a.high), high), nan
    )


def _remainder(a: Interval, b: Interval) -> Interval:
    size = np.minimum(_fabs(a).high, np.nextafter(_fabs(b).high / 2, a.low.dtype.type(inf)))
    return Interval(-size, size, _fmod(a, b).nan)


def _comparison(below: Callable[[Array, Array], Mask]) -> Callable[[Interval, Interval], Interval]:
    def compare(a: Interval, b: Interval) -> Interval:
        return _logical(below(a.high, b.low) & ~(a.nan | b.nan), below(a.low, b.high), a.low.dtype.type)

    return compare


def _eq(a: Interval, b: Interval) -> Interval:
    one = (a.low == a.high) & (b.low == b.high) & (a.low == b.low) & ~(a.nan | b.nan)
    return _logical(one, (a.low <= b.high) & (b.low <= a.high), a.low.dtype.type)


def _not(a: Interval) -> Interval:
    t = truth(a)
    return Interval(1 - t.high, 1 - t.low, np.zeros_like(a.nan))


EXACT: dict[str, Callable[..., Interval]] = {
    "neg": _neg,
    "fabs": _fabs,
    "add": _add,
    "sub": lambda a, b: _add(a, _neg(b)),
    "mul": _mul,
    "sq": _sq,
    "twice": lambda a: _add(a, a),
    "div": _div,
    "inv": _inv,
    "floor": lambda a: Interval(np.floor(a.low), np.floor(a.high), a.nan),
    "sqrt": _sqrt,
    "fmod": _fmod,
    "remainder": _remainder,
    "min": _min,
    "max": _max,
    "clamp": _clamp,
    "within": _clamp,
    "lt": _comparison(np.less),
    "le": _comparison(np.less_equal),
    "eq": _eq,
    "ne": lambda a, b: _not(_eq(a, b)),
    "not": _not,
    "and": lambda a, b: _min(truth(a), truth(b)),
    "or": lambda a, b: _max(truth(a), truth(b)),
}


def lookup(values: Sequence[float], index: Interval) -> Interval:
    """Return the range of a table's values at the whole indices inside it; of all its values if there are none."""
    numbers, last = np.asarray(values, index.low.dtype), len(values) - 1
    first, end = (np.clip(np.nan_to_num(np.floor(side)), 0, last).astype(int) for side in (index.low, index.high))
    parts = [numbers[a : b + 1] if a <= b else numbers for a, b in zip(first, end, strict=True)]
    low, high = (np.array([f(part) for part in parts], numbers.dtype) for f in (np.min, np.max))
    return Interval(low, high, index.nan)


def dot(coefficients: Sequence[float], values: Sequence[Interval], contracted: bool) -> Interval:
    """Return the range of c_1 x_1 + c_2 x_2 + .., rounded from left to right."""
    low, high, nan = (np.stack(np.broadcast_arrays(*side)) for side in zip(*(v.sides for v in values), strict=True))
    c = np.asarray(coefficients, low.dtype)[:, None]
    products = _mul(Interval(c, c, np.zeros(c.shape, bool)), Interval(low, high, nan))
    products = unrounded(products) if contracted else products
    low, high = (np.add.accumulate(side, axis=0) for side in (products.low, products.high))
    below, above = (
        (np.isinf(sums) | np.isinf(products_)).any(axis=0)
        for sums, products_ in ((low, products.low), (high, products.high))
    )
    unknown = products.nan.any(axis=0) | (below & above)
    return Interval(np.where(below, -inf, low[-1]), np.where(above, inf, high[-1]), unknown)


def polynomial(coefficients: Sequence[float], v: Interval, contracted: bool) -> Interval:
    """Return the range of c_0 + v (c_1 + v (... + v c_n)) by Horner's rule; a coefficient 0 is not added.

    A single interval is divided into pieces, which reduces the overestimation by the dependency of terms on v.
    """
    scalar, pieces = v.low.dtype.type, max(1, PIECES // v.low.size)
    parts = np.linspace(0, 1, pieces + 1, dtype=scalar)[:, None]
    edges = np.clip(v.low + (v.high - v.low) * parts, v.low, v.high)
    edges[-1] = v.high
    piece = Interval(edges[:-1], edges[1:], v.nan)
    last = np.full_like(piece.low, coefficients[-1])
    q = Interval(last, last, np.zeros(last.shape, bool))
    for c in coefficients[-2::-1]:
        product = _mul(piece, q)
        q = _add(point(c, scalar), unrounded(product) if contracted else product) if c else product
    low, high, unknown = q.low.min(axis=0), q.high.max(axis=0), v.infinite | ~np.isfinite(v.high - v.low)
    nan = np.broadcast_to(q.nan, edges[1:].shape).any(axis=0)
    return Interval(np.where(unknown, -inf, low), np.where(unknown, inf, high), nan | unknown)
