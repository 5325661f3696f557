"""Loops of the LQG controller: as shipped, with the printed weights (47), and (33) as printed; and the gain (42).

    as shipped        K of (49), prediction of the effect of the last currents, allocation of Table 3
    weights (47)      the same with K by lqrd for the printed weights
    (33) as printed   K of (49) with the observer (33) alone, from ideal positions directly to i_AQ, i_BQ, i_CQ

The third has the observer poles as shipped, which the paper does not print, and one sample of delay like the others. No
observer exists with the gain (42).
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from designs.planar_6dof import loops as shared
from designs.planar_6dof import lqg
from designs.planar_6dof.allocation import AXES, HORIZONTAL
from designs.planar_6dof.loops import LoopParts, OpenLoop
from designs.planar_6dof.lqg import CURRENTS, STATES, TIME, Axis
from designs.planar_6dof.paper import rows
from designs.planar_6dof_lqg import core
from synth.analyse import discretise
from synth.block import Block
from synth.errors import ModelError
from synth.plant import Plant
from synth.statespace import Array, StateSpace, readonly
from synth.synthesise.observers import reduced_observer

SHIPPED, REWEIGHTED, PRINTED = "as shipped", "weights (47)", "(33) as printed"
ROW = {"x": 2, "y": 1, "phi": 1}  # of K in which an axis has its gains


def all_loops(plant: Plant) -> list[OpenLoop]:
    """Return the six loops of each kind; another kind of one axis is closed with the other axes as shipped."""
    shipped, printed = lqg.law(plant), lqg.law(plant, variant="published")
    open_loops = shared.of_block(plant, whole(plant, shipped), AXES, SHIPPED)
    for axis in AXES:
        other, label = (law_of_printed_weights(plant), REWEIGHTED) if axis in HORIZONTAL else (printed, "as printed")
        open_loops += shared.of_block(plant, whole(plant, shared.with_axis_of(shipped, other, axis)), [axis], label)
    return open_loops + shared.of_parts(parts_as_in_the_paper(plant), HORIZONTAL, PRINTED)


def horizontals(plant: Plant) -> dict[str, dict[str, StateSpace]]:
    """Return the loop of x, y and phi of each kind."""
    laws = {SHIPPED: lqg.law(plant), REWEIGHTED: law_of_printed_weights(plant)}
    both = {label: shared.parts(plant, whole(plant, law)) for label, law in laws.items()}
    return {label: shared.horizontal(each) for label, each in (both | {PRINTED: parts_as_in_the_paper(plant)}).items()}


def whole(plant: Plant, law: Sequence[Block]) -> Block:
    """Return the controller of a law on measured positions."""
    return shared.rounded_controller(plant, TIME, lqg.sensing_blocks(plant), law)


def law_of_printed_weights(plant: Plant) -> list[Block]:
    """Return the law with the gains by lqrd for the weights (47)."""
    law = lqg.law(plant)
    for axis in lqg.axes(plant):
        law = shared.with_axis_of(law, [lqg.reduced_order(plant, _axis_of_printed_weights(axis))], axis.name)
    return law


def _axis_of_printed_weights(axis: Axis) -> Axis:
    i = STATES.index(axis.name)
    rows = (lqg.gain(w).K[ROW[axis.name]] for w in (lqg.PRINTED_WEIGHTS, lqg.WEIGHTS))
    k1, k3, k2 = (float(a[n] / b[n]) for a, b in [tuple(rows)] for n in (i, 3 + i, 6 + i))
    return replace(axis, k1=k1 * axis.k1, k2=k2 * axis.k2, k3=k3 * axis.k3)


def parts_as_in_the_paper(plant: Plant) -> LoopParts:
    """Return the horizontal stage under (33) with K of (49), which neglects the yaw torque of motor C."""
    stage = shared.parts(plant, whole(plant, lqg.law(plant))).plant
    return LoopParts(stage.select(HORIZONTAL, CURRENTS), core.compensator().model)


def gain_of_42() -> Array:
    """Return H (3, 6) of (42), on x, y, phi, z1, z2, z3."""
    diagonal, other, integral = (rows.published_rows()["Y-12"][name].value for name in ("own", "other", "integral"))
    return readonly(np.hstack([other + (diagonal - other) * np.eye(3), integral * np.eye(3)]))


def rejection_message() -> str:
    """Return the error message of the library for an observer with the gain of (42).

    Raises ModelError when the library accepts it.
    """
    held = discretise.zero_order_hold(lqg.model(), TIME.period_s)
    try:
        reduced_observer.from_gain(held, STATES[:6], gain_of_42())
    except ModelError as error:
        return str(error)
    raise ModelError("an observer with the gain of (42) was accepted: its poles decay, so the report is wrong")
