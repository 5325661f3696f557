"""The simulated loop of the maglev stage: the full plant, six encoders, one sample of delay, the compiled C.

The guide springs of the plant and those that F(12) knows are set apart, so that one can be wrong.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import casadi as ca
import numpy as np
from numpy.typing import ArrayLike

from designs.maglev_5dof import control
from models import maglev_stage
from synth.emit import write
from synth.execute import host
from synth.plant import Plant
from synth.simulate import closed_loop
from synth.simulate.scenario import Scenario, Trajectory
from synth.simulate.sensors import Encoder

RESOLUTION = 10e-6  # m, F section II
ANGLE_RESOLUTION = 20e-6  # rad, F section IV-A
SENSORS = {f"y{j}": f"g{j}" for j in range(1, 5)} | {"x": "x", "z": "z"}
ACTUATORS: dict[str, str | Mapping[str, float]] = {f"i_d{j}": f"i_d{j}" for j in range(1, 5)}
ACTUATORS |= {"u_x": "i_q2", "u_z": "i_q1"}
MEAN_DIRECT = {f"i_d{k}": 0.25 for k in range(1, 5)}
NO_ROTATION: dict[str, str | Mapping[str, float]] = ACTUATORS | {f"i_d{j}": MEAN_DIRECT for j in range(1, 5)}
STOPS = {"y": control.GAP, "phi": (-control.PHI, control.PHI), "theta": (-control.THETA, control.THETA)}


@dataclass(frozen=True, eq=False)
class Loop:
    """A plant under a compiled controller; `resolution` of the encoders in m, 0 for ideal ones."""

    plant: Plant
    controller: host.Controller
    resolution: float = RESOLUTION
    disturbance: ca.Function | None = None
    stops: Mapping[str, tuple[float, float]] = field(default_factory=lambda: dict(STOPS))

    def run(
        self,
        duration_s: float,
        start: Mapping[str, float],
        references: Mapping[str, ArrayLike],
        *,
        hold: float = control.SAFE_CURRENT,
        **options: Any,
    ) -> Trajectory:
        """Simulate from rest at `start` (m, rad); a set-point that is not given stays at its start, 0 or 25 mm.

        `hold` is the direct current in A before the first command; `options` are further fields of Scenario.
        """
        rest = {"y_ref": start.get("y", 0.025), "x_ref": 0.0, "z_ref": 0.0, "phi_ref": 0.0, "theta_ref": 0.0}
        scenario = Scenario(
            duration_s,
            start,
            SENSORS,
            options.pop("actuators", ACTUATORS),
            references=rest | dict(references),
            encoders={name: Encoder(self.resolution) for name in SENSORS},
            hold={f"i_d{j}": hold for j in range(1, 5)},
            velocities=maglev_stage.RATE,
            stops=self.stops,
            **options,
        )
        return closed_loop.simulate(self.plant, self.controller, scenario, self.disturbance)


def compiled(plant: Plant, scalar: type[np.floating], **variant: Any) -> host.Controller:
    """Return the emitted controller for the parameters of `plant`, compiled; `variant` as for `control.controller`."""
    error = control.SURROGATE_ERROR[scalar]
    emitted = write.emit(control.controller(plant, **variant), scalar, error=error)
    return host.load(emitted.files, emitted.manifest)
