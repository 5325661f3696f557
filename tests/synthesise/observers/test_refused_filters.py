"""What has no steady-state filter, and what lies just inside."""

import numpy as np
import pytest

from synth.errors import ModelError
from synth.statespace import StateSpace
from synth.synthesise.observers import kalman
from synth.timing import Continuous
from tests import tolerances
from tests.synthesise.observers.models import scalar


def test_an_unstable_mode_with_noise_and_a_decaying_one_without_both_have_a_filter() -> None:
    model = StateSpace(np.diag([2.0, -1.0]), [[1], [1]], [[1, 1]], [[0]], ("a", "b"), ("u",), ("y",), Continuous())
    estimator = kalman.continuous(model, {"a": 1}, [1])
    assert estimator.poles.real.max() < 0
    assert abs(estimator.prior[1, 1]) < tolerances.of("double")


def test_noise_determined_by_the_measurement_counts_as_known() -> None:
    """w = v S / V: x' = a x + (S / V) (y - x), which decays or not without a filter's help."""
    estimator = kalman.continuous(scalar(0, Continuous()), [1.0], [1.0], S=[[1.0]])
    assert (estimator.prior[0, 0], estimator.L[0, 0]) == (pytest.approx(0, abs=1e-14), pytest.approx(1))
    with pytest.raises(ModelError, match="no noise excites the mode 0 in x1"):
        kalman.continuous(scalar(-1, Continuous()), [1.0], [1.0], S=[[-1.0]])
