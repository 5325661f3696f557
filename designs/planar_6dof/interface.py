"""What both controllers of the planar positioner have around their laws: inputs, outputs and what happens on a fault.

Hall voltages, distances, set-points -> guard -> sensing, positions, heights -> law -> safe output -> phase currents
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from designs.planar_6dof import allocation, sensing, vertical
from models import planar_stage
from synth.block import Block
from synth.blocks import safety
from synth.compose import compose
from synth.plant import Plant
from synth.signals import Signal, names
from synth.timing import Discrete

BAD_SAMPLES = 5
SLEW = 126.0  # A/s: from the limit to 0 in 10 ms, three times L/R, for which a winding needs 2 V beside its 6.3 V
_VOLTAGES = [Signal(n, "V", -sensing.VOLTAGE, sensing.VOLTAGE, "Hall sensor and axis") for n in planar_stage.HALL]
_DISTANCES = [replace(s, name=s.name.removesuffix("_held")) for s in vertical.DISTANCES]
_SET_POINTS = [replace(s, name=s.name.removesuffix("_held")) for s in vertical.REFERENCES.values()]
INPUTS = (
    *(safety.Guarded(s, 0.0, True, held=False) for s in _VOLTAGES),
    *(safety.Guarded(s, 0.0, True) for s in _DISTANCES),
    *(safety.Guarded(s, 0.0, False) for s in _SET_POINTS),
)
OUTPUTS = allocation.PHASES
# Relative, of polynomials, all of which are in allocation and commutation. In single precision they turn a motor's
# current by 9 urad of its pitch at most, as 0.07 um of position would, where the raw position is wrong by 4.3 um rms.
SURROGATE_ERROR = {np.float32: 2e-5, np.float64: 1e-14}
SAFETY = safety.Safety(
    BAD_SAMPLES,
    dict.fromkeys(names(OUTPUTS), 0.0),
    dict.fromkeys(names(OUTPUTS), SLEW),
    "the air bearings carry the platen, and without current nothing pushes it",
)


def controller(name: str, plant: Plant, time: Discrete, sensed: Sequence[Block], law: Sequence[Block]) -> Block:
    """Return the whole controller, from six Hall voltages, three distances and six set-points to nine currents.

    `sensed` go from held voltages to positions, `law` from positions and held set-points to computed currents.
    """
    guard = safety.guard(time, INPUTS, BAD_SAMPLES, suspected=planar_stage.HALL)
    parts = [guard, *sensed, vertical.heights(plant, time), *law, safety.safe_output(time, OUTPUTS, SAFETY)]
    inputs, outputs = [g.signal.name for g in INPUTS], names(OUTPUTS)
    return safety.frozen(compose(name, parts, inputs=inputs, outputs=outputs))
