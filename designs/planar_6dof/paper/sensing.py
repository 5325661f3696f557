"""Audit of the Hall sensors: the spacing (1), their switching, and the inverse of the field in (2) and (3).

Two sensors on the platen's x read V_a and V_b over one pitch of travel. A sensor is sensitive where |dV/dx| is large,
which is where |V| is small: the one with the smaller |V| is read.
"""

from dataclasses import dataclass
from math import pi

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from designs.planar_6dof.paper.bench import MM, Bench
from models import halbach, planar_stage
from synth.report.audit import Outcome, Published, recomputes

Array = NDArray[np.float64]

COUNT = 2000  # places in a pitch, a multiple of 8
EDGES = np.arange(COUNT) / COUNT - 0.5  # in pitches, with the borders of the sections among them
PLACES = EDGES + 0.5 / COUNT  # without
SPACINGS = (1, 2, 3)  # n of (1)


@dataclass(frozen=True, eq=False)
class Scan:
    """Voltages of the sensors a and b in V and their slopes in V/m at some places (N,)."""

    a: Array
    b: Array
    slope_a: Array
    slope_b: Array


@recomputes("Y-29", "l", "Y-29.offset", "Y-29.step")
def spacing(bench: Bench, printed: Published) -> Outcome:
    """Recompute the phase between two sensors from their spacing."""
    l = bench.parameters["l"]
    apart = {n: (printed["offset"].value + printed["step"].value * n) * l for n in SPACINGS}
    phases = {n: _phase(scan(bench, PLACES[:: COUNT // 100], spacing=d)) for n, d in apart.items()}
    figures = [(f"phase for n = {n}", phase, "degrees") for n, phase in phases.items()]
    figures += [(f"spacing for n = {n}", d / MM, "mm") for n, d in apart.items()]
    return Outcome(figures, all(abs(abs(phase) - printed["phase"].value) < 1e-6 for phase in phases.values()))


@recomputes("Y-30", "l", "Delta", "height", "spacing")
def switching(bench: Bench, printed: Published) -> Outcome:
    """Recompute where the sensors switch, and how sensitive the one is that is read."""
    real = scan(bench, PLACES)
    read_a = np.abs(real.a) < np.abs(real.b)
    switches, sections = (_changes(v) for v in (read_a, 4 * read_a + 2 * (real.a > 0) + (real.b > 0)))
    fields = {"fundamental": (1,), "harmonics 1, 5, 9": halbach.HARMONICS}
    slopes = {name: _least_slope(scan(bench, EDGES, harmonics)) for name, harmonics in fields.items()}
    figures = [("switches in a pitch", float(switches), "1"), ("sections in a pitch", float(sections), "1")]
    figures += [(f"least slope that is read over the greatest, {name}", v, "1") for name, v in slopes.items()]
    agree = switches * printed["quarter"].value == 1 and sections == printed["sections"].value
    return Outcome(figures, agree and min(slopes.values()) > 0.5)


@recomputes("Y-31", "l", "Delta", "height")
def inverse(bench: Bench, printed: Published) -> Outcome:
    """Recompute the position by (2) as printed and by the arcsine, where a sensor is read."""
    voltage, read = scan(bench, PLACES).a, np.abs(PLACES) < 0.125
    amplitude = 2 * np.mean(voltage * np.sin(2 * pi * PLACES))
    angle, normalised = 2 * pi * PLACES[read], np.clip(voltage[read] / amplitude, -1, 1)
    angles = {
        "sin, pure sine": np.sin(np.sin(angle)),
        "arcsine, pure sine": np.arcsin(np.sin(angle)),
        "arcsine, harmonics 1, 5, 9": np.arcsin(normalised),
    }
    errors = {n: round(float(np.abs(v - angle).max()), 9) * bench.parameters["l"] / (2 * pi) for n, v in angles.items()}
    figures = [(f"greatest error, {name}", e * 1e6, "um") for name, e in errors.items()]
    limit = printed["noise"].value
    return Outcome(figures, errors["sin, pure sine"] < limit, errors["arcsine, pure sine"] < limit)


def scan(bench: Bench, places: Array, harmonics: tuple[int, ...] = halbach.HARMONICS, **changed: float) -> Scan:
    """Return what the sensors a and b read, level at y = 0, at `places` (N,) along x in pitches from a strong block."""
    p, X = bench.values(**changed), ca.SX.sym("X")
    pose = dict.fromkeys(planar_stage.AXES, ca.SX(0)) | {"x": X}
    V = planar_stage.hall_voltages(pose, p, harmonics)
    pair = ca.vertcat(V["V_ax"], V["V_bx"])
    read = ca.Function("read", [X], [ca.vertcat(pair, ca.jacobian(pair, X))])
    return Scan(*np.asarray(read.map(len(places))((places * bench.parameters["l"]).reshape(1, -1))))


def _phase(scanned: Scan) -> float:
    """Return by how many degrees the fundamental of b is ahead of that of a, -180 to 180."""
    a, b = (np.fft.fft(v)[1] for v in (scanned.a, scanned.b))
    return float(np.degrees(np.angle(b / a)))


def _changes(values: NDArray[np.int64] | NDArray[np.bool_]) -> int:
    """Return how often a periodic record changes."""
    return int(np.sum(values != np.roll(values, 1)))


def _least_slope(scanned: Scan) -> float:
    """Return the least over the greatest slope of the sensor with the smaller voltage."""
    read = np.where(np.abs(scanned.a) < np.abs(scanned.b), np.abs(scanned.slope_a), np.abs(scanned.slope_b))
    return float(read.min() / read.max())
