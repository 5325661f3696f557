"""Interface of the planar controllers: sensors, set-points, actuators, fault reaction, and the chain of Blocks.

Hall voltages, distances, set-points -> guard -> sensing, vertical kinematics -> law -> safe output -> phase currents

The noise of the Hall sensors is white and given as position noise: a standard deviation s in m is s A w in V, with the
amplitude A in V and wave number w in 1/m of the fundamental. At the zeros of a voltage the harmonics reduce its slope
by 22 %, so the raw position is noisier than s.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np

from designs.planar_6dof import vertical
from designs.planar_6dof.sensing import calibration
from designs.planar_6dof.sensing import sections as sensing
from models import planar_stage
from synth import stage
from synth.block import Block
from synth.declare.stage import Actuator, Composition, Controller, Interface, Sensor, SetPoint
from synth.plant import Plant
from synth.signals import signal_names
from synth.statespace import Array
from synth.timing import Discrete

NOISE, NOISE_PRINTED = 13e-6, 5e-5  # m: a third of the peaks of +-4e-5 m in Fig. 5(a); the value of section 3.2
LASER_NOISE = 2e-7  # m, not printed
RANGE, BITS = 20.0, 16  # V, section 4.2
HALL_OFFSET, HALL_GAIN_ERROR = 5e-3, 5e-3  # V, and of the sensitivity: largest errors of a channel, not printed
ADC = RANGE / 2**BITS
LASER_RESOLUTION = 2 * vertical.LASER / 2**BITS  # m: the range of a distance over the converter's
BAD_SAMPLES = 5
BRAKING = 24  # samples
PITCHES = tuple(f"sensing_offset_{axis}" for axis in "xy")  # states that count whole pitches, in m
SUBSTEPS = 2  # of a sample: psi oscillates at 214 rad/s, 0.13 rad in half of 1.25 ms
SLEW = 126.0  # A/s: from the limit to 0 in 10 ms, three times L/R; a winding needs 2 V for it beside R i = 6.3 V
# Relative error of the polynomials, which only occur in allocation and commutation. In single precision it rotates a
# motor's current by at most 9 urad of electrical angle, like 0.07 um of position. The raw position has 4.3 um rms.
SURROGATE_ERROR: Mapping[type[np.floating], float] = {np.float32: 2e-5, np.float64: 1e-14}


VOLTS_PER_METRE = calibration.of(planar_stage.plant()).volts_per_metre  # of the fundamental where it is 0
_HALL = partial(Sensor, resolution=ADC, noise=NOISE * VOLTS_PER_METRE, offset=HALL_OFFSET, gain_error=HALL_GAIN_ERROR)
_LASER = partial(Sensor, resolution=LASER_RESOLUTION, noise=LASER_NOISE)


@dataclass(frozen=True, eq=False)
class Subject:
    """A controller with the step function of its NumPy reference and the parameters of its random steps.

    `size` is the size of demands over what the motors can meet. `step` is a step of x in m that saturates the motors
    without an excessive yaw. `at_rest` returns the nonzero states (N,) of the law for platens at rest at positions
    (N,).
    """

    block: Block
    reference: Callable[[Any, Any], tuple[Mapping[str, Any], Mapping[str, Any], Any]]
    size: float
    step: float
    at_rest: Callable[[Mapping[str, Array]], dict[str, Array]] = lambda pose: {}


def of_plant(plant: Plant, held: bool = False) -> Interface:
    """Return the interface to all Hall voltages of a plant; refused ones are replaced by the last good value if held.

    A voltage that is not held becomes 0.
    """
    hall = [s for s in plant.outputs if s.unit == "V"]
    volts = [_HALL(s.name, low=-sensing.VOLTAGE, high=sensing.VOLTAGE, about=s.about, held=held) for s in hall]
    distances = [
        _LASER(name, low=-vertical.LASER, high=vertical.LASER, about=planar_stage.ABOUT[name])
        for name in planar_stage.LASERS
    ]
    return stage.interface(
        plant,
        sensors=[*volts, *distances],
        set_points=[SetPoint(f"{a}_ref", a, s.low, s.high, about=s.about) for a, s in vertical.REFERENCES.items()],
        actuators=[Actuator(name, safe=0.0, slew_per_s=SLEW) for name in signal_names(planar_stage.INPUTS)],
        bad_samples=BAD_SAMPLES,
        safe_output_effect="the air bearings carry the platen, and without current no force acts on it",
        suspected=signal_names(hall),
    )


INTERFACE = of_plant(planar_stage.plant())
BRAKED = replace(INTERFACE, braking=BRAKING)
SENSORS = tuple(s.name for s in INTERFACE.sensors)
INPUTS, OUTPUTS = stage.guarded_inputs(INTERFACE), INTERFACE.outputs


def controller(
    name: str,
    plant: Plant,
    time: Discrete,
    sensing_blocks: Sequence[Block],
    law: Sequence[Block],
    interface: Interface = INTERFACE,
) -> Block:
    """Return the whole controller, from six Hall voltages, three distances and six set-points to nine currents.

    The sensing Blocks lead from held voltages to positions, `law` from positions and held set-points to currents.
    """
    return stage.controller(
        name, time, interface, [*sensing_blocks, vertical.vertical_kinematics(plant, time), *law]
    ).block


def declare_controller(
    name: str, time: Discrete, block: Callable[[], Block], interface: Interface = INTERFACE
) -> Controller:
    """Return the declaration of a controller with this interface; its Block is built on first use."""
    return Controller(name, time, interface, lambda: Composition((), (), block()))
