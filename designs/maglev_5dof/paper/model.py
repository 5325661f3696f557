"""Audit of motors and model: levitation, misprints, cogging, the dominant terms of (9), its inverse (12), angles.

The four motors hold the platen level at a gap g when 4 F_V(g, i_d) + M_y G = 0, a quadratic in i_d: `pmlsm.balance`.
(9) is the full model (6), (7) as a polynomial in v; its coefficients are maximised over the box of angles, as in (10).
"""

from collections.abc import Callable, Mapping
from math import asin, nan, sin, sqrt

import casadi as ca
import numpy as np
from scipy.optimize import brentq

from designs.maglev_5dof import control
from designs.maglev_5dof.paper.bench import FIELD, FORCES, MAGNETS, MM, Bench
from models import maglev_polynomial, maglev_stage, pmlsm, slotted_field
from models.maglev_polynomial import InputPolynomial, inverse
from synth.analyse import magnitude
from synth.plant import Plant
from synth.report.audit import Outcome, Published, recomputes
from synth.signals import Signal

Figures = list[tuple[str, float, str]]

COTH, CSCH, SQUARED = pmlsm.Reading("coth2"), pmlsm.Reading("csch2"), pmlsm.Reading("coth2", 2)
DOMINANT, SMALL = ("a2", "a3", "a7"), ("a4", "a5", "a6", "a8", "a9")


@recomputes("F-1", *FORCES, "M_y", "G")
def levitation(bench: Bench, printed: Published) -> Outcome:
    """Recompute the gap of balance without current and the holding currents."""
    limit = printed["peak_current"].value / sqrt(2)
    gaps = np.linspace(printed["gap_low"].value * MM, printed["gap_high"].value * MM, 27)

    def held(reading: pmlsm.Reading) -> bool:
        return all(abs(_balance(bench, g, reading).current) <= limit for g in gaps)

    balance = _crossing(lambda g: _balance(bench, g, CSCH).free)
    figures = [
        ("gap of balance without current", balance / MM, "mm"),
        ("i_d at 25 mm", _balance(bench, 0.025, COTH).current, "A"),
        *((f"i_d at {g / MM:g} mm, csch^2", _balance(bench, g, CSCH).current, "A") for g in (0.025, 0.018, 0.031)),
    ]
    return Outcome(figures, held(pmlsm.PRINTED), held(COTH) and held(CSCH))


@recomputes("F-2", *FORCES, "M_y", "G")
def printed_power(bench: Bench, printed: Published) -> Outcome:
    """Recompute the discriminant of the holding current with K_v2 ~ 1/p^2."""
    squared, single = (_balance(bench, 0.025, reading).discriminant for reading in (SQUARED, COTH))
    least = _crossing(lambda gap: _balance(bench, gap, SQUARED).discriminant)
    figures = [
        ("discriminant at 25 mm with 1/p^2", squared, "N^2/A^2"),
        ("discriminant at 25 mm with 1/p", single, "N^2/A^2"),
        ("least gap with a real i_d, 1/p^2", least / MM, "mm"),
        ("K_v2^2/(4 K_v1 K_v3) with 1/p^2", _ratio(bench.plant, SQUARED), "1"),
        ("K_v2^2/(4 K_v1 K_v3) with 1/p", _ratio(bench.plant, COTH), "1"),
    ]
    return Outcome(figures, squared >= 0)


def _balance(bench: Bench, gap: float, reading: pmlsm.Reading) -> pmlsm.Balance:
    p = maglev_stage.nominal(bench.plant)
    return pmlsm.balance(gap, p["M_y"] * p["G"] / 4, p, reading)


def _ratio(plant: Plant, reading: pmlsm.Reading) -> float:
    K = pmlsm.constants(maglev_stage.nominal(plant), reading)
    return float(K.K_v2**2 / (4 * K.K_v1 * K.K_v3))


def _crossing(value: Callable[[float], float]) -> float:
    """Return the gap in m, from 5 to 100 mm, at which `value` changes its sign; NaN where it does not."""
    ends = 0.005, 0.1
    return nan if value(ends[0]) * value(ends[1]) > 0 else float(brentq(value, *ends, xtol=1e-12))


@recomputes("F-3", *FORCES)
def pole_pairs(bench: Bench, printed: Published) -> Outcome:
    """Recompute the thrust at 25 mm with p = 3 and p = 6 against the slotted field."""
    field = sqrt(2) * _field(bench, 0.025).thrust
    readings = (pmlsm.Reading(p_counts="pole_pairs"), pmlsm.STRESS)
    gap, current, p = ca.SX(0.025), ca.SX(-1.0), maglev_stage.nominal(bench.plant)
    with_3, with_6 = (float(pmlsm.thrust(gap, current, p, reading)) for reading in readings)
    thrusts = {"p = 3": with_3, "p = 6": with_6, "finite differences": field}
    figures = [(f"F_H, {name}", thrust, "N/A") for name, thrust in thrusts.items()]
    return Outcome(figures, abs(with_3 / field - 1) < 0.05, abs(with_6 / field - 1) < 0.05)


@recomputes("F-4", *FIELD)
def cogging(bench: Bench, printed: Published) -> Outcome:
    """Recompute the cogging of the slotted field beside the thrust at the continuous current."""
    fields = {g: _field(bench, g * MM) for g in (15, 20, 25)}
    share = {g: 100 * f.cogging / (sqrt(2) * control.RATED * f.thrust) for g, f in fields.items()}
    figures = [(f"cogging at {g} mm", f.cogging, "N") for g, f in fields.items()]
    figures += [(f"share of the continuous thrust at {g} mm", share[g], "%") for g in fields]
    return Outcome(figures, all(s < 1.0 for s in share.values()))


def _field(bench: Bench, gap: float) -> slotted_field.Forces:
    return slotted_field.extrapolated(maglev_stage.geometry(bench.plant), gap, bench.cells).value


@recomputes("F-5", *FORCES, "M_y", "r")
def dominance_as_printed(bench: Bench, printed: Published) -> Outcome:
    """Recompute Fig. 3 with coth^2."""
    return Outcome(*_magnitudes(bench, printed, "coth2"))


@recomputes("F-5b", *FORCES, "M_y", "r")
def dominance(bench: Bench, printed: Published) -> Outcome:
    """Recompute Fig. 3 with csch^2."""
    figures, dominated = _magnitudes(bench, printed, "csch2")
    return Outcome(figures, _magnitudes(bench, printed, "coth2")[1], dominated)


def _magnitudes(bench: Bench, printed: Published, lv3: str) -> tuple[Figures, bool]:
    """Return the maxima of a2..a9 at 20 and 30 mm, and whether a2, a3, a7 dominate at 20, 25 and 30 mm."""
    model = _polynomial(bench, lv3)
    gaps = np.array([printed["gap_low"].value, 25.0, printed["gap_high"].value])
    box = [Signal(n, "rad", -printed[n].value, printed[n].value) for n in ("phi", "theta")]
    terms = {n: model.coefficients[n] for n in (*DOMINANT, *SMALL)}
    found = magnitude.magnitudes(terms, {**model.x, **model.u}, box, "y", gaps * MM, {"u_x": 0.0, "u_z": 0.0})
    units = dict.fromkeys(DOMINANT, "m/s^2/A") | dict.fromkeys(SMALL, "m/s^2/A^2")
    figures = [(f"{n} at {gaps[k]:g} mm", float(found.of(n)[k]), units[n]) for n in sorted(terms) for k in (0, 2)]
    least = np.min([found.of(n) for n in DOMINANT], axis=0)
    return figures, bool((least > np.max([found.of(n) for n in SMALL], axis=0)).all())


def _polynomial(bench: Bench, lv3: str = "csch2") -> InputPolynomial:
    return maglev_polynomial.input_polynomial(maglev_stage.nominal(bench.plant), lv3)


def _box(bench: Bench, *names: str) -> list[Signal]:
    return [s for s in bench.plant.states if s.name in names]


@recomputes("F-6", *MAGNETS, "M_y", "G")
def order_of_a1(bench: Bench, printed: Published) -> Outcome:
    """Recompute a1 at zero angles and thrust currents."""
    model = _polynomial(bench)
    symbols = ca.vcat([*model.x.values(), *model.u.values()])
    a1 = ca.Function("a1", [symbols], [model.coefficients["a1"]])
    values = {g: float(a1([g * MM, 0, 0, 0, 0])) for g in (20, 25, 30)}
    order, largest = printed["order"].value, max(abs(a) for a in values.values())
    figures = [(f"a1 at {g} mm", a, "m/s^2") for g, a in values.items()]
    return Outcome(figures, order / sqrt(10) <= largest <= order * sqrt(10))


@recomputes("F-7", *FORCES, "M_y", "r", "I_x", "I_z")
def invertibility(bench: Bench, printed: Published) -> Outcome:
    """Recompute the least determinant and the greatest condition number of the matrix in (12)."""
    model = maglev_polynomial.simplified(_polynomial(bench))
    found = magnitude.conditioning(model.decoupling(), model.x, _box(bench, "y", "phi", "theta"))
    figures = [
        ("least |det|", found.min_abs_det, "m rad^2/s^6/A^3"),
        ("greatest condition number", found.max_cond, "1"),
    ]
    return Outcome(figures, found.min_abs_det > 0 and found.max_cond < 1e3)


@recomputes("F-19", *MAGNETS, "M_y", "r", "I_x", "I_z", "G", "k_s_phi", "k_s_theta")
def double_integrators(bench: Bench, printed: Published) -> Outcome:
    """Recompute (13): the accelerations of (11) under (12), and what remains on the full model."""
    full = _polynomial(bench)
    model = maglev_polynomial.simplified(full)
    w = {n: ca.SX.sym(f"w_{n}") for n in maglev_stage.RATE}
    law = inverse(model, w)
    nominal, rest = _under(model, law), _under(full, law)
    reduced = sum(_vanishes(nominal[n] - w[n], model, w) for n in w)
    zero = ca.vcat([*w.values(), *full.u.values()])
    units = {"y": "m/s^2", "phi": "rad/s^2", "theta": "rad/s^2"}
    terms = {n: ca.substitute(rest[n], zero, ca.SX.zeros(zero.numel())) for n in units}
    gaps, angles = [g * MM for g in (18, 20, 25, 30, 31)], _box(bench, "phi", "theta")
    found = [magnitude.magnitudes(terms, full.x, angles, "y", [gap], {}) for gap in gaps]
    greatest = {n: max(float(at.of(n)[0]) for at in found) for n in terms}
    figures = [("axes of (11) that obey x'' = w", float(reduced), "1")]
    figures += [(f"greatest |{n}''| of (9) at w = 0", greatest[n], unit) for n, unit in units.items()]
    return Outcome(figures, reduced == printed["axes"].value)


def _under(model: InputPolynomial, law: Mapping[str, ca.SX]) -> dict[str, ca.SX]:
    """Return the accelerations of a model under a law."""
    inputs = {**model.u, **model.v}
    old, new = ca.vcat(list(inputs.values())), ca.vcat([law[n] for n in inputs])
    return {n: ca.substitute(e, old, new) for n, e in model.accelerations().items()}


def _vanishes(expr: ca.SX, model: InputPolynomial, w: Mapping[str, ca.SX]) -> bool:
    points = np.random.default_rng(13).uniform(-1.0, 1.0, (8, 50))
    scale = np.array([0.0065, 0.003, 0.014, *[10.0] * 5])[:, None]
    at = scale * points + np.array([0.0245, *[0.0] * 7])[:, None]
    function = ca.Function("rest", [ca.vcat([*model.x.values(), *w.values()])], [expr])
    residual = np.abs(np.asarray(function(at))).ravel()
    return bool((residual <= 1e-9 * (1 + np.abs(at[3:]).max(axis=0))).all())


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
    r, low, high = bench.plant.parameter("r").value, printed["gap_low"].value, printed["gap_high"].value
    room, swing = (high - low) * MM, {n: r * sin(printed[n].value * 1e-3) for n in ("phi", "theta")}
    figures = [
        *((f"range of {n}", 2 * printed[n].value, "mrad") for n in swing),
        ("greatest angle between the stops", asin(room / 2 / r) * 1e3, "mrad"),
        *((f"motor gap moved by {n}", way / MM, "mm") for n, way in swing.items()),
        ("least central gap for the whole theta", low + swing["theta"] / MM, "mm"),
        ("greatest central gap for the whole theta", high - swing["theta"] / MM, "mm"),
    ]
    printed_ranges = all(printed[f"{n}_range"].agrees(2 * printed[n].value) for n in swing)
    return Outcome(figures, printed_ranges and 2 * max(swing.values()) <= room)
