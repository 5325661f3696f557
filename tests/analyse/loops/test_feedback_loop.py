"""Sensitivity functions against matrix algebra, an explicit recursion, and python-control."""

from dataclasses import replace

import control
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from synth.analyse.loops import feedback_loop, loop, stability_margins
from synth.errors import TimingError
from synth.statespace import StateSpace
from synth.timing import Continuous, Discrete, Time
from tests import tolerances

T = 0.01
CONTINUOUS = Continuous()


def random(rng: np.random.Generator, n: int, m: int, p: int, time: Time, direct: float = 0.0) -> StateSpace:
    A = rng.normal(size=(n, n)) / 2 - (2 * np.eye(n) if isinstance(time, Continuous) else 0)
    parts = (A, rng.normal(size=(n, m)), rng.normal(size=(p, n)), direct * rng.normal(size=(p, m)))
    labels = (tuple(f"{letter}{k}" for k in range(count)) for letter, count in (("x", n), ("f", m), ("q", p)))
    return StateSpace(*parts, *labels, time)


def stage() -> StateSpace:
    names = (("q", "v"), ("f",), ("q",), Continuous())
    return StateSpace([[0, 1], [0, 0]], [[0], [0.5]], [[1, 0]], [[0]], *names, {"q": "m", "v": "m/s", "f": "N"})


def controller(time: Time = CONTINUOUS) -> StateSpace:
    labels = (("lag",), ("error",), ("force",), time)
    return StateSpace([[-80.0]], [[1.0]], [[-2e4]], [[300.0]], *labels, {"error": "m", "force": "N", "lag": "m s"})


@settings(derandomize=True, max_examples=20, deadline=None)
@given(st.integers(0, 10**6), st.booleans())
def test_each_transfer_is_what_its_formula_says(seed: int, sampled: bool) -> None:
    rng = np.random.default_rng(seed)
    m, p, time = int(rng.integers(1, 4)), int(rng.integers(1, 4)), Discrete(T) if sampled else Continuous()
    plant, K = random(rng, 3, m, p, time, 0.2), random(rng, 2, p, m, time, 0.2)
    closed, v = feedback_loop.close(plant, replace(K, outputs=tuple("abc"[:m]), inputs=tuple("uvw"[:p]))), 1.7 + 0.9j
    Pv, Kv = plant.response(v)[0], K.response(v)[0]
    S, Si = np.linalg.inv(np.eye(p) + Pv @ Kv), np.linalg.inv(np.eye(m) + Kv @ Pv)
    expected = {"L": Pv @ Kv, "S": S, "T": Pv @ Kv @ S, "PS": Pv @ Si, "CS": Kv @ S}
    expected |= {"Li": Kv @ Pv, "Si": Si, "Ti": Kv @ Pv @ Si}
    for name, value in expected.items():
        model = getattr(closed, name)
        assert model.time == time
        np.testing.assert_allclose(model.response(v)[0], value, rtol=0, atol=1e-10 * np.abs(value).max(), err_msg=name)
    np.testing.assert_allclose(closed.S.response(v) + closed.T.response(v), np.eye(p)[None], atol=1e-10)
    if m > 1 or p > 1:
        assert Pv.shape != Kv.shape or np.abs(Pv @ Kv - Kv @ Pv).max() > 1e-6  # input and output are distinguished


def test_the_signals_are_those_of_the_diagram() -> None:
    """The loop stepped by hand, sample by sample, with references, disturbances and noise at once.

    This loop is unstable: its signals grow to 1e5, and the tolerance with them.
    """
    rng = np.random.default_rng(8)
    P, K = random(rng, 3, 2, 2, Discrete(T)), random(rng, 2, 2, 2, Discrete(T), 0.1)
    closed = feedback_loop.close(P, replace(K, outputs=("a", "b"), inputs=("g", "h")))
    r, d, n = (rng.normal(size=(12, 2)) for _ in "rdn")
    xp, xk, x = np.zeros(3), np.zeros(2), np.zeros(5)
    for k in range(12):
        y = P.C @ xp
        e = r[k] - y - n[k]
        u = K.C @ xk + K.D @ e
        v = u + d[k]
        outside = np.concatenate([r[k], d[k], n[k]])
        signals = closed.whole.C @ x + closed.whole.D @ outside
        stepped = np.concatenate([e, u, v, y])
        np.testing.assert_allclose(signals, stepped, rtol=0, atol=1e-10 * max(1.0, np.abs(stepped).max()))
        x = closed.whole.A @ x + closed.whole.B @ outside
        xp, xk = P.A @ xp + P.B @ v, K.A @ xk + K.B @ e


def test_names_and_units_come_from_the_plant() -> None:
    closed = feedback_loop.close(stage(), controller())
    ends = {
        name: (
            getattr(closed, name).labels(getattr(closed, name).inputs),
            getattr(closed, name).labels(getattr(closed, name).outputs),
        )
        for name in feedback_loop.ARROWS
    }
    assert ends == {
        "L": (("q_error [m]",), ("q [m]",)),
        "S": (("q_reference [m]",), ("q_error [m]",)),
        "T": (("q_reference [m]",), ("q [m]",)),
        "PS": (("f_disturbance [N]",), ("q [m]",)),
        "CS": (("q_reference [m]",), ("f_command [N]",)),
        "Li": (("f [N]",), ("f_compensation [N]",)),
        "Si": (("f_disturbance [N]",), ("f [N]",)),
        "Ti": (("f_disturbance [N]",), ("f_compensation [N]",)),
    }
    assert closed.whole.labels(closed.whole.states) == ("plant_q [m]", "plant_v [m/s]", "controller_lag [m s]")
    # a unit given only by the controller applies to the plant's signal as well
    bare = feedback_loop.close(replace(stage(), units={}), controller())
    assert bare.T.labels(bare.T.outputs) == ("q [m]",)


def test_python_control_closes_the_same_loop() -> None:
    closed = feedback_loop.close(stage(), controller())
    P, K = stage().to_control(), controller().to_control()
    four = {"S": (1, P * K), "T": (P * K, 1), "PS": (P, K), "CS": (K, P)}
    for name, (forward, back) in four.items():
        expected = control.feedback(forward, back)
        for s in (2j, 15j, 300j):
            assert getattr(closed, name).response(s)[0, 0, 0] == pytest.approx(
                complex(expected(s)), rel=tolerances.of("pencil")
            )
    assert closed.stable and "stable" in repr(closed) and "compliance" in repr(closed)
    np.testing.assert_allclose(np.sort_complex(control.feedback(P * K, 1).poles()), closed.poles, rtol=1e-9)


def test_margins_follow_from_L_and_peak_sensitivity_from_S() -> None:
    closed = feedback_loop.close(stage(), controller())
    loop_margins = stability_margins.of_loop(closed.L)
    w = np.sort(
        np.concatenate([np.linspace(1, 100, 2001), loop_margins.peak_frequency * np.linspace(0.99, 1.01, 2001)])
    )
    assert np.abs(closed.S.response(1j * w)).max() == pytest.approx(loop_margins.peak_sensitivity, rel=1e-6)
    assert stability_margins.of_loop(closed.Li).gain_crossings[0].phase_margin == pytest.approx(
        loop_margins.phase_margin, rel=1e-9
    )


def test_a_loop_with_the_wrong_sign_is_not_stable() -> None:
    wrong = replace(controller(), C=-controller().C, D=-controller().D)
    assert not feedback_loop.close(stage(), wrong).stable
    assert "NOT STABLE" in repr(feedback_loop.close(stage(), wrong))


def test_a_sampled_controller_needs_a_sampled_plant() -> None:
    K = controller(Discrete(T))
    with pytest.raises(TimingError, match=r"sample the plant with loop.sampled\(plant, 0.01, delay_s\)"):
        feedback_loop.close(stage(), K)
    with pytest.raises(TimingError, match="discretise or resample"):
        feedback_loop.close(loop.sampled(stage(), 2 * T), K)
    closed = feedback_loop.close(loop.sampled(stage(), T, 0.3 * T), replace(K, A=[[0.3]], C=[[-30.0]]))
    assert closed.L.time == Discrete(T) and "plant_f_held" in closed.whole.states


@pytest.mark.parametrize("back", [None, control.tf([1, 4], [1, 9])])
def test_feedback_is_that_of_python_control_and_keeps_the_names(back: control.TransferFunction | None) -> None:
    forward = control.tf([3], [1, 2, 5])
    loop, reference = feedback_loop.feedback(forward, back), control.feedback(forward, 1 if back is None else back)
    points = 1j * np.array([0.1, 1.0, 10.0])
    np.testing.assert_allclose(loop.response(points)[:, 0, 0], reference(points), rtol=tolerances.of("double"))
    assert (loop.inputs, loop.outputs) == (("u[0]",), ("y[0]",))
