"""The report of the maglev stage: what a design review reads, assembled from the computed parts."""

from collections.abc import Mapping, Sequence

import numpy as np

from designs.maglev_5dof import control, emitted, loops
from models import maglev_stage
from synth.emit.write import Emitted
from synth.plant import Plant
from synth.report import bode, figures, page
from synth.report.audit import Row
from synth.simulate.experiment import Experiment
from synth.verify.evidence import Evidence

UNITS = {"y": "m", "x": "m", "z": "m", "phi": "rad", "theta": "rad"}
COUNTS = {"y": 10e-6, "x": 10e-6, "z": 10e-6, "phi": 20e-6, "theta": 20e-6}
BESIDE = {
    "y_22_29": "Fig. 4 of the paper: overshoot 1 mm or 14.3 %, t_s below 3 s, t_enc about 5 s for a step of 7 mm.",
    "theta_10": "Fig. 5 of the paper: overshoot 2.2 mrad or 22 %, t_s below 5 s, t_enc below 10 s, with fluctuations.",
    "ellipse": "Fig. 6 of the paper; its mean errors are 33.04 um in y, 78.33 um in x, 68.25 um in z.",
    "tracking": "Figs. 7 and 8 of the paper; mean errors 47.03 um in y, 77.98 in x, 76.85 in z, 123.9 urad in theta.",
}
MODEL = (
    ("F(1)", "F_H = -K_h L_h(g) i_q"),
    ("F(2)", "F_V = -K_{v1} L_{v1}(g) + K_{v2} L_{v2}(g) i_d - K_{v3} L_{v3}(g) (i_d^2 + i_q^2)"),
    ("F(5)", "g_1 = y - r sin φ,  g_2 = y + r sin θ,  g_3 = y + r sin φ,  g_4 = y - r sin θ"),
    ("F(6)", "y'' = G + (F_{V1} + F_{V2} + F_{V3} + F_{V4}) / M_y"),
    ("F(6)", "x'' = (F_{H2} + F_{H4}) / M_x,  z'' = (F_{H1} + F_{H3}) / M_z"),
    ("F(7)", "φ'' = r (F_{V3} - F_{V1}) / I_x - k_{sφ} φ,  θ'' = r (F_{V2} - F_{V4}) / I_z - k_{sθ} θ"),
)
LAW = (
    ("F(14)", "ξ' = Φ ξ + N e + E (u_{limited} - u)"),
    ("F(16)", "w = K (e, e', ξ)"),
    ("F(12)", "(v_y, v_φ, v_θ) = D^{-1} (w - a),  u_x = w_x / h_x,  u_z = w_z / h_z"),
    ("F(8)", "i_{d1} = (v_y + v_φ)/2,  i_{d2} = (v_y - v_θ)/2,  i_{d3} = (v_y - v_φ)/2,  i_{d4} = (v_y + v_θ)/2"),
)


def report(
    files: Mapping[str, Emitted], evidence: Evidence, experiments: Sequence[Experiment], rows: Sequence[Row]
) -> str:
    """Return the whole report as one HTML document."""
    plant = maglev_stage.plant()
    sections = (
        _model(plant),
        _gains(plant),
        _loops(plant),
        _experiments(experiments),
        _audit(rows),
        _verification(evidence),
        _files(files),
    )
    about = (
        "The five-axis magnetically levitated stage of Fulford, Maggiore and Apkarian: four iron-cored linear motors "
        "carry and move a platen. This page was computed from the physics; every figure on it was measured on the C "
        "that ships, or on the model that the C was derived from."
    )
    facts: tuple[tuple[str, str], ...] = (("sample period", f"{control.TIME.period_s * 1e3:g} ms"), ("scalar type", "float32"))
    facts += (("inputs", "6 encoders, 5 set-points"), ("outputs", "direct and quadrature currents of 4 motors, rms"))
    return page.render(page.Report("maglev_5dof", about, sections, facts))


def _model(plant: Plant) -> page.Section:
    table = page.Table(
        "Parameters",
        ("name", "value", "unit", "relative tolerance", "source"),
        tuple((p.name, f"{p.value:.6g}", p.unit, f"{p.tolerance:g}", p.source) for p in plant.parameters),
    )
    text = page.Text(
        "Forces are positive downwards, where they open the gap; currents are rms. L_v3 contains csch^2: the printed "
        "coth^2 leaves out the stress of the tangential field on the winding. p counts the 6 poles. The guides' "
        "springs k_s are not published; the values below are assumptions, and the controller compensates them."
    )
    law = page.Text(
        "The controller inverts the model without the terms that the paper drops, then puts these terms back at the "
        "currents found so far, twice. F(12) as printed leaves a mean error of 33 urad in theta in the 4-DOF run and "
        "lets the gap move by 28 um in a step of 30 mm in x. Each motor keeps sqrt(i_d^2 + i_q^2) within 7 A peak, "
        "with the direct current served first. The loop is opened below at the measured position."
    )
    return page.Section("Model and control law", (text, page.Equations(MODEL), law, page.Equations(LAW), table))


def _gains(plant: Plant) -> page.Section:
    found = emitted.gains(plant, np.float32)
    rows = []
    for name, g in found.items():
        gain, optimum, certificate = g["K"], g["sampled_data_optimum"], g["certificate"]
        origin = "" if g["published_weights"] else " (theta's, unpublished)"
        rows.append(
            (
                name,
                ", ".join(f"{q:g}" for q in g["weights_Q"]) + origin,
                ", ".join(f"{k:.6g}" for k in gain),
                ", ".join(g["poles_rad_s"]),
                f"{certificate['relative_residual_below']:g}",
                f"{certificate['relative_forward_error_below']:g}",
                f"{optimum['worst_cost_ratio_of_K']:g}",
            )
        )
    columns = ("axis", "diag Q, R = 1", "K", "poles, rad/s", "residual below", "error below", "cost ratio to lqrd")
    text = page.Text(
        "w = K (e, e', xi). The published poles come from continuous LQR with these weights, which are the unique "
        "diagonal ones. The last column is the cost of this gain, held at 1 kHz, over that of the sampled-data optimum "
        "with the exact cost integral, for the worst initial state. Residual and error are relative bounds of the "
        "Riccati solution, computed in ball arithmetic."
    )
    return page.Section("Gains and certificates", (text, page.Table("Gains as shipped", columns, tuple(rows))))


def _loops(plant: Plant) -> page.Section:
    opened = loops.all_loops(plant)
    blocks: list[page.Block] = [
        page.Text(
            "Each loop is opened at its measured position, the other four closed: the rounded controller as it ships, "
            "one sample of computation delay, the hold, and the plant linearised at the gap. A gain margin below 1 is "
            "the factor down to which the gain may fall. The phi loop's small upper gain margin at low frequency is "
            "the price of compensating a guide spring of 15000 1/s^2 with a stiffness of 2050 1/s^2 of its own: "
            "overestimating that spring by 14 % makes the axis unstable."
        )
    ]
    rows = []
    for o in opened:
        m = o.margins
        crossings = ", ".join(f"{c.frequency / (2 * np.pi):.3g}" for c in m.gain_crossings)
        rows.append(
            (
                o.axis,
                f"{o.gap * 1e3:.4g}",
                "yes" if m.stable else "NO",
                m.gain_margin,
                m.gain_reduction_margin,
                m.phase_margin,
                m.delay_margin * 1e3,
                m.peak_sensitivity,
                crossings,
            )
        )
    columns = ("axis", "gap, mm", "stable", "gain up", "gain down", "phase, deg", "delay, ms", "Ms", "crossings, Hz")
    blocks.append(page.Table("Margins", columns, tuple(rows)))
    for axis in control.AXES:
        curves = [bode.curve(f"{o.gap * 1e3:.4g} mm", o.L, o.margins) for o in opened if o.axis == axis.name]
        drawn = figures.svg(bode.bode_plot(curves), f"bode-{axis.name}")
        blocks.append(page.Figure(drawn, f"Open loop of {axis.name} at three gaps"))
    return page.Section("Loops and margins", tuple(blocks))


def _experiments(experiments: Sequence[Experiment]) -> page.Section:
    text = page.Text(
        "The full nonlinear plant in RK4 steps of 0.25 ms, six encoders of 10 um, one sample of delay, and the shipped "
        "C in the loop. Guide springs 3000 1/s^2 (theta) and 15000 1/s^2 (phi) unless a title says otherwise."
    )
    return page.Section("Experiments", (text,), tuple(_experiment(e) for e in experiments))


def _experiment(e: Experiment) -> page.Section:
    window = (0.0, 5.0) if len(e.trajectory.time) > 30_000 else None
    drawn = figures.response(e, UNITS, COUNTS, window)
    blocks: list[page.Block] = [
        page.Figure(figures.svg(drawn, f"run-{e.name.replace('.', '-')}"), e.about, BESIDE.get(e.name, ""))
    ]
    if e.name == "ellipse":
        paths = (
            np.array([e.references[n] for n in ("x", "z", "y")]),
            np.array([e.trajectory[n] for n in ("x", "z", "y")]),
        )
        blocks.append(page.Figure(figures.svg(figures.path_3d(*paths, ("x", "z", "y")), "path-ellipse"), "The path"))
    if e.checks:
        blocks.append(page.Checks("Limits", e.checks))
    if e.figures:
        blocks.append(page.Table("Further figures", ("figure", "value"), tuple((n, v) for n, v in e.figures.items())))
    return page.Section(e.title, tuple(blocks))


def _audit(rows: Sequence[Row]) -> page.Section:
    text = page.Text(
        "R reproduces; RC reproduces after the correction that is stated; N does not reproduce. Verdicts are computed."
    )
    table = tuple(
        (
            row.id,
            row.published.text,
            "; ".join(f"{f.name}: {f.value:.5g}{'' if f.unit == '1' else ' ' + f.unit}" for f in row.recomputed),
            str(row.verdict),
            row.why,
        )
        for row in rows
    )
    columns = ("row", "published", "recomputed", "verdict", "why")
    return page.Section("Audit of the paper", (text, page.Table("Published and recomputed", columns, table)))


def _verification(evidence: Evidence) -> page.Section:
    text = page.Text(
        "reference: NumPy, written from the paper's equations, with gains of its own. casadi: CasADi's evaluation. "
        "casadi_c: CasADi's own C, double. c64, c32: the emitted C in double and single precision. A difference is "
        "relative to max(1 A, |i|)."
    )
    rows = tuple(
        (a.what, a.first, a.second, a.samples, a.worst, a.signal, a.ulps, a.faults_differ) for a in evidence.agreements
    )
    columns = ("what", "first", "second", "steps", "worst difference", "signal", "worst in ulp", "fault words unlike")
    return page.Section(
        "Verification", (text, page.Table("Agreement", columns, rows), page.Checks("Limits", tuple(evidence.checks)))
    )


def _files(files: Mapping[str, Emitted]) -> page.Section:
    rows = tuple(
        (f"{folder}/{name}", len(text.encode()), found.manifest["sha256"].get(name, ""))
        for folder, found in files.items()
        for name, text in found.files.items()
    )
    return page.Section("Files", (page.Table("generated_c", ("file", "bytes", "sha256"), rows),))
