"""H-infinity norm of a stable model in modal form, by branch and bound over frequency.

    M(w) = sum_k R_k / (v - p_k) + D,     v = i w  or  v = exp(i w)

Between two frequencies M differs from the straight line through its values there by at most h^2/8 max |M''|, and the
singular value is convex: over an interval of length h

    sigma_max(M) <= max of both ends + h^2/8 sum_k |R_k| k_k + the modes' error

with k_k >= |d^2/dw^2 1/(v - p_k)|: 2/|v - p_k|^3 on the axis, |v + p_k|/|v - p_k|^3 on the circle, at the point of the
interval closest to p_k. The frequencies of the poles divide the axis, which puts this point at an end. Far above the
fastest pole the variable is x = 1/w, with 2 |p_k| / |i - p_k x|^3. An interval whose bound exceeds the level
(1 + e) max sigma is subdivided, into a number of pieces that follows from the bound. A sweep treats all intervals at
once.
"""

from dataclasses import dataclass, replace

import numpy as np

from synth.analyse import climb, modal
from synth.analyse.modal import EPS, Modes
from synth.statespace import Array, Complex

SWEEPS = 40
MAX_INTERVALS = 20_000  # intervals of one sweep: above it the response is too flat for this method
ENTRIES = 2**20  # intervals times poles, likewise
RATIO = 1.6  # of the distances of the first cuts from the peak
TINY = 1e-300
PIECES = 8  # of a subdivided interval, at most
LEVELS = (1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 1e-1)  # e, relative
AXIS_END = 20.0  # times the fastest pole: the end of the axis
FROBENIUS_RANGE = 0.7  # of the level: below it the Frobenius norm serves as the singular value
UP = 1 + 1e-12  # covers the rounding of singular values and of the bound


@dataclass(frozen=True, eq=False)
class Bound:
    """`value` is attained at `w` rad/s or rad, and sigma_max <= (1 + margin) value everywhere."""

    value: float
    w: float
    margin: float


@dataclass(frozen=True, eq=False)
class Axis:
    """The axis from 0 to AXIS_END times the fastest pole, or the half circle."""

    modes: Modes

    def edges(self) -> Array:
        """Return the frequencies that divide the axis: its ends and the poles' frequencies."""
        poles = self.modes.poles[self.modes.poles.imag >= 0]
        w = np.abs(np.angle(poles)) if self.modes.sampled else poles.imag
        return np.sort(np.concatenate([[0.0, _end(self.modes)], w]))

    def frequency(self, w: float) -> float:
        """Return w."""
        return w

    def inverses(self, w: Array) -> tuple[Complex, Array]:
        """Return 1/(v - p) (k, n), and a bound of its size."""
        v = np.exp(1j * w) if self.modes.sampled else 1j * w
        Z = v[:, None] - self.modes.poles
        square = Z.real**2 + Z.imag**2
        size = 1 / (np.sqrt(square) - (16 * EPS if self.modes.sampled else 0.0))
        Z.real /= square
        Z.imag /= -square
        return Z, size

    def curvature(self, a: Array, b: Array, size: Array) -> Array:
        """Return a bound (k,) of |M''| over intervals a .. b, in which 1/|v - p| is at most `size` (k, n)."""
        return np.asarray((size * size * size) @ (2 * self.modes.sizes))


@dataclass(frozen=True, eq=False)
class Distance:
    """x = 1/w from 0 (infinite frequency) to the end of the axis."""

    modes: Modes

    def frequency(self, x: float) -> float:
        """Return 1/x."""
        return 1 / x if x else np.inf

    def inverses(self, x: Array) -> tuple[Complex, Array]:
        """Return 1/(v - p) (k, n), and a bound of its size up to x."""
        p, x = self.modes.poles, x[:, None]
        return x / (1j - p * x), x / (1 - np.abs(p) * x) * UP

    def curvature(self, a: Array, b: Array, size: Array) -> Array:
        """Return a bound (k,) of |M''| over intervals a .. b."""
        p = np.abs(self.modes.poles)
        return np.asarray((1 - p * b[:, None]) ** -3 @ (2 * p * self.modes.sizes))


def peak(modes: Modes) -> Bound | None:
    """Return the peak with the least margin that can be proved; None if none can."""
    axis = Axis(modes)
    edges = axis.edges()
    start = _start(axis, edges)
    if not 1 / modal.MAX_MAGNITUDE < start.value < modal.MAX_MAGNITUDE:
        return None
    bound = _prove(axis, _refine_edges(axis, edges, start), start)
    if bound is None or modes.sampled or _bound_beyond(modes) < (1 + bound.margin) * bound.value:
        return bound
    return _prove(Distance(modes), np.array([0.0, 1 / edges[-1] * (1 + 4 * EPS)]), bound)  # 4 EPS: the ranges overlap


def _bound_beyond(modes: Modes) -> float:
    """Return a bound of sigma_max beyond the end of the axis."""
    size = UP / (_end(modes) - np.abs(modes.poles))
    return float(size @ modes.sizes + modes.error(size[None])[0] + np.linalg.norm(modes.D)) * UP


def _refine_edges(axis: Axis, edges: Array, bound: Bound) -> Array:
    """Return the edges with more points around the peak, denser close to it."""
    if not bound.w < edges[-1]:
        return edges
    w = np.array([bound.w])
    curvature = float(axis.curvature(w, w, axis.inverses(w)[1])[0])
    least = np.sqrt(4 * bound.margin * bound.value / max(curvature, TINY))
    if not 0 < least < edges[-1]:
        return edges
    offsets = np.exp(np.arange(np.log(least), np.log(edges[-1]), np.log(RATIO)))
    around = np.concatenate([bound.w - offsets, w, bound.w + offsets])
    return np.sort(np.concatenate([edges, around[(around > 0) & (around < edges[-1])]]))


def error(modes: Modes, w: float) -> float:
    """Return a bound of the error of the response's value at w."""
    return 0.0 if np.isinf(w) else 2 * float(modes.error(Axis(modes).inverses(np.array([w]))[1])[0])


def _start(axis: Axis, w: Array) -> Bound:
    """Return the local maximum from the best of the frequencies w (k,) and infinity."""
    modes = axis.modes
    M = modes.response(axis.inverses(w)[0])
    if not modes.sampled:
        w, M = np.append(w, np.inf), np.concatenate([M, modes.D[None]])
    return _climb(modes, float(w[_gains(M, 0.0).argmax()]), LEVELS[0])


def _end(modes: Modes) -> float:
    """Return the end of the axis; for a sampled model pi, rounded up."""
    return float(np.nextafter(np.pi, 4.0)) if modes.sampled else AXIS_END * float(np.abs(modes.poles).max())


def _climb(modes: Modes, w: float, margin: float) -> Bound:
    """Return the local maximum near w, by Newton's method."""
    if np.isinf(w):
        return Bound(float(np.linalg.norm(modes.D, 2)), w, margin)
    value, w = climb.local_maximum(lambda at: _derivatives(modes, at), w)
    return Bound(value, min(w, 2 * np.pi - w) if modes.sampled else w, margin)


def _derivatives(modes: Modes, w: float) -> tuple[Complex, Complex, Complex]:
    """Return M and its first two derivatives (p, m) at w."""
    Z = Axis(modes).inverses(np.array([w]))[0]
    if modes.sampled:
        v = np.exp(1j * w)
        first = -1j * v * Z * Z
        second = -1j * (v + modes.poles) * first * Z
    else:
        first = -1j * Z * Z
        second = -2j * first * Z
    M = np.concatenate([Z, first, second]) @ modes.residues
    M = M.reshape(3, *modes.D.shape)
    return M[0] + modes.D, M[1], M[2]


def _prove(chart: Axis | Distance, edges: Array, bound: Bound) -> Bound | None:
    """Return a bound that also holds between the edges; None if the sweeps or the margins do not suffice."""
    a, b, t = edges[:-1], edges[1:], edges
    first, second = slice(-1), slice(1, None)
    for _ in range(SWEEPS):
        Z, size = chart.inverses(t)
        values = _gains(chart.modes.response(Z), FROBENIUS_RANGE * bound.value)
        if values.max() > bound.value * (1 + bound.margin / 4):
            bound = _climb(chart.modes, chart.frequency(float(t[values.argmax()])), bound.margin)
        size = np.maximum(size[first], size[second])
        ends = np.maximum(values[first], values[second]) * UP + 2 * chart.modes.error(size)
        raised = _raise_margin(bound, float(ends.max()))
        if raised is None:
            return None
        bound = raised
        slack = (1 + bound.margin) * bound.value - ends
        interpolation = (b - a) ** 2 * chart.curvature(a, b, size) * (UP / 8)
        open_intervals = ~(interpolation <= slack)
        if not open_intervals.any():
            return bound
        a, b = _subdivide(
            a[open_intervals], b[open_intervals], np.sqrt(interpolation[open_intervals] / slack[open_intervals])
        )
        if len(a) > min(MAX_INTERVALS, ENTRIES // len(chart.modes.poles)):
            return None
        t, first, second = np.concatenate([a, b]), slice(len(a)), slice(len(a), None)
    return None


def _raise_margin(bound: Bound, highest: float) -> Bound | None:
    """Return the bound with the least margin that lies clear above the `highest` end; None without one."""
    for margin in LEVELS:
        if margin >= bound.margin and highest < (1 + 0.9 * margin) * bound.value:
            return replace(bound, margin=margin)
    return None


def _subdivide(a: Array, b: Array, asked: Array) -> tuple[Array, Array]:
    """Return the intervals a .. b, each divided into about `asked` pieces."""
    count = np.maximum(np.where(asked < PIECES, np.ceil(asked), PIECES), 2).astype(np.intp)
    place = np.arange(count.sum()) - np.repeat(np.cumsum(count) - count, count)
    a, b, count = np.repeat(a, count), np.repeat(b, count), np.repeat(count, count)
    return a + (b - a) * (place / count), np.where(place + 1 < count, a + (b - a) * ((place + 1) / count), b)


def _gains(M: Complex, small: float) -> Array:
    """Return sigma_max of each M (k, p, m), or an upper bound if it is below `small`."""
    if min(M.shape[1:]) > 2:
        values = np.sqrt((M.real**2 + M.imag**2).sum(axis=(1, 2)))
        large = ~(values <= small)
        values[large] = np.linalg.svd(M[large], compute_uv=False)[:, 0]
        return np.asarray(values, dtype=np.float64)
    if M.shape[1] > M.shape[2]:
        M = M.transpose(0, 2, 1)
    square = (M.real**2 + M.imag**2).sum(axis=2)  # the diagonal of M M^H
    if M.shape[1] == 1:
        return np.asarray(np.sqrt(square[:, 0]), dtype=np.float64)
    other = np.abs((M[:, 0] * M[:, 1].conj()).sum(axis=1))
    x, y = square.T
    return np.asarray(np.sqrt((x + y) / 2 + np.hypot((x - y) / 2, other)), dtype=np.float64)
