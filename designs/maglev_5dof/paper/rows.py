"""The audit of the maglev stage's paper, row by row: printed, recomputed, verdict.

Everything is computed from the parameters of the plant that is given; a verdict is never stored.
"""

from collections.abc import Iterator, Mapping
from pathlib import Path

from designs.maglev_5dof.paper import loops, model
from designs.maglev_5dof.paper.bench import Bench
from synth.declaration import Stage
from synth.report import audit
from synth.report.audit import Published, Row

MODULES = (model, loops)


def rows(stage: Stage) -> Iterator[Row]:
    """Yield the rows F-1 to F-19 for the stage's parameters, each when it is computed."""
    return on(Bench(stage, stage.plant))


def on(bench: Bench) -> Iterator[Row]:
    """Yield the rows as recomputed on a bench of given plant, length of runs and fineness of the field."""
    return audit.rows(MODULES, bench, printed())


def printed() -> Mapping[str, Published]:
    """Return what the paper prints, by row."""
    return audit.read(Path(__file__).parent)
