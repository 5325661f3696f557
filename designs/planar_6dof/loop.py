"""The simulated loop of the planar positioner: plant, noisy sensors and converters, a sample of delay, compiled C.

    pose ---> Hall voltages + noise ---> 16 bits over +-10 V --+
          |                                                    +--> controller ---> z^-delay ---> phase currents
          +-> distances + noise -------> 16 bits over +-10 V --+

Noise of the Hall sensors is white and given as that of a position read from one of them: a deviation s in m is one of
s A w in V, with the fundamental's amplitude A in V and its wave number w in 1/m. Where a voltage is 0 the harmonics
make it 22 % flatter than that, and the raw position noisier than s. The plant's motors see the harmonics of the field,
of which the allocation knows nothing.

Phase currents are held over a sample, as if amplifiers were ideal: `voltages` says what they need.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import casadi as ca
import numpy as np
from numpy.typing import ArrayLike, NDArray

from designs.planar_6dof import filtering, interface, sensing, vertical
from models import halbach, hall_calibration, planar_stage
from synth.block import Block, unranged
from synth.compose import compose
from synth.emit import write
from synth.execute import host
from synth.plant import Plant
from synth.signals import names
from synth.simulate import closed_loop
from synth.simulate.scenario import Scenario, Trajectory, sample_times
from synth.simulate.sensors import Encoder
from synth.synthesise import safety
from synth.timing import Discrete

Array = NDArray[np.float64]

NOISE, NOISE_PRINTED = 13e-6, 5e-5  # m: a third of the peaks of +-4e-5 m in Fig. 5(a); what section 3.2 says
LASER_NOISE = 2e-7  # m, not printed
RANGE, BITS = 20.0, 16  # V, section 4.2
ADC = RANGE / 2**BITS
LASER_RESOLUTION = 2 * vertical.LASER / 2**BITS  # m: the range of a distance over the converter's
SUBSTEPS = 2  # of a sample: psi swings at 214 rad/s, 0.13 in half of 1.25 ms
SENSORS = {name: name for name in (*planar_stage.HALL, *planar_stage.LASERS)}
ACTUATORS: dict[str, str | Mapping[str, float]] = {name: name for name in names(interface.OUTPUTS)}


@dataclass(frozen=True, eq=False)
class Loop:
    """A plant under a compiled controller, whose view of the position is compiled beside it.

    `noise` is that of a Hall sensor's position, `laser_noise` that of a distance, m; `converters` False are ideal ones;
    `seed` draws the noise; `delay` counts samples.
    """

    plant: Plant
    controller: host.Controller
    view: host.Controller
    noise: float = NOISE
    laser_noise: float = LASER_NOISE
    converters: bool = True
    seed: int = 0
    delay: int = 1

    @property
    def period_s(self) -> float:
        """The sample period."""
        return self.controller.period_s

    @property
    def ideal(self) -> "Loop":
        """The same loop with sensors and converters free of noise and counts."""
        return replace(self, noise=0.0, laser_noise=0.0, converters=False)

    def run(
        self, duration_s: float, references: Mapping[str, ArrayLike], start: Mapping[str, float], **options: Any
    ) -> Trajectory:
        """Simulate from rest at `start` by axis (m, rad), in the middle pitch; other set-points stay there.

        `references` are set-points by axis; `options` are further fields of Scenario.
        """
        rest = {f"{axis}_ref": start.get(axis, 0.0) for axis in planar_stage.AXES}
        scenario = Scenario(
            duration_s,
            start,
            SENSORS,
            options.pop("actuators", ACTUATORS),
            references=rest | {f"{axis}_ref": values for axis, values in references.items()},
            encoders=resolutions() if self.converters else {},
            noise=noise(self, len(sample_times(duration_s, self.period_s))),
            delay=self.delay,
            substeps=options.pop("substeps", SUBSTEPS),
            **options,
        )
        return closed_loop.simulate(self.plant, self.controller, scenario)

    def seen(self, trajectory: Trajectory) -> dict[str, Array]:
        """Return raw and filtered positions, ``x_raw`` and ``x``, as the controller has them in a run."""
        found = self.view.replay(trajectory.measured).outputs
        return {name: np.asarray(values, dtype=np.float64) for name, values in found.items()}


def of(controller: Block) -> Loop:
    """Return the loop of a controller as shipped, in single precision, on motors that see the field's harmonics."""
    predicted = any(s.name.startswith("filter_") for s in controller.states)
    shown = view(controller.time, predicted)
    return Loop(planar_stage.plant(halbach.HARMONICS), compiled(controller), compiled(shown))


def view(time: Discrete, predicted: bool = True) -> Block:
    """Return the controllers' way from voltages to raw positions and residuals, `predicted` by the filters or not.

    What the filters make of them is shown in either case.
    """
    guard = safety.guard(time, interface.INPUTS, interface.BAD_SAMPLES, suspected=planar_stage.HALL)
    parts = [guard, sensing.sensing(planar_stage.plant(), time, predicted), *filtering.blocks(time)]
    outputs = [*(s.name for s in (*sensing.RAW.values(), *sensing.RESIDUALS)), *filtering.AXES]
    return unranged(compose("view", parts, inputs=[g.signal.name for g in interface.INPUTS], outputs=outputs))


def resolutions() -> dict[str, Encoder]:
    """Return the converters' counts, V and m."""
    return {n: Encoder(ADC) for n in planar_stage.HALL} | {n: Encoder(LASER_RESOLUTION) for n in planar_stage.LASERS}


def noise(loop: Loop, n: int) -> dict[str, Array]:
    """Return n samples of noise for each sensor, V and m; fewer are the first of more."""
    drawn = np.random.default_rng(loop.seed).standard_normal((n, len(SENSORS))).T
    sizes = dict.fromkeys(planar_stage.HALL, loop.noise * slope(loop.plant))
    sizes |= dict.fromkeys(planar_stage.LASERS, loop.laser_noise)
    return {name: size * row for (name, size), row in zip(sizes.items(), drawn, strict=True)}


def slope(plant: Plant) -> float:
    """Return A w in V/m, that of the fundamental where it is 0."""
    k = float(halbach.wave_number({p.name: ca.SX(p.value) for p in plant.parameters}))
    return hall_calibration.of(plant).amplitude * k


def compiled(block: Block, scalar: type[np.floating] = np.float32) -> host.Controller:
    """Return the C of a Block as shipped, compiled."""
    emitted = write.emit(block, scalar, error=interface.SURROGATE_ERROR[scalar])
    return host.load(emitted.files, emitted.manifest)
