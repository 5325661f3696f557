"""The audit of the planar positioner's paper Y: which rows belong to which design, and what they are computed from.

A row follows from the parameters of the plant and the printed numbers, or from records of a design's loop; no verdict
is stored.
"""

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from types import ModuleType

from designs.planar_6dof.paper import axes, filter, gains, motor, platen, sensing, spectrum, steps
from designs.planar_6dof.paper.bench import UNITS, Bench, Recorder
from models import planar_stage
from synth.plant import Plant
from synth.report import audit
from synth.report.audit import Published, Row
from synth.simulate.rig import Rig

LEADLAG, LQG = (platen, sensing, steps), (gains, spectrum)  # the rows that are functions
FORMULAS = (motor, axes, filter, gains)  # the functions of rows that are formulas
OPTIMAL = {f"Y-{n}" for n in (*range(10, 16), *range(36, 42))}  # the rows of planar_6dof_lqg


def leadlag(loop: Rig) -> Iterator[Row]:
    """Yield the rows of sections 3.1 and 5.2: motors, platen, Hall sensors, lead-lag loops."""
    return _rows({id: p for id, p in printed().items() if id not in OPTIMAL}, LEADLAG, loop)


def lqg(loop: Rig) -> Iterator[Row]:
    """Yield the rows of sections 3.2 and 5.3: optimal gains, Kalman filter; (26) is taken as printed."""
    return _rows({id: p for id, p in printed().items() if id in OPTIMAL}, LQG, loop)


def _rows(prints: Mapping[str, Published], modules: Sequence[ModuleType], loop: Rig) -> Iterator[Row]:
    *of_stage, of_records = modules
    recorded = audit.recipes([of_records])
    yield from audit.rows(of_stage, bench(), {id: p for id, p in prints.items() if id not in recorded})
    yield from audit.rows([of_records], Recorder(loop, printed()), {id: prints[id] for id in recorded})


def bench(plant: Plant | None = None, prints: Mapping[str, Published] | None = None) -> Bench:
    """Return what the rows of the stage are computed from, as published where nothing else is given."""
    functions = {name: value for module in FORMULAS for name, value in vars(module).items() if callable(value)}
    plant = plant or planar_stage.plant()
    return Bench(plant, prints or printed(), {**functions, **UNITS, "plant": plant})


def printed() -> dict[str, Published]:
    """Return what the paper prints, by row."""
    return audit.read(Path(__file__).parent)
