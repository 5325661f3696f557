"""What the report of the lead-lag design adds to that of the planar stage."""

from functools import partial

from designs.planar_6dof import page, vertical
from designs.planar_6dof.paper import rows
from designs.planar_6dof_leadlag import control, loops
from synth.plant import Plant
from synth.report.figures import SYMBOLS

LINE = "six lead-lag loops, (21)-(25), those of x, y and φ on filtered positions"
_STEP = (("Y-9", "Fig. 8"), ("Y-9b", "Fig. 8"))
BESIDE = {
    **dict.fromkeys(("step_x", "step_y"), _STEP),
    "step_phi": (*_STEP, ("Y-33", "Fig. 8(c)")),
    "circle": (("Y-27", "Fig. 9"), ("Y-16", "Fig. 9")),
    "standstill": (("Y-34", "section 5.2"),),
}


def contents(plant: Plant) -> page.Contents:
    """Return what is said of this design; report.md asks for the crossovers that the paper prints, in Hz."""
    printed = {f"crossover_{row}": rows.printed()[row]["crossover"].text for row in ("Y-7", "Y-8")}
    block, opened = control.controller(plant), loops.all_loops(plant)
    return page.Contents(block, LINE, _horizontal(), opened, BESIDE, values=printed)


def _horizontal() -> list[tuple[str, str]]:
    found = []
    for axis, equation in (("x", "K_x = K_y"), ("phi", "K_φ")):
        gain, lead = control.PUBLISHED[axis]
        law = f"{gain:g} k_{SYMBOLS.get(axis, axis)} (1 + {lead:g} s) / (1 + {control.LAG:g} s)"
        found.append((f"Y({vertical.EQUATION[axis]})", f"{equation} = {law} (1 + {control.RESET:g} s) / s"))
    return found


report = partial(page.report, contents)
