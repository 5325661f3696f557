"""What the report of the maglev stage has beyond the standard one: the forces by name, and the paper's own figures."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import casadi as ca
import numpy as np

from designs.maglev_5dof import control, loops
from models import maglev_stage, pmlsm
from synth.declaration import Stage
from synth.emit.write import Emitted
from synth.plant import Symbols
from synth.report import figures, page, standard, template
from synth.report.audit import Row
from synth.report.prose import Value
from synth.report.template import Extra
from synth.simulate.experiment import Experiment
from synth.verify.cost import Cost
from synth.verify.evidence import Evidence

LONGEST, WINDOW = 30.0, (0.0, 5.0)  # s: what runs longer is drawn over the window
LEVELS = {"y": 10e-6, "x": 10e-6, "z": 10e-6, "phi": 20e-6, "theta": 20e-6}  # m, rad: one count
_GAP, _TILT = ("F-11", "Fig. 4 of the paper"), ("F-12", "Fig. 5 of the paper")
BESIDE = {
    **dict.fromkeys(("y_22_29", "y_29_22", "y_20_27", "y_27_20", "paper_y_22_29", "paper_y_29_22"), (_GAP,)),
    **dict.fromkeys(("theta_10", "paper_theta_10"), (_TILT,)),
    **dict.fromkeys(("x_30", "z_30"), (("F-13", "Table III of the paper"),)),
    "ellipse": (("F-14", "Fig. 6 of the paper"), ("F-16", "section IV-B")),
    "tracking": (("F-15", "Figs. 7 and 8 of the paper"), ("F-16", "section IV-B")),
}


def report(
    stage: Stage,
    files: Mapping[str, Emitted],
    evidence: Evidence,
    runs: Sequence[Experiment],
    rows: Sequence[Row],
    cost: Cost | None,
) -> str:
    """Return the report as one HTML document."""
    printed = {row.id: row.published.text for row in rows}
    beside = {
        name: ". ".join(f"{figure}: {printed[row]}" for row, figure in said if row in printed)
        for name, said in BESIDE.items()
    }
    drawn = {run.name: (_path(run),) for run in runs if run.name == "ellipse"}
    shown = replace(template.shown(stage), levels=LEVELS, beside=beside, drawn=drawn, longest=LONGEST, window=WINDOW)
    opened = standard.loops(loops.all_loops(stage.plant))
    extra = Extra(_values(), [opened], forces, shown=shown)
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


def _values() -> dict[str, Value]:
    """Return what report.md asks for beyond what is known of every stage."""
    k_s, cancelled = maglev_stage.plant().parameter("k_s_phi").value, control.COMPENSATED["k_s_phi"]
    stiffness = -float(control.gain(control.AXES[3]).K[0, 0])
    return {
        "compensated_phi": cancelled,
        "compensated_theta": control.COMPENSATED["k_s_theta"],
        "stiffness": stiffness,
        "stable_above": (cancelled * k_s - stiffness) / k_s,
    }


def _path(run: Experiment) -> page.Figure:
    set_point, path = (np.array([source[n] for n in ("x", "z", "y")]) for source in (run.references, run.trajectory))
    drawn = figures.svg(figures.path_3d(set_point, path, ("x", "z", "y")), "path-ellipse")
    return page.Figure(drawn, "The path through space")
