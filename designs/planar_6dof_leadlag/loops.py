"""The lead-lag controller's loops: as shipped, as printed, and as printed but on positions that nothing filters.

The paper's crossovers and margins are those of the third kind: (21), (22) without the filters (6)-(16).
"""

from collections.abc import Sequence
from dataclasses import replace

from designs.planar_6dof import filtering
from designs.planar_6dof import loops as shared
from designs.planar_6dof.loops import OpenLoop
from designs.planar_6dof_leadlag import control
from designs.planar_6dof_leadlag.control import TIME
from models import hall_sections as sensing
from models.planar_allocation import AXES, HORIZONTAL
from synth.block import Block
from synth.plant import Plant


def all_loops(plant: Plant) -> list[OpenLoop]:
    """Return the six loops of each kind; what is printed of one axis is closed with the others as shipped."""
    shipped, printed = control.law(plant), control.law(plant, "published")
    opened = shared.of_block(plant, whole(plant, filtering.blocks(TIME), shipped), AXES, "as shipped")
    for axis in AXES:
        law = shared.exchanged(shipped, printed, axis)
        opened += shared.of_block(plant, whole(plant, filtering.blocks(TIME), law), [axis], "as printed")
        if axis in HORIZONTAL:
            opened += shared.of_block(plant, whole(plant, unfiltered(axis), law), [axis], "as printed, unfiltered")
    return opened


def whole(plant: Plant, filters: Sequence[Block], law: Sequence[Block]) -> Block:
    """Return the controller of filters and a law."""
    return shared.whole(plant, TIME, [sensing.sensing(plant, TIME), *filters], law)


def unfiltered(axis: str) -> list[Block]:
    """Return the filters, of which that of one axis passes its raw position on and predicts as before."""
    return [
        replace(b, output={**b.output, axis: b.symbol[f"{axis}_raw"]}) if axis in b.output else b
        for b in filtering.blocks(TIME)
    ]
