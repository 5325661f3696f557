"""Margins of a scalar loop.

         r -->(+)--> [ L ] --+--> y         1 + L = 0 is the closed loop; S = 1/(1 + L), T = L/(1 + L)
               ^-            |
               |-------------+

    gain crossing    |L| = 1:       phase margin arg(-L), delay margin (arg(-L) mod 2 pi) / w
    phase crossing   L < 0, real:   gain margin 1/|L|: above 1 the gain may rise by it, below 1 it may fall to it
    modulus margin   min |1 + L|,   the inverse of the peak sensitivity Ms

A sampled loop is taken on z = exp(i w T) up to w = pi/T, exactly; its hold and delays are part of its model. The grid
is refined until neighbours differ little, and each crossing and the peak are then found by bracketing, so that no grid
decides.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.optimize import brentq, minimize_scalar

from synth.errors import SignalError
from synth.statespace import Array, StateSpace
from synth.timing import Continuous

Complex = NDArray[np.complex128]
Response = Callable[[ArrayLike], Complex]


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


def of_loop(loop: StateSpace, low: float = 1e-2, high: float | None = None) -> Margins:
    """Return the margins of a scalar loop between `low` and `high` rad/s; a sampled loop goes up to Nyquist.

    Raises SignalError when the loop has another count of inputs or outputs than one.
    """
    L = response(loop)
    w, value = _refined(L, _grid(loop, low, high))
    gains = [_gain_crossing(L, f) for f in _roots(lambda v: np.log(np.abs(L(v))), w, np.log(np.abs(value)))]
    phases = _roots(lambda v: L(v).imag, w, value.imag)
    negative = [PhaseCrossing(f, float(-1 / L(f)[0].real)) for f in phases if L(f)[0].real < 0]
    if not isinstance(loop.time, Continuous) and value[-1].real < 0 and not np.isclose(w[-1], phases[-1:]).any():
        negative.append(PhaseCrossing(float(w[-1]), float(-1 / value[-1].real)))
    peak, where = _peak(L, w, 1 / np.abs(1 + value))
    return Margins(_stable(loop), tuple(gains), tuple(negative), peak, where)


def response(loop: StateSpace) -> Response:
    """Return w (k,) rad/s -> L (k,) of a scalar loop.

    Raises SignalError when the loop is not scalar.
    """
    if (len(loop.inputs), len(loop.outputs)) != (1, 1):
        raise SignalError(f"the loop has inputs {loop.inputs} and outputs {loop.outputs}: open it at one signal")
    time = loop.time

    def L(frequencies: ArrayLike) -> Complex:
        w = np.atleast_1d(np.asarray(frequencies, dtype=np.float64))
        point = 1j * w if isinstance(time, Continuous) else np.exp(1j * w * time.period_s)
        return loop.response(point)[:, 0, 0]

    return L


def _grid(loop: StateSpace, low: float, high: float | None) -> Array:
    """Return frequencies from low to high, denser around each lightly damped pole."""
    poles = np.linalg.eigvals(loop.A)
    if isinstance(loop.time, Continuous):
        top = high or 1e3 * max(1.0, float(np.abs(poles).max()))
    else:
        top = np.pi / loop.time.period_s
        with np.errstate(divide="ignore"):
            poles = np.log(poles[poles != 0].astype(complex)) / loop.time.period_s
    points = [np.geomspace(low, top, 400)]
    for pole in poles[np.abs(poles.imag) > low]:
        width = max(abs(pole.real), 1e-6 * abs(pole.imag))
        points.append(abs(pole.imag) + width * np.linspace(-4, 4, 33))
    w = np.unique(np.concatenate(points))
    return w[(w >= low) & (w <= top)]


def _refined(L: Response, w: Array) -> tuple[Array, Complex]:
    """Halve each interval over which log L turns or grows by more than a little."""
    value = L(w)
    for _ in range(12):
        with np.errstate(divide="ignore"):
            turn = np.diff(np.log(value))
        step = np.hypot(turn.real, (turn.imag + np.pi) % (2 * np.pi) - np.pi)
        wide = (step > 0.15) & (np.diff(w) > 1e-9 * w[1:])
        if not wide.any():
            break
        between = np.sqrt(w[:-1] * w[1:])[wide]
        order = np.argsort(np.concatenate([w, between]), kind="stable")
        value = np.concatenate([value, L(between)])[order]
        w = np.concatenate([w, between])[order]
    return w, value


def _roots(f: Callable[[float], NDArray[np.float64]], w: Array, value: Array) -> list[float]:
    signs = np.sign(value)
    found = [float(w[k]) for k in np.flatnonzero(signs == 0)]
    for k in np.flatnonzero(signs[:-1] * signs[1:] < 0):
        found.append(float(brentq(lambda v: float(np.ravel(f(v))[0]), w[k], w[k + 1], xtol=1e-12 * w[k], rtol=1e-13)))
    return sorted(found)


def _gain_crossing(L: Response, frequency: float) -> GainCrossing:
    above = float(np.angle(-L(frequency)[0]))
    return GainCrossing(frequency, float(np.degrees(above)), (above % (2 * np.pi)) / frequency)


def _peak(L: Response, w: Array, sensitivity: Array) -> tuple[float, float]:
    best = int(np.argmax(sensitivity))
    peak, where = float(sensitivity[best]), float(w[best])
    rising = np.flatnonzero((sensitivity[1:-1] >= sensitivity[:-2]) & (sensitivity[1:-1] >= sensitivity[2:])) + 1
    for k in rising[sensitivity[rising] > 0.9 * peak]:
        found = minimize_scalar(
            lambda v: abs(1 + L(v)[0]), bounds=(w[k - 1], w[k + 1]), method="bounded", options={"xatol": 1e-10 * w[k]}
        )
        if 1 / found.fun > peak:
            peak, where = float(1 / found.fun), float(found.x)
    return peak, where


def _stable(loop: StateSpace) -> bool:
    closed = loop.A - loop.B @ np.linalg.solve(np.eye(1) + loop.D, loop.C)
    poles = np.linalg.eigvals(closed)
    return bool((poles.real < 0).all() if isinstance(loop.time, Continuous) else (np.abs(poles) < 1).all())
