"""Zero-pole-gain form of a scalar loop on the frequency axis, with bounds of log L over intervals.

With the zeros and poles r of a rational loop, its gain k, a delay tau and a hold T,

    log L(i w) = log k +- sum log(i w - r) - i w (tau + T/2) + log(sin(w T/2) / (w T/2)).

Each term and its slope have closed-form bounds over an interval of w. With them, branch and bound finds the least
|1 + L|: on an interval of half width h around w it is at least |1 + L(i w)| - h max |L'|.
"""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.optimize import minimize_scalar

from synth.analyse.loops import rational
from synth.analyse.loops.rational import Rational
from synth.statespace import Array

MIN_WIDTH = 1e-12  # of a frequency: the least width of an interval
BOUND_TOLERANCE = 1e-5  # of the least |1 + L|: tolerance of branch and bound
LOW_ASYMPTOTE = 1e-3  # of the least of all rates: below it the loop is its asymptote
HIGH_ASYMPTOTE = 1e3  # times the largest of all rates: above it the loop is its asymptote
GRID = 400  # intervals to begin with


@dataclass(frozen=True, eq=False)
class ZeroPoleGain:
    """log L: zeros (sign +1) and poles (sign -1) `roots` (m,), their `signs` (m,), log |k|, arg k, and times in s."""

    roots: NDArray[np.complex128]
    signs: Array
    log_k: float
    arg_k: float
    delay_s: float
    hold_s: float

    def log_gain(self, w: Array) -> Array:
        """Return log |L| at frequencies (k,)."""
        with np.errstate(divide="ignore"):
            distance = np.log(np.abs(1j * w[:, None] - self.roots))
            held = np.log(np.abs(np.sinc(w * self.hold_s / (2 * np.pi))))
        return np.asarray(self.log_k + distance @ self.signs + held)

    def phase(self, w: Array) -> Array:
        """Return arg L at frequencies (k,), continuous except at roots on the axis and zeros of the hold."""
        c, x = -self.roots.real, w[:, None] - self.roots.imag
        acute = np.arctan2(x, np.abs(c))
        angles = np.where(c < 0, np.pi - acute, acute)
        lobes = np.floor(w * self.hold_s / (2 * np.pi))
        return np.asarray(self.arg_k + angles @ self.signs - w * self.delay_s + np.pi * lobes)

    def value(self, frequencies: ArrayLike) -> NDArray[np.complex128]:
        """Return L at frequencies (k,)."""
        w = np.atleast_1d(np.asarray(frequencies, dtype=np.float64))
        return np.asarray(np.exp(self.log_gain(w) + 1j * self.phase(w)))

    def phase_slope(self, a: Array, b: Array) -> tuple[Array, Array]:
        """Return bounds (k,) of d arg L / dw over intervals a .. b."""
        c, near, far = -self.roots.real, *self._distances(a, b)
        with np.errstate(divide="ignore", invalid="ignore"):
            ends = [np.where(c == 0, 0.0, self.signs * c / (c * c + x * x)) for x in (near, far)]
        low, high = np.minimum(*ends).sum(axis=1), np.maximum(*ends).sum(axis=1)
        return low - self.delay_s, high - self.delay_s

    def log_gain_slope(self, a: Array, b: Array) -> tuple[Array, Array]:
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
        held = self._hold_slope(a, b)
        return below + held[0], above + held[1]

    def log_gain_bounds(self, a: Array, b: Array) -> tuple[Array, Array]:
        """Return bounds (k,) of log |L| over intervals a .. b, from a bound of each factor."""
        near, far = self._distances(a, b)
        c = self.roots.real
        with np.errstate(divide="ignore"):
            low, high = (np.log(np.hypot(c, x)) for x in (near, far))
        rising, falling = self.signs > 0, self.signs < 0
        below = low[:, rising].sum(axis=1) - high[:, falling].sum(axis=1)
        above = high[:, rising].sum(axis=1) - low[:, falling].sum(axis=1)
        held = self._hold_bounds(a, b)
        return self.log_k + below + held[0], self.log_k + above + held[1]

    def _distances(self, a: Array, b: Array) -> tuple[Array, Array]:
        low, high = a[:, None] - self.roots.imag, b[:, None] - self.roots.imag
        near = np.where(low > 0, low, np.where(high < 0, -high, 0.0))
        return near, np.maximum(np.abs(low), np.abs(high))

    def _hold_slope(self, a: Array, b: Array) -> tuple[Array, Array]:
        """Return bounds of d log |sin x / x| / dw: cot x falls over each lobe; no interval extends over two lobes."""
        if not self.hold_s:
            return np.zeros(len(a)), np.zeros(len(a))
        x, y = self._inside_lobe(a, b)
        with np.errstate(divide="ignore", invalid="ignore"):
            low = np.where(y % np.pi == 0, -np.inf, 1 / np.tan(y)) - 1 / x
            high = 1 / np.tan(x) - 1 / y
        return low * self.hold_s / 2, high * self.hold_s / 2

    def _hold_bounds(self, a: Array, b: Array) -> tuple[Array, Array]:
        if not self.hold_s:
            return np.zeros(len(a)), np.zeros(len(a))
        x, y = self._inside_lobe(a, b)
        top = (np.floor(x / np.pi) + 0.5) * np.pi
        largest = np.where((x < top) & (top < y), 1.0, np.maximum(np.abs(np.sin(x)), np.abs(np.sin(y))))
        with np.errstate(divide="ignore"):
            low = np.log(np.minimum(np.abs(np.sin(x)), np.abs(np.sin(y))) / y)
            return low, np.minimum(np.log(largest / x), 0.0)

    def _inside_lobe(self, a: Array, b: Array) -> tuple[Array, Array]:
        return a * self.hold_s / 2 * (1 + 1e-15), b * self.hold_s / 2 * (1 - 1e-15)


def of_rational(loop: Rational, delay_s: float = 0.0, hold_s: float = 0.0) -> ZeroPoleGain:
    """Return the zero-pole-gain form of a rational loop other than 0.

    `delay_s` is its total delay, including half of its hold of `hold_s` seconds.
    """
    N, D = loop.lowest_terms
    zeros, poles = rational.zeros(N), rational.zeros(D)
    k = int(N[N.degree()]) / int(D[D.degree()])
    signs = np.concatenate([np.ones(len(zeros)), -np.ones(len(poles))])
    return ZeroPoleGain(np.concatenate([zeros, poles]), signs, float(np.log(abs(k))), np.pi * (k < 0), delay_s, hold_s)


def lowest_frequency(L: ZeroPoleGain) -> float:
    """Return a frequency below which the loop is its asymptote and |L| does not cross 1."""
    sizes = np.abs(L.roots)
    rates = [float(sizes[sizes > 0].min(initial=np.inf)), 1 / L.delay_s if L.delay_s else np.inf]
    lowest = LOW_ASYMPTOTE * (min(rates) if np.isfinite(min(rates)) else 1.0)
    slope = float(L.signs[sizes == 0].sum())
    if not slope:
        return lowest
    return min(lowest, lowest * float(np.exp(-L.log_gain(np.array([lowest]))[0] / slope)) / 10)


def frequency_grid(L: ZeroPoleGain, low: float, closed: NDArray[np.complex128] | None = None) -> Array:
    """Return frequencies from `low` up to one above which the loop without its hold is its asymptote and |L| != 1.

    The range also covers the `closed` poles, if given.
    """
    sizes = np.abs(L.roots if closed is None else np.concatenate([L.roots, closed[np.isfinite(closed)]]))
    top = max(
        HIGH_ASYMPTOTE * float(sizes.max(initial=0.0)),
        HIGH_ASYMPTOTE / L.delay_s if L.delay_s else 0.0,
        HIGH_ASYMPTOTE * low,
    )
    slope = float(L.signs.sum())
    if slope:
        size = float(replace(L, hold_s=0.0).log_gain(np.array([top]))[0])
        top *= max(1.0, 10 * float(np.exp(-size / slope)))
    peaks = L.roots.imag[(L.roots.imag > low) & (L.roots.imag < top)]
    return np.unique(np.concatenate([np.geomspace(low, top, GRID), peaks]))


def interval_ends(L: ZeroPoleGain, grid: Array, top: float, turning: bool) -> Array:
    """Return the ends of intervals: the grid, steps of the delay, roots on the axis and zeros of the hold."""
    on_axis = L.roots.imag[(L.roots.real == 0) & (L.roots.imag > 0)]
    ends = [grid, on_axis, np.array([top])]
    if turning:
        ends.append(np.arange(grid[0], top, 0.3 / L.delay_s))
    if L.hold_s and turning:
        ends.append(2 * np.pi / L.hold_s * np.arange(1, int(top * L.hold_s / (2 * np.pi)) + 1))
    w = np.unique(np.concatenate(ends))
    return np.asarray(w[(w >= grid[0]) & (w <= top)])


def least_distance(L: ZeroPoleGain, nodes: Array) -> tuple[float, float]:
    """Return the least |1 + L| between the nodes and its frequency, to a relative tolerance of BOUND_TOLERANCE."""
    least, where, width = np.inf, float(nodes[0]), 0.0
    a, b = nodes[:-1], nodes[1:]
    while a.size:
        middle, half = (a + b) / 2, (b - a) / 2
        distance = np.abs(1 + L.value(middle))
        if distance.min() < least:
            k = int(distance.argmin())
            least, where, width = float(distance[k]), float(middle[k]), float(half[k])
        slopes = np.maximum(*(np.maximum(*np.abs(s)) for s in (L.phase_slope(a, b), L.log_gain_slope(a, b))))
        low, high = np.exp(np.minimum(L.log_gain_bounds(a, b), 700.0))
        with np.errstate(invalid="ignore"):
            lipschitz = np.nan_to_num(distance - half * np.sqrt(2) * slopes * high, nan=-np.inf)
        bound = np.maximum(lipschitz, np.maximum(low - 1, 1 - high))
        kept = (bound < least * (1 - BOUND_TOLERANCE)) & (b - a > MIN_WIDTH * b)
        a, b, middle = a[kept], b[kept], middle[kept]
        a, b = np.concatenate([a, middle]), np.concatenate([middle, b])
    return _refine_minimum(L, least, where, width)


def _refine_minimum(L: ZeroPoleGain, least: float, where: float, width: float) -> tuple[float, float]:
    """Return the local minimum of |1 + L| within a width of `where`."""

    def distance(t: float) -> float:
        return float(np.abs(1 + L.value(np.array([where + width * t])))[0])

    minimum = minimize_scalar(distance, bounds=(-1, 1), method="bounded", options={"xatol": 1e-9})
    return (float(minimum.fun), float(where + width * minimum.x)) if minimum.fun < least else (least, where)
