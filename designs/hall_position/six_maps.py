"""What the voltages tell of all six degrees of freedom at each pose: Cramer-Rao deviations, and errors of the field.

With the Jacobian H (m, 6) of the voltages and noise of the standard deviation sigma in each, independent,

    cov (X, Y, Z, roll, pitch, yaw) >= sigma^2 (H'H)^-1 = sigma^2 V S^-2 V',    H = U S V',

and the condition number is that of H with angles counted at a lever, S_1 / S_6 of H diag(1, 1, 1, 1/lever, ..). What
the field has beyond the model moves the estimate besides, to first order by (H'H)^-1 H' (V - model), each time alike.

Deviations are proportional to sigma: those here are of the array's own, 1 mV unless given.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import radians

import casadi as ca
import numpy as np
from numpy.typing import ArrayLike, NDArray

from designs.hall_position import figures, six_field, six_layout
from designs.hall_position.six_parameters import Array
from models import hall_array
from models.concentrated_field import Wave
from models.hall_array import HallArray
from synth import show
from synth.errors import ModelError
from synth.statespace import readonly

Numbers = NDArray[np.float64]

LEVER = 25.4e-3  # m, half a pitch
POINTS = 64  # along a pitch
UNITS = ("X [um]", "Y [um]", "Z [um]", "roll [urad]", "pitch [urad]", "yaw [urad]")
# By name: how much the gap is larger, m, and roll, pitch and yaw, rad.
CONDITIONS: dict[str, tuple[float, float, float, float]] = {
    "level at the height": (0.0, 0.0, 0.0, 0.0),
    "0.5 mm nearer": (-0.5e-3, 0.0, 0.0, 0.0),
    "0.5 mm further": (0.5e-3, 0.0, 0.0, 0.0),
    "rolled 10 mrad": (0.0, 10e-3, 0.0, 0.0),
    "pitched 10 mrad": (0.0, 0.0, 10e-3, 0.0),
    "turned 5 deg": (0.0, 0.0, 0.0, radians(5)),
    "turned -5 deg": (0.0, 0.0, 0.0, radians(-5)),
    "all of them": (0.5e-3, 10e-3, -10e-3, radians(5)),
}


@dataclass(frozen=True, eq=False)
class Accuracy:
    """At poses (n, 6): deviations (n, 6) in m and rad, inf where rank is lost, and condition numbers (n,)."""

    poses: Numbers
    deviations: Numbers
    condition: Numbers


@show.printed
@dataclass(frozen=True, eq=False, repr=False)
class Map:
    """Over the pitch, by conditions or sensors lost: largest and median deviations (n, 6), m and rad, and condition."""

    title: str
    names: tuple[str, ...]
    worst: Numbers
    median: Numbers
    condition: Numbers

    def sheet(self) -> show.Sheet:
        """Return largest and median deviations by row, in um and urad."""
        sized = [np.column_stack([1e6 * self.worst, self.condition]), np.column_stack([1e6 * self.median])]
        tables = (
            show.matrix("largest", sized[0], self.names, (*UNITS, "condition")),
            show.matrix("median", sized[1], self.names, UNITS),
        )
        return show.Sheet(self.title, tables=tables)


def accuracy(array: Array, poses: ArrayLike, lever: float = LEVER) -> Accuracy:
    """Return what an array tells at poses (n, 6) in m and rad, by the model of two waves.

    Raises ModelError for poses of another shape or that are not finite, or a lever that is not above 0.
    """
    at = _checked(poses, lever)
    return _accuracy(six_field.rows(array, at), at, array.deviation, lever)


def accuracy_of(array: HallArray, waves: Sequence[Wave], poses: ArrayLike, lever: float = LEVER) -> Accuracy:
    """Return what sensors with whatever errors tell at poses (n, 6), in any waves without symbols.

    Raises as `accuracy`.
    """
    at = _checked(poses, lever)
    return _accuracy(six_field.jacobians(array, waves, at), at, array.chain.noise, lever)


def _checked(poses: ArrayLike, lever: float) -> Numbers:
    figures.positive("the lever", lever)
    return six_field.checked(poses)


def _accuracy(jacobians: Numbers, at: Numbers, deviation: float, lever: float) -> Accuracy:
    size = six_layout.sizes(lever)
    S, V = np.linalg.svd(jacobians / size, full_matrices=False)[1:]
    lost = S[:, 5] <= S[:, 0] * np.finfo(np.float64).eps * jacobians.shape[1]
    with np.errstate(divide="ignore"):
        condition = np.where(lost, np.inf, S[:, 0] / np.where(lost, 1.0, S[:, 5]))
    squares = ((V / np.where(lost[:, None], 1.0, S)[:, :, None]) ** 2).sum(axis=1)
    found = np.where(lost[:, None], np.inf, deviation * np.sqrt(squares) / size)
    return Accuracy(readonly(at), readonly(found), readonly(condition))


def cell(array: Array, condition: tuple[float, float, float, float], points: int = POINTS) -> Numbers:
    """Return a grid of poses (points^2, 6) over the pitch, X changing slowest, under one of CONDITIONS."""
    further, *angles = figures.rows("conditions", [condition], 4)[0]
    return readonly(six_layout.poses(array, 0.0, (points, 1)) + np.array([0.0, 0.0, further, *angles]))


def conditions(array: Array, points: int = POINTS) -> Map:
    """Return the map of an array under CONDITIONS."""
    found = {name: accuracy(array, cell(array, each, points)) for name, each in CONDITIONS.items()}
    return _map("Standard deviations in six degrees of freedom", found)


def losses(array: Array, condition: str = "level at the height", points: int = POINTS) -> Map:
    """Return the map of an array with all sensors, and after the loss of each.

    Raises ModelError for an array that has no sensor to spare, or a condition that is none of CONDITIONS.
    """
    if condition not in tuple(CONDITIONS):
        raise ModelError(f"'{condition}' is no condition: give one of {', '.join(CONDITIONS)}")
    n = len(array.positions)
    if n < 5:
        raise ModelError(f"{n} sensors have none to spare: four are needed everywhere, give five or more")
    at = cell(array, CONDITIONS[condition], points)
    found = {"all": accuracy(array, at)}
    for k in range(n):
        left = replace(array, positions=(*array.positions[:k], *array.positions[k + 1 :]))
        found[f"without {chr(ord('a') + k)}"] = accuracy(left, at)
    return _map(f"Standard deviations after the loss of a sensor, {condition}", found)


def _map(title: str, found: dict[str, Accuracy]) -> Map:
    worst = readonly([a.deviations.max(axis=0) for a in found.values()])
    median = readonly([np.median(a.deviations, axis=0) for a in found.values()])
    return Map(title, tuple(found), worst, median, readonly([a.condition.max() for a in found.values()]))


def misfit(array: Array, sensors: HallArray, waves: Sequence[Wave], poses: ArrayLike) -> Numbers:
    """Return the errors (n, 6), m and rad, at poses (n, 6) when `sensors` are in the field of `waves`.

    To first order. Raises ModelError as `accuracy`, for unlike numbers of sensors, or where rank is lost.
    """
    at = _checked(poses, LEVER)
    if len(sensors.sensors) != len(array.positions):
        raise ModelError(
            f"{len(sensors.sensors)} sensors meet {len(array.positions)} of the model: give as many of each"
        )
    lost = np.flatnonzero(~np.isfinite(accuracy(array, at).condition))
    if lost.size:
        raise ModelError(f"rank is lost at {lost.size} of the poses, the first is {at[lost[0]]}: leave it out")
    extra = _voltages(sensors, waves, at) - _voltages(*six_field.model(array), at)
    H = six_field.rows(array, at) / six_layout.sizes(LEVER)
    found = np.linalg.solve(H.transpose(0, 2, 1) @ H, H.transpose(0, 2, 1) @ extra[:, :, None])[:, :, 0]
    return readonly(found / six_layout.sizes(LEVER))


def _voltages(array: HallArray, waves: Sequence[Wave], at: Numbers) -> Numbers:
    q = ca.SX.sym("q", 6)
    f = ca.Function("volts", [q], [hall_array.voltages(array, waves, hall_array.spatial_pose(q))])
    return np.asarray(f.map(len(at))(at.T).full().T)
