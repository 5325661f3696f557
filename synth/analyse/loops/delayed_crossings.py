"""Gain and phase crossings and least distance to -1 of a loop with an exact delay and hold.

log L is a sum of terms whose slopes have bounds over an interval of frequencies (`zpk`). The mean value theorem
excludes crossings from some intervals. If log |L| or arg L is monotone over an interval, the values at its ends give
the number of crossings. Any other interval is halved, down to MIN_WIDTH of its frequency; if still undecided, it counts
as a crossing.
"""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from scipy.optimize import brentq

from synth.analyse.loops import crossings, transfer, zpk
from synth.analyse.loops.crossings import Crossing, Crossings
from synth.analyse.loops.rational import Rational
from synth.analyse.loops.transfer import Delayed
from synth.analyse.loops.zpk import MIN_WIDTH, ZeroPoleGain
from synth.errors import ModelError
from synth.statespace import Array

Bounds = Callable[[Array, Array], tuple[Array, Array, Array, Array]]

ROUNDING = 1e-12  # of log |L| and arg L: a zero this near to the end of an interval may lie on it
MOST_INTERVALS = 500_000
LOBE_POINTS = 100  # of the grid, where only lobes are left
LIMIT_TOLERANCE = 1e-5  # of |L| at infinity: the search ends where |L| stays this close above it


def of_delayed_loop(loop: Delayed, model: Rational, low: float | None, high: float | None) -> Crossings:
    """Return the crossings of a loop, whose rational factor is `model`, between two frequencies in rad/s.

    By default, `low` lies where the loop has reached its asymptote, and `high` lies above all crossings that can decide
    a margin.

    Raises ModelError if the delay is too long to trace the loop.
    """
    last = 0.0 if loop.hold_s else abs(crossings.ends(model)[np.inf])
    ends = {w: v for w, v in crossings.ends(model).items() if w == 0} | {np.inf: -last}  # L circles there
    if model.N.is_zero():
        return Crossings((), (), ends, 1.0, 0.0)
    L = zero_pole_gain(loop, model)
    grid = _with_lobes(L, zpk.frequency_grid(L, low or zpk.lowest_frequency(L)))
    envelope = _envelope(L, grid)

    def last_above(level: float) -> float:
        above = np.flatnonzero(envelope > level)
        return float(grid[min(above[-1] + 1, len(grid) - 1)]) if above.size else float(grid[0])

    phase, top = _phase_crossings(L, grid, last_above, last, high)
    if crossings.is_all_pass(model) and not L.hold_s:  # |L| = 1 everywhere: only L = -1 matters
        gain = phase
    else:
        rates = grid if L.hold_s else zpk.frequency_grid(replace(L, delay_s=0.0), float(grid[0]))  # |L| has no delay
        gain = _gain_crossings(L, rates, high or (last_above(0.5) if L.hold_s else float(rates[-1])))
    nearest = zpk.least_distance(L, zpk.interval_ends(L, grid, top, turning=True))
    distance, frequency = min([nearest, *((abs(1 + v), w) for w, v in ends.items())])
    at = {w: Crossing(w, complex(L.value(w)[0])) for w in (*gain, *phase)}
    gain, phase = ([w for w in each if np.isfinite(at[w].L)] for each in (gain, phase))  # a pole is no crossing
    peak = 1 / distance if distance else np.inf
    return Crossings(tuple(at[w] for w in gain), tuple(at[w] for w in phase), ends, peak, frequency)


def zero_pole_gain(loop: Delayed, model: Rational) -> ZeroPoleGain:
    """Return the zero-pole-gain form of a loop other than 0, whose rational factor is `model`."""
    return zpk.of_rational(model, loop.delay_s + loop.hold_s / 2, loop.hold_s)


def _gain_crossings(L: ZeroPoleGain, grid: Array, top: float) -> list[float]:
    """Return the frequencies of |L| = 1, which do not depend on a delay; the zeros of the hold divide the axis."""
    if L.hold_s:
        transfer.check_turns(L.delay_s, top)
    return _zeros(L.log_gain, _log_gain_bounds(L), zpk.interval_ends(L, grid, top, turning=bool(L.hold_s)), np.inf)


def _envelope(L: ZeroPoleGain, w: Array) -> Array:
    """Return |L| with the envelope of the hold's lobes in place of the lobes."""
    hold = np.minimum(1.0, 2 / np.maximum(w * L.hold_s, 1e-300))
    return np.asarray(np.exp(np.minimum(replace(L, hold_s=0.0).log_gain(w), 700.0)) * hold)


def _with_lobes(L: ZeroPoleGain, grid: Array) -> Array:
    """Return the grid up to where the hold's lobes stay below |L| = 1/2.

    Above the grid the loop without its hold does not rise any more, and the envelope falls at least as 1/w.
    """
    factor = 2 * float(_envelope(L, grid[-1:])[0])
    if not L.hold_s or factor <= 1 or L.signs.sum() > 0:
        return grid
    return np.concatenate([grid, np.geomspace(grid[-1], factor * grid[-1], LOBE_POINTS)[1:]])


def _phase_crossings(
    L: ZeroPoleGain, grid: Array, last_above: Callable[[float], float], last: float, high: float | None
) -> tuple[list[float], float]:
    """Return the frequencies of L < 0 and their upper limit; above it |L| stays below its largest value < 1 at them."""
    top = high or max(last_above(last + transfer.LIMIT_TOLERANCE), 4 * np.pi / L.delay_s)
    while True:
        transfer.check_turns(L.delay_s, top)
        nodes = zpk.interval_ends(L, grid, top, turning=True)
        crossings = _zeros(lambda w: L.phase(w) - np.pi, _phase_bounds(L), nodes, 2 * np.pi)
        gains = np.exp(L.log_gain(np.array(crossings))) if crossings else np.zeros(0)
        further = last_above(max(float(gains[gains < 1].max(initial=0.0)), last * (1 + LIMIT_TOLERANCE)))
        if high or further <= top:
            return crossings, top
        top = further


def _log_gain_bounds(L: ZeroPoleGain) -> Bounds:
    def bounds(a: Array, b: Array) -> tuple[Array, Array, Array, Array]:
        slope, range_ = L.log_gain_slope(a, b), L.log_gain_bounds(a, b)
        low, high = _mean_value(L.log_gain((a + b) / 2), (b - a) / 2, *slope)
        return np.maximum(low, range_[0]), np.minimum(high, range_[1]), *slope

    return bounds


def _phase_bounds(L: ZeroPoleGain) -> Bounds:
    def bounds(a: Array, b: Array) -> tuple[Array, Array, Array, Array]:
        slope = L.phase_slope(a, b)
        return *_mean_value(L.phase((a + b) / 2) - np.pi, (b - a) / 2, *slope), *slope

    return bounds


def _mean_value(middle: Array, half: Array, low: Array, high: Array) -> tuple[Array, Array]:
    spread = half * np.maximum(np.abs(low), np.abs(high))
    return middle - spread, middle + spread


def _zeros(f: Callable[[Array], Array], bounds: Bounds, nodes: Array, period: float) -> list[float]:
    """Return the zeros of f modulo `period`, or of f itself if the period is inf, between the nodes."""
    a, b = nodes[:-1], nodes[1:]
    zeros: list[float] = []
    while a.size:
        if len(a) > MOST_INTERVALS:
            raise ModelError(
                "the loop stays so close to |L| = 1 or to the negative axis that its crossings cannot be separated in "
                "double precision: change its gain a little"
            )
        low, high, slope_low, slope_high = bounds(a, b)
        low, high = low - ROUNDING * (1 + np.abs(low)), high + ROUNDING * (1 + np.abs(high))
        may_cross = (low <= 0) & (high >= 0) if np.isinf(period) else np.floor(high / period) >= np.ceil(low / period)
        monotone = (slope_low > 0) | (slope_high < 0)
        narrow = b - a <= MIN_WIDTH * b
        for x, y in zip(a[may_cross & monotone], b[may_cross & monotone], strict=True):
            zeros += _zeros_of_monotone(f, float(x), float(y), period)
        zeros += [float(v) for v in ((a + b) / 2)[may_cross & narrow & ~monotone]]
        a, b = a[may_cross & ~monotone & ~narrow], b[may_cross & ~monotone & ~narrow]
        middle = (a + b) / 2
        a, b = np.concatenate([a, middle]), np.concatenate([middle, b])
    return _distinct(sorted(zeros))


def _zeros_of_monotone(f: Callable[[Array], Array], a: float, b: float, period: float) -> list[float]:
    """Return the zeros modulo `period` of a function that is monotone between a and b.

    The ends are moved just inside, because f may jump there; a zero on an end then shows within ROUNDING of it.
    """
    a, b = a * (1 + 4e-16), b * (1 - 4e-16)
    at_a, at_b = map(float, f(np.array([a, b])))
    slack = ROUNDING * (1 + max(abs(at_a), abs(at_b)))
    low, high = min(at_a, at_b) - slack, max(at_a, at_b) + slack
    levels = [0.0] if np.isinf(period) else period * np.arange(np.ceil(low / period), np.floor(high / period) + 1)
    return [_root(f, a, b, at_a - level, at_b - level, level) for level in levels if low <= level <= high]


def _root(f: Callable[[Array], Array], a: float, b: float, at_a: float, at_b: float, level: float) -> float:
    """Return the point between a and b with f = level, or the closer end if the level lies just beyond it."""
    if at_a * at_b >= 0:
        return a if abs(at_a) <= abs(at_b) else b
    return float(brentq(lambda w: float(f(np.array([w]))[0] - level), a, b, xtol=1e-300, rtol=1e-14))


def _distinct(w: list[float]) -> list[float]:
    """Return sorted frequencies without duplicates of one crossing."""
    return [v for k, v in enumerate(w) if k == 0 or v - w[k - 1] > 4 * MIN_WIDTH * v]
