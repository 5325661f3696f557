"""A scalar loop along the frequency axis: s = i w, or z = exp(i w T) up to w = pi/T for a sampled loop.

    L(s) = (C (s I - A)^-1 B + D) exp(-s tau) (1 - exp(-s T)) / (s T)

A StateSpace is the first factor alone. `Delayed` has the other two as well, exactly: a computation delay tau, and the
mean effect of a sample hold of period T; with them 1 + L has infinitely many zeros. How many lie to the right is told
by the argument principle: with the poles p of the first factor and any a > 0,

    g(s) = (1 + L(s)) prod (s - p) / (s + a)

has no pole at or right of the axis and is real at s = 0, so that it has -(turn of g from w = 0 to infinity) / pi zeros
to the right. The poles are counted exactly, those on the axis and those that L does not show, too.

The grid is dense at the poles of L and of the closed loop and refined until neighbours differ little, in phase too,
which turns at a zero.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from numbers import Real

import numpy as np
from numpy.typing import ArrayLike, NDArray

from synth import arguments, show
from synth.errors import ModelError, SignalError, TimingError
from synth.statespace import Array, StateSpace, System, of
from synth.timing import Continuous, Discrete, Time

Complex = NDArray[np.complex128]
Response = Callable[[ArrayLike], Complex]

NARROW = 1e-9  # of a frequency: nodes stand no closer, for nearer to an undamped pole L is rounding error
QUIET = 1e-2  # a delayed loop is followed until |L| stays this near to its last value, and for two turns at least
TURNS = 1000  # of the delay over the whole grid: beyond, the loop is refused
TOLD = 1e-8  # where |1 + L| is less, rounding error decides on which side of -1 the loop passes


@arguments.checked
@show.printed
@dataclass(frozen=True, eq=False, repr=False)
class Delayed:
    """A scalar continuous model whose output is late by `delay_s` and, where `hold_s` is not 0, held over `hold_s`."""

    model: StateSpace
    delay_s: float
    hold_s: float = 0.0

    def sheet(self) -> show.Sheet:
        """Return the two times, and the model under them."""
        under = self.model.sheet()
        line = f"delay {self.delay_s:g} s, hold {self.hold_s:g} s, both exact"
        return show.Sheet(f"{under.title}, delayed", (line,), under.tables)


Loop = System | Delayed
"""What has a frequency response: a System, or a Delayed."""


@dataclass(frozen=True, eq=False)
class Curve:
    """L on frequencies w (N,) in rad/s, rising; `ends` has L at w = 0 and at pi/T or infinity, where it has no pole."""

    L: Response
    w: Array
    value: Complex
    ends: Mapping[float, float]


@arguments.checked
def delayed(system: System, delay_s: float, hold_s: float = 0.0) -> Delayed:
    """Return a scalar continuous loop with an exact delay and hold, seconds, each 0 or more.

    Raises TimingError for a sampled model or a time that is negative or not finite; SignalError when it is not scalar.
    """
    model = scalar(of(system))
    if not isinstance(model.time, Continuous):
        raise TimingError(
            f"a loop in {model.time} was given to be delayed by {delay_s:g} s: sample its plant with loop.sampled, "
            "which takes the delay, or give the continuous loop"
        )
    for what, seconds in (("delay", delay_s), ("hold", hold_s)):
        if not (np.isfinite(seconds) and seconds >= 0):
            raise TimingError(f"the {what} is {seconds} s: it must be finite and 0 or more")
    return Delayed(model, float(delay_s), float(hold_s))


@arguments.checked
def read(loop: Loop) -> StateSpace | Delayed:
    """Return a loop as a StateSpace or a Delayed; raise SignalError when it has another count of signals than one."""
    return loop if isinstance(loop, Delayed) else scalar(of(loop))


@arguments.checked
def scalar(model: StateSpace) -> StateSpace:
    """Return the model; raise SignalError when it has not one input and one output."""
    if (len(model.inputs), len(model.outputs)) != (1, 1):
        raise SignalError(f"the loop has inputs {model.inputs} and outputs {model.outputs}: open it at one signal")
    return model


@arguments.checked
def response(loop: Loop) -> Response:
    """Return w (k,) rad/s -> L (k,) of a scalar loop; exactly on a pole, L right beside it.

    Raises SignalError when the loop is not scalar; w -> L raises ModelError at a pole that has nothing beside it, at 0.
    """
    found = read(loop)
    model = found.model if isinstance(found, Delayed) else found
    time = model.time

    def points(w: Array) -> Complex:
        return np.asarray(1j * w if isinstance(time, Continuous) else np.exp(1j * w * time.period_s))

    def L(frequencies: ArrayLike) -> Complex:
        w = np.atleast_1d(np.asarray(frequencies, dtype=np.float64))
        late = _lateness(found, w) if isinstance(found, Delayed) else 1.0
        try:
            return late * model.response(points(w))[:, 0, 0]
        except ModelError:
            return late * model.response(points(w * (1 + 1e-14)))[:, 0, 0]

    return L


@arguments.checked
def closed_poles(model: StateSpace) -> Complex:
    """Return the zeros of 1 + L, in 1/s or in z; raise ModelError where L passes its input straight on as -1."""
    D = float(scalar(model).D[0, 0])
    if D == -1:
        raise ModelError("the loop passes its input straight on with the factor -1: 1 + L has no inverse; delay it")
    return np.linalg.eigvals(model.A - model.B @ model.C / (1 + D)).astype(np.complex128)


def decay(poles: Complex, time: Time) -> bool:
    """Tell whether all poles decay, by more than the rounding error of the matrix that they belong to."""
    if isinstance(time, Continuous):
        return bool((poles.real < -1e-14 * np.abs(poles).max(initial=0.0)).all())
    return bool((np.abs(poles) < 1 - 1e-14).all())


@arguments.checked
def trace(loop: StateSpace | Delayed, low: float | None = None, high: float | None = None) -> Curve:
    """Return L between `low` and `high` rad/s on a grid fine enough for every crossing to show.

    Left out, `low` lies below and `high` above all poles; a sampled loop always goes up to Nyquist.

    Raises SignalError when low and high are not 0 < low < high; ModelError when 1 + L has no inverse, or when a delay
    is too long for the loop to be followed.
    """
    model = loop.model if isinstance(loop, Delayed) else loop
    L, closed, poles = response(loop), _closed_rates(loop), _rates(model.poles, model)
    start, top = _span(model, closed, poles, low, high)
    turning = loop.delay_s + loop.hold_s / 2 if isinstance(loop, Delayed) else 0.0
    nodes = [np.zeros(0)]
    if turning:
        top = high or max(_settled(loop, start, top), 4 * np.pi / turning)
        if top * turning > 2 * np.pi * TURNS:
            raise ModelError(
                f"the loop is delayed by {turning:g} s and must be followed up to {top:.3g} rad/s, more than {TURNS} "
                f"turns: give `high` below {2 * np.pi * TURNS / turning:.3g} rad/s, or lower the loop's bandwidth"
            )
        nodes = [np.arange(start, top, 0.3 / turning)]
    if not 0 < start < top:
        raise SignalError(f"the frequencies go from {start:g} to {top:g} rad/s: give 0 < low < high, below Nyquist")
    w = _grid(np.concatenate([poles, closed]), start, top, nodes)
    w, value = _refined(L, w)
    w.flags.writeable = value.flags.writeable = False
    return Curve(L, w, value, _ends(loop))


def count_unstable(loop: Delayed, curve: Curve) -> float:
    """Return how many closed-loop poles lie to the right of the imaginary axis, by the argument principle.

    With a delay, |D| >= 1 and no hold, infinitely many lie there or come as near to the axis as one likes: inf.

    Raises ModelError where rounding hides the answer.
    """
    if loop.delay_s and not loop.hold_s and abs(float(loop.model.D[0, 0])) >= 1:
        return np.inf
    least = int(np.abs(1 + curve.value).argmin())
    if abs(1 + curve.value[least]) < TOLD:
        raise ModelError(
            f"|1 + L| is {abs(1 + curve.value[least]):.0e} at {curve.w[least]:.6g} rad/s: rounding hides whether the "
            "delayed loop is stable; change its gain or its delay a little"
        )
    turn = _turn(loop.model, curve)
    if abs(turn - round(turn)) > 0.1:
        raise ModelError(
            f"the delayed loop turns {turn:.3g} half times around -1, no whole number: give a lower `low` and a "
            "higher `high`"
        )
    return -round(turn)


def _turn(model: StateSpace, curve: Curve) -> float:
    """Return the turn of g from w = 0 to infinity, over pi."""
    s = 1j * curve.w
    poles = model.poles
    scale = float(np.exp(np.log(curve.w[[0, -1]]).mean()))
    factors = [(s - p) / (s + (abs(p) if abs(p) > curve.w[0] else scale)) for p in poles]
    g = (1 + curve.value) * np.prod([np.ones(len(s)), *factors], axis=0)
    inside = np.diff(np.angle(g))
    inside = float(((inside + np.pi) % (2 * np.pi) - np.pi).sum())
    before = float(np.angle(g[0]) - np.pi * np.round(np.angle(g[0]) / np.pi))  # g is real at w = 0
    after = -float(np.angle(1 + curve.value[-1]) + sum(np.angle(f[-1]) for f in factors))  # all tend to 1
    return (before + inside + after) / np.pi


def _lateness(loop: Delayed, w: Array) -> Complex:
    x = w * loop.hold_s / 2
    return np.asarray(np.sinc(x / np.pi) * np.exp(-1j * (w * loop.delay_s + x)))


def _closed_rates(loop: StateSpace | Delayed) -> Complex:
    """Return the poles of the closed loop, without its delay, in 1/s."""
    if isinstance(loop, StateSpace):
        return _rates(closed_poles(loop), loop)
    return loop.model.poles if loop.model.D[0, 0] == -1 else closed_poles(loop.model)


def _rates(poles: Complex, model: StateSpace) -> Complex:
    return poles if isinstance(model.time, Continuous) else np.log(poles[poles != 0]) / model.time.period_s


def _span(
    model: StateSpace, closed: Complex, poles: Complex, low: float | None, high: float | None
) -> tuple[float, float]:
    for name, v in (("low", low), ("high", high)):
        if v is not None and (not isinstance(v, Real) or isinstance(v, bool) or not 0 < v < np.inf):
            raise SignalError(f"`{name}` is {v!r}: give a finite frequency above 0 in rad/s, or leave it out")
    if low is not None and high is not None and low >= high:
        raise SignalError(f"the frequencies go from {low:g} to {high:g} rad/s: give 0 < low < high, below Nyquist")
    size = np.abs(np.concatenate([closed, poles]))
    if isinstance(model.time, Discrete):
        top, bottom = np.pi / model.time.period_s * (1 - 1e-9), 1e-6 / model.time.period_s
    else:
        top, bottom = high or 1e3 * float(size.max(initial=1.0)), 1e-9 * float(size.max(initial=1.0))
    return low or float(np.clip(1e-2 * np.abs(closed).min(initial=1.0), min(bottom, 1e-2), 1e-2)), float(top)


def _settled(loop: StateSpace | Delayed, start: float, top: float) -> float:
    """Return a frequency above which |L| stays within QUIET of its last value, `top` if there is none."""
    w = np.geomspace(start, top, 2000)
    moving = np.flatnonzero(np.abs(np.abs(response(loop)(w)) - abs(_ends(loop)[np.inf])) >= QUIET)
    return float(w[min(moving[-1] + 1, len(w) - 1)]) if moving.size else float(w[0])


def _grid(rates: Complex, start: float, top: float, nodes: list[Array]) -> Array:
    """Return frequencies from start to top, denser towards each lightly damped pole, and the given nodes."""
    points = [np.geomspace(start, top, 400), *nodes]
    for s in rates[rates.imag > start]:
        width = max(abs(s.real), 4 * NARROW * s.imag)
        away = np.geomspace(width / 4, 4 * width + 0.1 * s.imag, 16 + int(4 * np.log10(1 + s.imag / width)))
        points += [s.imag - away, s.imag + away]
    w = np.unique(np.concatenate(points))
    w = w[(w >= start) & (w <= top)]
    undamped = rates.imag[(np.abs(rates.real) < NARROW * rates.imag) & (rates.imag > start)]
    w = w[(np.abs(w[:, None] - undamped) > NARROW / 2 * w[:, None]).all(axis=1)]
    # Poles that nearly coincide seed nearly the same nodes; a bracket between such twins would hold no peak.
    return w[np.append(np.diff(w) > NARROW * w[1:], True)]


def _ends(loop: StateSpace | Delayed) -> dict[float, float]:
    """Return L where it is real: at w = 0 and at Nyquist or infinity, unless it has a pole there."""
    if isinstance(loop, Delayed):
        last = 0.0 if loop.hold_s else float(loop.model.D[0, 0])
        return _real(loop.model, {0.0: 0.0}) | {np.inf: -abs(last) if loop.delay_s else last}  # it circles for ever
    if isinstance(loop.time, Continuous):
        return _real(loop, {0.0: 0.0}) | {np.inf: float(loop.D[0, 0])}
    return _real(loop, {0.0: 1.0, np.pi / loop.time.period_s: -1.0})


def _real(model: StateSpace, points: dict[float, float]) -> dict[float, float]:
    found = {}
    for w, v in points.items():
        sigma = np.linalg.svd(v * np.eye(len(model.A)) - model.A, compute_uv=False)
        if sigma.size == 0 or sigma[-1] > 1e-12 * sigma[0]:
            found[w] = float(model.response(v)[0, 0, 0].real)
    return found


def _refined(L: Response, w: Array) -> tuple[Array, Complex]:
    """Halve each interval over which log L or log(1 + L) turns or grows by more than a little."""
    value = L(w)
    for _ in range(40):
        wide = (_step(value) > 0.15) | (_step(1 + value) > 0.15)
        wide &= np.diff(w) > 4 * NARROW * w[1:]
        if not wide.any():
            break
        between = np.sqrt(w[:-1] * w[1:])[wide]
        order = np.argsort(np.concatenate([w, between]), kind="stable")
        value = np.concatenate([value, L(between)])[order]
        w = np.concatenate([w, between])[order]
    return w, value


def _step(value: Complex) -> Array:
    """Return how far log `value` moves from point to point."""
    turn = np.diff(np.angle(value))
    return np.hypot(np.diff(log(value)), (turn + np.pi) % (2 * np.pi) - np.pi)


def log(value: Complex) -> Array:
    """Return log |value|, of 0 that of the least number."""
    return np.log(np.maximum(np.abs(value), 1e-300))
