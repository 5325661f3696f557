"""Stimuli of a compiled controller: which steps are counted, replayed on a target, and committed as test vectors.

    closed loops     each experiment, and set-points that swing while samples are bad, up to the latch
    latches          from outputs at their limits on no measurement is good, until every slew has ended
    faults, edges    every input bad alone and all at once; every input on the last number accepted and on the next
    random           inputs in range; states and inputs anywhere, and those of closed loops with some states anew
    rare, at ends    of these, those whose flags few others have, and those that come to the end of a range

All but the closed loops know a controller by its manifest alone.
"""

from collections.abc import Callable, Mapping, Sequence
from math import ceil
from typing import Any

import numpy as np
from numpy.typing import NDArray

from synth.declaration import Interface, SetPoint
from synth.execute import host
from synth.simulate.experiment import Experiment
from synth.simulate.rig import Rig
from synth.simulate.scenario import Trajectory
from synth.simulate.sensors import Override
from synth.verify import steps
from synth.verify.steps import Steps

REPLAY, VECTORS = 10_000, 1000  # steps
EACH = 1000  # steps of each closed loop
SWING = 0.2  # of a set-point's range, to either side of rest
TURNS = 3.0  # of the first set-point in a recording; the others have more
JUMP = 20  # samples before the latch: the set-points jump, so that the actuators are far from their safe values
RANDOM, DRAWN, RARE, EACH_END = 2000, 20_000, 1000, 40
LEADS = (3, 40, 333)  # samples of random inputs before measurements end
LONGEST = 20_000  # samples of a slew
BEYOND = 0.5  # of a range: how far beyond its end the bad samples of test vectors are, which JSON has to hold
SEED = 2026


def closed_loop(rig: Rig, n: int, beyond: float = np.nan) -> Trajectory:
    """Run n samples in which the set-points swing about rest; sensors and set-points are bad for some, up to the latch.

    The first sensor has a run of bad samples one short of the latch, the others single ones, a set-point ten, and for
    the last twentieth of the run the last sensor is lost. A bad sample is `beyond` the end of the range, by that part
    of it, or no number.
    """
    interface = rig.stage.interface
    k, lost = np.arange(n), n - n // 20
    rest = rig.at_rest()
    references = {s.name: _swinging_set_point(s, i, rest[s.name], k, lost) for i, s in enumerate(interface.set_points)}
    return rig.run(n * rig.period_s, {}, references, overrides=_bad_samples(interface, k, lost, beyond))


def _swinging_set_point(point: SetPoint, i: int, rest: float, k: NDArray[np.int64], lost: int) -> NDArray[np.float64]:
    size = SWING * (min(point.high - rest, rest - point.low) or (point.high - point.low) / 2)
    values = rest + size * np.sin(2 * np.pi * (TURNS + 2 * i) * k / len(k))
    jump = np.where(k >= lost - JUMP, size, 0.0)
    return np.clip(values + jump, point.low, point.high)


def _bad_samples(interface: Interface, k: NDArray[np.int64], lost: int, beyond: float) -> dict[str, Override]:
    n, names = len(k), [s.name for s in interface.sensors]
    start = (6 * n) // 10
    masks = {name: k % (n // 10) == (n // 20 + 7 * i) % (n // 10) for i, name in enumerate(names[1:])}
    masks[names[0]] = (k >= start) & (k < start + interface.bad_samples - 1)
    masks[names[-1]] = masks[names[-1]] | (k >= lost)
    masks |= {s.name: (k >= (8 * n) // 10) & (k < (8 * n) // 10 + 10) for s in interface.set_points[:1]}
    ends = {name: interface.signals[name] for name in masks}
    values = {name: s.high + beyond * (s.high - s.low) for name, s in ends.items()}
    return {name: Override(mask, np.full(n, values[name])) for name, mask in masks.items()}


def sequences(
    rig: Rig, experiments: Sequence[Experiment], progress: Callable[[str], None], design_steps: Sequence[Steps] = ()
) -> list[Steps]:
    """Return every sequence for a rig's controller, closed loops first; `experiments` were run with it.

    `own` are further steps of the design's.
    """
    progress("sequences")
    controller = rig.controller
    runs = {e.name: e.trajectory for e in experiments} | {"faults in motion": closed_loop(rig, REPLAY)}
    loops = [steps.recorded(controller, name, run.measured, closed_loop=True) for name, run in runs.items()]
    return [*(steps.thinned(loop, EACH) for loop in loops), *excursions(controller, rig.at_rest(), loops, design_steps)]


def excursions(
    controller: host.Controller,
    at_rest: Mapping[str, float],
    loops: Sequence[Steps],
    design_steps: Sequence[Steps] = (),
) -> list[Steps]:
    """Return the sequences that need no closed loop, from inputs at rest.

    States of recorded `loops` and of the design's `own` steps are drawn anew.
    """
    pools = [*([steps.joined("", loops)] if loops else []), *design_steps]
    drawn = steps.drawn(controller, DRAWN)
    resampled = [steps.anew(controller, steps.thinned(p, DRAWN), f"{p.name} states anew".lstrip()) for p in pools]
    return [
        *(steps.thinned(each, RANDOM) for each in design_steps),
        *latches(controller, SEED),
        steps.faulty(controller, at_rest),
        steps.edges(controller, steps.thinned(pools[0], DRAWN)),
        steps.in_range(controller, RANDOM),
        drawn,
        *resampled,
        *(steps.rare(controller, each, RARE) for each in (*design_steps, *resampled)),
        steps.at_ends(controller, steps.joined("random", [drawn, *resampled, *design_steps]), EACH_END),
    ]


def latches(controller: host.Controller, seed: int) -> list[Steps]:
    """Record how the outputs go to their safe values: after random inputs no measurement is good.

    Inputs anywhere in their ranges take the outputs to their limits, from where the slew is longest. There is none of a
    controller that has no safe output.
    """
    safety, rng = controller.manifest["safety"], np.random.default_rng(seed)
    if not safety or not safety["slew_per_s"]:
        return []
    fields = {f["name"]: f for f in controller.manifest["structs"]["output"]["fields"]}
    longest = max(
        (f["high"] - f["low"]) / safety["slew_per_s"][n] for n, f in fields.items() if n in safety["slew_per_s"]
    )
    after = safety["bad_samples"] + min(ceil(longest / controller.period_s), LONGEST) + steps.GOOD
    runs = [steps.recorded(controller, "latches", loss_of_measurement(controller, lead, after, rng)) for lead in LEADS]
    return [steps.joined("latches", [run.part(slice(lead, None)) for run, lead in zip(runs, LEADS, strict=True)])]


def loss_of_measurement(
    controller: host.Controller, lead: int, after: int, rng: np.random.Generator
) -> dict[str, NDArray[Any]]:
    """Return inputs (lead + after,): anywhere in their ranges, and from `lead` on not a number."""
    inputs = controller.manifest["structs"]["input"]["fields"]
    columns = {f["name"]: rng.uniform(f["low"], f["high"], lead + after) for f in inputs}
    for values in columns.values():
        values[lead:] = np.nan
    return columns
