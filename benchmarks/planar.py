"""Cost of a step of the planar controllers on an emulated Cortex-M4F, by gcc: whole, by part, and the cores alone.

    whole   sensing, filters, law, allocation, commutation and guard: lead-lag, LQG of reduced and of full order
    cores   the LQG regulators alone, from three errors to three currents
    CasADi  CasADi's own C of the same Blocks over some of the same steps: as emitted, and with a float shim

`mean` is over steps of closed loops without a fault, `most` over all sequences: instructions that are issued. For a
core `small` errors leave every state within its bounds. `benchmarks.parts` attributes instructions to parts.
"""

import sys
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from benchmarks import parts
from designs.planar_6dof import cost_stimuli, interface, loop, lqg
from designs.planar_6dof.allocation import HORIZONTAL
from designs.planar_6dof_leadlag import control as leadlag
from designs.planar_6dof_leadlag import experiments as of_leadlag
from designs.planar_6dof_lqg import core
from designs.planar_6dof_lqg import experiments as of_lqg
from models import planar_stage
from synth.block import Block, unranged
from synth.declare.experiments import Run
from synth.emit import write
from synth.execute import host
from synth.verify import baselines, meter, steps, stimuli
from synth.verify.steps import Steps

# Without dead reckoning, braking and the estimate of the amplitude the LQG controllers had 700, lead-lag 800.
BARS = {"lead-lag": 900, "LQG": 900, "LQG, full order": 900, "reduced core": 95, "full core": 100}
COMMON_STEPS = {True: 60, False: 12}  # closed-loop steps for CasADi's C, with the shim and as emitted
BREAKDOWN_STEPS = 500  # closed-loop steps of the instruction profile
CORE = 2000  # steps of a core
PARTS = {
    "guard": ("guard", "start"),
    "sensing": ("sensing", "vertical_kinematics"),
    "filters": ("filter_",),
    "prediction": ("reckoning", "delay"),
    "law": ("loop_", "lqg_", "braking"),
}
WIDTHS = (17, 20, 8, 9, 10, 15, 10)


@dataclass(frozen=True, eq=False)
class Subject:
    """A Block with its emitted C and the steps over which it is measured; `within` are those of the mean."""

    name: str
    block: Block
    emitted: write.EmittedCode
    controller: host.Controller
    within: Steps
    every: Steps


@dataclass(frozen=True)
class Costs:
    """Instructions of a subject by a build: mean and most, and the mean of CasADi's C, shimmed and not, over ours.

    `parts` has for each part of the step the mean and the count in the costliest step.
    """

    subject: str
    build: str
    mean: float
    most: int
    bar: int
    ratios: tuple[float, float]
    parts: Mapping[str, tuple[float, int]]


def controllers() -> Iterator[Subject]:
    """Yield the three controllers."""
    plant = planar_stage.plant()
    yield controller_subject("lead-lag", leadlag.controller(plant), of_leadlag.ALL)
    yield controller_subject("LQG", lqg.controller(plant), of_lqg.ALL)
    yield controller_subject("LQG, full order", lqg.controller(plant, regulate=core.full_order), of_lqg.ALL)


def controller_subject(name: str, block: Block, experiments: Sequence[Run]) -> Subject:
    """Return a controller with every sequence of its cost stimuli."""
    emitted = write.emit(block, np.float32, error=interface.SURROGATE_ERROR[np.float32])
    controller = host.load(emitted.files, emitted.manifest)
    rig = loop.of(block, controller)
    runs = [experiment.run(rig) for experiment in experiments]
    sequences = stimuli.sequences(rig, runs, lambda _: None, cost_stimuli.stimuli(controller))
    loops = steps.concatenate("closed loops", [s for s in sequences if s.closed_loop])
    sound = steps.thinned(steps.without_faults(controller, loops), BREAKDOWN_STEPS)
    return Subject(name, block, emitted, controller, sound, steps.concatenate("all", sequences))


def cores() -> Iterator[Subject]:
    """Yield the two cores, with small errors and with random states and errors."""
    for order in core.ORDERS:
        block = core.block(order)
        emitted = write.emit(unranged(block), np.float32)
        controller = host.load(emitted.files, emitted.manifest)
        errors = {axis: 1e-6 * np.sin(np.arange(CORE) + i) for i, axis in enumerate(HORIZONTAL)}
        small = steps.record(controller, "small", errors)
        every = steps.concatenate("all", [small, steps.random_steps(controller, CORE)])
        yield Subject(f"{order} core", block, emitted, controller, small, every)


def builds() -> list[meter.Build]:
    """Return gcc's builds without contraction, -O2 and -Os; none where gcc is not installed."""
    return [b for b in meter.builds() if b.compiler == "gcc" and "contracted" not in b.name]


def measure(subject: Subject, build: meter.Build) -> Costs:
    """Measure a subject by a build, and CasADi's C for comparison."""
    every = meter.run(baselines.emitted_c(subject.emitted), subject.every, build).cost.instructions
    worst = subject.every.part(np.array([np.argmax(every)]))
    within, costliest = (parts.measure(subject.emitted, sequence, build) for sequence in (subject.within, worst))
    shares: dict[str, tuple[float, int]] = {}
    for block, n in within.items():
        mean, most = shares.get(part_of(block), (0.0, 0))
        shares[part_of(block)] = mean + float(n.mean()), most + int(costliest[block][0])
    mean = sum(mean for mean, _ in shares.values())
    bar, ratios = BARS[subject.name], (_ratio(subject, build, True), _ratio(subject, build, False))
    return Costs(subject.name, build.name, mean, int(every.max()), bar, ratios, shares)


def _ratio(subject: Subject, build: meter.Build, shimmed: bool) -> float:
    common = steps.thinned(subject.within, COMMON_STEPS[shimmed])
    candidates = baselines.emitted_c(subject.emitted), baselines.casadi(subject.block, shimmed)
    ours, casadis = (meter.run(c, common, build).cost.instructions.mean() for c in candidates)
    return float(casadis / ours)


def part_of(block: str) -> str:
    """Return the part of the step to which a Block belongs."""
    return next((part for part, starts in PARTS.items() if block.startswith(starts)), block.replace("_", " "))


def comparison_lines(costs: Sequence[Costs]) -> Iterator[str]:
    """Yield the lines that compare the subjects."""
    yield _line(("step of", "build", "mean", "most", "bar", "CasADi, float", "CasADi"))
    for c in costs:
        ratios = (f"x {ratio:.2f}" for ratio in c.ratios)
        yield _line((c.subject, c.build, f"{c.mean:.0f}", str(c.most), str(c.bar), *ratios))


def breakdown_lines(costs: Costs) -> Iterator[str]:
    """Yield the lines of a step's parts."""
    yield _line((costs.subject, costs.build, "mean", "share", "costliest", "share"))
    for part, (mean, most) in {**costs.parts, "in all": (costs.mean, costs.most)}.items():
        shares = f"{100 * mean / costs.mean:.1f} %", f"{100 * most / costs.most:.1f} %"
        yield _line(("", part, f"{mean:.1f}", shares[0], str(most), shares[1]))


def _line(cells: Sequence[str]) -> str:
    aligned = [
        cell.rjust(w) if k > 1 else cell.ljust(w) for k, (cell, w) in enumerate(zip(cells, WIDTHS, strict=False))
    ]
    return "".join(aligned)


def lines() -> Iterator[str]:
    """Yield every line, those of the parts last."""
    costs = [measure(subject, build) for subject in (*controllers(), *cores()) for build in builds()]
    yield from comparison_lines(costs)
    for each in costs:
        yield ""
        yield from breakdown_lines(each)


if __name__ == "__main__":
    for text in lines():
        sys.stdout.write(f"{text}\n")
