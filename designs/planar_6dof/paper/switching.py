"""Figures of two Hall sensors over a pitch: spacing (1), switching between them, and the inverse field (2), (3).

Two sensors on the platen's x axis give V_a and V_b over one pitch of travel. A sensor is sensitive where |dV/dx| is
large, which is where |V| is small. The position is read from the sensor with the smaller |V|.

Source: Yu, Kim, section 3.1, Figs. 3 and 4.
"""

from collections.abc import Mapping
from math import pi

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from designs.planar_6dof.paper.motors import constants
from models import halbach, planar_stage

Array = NDArray[np.float64]
Parameters = Mapping[str, float]

PUBLISHED = {p.name: p.value for p in planar_stage.PARAMETERS}
COUNT = 2000  # samples of a pitch, a multiple of 8
EDGES = np.arange(COUNT) / COUNT - 0.5  # in pitches, including the borders of the sections
PLACES = EDGES + 0.5 / COUNT  # in pitches, excluding the borders


def scan(p: Parameters, places: Array, harmonics: tuple[int, ...] = halbach.HARMONICS) -> Array:
    """Return voltages in V and slopes in V/m (4, N), V_a, V_b and their slopes, level at y = 0.

    `places` (N,) lie along x in pitches from a strong block; parameters that are not in `p` are as published.
    """
    parameters, X = {**PUBLISHED, **p}, ca.SX.sym("X")
    V = planar_stage.hall_voltages(
        dict.fromkeys(planar_stage.AXES, ca.SX(0)) | {"x": X}, constants(parameters), harmonics
    )
    pair = ca.vertcat(V["V_ax"], V["V_bx"])
    read = ca.Function("read", [X], [ca.vertcat(pair, ca.jacobian(pair, X))])
    return np.asarray(read.map(len(places))((places * parameters["l"]).reshape(1, -1)))


def phase(l: float, spacing: float) -> float:
    """Return the phase lead of the fundamental of V_b over that of V_a, -180 to 180 degrees."""
    a, b, *_ = (np.fft.fft(v)[1] for v in scan({"l": l, "spacing": spacing}, PLACES[:: COUNT // 100]))
    return float(np.degrees(np.angle(b / a)))


def switches(p: Parameters) -> int:
    """Return how often the sensor that is read changes over a pitch."""
    a, b, *_ = scan(p, PLACES)
    return _changes(np.abs(a) < np.abs(b))


def sections(p: Parameters) -> int:
    """Return how often the sensor that is read or a sign changes over a pitch."""
    a, b, *_ = scan(p, PLACES)
    return _changes(4 * (np.abs(a) < np.abs(b)) + 2 * (a > 0) + (b > 0))


def least_slope(p: Parameters, *harmonics: int) -> float:
    """Return the least over the greatest slope of the sensor that is read, with some harmonics of the field."""
    a, b, slope_a, slope_b = np.abs(scan(p, EDGES, harmonics))
    slope = np.where(a < b, slope_a, slope_b)
    return float(slope.min() / slope.max())


def inverse_errors(p: Parameters) -> Array:
    """Return the greatest errors in m of (2) where a sensor is read: as printed, by the arcsine, with harmonics."""
    voltage, read = scan(p, PLACES)[0], np.abs(PLACES) < 0.125
    amplitude = 2 * np.mean(voltage * np.sin(2 * pi * PLACES))
    angle, normalised = 2 * pi * PLACES[read], np.clip(voltage[read] / amplitude, -1, 1)
    angles = np.sin(np.sin(angle)), np.arcsin(np.sin(angle)), np.arcsin(normalised)
    return np.array([round(float(np.abs(v - angle).max()), 9) * p["l"] / (2 * pi) for v in angles])


def _changes(values: NDArray[np.int64] | NDArray[np.bool_]) -> int:
    """Return how often a periodic record changes."""
    return int(np.sum(values != np.roll(values, 1)))
