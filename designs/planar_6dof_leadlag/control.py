"""The lead-lag controller of the planar positioner at 1 kHz, Y(21)-(25), as Blocks.

    x, y, phi, z, theta, psi ----+
                                 v -
    set-points ---------------->(+)---> six loops ---> allocation ---> commutation ---> nine phase currents
                                            ^              |
                                            +-- achieved --+

The set-points' loops work on filtered positions. `motion` predicts x, y and phi from the achieved demands, which act a
sample later; it bridges bad samples and brakes before the latch. The filters cannot: they do not know the demands, and
learn the motion that a stuck channel shows.

published   (21), (22) as printed
shipped     (21), (22) with reduced gains; for (23)-(25) see `vertical`

Compensators are sampled by Tustin's rule. Margins with the filters (6)-(16): docs/decisions/planar_leadlag.md.
"""

from designs.planar_6dof import allocation, filtering, interface, motion, vertical
from designs.planar_6dof.sensing import sections as sensing
from designs.planar_6dof.vertical import Variant
from synth.block import Block
from synth.plant import Plant
from synth.synthesise.classical import lead_lag
from synth.timing import Discrete

NAME = "planar_6dof_leadlag"
TIME = Discrete(1e-3)
PUBLISHED = {"x": (1.5e4, 0.11), "y": (1.5e4, 0.11), "phi": (35.0, 0.12)}  # gain, lead in s
# rad/s, of the prediction. With 20 rad/s a channel that sticks teaches so much of a force that 0.052 m/s are left.
BANDWIDTH = {"x": 48.0, "y": 48.0, "phi": 8.0, "force": 16.0}
LAG, RESET = 0.00088, 0.1  # s, of (21) and (22)
GAIN_SHARE = {"x": 0.4, "y": 0.4, "phi": 0.5}  # of the published gain


def compensator(axis: str, variant: Variant = "shipped") -> lead_lag.Compensator:
    """Return the continuous compensator of x, y or phi, from m to N or rad to N m. Source: (21), (22)."""
    gain, lead = PUBLISHED[axis]
    gain *= GAIN_SHARE[axis] if variant == "shipped" else 1
    return lead_lag.from_time_constants(gain, (lead, RESET), (LAG,), 1)


def loops(variant: Variant = "shipped") -> dict[str, lead_lag.LeadLag]:
    """Return the compensators of all six axes, sampled."""
    horizontal = {axis: compensator(axis, variant) for axis in allocation.HORIZONTAL}
    return vertical.sampled(horizontal, TIME) | vertical.loops(TIME, variant)


def law(plant: Plant, variant: Variant = "shipped") -> list[Block]:
    """Return the Blocks from positions and held set-points to computed phase currents."""
    six = [vertical.block(plant, axis, K, TIME) for axis, K in loops(variant).items()]
    return [*six, allocation.allocation(plant, TIME), allocation.commutation(plant, TIME)]


def filters() -> list[Block]:
    """Return the filters of x, y and phi. Sensing takes the predictions of `motion` instead of theirs."""
    return [b.renamed({s.name: f"filter_{s.name}" for s in sensing.PREDICTED.values()}) for b in filtering.blocks(TIME)]


def controller(plant: Plant, variant: Variant = "shipped") -> Block:
    """Return the whole controller, from Hall voltages, distances and set-points to the motors' phase currents."""
    sensed = [*motion.sensing_blocks(plant, TIME, BANDWIDTH), *filters()]
    blocks = [*motion.add_braking(plant, TIME, law(plant, variant), BANDWIDTH), motion.delay(plant, TIME)]
    return interface.controller(NAME, plant, TIME, sensed, blocks, interface.BRAKED)
