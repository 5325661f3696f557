"""Random steps of a planar controller: states and inputs in operation over the whole travel, and at the range limits.

In operation the voltages and distances are those of a pose anywhere in the range of the plant, and predictions and
pitch counts agree with them except for noise. Demands have a given size: most motors are within their limits, which
would otherwise hide differences. At the edges, states are anywhere in their bounds, and inputs are at the ends of their
ranges, beyond them, or not finite.
"""

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from designs.planar_6dof import allocation, cost_stimuli, motion
from designs.planar_6dof.interface import Subject
from designs.planar_6dof.sensing import calibration
from designs.planar_6dof.sensing import sections as sensing
from models import planar_stage
from synth.block import Block
from synth.errors import SignalError
from synth.plant import Plant
from synth.verify import sampling
from synth.verify.sampling import Columns

SEED = 20_060_711
INSIDE = sampling.MARGIN
UNREADY, SUSPECTED, FAILED, COUNTING = 0.02, 0.02, 0.1, 0.02  # shares of samples; the last counts bad samples
OTHER_AMPLITUDE, ALIKE = 0.02, 0.5  # share of samples; of first residuals that another amplitude explains
WRONG = 0.6  # V: standard deviation of a failed voltage; from some 0.2 V on it contradicts the others
AMPLITUDE = 0.15  # standard deviation of the relative error of all voltages
PART = 0.3  # of the size of demands: standard deviation of each of its terms
ENDS, DEAD = 0.25, 0.02  # shares: inputs at a special value, and samples with one special value in all Hall voltages
REPEATED, FROZEN = 0.5, 0.3  # shares of samples: the watched voltage repeats its code, a channel is frozen
RESTING = 0.2  # share of edge steps with a flag that suppresses the control law
TINY = 1e-100  # V: the square of a smaller voltage may underflow
LAW = ("loop_", "lqg_", "delay_")  # its Blocks
SENSING, UNCONSTRAINED = (
    ("sensing_", "filter_", "reckoning_"),
    ("sensing_contradiction_left", "sensing_first_", "sensing_watch_", "reckoning_x_dist", "reckoning_y_dist"),
)  # prefixes of states; any value of the latter is plausible
PREDICTED, VELOCITY_STEP, ACCELERATION_STEP = (
    3e-5,
    1e-5,
    1e-6,
)  # m, rad: deviations of position, T velocity, T^2/2 acceleration


def operating_steps(subject: Subject, plant: Plant, n: int, seed: int = SEED) -> tuple[Columns, Columns]:
    """Draw n independent (states, inputs) with the platen anywhere.

    Raises SignalError when the controller has sensing or filter states that are unknown here.
    """
    block, rng = subject.block, np.random.default_rng(seed)
    states, _ = sampling.anywhere(block, rng, n, INSIDE)
    box = {a: next(s for s in block.inputs if s.name == f"{a}_ref") for a in allocation.AXES}
    middle = {a: ((s.low + s.high) / 2, (s.high - s.low) / 2) for a, s in box.items()}
    pose = {a: sampling.limited_to_range(box[a], at + half * rng.uniform(-1, 1, n)) for a, (at, half) in middle.items()}
    known = {"guard_latched": np.zeros(n), "guard_ready": _random_flags(rng, n, 1 - UNREADY)}
    known["guard_left"] = _samples_left(block, states, rng)
    known |= {"sensing_contradiction_confirmed": _random_flags(rng, n, SUSPECTED)} | _sensing_states(
        plant, pose, rng, n
    )
    known |= _random_law_states(subject, plant, pose, rng, n)
    known["sensing_frozen"] = states["sensing_frozen"] * _random_flags(rng, n, FROZEN)
    if unknown := [s for s in states if s.startswith(SENSING) and s not in known and not s.startswith(UNCONSTRAINED)]:
        listed = ", ".join(unknown)
        raise SignalError(f"'{block.name}' has the states {listed} with no value for a known pose: add them here")
    error = {a: rng.normal(0, PART, n) * subject.size * _saturating_error(block, plant, a) for a in allocation.AXES}
    references = {f"{a}_ref": sampling.limited_to_range(box[a], pose[a] + error[a]) for a in allocation.AXES}
    inputs = _with_wrong_voltage(cost_stimuli.sensor_values(pose), rng, n) | references
    known["sensing_watch_code"] = _watched_codes(states, inputs, rng)
    return {s: known.get(s, random) for s, random in states.items()}, inputs


def _watched_codes(states: Columns, inputs: Columns, rng: np.random.Generator) -> NDArray[Any]:
    """Return codes (N,) that the watched voltages repeat, or any other."""
    channel, code = np.asarray(states["sensing_watch_channel"]).astype(int), states["sensing_watch_code"]
    repeated = np.choose(channel, [inputs[name] for name in planar_stage.HALL])
    return np.where(_random_flags(rng, len(code), REPEATED) > 0, repeated, code)


def _samples_left(block: Block, states: Columns, rng: np.random.Generator) -> NDArray[Any]:
    """Return mostly all of the samples that the guard has left, else any number of them."""
    left, most = states["guard_left"], max(s.signal.high for s in block.states if s.name == "guard_left")
    return np.where(_random_flags(rng, len(left), 1 - COUNTING) > 0, most, left)


def _with_wrong_voltage(columns: Columns, rng: np.random.Generator, n: int) -> Columns:
    """Return sensor values (N,) with one wrong Hall voltage in some samples, and another amplitude of all in others."""
    wrong, channel = _random_flags(rng, n, FAILED) * rng.normal(0, WRONG, n), rng.integers(0, len(planar_stage.HALL), n)
    amplitude = 1 + _random_flags(rng, n, OTHER_AMPLITUDE) * rng.normal(0, AMPLITUDE, n)
    off = {name: np.where(channel == i, wrong, 0.0) for i, name in enumerate(planar_stage.HALL)}
    limit = sensing.VOLTAGE * (1 - INSIDE)
    return columns | {name: np.clip(amplitude * columns[name] + by, -limit, limit) for name, by in off.items()}


def _sensing_states(plant: Plant, pose: Mapping[str, NDArray[Any]], rng: np.random.Generator, n: int) -> Columns:
    """Return the states of sensing and filters for platens near rest at a pose (N,)."""
    pitch, count = plant.parameter("l").value, sensing.PITCHES
    predicted = {a: pose[a] + rng.normal(0, PREDICTED, n) for a in allocation.HORIZONTAL}
    whole = {a: pitch * np.clip(np.round(predicted[a] / pitch), -count, count) for a in "xy"}
    columns = {f"sensing_offset_{a}": values for a, values in whole.items()}
    columns |= {
        f"sensing_within_{a}": np.clip(predicted[a] - whole[a], -pitch / 2, pitch / 2) * (1 - INSIDE) for a in "xy"
    }
    columns |= {"sensing_scale": rng.uniform(0.99, 1.01, n)} | _first_residuals(rng, n)
    columns["sensing_innovation_phi"] = rng.normal(0, PREDICTED, n)
    columns["sensing_phi_raw"] = np.clip(predicted["phi"], -sensing.MAX_RAW_YAW, sensing.MAX_RAW_YAW) * (1 - INSIDE)
    for a in allocation.HORIZONTAL:
        columns |= {
            f"filter_{a}_p": predicted[a],
            f"filter_{a}_s": rng.normal(0, VELOCITY_STEP, n),
            f"filter_{a}_h": rng.normal(0, ACCELERATION_STEP, n),
            f"reckoning_{a}_position": predicted[a],
            f"reckoning_{a}_rate": rng.normal(0, VELOCITY_STEP, n),
        }
    return columns | {f"reckoning_{a}_mean": rng.normal(0, PREDICTED, n) for a in motion.BIAS}


def _first_residuals(rng: np.random.Generator, n: int) -> Columns:
    """Return the residuals of first contradictions, by one voltage or by another amplitude of all."""
    alike, A = _random_flags(rng, n, ALIKE), calibration.of(planar_stage.plant()).amplitude
    m = 0.3 * A**2 * rng.normal(size=n)
    columns = {"m_x": m, "m_y": np.where(alike > 0, m * rng.uniform(0.5, 1.5, n), rng.normal(0, 0.3 * A**2, n))}
    columns |= {r: np.where(alike > 0, 0.01, 0.1) * A * rng.normal(size=n) for r in ("r_1", "r_2")}
    return {f"sensing_first_{name}": values for name, values in columns.items()}


def edge_steps(block: Block, n: int, seed: int = SEED) -> tuple[Columns, Columns]:
    """Draw n independent (states, inputs) anywhere in the declared bounds, with inputs at range ends or not finite.

    Samples in which all voltages of an axis are tiny but not 0 are left out: the comparison of two squares that
    underflow is undefined.
    """
    rng = np.random.default_rng(seed + 1)
    states, inputs = sampling.anywhere(block, rng, n + n // 20, INSIDE)
    states |= {
        flag: _random_flags(rng, n + n // 20, RESTING) for flag in ("guard_latched", "sensing_contradiction_confirmed")
    }
    all_same = rng.uniform(size=n + n // 20) < DEAD
    same = np.take(sampling.SPECIAL, rng.integers(0, len(sampling.SPECIAL), len(all_same)))
    for s in block.inputs:
        ends = sampling.edge_values(s)
        special = rng.uniform(size=len(all_same)) < ENDS
        inputs[s.name] = np.where(special, np.take(ends, rng.integers(0, len(ends), len(all_same))), inputs[s.name])
        inputs[s.name] = np.where(all_same & (s.name in planar_stage.HALL), same, inputs[s.name])
    kept = np.flatnonzero(~(_underflows(inputs, "V_bx") | _underflows(inputs, "V_cy")))[:n]
    return {s: v[kept] for s, v in states.items()}, {s: v[kept] for s, v in inputs.items()}


def _underflows(inputs: Mapping[str, NDArray[Any]], cosine: str) -> NDArray[np.bool_]:
    size = np.abs([inputs["V_ax"], inputs["V_ay"], inputs[cosine]])
    with np.errstate(invalid="ignore"):
        return np.asarray((size < TINY).all(axis=0) & (size > 0).any(axis=0))


def is_saturated(outputs: Mapping[str, NDArray[Any]]) -> NDArray[np.bool_]:
    """Return for each sample whether a motor is at its limit, from its phases."""
    size = []
    for motor in planar_stage.MOTORS:
        a, b, c = (np.asarray(outputs[f"i_{motor}{phase}"]) for phase in "ABC")
        size.append(np.sqrt(2 / 3 * (a**2 + b**2 + c**2)))
    return np.asarray(np.max(size, axis=0) >= allocation.QUADRATURE * (1 - 1e-9))


def law_states(block: Block) -> list[str]:
    """Return the names of the states of a controller's law."""
    return [s.name for s in block.states if s.name.startswith(LAW)]


def axis_of(state: str) -> str:
    """Return the axis of a state of the law."""
    return next(part for part in state.split("_") if part in allocation.AXES)


def _random_law_states(
    subject: Subject, plant: Plant, pose: Mapping[str, NDArray[Any]], rng: np.random.Generator, n: int
) -> Columns:
    most, mean = allocation.authority(plant), subject.at_rest(pose)
    states = {}
    for s in (s for s in subject.block.states if s.name in law_states(subject.block)):
        value = mean.get(s.name, 0.0) + rng.normal(0, PART * subject.size * most[axis_of(s.name)], n)
        states[s.name] = sampling.limited_to_range(s.signal, value)
    return states


def _saturating_error(block: Block, plant: Plant, axis: str) -> float:
    """Return the error in m or rad whose demand is the largest that the motors can meet."""
    gains = [c.value for c in block.constants if c.name in (f"loop_{axis}_gain", f"lqg_{axis}_error_gain")]
    if len(gains) != 1:
        raise SignalError(f"'{block.name}' has {len(gains)} gains of the error of {axis}: one is needed to draw steps")
    return allocation.authority(plant)[axis] / gains[0]


def _random_flags(rng: np.random.Generator, n: int, share: float) -> NDArray[Any]:
    return np.asarray(rng.uniform(size=n) < share, dtype=float)
