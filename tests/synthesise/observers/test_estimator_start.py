"""Estimators that start at the first measurement: against the recursion in NumPy and the limit of a Kalman update."""

from dataclasses import replace

import casadi as ca
import numpy as np
import pytest

from synth.block import Block, unranged
from synth.blocks.laws import linear_block
from synth.emit import write
from synth.errors import SignalError
from synth.execute import host
from synth.signals import Signal
from synth.statespace import Array, StateSpace
from synth.synthesise.feedback import lqr
from synth.synthesise.observers import kalman, lqg, square_root_kalman
from synth.synthesise.regulation import servo
from synth.timing import Continuous
from tests import tolerances

pytestmark = pytest.mark.slow

T = 1e-3
UNITS = {"gap": "m", "speed": "m/s", "tilt": "rad", "spin": "rad/s", "near": "m", "far": "m", "force": "m/s^2"}
PLANT = StateSpace(
    np.kron(np.eye(2), [[0, 1], [0, 0]]), [[0], [1], [0], [0.5]], [[1, 0, 0.2, 0], [1, 0, -0.3, 0]], np.zeros((2, 1)),
    ("gap", "speed", "tilt", "spin"), ("force",), ("near", "far"), Continuous(), UNITS,
)  # fmt: skip
FILTER = kalman.kalmd(PLANT, np.diag([0, 1.0, 0, 1.0]), np.full(2, 1e-10), T)
RANGES = {"m": 1.0, "m/s": 100.0, "rad": 2.0, "rad/s": 100.0, "m/s^2": 100.0}


def signals(names: tuple[str, ...], units: dict[str, str]) -> list[Signal]:
    return [Signal(name, units[name], -RANGES[units[name]], RANGES[units[name]]) for name in names]


def estimator_block(model: StateSpace, start: linear_block.Start | None) -> Block:
    units = dict(model.units)
    groups = {kind: signals(getattr(model, kind), units) for kind in ("inputs", "outputs", "states")}
    return linear_block.block("observer", model, **groups, tag="(1)", start=start)


def recursion(model: StateSpace, u: Array, x: Array) -> Array:
    """Return the outputs (N, p) from the state x."""
    y = []
    for now in u:
        y.append(model.C @ x + model.D @ now)
        x = model.A @ x + model.B @ now
    return np.array(y)


def by_casadi(block: Block, u: Array) -> Array:
    f, x, y = block.function(), block.initial, []
    for now in u:
        x, out = f(x, now)
        y.append(ca.DM(out).full().ravel())
    return np.array(y)


def by_c(block: Block, u: Array) -> Array:
    emitted = write.emit(unranged(block), np.float64)
    columns = {s.name: u[:, i] for i, s in enumerate(block.inputs)}
    out = host.load(emitted.files, emitted.manifest).replay(columns).outputs
    return np.stack([out[s.name] for s in block.outputs], axis=1)


def measurements(x: Array, count: int = 50) -> tuple[Array, Array]:
    """Return (force, near, far) (N, 3) of a plant that moves from x, and its states (N, 4)."""
    model, seen = FILTER.model, []
    states = []
    for k in range(count):
        force = np.sin(0.1 * k)
        states.append(x)
        seen.append([force, *(model.C @ x)])
        x = model.A @ x + model.B @ [force]
    return np.array(seen), np.array(states)


@pytest.mark.parametrize("form", ["current", "predictor"])
def test_the_first_estimate_explains_the_first_measurement(form: str) -> None:
    """As CasADi evaluates it and as compiled C; without the start it comes from 0 with a transient."""
    model = getattr(FILTER, form)()
    x = np.array([2e-3, 0.0, 0.1, 0.0])
    u, states = measurements(x)
    start = lqg.from_measurement(model, FILTER.model)
    x_0 = np.linalg.pinv(FILTER.model.C) @ u[0, 1:]
    np.testing.assert_allclose(x_0, x, atol=tolerances.of("double"))
    expected = recursion(model, u, x_0)
    for result in (by_casadi(estimator_block(model, start), u), by_c(estimator_block(model, start), u)):
        np.testing.assert_allclose(result, expected, rtol=0, atol=tolerances.of("double"))
    np.testing.assert_allclose(expected, states, rtol=0, atol=tolerances.of("double"))
    plain = by_casadi(estimator_block(model, None), u)
    assert np.abs(plain[:10] - states[:10]).max() > 1.0  # m/s: what a position from nowhere looks like


def test_a_block_without_a_start_has_no_further_state() -> None:
    model = FILTER.current()
    plain, with_start = (estimator_block(model, s) for s in (None, lqg.from_measurement(model, FILTER.model)))
    assert [s.name for s in plain.states] == list(model.states)
    assert [s.name for s in with_start.states] == [*model.states, "started"]
    assert with_start.states[-1].integer


def test_other_states_start_at_given_values_and_trusted_ones_stay() -> None:
    model = FILTER.current()
    values = {"speed": 0.3, "tilt": 0.1, "gap": 5e-3}
    start = lqg.from_measurement(model, FILTER.model, values=values)
    y = np.array([1e-3, 4e-3])
    first = start.a + start.G @ [0.0, *y]
    np.testing.assert_allclose(FILTER.model.C @ first, y, rtol=0, atol=tolerances.of("double"))
    assert first[[1, 3]].tolist() == [0.3, 0.0]
    trusted = lqg.from_measurement(model, FILTER.model, ["near"], values=values, deviations={"tilt": 0.0, "speed": 3.0})
    first = trusted.a + trusted.G @ [0.0, *y]
    assert first[2] == pytest.approx(0.1, abs=0) and not trusted.G[:, 2].any()
    assert first[0] == pytest.approx(1e-3 - 0.2 * 0.1)


def test_it_is_the_limit_of_the_first_update_of_a_kalman_filter() -> None:
    """Of one output that adds up a position and a tilt: the less certain one moves more."""
    model, d = FILTER.model, np.array([1e-3, 1.0, 3e-2, 1.0])
    values = {"gap": 1e-3, "tilt": -0.01, "spin": 2.0}
    start = lqg.from_measurement(
        FILTER.current(), model, ["near"], values=values, deviations=dict(zip(model.states, d, strict=True))
    )
    x_0 = [values.get(x, 0.0) for x in model.states]
    before = square_root_kalman.initial(model, np.diag(d**2), x_0)
    after = square_root_kalman.update(before, model, np.full(2, 1e-22), {"near": 4e-3})
    np.testing.assert_allclose(start.a + start.G @ [0.0, 4e-3, 9.0], after.x, rtol=0, atol=1e-9)


def test_a_direct_term_is_taken_off() -> None:
    model = replace(FILTER.model, D=np.array([[0.5], [0.25]]))
    observer = replace(FILTER, model=model).predictor()
    start = lqg.from_measurement(observer, model)
    y, u = np.array([1e-3, 4e-3]), 0.7
    np.testing.assert_allclose(model.C @ (start.a + start.G @ [u, *y]) + model.D[:, 0] * u, y, atol=1e-15)
    blind = observer.select(observer.outputs, ("near", "far"))
    with pytest.raises(SignalError, match="depend directly on 'force', which the estimator does not take"):
        lqg.from_measurement(blind, model)


def test_a_servo_regulator_starts_with_its_estimates() -> None:
    """The command of the first sample is K_x x^[0], with the internal model at 0."""
    axis = StateSpace([[0, 1], [0, 0]], [[0], [1]], [[1, 0]], [[0]], ("gap", "speed"), ("force",), ("gap",),
                      Continuous(), UNITS)  # fmt: skip
    regulator = servo.lqrd(axis, (0.0,), [1e4, 1e2, 1e3], [1.0], T)
    filtered = kalman.kalmd(axis, np.diag([0, 1.0]), [1e-10], T)
    for form in (filtered.current(), filtered.predictor()):
        controller = servo.with_estimator(regulator, form).controller
        start = lqg.from_measurement(controller, regulator.plant, values={"speed": 0.2})
        x = start.a + start.G @ [1e-3 if name == "gap" else 0.0 for name in controller.inputs]
        assert x.tolist() == [0.0, 1e-3, 0.2]
        u = [1e-3 if name == "gap" else 0.0 for name in controller.inputs]
        assert (controller.C @ x + controller.D @ u)[0] == pytest.approx(regulator.K_x[0] @ [1e-3, 0.2])


def test_a_compensator_starts_with_its_estimates() -> None:
    """Its integral, which is known, starts at 0."""
    axis = StateSpace([[0, 1], [0, 0]], [[0], [1]], [[1, 0]], [[0]], ("gap", "speed"), ("force",), ("gap",),
                      Continuous(), UNITS)  # fmt: skip
    gain = lqr.lqrd(lqr.with_integrators(axis, ["gap"]), [1e4, 1e2, 1e3], [1.0], T)
    filtered = kalman.kalmd(axis, np.diag([0, 1.0]), [1e-10], T)
    compensator = lqg.current(gain, filtered).compensator
    start = lqg.from_measurement(compensator, filtered.model)
    assert compensator.states == ("gap_predicted", "speed_predicted", "gap_integral")
    assert start.G.tolist() == [[1.0, 0.0], [0.0, 0.0], [0.0, 0.0]]


def test_the_start_is_limited_to_the_ranges() -> None:
    model = FILTER.current()
    start = lqg.from_measurement(model, FILTER.model)
    u = np.array([[0.0, 0.9, -0.9]] * 2)  # a tilt of 3.6 rad, beyond its range of 2
    result = by_casadi(estimator_block(model, start), u)
    x = np.clip(start.a + start.G @ u[0], -np.array([1, 100, 2, 100]), [1, 100, 2, 100])
    np.testing.assert_allclose(result[0], np.clip(model.C @ x + model.D @ u[0], -1e9, 1e9), atol=1e-12)
