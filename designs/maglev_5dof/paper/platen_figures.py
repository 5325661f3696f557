"""Figures of the levitated platen: levitation current, thrust, dominant terms of (9), and the inverse (12).

The four motors hold the platen level at a gap g when 4 F_V(g, i_d) + M_y G = 0, a quadratic in i_d: `pmlsm.balance`.
(9) is the full model (6), (7) as a polynomial in v; its coefficients are maximised over the box of angles, as in (10).

Source: Fulford, Maggiore, Apkarian, "Control of a 5DOF Magnetically Levitated Positioning Stage", (1)-(13).
"""

from collections.abc import Callable, Mapping
from functools import lru_cache
from math import nan
from typing import NamedTuple

import casadi as ca
import numpy as np
from scipy.optimize import brentq

from designs.maglev_5dof.paper import polynomial
from designs.maglev_5dof.paper.polynomial import InputPolynomial, inverse
from models import maglev_stage, pmlsm, slotted_field
from synth.analyse.numerics import magnitude
from synth.plant import Plant
from synth.signals import Signal

VARIANTS = {
    "printed": pmlsm.PRINTED,
    "coth2": pmlsm.Variant("coth2"),
    "csch2": pmlsm.STRESS,
    "squared": pmlsm.Variant("coth2", 2),
    "pole_pairs": pmlsm.Variant(p_counts="pole_pairs"),
}
# (9): what (11) keeps and drops of y''
DOMINANT, SMALL = ("a2", "a3", "a7"), ("a4", "a5", "a6", "a8", "a9")


class Dominance(NamedTuple):
    """The maxima (3,) of |a2| .. |a9| over the angles at three gaps, and whether a2, a3, a7 exceed the others there."""

    greatest: Mapping[str, np.ndarray]
    dominated: bool


class Inversion(NamedTuple):
    """How many axes of (11) are double integrators under (12), and the greatest |q''| of (9) under it at w = 0."""

    axes: int
    residual: Mapping[str, float]


@lru_cache(maxsize=8)
def balance(plant: Plant, variant: str) -> Callable[[float], pmlsm.Balance]:
    """Return the force balance of a motor that holds a quarter of the platen, as a function of the gap in m."""
    p = maglev_stage.nominal(plant)
    return pmlsm.balance(p["M_y"] * p["G"] / 4, p, VARIANTS[variant])


def largest_current(plant: Plant, low: float, high: float, variant: str) -> float:
    """Return the largest direct current in A that holds the platen between two gaps in m; NaN where none does."""
    return float(np.max([abs(balance(plant, variant)(gap).current) for gap in np.linspace(low, high, 27)]))


def gap_of_zero(plant: Plant, variant: str, quantity: str) -> float:
    """Return the gap in m, from 5 to 100 mm, at which a quantity of the balance changes its sign; NaN without one."""

    def value(gap: float) -> float:
        return float(getattr(balance(plant, variant)(gap), quantity))

    ends = 0.005, 0.1
    return nan if value(ends[0]) * value(ends[1]) > 0 else float(brentq(value, *ends, xtol=1e-12))


def stress_ratio(plant: Plant, variant: str) -> float:
    """Return K_v2^2 / (4 K_v1 K_v3)."""
    K = pmlsm.constants(maglev_stage.nominal(plant), VARIANTS[variant])
    return float(K.K_v2**2 / (4 * K.K_v1 * K.K_v3))


def thrust(plant: Plant, gap: float, variant: str) -> float:
    """Return the thrust per rms ampere in N/A at a gap in m."""
    return float(pmlsm.thrust(ca.SX(gap), ca.SX(-1.0), maglev_stage.nominal(plant), VARIANTS[variant]))


@lru_cache(maxsize=8)
def slotted_forces(plant: Plant, gap: float, cells: int) -> slotted_field.Forces:
    """Return the forces of the slotted field at a gap in m."""
    return slotted_field.extrapolate(maglev_stage.geometry(plant), gap, cells).value


def a1(plant: Plant, gap: float) -> float:
    """Return a1 of (9) in m/s^2 at a gap in m, at zero angles and thrust currents."""
    model = _polynomial(plant)
    symbols = ca.vcat([*model.x.values(), *model.u.values()])
    return float(ca.Function("a1", [symbols], [model.coefficients["a1"]])([gap, 0, 0, 0, 0]))


def decoupling(plant: Plant) -> magnitude.Conditioning:
    """Return the least determinant and the greatest condition number of the matrix in (12) over the box of poses."""
    model = polynomial.simplified(_polynomial(plant))
    return magnitude.conditioning(model.decoupling(), model.x, _box(plant, "y", "phi", "theta"))


@lru_cache(maxsize=8)
def _polynomial(plant: Plant, lv3: str = "csch2") -> InputPolynomial:
    return polynomial.input_polynomial(maglev_stage.nominal(plant), lv3)


def _box(plant: Plant, *names: str) -> list[Signal]:
    return [s for s in plant.states if s.name in names]


@lru_cache(maxsize=8)
def dominance(plant: Plant, lv3: str, low: float, high: float, phi: float, theta: float) -> Dominance:
    """Return the terms of (9) between two gaps in m, at 25 mm and over angles of +-phi and +-theta in rad."""
    model, gaps = _polynomial(plant, lv3), np.array([low, 0.025, high])
    box = [Signal(n, "rad", -end, end) for n, end in (("phi", phi), ("theta", theta))]
    terms = {n: model.coefficients[n] for n in (*DOMINANT, *SMALL)}
    magnitudes = magnitude.magnitudes(terms, {**model.x, **model.u}, box, "y", gaps, {"u_x": 0.0, "u_z": 0.0})
    least = np.min([magnitudes.of(n) for n in DOMINANT], axis=0)
    dominated = bool((least > np.max([magnitudes.of(n) for n in SMALL], axis=0)).all())
    return Dominance({n: magnitudes.of(n) for n in terms}, dominated)


def inversion(plant: Plant) -> Inversion:
    """Return (11) under (12), which is (13), and the residual accelerations of the full model (9) under it."""
    full = _polynomial(plant)
    model = polynomial.simplified(full)
    w = {n: ca.SX.sym(f"w_{n}") for n in maglev_stage.RATE}
    law = inverse(model, w)
    nominal, residual = _closed_loop(model, law), _closed_loop(full, law)
    zero = ca.vcat([*w.values(), *full.u.values()])
    terms = {n: ca.substitute(residual[n], zero, ca.SX.zeros(zero.numel())) for n in ("y", "phi", "theta")}
    gaps, angles = [mm * 1e-3 for mm in (18, 20, 25, 30, 31)], _box(plant, "phi", "theta")
    magnitudes = [magnitude.magnitudes(terms, full.x, angles, "y", [gap], {}) for gap in gaps]
    remainder = {n: max(float(at.of(n)[0]) for at in magnitudes) for n in terms}
    return Inversion(sum(_vanishes(nominal[n] - w[n], model, w) for n in w), remainder)


def _closed_loop(model: InputPolynomial, law: Mapping[str, ca.SX]) -> dict[str, ca.SX]:
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
