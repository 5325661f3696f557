"""Readings replaced by parity and prediction, and sensors excluded, in NumPy.

It is the reference of `blocks.redundancy` and, for the `others`, of `blocks.innovation_monitor`.

parity       sum of s_j y_j = 0 for the sensors of a relation, s_j = +-1: a refused one follows from the others, two
             or more follow from the predictions
isolation    for |sum of s_j y_j| above a threshold, which its mean squared change in a sample raises: by codes that
             stand still and by innovations
others       a code that stands still while the prediction moves by more than a gate is frozen; a reading further
             than `jump` from a prediction that is believed has jumped; both need an earlier agreement
             unless the distance grew by more than a wide gate since the last change of the code
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from synth.reference.guard import by_row, rows

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]
Columns = Mapping[str, NDArray[Any]]

FRESH, STILL, PERSISTENT, UNDECIDED, DOUBTS = 3, 8, 3, 10, 10  # samples, changes of a code
CANDIDATE, LEAD = 0.4, (0.05, 0.3)  # of |r|
LEARNT = 1 / 128  # of the squared threshold, in a sample without a contradiction


@dataclass(frozen=True)
class Sensors:
    """The sensors of the relation with their signs and its threshold, and the `others` with gates and travel.

    Its square is `threshold`^2 + `gain` m, m the mean squared change of the residual, and at most `largest`^2.
    Samples without a change of the others are counted up to `longest`. Readings are limited to `low` .. `high`.
    """

    signs: Mapping[str, float]
    threshold: float
    gain: float
    largest: float
    others: Sequence[str]
    gate: float
    frozen: float
    jump: float
    wide_jump: float
    wide_frozen: float
    travel: float
    longest: int
    low: Array
    high: Array

    @property
    def sensors(self) -> tuple[str, ...]:
        """All sensors."""
        return (*self.signs, *self.others)

    def states(self, what: str) -> list[str]:
        """Return the names of a state of all sensors."""
        return [f"redundancy_{what}_{n}" for n in self.signs] + [f"{n}_monitor_{what}" for n in self.others]

    def parity(self, y: Array) -> Array:
        """Return the parity of some readings; its rows are those of the relation."""
        return np.asarray(np.sum(self.column(y) * y, axis=0))

    def column(self, like: Array) -> Array:
        """Return the signs as a column."""
        return by_row([*self.signs.values()], like)


def readings(
    state: Columns, y: Array, good: Flags, expected: Array, attempts: int, missed: Array, of: Sensors
) -> tuple[Array, Flags, dict[str, Flags], dict[str, Any]]:
    """Return the readings to use (m, n), the suspects (m, n), flags of the sample, and the next states.

    `expected` are the predicted readings; `attempts` of the probe without an answer exclude one of the others. A jump
    is not looked for in a sample before which calls were `missed`.
    """
    g = len(of.signs)
    same = y == rows(state, of.states("code"))
    excluded = rows(state, of.states("excluded")) > 0
    usable, longest = good & ~excluded, by_row([STILL] * g + [of.longest] * len(of.others), y)
    count = rows(state, of.states("still"))
    value, ready = np.where(usable, y, expected), np.asarray(state["guard_ready"]) > 0
    still = np.where(same, np.minimum(count + 1, longest), 0.0)
    judging = ready & ~(np.asarray(state["guard_latched"]) > 0)  # once latched, the observers stand still
    r, bound = of.parity(y[:g]), np.asarray(state["redundancy_bound_0"])
    threshold = np.sqrt(bound)
    related, named, after = _isolate(state, of, threshold, y[:g], value[:g], expected[:g], usable[:g], still[:g], ready)
    readmitted = ~same[:g] & excluded[:g] & good[:g] & (np.asarray(state["redundancy_stuck_0"]) > 0)
    undecided = after["waited"] | readmitted.any(axis=0)
    undecided = undecided | (np.asarray(state["redundancy_undecided_0"]) > 0)
    remembered = rows(state, of.states("before")[g:])
    before = np.where(ready, np.where(same[g:], remembered, expected[g:]), y[g:])
    unanswered = rows(state, [f"probe_{n}_attempt" for n in of.others]) >= attempts
    doubts = rows(state, of.states("doubts")[g:])
    distance, counted = np.abs(expected[g:] - y[g:]), rows(state, of.states("jumps")[g:])
    last = rows(state, of.states("code")[g:])
    growth = distance - np.abs(last - remembered)
    with np.errstate(invalid="ignore"):
        believed = judging & ((doubts == 0) | (growth > of.wide_jump)) & (np.asarray(missed) == 0)
    believed &= (np.abs(expected[g:]) < of.travel) & (np.abs(last) < of.travel)
    far = distance > of.jump
    doubted = np.where(far & believed, doubts, np.where(distance > of.gate, DOUBTS, np.maximum(doubts - 1, 0)))
    suspicious = ((doubts == 0) & (np.abs(expected[g:] - before) > of.frozen)) | (growth > of.wide_frozen) | unanswered
    stands = ready & (still[g:] >= FRESH) & (np.abs(y[g:]) < of.travel) & suspicious
    jumps = far & ((counted > 0) | (believed & ~same[g:]))
    freezes = stands & ~jumps & usable[g:]
    degraded = np.asarray(state["redundancy_degraded"]) > 0
    sound = ready & good.all(axis=0) & ~degraded
    usual = sound & ~stands & ~jumps
    stopped = ~usual & (freezes | excluded[g:])
    wrong = stopped | (~usual & jumps)
    out = ~usual & (np.where(jumps, counted >= PERSISTENT - 1, freezes) | excluded[g:])
    trusted = usual | (usable[g:] & ~wrong)
    value = np.concatenate([related, np.where(trusted, y[g:], expected[g:])])
    low, high = by_row(of.low, y), by_row(of.high, y)
    suspects = np.concatenate([named | excluded[:g] | undecided, wrong])
    next: dict[str, Any] = dict(zip(of.states("code"), y, strict=True))
    next |= dict(zip(of.states("still"), still, strict=True))
    next |= dict(zip(of.states("before")[g:], before, strict=True))
    kept_doubts = np.where(same[g:], doubts, doubted)
    next |= dict(zip(of.states("doubts")[g:], kept_doubts, strict=True))
    calm = sound & usual.all(axis=0) & (np.abs(r) <= threshold)
    last_r = np.asarray(state["redundancy_last_residual_0"])
    learnt = (1 - LEARNT) * bound + LEARNT * (of.threshold**2 + of.gain * (r - last_r) ** 2)
    next["redundancy_bound_0"] = np.where(calm, np.minimum(learnt, of.largest**2), bound)
    next["redundancy_last_residual_0"] = np.where(calm, r, last_r)
    jump_counts = np.where(jumps & (counted < PERSISTENT - 1), counted + 1, 0)
    next |= dict(zip(of.states("jumps")[g:], jump_counts, strict=True))
    next |= dict(zip(of.states("excluded")[g:], out, strict=True))
    leave_out = (excluded[:g] & ~readmitted) | after["excluded"]
    decisions = dict(zip(of.states("excluded")[:g], leave_out, strict=True))
    decisions |= {"redundancy_stuck_0": after["stuck"], "redundancy_undecided_0": undecided}
    decisions["redundancy_degraded"] = degraded | suspects.any(axis=0) | leave_out.any(axis=0) | out.any(axis=0)
    next |= {n: np.where(calm, np.asarray(state[n]) > 0, v) for n, v in decisions.items()}
    next["redundancy_contradictions_0"] = np.where(calm, 0, after["count"])
    missing = np.sum(~usable[:g], axis=0)
    determined = (missing <= 1) & ~undecided
    flags = {
        "determined": calm | determined,
        "regular": calm | (determined & trusted.all(axis=0)),
        "sufficient": calm | (missing <= 2),
        "trusted": trusted,
        "degraded": ~calm & ready,
        "frozen": stopped,
    }
    return np.where(calm, y, np.clip(value, low, high)), ~calm & suspects, flags, next


def _isolate(
    state: Columns,
    of: Sensors,
    threshold: Array,
    y: Array,
    value: Array,
    expected: Array,
    usable: Flags,
    still: Array,
    ready: Flags,
) -> tuple[Array, Flags, dict[str, Any]]:
    """Return the readings of the relation to use, which is named now, and what follows for the states."""
    sign = of.column(y)
    r, missing = of.parity(value), np.sum(~usable, axis=0)
    wrong = (missing == 0) & (np.abs(r) > threshold) & ready
    E = np.where(r > 0, 1.0, -1.0) * sign * (y - expected)
    undecided = np.asarray(state["redundancy_undecided_0"]) > 0
    candidate = (still >= FRESH) & (CANDIDATE * np.abs(r) < E)
    first = candidate.any(axis=0)
    score = np.where(first, np.where(candidate, E, -1.0), E)
    order = np.sort(score, axis=0)
    alone = (still >= STILL) & (np.sum(still < FRESH, axis=0) == len(y) - 1)
    second = alone.any(axis=0) & ~first
    third = (order[-1] - order[-2] > LEAD[1] * np.abs(r)) & ~undecided
    first &= order[-1] - order[-2] > LEAD[0] * np.abs(r)
    largest = np.arange(len(y)).reshape(by_row(range(len(y)), y).shape) == np.argmax(score, axis=0)
    named = np.where(second, alone, largest) & wrong & (first | second | third)
    by_parity = named | (~usable & (missing == 1))
    count = np.asarray(state["redundancy_contradictions_0"])
    excluded = named & (count >= PERSISTENT - 1)
    stuck = (np.asarray(state["redundancy_stuck_0"]) > 0) | (excluded & (still >= FRESH)).any(axis=0)
    next = {"excluded": excluded, "stuck": stuck, "waited": wrong & (count >= UNDECIDED - 1)}
    next["count"] = np.where(wrong, np.minimum(count + 1, UNDECIDED), 0)
    return np.where(by_parity, value - sign * r, value), named, next
