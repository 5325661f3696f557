"""Sensor fault detection, isolation and accommodation (FDIA): parity, innovations, and codes that stand still.

    accepted readings y, expected readings y^ (predictions of the observers)  -->  readings to use, suspects

A relation sum_i w_i y_i = 0 holds for the sensors of a group, at most one relation a sensor (`analyse.parity`).

    one reading of a group refused    the relation replaces it, y_i = -sum_{k != i} w_k y_k / w_i
    two or more                       predictions replace them
    a reading without a group         its prediction replaces it

    contradiction   |r| > threshold, r = sum_i w_i y_i. It says that a sensor is wrong, and `isolation` which one; where
                    that is not clear, all of the group are suspects after `undecided` samples, and all stay in use.
    frozen          of a sensor without a group: its code does not change for FRESH samples or more while its
                    prediction, which agreed with it at the last DOUBTS changes, moves by more than `gate`; or a
                    `probe` says that its code did not answer.
    jump            of a sensor without a group: it is further than `jump` from its prediction, which agreed with it at
                    the last DOUBTS changes. The prediction replaces it at once. It is not looked for in a sample after
                    missing calls, in which the body has moved on, nor where the prediction or the
                    code before it is outside `travel`.

Once latched, predictions stand still, and no jump is looked for any more.

A sensor that is named for `persistent` samples in a row is excluded until init, a frozen one at once. One of a group
that was excluded because its code stood still, and whose code then moves, makes the group undecided: the choice was
wrong.

``determined`` says that the groups measure their coordinates: at most one reading of each is replaced, and nothing is
undecided. ``regular`` says that further no reading without a group is replaced. ``sufficient`` says that at most
`tolerated` readings of each group are replaced.

Source: Isermann, *Fault-Diagnosis Systems*, chapters 10 (parity) and 11 (observers); Patton, Chen, "Review of parity
space approaches to fault diagnosis", 1994.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import casadi as ca

from synth import arguments
from synth.analyse.parity import Relation
from synth.block import Block, Exprs, Step, build, clip
from synth.blocks import isolation, redundancy_signals, safety
from synth.blocks.isolation import FRESH
from synth.blocks.redundancy_decision import DOUBTS, Decision
from synth.blocks.redundancy_failures import of_redundancy
from synth.errors import SignalError
from synth.signals import Signal, signal_names
from synth.timing import Discrete

__all__ = ["Decision", "block"]


@arguments.checked
def block(
    time: Discrete,
    sensors: Sequence[Signal],
    relations: Sequence[Relation],
    decision: Decision,
    missed_calls: Signal | None = None,
) -> Block:
    """Return the Block between the guard and the laws.

    For each sensor s it reads ``<s>_accepted`` and ``fault_<s>`` of the guard, and ``<s>_expected``; further ``ready``,
    ``judging`` and ``complete``, and with a probe ``<s>_unanswered`` of each sensor with a gate. Its outputs are
    ``<s>_held`` and ``suspect_<s>``, of each sensor with a gate also ``<s>_trusted``, ``<s>_unchanged`` and
    ``<s>_frozen``, and ``regular``, ``determined`` and ``sufficient``. While all readings are good and agree and no
    sensor was ever a suspect, they pass, and nothing else is computed. ``degraded`` says that this is not so, once
    ready. `missed_calls` is the input that counts missing calls, if there is one.

    Raises SignalError for a relation of unknown sensors or of fewer than two, a sensor in two relations, a sensor
    without a relation and without a gate, a gate or travel of an unknown sensor, or numbers of samples below 1.
    """
    names, by_name = signal_names(sensors), {s.name: s for s in sensors}
    singles = _singles(names, relations, decision)

    def law(u: Exprs, x: Exprs, k: Exprs) -> Step:
        y = {n: u[f"{n}_accepted"] for n in names}
        same = {n: y[n] == x[f"code_{n}"] for n in names}
        usable = {n: ca.logic_and(ca.logic_not(u[f"fault_{n}"]), ca.logic_not(x[f"excluded_{n}"])) for n in names}
        next: dict[str, ca.SX] = {f"code_{n}": y[n] for n in names}
        next |= {f"still_{n}": _count(same[n], x[f"still_{n}"], decision.longest(n in singles)) for n in names}
        value, suspects, named = dict[str, ca.SX](), dict[str, ca.SX](), list[tuple[Signal, ca.SX]]()
        stopped: dict[str, ca.SX] = {}
        in_time = u[safety.JUDGING.name]
        if missed_calls:  # a count below 0 is as bad as one that is NaN
            counted = ca.logic_and(u[missed_calls.name] >= missed_calls.low, u[missed_calls.name] <= 0)
            in_time = ca.logic_and(in_time, counted)
        regular, sufficient = ca.SX(1), ca.SX(1)
        calm = ca.logic_and(u["ready"], ca.logic_and(u["complete"], ca.logic_not(x["degraded"])))
        for i, relation in enumerate(relations):
            vote = _vote(i, relation, by_name, u, x, next, usable, same, decision)
            value |= vote.value
            suspects |= vote.suspects
            next |= vote.next
            named += vote.named
            regular = ca.if_else(vote.regular, regular, 0)
            sufficient = ca.if_else(vote.sufficient, sufficient, 0)
            calm = ca.logic_and(calm, vote.agreement)
        determined = regular
        for n in singles:
            still, expected = next[f"still_{n}"], u[f"{n}_expected"]
            before = ca.if_else(same[n], x[f"before_{n}"], expected)
            gate, doubts, distance = decision.gate[n], x[f"doubts_{n}"], ca.fabs(expected - y[n])
            believed = _is_jump_possible(decision.travel[n], (expected, x[f"code_{n}"]), doubts, in_time)
            far = distance > decision.jump[n] if n in decision.jump else ca.SX(0)
            count = x[f"jumps_{n}"] if n in decision.jump else ca.SX(0)
            jumps = ca.logic_and(far, ca.logic_or(count >= 1, ca.logic_and(believed, ca.logic_not(same[n]))))
            near = ca.if_else(distance > gate, DOUBTS, ca.if_else(doubts >= 1, doubts - 1, 0))
            changed = ca.if_else(far, ca.if_else(believed, doubts, DOUBTS), near)
            next |= {f"before_{n}": before, f"doubts_{n}": ca.if_else(same[n], doubts, changed)}
            moves = ca.logic_and(ca.fabs(expected - before) > gate, doubts < 1)
            suspicious = ca.logic_or(moves, u[f"{n}_unanswered"]) if decision.at_rest else moves
            frozen = _is_frozen(decision.travel[n], y[n], still, suspicious)
            calm = ca.logic_and(calm, ca.logic_not(frozen))
            frozen = ca.logic_and(ca.logic_and(frozen, u["ready"]), usable[n])
            next[f"excluded_{n}"] = suspects[n] = stopped[n] = ca.if_else(frozen, 1, x[f"excluded_{n}"])
            if n in decision.jump:
                calm = ca.logic_and(calm, ca.logic_not(jumps))
                last = count >= decision.persistent - 1
                next[f"jumps_{n}"] = ca.if_else(jumps, ca.if_else(last, 0, count + 1), 0)
                after_jump = ca.if_else(last, 1, x[f"excluded_{n}"])
                next[f"excluded_{n}"] = ca.if_else(jumps, after_jump, stopped[n])
                suspects[n] = ca.if_else(jumps, 1, stopped[n])
            usable[n] = ca.logic_and(usable[n], ca.logic_not(suspects[n]))
            value[n] = ca.if_else(usable[n], y[n], clip(expected, by_name[n]))
            regular = ca.if_else(usable[n], regular, 0)
        degraded = x["degraded"]
        for flag in suspects.values():
            degraded = ca.if_else(flag, 1, degraded)
        unusual = {f"{n}_held": value[n] for n in names} | {f"suspect_{n}": suspects[n] for n in names}
        unusual |= {f"{n}_trusted": ca.if_else(usable[n], 1, 0) for n in singles}
        unusual |= {"regular": regular, "sufficient": sufficient, "determined": determined}
        unusual |= {f"{n}_frozen": stopped[n] for n in singles}
        usual = {f"{n}_held": y[n] for n in names} | {f"suspect_{n}": ca.SX(0) for n in names}
        usual |= {f"{n}_frozen": ca.SX(0) for n in singles}
        output = {n: ca.if_else(calm, usual.get(n, ca.SX(1)), v) for n, v in unusual.items()}
        output |= {f"{n}_unchanged": next[f"still_{n}"] for n in singles}
        output["degraded"] = ca.if_else(calm, 0, u["ready"])
        decisions = {n: v for n, v in next.items() if not n.startswith(("code_", "still_", "before_", "doubts_"))}
        zeros = {f"contradictions_{i}": ca.SX(0) for i in range(len(relations))}
        next |= {n: ca.if_else(calm, zeros.get(n, x[n]), v) for n, v in (decisions | {"degraded": degraded}).items()}
        return Step(output, next, named, numbers=decision.numbers(by_name, relations))

    made = build(
        safety.REDUNDANCY, time, law,
        inputs=redundancy_signals.inputs(sensors, singles if decision.at_rest else [], missed_calls),
        outputs=redundancy_signals.outputs(sensors, singles),
        states=redundancy_signals.states(sensors, relations, singles, decision),
        tag="parity, innovations, frozen codes, jumps",
    )  # fmt: skip
    return replace(made, failures=of_redundancy(by_name, relations, singles, decision))


@dataclass(frozen=True, eq=False)
class _Vote:
    value: dict[str, ca.SX]
    suspects: dict[str, ca.SX]
    next: dict[str, ca.SX]
    regular: ca.SX
    sufficient: ca.SX
    agreement: ca.SX
    named: list[tuple[Signal, ca.SX]]


def _vote(
    i: int,
    relation: Relation,
    signals: Mapping[str, Signal],
    u: Exprs,
    x: Exprs,
    still: Exprs,
    usable: Exprs,
    same: Exprs,
    decision: Decision,
) -> _Vote:
    """Return the readings of a group to use, its suspects and its next states, in one of three cases.

    agreeing        all readings are usable and agree: they pass
    contradictory   all are usable and do not agree: one may be named and replaced
    incomplete      a reading is refused or excluded
    """
    weights, names = relation.weights, list(relation.weights)
    y, expected = ({n: u[f"{n}_{of}"] for n in names} for of in ("accepted", "expected"))
    r = sum((w * y[n] for n, w in weights.items()), start=ca.SX(0))
    whole = ca.SX(1)
    for n in names:
        whole = ca.logic_and(whole, usable[n])
    agreement = ca.fabs(r) <= relation.threshold
    agrees = ca.logic_or(agreement, ca.logic_not(u["ready"]))
    count, stuck, undecided = (x[f"{of}_{i}"] for of in ("contradictions", "stuck", "undecided"))
    excluded, stands = {n: x[f"excluded_{n}"] for n in names}, {n: still[f"still_{n}"] for n in names}

    def by_case(agreeing: ca.SX, contradictory: ca.SX, incomplete: ca.SX) -> ca.SX:
        return ca.if_else(whole, ca.if_else(agrees, agreeing, contradictory), incomplete)

    direction = {n: ca.if_else(r > 0, w, -w) for n, w in weights.items()}
    E = {n: direction[n] * (y[n] - expected[n]) for n in names}
    score, best, clear = isolation.isolate(names, E, stands, ca.fabs(r), undecided)
    least = ca.if_else(clear, best, 2 * isolation.PREFERENCE)
    isolated = {n: ca.if_else(score[n] >= least, 1.0, 0.0) for n in names}
    final, moved = ca.if_else(count >= decision.persistent - 1, 1.0, 0.0), ca.SX(0)
    stuck_now = sum((ca.if_else(stands[n] >= FRESH, isolated[n] * final, 0.0) for n in names), start=ca.SX(0))
    for n in names:
        moves = ca.logic_and(ca.logic_not(same[n]), ca.logic_and(excluded[n], ca.logic_not(u[f"fault_{n}"])))
        moved = ca.if_else(moves, 1, moved)
    missing = sum((ca.if_else(usable[n], 0, 1) for n in names), start=ca.SX(0))
    waited = ca.if_else(count >= decision.undecided - 1, 1, undecided)
    wrong_choice = ca.logic_and(stuck, moved)
    doubted = ca.if_else(wrong_choice, 1, undecided)
    value, suspects = {}, {}
    for n, w in weights.items():
        predicted = ca.if_else(missing <= 1, y[n] - r / w, expected[n])
        corrected, replaced = y[n] - isolated[n] * r / w, ca.if_else(usable[n], y[n], predicted)
        value[n] = by_case(y[n], clip(corrected, signals[n]), clip(replaced, signals[n]))
        suspects[n] = ca.if_else(by_case(undecided, isolated[n] + waited, excluded[n] + doubted) > 0, 1, 0)
    next = {
        f"contradictions_{i}": by_case(ca.SX(0), _count(ca.SX(1), count, decision.undecided), ca.SX(0)),
        f"stuck_{i}": by_case(stuck, ca.if_else(stuck_now + stuck > 0, 1, 0), stuck),
        f"undecided_{i}": by_case(undecided, waited, doubted),
        **{f"excluded_{n}": by_case(excluded[n], isolated[n] * final, excluded[n]) for n in names},
    }
    regular = by_case(ca.logic_not(undecided), ca.logic_not(waited), ca.logic_and(missing <= 1, ca.logic_not(doubted)))
    sufficient = ca.if_else(whole, 1, missing <= decision.tolerated)
    shown = isolation.signals(i, signals[names[0]].unit, r, E, score)
    return _Vote(value, suspects, next, regular, sufficient, agreement, shown)


def _is_frozen(travel: tuple[float, float], y: ca.SX, still: ca.SX, suspicious: ca.SX) -> ca.SX:
    """Return whether the code of a sensor without a group stands still although it ought to move."""
    low, high = travel
    return ca.if_else(still >= FRESH, ca.logic_and(ca.logic_and(y > low, y < high), suspicious), 0)


def _is_jump_possible(
    travel: tuple[float, float], positions: tuple[ca.SX, ca.SX], doubts: ca.SX, in_time: ca.SX
) -> ca.SX:
    """Return whether a prediction is believed and no stop may hold the body: then a large innovation is a jump.

    The positions are the prediction, and the code before: a body that leaves a stop is not where it is predicted.
    """
    (low, high), believed = travel, ca.logic_and(doubts < 1, in_time)
    for position in positions:
        believed = ca.logic_and(believed, ca.logic_and(position > low, position < high))
    return believed


def _count(flag: ca.SX, count: ca.SX, most: int) -> ca.SX:
    """Return the next of a counter of samples in a row with a flag, which stays at `most`."""
    return ca.if_else(flag, ca.if_else(count >= most, count, count + 1), 0)


def _singles(names: Sequence[str], relations: Sequence[Relation], decision: Decision) -> list[str]:
    """Return the sensors without a relation; raise SignalError for a declaration that does not fit."""
    related = [n for r in relations for n in r.weights]
    for n in related:
        if n not in names or related.count(n) > 1 or any(len(r.weights) < 2 for r in relations):
            raise SignalError(
                f"the relations name '{n}': name at least two of {', '.join(names)} in each, and each sensor once"
            )
    if unknown := [n for n in (*decision.gate, *decision.travel, *decision.jump) if n not in names]:
        raise SignalError(
            f"the decision has a gate, travel or jump of '{unknown[0]}', and the sensors are {names}: give a sensor"
        )
    singles = [n for n in names if n not in related]
    for n in singles:
        if not decision.gate.get(n, 0) > 0 or n not in decision.travel:
            raise SignalError(f"sensor '{n}' is in no relation and has no gate or travel: give both")
        if decision.jump.get(n, decision.gate[n]) < decision.gate[n]:
            raise SignalError(f"a jump of '{n}' is above {decision.jump[n]}, its gate {decision.gate[n]}: give no less")
    if decision.persistent < 1 or decision.undecided < decision.persistent:
        raise SignalError(
            f"a sensor is excluded after {decision.persistent} samples and a group undecided after "
            f"{decision.undecided}: give at least 1, and no fewer for the second"
        )
    return singles
