"""Audit of the loops: poles, steps and tracking errors; `audit_bench` says what "ideal" and "encoders" mean."""

from collections.abc import Mapping

import numpy as np

from designs.maglev_5dof import audit_continuous, control, experiments, loop
from designs.maglev_5dof.audit_bench import FRICTION, SPRINGS, Bench, Springs
from designs.maglev_5dof.audit_continuous import Reference
from designs.maglev_5dof.audit_motor import FORCES, MAGNETS
from synth.report.audit import Published, Row, judge, row
from synth.simulate import metrics
from synth.synthesise.feedback import inverse_lqr

NEAR = 0.10  # a tracking error agrees within this part of the printed one
SPRING_CASES: tuple[Springs, ...] = ("absent", "known", "unknown")
_TRACKED = (("y", "um"), ("theta", "urad"))
LEVEL = (*FORCES, "M_x", "M_z", "M_y", "G")  # what counts while the platen does not turn
TURNING = (*LEVEL, "r", "I_z", "k_s_theta")  # and while it turns by theta


def poles(name: str, printed: Published) -> Row:
    """F-8, F-9, F-10: recompute the closed-loop poles of an axis from its LQR weights."""
    found = np.linalg.eigvals(audit_continuous.closed_loop(name))
    real = found[np.abs(found.imag) < 1e-9].real
    first, second = sorted(found[found.imag > 1e-9], key=lambda pole: -pole.imag)
    recomputed = {
        "fast": float(real[0]),
        "first_real": float(first.real),
        "first_imaginary": float(first.imag),
        "second_real": float(second.real),
        "second_imaginary": float(second.imag),
    }
    axis = audit_continuous.axis(name)
    weights = ", ".join(f"{q:g}" for q in axis.weights)
    inverse = inverse_lqr.diagonal_weights(control.axis_plant(axis), _printed_poles(printed))
    why = (
        f"Rule: every part within one unit of its last printed digit. Poles of the continuous LQR with R = 1 and "
        f"Q = diag({weights}) on (e, de, xi), weights that the paper does not print. The symmetric root locus of the "
        "printed poles has one solution in diagonal weights, near these: the print rounds it."
    )
    agree = all(printed[n].agrees(value) for n, value in recomputed.items())
    figures = [(n.replace("_", " pair, "), value, "1/s") for n, value in recomputed.items()]
    recovered = zip(("e", "de", "xi1", "xi2", "xi3"), inverse.q, strict=True)
    figures += [(f"weight on {state} from the printed poles", q, "1") for state, q in recovered]
    figures.append(("diagonal weights that give the printed poles, free directions", inverse.nullspace.shape[1], "1"))
    return row(printed, figures, judge(agree), why)


def _printed_poles(printed: Published) -> list[complex]:
    pairs = [complex(printed[f"{n}_real"].value, printed[f"{n}_imaginary"].value) for n in ("first", "second")]
    return [complex(printed["fast"].value), *(s for pair in pairs for s in (pair, pair.conjugate()))]


def gap_step(bench: Bench, printed: Published) -> Row:
    """F-11: recompute the step of 7 mm, on the linear loop and on the nonlinear plant."""
    size = printed["step"].value * 1e-3
    linear = audit_continuous.linear_step("y", size, experiments.BAND, loop.RESOLUTION)
    low = 0.022
    motion = audit_continuous.run(bench.plant, bench.plant, {"y": Reference(low + size)}, {"y": low}, 6.0)
    gap = motion.error["y"] + low + size
    full = metrics.step_response(motion.time, gap, low, low + size, experiments.BAND, loop.RESOLUTION)
    figures = [*_step_figures("linear", linear), *_step_figures("nonlinear, 22 to 29 mm", full)]
    figures.append(("overshoot length, nonlinear, 22 to 29 mm", full.overshoot * size * 1e3, "mm"))
    agree = (
        printed["overshoot_length"].agrees(round(full.overshoot * size * 1e3))
        and max(linear.t_s, full.t_s) < printed["t_s"].value
        and max(linear.t_enc, full.t_enc) <= printed["t_enc"].value
    )
    why = (
        "Rule: the overshoot rounds to the printed 1 mm, t_s is below 3 s and t_enc at most 5 s. Both loops are in "
        "continuous time with ideal sensing and an exact rate; the nonlinear one has every quadratic term in the plant "
        "and (12) as printed in the law, with v_phi = v_theta = 0; "
        "the winding does not matter, the law scales its currents."
    )
    return row(printed, figures, judge(agree), why, (*MAGNETS, "M_y", "G"))


def tilt_step(printed: Published) -> Row:
    """F-12: recompute the step of 10 mrad on the linear loop."""
    size = printed["step"].value * 1e-3
    found = audit_continuous.linear_step("theta", size, experiments.BAND, loop.ANGLE_RESOLUTION)
    agree = (
        printed["overshoot"].agrees(found.overshoot * 100)
        and printed["t_s_low"].value <= found.t_s <= printed["t_s_high"].value
        and found.t_enc < printed["t_enc"].value
    )
    why = (
        "Rule: the overshoot within one unit of its last digit, t_s between 3 and 5 s, t_enc below 10 s. The linear "
        "loop is faster and better damped than the experiment; the paper blames the vertical guides, which neither it "
        "nor this loop models."
    )
    return row(printed, _step_figures("linear", found), judge(agree), why)


def horizontal_step(printed: Published) -> Row:
    """F-13: recompute the steps of 30 mm in x and z on the linear loop, which is the same for both."""
    size = printed["step"].value * 1e-3
    found = audit_continuous.linear_step("x", size, experiments.BAND, loop.RESOLUTION)
    agree = (
        found.overshoot * 100 < printed["overshoot"].value
        and found.t_s < printed["t_s"].value
        and found.t_enc < printed["t_enc"].value
    )
    why = "Rule: the three bounds of Table III, on the linear loop in continuous time with ideal sensing."
    return row(printed, _step_figures("linear", found), judge(agree), why)


def ellipse(bench: Bench, printed: Published) -> Row:
    """F-14: recompute the mean gap error of the 3-DOF ellipse."""
    csch, coth = (bench.ideal_errors(False, "known", lv3)["y"] for lv3 in ("csch2", "coth2"))
    coarse, shipped = (bench.encoder_errors(False, restored)["y"] for restored in (False, True))
    figures = [
        ("y, ideal", csch, "um"),
        ("y, ideal, coth^2", coth, "um"),
        ("y, encoders, printed law", coarse, "um"),
        ("y, encoders, shipped law", shipped, "um"),
    ]
    why = (
        f"Rule: within {NEAR:.0%} of the print, ideal or with encoders and the printed law, csch^2; coth^2 is what is "
        "printed. Not met, though the order is right: the terms that (11) drops set the error, and the authors' "
        "re-estimated parameters are not published. v_phi = v_theta = 0, so that the guide springs play no part."
    )
    corrected = _within({"y": csch}, printed) or _within({"y": coarse}, printed)
    return row(printed, figures, judge(_within({"y": coth}, printed), corrected), why, LEVEL)


def tracking(bench: Bench, printed: Published) -> Row:
    """F-15: recompute the mean errors of the 4-DOF tracking."""
    cases = {f"ideal, springs {s}": bench.ideal_errors(True, s) for s in SPRING_CASES}
    cases |= {f"encoders, printed law, springs {s}": bench.encoder_errors(True, False, s) for s in SPRING_CASES}
    near = any(_within({n: found[n] for n in ("y", "theta")}, printed) for found in cases.values())
    cases["encoders, shipped law, springs known"] = bench.encoder_errors(True, True)
    figures = [(f"{n}, {name}", found[n], unit) for name, found in cases.items() for n, unit in _TRACKED]
    lost = bench.ideal(True, "absent", "coth2").left_at
    figures.append(("time at which the gap leaves 18 .. 31 mm, ideal, coth^2, springs absent", lost, "s"))
    why = (
        f"Rule: y and theta both within {NEAR:.0%} of the print in one of the csch^2 cases with the printed law. Not "
        "met, though the order is right. The spring constants are not printed: the plant has "
        f"{_spring_constants(bench)}, and (12) the same where it knows them; both have 0 where they are absent. With "
        "coth^2 and without springs the dropped terms throw the platen out of its range."
    )
    return row(printed, figures, judge(False, near), why, TURNING)


def horizontal_errors(bench: Bench, printed: Published) -> Row:
    """F-16: recompute the mean errors along x and z, without and with a fitted guide friction and cogging."""
    cases = {
        "ideal": bench.ideal_errors(False, "known"),
        "encoders, printed law": bench.encoder_errors(False, False),
        "encoders, friction, cogging": bench.encoder_errors(False, False, guided=True),
        "4-DOF, encoders, printed law": bench.encoder_errors(True, False),
        "4-DOF, encoders, friction, cogging": bench.encoder_errors(True, False, guided=True),
    }
    figures = [(f"{n}, {name}", found[n], "um") for name, found in cases.items() for n in ("x", "z")]
    figures += [(f"friction along {n}, fitted", force, "N") for n, force in FRICTION.items()]
    why = (
        f"Rule: x and z within {NEAR:.0%} of the print without anything fitted. (12) inverts the horizontal axes "
        "exactly and the internal model holds the frequency of the reference, so nothing is left but the encoders' "
        f"counts. Coulomb friction of the guides, {FRICTION['x']:g} N along x and {FRICTION['z']:g} N along z, with "
        "the cogging of two motors in phase, comes near the ellipse; one fitted number an axis is no evidence of its "
        f"own. {_spring_constants(bench)} in the plant and in (12)."
    )
    unfitted = cases["encoders, printed law"]
    verdict = judge(_within({n: unfitted[n] for n in ("x", "z")}, printed))
    return row(printed, figures, verdict, why, TURNING)


def _spring_constants(bench: Bench) -> str:
    k_phi, k_theta = (bench.plant.parameter(n).value for n in SPRINGS)
    return f"k_s_phi = {k_phi:g} and k_s_theta = {k_theta:g} 1/s^2"


def _step_figures(kind: str, found: metrics.StepResponse) -> list[tuple[str, float, str]]:
    return [
        (f"overshoot, {kind}", 100 * found.overshoot, "%"),
        (f"t_s, {kind}", found.t_s, "s"),
        (f"t_enc, {kind}", found.t_enc, "s"),
    ]


def _within(found: Mapping[str, float], printed: Published) -> bool:
    return all(abs(v / printed[n].value - 1) <= NEAR for n, v in found.items())
