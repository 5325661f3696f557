"""What both controllers of the planar positioner have around their laws: inputs, outputs and what happens on a fault.

Hall voltages, distances, set-points -> guard -> sensing, filters, heights -> law -> safe output -> phase currents
"""

from collections.abc import Sequence
from dataclasses import replace

from designs.planar_6dof import allocation, filtering, sensing, vertical
from models import planar_stage
from synth.block import Block
from synth.compose import compose
from synth.plant import Plant
from synth.signals import Signal, names
from synth.synthesise import safety
from synth.timing import Discrete

BAD_SAMPLES = 5
SLEW = 126.0  # A/s: from the limit to 0 in 10 ms, three times L/R, for which a winding needs 2 V beside its 6.3 V
_VOLTAGES = [Signal(n, "V", -sensing.VOLTAGE, sensing.VOLTAGE, "Hall sensor and axis") for n in planar_stage.HALL]
_DISTANCES = [replace(s, name=s.name.removesuffix("_held")) for s in vertical.DISTANCES]
_SET_POINTS = [replace(s, name=s.name.removesuffix("_held")) for s in vertical.REFERENCES.values()]
INPUTS = (
    *(safety.Guarded(s, 0.0, True) for s in (*_VOLTAGES, *_DISTANCES)),
    *(safety.Guarded(s, 0.0, False) for s in _SET_POINTS),
)
OUTPUTS = allocation.PHASES
SAFETY = safety.Safety(
    BAD_SAMPLES,
    dict.fromkeys(names(OUTPUTS), 0.0),
    dict.fromkeys(names(OUTPUTS), SLEW),
    "the air bearings carry the platen, and without current nothing pushes it",
)


def blocks(plant: Plant, time: Discrete, law: Sequence[Block]) -> list[Block]:
    """Return the Blocks of a controller whose `law` goes from positions and held set-points to computed currents."""
    guard = safety.guard(time, INPUTS, BAD_SAMPLES, suspected=planar_stage.HALL)
    seen = [sensing.sensing(plant, time), *filtering.blocks(time), vertical.heights(plant, time)]
    return [guard, *seen, *law, safety.safe_output(time, OUTPUTS, SAFETY)]


def controller(name: str, plant: Plant, time: Discrete, law: Sequence[Block]) -> Block:
    """Return the whole controller, from six Hall voltages, three distances and six set-points to nine currents."""
    inputs, outputs = [g.signal.name for g in INPUTS], names(OUTPUTS)
    return safety.frozen(compose(name, blocks(plant, time, law), inputs=inputs, outputs=outputs))
