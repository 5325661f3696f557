"""No demand passes before the first complete sample, in the Block as in its NumPy reference."""

import numpy as np
import pytest

from synth.blocks.faults import start
from synth.reference import guard
from synth.signals import Signal
from synth.timing import Discrete

TIME = Discrete(1e-3)
LAW, PASSED = Signal("law", "A", -1.0, 1.0), Signal("d", "A", -1.0, 1.0)


@pytest.mark.parametrize("ready", [0.0, 1.0])
@pytest.mark.parametrize("complete", [0.0, 1.0])
def test_a_demand_passes_once_a_sample_was_complete(ready: float, complete: float) -> None:
    block = start.block(TIME, {LAW: PASSED})
    assert [s.name for s in block.inputs] == ["ready", "complete", "law"]
    passed = float(block.function()(block.initial, [ready, complete, 0.7])[1])
    assert passed == (0.7 if ready or complete else 0.0)
    expected = guard.begun({"guard_ready": np.array(ready)}, {"d": np.array(0.7)}, np.array(complete > 0))
    assert passed == expected["d"]
