from collections.abc import Callable

import numpy as np
import pytest

from synth.check import Check
from synth.simulate.experiments import Experiment
from synth.simulate.scenario import Trajectory

N, SPIKE = 60_000, 34_567


@pytest.fixture
def run() -> Callable[..., Experiment]:
    """Return a maker of 60 s runs of a gap in m and an angle in rad, with one sample of the gap 3 mm off."""

    def make(checks: tuple[Check, ...] = (), references: bool = True, name: str = "tracking") -> Experiment:
        time = np.arange(N) * 1e-3
        y_ref, theta_ref = 0.025 + 0.005 * np.sin(4.7 * time), 0.01 * np.cos(4.7 * time)
        y, theta = y_ref + 2e-6 * np.sin(50 * time), theta_ref + 30e-6 * np.sin(9.4 * time)
        y[SPIKE] += 3e-3
        states = {"y": y, "theta": theta}
        trajectory = Trajectory(time, states, {}, {}, {}, {}, np.zeros(N, np.uint32), {})
        set_points = {"y": y_ref, "theta": theta_ref} if references else {}
        figures = {"mean |e_y|, um": 1.25, "overshoot": 0.118}
        return Experiment(name, "Tracking", "60 s from rest", trajectory, ("y", "theta"), set_points, figures, checks)

    return make
