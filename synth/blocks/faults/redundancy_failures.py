"""Failures that `redundancy` notices, as rows of the header's table, with the numbers of its decisions."""

from collections.abc import Mapping, Sequence

from synth.analyse.structure.parity import Relation
from synth.blocks.faults.isolation import FRESH, STILL
from synth.blocks.faults.redundancy_decision import DOUBTS, Decision
from synth.blocks.guard.guard_failures import REFUSED
from synth.failure import Failure, enumeration
from synth.signals import Signal

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
    wrong = (
        f"|residual| above {relation.threshold:g} {unit} in {decision.persistent} samples in a row, and one has by far "
        f"the largest innovation or alone a code that stands still ({FRESH} or {STILL} samples): excluded until init"
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
    gates = enumeration([f"{g:g} {unit}" for g in dict.fromkeys(decision.gate[n] for n in singles)])
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
