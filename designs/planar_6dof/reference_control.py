"""NumPy reference of the planar controllers' common parts except sensing: Y(17)-(25), dead reckoning, braking.

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

from designs.planar_6dof import reference_sensing, reference_suspects
from synth.reference import dead_reckoning, guard, lead_lag

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
MASS, INERTIA = 1.52, 0.0022  # kg, kg m^2
INERTIAS = {"x": MASS, "y": MASS, "phi": INERTIA}
FASTEST = {"x": 2.0, "y": 2.0, "phi": 40.0}  # m/s, rad/s
FARTHEST = {"x": 0.2, "y": 0.2, "phi": 0.05}  # m, rad
BRAKING = 24  # samples
REMAINING = 0.5  # of the rate, after a braking sample
MEAN = {"phi": 0.9975}  # pole of the mean innovation
LEARNS, LARGEST = "xy", 32.0  # axes whose disturbance is learnt, and its bound in m/s^2
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


@cache
def vertical(axis: str, T: Fraction) -> lead_lag.Compensator:
    """Return the compensator of z, theta or psi at the period T in s; the pole is moved to 2/T. (23)-(25)."""
    gain, zero, pole, share = (Fraction(v) for v in VERTICAL[axis])
    new_pole = 2 / T
    return lead_lag.tustin(share * gain * new_pole / pole, (zero, Fraction(10)), new_pole, T)


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


def demand(axis: str, k: lead_lag.Compensator, e: Array, state: Columns) -> Array:
    """Return the force or torque that an axis demands for the error e. (21)-(25)."""
    return lead_lag.demand(f"loop_{axis}", k, e, state, scales()[axis])


def next_compensator_state(
    axis: str, k: lead_lag.Compensator, e: Array, achieved: Array, state: Columns
) -> dict[str, Array]:
    """Return the next states of a compensator, whose integral follows the achieved demand."""
    return lead_lag.next_state(f"loop_{axis}", k, e, achieved, state, scales()[axis])


@dataclass(frozen=True)
class Guarded:
    """The values to use, the guard's next state, the fault word, and whether Hall voltages are good and it brakes."""

    values: dict[str, Array]
    after: dict[str, Array]
    word: Array
    complete: Array
    braked: Array


def guard_inputs(state: Columns, inputs: Columns) -> Guarded:
    """Return the guarded inputs; NaN is outside every range."""
    accepted = guard.accept(state, inputs, {s: (-high, high) for s, high in LIMITS.items()}, HALL)
    good = accepted.good
    confirmed = np.asarray(state["sensing_contradiction_confirmed"]) > 0
    suspected = reference_suspects.suspects(state, reference_sensing.harmonic(1), True)
    common = reference_suspects.is_amplitude(state, reference_sensing.harmonic(1))
    word = accepted.word + np.sum(
        [(1 << len(good) + k) * (confirmed & suspected[s]) for k, s in enumerate(HALL)], axis=0
    )
    word = word + (1 << 29) * (confirmed & common & (np.asarray(state["sensing_frozen"]) == 0))
    before = np.asarray(state["guard_left"])
    all_good = np.all([good[s] for s in MEASUREMENTS], axis=0) & ~confirmed & (before > BRAKING)
    after = accepted.after | guard.count(state, all_good, BAD_SAMPLES + BRAKING)
    brakes = ~all_good & (before - 1 <= BRAKING)
    complete = np.all([good[s] for s in HALL], axis=0) & ~confirmed
    return Guarded(
        accepted.values, after, guard.fault_word(word + (1 << 30) * brakes, after), complete, before <= BRAKING
    )


def sample(
    state: Columns, measured: Columns, accepted: Array, acting: Columns, T: float, bandwidth: Mapping[str, float]
) -> dead_reckoning.Sample:
    """Return what a sample tells about x, y and phi, for the demands in A that act and bandwidths in rad/s."""
    begun = np.asarray(state["guard_ready"]) > 0
    axes = {
        a: dead_reckoning.Axis(
            scales()[a] / inertia,
            bandwidth[a],
            FASTEST[a],
            FARTHEST[a],
            MEAN.get(a, 0.0),
            BAD_SAMPLES - 1 + BRAKING,
            bandwidth["force"] if a in LEARNS else 0.0,
            LARGEST,
        )
        for a, inertia in INERTIAS.items()
    }
    return dead_reckoning.Sample(measured, begun, begun & accepted, acting, T, axes)


def brake(demands: Columns, state: Columns, now: dead_reckoning.Sample, stops: Array) -> dict[str, Array]:
    """Return the demands in N and N m; while the platen brakes, those that leave a part of the rates."""
    rates = dead_reckoning.next_rates(state, now)
    return dead_reckoning.brake(demands, rates, stops, now.T, INERTIAS, REMAINING)


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


def initial_state(axes: tuple[str, ...]) -> dict[str, Array]:
    """Return the state after init of guard, output and the compensators of `axes`, by name."""
    loops = {f"loop_{axis}_{part}": np.array(0.0) for axis in axes for part in ("integral", "lead")}
    guarded = guard.initial_state(dict.fromkeys(LIMITS, (0.0, 0.0)), PHASES, BAD_SAMPLES + BRAKING, HALL)
    return guarded | loops | dead_reckoning.initial_state(INERTIAS, MEAN, LEARNS)


def finish_step(
    state: Columns, after: dict[str, Array], computed: Columns, T: Fraction
) -> tuple[dict[str, Array], dict[str, Array]]:
    """Return the next state, frozen once latched except for the guard, and the phase currents.

    The currents are limited: as computed, or on a slew to 0 once latched. They are stored if the next sample may latch.
    """
    latched = after["guard_latched"] > 0
    law = {n: v for n, v in after.items() if not n.startswith("guard_")}
    limited = {n: np.clip(computed[n], -LIMIT, LIMIT) for n in PHASES}
    outputs, last = guard.slew(state, limited, latched, SLEW * float(T))
    return after | guard.frozen(state, law, latched) | guard.stored_before_latch(state, last, latched), outputs
