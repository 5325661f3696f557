"""Innovation monitor of one sensor: it is refused, frozen, or jumps away from its prediction (fault detection, FDI).

    accepted reading y, expected reading y^ (prediction of an observer)  -->  reading to use, whether it is trusted

    refused   the guard refuses it: the prediction replaces it
    frozen    its code does not change for FRESH samples or more while its prediction, which agreed with it at the last
              DOUBTS changes, moves by more than `gate`; or a `probe` says that its code did not answer
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
"""

import casadi as ca

from synth import arguments
from synth.block import Block, Exprs, Step, build, clip
from synth.blocks.faults import redundancy_decision
from synth.blocks.faults.redundancy_decision import DOUBTS, FRESH, Decision
from synth.blocks.guard import safety
from synth.signals import Signal
from synth.timing import Discrete

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
    gate, travel = decision.gate[n], decision.travel[n]

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
        moves = ca.logic_or(ca.logic_and(ca.fabs(expected - before) > gate, doubts < 1), strayed)
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
