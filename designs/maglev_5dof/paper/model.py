"""Audit of the model: the dominant terms of (9), the inverse (12) and the double integrators (13), angles.

(9) is the full model (6), (7) as a polynomial in v; its coefficients are maximised over the box of angles, as in (10).
"""

from collections.abc import Mapping
from math import asin, sin, sqrt

import casadi as ca
import numpy as np

from designs.maglev_5dof.paper.bench import FORCES, MAGNETS, MM, Bench, values
from designs.maglev_5dof.paper.continuous import inverse
from models import maglev_stage
from synth.analyse import magnitude
from synth.plant import Plant
from synth.report.audit import Outcome, Published, recomputes
from synth.signals import Signal

DOMINANT, SMALL = ("a2", "a3", "a7"), ("a4", "a5", "a6", "a8", "a9")


@recomputes("F-5", *FORCES, "M_y", "r")
def dominance_as_printed(bench: Bench, printed: Published) -> Outcome:
    """Recompute Fig. 3 with coth^2."""
    figures, dominated = _magnitudes(bench.plant, printed, "coth2")
    return Outcome(figures, dominated)


@recomputes("F-5b", *FORCES, "M_y", "r")
def dominance(bench: Bench, printed: Published) -> Outcome:
    """Recompute Fig. 3 with csch^2."""
    figures, dominated = _magnitudes(bench.plant, printed, "csch2")
    as_printed = _magnitudes(bench.plant, printed, "coth2")[1]
    return Outcome(figures, as_printed, dominated)


@recomputes("F-6", *MAGNETS, "M_y", "G")
def order_of_a1(bench: Bench, printed: Published) -> Outcome:
    """Recompute a1 at zero angles and thrust currents."""
    model = _polynomial(bench.plant, "csch2")
    symbols = ca.vcat([*model.x.values(), *model.u.values()])
    a1 = ca.Function("a1", [symbols], [model.coefficients["a1"]])
    found = {g: float(a1([g * MM, 0, 0, 0, 0])) for g in (20, 25, 30)}
    order, largest = printed["order"].value, max(abs(a) for a in found.values())
    figures = [(f"a1 at {g} mm", a, "m/s^2") for g, a in found.items()]
    return Outcome(figures, order / sqrt(10) <= largest <= order * sqrt(10))


@recomputes("F-7", *FORCES, "M_y", "r", "I_x", "I_z")
def invertibility(bench: Bench, printed: Published) -> Outcome:
    """Recompute the least determinant and the greatest condition number of the matrix in (12)."""
    model = maglev_stage.simplified(_polynomial(bench.plant, "csch2"))
    found = magnitude.conditioning(model.decoupling(), model.x, _box(bench.plant, "y", "phi", "theta"))
    figures = [
        ("least |det|", found.min_abs_det, "m rad^2/s^6/A^3"),
        ("greatest condition number", found.max_cond, "1"),
    ]
    return Outcome(figures, found.min_abs_det > 0 and found.max_cond < 1e3)


@recomputes("F-19", *MAGNETS, "M_y", "r", "I_x", "I_z", "G", "k_s_phi", "k_s_theta")
def double_integrators(bench: Bench, printed: Published) -> Outcome:
    """Recompute (13): the accelerations of (11) under (12), and what remains on the full model."""
    full = _polynomial(bench.plant, "csch2")
    model = maglev_stage.simplified(full)
    w = {n: ca.SX.sym(f"w_{n}") for n in maglev_stage.RATE}
    law = inverse(model, w)
    nominal = _under(model, law, w)
    reduced = sum(_vanishes(nominal[n] - w[n], model, w) for n in w)
    rest = _under(full, law, w)
    zero = ca.vcat([*w.values(), *full.u.values()])
    terms = {n: ca.substitute(rest[n], zero, ca.SX.zeros(zero.numel())) for n in ("y", "phi", "theta")}
    greatest = dict.fromkeys(terms, 0.0)
    for gap in (18, 20, 25, 30, 31):
        found = magnitude.magnitudes(terms, full.x, _box(bench.plant, "phi", "theta"), "y", [gap * MM], {})
        greatest = {n: max(greatest[n], float(found.of(n)[0])) for n in terms}
    units = {"y": "m/s^2", "phi": "rad/s^2", "theta": "rad/s^2"}
    figures = [("axes of (11) that obey x'' = w", float(reduced), "1")]
    figures += [(f"greatest |{n}''| of (9) at w = 0", greatest[n], units[n]) for n in terms]
    return Outcome(figures, reduced == printed["axes"].value)


@recomputes("F-17", "r")
def rotational_resolution(bench: Bench, printed: Published) -> Outcome:
    """Recompute the steps of phi and theta from encoders at the motors' radius."""
    r, count = bench.plant.parameter("r").value, printed["encoder"].value * 1e-6
    one, both = asin(count / (2 * r)) * 1e6, asin(count / r) * 1e6
    figures = [
        ("step when one encoder counts", one, "urad"),
        ("step when both count", both, "urad"),
        ("radius at which one count is 20 urad", count / 2 / (printed["resolution"].value * 1e-6), "m"),
    ]
    return Outcome(figures, one <= printed["resolution"].value <= both)


@recomputes("F-18", "r")
def rotation_range(bench: Bench, printed: Published) -> Outcome:
    """Recompute the ranges from +-3 and +-14 mrad, and whether the motors' gaps leave room for them."""
    r, room = bench.plant.parameter("r").value, (printed["gap_high"].value - printed["gap_low"].value) * MM
    swing = {n: r * sin(printed[n].value * 1e-3) for n in ("phi", "theta")}
    figures = [
        ("range of phi", 2 * printed["phi"].value, "mrad"),
        ("range of theta", 2 * printed["theta"].value, "mrad"),
        ("greatest angle between the stops", asin(room / 2 / r) * 1e3, "mrad"),
        ("motor gap moved by phi", swing["phi"] / MM, "mm"),
        ("motor gap moved by theta", swing["theta"] / MM, "mm"),
        ("least central gap for the whole theta", printed["gap_low"].value + swing["theta"] / MM, "mm"),
        ("greatest central gap for the whole theta", printed["gap_high"].value - swing["theta"] / MM, "mm"),
    ]
    printed_ranges = all(printed[f"{n}_range"].agrees(2 * printed[n].value) for n in ("phi", "theta"))
    return Outcome(figures, printed_ranges and 2 * max(swing.values()) <= room)


def _polynomial(plant: Plant, lv3: str) -> maglev_stage.InputPolynomial:
    return maglev_stage.input_polynomial(values(plant), lv3)


def _box(plant: Plant, *names: str) -> list[Signal]:
    return [s for s in plant.states if s.name in names]


def _magnitudes(plant: Plant, printed: Published, lv3: str) -> tuple[list[tuple[str, float, str]], bool]:
    """Return the maxima of a2..a9 at 20 and 30 mm, and whether a2, a3, a7 dominate at 20, 25 and 30 mm."""
    model = _polynomial(plant, lv3)
    gaps = np.array([printed["gap_low"].value, 25.0, printed["gap_high"].value])
    box = [Signal(n, "rad", -printed[n].value, printed[n].value) for n in ("phi", "theta")]
    terms = {n: model.coefficients[n] for n in (*DOMINANT, *SMALL)}
    found = magnitude.magnitudes(terms, {**model.x, **model.u}, box, "y", gaps * MM, {"u_x": 0.0, "u_z": 0.0})
    figures = []
    for name in sorted(terms):
        unit = "m/s^2/A" if name in DOMINANT else "m/s^2/A^2"
        figures += [(f"{name} at {gaps[k]:g} mm", float(found.of(name)[k]), unit) for k in (0, 2)]
    least = np.min([found.of(n) for n in DOMINANT], axis=0)
    return figures, bool((least > np.max([found.of(n) for n in SMALL], axis=0)).all())


def _under(model: maglev_stage.InputPolynomial, law: Mapping[str, ca.SX], w: Mapping[str, ca.SX]) -> dict[str, ca.SX]:
    inputs = {**model.u, **model.v}
    old, new = ca.vcat(list(inputs.values())), ca.vcat([law[n] for n in inputs])
    return {n: ca.substitute(e, old, new) for n, e in model.accelerations().items()}


def _vanishes(expr: ca.SX, model: maglev_stage.InputPolynomial, w: Mapping[str, ca.SX]) -> bool:
    points = np.random.default_rng(13).uniform(-1.0, 1.0, (8, 50))
    scale = np.array([0.0065, 0.003, 0.014, *[10.0] * 5])[:, None]
    at = scale * points + np.array([0.0245, *[0.0] * 7])[:, None]
    function = ca.Function("rest", [ca.vcat([*model.x.values(), *w.values()])], [expr])
    residual = np.abs(np.asarray(function(at))).ravel()
    return bool((residual <= 1e-9 * (1 + np.abs(at[3:]).max(axis=0))).all())
