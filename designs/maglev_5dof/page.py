"""The report of the maglev stage: the standard sections and what this stage adds; its prose is in report.md."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import casadi as ca
import numpy as np

from designs.maglev_5dof import control, emitted, loops
from models import maglev_stage, pmlsm
from synth.analyse.margins import Margins
from synth.emit.write import Emitted
from synth.plant import Plant, Symbols
from synth.report import figures, page, sections, standard, template
from synth.report.audit import Row
from synth.report.prose import Value
from synth.simulate.experiment import Experiment
from synth.statespace import StateSpace
from synth.verify.cost import Cost
from synth.verify.evidence import Evidence

ABOUT = (
    "The five-axis magnetically levitated stage of Fulford, Maggiore and Apkarian: four iron-cored linear motors "
    "carry and move a platen. This page was computed from the physics; every figure on it was measured on the C "
    "that ships, or on the model that the C was derived from."
)
UNITS = {"y": "m", "x": "m", "z": "m", "phi": "rad", "theta": "rad"}
COUNTS = {"y": 10e-6, "x": 10e-6, "z": 10e-6, "phi": 20e-6, "theta": 20e-6}
LONGEST, WINDOW = 30.0, (0.0, 5.0)  # s: what runs longer is drawn over the window
_GAP, _TILT = ("F-11", "Fig. 4 of the paper"), ("F-12", "Fig. 5 of the paper")
BESIDE = {
    **dict.fromkeys(("y_22_29", "y_29_22", "y_20_27", "y_27_20", "paper_y_22_29", "paper_y_29_22"), (_GAP,)),
    **dict.fromkeys(("theta_10", "paper_theta_10"), (_TILT,)),
    **dict.fromkeys(("x_30", "z_30"), (("F-13", "Table III of the paper"),)),
    "ellipse": (("F-14", "Fig. 6 of the paper"), ("F-16", "section IV-B")),
    "tracking": (("F-15", "Figs. 7 and 8 of the paper"), ("F-16", "section IV-B")),
}


@dataclass(frozen=True, eq=False)
class Opened:
    """The loop of an axis at a gap, as the report shows it."""

    signal: str
    label: str
    L: StateSpace
    margins: Margins


def report(
    files: Mapping[str, Emitted],
    evidence: Evidence,
    experiments: Sequence[Experiment],
    rows: Sequence[Row],
    cost: Cost | None,
) -> str:
    """Return the whole report as one HTML document."""
    plant = maglev_stage.plant()
    opened = [Opened(o.axis, f"{o.gap * 1e3:.4g} mm", o.L, o.margins) for o in loops.all_loops(plant)]
    parts = (
        standard.model(plant, forces),
        standard.law(control.controller(plant).rounded(np.float32)),
        standard.gains(emitted.gains(plant, np.float32)),
        standard.loops(opened),
        standard.experiments(experiments, _shown(experiments, {row.id: row.published.text for row in rows})),
        standard.audit(rows),
        standard.verification(evidence, "1 A"),
        sections.cost(cost),
        standard.files(files),
    )
    outputs = "direct and quadrature currents of 4 motors, rms"
    facts = standard.facts(control.TIME, np.float32, "6 encoders, 5 set-points", outputs)
    return template.assembled(control.NAME, ABOUT, facts, parts, _values(plant))


def forces(x: Symbols, u: Symbols, p: Symbols) -> dict[str, ca.SX]:
    """Return the factors of F(1)-(4) and the normal forces F_V by motor, as the physics computes them; h = K_h L_h."""
    K = pmlsm.constants(p)
    named = {"k_w1": pmlsm.winding_factor(p), "K_v1": K.K_v1, "K_v3": K.K_v3, "K_h": K.K_h}
    for j, (g, thrust) in enumerate(zip(maglev_stage.gaps(x, p), maglev_stage.QUADRATURE, strict=True), 1):
        named |= {f"lambda_{j}": pmlsm.permeance_factor(g, p), f"K_c{j}": pmlsm.carter_coefficient(g, p)}
        named |= {f"B_{j}": pmlsm.magnet_field(g, p), f"F_V{j}": pmlsm.normal_force(g, u[f"i_d{j}"], u[thrust], p)}
        named[f"h_{j}"] = K.K_h * pmlsm.coefficients(g, p).L_h
    return named


def _values(plant: Plant) -> dict[str, Value]:
    """Return what report.md asks for."""
    k_s, own = plant.parameter("k_s_phi").value, -float(control.gain(control.AXES[3]).K[0, 0])
    cancelled = control.COMPENSATED["k_s_phi"]
    return {
        "compensated_phi": cancelled,
        "compensated_theta": control.COMPENSATED["k_s_theta"],
        "k_s_phi": k_s,
        "k_s_theta": plant.parameter("k_s_theta").value,
        "stiffness": own,
        "stable_above": (cancelled * k_s - own) / k_s,
    }


def _shown(experiments: Sequence[Experiment], printed: Mapping[str, str]) -> standard.Shown:
    beside = {name: ". ".join(f"{figure}: {printed[row]}" for row, figure in rows) for name, rows in BESIDE.items()}
    drawn = {e.name: (_path(e),) for e in experiments if e.name == "ellipse"}
    return standard.Shown(UNITS, COUNTS, beside, drawn, LONGEST, WINDOW)


def _path(e: Experiment) -> page.Figure:
    set_point, path = (np.array([source[n] for n in ("x", "z", "y")]) for source in (e.references, e.trajectory))
    drawn = figures.svg(figures.path_3d(set_point, path, ("x", "z", "y")), "path-ellipse")
    return page.Figure(drawn, "The path through space")
