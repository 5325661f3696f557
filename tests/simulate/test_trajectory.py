"""A recorded trajectory at a prompt: what it says of itself, and its figure."""

import numpy as np
import pytest

from synth.errors import SignalError
from synth.simulate.scenario import Trajectory

TIME = np.arange(4) / 10
TRAJECTORY = Trajectory(
    TIME,
    {"z": TIME, "vz": 0 * TIME},
    {"gap": TIME + 1},
    {"f": np.array([0.0, 1.0, np.nan, 2.0])},
    {"gap_sensor": TIME},
    {"current": TIME},
    np.array([0, 2, 2, 0], np.uint32),
    {"z": 0.25, "x": 0.0},
    {"z": "m", "gap": "m"},
)


def test_a_trajectory_tells_its_ranges_faults_and_impacts() -> None:
    lines = repr(TRAJECTORY).splitlines()
    assert lines[0] == "Trajectory of 4 samples up to 0.3 s" and lines[1] == "2 samples with a fault"
    assert lines[2] == "impact on the stop of z: 0.25"
    rows = [line.split() for line in lines[4:]]
    assert ["output", "gap", "[m]", "1", "1.3", "1.3"] in rows and ["applied", "f", "nan", "nan", "2"] in rows


def test_a_trajectory_is_plotted_on_request() -> None:
    assert [axes.get_ylabel() for axes in TRAJECTORY.plot().axes] == ["gap [m]"]
    chosen = TRAJECTORY.plot(["z", "current"])
    assert [axes.get_ylabel() for axes in chosen.axes] == ["z [m]", "current"]
    np.testing.assert_array_equal(chosen.axes[0].lines[0].get_ydata(), TIME)
    with pytest.raises(SignalError, match="trajectory has no 'y'"):
        TRAJECTORY.plot("y")
