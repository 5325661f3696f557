"""The comparison of gains runs, on small models, and compares what it says."""

import pytest

from benchmarks import synthesis
from synth.timing import Continuous, Discrete, Time


@pytest.mark.parametrize("time", [Continuous(), Discrete(1e-3)])
@pytest.mark.parametrize("crossed", [False, True])
def test_a_small_problem_has_the_smaller_residual(time: Time, crossed: bool) -> None:
    comparison = synthesis.compare_riccati(synthesis.dense(6, 2, time, crossed), runs=1)
    assert 0 < comparison.residual < comparison.scipy_residual < 1e-10
    assert (
        comparison.forward_error < 1e-14 and comparison.condition > 1 and min(comparison.ours_s, comparison.scipy_s) > 0
    )


def test_a_held_input_and_a_stiff_model_do_too() -> None:
    for comparison in (
        synthesis.compare_lqrd(synthesis.dense(6, 2, Continuous(), crossed=True), runs=1),
        synthesis.compare_riccati(synthesis.stiff(10, 2), runs=1),
    ):
        assert comparison.residual < comparison.scipy_residual
