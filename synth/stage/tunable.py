"""Constants that are tuned on the running machine: in the emitted C they are states, k+ = k, which no step changes.

A function beside the step moves them, all together and between two steps: with n calls left to the values t,

    k <- t - (t - k) (n - 1) / n

so that k is t to the last bit after the last of them, and between the two before: what holds for every k in its range
holds on the way.
"""

from collections.abc import Callable, Mapping
from dataclasses import replace
from itertools import product

from synth.base import cache
from synth.block import Block, State
from synth.declare.stage import Stage
from synth.declare.tuning import FreeParameter, Tuning
from synth.errors import DesignError
from synth.signals import Signal

STEPS = 5  # of the bisection for the largest ranges that are proved
MARGIN = 0.05  # of a range, by which what follows from the corners and the middle of the box is widened on each side


def with_bench(stage: Stage) -> Block:
    """Return the Block that is emitted: the controller's, with the constants that the bench tunes as states.

    Raises DesignError as `ranges` and `require_declared_values`.
    """
    block, tuning = stage.controller.block, stage.tuning
    if tuning is None or tuning.bench is None:
        return block
    require_declared_values(stage, tuning)
    samples = max(1, round(tuning.bench.ramp_s / block.time.period_s))
    return with_tunable(block, ranges(stage.name, tuning), samples)


def proved_ranges(stage: Stage, proves: Callable[[Block], bool]) -> dict[str, tuple[float, float]]:
    """Return the largest ranges of the bench, shrunk alike towards the declared values, whose Block `proves`.

    Empty where even the smallest that is tried, a 32nd of the declared ones, is not proved.
    """
    assert stage.tuning is not None and stage.tuning.bench is not None
    tuning, bench = stage.tuning, stage.tuning.bench
    declared = {f.name: f.value for f in tuning.free}

    def shrunk(share: float) -> dict[str, tuple[float, float]]:
        ends = ((n, declared[n], low, high) for n, (low, high) in bench.ranges.items())
        return {n: (v - share * (v - low), v + share * (high - v)) for n, v, low, high in ends}

    proved, refused = 0.0, 1.0
    for _ in range(STEPS):
        share = (proved + refused) / 2
        of = replace(stage, tuning=replace(tuning, bench=replace(bench, ranges=shrunk(share))))
        proved, refused = (share, refused) if proves(with_bench(of)) else (proved, share)
    return shrunk(proved) if proved else {}


@cache.cached
def ranges(name: str, tuning: Tuning) -> dict[str, tuple[float, float]]:
    """Return the range of each constant that follows from the parameters of the bench, within their ranges.

    It is that over all corners, the middles of all edges and faces, and the middle of the box, widened by MARGIN.

    Raises DesignError for a bench without effect, and for a law whose constants have other names in another place.
    """
    assert tuning.bench is not None
    declared = {f.name: f.value for f in tuning.free}
    levels = [{f.low, f.at(0.5), f.value, f.high} for f in of_bench(tuning)]
    values_of: dict[str, list[float]] = {}
    for values in product(*levels):
        at = declared | dict(zip(tuning.bench.ranges, values, strict=True))
        constants = constants_at(tuning, at)
        if values_of and constants.keys() != values_of.keys():
            other = sorted({*constants} ^ {*values_of})[0]
            raise DesignError(
                f"'{name}' on the bench: the constant '{other}' is not in the law at every value of "
                f"{', '.join(tuning.bench.ranges)}: narrow their ranges, so that none passes a value such as 0"
            )
        for n, value in constants.items():
            values_of.setdefault(n, []).append(value)
    varying = {n: (min(values), max(values)) for n, values in values_of.items() if min(values) < max(values)}
    if not varying:
        raise DesignError(
            f"'{name}' on the bench: no constant of the law follows from {', '.join(tuning.bench.ranges)}; name other "
            "free parameters"
        )
    return {n: (low - MARGIN * (high - low), high + MARGIN * (high - low)) for n, (low, high) in varying.items()}


def require_declared_values(stage: Stage, tuning: Tuning) -> None:
    """Raise DesignError unless the declared values of a tuning give the constants of the declared controller."""
    values = constants_at(tuning, {f.name: f.value for f in tuning.free})
    declared = {c.name: c.value for c in stage.controller.block.constants}
    if differing := [n for n in {**declared, **values} if values.get(n) != declared.get(n)]:
        raise DesignError(
            f"tuning of '{stage.name}': its declared values give {differing[0]} = {values.get(differing[0])}, the "
            f"declared controller has {declared.get(differing[0])}: make both of the same function"
        )


def constants_at(tuning: Tuning, values: Mapping[str, float]) -> dict[str, float]:
    """Return the constants of the law, exact, with values of all free parameters."""
    return {c.name: c.value for c in tuning.controller(dict(values)).block.constants}


def of_bench(tuning: Tuning) -> list[FreeParameter]:
    """Return the free parameters of the bench, each within its range there, in the order of the bench."""
    assert tuning.bench is not None
    free = {f.name: f for f in tuning.free}
    return [replace(free[n], low=low, high=high) for n, (low, high) in tuning.bench.ranges.items()]


def with_tunable(block: Block, ranges: Mapping[str, tuple[float, float]], ramp: int) -> Block:
    """Return the Block with some constants as states within `ranges`, {name: (low, high)}, which no step changes.

    A change takes `ramp` samples.
    """
    constants = {c.name: c for c in block.constants}
    held = [
        State(Signal(n, constants[n].unit, low, high, constants[n].source), constants[n].value)
        for n, (low, high) in ranges.items()
    ]
    return replace(
        block,
        constants=tuple(c for c in block.constants if c.name not in ranges),
        states=(*block.states, *held),
        next={**block.next, **{n: block.symbol[n] for n in ranges}},
        tunable=tuple(ranges),
        ramp=ramp,
    )
