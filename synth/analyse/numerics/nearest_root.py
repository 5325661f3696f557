"""Minimum-norm root of a nonlinear system: multistart, descent along the set of roots, and Newton's method.

    minimise  |z|^2   subject to   f(z) = 0,     z (n,), f (k,), n and k any

f may have several roots, a continuum of roots (if J = df/dz has a null space), or none, and may be undefined in places.

Method. The Levenberg-Marquardt method leads from each start to a root; a step to a point without finite f and J is
shortened. A root then slides along the set of roots as long as its norm decreases. The steps solve the problem
linearised at z (Hasofer and Lind, ASCE J. Eng. Mech. 100 (1974) 111; Rackwitz and Fiessler, Comput. Struct. 9 (1978)
489),

    z + d = J^+ (J z - f),

and a correction back to f = 0 follows each step. Newton's method on the stationarity conditions, J^T l + z = 0 and
f = 0, gives the last digits; if it succeeds immediately, no sliding is needed. The norms are compared after all starts
have ended. The starts are the origin and a low-discrepancy sequence (Roberts: multiples of powers of the positive root
of x^(n+1) = x + 1, modulo 1) with finite f and J. The first starts lie in the box and close to the origin. Further
starts lie in the part of the box closer to the origin than the best root, until they find no better root.

The result of `find` is the best of the roots that the starts lead to: a root is missed if no start lies in its basin.
Roots whose norms differ by less than SAME_DISTANCE tie. They are ordered by the first component in which they differ,
the larger first; rounding does not decide. Roots within SAME_ROOT of each other count as one.

Box of a model's signals, low <= x <= high: random points in it, grids, and points as text.

Points are columns (d, k), in the order of the signals and in their units. They are the same on every machine.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from functools import cmp_to_key
from itertools import islice

import casadi as ca
import numpy as np

from synth.errors import ModelError
from synth.signals import Signal
from synth.statespace import Array, readonly

PRINT_THRESHOLD = 1e-6  # of a half range: a smaller value prints as 0


@dataclass(frozen=True, eq=False)
class Box:
    """Symbols (d,) of `signals`, and symbols of `constants` (q,) with their `values`.

    Constants stay symbols so that CasADi does not fold them: once folded, 0.1 + 0.2 - 0.3 looks like any small number.
    """

    symbols: ca.SX
    signals: tuple[Signal, ...]
    constants: ca.SX = field(default_factory=lambda: ca.SX(0, 1))
    values: Array = field(default_factory=lambda: readonly([]))

    def with_values(self, exprs: ca.SX) -> ca.SX:
        """Return the expressions with the values of the constants substituted."""
        return ca.substitute(exprs, self.constants, ca.SX(ca.DM(self.values.tolist())))

    def evaluate(self, exprs: ca.SX, points: Array) -> Array:
        """Return the values (k, l, points) of `exprs` (k, l) at columns of `points` (d, points).

        Raises ModelError where one is not finite.
        """
        function = ca.Function("e", [self.symbols, self.constants], [ca.densify(ca.vec(exprs))])
        values = np.asarray(function(points, self.values)).reshape(exprs.size2(), exprs.size1(), -1).transpose(1, 0, 2)
        require_finite("the model or a derivative of it", values, self.signals, points)
        return values


def scatter(box: Sequence[Signal], count: int, seed: int) -> Array:
    """Return `count` points, uniform at random inside the box, as (d, count)."""
    unit = np.random.default_rng(seed).uniform(size=(len(box), count))
    return within(box, unit)


def within(box: Sequence[Signal], unit: Array) -> Array:
    """Return the points of the box at coordinates from 0 to 1, both (d, k)."""
    low, high = (np.array([getattr(s, end) for s in box]).reshape(-1, 1) for end in ("low", "high"))
    return low + (high - low) * unit


def grid(d: int, count: int) -> Array:
    """Return coordinates (d, k) from 0 to 1 on a grid of `count` points along each axis, vertices included."""
    axes = np.meshgrid(*[np.linspace(0.0, 1.0, count)] * d, indexing="ij")
    return np.array([a.ravel() for a in axes]).reshape(d, -1) if d else np.zeros((0, 1))


def half_widths(box: Sequence[Signal]) -> Array:
    """Return half of each signal's range (d,)."""
    return np.array([(s.high - s.low) / 2 for s in box])


def centre(box: Sequence[Signal]) -> Array:
    """Return the middle of each signal's range (d,)."""
    return np.array([(s.high + s.low) / 2 for s in box])


def signal_indices(expr: ca.SX, symbols: ca.SX, box: Sequence[Signal]) -> list[int]:
    """Return the indices of the signals whose `symbols` (d,) occur in an expression."""
    occurs = {s.element_hash() for s in ca.symvar(expr)}
    return [k for k in range(len(box)) if symbols[k].element_hash() in occurs]


def where(box: Sequence[Signal], point: Array) -> str:
    """Return a point (d,) as text: each signal with its value and unit."""
    values = np.where(np.abs(point) > PRINT_THRESHOLD * half_widths(box), point, 0.0)
    return ", ".join(f"{s.name} = {v:.6g} {s.unit}".removesuffix(" 1") for s, v in zip(box, values, strict=True))


def require_finite(what: str, values: Array, box: Sequence[Signal], points: Array) -> None:
    """Raise ModelError with the point if an entry of `values` (..., k) at `points` (d, k) is not finite."""
    bad = np.flatnonzero(~np.isfinite(values.reshape(-1, points.shape[1])).all(axis=0))
    if len(bad):
        raise ModelError(
            f"{what} is not finite at {where(box, points[:, bad[0]])}: "
            "shrink the ranges of the signals to where the model is finite"
        )


Pair = tuple[Array, Array]

BOX_STARTS = 24
CLOSE_STARTS = 6  # within each radius of START_RADII
START_RADII = (0.1, 0.01)  # radii about the origin
BALL_STARTS = 12  # in each round
BALL_ROUNDS = 8
MAX_CANDIDATES = 20  # candidates for each start; the first ones with finite f and J are used
SAME_DISTANCE = 1e-6  # of the distance: half the digits of the distance locate a root on a continuum
SAME_ROOT = 1e-4  # a double root is accurate to the square root of the tolerance on f
MARQUARDT_STEPS = 100
SLIDING_STEPS = 40
NEWTON_STEPS = 20
DAMPING = (1e-12, 1e-6, 1e10)  # least, first and last, of |J|^2
MAX_SQUARABLE = 1e150  # a larger number counts as infinite: its square overflows


@dataclass(frozen=True, eq=False)
class System:
    """f(z) = 0 and the box of its starts.

    `linear(z)` returns f (k,) and J (k, n), scaled so that |f_i| <= `tolerance` is a root; `stationary(z, l)` returns
    [J^T l + z; f] (n + k,) and its Jacobian (n + k, n + k). `low` <= 0 <= `high` (n,) bound the starts.
    If f is affine in z, its roots are one affine set with one nearest point: the origin is the only start.
    """

    linear: Callable[[Array], Pair]
    stationary: Callable[[Array], Pair]
    low: Array
    high: Array
    tolerance: float
    is_affine: bool = False

    def is_root(self, z: Array) -> bool:
        """Tell whether `z` satisfies every equation."""
        return bool((np.abs(self.linear(z)[0]) <= self.tolerance).all())


@dataclass(frozen=True, eq=False)
class Search:
    """The nearest roots, all at one distance, in order of preference, and the point (n,) with the least residual.

    `best` is None if f is finite at none of the starts.
    """

    roots: tuple[Array, ...]
    best: Array | None = None


def find(system: System) -> Search:
    """Return those roots nearest the origin to which the starts lead."""
    n = len(system.low)
    origin = np.zeros(n)
    if system.is_root(origin):
        return Search((_newton(system, origin),))
    regions = [] if system.is_affine else [(np.inf, BOX_STARTS), *((radius, CLOSE_STARTS) for radius in START_RADII)]
    starts = [origin, *(z for radius, count in regions for z in _starts(system, radius, 0, count))]
    ends = [_levenberg_marquardt(system, z) for z in starts]
    roots = _roots(system, ends)
    for k in range(BALL_ROUNDS if roots and not system.is_affine else 0):
        radius = _least_distance(roots)
        points = _starts(system, radius, k * BALL_STARTS, BALL_STARTS)
        roots += _roots(system, [_levenberg_marquardt(system, z) for z in points])
        if _least_distance(roots) >= radius * (1 - SAME_DISTANCE):
            break
    finite = [z for z in ends if np.isfinite(system.linear(z)[0]).all()]
    best = min(finite, key=lambda z: float(np.abs(system.linear(z)[0]).max()), default=None)
    return Search(_nearest(roots), best)


def find_near(system: System, z: Array) -> Array | None:
    """Return the stationary root to which the descent from `z` leads, None if it leads to no root."""
    roots = _roots(system, [_levenberg_marquardt(system, z)])
    return roots[0] if roots else None


def _starts(system: System, radius: float, skipped: int, count: int) -> Iterator[Array]:
    """Return points of Roberts' sequence in the box, each component within `radius`, where f and J are finite."""
    n = len(system.low)
    low, high = np.maximum(system.low, -radius), np.minimum(system.high, radius)
    base = 2.0
    for _ in range(60):
        base = (1 + base) ** (1 / (n + 1))
    steps = base ** -np.arange(1.0, n + 1)
    points = (
        low + (high - low) * ((0.5 + k * steps) % 1) for k in range(skipped + 1, skipped + 1 + MAX_CANDIDATES * count)
    )
    return islice((z for z in points if _is_finite(system.linear(z))), count)


def _roots(system: System, ends: Sequence[Array]) -> list[Array]:
    return [_stationary_root(system, z) for z in ends if system.is_root(z)]


def _stationary_root(system: System, root: Array) -> Array:
    """Return the stationary root to which the descent from `root` leads."""
    polished = _newton(system, root)
    return polished if polished is not root else _newton(system, _slide_along_roots(system, root))


def _least_distance(roots: Sequence[Array]) -> float:
    return min(float(np.linalg.norm(z)) for z in roots)


def _nearest(roots: Sequence[Array]) -> tuple[Array, ...]:
    """Return the distinct roots at the least distance, ordered by their components, the larger first."""
    if not roots:
        return ()
    limit = _least_distance(roots) * (1 + SAME_DISTANCE)
    distinct: list[Array] = []
    for z in (z for z in roots if np.linalg.norm(z) <= limit):
        if all(np.abs(z - other).max() > SAME_ROOT for other in distinct):
            distinct.append(z)
    return tuple(sorted(distinct, key=cmp_to_key(_compare)))


def _compare(z: Array, other: Array) -> int:
    """Return a negative number if `z` is larger in the first component in which the roots differ."""
    return next((1 if b > a else -1 for a, b in zip(z, other, strict=True) if abs(b - a) > SAME_ROOT), 0)


def _is_finite(pair: Pair) -> bool:
    return all(bool((np.abs(values) < MAX_SQUARABLE).all()) for values in pair)


def _levenberg_marquardt(system: System, z: Array) -> Array:
    """Return the result of the Levenberg-Marquardt method from `z`: a root, or a local minimum of |f|."""
    pair, (least, damping, last) = system.linear(z), DAMPING
    if not _is_finite(pair):
        return z
    for _ in range(MARQUARDT_STEPS):
        f, J = pair
        size = float(np.linalg.norm(J))
        if size == 0 or damping > last:
            break
        rows = np.vstack([J / size, np.sqrt(damping) * np.eye(len(z))])
        step = np.linalg.lstsq(rows, np.concatenate([-f / size, np.zeros(len(z))]), rcond=None)[0]
        candidate = system.linear(z + step)
        if not _is_finite(candidate) or candidate[0] @ candidate[0] >= f @ f:
            damping *= 10
        else:
            z, pair, damping = z + step, candidate, max(damping / 10, least)
        if np.abs(step).max() < (1e-11 if system.is_root(z) else 1e-14):
            break
    return z


def _slide_along_roots(system: System, root: Array) -> Array:
    """Return a root closer to the origin, by steps along the set of roots, or `root`."""
    for _ in range(SLIDING_STEPS):
        f, J = system.linear(root)
        if not _is_finite((f, J)):
            break
        step = np.linalg.lstsq(J, J @ root - f, rcond=None)[0] - root
        length = np.linalg.norm(root)
        if np.linalg.norm(step) <= 1e-9 * length:
            break
        candidates = (_gauss_newton(system, root + step / 2**k) for k in range(8))
        nearer = next((z for z in candidates if np.linalg.norm(z) < length * (1 - 1e-12) and system.is_root(z)), None)
        if nearer is None:
            break
        root = nearer
    return root


def _gauss_newton(system: System, z: Array) -> Array:
    """Return the point after a few minimum-norm Gauss-Newton steps to f = 0."""
    for _ in range(6):
        f, J = system.linear(z)
        if not _is_finite((f, J)) or system.is_root(z):
            break
        z = z - np.linalg.lstsq(J, f, rcond=None)[0]
    return z


def _newton(system: System, z: Array) -> Array:
    """Return the stationary point near the root `z`, or `z` itself if Newton's method gives nothing closer."""
    f, J = system.linear(z)
    if not _is_finite((f, J)):
        return z
    w = np.concatenate([z, -np.linalg.lstsq(J.T, z, rcond=None)[0]])
    for _ in range(NEWTON_STEPS):
        conditions, slope = system.stationary(w)
        if not _is_finite((conditions, slope)):
            return z
        step = np.linalg.lstsq(slope, conditions, rcond=None)[0]
        w = w - step
        if np.abs(step[: len(z)]).max() < 1e-15:
            break
    polished = w[: len(z)]
    nearer = np.linalg.norm(polished) <= np.linalg.norm(z) * (1 + 1e-6) + 1e-12
    return polished if nearer and system.is_root(polished) else z
