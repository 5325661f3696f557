"""Audit of the platen: Table 3 and (26) against (18)-(20), masses and springs against its size, travel, the circle.

A distribution of mass between two planes h apart has a variance of h^2 / 4 at most, whatever its centre. From the
inertias int x^2 dm = (Iyy + Izz - Ixx) / 2, and so on; and springs of Kz in all, none further than h from an axis, make
a torsional spring of Kz h^2 at most.
"""

from collections.abc import Mapping
from math import pi, sqrt

import casadi as ca
import numpy as np

from designs.planar_6dof.paper.bench import MM, Bench
from designs.planar_6dof.paper.motor import FORCE
from models import lorentz_motor, planar_stage
from synth.report.audit import Outcome, Published, recomputes
from synth.signals import names

ALONE = 1e-9  # of what one motor can do to an axis: less is rounding and leaves it at rest
FORCES = tuple(f"{motor}{axis}" for motor in planar_stage.MOTORS for axis in "yz")
SIZES = {"x": "width", "y": "depth", "z": "height"}
ARMS = ("a", "b", "c")


@recomputes("Y-22", *ARMS, "Y-22.*")
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


@recomputes("Y-24", "Ixx", "Iyy", "Izz", "M", *(f"Y-24.{size}" for size in SIZES.values()))
def inertias(bench: Bench, printed: Published) -> Outcome:
    """Recompute how far from its centre the platen's mass must lie for the printed inertias."""
    Ixx, Iyy, Izz = (bench.value(n) for n in ("Ixx", "Iyy", "Izz"))
    spreads = {"as printed": _spread(Ixx, Iyy, Izz, bench), "Ixx and Izz exchanged": _spread(Izz, Iyy, Ixx, bench)}
    limits = {axis: printed[size].value / 2 for axis, size in SIZES.items()}
    figures = [(f"rms distance along {n}, {case}", s[n] / MM, "mm") for case, s in spreads.items() for n in SIZES]
    figures += [(f"greatest possible along {n}", limit, "mm") for n, limit in limits.items()]
    possible = [all(s[n] / MM <= limits[n] for n in SIZES) for s in spreads.values()]
    return Outcome(figures, *possible)


@recomputes("Y-25", "Kz", "K_theta", "K_psi", "Y-24.width", "Y-24.depth")
def springs(bench: Bench, printed: Published) -> Outcome:
    """Recompute at which arms the vertical springs make the torsional ones."""
    Kz = bench.value("Kz")
    sizes = {"K_theta": bench.printed("Y-24.depth") * MM, "K_psi": bench.printed("Y-24.width") * MM}
    arms = {name: sqrt(bench.value(name) / Kz) for name in sizes}
    figures = [(f"arm at which Kz makes {name}", a / MM, "mm") for name, a in arms.items()]
    figures += [
        (f"greatest {name} of springs Kz within the platen", Kz * size**2, "N m/rad") for name, size in sizes.items()
    ]
    return Outcome(figures, all(arms[name] <= size for name, size in sizes.items()))


@recomputes("Y-26", "b", "c", "w", "Nm", "l", "Y-17.matrix", "Y-24.width", "Y-24.depth", "Y-26.x", "Y-26.y")
def travel(bench: Bench, printed: Published) -> Outcome:
    """Recompute the travel over which the windings stay over the matrix."""
    a, b, c, w = (bench.value(n) for n in (*ARMS, "w"))
    long, matrix = bench.value("Nm") * bench.value("l"), bench.printed("Y-17.matrix") * MM
    span = {"x": max(2 * a + w, long), "y": max(c + w / 2, long / 2 - b) + max(b + long / 2, w / 2 - c)}
    left = {n: matrix - s for n, s in span.items()}
    figures = [(f"travel of the windings, {n}", room / MM, "mm") for n, room in left.items()]
    figures += [
        (f"travel of the platen, {n}", matrix / MM - bench.printed(f"Y-24.{size}"), "mm")
        for n, size in (("x", "width"), ("y", "depth"))
    ]
    figures += [(f"room for the windings, printed travel, {n}", matrix / MM - printed[n].value, "mm") for n in left]
    return Outcome(figures, all(left[n] >= printed[n].value * MM for n in left))


@recomputes("Y-27", "Y-16.rate", "Y-26.x", "Y-26.y", "Y-27.diameter")
def circle(bench: Bench, printed: Published) -> Outcome:
    """Recompute the room that the circle of 200 mm takes."""
    size = printed["diameter"].value
    free = {n: bench.printed(f"Y-26.{n}") - size for n in "xy"}
    figures = [
        *((f"travel left, {n}", room, "mm") for n, room in free.items()),
        ("width of a circle of that radius", 2 * size, "mm"),
        ("speed along the circle", bench.printed("Y-16.rate") * size / 2, "mm/s"),
    ]
    return Outcome(figures, min(free.values()) >= 0)


@recomputes("Y-16", "Y-16.rate")
def rate(bench: Bench, printed: Published) -> Outcome:
    """Recompute the angular velocity from a period of whole seconds."""
    period = 2 * pi / printed["rate"].value
    rate_of_period = 2 * pi / round(period)
    figures = [("period of the printed rate", period, "s"), ("2 pi over its whole seconds", rate_of_period, "rad/s")]
    return Outcome(figures, printed["rate"].agrees(rate_of_period))


@recomputes("Y-28")
def control_outputs(bench: Bench, printed: Published) -> Outcome:
    """Recount the phases."""
    count = len(bench.plant.inputs)
    figures = [("motors times phases", count, "1")]
    return Outcome(figures, count == printed["outputs"].value <= printed["channels"].value)


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


def _spread(Ixx: float, Iyy: float, Izz: float, bench: Bench) -> dict[str, float]:
    """Return the rms distance in m of the mass from its centre along each axis."""
    half = (Ixx + Iyy + Izz) / 2
    return {n: sqrt((half - I) / bench.value("M")) for n, I in zip(SIZES, (Ixx, Iyy, Izz), strict=True)}
