"""Data of Figs. 4 and 5 of the paper: the field over the target area, and sensors on a line.

Fig. 5 and (3): two sensors a spacing apart along X have voltages with the slopes V_1' and V_2'. The least slope of the
pair is the minimum of sqrt(V_1'^2 + V_2'^2) over X; noise over slope is the standard deviation of X. For a pure sine it
is largest, and constant over X, at a spacing of (1/4 + n/2) pitch.

Source: Kawato, Kim, "A Novel Multi-DOF Precision Positioning Methodology Using Two-Axis Hall-Effect Sensors", section
2, Figs. 4 and 5.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from models import hall_array
from models.concentrated_field import Wave, field
from synth.statespace import readonly

Array = NDArray[np.float64]

HARMONICS = (1, 5, 9, 13)  # the next is below 1e-4 T at 3 mm


@dataclass(frozen=True, eq=False)
class Surface:
    """B_X (n, n) in T over X (n,) and Y (n,) in m, the target area of a pitch by a pitch."""

    X: Array
    Y: Array
    B_X: Array


@dataclass(frozen=True, eq=False)
class Line:
    """The voltages `volts` (2, n) of two sensors a spacing apart, and their `slopes` in V/m, over X (n,) in m."""

    X: Array
    volts: Array
    slopes: Array


@dataclass(frozen=True, eq=False)
class Spacings:
    """The least slope of a pair over the pitch, `least` (n,) in V/m, over `spacing` (n,) in m."""

    spacing: Array
    least: Array


def surface(waves: Sequence[Wave], points: int = 65, z: float = 3e-3) -> Surface:
    """Return Fig. 4: B_X on a grid over a pitch, z in m above the matrix, of waves without symbols."""
    X, Y = ca.SX.sym("X"), ca.SX.sym("Y")
    B = field(waves, X, Y, ca.SX(z))
    side = np.linspace(0.0, _pitch(waves), points)
    grid = (each.reshape(1, -1) for each in np.meshgrid(side, side, indexing="ij"))
    flux = ca.Function("B_X", [X, Y], [B.x]).map(points**2)(*grid)
    return Surface(readonly(side), readonly(side), readonly(flux.full().reshape(points, points)))


def spacings(count: int, pitch: float) -> Array:
    """Return the spacings (1/4 + n/2) pitch, n = 1 .. count, in the pitch's unit. Source: (3)."""
    return readonly((0.25 + 0.5 * np.arange(1, count + 1)) * pitch)


def line(waves: Sequence[Wave], spacing: float, points: int = 257, height: float = hall_array.HEIGHT) -> Line:
    """Return Fig. 5: voltages of two sensors a spacing in m apart over a pitch of waves without symbols."""
    X = np.linspace(0.0, _pitch(waves), points)
    volts, slopes = _evaluate(hall_array.prediction_along_x(spacing, waves, height), X)
    return Line(readonly(X), readonly(volts), readonly(slopes))


def least_slopes(waves: Sequence[Wave], points: int = 480, height: float = hall_array.HEIGHT) -> Spacings:
    """Return the least slope of two sensors over spacings up to two pitches, in waves without symbols.

    X and the spacings share a grid of `points` a pitch, which contains the spacings of (3) if 4 divides it.
    """
    grid = readonly(_pitch(waves) / points * np.arange(2 * points + 1))
    slopes = _evaluate(hall_array.prediction_along_x(0.0, waves, height), grid[:points])[1]
    squares = slopes[0] ** 2
    least = [np.sqrt((squares + np.roll(squares, -shift)).min()) for shift in range(len(grid))]
    return Spacings(grid, readonly(least))


def _pitch(waves: Sequence[Wave]) -> float:
    first = waves[0]
    return float(2 * np.pi * np.hypot(*first.order) / float(first.kappa))


def _evaluate(prediction: hall_array.Prediction, X: Array) -> tuple[Array, Array]:
    volts, slopes = prediction.function().map(len(X))(X[None, :])
    return volts.full(), slopes.full()
