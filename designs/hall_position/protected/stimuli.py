"""Stimuli of the estimators with protection levels: bodies rest for a sweep and then move, with faults of a sensor.

body k has fault k of FAULTS, from a random sample of its motion on: none, a dead sensor, a stuck voltage, an offset, a
voltage that is not a number, or one out of its range
"""

from collections.abc import Callable, Mapping

import numpy as np

from designs.hall_position.config import TIME
from designs.hall_position.protected import config
from models import hall_motions as motions
from models.hall_motions import Numbers, Pose
from synth.execute import host
from synth.verify import steps
from synth.verify.sampling import Columns
from synth.verify.steps import Steps
from synth.verify.stimuli import excursions

SAMPLES, REST = 300, 110  # samples of a motion, and those at rest before it
TRAVEL, YAW, SEED = 0.2, 0.08, 2_031  # m, rad
STUCK, OFFSET, BEYOND = 0, 0.3, 7.0  # sample of the kept value; V
Fault = Callable[[Numbers], Numbers]  # voltages (n, 2) of a sensor from its failure on -> the failed ones


def _first(value: Callable[[Numbers], Numbers | float]) -> Fault:
    return lambda V: np.column_stack([np.broadcast_to(value(V), len(V)), V[:, 1]])


FAULTS: Mapping[str, Fault] = {
    "none": lambda V: V,
    "dead": lambda V: 0 * V,
    "stuck": _first(lambda V: V[STUCK, 0]),
    "offset": _first(lambda V: V[:, 0] + OFFSET),
    "not a number": _first(lambda V: np.nan),
    "out of range": _first(lambda V: BEYOND),
}


def voltages(bodies: int, seed: int = SEED, name: str = config.NAME) -> Numbers:
    """Return the voltages (SAMPLES, bodies, sensors, 2) of bodies in motion, each with its fault."""
    array, rng = config.array(name), np.random.default_rng(seed)
    moved = motions.smooth_motions(TIME.period_s, (SAMPLES - REST, bodies), seed, TRAVEL, YAW)
    paths = [np.concatenate([np.repeat(v[:1], REST, axis=0), v]) for v in (moved.X, moved.Y, moved.yaw)]
    first = rng.uniform(-0.45, 0.45, (2, bodies)) * array.pitch
    along = [path - path[0] + start for path, start in zip(paths, first, strict=False)]
    V = motions.noisy(array, Pose(along[0], along[1], paths[2]), seed) * (1 + 0.1 * rng.uniform(-1, 1, (bodies, 1, 1)))
    for k, fails in zip(range(bodies), list(FAULTS.values()) * bodies, strict=False):
        begin, sensor = rng.integers(REST, SAMPLES), rng.integers(len(array.positions))
        V[begin:, k, sensor] = fails(V[begin:, k, sensor])
    return V


def sequences(controller: host.Controller) -> list[Steps]:
    """Return motions with each fault of FAULTS, and the excursions from them: for cost and decision coverage."""
    V = voltages(len(FAULTS), name=str(controller.manifest["design"]))
    loops = [
        steps.record(controller, f"motion, {fault}", motions.by_input(V[:, k]), closed_loop=True)
        for k, fault in enumerate(FAULTS)
    ]
    at_rest = {name: float(v[0]) for name, v in motions.by_input(V[:, 0]).items()}
    return [*loops, *excursions(controller, at_rest, loops)]


def inputs(bodies: int, seed: int = SEED, name: str = config.NAME) -> Columns:
    """Return the inputs (SAMPLES, bodies) by name."""
    return motions.by_input(voltages(bodies, seed, name))
