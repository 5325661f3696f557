"""Audit of the motor: levitation, the misprints of (3) and Table I, cogging.

The four motors hold the platen level at a gap g when 4 F_V(g, i_d) + M_y G = 0, a quadratic in i_d with the
discriminant D = (K_v2 L_v2)^2 - 4 K_v3 L_v3 (K_v1 L_v1 - M_y G/4). A real holding current needs D >= 0.
"""

from collections.abc import Callable
from math import nan, sqrt

import casadi as ca
import numpy as np
from scipy.optimize import brentq

from designs.maglev_5dof import control
from designs.maglev_5dof.paper.bench import FIELD, FORCES, MM, Bench, geometry, values
from models import pmlsm, slotted_field
from synth.plant import Plant
from synth.report.audit import Outcome, Published, recomputes

COTH, CSCH = pmlsm.Reading("coth2"), pmlsm.Reading("csch2")


@recomputes("F-1", *FORCES, "M_y", "G")
def levitation(bench: Bench, printed: Published) -> Outcome:
    """Recompute the gap of balance without current and the holding currents."""
    low, high = printed["gap_low"].value * MM, printed["gap_high"].value * MM
    limit = printed["peak_current"].value / sqrt(2)
    gaps = np.linspace(low, high, 27)

    def held(reading: pmlsm.Reading) -> bool:
        return all(abs(holding_current(bench.plant, g, reading)) <= limit for g in gaps)

    balance = _crossing(lambda g: _quadratic(bench.plant, g, CSCH)[0])
    figures = [
        ("gap of balance without current", balance / MM, "mm"),
        ("i_d at 25 mm", holding_current(bench.plant, 0.025, COTH), "A"),
        ("i_d at 25 mm, csch^2", holding_current(bench.plant, 0.025, CSCH), "A"),
        ("i_d at 18 mm, csch^2", holding_current(bench.plant, 0.018, CSCH), "A"),
        ("i_d at 31 mm, csch^2", holding_current(bench.plant, 0.031, CSCH), "A"),
    ]
    return Outcome(figures, held(pmlsm.PRINTED), held(COTH) and held(CSCH))


@recomputes("F-2", *FORCES, "M_y", "G")
def printed_power(bench: Bench, printed: Published) -> Outcome:
    """Recompute the discriminant of the holding current with K_v2 ~ 1/p^2."""
    squared = pmlsm.Reading("coth2", 2)
    g, least = 0.025, _crossing(lambda gap: discriminant(bench.plant, gap, squared))
    figures = [
        ("discriminant at 25 mm with 1/p^2", discriminant(bench.plant, g, squared), "N^2/A^2"),
        ("discriminant at 25 mm with 1/p", discriminant(bench.plant, g, COTH), "N^2/A^2"),
        ("least gap with a real i_d, 1/p^2", least / MM, "mm"),
        ("K_v2^2/(4 K_v1 K_v3) with 1/p^2", _ratio(bench.plant, squared), "1"),
        ("K_v2^2/(4 K_v1 K_v3) with 1/p", _ratio(bench.plant, COTH), "1"),
    ]
    return Outcome(figures, discriminant(bench.plant, g, squared) >= 0)


@recomputes("F-3", *FORCES)
def pole_pairs(bench: Bench, printed: Published) -> Outcome:
    """Recompute the thrust at 25 mm with p = 3 and p = 6 against the slotted field."""
    field = sqrt(2) * slotted_field.extrapolated(geometry(bench.plant), 0.025, bench.cells).value.thrust
    readings = (pmlsm.Reading(p_counts="pole_pairs"), pmlsm.STRESS)
    gap, current, p = ca.SX(0.025), ca.SX(-1.0), values(bench.plant)
    with_3, with_6 = (float(pmlsm.thrust(gap, current, p, reading)) for reading in readings)
    figures = [
        ("F_H, p = 3", with_3, "N/A"),
        ("F_H, p = 6", with_6, "N/A"),
        ("F_H, finite differences", field, "N/A"),
    ]
    return Outcome(figures, abs(with_3 / field - 1) < 0.05, abs(with_6 / field - 1) < 0.05)


@recomputes("F-4", *FIELD)
def cogging(bench: Bench, printed: Published) -> Outcome:
    """Recompute the cogging of the slotted field beside the thrust at the continuous current."""
    gaps = {g: slotted_field.extrapolated(geometry(bench.plant), g * MM, bench.cells).value for g in (15, 20, 25)}
    share = {g: 100 * f.cogging / (sqrt(2) * control.RATED * f.thrust) for g, f in gaps.items()}
    figures = [(f"cogging at {g} mm", f.cogging, "N") for g, f in gaps.items()]
    figures += [(f"share of the continuous thrust at {g} mm", share[g], "%") for g in gaps]
    return Outcome(figures, all(s < 1.0 for s in share.values()))


def discriminant(plant: Plant, gap: float, reading: pmlsm.Reading) -> float:
    """Return D of the holding current at a gap in m, N^2/A^2; below 0 no current holds the platen."""
    c, b, a = _quadratic(plant, gap, reading)
    return b**2 - 4 * a * c


def holding_current(plant: Plant, gap: float, reading: pmlsm.Reading) -> float:
    """Return the smaller i_d in A rms that holds the level platen at a gap in m; NaN where none does."""
    c, b, a = _quadratic(plant, gap, reading)
    D = b**2 - 4 * a * c
    return -2 * c / (b + sqrt(D)) if D >= 0 else nan


def _quadratic(plant: Plant, gap: float, reading: pmlsm.Reading) -> tuple[float, float, float]:
    """Return c, b, a of c + b i_d + a i_d^2 = F_V + M_y G/4."""
    p = values(plant)
    K, L = pmlsm.constants(p, reading), pmlsm.coefficients(ca.SX(gap), p, reading)
    free = p["M_y"] * p["G"] / 4 - K.K_v1 * L.L_v1
    return float(free), float(K.K_v2 * L.L_v2), float(-K.K_v3 * L.L_v3)


def _ratio(plant: Plant, reading: pmlsm.Reading) -> float:
    K = pmlsm.constants(values(plant), reading)
    return float(K.K_v2**2 / (4 * K.K_v1 * K.K_v3))


def _crossing(value: Callable[[float], float]) -> float:
    """Return the gap in m, from 5 to 100 mm, at which `value` changes its sign; NaN where it does not."""
    ends = 0.005, 0.1
    return nan if value(ends[0]) * value(ends[1]) > 0 else float(brentq(value, *ends, xtol=1e-12))
