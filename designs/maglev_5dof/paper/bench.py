"""The loops under audit, made once for a plant: ideal ones and compiled ones on encoders.

"Ideal" is the loop in continuous time with ideal sensing (`continuous`). "Encoders" is the compiled controller at
1 kHz on encoders of 10 um with its filters and one sample of delay: with the printed law (12), or `restored`, with the
shipped law, which puts back the squares of i_d that (11) drops and cancels the guide springs in part. Both laws take
squares of currents one sample late, and each motor at its own measured gap. Tracking errors are means of |e|, with
encoders from 10 to 60 s. Ideal runs are periodic by 12 s, and the mean is over the six whole periods up to 20 s.
Shorter runs keep these proportions.
"""

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property
from math import pi
from typing import Literal, TypeVar, cast

import casadi as ca
import numpy as np

from designs.maglev_5dof import control, experiments
from designs.maglev_5dof.paper import continuous
from designs.maglev_5dof.paper.continuous import Reference
from models import slotted_field
from synth.declaration import Stage
from synth.execute import build, host
from synth.plant import Plant
from synth.simulate import metrics
from synth.simulate.rig import Rig

Springs = Literal["known", "unknown", "absent"]
T = TypeVar("T")

MAGNETS = ("b0", "t1", "h_m", "L_A", "p_m", "tau", "tau_p", "H_c", "mu_rec", "mu0")
FORCES = (*MAGNETS, "W", "w_c", "p", "z1")
FIELD = ("b0", "t1", "h_m", "L_A", "p_m", "tau", "tau_p", "H_c", "mu_rec", "W", "p")
MM = 1e-3
SPRINGS = ("k_s_phi", "k_s_theta")
FRICTION = {"x": 1.8, "z": 1.3}  # N of guide friction, fitted to the two printed errors of the ellipse
SLIP = 1e-3  # m/s, within which friction changes sign


@dataclass(frozen=True, eq=False)
class Bench:
    """The stage and the plant under audit, and the length of the tracking runs in s.

    `cells` is the fineness of the slotted field. Of the guide springs, "known" means in plant and (12), "unknown" in
    the plant alone, "absent" in neither. Runs and controllers are kept for the rows that share them.
    """

    stage: Stage
    plant: Plant
    duration_s: float = experiments.TRACK_TO
    cells: int = 12
    _kept: dict[tuple[object, ...], object] = field(default_factory=dict, repr=False)

    @cached_property
    def without_springs(self) -> Plant:
        """The plant without guide springs."""
        return self.plant.with_parameters(**dict.fromkeys(SPRINGS, 0.0))

    def ideal(self, four: bool, springs: Springs, lv3: str = "csch2") -> continuous.Motion:
        """Return the ideal 4-DOF tracking or ellipse under (12), with this reading of L_v3 in plant and law."""
        return self._once(("ideal", four, springs, lv3), lambda: self._ideal(four, springs, lv3))

    def ideal_errors(self, four: bool, springs: Springs, lv3: str = "csch2") -> dict[str, float]:
        """Return the mean |e| of an ideal run by axis, um or urad; NaN when the gap left its range."""
        motion = self.ideal(four, springs, lv3)
        return {axis: 1e6 * motion.mean_error(axis, self.duration_s / 5) for axis in motion.error}

    def encoder_errors(
        self, four: bool, restored: bool, springs: Springs = "known", guided: bool = False
    ) -> dict[str, float]:
        """Return the mean |e| by axis of the compiled loop, um or urad; `guided` adds friction and cogging."""
        key = ("encoders", four, restored, springs, guided)
        return self._once(key, lambda: self._encoder_errors(four, restored, springs, guided))

    def guides(self) -> ca.Function:
        """Return the accelerations (10,) that friction and cogging add, a function of the state (10,) and t in s.

        F_s = -F_c tanh(v_s/SLIP) + 2 A(y) sin(2 pi s/t1), s = x, z; A is geometric through the field's amplitudes at
        20 and 25 mm.
        """
        names = [s.name for s in self.plant.states]
        x, t = ca.SX.sym("x", len(names)), ca.SX.sym("t")
        state = dict(zip(names, ca.vertsplit(x), strict=True))
        near, far = (slotted_field.forces(geometry(self.plant), g, self.cells).cogging for g in (0.020, 0.025))
        amplitude = near * (far / near) ** ((state["y"] - 0.020) / 0.005)
        added = dict.fromkeys(names, ca.SX(0))
        for axis, mass in (("x", "M_x"), ("z", "M_z")):
            wave = ca.sin(2 * pi * state[axis] / self.plant.parameter("t1").value)
            force = -FRICTION[axis] * ca.tanh(state[f"v{axis}"] / SLIP) + 2 * amplitude * wave
            added[f"v{axis}"] = force / self.plant.parameter(mass).value
        return ca.Function("guides", [x, t], [ca.vcat(list(added.values()))])

    def _ideal(self, four: bool, springs: Springs, lv3: str) -> continuous.Motion:
        references = {
            "y": Reference(0.025, 0.005, -pi / 2),
            "x": Reference(0.0, 0.03, -pi / 2),
            "z": Reference(0.0, 0.03),
        }
        if four:
            references |= {"phi": Reference(), "theta": Reference(0.0, 0.01)}
        start = {"y": 0.020, "x": -0.03}
        return continuous.run(*self._pair(springs), references, start, self.duration_s / 3, lv3)

    def _encoder_errors(self, four: bool, restored: bool, springs: Springs, guided: bool) -> dict[str, float]:
        plant, known = self._pair(springs)
        added = self.guides() if guided else None
        rig = Rig(self.stage, plant, self._controller(restored, known), disturbance=added)
        trajectory, references = experiments.tracking(rig, four, self.duration_s)
        errors = {a: trajectory[a] - references.get(a, 0.0) for a in experiments.UNITS}
        start = self.duration_s / 6
        return {a: 1e6 * metrics.mean_absolute(trajectory.time, e, start) for a, e in errors.items()}

    def _controller(self, restored: bool, known: Plant) -> host.Controller:
        key = ("controller", restored, known is self.plant)
        # The library computes the functions, which for new parameters none has fitted.
        block = control.controller(known, restored)
        return self._once(key, lambda: build.compiled(block.block, np.float64, libm=True))

    def _pair(self, springs: Springs) -> tuple[Plant, Plant]:
        """Return the plant, and the one that (12) takes it for."""
        plant = self.without_springs if springs == "absent" else self.plant
        return plant, self.plant if springs == "known" else self.without_springs

    def _once(self, key: tuple[object, ...], make: Callable[[], T]) -> T:
        if key not in self._kept:
            self._kept[key] = make()
        return cast(T, self._kept[key])


def values(plant: Plant) -> dict[str, ca.SX]:
    """Return the parameters' values by name, as constant expressions."""
    return {p.name: ca.SX(p.value) for p in plant.parameters}


def geometry(plant: Plant) -> slotted_field.Geometry:
    """Return the motor of the slotted field from the plant's parameters."""
    shared = {n: plant.parameter(n).value for n in FIELD if n != "p"}
    return slotted_field.Geometry(poles=plant.parameter("p").value, **shared)
