"""What the report of the lead-lag design adds to that of the planar stage."""

from functools import partial

from designs.planar_6dof import page
from designs.planar_6dof.paper import rows
from designs.planar_6dof_leadlag import control, loops
from synth.plant import Plant

LINE = "six lead-lag loops, (21)-(25), those of x, y and φ on filtered positions"
EQUATIONS = (
    ("Y(21)", "K_x = K_y = 15000 k_x (1 + 0.11 s) / (1 + 0.00088 s) (1 + 0.1 s) / s"),
    ("Y(22)", "K_φ = 35 k_φ (1 + 0.12 s) / (1 + 0.00088 s) (1 + 0.1 s) / s"),
)
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
    return page.Contents(block, LINE, EQUATIONS, opened, BESIDE, values=printed)


report = partial(page.report, contents)
