"""Audit of the loops: poles, steps and tracking errors.

"Ideal" is the loop in continuous time with ideal sensing (`audit_continuous`). "Encoders" is the compiled controller
at 1 kHz on encoders of 10 um with its filters and one sample of delay: with the printed law (12), and with the shipped
law, which puts back the terms that (11) drops. Tracking errors are means of |e|, with encoders from 10 to 60 s. Ideal
runs are periodic by 12 s, and the mean is over the six whole periods up to 20 s. Shorter runs keep these proportions.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from math import pi

import casadi as ca
import numpy as np

from designs.maglev_5dof import audit_continuous, control, experiments, loop
from designs.maglev_5dof.audit_motor import FORCES, geometry
from models import maglev_stage, slotted_field
from synth.execute import host
from synth.plant import Plant
from synth.report.audit import Published, Row, judge, row
from synth.simulate import metrics

FRICTION = {"x": 1.8, "z": 1.3}  # N of guide friction, fitted to the two printed errors of the ellipse
SLIP = 1e-3  # m/s, within which friction changes sign
NEAR = 0.10  # a tracking error agrees within this part of the printed one
STAGE = (*FORCES, "M_x", "M_z", "M_y", "r", "I_x", "I_z", "G")
SPRINGS = ("k_s_phi", "k_s_theta")


@dataclass(frozen=True, eq=False)
class Bench:
    """The plant under audit, what the paper prints, the length of the tracking runs in s, and the loops, made once.

    `cells` is the fineness of the slotted field.
    """

    plant: Plant
    published: Mapping[str, Published]
    duration_s: float = experiments.TRACK_TO
    cells: int = 12
    _controllers: dict[tuple[bool, bool], host.Controller] = field(default_factory=dict)

    @cached_property
    def coth(self) -> Plant:
        """The plant with L_v3 as printed."""
        return maglev_stage.plant("coth2").with_parameters(**{p.name: p.value for p in self.plant.parameters})

    @cached_property
    def free(self) -> Plant:
        """The plant without guide springs."""
        return self.plant.with_parameters(**dict.fromkeys(SPRINGS, 0.0))

    def ideal(self, four: bool, plant: Plant, known: Plant, lv3: str = "csch2") -> audit_continuous.Motion:
        """Return the ideal 4-DOF tracking or ellipse of `plant` under (12) for the parameters of `known`."""
        w = control.OMEGA0
        references: dict[str, audit_continuous.Reference] = {
            "y": lambda t: 0.005 * ca.sin(w * t - pi / 2) + 0.025,
            "x": lambda t: 0.03 * ca.sin(w * t - pi / 2),
            "z": lambda t: 0.03 * ca.sin(w * t),
        }
        if four:
            references |= {"phi": lambda t: ca.SX(0), "theta": lambda t: 0.01 * ca.sin(w * t)}
        start = {"y": 0.020, "x": -0.03}
        return audit_continuous.run(plant, known, references, start, self.duration_s / 3, lv3)

    def mean(self, motion: audit_continuous.Motion, axis: str) -> float:
        """Return the mean |e| of an ideal run in um or urad."""
        return 1e6 * motion.mean_error(axis, self.duration_s / 5)

    def encoders(
        self,
        four: bool,
        restored: bool,
        plant: Plant | None = None,
        springs: bool = True,
        disturbance: ca.Function | None = None,
    ) -> dict[str, float]:
        """Return the mean |e| in um or urad by axis of the compiled loop; `springs` tells whether (12) knows them."""
        key = (restored, springs)
        if key not in self._controllers:
            known = self.plant if springs else self.free
            self._controllers[key] = loop.compiled(known, np.float64, restored=restored)
        rig = loop.Loop(plant or self.plant, self._controllers[key], disturbance=disturbance)
        trajectory, references = experiments.tracking(rig, four, self.duration_s)
        found = {}
        for axis in experiments.AXES:
            error = trajectory[axis] - references.get(f"{axis}_ref", 0.0)
            found[axis] = 1e6 * metrics.mean_absolute(trajectory.time, error, self.duration_s / 6)
        return found


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
    weights = ", ".join(f"{q:g}" for q in audit_continuous.axis(name).weights)
    why = (
        f"Rule: every part within one unit of its last printed digit. Poles of the continuous LQR with R = 1 and "
        f"Q = diag({weights}) on (e, de, xi), weights that the paper does not print."
    )
    agree = all(printed[n].agrees(value) for n, value in recomputed.items())
    figures = [(n.replace("_", " pair, "), value, "1/s") for n, value in recomputed.items()]
    return row(printed, figures, judge(agree), why)


def gap_step(bench: Bench, printed: Published) -> Row:
    """F-11: recompute the step of 7 mm, on the linear loop and on the nonlinear plant."""
    size = printed["step"].value * 1e-3
    linear = audit_continuous.linear_step("y", size, experiments.BAND, loop.RESOLUTION)
    low = 0.022
    motion = audit_continuous.run(bench.plant, bench.plant, {"y": lambda t: ca.SX(low + size)}, {"y": low}, 6.0)
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
        "and (12) as printed in the law, with v_phi = v_theta = 0."
    )
    return row(printed, figures, judge(agree), why, (*FORCES, "M_y", "G"))


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
    csch = bench.mean(bench.ideal(False, bench.plant, bench.plant), "y")
    coth = bench.mean(bench.ideal(False, bench.coth, bench.coth, "coth2"), "y")
    coarse = bench.encoders(False, restored=False)["y"]
    as_printed = _within({"y": coth}, printed)
    corrected = _within({"y": csch}, printed) or _within({"y": coarse}, printed)
    figures = [
        ("y, ideal", csch, "um"),
        ("y, ideal, coth^2", coth, "um"),
        ("y, encoders, printed law", coarse, "um"),
        ("y, encoders, shipped law", bench.encoders(False, restored=True)["y"], "um"),
    ]
    why = (
        f"Rule: within {NEAR:.0%} of the print, ideal or with encoders and the printed law, csch^2; coth^2 is what is "
        "printed. Not met, though the order is right: the terms that (11) drops set the error, and the authors' "
        "re-estimated parameters are not published. v_phi = v_theta = 0, so that the guide springs play no part."
    )
    return row(printed, figures, judge(as_printed, corrected), why, STAGE)


def tracking(bench: Bench, printed: Published) -> Row:
    """F-15: recompute the mean errors of the 4-DOF tracking."""
    plant, free = bench.plant, bench.free
    cases = {
        "ideal, k_s = 0": bench.ideal(True, free, free),
        "ideal, springs known to (12)": bench.ideal(True, plant, plant),
        "ideal, springs unknown to (12)": bench.ideal(True, plant, free),
    }
    errors = {name: {a: bench.mean(motion, a) for a in ("y", "theta")} for name, motion in cases.items()}
    law = "encoders, printed law"
    errors[f"{law}, k_s = 0"] = bench.encoders(True, False, free, springs=False)
    errors[f"{law}, springs known"] = bench.encoders(True, False)
    errors[f"{law}, springs unknown"] = bench.encoders(True, False, springs=False)
    errors["encoders, shipped law, springs known"] = bench.encoders(True, True)
    bare = bench.coth.with_parameters(**dict.fromkeys(SPRINGS, 0.0))
    lost = bench.ideal(True, bare, bare, "coth2")
    units = {"y": "um", "theta": "urad"}
    figures = [(f"{a}, {name}", found[a], units[a]) for name, found in errors.items() for a in units]
    figures.append(("time at which the gap leaves 18 .. 31 mm, ideal, coth^2, k_s = 0", lost.left_at, "s"))
    k_phi, k_theta = (plant.parameter(n).value for n in SPRINGS)
    why = (
        f"Rule: y and theta both within {NEAR:.0%} of the print in one of the csch^2 cases with the printed law. Not "
        "met, though the order is right. The spring constants are not printed: where not 0, the plant has "
        f"k_s_phi = {k_phi:g} and k_s_theta = {k_theta:g} 1/s^2, and (12) the same where it knows them. With coth^2 "
        "and k_s = 0 the dropped terms throw the platen out of its range."
    )
    printed_law = [{a: found[a] for a in units} for name, found in errors.items() if "shipped" not in name]
    verdict = judge(False, any(_within(found, printed) for found in printed_law))
    return row(printed, figures, verdict, why, (*STAGE, *SPRINGS))


def horizontal_errors(bench: Bench, printed: Published) -> Row:
    """F-16: recompute the mean errors along x and z, without and with a fitted guide friction and cogging."""
    ideal = bench.ideal(False, bench.plant, bench.plant)
    cases = {
        "ideal": {a: bench.mean(ideal, a) for a in ("x", "z")},
        "encoders, printed law": bench.encoders(False, restored=False),
        "encoders, friction, cogging": bench.encoders(False, restored=False, disturbance=guides(bench)),
        "4-DOF, encoders, printed law": bench.encoders(True, restored=False),
        "4-DOF, encoders, friction, cogging": bench.encoders(True, restored=False, disturbance=guides(bench)),
    }
    figures = [(f"{a}, {name}", found[a], "um") for name, found in cases.items() for a in ("x", "z")]
    figures += [(f"friction along {a}, fitted", FRICTION[a], "N") for a in ("x", "z")]
    k_phi, k_theta = (bench.plant.parameter(n).value for n in SPRINGS)
    why = (
        f"Rule: x and z within {NEAR:.0%} of the print without anything fitted. (12) inverts the horizontal axes "
        "exactly and the internal model holds the frequency of the reference, so nothing is left but the encoders' "
        f"counts. Coulomb friction of the guides, {FRICTION['x']:g} N along x and {FRICTION['z']:g} N along z, with the "
        "cogging of two motors in phase, comes near the ellipse; one fitted number an axis is no evidence of its own. "
        f"k_s_phi = {k_phi:g}, k_s_theta = {k_theta:g} 1/s^2 in the plant and in (12)."
    )
    found = cases["encoders, printed law"]
    verdict = judge(_within({a: found[a] for a in ("x", "z")}, printed))
    return row(printed, figures, verdict, why, (*STAGE, *SPRINGS))


def guides(bench: Bench) -> ca.Function:
    """Return the accelerations (10,) that friction and cogging add, a function of the state (10,) and t in s.

    F_s = -F_c tanh(v_s/SLIP) + 2 A(y) sin(2 pi s/t1), s = x, z; A is geometric through the field's amplitudes at 20 and
    25 mm.
    """
    names = [s.name for s in bench.plant.states]
    x, t = ca.SX.sym("x", len(names)), ca.SX.sym("t")
    state = dict(zip(names, ca.vertsplit(x), strict=True))
    near, far = (slotted_field.forces(geometry(bench.plant), g, bench.cells).cogging for g in (0.020, 0.025))
    amplitude = near * (far / near) ** ((state["y"] - 0.020) / 0.005)
    added = dict.fromkeys(names, ca.SX(0))
    for axis, mass in (("x", "M_x"), ("z", "M_z")):
        wave = ca.sin(2 * pi * state[axis] / bench.plant.parameter("t1").value)
        force = -FRICTION[axis] * ca.tanh(state[f"v{axis}"] / SLIP) + 2 * amplitude * wave
        added[f"v{axis}"] = force / bench.plant.parameter(mass).value
    return ca.Function("guides", [x, t], [ca.vcat(list(added.values()))])


def _step_figures(kind: str, found: metrics.StepResponse) -> list[tuple[str, float, str]]:
    return [
        (f"overshoot, {kind}", 100 * found.overshoot, "%"),
        (f"t_s, {kind}", found.t_s, "s"),
        (f"t_enc, {kind}", found.t_enc, "s"),
    ]


def _within(found: Mapping[str, float], printed: Published) -> bool:
    return all(abs(v / printed[n].value - 1) <= NEAR for n, v in found.items())
