"""Figures of one axis under its compensator: records of steps, and the forms of an axis."""

import numpy as np
import pytest

from designs.planar_6dof.paper import axis_loop


def test_a_step_that_never_settles_has_no_time() -> None:
    time = np.arange(100) * 1e-3
    figures = axis_loop.of_response(time, np.full(100, 0.5))
    assert figures.settling == np.inf and figures.rise == np.inf
    assert axis_loop.of_response(time, np.ones(100)).settling == 0


def test_time_constants_and_zeros_and_poles_make_the_same_axis() -> None:
    psi = axis_loop.vertical(0.0019, 87.0, 1100.0, 80.0, 640.0, 10.0)
    assert (psi.inertia, psi.spring, psi.gain, psi.zeros, psi.poles) == (0.0019, 87, 1100, (-80, -10), (-640, 0))
    free = axis_loop.horizontal(0.0019, 1100.0 * 800 / 640, 1 / 80, 1 / 640, 1 / 10)
    assert (free.gain, *free.zeros, *free.poles) == pytest.approx((psi.gain, *psi.zeros, *psi.poles))
