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

How the crossings are found. Up to EXACT_STATES states a loop is the ratio of two polynomials, exactly that of the
numbers given, and `crossings` isolates every crossing; with a delay `delayed_crossings` encloses L between frequencies.
Beyond, `traced_crossings` follows L on a refined grid in double precision. Each answer is then verified another way:
the closed loop has as many unstable poles at 99 % of a margin, in log gain or in angle, as at the loop itself. What is
not verified is refused, and so is what the rounding of the numbers given leaves open by more than DETERMINED.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

import numpy as np

from synth import arguments, show
from synth.analyse import crossings, delayed_crossings, nyquist, perturbation, rational, traced_crossings, transfer
from synth.analyse.crossings import Course, Crossing
from synth.analyse.perturbation import Perturbation
from synth.analyse.rational import Rational
from synth.analyse.transfer import Complex, Delayed, Loop
from synth.errors import ModelError
from synth.statespace import StateSpace
from synth.timing import Continuous

__all__ = ["Complex", "GainCrossing", "Margins", "PhaseCrossing", "of_loop", "response"]

EXACT_STATES = 60  # up to which a loop is taken as a ratio of polynomials: their cost grows with the fourth power
NOTHING = 1e-12  # |L| below it, or above its inverse, is rounding error and no crossing is reported
DETERMINED = 0.2  # of |L|: a margin that rounding of the numbers given leaves open by more is refused
FAR = 1e6  # a factor on the gain this far from 1 may be as uncertain as it likes
TOLD = 1e-4  # an uncertainty beyond it is told
VERGE = 1e-9  # of |1 + L|: a loop this near to oscillation has no margin to verify
INSIDE = 0.99  # of a margin: there the closed loop must have as many unstable poles as without it
OUTERMOST = 100.0  # factor on the gain up to which, and from whose inverse, a margin is verified

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
    infinity, 0 for a sampled loop. `uncertainty` is the part of |L|, or of |1 + L|, that rounding of the numbers given
    may change at the crossings which decide the margins.
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
        if self.uncertainty > TOLD:
            opened = f"{100 * self.uncertainty:.2g} %"
            lines = (*lines, f"Rounding of the numbers given leaves the margins uncertain by up to {opened}.")
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

    Left out, all frequencies count; a sampled loop always goes up to Nyquist. A delayed loop crosses L < 0 for ever:
    its crossings are given as far as they are worse than what follows, and for two turns of the delay at least.

    Raises SignalError when the loop has another count of inputs or outputs than one, or for limits that are not
    0 < low < high; ModelError when 1 + L has no inverse, when rounding of the numbers given hides a margin or whether
    the loop is stable, or when a margin fails its verification.
    """
    transfer.check_limits(low, high)
    found = transfer.read(loop)
    model = found.model if isinstance(found, Delayed) else found
    if len(model.states) > EXACT_STATES:
        return _verified(_traced(found, low, high))
    if isinstance(found, Delayed) and (found.delay_s or found.hold_s):
        return _verified(_delayed(found, low, high))
    loop = found.model if isinstance(found, Delayed) else loop
    return _verified(_rational(rational.of_system(loop), low, high))


@dataclass(frozen=True, eq=False)
class _Found:
    """The course of a loop, with two ways to judge it.

    `unstable` counts the closed loop's unstable poles when the loop is multiplied by a complex factor; `perturbation`
    tells what rounding of the numbers given may do at a frequency. `whole` says that no limit cut the course.
    """

    course: Course
    stable: bool
    whole: bool
    unstable: Callable[[complex], float]
    perturbation: Callable[[float], Perturbation]


def _rational(loop: Rational, low: float | None, high: float | None) -> _Found:
    continuous = isinstance(loop.time, Continuous)
    if loop.model.D[0, 0] == -1:
        raise ModelError(transfer.ILL_POSED)
    bottom, top = low or 0.0, (high if continuous else None) or np.inf
    course = crossings.of_rational(loop, bottom, top)
    whole = bottom == 0 and np.isinf(top)
    return _Found(
        course,
        perturbation.is_stable(loop),
        whole,
        lambda factor: rational.unstable(loop, factor),
        lambda w: perturbation.of_rational(loop, w),
    )


def _delayed(loop: Delayed, low: float | None, high: float | None) -> _Found:
    part = rational.of_system(loop.model)
    L = None if part.N.is_zero() else delayed_crossings.factored(loop, part).value

    def unstable(factor: complex) -> float:
        return nyquist.count_unstable(loop, factor, high, L)

    return _Found(
        delayed_crossings.of_delayed(loop, part, low, high),
        unstable(1.0) == 0,
        low is None and high is None,
        unstable,
        lambda w: perturbation.of_rational(part, w),
    )


def _traced(loop: StateSpace | Delayed, low: float | None, high: float | None) -> _Found:
    curve = transfer.trace(loop, low, high)
    model = loop.model if isinstance(loop, Delayed) else loop

    def unstable(factor: complex) -> float:
        if isinstance(loop, Delayed):
            return nyquist.count_unstable(loop, factor, high)
        return transfer.not_decaying(transfer.closed_poles(loop, factor), loop.time)

    return _Found(
        traced_crossings.of_curve(curve),
        unstable(1.0) == 0,
        low is None and (high is None or not isinstance(model.time, Continuous)),
        unstable,
        lambda w: perturbation.of_model(model, w),
    )


def _verified(found: _Found) -> Margins:
    """Return the margins of a course; raise ModelError when they are not determined or not verified."""
    course, direct = found.course, abs(found.course.ends.get(np.inf, 0.0))
    gains = tuple(_gain_crossing(c) for c in course.unit)
    ends = [Crossing(w, complex(v)) for w, v in course.ends.items() if v < 0]
    negative = sorted((*course.negative, *ends), key=lambda c: c.frequency)
    phases = tuple(PhaseCrossing(c.frequency, -1 / c.L.real) for c in negative if NOTHING < -c.L.real < 1 / NOTHING)
    told = Margins(found.stable, gains, phases, course.peak, course.peak_frequency, direct)
    uncertainty = max([0.0, *(_uncertainty(found, told, name, w) for name, w in _deciding(told))])
    if found.whole:
        _verify(found, told)
    return replace(told, uncertainty=uncertainty)


def _gain_crossing(crossing: Crossing) -> GainCrossing:
    above = float(np.angle(-crossing.L))
    return GainCrossing(crossing.frequency, float(np.degrees(above)), (above % (2 * np.pi)) / crossing.frequency)


def _deciding(told: Margins) -> Iterator[tuple[str, float]]:
    """Yield the margins that a crossing or the peak decides, with its frequency."""
    if told.gain_crossings:
        yield "phase margin", min(told.gain_crossings, key=lambda c: abs(c.phase_margin)).frequency
        yield "delay margin", min(told.gain_crossings, key=lambda c: c.delay_margin).frequency
    for name, margin in (("gain margin", told.gain_margin), ("gain reduction margin", told.gain_reduction_margin)):
        if 1 / FAR < margin < FAR:
            yield name, next(c.frequency for c in told.phase_crossings if c.gain_margin == margin)
    yield "modulus margin", told.peak_frequency


def _uncertainty(found: _Found, told: Margins, name: str, frequency: float) -> float:
    told_at = found.perturbation(frequency)
    size = told_at.of_closed if name == "modulus margin" else told_at.of_loop
    if size > DETERMINED and (found.stable or name != "modulus margin"):
        raise ModelError(
            f"the {name}, decided at {frequency:.6g} rad/s, is not determined by the numbers given: their rounding to "
            f"double alone may change {'1 + L' if name == 'modulus margin' else 'L'} there by {100 * size:.3g} %; give "
            "the loop as a state-space model (loop.sampled), or sample it more slowly"
        )
    return size if np.isfinite(size) else 0.0


def _verify(found: _Found, told: Margins) -> None:
    """Raise ModelError when another count of closed-loop poles is unstable within a margin than without it."""
    nominal = found.unstable(1.0)
    if np.isinf(nominal) or told.modulus_margin < VERGE:
        return
    for name, factor in _inside(told):
        count = found.unstable(factor)
        if count != nominal:
            raise ModelError(
                f"the {name} fails its verification: the closed loop has {nominal} unstable poles, but {count} when "
                f"the loop is multiplied by {show.number(factor)}, within that margin; give the loop with fewer states "
                f"(up to {EXACT_STATES} are treated exactly)"
            )


def _inside(told: Margins) -> Iterator[tuple[str, complex]]:
    """Yield factors on the loop just within its margins."""
    yield "gain margin", min(told.gain_margin**INSIDE, OUTERMOST)
    yield "gain reduction margin", max(told.gain_reduction_margin**INSIDE, 1 / OUTERMOST)
    angle = np.radians(INSIDE * told.phase_margin) if told.gain_crossings else np.pi / 2
    yield "phase margin", complex(np.exp(1j * angle))  # the conjugate factor has the conjugate poles
