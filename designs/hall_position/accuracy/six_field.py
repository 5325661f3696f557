"""Voltages of two-axis sensors for all six degrees of freedom, and what they tell of each: the gap's part in it.

A wave of the number n decays as exp(-n w Z), and the three components of B go over into one another:

    B_X = sum_n a_n E_n sin(n w X),   B_Z = sum_n a_n E_n (cos(n w X) + cos(n w Y)),    E_n = exp(-n w (Z - height))

            [  g_X    0      -f_X      ]    g = sum n w a_n E_n cos(n w X), f = sum n w a_n E_n sin(n w X)
    grad B =[   0    g_Y     -f_Y      ]
            [ -f_X  -f_Y  -(g_X + g_Y) ]    symmetric, without trace

A sensor at r in a body at (X, Y, Z), turned by R = R_z(yaw) R_y(pitch) R_x(roll), reads e.B with e = R x or R y, at
the place (X, Y, Z) + o, o = R r. For small motions dP of the body and turns omega of it

    d(e.B) = p.dP + (e x B + o x p).omega,   p = grad B e,    omega = R x d(roll) + R_z y d(pitch) + z d(yaw).

Z is seen by how strong the field is, and tilts are by how Z differs from sensor to sensor, and by B_Z.

Source: Kawato, Kim, "Multi-Degree-of-Freedom Precision Position Sensing", section 3.A.
"""

from collections.abc import Sequence

import casadi as ca
import numpy as np
from numpy.typing import ArrayLike, NDArray

from designs.hall_position.glsdc.six_parameters import Array, Triple
from models import concentrated_field, hall_array
from models.concentrated_field import Wave
from models.hall_array import HallArray
from models.hall_scan import Fit
from synth import numeric
from synth.errors import ModelError

Numbers = NDArray[np.float64]

NUMBERS = (1, 5)
POSE = hall_array.SPATIAL


def seen(array: HallArray, waves: Sequence[Wave], height: float, pitch: float) -> Array:
    """Return the fundamental and the 5th wave of a matrix, without symbols, as sensors see them, m and V.

    The mean over a sensor's volume is in alpha and beta, for a body without tilt; sensors are taken to have no errors.

    Raises ModelError for a sensor that is turned, waves that lack one of these, or a height that is not positive.
    """
    height = numeric.positive("height", height)
    if any(s.angle or s.skew or any(s.misalignment) for s in array.sensors):
        raise ModelError("a sensor is turned in its body: turn its voltages back, and give it without angles")
    found = {w.order: hall_array.averaged(w, ca.SX.eye(3), array.volume) for w in waves}
    if missing := [n for n in NUMBERS if (n, 0) not in found]:
        raise ModelError(f"the waves lack the number {missing[0]} along X: give those of 1 and 5")
    alpha, beta = (
        array.chain.gain * float(ca.DM(ca.evalf(concentrated_field.amplitude(found[n, 0], height)))) for n in NUMBERS
    )
    return Array(tuple(s.position for s in array.sensors), alpha, beta, height, pitch, array.chain.noise)


def scanned(fit: Fit, positions: tuple[Triple, ...], height: float, pitch: float, deviation: float) -> Array:
    """Return an array, m and V, whose field is that of `scan.fit_over_gap` at a height."""
    return Array(positions, fit.estimate["alpha"], fit.estimate["beta"], height, pitch, deviation)


def model(array: Array) -> tuple[HallArray, tuple[Wave, ...]]:
    """Return the sensors and waves of `models` that read as `array`: sensors of no volume and two waves each way."""
    sensors = HallArray(tuple(hall_array.Sensor(r) for r in array.positions), volume=(0.0, 0.0, 0.0))
    gain = sensors.chain.gain
    amplitudes = {1: array.alpha / gain, 5: array.beta / gain}
    return sensors, concentrated_field.fitted(amplitudes, array.height, {"l": ca.SX(array.pitch)})


def checked(poses: ArrayLike) -> Numbers:
    """Return poses (N, 6) of POSE; raise ModelError for another shape, none, or what is not finite."""
    return numeric.table("the poses of X, Y, Z, roll, pitch, yaw", poses, len(POSE))


def rotation(roll: Numbers, pitch: Numbers, yaw: Numbers) -> Numbers:
    """Return the body's axes (3, 3, N) as columns, at angles (N,) in rad."""
    (a, b, c), (s, t, u) = (f([roll, pitch, yaw]) for f in (np.cos, np.sin))
    return np.array(
        [
            [c * b, c * t * s - u * a, c * t * a + u * s],
            [u * b, u * t * s + c * a, u * t * a - c * s],
            [-t, b * s, b * a],
        ]
    )


def rows(array: Array, poses: ArrayLike) -> Numbers:
    """Return the Jacobians (N, m, 6) in closed form, in V/m and V/rad at poses (N, 6) of POSE, m and rad.

    Raises ModelError as `checked`.
    """
    q = checked(poses).T
    R = rotation(*q[3:])
    turns = np.array([R[:, 0], [-np.sin(q[5]), np.cos(q[5]), 0 * q[5]], np.eye(3)[2][:, None] + 0 * q[5]])
    found = []
    for r in array.positions:
        o = np.einsum("ijn,j->in", R, r)
        B, slope = _field(array, q[:3] + o)
        for e in (R[:, 0], R[:, 1]):
            p = np.einsum("ijn,jn->in", slope, e)
            turn = np.cross(e, B, axis=0) + np.cross(o, p, axis=0)
            found.append(np.vstack([p, np.einsum("kin,in->kn", turns, turn)]))
    return np.array(found).transpose(2, 0, 1)


def _field(array: Array, at: Numbers) -> tuple[Numbers, Numbers]:
    """Return B (3, N) in V and its gradient (3, 3, N) in V/m at places (3, N) in m."""
    w = array.wave_number
    S, C, f, g = np.zeros((4, 2, at.shape[1]))
    for n, a in zip(NUMBERS, (array.alpha, array.beta), strict=True):
        size = a * np.exp(-n * w * (at[2] - array.height))
        s, c = size * np.sin(n * w * at[:2]), size * np.cos(n * w * at[:2])
        S, C, f, g = S + s, C + c, f + n * w * s, g + n * w * c
    none = np.zeros_like(S[0])
    slope = [[g[0], none, -f[0]], [none, g[1], -f[1]], [-f[0], -f[1], -g.sum(axis=0)]]
    return np.array([*S, C.sum(axis=0)]), np.array(slope)
