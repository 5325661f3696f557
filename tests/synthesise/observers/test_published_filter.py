"""The published filter of position, speed and acceleration of one axis, jerk as white noise: equations (7) to (16)."""

import numpy as np
import pytest
from scipy.optimize import brentq

from synth.statespace import StateSpace
from synth.synthesise.observers import kalman, square_root_kalman
from synth.timing import Discrete
from tests.synthesise.observers.models import run

AUDITED = 1e-3  # relative: the audited bandwidths lie 0.02 to 0.10 % above the crossing, as if read on a grid


def published_model(rate: float) -> tuple[StateSpace, np.ndarray]:
    """The model (11), (12) of one axis and Gamma. The axes do not meet in (7) to (13)."""
    T = 1 / rate
    A = [[1, T, T * T / 2], [0, 1, T], [0, 0, 1]]
    model = StateSpace(A, np.zeros((3, 0)), [[1, 0, 0]], np.zeros((1, 0)), ("x", "dx", "ddx"), (), ("y",), Discrete(T))
    return model, np.array([[T**3 / 6], [T * T / 2], [T]])


def bandwidth(form: StateSpace) -> float:
    """Where |x_estimate / y|^2 falls through a half, in Hz."""
    T = form.time.period_s

    def excess(frequency: float) -> float:
        return float(np.abs(form.response(np.exp(2j * np.pi * frequency * T))[0, 0, 0]) ** 2 - 0.5)

    return brentq(excess, 5.0, 0.45 / T, xtol=1e-10)


@pytest.mark.parametrize(
    ("rate", "q", "exact", "audited"),
    [(800, 100, 25.458, 25.463), (1000, 100, 25.627, 25.652), (800, 1e5, 75.532, 75.546), (1000, 1e5, 76.850, 76.882)],
)
def test_the_published_filter_has_half_the_bandwidth_that_is_printed(
    rate: float, q: float, exact: float, audited: float
) -> None:
    """Printed: 50 Hz (x, y; q = 100) and 100 Hz (phi; q = 1e5).

    The transfer is that from the measured position to the estimate of the same sample, of the steady filter for
    W = q Gamma Gamma' and V = (5e-5)^2, at half the power.
    """
    model, Gamma = published_model(rate)
    estimator = kalman.discrete(model, [q], [25e-10], Gamma)
    assert round(bandwidth(estimator.current()), 3) == exact
    assert 0 < audited / bandwidth(estimator.current()) - 1 < AUDITED
    assert abs(bandwidth(estimator.predictor()) / audited - 1) > 0.05  # the other form is another figure
    filtered = run(estimator.current(), np.sin(2 * np.pi * exact / rate * np.arange(8000))[:, None])[4000:, 0]
    assert 2 * np.mean(filtered**2) == pytest.approx(0.5, rel=2e-3)  # a sine at the crossing comes out at half power


@pytest.mark.parametrize(("rate", "ratio"), [(800, 0.33906), (1000, 0.30502)])
def test_the_published_filter_lets_through_a_third_of_the_noise(rate: float, ratio: float) -> None:
    """Printed: down by 75 %. White noise on y alone, stage at rest: the deviation of x_estimate over that of y."""
    model, Gamma = published_model(rate)
    form = kalman.discrete(model, [100.0], [25e-10], Gamma).current()
    impulse = run(form, np.eye(3000, 1))[:, 0]
    assert round(float(np.sqrt(impulse @ impulse)), 5) == ratio


def test_the_gain_as_printed_tends_to_one() -> None:
    """(14) predicts P and never updates it, so that it grows and K of (16) trusts the measurement alone."""
    model, Gamma = published_model(800)
    W = 100 * Gamma @ Gamma.T
    now = square_root_kalman.initial(model, 1e8 * np.eye(3))
    for _ in range(200):
        now = square_root_kalman.predict(now, model, (W + W.T) / 2)
    P = now.P[0, 0]
    assert 1 - P / (P + 25e-10) < 1e-12
    from_nothing = square_root_kalman.initial(model, np.zeros((3, 3)))
    gains = []
    for _ in range(800):
        from_nothing = square_root_kalman.predict(from_nothing, model, (W + W.T) / 2)
        gains.append(from_nothing.P[0, 0] / (from_nothing.P[0, 0] + 25e-10))
    assert (np.diff(gains) > 0).all()
    assert gains[-1] > 1 - 1e-6
    assert kalman.discrete(model, [100.0], [25e-10], Gamma).M[0, 0] == pytest.approx(0.1360, abs=5e-5)
