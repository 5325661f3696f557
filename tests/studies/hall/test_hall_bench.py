"""The bench refuses what it cannot read; its scans are compared in the calibration of the Hall position."""

import numpy as np
import pytest

from studies.hall import hall_bench
from studies.hall.hall_bench import Bench
from synth.errors import ModelError
from synth.timing import Discrete

pytestmark = pytest.mark.whole


def test_a_bench_and_what_it_reads_are_checked() -> None:
    with pytest.raises(ModelError, match="number of places is 1"):
        Bench(((0.0, 0.0),))
    with pytest.raises(ModelError, match=r"number of places is 9: .* at most 8"):
        Bench(tuple((1e-3 * k, 0.0) for k in range(9)))
    with pytest.raises(ModelError, match="positions are"):
        Bench([0.0, 1.0])  # type: ignore[arg-type]
    bench = Bench(((0.0, 0.0), (0.03, 0.0)))
    for poses in (np.zeros(3), np.zeros((2, 2)), np.full((2, 3), np.nan)):
        with pytest.raises(ModelError, match="poses of X, Y and yaw have the shape"):
            hall_bench.sampled_voltages(bench, poses, Discrete(1 / 800), 1)
    with pytest.raises(ModelError, match="the true field is tabulated up to 78 mm"):
        hall_bench.static_voltages(bench, np.array([[0.1, 0.0, 0.0]]))
