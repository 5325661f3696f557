"""Stimuli of the estimator as machine code: which steps are measured, replayed, and committed as test vectors.

motions          with noise, from `init`: across pitches at up to 2 m/s with a little yaw, through full turns, and
                 to yaws where no estimate is valid
lost, refused    voltages that jump to those of elsewhere; single voltages out of range and runs of them
shifted          samples of motions from states with phases and yaws of others: the end of every reach
random, anew     states and voltages drawn anywhere, and samples of motions with some states drawn anew
faults, edges    every input bad alone and all at once; every input on the last number accepted and on the next
at ends, rare    of these, those that come to the end of a range, and those whose flags few others have
vectors          from `init` at rest with three samples out of range, then across pitches with a yaw, to the latch
"""

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from designs.hall_position import config, random_steps
from models import hall_motions as motions
from models.hall_motions import Numbers, Pose
from synth.errors import DesignError
from synth.execute import host
from synth.verify import steps
from synth.verify.sampling import Columns
from synth.verify.steps import Steps

FLOOR = 1.0  # m, rad, V, below which a difference of outputs is absolute
REPLAY, LONG = 10_000, 6_000  # steps of the replay, and of each motion
SLOW = 0.2, 0.04, 0.0  # m, rad, rad/s: travel, yaw and turn of a motion
MOTIONS = {"motions": SLOW, "turns": (0.3, 0.5, 13.0), "yaws left": (0.2, 0.4, 0.0)}
EACH, DRAWN, RARE = 1500, 4000, 1500  # steps of each kind
EACH_END, NEAR = 40, 1e-5  # steps for an end of a range, and what is near it, of the range
PERTURBED = 10, 1e-3  # how often, and how much of the range at most
SEED = 1204
VECTORS, REST, VECTORS_SEED = 1000, 200, 2009  # samples of the test vectors, of them at rest
START, WAY = (0.011, 0.034, 0.03), (0.12, -0.09, -0.08)  # X, Y, yaw in m and rad: over two pitches in 1 s
OUT, BAD, LOST = 9.0, slice(150, 153), slice(900, 910)  # V; of V_ay and of V_bx


def replay(controller: host.Controller) -> Columns:
    """Return the controller's inputs (10,000,) on a motion with refused voltages, jumps, and the latch."""
    V, k = _measured(_name(controller), REPLAY, SLOW, SEED), np.arange(REPLAY)
    V[k % 250 == 1, 0, 1] = np.nan
    V[(k > 4100) & (k < 4105), 1, 0] = np.inf
    V[(k > 6100) & (k < 6120)] *= -1
    V[(k > 7100) & (k < 7104), 1, 1] = -6.0
    V[k > 9500, 0, 0] = 9.0
    return motions.named(V)


def recording(name: str, scalar: type[np.floating]) -> dict[str, Numbers]:
    """Return the inputs (N,) of an estimator's test vectors, V."""
    V = motions.noisy(config.array(name), way(), VECTORS_SEED)
    V[BAD, 0, 1] = OUT
    V[LOST, 1, 0] = OUT
    return motions.named(V.astype(scalar))


def of_three(inputs: Mapping[str, Any], outputs: Mapping[str, Any]) -> dict[str, Numbers]:
    """Return those of three sensors beside `inputs` of two, in their scalar type."""
    return recording(config.THREE, inputs["V_ax"].dtype.type)


def way() -> Pose:
    """Return the poses (N,) of the test vectors: at rest, then there without a jerk."""
    part = np.clip((np.arange(VECTORS) - REST) / (VECTORS - REST), 0, 1)
    along = part - np.sin(2 * np.pi * part) / (2 * np.pi)
    return Pose(*(start + by * along for start, by in zip(START, WAY, strict=True)))


def sequences(controller: host.Controller, progress: Callable[[str], None]) -> list[Steps]:
    """Return every sequence, those of motions first."""
    progress("sequences")
    name = _name(controller)
    volts = {kind: _measured(name, LONG, size, SEED + k) for k, (kind, size) in enumerate(MOTIONS.items(), 1)}
    loops = [steps.recorded(controller, kind, motions.named(V), closed_loop=True) for kind, V in volts.items()]
    lost = steps.recorded(controller, "lost", motions.named(_lost(volts["turns"], volts["motions"])))
    recorded = [*loops, lost, steps.recorded(controller, "refused", replay(controller))]
    pool = steps.joined("all of these", recorded)
    wrong = [_shifted(controller, pool), _random(controller, name), steps.anew(controller, pool, "states anew")]
    near = steps.at_ends(controller, steps.joined("wrong", wrong), EACH_END, NEAR)
    perturbed = steps.shaken(controller, near, "shaken", *PERTURBED)
    return [
        *(steps.thinned(each, EACH) for each in recorded),
        *(steps.thinned(each, DRAWN) for each in wrong),
        steps.faulty(controller, {name: float(v[0]) for name, v in motions.named(volts["motions"]).items()}),
        steps.edges(controller, loops[0]),
        steps.drawn(controller, DRAWN),
        *(steps.rare(controller, each, RARE) for each in (pool, *wrong)),
        steps.thinned(steps.at_ends(controller, perturbed, EACH_END), EACH),
    ]


def _name(controller: host.Controller) -> str:
    name = str(controller.manifest["design"])
    if name not in config.PLACES:
        raise DesignError(f"'{name}' is none of {', '.join(config.PLACES)}: measure one of these")
    return name


def _measured(name: str, n: int, size: tuple[float, float, float], seed: int) -> Numbers:
    """Return voltages (n, sensors, 2) on a motion of one body."""
    pose = motions.wander(config.TIME.period_s, (n, 1), seed, *size)
    return motions.noisy(config.array(name), pose, seed)[:, 0]


def _lost(V: Numbers, other: Numbers) -> Numbers:
    """Return voltages that are for some time those of another motion, or of none."""
    k = np.arange(len(V))[:, np.newaxis, np.newaxis]
    jumping = np.where(k % 400 > 300, other, V)
    return np.where((k % 900 > 600) & (k % 900 < 640), -jumping, jumping)


def _shifted(controller: host.Controller, pool: Steps) -> Steps:
    """Return steps of motions, each from a state that is off in phases, yaw and motions, by any order of magnitude."""
    rng, states = np.random.default_rng(SEED), pool.states.copy()
    size = 10.0 ** rng.uniform(-5, 0.5, len(pool))
    for f in controller.manifest["structs"]["state"]["fields"]:
        if f["ctype"] == "float" and not f["name"].startswith(("guard", "estimator_pitch")):
            moved = states[f["name"]] + size * rng.uniform(-1, 1, len(pool))
            states[f["name"]] = np.clip(moved, f["low"], f["high"])
    return Steps("shifted", states, pool.inputs)


def _random(controller: host.Controller, name: str) -> Steps:
    """Return random steps as verification draws them."""
    states, inputs = random_steps.in_operation(random_steps.subject(name), DRAWN)
    records = host.records(controller.manifest, controller.state, states, DRAWN)
    return Steps("random", records, controller.records(inputs, DRAWN))
