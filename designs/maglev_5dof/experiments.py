"""The paper's experiments, F section IV, and what a user of the stage must be sure of beyond them.

A step comes SETTLE after the start, so that the loop is at rest on its encoders' counts by then. Metrics are on the
true position, as the paper defines them: overshoot in parts of the step, t_s to stay within 0.1 mm or 0.1 mrad, t_enc
to stay within 10 um or 20 urad.
"""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cache, partial
from math import pi
from typing import Any

import numpy as np
from numpy.typing import NDArray

from designs.maglev_5dof import control
from designs.maglev_5dof.control import RESOLUTION
from models import maglev_stage
from synth.check import Check
from synth.execute import build, host
from synth.simulate import metrics
from synth.simulate.experiment import Experiment
from synth.simulate.rig import Rig
from synth.simulate.scenario import Trajectory, sample_times
from synth.simulate.sensors import Override

Array = NDArray[np.float64]
Limits = tuple[float, float, float]

SETTLE, AFTER = 1.0, 8.0  # s before a step, and after it
BAND = 1e-4  # m or rad, the band of t_s
ANGLE_RESOLUTION = 20e-6  # rad, F section IV-A
TRACK_FROM, TRACK_TO = 10.0, 60.0  # s, the window of the mean errors
AXES = ("y", "x", "z", "phi", "theta")
WIRES: Mapping[str, str | Mapping[str, float]] = {
    **{f"i_d{j}": f"i_d{j}" for j in range(1, 5)},
    "u_x": "i_q2",
    "u_z": "i_q1",
}
NO_ROTATION = {**WIRES, **{f"i_d{j}": {f"i_d{k}": 0.25 for k in range(1, 5)} for j in range(1, 5)}}
Y_LIMITS, XZ_LIMITS, THETA_LIMITS, WRONG_LIMITS = (0.20, 2.2, 4.0), (0.25, 2.0, 3.5), (0.20, 2.2, 4.0), (0.40, 3.3, 6.0)
TRACKED = {"y": 50e-6, "x": 2e-6, "z": 2e-6, "theta": 25e-6}  # m, rad: mean errors of the 4-DOF tracking


@dataclass(frozen=True)
class Run:
    """An experiment by name."""

    name: str
    make: Callable[[Rig, str], Experiment]

    def run(self, rig: Rig) -> Experiment:
        """Carry it out."""
        return self.make(rig, self.name)


@dataclass(frozen=True, eq=False)
class StepRun:
    """A step's whole trajectory with its set-point (N,), the metrics, and the sample at which the step comes."""

    trajectory: Trajectory
    reference: Array
    response: metrics.StepResponse
    sample: int


def reference_4dof(time: Array) -> dict[str, Array]:
    """Return the set-points of the 4-DOF tracking run, F section IV-B."""
    w = control.OMEGA0
    return {
        "y_ref": 0.005 * np.sin(w * time - pi / 2) + 0.025,
        "x_ref": 0.03 * np.sin(w * time - pi / 2),
        "z_ref": 0.03 * np.sin(w * time),
        "theta_ref": 0.01 * np.sin(w * time),
    }


def reference_3dof(time: Array) -> dict[str, Array]:
    """Return the set-points of the ellipse, F section IV-B."""
    return {name: values for name, values in reference_4dof(time).items() if name != "theta_ref"}


def step(
    rig: Rig, axis: str, start: float, target: float, gap: float = 0.025, after: float = AFTER, **options: Any
) -> StepRun:
    """Run one step of `axis` from `start` to `target` (m, rad) at a gap in m, followed for `after` seconds."""
    time = sample_times(SETTLE + after, control.TIME.period_s)
    reference = np.where(time < SETTLE, start, target)
    trajectory = rig.run(SETTLE + after, {"y": gap} | {axis: start}, {f"{axis}_ref": reference}, **options)
    k = int(np.argmax(time >= SETTLE))
    resolution = ANGLE_RESOLUTION if axis in ("phi", "theta") else RESOLUTION
    response = metrics.step_response(time[k:], trajectory[axis][k:], start, target, BAND, resolution)
    return StepRun(trajectory, reference, response, k)


def tracking(rig: Rig, four: bool, duration_s: float = TRACK_TO) -> tuple[Trajectory, dict[str, Array]]:
    """Run the 4-DOF tracking or the 3-DOF ellipse, from rest at the start of the reference."""
    time = sample_times(duration_s, control.TIME.period_s)
    references = reference_4dof(time) if four else reference_3dof(time)
    start = {n: float(references[f"{n}_ref"][0]) for n in ("y", "x", "z")}
    return rig.run(duration_s, start, references, actuators=WIRES if four else NO_ROTATION), references


def mean_errors(trajectory: Trajectory, references: Mapping[str, Array]) -> dict[str, float]:
    """Return the mean |true error| of each axis over the window, m and rad."""
    errors = {axis: trajectory[axis] - references.get(f"{axis}_ref", 0.0) for axis in AXES}
    return {axis: metrics.mean_absolute(trajectory.time, e, TRACK_FROM, TRACK_TO) for axis, e in errors.items()}


def motor_currents(trajectory: Trajectory) -> Array:
    """Return hypot(i_d, i_q) of the four commanded motor currents (4, N), A rms."""
    return np.array([np.hypot(*(trajectory.commands[f"i_{a}{j}"].astype(float) for a in "dq")) for j in range(1, 5)])


def unit(axis: str) -> str:
    """Return the unit of a coordinate."""
    return "rad" if axis in ("phi", "theta") else "m"


def _largest_current(trajectory: Trajectory) -> Check:
    return Check("largest motor current", float(motor_currents(trajectory).max()), 4.950, "A rms", "hypot(i_d, i_q)")


def _overload(trajectory: Trajectory) -> dict[str, float]:
    share = float(np.mean(motor_currents(trajectory) > control.RATED))
    return {"share of motor samples above the 5 A continuous rating": share}


def _with_spring(rig: Rig, axis: str, factor: float) -> Rig:
    """Return the rig with the true guide spring of an angle a factor of the assumed one."""
    name = f"k_s_{axis}"
    return replace(rig, plant=rig.plant.with_parameters(**{name: rig.plant.parameter(name).value * factor}))


def _step(
    rig: Rig, name: str, title: str, axis: str, start: float, target: float, limits: Limits, gap: float = 0.025
) -> Experiment:
    run = step(rig, axis, start, target, gap)
    trajectory, response = run.trajectory, run.response
    checks = [
        Check("overshoot", response.overshoot, limits[0], "1", "of the step"),
        Check("t_s", response.t_s, limits[1], "s", f"true error stays within 0.1 m{unit(axis)}"),
        Check("t_enc", response.t_enc, limits[2], "s", "true error stays within 10 um or 20 urad"),
        _largest_current(trajectory),
    ]
    if unit(axis) == "m":
        # One count, as single precision reads it: a count on 31 mm is off by up to 1 nm there.
        error = float(np.max(np.abs(_measured(trajectory, axis)[-1000:] - target)))
        checks.append(
            Check("measured error in the last second", error, RESOLUTION * (1 + 1e-4), "m", "one encoder count")
        )
    if axis in ("x", "z"):
        moved = float(np.max(np.abs(trajectory["y"][run.sample :] - trajectory["y"][run.sample])))
        checks.append(Check("gap moves by", moved, 20e-6, "m", "during the step"))
    about = f"{axis} from {start:g} to {target:g} {unit(axis)}, encoders of 10 um, one sample of delay"
    shown, figures = {axis: run.reference}, _overload(trajectory)
    return Experiment(name, title, about, trajectory, (axis,), shown, figures, tuple(checks))


def _measured(trajectory: Trajectory, axis: str) -> Array:
    if axis == "y":
        return np.mean([trajectory.measured[f"y{j}"].astype(float) for j in range(1, 5)], axis=0)
    return trajectory.measured[axis].astype(float)


def _wrong_spring(rig: Rig, name: str, title: str, angle: float, factor: float) -> Experiment:
    return _step(_with_spring(rig, "theta", factor), name, title, "theta", 0.0, angle, WRONG_LIMITS)


def _tilt(rig: Rig, name: str, title: str, factor: float) -> Experiment:
    """Step phi, whose guide spring is stiff and known to 30 % only."""
    run = step(_with_spring(rig, "phi", factor), "phi", 0.0, 0.5e-3)
    last = float(np.max(np.abs(run.trajectory["phi"][-1000:] - 0.5e-3)))
    checks = (Check("true error in the last second", last, BAND, "rad"), _largest_current(run.trajectory))
    about, figures = "the axis stays stable over the spring's tolerance", {"overshoot": run.response.overshoot}
    return Experiment(name, title, about, run.trajectory, ("phi",), {"phi": run.reference}, figures, checks)


def _as_printed(
    rig: Rig, name: str, title: str, axis: str, start: float, target: float, gap: float, **options: Any
) -> Experiment:
    run = step(rig, axis, start, target, gap, **options)
    r, about = run.response, "in the paper's configuration"
    figures = {"overshoot": r.overshoot, "t_s, s": r.t_s, "t_enc, s": r.t_enc}
    checks = (_largest_current(run.trajectory),)
    return Experiment(name, title, about, run.trajectory, (axis,), {axis: run.reference}, figures, checks)


def _tracking(rig: Rig, name: str, title: str, four: bool) -> Experiment:
    trajectory, references = tracking(rig, four)
    errors, y = mean_errors(trajectory, references), trajectory["y"]
    checks = [Check(f"mean |e_{n}|", errors[n], limit, unit(n), "10 to 60 s") for n, limit in TRACKED.items() if four]
    beyond = float(max(control.GAP[0] - y.min(), y.max() - control.GAP[1]))
    checks += [Check("y leaves 18 .. 31 mm by", beyond, 0.0, "m"), _largest_current(trajectory)]
    gaps = np.array([trajectory[f"g{j}"] for j in range(1, 5)])
    figures = {f"mean |e_{n}|, u{unit(n)}": e * 1e6 for n, e in errors.items()}
    figures |= {"least motor gap, mm": gaps.min() * 1e3, "greatest motor gap, mm": gaps.max() * 1e3}
    shown = ("y", "x", "z", "theta") if four else ("y", "x", "z")
    courses = {n: references[f"{n}_ref"] for n in shown}
    about, figures = "60 s from rest, encoders of 10 um", figures | _overload(trajectory)
    return Experiment(name, title, about, trajectory, shown, courses, figures, tuple(checks))


@cache
def unwound(scalar: str) -> host.Controller:
    """Return the controller without its anti-windup, compiled in a scalar type by name."""
    kind, plant = np.dtype(scalar).type, maglev_stage.plant()
    return build.compiled(control.controller(plant, wound=False).block, kind, error=control.SURROGATE_ERROR[kind])


def _windup(rig: Rig, name: str, title: str) -> Experiment:
    """Step x by 100 mm at a gap of 30 mm with the anti-windup (17), or without it."""
    without = replace(rig, controller=unwound(np.dtype(rig.controller.scalar).name))
    runs = {n: step(used, "x", -0.05, 0.05, gap=0.030) for n, used in (("with", rig), ("without", without))}
    run = runs[name.removeprefix("windup_")]
    checks = [_largest_current(run.trajectory)]
    if run is runs["with"]:
        ratio = run.response.overshoot / runs["without"].response.overshoot
        checks.append(
            Check("overshoot with over overshoot without", ratio, 0.9, "1", "the anti-windup must matter here")
        )
    about = "the stops along x are taken away, so that the overshoot shows"
    figures = {"overshoot": run.response.overshoot, "t_s, s": run.response.t_s}
    return Experiment(name, title, about, run.trajectory, ("x",), {"x": run.reference}, figures, tuple(checks))


def _lift_off(rig: Rig, name: str, title: str) -> Experiment:
    """Lift from the 31 mm stop to 25 mm by a ramp of 1 s."""
    time = sample_times(6.0, control.TIME.period_s)
    reference = 0.031 - 0.006 * np.clip(time - SETTLE, 0.0, 1.0)
    trajectory = rig.run(6.0, {"y": 0.031}, {"y_ref": reference})
    checks = (
        Check("overshoot", float(0.025 - trajectory["y"].min()) / 0.006, 0.02, "1", "of the 6 mm"),
        Check("true error in the last second", float(np.max(np.abs(trajectory["y"][-1000:] - 0.025))), RESOLUTION, "m"),
        _largest_current(trajectory),
    )
    about = "caught from rest on the lower stop"
    return Experiment(name, title, about, trajectory, ("y",), {"y": reference}, {}, checks)


def _set_down(rig: Rig, name: str, title: str, gap: float) -> Experiment:
    """Lose an encoder at a gap in m."""
    time = sample_times(3.0, control.TIME.period_s)
    lost = Override(time >= SETTLE, np.full(len(time), np.nan))
    trajectory = rig.run(3.0, {"y": gap}, overrides={"y1": lost})
    latched = trajectory.faults[int(np.argmax(time >= SETTLE)) + control.BAD_SAMPLES - 1 :] >> 31
    checks = (
        Check("rises above the start by", float(gap - trajectory["y"].min()), 1e-4, "m", "no slam upwards"),
        Check("distance from the 31 mm stop at the end", float(0.031 - trajectory["y"][-1]), 1e-6, "m"),
        Check("samples without the latch after 5 bad ones", float(np.count_nonzero(latched == 0)), 0.0, "1"),
        _largest_current(trajectory),
    )
    figures = {"speed at the lower stop, m/s": float(trajectory["vy"].max())}
    return Experiment(name, title, f"y1 reads NaN from {SETTLE:.1f} s on", trajectory, ("y",), {}, figures, checks)


def _zero_current(rig: Rig, name: str, title: str) -> Experiment:
    zero = dict.fromkeys(WIRES, 0.0)
    trajectory = rig.run(0.5, actuators={}, forcing=zero)
    hit = metrics.first_exit(trajectory.time, trajectory["y"], control.GAP[0] + 1e-9, control.GAP[1])
    figures = {"time to the upper stop, s": hit, "speed there, m/s": trajectory.impacts["y"]}
    return Experiment(name, title, "the platen slams up", trajectory, ("y",), {}, figures)


def _all() -> Iterator[Run]:
    """Yield every experiment: those of the paper, then what a user must be sure of."""
    for a, b in ((22, 29), (29, 22), (20, 27), (27, 20)):
        ends: Any = {"axis": "y", "start": a / 1e3, "target": b / 1e3, "gap": a / 1e3, "limits": Y_LIMITS}
        yield Run(f"y_{a}_{b}", partial(_step, title=f"Air gap {a} to {b} mm (Fig. 4)", **ends))
    for axis in ("x", "z"):
        ends = {"axis": axis, "start": 0.0, "target": 0.03, "limits": XZ_LIMITS}
        yield Run(f"{axis}_30", partial(_step, title=f"{axis} by 30 mm", **ends))
    for angle in (0.005, 0.010):
        ends = {"axis": "theta", "start": 0.0, "target": angle, "limits": THETA_LIMITS}
        yield Run(f"theta_{angle * 1e3:g}", partial(_step, title=f"theta by {angle * 1e3:g} mrad (Fig. 5)", **ends))
    for factor in (0.8, 1 / 1.2, 1.2, 1 / 0.8):
        for angle in (0.005, 0.010):
            title = f"theta by {angle * 1e3:g} mrad, the true guide spring {factor:.2f} of the assumed one"
            make = partial(_wrong_spring, title=title, angle=angle, factor=factor)
            yield Run(f"theta_{angle * 1e3:g}_springs_{factor:.2f}", make)
    for factor in (0.7, 1.0, 1.3):
        title = f"phi by 0.5 mrad, the true guide spring {factor:g} of the assumed one"
        yield Run(f"phi_springs_{factor:g}", partial(_tilt, title=title, factor=factor))
    for a, b in ((22, 29), (29, 22)):
        ends = {"axis": "y", "start": a / 1e3, "target": b / 1e3, "gap": a / 1e3, "actuators": NO_ROTATION}
        title = f"Air gap {a} to {b} mm, v_phi = v_theta = 0 (Fig. 4)"
        yield Run(f"paper_y_{a}_{b}", partial(_as_printed, title=title, **ends))
    for angle in (0.005, 0.010):
        ends = {"axis": "theta", "start": 0.0, "target": angle, "gap": 0.025, "locked": ("x", "z")}
        title = f"theta by {angle * 1e3:g} mrad, x and z locked (Fig. 5)"
        yield Run(f"paper_theta_{angle * 1e3:g}", partial(_as_printed, title=title, **ends))
    yield Run("ellipse", partial(_tracking, title="3-DOF ellipse (Fig. 6)", four=False))
    yield Run("tracking", partial(_tracking, title="4-DOF tracking (Figs. 7, 8)", four=True))
    for which in ("with", "without"):
        yield Run(f"windup_{which}", partial(_windup, title=f"x from -50 to 50 mm at 30 mm gap, {which} anti-windup"))
    yield Run("lift_off", partial(_lift_off, title="Lift-off from the 31 mm stop, ramp of 1 s to 25 mm"))
    for gap in (0.0181, 0.020, 0.025, 0.030):
        title = f"Safe output from {gap * 1e3:g} mm after the loss of an encoder"
        yield Run(f"set_down_{gap * 1e3:g}", partial(_set_down, title=title, gap=gap))
    yield Run("zero_current", partial(_zero_current, title="Zero current from 25 mm, for comparison"))


ALL = tuple(_all())
