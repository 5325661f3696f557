"""The report of the lead-lag design."""

from collections.abc import Mapping, Sequence

import numpy as np

from designs.planar_6dof import page as shared
from designs.planar_6dof import vertical
from designs.planar_6dof.allocation import AXES, VERTICAL
from designs.planar_6dof.paper import rows
from designs.planar_6dof_leadlag import control, loops
from designs.planar_6dof_leadlag.control import TIME
from models import halbach, planar_stage
from synth.emit.write import Emitted
from synth.plant import Plant
from synth.report import page, standard
from synth.report.audit import Row
from synth.report.prose import Value
from synth.simulate.experiment import Experiment
from synth.verify.cost import Cost
from synth.verify.evidence import Evidence

_STEP = (("Y-9", "Fig. 8"), ("Y-9b", "Fig. 8"))
BESIDE = {
    **dict.fromkeys(("step_x", "step_y"), _STEP),
    "step_phi": (*_STEP, ("Y-33", "Fig. 8(c)")),
    "circle": (("Y-27", "Fig. 9"), ("Y-16", "Fig. 9")),
    "standstill": (("Y-34", "section 5.2"),),
}


def report(
    files: Mapping[str, Emitted],
    evidence: Evidence,
    experiments: Sequence[Experiment],
    rows: Sequence[Row],
    cost: Cost | None,
) -> str:
    """Return the whole report as one HTML document."""
    plant = planar_stage.plant()
    line = "six lead-lag loops, (21)-(25), those of x, y and φ on filtered positions"
    own = shared.Contents(control.NAME, TIME, line, _law(plant), _gains(), _loops(plant), BESIDE, values=_printed())
    return shared.report(own, files, evidence, experiments, rows, cost)


def _law(plant: Plant) -> page.Section:
    printed = page.Equations((*_horizontal(), *shared.upright()))
    return standard.law(control.controller(plant).rounded(np.float32), (printed,))


def _horizontal() -> tuple[tuple[str, str], ...]:
    found = []
    for axis, equation in (("x", "K_x = K_y"), ("phi", "K_φ")):
        gain, lead = control.PUBLISHED[axis]
        law = f"{gain:g} k_{shared.SYMBOLS.get(axis, axis)} (1 + {lead:g} s) / (1 + {control.LAG:g} s)"
        found.append((f"Y({vertical.EQUATION[axis]})", f"{equation} = {law} (1 + {control.RESET:g} s) / s"))
    return tuple(found)


def _gains() -> page.Section:
    upright = [vertical.loop(axis, vertical.compensator(axis, TIME), TIME) for axis in VERTICAL]
    table = shared.compensators([*control.loops(), *upright], control.PART | vertical.PART)
    return page.Section(standard.GAINS, (table,))


def _loops(plant: Plant) -> page.Section:
    found = loops.all_loops(plant)
    over = shared.over_pitch(planar_stage.plant(halbach.HARMONICS), control.controller(plant).rounded(np.float32))
    return page.Section(standard.LOOPS, (over,), tuple(shared.bodes(found, axis) for axis in AXES))


def _printed() -> dict[str, Value]:
    """Return what report.md asks for: the crossovers that the paper prints, in Hz."""
    return {f"crossover_{row}": rows.printed()[row]["crossover"].text for row in ("Y-7", "Y-8")}
