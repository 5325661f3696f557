"""The planar positioner's linear loops with the positions known: law, filters, a sample of delay, hold and plant."""

from collections.abc import Mapping, Sequence

import casadi as ca

from designs.planar_6dof import allocation, filtering, vertical
from models import planar_stage
from synth.analyse import operating_points
from synth.analyse.loops import loop, stability_margins
from synth.block import Block, Exprs, Step, build, clip
from synth.composition import compose
from synth.plant import Plant
from synth.signals import Signal, signal_names
from synth.statespace import StateSpace
from synth.timing import Discrete

PLANT = planar_stage.plant()
REFERENCES = [s.name for s in vertical.REFERENCES.values()]
ACTUATORS = {s.name: s.name for s in planar_stage.INPUTS}


def renaming_blocks(time: Discrete, wires: Mapping[str, str], unit: str) -> list[Block]:
    """Return Blocks that hand a signal on under another name, new name -> old name."""
    blocks = []
    for new, old in wires.items():

        def law(u: Exprs, x: Exprs, k: Exprs, new: str = new, old: str = old) -> Step:
            return Step({new: u[old]})

        before, after = (Signal(name, unit, -1e6, 1e6) for name in (old, new))
        blocks.append(build(f"pass_{new}", time, law, inputs=[before], outputs=[after]))
    return blocks


def place_in_pitch(within: Signal, time: Discrete) -> Block:
    """Return the Block from a position seen in the middle pitch, or in one beside it, to its place within the pitch."""
    position = Signal(f"{within.name[-1]}_seen", "m", -1e6, 1e6)
    l = within.high - within.low

    def law(u: Exprs, x: Exprs, k: Exprs) -> Step:
        q = u[position.name]
        q = ca.if_else(q > within.high, q - l, ca.if_else(q < within.low, q + l, q))
        return Step({within.name: clip(q, within)})

    return build(f"pitched_{position.name}", time, law, inputs=[position], outputs=[within])


def sensing_blocks(plant: Plant, time: Discrete, filtered: bool) -> list[Block]:
    """Return what makes raw and filtered positions of those of the plant, ``x_seen`` ..; unfiltered they are one."""
    blocks = renaming_blocks(time, {f"{d}_held": d for d in planar_stage.LASERS}, "m")
    blocks += renaming_blocks(time, {name: f"{name}_computed" for name in ACTUATORS}, "A")
    blocks += [place_in_pitch(s, time) for s in allocation.WITHIN]
    for axis, unit in (("x", "m"), ("y", "m"), ("phi", "rad")):
        blocks += renaming_blocks(time, {f"{axis}_raw": f"{axis}_seen"}, unit)
        blocks += [filtering.block(axis, time)] if filtered else renaming_blocks(time, {axis: f"{axis}_raw"}, unit)
    return [*blocks, vertical.vertical_kinematics(plant, time)]


def ready(parts: Sequence[Block]) -> list[str]:
    """Return the flag that says whether every measurement has been good, where a Block reads it."""
    return ["ready"] if any("ready" in signal_names(b.inputs) for b in parts) else []


def of_axis(law: Sequence[Block], time: Discrete, axis: str, filtered: bool, delay: float = 1) -> StateSpace:
    """Return the loop opened at a position as it is measured, the other five closed."""
    signal = f"{axis}_raw" if axis in allocation.HORIZONTAL else axis
    parts = loop.cut([*sensing_blocks(PLANT, time, filtered), *law], signal)
    sensors = {f"{a}_seen": a for a in allocation.HORIZONTAL} | {d: d for d in planar_stage.LASERS}
    inputs = [*sensors, *REFERENCES, *ready(parts), signal]
    block = compose("opened", parts, inputs=inputs, outputs=[*ACTUATORS, f"{signal}_out"])
    controller = loop.linearise_block(block, {}, dict.fromkeys(inputs, 0.0) | dict.fromkeys(ready(parts), 1.0))
    point = operating_points.trim(PLANT, dict.fromkeys(planar_stage.AXES, 0.0), [])
    return loop.open_loop(operating_points.linearise(PLANT, point), controller, signal, sensors, ACTUATORS, delay)


def margins_of(
    law: Sequence[Block], time: Discrete, axis: str, filtered: bool, delay: float = 1
) -> stability_margins.Margins:
    """Return the margins of `of_axis`."""
    return stability_margins.of_loop(of_axis(law, time, axis, filtered, delay))
