"""The report of the maglev stage: what a design review reads, assembled from the computed parts."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from designs.maglev_5dof import control, emitted, loops
from models import maglev_stage
from synth.emit.write import Emitted
from synth.plant import Plant
from synth.report import bode, figures, page, sections
from synth.report.audit import Row
from synth.simulate.experiment import Experiment
from synth.verify.cost import Cost
from synth.verify.evidence import Evidence

UNITS = {"y": "m", "x": "m", "z": "m", "phi": "rad", "theta": "rad"}
COUNTS = {"y": 10e-6, "x": 10e-6, "z": 10e-6, "phi": 20e-6, "theta": 20e-6}
_GAP, _TILT = ("F-11", "Fig. 4 of the paper"), ("F-12", "Fig. 5 of the paper")
BESIDE = {
    **dict.fromkeys(("y_22_29", "y_29_22", "y_20_27", "y_27_20", "paper_y_22_29", "paper_y_29_22"), (_GAP,)),
    **dict.fromkeys(("theta_10", "paper_theta_10"), (_TILT,)),
    **dict.fromkeys(("x_30", "z_30"), (("F-13", "Table III of the paper"),)),
    "ellipse": (("F-14", "Fig. 6 of the paper"), ("F-16", "section IV-B")),
    "tracking": (("F-15", "Figs. 7 and 8 of the paper"), ("F-16", "section IV-B")),
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
    ("F(14)", "sum' = sum + e,  p' = p + c q,  q' = q - p' + e,  c = 2 - 2 cos(ω_0 T_s),  ξ = T (sum, p, q)"),
    ("F(16)", "w = K (e, e', ξ)"),
    ("F(12)", "l_j = a_j + c_j (i_{d}^2 + i_{q}^2),  currents of the sample before"),
    ("F(12)", "f_1 + f_2 + f_3 + f_4 = M_y (w_y - G) + l_1 + l_2 + l_3 + l_4"),
    ("F(12)", "f_3 - f_1 = I_x (w_φ + k_φ φ) / r + l_3 - l_1,  f_2 - f_4 = I_z (w_θ + k_θ θ) / r + l_2 - l_4"),
    ("F(8)", "f_j = b_j i_{dj},  i_{d1} + i_{d3} = i_{d2} + i_{d4}"),
    ("F(12)", "u_x = -M_x w_x / (h_2 + h_4),  u_z = -M_z w_z / (h_1 + h_3)"),
)


def report(
    files: Mapping[str, Emitted],
    evidence: Evidence,
    experiments: Sequence[Experiment],
    rows: Sequence[Row],
    cost: Cost | None,
) -> str:
    """Return the whole report as one HTML document."""
    plant = maglev_stage.plant()
    parts = (
        _model(plant),
        _gains(plant),
        _loops(plant),
        _experiments(plant, experiments, {row.id: row.published.text for row in rows}),
        _audit(rows),
        _verification(evidence),
        sections.cost(cost),
        page.Section("Files", (sections.files(_texts(files)),)),
    )
    about = (
        "The five-axis magnetically levitated stage of Fulford, Maggiore and Apkarian: four iron-cored linear motors "
        "carry and move a platen. This page was computed from the physics; every figure on it was measured on the C "
        "that ships, or on the model that the C was derived from."
    )
    facts = (
        ("sample period", f"{control.TIME.period_s * 1e3:g} ms"),
        ("scalar type", "float32"),
        ("inputs", "6 encoders, 5 set-points"),
        ("outputs", "direct and quadrature currents of 4 motors, rms"),
    )
    return page.render(page.Report("maglev_5dof", about, parts, facts))


def _model(plant: Plant) -> page.Section:
    text = page.Text(
        "Forces are positive downwards, where they open the gap; currents are rms. L_v3 contains csch²: the printed "
        "coth² leaves out the stress of the tangential field on the winding. p counts the 6 poles. The guides' "
        "springs k_s are not published; the values below are assumptions, and the controller compensates them."
    )
    parts = ", ".join(f"{part:.0%} of {name}" for name, part in control.COMPENSATED.items())
    law = page.Text(
        "a_j, b_j, c_j and h_j are the factors of F_V = -a + b i_d - c (i_d² + i_q²) and F_H = -h i_q at motor j's "
        "own measured gap. The controller inverts the model without the squares of currents, which the paper drops "
        "in part, and puts these terms back at the currents of the sample before, so that the law stays linear; rows "
        f"F-14 and F-15 of the audit show the errors with and without those of i_d. k_φ and k_θ are {parts}: too much "
        "of a spring makes an axis unstable, too little only slow. Each motor keeps √(i_d² + i_q²) within 7 A peak, "
        "with the direct current served first. The internal model is kept in coordinates in which one sample is a "
        "sum and a rotation by leapfrog, which stays on the unit circle whatever its constant is rounded to. A state "
        "of it that would leave its bound stands still; once the safe output is latched, filters and internal models "
        "stand still too."
    )
    blocks = (text, page.Equations(MODEL), law, page.Equations(LAW), sections.parameters(plant))
    return page.Section("Model and control law", blocks)


def _gains(plant: Plant) -> page.Section:
    rows = []
    for name, g in emitted.gains(plant, np.float32).items():
        optimum, certificate = g["sampled_data_optimum"], g["certificate"]
        origin = "" if g["published_weights"] else " (θ's, unpublished)"
        rows.append(
            (
                name,
                ", ".join(f"{q:g}" for q in g["weights_Q"]) + origin,
                ", ".join(f"{k:.6g}" for k in g["K"]),
                ", ".join(g["poles_rad_s"]),
                certificate["relative_residual_below"],
                certificate["relative_forward_error_estimate"],
                optimum["worst_cost_ratio_of_K"],
            )
        )
    columns = ("axis", "diag Q, R = 1", "K", "poles, rad/s", "residual below", "error, about", "cost ratio to lqrd")
    text = page.Text(
        "w = K (e, e', ξ); the constants of the C hold K T in place of K. The published poles come from continuous "
        "LQR with these weights; rows F-8 to F-10 of the audit recover them from the print. The last column is the "
        "cost of the rounded gain, held at 1 kHz, over that of the sampled-data optimum with the exact cost "
        "integral, for the worst initial state. Residual and error of the Riccati solution are relative."
    )
    return page.Section("Gains and certificates", (text, page.Table("Gains as shipped", columns, tuple(rows))))


def _loops(plant: Plant) -> page.Section:
    opened = loops.all_loops(plant)
    k_s, own = plant.parameter("k_s_phi").value, -float(control.gain(control.AXES[3]).K[0, 0])
    cancelled = control.COMPENSATED["k_s_phi"]
    text = page.Text(
        "Each loop is opened at its measured position, at the gaps too at which the law takes the forces, the other "
        "four closed: the rounded controller as it ships, one sample of computation delay, the hold, and both plant "
        "and controller linearised about the platen at rest, held by its currents. A gain margin below 1 is the "
        "factor down to which the gain may fall. Of the φ axis' guide spring of "
        f"{k_s:g} s⁻² the controller cancels {cancelled:.0%}; its own stiffness is {own:.0f} s⁻², so that the axis is "
        f"stable while the true spring is above {(cancelled * k_s - own) / k_s:.0%} of the assumed one."
    )
    parts = []
    for axis in control.AXES:
        curves = [bode.curve(f"{o.gap * 1e3:.4g} mm", o.L, o.margins) for o in opened if o.axis == axis.name]
        parts.append(sections.loop(f"Loop of {figures.SYMBOLS.get(axis.name, axis.name)}", f"bode-{axis.name}", curves))
    return page.Section("Loops and margins", (text,), tuple(parts))


def _experiments(plant: Plant, experiments: Sequence[Experiment], printed: Mapping[str, str]) -> page.Section:
    springs = {n: plant.parameter(f"k_s_{n}").value for n in ("phi", "theta")}
    text = page.Text(
        "The full nonlinear plant, six encoders of 10 µm, one sample of delay, and the shipped C in the loop. Guide "
        f"springs {springs['theta']:g} s⁻² (θ) and {springs['phi']:g} s⁻² (φ) unless a title says otherwise. Under the "
        "safe output the platen goes down on its guides faster the higher it was; the speed is among the figures."
    )
    return page.Section("Experiments", (text,), tuple(_experiment(e, printed) for e in experiments))


def _experiment(e: Experiment, printed: Mapping[str, str]) -> page.Section:
    window = (0.0, 5.0) if len(e.trajectory.time) > 30_000 else None
    beside = ". ".join(f"{figure}: {printed[row]}" for row, figure in BESIDE.get(e.name, ()))
    found = sections.experiment(e, UNITS, COUNTS, window, beside)
    if e.name != "ellipse":
        return found
    set_point, path = (np.array([source[n] for n in ("x", "z", "y")]) for source in (e.references, e.trajectory))
    drawn = figures.svg(figures.path_3d(set_point, path, ("x", "z", "y")), "path-ellipse")
    return replace(found, blocks=(*found.blocks, page.Figure(drawn, "The path through space")))


def _audit(rows: Sequence[Row]) -> page.Section:
    return page.Section("Audit of the paper", (page.Text("Verdicts are computed."), sections.audit(rows)))


def _verification(evidence: Evidence) -> page.Section:
    text = page.Text(
        "reference: NumPy, written from the paper's equations, with gains of its own. casadi: CasADi's evaluation. "
        "casadi_c: CasADi's own C, double. c64, c32: the emitted C in double and single precision. The floor is 1 A."
    )
    checks = page.Checks("Limits", tuple(evidence.checks))
    return page.Section("Verification", (text, sections.agreements(evidence.agreements), checks))


def _texts(files: Mapping[str, Emitted]) -> dict[str, str]:
    return {f"{folder}/{name}": text for folder, found in files.items() for name, text in found.files.items()}
