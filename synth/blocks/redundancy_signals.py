"""Inputs, outputs and states of `redundancy`."""

from collections.abc import Sequence
from dataclasses import replace

from synth.analyse.parity import Relation
from synth.block import State
from synth.blocks import safety
from synth.blocks.redundancy_decision import DOUBTS, Decision
from synth.signals import Signal


def _flag(name: str, about: str) -> Signal:
    return Signal(name, "1", 0, 1, about)


def inputs(sensors: Sequence[Signal], probed: Sequence[str], missed_calls: Signal | None) -> list[Signal]:
    """Return the inputs; `probed` are the sensors that a probe asks."""
    accepted = [replace(s, name=f"{s.name}_accepted") for s in sensors]
    faults = [_flag(f"fault_{s.name}", "refused this sample") for s in sensors]
    expected = [replace(s, name=f"{s.name}_expected", about="prediction") for s in sensors]
    answers = [_flag(f"{n}_unanswered", "no pair of the probe was answered") for n in probed]
    ready = [_flag("ready", "every measurement was good at once"), _flag("complete", "all are good")]
    return [*accepted, *faults, *expected, *answers, *ready, safety.JUDGING, *([missed_calls] if missed_calls else [])]


def outputs(sensors: Sequence[Signal], singles: Sequence[str]) -> list[Signal]:
    """Return the outputs; `singles` are the sensors without a group."""
    flags = [_flag(f"suspect_{s.name}", "wrong, or may be: contradicts the others or is frozen") for s in sensors]
    flags += [_flag(f"{n}_trusted", "measured, not predicted") for n in singles]
    flags += [
        _flag(f"{n}_frozen", "its code stands still although it ought to move, or it is excluded") for n in singles
    ]
    unchanged = [Signal(f"{n}_unchanged", "1", 0, 1e6, "samples without a change of the code") for n in singles]
    held = [replace(s, name=f"{s.name}_held", about=s.about) for s in sensors]
    return [
        *held, *flags, *unchanged,
        _flag("regular", "every coordinate is measured"), _flag("sufficient", "the machine can be controlled"),
        _flag("determined", "every coordinate of the groups is measured"),
        _flag("degraded", "a reading is refused, replaced or contradicted, or a sensor was a suspect"),
    ]  # fmt: skip


def states(
    sensors: Sequence[Signal], relations: Sequence[Relation], singles: Sequence[str], decision: Decision
) -> list[State]:
    """Return the states of the sensors, of the relations and of the whole."""
    declared = []
    for s in sensors:
        start = (s.low + s.high) / 2
        longest = decision.longest(s.name in singles)
        declared.append(State(replace(s, name=f"code_{s.name}", about="accepted reading one sample ago"), start))
        declared.append(State(Signal(f"still_{s.name}", "1", 0, longest, "samples without a change"), 0, True))
        declared.append(State(_flag(f"excluded_{s.name}", "wrong until init"), 0, True))
        if s.name in singles:
            doubts = Signal(f"doubts_{s.name}", "1", 0, DOUBTS, "changes until its prediction is believed")
            declared.append(State(doubts, DOUBTS, True))
            declared.append(State(replace(s, name=f"before_{s.name}", about="prediction at the last change"), start))
        if s.name in decision.jump:
            jumps = Signal(
                f"jumps_{s.name}", "1", 0, max(decision.persistent - 1, 1), "samples in a row far from its prediction"
            )
            declared.append(State(jumps, 0, True))
    for i in range(len(relations)):
        count = Signal(f"contradictions_{i}", "1", 0, decision.undecided, "samples in a row")
        declared.append(State(count, 0, True))
        declared.append(State(_flag(f"stuck_{i}", "the excluded sensor stood still"), 0, True))
        declared.append(State(_flag(f"undecided_{i}", "which sensor is wrong is not known"), 0, True))
    return [*declared, State(_flag("degraded", "a sensor was a suspect or is excluded, until init"), 0, True)]
