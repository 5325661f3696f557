"""Conditions of an experiment: time profiles of set-points and disturbances, initial state and changed parameters."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from synth.declare.stage import Interface, SetPoint
from synth.errors import SignalError
from synth.plant import Plant
from synth.simulate.scenario import Array

Course = float | ArrayLike | Callable[[Array], ArrayLike]
"""A value over time: a constant, one for each sample, or a function of times in s."""


@dataclass(frozen=True)
class Sine:
    """offset + amplitude sin(frequency t + phase), in rad/s and rad."""

    amplitude: float
    frequency: float
    phase: float = 0.0
    offset: float = 0.0

    def __call__(self, time: Array) -> Array:
        """Return the values at times in s."""
        return np.asarray(self.offset + self.amplitude * np.sin(self.frequency * time + self.phase))


@dataclass(frozen=True)
class Ramp:
    """From `start` to `end` within `duration_s`, from `begin_s` on.

    Raises SignalError for a duration that is not positive.
    """

    start: float
    end: float
    begin_s: float
    duration_s: float

    def __post_init__(self) -> None:
        if not 0 < self.duration_s < np.inf:
            raise SignalError(f"a ramp lasts {self.duration_s} s: give a positive duration")

    def __call__(self, time: Array) -> Array:
        """Return the values at times in s."""
        return np.asarray(self.start + (self.end - self.start) * np.clip((time - self.begin_s) / self.duration_s, 0, 1))


@dataclass(frozen=True, eq=False)
class Conditions:
    """Conditions of an experiment that differ from the declared stage.

    `start` gives plant states, others are 0; `disturbances` are time profiles of plant inputs that no actuator drives;
    `parameters` are plant parameters that differ from those of the controller design. `options` are further fields of
    `scenario.Scenario`.
    """

    start: Mapping[str, float] = field(default_factory=dict)
    disturbances: Mapping[str, Course] = field(default_factory=dict)
    parameters: Mapping[str, float] = field(default_factory=dict)
    options: Mapping[str, Any] = field(default_factory=dict)

    def text(self) -> str:
        """Return the conditions as text, each after a comma."""
        changed = [f"{name} = {value:g}" for name, value in {**self.parameters, **self.start}.items()]
        return "".join(f", {part}" for part in (*changed, *(f"{name} acts" for name in self.disturbances)))


def values(course: Course, time: Array) -> Array:
    """Return the values of a time profile at times (N,) in s; raise SignalError for a wrong number of values."""
    samples = np.asarray(course(time) if callable(course) else course, dtype=np.float64)
    if samples.shape not in ((), time.shape):
        raise SignalError(
            f"a course has values of shape {samples.shape}: give one, or one for each of {len(time)} samples"
        )
    return np.array(np.broadcast_to(samples, time.shape))


def forcing(plant: Plant, names: Sequence[str], disturbances: Mapping[str, Course], time: Array) -> dict[str, Any]:
    """Return the profile of each disturbance, 0 where none is given.

    Raises SignalError for one that leaves the range of its plant input at one of the times (N,), and as `values`.
    """
    inputs = {s.name: s for s in plant.inputs}
    for name, s in ((n, inputs[n]) for n in disturbances if n in inputs):
        course = values(disturbances[name], time)
        worst = _farthest(course, s.low, s.high)
        if worst < s.low or worst > s.high:
            raise SignalError(
                f"the disturbance '{name}' reaches {worst:g} {s.unit}; the range of the plant input is {s.low:g} .. "
                f"{s.high:g} {s.unit}: give a smaller one, or the input a wider range"
            )
    profiles = {n: c if callable(c) else values(c, time) for n, c in disturbances.items()}
    return dict.fromkeys(names, 0.0) | profiles


def set_point(interface: Interface, name: str) -> SetPoint:
    """Return the set-point called `name`; raise SignalError for another name."""
    points = {s.name: s for s in interface.set_points}
    if name not in points:
        raise SignalError(f"the stage has no set-point '{name}': name one of {', '.join(points) or 'none'}")
    return points[name]


def require_in_range(name: str, course: Array, point: SetPoint, unit: str) -> None:
    """Raise SignalError for a course of a set-point that leaves its range, where the guard would refuse it."""
    worst = _farthest(course, point.low, point.high)
    if not point.low <= worst <= point.high:
        raise SignalError(
            f"the course of set-point '{name}' reaches {worst:g} {unit}; its range is {point.low:g} .. {point.high:g} "
            f"{unit}: give a smaller step or motion, or the set-point a wider range"
        )


def _farthest(course: Array, low: float, high: float) -> float:
    """Return the value that is farthest beyond a range, or nearest to its ends."""
    return float(course[np.argmax(np.maximum(course - high, low - course))])


def require_response(name: str, overshoot: float, **positive: float) -> None:
    """Raise SignalError for an overshoot above 1, and for one of the other numbers that is not positive."""
    if not (0 <= overshoot <= 1 and all(0 < value < np.inf for value in positive.values())):
        numbers = ", ".join(f"{key} {value:g}" for key, value in {**positive, "overshoot": overshoot}.items())
        raise SignalError(f"{name}: {numbers}: give an overshoot of at most 1, 0.15 for 15 %, and the others above 0")


def require_end(name: str, after_s: float, duration_s: float) -> None:
    """Raise SignalError for an experiment that ends before what it assesses begins."""
    if not after_s < duration_s:
        raise SignalError(
            f"{name}: assessed after {after_s:g} s, but it ends after {duration_s:g} s: give a smaller after_s"
        )


def require_positive_errors(name: str, limits: Mapping[str, float]) -> None:
    """Raise SignalError for a limit of |y - r| of an experiment that is not positive."""
    for set_point, limit in limits.items():
        if not limit > 0:
            raise SignalError(
                f"{name}: the limit of |y - r| at '{set_point}' is {limit:g}: give a positive one; the set-point "
                "itself stays at the initial position, which Conditions(start=...) names"
            )
