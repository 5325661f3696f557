"""Stimuli of the estimators with protection levels: bodies rest for a sweep and then move, with faults of a sensor.

body k has fault k of FAULTS, from a random sample of its motion on: none, a dead sensor, a stuck voltage, an offset, a
voltage that is not a number, or one out of its range
"""

from collections.abc import Callable, Mapping

import numpy as np

from designs.hall_position.config import TIME
from designs.hall_position.glsdc.channels import SPAN
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
AT_REST = (
    "motion",
    "missed",
    "metres_pitch",
    "repeats",
)  # parts of the names of states that are 0 while it tracks at rest
TRACKING_STEPS, RANGE_END_STEPS = 200_000, 40  # steps drawn, and kept of each end of a range
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
    """Return motions with each fault of FAULTS and each dead sensor, sweeps with a fault, excursions, exclusions in
    doubt and lost tracks: for cost and coverage.
    """
    V = voltages(len(FAULTS), name=str(controller.manifest["design"]))
    loops = [
        steps.record(controller, f"motion, {fault}", motions.by_input(V[:, k]), closed_loop=True)
        for k, fault in enumerate(FAULTS)
    ]
    for sensor in range(V.shape[2]):
        failed = V[:, 0].copy()
        failed[(REST + SAMPLES) // 2 :, sensor] = 0
        loops.append(steps.record(controller, f"motion, sensor {sensor} dead", motions.by_input(failed)))
    at_rest = {name: float(v[0]) for name, v in motions.by_input(V[:, 0]).items()}
    V[:REST, ::2, 0] = 0
    V[:REST, 1::2, 0, 0] += OFFSET
    sweeps = [
        steps.record(controller, f"sweep {k}, {'offset' if k % 2 else 'dead'}", motions.by_input(V[:REST, k]))
        for k in range(len(FAULTS))
    ]
    tracking = tracking_steps(controller)
    ends = steps.at_range_ends(controller, tracking, RANGE_END_STEPS)
    outputs = steps.evaluate(controller, tracking).outputs
    unavailable = np.flatnonzero((outputs["converged"] > 0) & (outputs["valid"] == 0))[-RANGE_END_STEPS:]
    doubted = steps.concatenate("doubted", [_in_doubt(controller, each) for each in (*loops, tracking)])
    valid = loops[0].part(np.flatnonzero(steps.evaluate(controller, loops[0]).outputs["valid"] > 0)[-RANGE_END_STEPS:])
    states = valid.states.copy()
    states["estimator_missed"] = config.TUNINGS[str(controller.manifest["design"])].patience
    lost = Steps("lost", states, valid.inputs)
    return [*loops, *sweeps, *excursions(controller, at_rest, loops), ends, tracking.part(unavailable), doubted, lost]


def _in_doubt(controller: host.Controller, of: Steps) -> Steps:
    """Return the steps that converge with a sensor excluded, with every hypothesis remembered, and half of them as a
    trial of the next sensor; none excludes one without a fault.
    """
    outputs = steps.evaluate(controller, of).outputs
    part = of.part(np.flatnonzero((outputs["converged"] > 0) & (outputs["excluded"] > 0))[-RANGE_END_STEPS:])
    states, sensors = part.states.copy(), len(part.inputs.dtype.names or ()) // 2
    for k in range(1, sensors + 1):
        states[f"estimator_plausible_{k}"] = 1
    states["estimator_competing"] = np.where(np.arange(len(part)) % 2, states["estimator_excluded"] % sensors + 1, 0)
    return Steps("doubted", states, part.inputs)


def tracking_steps(controller: host.Controller) -> Steps:
    """Return steps that track any pose, without any sensor: half with voltages of no pose, half with those of it."""
    pool, array = steps.random_steps(controller, TRACKING_STEPS), config.array(str(controller.manifest["design"]))
    rng, states, n = np.random.default_rng(SEED), pool.states.copy(), len(pool)
    voltages = pool.inputs.copy()
    bounds = {f["name"]: f for f in controller.manifest["structs"]["state"]["fields"]}
    for name in ("phase_x", "phase_y", "yaw", "amplitude"):
        of = bounds[f"estimator_{name}"]
        states[of["name"]] = rng.uniform(of["low"], of["high"], n)
    at = [states[f"estimator_{name}"].astype(float) for name in ("phase_x", "phase_y", "yaw")]
    pose = Pose(at[0] / array.wave_number, at[1] / array.wave_number, at[2])
    for name, seen in motions.by_input(motions.noisy(array, pose, SEED)).items():
        voltages[name] = np.where(np.arange(n) < n // 2, rng.uniform(-SPAN, SPAN, n), seen)
        states[f"screen_last_{name}"] = 0
    for name in (n for n in bounds if any(part in n for part in AT_REST)):
        states[name] = 0
    states["estimator_start_number"] = bounds["estimator_start_number"]["high"]
    states["estimator_excluded"] = rng.integers(0, len(voltages.dtype.names or ()) // 2 + 1, n)
    return Steps("tracking from anywhere", states, voltages)


def inputs(bodies: int, seed: int = SEED, name: str = config.NAME) -> Columns:
    """Return the inputs (SAMPLES, bodies) by name."""
    return motions.by_input(voltages(bodies, seed, name))
