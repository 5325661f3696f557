"""A state at its bound fails its experiment, although no fault bit is set and all witnesses agree."""

from dataclasses import replace

import numpy as np
import pytest

from synth.app import standard_tasks, tasks
from synth.base.progress import silent
from synth.block import Block, clip
from synth.declare.stage import Stage
from synth.simulate import experiments
from synth.simulate.experiments import Experiment
from synth.simulate.rig import Rig
from synth.verify import suite
from tests import levitator

PID = levitator.design()
LOW = 3e-3  # m/s: a step of 0.2 mm needs some 0.01


def bounded(block: Block, name: str, bound: float) -> Block:
    """Return a control law with another bound of a state, for example one that is too low."""
    states = tuple(
        replace(s, signal=replace(s.signal, low=-bound, high=bound)) if s.name == name else s for s in block.states
    )
    signal = next(s.signal for s in states if s.name == name)
    return replace(block, states=states, next={**block.next, name: clip(block.next[name], signal)})


@pytest.fixture(scope="module")
def planted() -> Stage:
    """Return the stage with too low a bound of the rate of the error in z."""
    laws = {"z": bounded(PID.pid("z"), "v", LOW), "x": PID.pid("x")}
    return replace(PID.DESIGN, controller=PID.variant(laws))


def simulated(stage: Stage) -> list[Experiment]:
    return [standard_tasks.with_headroom(stage, run) for run in standard_tasks.simulate(stage, silent)]


def test_a_sound_stage_is_inside_all_bounds() -> None:
    for run in tasks.experiments(PID.DESIGN).compute(silent):
        check = next(c for c in run.checks if c.name == experiments.NAME)
        assert check.passed and 0.05 < check.value < 0.5
        assert any(name.startswith(experiments.NAME) for name in run.figures)


def test_a_bound_that_is_too_low_is_found(planted: Stage) -> None:
    runs = {run.name: run for run in simulated(planted)}
    check = next(c for c in runs["step_z"].checks if c.name == experiments.NAME)
    assert not check.passed and check.value == pytest.approx(1) and check.about.startswith("pid_z_v")
    assert not runs["step_z"].trajectory.faults.any()


def test_comparison_of_witnesses_does_not_detect_it(planted: Stage) -> None:
    """CasADi, its C and the emitted C limit the state in the same way: recorded inputs give equal outputs."""
    by = suite.witnesses(planted.controller.block, PID.reference.step)
    others = {name: witness for name, witness in by.by_name.items() if name != "reference"}
    run = planted.experiments[0].run(Rig(planted, planted.plant, by.c64))
    agreements = suite.replay(replace(by, by_name=others), {"step": run.trajectory.measured}, None)
    assert [c for c in suite.exact_checks(agreements, "A") if not c.passed] == []


def test_states_limited_on_purpose_may_reach_their_bound(planted: Stage) -> None:
    runs = simulated(replace(planted, limited=["pid_z_v"]))
    assert all(c.passed for run in runs for c in run.checks if c.name == experiments.NAME)


def test_the_ratio_is_taken_about_the_middle_of_the_range() -> None:
    controller = standard_tasks.compiled_controller(PID.DESIGN, np.float64)
    n = 10
    inputs = {"z": np.zeros(n), "x": np.full(n, -1e-3), "z_ref": np.zeros(n), "x_ref": np.full(n, 8e-4)}
    ratios = experiments.ratios(controller, inputs)
    assert ratios["pid_x_e_previous"] == pytest.approx(1) and ratios["pid_z_e_previous"] == 0
    assert set(ratios) == {f"pid_{axis}_{name}" for axis in "zx" for name in ("integral", "v", "e_previous")}
