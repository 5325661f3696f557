"""The leaky counter of bad samples in guard and landing: which patterns are too many, and what it was without leak."""

from collections.abc import Sequence

import numpy as np
import pytest

from synth.block import Block
from synth.blocks.faults import landing
from synth.blocks.guard import safety
from synth.blocks.guard.safety import GuardedInput, guard
from synth.signals import Signal, signal_names
from synth.timing import Discrete

TIME = Discrete(1e-3)
READING = GuardedInput(Signal("reading", "m", -1.0, 1.0), 0.0, True)


def first(block: Block, flag: str, rows: Sequence[dict[str, float]]) -> int:
    """Return the first sample in which a flag is set, -1 for none; inputs are 0 where a sample does not name them."""
    step, state = block.function(), block.initial
    for k, row in enumerate(rows):
        state, y = (np.array(v).ravel() for v in step(state, [row.get(s.name, 0.0) for s in block.inputs]))
        if dict(zip(signal_names(block.outputs), y, strict=True))[flag] > 0:
            return k
    return -1


def latches(pattern: str, good_samples: int, times: int = 200) -> int:
    """Return the sample of the latch for a pattern of good (.) and bad (x) samples that is repeated."""
    rows = [{"reading": 5.0 if c == "x" else 0.0} for c in pattern * times]
    return first(guard(TIME, [READING], 5, good_samples=good_samples), "latched", rows)


@pytest.mark.parametrize("good_samples", [0, 1, 4])
def test_five_bad_samples_in_a_row_latch_in_the_fifth(good_samples: int) -> None:
    assert latches("x", good_samples) == 4 and latches("." * 30 + "x" * 5, good_samples) == 34


def test_four_bad_samples_and_a_good_one_for_ever_latch_with_a_leak_only() -> None:
    assert latches("xxxx.", 4) == 6 and latches("xxxx.", 0) == -1


def test_more_than_one_bad_sample_in_five_latches_and_no_more_than_one_in_five_does_not() -> None:
    assert latches("x....", 4) == latches("x.....", 4) == -1
    assert 0 < latches("xx.......", 4) < 200 and 0 < latches("x...", 4) < 100
    assert latches("xxxx" + "." * 16, 4) == -1


def test_a_landing_begins_by_the_same_count() -> None:
    course = landing.Descent("y", 0.031, 0.08, 5e-3, 1e-3, 2.0, 4e-4, 60.0, 0.1, 0.0305)
    for good_samples, begins in ((4, 6), (0, -1)):
        block = landing.block(TIME, [course], [Signal("w_y", "m/s^2", -1e3, 1e3)], 5, good_samples)
        rows = [{"ready": 1.0, "regular": float(k % 5 == 4)} for k in range(500)]
        assert first(block, "lands", rows) == begins


def test_the_rule_is_stated() -> None:
    assert safety.rule(5, 0) == "5 samples in a row"
    assert safety.rule(5, 4) == "5 samples in a row, or more than 1 in 5 for long"
