"""Simulation rig: the plant of a stage with its compiled controller, sensors, delay and stops.

plant --> sensors (noise, resolution) --> compiled controller --> delay --> hold --> plant
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import casadi as ca
import numpy as np
from numpy.typing import ArrayLike

from synth.declaration import Stage
from synth.execute import host
from synth.plant import Plant
from synth.simulate import closed_loop
from synth.simulate.scenario import Array, Scenario, Trajectory, sample_times
from synth.simulate.sensors import Encoder

Simulate = Callable[[Plant, host.Controller, Scenario, ca.Function | None], Trajectory]
Wires = Mapping[str, str | Mapping[str, float]]


@dataclass(frozen=True, eq=False)
class Rig:
    """The plant of a stage under a compiled controller; `plant` may differ from the declared plant.

    `quantised` False removes the resolution of the sensors; `noise` scales their declared noise, generated from `seed`;
    `actuators` replaces the connections from controller outputs to plant inputs; `disturbance(x, t)` is added to dx/dt.
    `offsets` are errors of the sensors' zeros, in their units. `simulate` runs a scenario.
    """

    stage: Stage
    plant: Plant
    controller: host.Controller
    quantised: bool = True
    noise: float = 1.0
    seed: int = 0
    actuators: Wires = field(default_factory=dict)
    disturbance: ca.Function | None = None
    offsets: Mapping[str, float] = field(default_factory=dict)
    simulate: Simulate = closed_loop.simulate

    @property
    def period_s(self) -> float:
        """The sample period."""
        return self.controller.period_s

    @property
    def connections(self) -> Wires:
        """The controller output, or weighted outputs, of each plant input that an actuator drives."""
        return self.actuators or self.stage.wires or {a.of: a.name for a in self.stage.interface.actuators}

    @property
    def ideal(self) -> "Rig":
        """The same rig with ideal sensors: without noise and quantisation."""
        return replace(self, quantised=False, noise=0.0)

    def with_interface(self, **fields: Any) -> "Rig":
        """Return the same rig with some fields of its interface replaced; the controller is unchanged."""
        controller = self.stage.controller
        declared = replace(controller, interface=replace(controller.interface, **fields))
        return replace(self, stage=replace(self.stage, controller=declared))

    def run(
        self,
        duration_s: float,
        start: Mapping[str, float] | None = None,
        references: Mapping[str, ArrayLike] | None = None,
        **options: Any,
    ) -> Trajectory:
        """Simulate from rest at `start` (plant states; others start as declared by the stage) under set-points by name.

        A set-point is a constant or (N,); a missing one stays at the initial position. `options` are further fields of
        `Scenario`.

        Raises SignalError and WiringError as `closed_loop.simulate`.
        """
        interface, start = self.stage.interface, {**self.stage.start, **(start or {})}
        n = len(sample_times(duration_s, self.period_s))
        default_set_points = {s.name: start.get(s.of, s.initial) for s in interface.set_points}
        commands = self.controller.outputs.names or ()
        fields: dict[str, Any] = {
            "sensors": {s.name: s.of for s in interface.sensors},
            "actuators": self.connections,
            "references": default_set_points | dict(references or {}),
            "encoders": self._encoders(),
            "noise": self.sensor_noise(n),
            "hold": {a.name: a.safe for a in interface.actuators if a.name in commands},
            "forcing": dict.fromkeys(interface.disturbances, 0.0),
            "velocities": self.stage.velocities,
            "stops": self.stage.stops,
            "delay": interface.delay,
            "substeps": self.stage.substeps,
        }
        scenario = Scenario(duration_s, start, **(fields | options))
        return self.simulate(self.plant, self.controller, scenario, self.disturbance)

    @property
    def positions(self) -> dict[str, str]:
        """The plant state that each set-point controls, or the output behind its sensor where it names no state."""
        states, interface = {s.name for s in self.plant.states}, self.stage.interface
        sensors = {s.name: s.of for s in interface.sensors if s.name not in states}
        return {s.name: sensors.get(s.of, s.of) for s in interface.set_points}

    def at_rest(self) -> dict[str, float]:
        """Return the controller inputs at the initial state of the stage, with zero plant inputs."""
        interface, start = self.stage.interface, self.stage.start
        outputs = self.plant.output_values(start)
        sensors = {s.name: float(outputs[s.of][0]) for s in interface.sensors}
        return sensors | {s.name: float(start.get(s.of, s.initial or 0.0)) for s in interface.set_points}

    def _encoders(self) -> dict[str, Encoder]:
        resolutions = {s.name: s.resolution if self.quantised else 0.0 for s in self.stage.interface.sensors}
        return {
            name: Encoder(resolution, self.offsets.get(name, 0.0))
            for name, resolution in resolutions.items()
            if resolution or name in self.offsets
        }

    def sensor_noise(self, n: int) -> dict[str, Array]:
        """Return n samples of noise for each noisy sensor; a shorter record is the beginning of a longer one."""
        sensors = self.stage.interface.sensors
        if not self.noise or not any(s.noise for s in sensors):
            return {}
        noise = np.random.default_rng(self.seed).standard_normal((n, len(sensors))).T
        return {s.name: self.noise * s.noise * row for s, row in zip(sensors, noise, strict=True) if s.noise}
