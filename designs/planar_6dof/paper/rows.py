"""The audit of the planar positioner's paper Y: which rows belong to which design, and what they are computed from.

A row follows from the parameters of the plant and the printed numbers, or from records of a design's loop; no verdict
is stored.
"""

from collections.abc import Iterator
from pathlib import Path

from designs.planar_6dof.paper import filter, gains, loops, motor, platen, sensing, spectrum, steps
from designs.planar_6dof.paper.bench import Bench, Recorder
from models import planar_stage
from synth.report import audit
from synth.report.audit import Published, Row
from synth.simulate.rig import Rig

LEADLAG, LQG = (motor, platen, sensing, loops), (gains, filter)  # rows of the stage and its printed numbers


def leadlag(loop: Rig) -> Iterator[Row]:
    """Yield the rows of sections 3.1 and 5.2: motors, platen, Hall sensors, lead-lag loops."""
    prints = printed()
    yield from audit.rows(LEADLAG, Bench(planar_stage.plant(), prints), prints)
    yield from audit.rows([steps], Recorder(loop, prints), prints)


def lqg(loop: Rig) -> Iterator[Row]:
    """Yield the rows of sections 3.2 and 5.3: optimal gains, Kalman filter; (26) is taken as printed."""
    prints = printed()
    yield from audit.rows(LQG, Bench(planar_stage.plant(), prints), prints)
    yield from audit.rows([spectrum], Recorder(loop, prints), prints)


def printed() -> dict[str, Published]:
    """Return what the paper prints, by row."""
    return audit.read(Path(__file__).parent)
