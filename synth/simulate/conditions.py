"""Time profiles of set-points and disturbances over the samples of a run, and the refusals of what cannot be run.

Forcing of a simulated loop: disturbances and fixed commands at the inputs of the plant, held over each substep.
"""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from synth.declare.experiments import Course
from synth.declare.stage import Interface, SetPoint
from synth.errors import SignalError
from synth.plant import Plant
from synth.signals import Signal
from synth.simulate.scenario import Array, Scenario


def columns(inputs: Mapping[str, Signal], scenario: Scenario, time: Array) -> Array:
    """Return the forcing of each input in each substep, (samples, substeps, inputs), in the units of the inputs.

    Forcing by constants has one row for all samples.
    """
    n, m = len(time), scenario.substeps
    varies = any(callable(course) or np.ndim(course) for course in scenario.forcing.values())
    period = scenario.duration_s / n if n == 1 else time[1]
    moments = time if varies else time[:1]
    middles = moments[:, None] + period * (np.arange(m) + 0.5) / m
    forcing = np.zeros((*middles.shape, len(inputs)))
    for j, (name, signal) in enumerate(inputs.items()):
        course = scenario.forcing.get(name, 0.0)
        try:
            values = np.vectorize(course, otypes=[float])(middles) if callable(course) else np.asarray(course, float)
        except (TypeError, ValueError) as error:
            raise SignalError(
                f"forcing of '{name}' is not a number at some time ({error}): {_remedy(n, signal)}"
            ) from error
        if not callable(course) and values.shape not in ((), (n,)):
            raise SignalError(f"forcing of '{name}' is an array {values.shape}: {_remedy(n, signal)}")
        if not np.isfinite(values).all():
            raise SignalError(f"forcing of '{name}' is not finite: {_remedy(n, signal)}")
        forcing[:, :, j] = values[:, None] if values.shape == (n,) else values
    return forcing


def _remedy(n: int, signal: Signal) -> str:
    return f"give a finite number in {signal.unit}, {n} of them, one a sample, or a function of the time in s"


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


def profiles(interface: Interface, courses: Mapping[str, Course], time: Array) -> dict[str, Array]:
    """Return the values of set-points at times (N,).

    Raises SignalError for another name, for a set-point that leaves its range, where the guard would refuse it, and as
    `values`.
    """
    known = {}
    for name, course in courses.items():
        point, unit = set_point(interface, name), interface.signals[name].unit
        known[name] = values(course, time)
        worst = _farthest(known[name], point.low, point.high)
        if not point.low <= worst <= point.high:
            raise SignalError(
                f"the course of set-point '{name}' reaches {worst:g} {unit}; its range is {point.low:g} .. "
                f"{point.high:g} {unit}: give a smaller step or motion, or the set-point a wider range"
            )
    return known


def _farthest(course: Array, low: float, high: float) -> float:
    """Return the value that is farthest beyond a range, or nearest to its ends."""
    return float(course[np.argmax(np.maximum(course - high, low - course))])


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
