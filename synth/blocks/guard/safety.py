"""Input range check with hold, and fault latch: fault handling of a controller, in front of its `safe_output`.

An input is accepted when low <= value <= high; NaN fails both comparisons. While an input is refused, its last accepted
value replaces it; before the first accepted value, the declared initial one does. For an input that is not held, the
initial value always does, which is enough where the consumer ignores samples that are not ``complete``. After
`bad_samples` consecutive samples in which a *measurement* is refused, not necessarily the same one, the controller
latches: the outputs slew at a declared rate to the declared safe output and stay there until `init`. A *set-point*
never causes a latch.

    inputs --->[ guard ]---> <name>_held ---> controller ---> <name>_computed --->[ safe output ]---> outputs
                 ^ |------------------------- latched -------------------------------^
                 '-- suspected, suspect_<name> <---- [ states of a Block that compares measurements ]

A guard with `braking` samples latches that much later. From the `bad_samples`-th bad sample on its output
``latch_certain`` is 1, and each later sample counts as bad. From the next one on ``brakes`` is 1; a law that reads it
brings the machine to rest before the outputs go to their safe values. In the last of these samples ``may_latch`` is 1.

A measurement in its range may still contradict the others. A Block that detects this sets ``suspected`` from the next
sample on, and ``suspect_<name>`` of each measurement that may be wrong. Their values are passed on unchanged. No sample
is ``complete`` while `suspected` is set, so a persistent suspicion causes a latch.

What the C names and what its header tables: the numbers of limits and of the samples until the latch, and the failures
that a guard notices.

Leaky counter of bad samples: a bad one takes away as much as several good ones give back.

    n' = n - c after a bad sample, min(n + 1, N c) after a good one;   it is due in the bad sample in which n <= c

With N bad samples in a row it is due in the last of them, and sooner or later wherever more than one sample of c + 1 is
bad. Without leak, c = 1, and one good sample restores all.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Protocol

import casadi as ca

from synth import arguments
from synth.block import LATCH_BIT, Block, Constant, Exprs, Fault, Safety, State, Step, build
from synth.errors import SignalError
from synth.fault import BRAKING_BIT, Failure, Judgement, enumeration
from synth.law import label
from synth.signals import Signal
from synth.timing import Discrete


def limit(name: str, value: float, unit: str, source: str) -> Constant:
    """Return a number that something is compared with or limited to."""
    return Constant(name, value, unit, source, is_limit=True)


def ends(of: Signal) -> list[Constant]:
    """Return ``highest_<signal>``, and ``lowest_<signal>`` of a range that is not about 0."""
    highest = limit(f"highest_{of.name}", of.high, of.unit, "end of its range")
    lowest = limit(f"lowest_{of.name}", of.low, of.unit, "end of its range")
    return [highest] if of.low == -of.high else [highest, lowest]


REFUSED = "not finite or outside its range"
INITIAL = "always its initial value"


class Guarded(Protocol):
    """An input of the guard, as `safety.GuardedInput` is."""

    @property
    def signal(self) -> Signal:
        """Its name, unit and range."""
        ...

    @property
    def initial(self) -> float:
        """Its value before the first good one."""
        ...

    @property
    def measurement(self) -> bool:
        """Whether it causes a latch."""
        ...

    @property
    def held(self) -> bool:
        """Whether its last good value replaces it."""
        ...


def of_guard(
    inputs: Sequence[Guarded], too_many: str, suspected: Sequence[str], redundant: bool, braking: int
) -> tuple[Failure, ...]:
    """Return the rows of measurements, of those that may be suspects, and of the other inputs.

    Behind a `redundant` guard another Block replaces measurements as soon as all were good in one sample. `too_many`
    says how many bad samples latch.
    """
    latches = f"brakes for {braking - 1} samples, then latches" if braking else "latches"
    together = f"{too_many}, of any of them: {latches}"
    rows = []
    for held in (True, False):
        names = [g.signal.name for g in inputs if g.measurement and g.held == held]
        what, key = f"{enumeration(names)} {REFUSED}", "refused" if held else "refused_not_held"
        if redundant:
            what, key = f"{what}, before all were good in one sample", "refused_at_first"
        reaction = f"the law goes on; {together}"
        instead = "what the others or a prediction say" if redundant else _instead(held)
        rows += [Failure(key, what, "in that sample", instead, reaction, tuple(names))] if names else []
    if suspected and not redundant:
        what = f"{enumeration(suspected)} contradicts the others"
        reaction = f"counts as refused: {together}"
        rows.append(Failure("suspected", what, "from the next sample on", "nothing", reaction, (), tuple(suspected)))
    for held in (True, False):
        names = [g.signal.name for g in inputs if not g.measurement and g.held == held]
        what, key = f"{enumeration(names)} {REFUSED}", "set_point" if held else "set_point_not_held"
        reaction = "the law goes on; never latches"
        rows += [Failure(key, what, "in that sample", _instead(held), reaction, tuple(names))] if names else []
    return tuple(rows)


def _instead(held: bool) -> str:
    return "its last good value" if held else INITIAL


def full(samples: int, good_samples: int) -> int:
    """Return N c, the count after init: of `samples` in a row, where `good_samples` make up for one of them."""
    return samples * max(good_samples, 1)


def is_due(left: ca.SX, good_samples: int) -> ca.SX:
    """Return whether a bad sample is the last one."""
    return left <= max(good_samples, 1)


def next_count(good: ca.SX, left: ca.SX, samples: int, good_samples: int) -> ca.SX:
    """Return the count one sample later; the last bad sample leaves it as it is."""
    cost, most = max(good_samples, 1), full(samples, good_samples)
    restored = ca.if_else(left >= most, left, left + 1) if good_samples else most
    label(good=good)
    return ca.if_else(good, restored, ca.if_else(is_due(left, good_samples), left, left - cost))


def state(samples: int, good_samples: int, about: str) -> State:
    """Return the state of the counter."""
    most = full(samples, good_samples)
    unit = f", in 1/{good_samples} of a sample" if good_samples else ""
    return State(Signal("left", "1", 1, max(most, 2), f"{about}{unit}"), most, True)


def numbers(name: str, samples: int, good_samples: int, about: str) -> list[Constant]:
    """Return the numbers of the counter that the C names."""
    if not good_samples:
        return [Constant(name, samples, "1", about, ("left",))]
    return [
        Constant(name, full(samples, good_samples), "1", f"{about}, times {good_samples}", ("left",)),
        Constant("good_per_bad", good_samples, "1", "good samples that make up for a bad one", ("left",)),
    ]


def rule(samples: int, good_samples: int) -> str:
    """Return when the counter is due, as text."""
    return f"{samples} samples in a row" + (f", or more than 1 in {good_samples + 1} for long" if good_samples else "")


def check(good_samples: int, braking: int = 0) -> None:
    """Raise SignalError for a negative number, and for one of a guard that brakes: it counts samples in a row."""
    if good_samples < 0 or (good_samples and braking):
        raise SignalError(
            f"{good_samples} good samples make up for a bad one, with {braking} samples of braking: give 0, where one "
            "good sample restores all, or more without braking"
        )


MAY_LATCH_FROM = 2  # samples left, of a guard that brakes, before one that may latch


def about_left(braking: int) -> str:
    """Return what the count until the latch counts."""
    certain = f"; at {braking} and below each sample counts as bad" if braking else ""
    return f"samples with a bad measurement until it latches{certain}"


def latch(bad: int, braking: int, good_samples: int) -> list[Constant]:
    """Return the numbers of samples that the C names, for a latch after `bad` ones and those of `braking`."""
    about = "bad samples in a row until it latches"
    if not braking:
        return numbers("latch_samples", bad, good_samples, about)
    total = bad + braking
    about = f"{bad} bad samples in a row, and {braking} that count as bad whatever is measured, until it latches"
    certain = (
        f"of the {total}, left in the sample that first sets bit {BRAKING_BIT}; fewer are left in those that brake"
    )
    brakes = f"of the {total}, left in the first sample that brakes; from it on each one counts as bad"
    return [
        *numbers("latch_samples", total, good_samples, about),
        Constant("latch_certain_from", braking + 1, "1", certain, ("left",)),
        Constant("braking_from", braking, "1", brakes, ("left",)),
        Constant(
            "may_latch_from", MAY_LATCH_FROM, "1", f"of the {total}, left in the sample before the latch", ("left",)
        ),
    ]


__all__ = [
    *("BRAKING_BIT", "GUARD", "LANDING", "LATCH_BIT", "MONITOR", "REDUNDANCY", "NO_SAFE_OUTPUT", "SAFE_OUTPUT"),
    *("BRAKES", "GuardedInput", "LATCH_CERTAIN", "MAY_LATCH", "Safety", "SOUND", "SUSPECTED", "frozen", "guard"),
    "without_latch",
]

GUARD, SAFE_OUTPUT, SUSPECTED = "guard", "safe_output", "suspected"
LATCH_CERTAIN = Signal("latch_certain", "1", 0, 1, "too many bad samples in a row: a latch follows")
BRAKES = Signal("brakes", "1", 0, 1, "the latch was certain in the sample before: the law brakes")
MAY_LATCH = Signal("may_latch", "1", 0, 1, "the next sample may latch: the safe output then starts from this one")
BIT_TEXT = (
    "a latch is certain: after the first sample with this bit it brakes for {} samples, then latches; set until init"
)
REDUNDANCY, LANDING = "redundancy", "landing"  # names of the Blocks that replace readings and that land
MONITOR = "monitor"  # end of the name of a Block that replaces the readings of one sensor
JUDGING = Signal("judging", "1", 0, 1, "readings are compared with predictions, which stand still once latched")
SOUND = Signal("sound", "1", 0, 1, "all readings are good, and no sensor was ever a suspect")
SUFFICIENT, LANDED = "sufficient", "landed"  # flags by which they decide on the latch
RESTS = "rests"  # flag by which they choose the safe output
NO_SAFE_OUTPUT = "no output has a safe value: once latched it keeps running and reports the latch in the fault word"


@arguments.checked
@dataclass(frozen=True)
class GuardedInput:
    """An input with its value before the first good sample; only a measurement causes a latch.

    An input that is not `held` takes that value whenever it is refused, and needs no state. Raises SignalError for a
    field of another kind.
    """

    signal: Signal
    initial: float
    measurement: bool
    held: bool = True


@arguments.checked
def guard(
    time: Discrete,
    inputs: Sequence[GuardedInput],
    bad_samples: int,
    suspected: Sequence[str] = (),
    safe_output_effect: str = NO_SAFE_OUTPUT,
    redundant: bool = False,
    braking: int = 0,
    good_samples: int = 0,
) -> Block:
    """Return the Block that accepts or replaces each input.

    Its outputs are ``<name>_held`` and ``fault_<name>`` and, with a measurement among the inputs, also ``complete``
    (every measurement is accepted and none is suspected), ``ready`` (an earlier sample was complete) and ``latched``
    (this sample included). For measurements that may be `suspected` it has the additional inputs ``suspected`` and
    ``suspect_<name>``, and an output ``fault_suspect_<name>`` for each: ``suspected`` and ``suspect_<name>`` are both
    set; a `redundant` guard has no ``suspected``. ``complete`` then depends on these measurements alone, so they are
    compared even while others are refused.

    `safe_output_effect` says what a latch does without a safe output, for a guard that is composed with none. With
    `braking` samples between the last of the bad samples and the latch there are also the outputs ``latch_certain`` and
    ``brakes``. Behind a `redundant` guard a Block replaces readings and judges them: once ready, the latch counts
    samples in which its ``sufficient`` is 0, and ``landed`` causes the latch at once. A suspect is then no reason to
    latch. The `fault.Judgement` declares this. Its output ``judging`` says that it is ready and has not latched before
    this sample: the observers of a latched controller stand still, and no reading contradicts them. Such a guard does
    not brake: its law lands the machine before the latch.

    With `good_samples` these make up for a bad one (`bad_samples`), so that bad samples with good ones between them
    latch, too; with 0 one good sample makes up for all before it.

    The bits of the fault word are those of the inputs in their order, then of the suspects in theirs, BRAKING_BIT with
    `braking`, and LATCH_BIT.

    Raises SignalError for more inputs and suspects than the fault word has bits, for fewer than one bad sample, for
    negative `braking` or any without a measurement, with `good_samples` or of a `redundant` guard, for negative
    `good_samples`, for an initial value outside its range,
    or for a suspected name that is not a measurement or is listed twice.
    """
    _check_guard(inputs, bad_samples, suspected, braking, redundant)
    check(good_samples, braking)
    samples = bad_samples + braking
    held_inputs = [g for g in inputs if g.held]
    measured = [g.signal.name for g in inputs if g.measurement]
    suspects = [_flag(f"suspect_{name}", "contradicts the other measurements") for name in suspected]

    def law(u: Exprs, x: Exprs, k: Exprs) -> Step:
        good = {s.name: ca.logic_and(u[s.name] >= s.low, u[s.name] <= s.high) for s in (g.signal for g in inputs)}
        last = {g.signal.name: x[f"last_{g.signal.name}"] for g in held_inputs}
        held = {n: ca.if_else(good[n], u[n], last[n] if n in last else k[f"refused_{n}"]) for n in good}
        next = {f"last_{n}": held[n] for n in last}
        output = {f"{n}_held": held[n] for n in good} | {f"fault_{n}": ca.logic_not(good[n]) for n in good}
        output |= {
            f"fault_{s.name}": u[s.name] if redundant else ca.logic_and(u[SUSPECTED], u[s.name]) for s in suspects
        }
        if measured:
            complete, final = ca.SX(1), is_due(x["left"], good_samples)
            for n in suspected or measured:
                complete = ca.if_else(good[n], complete, 0)
                label(n, complete=complete)
            complete = ca.if_else(u[SUSPECTED], 0, complete) if suspects and not redundant else complete
            others = ca.SX(1)
            for n in (n for n in measured if suspects and n not in suspected):
                others = ca.if_else(good[n], others, 0)
            every = ca.logic_and(complete, others) if suspects and not others.is_constant() else complete
            if braking:
                every = ca.if_else(x["left"] <= braking, 0, every)
                output[LATCH_CERTAIN.name] = ca.if_else(every, 0, x["left"] <= braking + 1)
                output[BRAKES.name] = x["left"] < braking + 1  # a test of its own: a law behind it can skip the other
                output[MAY_LATCH.name] = x["left"] <= MAY_LATCH_FROM
            enough = ca.if_else(x["ready"], u[SUFFICIENT], every) if redundant else every
            gave_up = ca.if_else(enough, x["latched"], ca.if_else(final, 1, x["latched"]))
            latched = ca.if_else(u[LANDED], 1, gave_up) if redundant else gave_up
            next["left"] = next_count(enough, x["left"], samples, good_samples)
            next |= {"latched": ca.if_else(latched, 1, x["latched"]), "ready": ca.if_else(every, 1, x["ready"])}
            output |= {"latched": latched, "ready": x["ready"], "complete": complete}
            output |= {JUDGING.name: ca.logic_and(x["ready"], ca.logic_not(x["latched"]))} if redundant else {}
            label(complete=complete, others=others, every=every, enough=enough, final=final)
            label(gave_up=gave_up, latched=latched)
        label(good=good)
        return Step(output, next, numbers=latch(bad_samples, braking, good_samples) if measured else [])

    last = "last good value"
    states = [State(replace(g.signal, name=f"last_{g.signal.name}", about=last), g.initial) for g in held_inputs]
    left = state(samples, good_samples, about_left(braking))
    flags = [_flag("latched", "latched until init"), _flag("ready", "every measurement was good at once")]
    states += [left, *(State(f, 0, True) for f in flags)] if measured else []
    outputs = [replace(g.signal, name=f"{g.signal.name}_held") for g in inputs]
    outputs += [_flag(f"fault_{g.signal.name}", "refused this sample") for g in inputs]
    outputs += [_flag(f"fault_{s.name}", s.about) for s in suspects]
    outputs += [*flags, _flag("complete", "every measurement that is compared is good")] if measured else []
    outputs += [JUDGING] if redundant and measured else []
    outputs += [LATCH_CERTAIN, BRAKES, MAY_LATCH] if braking else []
    read = [g.signal for g in inputs]
    read += [_flag(SUSPECTED, "there are suspects")] if suspects and not redundant else []
    read += suspects
    read += [_flag(SUFFICIENT, "it can be controlled"), _flag(LANDED, "landing is over")] if redundant else []
    block = build(
        GUARD, time, law, inputs=read, outputs=outputs, states=states,
        constants=[_replacement(g) for g in inputs if not g.held], tag="range acceptance, hold, latch",
    )  # fmt: skip
    faults = [Fault(i, f"fault_{g.signal.name}", g.signal.name) for i, g in enumerate(inputs)]
    faults += [Fault(i, f"fault_suspect_{n}", suspect=n) for i, n in enumerate(suspected, len(inputs))]
    faults += [Fault(BRAKING_BIT, LATCH_CERTAIN.name, about=BIT_TEXT.format(braking - 1))] if braking else []
    faults += [Fault(LATCH_BIT, "latched")] if measured else []
    judgement = Judgement(SUFFICIENT, LANDED, tuple(measured)) if redundant else None
    declared = Safety(samples, {}, {}, safe_output_effect, judgement, braking, good_samples) if measured else None
    row = rule(bad_samples, good_samples)
    failures = of_guard(inputs, row, suspected, redundant, braking)
    return replace(block, faults=tuple(faults), safety=declared, failures=failures)


@arguments.checked
def frozen(block: Block) -> Block:
    """Return a guarded composition whose states, except the guard's and the last outputs, are frozen once latched.

    These states no longer influence the outputs, so a latched step computes only the slew.

    Raises SignalError for a Block that does not latch.
    """
    latched = next((block.output[f.output] for f in block.faults if f.bit == LATCH_BIT), None)
    if latched is None:
        raise SignalError(f"block '{block.name}' has no fault bit {LATCH_BIT}: compose it with a guard of measurements")
    still = [s.name for s in block.states if not s.name.startswith((f"{GUARD}_", f"{SAFE_OUTPUT}_"))]
    held = {n: ca.if_else(latched, block.symbol[n], block.next[n]) for n in still}
    return replace(block, next={**block.next, **held})


@arguments.checked
def without_latch(block: Block) -> Block:
    """Return a guarded composition that never latches, excludes no sensor and does not land.

    It is the negative control of a fault campaign. Raises SignalError for a Block that does not latch.
    """
    states = {s.name: s for s in block.states}
    left, latched = f"{GUARD}_left", f"{GUARD}_latched"
    if left not in states or latched not in states:
        raise SignalError(f"block '{block.name}' has no latch: compose it with a guard of measurements")
    detecting = tuple(f"{REDUNDANCY}_{of}_" for of in ("still", "excluded", "contradictions"))
    monitored = tuple(f"_{MONITOR}_{of}" for of in ("still", "excluded"))
    off = [latched, *(n for n in states if n.startswith(detecting) or n.endswith(monitored))]
    waiting = [n for n in (left, f"{LANDING}_left") if n in states]
    never = dict.fromkeys(off, ca.SX(0)) | {n: ca.SX(states[n].signal.high) for n in waiting}
    return replace(block, next={**block.next, **never})


def _check_guard(
    inputs: Sequence[GuardedInput], bad_samples: int, suspected: Sequence[str], braking: int, redundant: bool
) -> None:
    bits = BRAKING_BIT if braking else LATCH_BIT
    if len(inputs) + len(suspected) > bits:
        raise SignalError(
            f"{len(inputs)} inputs are guarded and {len(suspected)} may be suspects, but the fault word has "
            f"{bits} bits: split the Block"
        )
    if bad_samples < 1:
        raise SignalError(f"bad_samples is {bad_samples}: a latch needs at least 1 bad sample")
    measured = [g.signal.name for g in inputs if g.measurement]
    if braking < 0 or (braking and not measured):
        raise SignalError(
            f"the guard of {len(measured)} measurements brakes for {braking} samples: give 0 or more, and 0 without a "
            "measurement, which alone causes a latch"
        )
    if braking and redundant:
        raise SignalError(f"the guard is redundant and brakes for {braking} samples: give 0, its law lands the machine")
    for name in suspected:
        if name not in measured or len(set(suspected)) < len(suspected):
            raise SignalError(
                f"suspected are {', '.join(suspected)}, but '{name}' is not a measurement or one is listed twice: "
                f"name each once, among {', '.join(measured) or 'no measurements'}"
            )


def _replacement(g: GuardedInput) -> Constant:
    if not g.signal.low <= g.initial <= g.signal.high:
        raise SignalError(
            f"the initial value {g.initial} of '{g.signal.name}' is outside {g.signal.low} .. {g.signal.high}: "
            "choose one inside"
        )
    where = ", in a sample that is not complete" if g.measurement else ""
    return Constant(f"refused_{g.signal.name}", g.initial, g.signal.unit, f"in place of a refused value{where}")


def _flag(name: str, about: str) -> Signal:
    return Signal(name, "1", 0, 1, about)
