"""What the voltages tell of (X, Y, yaw), by model (2): Cramer-Rao deviations in closed form, and how large they get.

In the field's axes the Jacobian of sensor k, at the phase (p, q) and the place (o_X, o_Y) = w R(yaw) r_k, is

    X:  [g, 0, h],  g = B'(p),  h = B(q) - g o_Y        Y:  [0, k, m],  k = B'(q),  m = k o_X - B(p)

by phases in rad and the yaw, so that with the yaw's information N_T, by Lagrange's identity a sum of squares,

    N_T = sum over axes of [sum over pairs (g_i h_j - g_j h_i)^2] / sum g^2,
    var yaw = sigma^2 / N_T,    var X = sigma^2 / w^2 (1 / sum g^2 + (sum g h / sum g^2)^2 / N_T).

Deviations s_i in a cell about q are bounded: where the columns of the Jacobian H change by no more than d_j in length,
|H v + E v| >= |H v| - sum_j d_j |v_j| >= |H v| (1 - sum_j d_j s_j), and 1/s_i is the least |H v| with v_i = 1, so

    s_i in the cell  <=  s_i(q) / (1 - sum_j d_j s_j(q)).

Cells whose bound exceeds the largest deviation that was found are cut in two along each side until none is left.

Source: Kawato, Kim, "Multi-Degree-of-Freedom Precision Position Sensing", section 3.B.
"""

from dataclasses import dataclass
from itertools import product
from math import ceil, hypot, pi

import numpy as np
from numpy.typing import NDArray

from designs.hall_position import parameters
from synth.errors import ModelError
from synth.statespace import readonly

Array = NDArray[np.float64]
Range = tuple[float, float]

START = 24  # cells along a pitch
MOST = 30_000_000  # cells
AT_ONCE = 200_000  # cells, for memory
ROUNDING = 1e-9  # relative, added to bounds: far more than double precision loses where they are finite


@dataclass(frozen=True, eq=False)
class Rows:
    """Slopes g (2, n, N), V by rad of phase, and turns h (2, n, N), V by rad of yaw, of n sensors along X and Y."""

    g: Array
    h: Array


@dataclass(frozen=True, eq=False)
class Worst:
    """The largest deviations of X, Y in m and yaw in rad over cells: `found` (3,) at `at` (3, 3), none above `bound`.

    Row i of `at` is where i is largest, in m, m and rad. `cells` were looked at.
    """

    found: Array
    bound: Array
    at: Array
    cells: int


def field(array: parameters.Array, phase: Array, order: int = 0) -> Array:
    """Return B, or its derivative by the phase of an `order` up to 3, in V at phases in rad."""
    f, sign = ((np.sin, 1), (np.cos, 1), (np.sin, -1), (np.cos, -1))[order]
    waves = sign * (array.alpha * f(phase) + array.beta * 5**order * f(5 * phase))
    return waves if order else waves + array.c


def turned(array: parameters.Array, yaw: Array) -> tuple[Array, Array]:
    """Return the sensors' places (n, N) along X and Y from the body's origin, rad of phase, at yaws (N,) in rad."""
    x, y = array.wave_number * np.array(array.positions).T[:, :, None]
    return np.cos(yaw) * x - np.sin(yaw) * y, np.sin(yaw) * x + np.cos(yaw) * y


def rows(array: parameters.Array, q: Array) -> Rows:
    """Return the rows at phases of the body's origin and yaws q (3, N), rad, each by the root of its weight."""
    place = turned(array, q[2])
    p = [q[i] + place[i] for i in (0, 1)]
    B, g = ([field(array, phase, order) for phase in p] for order in (0, 1))
    h = B[1] - g[0] * place[1], g[1] * place[0] - B[0]
    scale = np.array(array.scales)[:, None]
    return Rows(scale * np.array(g), scale * np.array(h))


def of_phases(array: parameters.Array, q: Array) -> Array:
    """Return the deviations (3, N) in rad per V of noise at phases and yaws q (3, N) in rad; inf where rank is lost."""
    of = rows(array, q)
    N = (of.g**2).sum(axis=1)
    across = of.g[:, :, None] * of.h[:, None] - of.g[:, None] * of.h[:, :, None]
    with np.errstate(divide="ignore", invalid="ignore"):
        turn = 1 / ((across**2).sum(axis=(1, 2)) / 2 / N).sum(axis=0)
        axes = 1 / N + ((of.g * of.h).sum(axis=1) / N) ** 2 * turn
    found = np.sqrt(np.vstack([axes, turn]))
    return np.where(np.isfinite(found), found, np.inf)


def deviations(array: parameters.Array, q: Array) -> Array:
    """Return the deviations (3, N) of X, Y in m and yaw in rad at q (3, N) in m, m and rad; inf where rank is lost."""
    w = array.wave_number
    size = array.deviation * np.array([1 / w, 1 / w, 1.0])[:, None]
    return readonly(size * of_phases(array, np.array([w * q[0], w * q[1], q[2]])))


def changes(array: parameters.Array, q: Array, half: Array) -> Array:
    """Return bounds (3, N) of how far the Jacobian's columns, in V, move in cells q +- half (3, N), rad."""
    place = turned(array, q[2])
    reach = array.wave_number * np.array([hypot(*r) for r in array.positions])[:, None]
    moved = [half[i] + reach * half[2] for i in (0, 1)]
    scale = np.array(array.scales)[:, None]
    bends = array.alpha + 125 * abs(array.beta), array.alpha + 25 * abs(array.beta)  # of B''' and B''
    found = []
    for i, j in ((0, 1), (1, 0)):
        p, q_across = q[i] + place[i], q[j] + place[j]
        g = np.abs(field(array, p, 2)) * moved[i] + bends[0] / 2 * moved[i] ** 2
        B = np.abs(field(array, q_across, 1)) * moved[j] + bends[1] / 2 * moved[j] ** 2
        lever = reach * half[2]
        h = B + np.abs(place[j]) * g + (np.abs(field(array, p, 1)) + g) * lever
        found.append((scale * g, scale * h))
    (g, h), (k, m) = found
    return np.sqrt(np.array([(g**2).sum(axis=0), (k**2).sum(axis=0), (h**2 + m**2).sum(axis=0)]))


def worst(array: parameters.Array, yaw: Range = (0.0, 0.0), tolerance: float = 1e-3) -> Worst:
    """Return the largest deviations in the pitch and over yaws in rad, less than `tolerance`, relative, below a bound.

    Raises ModelError where that takes more than MOST cells, as where the rank is lost; the message tells where.
    """
    q, half = _cells(array, yaw)
    found, at, done = np.zeros(3), np.zeros((3, 3)), 0
    ended = np.zeros(3)  # the largest bound of cells that are done with
    while q.shape[1]:
        done += q.shape[1]
        kept = []
        for part in np.array_split(np.arange(q.shape[1]), ceil(q.shape[1] / AT_ONCE)):
            s, bound = _bounded(array, q[:, part], half)
            for i in np.flatnonzero(s.max(axis=1) > found):
                found[i], at[i] = s[i].max(), q[:, part[s[i].argmax()]]
            open = (bound > (1 + tolerance) * found[:, None]).any(axis=0)
            ended = np.maximum(ended, bound[:, ~open].max(axis=1, initial=0.0))
            kept.append(part[open])
        if done > MOST:
            raise ModelError(_unbounded(array, found, at))
        q, half = _cut(q[:, np.concatenate(kept)], half)
    w = array.wave_number
    size = array.deviation * np.array([1 / w, 1 / w, 1.0])
    return Worst(readonly(size * found), readonly(size * ended), readonly(at * [1 / w, 1 / w, 1.0]), done)


def _cells(array: parameters.Array, yaw: Range) -> tuple[Array, Array]:
    """Return the middles (3, N) of cells that cover the pitch and the yaws, and half their sides (3, 1), rad."""
    low, high = yaw
    if not -pi <= low <= high <= pi:
        raise ModelError(f"the yaws are {low} .. {high} rad: give the lower first, within half a turn")
    side = 2 * pi / START
    reach = array.wave_number * max(hypot(*r) for r in array.positions)
    many = max(1, ceil((high - low) * reach / side))
    step = (high - low) / many
    along = side * (np.arange(START) + 0.5)
    grid = np.meshgrid(along, along, low + step * (np.arange(many) + 0.5), indexing="ij")
    return np.array([each.ravel() for each in grid]), np.array([[side / 2], [side / 2], [step / 2]])


def _bounded(array: parameters.Array, q: Array, half: Array) -> tuple[Array, Array]:
    """Return deviations at the middles and bounds in the cells (3, N), inf where there is none, rad per V."""
    s = of_phases(array, q)
    with np.errstate(invalid="ignore"):
        left = 1 - (changes(array, q, half) * s).sum(axis=0)
    sound = left > 0  # NaN is not
    return s, np.where(sound, s * (1 + ROUNDING) / np.where(sound, left, 1.0), np.inf)


def _cut(q: Array, half: Array) -> tuple[Array, Array]:
    """Return the cells cut in two along each side that is not 0."""
    signs = product(*((-0.5, 0.5) if side > 0 else (0.0,) for side in half.ravel()))
    return np.hstack([q + half * np.array(sign)[:, None] for sign in signs]), half / 2


def _unbounded(array: parameters.Array, found: Array, at: Array) -> str:
    X, Y = at[2, :2] / array.wave_number * 1e3
    return (
        f"no bound of the deviations is found in {MOST} cells; that of the yaw exceeds "
        f"{found[2] * array.deviation:.3g} rad near X = {X:.4f} mm, Y = {Y:.4f} mm at a yaw of {at[2, 2]:.4f} rad, "
        "where rank seems to be lost: add a sensor, or allow a larger tolerance"
    )
