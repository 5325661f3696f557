"""Fault isolation: which sensor of a parity relation is wrong.

    r = sum_i w_i y_i,   E_i = sign(r) w_i (y_i - y^_i) with the prediction y^_i

For one wrong sensor with an error e, r = w e. Its E is |r|, and that of the others is 0, as far as the predictions do
not follow the error. The rules, in this order:

    1. of the sensors whose code did not change for FRESH samples, the one with the largest E_i > 0.4 |r|, where
       the next one is smaller by 0.05 |r|;
    2. the only one whose code stands still, STILL samples or more, while the codes of all others move;
    3. the one with the largest E_i, where the next one is smaller by 0.3 |r|;
    4. otherwise it is not clear. Rule 3 does not hold once a group is undecided.

Source: Isermann, *Fault-Diagnosis Systems*, chapter 10 (parity), with the innovations of chapter 11 as votes.
"""

from collections.abc import Sequence

import casadi as ca

from synth.block import Constant, Exprs
from synth.signals import Signal

FRESH, STILL = 3, 8  # samples without a change of the code: fewer, it moves; at least, it stands still
CANDIDATE = 0.4  # of |r|: least E by rule 1
LEAD = {"by code": 0.05, "by innovation": 0.3}  # of |r|: of the largest E over the next one, by rules 1 and 2, and 3
PREFERENCE = 10.0  # added to E by rules 1 and 2; larger than any reading


def isolate(
    names: Sequence[str], E: Exprs, still: Exprs, size: ca.SX, undecided: ca.SX
) -> tuple[dict[str, ca.SX], ca.SX, ca.SX]:
    """Return the score of each sensor, the largest, and whether that sensor explains a contradiction clearly.

    `E` and `still` (samples without a change) are by sensor, `size` is |r|. A group that is `undecided` has wrong
    predictions, so rule 3 does not hold for it. The rules are weights, not decisions: at most one sensor is chosen, and
    a chain of decisions about it would have outcomes that no input reaches.
    """
    least_E = CANDIDATE * size
    repeats = {n: still[n] >= FRESH for n in names}
    candidate = {n: _one(ca.logic_and(repeats[n], E[n] > least_E)) for n in names}
    moving = sum((_one(still[n] < FRESH) for n in names), start=ca.SX(0))
    others_move = _one(moving == len(names) - 1)
    stands = {n: still[n] >= STILL for n in names}
    alone = {n: _one(stands[n]) * others_move for n in names}
    candidates = sum(candidate.values(), start=ca.SX(0))
    by_first_rule = _one(candidates > 0)
    by_second_rule = 1 - by_first_rule
    preferred = {n: by_second_rule * alone[n] for n in names}
    score = {n: E[n] + PREFERENCE * (candidate[n] - by_first_rule + preferred[n]) for n in names}
    best, second = ca.SX(-PREFERENCE), ca.SX(-PREFERENCE)
    for n in names:
        second = ca.fmax(second, ca.fmin(best, score[n]))
        best = ca.fmax(best, score[n])
    standing = sum(alone.values(), start=ca.SX(0))
    by_code = candidates + standing > 0
    distinct = best - second > ca.if_else(by_code, LEAD["by code"], LEAD["by innovation"]) * size
    return score, best, ca.logic_and(distinct, ca.logic_or(by_code, ca.logic_not(undecided)))


def signals(i: int, unit: str, r: ca.SX, E: Exprs, score: Exprs) -> list[tuple[Signal, ca.SX]]:
    """Return the signals of relation i that the C names, for readings in a unit."""
    most = 10 * PREFERENCE
    named = [(Signal(f"residual_{i}", unit, -most, most, "of the parity relation"), r)]
    named += [(Signal(f"E_{n}", unit, -most, most, "innovation that explains it"), v) for n, v in E.items()]
    return named + [(Signal(f"score_{n}", unit, -most, most, "the largest is wrong"), v) for n, v in score.items()]


def numbers(unit: str, i: int, threshold: float) -> list[Constant]:
    """Return the numbers of the rules and of relation i that the C names, for readings in a unit."""
    return [
        Constant(
            f"threshold_{i}", threshold, unit, "largest |r| without a fault: half a count and an offset of each sensor"
        ),
        Constant(
            "candidate_part",
            CANDIDATE,
            "1",
            "of |r|: least E by a code that stands still; it had |r| at first, and predictions follow it",
        ),
        Constant(
            "lead_by_code", LEAD["by code"], "1", "of |r|: least lead over the next E by codes: more than noise of E"
        ),
        Constant(
            "lead_by_innovation",
            LEAD["by innovation"],
            "1",
            "of |r|: least lead by innovations alone, which predictions that followed an error spoil",
        ),
        Constant("preference", PREFERENCE, unit, "more than any E: codes decide before innovations"),
        Constant("twice_preference", 2 * PREFERENCE, unit, "more than any score: no sensor is named"),
    ]


def _one(flag: ca.SX) -> ca.SX:
    return ca.if_else(flag, 1.0, 0.0)
