"""Fisher information of (X, Y, yaw) in the voltages of model (2): Cramér-Rao deviations in closed form.

In the field's axes the Jacobian of sensor k, at the phase (p, q) and the place (o_X, o_Y) = w R(yaw) r_k, is

    X:  [g, 0, h],  g = B'(p),  h = B(q) - g o_Y        Y:  [0, k, m],  k = B'(q),  m = k o_X - B(p)

by phases in rad and the yaw, and with the yaw's information N_T, by Lagrange's identity a sum of squares,

    N_T = sum over axes of [sum over pairs (g_i h_j - g_j h_i)^2] / sum g^2,
    var yaw = sigma^2 / N_T,    var X = sigma^2 / w^2 (1 / sum g^2 + (sum g h / sum g^2)^2 / N_T).

`synth.analyse.observability.information` proves their largest values between grid points.

Source: Kawato, Kim, "A Novel Multi-DOF Precision Positioning Methodology Using Two-Axis Hall-Effect Sensors", section
3.B.
"""

from dataclasses import dataclass, replace
from functools import partial
from math import ceil, hypot, pi

import numpy as np

from models.hall_array import Array
from models.hall_two_waves import PlanarArray
from synth.analyse.observability import information
from synth.analyse.observability.information import LargestDeviation
from synth.errors import ModelError
from synth.statespace import readonly

Range = tuple[float, float]

START = 24  # cells along a pitch
MAX_CELLS = 30_000_000  # cells


@dataclass(frozen=True, eq=False)
class Rows:
    """Derivatives g (2, n, N) by the phase and h (2, n, N) by the yaw, V/rad, of n sensors along X and Y."""

    g: Array
    h: Array

    @property
    def jacobian(self) -> Array:
        """The Jacobian (3, 2 n, N) by two phases and the yaw, V by rad, all rows along X first."""
        none = np.zeros_like(self.g[0])
        return np.concatenate([[self.g[0], none, self.h[0]], [none, self.g[1], self.h[1]]], axis=1)


def field(array: PlanarArray, phase: Array, order: int = 0) -> Array:
    """Return B, or its derivative by the phase of an `order` up to 3, in V at phases in rad."""
    f, sign = ((np.sin, 1), (np.cos, 1), (np.sin, -1), (np.cos, -1))[order]
    waves = sign * (array.alpha * f(phase) + array.beta * 5**order * f(5 * phase))
    return waves if order else waves + array.c


def derivative_bound(array: PlanarArray, order: int) -> float:
    """Return a bound of the derivative of B of some order, V."""
    return array.alpha + 5**order * abs(array.beta)


def sensor_phases(array: PlanarArray, yaw: Array) -> tuple[Array, Array]:
    """Return the sensors' places (n, N) along X and Y from the body's origin, rad of phase, at yaws (N,) in rad."""
    x, y = array.wave_number * np.array(array.positions).T[:, :, None]
    return np.cos(yaw) * x - np.sin(yaw) * y, np.sin(yaw) * x + np.cos(yaw) * y


def rows(array: PlanarArray, q: Array) -> Rows:
    """Return the rows at phases of the body's origin and yaws q (3, N), rad."""
    place = sensor_phases(array, q[2])
    p = [q[i] + place[i] for i in (0, 1)]
    B, g = ([field(array, phase, order) for phase in p] for order in (0, 1))
    h = B[1] - g[0] * place[1], g[1] * place[0] - B[0]
    return Rows(np.array(g), np.array(h))


def of_phases(array: PlanarArray, q: Array) -> Array:
    """Return the deviations (3, N) in rad per V of noise at phases and yaws q (3, N) in rad; inf where rank is lost."""
    jacobian_rows = rows(array, q)
    N = (jacobian_rows.g**2).sum(axis=1)
    across = (
        jacobian_rows.g[:, :, None] * jacobian_rows.h[:, None] - jacobian_rows.g[:, None] * jacobian_rows.h[:, :, None]
    )
    with np.errstate(divide="ignore", invalid="ignore"):
        turn = 1 / ((across**2).sum(axis=(1, 2)) / 2 / N).sum(axis=0)
        axes = 1 / N + ((jacobian_rows.g * jacobian_rows.h).sum(axis=1) / N) ** 2 * turn
    deviations = np.sqrt(np.vstack([axes, turn]))
    return np.where(np.isfinite(deviations), deviations, np.inf)


def units(array: PlanarArray) -> Array:
    """Return the size of a rad of each phase and of the yaw, m and rad (3,)."""
    w = array.wave_number
    return np.array([1 / w, 1 / w, 1.0])


def deviations(array: PlanarArray, q: Array) -> Array:
    """Return the deviations (3, N) of X, Y in m and yaw in rad at q (3, N) in m, m and rad; inf where rank is lost."""
    w = array.wave_number
    size = array.deviation * units(array)[:, None]
    return readonly(size * of_phases(array, np.array([w * q[0], w * q[1], q[2]])))


def column_changes(array: PlanarArray, q: Array, half: Array) -> Array:
    """Return bounds (3, N) of the change of the Jacobian's columns, in V, in cells q +- half (3, N), rad."""
    place = sensor_phases(array, q[2])
    reach = array.wave_number * np.array([hypot(*r) for r in array.positions])[:, None]
    phase_change = [half[i] + reach * half[2] for i in (0, 1)]
    columns = []
    for i, j in ((0, 1), (1, 0)):
        p, q_across = q[i] + place[i], q[j] + place[j]
        g = np.abs(field(array, p, 2)) * phase_change[i] + derivative_bound(array, 3) / 2 * phase_change[i] ** 2
        B = np.abs(field(array, q_across, 1)) * phase_change[j] + derivative_bound(array, 2) / 2 * phase_change[j] ** 2
        lever = reach * half[2]
        h = B + np.abs(place[j]) * g + (np.abs(field(array, p, 1)) + g) * lever
        columns.append((g, h))
    (g, h), (k, m) = columns
    return np.sqrt(np.array([(g**2).sum(axis=0), (k**2).sum(axis=0), (h**2 + m**2).sum(axis=0)]))


def worst(array: PlanarArray, yaw: Range = (0.0, 0.0), tolerance: float = 1e-3) -> LargestDeviation:
    """Return the largest deviations of X, Y in m and yaw in rad in the pitch and over yaws, with a proved bound.

    Raises ModelError if that needs more than MAX_CELLS cells, as where the rank is lost; the message says where.
    """
    low, high = yaw
    if not -pi <= low <= high <= pi:
        raise ModelError(f"the yaws are {low} .. {high} rad: give the lower first, within half a turn")
    turn = 2 * pi
    reach = array.wave_number * max(hypot(*r) for r in array.positions)
    cells = (START, START, max(1, ceil((high - low) * reach / (turn / START))))
    ends = (0.0, 0.0, low), (turn, turn, high)
    proved = information.search(
        partial(of_phases, array), partial(column_changes, array), *ends, cells, tolerance, MAX_CELLS
    )
    unit = units(array)
    size = array.deviation * unit
    return replace(
        proved,
        attained=readonly(size * proved.attained),
        bound=readonly(size * proved.bound),
        at=readonly(proved.at * unit),
    )
