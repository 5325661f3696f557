"""The audit of Kawato and Kim's paper: what it prints, recomputed by the formulas of published.toml, with the verdict.

All rows follow from the matrix, the sensors and model (2); what the loop does is measured in the experiments.
"""

from collections.abc import Iterator, Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

from designs.hall_position.paper import convergence, errors, field, rank
from designs.hall_position.paper.stage import Stage
from models import hall_singular_points
from synth.report import audit
from synth.report.audit import Published, Row

UNITS = {"um": 1e-6, "mm": 1e-3, "mV": 1e-3}
NUMPY = (np.degrees, np.diff, np.hypot, np.isfinite, np.maximum, np.mean, np.median, np.percentile, np.radians, np.std)


@dataclass(frozen=True, eq=False)
class Bench:
    """What formulas name: the stage's parameters, functions of it, and what the paper prints by row."""

    parameters: Mapping[str, float]
    functions: Mapping[str, Any]
    published: Mapping[str, Published]


def rows() -> Iterator[Row]:
    """Yield the rows, each when it is computed."""
    bench = on(Stage(), printed())
    yield from audit.rows((), bench, bench.published)


def on(stage: Stage, prints: Mapping[str, Published]) -> Bench:
    """Return what the rows that follow from a stage and a print are computed from."""
    modules = (convergence, errors, field, rank)
    own = (v for m in modules for v in vars(m).values() if getattr(v, "__module__", "") == m.__name__)
    functions = {f.__name__: f for f in (*own, *NUMPY, Stage)}
    functions["singular_points"] = hall_singular_points.of_pair
    return Bench(asdict(stage), {**functions, **UNITS}, prints)


def printed() -> dict[str, Published]:
    """Return what the paper prints, by row."""
    return audit.read(Path(__file__).parent)
