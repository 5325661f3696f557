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
from synth.report import page
from synth.report.audit import Row
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
    own = shared.Contents(control.NAME, TIME, line, _law(), _gains(), _loops(plant), BESIDE)
    return shared.report(own, files, evidence, experiments, rows, cost)


def _law() -> page.Section:
    text = page.Text(
        "Each loop is a lead w and a reset I. The reset is driven by what the limited currents make of the demand, so "
        "that nothing winds up. The filters (6)-(16) take the phase that (21) and (22) have to give: x, y and φ use a "
        "part of the printed gain. z, θ and ψ have their zeros as printed, the pole at 2/T, and a part of the gain at "
        "low frequencies: a sample of delay makes ψ as printed unstable, whose crossover is 110 Hz."
    )
    return page.Section("Control law", (text, page.Equations((*_horizontal(), *shared.upright(), shared.RESET))))


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
    text = page.Text(
        "Gains, zeros and poles are computed in ball arithmetic and rounded once. The errors are those of the sampled "
        "compensator beside the continuous one; hold and delay come on top and are in the loops below."
    )
    return page.Section("Gains and certificates", (text, table))


def _loops(plant: Plant) -> page.Section:
    found, printed = loops.all_loops(plant), [rows.printed()[row]["crossover"].text for row in ("Y-7", "Y-8")]
    text = page.Text(
        "Each loop is opened at the platen's own coordinate, the other five closed: the rounded controller as it "
        "ships, guard and sensing included, one sample of computation delay, the hold, and the stage, linearised "
        "about the platen at rest in the middle of its travel. What is printed of one axis is closed with the other "
        "five as shipped, with the filters, and without its own. The paper prints crossovers of "
        f"{' and '.join(printed)} Hz, rows Y-7 and Y-8 of the audit, for a loop without filter and delay."
    )
    over = shared.over_pitch(planar_stage.plant(halbach.HARMONICS), control.controller(plant).rounded(np.float32))
    return page.Section("Loops and margins", (text, over), tuple(shared.bodes(found, axis) for axis in AXES))
