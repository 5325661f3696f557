"""Experiments as data: what is run, and the requirements on the response.

    StepResponse  step of a set-point:        overshoot / step, settling time to a band of 2 % of the step or one count
                                              around the set-point, or around the final value
    Track         moving set-points:          mean |y - r| of the true positions, after the initial transient
    Hold          constant set-points:        max |y - r| under disturbances, after the initial transient
    LiftOff       start at another position:  set-points ramp from there; overshoot / travel, max |y - r| at the end
    Withstand     motion under effects:       no fault bit, no contact with a stop
    SensorFaults  each sensor fails alone:      samples to its name, to braking and to the latch; commands after it
    Run           what a function of the stage runs

Conditions of an experiment are its initial state, time profiles of disturbances and auxiliary inputs, and changed
parameters. A run starts at the loop's equilibrium at the initial state, with the controller's states and currents that
belong to it. Where this state is on a stop, in motion or outside the set-points' ranges, or the loop has no stable
equilibrium there, and in all but the first three, the controller is switched on there, with the actuators at their safe
values. The title says so of the first three, and where the equilibrium is not at the initial state, as under a law
without integral action. `synth.simulate.experiments` runs them.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from synth.declare.effects import Course, Effect, effect_text
from synth.errors import SignalError
from synth.statespace import Array


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

    `start` gives plant states, others are 0; `disturbances` are time profiles of plant inputs that no actuator drives,
    `auxiliaries` of auxiliary inputs; `parameters` are plant parameters that differ from those of the controller
    design. `case` is the name of one of the stage's, which give both. `effects` act that the model lacks. `options` are
    further fields of `scenario.Scenario`.
    """

    start: Mapping[str, float] = field(default_factory=dict)
    disturbances: Mapping[str, Course] = field(default_factory=dict)
    parameters: Mapping[str, float] = field(default_factory=dict)
    options: Mapping[str, Any] = field(default_factory=dict)
    auxiliaries: Mapping[str, Course] = field(default_factory=dict)
    case: str = ""
    effects: Sequence[Effect] = ()

    def text(self) -> str:
        """Return the conditions as text, each after a comma."""
        changed = [f"{name} = {value:g}" for name, value in {**self.parameters, **self.start}.items()]
        acting = [f"{name} acts" for name in (*self.disturbances, *self.auxiliaries)]
        acting += map(effect_text, self.effects)
        return "".join(f", {part}" for part in (*([self.case] if self.case else []), *changed, *acting))


@dataclass(frozen=True, eq=False)
class StepResponse:
    """The set-point steps by `height` in its unit once the loop has settled.

    `overshoot` is a fraction of the step, `settling_time_s` the limit of the settling time, `error` that of the final
    |y - r|, None for no check. `conditions` gives the conditions of the run, `label` replaces the name.

    Both limits are for the set-point, or with `to_final` for the value at which the position comes to rest: then an
    error of the gauge's zero is no overshoot, and `error` says how far from the set-point it may be. Both are measured;
    a position that moves by less than half of the step does not settle there.

    Raises SignalError for a step of 0, an overshoot above 1, a settling time that is not positive, and `to_final`
    without `error`.
    """

    set_point: str
    height: float
    overshoot: float
    settling_time_s: float
    error: float | None = None
    conditions: Conditions = field(default_factory=Conditions)
    label: str = ""
    to_final: bool = False

    def __post_init__(self) -> None:
        positive = {"settling_time_s": self.settling_time_s, "height": abs(self.height)}
        _require_response(self.name, self.overshoot, **positive)
        if self.to_final and self.error is None:
            raise SignalError(
                f"{self.name}: a response to its final value may end anywhere: give `error`, the largest |y - r| there"
            )

    @property
    def name(self) -> str:
        """The label, or the set-point and the step."""
        return self.label or f"step_{self.set_point}_{self.height:g}"


@dataclass(frozen=True, eq=False)
class Track:
    """Set-points follow profiles; mean |y - r| after `after_s` is at most `mean_error`, of all or {set-point: limit}.

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
        _require_response(self.name, self.overshoot, ramp_s=self.ramp_s, error=self.error)

    @property
    def name(self) -> str:
        """The label."""
        return self.label


@dataclass(frozen=True, eq=False)
class Withstand:
    """A motion under what `conditions` lay on the machine, such as effects: no fault bit, and no contact with a stop.

    The motion is that of the fault campaign where `set_points` give none; the run starts at rest at its start.
    `impacts` {position: speed} are the largest speeds at stops, 0 where there is none; positions without declared stops
    have them at the ends of the plant's domain.
    """

    label: str
    conditions: Conditions
    duration_s: float = 60.0
    set_points: Mapping[str, Course] = field(default_factory=dict)
    impacts: Mapping[str, float] = field(default_factory=dict)

    @property
    def name(self) -> str:
        """The label."""
        return self.label


@dataclass(frozen=True, eq=False)
class SensorFaults:
    """Each of `sensors` fails alone, from `at_s` to the end, in each of `motions`; no fault bit is set before.

    `kind` is a fault of a campaign's sensors, or "zero" (`simulate.faults.injections`). A motion gives profiles of
    set-points, at whose start the run starts at rest. The guard refuses the readings at once: the controller brakes or
    latches with the last of the interface's bad samples, and commands go to their safe values as declared.

    For a fault that it does not refuse, `contradicted(rig, run)` returns the samples (N,) of a `Trajectory` in which a
    law can know of it. From the first of them on the sensor is named, or it brakes or latches, within `isolation`
    samples, and the latch follows that by as many as for refused readings. At most `unnoticed` runs end without a
    latch. `words` stand for sensor, command and contradiction in names, `shown` are the columns of the plot.

    Raises SignalError without sensors or motions, and for a fault that does not begin within the run.
    """

    kind: str
    sensors: Sequence[str]
    at_s: float
    duration_s: float
    motions: Sequence[Mapping[str, Course]] = ({},)
    contradicted: Callable[[Any, Any], ArrayLike] | None = None
    isolation: int = 0
    unnoticed: float = 0.0
    words: tuple[str, str, str] = ("sensor", "command", "contradiction")
    shown: tuple[str, ...] = ()
    title: str = ""
    label: str = ""

    def __post_init__(self) -> None:
        if not (self.sensors and self.motions and 0 < self.at_s < self.duration_s):
            raise SignalError(
                f"{self.name}: {len(self.sensors)} sensors, {len(self.motions)} motions, a fault from {self.at_s:g} s "
                f"on in {self.duration_s:g} s: give at least one of each, and a fault that begins within the run"
            )

    @property
    def name(self) -> str:
        """The label, or the kind of the fault."""
        return self.label or f"sensors_{self.kind.replace(' ', '_')}"


@dataclass(frozen=True)
class Run:
    """An experiment that a stage defines by a function: its name, and `make(rig, name)`, which runs it."""

    name: str
    make: Callable[[Any, str], Any]

    def run(self, rig: Any) -> Any:
        """Run the experiment on a `Rig`; return an `Experiment`."""
        return self.make(rig, self.name)


def _require_response(name: str, overshoot: float, **positive: float) -> None:
    """Raise SignalError for an overshoot above 1, and for one of the other numbers that is not positive."""
    if not (0 <= overshoot <= 1 and all(0 < value < np.inf for value in positive.values())):
        numbers = ", ".join(f"{key} {value:g}" for key, value in {**positive, "overshoot": overshoot}.items())
        raise SignalError(f"{name}: {numbers}: give an overshoot of at most 1, 0.15 for 15 %, and the others above 0")
