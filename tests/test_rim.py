"""What users gave and got a raw error for, or a wrong answer: each is read, or refused by name."""

from collections.abc import Callable
from typing import Any

import control
import numpy as np
import pytest

from synth.analyse import discretise
from synth.analyse.loops import disk, feedback_loop, interconnect, transfer
from synth.errors import ModelError, SignalError, TimingError
from synth.statespace import StateSpace, in_common_time, of
from synth.synthesise.classical import lead_lag
from synth.synthesise.feedback import inverse_lqr, lqr
from synth.synthesise.observers import lqg
from synth.synthesise.regulation import internal_model
from synth.synthesise.riccati import riccati
from synth.timing import Continuous, Discrete

PLANT = control.ss(control.tf([1], [1, 1, 0]))
HELD = control.c2d(PLANT, 0.1)
TWO = ([[0.0, 1.0], [-1.0, -1.0]], [[0.0], [1.0]], [[1.0, 0.0]])
GAINS = {
    "a static gain": lambda dt: control.ss([], [], [], [[2.0]], dt),
    "a transfer function": lambda dt: control.tf([2.0], [1.0], dt),
    "a lag": lambda dt: control.ss([[0.5]], [[1.0]], [[1.0]], [[2.0]], dt),
}


@pytest.mark.parametrize("dt", [None, True])
@pytest.mark.parametrize("name", GAINS)
def test_a_controller_without_time_takes_the_plants(name: str, dt: Any) -> None:
    closed = feedback_loop.close(HELD, GAINS[name](dt))
    timed = feedback_loop.close(HELD, GAINS[name](0.1))
    assert closed.whole.time == Discrete(0.1)
    np.testing.assert_array_equal(closed.whole.A, timed.whole.A)
    assert feedback_loop.close(GAINS[name](dt), HELD).whole.time == Discrete(0.1)
    if dt is None:
        assert feedback_loop.close(PLANT, GAINS[name](None)).whole.time == Continuous()


def test_a_sampled_controller_of_no_period_does_not_meet_a_continuous_plant() -> None:
    with pytest.raises(TimingError, match=r"a sampled system \(dt is True\) meets continuous time"):
        feedback_loop.close(PLANT, GAINS["a static gain"](True))
    with pytest.raises(SignalError, match="there is no sample period, dt is None"):
        in_common_time(GAINS["a static gain"](None), GAINS["a lag"](None))
    gain = GAINS["a static gain"](None)
    named = of(HELD).renamed({"u[0]": "f", "y[0]": "q"})
    assert interconnect.connect([named, gain], ["f", "u[0]"], ["q", "y[0]"], {}).time == Discrete(0.1)
    assert gain.dt is None, "the caller's system stays what it was"


REFUSED: dict[str, tuple[Callable[[], Any], type[Exception], str]] = {
    "cost_ratio": (
        lambda: lqr.cost_ratio(TWO, [[1.0, 1.0]], np.eye(2), [[1.0]], 0.01),
        SignalError,
        "`gain` .* a Gain",
    ),
    "predictor": (lambda: lqg.predictor(np.eye(2), np.eye(2)), SignalError, "`gain` .* give a Gain"),
    "from_time_constants": (
        lambda: lead_lag.from_time_constants(1.0, 0.1, 0.01),
        SignalError,
        "`numerator_constants_s` .* is 0.1",
    ),
    "integrators": (lambda: lead_lag.from_time_constants(1.0, [], [], -1), SignalError, "-1 integrators"),
    "certify": (lambda: riccati.certify(TWO, np.eye(2), [[1.0]], 1e300 * np.eye(2)), SignalError, r"reach 1e\+300"),
    "poles": (lambda: inverse_lqr.diagonal_weights(TWO, [-1e200, -1.0]), SignalError, "`poles` of"),
    "far poles": (
        lambda: inverse_lqr.diagonal_weights(TWO, [-2e90, -3e90]),
        ModelError,
        "overflow: choose a unit",
    ),
    "skew": (lambda: disk.of_loop(TWO, skew=None), SignalError, "`skew` of `disk.of_loop` is None: give a number"),
    "delayed": (
        lambda: transfer.with_delay_and_hold(TWO, None),
        TimingError,
        "`delay_s` of .* is None: .* of seconds",
    ),
    "a huge delay": (lambda: discretise.delay_samples(of(HELD), 10**9), TimingError, "take at most 10000"),
}


@pytest.mark.parametrize("name", REFUSED)
def test_what_is_no_argument_is_refused_by_its_name(name: str) -> None:
    call, kind, message = REFUSED[name]
    with pytest.raises(kind, match=message):
        call()


def test_numbers_of_numpy_are_numbers() -> None:
    single = internal_model.leapfrog([1.0], np.float32(1e-3))
    np.testing.assert_array_equal(single.T, internal_model.leapfrog([1.0], float(np.float32(1e-3))).T)


def test_a_long_delay_is_the_shift_register_of_its_samples() -> None:
    rng = np.random.default_rng(0)
    shapes = ((3, 3), (3, 2), (1, 3), (1, 2))
    A, B, C, D = (rng.normal(size=shape) for shape in shapes)
    names = (("x1", "x2", "x3"), ("u1", "u2"), ("y",))
    model = StateSpace(A, B, C, D, *names, Discrete(0.1), {"u1": "A"})
    late = discretise.delay_samples(model, 3)
    assert late.states == (*names[0], *(f"u{j}_late{k}" for k in (1, 2, 3) for j in (1, 2)))
    assert late.unit("u1_late3") == "A" and late.unit("u2_late1") == ""
    z = np.exp(1j * np.array([0.1, 1.0, 3.0]))
    np.testing.assert_allclose(late.response(z), model.response(z) * z[:, None, None] ** -3, rtol=1e-12)
    assert len(discretise.delay_samples(model, 1500).states) == 3003


MASKED = np.ma.array([[0.0, 1.0], [-1.0, -1.0]], mask=[[False, True], [False, False]])


@pytest.mark.parametrize(
    "call",
    [
        lambda: of((MASKED, [[0.0], [1.0]])),
        lambda: of(([list(row) for row in MASKED], [[0.0], [1.0]])),
        lambda: StateSpace(MASKED, np.eye(2), np.eye(2), np.eye(2), ("a", "b"), ("c", "d"), ("e", "f"), Continuous()),
        lambda: lqr.lqr(TWO, MASKED, [[1.0]]),
        lambda: discretise.gramian(MASKED, np.eye(2), 0.1),
    ],
)
def test_masked_entries_are_not_read_through_the_mask(call: Callable[[], Any]) -> None:
    with pytest.raises(SignalError, match="mask"):
        call()
