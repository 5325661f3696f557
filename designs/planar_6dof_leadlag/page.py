"""Report of the lead-lag design: its contents beyond the common report of the planar stage.

The loops are shown as shipped, as printed, and as printed on unfiltered positions. The crossovers and margins of the
paper are those of the third kind: (21), (22) without the filters (6)-(16).
"""

from collections.abc import Sequence
from dataclasses import replace
from functools import partial

from designs.planar_6dof import loops, motion, page
from designs.planar_6dof.allocation import AXES, HORIZONTAL
from designs.planar_6dof.loops import OpenLoop
from designs.planar_6dof.paper import rows
from designs.planar_6dof_leadlag import control
from designs.planar_6dof_leadlag.control import TIME
from synth.block import Block
from synth.plant import Plant

LINE = "six lead-lag loops, (21)-(25), those of x, y and φ on filtered positions"
EQUATIONS = (
    ("Y(21)", "K_x = K_y = 15000 k_x (1 + 0.11 s) / (1 + 0.00088 s) (1 + 0.1 s) / s"),
    ("Y(22)", "K_φ = 35 k_φ (1 + 0.12 s) / (1 + 0.00088 s) (1 + 0.1 s) / s"),
)
_STEP = (("Y-9", "Fig. 8"), ("Y-9b", "Fig. 8"))
PUBLISHED = {
    **dict.fromkeys(("step_x", "step_y"), _STEP),
    "step_phi": (*_STEP, ("Y-33", "Fig. 8(c)")),
    "circle": (("Y-27", "Fig. 9"), ("Y-16", "Fig. 9")),
    "standstill": (("Y-34", "section 5.2"),),
}


def of_plant(plant: Plant) -> page.Contents:
    """Return the contents of this design; report.md names the printed crossovers, in Hz."""
    printed = {f"crossover_{row}": rows.published_rows()[row]["crossover"].text for row in ("Y-7", "Y-8")}
    block, open_loops = control.controller(plant), all_loops(plant)
    return page.Contents(block, LINE, EQUATIONS, open_loops, PUBLISHED, values=printed)


def all_loops(plant: Plant) -> list[OpenLoop]:
    """Return the six loops of each kind; a printed loop of one axis is closed with the others as shipped."""
    shipped, printed = control.law(plant), control.law(plant, "published")
    open_loops = loops.of_block(plant, whole(plant, control.filters(), shipped), AXES, "as shipped")
    for axis in AXES:
        law = loops.with_axis_of(shipped, printed, axis)
        open_loops += loops.of_block(plant, whole(plant, control.filters(), law), [axis], "as printed")
        if axis in HORIZONTAL:
            open_loops += loops.of_block(
                plant, whole(plant, without_filter(axis), law), [axis], "as printed, unfiltered"
            )
    return open_loops


def whole(plant: Plant, filters: Sequence[Block], law: Sequence[Block]) -> Block:
    """Return the controller with some filters and a law, without braking."""
    sensed = [*motion.sensing_blocks(plant, TIME, control.BANDWIDTH), *filters]
    return loops.rounded_controller(plant, TIME, sensed, [*law, motion.delay(plant, TIME)])


def without_filter(axis: str) -> list[Block]:
    """Return the filters; that of one axis outputs its raw position."""
    return [
        replace(b, output={**b.output, axis: b.symbol[f"{axis}_raw"]}) if axis in b.output else b
        for b in control.filters()
    ]


contents = partial(page.extra, of_plant)
