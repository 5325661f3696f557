"""Each output has a separate floor, given or from its declared range."""

from collections.abc import Callable

import numpy as np
import pytest

from synth.block import Block, Step, build
from synth.errors import SignalError
from synth.signals import Signal
from synth.timing import Discrete
from synth.verify import agree
from tests import levitator

X, ANGLE = Signal("x", "m", -1e-3, 5e-4), Signal("angle", "rad", -3, 3)
BLOCK = build(
    "two",
    Discrete(1e-3),
    lambda u, x, k: Step({"x": u["x_in"], "angle": u["angle_in"]}),
    inputs=[Signal("x_in", "m", -1e-3, 5e-4), Signal("angle_in", "rad", -3, 3)],
    outputs=[X, ANGLE],
)


def worst(floor: agree.Floor) -> tuple[float, str]:
    """Return an error of 1e-6 of the range of x and of 1e-9 of the range of the angle."""
    words = np.zeros(1, np.uint32)
    right = agree.StepResults({"x": np.zeros(1), "angle": np.zeros(1)}, {}, words)
    wrong = agree.StepResults({"x": np.full(1, 1e-9), "angle": np.full(1, 3e-9)}, {}, words)
    agreement = agree.compare("steps", ("right", right), ("wrong", wrong), floor, BLOCK)
    return agreement.worst, agreement.signal


def test_a_common_floor_hides_errors_of_an_output_with_a_small_range() -> None:
    assert worst(1.0) == (3e-9, "angle")
    assert worst(None) == (pytest.approx(1e-6), "x")
    assert worst({"x": 1e-3, "angle": 1.0}) == (pytest.approx(1e-6), "x")
    assert worst({"x": 1.0}) == (1e-9, "x"), "the angle's own range serves"


@pytest.mark.parametrize(
    ("floor", "words"), [({"y": 1.0}, "floor of 'y': it is not one of the outputs x, angle"), (0.0, "'x' is 0.0: give")]
)
def test_an_invalid_floor_is_refused(floor: agree.Floor, words: str) -> None:
    with pytest.raises(SignalError, match=words):
        worst(floor)


def test_parallel_copies_equal_separate_runs() -> None:
    def integrate(states: agree.Columns, inputs: agree.Columns) -> agree.StepResults:
        total = states["total"] + inputs["u"]
        return agree.StepResults({"y": 2 * total}, {"total": total}, (total > 1).astype(np.uint32))

    u = np.random.default_rng(0).uniform(-1, 1, (20, 3))
    together = agree.run(integrate, {"total": 0.5}, {"u": u})
    assert together.outputs["y"].shape == together.faults.shape == u.shape
    for k in range(3):
        alone = agree.run(integrate, {"total": 0.5}, {"u": u[:, k]})
        np.testing.assert_array_equal(together.outputs["y"][:, k], alone.outputs["y"])
        np.testing.assert_array_equal(together.faults[:, k], alone.faults)
        assert together.states["total"][k] == alone.states["total"][0]


def test_runs_of_different_lengths_equal_separate_runs() -> None:
    """One run ends first, two end together, and one continues alone."""

    def integrate(states: agree.Columns, inputs: agree.Columns) -> agree.StepResults:
        total = states["total"] + inputs["u"]
        return agree.StepResults({"y": 2 * total}, {"total": total}, (total > 1).astype(np.uint32))

    rng = np.random.default_rng(0)
    runs = [{"u": rng.uniform(-1, 1, n)} for n in (7, 20, 7, 3)]
    for run, results in zip(runs, agree.run_each(integrate, {"total": 0.5}, runs), strict=True):
        alone = agree.run(integrate, {"total": 0.5}, run)
        np.testing.assert_equal((results.outputs, results.states), (alone.outputs, alone.states))
        np.testing.assert_array_equal(results.faults, alone.faults)


@pytest.mark.parametrize("made", [agree.casadi, agree.casadi_own_c])
def test_consecutive_steps_equal_single_steps(made: Callable[[Block], agree.Witness]) -> None:
    """The run is longer than CHUNK samples and has a bad sample in each part."""
    block = levitator.design().DESIGN.stage.controller.block
    rng, n = np.random.default_rng(3), agree.CHUNK + 30
    inputs = {s.name: rng.uniform(s.low, s.high, n) for s in block.inputs}
    for values in inputs.values():
        values[[5, -5]] = np.nan
    witness, start = made(block), {s.name: s.initial for s in block.states}
    in_a_row, one_by_one = (agree.run(w, start, inputs) for w in (witness, lambda x, u: witness(x, u)))
    np.testing.assert_equal(in_a_row.outputs, one_by_one.outputs)
    np.testing.assert_equal(in_a_row.states, one_by_one.states)
    assert np.array_equal(in_a_row.faults, one_by_one.faults) and len(set(in_a_row.faults)) > 1


def test_a_block_without_states_runs_consecutive_steps() -> None:
    inputs = {"x_in": np.array([1e-4, -2e-4]), "angle_in": np.array([1.0, 2.0])}
    outputs = agree.run(agree.casadi(BLOCK), {}, inputs).outputs
    np.testing.assert_equal(outputs, {"x": inputs["x_in"], "angle": inputs["angle_in"]})
