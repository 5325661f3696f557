"""Scores of estimators: correct estimates, and estimates that are valid but wrong."""

import numpy as np

from synth.simulate import ensemble
from synth.simulate.ensemble import Scores


def test_valid_estimates_away_from_the_truth_are_wrong() -> None:
    deviations = np.array([[0.5, 11.0, 11.0, np.nan], [9.0, 0.0, 0.0, 0.0]])
    one = Scores(np.array([True, True, False, True]), np.arange(4.0), deviations)
    np.testing.assert_array_equal(one.is_correct, [True, False, False, False])
    np.testing.assert_array_equal(one.is_wrong, [False, True, False, True])
    both = ensemble.stack([one, one])
    assert both.is_wrong.shape == both.error.shape == (2, 4) and both.deviations.shape == (2, 2, 4)
    np.testing.assert_array_equal(both.is_wrong[1], one.is_wrong)
    np.testing.assert_array_equal(both.first_valid, [1, 1, 0, 1])
