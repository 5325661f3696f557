"""Step and impulse responses, exact at equally spaced times (`control.step_response`, MATLAB `step` and `impulse`).

    continuous   step      y(t) = C int_0^t exp(A s) ds B + D          impulse   y(t) = C exp(A t) B          D = 0
    sampled      step      y(k) = C sum_(i<k) A^i B + D                impulse   y(0) = D,  y(k) = C A^(k-1) B

One matrix exponential of [[A, B], [0, 0]] over the interval gives the exact recursion x+ = F x + G. One input at a time
is excited; the other inputs and the initial states are 0.

The impulse of a sampled model is the unit pulse: 1 at the first sample, 0 after it. Its response is the sequence of
Markov parameters, whose sum is the step response. MATLAB and python-control use a pulse of height 1/T instead (area 1).
"""

import numpy as np
from numpy.typing import NDArray

from synth import arguments, show
from synth.analyse import discretise, equilibrate, transfer
from synth.errors import ModelError, TimingError
from synth.statespace import Array, StateSpace, System, of, readonly
from synth.timing import Continuous

DECADES = 3.0  # of decay, or growth, of the slowest mode in the default duration
POINTS = 500  # at least, for a continuous model
MAX_SAMPLES = 20_000
PER_TURN = 20  # points in a period of the fastest oscillating mode
BAND = 0.02  # of the final value: tolerance of the settling time


@show.result
class TimeResponse:
    """Outputs (k, p, m) at `time` (k,) in seconds: output i for a `signal` (step or impulse) at input j alone.

    `final` (p, m) is the final value of the step response of a stable model, None otherwise.
    """

    signal: str
    time: Array
    outputs: Array
    output_names: tuple[str, ...]
    input_names: tuple[str, ...]
    output_units: tuple[str, ...]
    input_units: tuple[str, ...]
    final: Array | None = None

    def sheet(self) -> show.Sheet:
        """Return final value, overshoot, rise and settling time of each channel for a step, and each peak."""
        labels = [[show.with_unit(*pair) for pair in zip(*part, strict=True)] for part in self._signals()]
        rows = tuple(
            (f"{labels[1][j]} -> {labels[0][i]}", *self._figures(i, j)) for i, j in np.ndindex(*self.outputs.shape[1:])
        )
        columns = ("channel", "final", "overshoot", "rise [s]", "settled [s]", "peak", "at [s]")
        span = f"{len(self.time)} times up to {show.number(self.time[-1])} s"
        line = f"rise from 10 to 90 %, settled within {BAND:.0%} of the final value" if self.final is not None else span
        return show.Sheet(f"Response to a unit {self.signal}, {span}", (line,), (show.Table(columns, rows),))

    def _signals(self) -> tuple[tuple[tuple[str, ...], tuple[str, ...]], ...]:
        return (self.output_names, self.output_units), (self.input_names, self.input_units)

    def _figures(self, i: int, j: int) -> tuple[str, ...]:
        n, y = show.number, self.outputs[:, i, j]
        top = int(np.abs(y).argmax())
        peak = n(y[top]), n(self.time[top])
        if self.final is None:
            return ("", "", "", "", *peak)
        final = float(self.final[i, j])
        if not final:
            return (n(final), "", "", "", *peak)
        times = [_first_crossing(self.time, y / final, level) for level in (0.1, 0.9)]
        rise = n(times[1] - times[0]) if np.isfinite(times).all() else ""
        overshoot = f"{max(0.0, float((y / final).max()) - 1):.2%}"
        return (n(final), overshoot, rise, _settling_time(self.time, y / final), *peak)


@arguments.checked
def step_response(system: System, duration_s: float | None = None, interval_s: float | None = None) -> TimeResponse:
    """Return the response to a unit step at each input in turn, from 0 to `duration_s` every `interval_s` seconds.

    By default the slowest mode decays, or the fastest growing mode grows, by a factor of 1000 within the duration, and
    the interval resolves the oscillations with at least 500 points. A sampled model keeps its own interval.

    Raises SignalError as `statespace.of`; TimingError for a time that is not positive, more than 20,000 intervals, or
    an interval for a sampled model; ModelError when a mode overflows double precision.
    """
    model = of(system)
    time, F, G = _recursion(model, duration_s, interval_s)
    n, m = model.B.shape
    outputs = _outputs(model, F, G, np.zeros((n, m)), model.D, len(time))
    return _response("step", model, time, outputs, _final(model))


@arguments.checked
def impulse_response(system: System, duration_s: float | None = None, interval_s: float | None = None) -> TimeResponse:
    """Return the response to a unit impulse at each input in turn; a sampled model gets 1 at its first sample.

    Times and errors are those of `step_response`. Also raises ModelError for a continuous model with D other than 0,
    whose response contains an impulse.
    """
    model = of(system)
    if isinstance(model.time, Continuous) and model.D.any():
        i, j = np.argwhere(model.D)[0]
        raise ModelError(
            f"the impulse response contains an impulse at t = 0, D[{model.outputs[i]}, {model.inputs[j]}] is "
            f"{show.number(model.D[i, j])}: give the model with D = 0 for its response at t > 0"
        )
    time, F, _ = _recursion(model, duration_s, interval_s)
    if isinstance(model.time, Continuous):
        outputs = _outputs(model, F, np.zeros_like(model.B), model.B, model.D, len(time))
    else:
        outputs = _outputs(model, F, np.zeros_like(model.B), model.B, np.zeros_like(model.D), len(time) - 1)
        outputs = np.concatenate([model.D[None], outputs])
    return _response("impulse", model, time, outputs, None)


def _outputs(model: StateSpace, F: Array, G: Array, X: Array, D: Array, count: int) -> Array:
    """Return C x + D (count, p, m) along x+ = F x + G from X (n, m)."""
    outputs = np.empty((count, *D.shape))
    with np.errstate(over="ignore", invalid="ignore"):
        for k in range(count):
            outputs[k] = model.C @ X + D
            X = F @ X + G
    if not np.isfinite(outputs).all():
        raise ModelError(
            "the response grows beyond what a double holds: give a shorter duration, or close a loop around the model"
        )
    return outputs


def _recursion(model: StateSpace, duration_s: float | None, interval_s: float | None) -> tuple[Array, Array, Array]:
    """Return the times (k,), F (n, n) and G (n, m)."""
    for what, seconds in (("duration", duration_s), ("interval", interval_s)):
        number = isinstance(seconds, int | float | np.integer | np.floating) and not isinstance(seconds, bool)
        if seconds is not None and not (number and 0 < seconds < np.inf):
            raise TimingError(f"the {what} is {seconds!r}: give a finite positive number of seconds")
    if isinstance(model.time, Continuous):
        span = float(duration_s or _duration(model))
        interval = float(interval_s or span / _count(model, span))
    elif interval_s is not None:
        raise TimingError(f"a model in {model.time} has its own interval, but {interval_s:g} s was given: leave it out")
    else:
        interval = model.time.period_s
        span = float(duration_s or min(float(np.ceil(_duration(model) / interval)), MAX_SAMPLES / 2) * interval)
    count = int(np.floor(span / interval * (1 + 1e-12)))
    if not 1 <= count <= MAX_SAMPLES:
        raise TimingError(
            f"{span:g} s hold {count} intervals of {interval:g} s: give times for 1 to {MAX_SAMPLES} of them"
        )
    F, G = (model.A, model.B) if not isinstance(model.time, Continuous) else _discretise(model, interval)
    return interval * np.arange(count + 1, dtype=np.float64), F, G


def _discretise(model: StateSpace, interval: float) -> tuple[Array, Array]:
    n, m = model.B.shape
    M = np.block([[model.A, model.B], [np.zeros((m, n + m))]])
    E = discretise.gramian(M, np.zeros_like(M), interval).M
    return E[:n, :n], E[:n, n:]


def _rates(model: StateSpace) -> NDArray[np.complex128]:
    """Return the poles in 1/s (n,); for a sampled model without those at z = 0."""
    poles = model.poles
    if isinstance(model.time, Continuous):
        return poles
    return np.log(poles[poles != 0]) / model.time.period_s


def _duration(model: StateSpace) -> float:
    """Return the time for all stable modes to decay by 1000, or for the fastest growing mode to grow by 1000."""
    rates = _rates(model)
    size = float(np.abs(rates).max(initial=0.0))
    lasting = np.abs(rates.real) <= 1e-9 * np.abs(rates) + 1e-14 * size
    grow = rates.real[~lasting & (rates.real > 0)]
    spans = DECADES * np.log(10) / (grow.max(keepdims=True) if grow.size else np.abs(rates.real[~lasting]))
    turns = 10 * 2 * np.pi / np.abs(rates[lasting & (np.abs(rates) > 1e-14 * size)])
    shortest = 1.0 if isinstance(model.time, Continuous) else 10 * model.time.period_s
    return float(np.concatenate([spans, turns]).max(initial=0.0)) or shortest


def _count(model: StateSpace, span: float) -> int:
    rates = _rates(model)
    frequencies = np.abs(rates.imag[np.abs(rates.imag) > 0.1 * np.abs(rates.real)])
    return int(np.clip(PER_TURN * span * frequencies.max(initial=0.0) / (2 * np.pi), POINTS, MAX_SAMPLES / 2))


def _final(model: StateSpace) -> Array | None:
    """Return C (-A)^-1 B + D, for a sampled model C (I - A)^-1 B + D; None unless it is stable."""
    if not transfer.is_stable(model.poles, model.time):
        return None
    resolvent = -model.A if isinstance(model.time, Continuous) else np.eye(len(model.A)) - model.A
    if equilibrate.is_singular(resolvent):
        return None
    return np.asarray(model.C @ np.linalg.solve(resolvent, model.B) + model.D)


def _response(signal: str, model: StateSpace, time: Array, outputs: Array, final: Array | None) -> TimeResponse:
    units, input_units = (tuple(model.unit(name) for name in names) for names in (model.outputs, model.inputs))
    ends = None if final is None else readonly(final)
    values = readonly(time), readonly(outputs)
    return TimeResponse(signal, *values, model.outputs, model.inputs, units, input_units, ends)


def _first_crossing(time: Array, y: Array, level: float) -> float:
    """Return the time when y first reaches a level, by linear interpolation; inf if it does not."""
    above = y >= level
    if not above.any():
        return np.inf
    k = int(above.argmax())
    return float(time[0] if not k else time[k - 1] + (time[k] - time[k - 1]) * (level - y[k - 1]) / (y[k] - y[k - 1]))


def _settling_time(time: Array, y: Array) -> str:
    """Return the settling time, after which y stays within BAND of 1, as text; "" if it is still outside."""
    outside = np.flatnonzero(np.abs(y - 1) > BAND)
    if not outside.size:
        return show.number(time[0])
    return show.number(time[outside[-1] + 1]) if outside[-1] + 1 < len(time) else ""
