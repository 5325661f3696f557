"""Report of the LQG design: its contents beyond the common report of the planar stage."""

from collections.abc import Mapping
from functools import partial

import numpy as np

from designs.planar_6dof import allocation, lqg, page
from designs.planar_6dof import loops as shared
from designs.planar_6dof.lqg import ERROR, TIME
from designs.planar_6dof_lqg import core, loops
from models import planar_stage
from synth.analyse.loops import disk
from synth.plant import Plant
from synth.report import bode, figures, sections
from synth.report.page import Figure, Section, Text
from synth.report.prose import Value
from synth.statespace import StateSpace

LINE = "reduced-order LQG in x, y and φ, (26)-(49), on positions as measured; lead-lag in z, θ and ψ, (23)-(25)"
PUBLISHED = dict.fromkeys(("step_x", "step_y", "standstill"), (("Y-40", "section 5.3"),))
EQUATIONS = (
    ("Y(31)", "x'' = b i_C,  y'' = b (i_A + i_B),  φ'' = c (i_B - i_A),  z_1' = x,  z_2' = y,  z_3' = φ"),
    ("Y(43)", "min ∫ (x' Q x + u' u) dt,  u held over T,  u = K x"),
)
LOW, HIGH, POINTS = 0.3, 0.999, 300  # Hz, of the Nyquist frequency, points of singular values


def of_plant(plant: Plant) -> page.Contents:
    """Return the contents of this design."""
    block, open_loops, whole = lqg.controller(plant), loops.all_loops(plant), (_horizontal_loop(plant),)
    values, cost = _values(plant), core.cost_table
    return page.Contents(block, LINE, EQUATIONS, open_loops, PUBLISHED, whole, False, True, values, cost)


def _values(plant: Plant) -> dict[str, Value]:
    """Return the values that are named in report.md."""
    stated = lqg.PER_AMPERE * plant.parameter("M").value
    errors = {f"{axis}_error_mm": 1e3 * ERROR[axis] for axis in "xy"}
    return {**errors, "weaker": 1 - allocation.force_constant(plant) / stated}


def _horizontal_loop(plant: Plant) -> Section:
    open_loops = loops.horizontals(plant)
    refusal = (
        f"The gain H of (42) cannot be used. The library refuses it: {loops.rejection_message().replace('-1', '−1')}."
    )
    disks = {label: {cut: disk.of_loop(L) for cut, L in each.items()} for label, each in open_loops.items()}
    svg = figures.svg(bode.disks(disks[loops.SHIPPED]), "disks")
    shipped = Figure(svg, "Disk margin over frequency, as shipped, by where the loop is opened.")
    return Section(
        "The horizontal loop as a whole", (*_singular(open_loops), sections.disks(disks), shipped, Text(refusal))
    )


def _singular(open_loops: Mapping[str, Mapping[str, StateSpace]]) -> tuple[Figure, ...]:
    w = 2 * np.pi * np.geomspace(LOW, HIGH * 0.5 / TIME.period_s, POINTS)
    arm = planar_stage.plant().parameter("a").value
    places = f"x, y and φ, φ times an arm of {1e3 * arm:.4g} mm"
    cuts = {
        ("currents", "i_AQ, i_BQ, i_CQ"): {label: each["currents"] for label, each in open_loops.items()},
        ("positions", places): {
            label: shared.scaled(each["positions"], {"phi": arm}) for label, each in open_loops.items()
        },
    }
    plots = []
    for (name, at), by_label in cuts.items():
        values = {label: bode.singular(L, w) for label, L in by_label.items()}
        svg = figures.svg(bode.singular_values(values), f"singular-{name}")
        plots.append(Figure(svg, f"Singular values of the loop opened at {at}."))
    return tuple(plots)


contents = partial(page.extra, of_plant)
