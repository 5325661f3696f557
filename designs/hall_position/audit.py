"""The audit of Kawato and Kim's paper, row by row: what it prints, recomputed, with the verdict.

All rows follow from the matrix, the sensors and model (2); what the loop does is measured in the experiments.
"""

from collections.abc import Callable, Iterator, Mapping
from pathlib import Path

from designs.hall_position import audit_accuracy, audit_convergence, audit_field, audit_layout
from designs.hall_position.audit_stage import Stage
from synth.report.audit import Published, Row, published

Prints = Mapping[str, Published]

ROWS: Mapping[str, Callable[[Stage, Published], Row]] = {
    "K-1": audit_field.weak_blocks,
    "K-2": audit_field.ideal_harmonics,
    "K-3": audit_field.fabricated_harmonics,
    "K-4": audit_field.fit_error,
    "K-5": audit_accuracy.resolution,
    "K-6": audit_accuracy.accuracy,
    "K-7": audit_convergence.convergence,
    "K-8": audit_field.halbach_gain,
    "K-9": audit_accuracy.moved,
    "K-10": audit_convergence.staircase,
    "K-11": audit_accuracy.yaw,
    "K-12": audit_field.spacing,
    "K-13": audit_layout.sufficient,
    "K-14": audit_layout.redundant,
    "K-15": audit_layout.absolute,
}


def rows() -> Iterator[Row]:
    """Yield the rows, each when it is computed."""
    yield from on(Stage(), printed())


def on(stage: Stage, prints: Prints) -> Iterator[Row]:
    """Yield the rows that follow from the stage, as recomputed from it."""
    for name, recompute in ROWS.items():
        yield recompute(stage, prints[name])


def printed() -> dict[str, Published]:
    """Return what the paper prints, by row."""
    return published(Path(__file__).with_name("published.toml").read_text(encoding="utf-8"))
