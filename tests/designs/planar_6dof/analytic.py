"""The planar positioner's loops written out, for comparison: no Block, no linearisation, no state-space algebra.

L(z) = C(z) g X(z) / (1 - rho/z) z^-1 G(z)                    rest at the middle of the travel

G      q'' = b f - k q with f held:  b T^2/2 (z + 1)/(z - 1)^2,  b (1 - cos wT)/w^2 (z + 1)/(z^2 - 2 cos wT z + 1)
z^-1   a sample of computation
g, rho raw = g q + rho raw/z: what the calibration makes of the slope of the field, and of the yaw of the sample before
X      the filter (6)-(16) from raw to its position, or 1
C      the compensator
"""

from collections.abc import Callable, Mapping

import casadi as ca
import numpy as np

from designs.planar_6dof import filtering, lqg, vertical
from designs.planar_6dof.paper import rows
from designs.planar_6dof.sensing import calibration
from designs.planar_6dof.sensing import sections as sensing
from designs.planar_6dof_leadlag import control as leadlag
from models import halbach
from synth.blocks.faults import innovation_monitor
from synth.plant import Plant
from synth.timing import Discrete

Array = np.ndarray
Transfer = Callable[[Array], Array]
INERTIA = {"x": "M", "y": "M", "phi": "Izz", "z": "M", "theta": "Ixx", "psi": "Iyy"}
SPRING = {"z": "Kz", "theta": "K_theta", "psi": "K_psi"}


def loop(plant: Plant, axis: str, C: Transfer, time: Discrete, filtered: bool, delay: int = 1) -> Transfer:
    """Return L(z) for a compensator from position to force or torque."""

    def L(z: Array) -> Array:
        if axis in SPRING:
            return C(z) * z**-delay * held_plant(plant, axis, time.period_s, z)
        g, rho = sensor_slopes(plant, axis)
        X = kalman(axis, time, z) if filtered else np.ones_like(z)
        return C(z) * g * X / (1 - rho / z) * z**-delay * held_plant(plant, axis, time.period_s, z)

    return L


def ideal_loop(plant: Plant, axis: str, C: Transfer, time: Discrete) -> Transfer:
    """Return L(z) = C(z) z^-1 G(z) on the positions of the stage."""
    return lambda z: C(z) / z * held_plant(plant, axis, time.period_s, z)


def held_plant(plant: Plant, axis: str, T: float, z: Array) -> Array:
    b = 1 / plant.parameter(INERTIA[axis]).value
    if axis not in SPRING:
        return b * T**2 / 2 * (z + 1) / (z - 1) ** 2
    w = np.sqrt(plant.parameter(SPRING[axis]).value * b)
    return b * (1 - np.cos(w * T)) / w**2 * (z + 1) / (z**2 - 2 * np.cos(w * T) * z + 1)


def sensor_slopes(plant: Plant, axis: str) -> tuple[float, float]:
    """Return g and rho, with S' = sum n A_n and C = sum A_n at the middle (S is 0), after two samples of the scale."""
    cal, p = calibration.of(plant), {s.name: ca.SX(s.value) for s in plant.parameters}
    height = ca.SX(plant.parameter("height").value)
    A = {n: plant.parameter("sensitivity").value * float(halbach.amplitude(n, height, p)) for n in halbach.HARMONICS}
    slope, level, scale = sum(n * a for n, a in A.items()), sum(A.values()), 1.0
    for share in (1.0, innovation_monitor.WATCHED * calibration.SCALE_GAIN):
        scale -= share * ((scale * level) ** 2 / cal.power[0] - 1) / 2
    slope, level = scale * slope, scale * level
    if axis != "phi":
        r = slope * level / (level**2 + sensing.SQUARE_FLOOR * cal.amplitude**2)
        return cal.position[0] * 2 * np.pi / cal.pitch * r, 0.0
    h, true = cal.slope[0] * level**3 + level, 1.5 * np.pi * slope + level
    information = 2 * h**2 + sensing.REGULARISATION_FROM_FORCES * cal.amplitude**2
    return 2 * h * true / information, 1 - 2 * h**2 / information


def kalman(axis: str, time: Discrete, z: Array) -> Array:
    T, K = time.period_s, filtering.estimator(axis, time).M
    A, C = np.array([[1, T, T * T / 2], [0, 1, T], [0, 0, 1]]), np.eye(1, 3)
    predicted = np.array([np.linalg.solve(v * np.eye(3) - A @ (np.eye(3) - K @ C), A @ K)[:, 0] for v in z])
    return predicted[:, 0] + K[0, 0] * (1 - predicted[:, 0])


def lead_lag(axis: str, time: Discrete, published: bool = False) -> Transfer:
    """Return (21)-(25) by Tustin's rule, from the printed numbers."""
    print_, part = rows.published_rows(), 1.0 if published else (leadlag.GAIN_SHARE | vertical.GAIN_SHARE)[axis]

    def C(z: Array) -> Array:
        s = 2 / time.period_s * (z - 1) / (z + 1)
        if axis in SPRING:
            gain, zero, pole, reset = (print_["Y-32"][f"{axis}_{n}"].value for n in ("gain", "lead", "lag", "reset"))
            moved = pole if published else 2 / time.period_s
            return part * gain * moved / pole * (s + zero) / (s + moved) * (s + reset) / s
        gain, lead, lag, reset = (
            print_["Y-8" if axis == "phi" else "Y-7"][n].value for n in ("gain", "lead", "lag", "reset")
        )
        return part * gain * (1 + lead * s) / (1 + lag * s) * (1 + reset * s) / s

    return C


def optimal(plant: Plant, axis: str, weights: tuple[float, ...] = lqg.WEIGHTS) -> Transfer:
    """Return K of (49) on the observer of the rate, one sample ahead, from position to force or torque."""
    T, p, K = lqg.TIME.period_s, lqg.OBSERVER_POLE[axis], -lqg.gain(weights).K
    pushed = {"x": lqg.PER_AMPERE, "y": 2 * lqg.PER_AMPERE, "phi": 2 * lqg.YAW_PER_AMPERE}[axis]
    i, row = lqg.STATES.index(axis), K[2 if axis == "x" else 1]
    k1, k3, k2, L = row[i], row[3 + i] * T, row[6 + i], (1 - p) / T

    def C(z: Array) -> Array:
        # Of a position 1: x3, the current i of the sample before and the sum, then i itself.
        rows = []
        for v in z:
            # i = -k1 (1 + T r + b T^2/2 i/z) - k2 (r + b T i/z) - k3 (1 + s),  r = x3 + L,  s = 1/(z - 1)
            # z x3 = p x3 - L (1 - p) + (b T - L b T^2/2) i/z
            a = pushed * T * (1 - L * T / 2) / (v * (v - p))
            fixed = L - L * (1 - p) / (v - p)
            on_rate = k1 * T + k2
            left = 1 + k1 * pushed * T**2 / 2 / v + k2 * pushed * T / v + on_rate * a
            rows.append((k1 + on_rate * fixed + k3 * (1 + 1 / (v - 1))) / left)
        return np.array(rows) * pushed * plant.parameter(INERTIA[axis]).value

    return C


def wrench(plant: Plant) -> Array:
    """Return (3, 3) from forces of A, B, C along their motion to those along x and y and the torque."""
    a, c = plant.parameter("a").value, plant.parameter("c").value
    return np.array([[0, 0, 1], [1, 1, 0], [-a, a, -c]])


def currents(plant: Plant, loops: Mapping[str, Transfer], z: Array) -> Array:
    """Return L (N, 3, 3) at the currents of A, B, C: W^-1 diag(L) W."""
    W, values = wrench(plant), np.array([loops[axis](z) for axis in ("x", "y", "phi")])
    return np.array([np.linalg.solve(W, np.diag(v) @ W) for v in values.T])
