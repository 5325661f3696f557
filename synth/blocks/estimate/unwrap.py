"""Unwrapping of a reading that starts over after a span: absolute encoders, counters of 16 or 24 bits (`numpy.unwrap`).

    d_k = r_k - r_{k-1},    n_k = n_{k-1} + 1 for d_k < -span/2,  n_{k-1} - 1 for d_k > span/2,  else n_{k-1}
    position_k = r_k + span n_k

n counts whole turns as an integer, so nothing accumulates, however long the machine rotates. The count is right as long
as the machine moves less than half a span between two good samples, which the largest speed and the number of bad
samples before the latch decide at synthesis. A motion that is faster than that speed, or a turn beyond the range of the
position, leaves the count in doubt: ``<position>_lost`` is then 1 from the next sample on, until init.
"""

import math

import casadi as ca

from synth import arguments
from synth.block import Block, Constant, Exprs, State, Step, build, clip
from synth.errors import SignalError
from synth.law import label
from synth.signals import Signal, dimension
from synth.timing import Discrete

MOST_TURNS = 2**24  # whole numbers that single precision has
MARGIN = 1e-2  # of the reading's range, by which the range of its last value is wider
SLACK = 1e-3  # of the largest motion between two good samples, for rounding


@arguments.checked
def block(
    name: str, time: Discrete, reading: Signal, position: Signal, *, span: float, speed: float, bad_samples: int
) -> Block:
    """Return the Block from the `reading`, whose range is a span or less, to the `position` over its range.

    Further outputs are ``<position>_turns``, which stays exact where single precision has too few digits for the
    position, and ``<position>_lost``. `speed` is the largest of the machine in the reading's unit per second,
    `bad_samples` the number of the interface after which the controller latches, and more where calls may be missing.
    The guard must hold the reading while it is bad. At the first good sample, which the
    input ``ready`` of the guard follows, no turn is counted: the position is the reading.

    Raises SignalError for a position in another unit, whose range has not the reading's in it or has more than
    MOST_TURNS turns; for a span that is not positive or shorter than the reading's range; and for a speed that is not
    positive or moves the machine half a span or more in `bad_samples` periods.
    """
    low, high = _turns(reading, position, span)
    largest = speed * time.period_s * bad_samples * (1 + SLACK)
    if not (0 < largest < span / 2 and bad_samples >= 1):
        raise SignalError(
            f"'{reading.name}' moves up to {largest:g} {reading.unit} in {bad_samples} periods: at least one must be "
            f"given, and the motion be above 0 and below half a span, {span / 2:g} {reading.unit}, or a turn is "
            "miscounted; take a shorter period, fewer bad samples or a lower speed"
        )
    step = max(abs(position.low), abs(position.high)) * 2.0**-23
    unit, turns, lost = reading.unit, f"{position.name}_turns", f"{position.name}_lost"
    constants = [
        Constant("span", span, unit, "after which the reading starts over"),
        Constant("half_span", span / 2, unit, "a larger change is a new turn"),
        Constant("largest_change", largest, unit, "between two good samples, at the largest speed"),
        Constant("turns_below", -low, "1", "of the lowest position"),
    ]

    def law(u: Exprs, x: Exprs, k: Exprs) -> Step:
        d = ca.if_else(u["ready"], u[reading.name] - x["previous"], 0)
        up, down = d < -k["half_span"], d > k["half_span"]
        count = ca.if_else(
            up, ca.fmin(x["count"] + 1, high - low), ca.if_else(down, ca.fmax(x["count"], 1) - 1, x["count"])
        )
        change = d + k["span"] * (ca.if_else(up, 1, 0) - ca.if_else(down, 1, 0))
        beyond = ca.if_else(up, x["count"] >= high - low, ca.if_else(down, x["count"] <= 0, 0))
        too_fast = ca.fabs(change) > k["largest_change"]
        turn = count - k["turns_below"]
        label(d=d, up=up, down=down, count=count, change=change, beyond=beyond, too_fast=too_fast, turn=turn)
        return Step(
            {position.name: clip(u[reading.name] + k["span"] * turn, position), turns: turn, lost: x["lost"]},
            {
                "previous": u[reading.name],
                "count": count,
                "lost": ca.if_else(ca.logic_or(beyond, too_fast), 1, x["lost"]),
            },
        )

    # Readings at the ends of the range are ordinary here: a state of the law is then not at its bound.
    first, beside = min(max(0.0, reading.low), reading.high), MARGIN * (reading.high - reading.low)
    return build(
        name,
        time,
        law,
        inputs=[reading, Signal("ready", "1", 0, 1, "every measurement was good at once")],
        outputs=[
            Signal(position.name, unit, position.low, position.high, f"steps of {step:.2g} {unit} in single precision"),
            Signal(turns, "1", low, high, f"whole spans in {position.name}"),
            Signal(lost, "1", 0, 1, "a turn may have been miscounted"),
        ],
        states=[
            State(Signal("previous", unit, reading.low - beside, reading.high + beside, "reading a sample ago"), first),
            State(Signal("count", "1", 0, high - low, "turns from the lowest position on"), -low, integer=True),
            State(Signal("lost", "1", 0, 1, "a turn may have been miscounted"), 0, integer=True),
        ],
        constants=constants,
        tag=f"unwrapped {reading.name}",
    )


def _turns(reading: Signal, position: Signal, span: float) -> tuple[int, int]:
    """Return the least and the largest number of turns in the range of the position."""
    if dimension(reading.unit) != dimension(position.unit):
        raise SignalError(
            f"'{position.name}' is in {position.unit} and '{reading.name}' in {reading.unit}: give both one unit"
        )
    if not (math.isfinite(span) and 0 < reading.high - reading.low <= span):
        raise SignalError(
            f"'{reading.name}' has the range {reading.low:g} .. {reading.high:g} {reading.unit} and starts over after "
            f"{span:g}: give a span of at least the width of its range"
        )
    low, high = (math.floor((end - reading.low) / span) for end in (position.low, position.high))
    if not (position.low <= reading.low and reading.high <= position.high and high - low <= MOST_TURNS):
        raise SignalError(
            f"'{position.name}' has the range {position.low:g} .. {position.high:g} {position.unit}, {high - low + 1} "
            f"spans: give one that contains the reading's, {reading.low:g} .. {reading.high:g}, and {MOST_TURNS} spans "
            "at most"
        )
    return low, high
