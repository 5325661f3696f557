"""Interval extensions of libm's functions: enclosures of results with an error of a few units in the last place.

The exact value comes from ball arithmetic (Arb), so the ends are the same on every machine. The assumptions are that
the library errs by no more than ULPS units, and that its result has the sign of the exact value, or is 0.
"""

from collections.abc import Callable, Sequence
from functools import lru_cache
from math import inf, nan, pi

import flint
import numpy as np

from synth.analyse.numerics.precise import precision
from synth.emit.proof.interval import EXACT, Array, Interval, Mask

ULPS = 4
_BITS = 96
_SLACK = 1e-9  # in periods: an extremum or a pole this close to the interval counts as inside
_FAR = 1e6  # periods beyond which _SLACK is not resolved

# The functions' limits at infinity, which they attain in double precision well before it.
_HUGE = 1e4
_LIMITS = {"exp": (0.0, inf), "expm1": (-1.0, inf), "sinh": (-inf, inf), "cosh": (inf, inf), "tanh": (-1.0, 1.0)}
_LIMITS |= {"erf": (-1.0, 1.0)}


@lru_cache(maxsize=1 << 17)
def _ball(name: str, *x: float) -> tuple[float, float, float]:
    """Return doubles below and above the exact value, and its sign, which is kept even if they are 0."""
    if abs(x[0]) > _HUGE and name in _LIMITS:
        limit = _LIMITS[name][x[0] > 0]
        return limit, limit, -1.0 if limit < 0 else 1.0
    if name == "log" and x[0] == 0:
        return -inf, -inf, -1.0
    with precision(_BITS):
        ball = getattr(flint.arb, name)(*map(flint.arb, x))
        if not ball.is_finite():
            return -inf, inf, nan
        return float(ball.lower()), float(ball.upper()), nan if ball.contains(0) and ball != 0 else float(ball.sgn())


def _at_points(name: str, ulps: int, *x: Array) -> Interval:
    """Return the values that libm may return at points (n,)."""
    stacked = np.stack(np.broadcast_arrays(*x))
    columns, place = np.unique(stacked, axis=1, return_inverse=True)
    balls = [_ball(name, *map(float, column)) for column in columns.T]
    low, high, sign = (np.array(side)[place.ravel()] for side in zip(*balls, strict=True))
    scalar = x[0].dtype.type
    low, high = low.astype(scalar), high.astype(scalar)
    if ulps:
        # Twice the units, because the interval may extend to where they are twice as large; one more for this rounding.
        low, high = _move_by_ulps(low, -2 * ulps - 1), _move_by_ulps(high, 2 * ulps + 1)
        low, high = np.where(sign >= 0, np.maximum(low, 0), low), np.where(sign <= 0, np.minimum(high, 0), high)
        low, high = np.where(sign == 0, 0, low), np.where(sign == 0, 0, high)
    return Interval(low, high, np.zeros(low.shape, bool))


def _move_by_ulps(v: Array, units: int) -> Array:
    """Move by units in the last place; an infinity moves inwards only."""
    big = np.finfo(v.dtype).max
    inward = np.where((units < 0) == (v > 0), np.sign(v) * big, v)
    return np.where(np.isinf(v), inward, v + units * np.spacing(np.abs(np.clip(v, -big, big))))


def _monotone(name: str) -> Callable[[int, Interval], Interval]:
    def enclose(ulps: int, a: Interval) -> Interval:
        return Interval(_at_points(name, ulps, a.low).low, _at_points(name, ulps, a.high).high, a.nan)

    return enclose


def _clip_to_domain(a: Interval, low: float, high: float) -> Interval:
    """Return the intersection of `a` with a function's domain; values outside give NaN."""
    return Interval(np.clip(a.low, low, high), np.clip(a.high, low, high), a.nan | (a.low < low) | (a.high > high))


def _may_contain(a: Interval, first: float, period: float) -> Mask:
    """Return whether first + k period may lie in the interval for some whole k."""
    low, high = ((side.astype(np.float64) - first) / period for side in (a.low, a.high))
    return (np.floor(high + _SLACK) >= np.ceil(low - _SLACK)) | (np.maximum(np.abs(low), np.abs(high)) > _FAR)


def _periodic(name: str, top: float) -> Callable[[int, Interval], Interval]:
    def enclose(ulps: int, a: Interval) -> Interval:
        inside = [np.where(np.isinf(side), 0, side) for side in (a.low, a.high)]
        first, last = (_at_points(name, ulps, side) for side in inside)
        one = _move_by_ulps(np.ones_like(a.low), 2 * ulps + 1) if ulps else np.ones_like(a.low)
        low = np.where(_may_contain(a, top + pi, 2 * pi), -one, np.minimum(first.low, last.low))
        high = np.where(_may_contain(a, top, 2 * pi), one, np.maximum(first.high, last.high))
        return Interval(low, high, a.nan | a.infinite)

    return enclose


def _tan(ulps: int, a: Interval) -> Interval:
    pole = _may_contain(a, pi / 2, pi)
    low, high = (np.where(pole, 0, side) for side in (a.low, a.high))
    tangent = _monotone("tan")(ulps, Interval(low, high, a.nan))
    return Interval(np.where(pole, -inf, tangent.low), np.where(pole, inf, tangent.high), a.nan | a.infinite)


def _cosh(ulps: int, a: Interval) -> Interval:
    size = EXACT["fabs"](a)
    return _monotone("cosh")(ulps, size)


def _acos(ulps: int, a: Interval) -> Interval:
    inside = _clip_to_domain(a, -1, 1)
    return Interval(_at_points("acos", ulps, inside.high).low, _at_points("acos", ulps, inside.low).high, inside.nan)


def _atan2(ulps: int, y: Interval, x: Interval) -> Interval:
    # Away from the branch cut along x <= 0 the extremes over a box lie at its corners.
    free = ((x.low > 0) | (y.low > 0) | (y.high < 0)) & ~x.infinite & ~y.infinite
    sides = [[np.where(free, side, 1) for side in (a.low, a.high)] for a in (y, x)]
    corners = [_at_points("atan2", ulps, v, u) for v in sides[0] for u in sides[1]]
    round_ = _at_points("atan2", ulps, np.zeros_like(y.low), -np.ones_like(y.low)).high
    low = np.where(free, np.minimum.reduce([f.low for f in corners]), -round_)
    high = np.where(free, np.maximum.reduce([f.high for f in corners]), round_)
    return Interval(low, high, y.nan | x.nan)


FUNCTIONS: dict[str, Callable[..., Interval]] = {
    **{name: _monotone(name) for name in ("exp", "expm1", "sinh", "tanh", "atan", "asinh", "erf")},
    "log": lambda ulps, a: _monotone("log")(ulps, _clip_to_domain(a, 0, inf)),
    "log1p": lambda ulps, a: _monotone("log1p")(ulps, _clip_to_domain(a, -1, inf)),
    "asin": lambda ulps, a: _monotone("asin")(ulps, _clip_to_domain(a, -1, 1)),
    "acos": _acos,
    "sin": _periodic("sin", pi / 2),
    "cos": _periodic("cos", 0.0),
    "tan": _tan,
    "cosh": _cosh,
    "atan2": _atan2,
}


def transfer(op: str, args: Sequence[Interval], ulps: int) -> Interval:
    """Transfer function: return the range of an operation's result; `ulps` is the error of libm.

    The passes analyse nearly the same program several times, so results for single intervals are kept.

    Raises KeyError for an unknown operation.
    """
    if any(a.low.shape != (1,) for a in args):
        return _transfer(op, args, ulps)
    return _kept_transfer(op, args[0].low.dtype.str, ulps, *(side.tobytes() for a in args for side in a.sides))


@lru_cache(maxsize=1 << 15)
def _kept_transfer(op: str, dtype: str, ulps: int, *sides: bytes) -> Interval:
    types = (dtype, dtype, bool)
    arrays = [np.frombuffer(side, types[i % 3]) for i, side in enumerate(sides)]
    return _transfer(op, [Interval(*arrays[i : i + 3]) for i in range(0, len(arrays), 3)], ulps)


def _transfer(op: str, args: Sequence[Interval], ulps: int) -> Interval:
    return FUNCTIONS[op](ulps, *args) if op in FUNCTIONS else EXACT[op](*args)
