"""The audit of Kawato and Kim's paper: what it prints, recomputed by the formulas of published.toml, with the verdict.

All rows follow from the matrix, the sensors and model (2); what the loop does is measured in the experiments.
"""

from collections.abc import Iterator, Mapping
from dataclasses import asdict
from pathlib import Path

import numpy as np

from designs.hall_position.paper import convergence, errors, field, rank
from models import hall_singular_points
from models.hall_stage import Stage
from synth.report import audit
from synth.report.audit import Published, Row, Scope

UNITS = {"um": 1e-6, "mm": 1e-3, "mV": 1e-3}
NUMPY = (np.degrees, np.diff, np.hypot, np.isfinite, np.maximum, np.mean, np.median, np.percentile, np.radians, np.std)


def rows() -> Iterator[Row]:
    """Yield the rows, each when it is computed."""
    return audit.rows(scope(Stage(), published_rows()))


def scope(stage: Stage, prints: Mapping[str, Published]) -> Scope:
    """Return what the rows that follow from a stage and a print are computed from."""
    functions = audit.functions(convergence, errors, field, rank) | {f.__name__: f for f in (*NUMPY, Stage)}
    functions["singular_points"] = hall_singular_points.of_pair
    return Scope(asdict(stage), {**functions, **UNITS}, prints)


def published_rows() -> dict[str, Published]:
    """Return what the paper prints, by row."""
    return audit.read(Path(__file__).parent)
