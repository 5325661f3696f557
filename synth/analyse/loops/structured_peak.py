"""Peak of the structured singular value of a stable model over all frequencies, proved between grid points as well.

    M(s) = C (s I - A)^-1 B + D, (p, p),        peak = max over 0 <= w <= inf of mu(M(i w))

mu is bounded as in `structured_singular_value`, first on a grid that is dense at lightly damped poles. Between the
grid points, the scaling D of one point is used: sigma_max(D M(i w) D^-1) crosses a level g only where i w is an
eigenvalue of the Hamiltonian (Boyd, Balakrishnan, Kabamba 1989)

    [  F   G  ]       F = A + B R^-1 D'C,     G = B R^-1 B',     Q = C'(I + D R^-1 D')C,     R = g^2 I - D'D
    [ -Q  -F' ]

with scaled B, C and D. These eigenvalues divide the axis into intervals on each of which the bound is entirely below
or above g. Intervals below g are finished; the others get the scaling of
another point, until none remains. If a point there exceeds the peak, it becomes the peak. If another scaling gains
little because two singular values meet, the level rises step by step.

Of several models, the largest peak is computed alone. The same method shows that the others are below its level; models
that differ little need the same few scalings.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from synth.analyse.loops import structured_singular_value as ssv
from synth.analyse.loops import transfer
from synth.analyse.loops.transfer import SchurResponse
from synth.statespace import Array, Complex, StateSpace

Interval = tuple[float, float]
GRID_TOLERANCE, FINAL_TOLERANCE = 1e-2, 1e-8  # relative, of coarse bounds and of those at the points that decide
GRID = np.linspace(0.0, 1.0, 120)
AT_ONCE = 8  # bounds that are minimised together: so many take little longer than one
CLEAR = 1e-3  # of the peak: a bound that is so far below it is low enough
CLIMBS, RISE = 2, 1e-7  # rounds towards the peak, and the least relative rise of one that another follows
# (count, e): number of eigenvalue problems for the level (1 + e) peak before the next e is used.
PROOFS = 12  # scalings at most by which a model that is below a level needs more than those before it
LEVELS = ((4, 1e-6), (4, 1e-5), (4, 1e-4), (48, 1e-3), (16, 1e-2), (16, 1e-1))


@dataclass(frozen=True, eq=False)
class Peak:
    """mu(M(i w)) <= `level` at all w, when `certified`; `lower` = mu's lower bound at `frequency`, with its `delta`.

    `frequencies` (k,) in rad/s and `bounds` (k,) are the points and the upper bounds of mu there.
    """

    level: float
    certified: bool
    lower: float
    delta: Complex
    frequency: float
    frequencies: Array
    bounds: Array


@dataclass(eq=False)
class _Points:
    """Frequencies with M, the bound and its scaling; `fine` marks bounds that are fully minimised."""

    w: Array
    M: Complex
    bound: Array
    scaling: Array
    fine: NDArray[np.bool_]

    def refine(self, places: NDArray[np.intp], enough: float = 0.0) -> None:
        """Minimise the bounds at points, down to `enough`."""
        upper = ssv.upper(self.M[places], FINAL_TOLERANCE, enough)
        self.bound[places], self.scaling[places], self.fine[places] = upper.value, upper.scaling, True

    def add(self, M: SchurResponse, frequencies: Array) -> None:
        """Add frequencies, with coarse bounds."""
        new = _points(M, frequencies)
        for name in ("w", "M", "bound", "scaling", "fine"):
            setattr(self, name, np.concatenate([getattr(self, name), getattr(new, name)]))

    def highest(self, inside: NDArray[np.bool_], above: float = 0.0) -> int:
        """Return the point with the highest bound among those inside; it is fine if it is `above` a level."""
        places = np.flatnonzero(inside)
        while not self.fine[k := int(places[self.bound[places].argmax()])] and self.bound[k] >= above:
            candidates = places[~self.fine[places] & (self.bound[places] >= (1 - GRID_TOLERANCE) * self.bound[k])]
            self.refine(candidates[np.argsort(-self.bound[candidates], kind="stable")[:AT_ONCE]], above)
        return k


def _points(M: SchurResponse, frequencies: Array) -> _Points:
    response = M.at(frequencies)
    upper = ssv.upper(response, GRID_TOLERANCE)
    is_scalar = response.shape[1:] == (1, 1)  # whose bound is exact
    return _Points(frequencies, response, upper.value, upper.scaling, np.full(len(frequencies), is_scalar))


def over_frequency(model: StateSpace, certify: bool = True) -> Peak:
    """Return the largest mu of a stable model (p, p) over all frequencies.

    Without `certify`, it is the largest on the grid and on more points around its peak.
    """
    M = transfer.schur_response(model)
    return _peak(M, certify)


def largest(models: Sequence[StateSpace], level: float) -> tuple[int, Peak] | None:
    """Return which of some stable models has the largest peak above a level, and this peak; None where none has.

    The peaks of the other models are proved to be no larger, but not computed.
    """
    best: tuple[int, Peak] | None = None
    scalings: dict[int, list[Array]] = {len(model.inputs): [] for model in models}
    responses = [transfer.schur_response(model) for model in models]
    points = [_balanced(M) for M in responses]
    for k in sorted(range(len(models)), key=lambda k: -float(points[k].bound.max())):
        if not (level and _is_below(responses[k], points[k], level, scalings[len(models[k].inputs)])):
            peak = _peak(responses[k], certify=True)
            if peak.level > level:
                best, level = (k, peak), peak.level
    return best


def _balanced(M: SchurResponse) -> _Points:
    """Return the points of the grid with the bounds of balancing alone."""
    w = grid(M.poles)
    response = M.at(w)
    scaling = ssv.osborne_scaling(response)
    is_scalar = response.shape[1:] == (1, 1)
    return _Points(w, response, ssv.gain(response, scaling), scaling, np.full(len(w), is_scalar))


def _is_below(M: SchurResponse, points: _Points, level: float, scalings: list[Array]) -> bool:
    """Tell whether mu is proved to be below a level at all frequencies: by `scalings`, to which others are added."""
    level /= 1 + 2 * _rounding(M, points, [int(points.bound.argmax())])
    undecided, known = [(0.0, np.inf)], len(scalings)
    for k in range(known + PROOFS):
        if k >= known:
            place = _highest_inside(M, points, undecided[-1], (1 - CLEAR) * level)
            if points.bound[place] > level:
                return False
            scalings.append(points.scaling[place])
        undecided = _above(M, scalings[k], level, undecided)
        if not undecided:
            return True
    return False


def _peak(M: SchurResponse, certify: bool) -> Peak:
    points = _points(M, grid(M.poles))
    _climb(M, points)
    top = points.highest(points.w >= 0)
    level, certified = _prove(M, points) if certify else (float(points.bound[top]), False)
    highest = _highest(points)
    level *= 1 + 2 * _rounding(M, points, highest)
    best, at = ssv.Lower(-1.0, np.zeros(0, dtype=np.complex128)), 0
    enough = (1 - FINAL_TOLERANCE) * float(points.bound.max())
    for k in highest:
        lower = ssv.lower(points.M[k], enough)
        if lower.value > best.value and (0 < points.w[k] < np.inf or _is_real(lower.delta)):
            best, at = lower, k
        if best.value >= enough:
            break  # no other point has more
    order, w = np.argsort(points.w), M.unwarped(points.w)
    return Peak(level, certified, best.value, best.delta, float(w[at]), w[order], points.bound[order])


def _rounding(M: SchurResponse, points: _Points, places: Sequence[int]) -> float:
    """Return the largest relative rounding error of sigma_max(D M D^-1) at points."""
    gains = ssv.gain(M.error(points.w[places], points.M[places]), points.scaling[places])
    return float((gains / np.maximum(points.bound[places], 1e-300)).max())


def grid(poles: Complex) -> Array:
    """Return 0, frequencies in rad/s from below to above all poles, dense at lightly damped ones, and inf."""
    if not len(poles):
        return np.array([0.0, 1.0, np.inf])
    size = np.abs(poles)
    low, high = 1e-3 * max(float(size.min()), 1e-12 * float(size.max())), 1e3 * float(size.max())
    around = poles.imag[:, None] + np.abs(poles.real)[:, None] * np.array([-3.0, -1.0, -0.3, 0.0, 0.3, 1.0, 3.0])
    return np.unique(np.concatenate([[0.0, np.inf], low * (high / low) ** GRID, around[around > low]]))


def _climb(M: SchurResponse, points: _Points) -> None:
    """Add points around the highest one, closer each round, as long as the bound there rises."""
    peak = 0.0
    for _ in range(CLIMBS):
        k = points.highest(points.w >= 0)
        w, bound = points.w[k], points.bound[k]
        if np.isinf(w) or bound <= (1 + RISE) * peak:
            return
        peak = bound
        order = np.argsort(points.w)
        place = int(np.searchsorted(points.w[order], w))
        sides = [int(i) for i in (*order[max(place - 1, 0) : place], *order[place + 1 : place + 2])]
        ends = [points.w[i] for i in sides if np.isfinite(points.w[i]) and w > 0]
        if not ends:
            return
        new = [w + (end - w) * np.array([0.1, 0.3, 0.6]) for end in ends]
        if len(ends) == 2:
            new.append(_vertex(points.w[[sides[0], k, sides[1]]], points.bound[[sides[0], k, sides[1]]]))
        points.add(M, np.concatenate(new))
        coarse = np.arange(len(points.w) - sum(map(len, new)), len(points.w))
        if not points.fine[coarse].all():
            points.refine(coarse)


def _vertex(w: Array, bound: Array) -> Array:
    """Return where the parabola through three points is highest, none where it is straight or that is a point."""
    below, above = (bound[1] - bound[0]) / (w[1] - w[0]), (bound[2] - bound[1]) / (w[2] - w[1])
    if not above < below:
        return np.zeros(0)
    vertex = (w[0] + w[1]) / 2 + below * (w[2] - w[0]) / (2 * (below - above))
    return np.array([vertex]) if w[0] < vertex < w[2] and vertex != w[1] else np.zeros(0)


def _highest(points: _Points, count: int = 3) -> list[int]:
    """Return the highest points and, if one is an end of the axis, its neighbour as well.

    At an end the response of a real system is real, and a complex delta of mu cannot be realised there.
    """
    places = np.flatnonzero(points.fine)
    places = places[np.argsort(-points.bound[places], kind="stable")[:count]]
    inner = np.flatnonzero((points.w > 0) & np.isfinite(points.w))
    beside = [inner[points.w[inner].argmin()]] if (points.w[places] == 0).any() else []
    beside += [inner[points.w[inner].argmax()]] if np.isinf(points.w[places]).any() else []
    return [int(k) for k in (*places, *beside)]


def _is_real(delta: Complex) -> bool:
    """Tell whether a system with real coefficients can have these values at an end of the axis."""
    return bool((np.abs(delta.imag) <= 1e-9 * np.abs(delta)).all())


def _prove(M: SchurResponse, points: _Points) -> tuple[float, bool]:
    """Return an upper bound of mu over frequency, and whether it is proved for all frequencies."""
    peak, undecided = float(points.bound[points.highest(points.w >= 0)]), [(0.0, np.inf)]
    if not peak:
        return 0.0, True  # M vanishes at more points than it has poles: M = 0
    for margin in (e for count, e in LEVELS for _ in range(count)):
        while True:
            k = _highest_inside(M, points, undecided[-1], (1 - CLEAR) * peak)
            if points.bound[k] <= peak:
                break
            peak = float(points.bound[k])
        level = (1 + margin) * peak
        undecided += _above(M, points.scaling[k], level, [undecided.pop()])
        if not undecided:
            return level, True
    return peak, False


def _highest_inside(M: SchurResponse, points: _Points, interval: Interval, above: float) -> int:
    """Return the highest point inside the interval, or a new one in its middle, fine if it is `above` a level."""
    a, b = interval
    inside = ((points.w > a) & (points.w < b)) | ((points.w == a) & (a == 0)) | ((points.w == b) & np.isinf(b))
    if not inside.any():
        points.add(M, np.array([0.5 * (a + b) if np.isfinite(b) else 2 * a]))
        inside = np.arange(len(points.w)) == len(points.w) - 1
    return points.highest(inside, above)


def _above(M: SchurResponse, x: Array, level: float, intervals: Sequence[Interval]) -> list[Interval]:
    """Return the parts of the intervals where sigma_max(D M D^-1) is not below the level."""
    crossings = np.unique(np.abs(hamiltonian_eigenvalues(M, x, level).imag))
    parts: list[Interval] = []
    for a, b in intervals:
        cuts = crossings[(crossings > a) & (crossings < b)]
        ends = np.concatenate([[a], cuts[np.append(np.diff(cuts) > 1e-12 * cuts[1:], True)[: len(cuts)]], [b]])
        middles = np.where(np.isinf(ends[1:]), 2 * ends[:-1] + M.size, 0.5 * (ends[:-1] + ends[1:]))
        below = ssv.gain(M.at(middles), x) < level
        first = len(parts)
        for low, high, done in zip(ends[:-1], ends[1:], below, strict=True):
            if not done and len(parts) > first and parts[-1][1] == low:
                parts[-1] = (parts[-1][0], float(high))
            elif not done:
                parts.append((float(low), float(high)))
    return parts


def hamiltonian_eigenvalues(M: SchurResponse, x: Array, level: float) -> Complex:
    """Return s (2 n,), including each i w where `level` is a singular value of D M(i w) D^-1, D^2 = diag(x)."""
    d = np.sqrt(x)
    A, B, C, D = M.A, M.B / d, M.C * d[:, None], M.D * d[:, None] / d
    n = len(A)
    K = np.linalg.solve(level**2 * np.eye(len(d)) - D.T @ D, np.hstack([D.T @ C, B.T]))
    H = np.empty((2 * n, 2 * n))
    F = np.add(A, B @ K[:, :n], out=H[:n, :n])
    H[:n, n:], H[n:, :n], H[n:, n:] = B @ K[:, n:], -C.T @ (C + D @ K[:, :n]), -F.T
    return np.asarray(np.linalg.eigvals(H), dtype=np.complex128)
