"""Scores of estimators: correct estimates, and estimates that are valid but wrong."""

import numpy as np

from synth.app import standard_tasks
from synth.simulate import sampling
from synth.simulate.sampling import Scores
from tests import levitator


def test_valid_estimates_away_from_the_truth_are_wrong() -> None:
    deviations = np.array([[0.5, 11.0, 11.0, np.nan], [9.0, 0.0, 0.0, 0.0]])
    one = Scores(np.array([True, True, False, True]), np.arange(4.0), deviations)
    np.testing.assert_array_equal(one.is_correct, [True, False, False, False])
    np.testing.assert_array_equal(one.is_wrong, [False, True, False, True])
    both = sampling.stack([one, one])
    assert both.is_wrong.shape == both.error.shape == (2, 4) and both.deviations.shape == (2, 2, 4)
    np.testing.assert_array_equal(both.is_wrong[1], one.is_wrong)
    np.testing.assert_array_equal(both.first_valid, [1, 1, 0, 1])


def test_consecutive_steps_begin_where_the_last_one_ended() -> None:
    controller = standard_tasks.compiled_controller(levitator.design().DESIGN, np.float64)
    names = controller.inputs.names or ()
    inputs = {name: np.random.default_rng(0).uniform(-1e-4, 1e-4, (5, 3)) for name in names}
    states, flat = sampling.consecutive_steps(controller, inputs)
    init = controller.init()
    after = controller.batch(sampling.initial_states(controller, 3), {n: v[0] for n, v in inputs.items()}).states
    for name, column in states.items():
        assert len(column) == 15 and (column[:3] == init[name]).all() and (column[3:6] == after[name]).all()
    assert all((flat[name] == v.ravel()).all() for name, v in inputs.items()) and set(states) == set(init.dtype.names)
