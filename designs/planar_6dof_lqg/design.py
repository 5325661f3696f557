"""The planar positioner of Yu and Kim under its reduced-order LQG controller at 800 Hz, from physics to verified C."""

from collections.abc import Callable, Iterator, Sequence

import numpy as np

from designs.planar_6dof import loop, lqg
from designs.planar_6dof.paper import rows
from designs.planar_6dof_lqg import bench, emitted, experiments, page, verification
from models import planar_stage
from synth.block import Block
from synth.report.audit import Row
from synth.simulate.experiment import Experiment
from synth.verify.evidence import Evidence
from synth.workspace import Bench, Design

QUICK_REPLAY, WHOLE_REPLAY = 5.0, 60.0  # s of a closed loop that the reference replays


def verify(told: Callable[[str], None], whole: bool) -> Evidence:
    """Compare the witnesses, over the `whole` replay or over a short one."""
    return verification.verify(told, WHOLE_REPLAY if whole else QUICK_REPLAY)


def simulate(told: Callable[[str], None]) -> Sequence[Experiment]:
    """Run the experiments with the shipped single-precision C."""
    return experiments.run(shipped(), told)


def audit() -> Iterator[Row]:
    """Recompute the paper's figures."""
    return rows.lqg(shipped())


def shipped() -> loop.Loop:
    """Return the loop under the shipped controller."""
    return loop.of(block())


def block() -> Block:
    """Return the controller for the stage's parameters."""
    return lqg.controller(planar_stage.plant())


DESIGN = Design(
    name=lqg.NAME,
    scalar=np.float32,
    emit=emitted.emitted,
    verify=verify,
    simulate=simulate,
    audit=audit,
    bench=Bench(block, bench.replay, bench.sequences, bench.FLOOR),
    report=page.report,
)
