"""Root of a nonlinear system nearest the origin: many starts, a descent along the roots, and Newton's method.

    minimise  |z|^2   subject to   f(z) = 0,     z (n,), f (k,), n and k any

f may have several roots, a continuum of them where J = df/dz has a null space, none, and no value outside its domain.

Method. Each start goes to a root by the Levenberg-Marquardt method; a step that leaves the set where f and J are finite
is shortened. A root is then moved along the set of roots while that brings it nearer, by the steps of the problem
linearised at z (Hasofer and Lind, ASCE J. Eng. Mech. 100 (1974) 111; Rackwitz and Fiessler, Comput. Struct. 9 (1978)
489),

    z + d = J^+ (J z - f),

each followed by a return to f = 0. Newton's method on the conditions of stationarity, J^T l + z = 0 and f = 0, gives
the last digits; where it succeeds at once, the descent is spared. Only when every start has ended are the distances
compared. The starts are the origin and a low-discrepancy sequence (Roberts: multiples of powers of the positive root of
x^(n+1) = x + 1, modulo 1), first in the box, then in the part of the box that is nearer than the best root, until no
nearer root turns up.

The answer is the nearest of the roots that the starts reach: a root whose basin holds no start is not seen. Roots whose
distances differ by less than SAME_DISTANCE tie, and the first of them is the one with the larger value of the first
component in which they differ; rounding does not decide. Roots nearer each other than SAME_ROOT count as one.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Pair = tuple[Array, Array]

BOX_STARTS = 24
BALL_STARTS = 12  # in each round
BALL_ROUNDS = 8
SAME_DISTANCE = 1e-6  # of the distance: a root on a continuum is known to half the digits of its distance
SAME_ROOT = 1e-4  # a double root is known to the square root of the tolerance on f
MARQUARDT_STEPS = 100
SLIDING_STEPS = 40
NEWTON_STEPS = 20
DAMPING = (1e-3, 1e12)  # first and last, of |J|^2


@dataclass(frozen=True, eq=False)
class System:
    """f(z) = 0 and the box of its starts.

    `linear(z)` returns f (k,) and J (k, n), scaled so that |f_i| <= `tolerance` is a root; `stationary(z, l)` returns
    [J^T l + z; f] (n + k,) and its Jacobian (n + k, n + k). `low` <= 0 <= `high` (n,) bound the starts.
    """

    linear: Callable[[Array], Pair]
    stationary: Callable[[Array], Pair]
    low: Array
    high: Array
    tolerance: float

    def is_root(self, z: Array) -> bool:
        """Tell whether every equation is met at `z`."""
        return bool((np.abs(self.linear(z)[0]) <= self.tolerance).all())


@dataclass(frozen=True, eq=False)
class Search:
    """The nearest roots, all at one distance, the chosen one first; and the best point (n,) where none was found.

    `best` is None when f is finite at none of the starts.
    """

    roots: tuple[Array, ...]
    best: Array | None = None


def find(system: System) -> Search:
    """Return the roots nearest the origin of those that the starts reach."""
    n = len(system.low)
    origin = np.zeros(n)
    if system.is_root(origin):
        return Search((_polished(system, origin),))
    ends = [_descended(system, z) for z in (origin, *_points(system.low, system.high, 0, BOX_STARTS))]
    ends = [z for z in ends if np.isfinite(system.linear(z)[0]).all()]
    roots = _roots(system, ends)
    for k in range(BALL_ROUNDS if roots else 0):
        radius = _least_distance(roots)
        low, high = np.maximum(system.low, -radius), np.minimum(system.high, radius)
        points = _points(low, high, BOX_STARTS + k * BALL_STARTS, BALL_STARTS)
        roots += _roots(system, [_descended(system, z) for z in points])
        if _least_distance(roots) >= radius * (1 - SAME_DISTANCE):
            break
    best = min(ends, key=lambda z: float(np.abs(system.linear(z)[0]).max()), default=None)
    return Search(_nearest(roots), best)


def _points(low: Array, high: Array, first: int, count: int) -> Iterator[Array]:
    """Return points first + 1 .. first + count of Roberts' sequence in a box."""
    n = len(low)
    base = 2.0
    for _ in range(60):
        base = (1 + base) ** (1 / (n + 1))
    steps = base ** -np.arange(1.0, n + 1)
    return (low + (high - low) * ((0.5 + k * steps) % 1) for k in range(first + 1, first + count + 1))


def _roots(system: System, ends: Sequence[Array]) -> list[Array]:
    return [_settled(system, z) for z in ends if system.is_root(z)]


def _settled(system: System, root: Array) -> Array:
    """Return the stationary root that the descent from `root` leads to."""
    polished = _polished(system, root)
    return polished if polished is not root else _polished(system, _slid(system, root))


def _least_distance(roots: Sequence[Array]) -> float:
    return min(float(np.linalg.norm(z)) for z in roots)


def _nearest(roots: Sequence[Array]) -> tuple[Array, ...]:
    """Return the roots at the least distance, each once, ordered by their components, the larger first."""
    if not roots:
        return ()
    limit = _least_distance(roots) * (1 + SAME_DISTANCE)
    distinct: list[Array] = []
    for z in (z for z in roots if np.linalg.norm(z) <= limit):
        if all(np.abs(z - other).max() > SAME_ROOT for other in distinct):
            distinct.append(z)
    return tuple(sorted(distinct, key=lambda z: tuple(-np.round(z / SAME_ROOT))))


def _is_finite(pair: Pair) -> bool:
    f, J = pair
    return bool(np.isfinite(J).all() and np.isfinite(f @ f))


def _descended(system: System, z: Array) -> Array:
    """Return where the Levenberg-Marquardt method leads from `z`: a root, or a local minimum of |f|."""
    pair, damping = system.linear(z), DAMPING[0]
    if not _is_finite(pair):
        return z
    for _ in range(MARQUARDT_STEPS):
        f, J = pair
        size = float(np.linalg.norm(J))
        if size == 0 or damping > DAMPING[1]:
            break
        rows = np.vstack([J / size, np.sqrt(damping) * np.eye(len(z))])
        step = np.linalg.lstsq(rows, np.concatenate([-f / size, np.zeros(len(z))]), rcond=None)[0]
        tried = system.linear(z + step)
        if not _is_finite(tried) or tried[0] @ tried[0] >= f @ f:
            damping *= 10
        else:
            z, pair, damping = z + step, tried, max(damping / 10, 1e-15)
        if np.abs(step).max() < 1e-14 and system.is_root(z):
            break
    return z


def _slid(system: System, root: Array) -> Array:
    """Return a root that is nearer the origin, by steps along the set of roots, or `root`."""
    for _ in range(SLIDING_STEPS):
        f, J = system.linear(root)
        if not np.isfinite(J).all():
            break
        step = np.linalg.lstsq(J, J @ root - f, rcond=None)[0] - root
        length = np.linalg.norm(root)
        if np.linalg.norm(step) <= 1e-9 * length:
            break
        tried = (_restored(system, root + step / 2**k) for k in range(8))
        nearer = next((z for z in tried if np.linalg.norm(z) < length * (1 - 1e-12) and system.is_root(z)), None)
        if nearer is None:
            break
        root = nearer
    return root


def _restored(system: System, z: Array) -> Array:
    """Return the point after a few Gauss-Newton steps of least length to f = 0."""
    for _ in range(6):
        f, J = system.linear(z)
        if not _is_finite((f, J)) or system.is_root(z):
            break
        z = z - np.linalg.lstsq(J, f, rcond=None)[0]
    return z


def _polished(system: System, z: Array) -> Array:
    """Return the stationary point near the root `z`, or `z` itself where Newton's method leads to nothing nearer."""
    J = system.linear(z)[1]
    if not np.isfinite(J).all():
        return z
    w = np.concatenate([z, -np.linalg.lstsq(J.T, z, rcond=None)[0]])
    for _ in range(NEWTON_STEPS):
        conditions, slope = system.stationary(w)
        if not (np.isfinite(conditions).all() and np.isfinite(slope).all()):
            return z
        step = np.linalg.lstsq(slope, conditions, rcond=None)[0]
        w = w - step
        if np.abs(step[: len(z)]).max() < 1e-15:
            break
    polished = w[: len(z)]
    nearer = np.linalg.norm(polished) <= np.linalg.norm(z) * (1 + 1e-6) + 1e-12
    return polished if nearer and system.is_root(polished) else z
