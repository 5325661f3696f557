"""Experiments of the paper, F section IV, and further ones: wrong guide springs, windup, lift-off, safe output.

A step comes SETTLE after the start, when the loop is at rest within a count of its encoders. Metrics are those of the
true position, as in the paper: overshoot relative to the step, t_s until it stays within 0.1 mm or 0.1 mrad, t_enc
until it stays within 10 um or 20 urad.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache
from math import pi
from typing import Any

import numpy as np

from designs.maglev_5dof import commutation, control, fault_handling
from designs.maglev_5dof.control import OMEGA0, RESOLUTION
from models import maglev_stage
from synth.check import Check
from synth.execute import build, host
from synth.simulate import metrics
from synth.simulate.conditions import Sine
from synth.simulate.experiment import Experiment
from synth.simulate.experiments import Run
from synth.simulate.rig import Rig, Wires
from synth.simulate.scenario import Trajectory, sample_times
from synth.simulate.sensors import Override
from synth.statespace import Array, readonly

Make = Callable[..., Experiment]

SETTLE, AFTER = 1.0, 8.0  # s before a step, and after it
BAND = 1e-4  # m or rad, the band of t_s
UNITS = {"y": "m", "x": "m", "z": "m", "phi": "rad", "theta": "rad"}
COUNTS = {axis: RESOLUTION if unit == "m" else 20e-6 for axis, unit in UNITS.items()}  # m or rad, F section IV-A
TRACK_FROM, TRACK_TO = 10.0, 60.0  # s, the window of the mean errors
COURSES = {  # of the 4-DOF tracking, F section IV-B
    "y": Sine(0.005, OMEGA0, -pi / 2, 0.025),
    "x": Sine(0.03, OMEGA0, -pi / 2),
    "z": Sine(0.03, OMEGA0),
    "theta": Sine(0.01, OMEGA0),
}
WIRES: Wires = {f"i_d{j}": f"i_d{j}" for j in control.MOTORS} | {"u_x": "i_q2", "u_z": "i_q1"}
NO_ROTATION: Wires = {**WIRES, **{f"i_d{j}": {f"i_d{k}": 0.25 for k in control.MOTORS} for j in control.MOTORS}}
Y_LIMITS, XZ_LIMITS, THETA_LIMITS, WRONG_LIMITS = (0.20, 2.2, 4.0), (0.25, 2.0, 3.5), (0.20, 2.2, 4.0), (0.40, 3.3, 6.0)
TRACKING_LIMITS = {"y": 50e-6, "x": 1.5e-6, "z": 1.5e-6, "theta": 25e-6}  # m, rad: mean errors of the 4-DOF tracking
STABLE = "the axis stays stable over the spring's tolerance"
TILTED: Mapping[str, Any] = {"axis": "phi", "target": 0.5e-3, "about": STABLE, "settles": True}
LEVEL: Mapping[str, Any] = {"about": "in the paper's configuration", "actuators": NO_ROTATION}
LOCKED: Mapping[str, Any] = {"about": "in the paper's configuration", "locked": ("x", "z")}


@dataclass(frozen=True, eq=False)
class StepRun:
    """The trajectory of a step with its set-point (N,), the metrics, and the sample of the step."""

    trajectory: Trajectory
    reference: Array
    response: metrics.StepResponse
    sample: int


def step(
    rig: Rig, axis: str, start: float, target: float, gap: float = 0.025, after: float = AFTER, **options: Any
) -> StepRun:
    """Run one step of `axis` from `start` to `target` (m, rad) at a gap in m, followed for `after` seconds.

    With `actuators` among the options the drive is left out, and with `locked` coordinates the fault handling, too: an
    encoder of a platen that is clamped looks like a frozen one.
    """
    rig = rig.without_drive if options.keys() & {"actuators", "locked"} else rig
    rig = _with(rig, "without fault handling") if "locked" in options else rig
    time = sample_times(SETTLE + after, rig.period_s)
    reference = np.where(time < SETTLE, start, target)
    trajectory = rig.run(SETTLE + after, {"y": gap} | {axis: start}, {f"{axis}_ref": reference}, **options)
    k = int(np.argmax(time >= SETTLE))
    response = metrics.step_response(time[k:], trajectory[axis][k:], start, target, BAND, COUNTS[axis])
    return StepRun(trajectory, reference, response, k)


@cache
def _courses(duration_s: float, period_s: float) -> dict[str, Array]:
    """Return the set-points of the 4-DOF tracking: a study runs it on many machines."""
    return {axis: readonly(course(sample_times(duration_s, period_s))) for axis, course in COURSES.items()}


def tracking(rig: Rig, four: bool, duration_s: float = TRACK_TO) -> tuple[Trajectory, dict[str, Array]]:
    """Run the 4-DOF tracking or the 3-DOF ellipse from rest; return it with the set-points by axis."""
    courses = {axis: course for axis, course in _courses(duration_s, rig.period_s).items() if four or axis != "theta"}
    start = {axis: float(courses[axis][0]) for axis in ("y", "x", "z")}
    references = {f"{axis}_ref": course for axis, course in courses.items()}
    if four:
        return rig.run(duration_s, start, references), courses
    return rig.without_drive.run(duration_s, start, references, actuators=NO_ROTATION), courses


def mean_errors(
    trajectory: Trajectory, courses: Mapping[str, Array], start: float = TRACK_FROM, stop: float = TRACK_TO
) -> dict[str, float]:
    """Return the mean |true error| of each axis from `start` to `stop` s, m and rad."""
    errors = {axis: trajectory[axis] - courses.get(axis, 0.0) for axis in UNITS}
    return {axis: metrics.mean_absolute(trajectory.time, e, start, stop) for axis, e in errors.items()}


def motor_currents(trajectory: Trajectory) -> Array:
    """Return hypot(i_d, i_q) of the four commanded motor currents (4, N), A rms."""
    commands = trajectory.commands
    magnitudes = np.empty((len(control.MOTORS), len(trajectory.time)))
    for i, j in zip(magnitudes, control.MOTORS, strict=True):
        np.square(commands[f"i_d{j}"], out=i, dtype=float)
        i += np.square(commands[f"i_q{j}"], dtype=float)
    return np.sqrt(magnitudes, out=magnitudes)


def _experiment(
    trajectory: Trajectory,
    about: str,
    courses: Mapping[str, Array],
    figures: Mapping[str, float],
    checks: Sequence[Check] = (),
    shown: Sequence[str] = (),
    overload: bool = False,
) -> Experiment:
    currents = motor_currents(trajectory)
    limited = Check("largest motor current", float(currents.max()), 4.950, "A rms", "hypot(i_d, i_q)")
    axes, further = tuple(shown or courses), _overload(currents) if overload else {}
    return Experiment("", "", about, trajectory, axes, dict(courses), {**figures, **further}, (*checks, limited))


def _last_second(trajectory: Trajectory, axis: str, target: float, limit: float) -> Check:
    error = float(np.max(np.abs(trajectory[axis][-1000:] - target)))
    return Check("true error in the last second", error, limit, UNITS[axis])


def _overload(currents: Array) -> dict[str, float]:
    share = np.count_nonzero(currents > control.RATED) / currents.size
    return {"share of motor samples above the 5 A continuous rating": share}


def _step(
    rig: Rig, axis: str, target: float, limits: tuple[float, float, float], start: float = 0.0, gap: float = 0.025
) -> Experiment:
    """Run a step with `limits` on overshoot, t_s and t_enc."""
    run, unit = step(rig, axis, start, target, gap), UNITS[axis]
    trajectory, response = run.trajectory, run.response
    checks = [
        Check("overshoot", response.overshoot, limits[0], "1", "of the step"),
        Check("t_s", response.t_s, limits[1], "s", f"true error stays within 0.1 m{unit}"),
        Check("t_enc", response.t_enc, limits[2], "s", "true error stays within 10 um or 20 urad"),
    ]
    if unit == "m":
        # One count in single precision, which rounds 31 mm by up to 1 nm.
        names, limit = [f"y{j}" for j in control.MOTORS] if axis == "y" else [axis], RESOLUTION * (1 + 1e-4)
        measured = np.mean([trajectory.measured[name].astype(float) for name in names], axis=0)
        error = float(np.max(np.abs(measured[-1000:] - target)))
        checks.append(Check("measured error in the last second", error, limit, "m", "one encoder count"))
    if axis in "xz":
        excursion = float(np.max(np.abs(trajectory["y"][run.sample :] - trajectory["y"][run.sample])))
        checks.append(Check("gap moves by", excursion, 20e-6, "m", "during the step"))
    about = f"{axis} from {start:g} to {target:g} {unit}, encoders of 10 um, one sample of delay"
    return _experiment(trajectory, about, {axis: run.reference}, {}, checks, overload=True)


def _response(
    rig: Rig, axis: str, target: float, about: str, start: float = 0.0, settles: bool = False, **options: Any
) -> Experiment:
    """Run a step; with `settles` the error in the last second must be within BAND."""
    run = step(rig, axis, start, target, **options)
    r, checks = run.response, [_last_second(run.trajectory, axis, target, BAND)] if settles else []
    figures = {"overshoot": r.overshoot, "t_s, s": r.t_s, "t_enc, s": r.t_enc}
    return _experiment(run.trajectory, about, {axis: run.reference}, figures, checks)


def tracking_experiment(
    trajectory: Trajectory, courses: Mapping[str, Array], four: bool, start: float = TRACK_FROM, stop: float = TRACK_TO
) -> Experiment:
    """Return all figures of the tracking; the mean errors are those from `start` to `stop` s."""
    errors, y = mean_errors(trajectory, courses, start, stop), trajectory["y"]
    limits = TRACKING_LIMITS if four else {}
    window = f"{start:g} to {stop:g} s"
    checks = [Check(f"mean |e_{n}|", errors[n], limit, UNITS[n], window) for n, limit in limits.items()]
    beyond = float(max(control.GAP[0] - y.min(), y.max() - control.GAP[1]))
    checks.append(Check("y leaves 18 .. 31 mm by", beyond, 0.0, "m"))
    gaps = [trajectory[f"g{j}"] for j in control.MOTORS]
    least, greatest = min(g.min() for g in gaps), max(g.max() for g in gaps)
    figures = {f"mean |e_{n}|, u{UNITS[n]}": e * 1e6 for n, e in errors.items()}
    figures |= {"least motor gap, mm": least * 1e3, "greatest motor gap, mm": greatest * 1e3}
    about = f"{stop:g} s from rest, encoders of 10 um"
    return _experiment(trajectory, about, courses, figures, checks, overload=True)


def _tracking(rig: Rig, four: bool) -> Experiment:
    return tracking_experiment(*tracking(rig, four), four)


@cache
def at_measured_position(scalar: str) -> host.Controller:
    """Return the commutation at the measured position, without the advance, compiled in a scalar type by name."""
    kind = np.dtype(scalar).type
    block = commutation.phase_currents(maglev_stage.plant(), 0.0)
    return build.compile_block(block, kind, error=control.SURROGATE_ERROR[kind])


def _tracking_at_measured_position(rig: Rig) -> Experiment:
    """Run the 4-DOF tracking with the commutation at the measured position, for comparison."""
    used = at_measured_position(np.dtype(rig.controller.scalar).name)
    trajectory, courses = tracking(replace(rig, drive=(used,)), True)
    errors = mean_errors(trajectory, courses)
    figures = {f"mean |e_{n}|, u{UNITS[n]}": e * 1e6 for n, e in errors.items()}
    return _experiment(trajectory, "the angle lags by one and a half samples of the motion", courses, figures)


@cache
def compiled_variant(variant: str, scalar: str) -> host.Controller:
    """Return the controller without anti-windup or without fault handling, compiled in a scalar type by name."""
    kind, plant = np.dtype(scalar).type, maglev_stage.plant()
    windup, bare = fault_handling.controller(plant, anti_windup=False), control.controller(plant)
    controller = {"without anti-windup": windup, "without fault handling": bare}[variant]
    return build.compile_block(controller.block, kind, error=control.SURROGATE_ERROR[kind])


def _with(rig: Rig, variant: str) -> Rig:
    return replace(rig, controller=compiled_variant(variant, np.dtype(rig.controller.scalar).name))


def _windup(rig: Rig, anti_windup: bool) -> Experiment:
    """Step x by 100 mm at a gap of 30 mm with the anti-windup (17), or without it."""
    bare = _with(rig, "without anti-windup")
    about = "without stops along x, so the overshoot is visible"
    without = _response(bare, "x", 0.05, about, -0.05, gap=0.030)
    if not anti_windup:
        return without
    run = _response(rig, "x", 0.05, about, -0.05, gap=0.030)
    ratio = run.figures["overshoot"] / without.figures["overshoot"]
    check = Check("overshoot with over overshoot without", ratio, 0.9, "1", "the anti-windup must have an effect here")
    return replace(run, checks=(check, *run.checks))


def _lift_off(rig: Rig) -> Experiment:
    """Lift from the 31 mm stop to 25 mm by a ramp of 1 s."""
    time = sample_times(6.0, rig.period_s)
    reference = 0.031 - 0.006 * np.clip(time - SETTLE, 0.0, 1.0)
    trajectory = rig.run(6.0, {"y": 0.031}, {"y_ref": reference})
    checks = (
        Check("overshoot", float(0.025 - trajectory["y"].min()) / 0.006, 0.02, "1", "of the 6 mm"),
        _last_second(trajectory, "y", 0.025, RESOLUTION),
    )
    return _experiment(trajectory, "from rest on the lower stop", {"y": reference}, {}, checks)


def _set_down(rig: Rig, gap: float) -> Experiment:
    """Lose three gap encoders at a gap in m."""
    time = sample_times(3.0, rig.period_s)
    lost = Override(time >= SETTLE, np.full(len(time), np.nan))
    trajectory = rig.run(3.0, {"y": gap}, overrides=dict.fromkeys(("y1", "y2", "y3"), lost))
    latched = trajectory.faults[int(np.argmax(time >= SETTLE)) + control.BAD_SAMPLES - 1 :] >> 31
    checks = (
        Check("rises above the start by", float(gap - trajectory["y"].min()), 1e-4, "m", "no motion upwards"),
        Check("distance from the 31 mm stop at the end", float(0.031 - trajectory["y"][-1]), 1e-6, "m"),
        Check("samples without the latch after 5 bad ones", float(np.count_nonzero(latched == 0)), 0.0, "1"),
    )
    figures = {"speed at the lower stop, m/s": float(trajectory["vy"].max())}
    return _experiment(trajectory, f"y1, y2 and y3 read NaN from {SETTLE:.1f} s on", {}, figures, checks, ["y"])


def _zero_current(rig: Rig) -> Experiment:
    trajectory = rig.without_drive.run(0.5, actuators={}, forcing=dict.fromkeys(WIRES, 0.0))
    hit = metrics.first_exit(trajectory.time, trajectory["y"], control.GAP[0] + 1e-9, control.GAP[1])
    figures = {"time to the upper stop, s": hit, "speed there, m/s": trajectory.impacts["y"]}
    return Experiment("", "", "the platen hits the upper stop", trajectory, ("y",), {}, figures)


def _run(name: str, title: str, make: Make, springs: Mapping[str, float] | None = None, **options: Any) -> Run:
    """Return the experiment `make(rig, **options)` with true guide springs `springs` times the assumed ones."""

    def run(rig: Rig, name: str) -> Experiment:
        true = {spring: rig.plant.parameter(spring).value * factor for spring, factor in (springs or {}).items()}
        experiment = make(replace(rig, plant=rig.plant.with_parameters(**true)), **options)
        return replace(experiment, name=name, title=title)

    return Run(name, run)


def _gap(a: int, b: int, make: Make, prefix: str = "", title: str = "", **options: Any) -> Run:
    step: Any = {"axis": "y", "start": a / 1e3, "target": b / 1e3, "gap": a / 1e3}
    return _run(f"{prefix}y_{a}_{b}", f"Air gap {a} to {b} mm{title} (Fig. 4)", make, **step, **options)


def _theta(mrad: int, make: Make, prefix: str = "", title: str = "", **options: Any) -> Run:
    title = f"theta by {mrad} mrad{title} (Fig. 5)"
    return _run(f"{prefix}theta_{mrad}", title, make, axis="theta", target=mrad / 1e3, **options)


def _wrong_spring(mrad: int, factor: float) -> Run:
    title = f"theta by {mrad} mrad, the true guide spring {factor:.2f} of the assumed one"
    step: Any = {"axis": "theta", "target": mrad / 1e3, "limits": WRONG_LIMITS}
    return _run(f"theta_{mrad}_springs_{factor:.2f}", title, _step, {"k_s_theta": factor}, **step)


PHI_SPRING = "phi by 0.5 mrad, the true guide spring {:g} of the assumed one"
LOST = "Safe output from {:g} mm after the loss of three gap encoders"
MEASURED = "commutation at the measured position, for comparison"
WINDUP = "x from -50 to 50 mm at 30 mm gap, {} anti-windup"
ALL = (
    *(_gap(a, b, _step, limits=Y_LIMITS) for a, b in ((22, 29), (29, 22), (20, 27), (27, 20))),
    *(_run(f"{s}_30", f"{s} by 30 mm", _step, axis=s, target=0.03, limits=XZ_LIMITS) for s in "xz"),
    *(_theta(mrad, _step, limits=THETA_LIMITS) for mrad in (5, 10)),
    *(_wrong_spring(mrad, factor) for factor in (0.8, 1 / 1.2, 1.2, 1 / 0.8) for mrad in (5, 10)),
    *(_run(f"phi_springs_{k:g}", PHI_SPRING.format(k), _response, {"k_s_phi": k}, **TILTED) for k in (0.7, 1.0, 1.3)),
    *(_gap(a, b, _response, "paper_", ", v_phi = v_theta = 0", **LEVEL) for a, b in ((22, 29), (29, 22))),
    *(_theta(mrad, _response, "paper_", ", x and z locked", **LOCKED) for mrad in (5, 10)),
    _run("ellipse", "3-DOF ellipse (Fig. 6)", _tracking, four=False),
    _run("tracking", "4-DOF tracking (Figs. 7, 8)", _tracking, four=True),
    _run("tracking_measured_angle", f"4-DOF tracking, {MEASURED}", _tracking_at_measured_position),
    *(_run(f"windup_{kind}", WINDUP.format(kind), _windup, anti_windup=kind == "with") for kind in ("with", "without")),
    _run("lift_off", "Lift-off from the 31 mm stop, ramp of 1 s to 25 mm", _lift_off),
    *(_run(f"set_down_{mm:g}", LOST.format(mm), _set_down, gap=mm / 1e3) for mm in (18.1, 20, 25, 30)),
    _run("zero_current", "Zero current from 25 mm, for comparison", _zero_current),
)
