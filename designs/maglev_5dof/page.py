"""What the report of the maglev stage adds to the standard one; its prose is in report.md."""

from typing import Any

import casadi as ca
import numpy as np

from designs.maglev_5dof import control, experiments
from models import maglev_stage, pmlsm
from synth.analyse import robustness
from synth.declaration import Stage
from synth.plant import Plant, Symbols
from synth.report import figures, page, standard, template
from synth.report.prose import Value
from synth.simulate.experiment import Experiment
from synth.verify import standard as verification

LONGEST, WINDOW = 30.0, (0.0, 5.0)  # s: what runs longer is drawn over the window
_GAP, _TILT = ("F-11", "Fig. 4 of the paper"), ("F-12", "Fig. 5 of the paper")
BESIDE = {
    **dict.fromkeys(("y_22_29", "y_29_22", "y_20_27", "y_27_20", "paper_y_22_29", "paper_y_29_22"), (_GAP,)),
    **dict.fromkeys(("theta_10", "paper_theta_10"), (_TILT,)),
    **dict.fromkeys(("x_30", "z_30"), (("F-13", "Table III of the paper"),)),
    "ellipse": (("F-14", "Fig. 6 of the paper"), ("F-16", "section IV-B")),
    "tracking": (("F-15", "Figs. 7 and 8 of the paper"), ("F-16", "section IV-B")),
}


def report(stage: Stage, files: Any, evidence: Any, runs: Any, rows: Any, cost: Any) -> str:
    """Return the report as one HTML document; arguments as `template.report`."""
    printed = {row.id: row.published.text for row in rows}
    beside = {
        name: ". ".join(f"{figure}: {printed[row]}" for row, figure in found if row in printed)
        for name, found in BESIDE.items()
    }
    drawn = {run.name: (_path(run),) for run in runs if run.name == "ellipse"}
    shown = standard.Shown(experiments.UNITS, experiments.COUNTS, beside, drawn, LONGEST, WINDOW)
    opened = standard.loops(robustness.opened(verification.loops(stage)))
    extra = template.Extra(_values(stage.plant), [opened], forces, shown=shown)
    return template.report(stage, files, evidence, runs, rows, cost, extra)


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


def _path(run: Experiment) -> page.Figure:
    set_point, path = (np.array([source[n] for n in ("x", "z", "y")]) for source in (run.references, run.trajectory))
    drawn = figures.svg(figures.path_3d(set_point, path, ("x", "z", "y")), "path-ellipse")
    return page.Figure(drawn, "The path through space")
