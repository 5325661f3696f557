"""Tuning on the running machine: the constants for values of free parameters, and their least margins.

    m(p) = least margin over points, corners of the tolerances and cases,     p in the box of the bench

The gains follow from p by Riccati equations, so m is not affine in p: its least value is sought on a grid of the box,
and by a local search from each least value that is not at an end of a range.
"""

from collections.abc import Callable, Mapping
from dataclasses import replace
from itertools import product
from typing import Any

import numpy as np
from scipy.optimize import minimize

from synth.app import verdicts
from synth.base import cache, store
from synth.base.progress import Counted, Progress
from synth.declare.stage import Stage
from synth.declare.tuning import Bench, BenchMargins, Tried, Tuning
from synth.emit.c import tuning as parameters
from synth.errors import ContentError, DesignError
from synth.stage import tunable

LEVELS = {1: 9, 2: 5}  # values of each parameter on the grid, 3 of more than two
CLOSE = 1e-3  # of a range: where a local search ends
MOST = 40  # trials of one


def of(stage: Stage) -> tuple[Tuning, Bench]:
    """Return the tuning of a stage with its bench; raise DesignError for a stage without one."""
    if stage.tuning is None or stage.tuning.bench is None:
        raise DesignError(
            f"design '{stage.name}' tunes nothing on the machine: give `tuning=Tuning(.., bench=Bench({{name: (low, "
            "high)}))`"
        )
    return stage.tuning, stage.tuning.bench


def try_values(stage: Stage, values: Mapping[str, float]) -> Tried:
    """Return the least margins with values of some parameters of the bench, the others as declared.

    Raises DesignError for a name that the bench does not have, and for a value outside its range.
    """
    tuning, bench = of(stage)
    for name, value in values.items():
        low, high = bench.ranges.get(name, (np.nan, np.nan))
        if not low <= value <= high:
            known = ", ".join(f"{n} {a:g} .. {b:g}" for n, (a, b) in bench.ranges.items())
            raise DesignError(f"'{name}' = {value:g} is not on the bench of '{stage.name}': it has {known}")
    every = {f.name: f.value for f in tuning.free} | dict(values)

    def compute() -> dict[str, float]:
        changed = replace(stage, controller=tuning.controller(every), tuning=None)
        return verdicts.least_margins(changed, verdicts.survey(changed))

    try:
        margins = store.fetch(
            cache.key(try_values, verdicts.survey, tuning.controller, replace(stage, tuning=None, require={}), every),
            compute,
        )
    except ContentError:
        margins = compute()
    missed = tuple(n for n, least in stage.require.items() if not margins.get(n, np.nan) >= least)
    return Tried({n: every[n] for n in bench.ranges}, margins, missed)


def over(stage: Stage, say: Progress) -> BenchMargins:
    """Return the margins over the bench of a stage."""
    free = tunable.of_bench(of(stage)[0])
    levels = np.linspace(0.0, 1.0, LEVELS.get(len(free), 3))
    tried: dict[tuple[float, ...], Tried] = {}

    def at(shares: tuple[float, ...]) -> Tried:
        if shares not in tried:
            say(Counted(f"{len(tried) + 1} trials on the bench", len(tried) + 1, len(levels) ** len(free)))
            tried[shares] = try_values(stage, {f.name: f.at(share) for f, share in zip(free, shares, strict=True)})
        return tried[shares]

    grid = [at(shares) for shares in product(levels, repeat=len(free))]
    at(tuple(f.share for f in free))
    for name in grid[0].margins:
        start = min(tried, key=lambda shares: tried[shares].margins[name])
        if any(0 < share < 1 for share in start):
            _search(at, name, start)
    return BenchMargins(tuple(tried[shares] for shares in sorted(tried)))


def _search(at: Callable[[tuple[float, ...]], Tried], margin: str, start: tuple[float, ...]) -> None:
    """Look for a smaller margin of this name near shares of the ranges."""
    step = 0.25 / LEVELS[1]
    away = [s + step if s < 0.5 else s - step for s in start]
    simplex = [start, *((*start[:i], away[i], *start[i + 1 :]) for i in range(len(start)))]
    options = {"initial_simplex": simplex, "xatol": CLOSE, "fatol": 0.0, "maxfev": MOST}
    bounds = [(0.0, 1.0)] * len(start)
    minimize(
        lambda x: at(tuple(x.tolist())).margins[margin], start, method="Nelder-Mead", bounds=bounds, options=options
    )


def set_file(stage: Stage, tried: Tried, manifest: Mapping[str, Any]) -> str:
    """Return the text of a set of parameters for the loop on the machine: their constants, and the check of these.

    `manifest` is that of the emitted C.
    """
    tuning, _ = of(stage)
    constants = tunable.constants_at(tuning, {f.name: f.value for f in tuning.free} | dict(tried.values))
    values = {n: stage.scalar(constants[n]) for n in manifest["tuning"]["default"]}
    units = {f.name: f.unit for f in tuning.free}
    check = parameters.check(list(values.values()), manifest["tuning"]["seed"])
    asked = ", ".join(f"{n} = {v:.9g} {units[n]}" for n, v in tried.values.items())
    margins = ", ".join(f"{n.replace('_', ' ')} {v:.6g}" for n, v in tried.margins.items())
    lines = [f"# {stage.name}: {asked}", f"# least margins: {margins}", *(f"{n} = {v!s}" for n, v in values.items())]
    return "\n".join([*lines, f"check = 0x{check:08x}", ""])
