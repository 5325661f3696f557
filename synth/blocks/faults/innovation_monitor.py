"""Innovation monitor of one sensor: it is refused, frozen, or jumps away from its prediction (fault detection, FDI).

    accepted reading y, expected reading y^ (prediction of an observer)  -->  reading to use, whether it is trusted

    refused   the guard refuses it: the prediction replaces it
    frozen    its code does not change for FRESH samples or more while its prediction, which agreed with it at the last
              DOUBTS changes, moves by more than `frozen`; or a `probe` says that its code did not answer
    jump      its innovation y - y^ is larger than `jump`, and y^ agreed with it at the last DOUBTS changes. The
              prediction replaces it at once. A jump is not looked for in a sample after missing calls, in which the
              body has moved on, nor where the prediction or the code before it is outside `travel`; a sensor that
              jumps is not frozen in the same sample

While a body accelerates hard, its prediction seldom agrees with it. No agreement is needed where |y - y^| has grown
since the last change of the code: by more than `wide_frozen` for a code that stands still, which is then frozen, and by
more than `wide_jump` for one that changes, which then jumps. A prediction that returns to its code, as after missing
calls, makes |y - y^| smaller.

A frozen sensor is excluded until init at once, one that jumps after `persistent` samples in a row. Once latched,
predictions stand still, and no jump is looked for any more.

Source: Isermann, *Fault-Diagnosis Systems*, chapter 11 (observers).

Repeated codes of converters: one channel is watched at a time, in the samples that are measured.

    n = N + 1   between two watches: n = N
    n = N       a watch begins: the code of channel i is stored, y = y_i(k), and n = N - 1
    n < N       n = n - 1 while y_i(k) = y, and i is frozen once n was 1; else n = N + 1, and another channel follows

So a channel is frozen at its N-th code in a row. A sound converter is watched for three samples, and for one more with
each code that it repeats by chance. Without that a frozen one of m is known after 3 (m - 1) + N + 1 measured samples.
The others are not examined any more. `glsdc_search.screen` compares all channels at once, which takes a
state for each of them. The samples between two watches are left to slow estimates, so no sample has the cost of both.

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
from synth.block import Block, Constant, Exprs, State, Step, build, clip
from synth.blocks.faults import redundancy_decision
from synth.blocks.faults.redundancy_decision import DOUBTS, FRESH, Decision
from synth.blocks.guard import safety
from synth.errors import SignalError
from synth.law import label
from synth.signals import Signal, dimension
from synth.timing import Discrete

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
    label(begun=begun, code=code)
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


__all__ = ["block"]

Value = ca.SX | int


@arguments.checked
def block(time: Discrete, sensor: Signal, decision: Decision, missed_calls: Signal | None = None) -> Block:
    """Return the Block of a sensor without a relation, between the guard and `redundancy`.

    For the sensor s it reads ``<s>_accepted``, ``fault_<s>``, ``ready`` and ``judging`` of the guard, ``sound`` of
    `redundancy`, and ``<s>_expected``; with a probe, ``<s>_unanswered``. Its outputs are ``<s>_held``, ``<s>_trusted``,
    ``<s>_frozen``, ``<s>_suspect`` and ``<s>_usual`` for `redundancy`, and ``<s>_unchanged``. `missed_calls` is the
    input that counts missing calls, if there is one.

    Raises SignalError for a sensor without a gate or a travel, or with a gate of jumps or a wide one below its gate.
    """
    n = sensor.name
    decision.require(n)
    gate, frozen, travel = decision.gate[n], decision.frozen_from(n), decision.travel[n]

    def law(u: Exprs, x: Exprs, k: Exprs) -> Step:
        y, expected, excluded, doubts = u[f"{n}_accepted"], u[f"{n}_expected"], x["excluded"], x["doubts"]
        same = y == x["code"]
        unchanged = redundancy_decision.count(same, x["still"], decision.longest(True))
        before = ca.if_else(u["ready"], ca.if_else(same, x["before"], expected), y)
        distance = ca.fabs(expected - y)
        growth = distance - ca.fabs(x["code"] - x["before"])
        grown = growth > decision.wide_jump[n] if n in decision.wide_jump else ca.SX(0)
        strayed = growth > decision.wide_frozen[n] if n in decision.wide_frozen else ca.SX(0)
        far, jumping, last = ca.SX(0), ca.SX(0), ca.SX(0)
        contradicts = ca.logic_and(ca.logic_or(doubts < 1, grown), _is_in_time(u, missed_calls))
        believed = _is_free(travel, (expected, x["code"]), contradicts)
        if n in decision.jump:
            far, last = distance > decision.jump[n], x["jumps"] >= decision.persistent - 1
            jumping = ca.if_else(far, ca.logic_or(x["jumps"] >= 1, ca.logic_and(believed, ca.logic_not(same))), 0)
            strayed = ca.if_else(far, strayed, 0)
        # Both are beyond the gate anyway; said twice, a step in agreement with its prediction skips all of it.
        jumping, strayed = (ca.if_else(distance > gate, each, 0) for each in (jumping, strayed))
        unexplained = ca.if_else(ca.logic_or(same, believed), doubts, DOUBTS)
        disagreeing = ca.if_else(far, unexplained, ca.if_else(same, doubts, DOUBTS))
        agreeing = ca.if_else(same, doubts, ca.if_else(doubts >= 1, doubts - 1, 0))
        moves = ca.logic_or(ca.logic_and(ca.fabs(expected - before) > frozen, doubts < 1), strayed)
        suspicious = ca.logic_or(moves, u[f"{n}_unanswered"]) if decision.at_rest else moves
        stands = ca.logic_and(_is_frozen(travel, y, unchanged, suspicious), u["ready"])
        usable = ca.logic_and(ca.logic_not(u[f"fault_{n}"]), ca.logic_not(excluded))
        stopped = ca.if_else(usable, 1, excluded)
        predicted, sound = clip(expected, sensor), u[safety.SOUND.name]

        def by_case(jumps: Value, stops: Value, unsound: Value, usual: Value) -> ca.SX:
            return ca.if_else(jumping, jumps, ca.if_else(stands, stops, ca.if_else(sound, usual, unsound)))

        output = {
            f"{n}_held": by_case(predicted, predicted, ca.if_else(usable, y, predicted), y),
            f"{n}_trusted": by_case(0, 0, usable, 1),
            f"{n}_frozen": by_case(excluded, stopped, excluded, 0),
            f"{n}_suspect": by_case(1, stopped, excluded, 0),
            f"{n}_usual": by_case(0, 0, 0, 1),
            f"{n}_unchanged": unchanged,
        }
        next = {
            "code": y,
            "still": unchanged,
            "before": before,
            "doubts": ca.if_else(distance > gate, disagreeing, agreeing),
            "excluded": by_case(ca.if_else(last, 1, excluded), stopped, excluded, 0),
        }
        if n in decision.jump:
            next["jumps"] = by_case(ca.if_else(last, 0, x["jumps"] + 1), 0, 0, 0)
        out_of_use = ca.if_else(stands, stopped, ca.if_else(sound, 0, excluded))  # unless it jumps
        label(
            agreeing=agreeing, same=same, believed=believed, unchanged=unchanged, jumping=jumping, stands=stands,
            usable=usable, stopped=stopped, growth=growth, strayed=strayed, far=far, distance=distance, moves=moves,
            out_of_use=out_of_use,
        )  # fmt: skip
        return Step(output, next, numbers=decision.numbers_of_monitor(sensor))

    return build(
        f"{n}_{safety.MONITOR}", time, law,
        inputs=redundancy_decision.inputs_of_monitor(sensor, decision.at_rest > 0, missed_calls),
        outputs=redundancy_decision.outputs_of_monitor(sensor),
        states=redundancy_decision.states_of_monitor(sensor, decision),
        tag="frozen codes, jumps of the innovation",
    )  # fmt: skip


def _is_in_time(u: Exprs, missed_calls: Signal | None) -> ca.SX:
    """Return whether a jump may be looked for: not once latched, and not after missing calls."""
    in_time = u[safety.JUDGING.name]
    if missed_calls:  # a count below 0 is as bad as one that is NaN
        counted = ca.logic_and(u[missed_calls.name] >= missed_calls.low, u[missed_calls.name] <= 0)
        in_time = ca.logic_and(in_time, counted)
        label(counted=counted, in_time=in_time)
    return in_time


def _is_frozen(travel: tuple[float, float], y: ca.SX, still: ca.SX, suspicious: ca.SX) -> ca.SX:
    """Return whether the code stands still although it ought to move."""
    low, high = travel
    return ca.if_else(still >= FRESH, ca.logic_and(ca.logic_and(y > low, y < high), suspicious), 0)


def _is_free(travel: tuple[float, float], positions: tuple[ca.SX, ca.SX], contradicts: ca.SX) -> ca.SX:
    """Return whether an innovation that `contradicts` a believed prediction is a jump: no stop may hold the body.

    The positions are the prediction, and the code before: a body that leaves a stop is not where it is predicted.
    """
    low, high = travel
    for position in positions:
        contradicts = ca.logic_and(contradicts, ca.logic_and(position > low, position < high))
    return contradicts
