"""Standard verification of a declared stage: all witnesses over random steps and over closed loops.

    random    steps of the closed loops of the stage, perturbed by various orders of magnitude within their ranges
    edge      states uniform in their bounds, inputs at the ends of their ranges, beyond, or NaN
    replay    recorded inputs of closed loops from `init`, with bad samples up to the latch

Single precision is compared with double in two ways: from the same bits in steps where both take the same decisions,
and by the true path of the plant in closed loops with ideal sensors.
"""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from synth import arguments
from synth.analyse.loops import robustness, tolerances
from synth.check import Check
from synth.declare.stage import Reference, Stage
from synth.errors import DesignError
from synth.simulate import rig as rigs
from synth.simulate.experiment import Experiment
from synth.simulate.rig import Rig
from synth.simulate.scenario import Trajectory
from synth.statespace import StateSpace
from synth.verify import agree, companions, drive, sampling, steps, stimuli, suite
from synth.verify.agree import Agreement
from synth.verify.evidence import Evidence
from synth.verify.suite import Witnesses

RANDOM_STEPS, EDGE_STEPS = 100_000, 20_000
WHOLE, QUICK = 5_000, 1_000  # samples of a closed loop that the other witnesses replay
SEED = 20_260
UNIT = "of the output's range or more"
SINGLE = 1e-3  # of an output's range: single against double in one step
DIVERGENT_SHARE = 1e-3  # fraction of random steps whose decisions differ in single precision
DISK = "disk_margin"
LOST = "loops that are not stable or have no equilibrium"
PATH = 1e-4  # of the range of a sensor without resolution: path of the plant in single against double


def require_reference(stage: Stage) -> Reference:
    """Return the reference of a stage; raise DesignError for a stage without one, or with one that is no function."""
    if stage.reference is None:
        raise DesignError(
            f"design '{stage.name}' has no reference: give `reference`, a NumPy step (states, inputs) -> (states', "
            "outputs, fault words) written from the equations"
        )
    if not callable(stage.reference):
        raise DesignError(
            f"the reference of design '{stage.name}' is {arguments.describe(stage.reference)}: give its step function, "
            "(states, inputs) -> (states', outputs, fault words)"
        )
    return stage.reference


def witnesses(stage: Stage) -> Witnesses:
    """Return the witnesses of the controller of a stage; raise DesignError for a stage without a reference."""
    reference = require_reference(stage)
    return suite.witnesses(stage.controller.block, reference, stage.surrogate_error)


def verify(stage: Stage, progress: Callable[[str], None], whole: bool) -> Evidence:
    """Compare all witnesses of a stage, over long replays if `whole`.

    Raises DesignError for a stage without a reference.
    """
    progress("witnesses")
    witness_set = witnesses(stage)
    rig = rigs.of_stage(stage, witness_set.c64)
    samples = WHOLE if whole else QUICK
    trajectories = _runs(rig, samples)
    runs = {name: _first_samples(dict(run.measured), samples) for name, run in trajectories.items()}
    progress("random and edge steps")
    agreements, checks = compare_samples(witness_set, runs)
    progress("replays of closed loops")
    compared = suite.replay(witness_set, {f"replay of {name}": inputs for name, inputs in runs.items()}, None)
    agreements, checks = [*agreements, *compared], [*checks, *suite.exact_checks(compared, UNIT)]
    beside, beside_checks = compare_companions(stage, trajectories, samples)
    agreements, checks = [*agreements, *beside], [*checks, *beside_checks]
    progress("single against double")
    checks += [*compare_paths(stage, witness_set), *drive.checks(rig, trajectories.values())]
    return Evidence(stage.name, tuple(agreements), tuple(checks))


@dataclass(frozen=True, eq=False)
class LoopsAt:
    """The loops of a stage at a place, of a stage that opens them itself: `open` returns L (p, p) opened at p signals.

    The loops are opened at each of the `signals`, and for the disk margin at all of `at_once`.
    """

    place: str
    signals: Sequence[str]
    at_once: Sequence[str]
    open: Callable[[Sequence[str]], StateSpace]


def loops(stage: Stage) -> robustness.Loops:
    """Return the loops of a stage at its operating points, with constants rounded as in the emitted C."""
    return robustness.of_controller(
        stage.controller,
        stage.plant,
        stage.operating_points,
        scalar=stage.scalar,
        actuators=stage.wires or None,
        coordinates=stage.coordinates,
    )


def over_tolerances(stage: Stage) -> robustness.Loops:
    """Return the loops of a stage for the nominal plant and for the corners of the declared tolerances."""
    return replace(loops(stage), cases=(robustness.NOMINAL, *tolerances.corners(stage.plant, stage.tolerances)))


def least_margins(stage: Stage, survey: robustness.Survey, names: Iterable[str]) -> dict[str, float]:
    """Return the least of each margin over the loops of a survey, 0 without an equilibrium.

    The disk margin is that of the nominal plant at the operating points, its certified lower bound.
    """
    stable = not survey.unsolved and all(loop.margins.stable for loop in survey.loops)
    margins = {n: min((loop.margin(n) for loop in survey.loops), default=0.0) for n in names if n != DISK}
    if DISK in names:
        nominal = loops(stage)
        disks = [robustness.disk_margins(nominal, point)["both"].lower for point in nominal.points] if stable else [0.0]
        margins[DISK] = min(disks)
    return margins if not survey.unsolved else dict.fromkeys(margins, 0.0)


def compare_companions(
    stage: Stage, runs: Mapping[str, Trajectory], samples: int
) -> tuple[list[Agreement], list[Check]]:
    """Compare the witnesses of the companions that have a reference, over some samples of each run and random steps."""
    agreements: list[Agreement] = []
    checks: list[Check] = []
    for k, companion in enumerate(c for c in stage.companions if c.reference):
        columns = {name: companion.select_inputs(run.measured, run.commands) for name, run in runs.items()}
        recorded = {f"replay of {name}": _first_samples(each, samples) for name, each in columns.items()}
        rng, sizes = np.random.default_rng(SEED + 2 + k), (RANDOM_STEPS, EDGE_STEPS)
        compared, single = companions.compare(companion, companion.block.name, stage, recorded, rng, sizes)
        unit = UNIT if companion.floor is None else f"max({companion.floor:g}, |output|)"
        agreements, checks = [*agreements, *compared, single], [*checks, *suite.exact_checks(compared, unit)]
    return agreements, checks


def _runs(rig: Rig, n: int) -> dict[str, Trajectory]:
    """Return each experiment, and n samples of a closed loop with faults."""
    runs = {e.name: e.trajectory for e in (e.run(rig) for e in rig.stage.experiments)}
    return runs | {"faults": stimuli.closed_loop(rig, n)}


def _first_samples(columns: agree.Columns, n: int) -> agree.Columns:
    """Return at most n samples."""
    return {name: values[:n] for name, values in columns.items()}


def compare_samples(witness_set: Witnesses, runs: Mapping[str, agree.Columns]) -> tuple[list[Agreement], list[Check]]:
    """Compare the witnesses over random and edge steps, and single with double over the random ones."""
    pool = steps.concatenate(
        "closed loops", [steps.record(witness_set.c64, name, inputs) for name, inputs in runs.items()]
    )
    random = sampling.operating_steps(witness_set.block, np.random.default_rng(SEED), RANDOM_STEPS, pool)
    edge = sampling.edge_steps(witness_set.block, np.random.default_rng(SEED + 1), EDGE_STEPS)
    agreements: list[Agreement] = []
    for what, stimulus in (("random steps", random), ("edge steps", edge)):
        agreements += suite.compare(what, witness_set, *stimulus, None)
    single, checks = compare_precisions(witness_set, *random)
    return [*agreements, single], [*suite.exact_checks(agreements, UNIT), *checks]


def compare_precisions(
    witness_set: Witnesses,
    states: sampling.Columns,
    inputs: sampling.Columns,
    floor: agree.Floor = None,
    counts: Mapping[str, float] | None = None,
) -> tuple[Agreement, list[Check]]:
    """Compare single with double precision from the same bits, in steps where both take the same decisions.

    `counts` are real states that jump with a decision, each with its least jump; a smaller difference counts as equal.
    """
    double, single = suite.in_both_precisions(witness_set, states, inputs)
    alike = suite.same_decisions(witness_set.block, double, single)
    for name, jump in (counts or {}).items():
        alike &= np.abs(double.states[name] - single.states[name].astype(np.float64)) < jump
    pair = ("c64", suite.select(double, alike)), ("c32", suite.select(single, alike))
    a = agree.compare("random steps", *pair, floor, witness_set.block, np.float32)
    share, unit = float(np.mean(~alike)), UNIT if floor is None else "of the output's floor or more"
    return a, [
        Check("random steps: single against double", a.worst, SINGLE, unit, a.signal),
        Check("random steps: decisions that differ in single precision", share, DIVERGENT_SHARE, "1"),
    ]


def compare_paths(stage: Stage, witness_set: Witnesses) -> list[Check]:
    """Compare the path of the plant under both scalar types in each experiment, with ideal sensors."""
    precisions = [rigs.of_stage(stage, c).ideal for c in (witness_set.c64, witness_set.c32)]
    return [
        check
        for experiment in stage.experiments
        for check in _path_checks(stage, experiment.name, [experiment.run(rig) for rig in precisions])
    ]


def _path_checks(stage: Stage, name: str, runs: Sequence[Experiment]) -> list[Check]:
    checks = []
    for sensor in stage.interface.sensors:
        signal = stage.interface.signals[sensor.name]
        one, two = (run.trajectory.outputs[sensor.of] for run in runs)
        limit = sensor.resolution or PATH * (signal.high - signal.low)
        worst = float(np.max(np.abs(one - two)))
        checks.append(Check(f"{name}: single less double, {sensor.name}", worst, limit, signal.unit, "ideal sensors"))
    return checks
