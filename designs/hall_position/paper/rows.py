"""The audit of Kawato and Kim's paper, row by row: what it prints, recomputed, with the verdict.

All rows follow from the matrix, the sensors and model (2); what the loop does is measured in the experiments.
"""

from collections.abc import Iterator, Mapping
from pathlib import Path

from designs.hall_position.paper import accuracy, convergence, field, rank
from designs.hall_position.paper.stage import Stage
from synth.report import audit
from synth.report.audit import Published, Row

ROWS = (field, accuracy, convergence, rank)


def rows() -> Iterator[Row]:
    """Yield the rows, each when it is computed."""
    yield from on(Stage(), printed())


def on(stage: Stage, prints: Mapping[str, Published]) -> Iterator[Row]:
    """Yield the rows that follow from the stage, as recomputed from it."""
    yield from audit.rows(ROWS, stage, prints)


def printed() -> dict[str, Published]:
    """Return what the paper prints, by row."""
    return audit.read(Path(__file__).parent)
