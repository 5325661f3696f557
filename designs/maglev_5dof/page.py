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
BESIDE = {  # rows of the audit that say what the paper shows of an experiment
    "F-11": ("y_22_29", "y_29_22", "y_20_27", "y_27_20", "paper_y_22_29", "paper_y_29_22"),
    "F-12": ("theta_10", "paper_theta_10"),
    "F-13": ("x_30", "z_30"),
    "F-14": ("ellipse",),
    "F-15": ("tracking",),
    "F-16": ("ellipse", "tracking"),
}


def report(stage: Stage, files: Any, evidence: Any, runs: Any, rows: Any, cost: Any) -> str:
    """Return the report as one HTML document; arguments as `template.report`."""
    prints = {
        name: [row.published for row in rows if name in BESIDE.get(row.id, ())] for name in (r.name for r in runs)
    }
    beside = {name: ". ".join(f"{p.where}: {p.text}" for p in printed) for name, printed in prints.items()}
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
    """Return what report.md asks for beyond the standard values."""
    phi, theta = control.COMPENSATED.values()
    k_s, stiffness = plant.parameter("k_s_phi").value, -float(control.gain(control.AXES[3]).K[0, 0])
    margins = {"stiffness": stiffness, "stable_above": (phi * k_s - stiffness) / k_s}
    return {"compensated_phi": phi, "compensated_theta": theta, **margins}


def _path(run: Experiment) -> page.Figure:
    set_point, path = (np.array([source[n] for n in ("x", "z", "y")]) for source in (run.references, run.trajectory))
    drawn = figures.svg(figures.path_3d(set_point, path, ("x", "z", "y")), "path-ellipse")
    return page.Figure(drawn, "The path through space")
