"""Audit of the planar positioner's paper Y: the rows of each design and the scope of their formulas.

A row is computed from the parameters of the plant and the printed numbers, or from records of a design's loop, by the
formulas in published.toml. No verdict is stored.
"""

from collections.abc import Iterator, Mapping
from pathlib import Path

from designs.planar_6dof.paper import axis_loop, gains, kalman_filter, motors, records, switching
from models import planar_stage
from synth.plant import Plant
from synth.report import audit
from synth.report.audit import Published, Row, Scope
from synth.simulate.rig import Rig

UNITS = {"mm": 1e-3, "um": 1e-6, "inch": 25.4e-3}  # in m
MODULES = (motors, switching, axis_loop, kalman_filter, gains, records)  # whose functions the formulas name
OPTIMAL = {f"Y-{n}" for n in (*range(10, 16), *range(36, 42))}  # the rows of planar_6dof_lqg


def leadlag(loop: Rig) -> Iterator[Row]:
    """Yield the rows of sections 3.1 and 5.2: motors, platen, Hall sensors, lead-lag loops."""
    return audit.rows(scope(loop=loop), [id for id in published_rows() if id not in OPTIMAL])


def lqg(loop: Rig) -> Iterator[Row]:
    """Yield the rows of sections 3.2 and 5.3: optimal gains, Kalman filter; (26) is taken as printed."""
    return audit.rows(scope(loop=loop), [id for id in published_rows() if id in OPTIMAL])


def scope(plant: Plant | None = None, prints: Mapping[str, Published] | None = None, loop: Rig | None = None) -> Scope:
    """Return the scope of the formulas; plant and print default to the published ones."""
    plant = plant or planar_stage.plant()
    parameters = {p.name: p.value for p in plant.parameters}
    return Scope(
        parameters, {**audit.functions(*MODULES), **UNITS, "plant": plant, "loop": loop}, prints or published_rows()
    )


def published_rows() -> dict[str, Published]:
    """Return what the paper prints, by row."""
    return audit.read_rows(Path(__file__).parent)
