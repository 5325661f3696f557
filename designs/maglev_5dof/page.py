"""Report of the maglev stage: its additions to the standard report; the prose is in report.md."""

import numpy as np

from designs.maglev import commutation, commutation_tables, motions, platen
from designs.maglev_5dof import control
from models import maglev_stage
from synth.declare.stage import Stage
from synth.plant import Plant
from synth.report import figures, page, sections, standard
from synth.report.prose import Value
from synth.report.template import Extra, Results
from synth.simulate.experiments import Experiment

LONGEST, WINDOW = 30.0, (0.0, 5.0)  # s: longer runs are drawn over the window
PUBLISHED = {  # rows of the audit with the paper's statements on an experiment
    **dict.fromkeys(("y_22_29", "y_29_22", "y_20_27", "y_27_20", "paper_y_22_29", "paper_y_29_22"), (("F-11", ""),)),
    **dict.fromkeys(("theta_10", "paper_theta_10"), (("F-12", ""),)),
    **dict.fromkeys(("x_30", "z_30"), (("F-13", ""),)),
    **dict.fromkeys(("rejects_constant", "rejects_omega0"), (("F-20", ""),)),
    "ellipse": (("F-14", ""), ("F-16", "")),
    "tracking": (("F-15", ""), ("F-16", "")),
}


def contents(stage: Stage, results: Results) -> Extra:
    """Return what this design adds to the report."""
    runs = results.runs
    paths = {run.name: (_path(run),) for run in runs if run.name == "ellipse"}
    style = standard.Shown(
        motions.UNITS, motions.COUNTS, sections.published_figures(PUBLISHED, results.rows), paths, LONGEST, WINDOW
    )
    values = _values(stage.plant) | commutation_tables.values(stage, results.files, runs, results.cost is not None)
    return Extra(values, terms=maglev_stage.factors, shown=style)


def _values(plant: Plant) -> dict[str, Value]:
    """Return the values named in report.md beyond the standard ones."""
    phi, theta = platen.COMPENSATED.values()
    k_s, stiffness = plant.parameter("k_s_phi").value, -float(control.gain(control.AXES[3]).K[0, 0])
    margins: dict[str, Value] = {"advance": commutation.ADVANCE, "descent": commutation.DESCENT}
    margins |= {"stride_mm": 1e3 * commutation.SPEED["x"] * platen.TIME.period_s}
    margins |= {"stiffness": stiffness, "stable_above": (phi * k_s - stiffness) / k_s}
    return {"compensated_phi": phi, "compensated_theta": theta, **margins}


def _path(run: Experiment) -> page.Figure:
    set_point, path = (np.array([source[n] for n in ("x", "z", "y")]) for source in (run.references, run.trajectory))
    svg = figures.svg(figures.path_3d(set_point, path, ("x", "z", "y")), "path-ellipse")
    return page.Figure(svg, "The path through space")
