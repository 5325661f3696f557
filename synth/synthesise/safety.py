"""Guard and safe output: what a controller does with inputs that cannot be true.

An input is accepted when low <= value <= high; NaN fails both comparisons. While it is refused the last accepted value
serves, before the first the declared initial one. A *measurement* that is refused `bad_samples` times in a row latches:
the outputs then slew at a declared rate to the declared safe output and stay there until `init`. A *set-point* never
latches.

    inputs --->[ guard ]---> <name>_held ---> controller ---> <name>_computed --->[ safe output ]---> outputs
                   |------------------------- latched -------------------------------^
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import reduce

import casadi as ca

from synth.block import Block, Exprs, Fault, State, Step, build, clip
from synth.errors import SignalError
from synth.signals import Signal
from synth.timing import Discrete

LATCH_BIT = 31


@dataclass(frozen=True)
class Guarded:
    """An input with its value before the first good sample; only a measurement latches."""

    signal: Signal
    initial: float
    measurement: bool


@dataclass(frozen=True)
class Safety:
    """After `bad_samples` bad samples of a measurement on end the outputs slew to `safe_output`; `reason` says why."""

    bad_samples: int
    safe_output: Mapping[str, float]
    slew_per_s: Mapping[str, float]
    reason: str


def guard(time: Discrete, inputs: Sequence[Guarded], bad_samples: int) -> Block:
    """Return the Block that accepts or replaces each input.

    It drives ``<name>_held``, ``fault_<name>``, ``latched`` (this sample included) and ``ready``: whether a sample
    before this one has seen every measurement accepted.

    Raises SignalError for more inputs than the fault word has bits, or for fewer than one bad sample.
    """
    if len(inputs) > LATCH_BIT:
        raise SignalError(f"{len(inputs)} inputs are guarded but the fault word has {LATCH_BIT} bits: split the Block")
    if bad_samples < 1:
        raise SignalError(f"bad_samples is {bad_samples}: a latch needs at least 1 bad sample")
    measured = [g.signal.name for g in inputs if g.measurement]
    latches = bool(measured)

    def law(u: Exprs, x: Exprs, k: Exprs) -> Step:
        good = {s.name: ca.logic_and(u[s.name] >= s.low, u[s.name] <= s.high) for s in (g.signal for g in inputs)}
        held = {n: ca.if_else(good[n], u[n], x[f"last_{n}"]) for n in good}
        next = {f"last_{n}": held[n] for n in good}
        output = {f"{n}_held": held[n] for n in good} | {f"fault_{n}": ca.logic_not(good[n]) for n in good}
        if latches:
            bad = {n: ca.if_else(good[n], 0, ca.fmin(x[f"bad_{n}"] + 1, bad_samples)) for n in measured}
            latched = reduce(ca.logic_or, [x["latched"], *(b >= bad_samples for b in bad.values())])
            ready = ca.logic_or(x["ready"], reduce(ca.logic_and, [good[n] for n in measured]))
            next |= {f"bad_{n}": b for n, b in bad.items()} | {"latched": latched, "ready": ready}
            output |= {"latched": latched, "ready": x["ready"]}
        return Step(output, next)

    states = [State(_renamed(g.signal, f"last_{g.signal.name}", "last good value"), g.initial) for g in inputs]
    states += [State(Signal(f"bad_{n}", "1", 0, bad_samples, "bad samples in a row"), 0, True) for n in measured]
    flags = [_flag("latched", "safe output until init"), _flag("ready", "every measurement was good at once")]
    states += [State(f, 0, True) for f in flags] if latches else []
    outputs = [_renamed(g.signal, f"{g.signal.name}_held", g.signal.about) for g in inputs]
    outputs += [_flag(f"fault_{g.signal.name}", "refused this sample") for g in inputs] + (flags if latches else [])
    block = build(
        "guard",
        time,
        law,
        inputs=[g.signal for g in inputs],
        outputs=outputs,
        states=states,
        tag="range acceptance, hold, latch",
    )
    faults = [Fault(i, f"fault_{g.signal.name}", g.signal.name) for i, g in enumerate(inputs)]
    faults += [Fault(LATCH_BIT, "latched", None)] if latches else []
    return replace(block, faults=tuple(faults))


def safe_output(time: Discrete, outputs: Sequence[Signal], safety: Safety) -> Block:
    """Return the Block that passes ``<name>_computed`` on as ``<name>`` and, once latched, slews to the safe output.

    Either way the output is limited to its range.

    Raises SignalError when a safe output or a rate is missing, a rate is not positive, or a safe output lies outside
    its range.
    """
    for s in outputs:
        if s.name not in safety.safe_output or s.name not in safety.slew_per_s:
            raise SignalError(f"output '{s.name}' has no safe value or no rate: declare both")
        if not s.low <= safety.safe_output[s.name] <= s.high:
            raise SignalError(
                f"the safe output {safety.safe_output[s.name]} of '{s.name}' is outside {s.low} .. {s.high}: "
                "choose one inside"
            )
        if not 0 < safety.slew_per_s[s.name] < math.inf:
            raise SignalError(
                f"output '{s.name}' slews at {safety.slew_per_s[s.name]} {s.unit} per second: "
                "the rate must be finite and positive"
            )

    def law(u: Exprs, x: Exprs, k: Exprs) -> Step:
        value = {}
        for s in outputs:
            rate = safety.slew_per_s[s.name] * time.period_s
            last = x[f"last_{s.name}"]
            move = clip(safety.safe_output[s.name] - last, Signal("move", s.unit, -rate, rate))
            value[s.name] = ca.if_else(u["latched"], last + move, u[f"{s.name}_computed"])
        return Step({s.name: clip(value[s.name], s) for s in outputs}, {f"last_{n}": v for n, v in value.items()})

    return build(
        "safe_output",
        time,
        law,
        inputs=[
            _flag("latched", "safe output until init"),
            *(_renamed(s, f"{s.name}_computed", s.about) for s in outputs),
        ],
        outputs=outputs,
        states=[State(_renamed(s, f"last_{s.name}", "last output"), safety.safe_output[s.name]) for s in outputs],
        tag="slew to the safe output once latched",
    )


def _renamed(signal: Signal, name: str, about: str) -> Signal:
    return replace(signal, name=name, about=about)


def _flag(name: str, about: str) -> Signal:
    return Signal(name, "1", 0, 1, about)
