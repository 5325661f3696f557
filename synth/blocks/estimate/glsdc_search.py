"""Cold start and track of a least-squares estimator: a sweep of start points, and one accepted solution among them.

    searching   start k is q_k = q_(k-1) + increment, wrapped into the range;  increments are those of Roberts'
                sequence, width_i g^-i with g^(d+1) = g + 1, which fills the ranges of d unknowns evenly
                corrections continue from a start for `dwell` samples, unless they converge before
                an accepted solution that has converged is the candidate;  a second candidate does not agree with it
    tracking    begins after a sweep of `starts` with a single candidate, at the candidate; else the next sweep begins
                an accepted solution is the next prediction; without one the prediction goes on
    lost        `patience` samples in a row without an accepted solution: nothing is valid until init

A solution is accepted if it is complete and not weak, and its residuals pass the test. The body rests
during a sweep, which takes `starts` to `starts` times `dwell` samples.

Source: Roberts, "The Unreasonable Effectiveness of Quasirandom Sequences" (2018), additive recurrence R_d.

Screening of grouped measurements: refused readings, and converters that repeat a code; one faulty group is rejected.

    repeats_g = repeats_g + 1 while y_i(k) = y_i(k-1) for some i of group g, else 0;    frozen: repeats_g at its limit
    a group is faulty when the guard refuses one of its channels in this sample, or it is frozen
    rejected = number of the only faulty group, else 0;           screened = no group or one group is faulty

One count serves a group. A group of m converters whose noise spreads over several codes counts to n with a probability
of about (m p)^n, where p = step / (2 sqrt(pi) sigma) for a normal noise sigma. Without noise, as in a simulation of
ideal sensors, a body at rest is indistinguishable from a frozen converter.

Source: Gertler, "Fault Detection and Diagnosis in Engineering Systems", section 1.3 (limit and plausibility checks).
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import reduce

import casadi as ca
from scipy import optimize

from synth import arguments, numeric
from synth.block import Block, Constant, Exprs, State, Step, build, clip
from synth.blocks.estimate.glsdc import Vector
from synth.blocks.estimate.glsdc_model import Unknown
from synth.errors import SignalError
from synth.law import label
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
            label(str(index), same=same, count=count, frozen=frozen, refused=refused, flag=flags[-1])
        single = reduce(lambda total, flag: total + flag, flags) <= 1
        number = ca.SX(0)
        for index, flag in reversed(list(enumerate(flags, 1))):
            number = ca.if_else(flag, index, number)
        label(number=number)
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


MOST = 10_000  # starts, and samples of patience
LOST = Signal("lost", "1", 0, 1, "the track is lost: nothing is valid until init")
TRACKING = Signal("tracking", "1", 0, 1, "a sweep of start points has found a single solution, which is followed")


@arguments.checked
@dataclass(frozen=True)
class Search:
    """The number of `starts` of a sweep, each for `dwell` samples, and the `patience` in samples until a track is lost.

    `agreement` are the unknowns that are searched, with the largest difference, in their units, of two solutions that
    count as one. Any other unknown starts where it starts after init. With `all_groups` a sweep accepts no solution
    from which a group of channels is excluded: give it where the channels that are left have several solutions.

    Raises ModelError for a number out of its range.
    """

    starts: int
    agreement: Mapping[str, float]
    patience: int
    dwell: int = 1
    all_groups: bool = False

    def __post_init__(self) -> None:
        numeric.whole("the number of starts", self.starts, 1, MOST)
        numeric.whole("the dwell", self.dwell, 1, MOST)
        numeric.whole("the patience", self.patience, 1, MOST)
        for name, value in self.agreement.items():
            numeric.positive(f"the agreement of '{name}'", value)

    def counts(self) -> list[Constant]:
        """Return the numbers of samples and starts that the C names."""
        made = [
            Constant("starts", self.starts, "1", "of a sweep", ("start",)),
            Constant("last_start", self.starts - 1, "1", "number of the last start of a sweep", ("start",)),
            Constant("track_patience", self.patience, "1", "samples without a solution: lost", ("missed",)),
        ]
        if self.dwell == 1:
            return made
        return [*made, Constant("last_age", self.dwell - 1, "1", "samples since a start at which it ends", ("age",))]

    def increments(self, unknowns: Sequence[Unknown]) -> dict[str, float]:
        """Return by how much each searched unknown moves from a start to the next."""
        d = len(self.agreement)
        g = float(optimize.brentq(lambda v: v ** (d + 1) - v - 1, 1.0, 2.0))
        widths = {u.name: u.width for u in unknowns}
        return {name: widths[name] * g**-i for i, name in enumerate(self.agreement, 1)}

    def check(self, unknowns: Sequence[Unknown]) -> None:
        """Raise SignalError unless some unknowns are searched, and each is one."""
        names = [u.name for u in unknowns]
        if not self.agreement or not set(self.agreement) <= set(names):
            searched = ", ".join(self.agreement) or "none"
            raise SignalError(f"the searched unknowns are {searched}: give some of {', '.join(names)}")

    def states(self, unknowns: Sequence[Unknown]) -> list[State]:
        """Return the states of the search."""
        count = Signal("start_number", "1", 0, self.starts, "starts of this sweep so far, all of them while tracking")
        number = Signal("candidates", "1", 0, 2, "solutions in this sweep so far, 2 for more than one")
        missed = Signal(
            "missed", "1", 0, self.patience, "samples in a row without an accepted solution; the last: lost"
        )
        counted = [count, number, missed]
        if self.dwell > 1:
            counted.append(Signal("age", "1", 0, self.dwell - 1, "samples since this start"))
        begun = [State(_begin(u), u.start) for u in unknowns if u.name in self.agreement]
        counts = [State(s, 0, True) for s in counted]
        return [*counts, *(State(_candidate(u), u.start) for u in unknowns), *begun]


@dataclass(frozen=True, eq=False)
class Sample:
    """A sample: unknowns at the prediction and as solved (n,), whether they have converged and are accepted."""

    predicted: Vector
    solved: Exprs
    converged: ca.SX
    accepted: ca.SX


def _begin(of: Unknown) -> Signal:
    s = of.signal
    return Signal(f"begin_{s.name}", s.unit, s.low, s.high, f"{s.name} of this start")


def _candidate(of: Unknown) -> Signal:
    s = of.signal
    return Signal(f"candidate_{s.name}", s.unit, s.low, s.high, f"{s.name} of the first solution of this sweep")


def is_tracking(of: Search, x: Exprs) -> ca.SX:
    """Return whether the track has begun; it may be lost since."""
    return x["start_number"] >= of.starts


def is_lost(of: Search, x: Exprs) -> ca.SX:
    """Return whether the track is lost."""
    return x["missed"] >= of.patience


def advance(of: Search, unknowns: Sequence[Unknown], sample: Sample, x: Exprs) -> dict[str, ca.SX]:
    """Return the next unknowns and the next states of the search."""
    tracking, accepted = is_tracking(of, x), sample.accepted
    solves = ca.logic_and(sample.converged, accepted)
    if of.all_groups:
        solves = ca.logic_and(solves, x["excluded"] == 0)
    first = x["candidates"] == 0
    agrees = reduce(ca.logic_and, [_agrees(of, u, sample.solved, x) for u in unknowns if u.name in of.agreement])
    count = ca.fmax(x["candidates"], solves * (2 - ca.logic_or(first, agrees)))
    ends = ca.logic_or(sample.converged, x["age"] >= of.dwell - 1) if of.dwell > 1 else ca.SX(1)
    last = ca.logic_and(ends, x["start_number"] >= of.starts - 1)
    unique = ca.logic_and(last, count == 1)
    adopt, next = ca.logic_and(first, solves), {}
    increments = of.increments(unknowns)
    for u, predicted in zip(unknowns, sample.predicted, strict=True):
        candidate = ca.if_else(adopt, sample.solved[u.name], x[f"candidate_{u.name}"])
        start = ca.SX(u.start)
        if u.name in increments:
            start = _wrap(x[f"begin_{u.name}"] + increments[u.name], u.signal)
            begin = x[f"begin_{u.name}"]
            next[f"begin_{u.name}"] = ca.if_else(tracking, begin, ca.if_else(ends, start, begin))
        sweep = ca.if_else(unique, candidate, ca.if_else(ends, start, sample.solved[u.name]))
        track = ca.if_else(accepted, sample.solved[u.name], predicted)
        next |= {
            f"candidate_{u.name}": ca.if_else(tracking, x[f"candidate_{u.name}"], candidate),
            u.name: ca.if_else(tracking, track, sweep),
        }
        label(u.name, start=start, candidate=candidate)
    number, final = x["start_number"], of.starts - 1
    going_on = ca.if_else(number >= final, final, number + ends)
    following = ca.if_else(unique, of.starts, ca.if_else(last, 0, going_on))
    missed = ca.if_else(is_lost(of, x), x["missed"], x["missed"] + 1)
    kept = ca.logic_or(ca.logic_not(last), unique)
    if of.dwell > 1:
        age = ca.if_else(ends, 0, ca.fmin(x["age"] + 1, of.dwell - 1))
        next["age"] = ca.if_else(tracking, 0, age)
    followed = ca.logic_and(accepted, ca.logic_not(is_lost(of, x)))
    label(
        tracking=tracking, unique=unique, agrees=agrees, last=last, ends=ends, solves=solves, first=first, count=count,
        followed=followed,
    )  # fmt: skip
    return next | {
        "start_number": ca.if_else(tracking, of.starts, following),
        "candidates": ca.if_else(tracking, 0, ca.if_else(kept, count, 0)),
        "missed": ca.if_else(tracking, ca.if_else(followed, 0, missed), 0),
    }


def _agrees(of: Search, u: Unknown, solved: Exprs, x: Exprs) -> ca.SX:
    """Return whether a solution is the candidate, the short way round for a periodic unknown."""
    apart = ca.fabs(solved[u.name] - x[f"candidate_{u.name}"])
    label(u.name, apart=apart)
    return (ca.fmin(apart, ca.fabs(apart - u.width)) if u.periodic else apart) <= of.agreement[u.name]


def _wrap(value: ca.SX, into: Signal) -> ca.SX:
    return clip(ca.if_else(value > into.high, value - (into.high - into.low), value), into)
