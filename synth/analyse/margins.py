"""Margins of a scalar loop.

         r -->(+)--> [ L ] --+--> y         1 + L = 0 is the closed loop; S = 1/(1 + L), T = L/(1 + L)
               ^-            |
               |-------------+

    gain crossing    |L| = 1:       phase margin arg(-L), delay margin (arg(-L) mod 2 pi) / w
    phase crossing   L < 0, real:   gain margin 1/|L|: above 1 the gain may rise by it, below 1 it may fall to it
    modulus margin   min |1 + L|,   the inverse of the peak sensitivity Ms

A sampled loop is taken on z = exp(i w T) up to w = pi/T, exactly; its hold and delays are part of its model, and its
delay margin is exact for whole samples (for others, close the loop on `loop.sampled`). A continuous loop may have an
exact delay and hold (`transfer.delayed`). L is real at w = 0 and at pi/T or infinity, and a phase crossing may lie
there. A continuous loop with |L| >= 1 at infinity bears no delay at all: its delay margin is 0.

Between the nodes of `transfer.trace` each crossing and the peak are found by bracketing, and a pair of crossings inside
one interval by the turn between them. Where |L| = 1 or L < 0 over a whole stretch (an all-pass, an undamped loop), the
crossings told are the worst of the stretch.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq, minimize_scalar

from synth import arguments, show
from synth.analyse import transfer
from synth.analyse.transfer import Complex, Curve, Delayed, Loop, Response
from synth.statespace import Array, StateSpace

NOTHING = 1e-12  # |L| below it, or above its inverse, is rounding error and no crossing is reported
FLAT = 1e-10  # log |L| or sin(arg L) stays below it over neighbouring nodes only where it is 0 all along
NEAR = 0.3  # neighbours differ by half of it at most: a turn farther from 0 does not reach it

response = transfer.response


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


@show.printed
@dataclass(frozen=True, repr=False)
class Margins:
    """All crossings of a loop; Ms is at `peak_frequency` rad/s.

    `stable` is told from the poles of 1 + L, or their count where a delay leaves infinitely many; `direct` is |L| at
    infinity, 0 for a sampled loop.
    """

    stable: bool
    gain_crossings: tuple[GainCrossing, ...]
    phase_crossings: tuple[PhaseCrossing, ...]
    peak_sensitivity: float
    peak_frequency: float
    direct: float = 0.0

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
        """The least delay in s that makes the loop oscillate: inf without a gain crossing, 0 where `direct` >= 1."""
        return 0.0 if self.direct >= 1 else min((c.delay_margin for c in self.gain_crossings), default=np.inf)

    @property
    def gain_margin(self) -> float:
        """The smallest factor above 1 that makes the loop oscillate, inf without one."""
        return min((c.gain_margin for c in self.phase_crossings if c.gain_margin > 1), default=np.inf)

    @property
    def gain_reduction_margin(self) -> float:
        """The largest factor below 1 that makes the loop oscillate, 0 without one."""
        return max((c.gain_margin for c in self.phase_crossings if c.gain_margin <= 1), default=0.0)

    def sheet(self) -> show.Sheet:
        """Return the worst of all crossings, then each crossing."""
        lines = (
            () if self.stable else ("Not stable: what follows tells how far the loop is from its verge, not safety.",)
        )
        if self.direct >= 1:
            lines = (*lines, f"Delay margin 0: |L| is {self.direct:.4g} at infinity, where any delay turns it onto -1.")
        worst = (
            ("gain may rise by", show.number(self.gain_margin), "1"),
            ("gain may fall to", show.number(self.gain_reduction_margin), "1"),
            ("phase margin", show.number(self.phase_margin), "degrees"),
            ("delay margin", show.number(self.delay_margin), "s"),
            ("modulus margin", show.number(self.modulus_margin), "1"),
            ("peak sensitivity", show.number(self.peak_sensitivity), f"at {_both(self.peak_frequency)}"),
        )
        gains = [
            (*_pair(c.frequency), show.number(c.phase_margin), show.number(c.delay_margin)) for c in self.gain_crossings
        ]
        phases = [(*_pair(c.frequency), show.number(c.gain_margin)) for c in self.phase_crossings]
        tables = [show.Table(("margin", "value", "unit"), worst)]
        if gains:
            columns = ("|L| = 1 at [rad/s]", "[Hz]", "phase margin [degrees]", "delay margin [s]")
            tables.append(show.Table(columns, tuple(gains)))
        if phases:
            tables.append(show.Table(("L < 0 at [rad/s]", "[Hz]", "gain margin"), tuple(phases)))
        return show.Sheet(f"Margins of a {'stable' if self.stable else 'NOT STABLE'} loop", lines, tuple(tables))


def _pair(frequency: float) -> tuple[str, str]:
    return show.number(frequency), show.number(frequency / (2 * np.pi))


def _both(frequency: float) -> str:
    return "{} rad/s, {} Hz".format(*_pair(frequency))


@arguments.checked
def of_loop(loop: Loop, low: float | None = None, high: float | None = None) -> Margins:
    """Return the margins of a scalar loop between `low` and `high` rad/s, and where L is real at their far ends.

    Left out, `low` lies below and `high` above all poles of the open and the closed loop; a sampled loop always goes up
    to Nyquist. A delayed loop crosses L < 0 for ever: what is told goes on until |L| settles within 0.01, and for two
    turns of the delay at least.

    Raises SignalError when the loop has another count of inputs or outputs than one, or for limits that are not
    0 < low < high; ModelError when 1 + L has no inverse, or when rounding hides whether a delayed loop is stable.
    """
    found = transfer.read(loop)
    curve = transfer.trace(found, low, high)
    L, ends = curve.L, dict(curve.ends)
    unit = _unit(curve)
    gains = [_gain_crossing(L, f) for f in unit]
    at = {f: complex(L(f)[0]) for f in _real(curve, unit)}
    real = {f: v.real for f, v in at.items() if abs(v.imag) <= 1e-6 * abs(v)}  # else a pole, where L.imag jumps
    phases = [PhaseCrossing(f, -1 / v) for f, v in sorted((real | ends).items()) if NOTHING < -v < 1 / NOTHING]
    direct = abs(ends.get(np.inf, 0.0))
    return Margins(_stable(found, curve), tuple(gains), tuple(phases), *_peak(curve), direct)


def _unit(curve: Curve) -> list[float]:
    """Return where |L| = 1; of a stretch the worst for the phase and for a delay."""
    value, w = transfer.log(curve.value), curve.w
    found = [] if len(w) < 3 else _roots(lambda v: transfer.log(curve.L(v)), w, value)
    for run in _stretches(value):
        above = np.angle(-curve.value[run])
        found += [float(w[run][np.abs(above).argmin()]), float(w[run][(above % (2 * np.pi) / w[run]).argmin()])]
    return sorted(set(found))


def _real(curve: Curve, unit: list[float]) -> list[float]:
    """Return where L is real; of a stretch where |L| is 1, as at each of `unit`, or nearest to it."""

    def sine(v: Array | float) -> Array:
        return _sine(curve.L(v))

    value, w = _sine(curve.value), curve.w
    found = _roots(sine, w, value)
    for run in _stretches(value):
        inside = [f for f in unit if w[run][0] <= f <= w[run][-1]]
        found += inside or [float(w[run][np.abs(transfer.log(curve.value[run])).argmin()])]
    return sorted(set(found))


def _sine(value: Complex) -> Array:
    return np.asarray(value.imag / np.maximum(np.abs(value), 1e-300))


def _stretches(value: Array) -> list[slice]:
    """Return the runs of three or more nodes on which `value` is 0 but for rounding."""
    flat = np.concatenate([[False], np.abs(value) < FLAT, [False]])
    edges = np.flatnonzero(np.diff(flat.astype(int)))
    return [slice(a, b) for a, b in zip(edges[::2], edges[1::2], strict=True) if b - a >= 3]


def _roots(f: Callable[[float], NDArray[np.float64]], w: Array, value: Array) -> list[float]:
    """Return where f is zero, from its `value` on w, but for stretches of zeros."""
    w, value = _with_turns(f, w, value)
    signs = np.sign(value)
    for run in _stretches(value):
        signs[run] = np.nan
    found = [float(v) for v in w[signs == 0]]
    for k in np.flatnonzero(signs[:-1] * signs[1:] < 0):
        found.append(float(brentq(lambda v: float(np.ravel(f(v))[0]), w[k], w[k + 1], xtol=1e-12 * w[k], rtol=1e-13)))
    return sorted(found)


def _with_turns(f: Callable[[float], NDArray[np.float64]], w: Array, value: Array) -> tuple[Array, Array]:
    """Return the nodes and, where f turns between them beyond 0 and back, the point of the turn."""
    size, sign = np.abs(value), np.sign(value)
    turns = (size[1:-1] <= size[:-2]) & (size[1:-1] <= size[2:]) & (size[1:-1] < NEAR)
    turns &= size[1:-1] < 4 * (np.maximum(size[:-2], size[2:]) - size[1:-1])  # a smooth turn goes down by less
    turns &= w[2:] - w[:-2] > 16 * transfer.NARROW * w[2:]
    turns &= (sign[1:-1] == sign[:-2]) & (sign[1:-1] == sign[2:]) & (size[1:-1] > FLAT)
    for k in np.flatnonzero(turns) + 1:
        where, least = _least(_scaled(f, sign[k]), w[k - 1], w[k + 1])
        if least < 0:
            at = int(np.searchsorted(w, where))
            w, value = np.insert(w, at, where), np.insert(value, at, sign[k] * least)
            return _with_turns(f, w, value)
    return w, value


def _scaled(f: Callable[[float], NDArray[np.float64]], factor: float) -> Callable[[float], float]:
    return lambda v: factor * float(np.ravel(f(v))[0])


def _least(f: Callable[[float], float], a: float, b: float) -> tuple[float, float]:
    """Return where f is least in a bracket, which may be far narrower than a, and its value."""
    found = minimize_scalar(lambda t: f(a + (b - a) * t), bounds=(0, 1), method="bounded", options={"xatol": 1e-9})
    return float(a + (b - a) * found.x), float(found.fun)


def _gain_crossing(L: Response, frequency: float) -> GainCrossing:
    above = float(np.angle(-L(frequency)[0]))
    return GainCrossing(frequency, float(np.degrees(above)), (above % (2 * np.pi)) / frequency)


def _peak(curve: Curve) -> tuple[float, float]:
    """Return the largest 1/|1 + L| and its frequency."""
    w, distance = curve.w, np.abs(1 + curve.value)
    candidates = [(abs(1 + v), f) for f, v in curve.ends.items()] + [
        (float(distance.min()), float(w[distance.argmin()]))
    ]
    falling = np.flatnonzero((distance[1:-1] <= distance[:-2]) & (distance[1:-1] <= distance[2:])) + 1
    near = falling[distance[falling] < 1.2 * distance.min()]  # neighbours differ by less, and a flat S has many
    for k in near[np.argsort(distance[near], kind="stable")[:20]]:
        where, least = _least(lambda v: float(abs(1 + curve.L(v)[0])), w[k - 1], w[k + 1])
        candidates.append((least, where))
    least, where = min(candidates)
    return (1 / least if least > 0 else np.inf), where


def _stable(loop: StateSpace | Delayed, curve: Curve) -> bool:
    """Tell whether all closed-loop poles decay."""
    if isinstance(loop, Delayed):
        return transfer.count_unstable(loop, curve) == 0
    return transfer.decay(transfer.closed_poles(loop), loop.time)
