"""Riccati equations at the edge of what is solvable: what has a stabilising solution is solved, the rest is named."""

import numpy as np
import pytest

from synth.errors import ModelError
from synth.statespace import of
from synth.synthesise.feedback import lqr
from synth.synthesise.observers import kalman
from synth.synthesise.riccati import exact, riccati, solvability
from synth.synthesise.riccati.equation import Equation, decays
from synth.timing import Continuous, Discrete
from tests import tolerances
from tests.synthesise import benchmark_problems as problems

CONTINUOUS, SAMPLED = Continuous(), Discrete(1.0)
ROUNDED = 10 * tolerances.of("last_bit")
SOLVABLE = {
    "CAREX 1.3": problems.carex_3,
    "CAREX 1.4": problems.carex_4,
    "DAREX 1.1": problems.darex_1,
    "DAREX 1.2": problems.darex_2,
    "DAREX 1.4": problems.darex_4,
    "DAREX 1.4 with a23 of SLICOT": lambda: problems.darex_4(0.01),
    "minimum energy": lambda: ((np.eye(1), np.eye(1), CONTINUOUS), np.zeros((1, 1)), np.eye(1), None),
    "minimum energy, sampled": lambda: ((2 * np.eye(1), np.eye(1), SAMPLED), np.zeros((1, 1)), np.eye(1), None),
}


def distance_of_exact_newton_step(p: problems.Problem, X: np.ndarray) -> float:
    """Newton's step from X in ball arithmetic over the largest of X: the error of X, where its loop is stable."""
    (A, B, time), Q, R, N = p
    Q = (Q + Q.T) / 2
    e = Equation(A, B, Q, R, np.zeros(B.shape) if N is None else N, isinstance(time, Continuous))
    solution = exact.certify(e, X)
    assert decays(solution.poles(), e.continuous)
    return float(solution.step.max() / np.abs(X).max())


@pytest.mark.parametrize("name", SOLVABLE)
def test_solvable_problems_are_solved_with_their_certificate(name: str) -> None:
    p = SOLVABLE[name]()
    solution = riccati.solve(*p)
    assert solution.forward_error <= ROUNDED and solution.residual <= ROUNDED
    assert decays(solution.poles, isinstance(p[0][2], Continuous))
    assert distance_of_exact_newton_step(p, solution.X) <= 1e-13
    assert distance_of_exact_newton_step(p, solution.X * (1 + 1e-9)) > 1e-10  # the oracle sees a wrong X


def test_the_published_solutions_come_out() -> None:
    np.testing.assert_allclose(riccati.solve(*problems.darex_1()).X, np.eye(2), atol=1e-14)
    X = riccati.solve(*problems.darex_4()).X
    np.testing.assert_allclose(X, np.diag([1e5, 1e3, 0]), rtol=1e-14, atol=1e-9)


def test_an_input_without_weight_gives_the_gain_that_scipys_equation_gives() -> None:
    gain = lqr.lqr(*problems.darex_1())
    np.testing.assert_allclose(gain.K, [[-2, 1]], atol=1e-14)  # deadbeat
    with pytest.raises(ModelError, match=r"does not see the mode 1, which lies on the stability boundary"):
        lqr.lqr((np.diag([1.0, 0.5]), np.ones((2, 1)), SAMPLED), [0.0, 1.0], [0.0])
    mirrored = lqr.lqr((np.diag([2.0, 0.5]), np.ones((2, 1)), SAMPLED), [0.0, 1.0], [0.0])
    assert mirrored.certificate.mirrored == pytest.approx((2,)) and mirrored.poles.real.max() == pytest.approx(0.5)


# What the result says


def test_minimum_energy_control_mirrors_the_unstable_mode_and_says_so() -> None:
    """x' = x + u: X = 2. x+ = 2 x + u: X = 3, z = 1/2."""
    solution = riccati.solve(([[1.0]], [[1.0]]), [0.0], [1.0])
    assert solution.X[0, 0] == pytest.approx(2, rel=1e-15) and solution.poles == pytest.approx([-1])
    assert solution.mirrored == (1,) and "do not see the mode 1, which does not decay" in repr(solution)
    sampled = riccati.solve(([[2.0]], [[1.0]], SAMPLED), [0.0], [1.0])
    assert sampled.X[0, 0] == pytest.approx(3, rel=1e-15) and sampled.poles == pytest.approx([0.5])
    assert sampled.mirrored == (2,) and "1 / conj(z)" in repr(sampled)
    assert "mirrors" in repr(lqr.lqr(([[1.0]], [[1.0]]), [0.0], [1.0]))


def test_the_filter_of_an_unstable_plant_without_process_noise_is_found() -> None:
    """x' = x, y = x + v: P = 2, L = 2; sampled x+ = 2 x: P = 3, L = 3/2, and after a sample 3/4."""
    solution = kalman.continuous(([[1.0]], [[1.0]], [[1.0]], [[0.0]]), [0.0], [1.0])
    assert solution.L[0, 0] == pytest.approx(2, rel=1e-14) and solution.poles == pytest.approx([-1])
    assert solution.certificate.mirrored == (1,) and "none excites that mode" in repr(solution)
    sampled = kalman.discrete(([[2.0]], [[1.0]], [[1.0]], [[0.0]], 1.0), [0.0], [1.0])
    assert sampled.L[0, 0] == pytest.approx(1.5) and sampled.posterior[0, 0] == pytest.approx(0.75)


def test_complex_and_equal_modes_are_mirrored() -> None:
    A = np.array([[0.5, 3.0], [-3.0, 0.5]])
    solution = riccati.solve((A, np.eye(2, 1)), np.zeros((2, 2)), [1.0])
    np.testing.assert_allclose(sorted(solution.poles, key=np.imag), [-0.5 - 3j, -0.5 + 3j], rtol=1e-12)
    assert len(solution.mirrored) == 2 and "0.5 +- 3i" in repr(solution)
    both = riccati.solve((np.eye(2), np.eye(2)), np.ones((2, 2)), [1.0, 1.0])  # the cost sees the sum alone
    assert both.mirrored == pytest.approx((1,)) and both.poles.real.max() == pytest.approx(-1)


def test_only_what_the_cost_does_not_see_counts_as_mirrored() -> None:
    """A weight of 1e-7 leaves a pole within 1e-7 of the mirror image, and is a weight nevertheless."""
    assert riccati.solve((np.diag([1.0, -2.0]), np.ones((2, 1))), np.diag([1e-7, 0]), [1.0]).mirrored == ()
    solution = riccati.solve((np.diag([1.0, 2.0]), np.ones((2, 1))), np.diag([1.0, 0]), [1.0])
    assert solution.mirrored == pytest.approx((2,)) and "the mode 2, which" in repr(solution)


def test_indefinite_costs_and_saddles_are_said() -> None:
    double = (np.array([[0.0, 1], [0, 0]]), np.array([[0.0], [1]]))
    solution = riccati.solve(double, np.diag([1.0, -1.0]), [1.0])  # L = [1, sqrt(2 + q2)]
    np.testing.assert_allclose(solution.L, [[1, 1]], rtol=1e-14)
    assert solution.cost_eigenvalue == -1 and solution.weight_eigenvalue == 1
    assert "the cost is indefinite, and X is the least cost of bringing the state to rest" in repr(solution)
    saddle = riccati.solve(*problems.darex_2())
    assert saddle.weight_eigenvalue < 0 and "X is a saddle of the cost, no minimum" in repr(saddle)
    usual = riccati.solve(double, [1.0, 1.0], [1.0])
    assert (usual.mirrored, usual.remarks()) == ((), ()) and usual.cost_eigenvalue == 1


def test_the_least_cost_of_coming_to_rest_is_x() -> None:
    """Over a hundred steps from [1, 0], ended at 0, no inputs cost less than x0'X x0, though Q is indefinite."""
    A, B = np.array([[1.0, 0.1], [0, 1.0]]), np.array([[0.005], [0.1]])
    Q, R, x0, T = np.diag([1.0, -0.2]), np.eye(1), np.array([1.0, 0.0]), 300
    solution = riccati.solve((A, B, Discrete(0.1)), Q, R)
    reach = np.zeros((2 * T, T))
    for k in range(T):
        for j in range(k + 1):
            reach[2 * k : 2 * k + 2, j] = (np.linalg.matrix_power(A, k - j) @ B)[:, 0]
    free = np.concatenate([np.linalg.matrix_power(A, k + 1) @ x0 for k in range(T)])
    H, g = reach.T @ np.kron(np.eye(T), Q) @ reach + np.eye(T), reach.T @ np.kron(np.eye(T), Q) @ free
    end, b = reach[-2:], -free[-2:]
    kkt = np.block([[H, end.T], [end, np.zeros((2, 2))]])
    u = np.linalg.solve(kkt, np.concatenate([-g, b]))[:T]
    cost = x0 @ Q @ x0 + u @ H @ u + 2 * g @ u + free @ np.kron(np.eye(T), Q) @ free
    assert cost == pytest.approx(x0 @ solution.X @ x0, rel=1e-6)


# What is refused


def is_refused_or_marginal(system: tuple[np.ndarray, np.ndarray], Q: np.ndarray) -> bool:
    try:
        return "decay by less than the rounding" in repr(riccati.solve(system, Q, [1.0]))
    except ModelError as error:
        return "on the stability boundary" in str(error)


def test_an_unseen_oscillation_is_refused_or_reported_in_any_coordinates() -> None:
    """In rotated coordinates rounding decides whether the mode decays: ball arithmetic finds out."""
    A = np.zeros((3, 3))
    A[0, 1], A[1, 0], A[2, 2] = 2.0, -2.0, -1.0
    V = np.linalg.qr(np.random.default_rng(0).normal(size=(3, 3)))[0] + np.eye(3)
    Q = np.diag([0.0, 0, 1])
    B = np.ones((3, 1))
    Vi = np.linalg.inv(V)
    assert is_refused_or_marginal((Vi @ A @ V, Vi @ B), V.T @ Q @ V)


def test_an_unseen_rigid_body_is_refused_or_reported_in_any_coordinates() -> None:
    """The computed modes of [[0, 1], [0, 0]] scatter by 1e-8 in rotated coordinates."""
    A = np.zeros((3, 3))
    A[0, 1], A[2, 2] = 1.0, -1.0
    for seed in range(6):
        V = np.linalg.qr(np.random.default_rng(seed).normal(size=(3, 3)))[0] + 0.1 * np.eye(3)
        Vi, Q = np.linalg.inv(V), np.diag([0.0, 0, 1])
        assert is_refused_or_marginal((Vi @ A @ V, Vi @ np.array([[0.0], [1], [1]])), V.T @ Q @ V)


def test_a_model_that_decays_by_its_entries_alone_is_solved_and_reported() -> None:
    """The slowest mode of this Hilbert matrix is -5.7e-15; SciPy solves the problem, too."""
    i = np.arange(11)
    solution = riccati.solve((-1 / (i[:, None] + i + 1), np.eye(11, 1)), np.eye(11), [1.0])
    assert solution.forward_error <= ROUNDED and len(solution.marginal) >= 1 and solution.poles.real.max() < 0
    assert "decay by less than the rounding of the model's entries" in repr(solution)


def test_boundary_and_mirrored_modes_are_distinguished() -> None:
    model = of((np.diag([1e-3, -1.0]), np.ones((2, 1))))
    assert not solvability.unobservable_boundary_modes(model.A, np.diag([0.0, 1.0]), model.states, model.time)
    assert riccati.solve(model, np.diag([0.0, 1.0]), [1.0]).mirrored == (1e-3,)
    assert solvability.unobservable_boundary_modes(np.diag([0.0, -1.0]), np.diag([0.0, 1.0]), model.states, model.time)


# The certificate of states that cost nothing


def test_the_certificate_of_states_that_cost_nothing_is_measured_by_the_others() -> None:
    solution = riccati.solve(*problems.carex_6())
    assert solution.residual <= ROUNDED and solution.forward_error <= ROUNDED and solution.least_eigenvalue == 0
