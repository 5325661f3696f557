"""The drive of a stage and the plant that it drives, against the stage's plant for which the law and its margins hold.

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

from collections.abc import Iterable, Iterator, Mapping

import numpy as np

from synth.check import Check
from synth.declare.companion import Companion
from synth.declare.stage import Stage
from synth.plant import Plant
from synth.simulate.rig import Rig, Wires
from synth.simulate.scenario import Trajectory
from synth.statespace import Array
from synth.verify import agree, sampling, suite
from synth.verify.agree import Agreement

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


def checks(rig: Rig, runs: Iterable[Trajectory]) -> list[Check]:
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
