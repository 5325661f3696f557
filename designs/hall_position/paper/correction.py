"""Gauss-Newton (GLSDC) as in the paper, without damping, bounds or prediction, vectorised over bodies.

    q <- q + alpha (H'H)^-1 H' (y - f(q)),    q = (X, Y, yaw), or (X, Y) where the yaw is known.

A correction that does not lower J = |y - f(q)|^2 is rejected, and the next one of that body is half as long. In the
field's axes R(yaw) y - B has the length of y - R(yaw)' B, and its Jacobian by the phases w X, w Y has the rows
[g, 0, h] and [0, k, m] of `fisher`.
"""

import numpy as np

from designs.hall_position.paper import fisher
from models.hall_array import Array
from models.hall_two_waves import PlanarArray

RANK = 1e-12  # of alpha^6 or alpha^4: a smaller determinant is singular


def volts(array: PlanarArray, q: Array) -> Array:
    """Return the voltages by model (2) at q (3, N) in m and rad: (2, sensors, N) in V, in the field's axes X, Y."""
    place = fisher.sensor_phases(array, q[2])
    return np.array([fisher.field(array, array.wave_number * q[i] + place[i]) for i in (0, 1)])


def rotate_voltages(seen: Array, yaw: Array) -> Array:
    """Return voltages (2, sensors, N) rotated by yaws (N,) in rad."""
    c, s = np.cos(yaw), np.sin(yaw)
    return np.array([c * seen[0] - s * seen[1], s * seen[0] + c * seen[1]])


def residuals(array: PlanarArray, read: Array, q: Array) -> Array:
    """Return measured (2, sensors, N) less modelled voltages, in the field's axes, V."""
    return rotate_voltages(read, q[2]) - volts(array, q)


def cost(array: PlanarArray, read: Array, q: Array) -> Array:
    """Return J (N,) in V^2."""
    return np.asarray((residuals(array, read, q) ** 2).sum(axis=(0, 1)))


def correction(array: PlanarArray, read: Array, q: Array, yaw_known: bool = False) -> Array:
    """Return the full correction (3, N) in m and rad, 0 where rank is lost in double precision."""
    w, free = array.wave_number, 2 if yaw_known else 3
    H = fisher.rows(array, np.array([w * q[0], w * q[1], q[2]])).jacobian[:free]
    e = residuals(array, read, q).reshape(-1, q.shape[1])
    N, right = np.einsum("imn,jmn->nij", H, H), np.einsum("imn,mn->ni", H, e)
    regular = np.abs(np.linalg.det(N)) > RANK * array.alpha ** (2 * free)
    step = np.zeros_like(q)
    step[:free, regular] = np.linalg.solve(N[regular], right[regular][:, :, None])[:, :, 0].T
    return step / np.array([[w], [w], [1.0]])


def iterate(
    array: PlanarArray, read: Array, q: Array, scale: float, corrections: int, yaw_known: bool = False
) -> Array:
    """Return q (3, N) after some corrections, for voltages (2, sensors, N) in the body's axes, V."""
    J, part = cost(array, read, q), np.full(q.shape[1], scale)
    for _ in range(corrections):
        tried = q + part * correction(array, read, q, yaw_known)
        then = cost(array, read, tried)
        lower = then < J
        q, J, part = np.where(lower, tried, q), np.where(lower, then, J), np.where(lower, scale, part / 2)
    return q
