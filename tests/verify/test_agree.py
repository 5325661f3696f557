"""Each output has a separate floor, given or from its declared range."""

import numpy as np
import pytest

from synth.block import Step, build
from synth.errors import SignalError
from synth.signals import Signal
from synth.timing import Discrete
from synth.verify import agree

X, ANGLE = Signal("x", "m", -1e-3, 5e-4), Signal("angle", "rad", -3, 3)
BLOCK = build(
    "two",
    Discrete(1e-3),
    lambda u, x, k: Step({"x": u["x_in"], "angle": u["angle_in"]}),
    inputs=[Signal("x_in", "m", -1e-3, 5e-4), Signal("angle_in", "rad", -3, 3)],
    outputs=[X, ANGLE],
)


def worst(floor: agree.Floor) -> tuple[float, str]:
    """Return an error of 1e-6 of the range of x and of 1e-9 of the range of the angle."""
    words = np.zeros(1, np.uint32)
    right = agree.StepResults({"x": np.zeros(1), "angle": np.zeros(1)}, {}, words)
    wrong = agree.StepResults({"x": np.full(1, 1e-9), "angle": np.full(1, 3e-9)}, {}, words)
    agreement = agree.compare("steps", ("right", right), ("wrong", wrong), floor, BLOCK)
    return agreement.worst, agreement.signal


def test_a_common_floor_hides_errors_of_an_output_with_a_small_range() -> None:
    assert worst(1.0) == (3e-9, "angle")
    assert worst(None) == (pytest.approx(1e-6), "x")
    assert worst({"x": 1e-3, "angle": 1.0}) == (pytest.approx(1e-6), "x")
    assert worst({"x": 1.0}) == (1e-9, "x"), "the angle's own range serves"


@pytest.mark.parametrize(
    ("floor", "words"), [({"y": 1.0}, "floor of 'y': it is not one of the outputs x, angle"), (0.0, "'x' is 0.0: give")]
)
def test_an_invalid_floor_is_refused(floor: agree.Floor, words: str) -> None:
    with pytest.raises(SignalError, match=words):
        worst(floor)


def test_a_name_that_the_reference_does_not_find_is_refused_with_those_that_there_are() -> None:
    witness = agree.reference(lambda x, u: ({}, {"x": u["y_in"]}, 0))
    with pytest.raises(SignalError, match=r"looks up 'y_in' .* not find it: the states are count, the inputs x_in"):
        witness({"count": np.zeros(1)}, {"x_in": np.zeros(1)})
