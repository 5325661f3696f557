"""Tables of the report about the commutation: errors through both blocks, instructions of a step, and equal bits."""

from collections.abc import Mapping, Sequence

import numpy as np

from designs.maglev import platen
from synth import show
from synth.blocks.estimate import phasor
from synth.declare.companion import Companion
from synth.declare.stage import Stage
from synth.emit.write import EmittedCode
from synth.execute import host
from synth.report import page
from synth.report.prose import Value
from synth.simulate.experiments import Experiment
from synth.verify import meter, steps

ANGLES = {"tracking": "where the current acts", "tracking_measured_angle": "measured"}
SAMPLES, LOST = slice(2000, 3000), slice(200, 700)  # of the tracking, and of these samples those in which x is lost
BOTH = slice(900, 920)  # samples in which z is lost, too
ABSENT = "Instructions and bits were not measured: no emulator or no cross compiler was installed."


def values(
    stage: Stage, files: Mapping[str, EmittedCode], runs: Sequence[Experiment], emulated: bool
) -> dict[str, Value]:
    """Return the placeholders of report.md; without an emulator a text takes the place of the second table."""
    by_name, (companion,) = {run.name: run for run in runs}, stage.companions
    code = files[companion.name]
    cost = instructions(companion, code, by_name["tracking"]) if emulated else page.Text(ABSENT)
    (polynomial,), roundoff = code.manifest["surrogates"], float(np.finfo(stage.scalar).eps) / 2
    bound = phasor.quarter_angle_error(roundoff, polynomial["max_relative_error"])
    return {"commutation_errors": errors(by_name), "commutation_cost": cost, "sine_error": bound}


def errors(runs: Mapping[str, Experiment]) -> show.Table:
    """Return the mean errors of the 4-DOF tracking through both blocks, for each angle of the commutation."""
    columns = [name for name in runs["tracking"].figures if name.startswith("mean |e_")]
    rows: list[tuple[show.Cell, ...]] = [
        (angle, *(runs[name].figures[c] for c in columns)) for name, angle in ANGLES.items()
    ]
    caption = "4-DOF tracking through controller and commutation, one sample late"
    return show.Table(caption, ("angle of the commutation", *columns), tuple(rows))


def instructions(companion: Companion, emitted: EmittedCode, tracking: Experiment) -> show.Table:
    """Return the instructions of a step of the commutation by build, and how many values differ from the host."""
    run, controller = tracking.trajectory, host.load(emitted.files, emitted.manifest)
    recorded = {n: v[SAMPLES].copy() for n, v in companion.select_inputs(run.measured, run.commands).items()}
    healthy = steps.record(controller, "4-DOF tracking", recorded)
    x, z = (recorded[s.name] for s in platen.COMMUTATED.values())
    x[LOST] = x[BOTH] = z[BOTH] = np.nan
    lost = steps.record(controller, "positions lost", recorded)
    rows: list[tuple[show.Cell, ...]] = [
        (row.build, float(row.counts[0].mean()), *(int(n.max()) for n in row.counts), row.values, row.differing)
        for row in meter.instructions(emitted, (healthy, lost))
    ]
    columns = ("build", "mean", "most", "most, a position lost", "values", "with other bits")
    return show.Table("Instructions of a step of the commutation on a Cortex-M4F", columns, tuple(rows), digits=6)
