"""Arguments and result of a closed-loop simulation; `closed_loop` states the equations.

Connections are keyed by the receiving signal: `sensors[controller input] = plant output`, and
`actuators[plant input] = controller output` or `{controller output: weight, ...}`.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import chain
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from synth import arguments, show
from synth.errors import SignalError
from synth.simulate.sensors import Override, Sensor, Word
from synth.statespace import Array

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Columns = Mapping[str, NDArray[Any]]


@dataclass(frozen=True, eq=False)
class InputFault:
    """An actuator applies gain c + bias instead of the command c; both are (N,), the bias in the unit of the input."""

    gain: ArrayLike
    bias: ArrayLike


@dataclass(frozen=True, eq=False)
class Scenario:
    """A scenario: connections, initial state, set-points and disturbances; SI units throughout.

    Every controller input is in `sensors` or in `references` (a constant or one value for each sample). Every plant
    input is in `actuators`, in `forcing`, or in both; forcing is added to the command and is a constant, one value for
    each sample, or a function of the time in s, in the unit of the input. A state that is missing from `x0` is 0,
    a command that is missing from `hold` is 0 before the first sample, and a sensor that is missing from `encoders` is
    ideal. `noise` (N,) is added to the measured quantity before quantisation. `velocities` maps each position that
    `stops` (low, high) and `locked` may name to its velocity. `delay` is in samples.

    A sensor in `lags` delivers the reading of `lags` (N,) samples ago, and one in `words` has faulty bits.
    `input_faults` are faults of plant inputs that an actuator drives. The controller is not called in the samples where
    `missed` (N,) is true; its outputs stay.
    """

    duration_s: float
    x0: Mapping[str, float]
    sensors: Mapping[str, str]
    actuators: Mapping[str, str | Mapping[str, float]]
    references: Mapping[str, ArrayLike] = field(default_factory=dict)
    encoders: Mapping[str, Sensor] = field(default_factory=dict)
    noise: Mapping[str, ArrayLike] = field(default_factory=dict)
    overrides: Mapping[str, Override] = field(default_factory=dict)
    hold: Mapping[str, float] = field(default_factory=dict)
    forcing: Mapping[str, ArrayLike | Callable[[float], float]] = field(default_factory=dict)
    velocities: Mapping[str, str] = field(default_factory=dict)
    stops: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    lags: Mapping[str, ArrayLike] = field(default_factory=dict)
    words: Mapping[str, Word] = field(default_factory=dict)
    input_faults: Mapping[str, InputFault] = field(default_factory=dict)
    missed: NDArray[np.bool_] | None = None
    locked: Sequence[str] = ()
    delay: int = 1
    substeps: int = 4

    def __post_init__(self) -> None:
        if not (self.delay >= 0 and self.substeps >= 1):
            raise SignalError(
                f"delay is {self.delay} samples and substeps {self.substeps}: give at least 0 and at least 1"
            )


@show.result
class Trajectory:
    """One value for each sample t = kT, k = 0 .. N-1, in read-only columns (N,) by name.

    `states` and `outputs` are true values of the plant, before any encoder; `applied` are the plant inputs from t on;
    `measured` are the controller inputs, suitable for `controller.replay`; `commands` are the controller outputs,
    `driven` those of the Blocks of a drive, and `drive_faults` the fault words of each of these Blocks. `faults` are
    the fault words of the controller without the bits of a status, which `status` has. `impacts` is the largest speed
    of an impact on each stop. `units` has the unit of each column that is known.
    """

    time: Array
    states: Columns
    outputs: Columns
    applied: Columns
    measured: Columns
    commands: Columns
    faults: NDArray[np.uint32]
    impacts: dict[str, float]
    units: Mapping[str, str] = field(default_factory=dict)
    driven: Columns = field(default_factory=dict)
    drive_faults: Mapping[str, NDArray[np.uint32]] = field(default_factory=dict)
    status: NDArray[np.uint32] = field(default_factory=lambda: np.zeros(0, np.uint32))

    def sheet(self) -> show.Sheet:
        """Return the range of every column and the impacts."""
        groups = {"state": self.states, "output": self.outputs, "applied": self.applied}
        groups |= {"measured": self.measured, "command": self.commands, "driven": self.driven}
        rows = (
            (
                group,
                show.with_unit(name, self.units.get(name, "")),
                *(show.number(e) for e in (v.min(), v.max(), v[-1])),
            )
            for group, columns in groups.items()
            for name, v in columns.items()
        )
        faults = f"{np.count_nonzero(self.faults)} samples with a fault"
        stops = (f"impact on the stop of {q}: {show.number(v)}" for q, v in self.impacts.items() if v)
        title = f"Trajectory of {len(self.time)} samples up to {show.number(self.time[-1])} s"
        table = show.Table(("", "name", "least", "largest", "last"), tuple(rows))
        return show.Sheet(title, (faults, *stops), (table,))

    def plot(self, names: Sequence[str] = ()) -> "Figure":
        """Return a figure of columns over time, one panel each; without `names` the first 12 of the outputs.

        Raises SignalError for a name that the trajectory does not have, and for more than 12 names.
        """
        from synth.analyse import plots  # loads matplotlib

        chosen = arguments.as_name_list("columns", names) or tuple(self.outputs)[:12]
        return plots.over_time(self.time, {name: self[name] for name in chosen}, self.units)

    def __getitem__(self, name: str) -> NDArray[Any]:
        """Return the column `name` from the first of states, outputs, applied, measured, commands, driven with it.

        Raises SignalError when none of them has it.
        """
        groups = (self.states, self.outputs, self.applied, self.measured, self.commands, self.driven)
        for columns in groups:
            if name in columns:
                return columns[name]
        raise SignalError(f"trajectory has no '{name}': choose one of {', '.join(dict.fromkeys(chain(*groups)))}")


def sample_times(duration_s: float, period_s: float) -> Array:
    """Return t = kT for k = 0 .. N-1 with N = round(duration/T), seconds; raise SignalError when N is below 1."""
    if not 0.5 < duration_s / period_s < np.inf:
        raise SignalError(f"duration is {duration_s} s: give at least one period of {period_s:g} s")
    return np.arange(round(duration_s / period_s), dtype=np.float64) * np.float64(period_s)
