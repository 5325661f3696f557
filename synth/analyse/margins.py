"""Margins of a scalar loop.

         r -->(+)--> [ L ] --+--> y         1 + L = 0 is the closed loop; S = 1/(1 + L), T = L/(1 + L)
               ^-            |
               |-------------+

    gain crossing    |L| = 1:       phase margin arg(-L), delay margin (arg(-L) mod 2 pi) / w
    phase crossing   L < 0, real:   gain margin 1/|L|: above 1 the gain may rise by it, below 1 it may fall to it
    modulus margin   min |1 + L|,   the inverse of the peak sensitivity Ms

A sampled loop is taken on z = exp(i w T) up to w = pi/T, exactly; its hold and delays are part of its model. L is real
at w = 0 and at pi/T or infinity, and a phase crossing may lie there. The grid is dense at the poles of L and of the
closed loop and refined until neighbours differ little, in phase too, which turns at a zero; each crossing and the peak
are then found by bracketing.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.optimize import brentq, minimize_scalar

from synth.errors import ModelError, SignalError
from synth.statespace import Array, StateSpace
from synth.timing import Continuous

Complex = NDArray[np.complex128]
Response = Callable[[ArrayLike], Complex]
NOTHING = 1e-12  # below it |L| is rounding error and no crossing is reported


@dataclass(frozen=True)
class GainCrossing:
    """|L| = 1 at `frequency` rad/s: phase margin in degrees, delay margin in s."""

    frequency: float
    phase_margin: float
    delay_margin: float


@dataclass(frozen=True)
class PhaseCrossing:
    """L real and negative at `frequency` rad/s: the factor on the gain that makes L = -1."""

    frequency: float
    gain_margin: float


@dataclass(frozen=True)
class Margins:
    """All crossings of a loop; `stable` is told from the poles of 1 + L, Ms is at `peak_frequency` rad/s."""

    stable: bool
    gain_crossings: tuple[GainCrossing, ...]
    phase_crossings: tuple[PhaseCrossing, ...]
    peak_sensitivity: float
    peak_frequency: float

    @property
    def modulus_margin(self) -> float:
        """min |1 + L|."""
        return 1 / self.peak_sensitivity

    @property
    def phase_margin(self) -> float:
        """The smallest |phase margin| in degrees, inf without a gain crossing."""
        return min((abs(c.phase_margin) for c in self.gain_crossings), default=np.inf)

    @property
    def delay_margin(self) -> float:
        """The smallest delay in s that makes the loop oscillate, inf without a gain crossing."""
        return min((c.delay_margin for c in self.gain_crossings), default=np.inf)

    @property
    def gain_margin(self) -> float:
        """The smallest factor above 1 that makes the loop oscillate, inf without one."""
        return min((c.gain_margin for c in self.phase_crossings if c.gain_margin > 1), default=np.inf)

    @property
    def gain_reduction_margin(self) -> float:
        """The largest factor below 1 that makes the loop oscillate, 0 without one."""
        return max((c.gain_margin for c in self.phase_crossings if c.gain_margin <= 1), default=0.0)


def of_loop(loop: StateSpace, low: float | None = None, high: float | None = None) -> Margins:
    """Return the margins of a scalar loop between `low` and `high` rad/s, and where L is real at their far ends.

    Left out, `low` lies below and `high` above all poles of the open and the closed loop; a sampled loop always goes up
    to Nyquist.

    Raises SignalError when the loop has another count of inputs or outputs than one; ModelError when 1 + L has no
    inverse.
    """
    L = response(loop)
    closed = _closed_poles(loop)
    w, value = _refined(L, _grid(loop, closed, low, high))
    gains = [_gain_crossing(L, f) for f in _roots(lambda v: _log(L(v)), w, _log(value))]
    at = {f: complex(L(f)[0]) for f in _roots(lambda v: L(v).imag, w, value.imag)}
    real = {f: v.real for f, v in at.items() if abs(v.imag) <= 1e-6 * abs(v)}  # else a pole, where L.imag jumps
    real |= _ends(loop)
    phases = [PhaseCrossing(f, -1 / v) for f, v in sorted(real.items()) if v < -NOTHING]
    return Margins(_stable(loop, closed), tuple(gains), tuple(phases), *_peak(L, w, value, _ends(loop)))


def response(loop: StateSpace) -> Response:
    """Return w (k,) rad/s -> L (k,) of a scalar loop; exactly on a pole, L right beside it.

    Raises SignalError when the loop is not scalar.
    """
    if (len(loop.inputs), len(loop.outputs)) != (1, 1):
        raise SignalError(f"the loop has inputs {loop.inputs} and outputs {loop.outputs}: open it at one signal")
    time = loop.time

    def points(w: Array) -> Complex:
        return np.asarray(1j * w if isinstance(time, Continuous) else np.exp(1j * w * time.period_s))

    def L(frequencies: ArrayLike) -> Complex:
        w = np.atleast_1d(np.asarray(frequencies, dtype=np.float64))
        try:
            return loop.response(points(w))[:, 0, 0]
        except np.linalg.LinAlgError:
            return loop.response(points(w * (1 + 1e-14)))[:, 0, 0]

    return L


def _closed_poles(loop: StateSpace) -> Complex:
    D = float(loop.D[0, 0])
    if D == -1:
        raise ModelError("the loop passes its input straight on with the factor -1: 1 + L has no inverse; delay it")
    return np.linalg.eigvals(loop.A - loop.B @ loop.C / (1 + D)).astype(np.complex128)


def _grid(loop: StateSpace, closed: Complex, low: float | None, high: float | None) -> Array:
    """Return frequencies from low to high, denser around each lightly damped pole of L and of the closed loop."""
    poles = np.linalg.eigvals(loop.A).astype(np.complex128)
    if isinstance(loop.time, Continuous):
        size = np.abs(np.concatenate([poles, closed]))
        top, bottom = high or 1e3 * float(size.max(initial=1.0)), 1e-9 * float(size.max(initial=1.0))
    else:
        top, bottom = np.pi / loop.time.period_s * (1 - 1e-9), 1e-6 / loop.time.period_s
        poles, closed = (np.log(p[p != 0]) / loop.time.period_s for p in (poles, closed))
    start = low or float(np.clip(1e-2 * np.abs(closed).min(initial=1.0), min(bottom, 1e-2), 1e-2))
    points = [np.geomspace(start, top, 400)]
    for s in np.concatenate([poles, closed]):
        if abs(s.imag) > start:
            width = max(abs(s.real), 1e-6 * abs(s.imag))
            points.append(abs(s.imag) + width * np.linspace(-4, 4, 32))
    w = np.unique(np.concatenate(points))
    w = w[(w >= start) & (w <= top)]
    # Both poles of a pair seed the same nodes but for the last bit; a bracket between such twins would hold no peak.
    return w[np.append(np.diff(w) > 1e-8 * w[1:], True)]


def _ends(loop: StateSpace) -> dict[float, float]:
    """Return L at w = 0 and at Nyquist or infinity, where it is real, unless it has a pole there."""
    if isinstance(loop.time, Continuous):
        return _real(loop, {0.0: 0.0}) | {np.inf: float(loop.D[0, 0])}
    return _real(loop, {0.0: 1.0, np.pi / loop.time.period_s: -1.0})


def _real(loop: StateSpace, points: dict[float, float]) -> dict[float, float]:
    found = {}
    for w, v in points.items():
        sigma = np.linalg.svd(v * np.eye(len(loop.A)) - loop.A, compute_uv=False)
        if sigma.size == 0 or sigma[-1] > 1e-12 * sigma[0]:
            found[w] = float(loop.response(v)[0, 0, 0].real)
    return found


def _refined(L: Response, w: Array) -> tuple[Array, Complex]:
    """Halve each interval over which log L or log(1 + L) turns or grows by more than a little."""
    value = L(w)
    for _ in range(12):
        wide = (_step(value) > 0.15) | (_step(1 + value) > 0.15)
        wide &= np.diff(w) > 1e-9 * w[1:]
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
    return np.hypot(np.diff(_log(value)), (turn + np.pi) % (2 * np.pi) - np.pi)


def _log(value: Complex) -> Array:
    return np.log(np.maximum(np.abs(value), 1e-300))


def _roots(f: Callable[[float], NDArray[np.float64]], w: Array, value: Array) -> list[float]:
    """Return where f is zero, from its `value` on w; of a stretch of zeros the first point."""
    signs = np.sign(value)
    found = [float(w[k]) for k in np.flatnonzero(signs == 0) if k == 0 or signs[k - 1] != 0]
    for k in np.flatnonzero(signs[:-1] * signs[1:] < 0):
        found.append(float(brentq(lambda v: float(np.ravel(f(v))[0]), w[k], w[k + 1], xtol=1e-12 * w[k], rtol=1e-13)))
    return sorted(found)


def _gain_crossing(L: Response, frequency: float) -> GainCrossing:
    above = float(np.angle(-L(frequency)[0]))
    return GainCrossing(frequency, float(np.degrees(above)), (above % (2 * np.pi)) / frequency)


def _peak(L: Response, w: Array, value: Complex, ends: dict[float, float]) -> tuple[float, float]:
    """Return the largest 1/|1 + L| and its frequency."""
    distance = np.abs(1 + value)
    candidates = [(abs(1 + v), f) for f, v in ends.items()] + [(float(distance.min()), float(w[distance.argmin()]))]
    falling = np.flatnonzero((distance[1:-1] <= distance[:-2]) & (distance[1:-1] <= distance[2:])) + 1
    for k in falling[distance[falling] < 1.5 * distance.min()]:
        a, h = w[k - 1], w[k + 1] - w[k - 1]  # searched in units of the bracket, which may be far narrower than w
        found = minimize_scalar(
            lambda t, a=a, h=h: abs(1 + L(a + h * t)[0]), bounds=(0, 1), method="bounded", options={"xatol": 1e-9}
        )
        candidates.append((float(found.fun), float(a + h * found.x)))
    least, where = min(candidates)
    return (1 / least if least > 0 else np.inf), where


def _stable(loop: StateSpace, closed: Complex) -> bool:
    """Tell whether all closed-loop poles decay, by more than the rounding error of A."""
    if isinstance(loop.time, Continuous):
        return bool((closed.real < -1e-14 * np.abs(closed).max(initial=0.0)).all())
    return bool((np.abs(closed) < 1 - 1e-14).all())
