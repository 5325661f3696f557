"""Riccati solutions in double precision against SciPy, python-control, SLICOT and ball arithmetic.

The certificate must tell the error that there is, and flag a wrong X, a dropped cross weight and a wrong period.
"""

import control
import numpy as np
import pytest
import slycot
from hypothesis import given, settings
from hypothesis import strategies as st

from synth.analyse import discretise
from synth.analyse.structure import structure
from synth.errors import ModelError, SignalError
from synth.statespace import StateSpace
from synth.synthesise.riccati import exact, riccati, solvability, weights
from synth.timing import Continuous, Discrete, Time
from tests import tolerances

CONTINUOUS, SAMPLED = Continuous(), Discrete(1e-3)
ROUNDED = 10 * tolerances.of("last_bit")  # residual of a rounded X beside the equation's terms
KINDS = ("plain", "cross", "weights", "units", "stiff", "chain", "dear", "cheap", "near-singular R")


def model(A: object, B: object, time: Time = CONTINUOUS) -> StateSpace:
    A, B = np.atleast_2d(np.asarray(A, float)), np.atleast_2d(np.asarray(B, float))
    states, inputs = tuple(f"x{i}" for i in range(len(A))), tuple(f"u{i}" for i in range(B.shape[1]))
    return StateSpace(A, B, np.eye(len(A)), np.zeros(B.shape), states, inputs, states, time)


def random_problem(
    seed: int, time: Time, kind: str = "cross"
) -> tuple[StateSpace, np.ndarray, np.ndarray, np.ndarray | None]:
    rng = np.random.default_rng(seed)
    n, m = rng.integers(1, 6), rng.integers(1, 3)
    A, B, N = rng.normal(size=(n, n)), rng.normal(size=(n, m)), None
    C = rng.normal(size=(rng.integers(1, n + 1), n))
    Q, R = C.T @ C, np.eye(m)
    if kind == "cross":
        W = rng.normal(size=(n + m, n + m))
        W = W @ W.T + 0.1 * np.eye(n + m)
        Q, R, N = W[:n, :n], W[n:, n:], W[:n, n:]
    elif kind == "weights":
        Q, R = np.diag(10.0 ** rng.uniform(0, 10, n)), np.diag(10.0 ** rng.uniform(0, 10, m))
    elif kind == "units":
        d = 10.0 ** rng.uniform(-6, 6, n)
        A, B, Q = A * d / d[:, None], B / d[:, None], Q * d * d[:, None]
    elif kind == "stiff":
        rates = 10.0 ** rng.uniform(-3, 5, n)
        V = np.linalg.qr(rng.normal(size=(n, n)))[0] + np.eye(n) / 2
        rates = np.where(rng.uniform(size=n) < 0.8, -rates, rates) if time is CONTINUOUS else 1 - rates / 2e5
        A = np.linalg.solve(V, rates[:, None] * V)
    elif kind == "chain":
        A, B = np.diag(np.ones(n - 1), 1) + (0 if time is CONTINUOUS else np.eye(n)), np.eye(n)[:, -1:]
        Q, R = np.diag([10.0 ** rng.uniform(0, 10)] + [0] * (n - 1)), np.eye(1)
    elif kind in ("dear", "cheap"):
        R = (1e12 if kind == "dear" else 1e-12) * np.eye(m)
    elif kind == "near-singular R":
        U = np.linalg.qr(rng.normal(size=(m, m)))[0]
        R = U @ np.diag([1, 1e-13][:m]) @ U.T
    return model(A, B, time), (Q + Q.T) / 2, (R + R.T) / 2, N


@pytest.mark.parametrize("time", [CONTINUOUS, SAMPLED])
@settings(derandomize=True, max_examples=15, deadline=None)
@given(seed=st.integers(0, 10**6))
def test_random_problems_agree_with_scipy_and_python_control(time: Time, seed: int) -> None:
    c, Q, R, N = random_problem(seed, time)
    solution = riccati.solve(c, Q, R, N)
    solver = control.care if time is CONTINUOUS else control.dare
    X, poles, L = solver(c.A, c.B, Q, R, S=N, E=np.eye(len(c.A)), method="scipy")
    atol = tolerances.of("pencil") * np.abs(X).max()
    np.testing.assert_allclose(solution.X, X, rtol=0, atol=atol)
    np.testing.assert_allclose(solution.L, L, rtol=0, atol=tolerances.of("pencil") * np.abs(L).max())
    stable = solution.poles.real < 0 if time is CONTINUOUS else np.abs(solution.poles) < 1
    assert stable.all() and solution.least_eigenvalue > 0
    np.testing.assert_allclose(
        sorted(np.abs(solution.poles)), sorted(np.abs(poles)), rtol=1e3 * tolerances.of("pencil")
    )
    assert solution.residual <= ROUNDED
    np.testing.assert_array_equal(solution.X, solution.X.T)


@pytest.mark.parametrize(("time", "letter"), [(CONTINUOUS, "C"), (SAMPLED, "D")])
def test_slicot_agrees(time: Time, letter: str) -> None:
    c, Q, R, N = random_problem(11, time)
    n, m = c.B.shape
    X = slycot.sb02od(n, m, c.A.copy(), c.B.copy(), Q.copy(), R.copy(), letter, L=N.copy())[0]
    np.testing.assert_allclose(riccati.solve(c, Q, R, N).X, X, rtol=0, atol=tolerances.of("pencil") * np.abs(X).max())
    assert np.abs(riccati.solve(c, Q, R).X - X).max() > 1e-3  # without the cross weight it is another problem


def test_a_correct_solution_costs_no_search_for_modes(monkeypatch: pytest.MonkeyPatch) -> None:
    def searched(*arguments: object) -> None:
        raise AssertionError("the modes were searched")

    monkeypatch.setattr(structure, "require_stabilisable", searched)
    monkeypatch.setattr(solvability, "require_detectable_boundary", searched)
    monkeypatch.setattr(solvability, "_unobservable_modes", searched)
    chain = model(np.diag(np.ones(3), 1), np.eye(4)[:, -1:])
    riccati.solve(chain, np.diag([1.0, 0, 0, 0]), [[1.0]])
    riccati.solve(model(np.diag([1.0, 2.0]), [[1], [1]]), np.diag([1e-9, 1e-9]), [[1.0]])
    riccati.solve(model(np.diag([1.0, -2.0]), [[1], [1]]), np.diag([1e-7, 0]), [[1.0]])  # a pole within 1e-7 of -1
    riccati.solve(model(np.diag([1.5, 0.2]), [[1], [1]], SAMPLED), np.diag([1e-7, 0]), [[1.0]])


@pytest.mark.parametrize("time", [CONTINUOUS, SAMPLED])
@pytest.mark.parametrize("size", [1e-12, 1e-9, 1e-6])
def test_the_certificate_flags_a_perturbed_solution(time: Time, size: float) -> None:
    c, Q, R, N = random_problem(8, time)
    right = riccati.solve(c, Q, R, N)
    E, unit = np.random.default_rng(0).normal(size=right.X.shape), np.sqrt(np.diag(right.X))
    wrong = right.X + size * (E + E.T) / np.abs(E + E.T).max() * unit * unit[:, None]
    wrong = (wrong + wrong.T) / 2
    flagged, again = riccati.certify(c, Q, R, wrong, N), riccati.certify(c, Q, R, right.X, N)
    assert again.forward_error <= tolerances.of("folded") < flagged.forward_error
    assert flagged.forward_error == pytest.approx(size, rel=0.5)
    assert flagged.residual > 1e-3 * size and again.residual <= ROUNDED


@pytest.mark.parametrize("time", [CONTINUOUS, SAMPLED])
def test_the_certificate_flags_the_solution_of_another_problem(time: Time) -> None:
    """A cross weight that was dropped, and weights that a period scales: Q T, R T instead of the cost's integral."""
    c, Q, R, N = random_problem(4, time)
    X = riccati.solve(c, Q, R, N).X
    for wrong in (riccati.solve(c, Q, R).X, riccati.solve(c, 0.9 * Q, 0.9 * R, N).X):
        flagged = riccati.certify(c, Q, R, wrong, N)
        assert flagged.residual > 1e-4 and flagged.forward_error > 1e-3
    assert riccati.certify(c, Q, R, X, N).residual <= ROUNDED


def test_the_certificate_shows_the_poles_of_a_solution_that_does_not_stabilise() -> None:
    """x' = x + u, Q = 3, R = 1: X = 3 stabilises, X = -1 solves the equation too."""
    other = riccati.certify(model([[1.0]], [[1.0]]), [[3.0]], [[1.0]], [[-1.0]])
    assert other.residual == 0 and other.poles == pytest.approx([2]) and other.least_eigenvalue == -1
    assert other.forward_error == np.inf
    right = riccati.certify(model([[1.0]], [[1.0]]), [[3.0]], [[1.0]], [[3.0]])
    assert right.residual == 0 and right.forward_error == 0 and right.poles == pytest.approx([-2])


def test_units_change_nothing_but_the_numbers() -> None:
    c, Q, R, N = random_problem(6, CONTINUOUS)
    d, e = 2.0 ** np.arange(-40, -40 + 17 * len(c.A), 17), 2.0 ** np.arange(20, 20 + c.B.shape[1])
    other = model(c.A * d / d[:, None], c.B * e / d[:, None])
    here = riccati.solve(c, Q, R, N)
    there = riccati.solve(other, Q * d * d[:, None], R * e * e[:, None], N * e * d[:, None])
    np.testing.assert_allclose(there.X / d / d[:, None], here.X, rtol=tolerances.of("folded"))
    np.testing.assert_allclose(there.L * e[:, None] / d, here.L, rtol=tolerances.of("folded"))
    np.testing.assert_allclose(there.condition, here.condition, rtol=tolerances.of("pencil"))
    assert there.residual <= ROUNDED


def test_the_condition_bounds_what_changed_data_do() -> None:
    c, Q, R, _ = random_problem(9, CONTINUOUS, "plain")
    solution, change = riccati.solve(c, Q, R), 1e-7
    rng = np.random.default_rng(0)
    size = np.sqrt(np.diag(solution.X))
    for _ in range(20):
        E = 1 + change * rng.uniform(-1, 1, Q.shape)
        change_of_X = riccati.solve(c, Q * (E + E.T) / 2, R).X - solution.X
        assert np.abs(change_of_X / size / size[:, None]).max() <= solution.condition * change


def test_the_other_solution_is_not_shipped(monkeypatch: pytest.MonkeyPatch) -> None:
    """x' = x + u, Q = 3: the other solution is X = -1; X = 1 makes A - B L = 0."""
    c = model([[1.0]], [[1.0]])
    np.testing.assert_array_equal(riccati.solve(c, [[3.0]], [[1.0]]).X, [[3.0]])
    monkeypatch.setattr(exact, "solve", lambda e, *_: exact.certify(e, np.array([[-1.0]])))
    with pytest.raises(ModelError, match=r"leaves the pole 2.*, which does not decay"):
        riccati.solve(c, [[3.0]], [[1.0]])


def test_equal_modes_of_which_the_cost_sees_only_a_sum_are_searched() -> None:
    """Each eigenvector that is computed costs something; their difference costs nothing."""
    c = model(np.diag([1.0, 1.0]), np.eye(2))
    assert not solvability._certainly_detectable(
        riccati._equation(c, np.ones((2, 2)), np.eye(2), np.zeros((2, 2))), -np.ones(2) + 0j
    )


def test_a_weight_that_is_singular_within_rounding_is_refused() -> None:
    c = model([[0, 1], [0, 0]], np.eye(2))
    v = np.array([[1.0], [1 / 3]])
    with pytest.raises(SignalError, match=r"matrix R has the eigenvalue .*positive definite beyond rounding"):
        riccati.solve(c, np.eye(2), v @ v.T)
    riccati.solve(c, np.eye(2), np.diag([1.0, 1e-20]))  # units, not singularity


def test_the_result_prints_its_certificate_and_its_tables() -> None:
    text = repr(riccati.solve(model([[0, 1], [0, 0]], [[0], [1]]), np.eye(2), [[1.0]]))
    assert text.startswith("Riccati solution in continuous time: 2 states, 1 inputs\nresidual ")
    assert "u0   1  1.7321" in text and "-0.86603+0.5i" in text and "damping" in text
    sampled = riccati.solve(model([[0.5]], [[1]], SAMPLED), [[1.0]], [[1.0]])
    assert "pole, z" in repr(sampled)


@settings(derandomize=True, max_examples=15, deadline=None)
@given(seed=st.integers(0, 10**6))
def test_the_least_eigenvalue_does_not_depend_on_units(seed: int) -> None:
    rng = np.random.default_rng(seed)
    n = int(rng.integers(2, 6))
    A, B, d = rng.normal(size=(n, n)), rng.normal(size=(n, 1)), 10.0 ** rng.uniform(-6, 6, n)
    plain = riccati.solve((A, B), np.eye(n), [1.0])
    scaled = riccati.solve((A * d / d[:, None], B / d[:, None]), d * d, [1.0])
    assert 0 < scaled.least_eigenvalue == pytest.approx(plain.least_eigenvalue, rel=1e-6)


def test_a_deadbeat_pole_has_no_frequency_and_a_constant_no_damping() -> None:
    sampled = weights.table(np.array([0.0, 1e-17, -1e-300, 0.5, 1.0, -0.5]), Discrete(5e-4)).rows
    assert [row[1:] for row in sampled[:3]] == [("deadbeat", "-")] * 3
    assert [row[1:] for row in sampled[3:]] == [("220.64", "1"), ("0", "-"), ("1024.1", "0.21545")]
    assert [row[1:] for row in weights.table(np.array([0.0, -2.0, 3j]), CONTINUOUS).rows] == [
        ("0", "-"), ("0.31831", "1"), ("0.47746", "0"),
    ]  # fmt: skip


@pytest.mark.parametrize("samples", [1, 2, 3, 5])
def test_a_delayed_loop_shows_its_deadbeat_poles(samples: int) -> None:
    """Rounding scatters them, three by some 1e-5, which is no frequency of 4 kHz."""
    late = discretise.delay_samples(model([[1.0]], [[1.0]], Discrete(5e-4)), samples)
    solution = riccati.solve(late, np.diag([1.0] + [0.0] * samples), [1.0])
    shown = [row[1] for row in weights.table(solution.poles, solution.time).rows]
    assert shown.count("deadbeat") == samples
    scattered = 7e-6 * np.exp(2j * np.pi * np.arange(3) / 3)
    assert [row[1] for row in weights.table(scattered, solution.time).rows] == ["deadbeat"] * 3
    assert [row[1] for row in weights.table(scattered[:1], solution.time).rows] == ["3778.2"]
