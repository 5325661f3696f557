"""Fault isolation: which sensor of a parity relation is wrong.

    r = sum_i w_i y_i,   E_i = sign(r) w_i (y_i - y^_i) with the prediction y^_i

For one wrong sensor with an error e, r = w e. Its E is |r|, and that of the others is 0, as far as the predictions do
not follow the error. The rules, in this order:

    1. of the sensors whose code did not change for FRESH samples, the one with the largest E_i > 0.4 |r|;
    2. the only one whose code stands still, STILL samples or more, while the codes of all others move;
    3. the one with the largest E_i > |r|/2, where the next one is below half of it;
    4. otherwise it is not clear. Rule 3 does not hold once a group is undecided.

Source: Isermann, *Fault-Diagnosis Systems*, chapter 10 (parity), with the innovations of chapter 11 as votes.
"""

from collections.abc import Sequence

import casadi as ca

from synth.block import Exprs

FRESH, STILL = 3, 8  # samples without a change of the code: fewer, it moves; at least, it stands still
CANDIDATE, CLEAR = 0.4, 0.5  # of |r|: least E of rules 1 and 3, and of the largest E: most of the next one


def isolate(
    names: Sequence[str], E: Exprs, still: Exprs, size: ca.SX, undecided: ca.SX
) -> tuple[dict[str, ca.SX], ca.SX]:
    """Return by sensor whether it explains a contradiction best, and whether it does so clearly.

    `E` and `still` (samples without a change) are by sensor, `size` is |r|. A group that is `undecided` has wrong
    predictions, so rule 3 does not hold for it.
    """
    candidate = {n: ca.logic_and(still[n] >= FRESH, E[n] > CANDIDATE * size) for n in names}
    any_candidate = ca.SX(0)
    for n in names:
        any_candidate = ca.if_else(candidate[n], 1, any_candidate)
    score = {n: ca.if_else(any_candidate, ca.if_else(candidate[n], E[n], -1.0), E[n]) for n in names}
    best, second = score[names[0]], ca.SX(-1.0)
    for n in names[1:]:
        second = ca.fmax(second, ca.fmin(best, score[n]))
        best = ca.fmax(best, score[n])
    moving = sum((ca.if_else(still[n] < FRESH, 1, 0) for n in names), start=ca.SX(0))
    only = ca.SX(0)
    alone = {n: ca.logic_and(still[n] >= STILL, moving == len(names) - 1) for n in names}
    for n in names:
        only = ca.if_else(alone[n], 1, only)
    by_code = ca.logic_and(only, ca.logic_not(any_candidate))
    chosen, free = {}, ca.SX(1)
    for n in names:
        largest = ca.logic_and(score[n] >= best, free)
        free = ca.if_else(largest, 0, free)
        chosen[n] = ca.if_else(by_code, alone[n], largest)
    distinct = ca.logic_and(best > CLEAR * size, second < CLEAR * best)
    distinct = ca.logic_and(distinct, ca.logic_not(undecided))
    return chosen, ca.logic_or(ca.logic_or(any_candidate, only), distinct)
