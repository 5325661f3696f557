"""Equations of motion of a platen on air bearings, driven in six axes by three planar motors over a magnet matrix.

        Y ^        [  C  ]  --> f_Cx         motor centres in the platen: A (-a, -b), B (a, -b), C (0, c)
          |                                  theta, psi, phi  rotations about X, Y, Z; z up
          |      [A]     [B]                 A and B push along the platen's y, C along its x, all three up
          +--> X  f_Ay    f_By

    M x''      = cos(phi) f_Cx - sin(phi) (f_Ay + f_By)                                                      (18)
    M y''      = sin(phi) f_Cx + cos(phi) (f_Ay + f_By)
    Izz phi''  = a (f_By - f_Ay) - c f_Cx
    M z''      = f_Az + f_Bz + f_Cz - Kz z                                                                   (19)
    Ixx theta'' = c f_Cz - b (f_Az + f_Bz) - K_theta theta                                                   (20)
    Iyy psi''   = a (f_Az - f_Bz) - K_psi psi

Each motor's forces (`models.lorentz_motor`) follow from its phase currents and the position of its own centre over the
matrix, x + R(phi) r_i, at its own gap. Three two-axis Hall sensors (`models.hall_sensor`) and three laser distance
sensors see the platen.

The arms are not printed. (26) contains 117.15 = K a / Izz. With b = a and c = 2 a the rows x and z of Table 3, with
unit coefficients, move these axes alone. (26) neglects the yaw torque of motor C, which the row x compensates.

Source: Yu, Kim, "Design of Precision Positioner with Hall-effect Sensors and Multivariable Control Methodology",
(17)-(20), Tables 1 to 3.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from string import ascii_lowercase

import casadi as ca
import numpy as np

from models import halbach, hall_sensor, lorentz_motor
from synth.plant import Plant, build
from synth.signals import Parameter, Signal, signal_names
from synth.statespace import Array, readonly

Exprs = Mapping[str, ca.SX]

SECTION = "section 5.2"
ARM = 117.15 * 0.0022 / (13.2547 * 1.52)
PARAMETERS = (
    *lorentz_motor.PARAMETERS,
    Parameter("M", 1.52, "kg", 5e-3, SECTION),
    Parameter("Ixx", 0.0037, "kg m^2/rad", 0.02, SECTION),
    Parameter("Iyy", 0.0019, "kg m^2/rad", 0.03, SECTION),
    Parameter("Izz", 0.0022, "kg m^2/rad", 0.03, SECTION),
    Parameter("Kz", 620.0, "N/m", 0.05, SECTION),
    Parameter("K_theta", 65.0, "N m/rad", 0.05, SECTION),
    Parameter("K_psi", 87.0, "N m/rad", 0.05, SECTION),
    Parameter("a", ARM, "m", 0.03, "implied by 117.15 and 13.2547 in (26)"),
    Parameter("b", ARM, "m", 0.03, "not printed: row z of Table 3 makes no torque about x"),
    Parameter("c", 2 * ARM, "m", 0.03, "not printed: row x of Table 3 makes no torque about z"),
    Parameter("spacing", 0.75 * 304.8e-3 / 6, "m", 1e-3, "(1) with n = 1: 0.75 pitch from Hall sensor A to B and to C"),
    Parameter("height", 3e-3, "m", 0.05, "not printed: of the Hall sensors above the matrix, as in Kawato and Kim"),
    Parameter("sensitivity", 0.4 * 21, "V/T", 0.01, "400 mV/T, section 3.1; the amplifier is Kawato and Kim's"),
    Parameter("laser_arm", 0.06, "m", 0.01, "not printed: of the laser distance sensors from the centre"),
)
AXES = ("x", "y", "phi", "z", "theta", "psi")
RATE = {axis: f"v{axis}" if axis in "xyz" else f"w{axis}" for axis in AXES}
STATES = (
    Signal("x", "m", -0.11, 0.11, "position of the mass centre along X, from a strong block's centre"),
    Signal("y", "m", -0.10, 0.10, "position of the mass centre along Y"),
    Signal("phi", "rad", -0.02, 0.02, "yaw"),
    Signal("z", "m", -2e-4, 2e-4, "height above the nominal gap"),
    Signal("theta", "rad", -2e-3, 2e-3, "tilt about X"),
    Signal("psi", "rad", -2e-3, 2e-3, "tilt about Y"),
    *(Signal(f"v{axis}", "m/s", -1.0, 1.0) for axis in "xy"),
    Signal("wphi", "rad/s", -5.0, 5.0),
    Signal("vz", "m/s", -0.1, 0.1),
    *(Signal(f"w{axis}", "rad/s", -1.0, 1.0) for axis in ("theta", "psi")),
)
LIMIT = 1.26  # A, Table 1
MOTORS = ("A", "B", "C")
INPUTS = tuple(
    Signal(f"i_{motor}{phase}", "A", -LIMIT, LIMIT, f"phase {phase} of motor {motor}")
    for motor in MOTORS
    for phase in lorentz_motor.PHASE_OFFSETS
)
LASERS = ("d1", "d2", "d3")
ABOUT = {
    "d1": "laser distance at the front left, up from nominal",
    "d2": "laser distance at the front right, up from nominal",
    "d3": "laser distance at the rear, up from nominal",
}


def hall_signals(sensors: int) -> tuple[Signal, ...]:
    """Return the voltages of so many Hall sensors, each with its two axes."""
    return tuple(
        Signal(f"V_{letter}{axis}", "V", -10.0, 10.0, f"voltage of Hall sensor {letter.upper()} along {axis}")
        for letter in ascii_lowercase[:sensors]
        for axis in "xy"
    )


def outputs(sensors: int) -> tuple[Signal, ...]:
    """Return the outputs of a stage with so many Hall sensors: the pose, the voltages, the laser distances."""
    lasers = (Signal(name, "m", -5e-4, 5e-4, ABOUT[name]) for name in LASERS)
    return (*(signal for signal in STATES if signal.name in AXES), *hall_signals(sensors), *lasers)


HALL = signal_names(hall_signals(3))
OUTPUTS = outputs(3)


@dataclass(frozen=True, eq=False)
class Place:
    """A point of the platen: its position X, Y over the matrix and its lift, m."""

    X: ca.SX
    Y: ca.SX
    lift: ca.SX


def place(x: Exprs, r_x: ca.SX, r_y: ca.SX) -> Place:
    """Return the position of the platen's point (r_x, r_y) in m for the pose `x` by name; tilts to first order."""
    c, s = ca.cos(x["phi"]), ca.sin(x["phi"])
    lift = x["z"] + x["theta"] * r_y - x["psi"] * r_x
    return Place(x["x"] + c * r_x - s * r_y, x["y"] + s * r_x + c * r_y, lift)


def centres(x: Exprs, p: Exprs) -> dict[str, Place]:
    """Return the position of each motor's centre."""
    return {
        "A": place(x, -p["a"], -p["b"]),
        "B": place(x, p["a"], -p["b"]),
        "C": place(x, ca.SX(0), p["c"]),
    }


def motor_forces(x: Exprs, u: Exprs, p: Exprs, harmonics: Sequence[int] = (1,)) -> dict[str, lorentz_motor.MotorForces]:
    """Return each motor's force in N along its motion and up, from the phase currents `u` in A."""
    forces: dict[str, lorentz_motor.MotorForces] = {}
    for motor, at in centres(x, p).items():
        currents = {phase: u[f"i_{motor}{phase}"] for phase in lorentz_motor.PHASE_OFFSETS}
        along = at.X if motor == "C" else at.Y
        forces[motor] = lorentz_motor.forces(along, at.lift, currents, p, harmonics)
    return forces


def accelerations(x: Exprs, u: Exprs, p: Exprs, harmonics: Sequence[int] = (1,)) -> dict[str, ca.SX]:
    """Return the six accelerations in m/s^2 and rad/s^2. Source: (18)-(20)."""
    f = motor_forces(x, u, p, harmonics)
    c, s = ca.cos(x["phi"]), ca.sin(x["phi"])
    along_x, along_y, front = f["C"].y, f["A"].y + f["B"].y, f["A"].z + f["B"].z
    return {
        "x": (c * along_x - s * along_y) / p["M"],
        "y": (s * along_x + c * along_y) / p["M"],
        "phi": (p["a"] * (f["B"].y - f["A"].y) - p["c"] * along_x) / p["Izz"],
        "z": (front + f["C"].z - p["Kz"] * x["z"]) / p["M"],
        "theta": (p["c"] * f["C"].z - p["b"] * front - p["K_theta"] * x["theta"]) / p["Ixx"],
        "psi": (p["a"] * (f["A"].z - f["B"].z) - p["K_psi"] * x["psi"]) / p["Iyy"],
    }


def hall_places(plant: Plant) -> tuple[tuple[float, float], ...]:
    """Return the positions of Hall sensors A, B and C in the platen, m."""
    spacing = plant.parameter("spacing").value
    return (0.0, 0.0), (spacing, 0.0), (0.0, spacing)


def hall_voltages(x: Exprs, p: Exprs, harmonics: Sequence[int] = halbach.HARMONICS) -> dict[str, ca.SX]:
    """Return V_ax .. V_cy in V: sensor A at the platen's centre, B a spacing along its x, C one along its y."""
    voltages: dict[str, ca.SX] = {}
    for sensor, r_x, r_y in (("a", 0, 0), ("b", p["spacing"], 0), ("c", 0, p["spacing"])):
        at = place(x, ca.SX(r_x), ca.SX(r_y))
        field = halbach.field(at.X, at.Y, p["height"] + at.lift, p, harmonics)
        pair = hall_sensor.voltages(field, x["phi"], p["sensitivity"], ca.SX(0))
        voltages |= {f"V_{sensor}x": pair.u, f"V_{sensor}y": pair.v}
    return voltages


def laser_distances(x: Exprs, p: Exprs) -> dict[str, ca.SX]:
    """Return d1, d2, d3 in m: the lift of three points of the platen, front left, front right and rear."""
    arm = p["laser_arm"]
    points = ((-arm, -arm), (arm, -arm), (ca.SX(0), arm))
    return {name: place(x, *point).lift for name, point in zip(LASERS, points, strict=True)}


def force_constant(plant: Plant) -> float:
    """Return K in N/A by the Lorentz integral."""
    return float(lorentz_motor.force_constant({p.name: ca.SX(p.value) for p in plant.parameters}))


def wrench(plant: Plant) -> Array:
    """Return T (6, 6) from f_Ay, f_By, f_Cx, f_Az, f_Bz, f_Cz in N to forces in N and torques in N m on the platen."""
    a, b, c = (plant.parameter(name).value for name in "abc")
    rows: list[list[float]] = [
        [0, 0, 1, 0, 0, 0],
        [1, 1, 0, 0, 0, 0],
        [-a, a, -c, 0, 0, 0],
        [0, 0, 0, 1, 1, 1],
        [0, 0, 0, -b, -b, c],
        [0, 0, 0, a, -a, 0],
    ]
    return readonly(rows)


def commutation_matrix(plant: Plant, pose: Mapping[str, float]) -> Array:
    """Return E (9, 6) at a pose (m, rad): phase currents of 1 A in each motor, along its motion (3), then up (3)."""
    p = {s.name: ca.SX(s.value) for s in plant.parameters}
    E, phases = np.zeros((len(INPUTS), 2 * len(MOTORS))), signal_names(INPUTS)
    for k, (motor, at) in enumerate(centres({axis: ca.SX(v) for axis, v in pose.items()}, p).items()):
        for column, along in ((k, True), (k + len(MOTORS), False)):
            y = at.X if motor == "C" else at.Y
            for phase, current in lorentz_motor.phase_currents(ca.SX(along), ca.SX(not along), y, p).items():
                E[phases.index(f"i_{motor}{phase}"), column] = float(current)
    return readonly(E)


def plant(force_harmonics: Sequence[int] = (1,), field_harmonics: Sequence[int] = halbach.HARMONICS) -> Plant:
    """Return the plant (18)-(20): twelve states, nine phase currents, the pose, six Hall voltages, three distances."""

    def physics(x: Exprs, u: Exprs, p: Exprs) -> tuple[dict[str, ca.SX], dict[str, ca.SX]]:
        second = accelerations(x, u, p, force_harmonics)
        derivative = {q: x[v] for q, v in RATE.items()} | {v: second[q] for q, v in RATE.items()}
        measurements = hall_voltages(x, p, field_harmonics) | laser_distances(x, p)
        return derivative, {q: x[q] for q in AXES} | measurements

    return build("planar_stage", STATES, INPUTS, OUTPUTS, PARAMETERS, physics)
