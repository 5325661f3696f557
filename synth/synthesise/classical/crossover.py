"""Lead-lag design for the crossover frequency and phase margin of a sampled loop.

    e --> [ K, sampled ] --> [ delay tau ] --> [ hold, plant, sampler ] --> y            L = P_d K_d, 1 + L = 0

    K(s) = k ((s + wi) / s) ((s + w / sqrt(r)) / (s + w sqrt(r)))^n

w is the crossover in rad/s, wi the corner of integral action (None for no integral action), n the number of sections.
Each section leads by asin((r - 1) / (r + 1)) at w, or lags for r < 1. P_d is exact and includes the hold and the delay,
also a fraction of a sample (`loop.sampled`). From P_d follow r and k for which the sampled K_d, with any discretisation
method, gives |L| = 1 and arg L = margin - 180 degrees at w to rounding error.

Library: no design uses it yet; docs/library.md has an example.
"""

from collections.abc import Callable

import numpy as np
from scipy.optimize import brentq

from synth import arguments, show
from synth.analyse import feedback_loop, loop, stability_margins, transfer
from synth.errors import ModelError, SignalError, TimingError
from synth.statespace import StateSpace, System, of
from synth.synthesise.classical import lead_lag
from synth.synthesise.classical.lead_lag import Compensator, LeadLag, Method
from synth.timing import Continuous, Discrete

MAX_LEAD = 65.0  # degrees per section: r = 20; beyond it gain and noise grow far faster than the lead


@show.result
class Design:
    """The compensator, the sampled plant with hold and delay, and their loop.

    `lead` is that of one section, in degrees; `crossover` in rad/s and `phase_margin` in degrees are the specification,
    `margins` and `closed` the result.
    """

    compensator: LeadLag
    plant: StateSpace
    closed: feedback_loop.ClosedLoop
    margins: stability_margins.Margins
    crossover: float
    phase_margin: float
    lead: float

    def sheet(self) -> show.Sheet:
        """Return the specification, the compensator and the margins."""
        parts = (self.compensator.sheet(), self.margins.sheet())
        hertz = show.number(self.crossover / (2 * np.pi))
        line = (
            f"asked: crossover {show.number(self.crossover)} rad/s ({hertz} Hz), phase margin "
            f"{show.number(self.phase_margin)} degrees; each section leads by {show.number(self.lead)} degrees"
        )
        lines = (line, *(text for part in parts for text in (part.title, *part.lines)))
        return show.Sheet("Lead-lag design", lines, tuple(table for part in parts for table in part.tables))


@arguments.checked
def design(
    plant: System,
    crossover: float,
    phase_margin: float,
    period_s: float,
    delay_s: float = 0.0,
    integral_corner: float | None = None,
    sections: int = 1,
    method: Method = lead_lag.prewarped,
    max_lead: float = MAX_LEAD,
) -> Design:
    """Return the lead-lag compensator of a continuous plant with one input and one output, at `period_s` and `delay_s`.

    `crossover` and `integral_corner` are in rad/s, `phase_margin` and `max_lead`, the largest lead or lag of one
    section, in degrees.

    Raises SignalError for a plant that is not scalar, a corner that is not below the crossover, or an impossible number
    of sections or angle; TimingError for a sampled plant, a negative delay or a crossover beyond Nyquist; ModelError
    when the sections cannot provide the phase, when a sampled pole is negative, or when the loop is not stable.
    """
    model = transfer.scalar(of(plant))
    _check_angles(phase_margin, sections, max_lead)
    _check_frequencies(integral_corner, crossover, np.pi / Discrete(period_s).period_s)
    sampled = loop.sampled(model, period_s, delay_s)

    def sampled_compensator(lead: float, gain: float = 1.0) -> LeadLag:
        compensator = method(_compensator(model, crossover, integral_corner, sections, lead, gain), period_s, crossover)
        if not isinstance(compensator, LeadLag):
            raise SignalError(
                f"the method returns {arguments.describe(compensator)}: give one of lead_lag, like prewarped"
            )
        return compensator

    flat, z = sampled_compensator(0.0).discrete, np.exp(1j * crossover * period_s)
    plant_response = complex(transfer.response(sampled)(crossover)[0])
    if abs(plant_response) == 0:
        raise ModelError(f"the sampled plant has a zero at {crossover:g} rad/s: ask for another crossover")
    required = np.exp(1j * np.radians(phase_margin - 180)) / plant_response
    flat_response = complex(flat.response(z)[0, 0, 0])
    required_lead = float(np.degrees(np.angle(required / flat_response)))

    def lead_of(lead: float) -> float:
        return float(np.degrees(np.angle(sampled_compensator(lead).discrete.response(z)[0, 0, 0] / flat_response)))

    lead = _solve_lead(
        lead_of,
        required_lead,
        max_lead,
        crossover,
        sections,
        _phase_lag(model, plant_response, crossover),
        phase_margin,
    )
    gain = abs(required) / abs(sampled_compensator(lead).discrete.response(z)[0, 0, 0])
    return _check_design(sampled_compensator(lead, gain), sampled, crossover, phase_margin, lead)


def _check_angles(phase_margin: float, sections: int, max_lead: float) -> None:
    if sections not in (1, 2):
        raise SignalError(f"{sections} sections were asked for: give 1 or 2")
    if not (0 < phase_margin < 180 and 0 < max_lead < 90):
        raise SignalError(
            f"the phase margin is {phase_margin:g} degrees and the most a section may lead {max_lead:g}: "
            "give a margin between 0 and 180 and a lead between 0 and 90"
        )


def _check_frequencies(corner: float | None, crossover: float, nyquist: float) -> None:
    if not 0 < crossover < nyquist:
        raise TimingError(
            f"the crossover is {crossover:g} rad/s, not between 0 and Nyquist, {nyquist:.6g} rad/s: lower it or give a "
            "shorter period"
        )
    if corner is not None and not 0 < corner < crossover:
        raise SignalError(
            f"the integral corner is {corner:g} rad/s: it must lie above 0 and below the crossover, {crossover:g} "
            "rad/s; a tenth of it costs 5.7 degrees"
        )


def _compensator(
    plant: StateSpace, w: float, corner: float | None, sections: int, lead: float, gain: float
) -> Compensator:
    """Return K with sections that lead by `lead` degrees each at w."""
    root = np.tan(np.radians(45 + lead / 2))  # the root of r = (1 + sin) / (1 - sin)
    zeros, poles = [-w / root] * sections, [-w * root] * sections
    if corner is not None:
        zeros, poles = [*zeros, -corner], [*poles, 0.0]
    (e,), (u,) = plant.outputs, plant.inputs
    units = {f"{e}_error": plant.unit(e), f"{u}_command": plant.unit(u)}
    known = {name: unit for name, unit in units.items() if unit}
    at = (float(gain), tuple(map(float, zeros)), tuple(map(float, poles)))
    return Compensator(*at, Continuous(), f"{e}_error", f"{u}_command", known)


def _phase_lag(plant: StateSpace, sampled: complex, w: float) -> float:
    """Return the phase lag of hold and delay at w in degrees."""
    return float(np.degrees(np.angle(transfer.response(plant)(w)[0] / sampled)))


def _solve_lead(
    lead_of: Callable[[float], float],
    required_lead: float,
    limit: float,
    crossover: float,
    sections: int,
    lag: float,
    margin: float,
) -> float:
    """Return the lead of one section, in degrees, for a total lead of `required_lead`."""
    low, high = lead_of(-limit), lead_of(limit)
    if not low <= required_lead <= high:
        remedy = "lower the crossover, shorten the delay or the period, or ask for less margin"
        remedy = f"use two sections, {remedy}" if sections == 1 and required_lead > 0 else remedy
        raise ModelError(
            f"a phase margin of {margin:g} degrees at {crossover:g} rad/s needs {required_lead:.4g} degrees of lead, "
            f"but {sections} section{'s' if sections > 1 else ''} of at most {limit:g} degrees give {low:.4g} to "
            f"{high:.4g}; hold and delay take {lag:.4g}: {remedy}; if that is far off, change the sign of the plant"
        )
    return float(brentq(lambda v: lead_of(v) - required_lead, -limit, limit, xtol=1e-13, rtol=1e-14))


def _check_design(
    compensator: LeadLag, plant: StateSpace, crossover: float, phase_margin: float, lead: float
) -> Design:
    """Return the design with its margins; raise ModelError when it has a negative pole or is not stable."""
    least = min(p.real for p in compensator.poles)
    if least < 0:
        raise ModelError(
            f"the lead's pole at {-min(compensator.continuous.poles):.4g} rad/s becomes z = {least:.3g}, which "
            "alternates from sample to sample: use a shorter period, a lower crossover or two sections"
        )
    closed = feedback_loop.close(plant, compensator.discrete)
    loop_margins = stability_margins.of_loop(closed.L)
    if not closed.stable:
        worst, others = max(closed.poles, key=abs), ", ".join(f"{c.frequency:.4g}" for c in loop_margins.gain_crossings)
        raise ModelError(
            f"the loop crosses {crossover:g} rad/s with {phase_margin:g} degrees but is not stable: it has the pole "
            f"z = {worst:.4g} and |L| = 1 at {others} rad/s: filter the loop beyond the crossover, or raise the "
            "crossover above the plant's unstable poles"
        )
    return Design(compensator, plant, closed, loop_margins, crossover, phase_margin, lead)
