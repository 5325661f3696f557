"""Cold start of the estimator as its header asks for it: bodies move on a circle from `init` on, or rest.

Two sensors determine X, Y and yaw, and tell the pose from all others with the same voltages, at a part of the places in
the pitch only. A circle passes such places in every direction. The voltages are those of the estimator's own model,
with its noise. No start may be valid at a wrong place, a whole pitch off in particular.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from designs.hall_position import config
from models import hall_motions as motions
from models.hall_motions import Pose
from synth.check import Check
from synth.declare.experiments import Run
from synth.simulate import sampling
from synth.simulate.experiments import Experiment
from synth.simulate.rig import Rig
from synth.simulate.scenario import Trajectory, sample_times

STARTS, SEED = 4000, 4
WRONG = 2e-4  # m: twenty standard deviations of a valid position where it is least accurate
SHOWN = ("X", "Y", "valid")
Array = NDArray[Any]


def cold_start(rig: Rig, name: str) -> Experiment:
    """Run the starts on the circle and at rest; shown is the start that takes longest to be valid."""
    of, period = config.COLD_START, rig.period_s
    time = sample_times(of.longest_s, period)
    rng = np.random.default_rng(SEED)
    speed = rng.uniform(of.slowest, of.fastest, STARTS)
    first, wrong, columns = _run(rig, len(time), speed, rng)
    revolution = 2 * np.pi * of.radius / speed
    valid = (first > 0) & (first * period <= revolution)
    at_rest, wrong_at_rest, _ = _run(rig, len(time), np.zeros(STARTS), rng)
    slowest = int(np.where(valid, first, 0).argmax())
    inputs, outputs = ({n: v[:, slowest] for n, v in each.items()} for each in columns)
    none = np.zeros(len(time), np.uint32)
    trajectory = Trajectory(time, {}, {}, {}, inputs, outputs, none, {}, {"X": "m", "Y": "m", "valid": "1"})
    checks = (
        Check(
            "starts on the circle that are valid within a revolution", float(valid.mean()), of.valid, "1", at_least=True
        ),
        Check("starts at rest that are ever valid", float((at_rest > 0).mean()), of.at_rest, "1"),
        Check("starts that are valid at a wrong place", float(wrong + wrong_at_rest), 0.0, "1"),
    )
    figures = {
        "median time to the first valid sample on the circle, s": period * float(np.median(first[valid])),
        "largest, s": period * float(first[valid].max()),
    }
    about = f"{STARTS} starts anywhere within half a pitch, {1e3 * of.slowest:g} to {1e3 * of.fastest:g} mm/s"
    title = f"Cold start on a circle with a radius of {1e3 * of.radius:g} mm"
    return Experiment(name, title, about, trajectory, SHOWN, {}, figures, checks)


def _run(
    rig: Rig, samples: int, speed: Array, rng: np.random.Generator
) -> tuple[Array, int, tuple[dict[str, Array], dict[str, Array]]]:
    """Return the first valid sample (N,) from 1 on or 0, how many starts are wrong, and inputs and outputs (k, N)."""
    of, array, n = config.COLD_START, config.array(), len(speed)
    half, yaw = array.pitch / 2 - of.radius, np.radians(of.yaw)
    (X, Y), turn = rng.uniform(-half, half, (2, n)), rng.uniform(-yaw, yaw, n)
    begin, rate = rng.uniform(0, 2 * np.pi, n), rng.choice([-1, 1], n) * speed / of.radius
    states = sampling.initial_states(rig.controller, n)
    first, wrong, kept = np.zeros(n, int), np.zeros(n, bool), []
    for k in range(samples):
        angle = begin + rate * k * rig.period_s
        pose = Pose(X + of.radius * np.cos(angle), Y + of.radius * np.sin(angle), turn)
        inputs = motions.by_input(motions.noisy(array, pose, rng))
        batch = rig.controller.batch(states, inputs)
        states, valid = batch.states, batch.outputs["valid"] > 0
        first = np.where(valid & (first == 0), k + 1, first)
        wrong |= valid & (np.hypot(batch.outputs["X"] - pose.X, batch.outputs["Y"] - pose.Y) > WRONG)
        kept.append((inputs, {name: batch.outputs[name] for name in SHOWN}))
    before, after = zip(*kept, strict=True)
    stacked = ({name: np.array([each[name] for each in of_all]) for name in of_all[0]} for of_all in (before, after))
    return first, int(wrong.sum()), (next(stacked), next(stacked))


ALL = (Run("cold_start", cold_start),)
