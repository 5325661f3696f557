"""Witnesses repeat recorded inputs side by side, in parts that begin where the compiled C was."""

from collections.abc import Callable

import numpy as np
import pytest

from synth.block import Block, State, Step, build
from synth.execute import host as build_c
from synth.signals import Signal
from synth.timing import Discrete
from synth.verify import agree, replays, suite
from tests import levitator
from tests.verify.test_agree import BLOCK

PART, SAMPLES = 60, 250  # the last part has 10 samples


def test_parallel_copies_equal_separate_runs() -> None:
    def integrate(states: agree.Columns, inputs: agree.Columns) -> agree.StepResults:
        total = states["total"] + inputs["u"]
        return agree.StepResults({"y": 2 * total}, {"total": total}, (total > 1).astype(np.uint32))

    u = np.random.default_rng(0).uniform(-1, 1, (20, 3))
    together = replays.run(integrate, {"total": 0.5}, {"u": u})
    assert together.outputs["y"].shape == together.faults.shape == u.shape
    for k in range(3):
        alone = replays.run(integrate, {"total": 0.5}, {"u": u[:, k]})
        np.testing.assert_array_equal(together.outputs["y"][:, k], alone.outputs["y"])
        np.testing.assert_array_equal(together.faults[:, k], alone.faults)
        assert together.states["total"][k] == alone.states["total"][0]


def test_runs_of_different_lengths_equal_separate_runs() -> None:
    """One run ends first, two end together, and one continues alone."""

    def integrate(states: agree.Columns, inputs: agree.Columns) -> agree.StepResults:
        total = states["total"] + inputs["u"]
        return agree.StepResults({"y": 2 * total}, {"total": total}, (total > 1).astype(np.uint32))

    rng = np.random.default_rng(0)
    runs, starts = [{"u": rng.uniform(-1, 1, n)} for n in (7, 20, 7, 3)], [{"total": t} for t in (0.5, 0.1, 0.2, 0.9)]
    for start, run, results in zip(starts, runs, replays.run_each(integrate, starts, runs), strict=True):
        alone = replays.run(integrate, start, run)
        np.testing.assert_equal((results.outputs, results.states), (alone.outputs, alone.states))
        np.testing.assert_array_equal(results.faults, alone.faults)


@pytest.mark.parametrize("made", [agree.casadi, agree.casadi_own_c])
def test_consecutive_steps_equal_single_steps(made: Callable[[Block], agree.Witness]) -> None:
    """The run is longer than CHUNK samples and has a bad sample in each part."""
    block = levitator.design().DESIGN.controller.block
    rng, n = np.random.default_rng(3), agree.CHUNK + 30
    inputs = {s.name: rng.uniform(s.low, s.high, n) for s in block.inputs}
    for values in inputs.values():
        values[[5, -5]] = np.nan
    witness, start = made(block), {s.name: s.initial for s in block.states}
    in_a_row, one_by_one = (replays.run(w, start, inputs) for w in (witness, lambda x, u: witness(x, u)))
    np.testing.assert_equal(in_a_row.outputs, one_by_one.outputs)
    np.testing.assert_equal(in_a_row.states, one_by_one.states)
    assert np.array_equal(in_a_row.faults, one_by_one.faults) and len(set(in_a_row.faults)) > 1


def test_a_block_without_states_runs_consecutive_steps() -> None:
    inputs = {"x_in": np.array([1e-4, -2e-4]), "angle_in": np.array([1.0, 2.0])}
    outputs = replays.run(agree.casadi(BLOCK), {}, inputs).outputs
    np.testing.assert_equal(outputs, {"x": inputs["x_in"], "angle": inputs["angle_in"]})


def integrate(states: agree.Columns, inputs: agree.Columns) -> agree.StepResults:
    total = 0.9 * states["total"] + inputs["u"]
    return agree.StepResults({"y": total}, {"total": total}, np.zeros(len(total), np.uint32))


def leak(size: float) -> agree.Witness:
    """Return the integrator whose state deviates by `size` in every step, and its output in none."""

    def witness(states: agree.Columns, inputs: agree.Columns) -> agree.StepResults:
        sound = integrate(states, inputs)
        return agree.StepResults(sound.outputs, {"total": sound.states["total"] + size}, sound.faults)

    return witness


def compared(size: float) -> agree.Agreement:
    """Compare a leaking witness with the compiled integrator over the parts of a replay."""
    total = State(Signal("total", "m", -20, 20), 0.5)
    block = build(
        "leaky",
        Discrete(1e-3),
        lambda u, x, k: Step({"y": 0.9 * x["total"] + u["u"]}, {"total": 0.9 * x["total"] + u["u"]}),
        inputs=[Signal("u", "m", -1, 1)],
        states=[total],
        outputs=[Signal("y", "m", -20, 20)],
    )
    u = np.random.default_rng(1).uniform(-1, 1, SAMPLES)
    parts = replays.replay_in_parts(build_c.compile_block(block, np.float64), {"u": u}, PART)
    ((repeated, c64),) = replays.repeat(leak(size), [parts])
    return agree.compare("replay", ("reference", repeated), ("c64", c64), None, block)


def test_the_parts_of_a_replay_are_all_compared() -> None:
    sound = compared(0.0)
    assert sound.samples == SAMPLES and max(sound.worst, sound.state_worst) <= suite.DOUBLE_TOLERANCE


def test_a_state_that_leaks_adds_up_within_a_part() -> None:
    """A fifth of the tolerance of a range of 40 m in each step, and a memory of ten steps."""
    leaking = compared(suite.DOUBLE_TOLERANCE * 40 / 5)
    assert leaking.state_worst > suite.DOUBLE_TOLERANCE and leaking.worst > suite.DOUBLE_TOLERANCE
