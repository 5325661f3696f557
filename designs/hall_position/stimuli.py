"""Stimuli of the estimator's machine code: steps to measure, to replay, and to commit as test vectors.

motions             with noise, from `init`: across pitches at up to 2 m/s with small yaws, through full turns, and to
                    yaws where no estimate is valid
lost, refused       voltages that jump to those of another motion; single voltages out of range, and runs of them
shifted             samples of motions, from states with shifted phases, yaws and motions: the ends of every bound
random, resampled   random states and voltages, and samples of motions with some states resampled
faults, edges       every input bad alone and all at once; every input at the last accepted number and the next one
at ends, rare       of these, the steps near the ends of ranges, and those with rare combinations of flags
vectors             from `init` at rest with three samples out of range, then across pitches with a yaw, to the latch
"""

from collections.abc import Callable

import numpy as np

from designs.hall_position import config, random_steps
from models import hall_motions as motions
from models.hall_motions import Numbers, Pose
from synth.execute import host
from synth.verify import steps
from synth.verify.sampling import Columns
from synth.verify.standard import Stimuli
from synth.verify.steps import Steps

FLOOR = 1.0  # m, rad, V: differences of smaller outputs are absolute
REPLAY_STEPS, MOTION_STEPS = 10_000, 6_000  # steps of the replay, and of each motion
SLOW_MOTION = 0.2, 0.04, 0.0  # m, rad, rad/s: travel, yaw and turn of a motion
MOTIONS = {"motions": SLOW_MOTION, "turns": (0.3, 0.5, 13.0), "yaws left": (0.2, 0.4, 0.0)}
MOTION_STEPS_KEPT, RANDOM_STEPS, RAREST_STEPS = 1500, 4000, 1500  # of each kind
STEPS_PER_RANGE_END, RANGE_END_DISTANCE = 40, 1e-5  # the distance is relative to the range
PERTURBED = 10, 1e-3  # repetitions, and largest change relative to the range
SEED = 1204
VECTORS, AT_REST, VECTORS_SEED = 1000, 200, 2009  # samples of the test vectors, and those of them at rest
START, DISPLACEMENT = (0.011, 0.034, 0.03), (0.12, -0.09, -0.08)  # X, Y, yaw in m and rad: more than two pitches in 1 s
OUT_OF_RANGE, SHORT_FAULT, LONG_FAULT = 9.0, slice(150, 153), slice(900, 910)  # V; of V_ay and of V_bx


def of_stage() -> Stimuli:
    """Return what drives the measurements of the machine code and gives the test vectors."""
    return Stimuli(
        vectors=lambda rig: recording(rig.controller.scalar), replay=replay, sequences=sequences, floor=FLOOR
    )


def replay(controller: host.Controller) -> Columns:
    """Return the controller's inputs (10,000,) on a motion with refused voltages, jumps, and the latch."""
    V, k = _measure(REPLAY_STEPS, SLOW_MOTION, SEED), np.arange(REPLAY_STEPS)
    V[k % 250 == 1, 0, 1] = np.nan
    V[(k > 4100) & (k < 4105), 1, 0] = np.inf
    V[(k > 6100) & (k < 6120)] *= -1
    V[(k > 7100) & (k < 7104), 1, 1] = -6.0
    V[k > 9500, 0, 0] = 9.0
    return motions.by_input(V)


def recording(scalar: type[np.floating]) -> dict[str, Numbers]:
    """Return the inputs (N,) of the test vectors, V."""
    V = motions.noisy(config.array(), path(), VECTORS_SEED)
    V[SHORT_FAULT, 0, 1] = OUT_OF_RANGE
    V[LONG_FAULT, 1, 0] = OUT_OF_RANGE
    return motions.by_input(V.astype(scalar))


def path() -> Pose:
    """Return the poses (N,) of the test vectors."""
    return motions.rest_then_move(VECTORS, AT_REST, START, DISPLACEMENT)


def sequences(controller: host.Controller, progress: Callable[[str], None]) -> list[Steps]:
    """Return every sequence, those of motions first."""
    progress("sequences")
    volts = {kind: _measure(MOTION_STEPS, size, SEED + k) for k, (kind, size) in enumerate(MOTIONS.items(), 1)}
    loops = [steps.record(controller, kind, motions.by_input(V), closed_loop=True) for kind, V in volts.items()]
    lost = steps.record(controller, "lost", motions.by_input(_misplaced_voltages(volts["turns"], volts["motions"])))
    recorded = [*loops, lost, steps.record(controller, "refused", replay(controller))]
    pool = steps.concatenate("all of these", recorded)
    wrong = [
        _shifted_states(controller, pool),
        _random_steps(controller),
        steps.resampled(controller, pool, "states resampled"),
    ]
    near = steps.at_range_ends(controller, steps.concatenate("wrong", wrong), STEPS_PER_RANGE_END, RANGE_END_DISTANCE)
    perturbed = steps.perturbed(controller, near, "perturbed", *PERTURBED)
    return [
        *(steps.thinned(each, MOTION_STEPS_KEPT) for each in recorded),
        *(steps.thinned(each, RANDOM_STEPS) for each in wrong),
        steps.fault_steps(controller, {name: float(v[0]) for name, v in motions.by_input(volts["motions"]).items()}),
        steps.edge_steps(controller, loops[0]),
        steps.random_steps(controller, RANDOM_STEPS),
        *(steps.rarest(controller, each, RAREST_STEPS) for each in (pool, *wrong)),
        steps.thinned(steps.at_range_ends(controller, perturbed, STEPS_PER_RANGE_END), MOTION_STEPS_KEPT),
    ]


def _measure(n: int, size: tuple[float, float, float], seed: int) -> Numbers:
    """Return voltages (n, sensors, 2) on a motion of one body."""
    pose = motions.smooth_motions(config.TIME.period_s, (n, 1), seed, *size)
    return motions.noisy(config.array(), pose, seed)[:, 0]


def _misplaced_voltages(V: Numbers, other: Numbers) -> Numbers:
    """Return voltages that for some time are those of another motion, or of no pose at all."""
    k = np.arange(len(V))[:, np.newaxis, np.newaxis]
    jumping = np.where(k % 400 > 300, other, V)
    return np.where((k % 900 > 600) & (k % 900 < 640), -jumping, jumping)


def _shifted_states(controller: host.Controller, pool: Steps) -> Steps:
    """Return steps of motions, each from a state with phases, yaw and motions shifted by 1e-5 to 3."""
    rng, states = np.random.default_rng(SEED), pool.states.copy()
    size = 10.0 ** rng.uniform(-5, 0.5, len(pool))
    for f in controller.manifest["structs"]["state"]["fields"]:
        if f["ctype"] == "float" and not f["name"].startswith(("guard", "estimator_pitch")):
            shifted = states[f["name"]] + size * rng.uniform(-1, 1, len(pool))
            states[f["name"]] = np.clip(shifted, f["low"], f["high"])
    return Steps("shifted", states, pool.inputs)


def _random_steps(controller: host.Controller) -> Steps:
    """Return the random steps of verification."""
    states, inputs = random_steps.operating_steps(random_steps.subject(), RANDOM_STEPS)
    records = host.records(controller.manifest, controller.state, states, RANDOM_STEPS)
    return Steps("random", records, controller.records(inputs, RANDOM_STEPS))
