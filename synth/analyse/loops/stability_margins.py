"""Gain, phase, delay and modulus margins of a scalar loop (MATLAB `allmargin`, python-control `stability_margins`).

         r -->(+)--> [ L ] --+--> y         1 + L = 0: characteristic equation; S = 1/(1 + L), T = L/(1 + L)
               ^-            |
               |-------------+

    gain crossing    |L| = 1:       phase margin arg(-L), delay margin (arg(-L) mod 2 pi) / w
    phase crossing   L < 0, real:   gain margin 1/|L|: the factor by which the gain may increase (> 1) or decrease
    modulus margin   min |1 + L|,   the inverse of the peak sensitivity Ms

A sampled loop is evaluated exactly, on z = exp(i w T) up to w = pi/T. Its hold and delays are part of its model. Its
delay margin is exact for whole samples (for others, close the loop on `loop.sampled`). A continuous loop may have an
exact delay and hold (`transfer.with_delay_and_hold`). L is real at w = 0 and at pi/T or infinity, and a phase crossing
may lie there. A continuous loop with |L| >= 1 at infinity tolerates no delay: its delay margin is 0.

Method. Up to EXACT_STATES states, a loop is an exact ratio of two polynomials, and `crossings` isolates every crossing.
With a delay, `crossings` encloses L between frequencies. Above EXACT_STATES, `grid_crossings` traces L on a
refined grid in double precision. Each margin is then verified independently: the closed loop must have the same number
of unstable poles at 99 % of the margin, in log gain or in angle, as without it. An unverified margin raises an error,
and so does a margin that rounding of the loop's coefficients changes by more than MAX_UNCERTAINTY.

Nyquist stability criterion: the number of unstable closed-loop poles of a delayed loop.

With the poles p of the rational factor of L (`transfer`), a factor k and any a > 0,

    g(s) = (1 + k L(s)) prod (s - p) / (s + a)

has no pole in the closed right half-plane. By the argument principle, its number of zeros there is -1 / (2 pi) times
the phase of g accumulated along the axis from -i inf to i inf. The open-loop poles p are all included, also those on
the axis and those that cancel in L. For w < 0, g(i w) is the conjugate of g(-i w) with the conjugate of k.

Assessment of a loop for its margins: its crossings, and two independent checks of them.

The first check counts the unstable poles of the closed loop after the loop is multiplied by a complex factor. The
second bounds the change that rounding of the loop's coefficients can cause. A rational loop is a ratio of polynomials
and a delayed loop is a sum of logarithms; both are computed without rounding. A loop of many states is traced in
double precision.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

import numpy as np

from synth import arguments, show
from synth.analyse.loops import crossings, disk, grid_crossings, transfer, zpk
from synth.analyse.loops.crossings import Crossing, Crossings
from synth.analyse.loops.disk import Perturbation
from synth.analyse.loops.transfer import Delayed, Loop, Response
from synth.analyse.numerics import precise
from synth.base import cache
from synth.errors import ModelError
from synth.statespace import StateSpace, System
from synth.timing import Continuous

RESOLVED_RETURN_DIFFERENCE = 1e-8  # of |1 + L|: below it rounding hides on which side of -1 the loop passes


def count_unstable_poles(
    loop: Delayed, factor: complex = 1.0, high: float | None = None, L: Response | None = None
) -> float:
    """Return the number of unstable poles of the loop closed on `factor` L.

    With a delay, |D| >= 1 and no hold the number is inf: infinitely many poles are unstable or approach the axis. The
    loop is traced up to `high` rad/s, with the default of `trace`; `L` is its response, if already available.

    Raises ModelError if rounding hides the number.
    """
    size, model = abs(factor), loop.model
    if loop.delay_s and not loop.hold_s and size * abs(float(model.D[0, 0])) >= 1:
        return np.inf
    scaled = replace(loop, model=replace(model, C=size * model.C, D=size * model.D))
    value = L or transfer.response(loop)
    curve = transfer.trace(scaled, None, high, lambda w: size * value(w))
    above = _phase_change(model, curve, factor / size)
    below = above if np.isreal(factor) else _phase_change(model, curve, np.conj(factor) / size)
    (_, first, _), (_, second, _) = above, below
    phase = sum(inside + after for inside, _, after in (above, below)) + float(np.angle(np.exp(1j * (first + second))))
    count = -phase / (2 * np.pi)
    if abs(count - round(count)) > 0.1:
        raise ModelError(
            f"the delayed loop turns {-count:.3g} times around -1, not a whole number: give a lower `low` and a higher "
            "`high`"
        )
    return round(count)


def _phase_change(model: StateSpace, curve: transfer.Curve, factor: complex) -> tuple[float, float, float]:
    """Return the phase of g accumulated over the curve, its angle at the start, and its phase from the end to infinity.

    The half for w < 0 is the conjugate of that for the conjugate factor, and both meet at w = 0.
    """
    w, value = precise.refine(lambda v: factor * curve.L(v), curve.w, factor * curve.value)
    least = int(np.abs(1 + value).argmin())
    if abs(1 + value[least]) < RESOLVED_RETURN_DIFFERENCE:
        raise ModelError(
            f"|1 + L| is {abs(1 + value[least]):.0e} at {w[least]:.6g} rad/s: rounding hides whether the "
            "delayed loop is stable; change its gain or its delay a little"
        )
    s, poles = 1j * w, model.poles
    scale = float(np.exp(np.log(w[[0, -1]]).mean()))
    factors = [(s - p) / (s + (abs(p) if abs(p) > w[0] else scale)) for p in poles]
    g = (1 + value) * np.prod([np.ones(len(s)), *factors], axis=0)
    steps = np.diff(np.angle(g))
    inside = float(((steps + np.pi) % (2 * np.pi) - np.pi).sum())
    after = -float(np.angle(1 + value[-1]) + sum(np.angle(f[-1]) for f in factors))  # all tend to 1
    return inside, float(np.angle(g[0])), after


@dataclass(frozen=True, eq=False)
class Assessment:
    """The crossings of a loop, whether it is stable, and the two checks of the crossings.

    `is_complete` is true if the range of frequency excludes no crossing. `count_unstable` takes a factor on the loop,
    `disk` takes a frequency in rad/s.
    """

    crossings: Crossings
    stable: bool
    is_complete: bool
    count_unstable: Callable[[complex], float]
    perturbation: Callable[[float], Perturbation]


def of_rational(system: System, low: float | None, high: float | None) -> Assessment:
    """Return the assessment of a scalar System from its numerator and denominator polynomials."""
    loop = zpk.of_system(system)
    if loop.model.D[0, 0] == -1:
        raise ModelError(transfer.ILL_POSED)
    bottom, top = low or 0.0, (high if isinstance(loop.time, Continuous) else None) or np.inf
    return Assessment(
        crossings.of_rational(loop, bottom, top),
        disk.is_stable(loop),
        bottom == 0 and np.isinf(top),
        lambda factor: zpk.count_unstable(loop, factor),
        lambda w: disk.of_rational(loop, w),
    )


def of_delayed_loop(loop: Delayed, low: float | None, high: float | None) -> Assessment:
    """Return the assessment of a loop with an exact delay and hold."""
    model = zpk.of_system(loop.model)
    L = None if model.N.is_zero() else crossings.zero_pole_gain(loop, model).value

    def count_unstable(factor: complex) -> float:
        return count_unstable_poles(loop, factor, high, L)

    def sensitivity_to_rounding(w: float) -> Perturbation:
        of_loop = disk.of_rational(model, w).of_loop
        value = abs(L(w)[0]) / abs(1 + L(w)[0]) if L and np.isfinite(w) else 1.0
        return Perturbation(of_loop, of_loop * float(value))

    return Assessment(
        crossings.of_delayed_loop(loop, model, low, high),
        count_unstable(1.0) == 0,
        low is None and high is None,
        count_unstable,
        sensitivity_to_rounding,
    )


def of_many_states(loop: StateSpace | Delayed, low: float | None, high: float | None) -> Assessment:
    """Return the assessment of a loop of many states, traced in double precision."""
    model = loop.model if isinstance(loop, Delayed) else loop

    def count_unstable(factor: complex) -> float:
        if isinstance(loop, Delayed):
            return count_unstable_poles(loop, factor, high)
        return int(transfer.not_decaying(transfer.closed_loop_poles(loop, factor), loop.time).sum())

    return Assessment(
        grid_crossings.of_curve(transfer.trace(loop, low, high)),
        count_unstable(1.0) == 0,
        low is None and (high is None or not isinstance(model.time, Continuous)),
        count_unstable,
        lambda w: disk.of_model(model, w),
    )


__all__ = ["GainCrossing", "Margins", "PhaseCrossing", "of_loop", "response"]

EXACT_STATES = 50  # up to which a loop is a ratio of polynomials: their cost grows with the fourth power
LOOP_ROUNDING = 1e-12  # |L| below it, or above its inverse, is rounding error: no crossing is reported
MAX_UNCERTAINTY = 0.2  # of |L|: a larger uncertainty from rounding of the coefficients is an error
CHECKED_FACTOR = 1e6  # the uncertainty of a gain factor beyond it, or below its inverse, is not checked
SHOWN_UNCERTAINTY = 1e-4  # a larger uncertainty is reported
MIN_RETURN_DIFFERENCE = 1e-9  # of |1 + L|: a loop this close to oscillation has no margin to verify
VERIFIED_FRACTION = 0.99  # of a margin: the closed loop must have as many unstable poles there as without it
MAX_GAIN_FACTOR = 100.0  # margins are verified for gain factors between its inverse and it

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


@show.with_repr
@dataclass(frozen=True, repr=False)
class Margins:
    """All crossings of a loop, and its margins; Ms is at `peak_frequency` rad/s.

    `stable` follows from the closed-loop poles, or from the number of unstable ones if a delay makes infinitely many.
    `direct` is |L| at infinity, 0 for a sampled loop. `uncertainty` is the relative change of |L|, or of |1 + L|, that
    rounding of the coefficients can cause at the crossings that decide the margins.
    """

    stable: bool
    gain_crossings: tuple[GainCrossing, ...]
    phase_crossings: tuple[PhaseCrossing, ...]
    peak_sensitivity: float
    peak_frequency: float
    direct: float = 0.0
    uncertainty: float = 0.0

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
        """The least delay in s that makes the loop oscillate: inf without a gain crossing, 0 if `direct` >= 1."""
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
        """Return the margins, then each crossing."""
        lines = (
            () if self.stable else ("Not stable: the values below are distances to the stability limit, not margins.",)
        )
        if self.direct >= 1:
            lines = (*lines, f"Delay margin 0: |L| is {self.direct:.4g} at infinity, any delay destabilises it.")
        if self.uncertainty > SHOWN_UNCERTAINTY:
            percent = f"{100 * self.uncertainty:.2g} %"
            lines = (*lines, f"Rounding of the coefficients makes the margins uncertain by up to {percent}.")
        worst = (
            ("gain may rise by", show.number(self.gain_margin), "1"),
            ("gain may fall to", show.number(self.gain_reduction_margin), "1"),
            ("phase margin", show.number(self.phase_margin), "degrees"),
            ("delay margin", show.number(self.delay_margin), "s"),
            ("modulus margin", show.number(self.modulus_margin), "1"),
            ("peak sensitivity", show.number(self.peak_sensitivity), f"at {_frequency_text(self.peak_frequency)}"),
        )
        gains = [
            (*_pair(c.frequency), show.number(c.phase_margin), show.number(c.delay_margin)) for c in self.gain_crossings
        ]
        phases = [(*_pair(c.frequency), show.number(c.gain_margin)) for c in self.phase_crossings]
        tables = [show.Table("", ("margin", "value", "unit"), worst)]
        if gains:
            columns = ("|L| = 1 at [rad/s]", "[Hz]", "phase margin [degrees]", "delay margin [s]")
            tables.append(show.Table("", columns, tuple(gains)))
        if phases:
            tables.append(show.Table("", ("L < 0 at [rad/s]", "[Hz]", "gain margin"), tuple(phases)))
        return show.Sheet(f"Margins of a {'stable' if self.stable else 'NOT STABLE'} loop", lines, tuple(tables))


def _pair(frequency: float) -> tuple[str, str]:
    return show.number(frequency), show.number(frequency / (2 * np.pi))


def _frequency_text(frequency: float) -> str:
    return "{} rad/s, {} Hz".format(*_pair(frequency))


@arguments.checked
@cache.cached
def of_loop(loop: Loop, low: float | None = None, high: float | None = None) -> Margins:
    """Return the margins of a scalar loop between `low` and `high` rad/s, and at 0 and infinity or Nyquist.

    The default is all frequencies; a sampled loop always extends to Nyquist. A delayed loop has infinitely many phase
    crossings: they are returned up to the last one that can decide a margin, and for at least two turns of the delay.

    Raises SignalError when the loop does not have one input and one output, or for limits that are not 0 < low < high;
    ModelError when 1 + L has no inverse, when rounding of the coefficients hides a margin or the stability of the loop,
    or when a margin fails its verification.
    """
    transfer.check_limits(low, high)
    model = transfer.of_loop(loop)
    states = (model.model if isinstance(model, Delayed) else model).states
    if len(states) > EXACT_STATES:
        return _from_assessment(of_many_states(model, low, high))
    if isinstance(model, Delayed) and (model.delay_s or model.hold_s):
        return _from_assessment(of_delayed_loop(model, low, high))
    return _from_assessment(of_rational(model.model if isinstance(model, Delayed) else loop, low, high))


def _from_assessment(loop: Assessment) -> Margins:
    """Return the verified margins of a loop; raise ModelError if they are undetermined or fail the verification."""
    crossings, direct = loop.crossings, abs(loop.crossings.ends.get(np.inf, 0.0))
    gains = tuple(_gain_crossing(c) for c in crossings.gain_crossings)
    ends = [Crossing(w, complex(v)) for w, v in crossings.ends.items() if v < 0]
    negative = sorted((*crossings.phase_crossings, *ends), key=lambda c: c.frequency)
    phases = tuple(
        PhaseCrossing(c.frequency, -1 / c.L.real) for c in negative if LOOP_ROUNDING < -c.L.real < 1 / LOOP_ROUNDING
    )
    margins = Margins(loop.stable, gains, phases, crossings.peak, crossings.peak_frequency, direct)
    uncertainty = max([0.0, *(_uncertainty(loop, name, w) for name, w in _deciding_frequencies(margins))])
    if loop.is_complete:
        _verify(loop, margins)
    return replace(margins, uncertainty=uncertainty)


def _gain_crossing(crossing: Crossing) -> GainCrossing:
    above, w = float(np.angle(-crossing.L)), crossing.frequency
    return GainCrossing(w, float(np.degrees(above)), (above % (2 * np.pi)) / w if w else np.inf)


def _deciding_frequencies(margins: Margins) -> Iterator[tuple[str, float]]:
    """Yield each margin that a crossing or the peak decides, with its frequency."""
    if margins.gain_crossings:
        yield "phase margin", min(margins.gain_crossings, key=lambda c: abs(c.phase_margin)).frequency
        yield "delay margin", min(margins.gain_crossings, key=lambda c: c.delay_margin).frequency
    factors = {"gain margin": margins.gain_margin, "gain reduction margin": margins.gain_reduction_margin}
    for name, factor in factors.items():
        if 1 / CHECKED_FACTOR < factor < CHECKED_FACTOR:
            yield name, next(c.frequency for c in margins.phase_crossings if c.gain_margin == factor)
    yield "modulus margin", margins.peak_frequency


def _uncertainty(loop: Assessment, name: str, frequency: float) -> float:
    """Return the effect of rounding at the frequency that decides a margin; raise ModelError if it is too large."""
    change, is_modulus = loop.perturbation(frequency), name == "modulus margin"
    part = change.of_closed if is_modulus else change.of_loop
    if part > MAX_UNCERTAINTY and (loop.stable or not is_modulus):
        raise ModelError(
            f"the {name}, decided at {frequency:.6g} rad/s, is not determined by the coefficients: their rounding to "
            f"double alone may change {'1 + L' if is_modulus else 'L'} there by {100 * part:.3g} %; give the loop as a "
            "state-space model (loop.sampled), or sample it more slowly"
        )
    return part if np.isfinite(part) else 0.0


def _verify(loop: Assessment, margins: Margins) -> None:
    """Raise ModelError unless as many closed-loop poles are unstable within each margin as at the nominal loop."""
    nominal = loop.count_unstable(1.0)
    if np.isinf(nominal) or margins.modulus_margin < MIN_RETURN_DIFFERENCE:
        return
    for name, factor in _factors_inside(margins):
        count = loop.count_unstable(factor)
        if count != nominal:
            raise ModelError(
                f"the {name} fails its verification: the closed loop has {nominal} unstable poles, but {count} when "
                f"the loop is multiplied by {show.number(factor)}, within that margin; give the loop with fewer states "
                f"(up to {EXACT_STATES} are treated exactly)"
            )


def _factors_inside(margins: Margins) -> Iterator[tuple[str, complex]]:
    """Yield factors on the loop just within its margins."""
    yield "gain margin", min(margins.gain_margin**VERIFIED_FRACTION, MAX_GAIN_FACTOR)
    yield "gain reduction margin", max(margins.gain_reduction_margin**VERIFIED_FRACTION, 1 / MAX_GAIN_FACTOR)
    angles = [VERIFIED_FRACTION * margins.phase_margin] if margins.gain_crossings else [90.0, 180.0 * VERIFIED_FRACTION]
    for angle in angles:
        yield "phase margin", complex(np.exp(1j * np.radians(angle)))  # the conjugate factor has the conjugate poles
