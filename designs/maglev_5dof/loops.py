"""The five loops as they ship: the rounded controller, one sample of delay, the hold, and the plant at a gap.

    encoders --> [ pose ] --> y, phi, theta --x--> [ gaps ] --> held gaps --> [ law ]
                                              |--> [ errors, filters, regulators ] --^

The law takes each motor's own held gap. Gaps are made of the pose here, which changes nothing, so that a loop that is
opened at x has all that the controller does with the position in it, the compensation of the magnets' and the guides'
stiffness too: a delay there is a delay of the hardware.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import casadi as ca
import numpy as np

from designs.maglev_5dof import control
from designs.maglev_5dof.experiments import WIRES
from models import maglev_stage
from synth.analyse import linearise, loop, margins, trim
from synth.block import Block, Exprs, Step, build
from synth.compose import compose
from synth.plant import Plant
from synth.signals import Signal
from synth.statespace import StateSpace

GAPS = (control.GAP[0], 0.025, control.GAP[1])  # m
HELD = tuple(f"y{j}_held" for j in range(1, 5))
WARP = Signal("warp", "m", -0.1, 0.1, "what y, phi and theta leave of the four gaps")


@dataclass(frozen=True, eq=False)
class OpenLoop:
    """The loop of one axis at a gap in m, opened at its position, and its margins."""

    axis: str
    gap: float
    L: StateSpace
    margins: margins.Margins

    @property
    def signal(self) -> str:
        """The position at which it is opened."""
        return self.axis

    @property
    def label(self) -> str:
        """The gap, for a plot."""
        return f"{self.gap * 1e3:.4g} mm"


def holding(plant: Plant, gap: float) -> trim.OperatingPoint:
    """Return the level platen at rest at a gap in m."""
    return trim.trim(plant, {"y": gap}, [f"i_d{j}" for j in range(1, 5)])


def opened(plant: Plant, gap: float, axis: str, scalar: type[np.floating] = np.float32) -> OpenLoop:
    """Open the loop of `axis` at its measured position, the other four closed."""
    signal, point = next(a.position.name for a in control.AXES if a.name == axis), holding(plant, gap)
    parts = loop.cut(posed(plant), signal)
    inputs = [s.name for s in control.INTERFACE.inputs]
    outputs = [*(s.name for s in control.OUTPUTS), f"{signal}_out"]
    block = compose(control.NAME, parts, inputs=[*inputs, signal], outputs=outputs).rounded(scalar)
    at = dict.fromkeys((*inputs, signal), 0.0) | {f"y{j}": gap for j in range(1, 5)} | {"y_ref": gap}
    at[signal] = gap if axis == "y" else 0.0
    controller = loop.linearised(block, resting(point), at)
    sensors = {s.name: s.of for s in control.INTERFACE.sensors}
    wires = {plant_input: str(output) for plant_input, output in WIRES.items()}
    L = loop.opened(linearise.linearise(plant, point), controller, signal, sensors, wires)
    return OpenLoop(axis, gap, L, margins.of_loop(L))


def resting(point: trim.OperatingPoint) -> Mapping[str, float]:
    """Return the states of the controller that holds the plant at `point`, those that are not as after `init`."""
    return {"guard_ready": 1.0} | {f"safe_output_last_{s.name}": point[s.name] for s in control.CURRENTS}


def posed(plant: Plant) -> list[Block]:
    """Return the Blocks of the controller, whose law takes the gaps by way of the pose and one more coordinate."""
    parts = [b for b in control.controller(plant).parts if b.name != "kinematics"]
    for name in HELD:
        parts = list(loop.cut(parts, name))
    r = ca.SX(plant.parameter("r").value)
    positions = [a.position for a in control.AXES if a.name in ("y", "phi", "theta")]
    read = [Signal(f"{name}_out", "m", 0.0, 0.1) for name in HELD]
    made = [Signal(name, "m", 0.0, 0.1) for name in HELD]

    def pose(u: Exprs, x: Exprs, k: Exprs) -> Step:
        y1, y2, y3, y4 = (u[s.name] for s in read)
        return Step({**maglev_stage.kinematics(y1, y2, y3, y4, r), "warp": (y1 - y2 + y3 - y4) / 4})

    def gaps(u: Exprs, x: Exprs, k: Exprs) -> Step:
        level = maglev_stage.gaps(u, {"r": r})
        return Step({name: g - (-1) ** j * u["warp"] for j, (name, g) in enumerate(zip(HELD, level, strict=True), 1)})

    back = build("pose", control.TIME, pose, inputs=read, outputs=[*positions, WARP], tag="F(5) inverted")
    forth = build("gaps", control.TIME, gaps, inputs=[*positions, WARP], outputs=made, tag="F(5)")
    return [*parts, back, forth]


def all_loops(plant: Plant, scalar: type[np.floating] = np.float32) -> list[OpenLoop]:
    """Return the five loops at each gap."""
    return [opened(plant, gap, axis.name, scalar) for axis in control.AXES for gap in GAPS]
