"""The reduced-order LQG controller of the planar positioner, one step of 1.25 ms: NumPy reference of the C.

    (26) is three axes q'' = b s with s = i_C, (i_A + i_B)/2, (i_B - i_A)/2 and the costs R s^2, R = 1, 2, 2.
    (31) adds the integral of q. s = -K (q, z, q'), by (43)-(45) with the currents held, as MATLAB's lqrd
    v^ = x3 + L q, x3+ = p x3 - L (1 - p) q + (b T - L b T^2/2) s1,    L = (1 - p)/T                              (33)
    s  = -K (q1 - r, z1, v1) with q1, z1, v1 predicted one sample ahead under s1, the input of the sample before

Gains are solved in 60 digits and rounded once. Every function takes scalars or columns (n,) of n independent
controllers. Lengths in m, angles in rad, currents in A.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from functools import cache
from typing import Any

import mpmath  # type: ignore[import-untyped]
import numpy as np
from numpy.typing import NDArray

from designs.planar_6dof import reference_control as shared
from designs.planar_6dof import reference_sensing as sensing
from synth.reference import dead_reckoning, gains, guard

Array = NDArray[Any]
Columns = Mapping[str, Array]

PERIOD = Fraction(1, 800)  # s
PER_AMPERE, YAW_PER_AMPERE = 13.2547, 117.15  # (26)
FORCE = PER_AMPERE * 1.52  # N/A
WEIGHTS = {"x": (1e4, 1e10, 1e2), "y": (1e3, 1e9, 1e1), "phi": (1e3, 1e10, 2e1)}  # of q, z, q'
ERROR = {"x": 1.5e-3, "y": 4e-3, "phi": np.inf}  # m, rad
LATE = {"x": 27, "y": 28}  # bits of the fault word: the error is beyond ERROR
BANDWIDTH = {"x": 48.0, "y": 48.0, "phi": 12.0, "force": 30.0}  # rad/s, of the prediction
POLE = {"x": "0.7", "y": "0.7", "phi": "0.9"}
HORIZONTAL, UPRIGHT = ("x", "y", "phi"), ("z", "theta", "psi")


@dataclass(frozen=True)
class Axis:
    """One axis with demands in the scale of `reference_control`: q'' = b d, d = -k (q, q', T z)."""

    b: float
    k_q: float
    k_v: float
    k_z: float
    p: float


@cache
def axes() -> dict[str, Axis]:
    """Return the three axes with their gains in A per m, m/s, and m of each sample."""
    T, by_axis = float(PERIOD), {}
    force = {"x": FORCE, "y": 2 * FORCE, "phi": 2 * FORCE * shared.ARM}
    acceleration = {"x": PER_AMPERE, "y": 2 * PER_AMPERE, "phi": 2 * YAW_PER_AMPERE}
    for axis, weights in WEIGHTS.items():
        K, unit = gain(acceleration[axis], weights, 1 if axis == "x" else 2), force[axis] / shared.scales()[axis]
        k_q, k_z, k_v = (unit * v for v in K)
        by_axis[axis] = Axis(acceleration[axis] / unit, k_q, k_v, k_z * T, float(Fraction(POLE[axis])))
    return by_axis


def gain(b: float, weights: tuple[float, float, float], R: float) -> Array:
    """Return K (3,) of s = -K (q, z, q') for the integral of x' diag(weights) x + R s^2 with s held over a period."""
    with mpmath.workdps(60):
        A = mpmath.matrix([[0, 0, 1], [1, 0, 0], [0, 0, 0]])
        _, K = gains.lqrd(A, mpmath.matrix([0, 0, mpmath.mpf(b)]), weights, R, PERIOD)
        return np.array([float(K[0, j]) for j in range(3)])


def initial_state() -> dict[str, Array]:
    """Return the state after init, by name."""
    names = [f"lqg_{axis}_{part}" for axis in HORIZONTAL for part in ("x3", "integral", "achieved")]
    law = {name: np.array(0.0) for name in names}
    return shared.initial_state(UPRIGHT) | sensing.initial_state_with_innovation() | law


def observer_state(name: str, q: Array, ready: Array, state: Columns) -> Array:
    """Return x3 in m/s or rad/s; that of a platen at rest until every measurement has been good once. (33)."""
    k = axes()[name]
    return np.where(ready > 0, state[f"lqg_{name}_x3"] / rate_gain(k), -(1 - k.p) / float(PERIOD) * q)


def demand(name: str, q: Array, r: Array, ready: Array, state: Columns) -> tuple[Array, Array]:
    """Return the demand of an axis, and its part w that does not come from error and integral. (33), (49)."""
    k, T, f1 = axes()[name], float(PERIOD), state[f"lqg_{name}_achieved"]
    v = observer_state(name, q, ready, state) + (1 - k.p) / T * q
    q1, v1 = q + T * v + k.b * T**2 / 2 * f1, v + k.b * T * f1
    w = -k.k_q * (q1 - q) - k.k_v * v1
    e = np.clip(r - q, -ERROR[name], ERROR[name])
    return w + (k.k_q + k.k_z) * e + state[f"lqg_{name}_integral"], w


def rate_gain(k: Axis) -> float:
    """Return the gain on the estimated rate, by which x3 is scaled."""
    return k.k_q * float(PERIOD) + k.k_v


def next_regulator_state(
    name: str, q: Array, r: Array, ready: Array, achieved: Array, state: Columns
) -> dict[str, Array]:
    """Return the next observer, integral and force of an axis; the integral decays while the error is clipped. (33)."""
    k, T, f1, w = axes()[name], float(PERIOD), state[f"lqg_{name}_achieved"], demand(name, q, r, ready, state)[1]
    L, g = (1 - k.p) / T, k.k_z / (k.k_q + k.k_z)
    observer = k.p * observer_state(name, q, ready, state) - L * (1 - k.p) * q + k.b * T * (1 - L * T / 2) * f1
    integral = state[f"lqg_{name}_integral"]
    return {
        f"lqg_{name}_x3": rate_gain(k) * observer,
        f"lqg_{name}_integral": integral + g * (np.where(np.abs(r - q) <= ERROR[name], achieved - w, 0) - integral),
        f"lqg_{name}_achieved": achieved,
    }


def late_bits(loop_inputs: Mapping[str, tuple[Array, Array, Array]], guarded: shared.Guarded) -> Array:
    """Return the status bits of x and y, whose error is beyond ERROR; 0 while it brakes and after a latch."""
    follows = ~guarded.braked & (guarded.after["guard_latched"] == 0)
    bits = [
        (1 << bit) * (follows & (np.abs(r - q) > ERROR[axis]))
        for axis, bit in LATE.items()
        for q, r, _ in (loop_inputs[axis],)
    ]
    return np.sum(bits, axis=0).astype(np.uint32)


def step(state: Columns, inputs: Columns) -> tuple[dict[str, Array], dict[str, Array], Array]:
    """Return (next state, phase currents, fault word) of one sample, columns by name."""
    guarded = shared.guard_inputs(state, inputs)
    values, after, word = guarded.values, guarded.after, guarded.word
    ready, scales = np.asarray(state["guard_ready"]), shared.scales()
    flags, predicted = (ready, guarded.complete), dead_reckoning.predicted_pose(state, HORIZONTAL)
    pose, after_sensing = sensing.sense(state, values, flags, predicted, sensing.constants(float(PERIOD)), True)
    pose |= {"phi": pose["phi_raw"], **shared.vertical_kinematics(values)}
    loop_inputs = {axis: (pose[f"{axis}_raw"], values[f"{axis}_ref"], ready) for axis in HORIZONTAL}
    e = {axis: values[f"{axis}_ref"] - pose[axis] for axis in UPRIGHT}
    k = {axis: shared.vertical(axis, PERIOD) for axis in UPRIGHT}
    demands = {axis: demand(axis, *qr, state)[0] * scales[axis] for axis, qr in loop_inputs.items()}
    measured = {axis: pose[f"{axis}_raw"] for axis in HORIZONTAL}
    acting = {axis: state[f"lqg_{axis}_achieved"] for axis in HORIZONTAL}
    now = shared.sample(state, measured, pose["measured"], acting, float(PERIOD), BANDWIDTH)
    demands |= {axis: shared.demand(axis, k[axis], e[axis], state) for axis in UPRIGHT}
    demands = guard.begun(state, demands, guarded.complete)
    demands |= shared.brake({axis: demands[axis] for axis in HORIZONTAL}, state, now, guarded.braked)
    currents, achieved = shared.allocate(demands, pose["phi"])
    for axis, qr in loop_inputs.items():
        after |= next_regulator_state(axis, *qr, achieved[axis] / scales[axis], state)
    for axis in UPRIGHT:
        after |= shared.next_compensator_state(axis, k[axis], e[axis], achieved[axis], state)
    after |= after_sensing | dead_reckoning.next_state(state, now)
    word = word | late_bits(loop_inputs, guarded)
    next_state, out = shared.finish_step(state, after, shared.phases(currents, pose), PERIOD)
    return next_state, out, word
