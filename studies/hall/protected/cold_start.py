"""Ensembles of cold starts: bodies rest anywhere in the pitch from init on, some with a faulty sensor.

Bodies are MARGIN or more from the pitch's edge: nearer to it the noise decides the pitch. A fault is there from the
first sample on, and may be in every start of the sweep.
"""

from dataclasses import dataclass

import numpy as np

from designs.hall_position.protected import config
from designs.hall_position.protected.parameters import Tuning
from models import hall_motions as motions
from models.hall_motions import Pose
from studies.hall.protected import faults, trust
from studies.hall.protected.trust import World
from synth.execute import host

MARGIN, SAMPLES = 1e-3, 120  # m, and samples from init on


@dataclass(frozen=True)
class ColdStart:
    """Shares of bodies that are tracked at the end and that were ever valid; samples until valid.

    `wrong` bodies were ever valid and a pitch or more off, `misled` is the share of valid samples that are wrong.
    """

    tracked: float
    valid: float
    median: float
    longest: int
    wrong: int
    misled: float


def run(
    tuning: Tuning,
    field: str,
    bodies: int,
    samples: int = SAMPLES,
    seed: int = 1,
    name: str = config.NAME,
    fault: str = "none",
) -> ColdStart:
    """Return the result of bodies in a field; raise ModelError for an unknown field or fault."""
    rng = np.random.default_rng(seed)
    pose = in_pitch(bodies, rng)
    of = trust.world(field, bodies, rng, name)
    return start(trust.compile_estimator(tuning, name), of, pose, samples, rng, fault)


def in_pitch(bodies: int, rng: np.random.Generator, yaw: float = trust.YAW) -> Pose:
    """Draw poses anywhere in the pitch, less MARGIN, at yaws of up to `yaw` to either side, rad."""
    return trust.draw(config.array().pitch / 2 - MARGIN, bodies, rng, yaw)


def start(
    controller: host.Controller, of: World, pose: Pose, samples: int, rng: np.random.Generator, fault: str = "none"
) -> ColdStart:
    """Return the result of bodies at rest at poses, of any estimator; raise ModelError for an unknown fault."""
    exact, array, bodies = of.read(pose), config.array(), len(pose.X)
    faults.find(fault)
    failure = None if fault == "none" else trust.fail(fault, of, bodies, rng)
    states, first = np.repeat(controller.init()[None], bodies), np.zeros(bodies, int)
    wrong, counts = np.zeros(bodies, bool), np.zeros(2)
    for k in range(samples):
        V = exact + array.deviation * rng.standard_normal(exact.shape)
        if failure:
            failure.corrupt(V, k)
        batch = controller.batch(states, motions.by_input(np.clip(V, -faults.END, faults.END)))
        states, valid, errors = batch.states, batch.outputs["valid"] > 0, trust.errors(batch.outputs, pose)
        first = np.where(valid & (first == 0), k + 1, first)
        wrong |= valid & (np.hypot(errors[:, 0], errors[:, 1]) > array.pitch / 4)
        counts += valid.sum(), (valid & trust.is_wrong(errors)).sum()
    ever = first[first > 0]
    tracked = float((batch.outputs.get("tracking", batch.outputs["valid"]) > 0).mean())
    median, longest = (float(np.median(ever)), int(ever.max())) if ever.size else (np.inf, 0)
    misled = float(counts[1] / max(counts[0], 1))
    return ColdStart(tracked, float((first > 0).mean()), median, longest, int(wrong.sum()), misled)
