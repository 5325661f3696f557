"""Arguments and result of a closed-loop simulation; `closed_loop` states the equations.

Connections are keyed by the receiving signal: `sensors[controller input] = plant output`, and
`actuators[plant input] = controller output` or `{controller output: weight, ...}`.

Sensor models: the reading m of the controller for the plant output y.

    seen      s = (1 + gain_error) y + offset + noise          of every sensor
    Encoder   m = r round(s / r), halves to even, so |m - s| <= r/2 for the resolution r;  m = s for r = 0
              with a span w it starts over: m - w floor((m - low) / w), from low to low + w
    Analogue  as an encoder with r = (high - low) / 2^bits, limited to low .. high
    word      the count of a reading with some bits set or inverted, see `Word`
    override  m_k = v_k at every sample k of the mask, independent of y

Offsets, resolutions, noise and values are in the unit of y; a gain error is a fraction.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import chain
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from synth import arguments, show
from synth.errors import SignalError
from synth.statespace import Array

Chain = tuple[float, float, float, float, float, float]  # gain, offset, resolution, low, high, span


@dataclass(frozen=True)
class Encoder:
    """An encoder of `resolution`, in the unit of the measured quantity; 0 makes it ideal.

    With a `span` above 0 its reading starts over at `low` after each span.
    """

    resolution: float = 0.0
    offset: float = 0.0
    gain_error: float = 0.0
    span: float = 0.0
    low: float = -math.inf

    def __post_init__(self) -> None:
        if self.span and not (0 < self.span < math.inf and math.isfinite(self.low)):
            raise SignalError(f"encoder span is {self.span} from {self.low}: give finite numbers, the span above 0")
        if not (math.isfinite(self.resolution) and self.resolution >= 0):
            raise SignalError(f"encoder resolution is {self.resolution}: give a finite number, 0 for an ideal sensor")
        _check_errors("encoder", self.offset, self.gain_error)

    @property
    def chain(self) -> Chain:
        """Gain, offset, resolution, limits and span."""
        return 1 + self.gain_error, self.offset, self.resolution, self.low, math.inf, self.span

    def read(self, y: ArrayLike) -> NDArray[np.float64]:
        """Return the reading of the encoder at y, any shape, in the unit of y."""
        return _read(self.chain, y)

    def noise_of(self, n: int, stream: int) -> NDArray[np.float64]:
        """Return no noise, (n,)."""
        return np.zeros(n)


@dataclass(frozen=True)
class Analogue:
    """An analogue sensor with a converter of `bits` that saturates at low and high, in the unit of y.

    `noise` is the rms of white Gaussian noise, repeatable for the same `seed`; each sensor of a loop has a stream.
    """

    low: float
    high: float
    bits: int = 16
    noise: float = 0.0
    offset: float = 0.0
    gain_error: float = 0.0
    seed: int = 0

    def __post_init__(self) -> None:
        if not (math.isfinite(self.high - self.low) and self.low < self.high):
            raise SignalError(f"analogue sensor spans {self.low} .. {self.high}: give finite ends, low below high")
        if not (isinstance(self.seed, int | np.integer) and self.seed >= 0):
            raise SignalError(f"analogue sensor has the seed {self.seed}: give a whole number from 0 on")
        if not (1 <= self.bits <= 53 and self.bits == int(self.bits)):
            raise SignalError(f"analogue sensor has {self.bits} bits: give a whole number from 1 to 53")
        if not (math.isfinite(self.noise) and self.noise >= 0):
            raise SignalError(f"analogue sensor has the noise {self.noise} rms: give a finite number, 0 for none")
        _check_errors("analogue sensor", self.offset, self.gain_error)

    @property
    def resolution(self) -> float:
        """One count, in the unit of y."""
        return (self.high - self.low) / 2**self.bits

    @property
    def chain(self) -> Chain:
        """Gain, offset, resolution, limits and span."""
        return 1 + self.gain_error, self.offset, self.resolution, self.low, self.high, 0.0

    def read(self, y: ArrayLike) -> NDArray[np.float64]:
        """Return the reading of the converter at y without noise, any shape, in the unit of y."""
        return _read(self.chain, y)

    def noise_of(self, n: int, stream: int) -> NDArray[np.float64]:
        """Return n samples of noise of the sensor with number `stream`, (n,), in the unit of y."""
        return self.noise * np.random.default_rng([self.seed, stream]).standard_normal(n)


Sensor = Encoder | Analogue


def _check_errors(what: str, offset: float, gain_error: float) -> None:
    if not (math.isfinite(offset) and math.isfinite(gain_error)):
        raise SignalError(f"{what} has the offset {offset} and the gain error {gain_error}: give finite numbers")


def _read(chain: Chain, y: ArrayLike) -> NDArray[np.float64]:
    gain, offset, resolution, low, high, span = chain
    seen = gain * np.asarray(y, dtype=np.float64) + offset
    counted = resolution * np.rint(seen / resolution) if resolution else seen
    return np.clip(counted - span * np.floor((counted - low) / span) if span else counted, low, high)


@dataclass(frozen=True, eq=False)
class Override:
    """Samples that replace the sensor reading: `values` (N,) where `mask` (N,) is true.

    Values in the scalar type of the controller keep their bit pattern.
    """

    mask: NDArray[np.bool_]
    values: ArrayLike


@dataclass(frozen=True, eq=False)
class Word:
    """A faulty word of a sensor: of its count w = round((m - low) / step) some bits are inverted, then some fixed.

    `low` and `step` are in the unit of the reading m; `flipped`, `set_bits` and `cleared` (N,) are masks of bits.
    """

    low: float
    step: float
    flipped: ArrayLike = 0
    set_bits: ArrayLike = 0
    cleared: ArrayLike = 0


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
    a command that is missing from `hold` is 0 before the first sample, `state` are states of the controller that differ
    from those after `init`, and a sensor that is missing from `encoders` is
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
    state: Mapping[str, float] = field(default_factory=dict)
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
    the fault words of the controller without the bits of a status, which `status` has. `initial` are states of the
    controller before the first sample that differ from those after `init`. `impacts` is the largest speed
    of an impact on each stop. `units` has the unit of each column that is known. `begun` says where the run of an
    experiment starts.
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
    initial: Mapping[str, float] = field(default_factory=dict)
    begun: str = ""

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
        table = show.Table("", ("", "name", "least", "largest", "last"), tuple(rows))
        starts = (f"starts {self.begun}",) if self.begun else ()
        return show.Sheet(title, (*starts, faults, *stops), (table,))

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
