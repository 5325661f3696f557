"""Time profiles of set-points and disturbances over the samples of a run, and the refusals of what cannot be run.

Forcing of a simulated loop: disturbances and fixed commands at the inputs of the plant, held over each substep.
"""

from collections.abc import Collection, Mapping, Sequence
from typing import Any

import numpy as np

from synth.declare.effects import Course
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
    _require_known("set-point", points, name)
    return points[name]


def _require_known(role: str, known: Collection[str], name: str) -> None:
    if name not in known:
        raise SignalError(f"the stage has no {role} '{name}': name one of {', '.join(known) or 'none'}")


def profiles(interface: Interface, courses: Mapping[str, Course], time: Array) -> dict[str, Array]:
    """Return the values of set-points at times (N,).

    Raises SignalError for another name, for a set-point that leaves its range, where the guard would refuse it, and as
    `values`.
    """
    return _in_range("set-point", [s.name for s in interface.set_points], interface, courses, time)


def auxiliaries(interface: Interface, courses: Mapping[str, Course], time: Array) -> dict[str, Array]:
    """Return the values of auxiliary inputs at times (N,); raise SignalError as `profiles`."""
    return _in_range("auxiliary input", [s.name for s in interface.auxiliaries], interface, courses, time)


def _in_range(
    role: str, known: Collection[str], interface: Interface, courses: Mapping[str, Course], time: Array
) -> dict[str, Array]:
    made = {}
    for name, course in courses.items():
        _require_known(role, known, name)
        s, made[name] = interface.signals[name], values(course, time)
        worst = _farthest(made[name], s.low, s.high)
        if not s.low <= worst <= s.high:
            raise SignalError(
                f"the course of {role} '{name}' reaches {worst:g} {s.unit}; its range is {s.low:g} .. {s.high:g} "
                f"{s.unit}: give a smaller step or motion, or the {role} a wider range"
            )
    return made


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
