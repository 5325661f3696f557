"""Two-axis Hall sensors in a field of two waves along each axis: model (2) without gamma and delta, in volts.

    in the plane    B_X(X) = c + alpha sin(w X) + beta sin(5 w X),   B_Y likewise in Y,   w = 2 pi / pitch
    over the gap    B = -grad Phi,   a_1 = alpha, a_5 = beta
                    Phi = sum over n = 1, 5 of a_n / (n w) exp(-n w (Z - height)) (cos(n w X) + cos(n w Y))

This B_X agrees with the first at the height, without c: subtract the sensors' offsets first.

Source: Kawato, Kim, "A Novel Multi-DOF Precision Positioning Methodology Using Two-Axis Hall-Effect Sensors", (2),
section 3.A, Fig. 6 (b).
"""

from collections.abc import Iterable
from dataclasses import dataclass, replace
from functools import cache
from math import hypot, pi, sqrt
from typing import Any, TypeVar

import casadi as ca
import numpy as np
from numpy.typing import ArrayLike

from models import concentrated_field, hall_array
from models.concentrated_field import Wave
from models.hall_array import Array, HallArray, Pair, Triple
from synth import numeric
from synth.base import column_maps
from synth.errors import ModelError
from synth.statespace import readonly

MIN_SENSORS = 3  # sensors of two axes for six unknowns


class _Periodic:
    """Array in a field with a pitch in m, of sensors at `arms` in rad of phase."""

    pitch: float
    arms: Any

    @property
    def wave_number(self) -> float:
        """Return w, rad/m."""
        return 2 * pi / self.pitch

    @property
    def longest_arm(self) -> float:
        """Return the largest |x| + |y| of the arms, rad."""
        return max(abs(x) + abs(y) for x, y, *_ in self.arms)

    def yaw_within(self, phase: float) -> float:
        """Return the yaw T in rad that moves no sensor by more than a phase in rad: longest_arm (T + T^2/2) = phase."""
        return sqrt(1 + 2 * phase / self.longest_arm) - 1

    def _check(self, positive: Iterable[str], finite: Iterable[str]) -> None:
        """Convert fields to floats; raise ModelError for one that is not a number, or not above 0 where it must be."""
        for name in positive:
            object.__setattr__(self, name, numeric.positive(name, getattr(self, name)))
        for name in finite:
            object.__setattr__(self, name, numeric.number(name, getattr(self, name)))


@dataclass(frozen=True)
class PlanarArray(_Periodic):
    """Sensors at `positions` in the body, m, their field in V, and the noise `deviation` of each axis, V.

    Positions may be lists or an array. Raises ModelError for fewer than two places, more than 26 sensors, or a value
    that is not a number or out of its range.
    """

    positions: tuple[Pair, ...]
    c: float
    alpha: float
    beta: float
    pitch: float = 0.0508
    deviation: float = 1e-3

    def __post_init__(self) -> None:
        object.__setattr__(self, "positions", numeric.positions(self.positions, 2))
        if len(set(self.positions)) < 2:
            raise ModelError(f"sensors are at {self.positions}: the yaw needs two places, give another one")
        self._check(("alpha", "pitch", "deviation"), ("c", "beta"))

    @property
    def centre(self) -> Pair:
        """Return the mean of the positions, m: the estimated point, where X, Y and yaw are least coupled."""
        n = len(self.positions)
        return sum(x for x, _ in self.positions) / n, sum(y for _, y in self.positions) / n

    @property
    def arms(self) -> tuple[Pair, ...]:
        """Return the positions from the centre, as phases, rad."""
        w, (x0, y0) = self.wave_number, self.centre
        return tuple((w * (x - x0), w * (y - y0)) for x, y in self.positions)

    @property
    def radius(self) -> float:
        """Return the root mean square of the arms, rad of phase by rad of yaw."""
        return sqrt(sum(hypot(*arm) ** 2 for arm in self.arms) / len(self.arms))


@dataclass(frozen=True)
class SpatialArray(_Periodic):
    """Sensors at `positions` in the body, m, and their field at a `height` in m above the matrix, V.

    Their axes are along the body's x and y, each with noise `deviation`, V. Positions may be lists or an array.

    Raises ModelError for fewer than three places or more than 26 sensors, for places all above one another,
    or a value that is not a number or out of its range.
    """

    positions: tuple[Triple, ...]
    alpha: float
    beta: float
    height: float = 3e-3
    pitch: float = 0.0508
    deviation: float = 1e-3

    def __post_init__(self) -> None:
        object.__setattr__(self, "positions", numeric.positions(self.positions, 3))
        if len(set(self.positions)) < MIN_SENSORS:
            raise ModelError(
                f"{len(set(self.positions))} sensors have fewer than six voltages: give {MIN_SENSORS} places or more"
            )
        if len({r[:2] for r in self.positions}) < 2:
            raise ModelError(
                f"all sensors are at x, y = {self.positions[0][:2]} m, above one another: their voltages differ by the "
                "decay with Z alone, which separates rotations poorly from displacements; give places apart in x and y"
            )
        self._check(("alpha", "height", "pitch", "deviation"), ("beta",))

    @property
    def arms(self) -> tuple[Triple, ...]:
        """Return the positions as phases, rad."""
        w = self.wave_number
        return tuple((w * x, w * y, w * z) for x, y, z in self.positions)

    @property
    def radius(self) -> float:
        """Return the root mean square of the arms in the body's plane, rad of phase by rad of turn."""
        return sqrt(sum(x * x + y * y for x, y, _ in self.arms) / len(self.arms))


AnyArray = TypeVar("AnyArray", PlanarArray, SpatialArray)


def with_positions(array: AnyArray, places: ArrayLike | tuple[Pair, ...]) -> AnyArray:
    """Return an array with its sensors at places in the body's plane, in pitches; raise ModelError for no places."""
    at = [(x * array.pitch, y * array.pitch) for x, y in numeric.rows("places", places, 2)]
    if isinstance(array, PlanarArray):
        return replace(array, positions=tuple(at))
    return replace(array, positions=tuple((x, y, 0.0) for x, y in at))


def poses(pitch: float, points: int, yaws: ArrayLike = 0.0, shift: float = 0.0) -> Array:
    """Return a grid (3, N) of X, Y in m and yaws in rad over a pitch in m, X changing slowest, by `shift` of a step.

    Raises ModelError for no points, or a yaw that is not finite.
    """
    points = numeric.whole("the number of poses along the pitch", points)
    turns = numeric.table("the yaws", np.reshape(yaws, (-1, 1)), 1)[:, 0]
    along = pitch * (np.arange(points) + shift) / points
    return readonly([each.ravel() for each in np.meshgrid(along, along, turns, indexing="ij")])


def level(array: SpatialArray, q: Array) -> Array:
    """Return poses (N, 6) of a level body at the array's height, at X, Y and yaws (3, N)."""
    none = np.zeros_like(q[0])
    return readonly(np.column_stack([q[0], q[1], none + array.height, none, none, q[2]]))


def model(array: AnyArray) -> tuple[HallArray, tuple[Wave, ...]]:
    """Return the equivalent sensors and waves of `hall_array`: zero volume, two waves along each axis."""
    if isinstance(array, SpatialArray):
        height, sensors = (
            array.height,
            HallArray(tuple(map(hall_array.Sensor, array.positions)), volume=(0.0, 0.0, 0.0)),
        )
    else:
        height, sensors = hall_array.HEIGHT, hall_array.point_sensors(array.positions)
    amplitudes = {1: array.alpha / sensors.chain.gain, 5: array.beta / sensors.chain.gain}
    return sensors, concentrated_field.waves_from_amplitudes(amplitudes, height, {"l": ca.SX(array.pitch)})


def check_poses(poses: ArrayLike) -> Array:
    """Return poses (N, 6) of X, Y, Z and angles; raise ModelError for another shape, none, or infinite values."""
    return numeric.table("the poses of X, Y, Z, roll, pitch, yaw", poses, len(hall_array.SPATIAL))


def rows(array: SpatialArray, poses: ArrayLike) -> Array:
    """Return the Jacobians (N, 2 sensors, 6) in V/m and V/rad at poses (N, 6) in m and rad; raise as `check_poses`."""
    q = check_poses(poses).T
    field = np.array([array.alpha, array.beta, array.height, array.pitch])
    slopes = (column_maps.map_columns(_one(), q, np.array(r), field)[0] for r in array.positions)
    jacobians = [each.reshape(2, -1, len(q)) for each in slopes]
    return readonly(np.concatenate(jacobians).transpose(1, 0, 2))


@cache
def _one() -> ca.Function:
    """Return the Jacobian (2, 6) of a sensor by the pose, its place in the body and (alpha, beta, height, pitch)."""
    q, r, field = (ca.SX.sym(name, n) for name, n in (("q", len(hall_array.SPATIAL)), ("r", 3), ("field", 4)))
    pose, (alpha, beta, height, pitch) = hall_array.spatial_pose(q), ca.vertsplit(field)
    waves = concentrated_field.waves_from_amplitudes({1: alpha, 5: beta}, height, {"l": pitch})
    B = concentrated_field.field(waves, *ca.vertsplit(pose.at + pose.rotation @ r))
    volts = (pose.rotation.T @ ca.vertcat(B.x, B.y, B.z))[:2]
    return ca.Function("sensor", [q, r, field], [ca.jacobian(volts, q)])
