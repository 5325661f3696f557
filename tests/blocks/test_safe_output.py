"""Safe output: the target once latched, in flight and once landed, and what is refused."""

from dataclasses import replace

import numpy as np
import pytest

from synth.block import Safety
from synth.blocks import safe_output
from synth.errors import SignalError
from synth.signals import Signal
from synth.timing import Discrete

TIME = Discrete(1e-3)
OUTPUTS = [Signal(n, "A", -3.0, 3.0) for n in ("i_1", "i_2", "u")]
SAFE = Safety(5, {"i_1": 2.0, "i_2": 2.0, "u": 0.0}, dict.fromkeys(("i_1", "i_2", "u"), 500.0), "rests")
LANDED = replace(SAFE, landed_output={"i_1": 0.0, "i_2": 0.5, "u": 0.0})


def after_latch(safety: Safety, landed: float | None) -> dict[str, float]:
    """Return the outputs 20 samples after a latch from 1 A."""
    block = safe_output.block(TIME, OUTPUTS, safety)
    step, x = block.function(), np.ones(3)
    flags = {"latched": 1.0} | ({} if landed is None else {"rests": landed})
    u = [({f"{s.name}_computed": 1.0 for s in OUTPUTS} | flags)[s.name] for s in block.inputs]
    for _ in range(20):
        x, y = (np.array(v).ravel() for v in step(x, u))
    return dict(zip((s.name for s in OUTPUTS), y, strict=False))


def test_a_latch_in_flight_and_one_once_landed_have_their_own_values() -> None:
    assert after_latch(SAFE, None) == {"i_1": 2.0, "i_2": 2.0, "u": 0.0}
    assert after_latch(LANDED, 0.0) == {"i_1": 2.0, "i_2": 2.0, "u": 0.0}
    assert after_latch(LANDED, 1.0) == {"i_1": 0.0, "i_2": 0.5, "u": 0.0}


def test_values_that_do_not_differ_need_no_flag() -> None:
    block = safe_output.block(TIME, OUTPUTS, replace(SAFE, landed_output=SAFE.safe_output))
    assert "rests" not in [s.name for s in block.inputs]


@pytest.mark.parametrize(
    ("landed", "text"),
    [({"i_1": 4.0}, "the safe output 4.0 of 'i_1' is outside -3.0 .. 3.0"), ({"i_3": 0.0}, "'i_3' has a value once")],
)
def test_a_wrong_value_is_refused(landed: dict[str, float], text: str) -> None:
    with pytest.raises(SignalError, match=text):
        safe_output.block(TIME, OUTPUTS, replace(SAFE, landed_output=landed))
