"""The five loops as they ship: the rounded controller, one sample of delay, the hold, and the plant at a gap."""

from dataclasses import dataclass

import numpy as np

from designs.maglev_5dof import control
from designs.maglev_5dof.loop import ACTUATORS, SENSORS
from synth.analyse import linearise, loop, margins, trim
from synth.compose import compose
from synth.plant import Plant
from synth.statespace import StateSpace

INSIDE = 1e-6  # m: at the very edge the pose is clipped, and a derivative there has two sides
GAPS = (control.GAP[0] + INSIDE, 0.025, control.GAP[1] - INSIDE)  # m


@dataclass(frozen=True, eq=False)
class OpenLoop:
    """The loop of one axis at a gap in m, opened at its position, and its margins."""

    axis: str
    gap: float
    L: StateSpace
    margins: margins.Margins


def level(plant: Plant, gap: float) -> StateSpace:
    """Return the plant linearised about the level platen at a gap in m, under its holding currents."""
    currents = [f"i_d{j}" for j in range(1, 5)]
    return linearise.linearise(plant, trim.trim(plant, {"y": gap}, currents))


def opened(plant: Plant, gap: float, axis: str, scalar: type[np.floating] = np.float32) -> OpenLoop:
    """Open the loop of `axis` at its measured position, the other four closed.

    All that the controller does with the position lies in the loop, the compensation in F(12) of the magnets' and the
    guides' stiffness too: a delay there is a delay of the hardware.
    """
    signal = next(a.position.name for a in control.AXES if a.name == axis)
    parts = loop.cut(control.blocks(plant), signal)
    inputs = [g.signal.name for g in control.INPUTS]
    outputs = [*(s.name for s in control.OUTPUTS), f"{signal}_out"]
    block = compose(control.NAME, parts, inputs=[*inputs, signal], outputs=outputs).rounded(scalar)
    at = dict.fromkeys((*inputs, signal), 0.0) | {f"y{j}": gap for j in range(1, 5)} | {"y_ref": gap}
    at[signal] = gap if axis == "y" else 0.0
    controller = loop.linearised(block, {"guard_ready": 1.0}, at)
    actuators = {plant_input: str(output) for plant_input, output in ACTUATORS.items()}
    L = loop.opened(level(plant, gap), controller, signal, SENSORS, actuators)
    return OpenLoop(axis, gap, L, margins.of_loop(L))


def all_loops(plant: Plant, scalar: type[np.floating] = np.float32) -> list[OpenLoop]:
    """Return the five loops at each gap."""
    return [opened(plant, gap, axis.name, scalar) for axis in control.AXES for gap in GAPS]
