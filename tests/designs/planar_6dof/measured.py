"""What the planar positioner's sensors measure, and its sensing and filters with and without C for it.

plant's voltages (+ noise) ---> [ sensing, filters ] ---> raw, filtered, suspects
"""

from collections.abc import Mapping
from functools import cache
from typing import Any

import numpy as np

from designs.planar_6dof import filtering, reference_sensing, reference_suspects
from designs.planar_6dof.sensing import calibration
from designs.planar_6dof.sensing import maps as sensing_maps
from designs.planar_6dof.sensing import sections as sensing
from models import planar_stage
from synth.block import Block, unranged
from synth.emit import write
from synth.execute import host
from synth.statespace import Array
from synth.timing import Discrete
from tests import tolerances

PLANT = planar_stage.plant()
TIME = Discrete(1 / 800)
HALL = planar_stage.HALL
CAL = calibration.of(PLANT)
A, L = CAL.amplitude, CAL.pitch
W = 2 * np.pi / L
AS_MEASURED = [s.name for s in sensing.RAW.values()]
RESIDUALS = [s.name for s in sensing.RESIDUALS]
SIGMA = sensing_maps.deviation(PLANT)  # V rms
REFERENCE = reference_sensing.constants(TIME.period_s)
EXACT = tolerances.of("double")

Columns = Mapping[str, Array]


@cache
def estimation(predicted: bool = True) -> Block:
    return sensing_maps.estimation(PLANT, TIME, filtering.blocks(TIME) if predicted else ())


@cache
def compile_estimation(scalar: type[np.floating], predicted: bool = True) -> host.Controller:
    made = write.emit(unranged(estimation(predicted)), scalar)
    return host.load(made.files, made.manifest)


def held_voltages(voltages: Columns) -> dict[str, Any]:
    return {f"{name}_held": v for name, v in voltages.items()}


def noisy(voltages: Columns, seed: int = 0) -> dict[str, Array]:
    rng = np.random.default_rng(seed)
    return {name: v + SIGMA * rng.normal(size=v.shape) for name, v in voltages.items()}


def estimation_inputs(u: Columns) -> dict[str, Any]:
    """Return what the estimation reads of voltages (N,) that the guard accepts."""
    return held_voltages(u) | {"ready": np.arange(len(u["V_ax"])) > 0, "complete": 1.0}


def replay(
    pose: Columns, noise: bool = False, scalar: type[np.floating] = np.float64, predicted: bool = True
) -> host.Columns:
    """Return the outputs of the C along a trajectory (N,) that begins in the middle pitch."""
    u = sensing_maps.voltages(PLANT, pose)
    return compile_estimation(scalar, predicted).replay(estimation_inputs(noisy(u) if noise else u)).outputs


def pitches(run: host.Columns, axis: str) -> Array:
    """Return the whole pitches (N,) that a run counts."""
    count = (np.asarray(run[f"{axis}_raw"], float) - np.asarray(run[f"within_{axis}"], float)) / L
    assert np.abs(count - np.rint(count)).max() < 1e-6  # single precision of a position
    return np.rint(count)


def rms(v: Array) -> float:
    return float(np.sqrt(np.mean(np.square(v))))


def forward_and_back(travel: float, n: int) -> dict[str, Array]:
    """To and fro through the middle: x up to `travel` and back to -travel, y the other way round at half the speed."""
    x = travel * np.interp(np.arange(n), [0, n / 4, 3 * n / 4, n], [0, 1, -1, 0])
    return {"x": x, "y": -0.5 * x}


def motion(n: int, columns: int, seed: int) -> dict[str, Array]:
    """Sines of 0.2 to 1 Hz in x, y and phi, (n, columns), that begin anywhere in the middle pitch."""
    rng = np.random.default_rng(seed)
    t = np.arange(n)[:, None] * TIME.period_s
    pose = {}
    for axis, size, start in (("x", 0.06, 0.4 * L), ("y", 0.06, 0.4 * L), ("phi", 4e-3, 0.0)):
        rate, turn = rng.uniform(0.2, 1.0, columns), rng.uniform(0, 2 * np.pi, columns)
        wave = size * rng.uniform(0.2, 1, columns) * np.sin(2 * np.pi * rate * t + turn)
        pose[axis] = wave - wave[0] + rng.uniform(-start, start, columns)
    return pose


def start(predicted: bool, n: int) -> dict[str, Array]:
    """Return the reference's states (n,) after init."""
    rest = reference_sensing.initial_filter_state() if predicted else {"sensing_phi_raw": np.array(0.0)}
    return {name: np.zeros(n) + v for name, v in (reference_sensing.initial_state() | rest).items()}


def reference_step(
    state: Columns, v: Columns, flags: tuple[Array, Array], predicted: bool
) -> tuple[dict[str, Array], dict[str, Array]]:
    """Return outputs and next states of the reference, with its filters or predicting the sample before."""
    suspicion = {f"suspect_{name}": one for name, one in reference_suspects.suspects(state, A).items()}
    confirmed = state["sensing_contradiction_confirmed"]
    is_amplitude = (confirmed > 0) & reference_suspects.is_amplitude(state, A)
    suspicion |= {"suspected": confirmed, "other_amplitude": is_amplitude}
    if predicted:
        poses = {axis: state[f"filter_{axis}_p"] for axis in filtering.AXES}
        raw, after = reference_sensing.sense(state, v, flags, poses, REFERENCE)
        filtered, after_filters = reference_sensing.filter_positions(state, raw, flags[0], REFERENCE)
        out, after = raw | filtered, after | after_filters
    else:
        last = {axis: state[f"sensing_within_{axis}"] + state[f"sensing_offset_{axis}"] for axis in "xy"}
        last["phi"] = state["sensing_phi_raw"]
        out, after = reference_sensing.sense(state, v, flags, last, REFERENCE)
        after["sensing_phi_raw"] = out["phi_raw"]
    return out | suspicion, after
