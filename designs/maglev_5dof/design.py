"""The five-axis maglev stage of Fulford, Maggiore and Apkarian, from physics to verified C."""

from collections.abc import Callable, Iterator, Sequence

import numpy as np

from designs.maglev_5dof import audit, bench, control, emitted, experiments, page, verification
from designs.maglev_5dof.loop import Loop, compiled
from models import maglev_stage
from synth.block import Block
from synth.report.audit import Row
from synth.simulate.experiment import Experiment
from synth.verify.evidence import Evidence
from synth.workspace import Bench, Design

QUICK_REPLAY, WHOLE_REPLAY = 5.0, 60.0  # s of a closed loop that the reference replays


def verify(told: Callable[[str], None], whole: bool) -> Evidence:
    """Compare the witnesses, over the `whole` replay or over a short one."""
    return verification.verify(maglev_stage.plant(), told, WHOLE_REPLAY if whole else QUICK_REPLAY)


def simulate(told: Callable[[str], None]) -> Sequence[Experiment]:
    """Run the experiments with the shipped single-precision C."""
    plant = maglev_stage.plant()
    loop = Loop(plant, compiled(plant, np.float32))
    unwound = Loop(plant, compiled(plant, np.float32, wound=False))
    return experiments.run(loop, unwound, told)


def rows() -> Iterator[Row]:
    """Recompute the paper's figures."""
    return iter(audit.rows(maglev_stage.plant()))


def block() -> Block:
    """Return the controller for the stage's parameters."""
    return control.controller(maglev_stage.plant())


DESIGN = Design(
    name=control.NAME,
    scalar=np.float32,
    emit=emitted.emitted,
    verify=verify,
    simulate=simulate,
    audit=rows,
    bench=Bench(block, bench.replay, bench.sequences, bench.FLOOR),
    report=page.report,
)
