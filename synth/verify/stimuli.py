"""Stimuli of a compiled controller, for cost measurement, replay on a target and committed test vectors.

    closed loops     each experiment, and swinging set-points with bad samples, up to the latch
    latches          loss of all measurements while outputs are at their limits, until every slew has ended
    faults, edges    every input bad, alone and all at once; every input at the last accepted number and at the next one
    random           inputs in range; random states and inputs; closed loops with some states resampled
    rare, at ends    of these steps, those with the least frequent flags, and those that reach the end of a range

All sequences except the closed loops need only the manifest of a controller.
"""

from collections.abc import Callable, Mapping, Sequence
from math import ceil
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from synth.declare.stage import Interface, SetPoint
from synth.execute import host
from synth.simulate.experiments import Experiment
from synth.simulate.rig import Rig
from synth.simulate.scenario import Override, Trajectory
from synth.verify import steps
from synth.verify.steps import Steps

REPLAY_STEPS, VECTOR_STEPS = 10_000, 1000  # steps of a replay, and of committed test vectors
LOOP_STEPS = 1000  # steps of each closed loop
SWING = 0.2  # of the range of a set-point, to both sides of rest
TURNS = 3.0  # periods of the first set-point in a recording; the others have more
JUMP = 20  # samples before the latch at which the set-points jump, to move the actuators away from their safe values
RANDOM_STEPS, POOL_STEPS, RAREST_STEPS = 2000, 20_000, 1000  # recorded; drawn, to choose from; of the rarest branches
STEPS_PER_RANGE_END = 40
LEADS = (3, 40, 333)  # samples of random inputs before the loss of measurement
LONGEST = 20_000  # samples of a slew
BAD_SAMPLE_EXCESS = 0.5  # of a range: distance of bad samples in test vectors beyond its end; JSON cannot hold NaN
SEED = 2026


def closed_loop(rig: Rig, n: int, beyond: float = np.nan) -> Trajectory:
    """Run n samples with set-points that swing about rest, and with bad sensor and set-point samples up to a latch.

    The first sensor has one bad sample less than the latch needs, the others have single bad samples, a set-point has
    ten. The last sensor fails for the last twentieth of the run, and all of them for the last fortieth: a controller
    that replaces readings does not latch before. A bad sample is beyond the end of its range by the
    fraction `beyond` of the range, or NaN.
    """
    interface = rig.stage.interface
    k, loss_start = np.arange(n), n - n // 20
    rest = rig.at_rest()
    references = {
        s.name: _swinging_set_point(s, i, rest[s.name], k, loss_start) for i, s in enumerate(interface.set_points)
    }
    return rig.run(n * rig.period_s, {}, references, overrides=_bad_samples(interface, k, loss_start, beyond))


def _swinging_set_point(
    point: SetPoint, i: int, rest: float, k: NDArray[np.int64], loss_start: int
) -> NDArray[np.float64]:
    size = SWING * (min(point.high - rest, rest - point.low) or (point.high - point.low) / 2)
    values = rest + size * np.sin(2 * np.pi * (TURNS + 2 * i) * k / len(k))
    jump = np.where(k >= loss_start - JUMP, size, 0.0)
    return np.clip(values + jump, point.low, point.high)


def _bad_samples(interface: Interface, k: NDArray[np.int64], loss_start: int, beyond: float) -> dict[str, Override]:
    n, names = len(k), [s.name for s in interface.sensors]
    start = (6 * n) // 10
    masks = {name: k % (n // 10) == (n // 20 + 7 * i) % (n // 10) for i, name in enumerate(names[1:])}
    masks[names[0]] = (k >= start) & (k < start + interface.bad_samples - 1)
    masks[names[-1]] = masks[names[-1]] | (k >= loss_start)
    masks |= {name: masks[name] | (k >= loss_start + n // 40) for name in names}
    masks |= {s.name: (k >= (8 * n) // 10) & (k < (8 * n) // 10 + 10) for s in interface.set_points[:1]}
    ends = {name: interface.signals[name] for name in masks}
    values = {name: s.high + beyond * (s.high - s.low) for name, s in ends.items()}
    return {name: Override(mask, np.full(n, values[name])) for name, mask in masks.items()}


def sequences(
    rig: Rig, experiments: Sequence[Experiment], progress: Callable[[str], None], design_steps: Sequence[Steps] = ()
) -> list[Steps]:
    """Return every sequence for the controller of a rig, closed loops first; `experiments` were run with it.

    `design_steps` are further steps that the design defines.
    """
    progress("sequences")
    controller = rig.controller
    runs = {e.name: e.trajectory for e in experiments} | {"faults in motion": closed_loop(rig, REPLAY_STEPS)}
    columns: dict[str, dict[str, ArrayLike]] = {
        name: {
            **rig.constant_inputs,
            **run.measured,
        }  # an experiment's variant of the controller may not read the count
        for name, run in runs.items()
    }
    loops = [steps.record(controller, name, columns[name], True, run.initial) for name, run in runs.items()]
    return [
        *(steps.thinned(loop, LOOP_STEPS) for loop in loops),
        *excursions(controller, rig.at_rest(), loops, design_steps),
    ]


def excursions(
    controller: host.Controller,
    at_rest: Mapping[str, float],
    loops: Sequence[Steps],
    design_steps: Sequence[Steps] = (),
) -> list[Steps]:
    """Return the sequences that need no closed loop, from inputs at rest.

    States of recorded `loops` and of `design_steps` are resampled.
    """
    pools = [*([steps.concatenate("", loops)] if loops else []), *design_steps]
    random_steps = steps.random_steps(controller, POOL_STEPS)
    resampled = [
        steps.resampled(controller, steps.thinned(p, POOL_STEPS), f"{p.name} states resampled".lstrip()) for p in pools
    ]
    contradictory = steps.contradictory(controller, resampled[0])
    return [
        *(steps.thinned(each, RANDOM_STEPS) for each in design_steps),
        *latches(controller, SEED),
        steps.fault_steps(controller, at_rest),
        steps.edge_steps(controller, steps.thinned(pools[0], POOL_STEPS)),
        steps.in_range(controller, RANDOM_STEPS),
        random_steps,
        *resampled,
        *([contradictory] if len(contradictory) else []),
        *(
            steps.rarest(controller, each, RAREST_STEPS)
            for each in (*design_steps, *resampled, contradictory)
            if len(each)
        ),
        steps.at_range_ends(
            controller, steps.concatenate("random", [random_steps, *resampled, *design_steps]), STEPS_PER_RANGE_END
        ),
    ]


def latches(controller: host.Controller, seed: int) -> list[Steps]:
    """Record the slew of the outputs to their safe values: after random inputs all measurements are NaN.

    Random inputs over their full ranges drive the outputs to their limits, where the slew is longest. The result is
    empty for a controller without safe outputs.
    """
    safety, rng = controller.manifest["safety"], np.random.default_rng(seed)
    if not safety or not safety["slew_per_s"]:
        return []
    fields = {f["name"]: f for f in controller.manifest["structs"]["output"]["fields"]}
    longest = max(
        (f["high"] - f["low"]) / safety["slew_per_s"][n] for n, f in fields.items() if n in safety["slew_per_s"]
    )
    after = safety["bad_samples"] + min(ceil(longest / controller.period_s), LONGEST) + steps.GOOD
    runs = [steps.record(controller, "latches", loss_of_measurement(controller, lead, after, rng)) for lead in LEADS]
    return [steps.concatenate("latches", [run.part(slice(lead, None)) for run, lead in zip(runs, LEADS, strict=True)])]


def loss_of_measurement(
    controller: host.Controller, lead: int, after: int, rng: np.random.Generator
) -> dict[str, NDArray[Any]]:
    """Return inputs (lead + after,): random in their ranges, and NaN from sample `lead` on."""
    inputs = controller.manifest["structs"]["input"]["fields"]
    columns = {f["name"]: rng.uniform(f["low"], f["high"], lead + after) for f in inputs}
    for values in columns.values():
        values[lead:] = np.nan
    return columns
