"""Frequency response of a scalar loop: s = i w, or z = exp(i w T) up to w = pi/T for a sampled loop.

    L(s) = (C (s I - A)^-1 B + D) exp(-s tau) (1 - exp(-s T)) / (s T)

A StateSpace is the first factor alone. `Delayed` also has the other two, exactly: a computation delay tau and the
average effect of a zero-order hold of period T. With them 1 + L has infinitely many zeros.

The frequency grid of `trace` is dense at the poles of L and of the closed loop. It is refined until gain and phase
differ little between neighbours.

Frequency response at many frequencies, from the Schur form A = U T U' of the balanced A (`synth.resolvent`).

    M(s) = C U (s I - T)^-1 U' B + D

Unlike eigenvectors, U is well conditioned for every A. For a sampled model, the bilinear transformation
s = (z - 1)/(z + 1) maps z = exp(i w T) exactly to s = i tan(w T / 2):

    A -> (A + I)^-1 (A - I),   B -> sqrt(2) (A + I)^-1 B,   C -> sqrt(2) C (A + I)^-1,   D -> D - C (A + I)^-1 B

`error` gives the rounding error of M, from solutions with residuals in extended precision.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from numbers import Real

import numpy as np
from numpy.typing import ArrayLike, NDArray

from synth import arguments, resolvent, show
from synth.analyse.numerics.precise import MIN_SPACING, refine
from synth.errors import ModelError, SignalError, TimingError
from synth.statespace import Array, Complex, StateSpace, System, of
from synth.timing import Continuous, Discrete, Time


@dataclass(frozen=True, eq=False)
class SchurResponse:
    """A, B, C, D after the bilinear transformation and balancing, the Schur `form` of A, and the original `model`.

    Frequencies are those of s: w in rad/s for a continuous model, tan(w T / 2) for a sampled one.
    """

    A: Array
    B: Array
    C: Array
    D: Array
    form: resolvent.Schur
    model: StateSpace

    @property
    def poles(self) -> Complex:
        """Eigenvalues of A."""
        return self.form.poles

    @property
    def size(self) -> float:
        """The largest modulus of a pole, 1 without poles."""
        return float(np.abs(self.poles).max(initial=0.0)) or 1.0

    def at(self, frequencies: Array) -> Complex:
        """Return M (k, p, m) at frequencies (k,) of s, which may include inf."""
        infinite = np.isinf(frequencies)
        M = self.D + resolvent.at_points(self.form, self.A, self.B, self.C, 1j * np.where(infinite, 0.0, frequencies))
        M[infinite] = self.D
        return M

    def unwarped(self, frequencies: Array) -> Array:
        """Return w in rad/s for frequencies of s."""
        if isinstance(self.model.time, Continuous):
            return frequencies
        return np.asarray(2 / self.model.time.period_s * np.arctan(frequencies))

    def error(self, frequencies: Array, M: Complex) -> Complex:
        """Return the errors of the responses M (k, p, m) at frequencies (k,) of s, relative to the original model."""
        A, B, C, D = (getattr(self.model, letter).astype(np.longdouble) for letter in "ABCD")
        finite, continuous = np.isfinite(frequencies), isinstance(self.model.time, Continuous)
        s = 1j * np.where(finite, frequencies, 0.0).astype(np.longdouble)
        points = s if continuous else np.where(finite, (1 + s) / (1 - s), -1)
        pencils = points[:, None, None] * np.eye(len(A)) - A
        inverses = np.linalg.inv(pencils.astype(np.complex128))
        X = np.zeros((len(points), *B.shape), dtype=np.clongdouble)
        for _ in range(4):
            X = X + inverses @ (B - pencils @ X).astype(np.complex128)
        exact = np.where((finite | (not continuous))[:, None, None], C @ X + D, M)
        return np.asarray(M - exact, dtype=np.complex128)


def schur_response(model: StateSpace) -> SchurResponse:
    """Return the response of a model without a pole at z = -1."""
    A, B, C, D = model.A, model.B, model.C, model.D
    if not isinstance(model.time, Continuous):
        A, B, C, D = bilinear(*resolvent.balanced(A, B, C), D)
    A, B, C = resolvent.balanced(A, B, C)
    return SchurResponse(A, B, C, D, resolvent.schur(A), model)


def bilinear(A: Array, B: Array, C: Array, D: Array) -> tuple[Array, Array, Array, Array]:
    """Return A, B, C, D in s = (z - 1)/(z + 1) from those in z, which have no pole at z = -1."""
    one, root = np.eye(len(A)), np.sqrt(2)
    inverse = np.linalg.inv(A + one)
    return inverse @ (A - one), root * inverse @ B, root * C @ inverse, D - C @ inverse @ B


Response = Callable[[ArrayLike], Complex]

INTEGRATOR_RATE = 1e-12  # of the fastest rate: a slower one may be an integrator with rounding error
LIMIT_TOLERANCE = 1e-2  # a delayed loop is traced until |L| stays this close to its limit, and for at least two turns
ILL_POSED = "the loop has the direct feedthrough -1: 1 + L has no inverse; delay it"
MAX_TURNS = 1000  # of the delay over the whole grid: more is an error


@arguments.checked
@show.result
class Delayed:
    """A scalar continuous model with its output delayed by `delay_s` and, unless 0, held over `hold_s`."""

    model: StateSpace
    delay_s: float
    hold_s: float = 0.0

    def sheet(self) -> show.Sheet:
        """Return the delay, the hold and the model."""
        inner = self.model.sheet()
        line = f"delay {self.delay_s:g} s, hold {self.hold_s:g} s, both exact"
        return show.Sheet(f"{inner.title}, delayed", (line,), inner.tables)


Loop = System | Delayed
"""A System or a Delayed."""


@dataclass(frozen=True, eq=False)
class Curve:
    """L on rising frequencies w (N,) in rad/s; `ends` has L at w = 0 and at pi/T or infinity, unless it has a pole."""

    L: Response
    w: Array
    value: Complex
    ends: Mapping[float, float]


@arguments.checked
def with_delay_and_hold(system: System, delay_s: float, hold_s: float = 0.0) -> Delayed:
    """Return a scalar continuous loop with an exact delay and hold, seconds, each 0 or more.

    Raises TimingError for a sampled model or a time that is negative or not finite; SignalError when it is not scalar.
    """
    model = scalar(of(system))
    if not isinstance(model.time, Continuous):
        raise TimingError(
            f"a loop in {model.time} cannot be delayed by {delay_s:g} s: sample its plant with loop.sampled, "
            "which takes the delay, or give the continuous loop"
        )
    for what, seconds in (("delay", delay_s), ("hold", hold_s)):
        if not (np.isfinite(seconds) and seconds >= 0):
            raise TimingError(f"the {what} is {seconds} s: it must be finite and 0 or more")
    return Delayed(model, float(delay_s), float(hold_s))


@arguments.checked
def of_loop(loop: Loop) -> StateSpace | Delayed:
    """Return a loop as a StateSpace or a Delayed; raise SignalError unless it has one input and one output."""
    return loop if isinstance(loop, Delayed) else scalar(of(loop))


@arguments.checked
def scalar(model: StateSpace) -> StateSpace:
    """Return the model; raise SignalError unless it has one input and one output."""
    if (len(model.inputs), len(model.outputs)) != (1, 1):
        raise SignalError(f"the loop has inputs {model.inputs} and outputs {model.outputs}: open it at one signal")
    return model


@arguments.checked
def response(loop: Loop) -> Response:
    """Return the function w (k,) rad/s -> L (k,) of a scalar loop; exactly on a pole it gives L just beside it.

    Raises SignalError when the loop is not scalar. The function raises ModelError at a pole at w = 0.
    """
    scalar_loop = of_loop(loop)
    rational_part = _rational_response(scalar_loop.model if isinstance(scalar_loop, Delayed) else scalar_loop)

    def L(frequencies: ArrayLike) -> Complex:
        w = np.atleast_1d(np.asarray(frequencies, dtype=np.float64))
        factor = _delay_and_hold(scalar_loop, w) if isinstance(scalar_loop, Delayed) else 1.0
        return np.asarray(factor * rational_part(w))

    return L


def _rational_response(model: StateSpace) -> Response:
    """Return w (k,) -> C (v I - A)^-1 B + D (k,)."""
    time = model.time

    def points(w: Array) -> Complex:
        return np.asarray(1j * w if isinstance(time, Continuous) else np.exp(1j * w * time.period_s))

    def rational(w: ArrayLike) -> Complex:
        frequencies = np.asarray(w)
        try:
            return model.response(points(frequencies))[:, 0, 0]
        except ModelError:
            return model.response(points(frequencies * (1 + 1e-14)))[:, 0, 0]

    return rational


@arguments.checked
def closed_loop_poles(model: StateSpace, factor: complex = 1.0) -> Complex:
    """Return the zeros of 1 + factor L, in 1/s or in z; raise ModelError if 1 + factor D is 0."""
    D = factor * float(scalar(model).D[0, 0])
    if D == -1:
        raise ModelError(ILL_POSED)
    return np.linalg.eigvals(model.A - factor * model.B @ model.C / (1 + D)).astype(np.complex128)


def is_stable(poles: Complex, time: Time) -> bool:
    """Tell whether all poles are stable, by more than the rounding error of their matrix."""
    return not not_decaying(poles, time).any()


def not_decaying(poles: Complex, time: Time) -> NDArray[np.bool_]:
    """Tell for each pole whether it is undamped or unstable, up to the rounding error of its matrix."""
    if isinstance(time, Continuous):
        return np.asarray(poles.real >= -1e-14 * np.abs(poles).max(initial=0.0))
    return np.asarray(np.abs(poles) >= 1 - 1e-14)


@arguments.checked
def trace(
    loop: StateSpace | Delayed, low: float | None = None, high: float | None = None, L: Response | None = None
) -> Curve:
    """Return L between `low` and `high` rad/s on a grid that resolves every crossing; `L` if available.

    By default `low` lies below and `high` above all poles; a sampled loop always extends to Nyquist.

    Raises SignalError unless 0 < low < high; ModelError if 1 + L has no inverse, or if a delay is too long to trace the
    loop.
    """
    model = loop.model if isinstance(loop, Delayed) else loop
    L, closed, poles = L or response(loop), _closed_loop_rates(loop), _rates(model.poles, model)
    start, top = _span(model, closed, poles, low, high)
    total_delay = loop.delay_s + loop.hold_s / 2 if isinstance(loop, Delayed) else 0.0
    nodes = [np.zeros(0)]
    if total_delay:
        top = high or max(_quiet_frequency(L, abs(ends(loop)[np.inf]), start, top), 4 * np.pi / total_delay)
        check_turns(total_delay, top)
        nodes = [np.arange(start, top, 0.3 / total_delay)]
    if not 0 < start < top:
        raise SignalError(f"the frequencies go from {start:g} to {top:g} rad/s: give 0 < low < high, below Nyquist")
    w = _grid(np.concatenate([poles, closed]), start, top, nodes)
    first = np.asarray(L(w[:1]))
    if first.shape != (1,) or first.dtype.kind not in "fc":
        raise SignalError(f"`L` gives {arguments.describe(first)} for one frequency: give a function w (k,) -> L (k,)")
    w, value = refine(L, w, np.asarray(L(w)))
    w.flags.writeable = value.flags.writeable = False
    return Curve(L, w, value, ends(loop))


@arguments.checked
def check_limits(low: float | None, high: float | None) -> None:
    """Raise SignalError unless the limits in rad/s are 0 < low < high."""
    for name, v in (("low", low), ("high", high)):
        if v is not None and (not isinstance(v, Real) or isinstance(v, bool) or not 0 < v < np.inf):
            raise SignalError(f"`{name}` is {v!r}: give a finite frequency above 0 in rad/s, or leave it out")
    if low is not None and high is not None and low >= high:
        raise SignalError(f"the frequencies go from {low:g} to {high:g} rad/s: give 0 < low < high, below Nyquist")


@arguments.checked
def check_turns(delay_s: float, top: float) -> None:
    """Raise ModelError if the delay in s gives the loop too many turns below `top` rad/s to trace it."""
    if top * delay_s > 2 * np.pi * MAX_TURNS:
        raise ModelError(
            f"the loop is delayed by {delay_s:g} s and must be traced up to {top:.3g} rad/s, more than {MAX_TURNS} "
            f"turns: give `high` below {2 * np.pi * MAX_TURNS / delay_s:.3g} rad/s, or lower the loop's bandwidth"
        )


def _delay_and_hold(loop: Delayed, w: Array) -> Complex:
    x = w * loop.hold_s / 2
    return np.asarray(np.sinc(x / np.pi) * np.exp(-1j * (w * loop.delay_s + x)))


def _closed_loop_rates(loop: StateSpace | Delayed) -> Complex:
    if isinstance(loop, StateSpace):
        return _rates(closed_loop_poles(loop), loop)
    return loop.model.poles if loop.model.D[0, 0] == -1 else closed_loop_poles(loop.model)


def _rates(poles: Complex, model: StateSpace) -> Complex:
    return poles if isinstance(model.time, Continuous) else np.log(poles[poles != 0]) / model.time.period_s


def _span(
    model: StateSpace, closed: Complex, poles: Complex, low: float | None, high: float | None
) -> tuple[float, float]:
    size = np.abs(np.concatenate([closed, poles]))
    if isinstance(model.time, Discrete):
        top, bottom = np.pi / model.time.period_s * (1 - 1e-9), 1e-6 / model.time.period_s
    else:
        top, bottom = high or 1e3 * float(size.max(initial=1.0)), 1e-9 * float(size.max(initial=1.0))
    slowest = float(size[size > INTEGRATOR_RATE * size.max(initial=0.0)].min(initial=1.0))
    return low or float(np.clip(1e-2 * slowest, min(bottom, 1e-2), 1e-2)), float(top)


def _quiet_frequency(L: Response, last: float, start: float, top: float) -> float:
    """Return a frequency above which |L| stays within LIMIT_TOLERANCE of its limit `last`, `top` if there is none."""
    w = np.geomspace(start, top, 2000)
    unsettled = np.flatnonzero(np.abs(np.abs(L(w)) - last) >= LIMIT_TOLERANCE)
    return float(w[min(unsettled[-1] + 1, len(w) - 1)]) if unsettled.size else float(w[0])


def _grid(rates: Complex, start: float, top: float, nodes: list[Array]) -> Array:
    """Return frequencies from start to top, denser towards each lightly damped pole, and `nodes`."""
    points = [np.geomspace(start, top, 400), *nodes]
    for s in rates[rates.imag > start]:
        width = max(abs(s.real), 4 * MIN_SPACING * s.imag)
        away = np.geomspace(width / 4, 4 * width + 0.1 * s.imag, 16 + int(4 * np.log10(1 + s.imag / width)))
        points += [s.imag - away, s.imag + away]
    w = np.unique(np.concatenate(points))
    w = w[(w >= start) & (w <= top)]
    undamped = rates.imag[(np.abs(rates.real) < MIN_SPACING * rates.imag) & (rates.imag > start)]
    w = w[(np.abs(w[:, None] - undamped) > MIN_SPACING / 2 * w[:, None]).all(axis=1)]
    # Poles that nearly coincide give nearly equal nodes; a bracket between these would contain no peak.
    return w[np.append(np.diff(w) > MIN_SPACING * w[1:], True)]


@arguments.checked
def ends(loop: StateSpace | Delayed) -> dict[float, float]:
    """Return L where it is real: at w = 0 and at Nyquist or infinity, unless it has a pole there."""
    scalar(loop.model if isinstance(loop, Delayed) else loop)
    if isinstance(loop, Delayed):
        last = 0.0 if loop.hold_s else float(loop.model.D[0, 0])
        return _real_values(loop.model, {0.0: 0.0}) | {np.inf: -abs(last) if loop.delay_s else last}  # L circles
    if isinstance(loop.time, Continuous):
        return _real_values(loop, {0.0: 0.0}) | {np.inf: float(loop.D[0, 0])}
    return _real_values(loop, {0.0: 1.0, np.pi / loop.time.period_s: -1.0})


def _real_values(model: StateSpace, points: dict[float, float]) -> dict[float, float]:
    values = {}
    for w, v in points.items():
        sigma = np.linalg.svd(v * np.eye(len(model.A)) - model.A, compute_uv=False)
        if sigma.size == 0 or sigma[-1] > 1e-12 * sigma[0]:
            values[w] = float(model.response(v)[0, 0, 0].real)
    return values
