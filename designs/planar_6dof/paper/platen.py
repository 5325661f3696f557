"""Audit of the platen's motions: Table 3 and (26) against (18)-(20)."""

from collections.abc import Mapping

import casadi as ca
import numpy as np

from designs.planar_6dof.paper.bench import Bench
from models import lorentz_motor, planar_stage
from synth.report.audit import Outcome, Published, recomputes
from synth.signals import names

ALONE = 1e-9  # of what one motor can do to an axis: less is rounding and leaves it at rest
FORCES = tuple(f"{motor}{axis}" for motor in planar_stage.MOTORS for axis in "yz")
FORCE = ("l", "w", "area", "Delta", "turns", "Nm", "z0", "mu0_M0")  # what K follows from


@recomputes("Y-22", "a", "b", "c", "Y-22.*")
def motions(bench: Bench, printed: Published) -> Outcome:
    """Recompute which axes each row of Table 3 moves."""
    table: dict[str, dict[str, float]] = {axis: {} for axis in planar_stage.AXES}
    for name, number in printed.numbers.items():
        axis, force = name.split("_")
        table[axis][force] = number.value
    weight = -sum(table["theta"][f] for f in ("Az", "Bz")) / table["theta"]["Cz"]
    corrected = table | {"theta": table["theta"] | {"Cz": weight * table["theta"]["Cz"]}}
    made = {force: accelerations(bench, force) for force in FORCES}
    counts = [sum(moved(made, forces) == {axis} for axis, forces in t.items()) for t in (table, corrected)]
    figures = [
        ("rows that move their axis alone, unit forces", counts[0], "1"),
        ("lift that the row theta leaves, in forces of one motor", sum(table["theta"].values()), "1"),
        ("weight of F_Cz that ends it", weight, "1"),
        ("rows that move their axis alone, with it", counts[1], "1"),
    ]
    return Outcome(figures, *(count == len(table) for count in counts))


@recomputes("Y-23", *FORCE, "Izz", "a", "c")
def yaw_of_c(bench: Bench, printed: Published) -> Outcome:
    """Recompute phi'' per ampere of motor C."""
    per_ampere = {motor: accelerations(bench, f"{motor}y")["phi"] for motor in "BC"}
    figures = [(f"phi'' per ampere of motor {motor}", value, "rad/s^2/A") for motor, value in per_ampere.items()]
    figures.append(("of C over that of B", per_ampere["C"] / per_ampere["B"], "1"))
    return Outcome(figures, abs(per_ampere["C"] - printed["per_ampere"].value) < 0.01 * abs(per_ampere["B"]))


def accelerations(bench: Bench, force: str) -> dict[str, float]:
    """Return the accelerations of the six axes, level at the matrix' middle, per ampere that makes one of FORCES."""
    p, at = bench.values(), dict.fromkeys(planar_stage.AXES, ca.SX(0))
    motor, centre = force[0], planar_stage.centres(at, p)[force[0]]
    i_q, i_d = (ca.SX(float(axis == force[1])) for axis in "yz")
    phases = lorentz_motor.commutated(i_q, i_d, centre.X if motor == "C" else centre.Y, p)
    u = {f"i_{motor}{phase}": float(i) for phase, i in phases.items()}
    plant = bench.plant
    slopes = plant.f(np.zeros(len(plant.states)), [u.get(n, 0.0) for n in names(plant.inputs)], plant.values)
    slope = dict(zip(names(plant.states), np.asarray(slopes).ravel(), strict=True))
    return {axis: float(slope[planar_stage.RATE[axis]]) for axis in planar_stage.AXES}


def moved(made: Mapping[str, Mapping[str, float]], forces: Mapping[str, float]) -> set[str]:
    """Return the axes that some forces accelerate, from the accelerations that one of each makes."""
    total = {n: sum(size * made[force][n] for force, size in forces.items()) for n in planar_stage.AXES}
    return {n for n, a in total.items() if abs(a) > ALONE * max(abs(each[n]) for each in made.values())}
