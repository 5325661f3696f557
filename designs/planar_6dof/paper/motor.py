"""Audit of the motors: the armature of Table 1, G and (17), and the accelerations per ampere of (26).

Per ampere of i_Q the stage gets x'' = K / M of one motor, with K of (17), and phi'' = K a / Izz of a motor whose arm
is a. The pitch of Table 1 is not that of the matrix, so that figures are given for each where it matters.
"""

from math import exp, floor, log, log10, pi, sqrt

import casadi as ca
import numpy as np

from designs.planar_6dof.paper.bench import MM, Bench
from models import halbach, lorentz_motor
from synth.report.audit import Outcome, Published, recomputes

SHAPE = ("l", "w", "area", "Delta")  # what G follows from
FORCE = (*SHAPE, "turns", "Nm", "z0", "mu0_M0")  # and K
INCH = 25.4e-3
NEAR = 5e-3  # relative: what the pitches of Table 1 and of the matrix leave open
POINTS = 24  # of Gauss-Legendre quadrature along each side of a band


@recomputes("Y-1", "turns", "Y-1.turn_density", "Y-1.area")
def area(bench: Bench, printed: Published) -> Outcome:
    """Recompute the area of a winding from its turns and their density."""
    expected = bench.value("turns") / printed["turn_density"].value
    as_printed = printed["area"].value
    corrected = as_printed * 10.0 ** (-2 * floor(log10(as_printed)))
    figures = [
        ("turns over turn density", expected, "m^2"),
        ("printed area over it", as_printed / expected, "1"),
        ("the same with the sign of the exponent turned", corrected / expected, "1"),
    ]
    return Outcome(figures, abs(as_printed / expected - 1) < 1e-3, abs(corrected / expected - 1) < 1e-3)


@recomputes("Y-2", "area", "turns", "Y-1.turn_density", "Y-2.density")
def nominal_current(bench: Bench, printed: Published) -> Outcome:
    """Recompute the nominal current from the current density."""
    density = printed["density"].value
    figures = {
        "i, printed turn density": density / bench.printed("Y-1.turn_density"),
        "i, turns over area": density * bench.value("area") / bench.value("turns"),
    }
    agree = all(printed["current"].agrees(value) for value in figures.values())
    named = [(name, value, "A") for name, value in figures.items()]
    return Outcome(named, agree)


@recomputes("Y-3", "resistance", "Y-2.current", "Y-3.maximum_current", "Y-3.nominal", "Y-3.maximum")
def voltages(bench: Bench, printed: Published) -> Outcome:
    """Recompute the voltages of a phase at rest."""
    currents = {"nominal": bench.printed("Y-2.current"), "maximum": printed["maximum_current"].value}
    drops = {name: bench.value("resistance") * i for name, i in currents.items()}
    figures = [(f"R i, {name}", voltage, "V") for name, voltage in drops.items()]
    figures += [(f"resistance that makes it, {name}", printed[name].value / i, "ohm") for name, i in currents.items()]
    return Outcome(figures, all(printed[name].agrees(voltage) for name, voltage in drops.items()))


@recomputes("Y-4", *SHAPE, "Y-17.pitch", "Y-18.w", "Y-19.Gamma")
def geometric_constant(bench: Bench, printed: Published) -> Outcome:
    """Recompute G from the motor's dimensions."""
    pitch, w, winding = bench.printed("Y-17.pitch") * MM, bench.value("w"), bench.value("area")
    constants = {
        "G, w and Gamma as printed (Gamma in mm), pitch of Table 1": G(
            bench, pitch, bench.printed("Y-18.w") * MM, bench.printed("Y-19.Gamma") * MM * pitch / 6
        ),
        "G, one pitch of the matrix across, pitch of Table 1 along": G(bench, pitch, w, winding),
        "G, pitch of Table 1 in both": G(bench, pitch, pitch, winding),
        "G, pitch of the matrix in both": float(lorentz_motor.geometric_constant(bench.values())),
    }
    as_printed, corrected, *_ = (printed["G"].agrees(value) for value in constants.values())
    return Outcome([(n, v, "m^3") for n, v in constants.items()], as_printed, corrected)


@recomputes("Y-5", *FORCE, "M", "Y-1.turn_density", "Y-4.G", "Y-5.per_ampere", "Y-17.gamma")
def per_ampere(bench: Bench, printed: Published) -> Outcome:
    """Recompute x'' per ampere of (26)."""
    M, wanted = bench.value("M"), printed["per_ampere"]
    decay = exp(-bench.printed("Y-17.gamma") * bench.value("z0"))
    one = 0.5 * bench.value("mu0_M0") * bench.printed("Y-1.turn_density") * bench.printed("Y-4.G") * decay / M
    both = bench.value("Nm") * one
    figures = [
        ("K/M, printed G, turn density and gamma, Nm left out", one, "m/s^2/A"),
        ("K/M, printed G, turn density and gamma", both, "m/s^2/A"),
        (
            "K/M, (17), pitch of the matrix",
            float(lorentz_motor.force_constant(bench.values(), "printed")) / M,
            "m/s^2/A",
        ),
        ("K/M, integral over the bands", float(lorentz_motor.force_constant(bench.values())) / M, "m/s^2/A"),
        ("K that makes 13.2547", wanted.value * M, "N/A"),
        ("mu0 M0 that makes it, printed G, turn density and gamma", bench.value("mu0_M0") * wanted.value / both, "T"),
    ]
    remanence = printed["remanence"]
    room = remanence.last_digit / 2 / remanence.value
    return Outcome(figures, abs(one / wanted.value - 1) < room, abs(both / wanted.value - 1) < room)


@recomputes("Y-6", "M", "Izz", "Ixx", "w", "Y-5.per_ampere", "Y-6.per_ampere", "Y-24.width")
def arm(bench: Bench, printed: Published) -> Outcome:
    """Recompute the arm of the motors A and B from (26)."""
    torque = printed["per_ampere"].value / (bench.printed("Y-5.per_ampere") * bench.value("M"))
    arms = {"as printed": torque * bench.value("Izz"), "Ixx in place of Izz": torque * bench.value("Ixx")}
    least, most = bench.value("w") / 2, bench.printed("Y-24.width") * MM / 2
    figures = [(f"arm, {name}", a / MM, "mm") for name, a in arms.items()]
    figures += [("least arm of windings w wide side by side", least / MM, "mm"), ("half the platen", most / MM, "mm")]
    as_printed, exchanged = (least <= a <= most for a in arms.values())
    return Outcome(figures, as_printed, exchanged)


@recomputes("Y-17", *(f"Y-17.{n}" for n in ("pitch", "pitch_inches", "matrix", "pitches")), "Y-26.y")
def pitch(bench: Bench, printed: Published) -> Outcome:
    """Recompute the pitch from the size of the matrix."""
    table_1, matrix = printed["pitch"].value, printed["matrix"].value / printed["pitches"].value
    gammas = {"printed pitch": 2 * pi / (table_1 * MM), "pitch of the matrix": 2 * pi / (matrix * MM)}
    travel = bench.printed("Y-26.y")
    error = (gammas["pitch of the matrix"] - gammas["printed pitch"]) * travel * MM
    figures = [
        ("pitch, 304.8 mm in six", matrix, "mm"),
        ("pitch, 2.007 in", printed["pitch_inches"].value * INCH / MM, "mm"),
        *((f"gamma, {name}", gamma, "1/m") for name, gamma in gammas.items()),
        ("commutation error over the travel in y", np.degrees(error), "degrees"),
        ("thrust that it costs there", 100 * (1 - np.cos(error)), "%"),
        ("thrust that it turns into lift there", 100 * np.sin(error), "%"),
    ]
    return Outcome(figures, printed["pitch"].agrees(matrix))


@recomputes("Y-18", "area", "Y-4.G", "Y-17.matrix", "Y-17.pitches", "Y-17.pitch")
def array_width(bench: Bench, printed: Published) -> Outcome:
    """Recompute the w that G needs."""
    matrix = bench.printed("Y-17.matrix") / bench.printed("Y-17.pitches")
    table_1 = bench.printed("Y-17.pitch")
    needed = {n: _width(bench, l * MM) / MM for n, l in (("Table 1", table_1), ("the matrix", matrix))}
    figures = [(f"w that makes G, pitch of {n}", width, "mm") for n, width in needed.items()]
    figures += [("one pitch of the matrix", matrix, "mm"), ("a quarter of it, one block", matrix / 4, "mm")]

    def near(w: float) -> bool:
        return all(abs(w / wanted - 1) < NEAR for wanted in needed.values())

    return Outcome(figures, near(printed["w"].value), near(matrix))


@recomputes("Y-19", "area", "l", "w", "Y-4.G", "Y-17.pitch")
def thickness(bench: Bench, printed: Published) -> Outcome:
    """Recompute the thickness of a winding."""
    table_1, w = bench.printed("Y-17.pitch") * MM, bench.value("w")
    open_ = sqrt(2) * w * table_1**2 / pi**2 * (1 - exp(-pi / 2))
    needed = -log(1 - bench.printed("Y-4.G") / open_) * table_1 / (2 * pi)
    thicknesses = {
        "area over l/6, pitch of Table 1": 6 * bench.value("area") / table_1,
        "area over l/6, pitch of the matrix": float(lorentz_motor.thickness(bench.values())),
        "Gamma that makes G": needed,
    }
    units = {"mm": MM, "cm": 1e-2, "m": 1.0, "in": INCH}
    agree = any(
        all(abs(printed["Gamma"].value * u / v - 1) < 1e-2 for v in thicknesses.values()) for u in units.values()
    )
    figures = [(name, value / MM, "mm") for name, value in thicknesses.items()]
    return Outcome(figures, agree)


@recomputes("Y-20", *FORCE, "Y-20.factor")
def distribution(bench: Bench, printed: Published) -> Outcome:
    """Recompute the factor of (17) as the Lorentz force on the bands."""
    l, K = bench.value("l"), float(lorentz_motor.force_constant(bench.values(), "printed"))
    forces = np.array([lorentz_force(bench, y) for y in np.linspace(0, l, 7)])
    direct, factor = float(forces[0, 0]), printed["factor"].value
    ripple = round(100 * float(np.abs(forces / direct - [1, 0]).max()), 9)  # the rest is rounding
    figures = [
        ("K, (17)", K * factor / 0.5, "N/A"),
        ("K, integral over the bands", direct, "N/A"),
        ("factor that makes the integral", 0.5 * direct / K, "1"),
        ("distribution factor of a band of 60 degrees", 6 / pi * np.sin(pi / 6), "1"),
        ("printed factor over it", factor / (0.5 * direct / K), "1"),
        ("greatest ripple and lift of i_Q over a pitch", ripple, "%"),
    ]
    return Outcome(figures, abs(factor / (0.5 * direct / K) - 1) < 1e-3)


@recomputes("Y-21")
def phases(bench: Bench, printed: Published) -> Outcome:
    """Recompute the phase differences of bands and of currents."""
    places = np.sort([(c + half) % 1 for c in lorentz_motor.OFFSETS.values() for half in (0, 0.5)])
    bands = 360 * float(np.diff(places).max())
    cosine, sine = (_currents(bench, y) for y in (0.0, bench.value("l") / 4))
    currents = float(np.degrees(np.arctan2(sine["B"], cosine["B"]) - np.arctan2(sine["A"], cosine["A"])))
    figures = [("from band to band", bands, "degrees"), ("from phase to phase", currents, "degrees")]
    wanted = 180 / printed["divisor"].value
    as_printed, neighbours = (abs(angle - wanted) < 1e-6 for angle in (currents, bands))
    return Outcome(figures, as_printed, neighbours)


def G(bench: Bench, l: float, w: float, winding: float) -> float:
    """Return the geometric constant in m^3 of a pitch and width in m and a winding of m^2, over blocks l/4 high."""
    return float(lorentz_motor.geometric_constant(bench.values(l=l, w=w, area=winding, Delta=l / 4)))


def lorentz_force(bench: Bench, y: float) -> tuple[float, float]:
    """Return f_y and f_z in N for i_Q = 1 A at y in m, by quadrature over the bands, nothing simplified by hand."""
    p, l = bench.values(), bench.value("l")
    nodes, weights = np.polynomial.legendre.leggauss(POINTS)
    high = float(lorentz_motor.thickness(p))
    heights, along = bench.value("z0") + high * (nodes + 1) / 2, l / 12 * nodes
    A = np.asarray(ca.DM(halbach.amplitude(1, ca.SX(heights), p))).ravel()
    total = np.zeros(2)
    for phase, i in _currents(bench, y).items():
        for sign, way in ((1, 0.0), (-1, 0.5)):
            at = 2 * pi / l * (y + (lorentz_motor.OFFSETS[phase] + way) * l + along)
            total += sign * i * l / 12 * np.array([weights @ np.cos(at), -weights @ np.sin(at)])
    sheet = high / 2 * (weights @ A) * bench.value("Nm") * bench.value("w") * float(lorentz_motor.turn_density(p))
    return float(sheet * total[0]), float(sheet * total[1])


def _currents(bench: Bench, y: float) -> dict[str, float]:
    """Return the phase currents of i_Q = 1 A at y in m."""
    currents = lorentz_motor.commutated(ca.SX(1), ca.SX(0), ca.SX(y), bench.values())
    return {phase: float(i) for phase, i in currents.items()}


def _width(bench: Bench, l: float) -> float:
    """Return the w in m with which the printed G follows from a pitch in m."""
    return bench.printed("Y-4.G") / G(bench, l, 1.0, bench.value("area"))
