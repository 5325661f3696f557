"""The maglev commutation, one step of 1 ms, in NumPy: reference for the generated C.

    angle    th = pi s/tau + pi/2 at s = p + 1.5 (p - p_before), where the current of this sample acts: one sample of
             delay and half a sample of hold; p follows the measurement by at most 1 mm in a sample
    phases   i_k = sqrt(2) (i_d cos(th - 2 pi k/3) - i_q sin(th - 2 pi k/3)),  k = 0, 1, -1 for a, b, c
    lost     the motors along an axis whose position is refused five times in a row hand i_d over to the other two and
             fade out in 25 samples; with both positions lost, all carry on for 80 samples and then fade out

`step` takes scalars or columns (n,) of n independent Blocks. Lengths in m, currents in A: i_d and i_q rms, phases
instantaneous.
"""

from collections.abc import Mapping
from math import pi, sqrt
from typing import Any

import numpy as np
from numpy.typing import NDArray

from synth.reference import guard

Array = NDArray[np.float64]
Columns = Mapping[str, NDArray[Any]]

TAU = 0.05715  # m, pole pitch
ADVANCE, STRIDE = 1.5, 1e-3  # samples, m in a sample
CURRENT = 7 / sqrt(2)  # A rms
BAD_SAMPLES, FADE, DESCENT = 5, 25, 80
PEAK = sqrt(2) * sqrt(2) * CURRENT * (1 + 1e-4)
LIMITS = {f"i_{axis}{j}": (-CURRENT, CURRENT) for axis in "dq" for j in (1, 2, 3, 4)} | dict.fromkeys("xz", (-0.1, 0.1))
INPUTS = {"x": "x_commutation", "z": "z_commutation"}
MOTORS = {"x": (2, 4), "z": (1, 3)}
SHIFTS = {"a": 0.0, "b": -2 * pi / 3, "c": 2 * pi / 3}


def advance(state: Columns, measured: Array, refused: NDArray[np.bool_], axis: str) -> tuple[Array, dict[str, Array]]:
    """Return the position when the current acts, and the Block's next states of this axis."""
    left = np.asarray(state[f"advance_left_{axis}"], dtype=np.float64)
    before = np.where(left > 0, state[f"advance_last_{axis}"], measured)
    position = np.clip(measured, before - STRIDE, before + STRIDE)
    left = np.where(refused, np.maximum(left - 1, 0), BAD_SAMPLES)
    after = {f"advance_last_{axis}": position, f"advance_left_{axis}": left}
    return position + ADVANCE * (position - before), after


def next_transfer(
    transfer: Array, lost_x: NDArray[np.bool_], lost_z: NDArray[np.bool_], stays: NDArray[np.bool_]
) -> Array:
    """Return the part that is handed over, one sample later."""
    target = np.where(stays, transfer, lost_x.astype(float) - lost_z)
    return np.clip(target, transfer - 1 / FADE, transfer + 1 / FADE)


def hand_over(state: Columns, lost_x: NDArray[np.bool_], lost_z: NDArray[np.bool_]) -> tuple[Array, Array]:
    """Return the next part that is handed over, > 0 along X and < 0 along Z, and the next count of both lost."""
    transfer, count = (np.asarray(state[f"commutation_{n}"], dtype=np.float64) for n in ("transfer", "unknown"))
    transfer = next_transfer(transfer, lost_x, lost_z, lost_x & lost_z)
    known_again = np.maximum(count - 1, 0)
    return transfer, np.where(lost_x & lost_z, np.minimum(count + 1, DESCENT + FADE), known_again)


def direct_currents(values: Mapping[str, Array], transfer: Array, active: NDArray[np.bool_]) -> dict[int, Array]:
    """Return i_d of each motor with what the motors of the other axis hand over, within the limit beside its i_q."""
    parts = {"x": np.maximum(transfer, 0), "z": np.maximum(-transfer, 0)}
    direct = {}
    for axis, giver in (("x", "z"), ("z", "x")):
        handed = parts[giver] * np.mean([values[f"i_d{j}"] for j in MOTORS[giver]], axis=0)
        for j in MOTORS[axis]:
            i_d, room = values[f"i_d{j}"], CURRENT - np.abs(values[f"i_q{j}"])
            direct[j] = np.where(active, np.clip(i_d + handed, -room, room), i_d)
    return direct


def step(state: Columns, inputs: Columns) -> tuple[dict[str, Array], dict[str, Array], NDArray[Any]]:
    """Return (next state, outputs, fault word) of one sample, columns by name."""
    accepted = guard.accept(state, inputs, LIMITS, called=INPUTS)
    values, after = accepted.values, accepted.after
    acting, lost = {}, {}
    for axis in "xz":
        acting[axis], states = advance(state, values[axis], ~accepted.good[axis], axis)
        lost[axis] = states[f"advance_left_{axis}"] == 0
        after |= states
    active = lost["x"] | lost["z"] | (np.asarray(state["commutation_transfer"]) != 0)
    active |= np.asarray(state["commutation_unknown"]) > 0
    transfer, unknown = hand_over(state, lost["x"], lost["z"])
    whole = np.minimum((DESCENT + FADE - np.asarray(state["commutation_unknown"], dtype=np.float64)) / FADE, 1)
    shares = {"x": whole * (1 - np.maximum(transfer, 0)), "z": whole * (1 - np.maximum(-transfer, 0))}
    direct = direct_currents(values, transfer, active)
    outputs = {}
    for axis, motors in MOTORS.items():
        share = np.where(active, shares[axis], 1.0)
        for j in motors:
            for phase, shift in SHIFTS.items():
                th = pi * acting[axis] / TAU + pi / 2 + shift
                current = sqrt(2) * share * (direct[j] * np.cos(th) - values[f"i_q{j}"] * np.sin(th))
                outputs[f"i_{phase}{j}"] = np.clip(current, -PEAK, PEAK)
    after |= {
        "commutation_transfer": np.where(active, transfer, 0),
        "commutation_unknown": np.where(active, unknown, 0),
    }
    word = accepted.word + 1024 * lost["x"] + 2048 * lost["z"]
    return after, outputs, np.asarray(word).astype(np.uint32)
