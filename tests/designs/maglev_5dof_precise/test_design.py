"""The precise design: its experiments, and its margins beside those of the paper's design."""

import numpy as np
import pytest

from designs.maglev_5dof.design import DESIGN as PAPER
from designs.maglev_5dof_precise import control, reference
from designs.maglev_5dof_precise.design import DESIGN
from synth.analyse.loops import robustness
from synth.analyse.loops.disk import DiskMargin
from synth.app import tasks
from synth.declare.stage import Stage
from synth.simulate.experiments import Experiment

LEAST_DELAY = 3e-3  # s


@pytest.fixture(scope="module")
def runs() -> dict[str, Experiment]:
    return {e.name: e for e in tasks.experiments(DESIGN).result(lambda _: None)}


@pytest.mark.whole
def test_every_experiment_keeps_its_limits(runs: dict[str, Experiment]) -> None:
    failed = [(name, c.name, c.value, c.limit) for name, run in runs.items() for c in run.checks if not c.passed]
    assert failed == []


def test_the_gains_are_those_of_the_reference() -> None:
    K = reference.constants().K
    for row, axis in zip(K, control.AXES, strict=True):
        constants = {c.name: c.value for c in control.servo(axis, control.LOOPS[axis.name]).constants}
        shipped = [constants.get(f"k_{name}", 0.0) for name in ("e", "de", *reference.ETA)]
        np.testing.assert_allclose(shipped, row, rtol=1e-12)


def test_every_loop_keeps_its_delay_margin() -> None:
    assert DESIGN is not None
    loops = robustness.open_loops(robustness.of_stage(DESIGN))
    assert min(loop.margin("delay_margin") for loop in loops) > LEAST_DELAY


@pytest.fixture(scope="module")
def disk_margins() -> dict[str, list[dict[str, DiskMargin]]]:
    """Those of both designs at every operating point, by channels."""

    def at_points(design: Stage) -> list[dict[str, DiskMargin]]:
        assert design is not None
        loops = robustness.of_stage(design)
        return [robustness.disk_margins(loops, point) for point in loops.points]

    return {design.name: at_points(design) for design in (DESIGN, PAPER)}


@pytest.mark.whole
@pytest.mark.parametrize("channels", ["actuators", "sensors", "both"])
def test_the_worst_disk_margin_is_not_below_that_of_the_papers_design(
    disk_margins: dict[str, list[dict[str, DiskMargin]]], channels: str
) -> None:
    lowest = min(margins[channels].lower for margins in disk_margins[DESIGN.name])
    assert lowest > min(margins[channels].upper for margins in disk_margins[PAPER.name])
