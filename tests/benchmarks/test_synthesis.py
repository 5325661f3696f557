"""The comparison of gains runs, on small models, and compares what it says."""

import pytest

from benchmarks import synthesis
from synth.timing import Continuous, Discrete, Time


@pytest.mark.parametrize("time", [Continuous(), Discrete(1e-3)])
@pytest.mark.parametrize("crossed", [False, True])
def test_a_small_problem_has_the_smaller_residual(time: Time, crossed: bool) -> None:
    found = synthesis.solved(synthesis.dense(6, 2, time, crossed), runs=1)
    assert 0 < found.residual < found.scipy_residual < 1e-10
    assert found.forward_error < 1e-14 and found.condition > 1 and min(found.ours_s, found.scipy_s) > 0


def test_a_held_input_and_a_stiff_model_do_too() -> None:
    for found in (
        synthesis.sampled(synthesis.dense(6, 2, Continuous(), crossed=True), runs=1),
        synthesis.solved(synthesis.stiff(10, 2), runs=1),
    ):
        assert found.residual < found.scipy_residual
