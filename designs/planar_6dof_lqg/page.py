"""The report of the LQG design."""

from collections.abc import Mapping, Sequence

import numpy as np

from designs.planar_6dof import allocation, drawings, lqg, vertical
from designs.planar_6dof import loops as shared_loops
from designs.planar_6dof import page as shared
from designs.planar_6dof.allocation import AXES, VERTICAL
from designs.planar_6dof.lqg import ERROR, STATES, TIME
from designs.planar_6dof.page_stage import SYMBOLS
from designs.planar_6dof_lqg import loops, orders
from models import halbach, planar_stage
from synth.emit.write import Emitted
from synth.plant import Plant
from synth.report import figures, page, sections, standard
from synth.report.audit import Row
from synth.report.notation import number
from synth.report.prose import Value
from synth.simulate.experiment import Experiment
from synth.verify.cost import Cost
from synth.verify.evidence import Evidence

BESIDE = {
    "step_x": (("Y-40", "section 5.3"),),
    "step_y": (("Y-40", "section 5.3"),),
    "standstill": (("Y-40", "section 5.3"),),
}
LAW = (
    ("Y(31)", "x'' = b i_C,  y'' = b (i_A + i_B),  φ'' = c (i_B - i_A),  z_1' = x,  z_2' = y,  z_3' = φ"),
    ("Y(43)", "min ∫ (x' Q x + u' u) dt,  u held over T,  u = K x"),
)
LOW, HIGH, POINTS = 0.3, 0.999, 300  # Hz, of the Nyquist frequency, points of singular values


def report(
    files: Mapping[str, Emitted],
    evidence: Evidence,
    experiments: Sequence[Experiment],
    rows: Sequence[Row],
    cost: Cost | None,
) -> str:
    """Return the whole report as one HTML document."""
    plant = planar_stage.plant()
    line = "reduced-order LQG in x, y and φ, (26)-(49), on positions as measured; lead-lag in z, θ and ψ, (23)-(25)"
    spent = orders.spent(experiments) if cost else ()
    parts = (_law(plant), _gains(plant), _loops(plant))
    own = shared.Contents(lqg.NAME, TIME, line, *parts, BESIDE, False, True, _values(plant), spent)
    return shared.report(own, files, evidence, experiments, rows, cost)


def _law(plant: Plant) -> page.Section:
    return standard.law(lqg.controller(plant).rounded(np.float32), (page.Equations((*LAW, *shared.upright())),))


def _gains(plant: Plant) -> page.Section:
    upright = [vertical.loop(axis, vertical.compensator(axis, TIME), TIME) for axis in VERTICAL]
    tables = (_weights(), _certificates(), _axes(plant), shared.compensators(upright, vertical.PART))
    return page.Section(standard.GAINS, tables)


def _weights() -> page.Table:
    used, printed = -lqg.gain().K, -lqg.gain(lqg.PRINTED_WEIGHTS).K
    rows = []
    for j, name in enumerate(STATES):
        gains = (", ".join(number(v, 6) for v in K[:, j]) for K in (used, printed))
        q, other = lqg.WEIGHTS[j], lqg.PRINTED_WEIGHTS[j]
        rows.append((name, number(q), next(gains), number(other), next(gains)))
    columns = ("state", "weight", "−K: i_AQ, i_BQ, i_CQ", "printed weight (47)", "−K of it")
    return page.Table("Gains of (49) at 800 Hz, R = I, and those of the printed weights", columns, tuple(rows))


def _certificates() -> page.Table:
    rows = []
    for label, weights in (("(49)", lqg.WEIGHTS), ("of (47)", lqg.PRINTED_WEIGHTS)):
        found = lqg.gain(weights).certificate
        poles = sorted({(round(p.real, 5), round(abs(p.imag), 5)) for p in found.poles})
        told = ", ".join(f"{re:g}" + (f" ± {im:g}i" if im else "") for re, im in poles)
        rows.append((label, found.residual, found.forward_error, found.least_eigenvalue, told))
    columns = ("K", "residual", "error of X", "least eigenvalue of X, scaled", "poles of A + B K, z")
    return page.Table("Certificates of the Riccati solutions", columns, tuple(rows), digits=2)


def _axes(plant: Plant) -> page.Table:
    rows: list[tuple[page.Cell, ...]] = []
    for axis in lqg.axes(plant):
        found = lqg.observer(axis)
        entries = (float(m[0, 0]) for m in (found.F, found.G, found.H, found.L))
        rows.append((SYMBOLS.get(axis.name, axis.name), axis.b, axis.k1, axis.k2, axis.k3, *entries))
    columns = ("axis", "b, 1/A", "k1, A", "k2, A s", "k3, A", "F = p", "G, 1/s", "H, 1/A/s", "L, 1/s")
    caption = "Axes and observers, per m or rad: gains on position, rate and sum of errors; the observer of the rate"
    return page.Table(caption, columns, tuple(rows), digits=5)


def _loops(plant: Plant) -> page.Section:
    found = loops.all_loops(plant)
    over = shared.over_pitch(planar_stage.plant(halbach.HARMONICS), lqg.controller(plant).rounded(np.float32))
    return page.Section(standard.LOOPS, (over,), (_whole(plant), *(shared.bodes(found, axis) for axis in AXES)))


def _values(plant: Plant) -> dict[str, Value]:
    """Return what report.md asks for."""
    stated = lqg.PER_AMPERE * plant.parameter("M").value
    return {
        "x_error_mm": 1e3 * ERROR["x"],
        "y_error_mm": 1e3 * ERROR["y"],
        "weaker": 1 - allocation.force_constant(plant) / stated,
    }


def _whole(plant: Plant) -> page.Section:
    found = loops.horizontals(plant)
    refused = page.Text(
        f"The gain H of (42) is no choice. The library refuses it: {loops.refusal().replace('-1', '−1')}."
    )
    disks = {label: each.disks() for label, each in found.items()}
    drawn = figures.svg(drawings.disks(disks[loops.SHIPPED]), "disks")
    caption = "Disk margin over frequency, as shipped, by where the loop is opened."
    blocks: tuple[page.Block, ...] = (
        *_singular(found),
        sections.disks(disks),
        page.Figure(drawn, caption),
        refused,
    )
    return page.Section("The horizontal loop as a whole", blocks)


def _singular(found: Mapping[str, shared_loops.Horizontal]) -> tuple[page.Figure, ...]:
    w = 2 * np.pi * np.geomspace(LOW, HIGH * 0.5 / TIME.period_s, POINTS)
    arm = planar_stage.plant().parameter("a").value
    cuts = {
        "currents": {label: each.currents for label, each in found.items()},
        "positions": {label: shared_loops.scaled(each.positions, {"phi": arm}) for label, each in found.items()},
    }
    captions = {
        "currents": "Singular values of the loop opened at i_AQ, i_BQ, i_CQ.",
        "positions": f"Singular values of the loop opened at x, y and φ, φ times an arm of {1e3 * arm:.4g} mm.",
    }
    made = ((name, {label: shared_loops.singular(L, w) for label, L in loops.items()}) for name, loops in cuts.items())
    return tuple(
        page.Figure(figures.svg(drawings.singular_values(values), f"singular-{name}"), captions[name])
        for name, values in made
    )
