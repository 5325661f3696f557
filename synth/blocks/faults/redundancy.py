"""Sensor fault detection, isolation and accommodation (FDIA): parity, innovations, and codes that stand still.

    accepted readings y, expected readings y^ (predictions of the observers)  -->  readings to use, suspects

A relation sum_i w_i y_i = 0 holds for the sensors of a group, at most one relation a sensor (`analyse.parity`).

    one reading of a group refused    the relation replaces it, y_i = -sum_{k != i} w_k y_k / w_i
    two or more                       predictions replace them

    contradiction   |r| > threshold, r = sum_i w_i y_i. It says that a sensor is wrong, and `redundancy_decision` which
                    one; where that is not clear, all of the group are suspects after `undecided` samples, and all stay
                    in use.

A sensor without a group has an `innovation_monitor` of its own, which says whether it is trusted.

A sensor that is named for `persistent` samples in a row is excluded until init, unless it was excluded because its code
stood still and the code moves: the choice was wrong. The sensor is then used again, so that the wrong one may be found,
and the group is undecided.

``determined`` says that the groups measure their coordinates: at most one reading of each is replaced, and nothing is
undecided. ``regular`` says that further no reading without a group is replaced. ``sufficient`` says that at most
`tolerated` readings of each group are replaced.

Source: Isermann, *Fault-Diagnosis Systems*, chapters 10 (parity) and 11 (observers); Patton, Chen, "Review of parity
space approaches to fault diagnosis", 1994.

Failures that `redundancy` notices, as rows of the header's table, with the numbers of its decisions.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import casadi as ca

from synth import arguments
from synth.analyse.structure.parity import Relation
from synth.block import Block, Exprs, Step, build, clip
from synth.blocks.faults import redundancy_decision
from synth.blocks.faults.redundancy_decision import DOUBTS, FRESH, STILL, Decision
from synth.blocks.guard import safety
from synth.blocks.guard.safety import REFUSED
from synth.errors import SignalError
from synth.fault import Failure, enumeration
from synth.law import call, label
from synth.signals import Signal, signal_names
from synth.timing import Discrete

PARITY = "what the others say, by the parity relation"
PREDICTION = "the prediction of its observer"


def of_redundancy(
    signals: Mapping[str, Signal], relations: Sequence[Relation], singles: Sequence[str], decision: Decision
) -> tuple[Failure, ...]:
    """Return the rows of the groups of sensors and of those without a group, once all were good in one sample."""
    rows = [row for relation in relations for row in _of_group(signals, relation, decision)]
    return (*rows, *(_of_singles(signals, singles, decision) if singles else ()))


def _of_group(signals: Mapping[str, Signal], relation: Relation, decision: Decision) -> list[Failure]:
    names = tuple(relation.weights)
    unit, most = signals[names[0]].unit, decision.tolerated
    noisy = f" (with noise up to {relation.largest:.3g} {unit})" if relation.gain else ""
    wrong = (
        f"|residual| above {relation.threshold:g} {unit} in {decision.persistent} samples in a row{noisy}, and one has "
        f"by far the largest innovation or alone a code that stands still ({FRESH} or {STILL} samples): excluded until "
        "init"
    )
    unclear = (
        f"the same in {decision.undecided} samples in a row, or an excluded one moves again after it stood still: "
        "it is used again"
    )
    group = f"of {enumeration(names, 'and')}"
    alone = "no relation is left: another wrong one is not noticed"
    return [
        Failure("one_refused", f"one {group} {REFUSED}", "in that sample", PARITY, f"meanwhile {alone}", names),
        Failure("one_wrong", f"one {group} frozen, offset, drifting or jumping", wrong, PARITY, f"from then on {alone}",
                (), names),
        Failure("unclear", f"the same, but which one is not clear: all {group} are suspects", unclear,
                "nothing: those in use stay in use, another excluded one stays replaced", "", (), names),
        Failure("several_lost", f"two {group} refused or excluded" if most == 2 else f"2 to {most} {group} refused or "
                "excluded", "in that sample", PREDICTION, "", names, names),
        Failure("too_many_lost", f"more than {most} {group} refused or excluded", "in that sample", PREDICTION, "",
                names, names),
    ]  # fmt: skip


def _of_singles(signals: Mapping[str, Signal], singles: Sequence[str], decision: Decision) -> list[Failure]:
    names, (first, *_) = tuple(singles), singles
    unit = signals[first].unit
    gates = enumeration([f"{g:g} {unit}" for g in dict.fromkeys(decision.frozen_from(n) for n in singles)])
    travels = dict.fromkeys(decision.travel[n] for n in singles)
    inside = enumeration([f"{low:g} .. {high:g} {unit}" for low, high in travels])
    frozen = (
        f"its code stands still for {FRESH} samples or more while its prediction, which agreed with its last {DOUBTS} "
        f"changes, moves by more than {gates}"
    )
    frozen += f"; or no answer to the probe; only inside {inside}; excluded until init"
    return [
        Failure("single_refused", f"{enumeration(names)} {REFUSED}", "in that sample", PREDICTION, "", names),
        Failure("single_frozen", f"{enumeration(names)} frozen", frozen, PREDICTION, "", (), names),
        *_of_jumps(signals, decision, inside),
        Failure("singles_lost", f"{enumeration(names, 'and')} refused or excluded", "in that sample", PREDICTION, "",
                names, names),
    ]  # fmt: skip


def _of_jumps(signals: Mapping[str, Signal], decision: Decision, inside: str) -> list[Failure]:
    if not decision.jump:
        return []
    names, (first, *_) = tuple(decision.jump), decision.jump
    gates = enumeration([f"{g:g} {signals[first].unit}" for g in dict.fromkeys(decision.jump.values())])
    noticed = (
        f"further than {gates} from its prediction, which agreed with its last {DOUBTS} changes; only inside {inside}; "
        f"excluded until init after {decision.persistent} samples in a row. Not after missed calls, until the "
        "prediction agrees again: count them, else they look like a jump. A smaller offset, a drift and noise are not "
        "noticed"
    )
    what = f"{enumeration(names)} jumping inside its range"
    return [Failure("single_jumps", what, noticed, f"{PREDICTION}, at once", "", (), names)]


__all__ = ["Decision", "block"]


@arguments.checked
def block(
    time: Discrete,
    sensors: Sequence[Signal],
    relations: Sequence[Relation],
    decision: Decision,
) -> Block:
    """Return the Block between the guard and the laws.

    For each sensor s of a group it reads ``<s>_accepted`` and ``fault_<s>`` of the guard, and ``<s>_expected``; for
    each other one ``<s>_usual``, ``<s>_suspect`` and ``<s>_trusted`` of its `innovation_monitor`; further ``ready`` and
    ``complete``. Its outputs are ``<s>_held`` of the sensors of a group, ``suspect_<s>`` of all, ``regular``,
    ``determined`` and ``sufficient``, and for the monitors ``sound``. While all readings are good and agree and no
    sensor was ever a suspect, they pass, and nothing else is computed. ``degraded`` says that this is not so, once
    ready.

    Raises SignalError for a relation of unknown sensors or of fewer than two, a sensor in two relations, a sensor
    without a relation and without a gate, a gate or travel of an unknown sensor, or numbers of samples below 1.
    """
    names, by_name = signal_names(sensors), {s.name: s for s in sensors}
    singles = _singles(names, relations, decision)
    grouped = [s for s in sensors if s.name not in singles]

    def law(u: Exprs, x: Exprs, k: Exprs) -> Step:
        group = signal_names(grouped)
        y = {n: u[f"{n}_accepted"] for n in group}
        same = {n: y[n] == x[f"code_{n}"] for n in group}
        usable = {n: ca.logic_and(ca.logic_not(u[f"fault_{n}"]), ca.logic_not(x[f"excluded_{n}"])) for n in group}
        next: dict[str, ca.SX] = {f"code_{n}": y[n] for n in group}
        longest = decision.longest(False)
        next |= {f"still_{n}": redundancy_decision.count(same[n], x[f"still_{n}"], longest) for n in group}
        value, suspects, named = dict[str, ca.SX](), dict[str, ca.SX](), list[tuple[Signal, ca.SX]]()
        determined, sufficient, learnt = ca.SX(1), ca.SX(1), dict[str, ca.SX]()
        sound = calm = ca.logic_and(u["ready"], ca.logic_and(u["complete"], ca.logic_not(x["degraded"])))
        for i, relation in enumerate(relations):
            vote = _vote(i, relation, by_name, u, x, next, usable, same, decision)
            value |= vote.value
            suspects |= vote.suspects
            next |= vote.next
            learnt |= vote.learnt
            named += vote.named
            determined = ca.if_else(vote.regular, determined, 0)
            sufficient = ca.if_else(vote.sufficient, sufficient, 0)
            calm = ca.logic_and(calm, vote.agreement)
        regular = determined
        for n in singles:
            calm = ca.logic_and(calm, u[f"{n}_usual"])
            suspects[n] = u[f"{n}_suspect"]
            regular = ca.logic_and(u[f"{n}_trusted"], regular)
        degraded = x["degraded"]
        for flag in suspects.values():
            degraded = ca.if_else(flag, 1, degraded)
        unusual = {f"{n}_held": v for n, v in value.items()} | {f"suspect_{n}": suspects[n] for n in names}
        unusual |= {"regular": regular, "sufficient": sufficient, "determined": determined}
        usual = {f"{n}_held": y[n] for n in group} | {f"suspect_{n}": ca.SX(0) for n in names}
        output = {n: ca.if_else(calm, usual.get(n, ca.SX(1)), v) for n, v in unusual.items()}
        output[safety.SOUND.name] = sound
        output["degraded"] = ca.if_else(calm, 0, u["ready"])
        decisions = {n: v for n, v in next.items() if not n.startswith(("code_", "still_"))}
        zeros = {f"contradictions_{i}": ca.SX(0) for i in range(len(relations))}
        next |= {n: ca.if_else(calm, zeros.get(n, x[n]), v) for n, v in (decisions | {"degraded": degraded}).items()}
        next |= {n: ca.if_else(calm, v, x[n]) for n, v in learnt.items()}
        label(same=same, usable=usable, calm=calm, determined=determined, sound=sound, decisions=decisions)
        return Step(output, next, named, numbers=decision.numbers(by_name, relations))

    made = build(
        safety.REDUNDANCY, time, law,
        inputs=redundancy_decision.inputs(grouped, singles),
        outputs=redundancy_decision.outputs(sensors, grouped),
        states=redundancy_decision.states(grouped, relations, decision),
        tag="parity, innovations, frozen codes",
    )  # fmt: skip
    return replace(made, failures=of_redundancy(by_name, relations, singles, decision))


@dataclass(frozen=True, eq=False)
class _Vote:
    value: dict[str, ca.SX]
    suspects: dict[str, ca.SX]
    next: dict[str, ca.SX]
    learnt: dict[str, ca.SX]
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
    agreement, learnt = ca.fabs(r) <= relation.threshold, dict[str, ca.SX]()
    if relation.gain:
        part, bound, change = redundancy_decision.LEARNT, x[f"bound_{i}"], r - x[f"last_residual_{i}"]
        agreement = r * r <= bound
        increase = part * relation.threshold**2 + part * relation.gain * (change * change)
        label(change=change, increase=increase)
        learnt = {f"last_residual_{i}": r, f"bound_{i}": ca.fmin((1 - part) * bound + increase, relation.largest**2)}
    whole = ca.SX(1)
    for n in names:
        whole = ca.logic_and(whole, usable[n])
    agrees = ca.logic_or(agreement, ca.logic_not(u["ready"]))
    count, stuck, undecided = (x[f"{of}_{i}"] for of in ("contradictions", "stuck", "undecided"))
    excluded, stands = {n: x[f"excluded_{n}"] for n in names}, {n: still[f"still_{n}"] for n in names}

    def by_case(agreeing: ca.SX, contradictory: ca.SX, incomplete: ca.SX) -> ca.SX:
        return ca.if_else(whole, ca.if_else(agrees, agreeing, contradictory), incomplete)

    decided = ca.logic_not(undecided)
    of = call(f"isolation_{i}", _isolate, weights, signals, y, expected, r, ca.fabs(r), stands, decided)
    E, score, isolated = of.E, of.score, of.isolated
    final = ca.if_else(count >= decision.persistent - 1, 1.0, 0.0)
    left_out_now = {n: isolated[n] * final for n in names}
    stuck_now = sum((ca.if_else(stands[n] >= FRESH, left_out_now[n], 0.0) for n in names), start=ca.SX(0))
    faults = {n: u[f"fault_{n}"] for n in names}
    readmitted, doubted = call(f"readmission_{i}", _readmit, names, same, faults, stuck, excluded, undecided)
    missing = sum((ca.if_else(usable[n], 0, 1) for n in names), start=ca.SX(0))
    waited = ca.if_else(count >= decision.undecided - 1, 1, undecided)
    left_out = {n: ca.logic_and(excluded[n], ca.logic_not(readmitted[n])) for n in names}
    value, suspects = {}, {}
    replaced = call(f"replacement_{i}", _replace, weights, signals, y, expected, usable, r, missing)
    for n in names:
        value[n] = by_case(y[n], of.corrected[n], replaced[n])
        suspects[n] = ca.if_else(by_case(undecided, isolated[n] + waited, excluded[n] + doubted) > 0, 1, 0)
    next = {
        f"contradictions_{i}": by_case(
            ca.SX(0), redundancy_decision.count(ca.SX(1), count, decision.undecided), ca.SX(0)
        ),
        f"stuck_{i}": by_case(stuck, ca.if_else(stuck_now + stuck > 0, 1, 0), stuck),
        f"undecided_{i}": by_case(undecided, waited, doubted),
        **{f"excluded_{n}": by_case(excluded[n], left_out_now[n], left_out[n]) for n in names},
    }
    enough = missing <= 1
    regular = by_case(decided, ca.logic_not(waited), ca.logic_and(enough, ca.logic_not(doubted)))
    sufficient = ca.if_else(whole, 1, missing <= decision.tolerated)
    shown = redundancy_decision.signals(i, signals[names[0]].unit, r, E, score)
    label(
        E=E, score=score, final=final, agrees=agrees, agreement=agreement, whole=whole, waited=waited, doubted=doubted,
        decided=decided, enough=enough, missing=missing, isolated=isolated, left_out_now=left_out_now,
        stuck_now=stuck_now, readmitted=readmitted,
    )  # fmt: skip
    return _Vote(value, suspects, next, learnt, regular, sufficient, agreement, shown)


@dataclass(frozen=True, eq=False)
class _Isolation:
    """By reading: innovation in the direction of r, score, 1 where it is the wrong one, and what it then should be."""

    E: Exprs
    score: Exprs
    isolated: Exprs
    corrected: Exprs


def _isolate(
    weights: Mapping[str, float],
    signals: Mapping[str, Signal],
    y: Exprs,
    expected: Exprs,
    r: ca.SX,
    size: ca.SX,
    stands: Exprs,
    decided: ca.SX,
) -> _Isolation:
    direction = {n: ca.if_else(r > 0, w, -w) for n, w in weights.items()}
    E = {n: direction[n] * (y[n] - expected[n]) for n in weights}
    score, best, clear = redundancy_decision.isolate([*weights], E, stands, size, decided)
    least = ca.if_else(clear, best, 2 * redundancy_decision.PREFERENCE)
    isolated = {n: ca.if_else(score[n] >= least, 1.0, 0.0) for n in weights}
    corrected = {n: clip(y[n] - isolated[n] * r / w, signals[n]) for n, w in weights.items()}
    label(direction=direction, best=best, least=least)
    return _Isolation(E, score, isolated, corrected)


def _readmit(
    names: Sequence[str], same: Exprs, faults: Exprs, stuck: ca.SX, excluded: Exprs, undecided: ca.SX
) -> tuple[dict[str, ca.SX], ca.SX]:
    """Return which excluded readings move again, and whether the group is in doubt since one of them does."""
    moves = {n: ca.logic_and(ca.logic_not(same[n]), ca.logic_not(faults[n])) for n in names}
    readmitted = {n: ca.logic_and(stuck, ca.logic_and(excluded[n], moves[n])) for n in names}
    wrong_choice = ca.SX(0)
    for n in names:
        wrong_choice = ca.logic_or(wrong_choice, readmitted[n])
    return readmitted, ca.if_else(wrong_choice, 1, undecided)


def _replace(
    weights: Mapping[str, float],
    signals: Mapping[str, Signal],
    y: Exprs,
    expected: Exprs,
    usable: Exprs,
    r: ca.SX,
    missing: ca.SX,
) -> dict[str, ca.SX]:
    """Return the readings of a group, for one that is not usable what the others or the motion predict."""
    value = {}
    for n, w in weights.items():
        predicted = ca.if_else(missing <= 1, y[n] - r / w, expected[n])
        value[n] = clip(ca.if_else(usable[n], y[n], predicted), signals[n])
        label(n, predicted=predicted)
    return value


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
        decision.require(n)
    if decision.persistent < 1 or decision.undecided < decision.persistent:
        raise SignalError(
            f"a sensor is excluded after {decision.persistent} samples and a group undecided after "
            f"{decision.undecided}: give at least 1, and no fewer for the second"
        )
    return singles
