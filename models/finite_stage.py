"""The planar stage over a finite magnet matrix, whose blocks' field drives the motors and the Hall sensors.

With the force F_i and torque T_i of each motor in the frame of the platen (`models.finite_motor`), at its centre r_i,

    M (x'', y'')  = R(phi) sum F_i,xy             Izz phi''   = sum (a_i F_y - b_i F_x + T_z)     r_i = (a_i, b_i)
    M z''         = sum F_z - Kz z                Ixx theta'' = sum (b_i F_z + T_x) - K_theta theta
                                                  Iyy psi''   = sum (-a_i F_z + T_y) - K_psi psi

which are (18)-(20) with the terms that the closed force law neglects: forces across a motor's motion and torques about
its own centre. That centre is as high as the mass centre, as in (18)-(20). F_i and T_i are linear in the phase
currents; at a lift d and a yaw phi, within 0.3 mm and 20 mrad, the map is

    exp(-2 pi d / l) (W + d W_lift) + phi W_yaw

with tables of W, W_lift and W_yaw over the matrix. A tilt only lifts a motor's centre.
Motor C is one of the others rotated by -90 degrees, and the matrix is its own mirror image in X = Y with every magnet
reversed: its map at (X, Y), phi is theirs at (Y, X), -phi with x and y exchanged and torques reversed.

The gain of the Hall sensors makes the fundamental in the middle pitch equal to that of `models.halbach`, for which the
controllers are calibrated. The tables hold for one l, w, Nm, area and Delta: with another value everything is NaN.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from math import pi

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from models import finite_matrix, finite_motor, finite_tables, halbach, hall_sensor, lorentz_motor, planar_stage
from models.finite_matrix import VALUES, Blocks, Series
from models.halbach import Field
from models.planar_stage import Place
from synth.plant import Plant, build
from synth.statespace import Array

Exprs = Mapping[str, ca.SX]

MOTOR_RANGE, SENSOR_RANGE = 0.131, 0.152  # m: half widths of the tables: travel plus arms
FORCE_HARMONICS, FIELD_HARMONICS = 16, 24  # of a pitch
HEIGHT = next(p.value for p in planar_stage.PARAMETERS if p.name == "height")  # m
FIXED = ("l", "w", "Nm", "area", "Delta")
FORCE, TORQUE, FLUX = 2e-3, 5e-5, 2e-5  # N/A, N m/A, T: largest error of the tables' sums of products
RANGE = {"value": 1.0, "lift": 3e-4, "yaw": 0.02}  # the largest factor of each table: 1, m, rad
COMPONENTS, PHASES = finite_motor.COMPONENTS, finite_motor.PHASES


@dataclass(frozen=True, eq=False)
class Tables:
    """Functions of (X, Y) in m: a motor's wrenches (54,) by order, phase, component; B_X with its lift term (2,)."""

    motor: ca.Function
    flux: ca.Function
    amplitude: float  # T: of the fundamental of B_X in the middle pitch


@cache
def tables(made: bool, end_turns: float) -> Tables:
    """Return the tables of the matrix as built, or of ideal blocks."""
    blocks = finite_matrix.fabricated_blocks() if made else finite_matrix.ideal_blocks()
    return Tables(_motor(blocks, end_turns), *_flux(blocks))


def _motor(blocks: Blocks, end_turns: float) -> ca.Function:
    series = finite_matrix.series(blocks, FORCE_HARMONICS)
    cases = [(order, phase) for order in finite_motor.ORDERS for phase in PHASES]
    values = [finite_motor.maps(series, phase, order, MOTOR_RANGE, end_turns) for order, phase in cases]
    bounds = [each / RANGE[order] for order, _ in cases for each in 3 * [FORCE] + 3 * [TORQUE]]
    return finite_tables.function("motor", series.grid(MOTOR_RANGE), np.concatenate(values), bounds)


def _flux(blocks: Blocks) -> tuple[ca.Function, float]:
    series = finite_matrix.series(blocks, FIELD_HARMONICS)
    value, slope = (finite_matrix.flux_density(series, HEIGHT, order)[0] for order in (0, 1))
    values = [series.evaluate(c, SENSOR_RANGE) for c in (value, slope + finite_motor.DECAY * value)]
    bounds = [FLUX, FLUX / RANGE["lift"]]
    return finite_tables.function("flux", series.grid(SENSOR_RANGE), np.array(values), bounds), _amplitude(
        series, value
    )


def _amplitude(series: Series, flux: finite_matrix.Complex) -> float:
    pitch = series.evaluate(flux, VALUES["l"] / 2)[:-1, :-1]
    angle = 2 * pi / VALUES["l"] * series.grid(VALUES["l"] / 2)[:-1]
    return float(2 * np.mean(pitch * np.sin(angle)[:, None]))


def wrenches(x: Exprs, u: Exprs, p: Exprs, fitted: Tables) -> dict[str, dict[str, ca.SX]]:
    """Return each motor's forces in N and torques in N m in the platen's frame, by COMPONENTS."""
    scale = _scale(p) * p["turns"] / VALUES["turns"]
    by_motor = {}
    for motor, at in planar_stage.centres(x, p).items():
        rear, lift = motor == "C", at.lift + p["z0"] - VALUES["z0"]
        where, phi = ((at.Y, at.X), -x["phi"]) if rear else ((at.X, at.Y), x["phi"])
        value, lifted, yawed = ca.vertsplit(fitted.motor(*where), len(PHASES) * len(COMPONENTS))
        per_phase = ca.exp(-finite_motor.DECAY * lift) * (value + lift * lifted) + phi * yawed
        currents = ca.vertcat(*(u[f"i_{motor}{phase}"] for phase in PHASES))
        w = scale * ca.reshape(per_phase, len(COMPONENTS), len(PHASES)) @ currents
        wrench = dict(zip(COMPONENTS, ca.vertsplit(w), strict=True))
        by_motor[motor] = _mirrored(wrench) if rear else wrench
    return by_motor


def _mirrored(w: Exprs) -> dict[str, ca.SX]:
    """Return the wrench mirrored in X = Y, for reversed currents."""
    forces = {"f_x": w["f_y"], "f_y": w["f_x"], "f_z": w["f_z"]}
    return forces | {"m_x": -w["m_y"], "m_y": -w["m_x"], "m_z": -w["m_z"]}


def _scale(p: Exprs) -> ca.SX:
    """Return the remanence over that of the tables, NaN where the tables do not hold."""
    same = [p[name] == VALUES[name] for name in FIXED]
    return ca.if_else(ca.sum1(ca.vertcat(*same)) == len(FIXED), p["mu0_M0"] / VALUES["mu0_M0"], ca.SX(np.nan))


def accelerations(x: Exprs, u: Exprs, p: Exprs, fitted: Tables) -> dict[str, ca.SX]:
    """Return the six accelerations in m/s^2 and rad/s^2."""
    w = wrenches(x, u, p, fitted)
    arms = {"A": (-p["a"], -p["b"]), "B": (p["a"], -p["b"]), "C": (ca.SX(0), p["c"])}
    total = {name: sum((each[name] for each in w.values()), start=ca.SX(0)) for name in COMPONENTS}
    yaw, roll, pitch = total["m_z"], total["m_x"], total["m_y"]
    for motor, (a, b) in arms.items():
        yaw += a * w[motor]["f_y"] - b * w[motor]["f_x"]
        roll += b * w[motor]["f_z"]
        pitch -= a * w[motor]["f_z"]
    c, s = ca.cos(x["phi"]), ca.sin(x["phi"])
    return {
        "x": (c * total["f_x"] - s * total["f_y"]) / p["M"],
        "y": (s * total["f_x"] + c * total["f_y"]) / p["M"],
        "phi": yaw / p["Izz"],
        "z": (total["f_z"] - p["Kz"] * x["z"]) / p["M"],
        "theta": (roll - p["K_theta"] * x["theta"]) / p["Ixx"],
        "psi": (pitch - p["K_psi"] * x["psi"]) / p["Iyy"],
    }


def flux_density(at: Place, p: Exprs, fitted: Tables) -> Field:
    """Return the flux density in T at a Hall sensor along X and Y; along Z it is NaN."""
    lift = at.lift + p["height"] - HEIGHT
    decay = _scale(p) * ca.exp(-finite_motor.DECAY * lift)

    def along(*where: ca.SX) -> ca.SX:
        value, lifted = ca.vertsplit(fitted.flux(*where))
        return decay * (value + lift * lifted)

    return Field(along(at.X, at.Y), along(at.Y, at.X), ca.SX(np.nan))


def hall_voltages(x: Exprs, p: Exprs, fitted: Tables) -> dict[str, ca.SX]:
    """Return V_ax .. V_cy in V, of sensors whose gain is matched to the matrix."""
    nominal = {name: ca.SX(value) for name, value in VALUES.items()}
    gain = p["sensitivity"] * float(halbach.amplitude(1, ca.SX(HEIGHT), nominal)) / fitted.amplitude
    voltages: dict[str, ca.SX] = {}
    for sensor, r_x, r_y in (("a", 0, 0), ("b", p["spacing"], 0), ("c", 0, p["spacing"])):
        field = flux_density(planar_stage.place(x, ca.SX(r_x), ca.SX(r_y)), p, fitted)
        pair = hall_sensor.voltages(field, x["phi"], gain, ca.SX(0))
        voltages |= {f"V_{sensor}x": pair.u, f"V_{sensor}y": pair.v}
    return voltages


def closed_law_deviations(made: bool, radius: float) -> dict[tuple[str, str], float]:
    """Return how a motor deviates from the closed force law, for the platen up to `radius` in m from the middle.

    Forces are per A of the quadrature or the direct current, over K, and in the middle pitch unless stated otherwise.
    Torques are about the motor's own centre. Keys are (quantity, unit).
    """
    series = finite_matrix.series(
        finite_matrix.fabricated_blocks() if made else finite_matrix.ideal_blocks(), FORCE_HARMONICS
    )
    y, K = series.grid(MOTOR_RANGE), float(lorentz_motor.force_constant({n: ca.SX(v) for n, v in VALUES.items()}))
    phases = [finite_motor.maps(series, phase, "value", MOTOR_RANGE) for phase in PHASES]
    per_ampere = finite_motor.commutated_wrenches(np.array(phases), y)
    inside, reachable = (y > -VALUES["l"] / 2 - 1e-9) & (y < VALUES["l"] / 2 - 1e-9), _within_travel(y, radius)
    middle = per_ampere[:, :, inside][:, :, :, inside]
    mean, peak = middle.mean(axis=(2, 3)), np.abs(middle).max(axis=(2, 3))
    driving, across = per_ampere[0, 1][reachable] / K, np.abs(per_ampere[:, 0][:, reachable]).max()
    rows = (
        ("driving force over K", "", mean[0, 1] / K),
        ("lifting force over K", "", mean[1, 2] / K),
        ("peak ripple of the driving force", "", np.abs(middle[0, 1] / mean[0, 1] - 1).max()),
        ("peak ripple of the lifting force", "", np.abs(middle[1, 2] / mean[1, 2] - 1).max()),
        ("peak lift of the driving current over K", "", peak[0, 2] / K),
        ("peak force across the motion over K", "", peak[:, 0].max() / K),
        ("peak torque along the conductors", ", N m/A", peak[:, 3].max()),
        ("peak torque along the motion", ", N m/A", peak[:, 4].max()),
        ("peak torque in yaw", ", N m/A", peak[:, 5].max()),
        ("least driving force over K on the way", "", driving.min()),
        ("greatest driving force over K on the way", "", driving.max()),
        ("peak force across the motion over K on the way", "", across / K),
    )
    return {(what, unit): float(value) for what, unit, value in rows}


def _within_travel(y: Array, radius: float) -> NDArray[np.bool_]:
    """Return which points of the grid (n, n), across the motion and along it, a motor's centre reaches."""
    a, b, c = (next(p.value for p in planar_stage.PARAMETERS if p.name == name) for name in "abc")
    across, along = y[:, None], y[None, :]
    return np.any([np.hypot(across - u, along - v) <= radius for u, v in ((-a, -b), (a, -b), (c, 0.0))], axis=0)


def plant(made: bool = True, end_turns: float = finite_motor.RAISED_END_TURNS) -> Plant:
    """Return the stage over blocks as built or ideal, with end turns of weight `end_turns`."""
    fitted = tables(made, end_turns)

    def physics(x: Exprs, u: Exprs, p: Exprs) -> tuple[dict[str, ca.SX], dict[str, ca.SX]]:
        second = accelerations(x, u, p, fitted)
        derivative = {q: x[v] for q, v in planar_stage.RATE.items()}
        derivative |= {v: second[q] for q, v in planar_stage.RATE.items()}
        seen = hall_voltages(x, p, fitted) | planar_stage.laser_distances(x, p)
        return derivative, {q: x[q] for q in planar_stage.AXES} | seen

    s = planar_stage
    return build("planar_stage_finite", s.STATES, s.INPUTS, s.OUTPUTS, s.PARAMETERS, physics)
