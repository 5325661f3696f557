"""Experiments of the paper, F section IV, and further ones: wrong guide springs, lift-off, safe output."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any

import numpy as np

from designs.maglev import commutation, motions, platen
from designs.maglev.platen import RESOLUTION
from synth.check import Check
from synth.declare.experiments import Run
from synth.declare.stage import Stage
from synth.execute import host
from synth.simulate import metrics
from synth.simulate.experiments import Experiment
from synth.simulate.rig import Rig
from synth.simulate.scenario import Override, Trajectory, sample_times
from synth.statespace import Array

Make = Callable[..., Experiment]

STABLE = "the axis stays stable over the spring's tolerance"
TILTED: Mapping[str, Any] = {"axis": "phi", "target": 0.5e-3, "about": STABLE, "settles": True}
LEVEL: Mapping[str, Any] = {"about": "in the paper's configuration", "actuators": motions.NO_ROTATION}
LOCKED: Mapping[str, Any] = {"about": "in the paper's configuration", "locked": ("x", "z")}


@dataclass(frozen=True)
class Limits:
    """Limits of a design: overshoot, t_s and t_enc of steps, and by axis the mean errors of the 4-DOF tracking.

    `wrong` is for theta with a wrong guide spring.
    """

    y: tuple[float, float, float]
    xz: tuple[float, float, float]
    theta: tuple[float, float, float]
    wrong: tuple[float, float, float]
    tracking: Mapping[str, float]


def experiment(
    trajectory: Trajectory,
    about: str,
    courses: Mapping[str, Array],
    figures: Mapping[str, float],
    checks: Sequence[Check] = (),
    shown: Sequence[str] = (),
    overload: bool = False,
) -> Experiment:
    """Return an experiment of a trajectory, with its largest current; with `overload` also its share of overload."""
    currents = motions.motor_currents(trajectory)
    limited = Check("largest motor current", float(currents.max()), 4.950, "A rms", "hypot(i_d, i_q)")
    axes, further = tuple(shown or courses), _overload(currents) if overload else {}
    return Experiment("", "", about, trajectory, axes, dict(courses), {**figures, **further}, (*checks, limited))


def _last_second(trajectory: Trajectory, axis: str, target: float, limit: float) -> Check:
    error = float(np.max(np.abs(trajectory[axis][-1000:] - target)))
    return Check("true error in the last second", error, limit, motions.UNITS[axis])


def _overload(currents: Array) -> dict[str, float]:
    share = np.count_nonzero(currents > platen.RATED) / currents.size
    return {"share of motor samples above the 5 A continuous rating": share}


def _step(
    rig: Rig, axis: str, target: float, limits: tuple[float, float, float], start: float = 0.0, gap: float = 0.025
) -> Experiment:
    """Run a step with `limits` on overshoot, t_s and t_enc."""
    run, unit = motions.step(rig, axis, start, target, gap), motions.UNITS[axis]
    trajectory, response = run.trajectory, run.response
    checks = [
        Check("overshoot", response.overshoot, limits[0], "1", "of the step"),
        Check("t_s", response.t_s, limits[1], "s", f"true error stays within 0.1 m{unit}"),
        Check("t_enc", response.t_enc, limits[2], "s", "true error stays within 10 um or 20 urad"),
    ]
    if unit == "m":
        # One count in single precision, which rounds 31 mm by up to 1 nm.
        names, limit = [f"y{j}" for j in platen.MOTORS] if axis == "y" else [axis], RESOLUTION * (1 + 1e-4)
        measured = np.mean([trajectory.measured[name].astype(float) for name in names], axis=0)
        error = float(np.max(np.abs(measured[-1000:] - target)))
        checks.append(Check("measured error in the last second", error, limit, "m", "one encoder count"))
    if axis in "xz":
        excursion = float(np.max(np.abs(trajectory["y"][run.sample :] - trajectory["y"][run.sample])))
        checks.append(Check("gap moves by", excursion, 20e-6, "m", "during the step"))
    about = f"{axis} from {start:g} to {target:g} {unit}, encoders of 10 um, one sample of delay"
    figures = {f"hunting, u{unit}": float(np.ptp(trajectory[axis][-1000:])) * 1e6}  # in the last second
    return experiment(trajectory, about, {axis: run.reference}, figures, checks, overload=True)


def response(
    rig: Rig, axis: str, target: float, about: str, start: float = 0.0, settles: bool = False, **options: Any
) -> Experiment:
    """Run a step; with `settles` the error in the last second must be within BAND."""
    run = motions.step(rig, axis, start, target, **options)
    r, checks = run.response, [_last_second(run.trajectory, axis, target, motions.BAND)] if settles else []
    figures = {"overshoot": r.overshoot, "t_s, s": r.t_s, "t_enc, s": r.t_enc}
    return experiment(run.trajectory, about, {axis: run.reference}, figures, checks)


def tracking_experiment(
    trajectory: Trajectory,
    courses: Mapping[str, Array],
    limits: Mapping[str, float],
    start: float = motions.TRACK_FROM,
    stop: float = motions.TRACK_TO,
) -> Experiment:
    """Return all figures of the tracking; the mean errors are those from `start` to `stop` s."""
    errors, y = motions.mean_errors(trajectory, courses, start, stop), trajectory["y"]
    window = f"{start:g} to {stop:g} s"
    checks = [Check(f"mean |e_{n}|", errors[n], limit, motions.UNITS[n], window) for n, limit in limits.items()]
    beyond = float(max(platen.GAP[0] - y.min(), y.max() - platen.GAP[1]))
    checks.append(Check("y leaves 18 .. 31 mm by", beyond, 0.0, "m"))
    gaps = [trajectory[f"g{j}"] for j in platen.MOTORS]
    least, greatest = min(g.min() for g in gaps), max(g.max() for g in gaps)
    figures = {f"mean |e_{n}|, u{motions.UNITS[n]}": e * 1e6 for n, e in errors.items()}
    figures |= {"least motor gap, mm": least * 1e3, "greatest motor gap, mm": greatest * 1e3}
    about = f"{stop:g} s from rest, encoders of 10 um"
    return experiment(trajectory, about, courses, figures, checks, overload=True)


def _tracking(rig: Rig, four: bool, limits: Mapping[str, float]) -> Experiment:
    return tracking_experiment(*motions.tracking(rig, four), limits)


@lru_cache(maxsize=8)
def _at_measured_position(stage: Stage, scalar: str) -> host.Controller:
    """Return the commutation at the measured position, without the advance, compiled in a scalar type by name."""
    return motions.compile_block(commutation.phase_currents(stage.name, stage.plant, 0.0), scalar)


def _tracking_at_measured_position(rig: Rig) -> Experiment:
    """Run the 4-DOF tracking with the commutation at the measured position, for comparison."""
    used = _at_measured_position(rig.stage, np.dtype(rig.controller.scalar).name)
    trajectory, courses = motions.tracking(replace(rig, drive=(used,)), True)
    errors = motions.mean_errors(trajectory, courses)
    figures = {f"mean |e_{n}|, u{motions.UNITS[n]}": e * 1e6 for n, e in errors.items()}
    return experiment(trajectory, "the angle lags by one and a half samples of the motion", courses, figures)


def _lift_off(rig: Rig) -> Experiment:
    """Lift from the 31 mm stop to 25 mm by a ramp of 1 s."""
    trajectory, reference = motions.lift_off(rig)
    checks = (
        Check("overshoot", float(0.025 - trajectory["y"].min()) / 0.006, 0.02, "1", "of the 6 mm"),
        _last_second(trajectory, "y", 0.025, RESOLUTION),
    )
    return experiment(trajectory, "from rest on the lower stop", {"y": reference}, {}, checks)


def _set_down(rig: Rig, gap: float) -> Experiment:
    """Lose three gap encoders at a gap in m."""
    time = sample_times(3.0, rig.period_s)
    lost = Override(time >= motions.SETTLE, np.full(len(time), np.nan))
    trajectory = rig.run(3.0, {"y": gap}, overrides=dict.fromkeys(("y1", "y2", "y3"), lost))
    latched = trajectory.faults[int(np.argmax(time >= motions.SETTLE)) + platen.BAD_SAMPLES - 1 :] >> 31
    checks = (
        Check("rises above the start by", float(gap - trajectory["y"].min()), 1e-4, "m", "no motion upwards"),
        Check("distance from the 31 mm stop at the end", float(0.031 - trajectory["y"][-1]), 1e-6, "m"),
        Check("samples without the latch after 5 bad ones", float(np.count_nonzero(latched == 0)), 0.0, "1"),
    )
    figures = {"speed at the lower stop, m/s": float(trajectory["vy"].max())}
    return experiment(trajectory, f"y1, y2 and y3 read NaN from {motions.SETTLE:.1f} s on", {}, figures, checks, ["y"])


def _zero_current(rig: Rig) -> Experiment:
    trajectory = rig.without_drive.run(0.5, actuators={}, forcing=dict.fromkeys(platen.WIRES, 0.0))
    hit = metrics.first_exit(trajectory.time, trajectory["y"], platen.GAP[0] + 1e-9, platen.GAP[1])
    figures = {"time to the upper stop, s": hit, "speed there, m/s": trajectory.impacts["y"]}
    return Experiment("", "", "the platen hits the upper stop", trajectory, ("y",), {}, figures)


def run(name: str, title: str, make: Make, springs: Mapping[str, float] | None = None, **options: Any) -> Run:
    """Return the experiment `make(rig, **options)` with true guide springs `springs` times the assumed ones."""

    def execute(rig: Rig, name: str) -> Experiment:
        true = {spring: rig.plant.parameter(spring).value * factor for spring, factor in (springs or {}).items()}
        experiment = make(replace(rig, plant=rig.plant.with_parameters(**true)), **options)
        return replace(experiment, name=name, title=title)

    return Run(name, execute)


def _gap(a: int, b: int, make: Make, prefix: str = "", title: str = "", **options: Any) -> Run:
    step: Any = {"axis": "y", "start": a / 1e3, "target": b / 1e3, "gap": a / 1e3}
    return run(f"{prefix}y_{a}_{b}", f"Air gap {a} to {b} mm{title} (Fig. 4)", make, **step, **options)


def _theta(mrad: int, make: Make, prefix: str = "", title: str = "", **options: Any) -> Run:
    title = f"theta by {mrad} mrad{title} (Fig. 5)"
    return run(f"{prefix}theta_{mrad}", title, make, axis="theta", target=mrad / 1e3, **options)


def _wrong_spring(mrad: int, factor: float, limits: Limits) -> Run:
    title = f"theta by {mrad} mrad, the true guide spring {factor:.2f} of the assumed one"
    step: Any = {"axis": "theta", "target": mrad / 1e3, "limits": limits.wrong}
    return run(f"theta_{mrad}_springs_{factor:.2f}", title, _step, {"k_s_theta": factor}, **step)


PHI_SPRING = "phi by 0.5 mrad, the true guide spring {:g} of the assumed one"
LOST = "Safe output from {:g} mm after the loss of three gap encoders"
MEASURED = "commutation at the measured position, for comparison"


def of(limits: Limits) -> tuple[Run, ...]:
    """Return the experiments of a design, with its limits."""
    factors, steps = (0.8, 1 / 1.2, 1.2, 1 / 0.8), ((22, 29), (29, 22), (20, 27), (27, 20))
    return (
        *(_gap(a, b, _step, limits=limits.y) for a, b in steps),
        *(run(f"{s}_30", f"{s} by 30 mm", _step, axis=s, target=0.03, limits=limits.xz) for s in "xz"),
        *(_theta(mrad, _step, limits=limits.theta) for mrad in (5, 10)),
        *(_wrong_spring(mrad, factor, limits) for factor in factors for mrad in (5, 10)),
        *(run(f"phi_springs_{k:g}", PHI_SPRING.format(k), response, {"k_s_phi": k}, **TILTED) for k in (0.7, 1.0, 1.3)),
        *(_gap(a, b, response, "paper_", ", v_phi = v_theta = 0", **LEVEL) for a, b in steps[:2]),
        *(_theta(mrad, response, "paper_", ", x and z locked", **LOCKED) for mrad in (5, 10)),
        run("ellipse", "3-DOF ellipse (Fig. 6)", _tracking, four=False, limits={}),
        run("tracking", "4-DOF tracking (Figs. 7, 8)", _tracking, four=True, limits=limits.tracking),
        run("tracking_measured_angle", f"4-DOF tracking, {MEASURED}", _tracking_at_measured_position),
        run("lift_off", "Lift-off from the 31 mm stop, ramp of 1 s to 25 mm", _lift_off),
        *(run(f"set_down_{mm:g}", LOST.format(mm), _set_down, gap=mm / 1e3) for mm in (18.1, 20, 25, 30)),
        run("zero_current", "Zero current from 25 mm, for comparison", _zero_current),
    )
