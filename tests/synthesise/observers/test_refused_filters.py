"""What has no steady-state filter, and what lies just inside."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from synth.errors import ModelError, SignalError, TimingError
from synth.statespace import StateSpace
from synth.synthesise.observers import kalman
from synth.timing import Continuous, Discrete
from tests import tolerances
from tests.synthesise.observers.models import mass, scalar

BIASED = StateSpace(np.diag([-1.0, 0.0]), [[1], [0]], [[1, 0]], [[0]], ("x", "bias"), ("u",), ("y",), Continuous())
SEEN_BIAS = replace(BIASED, C=[[1, 1]])


@pytest.mark.parametrize(
    ("make", "error", "message"),
    [
        (lambda: kalman.continuous(BIASED, [1, 1], [1]), ModelError, "not detectable: mode 0 in bias"),
        (lambda: kalman.continuous(SEEN_BIAS, {"x": 1}, [1]), ModelError, "no noise excites the mode 0 in bias"),
        (lambda: kalman.discrete(scalar(1, Discrete(1)), [0], [1]), ModelError, "no noise excites the mode 1 in x1"),
        (lambda: kalman.continuous(mass(), {"v": 1}, [0.0]), ModelError, "measurement of y .* reduced-order observer"),
        (
            lambda: kalman.continuous(
                replace(mass(), C=np.eye(2), D=[[0], [0]], outputs=("x", "v")), [1, 1], [[1, 1], [1, 1]]
            ),
            ModelError,
            "measurement of x, v .* reduced-order",
        ),
        (lambda: kalman.kalmd(mass(), {"v": 1}, [0.0], 1e-3), ModelError, "measurement of y has no white noise"),
        (lambda: kalman.continuous(mass(), {"v": 1}, [-1.0]), SignalError, "V has the eigenvalue -1"),
        (lambda: kalman.continuous(mass(), [[1, 2], [0, 1]], [1]), SignalError, "W is not symmetric"),
        (lambda: kalman.continuous(mass(), [1, np.nan], [1]), SignalError, "W has nan"),
        (lambda: kalman.continuous(mass(), {"q": 1}, [1]), SignalError, "names 'q'"),
        (lambda: kalman.continuous(mass(), [1, 1], [1], S=[[0], [2]]), SignalError, "S is larger than W and V allow"),
        (lambda: kalman.continuous(mass(), [1, 1], [1], S=[[0, 2]]), SignalError, "S is "),
        (lambda: kalman.continuous(mass(), [1], [1], G="g"), SignalError, "'g' is not one of f"),
        (lambda: kalman.continuous(mass(), [1], [1], G=[[1.0]]), SignalError, "G is .* 2 states"),
        (lambda: kalman.continuous(mass().select((), ("f",)), [1, 1], []), SignalError, "0 outputs"),
        (lambda: kalman.discrete(mass(), [1, 1], [1]), TimingError, "sample period"),
        (lambda: kalman.continuous(scalar(1, Discrete(1)), [1], [1]), TimingError, "discretise or resample"),
        (lambda: kalman.kalmd(scalar(1, Discrete(1)), [1], [1], 0.1), TimingError, "continuous model"),
        (lambda: kalman.kalmd(mass(), [1, 1], [1], 0.0), TimingError, "period"),
        (lambda: kalman.kalmd((-1, 1, 1, 1), [1], [1], 0.1, G="u1"), SignalError, "has a direct path to y1"),
    ],
)
def test_what_has_no_filter_is_refused(make: Callable[[], object], error: type[Exception], message: str) -> None:
    with pytest.raises(error, match=message):
        make()


def test_an_unstable_mode_with_noise_and_a_decaying_one_without_both_have_a_filter() -> None:
    model = StateSpace(np.diag([2.0, -1.0]), [[1], [1]], [[1, 1]], [[0]], ("a", "b"), ("u",), ("y",), Continuous())
    estimator = kalman.continuous(model, {"a": 1}, [1])
    assert estimator.poles.real.max() < 0
    assert abs(estimator.prior[1, 1]) < tolerances.of("double")


def test_noise_determined_by_the_measurement_counts_as_known() -> None:
    """w = v S / V: x' = a x + (S / V) (y - x), which decays or not without a filter's help."""
    estimator = kalman.continuous(scalar(0, Continuous()), [1.0], [1.0], S=[[1.0]])
    assert (estimator.prior[0, 0], estimator.L[0, 0]) == (pytest.approx(0, abs=1e-14), pytest.approx(1))
    with pytest.raises(ModelError, match="no noise excites the mode 0 in x1"):
        kalman.continuous(scalar(-1, Continuous()), [1.0], [1.0], S=[[-1.0]])


@pytest.mark.parametrize("size", [1e-310, 1e-120, 1e120])
def test_variances_that_cannot_be_squared_are_refused(size: float) -> None:
    plant = ([[0, 1.0], [0, 0]], [[0], [1.0]], [[1.0, 0]], [[0.0]])
    for make in (
        lambda: kalman.continuous(plant, [size, size], [size]),
        lambda: kalman.discrete((*plant, 0.1), [1.0, 1.0], [size]),
        lambda: kalman.kalmd(plant, [size, size], [size], 0.1),
    ):
        with pytest.raises(SignalError, match=r"the noise on (x1|y1) has the size .*; choose|the weight [WV] reach 1e"):
            make()
