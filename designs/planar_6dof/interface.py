"""What surrounds the laws of the planar positioner: sensors, set-points, amplifiers, and what happens on a fault.

Hall voltages, distances, set-points -> guard -> sensing, positions, heights -> law -> safe output -> phase currents

Noise of the Hall sensors is white and given as that of a position read from one of them: a deviation s in m is one of
s A w in V, with the fundamental's amplitude A in V and its wave number w in 1/m. Where a voltage is 0 the harmonics
make it 22 % flatter than that, and the raw position noisier than s.
"""

from collections.abc import Callable, Mapping, Sequence
from functools import partial

import numpy as np

from designs.planar_6dof import vertical
from models import hall_calibration, planar_stage
from models import hall_sections as sensing
from synth import stage
from synth.block import Block
from synth.declaration import Actuator, Composition, Controller, Sensor, SetPoint
from synth.plant import Plant
from synth.signals import names
from synth.timing import Discrete

NOISE, NOISE_PRINTED = 13e-6, 5e-5  # m: a third of the peaks of +-4e-5 m in Fig. 5(a); what section 3.2 says
LASER_NOISE = 2e-7  # m, not printed
RANGE, BITS = 20.0, 16  # V, section 4.2
ADC = RANGE / 2**BITS
LASER_RESOLUTION = 2 * vertical.LASER / 2**BITS  # m: the range of a distance over the converter's
BAD_SAMPLES = 5
SLEW = 126.0  # A/s: from the limit to 0 in 10 ms, three times L/R, for which a winding needs 2 V beside its 6.3 V
# Relative, of polynomials, all of which are in allocation and commutation. In single precision they turn a motor's
# current by 9 urad of its pitch at most, as 0.07 um of position would, where the raw position is wrong by 4.3 um rms.
SURROGATE_ERROR: Mapping[type[np.floating], float] = {np.float32: 2e-5, np.float64: 1e-14}


VOLTS_PER_METRE = hall_calibration.of(planar_stage.plant()).volts_per_metre  # of the fundamental where it is 0
_HALL = partial(Sensor, resolution=ADC, noise=NOISE * VOLTS_PER_METRE, held=False)
_LASER = partial(Sensor, resolution=LASER_RESOLUTION, noise=LASER_NOISE)
INTERFACE = stage.interface(
    planar_stage.plant(),
    sensors=[
        *(
            _HALL(name, low=-sensing.VOLTAGE, high=sensing.VOLTAGE, about=planar_stage.ABOUT[name])
            for name in planar_stage.HALL
        ),
        *(
            _LASER(name, low=-vertical.LASER, high=vertical.LASER, about=planar_stage.ABOUT[name])
            for name in planar_stage.LASERS
        ),
    ],
    set_points=[SetPoint(f"{a}_ref", a, s.low, s.high, about=s.about) for a, s in vertical.REFERENCES.items()],
    actuators=[Actuator(name, safe=0.0, slew_per_s=SLEW) for name in names(planar_stage.INPUTS)],
    bad_samples=BAD_SAMPLES,
    reason="the air bearings carry the platen, and without current nothing pushes it",
    suspected=planar_stage.HALL,
)
SENSORS = tuple(s.name for s in INTERFACE.sensors)
INPUTS, OUTPUTS = stage.guarded(INTERFACE), INTERFACE.outputs


def controller(name: str, plant: Plant, time: Discrete, sensing_blocks: Sequence[Block], law: Sequence[Block]) -> Block:
    """Return the whole controller, from six Hall voltages, three distances and six set-points to nine currents.

    `sensed` go from held voltages to positions, `law` from positions and held set-points to computed currents.
    """
    return stage.controller(
        name, time, INTERFACE, [*sensing_blocks, vertical.vertical_kinematics(plant, time), *law]
    ).block


def declare_controller(name: str, time: Discrete, block: Callable[[], Block]) -> Controller:
    """Return a controller of this interface as it is declared; its Block is made when it is first asked for."""
    return Controller(name, time, INTERFACE, lambda: Composition((), (), block()))
