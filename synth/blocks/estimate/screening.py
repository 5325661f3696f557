"""Screening of grouped measurements: refused readings, and converters that repeat a code; one faulty group is rejected.

    repeats_g = repeats_g + 1 while y_i(k) = y_i(k-1) for some i of group g, else 0;    frozen: repeats_g at its limit
    a group is faulty when the guard refuses one of its channels in this sample, or it is frozen
    rejected = number of the only faulty group, else 0;           screened = no group or one group is faulty

One count serves a group. A group of m converters whose noise spreads over several codes counts to n with a probability
of about (m p)^n, where p = step / (2 sqrt(pi) sigma) for a normal noise sigma. Without noise, as in a simulation of
ideal sensors, a body at rest is indistinguishable from a frozen converter.

Source: Gertler, "Fault Detection and Diagnosis in Engineering Systems", section 1.3 (limit and plausibility checks).
"""

from collections.abc import Sequence
from dataclasses import replace
from functools import reduce

import casadi as ca

from synth import arguments, numeric
from synth.block import Block, Constant, Exprs, State, Step, build
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
    most = Constant("most_repeats", limit, "1", "samples in a row with the same code: frozen", ("repeats",))
    rejected = Signal("rejected", "1", 0, len(groups), "number of the group of channels that is refused or frozen")

    def law(u: Exprs, x: Exprs, k: Exprs) -> Step:
        next, flags = {f"last_{name}": u[f"{name}_held"] for name in names}, []
        for index, group in enumerate(groups, 1):
            same = reduce(ca.logic_or, [ca.fabs(u[f"{name}_held"] - x[f"last_{name}"]) <= 0 for name in group])
            before = x[f"repeats_{index}"]
            count = ca.if_else(before >= limit, before, before + 1)
            frozen = ca.if_else(same, count >= limit, 0)
            refused = reduce(ca.logic_or, [u[f"fault_{name}"] for name in group])
            flags.append(ca.logic_or(refused, frozen))
            next[f"repeats_{index}"] = ca.if_else(same, count, 0)
        single = reduce(lambda total, flag: total + flag, flags) <= 1
        number = ca.SX(0)
        for index, flag in reversed(list(enumerate(flags, 1))):
            number = ca.if_else(flag, index, number)
        return Step({"rejected": ca.if_else(single, number, 0), SCREENED.name: single}, next, numbers=[most])

    held = [replace(s, name=f"{s.name}_held") for s in channels]
    faults = [Signal(f"fault_{name}", "1", 0, 1, "refused this sample") for name in names]
    about = "samples in a row in which a channel of group {} has the same code"
    counts = [Signal(f"repeats_{k}", "1", 0, limit, about.format(k)) for k in range(1, len(groups) + 1)]
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
