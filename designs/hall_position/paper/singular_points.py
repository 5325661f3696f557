"""Singular points of two sensors: all points of the pitch at which the Jacobian of their four voltages has rank 2.

With the rows [g, 0, h] and [0, k, m] of `fisher` the rank is lost, at a yaw, where both determinants vanish:

    D_X = g_1 h_2 - g_2 h_1 = 0,    D_Y = k_1 m_2 - k_2 m_1 = 0.

`synth.analyse.observability.isolated_zeros` isolates and proves their zeros, which are rounded once from 256 bits.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from math import pi
from typing import Any

import flint
import numpy as np
from numpy.typing import NDArray

from designs.hall_position.paper import fisher
from models.hall_array import Array
from models.hall_two_waves import PlanarArray
from synth.analyse.numerics import precise
from synth.analyse.observability import isolated_zeros
from synth.errors import ModelError
from synth.statespace import readonly

Ball = flint.arb

ROUNDING_MARGIN = 1e-9  # of alpha^2, in rad: far above the rounding error of a determinant


def of_pair(array: PlanarArray, yaw: float) -> Array:
    """Return all points (n, 2) of the body's origin in a pitch, in m, where two sensors lose rank at a yaw in rad.

    Raises ModelError for other than two sensors, or where points are not isolated, as when both slopes of an axis
    vanish together: then X is lost on a whole line.
    """
    if len(array.positions) != 2:
        raise ModelError(f"{len(array.positions)} sensors: the determinants are those of two, see fisher.worst")
    _check_slopes(array, yaw)
    with precise.precision():
        pair = _Pair.of(array, yaw)
        equations = isolated_zeros.Equations(2, pair.values, partial(possible, array, yaw))
        points = [cube.at for cube in isolated_zeros.search(equations)]
        zeros = sorted([float(isolated_zeros.within_turn(v) / pair.w) for v in p] for p in points)
    return readonly(np.reshape(zeros, (-1, 2)))


def possible(array: PlanarArray, yaw: float, cells: Array, half: float) -> NDArray[np.bool_]:
    """Return which cells (2, N) may hold a point: no bound on the determinants excludes it."""
    q = np.vstack([cells, np.full(cells.shape[1], yaw)])
    rows, offset = fisher.rows(array, q), fisher.sensor_phases(array, q[2])
    is_possible = np.ones(cells.shape[1], dtype=bool)
    for i, j in ((0, 1), (1, 0)):
        p, across = cells[i] + offset[i], cells[j] + offset[j]
        dg = np.abs(fisher.field(array, p, 2)) * half + fisher.derivative_bound(array, 3) / 2 * half**2
        dB = np.abs(fisher.field(array, across, 1)) * half + fisher.derivative_bound(array, 2) / 2 * half**2
        g, h, dh = np.abs(rows.g[i]), np.abs(rows.h[i]), dB + np.abs(offset[j]) * dg
        D = rows.g[i, 0] * rows.h[i, 1] - rows.g[i, 1] * rows.h[i, 0]
        change = sum(g[a] * dh[b] + dg[a] * h[b] + dg[a] * dh[b] for a, b in ((0, 1), (1, 0)))
        is_possible &= np.abs(D) <= change + ROUNDING_MARGIN * array.alpha**2
    return is_possible


@dataclass(frozen=True, eq=False)
class _Pair:
    """Two sensors in balls: their offsets (o_X, o_Y) from the origin in rad at the yaw; c, alpha and beta in V.

    Phases are balls, or series in one of them.
    """

    w: Ball
    offsets: list[tuple[Ball, Ball]]
    c: Ball
    alpha: Ball
    beta: Ball

    @staticmethod
    def of(array: PlanarArray, yaw: float) -> "_Pair":
        w = 2 * Ball.pi() / Ball(array.pitch)
        angle = Ball(yaw)
        s, c = angle.sin(), angle.cos()
        offsets = [(w * (c * Ball(x) - s * Ball(y)), w * (s * Ball(x) + c * Ball(y))) for x, y in array.positions]
        return _Pair(w, offsets, Ball(array.c), Ball(array.alpha), Ball(array.beta))

    def slope(self, p: Any) -> Any:
        """Return B'."""
        return self.alpha * p.cos() + 5 * self.beta * (5 * p).cos()

    def rows(self, at: Sequence[Any], i: int) -> list[tuple[Any, Any]]:
        """Return g and h of each sensor along the axis i."""
        pairs, sign = [], 1 - 2 * i
        for offset in self.offsets:
            p, q, o = at[i] + offset[i], at[1 - i] + offset[1 - i], offset[1 - i]
            g = self.slope(p)
            pairs.append((g, sign * (self.c + self.alpha * q.sin() + self.beta * (5 * q).sin() - g * o)))
        return pairs

    def values(self, at: Sequence[Any]) -> list[Any]:
        """Return D_X and D_Y."""
        rows = (self.rows(at, i) for i in (0, 1))
        return [g0 * h1 - g1 * h0 for (g0, h0), (g1, h1) in rows]


def _check_slopes(array: PlanarArray, yaw: float) -> None:
    """Raise ModelError where both slopes of an axis may vanish together, so that rank is lost on a line."""
    for name, offset in zip("XY", fisher.sensor_phases(array, np.array([yaw])), strict=True):
        half, along = pi / isolated_zeros.CELLS, isolated_zeros.grid(1)[0]
        for _ in range(isolated_zeros.MAX_BISECTIONS):
            slopes = np.abs(fisher.field(array, along + offset, 1))
            along = along[(slopes <= fisher.derivative_bound(array, 2) * half).all(axis=0)]
            half /= 2
            along = np.concatenate([along - half, along + half])
        if along.size:
            at = along[0] / array.wave_number * 1e3
            raise ModelError(
                f"at {name} = {at:.3f} mm both sensors have no slope along {name}, which is not "
                "observable on this whole line: place them other than half a pitch apart"
            )
