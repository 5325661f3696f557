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
With a delay, `delayed_crossings` encloses L between frequencies. Above EXACT_STATES, `grid_crossings` traces L on a
refined grid in double precision. Each margin is then verified independently: the closed loop must have the same number
of unstable poles at 99 % of the margin, in log gain or in angle, as without it. An unverified margin raises an error,
and so does a margin that rounding of the loop's coefficients changes by more than MAX_UNCERTAINTY.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from synth import arguments, show
from synth.analyse.loops import assessment, transfer
from synth.analyse.loops.assessment import Assessment
from synth.analyse.loops.crossings import Crossing
from synth.analyse.loops.transfer import Delayed, Loop
from synth.base import cache
from synth.errors import ModelError

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
        tables = [show.Table(("margin", "value", "unit"), worst)]
        if gains:
            columns = ("|L| = 1 at [rad/s]", "[Hz]", "phase margin [degrees]", "delay margin [s]")
            tables.append(show.Table(columns, tuple(gains)))
        if phases:
            tables.append(show.Table(("L < 0 at [rad/s]", "[Hz]", "gain margin"), tuple(phases)))
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
        return _from_assessment(assessment.of_many_states(model, low, high))
    if isinstance(model, Delayed) and (model.delay_s or model.hold_s):
        return _from_assessment(assessment.of_delayed_loop(model, low, high))
    return _from_assessment(assessment.of_rational(model.model if isinstance(model, Delayed) else loop, low, high))


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
