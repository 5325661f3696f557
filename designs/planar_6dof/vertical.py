"""Lead-lag control of the vertical axes z, theta, psi, from three laser distances to demands, (23)-(25).

    [d1]   [1  -r   r] [z    ]       d1..d3 --->[ kinematics ]-> z, theta, psi --+
    [d2] = [1  -r  -r] [theta]                                                   v -
    [d3]   [1   r   0] [psi  ]       set-points ------------------------------->(+)--->[ K(z) ]---> d_z, d_theta, d_psi

    published   K (s + a) (s + 10) / ((s + b) s), as printed
    shipped     the same zeros, the pole b at 2/T, and a reduced gain at low frequencies

Both are sampled by Tustin's rule; docs/decisions/planar_leadlag.md says why.

Each loop is that of `synth.blocks.laws.lead_lag`, all divided by the scale of the axis in `allocation`, so d is its
demand in A. Source: Yu, Kim, section 5.2, (19), (20), (23)-(25).
"""

from collections.abc import Mapping
from dataclasses import replace
from math import pi
from typing import Literal

from designs.planar_6dof import allocation
from designs.planar_6dof.allocation import ACHIEVED, AXES, BOX, DEMANDS
from models import planar_stage
from synth.block import Block, Exprs, Step, build
from synth.blocks.laws import lead_lag as lead_lag_block
from synth.law import label
from synth.plant import Plant
from synth.signals import Signal
from synth.synthesise.classical import lead_lag
from synth.timing import Discrete

Variant = Literal["shipped", "published"]

PUBLISHED = {
    "z": (323252.0, 102.91, 776.828),
    "theta": (900.0, 80.0413, 604.199),
    "psi": (1100.0, 80.0413, 604.199),
}
GAIN_SHARE = {"z": 0.65, "theta": 0.5, "psi": 0.15}  # of the published gain at low frequencies
RESET = 10.0  # rad/s
COMPARED = 2 * pi * 30  # rad/s, at which sampled and continuous compensators are compared
LASER = 5e-4  # m
DISTANCES = tuple(Signal(f"{name}_held", "m", -LASER, LASER, "laser distance") for name in planar_stage.LASERS)
MEASURED_RANGE = {"x": 0.4, "y": 0.4, "phi": 0.1, "z": LASER, "theta": 0.01, "psi": 0.01}  # m, rad
POSITIONS = {axis: replace(BOX[axis], low=-high, high=high) for axis, high in MEASURED_RANGE.items()}
DEMAND, ACHIEVED_DEMAND = (dict(zip(AXES, signals, strict=True)) for signals in (DEMANDS, ACHIEVED))  # of each axis
EQUATION = {"x": "21", "y": "21", "phi": "22", "z": "23", "theta": "24", "psi": "25"}
MARGIN = lead_lag_block.MARGIN
_QUANTITY = {
    "x": "position along X",
    "y": "position along Y",
    "phi": "yaw",
    "z": "height",
    "theta": "tilt about X",
    "psi": "tilt about Y",
}
REFERENCES = {
    axis: replace(BOX[axis], name=f"{axis}_ref_held", about=f"set-point of the {what}")
    for axis, what in _QUANTITY.items()
}
# The raw yaw is exact to first order: at (-16.8, 8.3) mm of a pitch 15 mrad are measured as 10.3 mrad. There a level
# platen loses its yaw loop beyond 10 mrad, and one tilted by 2 mrad already at 8 mrad.
REFERENCES["phi"] = replace(REFERENCES["phi"], low=-0.008, high=0.008)


def vertical_kinematics(plant: Plant, time: Discrete) -> Block:
    """Return the Block from the laser distances to z, theta and psi; tilts count to first order."""
    r = plant.parameter("laser_arm").value
    inverse = plant.constant("half_over_laser_arm", "1/m", lambda p: 1 / (2 * p["laser_arm"]))

    def law(u: Exprs, x: Exprs, k: Exprs) -> Step:
        left, right, rear = (u[s.name] for s in DISTANCES)
        front_distance = (left + right) / 2
        tilts = {"theta": (rear - front_distance) / (2 * r), "psi": (left - right) / (2 * r)}
        label(front_distance=front_distance)
        return Step({"z": (front_distance + rear) / 2} | tilts, numbers=[inverse])

    outputs = [POSITIONS[axis] for axis in ("z", "theta", "psi")]
    return build("vertical_kinematics", time, law, inputs=DISTANCES, outputs=outputs, tag="z and tilts from distances")


def compensator(axis: str, time: Discrete, variant: Variant = "shipped") -> lead_lag.Compensator:
    """Return the continuous compensator of z, theta or psi, from m to N or rad to N m. Source: (23)-(25)."""
    gain, zero, pole = PUBLISHED[axis]
    if variant == "shipped":
        new_pole = 2 / time.period_s
        gain, pole = GAIN_SHARE[axis] * gain * new_pole / pole, new_pole
    return lead_lag.Compensator(gain, (-zero, -RESET), (-pole, 0.0))


def sampled(continuous: Mapping[str, lead_lag.Compensator], time: Discrete) -> dict[str, lead_lag.LeadLag]:
    """Return compensators by axis, sampled by Tustin's rule."""
    return {axis: lead_lag.tustin(K, time.period_s, COMPARED) for axis, K in continuous.items()}


def loops(time: Discrete, variant: Variant = "shipped") -> dict[str, lead_lag.LeadLag]:
    """Return the compensators of z, theta and psi, sampled."""
    return sampled({axis: compensator(axis, time, variant) for axis in allocation.VERTICAL}, time)


def block(plant: Plant, axis: str, K: lead_lag.LeadLag, time: Discrete) -> Block:
    """Return the Block of one loop, from the position, the set-point and the achieved demand to the demand in A."""
    loop = lead_lag_block.Loop(
        POSITIONS[axis],
        REFERENCES[axis],
        DEMAND[axis],
        ACHIEVED_DEMAND[axis],
        allocation.scales(plant)[axis],
        allocation.achievable_bound(plant)[axis],
    )
    return lead_lag_block.block(f"loop_{axis}", time, K, loop, f"({EQUATION[axis]})")
