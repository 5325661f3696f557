"""Steady states against Sylvester equations and simulations, and what cannot be regulated."""

import numpy as np
import pytest
import scipy.linalg
from hypothesis import given, settings
from hypothesis import strategies as st

from synth.analyse import discretise
from synth.errors import ModelError, SignalError
from synth.statespace import StateSpace
from synth.synthesise.regulation import minimal_polynomial, regulator_equations
from synth.timing import Continuous, Discrete
from tests import tolerances

S = scipy.linalg.block_diag([[0.0]], [[0.0, 2.0], [-2.0, 0.0]])


def plant(rng: np.random.Generator, n: int, m: int, p: int, direct: bool = True) -> StateSpace:
    names = [tuple(f"{letter}{i}" for i in range(k)) for letter, k in (("x", n), ("u", m), ("y", p))]
    D = rng.normal(size=(p, m)) * direct
    return StateSpace(
        rng.normal(size=(n, n)), rng.normal(size=(n, m)), rng.normal(size=(p, n)), D, *names, Continuous()
    )


@settings(derandomize=True, max_examples=15, deadline=None)
@given(st.integers(0, 10**6))
def test_a_steady_state_made_by_a_sylvester_equation_is_found_again(seed: int) -> None:
    rng = np.random.default_rng(seed)
    p = int(rng.integers(1, 4))
    model = plant(rng, int(rng.integers(p, 5)), p, p)
    E, Gamma = rng.normal(size=(len(model.A), 3)), rng.normal(size=(p, 3))
    Pi = scipy.linalg.solve_sylvester(model.A, -S, -(model.B @ Gamma + E))
    steady = regulator_equations.solve(model, S, E, -(model.C @ Pi + model.D @ Gamma))
    size = max(np.abs(Pi).max(), np.abs(Gamma).max())
    np.testing.assert_allclose(steady.Pi, Pi, rtol=0, atol=tolerances.of("pencil") * size)
    np.testing.assert_allclose(steady.Gamma, Gamma, rtol=0, atol=tolerances.of("pencil") * size)
    assert steady.residual < tolerances.of("double")


def test_with_inputs_to_spare_the_least_effort_is_taken() -> None:
    rng = np.random.default_rng(3)
    model = plant(rng, 4, 3, 2)
    E, F = rng.normal(size=(4, 3)), rng.normal(size=(2, 3))
    steady = regulator_equations.solve(model, S, E, F)
    A, B, C, D = model.A, model.B, model.C, model.D
    np.testing.assert_allclose(steady.Pi @ S, A @ steady.Pi + B @ steady.Gamma + E, atol=tolerances.of("double") * 100)
    np.testing.assert_allclose(C @ steady.Pi + D @ steady.Gamma, -F, atol=tolerances.of("double") * 100)
    other = regulator_equations.solve(model.select(model.outputs, ("u0", "u2")), S, E, F)
    assert np.linalg.norm(steady.Gamma) < np.linalg.norm(other.Gamma)
    # Least: no direction in which the equations stay solved lowers the norm.
    M = np.block([[A, B], [C, D]])
    null = scipy.linalg.null_space(
        np.kron(np.eye(3), M) - np.kron(S.T, np.block([[np.eye(4), np.zeros((4, 3))], [np.zeros((2, 7))]]))
    )
    gamma = np.tile(np.arange(7) >= 4, 3)
    slope = null[gamma].T @ steady.Gamma.T.ravel()
    assert np.abs(slope).max() < tolerances.of("double") * 100 * np.linalg.norm(steady.Gamma)


@pytest.mark.parametrize("time", [Continuous(), Discrete(0.05)])
def test_feedforward_leads_every_state_to_zero_error(time: Continuous | Discrete) -> None:
    """A double integrator follows a sine under a constant disturbance: u = K x + (Gamma - K Pi) w, simulated."""
    double = StateSpace([[0, 1], [0, 0]], [[0], [1]], [[1, 0]], [[0]], ("x", "v"), ("f",), ("x",), Continuous())
    E, F = np.array([[0, 0, 0], [1.0, 0, 0]]), np.array([[0, -1.0, 0]])
    K, T = np.array([[-20.0, -9.0]]), 0.05
    model, generator = double, S
    if isinstance(time, Discrete):
        model = discretise.zero_order_hold(double, T)
        held = scipy.linalg.expm(np.block([[double.A, E], [np.zeros((3, 2)), S]]) * T)
        E, generator = held[:2, 2:], held[2:, 2:]
    steady = regulator_equations.solve(model, generator, E, F)
    L = steady.feedforward(K)
    whole = np.block([[model.A + model.B @ K, E + model.B @ L], [np.zeros((3, 2)), generator]])
    step = whole if isinstance(time, Discrete) else scipy.linalg.expm(whole * T)
    state = np.array([3.0, -1.0, 0.7, 1.0, 0.0])
    start = state[0] - state[3]
    for _ in range(400):
        state = step @ state
    assert abs(state[0] - state[3]) < tolerances.of("settled") * abs(start)
    assert abs(state[3]) > 0.1
    np.testing.assert_allclose(steady.Pi[0], [0, 1, 0], atol=tolerances.of("double"))
    with pytest.raises(SignalError, match=r"K is \(1, 3\): give \(1, 2\), inputs by states"):
        steady.feedforward(np.zeros((1, 3)))


def test_any_form_of_system_is_read() -> None:
    arrays = ([[0, 1], [0, 0]], [[0], [1]], [[1, 0]], [[0]])
    steady = regulator_equations.solve(arrays, [[0.0]], np.zeros((2, 1)), [[-1.0]])
    np.testing.assert_allclose(steady.Pi, [[1], [0]], atol=tolerances.of("double"))
    import control

    again = regulator_equations.solve(control.ss(*arrays), [[0.0]], np.zeros((2, 1)), [[-1.0]])
    np.testing.assert_array_equal(again.Pi, steady.Pi)
    assert "Steady state x = Pi w, u = Gamma w" in repr(steady)


def modes(*frequencies: float) -> tuple[minimal_polynomial.Mode, ...]:
    return tuple(minimal_polynomial.Mode(complex(0, w), 1) for w in frequencies)


def coupled_plant(scale: float = 1.0) -> StateSpace:
    """y1 = g (u1 + u2), y2 = g (u1 + u2) + (s^2 + 4) / (s + 1)^2 u2, g = 1 / (s + 1): y2 - y1 has a zero at 2 rad/s."""
    A = scipy.linalg.block_diag([[-1.0]], [[0.0, 1.0], [-1.0, -2.0]])
    B = [[1.0, 1.0], [0.0, 0.0], [0.0, 1.0]]
    C, D = [[1.0, 0.0, 0.0], [scale, 3.0 * scale, -2.0 * scale]], [[0.0, 0.0], [0.0, scale]]
    return StateSpace(A, B, C, D, ("a", "b", "c"), ("u1", "u2"), ("y1", "y2"), Continuous())


def test_a_zero_is_named_with_the_combination_that_no_input_moves() -> None:
    with pytest.raises(ModelError, match=r"zero at 2 rad/s, a frequency .* no input affects 1 y\d, -1\S* y\d; drop it"):
        regulator_equations.require_solvable(coupled_plant(), modes(0.0, 2.0))
    regulator_equations.require_solvable(coupled_plant(), modes(0.0, 2.01))


@pytest.mark.parametrize("scale", [1e-9, 1e9])
def test_units_do_not_move_zeros(scale: float) -> None:
    with pytest.raises(ModelError, match="transmission zero at 2 rad/s"):
        regulator_equations.require_solvable(coupled_plant(scale), modes(2.0))
    regulator_equations.require_solvable(coupled_plant(scale), modes(2.01))


def test_a_zero_is_found_in_sampled_plants_and_off_the_axis() -> None:
    z = np.exp(2j * 0.1)
    A, B, C = [[0.0, 1.0], [0.0, 0.0]], [[0.0], [1.0]], [[1.0, -2 * z.real]]
    sampled = StateSpace(A, B, C, [[1.0]], ("a", "b"), ("u",), ("y",), Discrete(0.1))  # 1 - 2 cos / z + 1 / z^2
    with pytest.raises(ModelError, match="transmission zero at 2 rad/s, a frequency"):
        regulator_equations.require_solvable(sampled, modes(2.0))
    regulator_equations.require_solvable(sampled, modes(1.9))
    right = StateSpace(
        [[-1.0]], [[1.0]], [[-1.5]], [[1.0]], ("a",), ("u",), ("y",), Continuous()
    )  # (s - 0.5) / (s + 1)
    with pytest.raises(ModelError, match=r"transmission zero at 0\.5 1/s, a mode"):
        regulator_equations.require_solvable(right, [minimal_polynomial.Mode(0.5 + 0j, 1)])


def test_other_reasons_are_named() -> None:
    model = coupled_plant()
    with pytest.raises(ModelError, match=r"2 outputs \(y1, y2\) cannot be regulated by 1 inputs \(u1\)"):
        regulator_equations.require_solvable(model.select(("y1", "y2"), ("u1",)), modes(0.0))
    loose = StateSpace(np.diag([-1.0, 1.0]), [[1], [0]], [[1, 1]], [[0]], ("a", "b"), ("u",), ("y",), Continuous())
    with pytest.raises(ModelError, match=r"not stabilisable: mode 1 in b"):
        regulator_equations.require_solvable(loose, modes(0.0))


def test_a_small_channel_without_a_solution_is_not_hidden_by_a_large_one() -> None:
    """The second output is x - u = 0 at rest: no input gives it the reference of 1e-6."""
    D = np.diag([0.0, -1.0])
    model = -np.eye(2), np.eye(2), np.eye(2), D
    with pytest.raises(ModelError, match="transmission zero at 0 rad/s"):
        regulator_equations.solve(model, [[0.0]], np.zeros((2, 1)), [[-1e5], [-1e-6]])
    steady = regulator_equations.solve(model, [[0.0]], np.zeros((2, 1)), [[-1e5], [0.0]])
    np.testing.assert_allclose(steady.Pi[0], 1e5, rtol=1e-12)


def test_equations_without_a_solution_are_refused() -> None:
    model = coupled_plant()
    oscillation, nothing = [[0.0, 2.0], [-2.0, 0.0]], np.zeros((3, 2))
    with pytest.raises(ModelError, match=r"transmission zero at 2 rad/s, .* no input affects 1 y\d, -1\S* y\d"):
        regulator_equations.solve(model, oscillation, nothing, np.eye(2))
    same = np.array([[1.0, 0.0], [1.0, 0.0]])  # y1 and y2 alike need no motion along y2 - y1
    assert regulator_equations.solve(model, oscillation, nothing, same).residual < tolerances.of("double")
    with pytest.raises(ModelError, match=r"no solution: .* let fewer outputs be regulated than y1, y2, or more inputs"):
        regulator_equations.solve(model.select(("y1", "y2"), ("u1",)), [[0.0]], np.zeros((3, 1)), [[1.0], [2.0]])


@pytest.mark.parametrize(
    ("matrices", "message"),
    [
        ((np.zeros((2, 3)), np.zeros((3, 2)), np.zeros((2, 2))), r"S is \(2, 3\): .* finite one of \(2, 2\)"),
        ((np.zeros((2, 2)), np.zeros((2, 2)), np.zeros((2, 2))), r"E is \(2, 2\): .* finite one of \(3, 2\)"),
        ((np.zeros((2, 2)), np.zeros((3, 2)), [[np.nan, 0], [0, 0]]), r"F is \(2, 2\): .* finite one of \(2, 2\)"),
    ],
)
def test_matrices_that_do_not_fit_are_refused(matrices: tuple[object, ...], message: str) -> None:
    with pytest.raises(SignalError, match=message):
        regulator_equations.solve(coupled_plant(), *matrices)  # type: ignore[arg-type]
