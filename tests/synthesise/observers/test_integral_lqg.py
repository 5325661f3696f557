"""Estimated state feedback with integrators: what remains of constant forces and of references."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from synth.statespace import StateSpace
from synth.synthesise.feedback import lqr
from synth.synthesise.observers import kalman, lqg
from synth.timing import Continuous
from tests import tolerances
from tests.synthesise.observers.models import FORMS, T, held_mass, mass


def planar() -> StateSpace:
    """Equations (26), (27): x, y, phi and their rates under three currents."""
    M = np.array([[0, 0, 13.2547], [13.2547, 13.2547, 0], [-117.15, 117.15, 0]])
    A, B = np.eye(6, k=3), np.vstack([np.zeros((3, 3)), M])
    states, inputs = ("x", "y", "phi", "d", "f", "v"), ("i_aq", "i_bq", "i_cq")
    units = dict(zip((*states, *inputs), ("m", "m", "rad", "m/s", "m/s", "rad/s", "A", "A", "A"), strict=True))
    outputs = ("x_hall", "y_hall", "phi_hall")
    units |= dict(zip(outputs, ("m", "m", "rad"), strict=True))
    return StateSpace(A, B, np.eye(3, 6), np.zeros((3, 3)), states, inputs, outputs, Continuous(), units)


def last(loop: StateSpace, constant: dict[str, float], steps: int) -> dict[str, float]:
    """The outputs of a sampled loop after many steps with constant inputs."""
    x, u = np.zeros(len(loop.states)), np.array([constant.get(name, 0.0) for name in loop.inputs])
    for _ in range(steps):
        x = loop.A @ x + loop.B @ u
    return dict(zip(loop.outputs, loop.C @ x + loop.D @ u, strict=True))


@pytest.mark.parametrize("form", FORMS)
def test_integrators_leave_no_error_to_a_constant_force_and_reference(form: Callable[..., lqg.Controller]) -> None:
    estimator = held_mass()
    full = lqr.with_integrators(estimator.model, ("y",))
    assert (full.states, full.unit("y_integral")) == (("x", "v", "y_integral"), "m s")
    loop = form(lqr.lqr(full, np.diag([1e6, 1, 1e8]), [[1e-2]]), estimator)
    assert loop.separation < tolerances.of("double") * 1e2
    assert loop.compensator.inputs == ("y", "y_reference")
    push = {"x_disturbance": 1e-6, "v_disturbance": 2e-3, "y_reference": 3e-4}
    assert last(loop.loop, push, 20_000)["y"] == pytest.approx(3e-4, rel=tolerances.of("settled"))
    plain = form(lqr.lqr(estimator.model, np.diag([1e6, 1]), [[1e-2]]), estimator)
    assert abs(last(plain.loop, {"v_disturbance": 2e-3}, 20_000)["y"]) > 1e-5


def test_the_integral_of_a_continuous_loop_is_that_of_the_error() -> None:
    estimator = kalman.continuous(mass(), [1e-3], [25e-13], G=mass().B)
    full = lqr.with_integrators(mass(), ("y",))
    np.testing.assert_array_equal(full.A, [[0, 1, 0], [0, 0, 0], [1, 0, 0]])  # the pattern of (31)
    loop = lqg.predictor(lqr.lqr(full, np.diag([1e4, 1, 1e5]), [[1e-2]]), estimator)
    assert loop.separation < tolerances.of("double") * 1e2
    rest = -np.linalg.solve(loop.loop.A, loop.loop.B)
    final_outputs = loop.loop.C @ rest + loop.loop.D
    y, names = final_outputs[0], loop.loop.inputs
    assert y[names.index("y_reference")] == pytest.approx(1.0)
    assert y[names.index("v_disturbance")] == pytest.approx(0.0, abs=1e-12)


def test_a_direct_term_is_integrated_too() -> None:
    plant = replace(mass(), D=[[0.25]])
    np.testing.assert_array_equal(lqr.with_integrators(plant, ("y",)).B, [[0], [1 / 1.52], [0.25]])
    estimator = kalman.kalmd(plant, [1e-3], [25e-10], T, G=mass().B)
    loop = lqg.predictor(
        lqr.lqr(lqr.with_integrators(estimator.model, ("y",)), np.diag([1e4, 1, 1]), [[1e-2]]), estimator
    )
    assert loop.separation < tolerances.of("double") * 1e2


def test_the_planar_stage_with_three_integrators_at_800_hz() -> None:
    """The model of (26), (27), (31) with the weights (47), (48), the integrals' first as printed."""
    plant, period = planar(), 1 / 800
    G = np.vstack([np.zeros((3, 3)), np.eye(3)])
    estimator = kalman.kalmd(plant, np.eye(3) * 1e-2, [25e-10] * 3, period, G=G)
    full = lqr.with_integrators(estimator.model, plant.outputs)
    Q = np.diag([1e3, 1e4, 1e3, 1e2, 1e2, 1e2, 1e9, 1e8, 1e8])
    loop = lqg.current(lqr.lqr(full, Q * period, np.eye(3) * period), estimator)
    assert loop.separation < tolerances.of("multiple_root")
    assert np.abs(loop.poles).max() < 1
    target = {"x_hall_reference": 20e-6, "y_hall_reference": 100e-6, "phi_hall_reference": 1e-4, "v_disturbance": 1e-3}
    reached = last(loop.loop, target, 6000)
    for name in plant.outputs:
        assert reached[name] == pytest.approx(target[f"{name}_reference"], rel=1e-6)
