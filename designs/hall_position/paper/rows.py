"""Audit of Kawato and Kim's paper: its printed figures, recomputed by the formulas of published.toml, with verdicts.

All rows follow from the matrix, the sensors and model (2); the experiments measure the closed loop.
"""

from collections.abc import Iterator, Mapping
from dataclasses import asdict
from pathlib import Path

import numpy as np

from designs.hall_position.paper import convergence, errors, field, rank, singular_points
from models.hall_stage import Stage
from synth.report import audit
from synth.report.audit import Published, Row, Scope

UNITS = {"um": 1e-6, "mm": 1e-3, "mV": 1e-3}
NUMPY = (np.degrees, np.diff, np.hypot, np.isfinite, np.maximum, np.mean, np.median, np.percentile, np.radians, np.std)


def rows() -> Iterator[Row]:
    """Yield the rows, each as soon as it is computed."""
    return audit.rows(scope(Stage(), published_rows()))


def scope(stage: Stage, prints: Mapping[str, Published]) -> Scope:
    """Return the scope of the formulas: a stage, functions, units, and the printed rows."""
    functions = audit.functions(convergence, errors, field, rank) | {f.__name__: f for f in (*NUMPY, Stage)}
    functions["singular_points"] = singular_points.of_pair
    return Scope(asdict(stage), {**functions, **UNITS}, prints)


def published_rows() -> dict[str, Published]:
    """Return the printed figures of the paper, by row."""
    return audit.read_rows(Path(__file__).parent)
