"""Repeated codes of converters: one channel is watched at a time, in the samples that are measured.

    n = N + 1   between two watches: n = N
    n = N       a watch begins: the code of channel i is kept, y = y_i(k), and n = N - 1
    n < N       n = n - 1 while y_i(k) = y, and i is frozen once n was 1; else n = N + 1, and the next channel follows

So a channel is frozen at its N-th code in a row. A sound converter is watched for three samples, so that a frozen one
of m is found within 3 (m - 1) + N + 1 samples. `screening` compares all channels at once, which takes a state for each.
The samples between two watches are left to slow estimates, so no sample has the cost of both.

The noise of a sound converter, with a standard deviation sigma of a code or more, repeats a code N - 1 times in a row
with probability p^(N - 1), p = code / (2 sqrt(pi) sigma). Without noise, as in a simulation of ideal sensors, a body at
rest is indistinguishable from a frozen converter.

This is no Block: the one that decides whether a sample is measured has these states, and takes their next values there.
It passes the codes as they are read. What a guard passes on would have to be kept until then, which costs more than the
comparison. A code out of range is not kept, and NaN differs from every code.

Source: Gertler, "Fault Detection and Diagnosis in Engineering Systems", section 1.3 (limit and plausibility checks).
"""

from collections.abc import Sequence
from dataclasses import dataclass

import casadi as ca

from synth import arguments, numeric
from synth.block import Constant, Exprs, State
from synth.errors import SignalError
from synth.signals import Signal, dimension

MOST_REPEATS = 1000
LEFT, FROZEN = "watch_left", "frozen"


@dataclass(frozen=True)
class Watch:
    """The next states of a watch, and the flag that a frozen channel sets."""

    next: Exprs
    flag: ca.SX


@arguments.checked
def states(channels: Sequence[Signal], repeats: int) -> list[State]:
    """Return the states of a watch over channels with one range about 0; `repeats` is N.

    Raises SignalError for fewer than two channels, other ranges or units, ModelError for `repeats` out of 2 .. 1000.
    """
    first, last, n = channels[0], len(channels) - 1, numeric.whole("the number of repeats", repeats, 2, MOST_REPEATS)
    _check(channels)
    return [
        State(Signal("watch_channel", "1", 0, last, "number of the watched channel, from 0"), 0, True),
        State(Signal(LEFT, "1", 0, n + 1, "codes in a row that are still missing"), n + 1, True),
        State(Signal(FROZEN, "1", 0, last + 1, "number of the channel that repeats a code, 0 if none does"), 0, True),
        State(Signal("watch_code", first.unit, first.low, first.high, "of the watched channel, at first"), 0.0),
    ]


def watch(x: Exprs, codes: Sequence[ca.SX], repeats: int, largest: float, flag: ca.SX) -> Watch:
    """Return what follows from the codes of a measured sample, for N `repeats` and a range of +-`largest`.

    `x` has the states by name. A sample that finds a frozen channel sets the `flag`.
    """
    channel, left, found, last = x["watch_channel"], x[LEFT], x[FROZEN], len(codes) - 1
    code, kept = _select(channel, codes, 0), x["watch_code"]
    same, is_last = ca.fabs(code - kept) <= 0, left <= 1

    def by_case(between: ca.SX | int, begins: ca.SX | int, repeated: ca.SX | int, differs: ca.SX | int) -> ca.SX:
        watched = ca.if_else(left >= repeats, begins, ca.if_else(same, repeated, differs))
        return ca.if_else(is_between(x, repeats), between, watched)

    next = {
        "watch_channel": by_case(channel, channel, channel, ca.if_else(channel >= last, 0, channel + 1)),
        LEFT: by_case(repeats, repeats - 1, ca.if_else(is_last, left, left - 1), repeats + 1),
        FROZEN: by_case(found, found, ca.if_else(is_last, channel + 1, found), found),
        "watch_code": by_case(kept, ca.if_else(ca.fabs(code) <= largest, code, 0), kept, kept),
    }
    return Watch(next, by_case(flag, flag, ca.if_else(is_last, 1, flag), flag))


def numbers(channels: Sequence[Signal], repeats: int) -> list[Constant]:
    """Return the numbers that the C names, without 0 and 1."""
    counts = {
        "repeats": (repeats, "codes in a row with which a channel is frozen"),
        "code_kept": (repeats - 1, "repeats - 1: its first code is kept"),
        "between_watches": (repeats + 1, "repeats + 1: no code is compared"),
    }
    of_channels = (
        Constant(f"number_of_{s.name}", k, "1", "of the channels, from 0", ("channel",))
        for k, s in enumerate(channels)
        if k > 1
    )
    return [*(Constant(name, n, "1", about, ("watch",)) for name, (n, about) in counts.items()), *of_channels]


def is_between(x: Exprs, repeats: int) -> ca.SX:
    """Return whether no code is compared in a measured sample."""
    return x[LEFT] > repeats


def _select(number: ca.SX, values: Sequence[ca.SX], first: int) -> ca.SX:
    """Return the value with this number, by halves; the first value has the number `first`."""
    if len(values) == 1:
        return values[0]
    half = len(values) // 2
    upper, lower = _select(number, values[half:], first + half), _select(number, values[:half], first)
    return ca.if_else(number >= first + half, upper, lower)


def _check(channels: Sequence[Signal]) -> None:
    kinds = {(dimension(s.unit), s.low, s.high) for s in channels}
    if len(channels) < 2 or len(kinds) > 1 or channels[0].low != -channels[0].high:
        listed = ", ".join(f"{s.name} in {s.low:g} .. {s.high:g} {s.unit}" for s in channels)
        raise SignalError(f"repeated codes are watched of [{listed}]: give two channels or more with one range about 0")
