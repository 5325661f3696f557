"""Inputs, outputs and states of `redundancy` and of `innovation_monitor`."""

from collections.abc import Sequence
from dataclasses import replace

import casadi as ca

from synth.analyse.structure.parity import Relation
from synth.block import State
from synth.blocks.faults.redundancy_decision import DOUBTS, Decision
from synth.blocks.guard import safety
from synth.signals import Signal


def count(flag: ca.SX, counted: ca.SX, most: int) -> ca.SX:
    """Return the next of a counter of samples in a row with a flag, which stays at `most`."""
    return ca.if_else(flag, ca.if_else(counted >= most, counted, counted + 1), 0)


def inputs(grouped: Sequence[Signal], singles: Sequence[str]) -> list[Signal]:
    """Return the inputs for the sensors of groups and for those without one."""
    return [*_read(grouped), *(_monitor_flag(n, of) for of in _MONITOR_FLAGS for n in singles), _READY, _COMPLETE]


def outputs(sensors: Sequence[Signal], grouped: Sequence[Signal]) -> list[Signal]:
    """Return the outputs; `grouped` are the sensors of groups."""
    flags = [_flag(f"suspect_{s.name}", "wrong, or may be: contradicts the others or is frozen") for s in sensors]
    held = [replace(s, name=f"{s.name}_held", about=s.about) for s in grouped]
    return [
        safety.SOUND, *held, *flags,
        _flag("regular", "every coordinate is measured"), _flag("sufficient", "the machine can be controlled"),
        _flag("determined", "every coordinate of the groups is measured"),
        _flag("degraded", "a reading is refused, replaced or contradicted, or a sensor was a suspect"),
    ]  # fmt: skip


def states(grouped: Sequence[Signal], relations: Sequence[Relation], decision: Decision) -> list[State]:
    """Return the states of the sensors of groups, of the relations and of the whole."""
    declared = [state for s in grouped for state in _code(s, f"_{s.name}", decision.longest(False))]
    for i in range(len(relations)):
        samples = Signal(f"contradictions_{i}", "1", 0, decision.undecided, "samples in a row")
        declared.append(State(samples, 0, True))
        declared.append(State(_flag(f"stuck_{i}", "the excluded sensor stood still"), 0, True))
        declared.append(State(_flag(f"undecided_{i}", "which sensor is wrong is not known"), 0, True))
    return [*declared, State(_flag("degraded", "a sensor was a suspect or is excluded, until init"), 0, True)]


def inputs_of_monitor(sensor: Signal, is_probed: bool, missed_calls: Signal | None) -> list[Signal]:
    """Return the inputs of the monitor of a sensor, which a probe may ask."""
    answers = [_flag(f"{sensor.name}_unanswered", "no pair of the probe was answered")] if is_probed else []
    return [*_read([sensor]), *answers, _READY, safety.SOUND, safety.JUDGING, *([missed_calls] if missed_calls else [])]


def outputs_of_monitor(sensor: Signal) -> list[Signal]:
    """Return the outputs of the monitor of a sensor."""
    n = sensor.name
    return [
        replace(sensor, name=f"{n}_held"), *(_monitor_flag(n, of) for of in _MONITOR_FLAGS),
        _flag(f"{n}_frozen", "its code stands still although it ought to move, or it is excluded"),
        Signal(f"{n}_unchanged", "1", 0, 1e6, "samples without a change of the code"),
    ]  # fmt: skip


def states_of_monitor(sensor: Signal, decision: Decision) -> list[State]:
    """Return the states of the monitor of a sensor."""
    doubts = Signal("doubts", "1", 0, DOUBTS, "changes until its prediction is believed")
    before = replace(sensor, name="before", about="prediction at the last change")
    jumps = Signal("jumps", "1", 0, max(decision.persistent - 1, 1), "samples in a row far from its prediction")
    return [
        *_code(sensor, "", decision.longest(True)),
        State(doubts, DOUBTS, True),
        State(before, _middle(sensor)),
        *([State(jumps, 0, True)] if sensor.name in decision.jump else []),
    ]


def _flag(name: str, about: str) -> Signal:
    return Signal(name, "1", 0, 1, about)


_READY, _COMPLETE = _flag("ready", "every measurement was good at once"), _flag("complete", "all are good")
_MONITOR_FLAGS = {
    "trusted": "measured, not predicted",
    "suspect": "wrong, or may be: is frozen or jumps",
    "usual": "sound, and nothing is wrong with this one",
}


def _monitor_flag(n: str, of: str) -> Signal:
    return _flag(f"{n}_{of}", _MONITOR_FLAGS[of])


def _read(sensors: Sequence[Signal]) -> list[Signal]:
    accepted = [replace(s, name=f"{s.name}_accepted") for s in sensors]
    faults = [_flag(f"fault_{s.name}", "refused this sample") for s in sensors]
    return [*accepted, *faults, *(replace(s, name=f"{s.name}_expected", about="prediction") for s in sensors)]


def _code(sensor: Signal, suffix: str, longest: int) -> list[State]:
    code = replace(sensor, name=f"code{suffix}", about="accepted reading one sample ago")
    return [
        State(code, _middle(sensor)),
        State(Signal(f"still{suffix}", "1", 0, longest, "samples without a change"), 0, True),
        State(_flag(f"excluded{suffix}", "wrong until init"), 0, True),
    ]


def _middle(sensor: Signal) -> float:
    return (sensor.low + sensor.high) / 2
