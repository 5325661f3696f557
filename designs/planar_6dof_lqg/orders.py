"""What the reduced order saves: instructions of a step on an emulated Cortex-M4F, of the cores and of the controllers.

Both orders answer the same recorded inputs, those of the shipped controller at rest; the cores alone get small errors.
"""

from collections.abc import Iterator, Sequence

import numpy as np

from designs.planar_6dof import interface, lqg
from designs.planar_6dof.page import REST
from designs.planar_6dof_lqg import core
from designs.planar_6dof_lqg.full_order import REGULATORS, Order
from models import planar_stage
from models.planar_allocation import HORIZONTAL
from synth.block import Block
from synth.emit import write
from synth.execute import host
from synth.report import page
from synth.simulate.experiment import Experiment
from synth.verify import operations
from synth.verify.agree import Columns

ORDERS: tuple[Order, ...] = ("reduced", "full")
STEPS, SKIPPED = 200, 100
ERROR = 1e-6  # m, rad: of what a core is given


def spent(experiments: Sequence[Experiment]) -> tuple[page.Block, ...]:
    """Return what both orders cost, by each compiler that is installed; nothing without a standstill to replay."""
    rest = [e.trajectory.measured for e in experiments if e.name == REST]
    rows = [row for measured in rest[:1] for row in _rows(measured)]
    columns = ("step", "order", "states", "operations", "build", "instructions, mean", "instructions, most")
    caption = f"The full order beside the reduced one: {STEPS} steps at rest, Cortex-M4F"
    return (page.Table(caption, columns, tuple(rows)),) if rows else ()


def _rows(measured: Columns) -> Iterator[tuple[page.Cell, ...]]:
    part = slice(SKIPPED, SKIPPED + STEPS)
    at_rest = {name: np.asarray(v)[part] for name, v in measured.items()}
    small = {axis: ERROR * np.sin(np.arange(STEPS) + i) for i, axis in enumerate(HORIZONTAL)}
    for order in ORDERS:
        yield from _counted("core alone, (33) and (40)", order, core.block(order), small)
    for order in ORDERS:
        yield from _counted(
            "whole controller", order, lqg.controller(planar_stage.plant(), regulate=REGULATORS[order]), at_rest
        )


def _counted(what: str, order: Order, block: Block, inputs: Columns) -> Iterator[tuple[page.Cell, ...]]:
    from synth.verify import meter, rivals, steps  # needs the extra `target`

    emitted = write.emit(block, np.float32, error=interface.SURROGATE_ERROR[np.float32])
    recorded = steps.recorded(host.load(emitted.files, emitted.manifest), "at rest", dict(inputs), closed_loop=True)
    assert emitted.program is not None
    arithmetic = sum(operations.of_program(emitted.program).values())
    for build in meter.builds():
        n = meter.run(rivals.emitted(emitted), recorded, build).cost.instructions
        yield what, order, len(block.states), arithmetic, build.name, float(n.mean()), int(n.max())
