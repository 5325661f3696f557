"""The report of a planar design: what a design review reads, assembled from the computed parts.

Both designs share stage, sensing, filter, the pictures of experiments, voltages, failures, audit and verification; each
adds its law, its gains and its loops.
"""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from designs.planar_6dof import allocation, loops, page_experiments, page_stage, sensing_maps, vertical
from designs.planar_6dof.page_stage import SYMBOLS
from models import halbach, planar_stage
from synth.block import Block
from synth.emit.write import Emitted
from synth.plant import Plant
from synth.report import bode, page, sections, standard, template
from synth.report.audit import Row
from synth.report.page import Section
from synth.report.prose import Value
from synth.report.shown import Beside, beside
from synth.simulate.experiment import Experiment
from synth.timing import Discrete
from synth.verify.cost import Cost
from synth.verify.evidence import Evidence

ABOUT = (
    "The six-axis planar positioner of Yu and Kim: a platen on air bearings, driven by three planar motors over a "
    "magnet matrix and seen by three Hall sensors and three laser distance sensors. This page was computed from the "
    "physics; every figure on it was measured on the C that ships, or on the model that the C was derived from."
)


@dataclass(frozen=True, eq=False)
class Contents:
    """What a design adds to its report: its controller, a line on its law and equations as printed, gains and loops.

    `whole` are sections on several loops at once. `beside` gives the rows of the audit that an experiment stands
    beside; `filtered` tells whether the law reads filtered positions, `spectrum` whether the paper draws one; `values`
    are what its report.md asks for; `cost` follows the cost.
    """

    block: Block
    line: str
    equations: Sequence[tuple[str, str]]
    gains: Sequence[page.Table]
    loops: Sequence[loops.OpenLoop]
    beside: Beside
    whole: Sequence[Section] = ()
    filtered: bool = True
    spectrum: bool = False
    values: Mapping[str, Value] = field(default_factory=dict)
    cost: Callable[[Sequence[Experiment]], tuple[page.Block, ...]] = lambda _: ()


def report(
    contents: Callable[[Plant], Contents],
    files: Mapping[str, Emitted],
    evidence: Evidence,
    experiments: Sequence[Experiment],
    rows: Sequence[Row],
    cost: Cost | None,
) -> str:
    """Return the whole report of a design as one HTML document, with every experiment that is handed in."""
    plant, spent = planar_stage.plant(), sections.cost(cost)
    own = contents(plant)
    block, time = own.block.rounded(np.float32), own.block.time
    shown = dict.fromkeys(opened.axis for opened in own.loops)
    parts = (
        page_stage.model(plant),
        page_stage.sensing(plant, time, experiments if own.filtered else None),
        standard.law(block, (page.Equations((*own.equations, *_upright())),)),
        Section(standard.GAINS, tuple(own.gains)),
        Section(standard.LOOPS, (over_pitch(block),), (*own.whole, *(bodes(own.loops, axis) for axis in shown))),
        page_experiments.experiments(experiments, beside(own.beside, rows), time, own.filtered, own.spectrum),
        page_experiments.headroom(experiments),
        page_stage.failures(plant, time, own.filtered),
        standard.audit(rows),
        standard.verification(evidence, "1 A"),
        replace(spent, blocks=(*spent.blocks, *(own.cost(experiments) if cost else ()))),
        standard.files(files),
    )
    inputs = "6 Hall voltages, 3 laser distances, 6 set-points"
    facts = (*standard.facts(time, np.float32, inputs, "9 phase currents of 3 motors"), ("law", own.line))
    values = {"speed": sensing_maps.SPEED, **own.values}
    return template.assembled(own.block.name, ABOUT, facts, parts, values, ("planar_6dof",))


def _upright() -> tuple[tuple[str, str], ...]:
    """Return (23)-(25) as printed, times the part that is used."""
    rows = []
    for axis, (gain, zero, pole) in vertical.PUBLISHED.items():
        k = SYMBOLS.get(axis, axis)
        lead = f"(s + {zero:g}) / (s + {pole:g}) (s + {vertical.RESET:g}) / s"
        rows.append((f"Y({vertical.EQUATION[axis]})", f"K_{k} = {gain:.6g} k_{k} {lead}"))
    return tuple(rows)


def compensators(
    time: Discrete, parts: Iterable[vertical.Loop] = (), used: Mapping[str, float] | None = None
) -> page.Table:
    """Return lead-lag compensators as sampled, the part of the printed gain in each, and the errors of sampling.

    Those of the vertical axes stand behind `parts`, of whose gains a part is `used`.
    """
    rows, shares = [], {**(used or {}), **vertical.PART}
    upright = (vertical.loop(axis, vertical.compensator(axis, time), time) for axis in allocation.VERTICAL)
    for part in (*parts, *upright):
        made = part.sampled
        zeros, poles = (", ".join(f"{v.real + 0.0:.6g}" for v in np.round(v, 12)) for v in (made.zeros, made.poles))
        errors = f"{100 * made.gain_error:.2g}", f"{made.phase_error:.2g}"
        name = SYMBOLS.get(part.axis, part.axis), f"({vertical.EQUATION[part.axis]})"
        rows.append((*name, shares[part.axis], made.gain, zeros, poles, *errors))
    errors_of = ("gain off by, %", "phase off by, °")
    columns = ("axis", "from", "part of the gain", "D, N/m or N m/rad", "zeros, z", "poles, z", *errors_of)
    caption = (
        f"Compensators by Tustin's rule; the errors of sampling are those at {vertical.COMPARED / (2 * np.pi):g} Hz"
    )
    return page.Table(caption, columns, tuple(rows), digits=6)


def bodes(found: Sequence[loops.OpenLoop], axis: str) -> Section:
    """Return the Bode plot of an axis with the margins of each of its loops."""
    curves = [bode.curve(o.label, o.L, o.margins) for o in found if o.axis == axis]
    return sections.loop(f"Loop of {SYMBOLS.get(axis, axis)}", f"bode-{axis}", curves)


def over_pitch(block: Block) -> page.Table:
    """Return the least and the greatest margins of each loop over a pitch."""
    found = loops.over_pitch(planar_stage.plant(halbach.HARMONICS), block)
    rows = [
        (SYMBOLS.get(axis, axis), *sections.margins_ranges([margins[axis] for margins in found]))
        for axis in allocation.AXES
    ]
    caption = f"The loops as shipped at {len(found)} places of a pitch, motors with the field's harmonics"
    return page.Table(caption, ("axis", *sections.RANGES), tuple(rows))
