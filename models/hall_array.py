"""Measurement model of two-axis Hall sensors on a body above a magnet matrix: voltages and their Jacobian.

         y ^    v                     body at (X, Y, Z), rotated by R = R_z(theta_z) R_y(theta_y) R_x(theta_x);
           |   /  sensor k            sensor k at r_k in the body, its axes u, v and n rotated by S_k from the body's:
           |  o---u                   by its angle about z and its misalignment; v is off the right angle by the skew
    body   +----------> x

    P_k = (X, Y, Z) + R r_k,    b = (R S_k)^T <B>(P_k)
    V_u = V_0u + g_u s b_u,     V_v = V_0v + g_v s (cos(skew) b_v - sin(skew) b_u)

with s = sensitivity times amplifier in V/T and <B> the mean over the sensor's sensitive volume, a box along u, v, n.
In the plane Z, theta_x and theta_y are fixed: [a; b] = s R(theta)^T B(P), 2 N voltages of the pose (X, Y, theta_z).

The mean is exact: a wave exp(i k.r - kappa z) is exp(i K.r) with K = (k, i kappa), and a box of sides d_j along q_j
multiplies it by prod_j sinc(K.q_j d_j / 2), where sinc(t) = sin(t)/t. For the sensors at hand and without tilt this is
1 - 1.4e-5 for the fundamental, 1 - 3.6e-4 for the 5th and 1 - 1.2e-3 for the 9th. The yaw changes these by 2e-10, 1e-7
and 1e-6 only: width and height nearly cancel because K.K = 0, and a square is isotropic to second order.

Source: Kawato, Kim, "A Novel Multi-DOF Precision Positioning Methodology Using Two-Axis Hall-Effect Sensors", sections
2 and 3, Figs. 5 to 7.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace
from math import cos, factorial, isfinite, pi, sin

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from models import concentrated_field
from models.concentrated_field import Wave
from models.hall_chain import Chain
from synth.base import column_maps
from synth.block import Exprs
from synth.errors import ModelError
from synth.plant import Plant, build
from synth.signals import Signal, signal_names
from synth.statespace import readonly

Array = NDArray[np.float64]
Pair = tuple[float, float]
Triple = tuple[float, float, float]

PLANAR = ("X", "Y", "theta_z")
SPATIAL = ("X", "Y", "Z", "theta_x", "theta_y", "theta_z")
TERMS = 7  # of sinc: the next is below 5e-17 up to t = 1/2, the 32nd harmonic for the default volume
HEIGHT = 3e-3  # m, of the sensors above the matrix, at which the paper gives the field


@dataclass(frozen=True)
class Sensor:
    """A two-axis sensor: its position in the body, in m, and the errors of its axes and voltages.

    `angle` and `misalignment`, about its own u, v and n, and `skew` are in rad; `gain` is relative, `offset` in V.
    """

    position: Triple
    angle: float = 0.0
    gain: Pair = (1.0, 1.0)
    offset: Pair = (0.0, 0.0)
    misalignment: Triple = (0.0, 0.0, 0.0)
    skew: float = 0.0


@dataclass(frozen=True)
class HallArray:
    """Sensors, their signal chain, and the sides of the sensitive volume along u, v, n in m.

    Raises ModelError without any sensor, or when a number is not finite or a side negative.
    """

    sensors: tuple[Sensor, ...]
    chain: Chain = field(default_factory=Chain)
    volume: Triple = (250e-6, 250e-6, 200e-6)

    def __post_init__(self) -> None:
        if not self.sensors:
            raise ModelError("a Hall array has no sensor: give at least one")
        for k, s in enumerate(self.sensors):
            if not all(map(isfinite, (*s.position, s.angle, *s.gain, *s.offset, *s.misalignment, s.skew))):
                raise ModelError(f"sensor {k} is {s}: every number must be finite")
        if not all(isfinite(side) and side >= 0 for side in self.volume):
            raise ModelError(f"the sensitive volume is {self.volume} m: its sides must be finite and not negative")


@dataclass(frozen=True, eq=False)
class Pose:
    """Position of the body's origin, (3, 1) in m, Z above the matrix, and its axes as columns (3, 3)."""

    at: ca.SX
    rotation: ca.SX


@dataclass(frozen=True, eq=False)
class Prediction:
    """Voltages (m, 1) in V and their Jacobian (m, n) in V/m and V/rad, as expressions in the coordinates q (n, 1)."""

    q: ca.SX
    volts: ca.SX
    jacobian: ca.SX

    def function(self, *free: ca.SX) -> ca.Function:
        """Return q -> (volts, jacobian); symbols of the field that are not numbers are further arguments."""
        return ca.Function("hall_array", [self.q, *free], [self.volts, self.jacobian])

    def measurement(self) -> ca.Function:
        """Return q -> volts, of a field without free symbols."""
        return ca.Function("volts", [self.q], [self.volts])

    def evaluate(self, poses: Array) -> Array:
        """Return the voltages (N, m) at poses (N, n), of a field without free symbols."""
        return column_maps.map_columns(self.measurement(), poses.T)[0].T


def sensors(places: Iterable[Pair]) -> HallArray:
    """Return sensors without errors at (x, y) in m in the body's plane, their axes along the body's."""
    return HallArray(tuple(Sensor((x, y, 0.0)) for x, y in places))


def point_sensors(places: Iterable[Pair], chain: Chain | None = None) -> HallArray:
    """Return sensors without errors and of zero volume, with a chain, at (x, y) in m in the body's plane."""
    return replace(sensors(places), chain=chain or Chain(), volume=(0.0, 0.0, 0.0))


def planar_pose(q: ca.SX, height: ca.SX | float = HEIGHT) -> Pose:
    """Return the pose of (X, Y, theta_z) in m and rad, the body's plane at a height in m above the matrix."""
    return Pose(ca.vertcat(q[0], q[1], height), _about_z(q[2]))


def spatial_pose(q: ca.SX) -> Pose:
    """Return the pose of (X, Y, Z, theta_x, theta_y, theta_z) in m and rad."""
    return Pose(q[:3], _about_z(q[5]) @ _about_y(q[4]) @ _about_x(q[3]))


def axes(sensor: Sensor) -> Array:
    """Return S (3, 3): the directions u, v, n of a sensor in the body as columns, v before its skew."""
    roll, pitch, turn = (ca.SX(angle) for angle in sensor.misalignment)
    return readonly(ca.evalf(_about_z(sensor.angle + turn) @ _about_y(pitch) @ _about_x(roll)).full())


def average_over_volume(wave: Wave, turn: ca.SX, volume: Triple) -> Wave:
    """Return a wave averaged over a box with sides in m along the columns of `turn` (3, 3).

    Exact to double precision while kappa times half a side stays below 1/2.
    """
    real, imaginary = ca.SX(1), ca.SX(0)
    for j, side in enumerate(volume):
        u, v = wave.kx * turn[0, j] + wave.ky * turn[1, j], wave.kappa * turn[2, j]
        a, b = _sinc((u**2 - v**2) * (side / 2) ** 2, 2 * u * v * (side / 2) ** 2)
        real, imaginary = real * a - imaginary * b, real * b + imaginary * a
    cosine = wave.cosine * real + wave.sine * imaginary
    return replace(wave, cosine=cosine, sine=wave.sine * real - wave.cosine * imaginary)


def voltages(array: HallArray, waves: Sequence[Wave], pose: Pose) -> ca.SX:
    """Return u and v of each sensor in turn, (2 N, 1) in V, for a body in the field of `waves`."""
    return ca.vertcat(*(_pair(sensor, array, waves, pose) for sensor in array.sensors))


def _pair(sensor: Sensor, array: HallArray, waves: Sequence[Wave], pose: Pose) -> ca.SX:
    turn = pose.rotation @ ca.SX(axes(sensor))
    at = pose.at + pose.rotation @ ca.SX(ca.DM(sensor.position))
    seen = [average_over_volume(wave, turn, array.volume) for wave in waves]
    B = concentrated_field.field(seen, *ca.vertsplit(at))
    b = turn.T @ ca.vertcat(B.x, B.y, B.z)
    flux = b[0], cos(sensor.skew) * b[1] - sin(sensor.skew) * b[0]
    return ca.vertcat(*(o + g * array.chain.gain * f for o, g, f in zip(sensor.offset, sensor.gain, flux, strict=True)))


def planar(array: HallArray, waves: Sequence[Wave], height: ca.SX | float = HEIGHT) -> Prediction:
    """Return the voltages for (X, Y, theta_z), the body's plane at a height in m above the matrix."""
    q = ca.vertcat(*(ca.SX.sym(name) for name in PLANAR))
    return _prediction(q, voltages(array, waves, planar_pose(q, height)))


def plant(array: HallArray, waves: Sequence[Wave], volts: Sequence[Signal], reach: float) -> Plant:
    """Return sensors on a body that moves in the plane at given speeds: dq/dt = v, within `reach`, m, at any yaw.

    `volts` are u and v of each sensor in turn.
    """
    states = [Signal(name, "m", -reach, reach, "of the body's origin over the matrix") for name in "XY"]
    states.append(Signal("yaw", "rad", -pi, pi, "of the body over the matrix"))
    speeds = [Signal(f"speed_{s.name}", f"{s.unit}/s", -10, 10, "of the body") for s in states]

    def physics(x: Exprs, u: Exprs, p: Exprs) -> tuple[Exprs, Exprs]:
        read = ca.vertsplit(voltages(array, waves, planar_pose(ca.vcat([x[s.name] for s in states]))))
        return {s.name: u[f"speed_{s.name}"] for s in states}, dict(zip(signal_names(volts), read, strict=True))

    return build("hall_sensors", states, speeds, volts, [], physics)


def spatial(array: HallArray, waves: Sequence[Wave]) -> Prediction:
    """Return the voltages for (X, Y, Z, theta_x, theta_y, theta_z), Z in m above the matrix."""
    q = ca.vertcat(*(ca.SX.sym(name) for name in SPATIAL))
    return _prediction(q, voltages(array, waves, spatial_pose(q)))


def prediction_along_x(spacing: float, waves: Sequence[Wave], height: ca.SX | float = HEIGHT) -> Prediction:
    """Return the two voltages for X alone, of sensors of B_X a spacing in m apart along X, at Y = 0 without yaw."""
    X = ca.SX.sym("X")
    pair = sensors([(0.0, 0.0), (spacing, 0.0)])
    both = voltages(pair, waves, planar_pose(ca.vertcat(X, 0, 0), height))
    return _prediction(X, ca.vertcat(both[0], both[2]))


def _prediction(q: ca.SX, volts: ca.SX) -> Prediction:
    return Prediction(q, volts, ca.jacobian(volts, q))


def _sinc(real: ca.SX, imaginary: ca.SX) -> tuple[ca.SX, ca.SX]:
    """Return the real and the imaginary part of sin(t)/t for t^2 = real + i imaginary."""
    a, b = ca.SX(0), ca.SX(0)
    for n in reversed(range(TERMS)):
        a, b = (-1) ** n / factorial(2 * n + 1) + a * real - b * imaginary, a * imaginary + b * real
    return a, b


def _about_x(angle: ca.SX) -> ca.SX:
    c, s = ca.cos(angle), ca.sin(angle)
    return ca.vertcat(ca.horzcat(1, 0, 0), ca.horzcat(0, c, -s), ca.horzcat(0, s, c))


def _about_y(angle: ca.SX) -> ca.SX:
    c, s = ca.cos(angle), ca.sin(angle)
    return ca.vertcat(ca.horzcat(c, 0, s), ca.horzcat(0, 1, 0), ca.horzcat(-s, 0, c))


def _about_z(angle: ca.SX) -> ca.SX:
    c, s = ca.cos(angle), ca.sin(angle)
    return ca.vertcat(ca.horzcat(c, -s, 0), ca.horzcat(s, c, 0), ca.horzcat(0, 0, 1))
