"""The position at which a current acts: exact at constant speed, steady under bad samples, and lost where unknown."""

from typing import Any

import numpy as np
import pytest

from synth.block import Block
from synth.blocks.estimate import advance
from synth.blocks.guard import safety
from synth.composition import compose
from synth.execute import host
from synth.signals import Signal
from synth.timing import Discrete

TIME = Discrete(1e-3)
X = Signal("x", "m", -0.1, 0.1)
BAD_SAMPLES, SPEED, A = 5, 1.0, 1.5
STRIDE = SPEED * TIME.period_s


def guarded(samples: float = A, speed: float = SPEED) -> Block:
    """Return the guard with the advance behind it."""
    parts = [
        safety.guard(TIME, [safety.GuardedInput(X, 0.0, False)], BAD_SAMPLES),
        advance.block(TIME, [advance.Position(X, speed)], samples, BAD_SAMPLES),
    ]
    return compose("advanced", parts, inputs=["x"], outputs=["x_acting", "lost_x"])


def run(x: Any, **options: Any) -> dict[str, Any]:
    return host.compile_block(guarded(**options), np.float64).replay({"x": np.asarray(x, float)}).outputs


def test_at_constant_speed_it_is_the_position_when_the_current_acts() -> None:
    speed, k = 0.14, np.arange(200)
    moving = -0.014 + speed * TIME.period_s * k
    acting = run(moving)["x_acting"]
    np.testing.assert_allclose(acting[1:], moving[1:] + A * speed * TIME.period_s, rtol=0, atol=1e-15)
    np.testing.assert_array_equal(run(moving, samples=0.0)["x_acting"], moving)
    assert abs(run(moving, samples=0.5)["x_acting"][1:] - acting[1:]).min() > 1e-4


def test_its_error_is_that_of_the_header_under_constant_acceleration() -> None:
    acceleration, t = 3.0, TIME.period_s * np.arange(300)
    true = lambda t: -0.09 + acceleration * t**2 / 2  # noqa: E731
    error = run(true(t))["x_acting"][1:] - true(t + A * TIME.period_s)[1:]
    np.testing.assert_allclose(error, -(A + 1) / 2 * A * TIME.period_s**2 * acceleration, rtol=1e-6)


def test_the_first_good_sample_is_taken_as_it_is() -> None:
    x = np.array([np.nan, np.nan, 0.03, 0.03])
    outputs = run(x)
    assert outputs["lost_x"].tolist() == [1, 1, 0, 0]
    assert outputs["x_acting"].tolist() == [0.0, 0.0, 0.03, 0.03]


@pytest.mark.parametrize("wrong", [0.09, -0.09])
def test_one_wrong_sample_makes_no_large_step(wrong: float) -> None:
    x = np.full(20, 0.01)
    x[10] = wrong
    acting = run(x)["x_acting"]
    assert np.abs(acting - 0.01).max() == pytest.approx((1 + A) * STRIDE)
    assert np.abs(acting[12:] - 0.01).max() == 0
    assert np.abs(run(x, speed=1000.0)["x_acting"] - 0.01).max() > 0.19  # without a limit of the speed


def test_a_refused_position_is_held_then_lost_and_found_again() -> None:
    x = np.full(20, 0.02)
    x[6:12] = np.nan
    x[12:] = 0.05
    outputs = run(x)
    assert np.flatnonzero(outputs["lost_x"]).tolist() == [10, 11]
    assert (outputs["x_acting"][6:12] == 0.02).all() and (outputs["x_acting"][12:] == 0.05).all()
    x[11] = 0.021  # found again in the sample before: now 0.05 is a jump
    assert run(x)["x_acting"][12] == pytest.approx(0.021 + (1 + A) * STRIDE)
