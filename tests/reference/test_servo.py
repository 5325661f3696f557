"""The reference of a servo axis, against SciPy in double precision, poles in closed form, and its own rest."""

from dataclasses import replace
from math import exp, pi

import numpy as np
import pytest
from scipy import linalg

from synth.reference import servo
from synth.reference.servo import Servo

T, SCAN = 1 / 2000, 20 * pi
LIMITS = {"sum": 1.0, "p1": 1.0, "q1": 1.0, "x_predicted": 1.0, "v_predicted": 10.0, "u_late1_predicted": 100.0}
BOUNDS = {f"servo_x_{n}": (-bound, bound) for n, bound in LIMITS.items()}
AXIS = Servo(
    "x", ((0, 1), (-1300.0, -3.3)), (0, 27.0), ((0.0, 25.0), (SCAN, 20.0)), (1e8, 1e2), 1e1, 1e-4, 1e-14, 0.5, 30.0, T,
    ("x_predicted", "v_predicted", "u_late1_predicted"),
)  # fmt: skip


def test_the_model_and_the_estimator_are_those_of_scipy() -> None:
    k, A, B = servo.gains(AXIS), np.array(AXIS.A), np.array(AXIS.B)[:, None]
    held = linalg.expm(np.block([[A, B], [np.zeros((1, 3))]]) * T)
    np.testing.assert_allclose(np.hstack([k.A, k.B]), held[:2], rtol=1e-12, atol=1e-15)
    noise = linalg.expm(np.block([[-A, np.diag([0, AXIS.process])], [np.zeros((2, 2)), A.T]]) * T)
    W = noise[2:, 2:].T @ noise[:2, 2:]
    C = np.array([[1.0, 0.0]])
    P = linalg.solve_discrete_are(k.A.T, C.T, W, [[AXIS.sensor]])
    M = P @ C.T / (C @ P @ C.T + AXIS.sensor)
    np.testing.assert_allclose(k.M, M, rtol=1e-6)
    np.testing.assert_allclose(k.L, k.A @ k.M, rtol=1e-12)


def test_the_loop_decays_and_holds_what_its_modes_ask_for() -> None:
    """Each mode keeps exp(+-j w T) in the law alone; with the anti-windup its poles are shrunk by exp(-a T)."""
    k = servo.gains(AXIS)
    modes = np.sort_complex([1.0, np.exp(1j * SCAN * T), np.exp(-1j * SCAN * T)])
    np.testing.assert_allclose(np.sort_complex(np.linalg.eigvals(k.propagate)), modes, atol=1e-7)
    faded = np.linalg.eigvals(k.propagate - k.E @ k.on_eta)
    np.testing.assert_allclose(np.abs(faded), exp(-AXIS.anti_windup * T), rtol=1e-6)
    # x^(k+1) = A x^ + B u(k-1), the command a sample late: x, u(k-1), eta with y = C x known.
    C = np.array([[1.0, 0.0]])
    closed = np.block(
        [
            [k.A, k.B, np.zeros((2, 3))],
            [k.on_x, k.on_late, k.on_eta],
            [k.drive @ C, np.zeros((3, 1)), k.propagate],
        ]
    )
    assert np.abs(np.linalg.eigvals(closed)).max() < exp(-15.0 * T), (
        "every error decays at about the rates of its modes"
    )


def test_it_wakes_at_rest_where_it_is() -> None:
    """The first command with the set-point at the position is the one that no integral had to learn: none."""
    state = servo.initial_state([AXIS])
    first = servo.command(AXIS, np.array(3e-4), np.array(3e-4), state, BOUNDS)
    assert first.u == pytest.approx(0.0, abs=1e-9)
    after = servo.next_state(AXIS, first, first.u, np.zeros(()), BOUNDS)
    assert after["servo_x_started"] == 1 and set(after) == set(state)
    far = servo.next_state(AXIS, first, np.array(1e6), np.zeros(()), BOUNDS)
    assert far["servo_x_u_late1_predicted"] == LIMITS["u_late1_predicted"], "states keep their bounds"


@pytest.mark.parametrize("field", ["command_weight", "process", "set_point_weight", "anti_windup", "T"])
def test_each_number_of_the_declaration_acts(field: str) -> None:
    other = servo.gains(replace(AXIS, **{field: 1.01 * getattr(AXIS, field)}))
    gaps = [
        np.abs(a - b).max() / np.abs(a).max()
        for a, b in zip(vars(servo.gains(AXIS)).values(), vars(other).values(), strict=True)
    ]
    assert max(gaps) > 1e-4
