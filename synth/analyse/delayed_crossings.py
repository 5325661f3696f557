"""Where a loop with an exact delay and hold crosses |L| = 1 and L < 0, and where it comes nearest to -1.

With the zeros and poles r of the loop's rational part, its gain k, a delay tau and a hold T,

    log L(i w) = log k +- sum log(i w - r) - i w (tau + T/2) + log(sin(w T/2) / (w T/2)).

The slope of each term over an interval of w has bounds in closed form. So an interval holds no crossing where the mean
value theorem excludes it; one over which log |L| or arg L is monotone holds as many as its ends show; any other is
halved, down to NARROW of its frequency, and one that is still undecided then counts as a crossing. The least |1 + L| is
found by branch and bound with the same slopes.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq

from synth.analyse import rational, transfer
from synth.analyse.crossings import Course, Crossing
from synth.analyse.rational import Rational
from synth.analyse.transfer import Delayed
from synth.statespace import Array

Bounds = Callable[[Array, Array], tuple[Array, Array, Array, Array]]

NARROW = 1e-12  # of a frequency: no interval is halved further
TIGHT = 1e-6  # of the least |1 + L|: what may lie below it
BELOW = 1e-3  # of the least of all rates: below it the loop is its asymptote
BEYOND = 1e3  # times the largest of all rates: above it the loop is its asymptote
GRID = 400
QUIET = 1e-5  # of |L| at infinity: a loop that stays this near above it is followed no further


@dataclass(frozen=True, eq=False)
class _Factors:
    """log L: zeros (+1) and poles (-1) `roots` (m,) with their `signs` (m,), log |k|, arg k, and two times in s."""

    roots: NDArray[np.complex128]
    signs: Array
    size: float
    angle: float
    late: float
    hold: float

    def log_size(self, w: Array) -> Array:
        """Return log |L| at frequencies (k,)."""
        with np.errstate(divide="ignore"):
            distance = np.log(np.abs(1j * w[:, None] - self.roots))
            held = np.log(np.abs(np.sinc(w * self.hold / (2 * np.pi))))
        return np.asarray(self.size + distance @ self.signs + held)

    def phase(self, w: Array) -> Array:
        """Return arg L at frequencies (k,), continuous but where a root lies on the axis or the hold is 0."""
        c, x = -self.roots.real, w[:, None] - self.roots.imag
        angles = np.where(c < 0, np.pi - np.arctan2(x, -c), np.arctan2(x, c))
        lobes = np.floor(w * self.hold / (2 * np.pi))
        return np.asarray(self.angle + angles @ self.signs - w * self.late + np.pi * lobes)

    def value(self, w: Array) -> NDArray[np.complex128]:
        """Return L at frequencies (k,)."""
        return np.asarray(np.exp(self.log_size(w) + 1j * self.phase(w)))

    def phase_slope(self, a: Array, b: Array) -> tuple[Array, Array]:
        """Return bounds (k,) of d arg L / dw over intervals a .. b."""
        c, near, far = -self.roots.real, *self._distances(a, b)
        with np.errstate(divide="ignore", invalid="ignore"):
            ends = [np.where(c == 0, 0.0, self.signs * c / (c * c + x * x)) for x in (near, far)]
        low, high = np.minimum(*ends).sum(axis=1), np.maximum(*ends).sum(axis=1)
        return low - self.late, high - self.late

    def size_slope(self, a: Array, b: Array) -> tuple[Array, Array]:
        """Return bounds (k,) of d log |L| / dw over intervals a .. b that have no root on the axis inside."""
        c, x = np.abs(self.roots.real), np.stack([v[:, None] - self.roots.imag for v in (a, b)])
        with np.errstate(divide="ignore", invalid="ignore"):
            ends = np.where((c == 0) & (x == 0), np.array([np.inf, -np.inf])[:, None, None], x / (c * c + x * x))
            turn = np.where(c > 0, 1 / (2 * c), np.inf)
        low, high = ends.min(axis=0), ends.max(axis=0)
        high = np.where((x[0] < c) & (c < x[1]), turn, high)
        low = np.where((x[0] < -c) & (-c < x[1]), -turn, low)
        rising, falling = self.signs > 0, self.signs < 0
        below = low[:, rising].sum(axis=1) - high[:, falling].sum(axis=1)
        above = high[:, rising].sum(axis=1) - low[:, falling].sum(axis=1)
        held = self._held_slope(a, b)
        return below + held[0], above + held[1]

    def size_range(self, a: Array, b: Array) -> tuple[Array, Array]:
        """Return bounds (k,) of log |L| over intervals a .. b, each factor by itself."""
        near, far = self._distances(a, b)
        c = self.roots.real
        with np.errstate(divide="ignore"):
            low, high = (np.log(np.hypot(c, x)) for x in (near, far))
        rising, falling = self.signs > 0, self.signs < 0
        below = low[:, rising].sum(axis=1) - high[:, falling].sum(axis=1)
        above = high[:, rising].sum(axis=1) - low[:, falling].sum(axis=1)
        held = self._held_range(a, b)
        return self.size + below + held[0], self.size + above + held[1]

    def _distances(self, a: Array, b: Array) -> tuple[Array, Array]:
        low, high = a[:, None] - self.roots.imag, b[:, None] - self.roots.imag
        near = np.where(low > 0, low, np.where(high < 0, -high, 0.0))
        return near, np.maximum(np.abs(low), np.abs(high))

    def _held_slope(self, a: Array, b: Array) -> tuple[Array, Array]:
        """Return bounds of d log |sin x / x| / dw: cot x falls over each lobe, and intervals end where lobes do."""
        if not self.hold:
            return np.zeros(len(a)), np.zeros(len(a))
        x, y = self._inside_lobe(a, b)
        with np.errstate(divide="ignore", invalid="ignore"):
            low = np.where(y % np.pi == 0, -np.inf, 1 / np.tan(y)) - 1 / x
            high = 1 / np.tan(x) - 1 / y
        return low * self.hold / 2, high * self.hold / 2

    def _held_range(self, a: Array, b: Array) -> tuple[Array, Array]:
        if not self.hold:
            return np.zeros(len(a)), np.zeros(len(a))
        x, y = self._inside_lobe(a, b)
        top = (np.floor(x / np.pi) + 0.5) * np.pi
        largest = np.where((x < top) & (top < y), 1.0, np.maximum(np.abs(np.sin(x)), np.abs(np.sin(y))))
        with np.errstate(divide="ignore"):
            low = np.log(np.minimum(np.abs(np.sin(x)), np.abs(np.sin(y))) / y)
            return low, np.minimum(np.log(largest / x), 0.0)

    def _inside_lobe(self, a: Array, b: Array) -> tuple[Array, Array]:
        return a * self.hold / 2 * (1 + 1e-15), b * self.hold / 2 * (1 - 1e-15)


def of_delayed(loop: Delayed, low: float | None, high: float | None) -> Course:
    """Return the course of a loop, its rational part exact, between two frequencies in rad/s.

    Left out, `low` lies where the loop is its asymptote, and `high` so far up that no later crossing decides a margin.

    Raises ModelError when the delay is too long for the loop to be followed.
    """
    ends = transfer.ends(loop)
    part = rational.of_system(loop.model)
    if part.N.is_zero():
        return Course((), (), ends, 1.0, 0.0)
    factors, last = _factors(part, loop), abs(ends[np.inf])
    grid = _grid(factors, low or _start(factors))
    envelope = _envelope(factors, grid)

    def last_above(level: float) -> float:
        above = np.flatnonzero(envelope > level)
        return float(grid[min(above[-1] + 1, len(grid) - 1)]) if above.size else float(grid[0])

    top = high or (last_above(0.5) if factors.hold else float(grid[-1]))
    nodes = _nodes(factors, grid, top, turning=bool(factors.hold))
    unit = _zeros(factors.log_size, _size_bounds(factors), nodes, np.inf)
    negative, top = _negative(factors, grid, last_above, last, high)
    least, where = _nearest(factors, _nodes(factors, grid, top, turning=True), ends)
    found = [tuple(Crossing(w, complex(factors.value(np.array([w]))[0])) for w in each) for each in (unit, negative)]
    return Course(found[0], found[1], ends, 1 / least if least else np.inf, where)


def _factors(part: Rational, loop: Delayed) -> _Factors:
    N, D = part.reduced
    zeros, poles = rational.zeros(N), rational.zeros(D)
    k = int(N[N.degree()]) / int(D[D.degree()])
    signs = np.concatenate([np.ones(len(zeros)), -np.ones(len(poles))])
    late = loop.delay_s + loop.hold_s / 2
    return _Factors(np.concatenate([zeros, poles]), signs, float(np.log(abs(k))), np.pi * (k < 0), late, loop.hold_s)


def _start(factors: _Factors) -> float:
    """Return a frequency below which the loop is its asymptote and |L| does not cross 1."""
    sizes = np.abs(factors.roots)
    apart = BELOW * min(float(sizes[sizes > 0].min(initial=np.inf)), 1 / factors.late)
    slope = float(factors.signs[sizes == 0].sum())
    if not slope:
        return apart
    return min(apart, apart * float(np.exp(-factors.log_size(np.array([apart]))[0] / slope)) / 10)


def _grid(factors: _Factors, start: float) -> Array:
    """Return frequencies from start to where the loop without its hold is its asymptote and |L| does not cross 1."""
    top = max(BEYOND * float(np.abs(factors.roots).max(initial=0.0)), BEYOND / factors.late, 10 * start)
    slope = float(factors.signs.sum())
    if slope:
        size = float(replace(factors, hold=0.0).log_size(np.array([top]))[0])
        top *= max(1.0, 10 * float(np.exp(-size / slope)))
    peaks = factors.roots.imag[(factors.roots.imag > start) & (factors.roots.imag < top)]
    return np.unique(np.concatenate([np.geomspace(start, top, GRID), peaks]))


def _envelope(factors: _Factors, w: Array) -> Array:
    """Return |L| with what the hold's lobes stay below in their place."""
    held = np.minimum(1.0, 2 / np.maximum(w * factors.hold, 1e-300))
    return np.asarray(np.exp(np.minimum(replace(factors, hold=0.0).log_size(w), 700.0)) * held)


def _nodes(factors: _Factors, grid: Array, top: float, turning: bool) -> Array:
    """Return where intervals end: the grid, steps of the delay, poles and zeros on the axis, zeros of the hold.

    Raises ModelError when there are more than `transfer.TURNS` turns of the delay.
    """
    on_axis = factors.roots.imag[(factors.roots.real == 0) & (factors.roots.imag > 0)]
    nodes = [grid, on_axis, np.array([top])]
    if turning:
        transfer.check_turns(factors.late, top)
        nodes.append(np.arange(grid[0], top, 0.3 / factors.late))
    if factors.hold and turning:
        nodes.append(2 * np.pi / factors.hold * np.arange(1, int(top * factors.hold / (2 * np.pi)) + 1))
    w = np.unique(np.concatenate(nodes))
    return np.asarray(w[(w >= grid[0]) & (w <= top)])


def _negative(
    factors: _Factors, grid: Array, last_above: Callable[[float], float], last: float, high: float | None
) -> tuple[list[float], float]:
    """Return where L < 0 up to the returned frequency, above which |L| stays below its largest value there under 1."""
    top = high or max(last_above(last + transfer.QUIET), 4 * np.pi / factors.late)
    while True:
        nodes = _nodes(factors, grid, top, turning=True)
        found = _zeros(lambda w: factors.phase(w) - np.pi, _phase_bounds(factors), nodes, 2 * np.pi)
        sizes = np.exp(factors.log_size(np.array(found))) if found else np.zeros(0)
        further = last_above(max(float(sizes[sizes < 1].max(initial=0.0)), last * (1 + QUIET)))
        if high or further <= top:
            return found, top
        top = further


def _size_bounds(factors: _Factors) -> Bounds:
    def bounds(a: Array, b: Array) -> tuple[Array, Array, Array, Array]:
        slope, range_ = factors.size_slope(a, b), factors.size_range(a, b)
        low, high = _mean_value(factors.log_size((a + b) / 2), (b - a) / 2, *slope)
        return np.maximum(low, range_[0]), np.minimum(high, range_[1]), *slope

    return bounds


def _phase_bounds(factors: _Factors) -> Bounds:
    def bounds(a: Array, b: Array) -> tuple[Array, Array, Array, Array]:
        slope = factors.phase_slope(a, b)
        return *_mean_value(factors.phase((a + b) / 2) - np.pi, (b - a) / 2, *slope), *slope

    return bounds


def _mean_value(middle: Array, half: Array, low: Array, high: Array) -> tuple[Array, Array]:
    spread = half * np.maximum(np.abs(low), np.abs(high))
    return middle - spread, middle + spread


def _zeros(f: Callable[[Array], Array], bounds: Bounds, nodes: Array, period: float) -> list[float]:
    """Return where f is a multiple of `period`, or 0 where that is inf, between the nodes."""
    a, b = nodes[:-1], nodes[1:]
    found: list[float] = []
    while a.size:
        low, high, slope_low, slope_high = bounds(a, b)
        maybe = (low <= 0) & (high >= 0) if np.isinf(period) else np.floor(high / period) >= np.ceil(low / period)
        monotone = (slope_low > 0) | (slope_high < 0)
        narrow = b - a <= NARROW * b
        for x, y in zip(a[maybe & monotone], b[maybe & monotone], strict=True):
            found += _bracketed(f, float(x), float(y), period)
        found += [float(v) for v in ((a + b) / 2)[maybe & narrow & ~monotone]]
        a, b = a[maybe & ~monotone & ~narrow], b[maybe & ~monotone & ~narrow]
        middle = (a + b) / 2
        a, b = np.concatenate([a, middle]), np.concatenate([middle, b])
    return _apart(sorted(found))


def _bracketed(f: Callable[[Array], Array], a: float, b: float, period: float) -> list[float]:
    """Return where a function that is monotone between a and b is a multiple of `period`."""
    a, b = a * (1 + 4e-16), b * (1 - 4e-16)
    ends = f(np.array([a, b]))
    low, high = float(ends.min()), float(ends.max())
    levels = [0.0] if np.isinf(period) else period * np.arange(np.ceil(low / period), np.floor(high / period) + 1)
    return [
        float(brentq(lambda w, level=level: float(f(np.array([w]))[0] - level), a, b, xtol=1e-300, rtol=1e-14))
        for level in levels
        if low <= level <= high
    ]


def _apart(w: list[float]) -> list[float]:
    """Return rising frequencies without those that the same crossing gave twice."""
    return [v for k, v in enumerate(w) if k == 0 or v - w[k - 1] > 4 * NARROW * v]


def _nearest(factors: _Factors, nodes: Array, ends: Mapping[float, float]) -> tuple[float, float]:
    """Return the least |1 + L| and where it is, to TIGHT."""
    least, where = min((abs(1 + v), w) for w, v in ends.items())
    a, b = nodes[:-1], nodes[1:]
    while a.size:
        middle, half = (a + b) / 2, (b - a) / 2
        distance = np.abs(1 + factors.value(middle))
        if distance.min() < least:
            least, where = float(distance.min()), float(middle[distance.argmin()])
        slopes = np.maximum(*(np.maximum(*np.abs(s)) for s in (factors.phase_slope(a, b), factors.size_slope(a, b))))
        low, high = np.exp(np.minimum(factors.size_range(a, b), 700.0))
        with np.errstate(invalid="ignore"):
            lipschitz = np.nan_to_num(distance - half * np.sqrt(2) * slopes * high, nan=-np.inf)
        bound = np.maximum(lipschitz, np.maximum(low - 1, 1 - high))
        kept = (bound < least * (1 - TIGHT)) & (b - a > NARROW * b)
        a, b, middle = a[kept], b[kept], middle[kept]
        a, b = np.concatenate([a, middle]), np.concatenate([middle, b])
    return least, where
