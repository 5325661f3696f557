"""Step, impulse and forced responses, exact at given times (python-control's and MATLAB `step`, `impulse`, `lsim`).

    continuous   step      y(t) = C int_0^t exp(A s) ds B + D          impulse   y(t) = C exp(A t) B          D = 0
    sampled      step      y(k) = C sum_(i<k) A^i B + D                impulse   y(0) = D,  y(k) = C A^(k-1) B

One matrix exponential of [[A, B], [0, 0]] over the interval gives the exact recursion x+ = F x + G. One input at a time
is excited; the other inputs and the initial states are 0.

The default duration of a stable model is sound: no response leaves a band around its final value after it. The bound is

    y(0)^2 <= 2 |y| |dy/dt|,        for a sampled model y(0)^2 <= |y(k) - y(k+1)| |y(k) + y(k+1)|

of an output without inputs, with norms of L2 over t >= 0, is the integral of d(y^2)/dt; a real mode attains it.

By default the times of a continuous model are equally spaced if 10,000 intervals resolve its fastest mode for the whole
duration. Otherwise they have segments: each has the interval for the modes that have not yet decayed.

The impulse of a sampled model is the unit pulse: 1 at the first sample, 0 after it. Its response is the sequence of
Markov parameters, whose sum is the step response. MATLAB and python-control use a pulse of height 1/T instead (area 1).
"""

import warnings
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import scipy.linalg
from numpy.typing import ArrayLike, NDArray

from synth import arguments, resolvent, show
from synth.analyse import discretise
from synth.analyse.loops import transfer
from synth.analyse.numerics import magnitude
from synth.errors import ModelError, SignalError, TimingError
from synth.statespace import Array, StateSpace, System, of, readonly
from synth.timing import Continuous, Discrete, Time

DECADES = 3.0  # of decay, or growth, of the slowest mode in the default duration
POINTS = 500  # at least, for a continuous model
MAX_SAMPLES = 20_000
MAX_DEFAULT_SAMPLES = MAX_SAMPLES // 2  # at one interval
PER_TURN = 20  # points in a period of the fastest oscillating mode
PER_LIFE = 20  # points in the time constant of the fastest decaying mode
BAND = 0.02  # of the final value: tolerance of the settling time
REST = 0.002  # of the final value: no response leaves this band after the default duration
LONGEST = 100.0  # times the time in which the slowest mode decays: no longer default duration
PARTS = 100  # of that time, for the largest deviation
SMALL = 1e-3  # of the largest deviation: REST is of this where the final value is smaller, and not 0
ROUNDING = 1e-12  # of the largest deviation: a smaller final value is 0


@dataclass(frozen=True)
class _Segment:
    """`count` intervals of equal length in s."""

    interval: float
    count: int


@show.result
class TimeResponse:
    """Outputs (k, p, m) at `time` (k,) in seconds: output i for a `signal` (step or impulse) at input j alone.

    `final` (p, m) is the final value of the step response of a stable model, None otherwise. `note` says where the
    default times are not equally spaced, or are fewer than the slowest mode needs.
    """

    signal: str
    time: Array
    outputs: Array
    output_names: tuple[str, ...]
    input_names: tuple[str, ...]
    output_units: tuple[str, ...]
    input_units: tuple[str, ...]
    final: Array | None = None
    note: str = ""

    def sheet(self) -> show.Sheet:
        """Return final value, overshoot, rise and settling time of each channel for a step, and each peak.

        A response that comes close to its largest value, the final one, without reaching it has no time of a peak.
        """
        labels = [[show.with_unit(*pair) for pair in zip(*part, strict=True)] for part in self._signals()]
        rows = tuple(
            (f"{labels[1][j]} -> {labels[0][i]}", *self._figures(i, j)) for i, j in np.ndindex(*self.outputs.shape[1:])
        )
        columns = ("channel", "final", "overshoot", "undershoot", "rise [s]", "settled [s]", "peak", "at [s]")
        span = f"{len(self.time)} times up to {show.number(self.time[-1])} s"
        meaning = f"rise from 10 to 90 %, settled within {BAND:.0%} of the final value, undershoot below 0"
        line = span if self.final is None else meaning
        lines = (line, self.note) if self.note else (line,)
        return show.Sheet(f"Response to a unit {self.signal}, {span}", lines, (show.Table("", columns, rows),))

    def _signals(self) -> tuple[tuple[tuple[str, ...], tuple[str, ...]], ...]:
        return (self.output_names, self.output_units), (self.input_names, self.input_units)

    def _figures(self, i: int, j: int) -> tuple[str, ...]:
        n, y = show.number, self.outputs[:, i, j]
        top = int(np.abs(y).argmax())
        peak = n(y[top]), n(self.time[top])
        if self.final is None:
            return ("", "", "", "", "", *peak)
        final = float(self.final[i, j])
        if abs(final) <= ROUNDING * np.abs(y).max():
            return (n(0.0), "", "", "", "", *peak)
        y = y / final
        if np.abs(y).max() < 1 - ROUNDING and y[-1] > 1 - BAND:
            peak = n(final), "approached"
        times = [_first_crossing(self.time, y, level) for level in (0.1, 0.9)]
        rise = n(times[1] - times[0]) if np.isfinite(times).all() else ""
        over, under = (f"{max(0.0, float(v)):.2%}" for v in (y.max() - 1, -y.min()))
        return (n(final), over, under, rise, _settling_time(self.time, y), *peak)


@arguments.checked
def step_response(system: System, duration_s: float | None = None, interval_s: float | None = None) -> TimeResponse:
    """Return the response to a unit step at each input in turn, from 0 to `duration_s` every `interval_s` seconds.

    By default the slowest mode decays, or the fastest growing mode grows, by a factor of 1000 within the duration; the
    outputs of a stable model stay within 0.2 % of their final values after it. 20 points in a period and in a time
    constant resolve each mode until it has decayed by 1000, at least 500 in all. Beside a slow mode that gives
    intervals of several lengths; `interval_s` gives equal ones. A sampled model keeps its own interval, and its default
    duration is at most 10,000 samples, even if its slowest mode needs more.

    Raises SignalError as `statespace.of`; TimingError for a time that is not positive, for more than 20,000 intervals
    (given, or needed by default), or for an interval of a sampled model; ModelError when a mode overflows double
    precision.
    """
    model = of(system)
    final = _final(model)
    deviation = None if final is None else np.asarray(np.linalg.solve(_at_rest(model), model.B), dtype=np.float64)
    segments, note = _segments(model, duration_s, interval_s, deviation, final)
    outputs = _outputs(model, segments, np.zeros_like(model.B), model.B, model.D)
    return _response("step", model, segments, outputs, final, note)


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
    stable = transfer.is_stable(model.poles, model.time)
    segments, note = _segments(model, duration_s, interval_s, model.B if stable else None, np.zeros_like(model.D))
    held = np.zeros_like(model.B)
    if isinstance(model.time, Continuous):
        outputs = _outputs(model, segments, model.B, held, model.D)
    else:
        markov = [_Segment(segment.interval, segment.count - 1) for segment in segments]
        outputs = np.concatenate([model.D[None], _outputs(model, markov, model.B, held, np.zeros_like(model.D))])
    return _response("impulse", model, segments, outputs, None, note)


@arguments.checked
def forced_response(
    system: System,
    inputs: Mapping[str, ArrayLike],
    interval_s: float | None = None,
    initial: Mapping[str, float] | None = None,
    *,
    linear: bool = False,
) -> Array:
    """Return the outputs (k, p) for `inputs` by name, each a number or (k,), from `initial` states on.

    Row k is at the time k `interval_s`, without which a sampled model goes by its period. Inputs are held between
    samples or, with `linear`, interpolated, as python-control does for continuous models. Those left out are 0, and so
    are states.

    Raises SignalError for a name that the model lacks, and for inputs that are not finite or not of one length;
    TimingError for a continuous model without interval or a sampled one with one; ModelError for an overflow.
    """
    model = of(system)
    u, x = _columns(model, inputs), np.zeros(len(model.states))
    for name, value in (initial or {}).items():
        x[_place("state", name, model.states)] = value
    if isinstance(model.time, Continuous) == (interval_s is None):
        raise TimingError(
            f"a model in {model.time} with the interval {interval_s}: give it to a continuous model alone"
        )
    if interval_s is None:
        F, G, H = model.A, model.B, np.zeros_like(model.B)
    elif linear:
        ramp = discretise.first_order_hold(model.A, model.B, interval_s)
        F, G, H = ramp.F, ramp.G, ramp.H
    else:
        (F, G), H = _recursion(model, model.B, Discrete(interval_s).period_s), np.zeros_like(model.B)
    states = np.empty((len(u), len(x)))
    with np.errstate(over="ignore", invalid="ignore"):
        for k in range(len(u)):
            states[k] = x
            x = F @ x + G @ u[k] + H @ (u[min(k + 1, len(u) - 1)] - u[k])
        return _finite(states @ model.C.T + u @ model.D.T)


def _columns(model: StateSpace, inputs: Mapping[str, ArrayLike]) -> Array:
    """Return inputs by name as columns (k, m)."""
    values = {name: np.atleast_1d(arguments.real(f"values of input '{name}'", v)) for name, v in inputs.items()}
    count = max((v.size for v in values.values()), default=0)
    u = np.zeros((count, len(model.inputs)))
    for name, v in values.items():
        if v.ndim != 1 or v.size not in (1, count) or not np.isfinite(v).all():
            raise SignalError(
                f"input '{name}' has the shape {v.shape} or is not finite: give a number, or {count} finite ones as "
                "the longest input has"
            )
        u[:, _place("input", name, model.inputs)] = v
    if not count:
        raise SignalError("no inputs are given: give samples of one or more, such as {'u1': np.zeros(100)}")
    return u


def _place(kind: str, name: str, names: Sequence[str]) -> int:
    if name not in names:
        raise SignalError(f"the model has no {kind} '{name}': it has {', '.join(names) or 'none'}")
    return list(names).index(name)


def _outputs(model: StateSpace, segments: Sequence[_Segment], X: Array, B: Array, D: Array) -> Array:
    """Return C x + D (k, p, m) from X (n, m) on, with B (n, m) for the held input."""
    outputs = np.empty((1 + sum(segment.count for segment in segments), *D.shape))
    first = 1
    with np.errstate(over="ignore", invalid="ignore"):
        outputs[0] = model.C @ X + D
        for segment in segments:
            F, G = _recursion(model, B, segment.interval)
            for k in range(first, first + segment.count):
                X = F @ X + G
                outputs[k] = model.C @ X + D
            first += segment.count
    return _finite(outputs)


def _finite(outputs: Array) -> Array:
    if not np.isfinite(outputs).all():
        raise ModelError(
            "the response grows beyond what a double holds: give a shorter duration, or close a loop around the model"
        )
    return outputs


def _segments(
    model: StateSpace, duration_s: float | None, interval_s: float | None, X: Array | None, final: Array | None
) -> tuple[list[_Segment], str]:
    """Return the times as segments of equal intervals, and a note on the default ones; X and `final` as `_duration`."""
    for what, seconds in (("duration", duration_s), ("interval", interval_s)):
        number = isinstance(seconds, int | float | np.integer | np.floating) and not isinstance(seconds, bool)
        if seconds is not None and not (number and 0 < seconds < np.inf):
            raise TimingError(f"the {what} is {seconds!r}: give a finite positive number of seconds")
    if not isinstance(model.time, Continuous):
        if interval_s is not None:
            raise TimingError(
                f"a model in {model.time} has its own interval, but {interval_s:g} s was given: leave it out"
            )
        T = model.time.period_s
        if duration_s is not None:
            return _equal_segments(float(duration_s), T), ""
        samples = float(np.ceil(_duration(model, X, final) / T))
        note = f"limited to {MAX_DEFAULT_SAMPLES} samples: the slowest mode needs {samples:g}; give duration_s"
        few = samples <= MAX_DEFAULT_SAMPLES
        return _equal_segments(min(samples, MAX_DEFAULT_SAMPLES) * T, T), "" if few else note
    spans = [duration_s] if duration_s is not None else [_duration(model, X, final), _duration(model, None, None)]
    for span in map(float, spans):
        try:
            if interval_s is None:
                segments, note = _resolving_segments(model, span)
            else:
                segments, note = _equal_segments(span, float(interval_s)), ""
            return segments, note if span == spans[0] else "the response has not settled yet: give duration_s"
        except TimingError as error:
            refusal = error
    raise refusal


def _equal_segments(span: float, interval: float) -> list[_Segment]:
    count = int(np.floor(span / interval * (1 + 1e-12)))
    if not 1 <= count <= MAX_SAMPLES:
        raise TimingError(
            f"{span:g} s hold {count} intervals of {interval:g} s: give times for 1 to {MAX_SAMPLES} of them"
        )
    return [_Segment(interval, count)]


def _resolving_segments(model: StateSpace, span: float) -> tuple[list[_Segment], str]:
    """Return segments up to `span` that resolve each mode of a continuous model until it has decayed."""
    rates = _rates(model)
    decay, turn = np.maximum(-rates.real, 0.0), np.abs(rates.imag)
    density = np.maximum(PER_LIFE * decay, PER_TURN * turn / (2 * np.pi))  # points per s
    if span * density.max(initial=0.0) <= MAX_DEFAULT_SAMPLES:
        count = max(POINTS, int(span * density.max(initial=0.0)))
        return [_Segment(span / count, count)], ""
    # A mode on the imaginary axis, or one that grows, lasts for the whole span.
    lives = np.minimum(DECADES * np.log(10) / np.maximum(decay, DECADES * np.log(10) / span), span)
    segments, start = [], 0.0
    for end in np.unique(np.append(lives, span)):
        densest = max(POINTS / span, density[lives > start].max(initial=0.0))
        count = int(np.ceil((end - start) * densest))
        segments.append(_Segment(float(end - start) / count, count))
        start = end
    total = sum(segment.count for segment in segments)
    if total > MAX_SAMPLES:
        k = int(np.argmax(lives * density))
        raise TimingError(
            f"the mode at {show.number(turn[k])} rad/s needs an interval of {show.number(1 / density[k])} s "
            f"for {show.number(lives[k])} s in a duration of {show.number(span)} s: that takes {total} "
            f"intervals, more than {MAX_SAMPLES}; give a shorter duration_s, or give duration_s and interval_s"
        )
    if len(segments) == 1:
        return segments, ""
    lengths = [segment.interval for segment in segments]
    return segments, f"intervals from {show.number(min(lengths))} to {show.number(max(lengths))} s"


def _recursion(model: StateSpace, B: Array, interval: float) -> tuple[Array, Array]:
    """Return F (n, n) and G (n, m) of x+ = F x + G with B (n, m) for the held input."""
    if not isinstance(model.time, Continuous):
        return model.A, B
    n, m = B.shape
    M = np.block([[model.A, B], [np.zeros((m, n + m))]])
    E = discretise.gramian(M, np.zeros_like(M), interval).M
    return E[:n, :n], E[:n, n:]


def _rates(model: StateSpace) -> NDArray[np.complex128]:
    """Return the poles in 1/s (n,); for a sampled model without those at z = 0."""
    poles = model.poles
    if isinstance(model.time, Continuous):
        return poles
    return np.log(poles[poles != 0]) / model.time.period_s


def _duration(model: StateSpace, X: Array | None, final: Array | None) -> float:
    """Return the time for all stable modes to decay by 1000, or for the fastest growing mode to grow by 1000.

    If X (n, m) are the deviations at t = 0 of the states of a stable model from rest, no output is further than REST
    times `final` (p, m) from it after the time; times its largest deviation where `final` is 0.
    """
    rates = _rates(model)
    size = float(np.abs(rates).max(initial=0.0))
    lasting = np.abs(rates.real) <= 1e-9 * np.abs(rates) + 1e-14 * size
    grow = rates.real[~lasting & (rates.real > 0)]
    spans = DECADES * np.log(10) / (grow.max(keepdims=True) if grow.size else np.abs(rates.real[~lasting]))
    turns = 10 * 2 * np.pi / np.abs(rates[lasting & (np.abs(rates) > 1e-14 * size)])
    shortest = 1.0 if isinstance(model.time, Continuous) else 10 * model.time.period_s
    duration = float(np.concatenate([spans, turns]).max(initial=0.0)) or shortest
    if X is None or final is None or not (rates.size and final.size):
        return duration
    A, S, C = resolvent.balanced(model.A, np.eye(len(model.A)), model.C)
    period = 0.0 if isinstance(model.time, Continuous) else model.time.period_s
    h = period * max(1.0, duration / PARTS // period) if period else duration / PARTS
    parts, bound = int(duration / h * (1 + ROUNDING)), _tail_bound(A, C, model.time)
    F, deviations = _transition(A, h, period), [S @ X]
    for _ in range(parts):
        deviations.append(F @ deviations[-1])
    peak = np.abs(C @ np.array(deviations)).max(axis=0, initial=0.0)
    scale = REST * np.where(np.abs(final) > ROUNDING * peak, np.maximum(np.abs(final), SMALL * peak), peak)
    X, end = deviations[-1], parts * h
    while end < LONGEST * duration:
        left = float(np.divide(bound(X), scale, out=np.zeros_like(scale), where=scale > 0).max(initial=0.0))
        if left <= 1:
            break
        more = max(np.log(left) / float(-rates.real.max()), h)
        more = period * np.ceil(more / period) if period else more
        X, end = _transition(A, more, period) @ X, end + more
    return max(duration, end)


def _transition(A: Array, seconds: float, period: float) -> Array:
    """Return the matrix that maps states to those after a time, without inputs; a continuous model has the period 0."""
    F = np.linalg.matrix_power(A, round(seconds / period)) if period else scipy.linalg.expm(A * seconds)
    return np.asarray(F, dtype=np.float64)


def _tail_bound(A: Array, C: Array, time: Time) -> Callable[[Array], Array]:
    """Return X (n, m) -> upper bounds (p, m) of |C x(t)| at all t >= 0 for the states X at t = 0 without inputs.

    The norms of L2 in its square follow from an observability Gramian for each output.
    """
    pairs = []
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of modes with s + s' near 0: their default duration is limited anyway
        for c in C:
            if isinstance(time, Continuous):
                W = 2 * scipy.linalg.solve_continuous_lyapunov(A.T, -np.outer(c, c))
                pairs.append((W, A.T @ W @ A))
            else:
                rows = [np.outer(row, row) for row in (c - c @ A, c + c @ A)]
                pairs.append(tuple(scipy.linalg.solve_discrete_lyapunov(A.T, Q, "bilinear") for Q in rows))

    def bound(X: Array) -> Array:
        squares = [[np.maximum(((W @ X) * X).sum(axis=0), 0) for W in pair] for pair in pairs]
        return np.array([(first * second) ** 0.25 for first, second in squares])

    return bound


def _final(model: StateSpace) -> Array | None:
    """Return C (-A)^-1 B + D, for a sampled model C (I - A)^-1 B + D; None unless it is stable."""
    if not transfer.is_stable(model.poles, model.time):
        return None
    M = _at_rest(model)
    if magnitude.is_singular(M):
        return None
    return np.asarray(model.C @ np.linalg.solve(M, model.B) + model.D)


def _at_rest(model: StateSpace) -> Array:
    """Return M (n, n) of M x = B u at rest: -A, for a sampled model I - A."""
    return -model.A if isinstance(model.time, Continuous) else np.eye(len(model.A)) - model.A


def _response(
    signal: str, model: StateSpace, segments: Sequence[_Segment], outputs: Array, final: Array | None, note: str
) -> TimeResponse:
    units, input_units = (tuple(model.unit(name) for name in names) for names in (model.outputs, model.inputs))
    ends = None if final is None else readonly(final)
    values = readonly(_times(segments)), readonly(outputs)
    return TimeResponse(signal, *values, model.outputs, model.inputs, units, input_units, ends, note)


def _times(segments: Sequence[_Segment]) -> Array:
    """Return the times (k,) from 0 on."""
    times = [np.zeros(1)]
    for segment in segments:
        times.append(times[-1][-1] + segment.interval * np.arange(1, segment.count + 1, dtype=np.float64))
    return np.concatenate(times)


def _first_crossing(time: Array, y: Array, level: float) -> float:
    """Return the time when y first reaches a level, by linear interpolation; inf if it does not."""
    above = y >= level
    if not above.any():
        return np.inf
    k = int(above.argmax())
    return float(time[0] if not k else time[k - 1] + (time[k] - time[k - 1]) * (level - y[k - 1]) / (y[k] - y[k - 1]))


def _settling_time(time: Array, y: Array) -> str:
    """Return the time after which y stays within BAND of 1, by linear interpolation, as text; "" if it is outside."""
    outside = np.flatnonzero(np.abs(y - 1) > BAND)
    if not outside.size:
        return show.number(time[0])
    k = int(outside[-1])
    if k + 1 == len(time):
        return ""
    edge = 1 + BAND * np.sign(y[k] - 1)
    return show.number(time[k] + (time[k + 1] - time[k]) * (edge - y[k]) / (y[k + 1] - y[k]))
