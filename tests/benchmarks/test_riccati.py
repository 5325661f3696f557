"""Weights over many decades: a fixed part of the random problems, and the judge that tells right from wrong."""

import numpy as np
import pytest
import scipy.linalg

from benchmarks import riccati as benchmark
from synth.synthesise.feedback import lqr
from synth.synthesise.riccati import riccati

# Before SciPy's errors were caught 127, 135, 162, 203, 218 and 230 raised its ValueError.
SEEDS = (1, 2, 3, 5, 6, 127, 135, 162, 203, 218, 230)
ENDS = {"right", "gain lost in rounding, reported"}


@pytest.mark.parametrize("seed", SEEDS)
def test_no_raw_error_and_nothing_wrong_or_refused_that_scipy_gets_right(seed: int) -> None:
    outcome = benchmark.outcome(benchmark.problem(seed))
    assert outcome.ours in ENDS, outcome.reason
    assert outcome.ours == "right" or outcome.scipy != "right"


def test_a_hilbert_matrix_with_weights_over_24_decades_has_a_gain(monkeypatch: pytest.MonkeyPatch) -> None:
    def failing(*_: object, **__: object) -> None:
        raise ValueError("Reordering of (A, B) failed")

    monkeypatch.setattr(scipy.linalg, "solve_continuous_are", failing)
    i = np.arange(8)
    A, B = -1 / (i[:, None] + i + 1), np.ones((8, 1))
    gain = lqr.lqr((A, B), 1e12 * np.eye(8), [1e-12])
    assert gain.certificate.forward_error <= 1e-15 and gain.poles.real.max() < 0


def test_the_judge_tells_right_from_wrong() -> None:
    p = benchmark.problem(3)
    solution = riccati.solve((p.A, p.B, p.time), p.Q, p.R)
    assert benchmark.is_right(p, solution.X, solution.L)
    assert not benchmark.is_right(p, solution.X * (1 + 1e-5), solution.L)
    assert not benchmark.is_right(p, solution.X, 0.9 * solution.L)
    assert not benchmark.is_right(p, solution.X, -solution.L)


def test_the_table_counts() -> None:
    lines = list(benchmark.table(2))
    assert lines[-3].startswith("ours:    right 2") and "not right though SciPy's is: 0" in lines[-1]
