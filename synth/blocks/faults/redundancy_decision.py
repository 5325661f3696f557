"""Decision thresholds of sensor fault detection (FDIA): the samples, gates and travels of `redundancy`, with names.

Inputs, outputs and states of `redundancy` and of `innovation_monitor`.

Fault isolation: which sensor of a parity relation is wrong.

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

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from math import inf, prod, sqrt
from statistics import NormalDist

import casadi as ca

from synth import arguments
from synth.analyse.structure.parity import Relation
from synth.block import Constant, Exprs, State
from synth.blocks.guard import safety
from synth.errors import SignalError
from synth.law import label
from synth.signals import Signal

FRESH, STILL = 3, 8  # samples without a change of the code: fewer, it moves; at least, it stands still
CANDIDATE = 0.4  # of |r|: least E by rule 1
LEAD = {"by code": 0.05, "by innovation": 0.3}  # of |r|: of the largest E over the next one, by rules 1 and 2, and 3
LEARNT = 1 / 128  # in a sample, of a squared threshold: long beside a fault, and forgotten a second after init
PLACES = 200  # of a body, over which the chance of repeated codes is averaged
PREFERENCE = 10.0  # added to E by rules 1 and 2; larger than any reading


def isolate(
    names: Sequence[str], E: Exprs, still: Exprs, size: ca.SX, decided: ca.SX
) -> tuple[dict[str, ca.SX], ca.SX, ca.SX]:
    """Return the score of each sensor, the largest, and whether that sensor explains a contradiction clearly.

    `E` and `still` (samples without a change) are by sensor, `size` is |r|. A group that is not `decided` has wrong
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
        label(n, best=best, second=second)
    standing = sum(alone.values(), start=ca.SX(0))
    by_code = candidates + standing > 0
    distinct = best - second > ca.if_else(by_code, LEAD["by code"], LEAD["by innovation"]) * size
    label(
        size=size, stands=stands, second=second, least_E=least_E, moving=moving, candidates=candidates,
        by_first_rule=by_first_rule, by_second_rule=by_second_rule, standing=standing, by_code=by_code, repeats=repeats,
        candidate=candidate, preferred=preferred,
    )  # fmt: skip
    return score, best, ca.logic_and(distinct, ca.logic_or(by_code, decided))


def signals(i: int, unit: str, r: ca.SX, E: Exprs, score: Exprs) -> list[tuple[Signal, ca.SX]]:
    """Return the signals of relation i that the C names, for readings in a unit."""
    most = 10 * PREFERENCE
    named = [(Signal(f"residual_{i}", unit, -most, most, "of the parity relation"), r)]
    named += [(Signal(f"E_{n}", unit, -most, most, "innovation that explains it"), v) for n, v in E.items()]
    return named + [(Signal(f"score_{n}", unit, -most, most, "the largest is wrong"), v) for n, v in score.items()]


def numbers_of_relation(unit: str, i: int, relation: Relation) -> list[Constant]:
    """Return the numbers of the rules and of relation i that the C names, for readings in a unit."""
    squared = f"{unit}^2"
    about = "largest |r| without a fault: half a count and an offset of each sensor"
    noisy = [
        Constant(f"quiet_part_{i}", LEARNT * relation.threshold**2, squared, f"in a sample, of the squared {about}"),
        Constant(f"learnt_part_{i}", LEARNT * relation.gain, "1", "of the squared change of r, in a sample"),
        Constant("kept_part", 1 - LEARNT, "1", "of the squared threshold, in a sample"),
        Constant(f"largest_{i}", relation.largest**2, squared, "squared threshold at the largest noise"),
    ]
    return [
        *(noisy if relation.gain else [Constant(f"threshold_{i}", relation.threshold, unit, about)]),
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


DOUBTS = 10  # changes of a code that agree until its prediction is believed, at first and after missing calls


@arguments.checked
@dataclass(frozen=True)
class Decision:
    """Samples in a row until a sensor is excluded or all are suspects, the gate of frozen sensors, and `tolerated`.

    `gate` is in the unit of each sensor without a group, by name: a prediction that is nearer agrees. A code that
    stands still while its prediction moves by more than `frozen` is frozen; without one that is the gate, and noise
    needs more (`frozen_gate`). With `at_rest` a `probe` moves such a sensor at rest,
    and needs so many samples without a change counted; 0 is for no probe. Such a sensor is free to move while its
    reading is inside `travel`; at an end, a stop may hold it. A reading further than `jump` from its prediction has
    jumped (`jump_gate`); without one no jump is looked for. Where the distance from its prediction has grown since
    the last change of the code by more than `wide_frozen` or `wide_jump`, the sensor is frozen or has jumped without an
    earlier agreement; without these it is not.
    """

    gate: Mapping[str, float]
    travel: Mapping[str, tuple[float, float]]
    persistent: int = 3
    undecided: int = 10
    at_rest: int = 0
    tolerated: int = 2
    jump: Mapping[str, float] = field(default_factory=dict)
    wide_jump: Mapping[str, float] = field(default_factory=dict)
    wide_frozen: Mapping[str, float] = field(default_factory=dict)
    frozen: Mapping[str, float] = field(default_factory=dict)

    def frozen_from(self, name: str) -> float:
        """Return the predicted motion beyond which an unchanged code of a sensor without a relation is frozen."""
        return self.frozen.get(name, self.gate[name])

    def longest(self, single: bool) -> int:
        """Return the largest count of samples without a change, of a sensor of a group or of a `single` one."""
        return max(self.at_rest if single else 0, STILL)

    def require(self, name: str) -> None:
        """Raise SignalError unless a sensor without a relation has a gate, a travel, and no other gate below it."""
        if not self.gate.get(name, 0) > 0 or name not in self.travel:
            raise SignalError(f"sensor '{name}' is in no relation and has no gate or travel: give both")
        if self.frozen_from(name) < self.gate[name]:
            gate = self.gate[name]
            raise SignalError(f"a code of '{name}' is frozen above {self.frozen[name]}, its gate {gate}: give no less")
        if self.jump.get(name, self.gate[name]) < self.gate[name]:
            jump, gate = self.jump[name], self.gate[name]
            raise SignalError(f"a jump of '{name}' is above {jump}, its gate {gate}: give no less")
        least = self.jump.get(name, self.gate[name])
        for of, wide in (("jumps", self.wide_jump), ("frozen codes", self.wide_frozen)):
            if wide.get(name, least) < least:
                raise SignalError(f"the wide gate for {of} of '{name}' is {wide[name]}, its gate {least}: give no less")

    def numbers(self, signals: Mapping[str, Signal], relations: Sequence[Relation]) -> list[Constant]:
        """Return the numbers of the groups that the C names."""
        units = (signals[next(iter(r.weights))].unit for r in relations)
        numbers = [n for i, unit in enumerate(units) for n in numbers_of_relation(unit, i, relations[i])]
        groups = dict.fromkeys(len(r.weights) - 1 for r in relations)
        others = (
            Constant(f"all_but_one_of_{n + 1}", n, "1", "sensors of a group but one", ("moving",)) for n in groups
        )
        return [
            *numbers, *self._counts(),
            *(n for r in relations for name in r.weights for n in safety.ends(signals[name])),
            Constant("undecided_from", self.undecided - 1, "1", "contradictions before all are suspects",
                     ("contradictions",)),
            Constant("most_contradictions", self.undecided, "1", "contradictions that are counted",
                     ("contradictions",)),
            Constant("tolerated_missing", self.tolerated, "1", "readings of a group that may be missing", ("missing",)),
            *others,
        ]  # fmt: skip

    def numbers_of_monitor(self, sensor: Signal) -> list[Constant]:
        """Return the numbers of the monitor of a sensor that the C names."""
        n, unit, at = sensor.name, sensor.unit, "end of the travel, where a stop may hold it"
        far = "from the prediction: no acceleration of the machine explains it"
        moved = "predicted motion in which a working code changes"
        numbers = [Constant("gate", self.gate[n], unit, "an agreeing prediction is nearer" if self.frozen else moved)]
        numbers += [Constant("frozen_gate", self.frozen[n], unit, moved)] if n in self.frozen else []
        numbers += [Constant("jump", self.jump[n], unit, far)] if n in self.jump else []
        grown = "growth of the distance to the prediction that needs no earlier agreement: of a code that"
        numbers += [Constant("wide_jump", self.wide_jump[n], unit, f"{grown} changes")] if n in self.wide_jump else []
        frozen = f"{grown} stands still"
        numbers += [Constant("wide_frozen", self.wide_frozen[n], unit, frozen)] if n in self.wide_frozen else []
        ends = zip(("low", "high"), self.travel[n], strict=True)
        return [
            *numbers, *(Constant(f"travel_{of}", v, unit, at) for of, v in ends), *self._counts(),
            Constant("most_unchanged", self.longest(True), "1", "samples without a change that are counted",
                     ("still", "unchanged")),
            Constant("doubted_changes", DOUBTS, "1", "changes of the code until its prediction is believed",
                     ("doubts",)),
        ]  # fmt: skip

    def _counts(self) -> list[Constant]:
        still, wrong, before = (
            ("still", "unchanged"),
            ("contradictions", "jumps"),
            "contradictions or jumps before the last",
        )
        return [
            Constant(
                "repeated_samples", FRESH, "1", "samples without a change of the code: fewer, and it moves", still
            ),
            Constant("still_samples", STILL, "1", "samples without a change of the code: it stands still", still),
            Constant("excluded_from", self.persistent - 1, "1", before, wrong),
        ]


@arguments.checked
def jump_gate(gate: float, acceleration: float, resolution: float, period: float) -> float:
    """Return the largest innovation of a sound sensor one sample after it was inside its `gate`.

    The acceleration differs from the prediction by at most `acceleration`, e. Such an error needs sqrt(2 gate / e) to
    leave the gate, and the rate is then wrong by sqrt(2 gate e); in the sample that follows it adds T times this and
    e T^2 / 2, and rounding may add a count.

    Raises SignalError for a negative or infinite value.
    """
    values = {"gate": gate, "acceleration": acceleration, "resolution": resolution, "period": period}
    for name, value in values.items():
        if not 0 <= value < inf:
            raise SignalError(f"gate of jumps: the {name} is {value}: give a finite number of at least 0")
    return gate + period * sqrt(2 * gate * acceleration) + acceleration * period**2 / 2 + resolution


@arguments.checked
def frozen_gate(gate: float, resolution: float, noise: float, chance: float = 1e-9) -> float:
    """Return the predicted motion d in which the code of a sound sensor repeats with a `chance`, at least its `gate`.

    It repeats m = FRESH times where the white noise of m + 1 samples, with the standard deviation sigma, `noise`, is
    opposite to a uniform motion, so that all readings are in one count q. Averaged over the place u in a count that is

        P(d) = integral of prod_k (F(u_k + q/2) - F(u_k - q/2)) du / q,   u_k = u + d (k/m - 1/2), k = 0 .. m

    with the distribution F of the noise. A larger motion, and a longer repetition, is less probable.

    Raises SignalError for a negative or infinite value, or a chance outside 0 .. 1.
    """
    for name, value in {"gate": gate, "resolution": resolution, "noise": noise}.items():
        if not 0 <= value < inf:
            raise SignalError(f"gate of frozen codes: the {name} is {value}: give a finite number of at least 0")
    if not 0 < chance < 1:
        raise SignalError(f"gate of frozen codes: the chance is {chance}: give one between 0 and 1")
    if not (noise and resolution):
        return gate
    F, reach = NormalDist(0.0, noise).cdf, 6 * noise + resolution
    places = [reach * (2 * i / PLACES - 1) for i in range(PLACES + 1)]

    def probability(d: float) -> float:
        at = ([u + d * (k / FRESH - 0.5) for k in range(FRESH + 1)] for u in places)
        inside = (prod(F(v + resolution / 2) - F(v - resolution / 2) for v in each) for each in at)
        return sum(inside) * 2 * reach / PLACES / resolution

    low, high = 0.0, 2 * (reach + resolution * FRESH)
    for _ in range(60):
        middle = (low + high) / 2
        low, high = (middle, high) if probability(middle) > chance else (low, middle)
    return max(gate, high)


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
    for i, relation in enumerate(relations):
        if relation.gain:
            unit, most = grouped[0].unit, 1.01 * _largest_residual(grouped, relation)
            last = Signal(f"last_residual_{i}", unit, -most, most, "of the parity relation one sample ago")
            low, high = 0.999 * relation.threshold**2, 1.001 * relation.largest**2
            bound = Signal(f"bound_{i}", f"{unit}^2", low, high, "largest residual without a fault, squared")
            declared += [State(last, 0.0), State(bound, relation.largest**2)]
        samples = Signal(f"contradictions_{i}", "1", 0, decision.undecided, "samples in a row")
        declared.append(State(samples, 0, True))
        declared.append(State(_flag(f"stuck_{i}", "the excluded sensor stood still"), 0, True))
        declared.append(State(_flag(f"undecided_{i}", "which sensor is wrong is not known"), 0, True))
    return [*declared, State(_flag("degraded", "a sensor was a suspect or is excluded, until init"), 0, True)]


def _largest_residual(grouped: Sequence[Signal], relation: Relation) -> float:
    ranges = {s.name: (s.low, s.high) for s in grouped}
    ends = [(w * ranges[n][0], w * ranges[n][1]) for n, w in relation.weights.items()]
    return max(abs(sum(min(pair) for pair in ends)), abs(sum(max(pair) for pair in ends)))


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
