"""NumPy reference of the planar controllers' common parts except sensing: Y(17)-(25).

    guard      a value out of range is replaced by the last good one, a Hall voltage by 0; five bad samples in a row
               latch, and every sample is bad once Hall channels are suspected
    vertical   d1..d3 are the lifts z + theta r_y - psi r_x of three points; compensators by Tustin's rule
    motors     (f_Ay, f_By, f_Cx, f_Az, f_Bz, f_Cz) = T^-1 w, w rotated into the platen's frame; i = f / K, limited
    phases     alpha + i beta = exp(i angle) (i_Q + i i_D), phases at 0, 120, 240 degrees of it                     (17)

Y is Yu and Kim, "Design of Precision Positioner with Hall-effect Sensors and Multivariable Control Methodology".
It is written from these equations with separate constants. Arrays are columns: N platens advance one sample at a time.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from functools import cache
from math import pi, sqrt
from typing import Any

import numpy as np
from numpy.typing import NDArray

from designs.planar_6dof import reference_sensing

Array = NDArray[Any]
Columns = Mapping[str, Array]

AXES = ("x", "y", "phi", "z", "theta", "psi")
PITCH = 0.3048 / 6  # m, Table 2
GAMMA = 2 * pi / PITCH  # rad/m
ARM = 117.15 * 0.0022 / (13.2547 * 1.52)  # m, implied by (26)
CENTRES = {"A": (-ARM, -ARM), "B": (ARM, -ARM), "C": (0.0, 2 * ARM)}  # m
AREA, TURNS = 8.6524e-5, 305  # m^2, Table 1
LIMIT = 1.26  # A, Table 1
QUADRATURE = 0.9 * LIMIT
DIRECT = sqrt(((1 - 3e-5) * LIMIT) ** 2 - QUADRATURE**2)
YAW = 0.075  # rad
LASER_ARM = 0.06  # m
BAD_SAMPLES, SLEW = 5, 126.0  # A/s
HALL = reference_sensing.HALL
LIMITS = dict.fromkeys(HALL, 5.0) | dict.fromkeys(("d1", "d2", "d3"), 5e-4)
MEASUREMENTS = tuple(LIMITS)
BOX = {"x": 0.11, "y": 0.10, "phi": 0.02, "z": 2e-4, "theta": 2e-3, "psi": 2e-3}
LIMITS |= {f"{axis}_ref": high for axis, high in (BOX | {"phi": 0.008}).items()}
PHASES = tuple(f"i_{motor}{phase}" for motor in CENTRES for phase in "ABC")
VERTICAL = {  # (23)-(25): gain, zero, pole in rad/s, and the factor on the gain at low frequencies
    "z": ("323252", "102.91", "776.828", "0.65"),
    "theta": ("900", "80.0413", "604.199", "0.5"),
    "psi": ("1100", "80.0413", "604.199", "0.15"),
}


def force_constant() -> float:
    """Return K in N/A: (17) with 3/pi, the distribution factor of bands of 60 degrees, and two pitches of winding."""
    thickness, across = 6 * AREA / PITCH, PITCH
    G = sqrt(2) * across * PITCH**2 / pi**2 * (1 - np.exp(-GAMMA * thickness)) * (1 - np.exp(-pi / 2))
    return float(0.5 * 3 / pi * 0.71 * TURNS / AREA * 2 * G * np.exp(-GAMMA * 2.3e-3))


def wrench() -> Array:
    """Return T (6, 6) of w = T f: forces add up, torques are r x f about Z, X and Y. Table 3."""
    along = {motor: (1.0, 0.0) if motor == "C" else (0.0, 1.0) for motor in CENTRES}
    columns = [[f, g, x * g - y * f, 0, 0, 0] for (x, y), (f, g) in zip(CENTRES.values(), along.values(), strict=True)]
    return np.array(columns + [[0, 0, 0, 1, y, -x] for x, y in CENTRES.values()]).T


@dataclass(frozen=True)
class Compensator:
    """K(z) = D (z - z1) (z - z2) / ((z - p) (z - 1))."""

    D: float
    z1: float
    z2: float
    p: float


def tustin(gain: Fraction, zeros: tuple[Fraction, Fraction], pole: Fraction, T: Fraction) -> Compensator:
    """Return gain (s + a) (s + b) / ((s + c) s) with s = (2/T) (z - 1)/(z + 1), exactly."""
    w = 2 / T
    D = gain * (w + zeros[0]) * (w + zeros[1]) / ((w + pole) * w)
    z1, z2, p = ((w - v) / (w + v) for v in (*zeros, pole))
    return Compensator(*(float(v) for v in (D, z1, z2, p)))


@cache
def vertical(axis: str, T: Fraction) -> Compensator:
    """Return the compensator of z, theta or psi at the period T in s; the pole is moved to 2/T. (23)-(25)."""
    gain, zero, pole, share = (Fraction(v) for v in VERTICAL[axis])
    new_pole = 2 / T
    return tustin(share * gain * new_pole / pole, (zero, Fraction(10)), new_pole, T)


@cache
def scales() -> dict[str, float]:
    """Return the force in N or torque in N m by which the demand of an axis and the states behind it are divided.

    It is the force of 1 A in motor C along x, and in A and B together along y; for phi and psi half of it in each;
    along z and about theta that at which A and B have 1 A each.
    """
    K, T = force_constant(), wrench()
    allocation_matrix = np.linalg.inv(T)
    return {"x": K, "y": K} | {
        axis: K / abs(allocation_matrix[row, AXES.index(axis)]) for axis, row in _LEADING.items()
    }


_LEADING = {"phi": 1, "z": 3, "theta": 3, "psi": 3}  # the force that 1 A defines


def demand(axis: str, k: Compensator, e: Array, state: Columns) -> Array:
    """Return the force or torque that an axis demands for the error e. (21)-(25)."""
    return k.D * e + scales()[axis] * (state[f"loop_{axis}_lead"] + state[f"loop_{axis}_integral"])


def next_compensator_state(axis: str, k: Compensator, e: Array, achieved: Array, state: Columns) -> dict[str, Array]:
    """Return the next states of a compensator, whose integral follows the achieved demand."""
    scale = scales()[axis]
    lead = k.p * state[f"loop_{axis}_lead"] + k.D * (k.p - k.z1) * e / scale
    integral = state[f"loop_{axis}_integral"]
    return {f"loop_{axis}_lead": lead, f"loop_{axis}_integral": integral + (1 - k.z2) * (achieved / scale - integral)}


@dataclass(frozen=True)
class Guarded:
    """The values to use, the guard's next state, the fault word, and whether Hall voltages are good and it brakes."""

    values: dict[str, Array]
    after: dict[str, Array]
    word: Array
    complete: Array
    braked: Array


def guard(state: Columns, inputs: Columns, braking: int = 0) -> Guarded:
    """Return the guarded inputs; NaN is outside every range."""
    with np.errstate(invalid="ignore"):
        read = {s: np.asarray(inputs[s], dtype=np.float64) for s in LIMITS}
        good = {s: np.abs(read[s]) <= high for s, high in LIMITS.items()}
    values = {s: np.where(good[s], read[s], 0.0 if s in HALL else state[f"guard_last_{s}"]) for s in LIMITS}
    after = {f"guard_last_{s}": value for s, value in values.items() if s not in HALL}
    confirmed = np.asarray(state["sensing_contradiction_confirmed"]) > 0
    suspected = reference_sensing.suspects(state, reference_sensing.harmonic(1), braking > 0)
    common = reference_sensing.is_amplitude(state, reference_sensing.harmonic(1))
    flags = [~good[s] for s in LIMITS] + [confirmed & suspected[s] for s in HALL]
    word = np.sum([np.where(flag, 1 << bit, 0) for bit, flag in enumerate(flags)], axis=0)
    word = word + (1 << 29) * (confirmed & common)
    complete = np.all([good[s] for s in HALL], axis=0) & ~confirmed
    before = np.asarray(state["guard_left"])
    all_good = np.all([good[s] for s in MEASUREMENTS], axis=0) & ~confirmed & (before > braking)
    left = np.where(all_good, BAD_SAMPLES + braking, before - 1)
    after["guard_left"] = np.maximum(left, 1)
    after["guard_latched"] = np.where(left < 1, 1, state["guard_latched"])
    after["guard_ready"] = np.where(all_good, 1, state["guard_ready"])
    brakes = ~all_good & (left <= braking) if braking else np.zeros_like(all_good)
    word = np.asarray(word + (1 << 31) * (after["guard_latched"] > 0) + (1 << 30) * brakes).astype(np.uint32)
    return Guarded(values, after, word, complete, before <= braking)


def vertical_kinematics(v: Columns) -> dict[str, Array]:
    """Return z, theta and psi for three distances."""
    points = np.array([[1, y, -x] for x, y in ((-LASER_ARM, -LASER_ARM), (LASER_ARM, -LASER_ARM), (0.0, LASER_ARM))])
    lifts = np.linalg.inv(points) @ np.stack([v["d1"], v["d2"], v["d3"]])
    return dict(zip(("z", "theta", "psi"), lifts, strict=True))


def allocate(w: Columns, phi: Array) -> tuple[dict[str, tuple[Array, Array]], dict[str, Array]]:
    """Return (i_Q, i_D) in A by motor and the demands that they achieve, in the frame of the matrix. Table 3."""
    K, T, turn = force_constant(), wrench(), np.exp(-1j * np.clip(phi, -YAW, YAW))
    platen = (w["x"] + 1j * w["y"]) * turn
    # A and B compensate the torque of C, so C leaves them up to half of their limit for the yaw.
    limit_c = np.maximum(QUADRATURE - np.abs(w["phi"]) / (2 * ARM * K), QUADRATURE / 2)
    rear = np.clip(platen.real / K, -limit_c, limit_c)
    platen = K * rear + 1j * platen.imag
    demanded = np.linalg.inv(T) @ np.stack([platen.real, platen.imag, *(w[axis] for axis in AXES[2:])]) / K
    yaw = np.clip((demanded[1] - demanded[0]) / 2, -QUADRATURE, QUADRATURE)  # has priority in A and B
    limit_half = QUADRATURE - np.abs(yaw)
    half = np.clip((demanded[0] + demanded[1]) / 2, -limit_half, limit_half)
    i_q = np.stack([half - yaw, half + yaw, demanded[2]])
    i_d = np.clip(demanded[3:], -DIRECT, DIRECT)
    achieved = T @ np.concatenate([i_q, i_d]) * K
    matrix = (achieved[0] + 1j * achieved[1]) * np.conj(turn)
    currents = {motor: (i_q[j], i_d[j]) for j, motor in enumerate(CENTRES)}
    return currents, dict(zip(AXES, (matrix.real, matrix.imag, *achieved[2:]), strict=True))


def phases(currents: Mapping[str, tuple[Array, Array]], q: Columns) -> dict[str, Array]:
    """Return the phase currents of the motors for a position within a pitch, (17) inverted."""
    phi, out = np.clip(q["phi"], -YAW, YAW), {}
    front, aside = q["within_y"] - ARM * np.cos(phi), ARM * np.sin(phi)
    back = q["within_x"] - 2 * ARM * np.sin(phi)
    for motor, along in (("A", front - aside), ("B", front + aside), ("C", back)):
        i_q, i_d = currents[motor]
        rotor = np.exp(1j * GAMMA * along) * (i_q + 1j * i_d)
        for k, phase in enumerate("ABC"):
            out[f"i_{motor}{phase}"] = (rotor * np.exp(-2j * pi / 3 * k)).real
    return out


def initial_state(axes: tuple[str, ...], braking: int = 0) -> dict[str, Array]:
    """Return the state after init of guard, output and the compensators of `axes`, by name."""
    names = [f"guard_last_{s}" for s in LIMITS if s not in HALL] + [f"safe_output_last_{s}" for s in PHASES]
    names += [f"loop_{axis}_{part}" for axis in axes for part in ("integral", "lead")]
    return {name: np.array(0.0) for name in (*names, "guard_latched", "guard_ready")} | {
        "guard_left": np.array(float(BAD_SAMPLES + braking))
    }


def finish_step(
    state: Columns, after: dict[str, Array], computed: Columns, T: Fraction
) -> tuple[dict[str, Array], dict[str, Array]]:
    """Return the next state, frozen once latched except for the guard, and the phase currents.

    The currents are limited: as computed, or on a slew to 0 once latched.
    """
    latched, out, most = after["guard_latched"] > 0, {}, SLEW * float(T)
    next_state = {n: v if n.startswith("guard_") else np.where(latched, state[n], v) for n, v in after.items()}
    for name in PHASES:
        last = state[f"safe_output_last_{name}"]
        slewed = np.clip(0.0, last - most, last + most)
        out[name] = np.clip(np.where(latched, slewed, computed[name]), -LIMIT, LIMIT)
    return next_state | {f"safe_output_last_{name}": i for name, i in out.items()}, out
