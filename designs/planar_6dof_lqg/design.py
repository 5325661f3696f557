"""The planar positioner of Yu and Kim under its reduced-order LQG controller at 800 Hz, from physics to verified C."""

from collections.abc import Mapping
from functools import cache, partial

from designs.planar_6dof import assembly, lqg
from designs.planar_6dof.paper import rows
from designs.planar_6dof.random_steps import Columns, Subject
from designs.planar_6dof_lqg import experiments, gains, page, reference
from models import planar_stage
from models.planar_allocation import HORIZONTAL
from synth.block import Block
from synth.statespace import Array


def at_rest(block: Block, pose: Mapping[str, Array]) -> Columns:
    """Return x3 (N,) of platens at rest: it is less L times the position, as large as 50 times what the motors meet."""
    L = {c.name: c.value for c in block.constants}
    return {f"lqg_{axis}_x3": -L[f"lqg_{axis}_L"] * pose[axis] for axis in HORIZONTAL}


@cache
def subject() -> Subject:
    """Return the controller beside its reference."""
    block = lqg.controller(planar_stage.plant())
    return Subject(block, reference.step, size=0.1, step=0.06, at_rest=partial(at_rest, block))


DESIGN = assembly.design(lqg.NAME, lqg.TIME, subject, gains.gains, experiments.ALL, rows.lqg, page.report)
