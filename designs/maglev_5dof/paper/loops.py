"""Audit of the loops: poles, steps and tracking errors; `bench` says what "ideal" and "encoders" mean."""

from collections.abc import Mapping

import numpy as np

from designs.maglev_5dof import control, experiments
from designs.maglev_5dof.paper import continuous
from designs.maglev_5dof.paper.bench import FORCES, FRICTION, MAGNETS, Bench, Springs
from designs.maglev_5dof.paper.continuous import Reference
from synth.report.audit import Outcome, Published, recomputes
from synth.simulate import metrics
from synth.synthesise.feedback import inverse_lqr

NEAR = 0.10  # a tracking error agrees within this part of the printed one
SPRING_CASES: tuple[Springs, ...] = ("absent", "known", "unknown")
_TRACKED = (("y", "um"), ("theta", "urad"))
LEVEL = (*FORCES, "M_x", "M_z", "M_y", "G")  # what counts while the platen does not turn
TURNING = (*LEVEL, "r", "I_z", "k_s_theta")  # and while it turns by theta


@recomputes("F-8")
def poles_y(bench: Bench, printed: Published) -> Outcome:
    """Recompute the closed-loop poles of y from its LQR weights."""
    return _poles("y", printed)


@recomputes("F-9")
def poles_x(bench: Bench, printed: Published) -> Outcome:
    """Recompute those of x and z."""
    return _poles("x", printed)


@recomputes("F-10")
def poles_theta(bench: Bench, printed: Published) -> Outcome:
    """Recompute those of theta."""
    return _poles("theta", printed)


def _poles(name: str, printed: Published) -> Outcome:
    found = np.linalg.eigvals(continuous.closed_loop(name))
    real = found[np.abs(found.imag) < 1e-9].real
    first, second = sorted(found[found.imag > 1e-9], key=lambda pole: -pole.imag)
    recomputed = {
        "fast": float(real[0]),
        "first_real": float(first.real),
        "first_imaginary": float(first.imag),
        "second_real": float(second.real),
        "second_imaginary": float(second.imag),
    }
    inverse = inverse_lqr.diagonal_weights(control.axis_plant(continuous.axis(name)), _printed_poles(printed))
    figures = [(n.replace("_", " pair, "), value, "1/s") for n, value in recomputed.items()]
    recovered = zip(("e", "de", "xi1", "xi2", "xi3"), inverse.q, strict=True)
    figures += [(f"weight on {state} from the printed poles", q, "1") for state, q in recovered]
    figures.append(("diagonal weights that give the printed poles, free directions", inverse.nullspace.shape[1], "1"))
    return Outcome(figures, all(printed[n].agrees(value) for n, value in recomputed.items()))


def _printed_poles(printed: Published) -> list[complex]:
    pairs = [complex(printed[f"{n}_real"].value, printed[f"{n}_imaginary"].value) for n in ("first", "second")]
    return [complex(printed["fast"].value), *(s for pair in pairs for s in (pair, pair.conjugate()))]


@recomputes("F-11", *MAGNETS, "M_y", "G")
def gap_step(bench: Bench, printed: Published) -> Outcome:
    """Recompute the step of 7 mm, on the linear loop and on the nonlinear plant."""
    size = printed["step"].value * 1e-3
    linear = continuous.linear_step("y", size, experiments.BAND, control.RESOLUTION)
    low = 0.022
    motion = continuous.run(bench.plant, bench.plant, {"y": Reference(low + size)}, {"y": low}, 6.0)
    gap = motion.error["y"] + low + size
    full = metrics.step_response(motion.time, gap, low, low + size, experiments.BAND, control.RESOLUTION)
    figures = [*_step_figures("linear", linear), *_step_figures("nonlinear, 22 to 29 mm", full)]
    figures.append(("overshoot length, nonlinear, 22 to 29 mm", full.overshoot * size * 1e3, "mm"))
    agree = (
        printed["overshoot_length"].agrees(round(full.overshoot * size * 1e3))
        and max(linear.t_s, full.t_s) < printed["t_s"].value
        and max(linear.t_enc, full.t_enc) <= printed["t_enc"].value
    )
    return Outcome(figures, agree)


@recomputes("F-12")
def tilt_step(bench: Bench, printed: Published) -> Outcome:
    """Recompute the step of 10 mrad on the linear loop."""
    size = printed["step"].value * 1e-3
    found = continuous.linear_step("theta", size, experiments.BAND, experiments.COUNTS["theta"])
    agree = (
        printed["overshoot"].agrees(found.overshoot * 100)
        and printed["t_s_low"].value <= found.t_s <= printed["t_s_high"].value
        and found.t_enc < printed["t_enc"].value
    )
    return Outcome(_step_figures("linear", found), agree)


@recomputes("F-13")
def horizontal_step(bench: Bench, printed: Published) -> Outcome:
    """Recompute the steps of 30 mm in x and z on the linear loop, which is the same for both."""
    size = printed["step"].value * 1e-3
    found = continuous.linear_step("x", size, experiments.BAND, control.RESOLUTION)
    agree = (
        found.overshoot * 100 < printed["overshoot"].value
        and found.t_s < printed["t_s"].value
        and found.t_enc < printed["t_enc"].value
    )
    return Outcome(_step_figures("linear", found), agree)


@recomputes("F-14", *LEVEL)
def ellipse(bench: Bench, printed: Published) -> Outcome:
    """Recompute the mean gap error of the 3-DOF ellipse."""
    csch, coth = (bench.ideal_errors(False, "known", lv3)["y"] for lv3 in ("csch2", "coth2"))
    coarse, shipped = (bench.encoder_errors(False, restored)["y"] for restored in (False, True))
    figures = [
        ("y, ideal", csch, "um"),
        ("y, ideal, coth^2", coth, "um"),
        ("y, encoders, printed law", coarse, "um"),
        ("y, encoders, shipped law", shipped, "um"),
    ]
    corrected = _within({"y": csch}, printed) or _within({"y": coarse}, printed)
    return Outcome(figures, _within({"y": coth}, printed), corrected)


@recomputes("F-15", *TURNING)
def tracking(bench: Bench, printed: Published) -> Outcome:
    """Recompute the mean errors of the 4-DOF tracking."""
    cases = {f"ideal, springs {s}": bench.ideal_errors(True, s) for s in SPRING_CASES}
    cases |= {f"encoders, printed law, springs {s}": bench.encoder_errors(True, False, s) for s in SPRING_CASES}
    near = any(_within({n: found[n] for n in ("y", "theta")}, printed) for found in cases.values())
    cases["encoders, shipped law, springs known"] = bench.encoder_errors(True, True)
    figures = [(f"{n}, {name}", found[n], unit) for name, found in cases.items() for n, unit in _TRACKED]
    lost = bench.ideal(True, "absent", "coth2").left_at
    figures.append(("time at which the gap leaves 18 .. 31 mm, ideal, coth^2, springs absent", lost, "s"))
    return Outcome(figures, False, near)


@recomputes("F-16", *TURNING)
def horizontal_errors(bench: Bench, printed: Published) -> Outcome:
    """Recompute the mean errors along x and z, without and with a fitted guide friction and cogging."""
    cases = {
        "ideal": bench.ideal_errors(False, "known"),
        "encoders, printed law": bench.encoder_errors(False, False),
        "encoders, friction, cogging": bench.encoder_errors(False, False, guided=True),
        "4-DOF, encoders, printed law": bench.encoder_errors(True, False),
        "4-DOF, encoders, friction, cogging": bench.encoder_errors(True, False, guided=True),
    }
    figures = [(f"{n}, {name}", found[n], "um") for name, found in cases.items() for n in ("x", "z")]
    figures += [(f"friction along {n}, fitted", force, "N") for n, force in FRICTION.items()]
    unfitted = cases["encoders, printed law"]
    return Outcome(figures, _within({n: unfitted[n] for n in ("x", "z")}, printed))


def _step_figures(kind: str, found: metrics.StepResponse) -> list[tuple[str, float, str]]:
    return [
        (f"overshoot, {kind}", 100 * found.overshoot, "%"),
        (f"t_s, {kind}", found.t_s, "s"),
        (f"t_enc, {kind}", found.t_enc, "s"),
    ]


def _within(found: Mapping[str, float], printed: Published) -> bool:
    return all(abs(v / printed[n].value - 1) <= NEAR for n, v in found.items())
