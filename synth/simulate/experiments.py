"""Closed-loop experiments of a stage: the runs of `declare.experiments`, and the checks that follow from each.

Positions are the true positions of the plant, not sensor readings. Each experiment also checks that no fault bit was
set, and reports the largest actuator commands. `run` runs experiments on a rig.

Headroom of the states of a controller: the largest ratio of each state to its bound in a run.

    r = max over k of |x_k - m| / h,    m and h the centre and half width of the declared range of the state

A state at its bound is saturated: it no longer has the value that the control law computes. A comparison of
implementations cannot detect this, because all of them saturate in the same way. Recorded inputs are therefore replayed
through the C in double precision, and r < 1 must hold for every state of the control laws, except for those that are
limited on purpose. States of the input guard, stored outputs and integers are ignored.

Result of an experiment: a simulated run, the signals to plot, measured values and checks.
"""

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import field, replace
from types import MappingProxyType
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from synth import check, show
from synth.base.progress import each
from synth.check import Check, Incomplete, of_error
from synth.declare.experiments import (
    Conditions,
    Hold,
    LiftOff,
    Ramp,
    SensorFaults,
    StepResponse,
    Track,
    Withstand,
)
from synth.errors import DesignError, SignalError
from synth.execute import host, trace
from synth.signals import Signal
from synth.simulate import conditions, effects, metrics
from synth.simulate.faults import campaign, sensor_faults
from synth.simulate.rig import Rig
from synth.simulate.scenario import Array, Trajectory, sample_times


@show.result
class Experiment:
    """One run. `shown` names the columns of the trajectory to plot, `references` their set-points (N,).

    `figures` are measured values without limits, in the unit at the end of each name; `checks` have limits.
    """

    name: str
    title: str
    about: str
    trajectory: Trajectory
    shown: tuple[str, ...]
    references: Mapping[str, NDArray[np.float64]] = field(default_factory=dict)
    figures: Mapping[str, float] = field(default_factory=dict)
    checks: tuple[Check, ...] = ()

    def sheet(self) -> show.Sheet:
        """Return the measured values and the checks."""
        figures = show.Table(
            "", ("measured", "value"), tuple((name, show.number(v)) for name, v in self.figures.items())
        )
        run = self.trajectory.sheet()
        tables = tuple(t for t in (figures, check.table(self.checks)) if t.rows)
        return show.Sheet(f"Experiment {self.name}: {self.title}", (run.title,), tables)


LARGEST = 1 - 1e-6
NAME = "largest |state| / bound"
_GUARD_PREFIXES = ("guard_", "safe_output_")
_REAL = ("float", "double")


def ratios(
    controller: host.Controller, inputs: Mapping[str, ArrayLike], initial: Mapping[str, float] = MappingProxyType({})
) -> dict[str, float]:
    """Return r of each state of the control laws, under input columns (N,) from `init` with `initial` states.

    Raises SignalError as `trace.states`.
    """
    states = trace.states(controller, inputs, initial)
    fields = controller.manifest["structs"]["state"]["fields"]
    laws = [f for f in fields if f["ctype"] in _REAL and not f["name"].startswith(_GUARD_PREFIXES)]
    return {f["name"]: _ratio(states[f["name"]].astype(np.float64), f["low"], f["high"]) for f in laws}


def _ratio(values: np.ndarray, low: float, high: float) -> float:
    middle, half = (low + high) / 2, (high - low) / 2
    return float(np.max(np.abs(values - middle)) / half)


def with_headroom(
    experiment: Experiment,
    controller: host.Controller,
    limited: Collection[str] = (),
    constants: Mapping[str, float] | None = None,
) -> Experiment:
    """Return an experiment with its largest r as a measured value, and a check that no state reached its bound.

    `limited` names states that may reach it; `controller` is the C in double precision. `constants` are its inputs that
    the controller of the experiment may not read.
    """
    run = experiment.trajectory
    peaks = ratios(controller, {**(constants or {}), **run.measured}, run.initial)
    if not peaks:
        return experiment
    free = {name: r for name, r in peaks.items() if name not in limited}
    largest = max(peaks, key=lambda name: peaks[name])
    figures = {**experiment.figures, f"{NAME} ({largest})": peaks[largest]}
    if not free:
        return replace(experiment, figures=figures)
    worst = max(free, key=lambda name: free[name])
    about = f"{worst}: at its bound a state is not what the law computes; widen the bound, or declare it `limited`"
    return replace(
        experiment, figures=figures, checks=(*experiment.checks, Check(NAME, free[worst], LARGEST, "1", about))
    )


BAND = 0.02  # of a step: the usual 2 % of the settling time
LEAST_TRAVEL = 0.5  # of a step, to its final value
LEAST_SHARE, MOST_SHARE, SHARE_RESOLUTION = 1 / 64, 16.0, 0.05  # of the effects of an experiment
AT_REST, SWITCHED_ON = "at the loop's equilibrium", "switched on"
END = 0.1  # of a run: its last part, in which the final error is measured


def _step_response(step: StepResponse, rig: Rig) -> Experiment:
    """Run for a settling time before the step and four after it."""
    position, unit = _position(rig, step.set_point)
    start = _first_set_point(rig, step.set_point, step.conditions)
    target, limit = start + step.height, step.settling_time_s
    time = sample_times(5 * limit, rig.period_s)
    course = np.where(time < limit, start, target)
    trajectory = _trajectory(rig, 5 * limit, {step.set_point: course}, step.conditions)
    k = int(np.argmax(time >= limit))
    y, band = trajectory[position], max(BAND * abs(step.height), _resolution(rig, position))
    final = float(np.mean(y[_last(trajectory)]))
    targets = {"to the set-point": (start, target), "to the final value": (float(y[k]), final)}
    measured = {
        to: (_overshoot(y[k:], *ends), metrics.settling_time(time[k:], y[k:] - ends[1], band))
        for to, ends in targets.items()
    }
    if step.to_final and (final - y[k]) / step.height < LEAST_TRAVEL:
        measured["to the final value"] = (np.nan, np.inf)  # a position that rests would be no response
    limited, other = reversed(measured) if step.to_final else measured
    (overshoot, settling_time), (beside, late) = measured[limited], measured[other]
    checks = [
        Check("overshoot", overshoot, step.overshoot, "1", f"of the step of {position}, {limited}"),
        Check("settling time", settling_time, limit, "s", f"{position} stays within {band:.3g} {unit}, {limited}"),
    ]
    if step.error is not None:
        checks.append(_final_error_check(trajectory, position, target, step.error, unit))
    title = f"{position} steps by {step.height:g} {unit}{step.conditions.text()}"
    figures = {"rise time, s": metrics.rise_time(time[k:], y[k:], start, target)}
    figures |= {f"overshoot {other}, 1": beside, f"settling time {other}, s": late}
    return _experiment(rig, step.name, title, trajectory, {position: course}, figures, checks)


def _track(track: Track, rig: Rig) -> Experiment:
    """Run from rest at the start of the profiles."""
    conditions.require_end(track.name, track.after_s, track.duration_s)
    time = sample_times(track.duration_s, rig.period_s)
    courses = {name: conditions.values(course, time) for name, course in track.set_points.items()}
    positions = {name: _position(rig, name) for name in courses}
    start = {positions[name][0]: float(course[0]) for name, course in courses.items()}
    under = replace(track.conditions, start=start | dict(track.conditions.start))
    trajectory = _trajectory(rig, track.duration_s, courses, under)
    limits = track.mean_error if isinstance(track.mean_error, Mapping) else dict.fromkeys(courses, track.mean_error)
    if unknown := [name for name in limits if name not in courses]:
        raise DesignError(f"{track.name}: a limit is for '{unknown[0]}', but what moves is {', '.join(courses)}")
    checks, figures = [], {}
    for name, course in courses.items():
        position, unit = positions[name]
        mean = metrics.mean_absolute(time, trajectory[position] - course, track.after_s)
        if name in limits:
            checks.append(Check(f"mean |e_{position}|", mean, limits[name], unit, f"from {track.after_s:g} s on"))
        else:
            figures[f"mean |e_{position}| from {track.after_s:g} s on, {unit}"] = mean
    title = f"Tracking of {', '.join(p for p, _ in positions.values())}{track.conditions.text()}"
    shown = {positions[name][0]: course for name, course in courses.items()}
    return _experiment(rig, track.name, title, trajectory, shown, figures, checks)


def _hold(hold: Hold, rig: Rig) -> Experiment:
    """Run from rest at the initial positions; raise SignalError for a limit that is not positive."""
    conditions.require_positive_errors(hold.name, hold.errors)
    conditions.require_end(hold.name, hold.after_s, hold.duration_s)
    trajectory = _trajectory(rig, hold.duration_s, {}, hold.conditions)
    late = trajectory.time >= hold.after_s
    checks, courses, figures = [], {}, {}
    for name, limit in hold.errors.items():
        position, unit = _position(rig, name)
        r = _first_set_point(rig, name, hold.conditions)
        courses[position] = np.full(len(trajectory.time), r)
        error = trajectory[position] - r
        figures[f"largest |e_{position}| from the start, {unit}"] = float(np.abs(error).max())
        checks.append(Check(f"largest |e_{position}|", _peak(error[late]), limit, unit, f"from {hold.after_s:g} s on"))
    title = f"{', '.join(courses)} held{hold.conditions.text()}"
    return _experiment(rig, hold.name, title, trajectory, courses, figures, checks)


def _lift_off(lift_off: LiftOff, rig: Rig) -> Experiment:
    """Run with a ramp that starts after `ramp_s` / 4, for `duration_s` or else 4 `ramp_s`."""
    duration = 4 * lift_off.ramp_s if lift_off.duration_s is None else lift_off.duration_s
    time = sample_times(duration, rig.period_s)
    checks, shown, courses = [], {}, {}
    for name, end in lift_off.to.items():
        ramp = Ramp(_first_set_point(rig, name, lift_off.conditions), end, lift_off.ramp_s / 4, lift_off.ramp_s)
        courses[name] = ramp(time)
    trajectory = _trajectory(rig, duration, courses, lift_off.conditions, settled=False)
    for name, end in lift_off.to.items():
        position, unit = _position(rig, name)
        shown[position], begin = courses[name], float(trajectory[position][0])
        if begin != end:
            overshoot = metrics.overshoot(trajectory[position], begin, end)
            checks.append(Check(f"overshoot of {position}", overshoot, lift_off.overshoot, "1", "of the travel"))
        checks.append(_final_error_check(trajectory, position, end, lift_off.error, unit))
    return _experiment(rig, lift_off.name, f"Start{lift_off.conditions.text()}", trajectory, shown, {}, checks)


def _withstand(declared: Withstand, rig: Rig) -> Experiment:
    """Run the motion from rest at its start, with a stop for every position."""
    rig, time = campaign.with_stops(rig), sample_times(declared.duration_s, rig.period_s)
    courses = conditions.profiles(rig.stage.interface, declared.set_points, time) or campaign.motion(rig, time)
    under = replace(declared.conditions, start=campaign.start_of(rig, courses) | dict(declared.conditions.start))
    trajectory = _trajectory(rig, declared.duration_s, courses, under, settled=False)
    shown = {rig.positions[name]: course for name, course in courses.items()}
    units, rates = trajectory.units, rig.stage.velocities
    figures = {f"largest |e_{q}|, {units[q]}": float(np.abs(trajectory[q] - r).max()) for q, r in shown.items()}
    checks = [
        Check(f"impact on the stop of {q}", speed, declared.impacts.get(q, 0.0), units[rates[q]])
        for q, speed in trajectory.impacts.items()
    ]
    title = f"In motion for {declared.duration_s:g} s{under.text()}"
    return _experiment(rig, declared.name, title, trajectory, shown, figures, checks)


def largest_share(rig: Rig, experiment: Any) -> dict[str, float]:
    """Return the largest share of an experiment's effects that keeps its limits, by a name that says what ends it.

    It is bisected to SHARE_RESOLUTION of itself, from LEAST_SHARE (0 where that is too much) to MOST_SHARE: what fails
    at a share is taken to fail at all larger ones. The result is empty for an experiment without effects.
    """
    under = getattr(experiment, "conditions", Conditions())
    if not under.effects:
        return {}

    def first_failure(share: float) -> str:
        larger = replace(under, effects=[effect.scaled(share) for effect in under.effects])
        checks = result(replace(experiment, conditions=larger), rig).checks
        return next(
            (c.name for c in reversed(checks) if not c.passed), ""
        )  # fault bits, from which much follows, first

    low, high, first = 0.0, 1.0, first_failure(1.0)
    while not first and high < MOST_SHARE:
        low, high = high, 2 * high
        first = first_failure(high)
    while first and high - low > SHARE_RESOLUTION * high and high > LEAST_SHARE:
        middle = (low + high) / 2
        reason = first_failure(middle)
        low, high, first = (low, middle, reason) if reason else (middle, high, first)
    ends = f"until {first}" if first else "within all limits"
    return {f"largest share of the effects {ends}, 1": low if first else high}


def _sensor_faults(faults: SensorFaults, rig: Rig) -> Experiment:
    """Run each fault in each motion; shown is the run with the largest excursion before the latch."""
    responses = sensor_faults.responses(faults, rig)
    worst, (sensor, *_) = sensor_faults.worst(responses), faults.words
    title = faults.title or f"{sensor}s fail, {faults.kind}"
    alone = f"each of {len(faults.sensors)} {sensor}s by itself from {faults.at_s:g} s on"
    about = f"{alone}, {len(faults.motions)} motions; shown is {worst.sensor}"
    shown, figures = faults.shown or tuple(worst.deviations), sensor_faults.figures(faults, responses)
    checks = tuple(sensor_faults.checks(faults, responses))
    return Experiment(faults.name, title, about, worst.run, shown, {}, figures, checks)


_RUNS: Mapping[type, Callable[[Any, Rig], Experiment]] = {
    StepResponse: _step_response,
    Track: _track,
    Hold: _hold,
    LiftOff: _lift_off,
    SensorFaults: _sensor_faults,
    Withstand: _withstand,
}


def result(experiment: Any, rig: Rig) -> Experiment:
    """Run an experiment on a rig: one of `declare.experiments`, or one that has `run(rig)` itself."""
    run_declared = _RUNS.get(type(experiment))
    return run_declared(experiment, rig) if run_declared else experiment.run(rig)


def run(rig: Rig, experiments: Sequence[Any], progress: Callable[[str], None]) -> list[Experiment]:
    """Run experiments on a rig, each with the largest share of its effects; `progress` receives its name before.

    Raises SignalError for a name that is listed twice, and Incomplete with the runs of the others where some raise.
    """
    names = [experiment.name for experiment in experiments]
    if twice := [name for k, name in enumerate(names) if name in names[:k]]:
        raise SignalError(f"two experiments are called '{twice[0]}': give one of them a label")
    runs, failed = [], []
    for experiment in each(experiments, progress, lambda e: e.name):
        try:
            finished = result(experiment, rig)
            runs.append(replace(finished, figures={**finished.figures, **largest_share(rig, experiment)}))
        except Exception as error:
            failed.append(of_error(f"experiment {experiment.name}", error))
    if failed:
        raise Incomplete(runs, failed)
    return runs


def _trajectory(
    rig: Rig, duration_s: float, courses: Mapping[str, Array], under: Conditions, settled: bool = True
) -> Trajectory:
    """Run from the loop's equilibrium; not `settled`, or where there is none to start at, switch the machine on.

    At rest an auxiliary input that moves from the first sample on, such as a feedforward, has its declared initial
    value, unless it tells a parameter. Any other has the first value of its course.
    `begun` of the trajectory says which, and where.
    """
    time, interface = sample_times(duration_s, rig.period_s), rig.stage.interface
    profiles = conditions.profiles(interface, courses, time)
    forcing = conditions.forcing(rig.plant, interface.disturbances, under.disturbances, time)
    case = rig.stage.cases[under.case] if under.case else {}
    inputs = {a.name: case[a.name] for a in interface.auxiliaries if a.name in case}
    parameters = {name: value for name, value in case.items() if name not in inputs} | dict(under.parameters)
    rig = replace(rig, plant=rig.plant.with_parameters(**parameters))
    announced = {
        a: rig.constant_inputs[a.name] for a in interface.auxiliaries if a.of and a.name in rig.constant_inputs
    }
    inputs = {a.name: value for a, value in announced.items()} | inputs
    auxiliaries = conditions.auxiliaries(interface, {**inputs, **under.auxiliaries}, time)
    options, begun = dict[str, Any](start=under.start), SWITCHED_ON
    if settled and (reason := rig.unrest(under.start)):
        begun = f"{SWITCHED_ON} {reason}"
    elif settled:
        known = parameters | {a.of: value for a, value in announced.items()}
        moving = {a.name for a in interface.auxiliaries if not a.of and a.name in auxiliaries}
        moving -= {n for n, v in auxiliaries.items() if len(v) < 2 or v[0] == v[1]}
        known |= {n: rig.constant_inputs.get(n, 0.0) if n in moving else float(v[0]) for n, v in auxiliaries.items()}
        options = rig.at_equilibrium(under.start, known)
        at_rest = AT_REST + rig.displacement(under.start, options["start"])
        begun = at_rest if "state" in options else f"{SWITCHED_ON} where the loop has no stable equilibrium"
    references = rig.set_points_at(under.start) | profiles | auxiliaries
    rig = effects.with_effects(rig, under.effects) if under.effects else rig
    run = rig.run(duration_s, references=references, **{**options, "forcing": forcing, **under.options})
    return replace(run, begun=begun)


def _set_point(rig: Rig, name: str) -> Any:
    return conditions.set_point(rig.stage.interface, name)


def _first_set_point(rig: Rig, name: str, under: Conditions) -> float:
    """Return the set-point at the start of a run, which lies in its range where the machine may rest on a stop."""
    return rig.set_points_at(under.start)[_set_point(rig, name).name]


def _position(rig: Rig, set_point: str) -> tuple[str, str]:
    """Return the state or output of the plant that a set-point controls, and its unit."""
    position = rig.positions[_set_point(rig, set_point).name]
    known: dict[str, Signal] = {s.name: s for s in (*rig.plant.outputs, *rig.plant.states)}
    return position, known[position].unit


def _resolution(rig: Rig, position: str) -> float:
    return max((s.resolution for s in rig.stage.interface.sensors if position in (s.of, s.name)), default=0.0)


def _last(trajectory: Trajectory) -> NDArray[np.bool_]:
    """Return which samples are in the last part of a run."""
    return np.asarray(trajectory.time >= (1 - END) * trajectory.time[-1])


def _overshoot(y: Array, start: float, end: float) -> float:
    """Return the overshoot, NaN where the position has not moved or is not finite."""
    return metrics.overshoot(y, start, end) if np.isfinite(end) and end != start else np.nan


def _peak(error: Array) -> float:
    return float(np.abs(error).max()) if error.size else np.nan


def _final_error_check(trajectory: Trajectory, position: str, target: float, limit: float, unit: str) -> Check:
    about = f"in the last {100 * END:g} % of the run"
    return Check(
        f"|e_{position}| at the end", _peak(trajectory[position][_last(trajectory)] - target), limit, unit, about
    )


def _experiment(
    rig: Rig,
    name: str,
    title: str,
    trajectory: Trajectory,
    courses: Mapping[str, Array],
    figures: Mapping[str, float],
    checks: Sequence[Check],
) -> Experiment:
    """Return the experiment with the check for faults and the largest actuator commands."""
    faulty = Check("samples with a fault bit", float(np.count_nonzero(trajectory.faults)), 0.0, "1")
    interface = rig.stage.interface
    driven = [s for s in interface.outputs if s.name in trajectory.commands]
    used = {f"largest |{s.name}|, {s.unit}": float(np.abs(trajectory.commands[s.name]).max()) for s in driven}
    about = f"the full plant, sensors as declared, {interface.delay} sample{'s' * (interface.delay != 1)} of delay"
    measured, begun = dict(figures) | used, trajectory.begun
    about += f"; starts {begun}"
    title += f", starts {begun}" if begun not in (AT_REST, SWITCHED_ON) else ""
    return Experiment(name, title, about, trajectory, tuple(courses), dict(courses), measured, (*checks, faulty))
