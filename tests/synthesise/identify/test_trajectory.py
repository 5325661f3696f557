"""Trajectories and their derivatives are those of SciPy's integrator and of finite differences."""

import casadi as ca
import numpy as np
import pytest
import scipy.integrate

from synth.plant import Plant, build
from synth.signals import Parameter, Signal
from synth.synthesise.identify import identify, least_squares
from synth.synthesise.identify.logs import Log
from tests import tolerances


def pendulum() -> Plant:
    """Return x'' = -w^2 sin x - c v + g u with the output s = x + 0.1 v."""

    def physics(x: dict, u: dict, p: dict) -> tuple[dict, dict]:
        dv = -(p["w"] ** 2) * ca.sin(x["x"]) - p["c"] * x["v"] + p["g"] * u["u"]
        return {"x": x["v"], "v": dv}, {"s": x["x"] + 0.1 * x["v"]}

    return build(
        "pendulum",
        (Signal("x", "rad", -3, 3), Signal("v", "rad/s", -9, 9)),
        (Signal("u", "N", -2, 2),),
        (Signal("s", "rad", -9, 9),),
        (
            Parameter("w", 3.0, "1/s", 0.5, "test"),
            Parameter("c", 0.4, "1/s", 0.5, "test"),
            Parameter("g", 2.0, "rad/s^2/N", 0.5, "test"),
        ),
        physics,
    )


def log(rows: int = 60, period_s: float = 0.02) -> Log:
    rng = np.random.default_rng(5)
    return Log(
        {"u": rng.uniform(-1, 1, rows), "x": rng.normal(size=rows), "v": rng.normal(size=rows), "s": np.zeros(rows)},
        period_s,
    )


def test_a_trajectory_is_that_of_an_adaptive_integrator() -> None:
    plant, logged = pendulum(), log()
    problem = identify.problem(plant, logged, ("w",), ("s", "v"), None, {"x": 0.5, "v": -1.0}, (), 8)
    state, outputs = np.array([0.5, -1.0]), []
    for u in logged.samples["u"]:
        outputs.append([state[0] + 0.1 * state[1], state[1]])
        run = scipy.integrate.solve_ivp(
            lambda t, x, u=u: [x[1], -9 * np.sin(x[0]) - 0.4 * x[1] + 2 * u], (0, 0.02), state, rtol=1e-11, atol=1e-12
        )
        state = run.y[:, -1]
    np.testing.assert_allclose(problem.simulate(np.array([3.0]))[0], outputs, atol=tolerances.of("ode"))


@pytest.mark.parametrize(("span", "free"), [(None, ()), (None, ("v", "x")), (1, ()), (7, ())])
def test_derivatives_are_those_of_differences(span: int | None, free: tuple[str, ...]) -> None:
    problem = identify.problem(pendulum(), log(), ("c", "w"), ("s", "x"), span, {}, free, 2)
    theta = np.concatenate([[0.3, 2.5], problem.starts.ravel()])
    g, J = problem.simulate(theta)
    J = dense(J) if isinstance(J, least_squares.Jacobian) else J
    assert g.shape == problem.y.shape and J.shape == (*g.shape, len(theta))
    for k in range(len(theta)):
        step = np.zeros(len(theta))
        step[k] = 1e-5
        difference = (problem.simulate(theta + step)[0] - problem.simulate(theta - step)[0]) / 2e-5
        np.testing.assert_allclose(J[:, :, k], difference, atol=1e-7)


def dense(J: least_squares.Jacobian) -> np.ndarray:
    """Return a Jacobian (N, p, k + s f) with all its zeros."""
    groups, length, p, f = J.group.shape
    blocks = np.zeros((groups, length, p, groups, f))
    blocks[range(groups), :, :, range(groups)] = J.group
    return np.concatenate([J.shared, blocks.reshape(groups * length, p, groups * f)], axis=2)


def test_spans_start_from_states_of_their_own() -> None:
    logged = log()
    problem = identify.problem(pendulum(), logged, ("w",), ("x",), 7, {}, (), 2)
    assert len(problem.y) == 8 * 7 and problem.starts.shape == (8, 2), "60 rows in 8 equal spans, none of them shared"
    np.testing.assert_array_equal(problem.y[:, 0], logged.samples["x"][:56])
    np.testing.assert_array_equal(problem.starts[:, 1], logged.samples["v"][:56:7])
    alone = Log({name: v[14:21] for name, v in logged.samples.items()}, 0.02)
    single = identify.problem(pendulum(), alone, ("w",), ("x",), None, {}, (), 2)
    np.testing.assert_allclose(
        problem.simulate(np.concatenate([[2.0], problem.starts.ravel()]))[0][14:21],
        single.simulate(np.concatenate([[2.0], single.starts.ravel()]))[0],
        rtol=tolerances.of("double"),
    )
