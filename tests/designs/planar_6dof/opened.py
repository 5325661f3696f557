"""The planar positioner's linear loops with the positions known: law, filters, a sample of delay, hold and plant."""

from collections.abc import Mapping, Sequence

import casadi as ca

from designs.planar_6dof import filtering, vertical
from models import planar_allocation as allocation
from models import planar_stage
from synth.analyse import linearise, loop, margins, trim
from synth.block import Block, Exprs, Step, build, clip
from synth.compose import compose
from synth.plant import Plant
from synth.signals import Signal, names
from synth.statespace import StateSpace
from synth.timing import Discrete

PLANT = planar_stage.plant()
REFERENCES = [s.name for s in vertical.REFERENCES.values()]
ACTUATORS = {s.name: s.name for s in planar_stage.INPUTS}


def passed(time: Discrete, wires: Mapping[str, str], unit: str) -> list[Block]:
    """Return Blocks that hand a signal on under another name, new name -> old name."""
    found = []
    for new, old in wires.items():

        def law(u: Exprs, x: Exprs, k: Exprs, new: str = new, old: str = old) -> Step:
            return Step({new: u[old]})

        before, after = (Signal(name, unit, -1e6, 1e6) for name in (old, new))
        found.append(build(f"pass_{new}", time, law, inputs=[before], outputs=[after]))
    return found


def pitched(within: Signal, time: Discrete) -> Block:
    """Return the Block from a position seen in the middle pitch, or in one beside it, to its place within the pitch."""
    position = Signal(f"{within.name[-1]}_seen", "m", -1e6, 1e6)
    l = within.high - within.low

    def law(u: Exprs, x: Exprs, k: Exprs) -> Step:
        q = u[position.name]
        q = ca.if_else(q > within.high, q - l, ca.if_else(q < within.low, q + l, q))
        return Step({within.name: clip(q, within)})

    return build(f"pitched_{position.name}", time, law, inputs=[position], outputs=[within])


def seen(plant: Plant, time: Discrete, filtered: bool) -> list[Block]:
    """Return what makes raw and filtered positions of those of the plant, ``x_seen`` ..; unfiltered they are one."""
    found = passed(time, {f"{d}_held": d for d in planar_stage.LASERS}, "m")
    found += passed(time, {name: f"{name}_computed" for name in ACTUATORS}, "A")
    found += [pitched(s, time) for s in allocation.WITHIN]
    for axis, unit in (("x", "m"), ("y", "m"), ("phi", "rad")):
        found += passed(time, {f"{axis}_raw": f"{axis}_seen"}, unit)
        found += [filtering.block(axis, time)] if filtered else passed(time, {axis: f"{axis}_raw"}, unit)
    return [*found, vertical.vertical_kinematics(plant, time)]


def ready(parts: Sequence[Block]) -> list[str]:
    """Return the flag that says whether every measurement has been good, where a Block reads it."""
    return ["ready"] if any("ready" in names(b.inputs) for b in parts) else []


def of_axis(law: Sequence[Block], time: Discrete, axis: str, filtered: bool, delay: float = 1) -> StateSpace:
    """Return the loop opened at a position as it is measured, the other five closed."""
    signal = f"{axis}_raw" if axis in allocation.HORIZONTAL else axis
    parts = loop.cut([*seen(PLANT, time, filtered), *law], signal)
    sensors = {f"{a}_seen": a for a in allocation.HORIZONTAL} | {d: d for d in planar_stage.LASERS}
    inputs = [*sensors, *REFERENCES, *ready(parts), signal]
    block = compose("opened", parts, inputs=inputs, outputs=[*ACTUATORS, f"{signal}_out"])
    controller = loop.linearised(block, {}, dict.fromkeys(inputs, 0.0) | dict.fromkeys(ready(parts), 1.0))
    point = trim.trim(PLANT, dict.fromkeys(planar_stage.AXES, 0.0), [])
    return loop.opened(linearise.linearise(PLANT, point), controller, signal, sensors, ACTUATORS, delay)


def margins_of(law: Sequence[Block], time: Discrete, axis: str, filtered: bool, delay: float = 1) -> margins.Margins:
    """Return the margins of `of_axis`."""
    return margins.of_loop(of_axis(law, time, axis, filtered, delay))
