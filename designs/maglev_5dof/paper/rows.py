"""The audit of the maglev stage's paper, row by row: printed, recomputed, verdict.

Everything is computed from the parameters of the plant that is given; a verdict is never stored.
"""

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

from designs.maglev_5dof.paper import bench as benches
from designs.maglev_5dof.paper.bench import BY_GROUP, Bench
from models import maglev_figures
from synth.declaration import Stage
from synth.plant import Plant
from synth.report import audit
from synth.report.audit import Published, Row

FORMULAS = (benches, maglev_figures)  # what formulas may name: what these define and import


def rows(stage: Stage) -> Iterator[Row]:
    """Yield the rows F-1 to F-19 for the stage's parameters, each when it is computed."""
    return on(bench(stage, stage.plant))


def bench(stage: Stage, plant: Plant, **fields: Any) -> Bench:
    """Return what rows are computed from; `fields` are further ones of `Bench`."""
    functions = {name: value for module in FORMULAS for name, value in vars(module).items()}
    return Bench(stage, plant, printed(), functions, **fields)


def on(bench: Bench) -> Iterator[Row]:
    """Yield the rows as recomputed on a bench of given plant, length of runs and fineness of the field."""
    return audit.rows((), bench, bench.published)


def printed() -> dict[str, Published]:
    """Return what the paper prints, by row, with the groups of parameters before each row's formulas."""
    prints = audit.read(Path(__file__).parent).items()
    return {id: replace(p, computed={**BY_GROUP, **p.computed}) for id, p in prints}
