"""Which axes of the platen the motors' forces accelerate, by (18)-(20), to compare with Table 3 and (26).

Source: Yu, Kim, section 5.1; see `planar_stage`.
"""

from collections.abc import Mapping

import casadi as ca
import numpy as np

from designs.planar_6dof.paper.motors import constants
from models import lorentz_motor, planar_stage
from synth.signals import signal_names

FORCE_ROUNDING = 1e-9  # of the largest acceleration of an axis by one motor: less is rounding
FORCES = tuple(f"{motor}{axis}" for motor in planar_stage.MOTORS for axis in "yz")

Accelerations = Mapping[str, float]  # by axis


def accelerations_per_force(p: Mapping[str, float]) -> dict[str, Accelerations]:
    """Return `accelerations` of each of FORCES."""
    return {force: accelerations(p, force) for force in FORCES}


def accelerations(p: Mapping[str, float], force: str) -> Accelerations:
    """Return the accelerations of the six axes, level in the middle of the matrix, per ampere that makes one of FORCES.

    Parameters that are not in `p` are as published.
    """
    plant = planar_stage.plant().with_parameters(**p)
    known, at = constants({s.name: s.value for s in plant.parameters}), dict.fromkeys(planar_stage.AXES, ca.SX(0))
    motor, centre = force[0], planar_stage.centres(at, known)[force[0]]
    i_q, i_d = (ca.SX(float(axis == force[1])) for axis in "yz")
    phases = lorentz_motor.phase_currents(i_q, i_d, centre.X if motor == "C" else centre.Y, known)
    u = {f"i_{motor}{phase}": float(i) for phase, i in phases.items()}
    slopes = plant.f(np.zeros(len(plant.states)), [u.get(n, 0.0) for n in signal_names(plant.inputs)], plant.values)
    slope = dict(zip(signal_names(plant.states), np.asarray(slopes).ravel(), strict=True))
    return {axis: float(slope[planar_stage.RATE[axis]]) for axis in planar_stage.AXES}


def decoupled_rows(accelerations: Mapping[str, Accelerations], table: Mapping[str, Mapping[str, float]]) -> int:
    """Return how many rows of a table of forces by axis accelerate that axis alone."""
    return sum(_accelerated_axes(accelerations, forces) == {axis} for axis, forces in table.items())


def _accelerated_axes(accelerations: Mapping[str, Accelerations], forces: Mapping[str, float]) -> set[str]:
    total = {n: sum(size * accelerations[force][n] for force, size in forces.items()) for n in planar_stage.AXES}
    return {
        n for n, a in total.items() if abs(a) > FORCE_ROUNDING * max(abs(each[n]) for each in accelerations.values())
    }
