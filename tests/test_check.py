"""A check's verdict."""

import json
import math

import numpy as np
import pytest

from synth.check import Check


@pytest.mark.parametrize(
    ("value", "passed"), [(1.0, True), (np.float32(1), True), (np.float64(2), False), (math.nan, False)]
)
def test_a_figure_is_held_against_its_limit_and_the_verdict_can_be_written(value: float, passed: bool) -> None:
    verdict = Check("gap", value, 1.0, "m").passed
    assert verdict is passed and json.loads(json.dumps(verdict)) is passed
