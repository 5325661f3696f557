"""Screening of grouped measurements: refused readings, and converters that repeat a code; one faulty group is rejected.

    repeats_i = repeats_i + 1 while y_i(k) = y_i(k-1), else 0;    a channel is frozen when repeats_i reaches its limit
    a group is faulty when the guard refuses one of its channels in this sample, or one is frozen
    rejected = number of the only faulty group, else 0;           screened = no group or one group is faulty

A converter whose noise spreads over several codes repeats one n times in a row with a probability of about p^n, where
p = step / (2 sqrt(pi) sigma) for a normal noise sigma. Without noise, as in a simulation of ideal sensors, a body at
rest is indistinguishable from a frozen converter.

Source: Gertler, "Fault Detection and Diagnosis in Engineering Systems", section 1.3 (limit and plausibility checks).
"""

from collections.abc import Sequence
from dataclasses import replace
from functools import reduce

import casadi as ca

from synth import arguments, numeric
from synth.block import Block, Exprs, State, Step, build, clip
from synth.errors import SignalError
from synth.signals import Signal, signal_names
from synth.timing import Discrete

MOST_REPEATS = 1000
SCREENED = Signal("screened", "1", 0, 1, "no group of channels is faulty, or a single one, which is rejected")


@arguments.checked
def screen(time: Discrete, channels: Sequence[Signal], groups: Sequence[Sequence[str]], repeats: int) -> Block:
    """Return the Block from ``<channel>_held`` and ``fault_<channel>`` of a guard to ``rejected`` and ``screened``.

    `groups` are the names of the channels that fail together, each channel in one of them.

    Raises SignalError for groups that are no partition of the channels, ModelError for repeats out of 1 .. 1000.
    """
    names, listed = signal_names(channels), [name for group in groups for name in group]
    if sorted(names) != sorted(listed) or not all(groups):
        raise SignalError(f"the groups have {', '.join(listed)}: give each of {', '.join(names)} in one group")
    limit = numeric.whole("the number of repeats", repeats, 1, MOST_REPEATS)
    rejected = Signal("rejected", "1", 0, len(groups), "number of the group of channels that is refused or frozen")

    def law(u: Exprs, x: Exprs, k: Exprs) -> Step:
        next: dict[str, ca.SX] = {}
        faulty: dict[str, ca.SX] = {}
        for name in names:
            value = u[f"{name}_held"]
            count = (value == x[f"last_{name}"]) * ca.fmin(x[f"repeats_{name}"] + 1, limit)
            next |= {f"last_{name}": value, f"repeats_{name}": count}
            faulty[name] = ca.logic_or(u[f"fault_{name}"], count >= limit)
        flags = [reduce(ca.logic_or, [faulty[name] for name in group]) for group in groups]
        single = reduce(lambda total, flag: total + flag, flags) <= 1
        number = reduce(lambda total, pair: total + pair[0] * pair[1], enumerate(flags, 1), ca.SX(0))
        return Step({"rejected": clip(single * number, rejected), SCREENED.name: single}, next)

    held = [replace(s, name=f"{s.name}_held") for s in channels]
    faults = [Signal(f"fault_{name}", "1", 0, 1, "refused this sample") for name in names]
    counts = [Signal(f"repeats_{name}", "1", 0, limit, "samples in a row with the same code") for name in names]
    lasts = [replace(s, name=f"last_{s.name}", about="of the last sample") for s in channels]
    return build(
        "screen",
        time,
        law,
        inputs=[*held, *faults],
        outputs=[rejected, SCREENED],
        states=[
            *(State(s, min(max(0.0, s.low), s.high)) for s in lasts),
            *(State(s, 0, True) for s in counts),
        ],
        tag="refused and repeated codes",
    )
