"""The largest singular value of a stable model's response over all frequencies, by its modes, with branch and bound.

    M(w) = sum_k R_k / (v - p_k) + D,     v = i w  or  v = exp(i w)

Between two frequencies M differs from the straight line through its values there by at most h^2/8 max |M''|, and the
singular value is convex: over an interval of length h

    sigma_max(M) <= max of both ends + h^2/8 sum_k |R_k| k_k + the modes' error

with k_k >= |d^2/dw^2 1/(v - p_k)|: 2/|v - p_k|^3 on the axis, |v + p_k|/|v - p_k|^3 on the circle, where p_k is nearest.
The poles' frequencies cut the axis, so that this is at one of the ends. Beyond twice the fastest pole the variable is
x = 1/w, with 2 |p_k| / |i - p_k x|^3. An interval in which the bound passes the level (1 + e) max sigma is cut into as
many as the bound asks for. All intervals of a sweep are treated at once.
"""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from synth.analyse import climb
from synth.analyse.modal import EPS, Complex, Modes
from synth.statespace import Array

SWEEPS = 40
MOST = 20_000  # intervals of one sweep: beyond, the level is too flat to be proved so
RATIO = 1.6  # of the distances of the first cuts from the peak
TINY = 1e-300
PIECES = 8  # of an interval, at most
LEVELS = (1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 1e-1)  # e, relative
SMALL = 0.7  # of the level: below it the Frobenius norm serves as the singular value
UP = 1 + 1e-12  # covers the rounding of singular values and of the bound


@dataclass(frozen=True, eq=False)
class Bound:
    """`value` is attained at `w` rad/s or rad, and nothing passes (1 + margin) value."""

    value: float
    w: float
    margin: float


@dataclass(frozen=True, eq=False)
class Axis:
    """The axis from 0 to twice the fastest pole, or the half circle."""

    modes: Modes

    def edges(self) -> Array:
        """Return the frequencies that cut the axis: the ends and those of the poles."""
        poles = self.modes.poles
        w = np.abs(np.angle(poles)) if self.modes.sampled else np.abs(poles.imag)
        return np.unique(np.concatenate([[0.0], w, [_end(self.modes)]]))

    def frequency(self, w: float) -> float:
        """Return w."""
        return w

    def inverses(self, w: Array) -> tuple[Complex, Array]:
        """Return 1/(v - p) (k, n), and a bound of its size."""
        v = np.exp(1j * w) if self.modes.sampled else 1j * w
        Z = v[:, None] - self.modes.poles
        square = Z.real**2 + Z.imag**2
        size = 1 / (np.sqrt(square) - (16 * EPS if self.modes.sampled else 0.0))
        np.conj(Z, out=Z)
        Z /= square
        return Z, size

    def bend(self, a: Array, b: Array, size: Array) -> Array:
        """Return a bound (k,) of |M''| over intervals a .. b, in which 1/|v - p| is at most `size` (k, n)."""
        return np.asarray(size**3 @ (2 * self.modes.sizes))


@dataclass(frozen=True, eq=False)
class Distance:
    """x = 1/w from 0, which is infinity, to the end of the axis."""

    modes: Modes

    def edges(self) -> Array:
        """Return both ends."""
        return np.array([0.0, 1 / _end(self.modes)])

    def frequency(self, x: float) -> float:
        """Return 1/x."""
        return 1 / x if x else np.inf

    def inverses(self, x: Array) -> tuple[Complex, Array]:
        """Return 1/(v - p) (k, n), and a bound of its size up to x."""
        p, x = self.modes.poles, x[:, None]
        return x / (1j - p * x), x / (1 - np.abs(p) * x) * UP

    def bend(self, a: Array, b: Array, size: Array) -> Array:
        """Return a bound (k,) of |M''| over intervals a .. b."""
        p = np.abs(self.modes.poles)
        return np.asarray((1 - p * b[:, None]) ** -3 @ (2 * p * self.modes.sizes))


def peak(modes: Modes) -> Bound | None:
    """Return the peak, proved to the least of the margins for which that is possible; None where there is none."""
    charts = (Axis(modes),) if modes.sampled else (Axis(modes), Distance(modes))
    bound: Bound | None = _start(modes)
    for chart in charts:
        bound = bound and _covered(chart, bound)
    return bound


def _edges(chart: Axis | Distance, bound: Bound) -> Array:
    """Return the first cuts of a chart: its own, and some around the peak, the closer the nearer to it."""
    edges = chart.edges()
    if not bound.w < edges[-1] or isinstance(chart, Distance):
        return edges
    w = np.array([bound.w])
    size = chart.inverses(w)[1]
    least = np.sqrt(4 * bound.margin * bound.value / max(float(chart.bend(w, w, size)[0]), TINY))
    if not 0 < least < edges[-1]:
        return edges
    apart = np.exp(np.arange(np.log(least), np.log(edges[-1]), np.log(RATIO)))
    around = np.concatenate([bound.w - apart, w, bound.w + apart])
    return np.unique(np.concatenate([edges, around[(around > 0) & (around < edges[-1])]]))


def error(modes: Modes, w: float) -> float:
    """Return a bound of the error of the response's value at w."""
    return 0.0 if np.isinf(w) else 2 * float(modes.error(Axis(modes).inverses(np.array([w]))[1])[0])


def _start(modes: Modes) -> Bound:
    """Return the local maximum that is found from the best of the poles' frequencies, 0 and infinity."""
    w = Axis(modes).edges()
    M = modes.response(Axis(modes).inverses(w)[0])
    if not modes.sampled:
        w, M = np.append(w, np.inf), np.concatenate([M, modes.D[None]])
    values = np.linalg.svd(M, compute_uv=False)[:, 0]
    return _climbed(modes, float(w[values.argmax()]), LEVELS[0])


def _end(modes: Modes) -> float:
    return np.pi if modes.sampled else 2 * float(np.abs(modes.poles).max())


def _climbed(modes: Modes, w: float, margin: float) -> Bound:
    """Return the local maximum near w, by Newton's method."""
    if np.isinf(w):
        return Bound(float(np.linalg.norm(modes.D, 2)), w, margin)
    value, w = climb.climb(lambda at: _derivatives(modes, at), w)
    return Bound(value, w, margin)


def _derivatives(modes: Modes, w: float) -> tuple[Complex, Complex, Complex]:
    """Return M and its first two derivatives (p, m) at w."""
    Z = Axis(modes).inverses(np.array([w]))[0]
    if modes.sampled:
        v = np.exp(1j * w)
        first, second = -1j * v * Z**2, -v * (v + modes.poles) * Z**3
    else:
        first, second = -1j * Z**2, -2 * Z**3
    M = np.concatenate([Z, first, second]) @ modes.residues
    M = M.reshape(3, *modes.D.shape)
    return M[0] + modes.D, M[1], M[2]


def _covered(chart: Axis | Distance, bound: Bound) -> Bound | None:
    """Return the bound that holds on the chart too."""
    edges = _edges(chart, bound)
    a, b = edges[:-1], edges[1:]
    for _ in range(SWEEPS):
        t, k = np.concatenate([a, b]), len(a)
        Z, size = chart.inverses(t)
        size = np.maximum(size[:k], size[k:])
        values = _values(chart.modes.response(Z), SMALL * bound.value)
        if values.max() > bound.value * (1 + bound.margin / 4):
            bound = _climbed(chart.modes, chart.frequency(float(t[values.argmax()])), bound.margin)
        ends = np.maximum(values[:k], values[k:]) * UP + 2 * chart.modes.error(size)
        proved = _raised(bound, float(ends.max()))
        if proved is None:
            return None
        bound = proved
        slack = (1 + bound.margin) * bound.value - ends
        bow = (b - a) ** 2 * chart.bend(a, b, size) * (UP / 8)
        left = ~(bow <= slack)
        if not left.any():
            return bound
        a, b = _cut(a[left], b[left], np.sqrt(bow[left] / slack[left]))
        if len(a) > MOST:
            return None
    return None


def _raised(bound: Bound, highest: float) -> Bound | None:
    """Return the bound with the least margin that leaves room above the `highest` end; None where none does."""
    for margin in LEVELS:
        if margin >= bound.margin and highest < (1 + 0.9 * margin) * bound.value:
            return replace(bound, margin=margin)
    return None


def _cut(a: Array, b: Array, asked: Array) -> tuple[Array, Array]:
    """Return the intervals a .. b, each cut into about as many as are asked for."""
    count = np.maximum(np.where(asked < PIECES, np.ceil(asked), PIECES), 2).astype(np.intp)
    place = np.arange(count.sum()) - np.repeat(np.cumsum(count) - count, count)
    a, b, count = np.repeat(a, count), np.repeat(b, count), np.repeat(count, count)
    return a + (b - a) * (place / count), np.where(place + 1 < count, a + (b - a) * ((place + 1) / count), b)


def _values(M: Complex, small: float) -> Array:
    """Return sigma_max of each M (k, p, m), or where it is small a bound."""
    values = np.sqrt((M.real**2 + M.imag**2).sum(axis=(1, 2)))
    if min(M.shape[1:]) > 1:
        large = ~(values <= small)
        values[large] = np.linalg.svd(M[large], compute_uv=False)[:, 0]
    return np.asarray(values, dtype=np.float64)
