"""Where two sensors lose the yaw, X and Y: the points of the pitch at which their four voltages have rank 2, all found.

With the rows [g, 0, h] and [0, k, m] of `fisher` the rank is lost, at a yaw, where both determinants vanish:

    D_X = g_1 h_2 - g_2 h_1 = 0,    D_Y = k_1 m_2 - k_2 m_1 = 0.

Cells of the pitch in which a bound on its slope keeps one of them from 0 are left out, the others cut in four. Newton's
method leads from those that stay to points, and Krawczyk's test in ball arithmetic shows for each that a square about
it holds one point and no other; the cells that stayed must all lie in such squares. Points are rounded once from 256
bits, so that they are the same on every machine.
"""

from dataclasses import dataclass, replace
from math import ceil, pi

import flint
import numpy as np
from numpy.typing import NDArray

from designs.hall_position import fisher, parameters
from synth.analyse import precise
from synth.errors import ModelError
from synth.statespace import readonly

Array = NDArray[np.float64]
Ball = flint.arb

CELLS = 64  # along a pitch, at first
CUTS = 24
FIRST = 3  # cuts before Newton's method is tried
STARTS = 400  # of Newton's method at a cut
SQUARES = (0.05, 0.02, 0.01, 0.005, 0.002)  # rad, half their sides, tried in turn
CLEAR = 1e-9  # of alpha^2, rad: far above what double precision leaves of a determinant
STEPS = 12  # of Newton's method: each doubles the digits
SAME = 1e-7  # rad, between two ends of Newton's method that are one point


@dataclass(frozen=True, eq=False)
class SingularPoints:
    """All points `at` (n, 2) of the body's origin in a pitch, in m, where rank is lost at a yaw in rad.

    `lost` (n, 3) is the motion in X, Y (m) and yaw (rad), of length 1 with the yaw times 1/w, that moves no voltage.
    """

    yaw: float
    at: Array
    lost: Array


def of_pair(array: parameters.Array, yaw: float) -> SingularPoints:
    """Return the singular points of two sensors at a yaw in rad.

    Raises ModelError for other than two sensors, or where points are not isolated, as when both slopes of an axis
    vanish together: then X is lost on a whole line.
    """
    if len(array.positions) != 2:
        raise ModelError(f"{len(array.positions)} sensors: the determinants are those of two, see fisher.worst")
    array = replace(array, weights=())  # which multiply a determinant
    _check_slopes(array, yaw)
    with precise.precision():
        pair = _Pair.of(array, yaw)
        squares = _squares(pair, array, yaw)
        points = [s.at for s in squares]
        rounded = [[float(_wrapped(v) / pair.w) for v in p] for p in points]
        lost = [[float(v) for v in pair.lost(*p)] for p in points]
    order = sorted(range(len(points)), key=lambda i: rounded[i])
    at = np.reshape([rounded[i] for i in order], (-1, 2))
    return SingularPoints(yaw, readonly(at), readonly(np.reshape([lost[i] for i in order], (-1, 3))))


def _squares(pair: "_Pair", array: parameters.Array, yaw: float) -> list["_Square"]:
    """Return a square about each point; cells are cut until none is left beside these.

    Raises ModelError where CUTS do not do.
    """
    half = pi / CELLS
    along = 2 * half * (np.arange(CELLS) + 0.5)
    cells = np.array([each.ravel() for each in np.meshgrid(along, along, indexing="ij")])
    found: list[_Square] = []
    for cut in range(CUTS):
        cells = cells[:, _open(array, yaw, cells, half)]
        if cut >= FIRST:
            cells = _outside(found, cells, half)
            found += _new(pair, found, cells)
            cells = _outside(found, cells, half)
        if not cells.size:
            return found
        half /= 2
        cells = np.hstack([cells + half * np.array([[i], [j]]) for i in (-1, 1) for j in (-1, 1)])
    X, Y = cells[:, 0] / array.wave_number * 1e3
    raise ModelError(
        f"near X = {X:.3f} mm, Y = {Y:.3f} mm singular points meet or lie on a line: change the yaw "
        "or a sensor's place slightly"
    )


def _open(array: parameters.Array, yaw: float, cells: Array, half: float) -> NDArray[np.bool_]:
    """Return which cells (2, N) no bound keeps from holding a point."""
    q = np.vstack([cells, np.full(cells.shape[1], yaw)])
    of, place = fisher.rows(array, q), fisher.turned(array, q[2])
    clear = CLEAR * array.alpha**2
    open = np.ones(cells.shape[1], dtype=bool)
    bends = array.alpha + 125 * abs(array.beta), array.alpha + 25 * abs(array.beta)
    for i, j in ((0, 1), (1, 0)):
        p, across = cells[i] + place[i], cells[j] + place[j]
        dg = np.abs(fisher.field(array, p, 2)) * half + bends[0] / 2 * half**2
        dB = np.abs(fisher.field(array, across, 1)) * half + bends[1] / 2 * half**2
        g, h, dh = np.abs(of.g[i]), np.abs(of.h[i]), dB + np.abs(place[j]) * dg
        D = of.g[i, 0] * of.h[i, 1] - of.g[i, 1] * of.h[i, 0]
        change = sum(g[a] * dh[b] + dg[a] * h[b] + dg[a] * dh[b] for a, b in ((0, 1), (1, 0)))
        open &= np.abs(D) <= change + clear
    return open


@dataclass(frozen=True, eq=False)
class _Pair:
    """Two sensors in balls: places (o_X, o_Y) in rad at the yaw; c, alpha and beta in V."""

    w: Ball
    places: list[tuple[Ball, Ball]]
    c: Ball
    alpha: Ball
    beta: Ball

    @staticmethod
    def of(array: parameters.Array, yaw: float) -> "_Pair":
        w = 2 * Ball.pi() / Ball(array.pitch)
        turn = Ball(yaw)
        s, c = turn.sin(), turn.cos()
        places = [(w * (c * Ball(x) - s * Ball(y)), w * (s * Ball(x) + c * Ball(y))) for x, y in array.positions]
        return _Pair(w, places, Ball(array.c), Ball(array.alpha), Ball(array.beta))

    def axis(self, U: Ball, V: Ball, i: int) -> tuple[Ball, Ball, Ball]:
        """Return the determinant of the axis i and its derivatives along the axis and across it."""
        sign = 1 if i == 0 else -1
        g, h, dg, along, over = [], [], [], [], []
        for place in self.places:
            p, q, o = U + place[i], V + place[1 - i], place[1 - i]
            g.append(self.alpha * p.cos() + 5 * self.beta * (5 * p).cos())
            dg.append(-self.alpha * p.sin() - 25 * self.beta * (5 * p).sin())
            slope = self.alpha * q.cos() + 5 * self.beta * (5 * q).cos()
            h.append(sign * (self.c + self.alpha * q.sin() + self.beta * (5 * q).sin() - g[-1] * o))
            along.append(-sign * dg[-1] * o)
            over.append(sign * slope)
        D = g[0] * h[1] - g[1] * h[0]
        d_along = dg[0] * h[1] + g[0] * along[1] - dg[1] * h[0] - g[1] * along[0]
        return D, d_along, g[0] * over[1] - g[1] * over[0]

    def values(self, U: Ball, V: Ball) -> flint.arb_mat:
        """Return D_X and D_Y (2, 1)."""
        return flint.arb_mat([[self.axis(U, V, 0)[0]], [self.axis(V, U, 1)[0]]])

    def slopes(self, U: Ball, V: Ball) -> flint.arb_mat:
        """Return the derivatives (2, 2) of D_X and D_Y by U and V."""
        _, xu, xv = self.axis(U, V, 0)
        _, yv, yu = self.axis(V, U, 1)
        return flint.arb_mat([[xu, xv], [yu, yv]])

    def lost(self, U: Ball, V: Ball) -> tuple[Ball, Ball, Ball]:
        """Return (X, Y, yaw) of length 1, the yaw times 1/w, the first of the sensors' slopes being those used."""
        moved = []
        for i, (along, over) in enumerate(((U, V), (V, U))):
            sign, gs, hs = 1 - 2 * i, [], []
            for place in self.places:
                p, q, o = along + place[i], over + place[1 - i], place[1 - i]
                gs.append(self.alpha * p.cos() + 5 * self.beta * (5 * p).cos())
                hs.append(sign * (self.c + self.alpha * q.sin() + self.beta * (5 * q).sin() - gs[-1] * o))
            moved.append(-(gs[0] * hs[0] + gs[1] * hs[1]) / (gs[0] ** 2 + gs[1] ** 2))
        size = (moved[0] ** 2 + moved[1] ** 2 + 1).sqrt()
        return moved[0] / self.w / size, moved[1] / self.w / size, 1 / size


@dataclass(frozen=True, eq=False)
class _Square:
    """A square of half a side `half`, rad, about `at`, that holds one point and no other."""

    at: tuple[Ball, Ball]
    half: float


def _new(pair: _Pair, known: list[_Square], cells: Array) -> list[_Square]:
    """Return a square about each further point to which Newton's method leads from the cells (2, N)."""
    found: list[_Square] = []
    for start in cells.T[:: ceil(cells.shape[1] / STARTS) or 1]:
        end = _newton(pair, start)
        if end is not None and all(_apart(end, s.at) > SAME for s in (*known, *found)):
            found.append(_certified(pair, end))
    return found


def _apart(a: tuple[Ball, Ball], b: tuple[Ball, Ball]) -> float:
    return float(np.abs(_turn(np.array([float(u - v) for u, v in zip(a, b, strict=True)]))).max())


def _newton(pair: _Pair, start: Array) -> tuple[Ball, Ball] | None:
    at = Ball(float(start[0])), Ball(float(start[1]))
    for _ in range(STEPS):
        J, f = pair.slopes(*at), pair.values(*at)
        det = (J[0, 0] * J[1, 1] - J[0, 1] * J[1, 0]).mid()
        if det == 0:
            return None
        step = [(J[1, 1] * f[0, 0] - J[0, 1] * f[1, 0]) / det, (J[0, 0] * f[1, 0] - J[1, 0] * f[0, 0]) / det]
        at = (at[0] - step[0]).mid(), (at[1] - step[1]).mid()
    return at if max(abs(float(v)) for v in step) < 1e-60 else None


def _certified(pair: _Pair, at: tuple[Ball, Ball]) -> _Square:
    """Return the largest of SQUARES about a point that is shown to hold it alone, by Krawczyk's test."""
    inverse = precise.middle(pair.slopes(*at).inv())
    moved = inverse * pair.values(*at)
    for half in SQUARES:
        box = [v + Ball(0, half) for v in at]
        left = flint.arb_mat([[1, 0], [0, 1]]) - inverse * pair.slopes(*box)
        reach = [abs(moved[i, 0]) + (abs(left[i, 0]) + abs(left[i, 1])) * half for i in (0, 1)]
        if all(r < half for r in reach):
            return _Square(at, half)
    raise ModelError(
        f"at the phases {float(at[0]):.6f}, {float(at[1]):.6f} rad two singular points meet or lie on a line: change "
        "the yaw or a sensor's place slightly"
    )


def _outside(squares: list[_Square], cells: Array, half: float) -> Array:
    """Return the cells (2, N) that lie in none of the squares."""
    inside = np.zeros(cells.shape[1], dtype=bool)
    for square in squares:
        off = _turn(cells - np.array([[float(v)] for v in square.at]))
        inside |= np.abs(off).max(axis=0) + half < square.half * (1 - CLEAR)
    return cells[:, ~inside]


def _check_slopes(array: parameters.Array, yaw: float) -> None:
    """Raise ModelError where both slopes of an axis may vanish together, so that rank is lost on a line."""
    bend = array.alpha + 25 * abs(array.beta)
    for name, place in zip("XY", fisher.turned(array, np.array([yaw])), strict=True):
        half = pi / CELLS
        along = 2 * half * (np.arange(CELLS) + 0.5)
        for _ in range(CUTS):
            slopes = np.abs(fisher.field(array, along + place, 1))
            along = along[(slopes <= bend * half).all(axis=0)]
            half /= 2
            along = np.concatenate([along - half, along + half])
        if along.size:
            at = along[0] / array.wave_number * 1e3
            raise ModelError(
                f"at {name} = {at:.3f} mm both sensors have no slope along {name}, which is lost on this whole line: "
                "place them other than half a pitch apart"
            )


def _turn(phase: Array) -> Array:
    """Return phases within half a turn."""
    return (phase + pi) % (2 * pi) - pi


def _wrapped(phase: Ball) -> Ball:
    """Return a phase from 0 up to a turn; 0 for one that is whole turns to the precision kept."""
    turns = (phase / (2 * Ball.pi())).mid()
    nearest = (turns + 0.5).floor().mid()
    if abs(turns - nearest) < precise.ZERO:
        return Ball(0)
    return (turns - turns.floor().mid()) * 2 * Ball.pi()
