"""Standard verification of a declared stage: all witnesses over random steps and over closed loops.

    random    steps of the closed loops of the stage, perturbed by various orders of magnitude within their ranges
    edge      states uniform in their bounds, inputs at the ends of their ranges, beyond, or NaN
    replay    recorded inputs of closed loops from `init`, with bad samples up to the latch

Single precision is compared with double in two ways: from the same bits in steps where both take the same decisions,
and by the true path of the plant in closed loops with ideal sensors.

The drive of a stage and the plant that it drives, against the stage's plant for which the law and its margins hold.

    controller outputs v --> wires --> plant            f(x, u, p)
    controller outputs v --> drive --> driven plant     f'(x, u', p)

At rest both must accelerate alike: margins see the first path alone, simulations the second. Positions and commands are
those of the experiments, without a fault. The difference is relative to what the commands change, max |f(x, u) -
f(x, 0)| of each state's rate. A wrong current constant, a peak value for an effective one, or a commutation with a
wrong angle shows in it.

Verification of the Blocks beside a controller that have a reference: all witnesses, and single against double.

random, edge    states uniform in their bounds, inputs in their ranges, at their ends, beyond, or NaN
replay          what a companion reads in recorded closed loops, from `init`
"""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from synth.analyse.loops import robustness
from synth.block import Block
from synth.check import Check
from synth.declare.companion import Companion
from synth.declare.stage import Stage
from synth.errors import DesignError
from synth.execute import host
from synth.plant import Plant
from synth.simulate import experiments
from synth.simulate import rig as rigs
from synth.simulate.experiments import Experiment
from synth.simulate.rig import Rig, Wires
from synth.simulate.scenario import Trajectory
from synth.stage import tunable
from synth.statespace import Array
from synth.verify import agree, sampling, steps, stimuli, suite
from synth.verify.agree import Agreement
from synth.verify.steps import Steps
from synth.verify.suite import Evidence, Witnesses

LIMIT = 0.05  # of what the commands change: the details that only the driven plant has stay below
LEAST_CHANGE = 1e-6  # of a rate: commands that change it less do not act on it
SAMPLES = 40  # of each run


def compare(
    companion: Companion,
    label: str,
    stage: Stage,
    recorded: Mapping[str, agree.Columns],
    rng: np.random.Generator,
    steps: tuple[int, int],
) -> tuple[list[Agreement], Agreement]:
    """Compare all witnesses of a companion, and single with double precision over the random steps.

    `steps` are the numbers of random and of edge steps; `recorded` are its inputs in closed loops of the `stage`.
    """
    assert companion.reference is not None
    by, floor = suite.witnesses(companion.block, companion.reference, stage.surrogate_error), companion.floor
    random = sampling.anywhere(companion.block, rng, steps[0])
    edge = sampling.edge_steps(companion.block, rng, steps[1])
    compared = suite.compare(f"{label}, random steps", by, *random, floor)
    compared += suite.compare(f"{label}, edge steps", by, *edge, floor)
    labelled = {f"{label}, {what}": inputs for what, inputs in recorded.items()}
    double, single = suite.in_both_precisions(by, *random)
    pair = ("c64", double), ("c32", single)
    in_single = agree.compare(f"{label}, random steps", *pair, floor, companion.block, np.float32)
    return [*compared, *suite.replay(by, labelled, floor)], in_single


def drive_checks(rig: Rig, runs: Iterable[Trajectory]) -> list[Check]:
    """Return the check of a rig with a drive, for positions and commands of some runs."""
    rates = np.array([_rates(rig, *sample) for run in runs for sample in _samples(rig, run)] if rig.drive else [])
    if not rates.size:
        return []
    driven, direct, unforced = np.moveaxis(rates, 1, 0)
    change, difference = np.abs(direct - unforced).max(axis=0), np.abs(driven - direct).max(axis=0)
    size = np.maximum(change, LEAST_CHANGE * np.abs(direct).max(axis=0))
    shares = np.where(difference > 0, difference / np.where(size > 0, size, np.finfo(float).tiny), 0.0)
    worst = int(shares.argmax())
    about = f"of what the commands change, rate of {rig.plant.states[worst].name}"
    name = "rates at rest through the drive differ from the plant's by"
    return [Check(name, float(shares[worst]), LIMIT, "1", about)]


def _samples(rig: Rig, run: Trajectory) -> Iterator[tuple[dict[str, float], dict[str, float]]]:
    """Yield positions and commands of samples of a run without a fault."""
    moving, sound = set(rig.stage.velocities.values()), np.flatnonzero(run.faults == 0)
    for k in sound[np.linspace(0, len(sound) - 1, min(SAMPLES, len(sound))).astype(int)]:
        start = {s.name: float(run[s.name][k]) for s in rig.plant.states if s.name not in moving}
        yield start, {name: float(values[k]) for name, values in run.commands.items()}


def _rates(rig: Rig, start: Mapping[str, float], commands: Mapping[str, float]) -> list[Array]:
    """Return dx/dt of the driven plant, of the stage's plant, and of the latter without commands."""
    through, direct = rig.drive_commands(start, commands), rig.without_drive.connections
    plant, unforced = rig.stage.plant, dict.fromkeys(commands, 0.0)
    return [
        _rate(rig.plant, start, through, rig.connections),
        *(_rate(plant, start, some, direct) for some in (commands, unforced)),
    ]


def _rate(plant: Plant, start: Mapping[str, float], commands: Mapping[str, float], connections: Wires) -> Array:
    """Return dx/dt (n,) of a plant whose inputs are weighted sums of the commands."""
    wires = {name: {wire: 1.0} if isinstance(wire, str) else wire for name, wire in connections.items()}
    values = {name: sum(weight * commands[n] for n, weight in wire.items()) for name, wire in wires.items()}
    x, u = ([known.get(s.name, 0.0) for s in group] for known, group in ((start, plant.states), (values, plant.inputs)))
    return np.asarray(plant.f(x, u, plant.values), dtype=np.float64).ravel()


RANDOM_STEPS, EDGE_STEPS = 100_000, 20_000
WHOLE, QUICK = 5_000, 1_000  # samples of a closed loop that the other witnesses replay
SEED = 20_260
UNIT = "of the output's range or more"
SINGLE = 1e-3  # of an output's range: single against double in one step
DIVERGENT_SHARE = 1e-3  # fraction of random steps whose decisions differ in single precision
LOST = "loops that are not stable or have no equilibrium"
PATH = 1e-4  # of the range of a sensor without resolution: path of the plant in single against double


def witnesses(stage: Stage) -> Witnesses:
    """Return the witnesses of the controller of a stage; raise DesignError for a stage without a reference."""
    if stage.reference is None:
        raise DesignError(
            f"design '{stage.name}' has no reference: give `reference`, a NumPy step (states, inputs) -> (states', "
            "outputs, fault words) written from the equations"
        )
    return suite.witnesses(tunable.with_bench(stage), stage.reference, stage.surrogate_error)


@dataclass(frozen=True, eq=False)
class Stimuli:
    """What drives the verification of a stage beyond the standard; all of it may be left out.

    seed           of the random and edge steps
    random         n random steps (states, inputs) of a Block, (n,) by name, in place of perturbed steps of closed loops
    random_checks  of their states and results: that few are at limits, and such
    edge           n steps at the ends of ranges, in place of `sampling.edge_steps`
    runs           {name: Trajectory} of a rig, over long replays if `whole`, in place of the experiments and of faults
    path_checks    of the rigs in double and in single precision, in place of `compare_paths`
    vectors        inputs (N,) of vectors.json from a rig, in place of the standard closed loop with faults
    further        further steps for the cost of the compiled C
    replay         recorded inputs (N,) for a C that closes no loop, and `sequences` all steps for its cost
    floor          a difference of outputs is relative to max(floor, |y|), of edge steps to `edge_floor`, else to ranges
    unit           of the outputs, in the texts of the checks
    counts         real states that jump with a decision, each with its least jump: with a larger difference than that,
                   single precision has decided otherwise
    authority      magnitudes of states: their difference is relative to max(authority, |x|), too, where bounds are wide
    """

    seed: int = SEED
    random: Callable[[Block, int], tuple[sampling.Columns, sampling.Columns]] | None = None
    edge: Callable[[Block, int], tuple[sampling.Columns, sampling.Columns]] | None = None
    random_checks: Callable[[sampling.Columns, agree.StepResults], Sequence[Check]] = lambda states, results: ()
    runs: Callable[[Rig, bool], Mapping[str, Trajectory]] | None = None
    path_checks: Callable[[Rig, Rig], Sequence[Check]] | None = None
    vectors: Callable[[Rig], Mapping[str, Any]] | None = None
    further: Callable[[host.Controller], Sequence[Steps]] = lambda controller: ()
    replay: Callable[[host.Controller], Mapping[str, Any]] | None = None
    sequences: Callable[[host.Controller, Callable[[str], None]], Sequence[Steps]] | None = None
    floor: float | None = None
    edge_floor: float | None = None
    unit: str = ""
    counts: Mapping[str, float] = field(default_factory=dict)
    authority: Mapping[str, float] = field(default_factory=dict)

    def unit_of(self, floor: float | None) -> str:
        """Return the unit of differences of outputs relative to a floor."""
        return UNIT if floor is None else f"max({floor:.3g} {self.unit}, |y|)"


def stimuli_of(stage: Stage) -> Stimuli:
    """Return what a stage declares, or the standard."""
    return stage.stimuli() if stage.stimuli else Stimuli()


def verify(stage: Stage, progress: Callable[[str], None], whole: bool) -> Evidence:
    """Compare all witnesses of a stage, over long replays if `whole`."""
    progress("witnesses")
    by, hooks = witnesses(stage), stimuli_of(stage)
    rig = rigs.of_stage(stage, by.c64)
    if hooks.runs:  # they are replayed whole, under their names
        runs, samples, label = hooks.runs(rig, whole), None, ""
    else:
        samples, label = WHOLE if whole else QUICK, "replay of "
        runs = _runs(rig, samples)
    recorded = {name: _first_samples(dict(run.measured), samples) for name, run in runs.items()}
    progress("random and edge steps")
    agreements, checks = compare_samples(stage, by, recorded)
    progress("replays of closed loops")
    replayed = {f"{label}{name}": inputs for name, inputs in recorded.items()}
    compared = suite.replay(by, replayed, hooks.floor, hooks.authority)
    agreements, checks = [*agreements, *compared], [*checks, *suite.exact_checks(compared, hooks.unit_of(hooks.floor))]
    beside, beside_checks = compare_companions(stage, runs, samples, label)
    agreements, checks = [*agreements, *beside], [*checks, *beside_checks]
    progress("single against double")
    checks += hooks.path_checks(rig, rigs.of_stage(stage, by.c32)) if hooks.path_checks else compare_paths(stage, by)
    checks += drive_checks(rig, runs.values())
    return Evidence(stage.name, tuple(agreements), tuple(checks))


def over_tolerances(stage: Stage) -> robustness.Loops:
    """Return the loops of a stage for the nominal plant and for `varied_cases`."""
    return replace(robustness.of_stage(stage), cases=(robustness.NOMINAL, *varied_cases(stage)))


def varied_cases(stage: Stage) -> list[robustness.Case]:
    """Return the corners of the tolerances, then each declared case, alone and at the corners of the others."""
    varied = robustness.corners(stage.plant, stage.tolerances)
    for case, values in stage.cases.items():
        others = [name for name in stage.tolerances if name not in values]
        corners = robustness.NOMINAL, *robustness.corners(stage.plant, others)
        varied += [robustness.Case({**values, **corner.values}, case) for corner in corners]
    return varied


def compare_companions(
    stage: Stage, runs: Mapping[str, Trajectory], samples: int | None, label: str
) -> tuple[list[Agreement], list[Check]]:
    """Compare the witnesses of the companions that have a reference, over some samples of each run and random steps."""
    hooks = stimuli_of(stage)
    agreements: list[Agreement] = []
    checks: list[Check] = []
    for k, companion in enumerate(c for c in stage.companions if c.reference):
        columns = {name: companion.select_inputs(run.measured, run.commands) for name, run in runs.items()}
        recorded = {f"{label}{name}": _first_samples(each, samples) for name, each in columns.items()}
        rng, sizes = np.random.default_rng(hooks.seed + 2 + k), (RANDOM_STEPS, EDGE_STEPS)
        name, unit = companion.label or companion.name, hooks.unit_of(companion.floor)
        compared, single = compare(companion, name, stage, recorded, rng, sizes)
        agreements, checks = [*agreements, *compared, single], [*checks, *suite.exact_checks(compared, unit)]
    return agreements, checks


def _runs(rig: Rig, n: int) -> dict[str, Trajectory]:
    """Return each experiment, and n samples of a closed loop with faults."""
    runs = {e.name: e.trajectory for e in (experiments.result(e, rig) for e in rig.stage.all_experiments)}
    return runs | {"faults": stimuli.closed_loop(rig, n)}


def _first_samples(columns: agree.Columns, n: int | None) -> agree.Columns:
    """Return at most n samples, all of them for None."""
    return {name: values[:n] for name, values in columns.items()}


def compare_samples(
    stage: Stage, by: Witnesses, runs: Mapping[str, agree.Columns]
) -> tuple[list[Agreement], list[Check]]:
    """Compare the witnesses over random and edge steps, and single with double over the random ones."""
    hooks, block = stimuli_of(stage), by.block
    if hooks.random:
        random = hooks.random(block, RANDOM_STEPS)
    else:
        pool = steps.concatenate("closed loops", [steps.record(by.c64, name, inputs) for name, inputs in runs.items()])
        random = sampling.operating_steps(block, np.random.default_rng(hooks.seed), RANDOM_STEPS, pool)
    edge = (
        hooks.edge(block, EDGE_STEPS)
        if hooks.edge
        else sampling.edge_steps(block, np.random.default_rng(hooks.seed + 1), EDGE_STEPS)
    )
    agreements, checks = list[Agreement](), [*hooks.random_checks(random[0], by.by_name["c64"](*random))]
    for what, sample, floor in (("random steps", random, hooks.floor), ("edge steps", edge, hooks.edge_floor)):
        compared = suite.compare(what, by, *sample, floor, hooks.authority)
        agreements, checks = [*agreements, *compared], [*checks, *suite.exact_checks(compared, hooks.unit_of(floor))]
    single, further = compare_precisions(by, *random, hooks.floor, hooks.counts)
    return [*agreements, single], [*checks, *further]


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
        for experiment in stage.all_experiments
        for check in _path_checks(stage, experiment.name, [experiments.result(experiment, rig) for rig in precisions])
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
