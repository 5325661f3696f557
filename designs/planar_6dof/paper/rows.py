"""The audit of the planar positioner's paper Y: which rows belong to which design, and what they are computed from.

A row follows from the parameters of the plant and the printed numbers, or from records of a design's loop; no verdict
is stored.
"""

from collections.abc import Iterator, Mapping
from pathlib import Path

from designs.planar_6dof.paper import axes, filter, gains, motor, platen, sensing, spectrum, steps
from designs.planar_6dof.paper.bench import UNITS, Bench
from models import planar_stage
from synth.plant import Plant
from synth.report import audit
from synth.report.audit import Published, Row
from synth.simulate.rig import Rig

LEADLAG, LQG = (platen,), (gains,)  # the rows that are functions
FORMULAS = (motor, sensing, axes, filter, gains, steps, spectrum)  # the functions of rows that are formulas
OPTIMAL = {f"Y-{n}" for n in (*range(10, 16), *range(36, 42))}  # the rows of planar_6dof_lqg


def leadlag(loop: Rig) -> Iterator[Row]:
    """Yield the rows of sections 3.1 and 5.2: motors, platen, Hall sensors, lead-lag loops."""
    prints = printed()
    return audit.rows(LEADLAG, bench(loop=loop), {id: p for id, p in prints.items() if id not in OPTIMAL})


def lqg(loop: Rig) -> Iterator[Row]:
    """Yield the rows of sections 3.2 and 5.3: optimal gains, Kalman filter; (26) is taken as printed."""
    prints = printed()
    return audit.rows(LQG, bench(loop=loop), {id: p for id, p in prints.items() if id in OPTIMAL})


def bench(plant: Plant | None = None, prints: Mapping[str, Published] | None = None, loop: Rig | None = None) -> Bench:
    """Return what rows are computed from, the plant and the print as published where no others are given."""
    plant = plant or planar_stage.plant()
    own = (v for module in FORMULAS for v in vars(module).values() if getattr(v, "__module__", "") == module.__name__)
    functions = {value.__name__: value for value in own}
    return Bench(plant, prints or printed(), {**functions, **UNITS, "plant": plant, "loop": loop})


def printed() -> dict[str, Published]:
    """Return what the paper prints, by row."""
    return audit.read(Path(__file__).parent)
