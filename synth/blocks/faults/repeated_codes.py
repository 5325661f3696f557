"""Repeated codes of converters: one channel is watched at a time, in the samples that are measured.

    n = N + 1   between two watches: n = N
    n = N       a watch begins: the code of channel i is stored, y = y_i(k), and n = N - 1
    n < N       n = n - 1 while y_i(k) = y, and i is frozen once n was 1; else n = N + 1, and another channel follows

So a channel is frozen at its N-th code in a row. A sound converter is watched for three samples, and for one more with
each code that it repeats by chance. Without that a frozen one of m is known after 3 (m - 1) + N + 1 measured samples.
The others are not examined any more. `screening` compares all channels at once, which takes a state for each of them.
The samples between two watches are left to slow estimates, so no sample has the cost of both.

A sound converter whose noise has a standard deviation of sigma codes, 1 or more, has N equal codes in a row with
probability (sqrt(2 pi) sigma)^(1 - N) / sqrt(N). Without noise, as in a simulation of ideal sensors, a body at rest is
indistinguishable from a frozen converter.

This is no Block: the one that decides whether a sample is measured has these states, and takes their next values there.
It passes the codes as the guard does.

Source: Gertler, "Fault Detection and Diagnosis in Engineering Systems", section 1.3 (limit and plausibility checks).
"""

from collections.abc import Sequence
from dataclasses import dataclass

import casadi as ca

from synth import arguments, numeric
from synth.block import Constant, Exprs, State
from synth.errors import SignalError
from synth.signals import Signal, dimension

MOST_REPEATS = 1000  # 1 s at 1 kHz: a machine must not move unseen for longer
WATCHED = 3  # samples for which a sound channel is watched
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
    _check(channels)
    first, last, n = channels[0], len(channels) - 1, numeric.whole("the number of repeats", repeats, 2, MOST_REPEATS)
    return [
        State(Signal("watch_channel", "1", 0, last, "index of the watched channel, from 0"), 0, True),
        State(
            Signal(LEFT, "1", 0, n + 1, "1 .. N: codes in a row that are still missing; N + 1 between two watches"),
            n + 1,
            True,
        ),
        State(Signal(FROZEN, "1", 0, last + 1, "number of the channel whose code repeats, from 1; 0: none"), 0, True),
        State(Signal("watch_code", first.unit, first.low, first.high, "of the watched channel, at first"), 0.0),
    ]


def watch(x: Exprs, codes: Sequence[ca.SX], repeats: int, goes_on: ca.SX, flag: ca.SX) -> Watch:
    """Return what follows from the codes of a measured sample, for N `repeats`.

    `x` has the states by name. No watch begins until it `goes_on`. A sample that shows a channel to be frozen sets the
    `flag`.
    """
    channel, left, frozen, last = x["watch_channel"], x[LEFT], x[FROZEN], len(codes) - 1
    code, stored = _select(channel, codes, 0), x["watch_code"]
    is_same, is_last = ca.fabs(code - stored) <= 0, left <= 1

    def by_phase(between: ca.SX | int, first: ca.SX | int, same: ca.SX | int, other: ca.SX | int) -> ca.SX:
        watched = ca.if_else(left >= repeats, first, ca.if_else(is_same, same, other))
        return ca.if_else(is_between(x, repeats), between, watched)

    begun = ca.if_else(goes_on, repeats, left)
    next = {
        "watch_channel": by_phase(channel, channel, channel, ca.if_else(channel >= 1, channel - 1, last)),
        LEFT: by_phase(begun, repeats - 1, ca.if_else(is_last, left, left - 1), repeats + 1),
        FROZEN: by_phase(frozen, frozen, ca.if_else(is_last, channel + 1, frozen), frozen),
        "watch_code": by_phase(stored, code, stored, stored),
    }
    return Watch(next, by_phase(flag, flag, ca.if_else(is_last, 1, flag), flag))


@arguments.checked
def longest(channels: int, repeats: int) -> int:
    """Return the measured samples after which one of so many channels is known to be frozen."""
    return WATCHED * (channels - 1) + repeats + 1


@arguments.checked
def numbers(channels: Sequence[Signal], repeats: int) -> list[Constant]:
    """Return the numbers that the C names, without 0 and 1."""
    counts = {
        "repeats": (repeats, "codes in a row with which a channel is frozen"),
        "code_stored": (repeats - 1, "repeats - 1: its first code is stored"),
        "between_watches": (repeats + 1, "repeats + 1: no code is compared"),
    }
    indices = (
        Constant(f"index_of_{s.name}", k, "1", "among the channels, from 0", ("channel",))
        for k, s in enumerate(channels)
        if k > 1
    )
    ordinals = (
        Constant(f"channel_{s.name}", k, "1", "among the channels, from 1", ("frozen",))
        for k, s in enumerate(channels, 1)
        if k > 1
    )
    return [*(Constant(name, n, "1", about, ("watch",)) for name, (n, about) in counts.items()), *indices, *ordinals]


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
