"""Closed-loop experiments as data: requirements on the response of a stage, and the checks that follow.

    StepResponse  step of a set-point:        overshoot / step, settling time to a band of 2 % of the step or one count
    Track         moving set-points:          mean |y - r| of the true positions, after the initial transient
    Hold          constant set-points:        max |y - r| under disturbances, after the initial transient
    LiftOff       start at another position:  set-points ramp from there; overshoot / travel, max |y - r| at the end

Positions are the true positions of the plant, not sensor readings. Each experiment also checks that no fault bit was
set, and reports the largest actuator commands. `run` runs experiments on a rig.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, Protocol

import numpy as np

from synth.base.progress import each
from synth.check import Check, Incomplete, of_error
from synth.errors import SignalError
from synth.signals import Signal
from synth.simulate import conditions, metrics
from synth.simulate.conditions import Conditions, Course, Ramp
from synth.simulate.experiment import Experiment
from synth.simulate.rig import Rig
from synth.simulate.scenario import Array, Trajectory, sample_times

BAND = 0.02  # of a step: the usual 2 % of the settling time
END = 0.1  # of a run: its last part, in which the final error is measured


class Runnable(Protocol):
    """An experiment as data; further kinds that a stage defines have the same two members."""

    @property
    def name(self) -> str:
        """A short name, unique among the experiments of a stage."""
        ...

    def run(self, rig: Rig) -> Experiment:
        """Run the experiment."""
        ...


@dataclass(frozen=True)
class Run:
    """An experiment that a stage defines by a function: its name, and `make(rig, name)`, which runs it."""

    name: str
    make: Callable[[Rig, str], Experiment]

    def run(self, rig: Rig) -> Experiment:
        """Run the experiment."""
        return self.make(rig, self.name)


@dataclass(frozen=True, eq=False)
class StepResponse:
    """The set-point steps by `height` in its unit once the loop has settled.

    `overshoot` is a fraction of the step, `settling_time_s` the limit of the settling time, `error` that of the final
    |y - r|, None for no check. `conditions` gives the conditions of the run, `label` replaces the name.

    Raises SignalError for a step of 0, an overshoot above 1, and a settling time that is not positive.
    """

    set_point: str
    height: float
    overshoot: float
    settling_time_s: float
    error: float | None = None
    conditions: Conditions = field(default_factory=Conditions)
    label: str = ""

    def __post_init__(self) -> None:
        positive = {"settling_time_s": self.settling_time_s, "height": abs(self.height)}
        conditions.require_response(self.name, self.overshoot, **positive)

    @property
    def name(self) -> str:
        """The label, or the set-point and the step."""
        return self.label or f"step_{self.set_point}_{self.height:g}"

    def run(self, rig: Rig) -> Experiment:
        """Run for a settling time before the step and four after it."""
        position, unit = _position(rig, self.set_point)
        start = _first_set_point(rig, self.set_point, self.conditions)
        target, limit = start + self.height, self.settling_time_s
        time = sample_times(5 * limit, rig.period_s)
        course = np.where(time < limit, start, target)
        trajectory = _trajectory(rig, 5 * limit, {self.set_point: course}, self.conditions)
        k = int(np.argmax(time >= limit))
        y, band = trajectory[position], max(BAND * abs(self.height), _resolution(rig, position))
        settling_time = metrics.settling_time(time[k:], y[k:] - target, band)
        overshoot = metrics.overshoot(y[k:], start, target)
        checks = [
            Check("overshoot", overshoot, self.overshoot, "1", f"of the step of {position}"),
            Check("settling time", settling_time, limit, "s", f"{position} stays within {band:.3g} {unit}"),
        ]
        if self.error is not None:
            checks.append(_final_error_check(trajectory, position, target, self.error, unit))
        title = f"{position} steps by {self.height:g} {unit}{self.conditions.text()}"
        figures = {"rise time, s": metrics.rise_time(time[k:], y[k:], start, target)}
        return _experiment(rig, self.name, title, trajectory, {position: course}, figures, checks)


@dataclass(frozen=True, eq=False)
class Track:
    """Set-points follow profiles; the mean |y - r| after `after_s` is at most `mean_error`, one or {set-point: limit}.

    The run starts at rest at the start of the profiles.
    """

    set_points: Mapping[str, Course]
    mean_error: float | Mapping[str, float]
    duration_s: float = 2.0
    after_s: float = 1.0
    conditions: Conditions = field(default_factory=Conditions)
    label: str = ""

    @property
    def name(self) -> str:
        """The label, or the set-points."""
        return self.label or f"track_{'_'.join(self.set_points)}"

    def run(self, rig: Rig) -> Experiment:
        """Run from rest at the start of the profiles."""
        conditions.require_end(self.name, self.after_s, self.duration_s)
        time = sample_times(self.duration_s, rig.period_s)
        courses = {name: conditions.values(course, time) for name, course in self.set_points.items()}
        positions = {name: _position(rig, name) for name in courses}
        start = {positions[name][0]: float(course[0]) for name, course in courses.items()}
        under = replace(self.conditions, start=start | dict(self.conditions.start))
        trajectory = _trajectory(rig, self.duration_s, courses, under)
        checks = []
        for name, course in courses.items():
            position, unit = positions[name]
            limit = self.mean_error[name] if isinstance(self.mean_error, Mapping) else self.mean_error
            mean = metrics.mean_absolute(time, trajectory[position] - course, self.after_s)
            checks.append(Check(f"mean |e_{position}|", mean, limit, unit, f"from {self.after_s:g} s on"))
        title = f"Tracking of {', '.join(p for p, _ in positions.values())}{self.conditions.text()}"
        shown = {positions[name][0]: course for name, course in courses.items()}
        return _experiment(rig, self.name, title, trajectory, shown, {}, checks)


@dataclass(frozen=True, eq=False)
class Hold:
    """Set-points stay at the initial positions; |y - r| after `after_s` is at most `errors` {set-point: limit}."""

    errors: Mapping[str, float]
    duration_s: float = 1.0
    after_s: float = 0.5
    conditions: Conditions = field(default_factory=Conditions)
    label: str = ""

    @property
    def name(self) -> str:
        """The label, or the set-points."""
        return self.label or f"hold_{'_'.join(self.errors)}"

    def run(self, rig: Rig) -> Experiment:
        """Run from rest at the initial positions; raise SignalError for a limit that is not positive."""
        conditions.require_positive_errors(self.name, self.errors)
        conditions.require_end(self.name, self.after_s, self.duration_s)
        trajectory = _trajectory(rig, self.duration_s, {}, self.conditions)
        late = trajectory.time >= self.after_s
        checks, courses, figures = [], {}, {}
        for name, limit in self.errors.items():
            position, unit = _position(rig, name)
            r = _first_set_point(rig, name, self.conditions)
            courses[position] = np.full(len(trajectory.time), r)
            error = trajectory[position] - r
            figures[f"largest |e_{position}| from the start, {unit}"] = float(np.abs(error).max())
            checks.append(
                Check(f"largest |e_{position}|", _peak(error[late]), limit, unit, f"from {self.after_s:g} s on")
            )
        title = f"{', '.join(courses)} held{self.conditions.text()}"
        return _experiment(rig, self.name, title, trajectory, courses, figures, checks)


@dataclass(frozen=True, eq=False)
class LiftOff:
    """The run starts at rest at `conditions.start`, such as a stop; set-points ramp to the values `to` in `ramp_s`.

    `overshoot` is a fraction of the travel, `error` the limit of the final |y - r|.

    Raises SignalError for a ramp or an error that is not positive, and an overshoot above 1.
    """

    to: Mapping[str, float]
    ramp_s: float
    overshoot: float
    error: float
    conditions: Conditions
    duration_s: float | None = None
    label: str = "lift_off"

    def __post_init__(self) -> None:
        conditions.require_response(self.name, self.overshoot, ramp_s=self.ramp_s, error=self.error)

    @property
    def name(self) -> str:
        """The label."""
        return self.label

    def run(self, rig: Rig) -> Experiment:
        """Run with a ramp that starts after `ramp_s` / 4, for `duration_s` or else 4 `ramp_s`."""
        duration = 4 * self.ramp_s if self.duration_s is None else self.duration_s
        time = sample_times(duration, rig.period_s)
        checks, shown, courses = [], {}, {}
        for name, end in self.to.items():
            ramp = Ramp(_first_set_point(rig, name, self.conditions), end, self.ramp_s / 4, self.ramp_s)
            courses[name] = ramp(time)
        trajectory = _trajectory(rig, duration, courses, self.conditions)
        for name, end in self.to.items():
            position, unit = _position(rig, name)
            shown[position], begin = courses[name], float(trajectory[position][0])
            if begin != end:
                overshoot = metrics.overshoot(trajectory[position], begin, end)
                checks.append(Check(f"overshoot of {position}", overshoot, self.overshoot, "1", "of the travel"))
            checks.append(_final_error_check(trajectory, position, end, self.error, unit))
        return _experiment(rig, self.name, f"Start{self.conditions.text()}", trajectory, shown, {}, checks)


def run(rig: Rig, experiments: Sequence[Runnable], progress: Callable[[str], None]) -> list[Experiment]:
    """Run experiments on a rig; `progress` receives the name of each before it starts.

    Raises SignalError for a name that is listed twice, and Incomplete with the runs of the others where some raise.
    """
    names = [experiment.name for experiment in experiments]
    if twice := [name for k, name in enumerate(names) if name in names[:k]]:
        raise SignalError(f"two experiments are called '{twice[0]}': give one of them a label")
    runs, failed = [], []
    for experiment in each(experiments, progress, lambda e: e.name):
        try:
            runs.append(experiment.run(rig))
        except Exception as error:
            failed.append(of_error(f"experiment {experiment.name}", error))
    if failed:
        raise Incomplete(runs, failed)
    return runs


def _trajectory(rig: Rig, duration_s: float, courses: Mapping[str, Array], under: Conditions) -> Trajectory:
    time, interface = sample_times(duration_s, rig.period_s), rig.stage.interface
    for name, course in courses.items():
        conditions.require_in_range(name, course, _set_point(rig, name), interface.signals[name].unit)
    forcing = conditions.forcing(rig.plant, interface.disturbances, under.disturbances, time)
    plant = rig.plant.with_parameters(**under.parameters) if under.parameters else rig.plant
    return replace(rig, plant=plant).run(duration_s, under.start, courses, **{"forcing": forcing, **under.options})


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


def _peak(error: Array) -> float:
    return float(np.abs(error).max()) if error.size else np.nan


def _final_error_check(trajectory: Trajectory, position: str, target: float, limit: float, unit: str) -> Check:
    last = trajectory.time >= (1 - END) * trajectory.time[-1]
    about = f"in the last {100 * END:g} % of the run"
    return Check(f"|e_{position}| at the end", _peak(trajectory[position][last] - target), limit, unit, about)


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
    measured = dict(figures) | used
    return Experiment(name, title, about, trajectory, tuple(courses), dict(courses), measured, (*checks, faulty))
