"""Each output has a separate floor, given or from its declared range."""

from typing import Any

import numpy as np
import pytest

from synth.block import Exprs, State, Step, build
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


@pytest.mark.parametrize(
    ("step", "message"),
    [
        (lambda x, u: ({}, {"x": 0.0}, 0), r"output 'x' of shape \(\), needed is \(3,\): compute it for each step"),
        (lambda x, u: ({"count": np.zeros(2)}, {}, 0), r"state 'count' of shape \(2,\), needed is \(3,\)"),
        (lambda x, u: ({}, {}, np.zeros(2)), r"fault words of shape \(2,\), needed is \(3,\)"),
        (lambda x, u: ({}, {}), "the reference returns .*: return three values, the next states by name"),
        (
            lambda x, u: ({}, {"x": u["x_in"] + np.zeros(2)}, 0),
            r"stops at .*test_agree.py:\d+: operands .* the shape \(3,\)",
        ),
    ],
)
def test_columns_of_another_shape_are_refused(step: Any, message: str) -> None:
    with pytest.raises(SignalError, match=message):
        agree.reference(step)({"count": np.zeros(3)}, {"x_in": np.zeros(3)})


def test_a_constant_fault_word_is_that_of_each_step() -> None:
    results = agree.reference(lambda x, u: ({}, {"x": u["x_in"]}, 4))({}, {"x_in": np.zeros(3)})
    assert results.faults.tolist() == [4, 4, 4]


def test_a_reference_with_a_third_parameter_reads_the_bounds_of_the_states() -> None:
    def step(x: Any, u: Any, bounds: Any) -> Any:
        return {"sum": np.clip(x["sum"] + u["e"], *bounds["sum"])}, {}, 0

    def law(u: Exprs, x: Exprs, k: Exprs) -> Step:
        return Step({}, {"sum": x["sum"] + u["e"]})

    e, sums = Signal("e", "m", -1.0, 1.0), State(Signal("sum", "m", -2.5, 4.0), 0.0)
    block = build("integral", Discrete(1e-3), law, inputs=[e], outputs=[], states=[sums])
    results = agree.reference(step, block)({"sum": np.array([3.5, 0.0, -2.0])}, {"e": np.array([1.0, 1.0, -1.0])})
    assert results.states["sum"].tolist() == [4.0, 1.0, -2.5]
