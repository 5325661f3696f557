"""Riccati solutions against SciPy, python-control, SLICOT and closed forms; a wrong X does not pass the certificate."""

import control
import mpmath
import numpy as np
import pytest
import scipy.linalg
import slycot
from hypothesis import given, settings
from hypothesis import strategies as st

from synth.errors import ModelError, SignalError
from synth.statespace import StateSpace
from synth.synthesise import riccati
from synth.timing import Continuous, Discrete, Time
from tests import tolerances

CONTINUOUS, SAMPLED = Continuous(), Discrete(1e-3)
HALF_BIT = tolerances.of("half_bit")


def model(A: object, B: object, time: Time = CONTINUOUS) -> StateSpace:
    A, B = np.atleast_2d(np.asarray(A, float)), np.atleast_2d(np.asarray(B, float))
    states, inputs = tuple(f"x{i}" for i in range(len(A))), tuple(f"u{i}" for i in range(B.shape[1]))
    return StateSpace(A, B, np.eye(len(A)), np.zeros(B.shape), states, inputs, states, time)


def random_problem(seed: int, time: Time) -> tuple[StateSpace, np.ndarray, np.ndarray, np.ndarray]:
    rng = np.random.default_rng(seed)
    n, m = rng.integers(1, 6), rng.integers(1, 3)
    W = rng.normal(size=(n + m, n + m))
    W = W @ W.T + 0.1 * np.eye(n + m)
    return model(rng.normal(size=(n, n)), rng.normal(size=(n, m)), time), W[:n, :n], W[n:, n:], W[:n, n:]


@pytest.mark.parametrize("time", [CONTINUOUS, SAMPLED])
@settings(derandomize=True, max_examples=15, deadline=None)
@given(seed=st.integers(0, 10**6))
def test_random_problems_agree_with_scipy_and_python_control(time: Time, seed: int) -> None:
    c, Q, R, N = random_problem(seed, time)
    found = riccati.solve(c, Q, R, N)
    solver = control.care if time is CONTINUOUS else control.dare
    X, poles, L = solver(c.A, c.B, Q, R, S=N, E=np.eye(len(c.A)), method="scipy")
    atol = tolerances.of("pencil") * np.abs(X).max()
    np.testing.assert_allclose(found.X, X, rtol=0, atol=atol)
    np.testing.assert_allclose(found.L, L, rtol=0, atol=tolerances.of("pencil") * np.abs(L).max())
    stable = found.poles.real < 0 if time is CONTINUOUS else np.abs(found.poles) < 1
    assert stable.all() and found.least_eigenvalue > 0
    np.testing.assert_allclose(sorted(np.abs(found.poles)), sorted(np.abs(poles)), rtol=1e3 * tolerances.of("pencil"))
    rounding = tolerances.of("last_bit") * len(c.A) ** 2 * (1 + np.abs(c.A).max() + np.abs(c.B @ L).max()) ** 2
    assert found.forward_error <= HALF_BIT and found.residual <= rounding * np.abs(X).max() / np.abs(Q).max()
    np.testing.assert_array_equal(found.X, found.X.T)


@pytest.mark.parametrize(("time", "letter"), [(CONTINUOUS, "C"), (SAMPLED, "D")])
def test_slicot_agrees(time: Time, letter: str) -> None:
    c, Q, R, N = random_problem(11, time)
    n, m = c.B.shape
    X = slycot.sb02od(n, m, c.A.copy(), c.B.copy(), Q.copy(), R.copy(), letter, L=N.copy())[0]
    np.testing.assert_allclose(riccati.solve(c, Q, R, N).X, X, rtol=0, atol=tolerances.of("pencil") * np.abs(X).max())
    assert np.abs(riccati.solve(c, Q, R).X - X).max() > 1e-3  # without the cross weight it is another problem


positive = st.floats(0.01, 100)


@settings(derandomize=True, max_examples=40, deadline=None)
@given(a=st.floats(-10, 10), b=st.floats(0.1, 10), q=positive, r=positive)
def test_scalar_problems_are_correctly_rounded(a: float, b: float, q: float, r: float) -> None:
    """In continuous time b^2 X^2 = 2 a r X + q r, in discrete time b^2 X^2 = (r (a^2 - 1) + b^2 q) X + q r."""
    with mpmath.workdps(80):
        A, B, Q, R = map(mpmath.mpf, (a, b, q, r))
        flow = (A * R + mpmath.sqrt(A**2 * R**2 + B**2 * Q * R)) / B**2
        h = R * (A**2 - 1) + B**2 * Q
        step = (h + mpmath.sqrt(h**2 + 4 * B**2 * Q * R)) / (2 * B**2)
        gains = float(B * flow / R), float(A * B * step / (R + B**2 * step))
        values = float(flow), float(step)
    for time, X, L in zip((CONTINUOUS, SAMPLED), values, gains, strict=True):
        found = riccati.solve(model([[a]], [[b]], time), [[q]], [[r]])
        assert (found.X[0, 0], found.L[0, 0]) == (X, L)


def test_the_double_integrator_is_correctly_rounded() -> None:
    """Q = I, R = 1: X = [[sqrt 3, 1], [1, sqrt 3]], L = [1, sqrt 3]."""
    found = riccati.solve(model([[0, 1], [0, 0]], [[0], [1]]), np.eye(2), [[1.0]])
    np.testing.assert_array_equal(found.X, [[np.sqrt(3), 1], [1, np.sqrt(3)]])
    np.testing.assert_array_equal(found.L, [[1, np.sqrt(3)]])
    np.testing.assert_allclose(found.poles, [-np.sqrt(3) / 2 - 0.5j, -np.sqrt(3) / 2 + 0.5j], rtol=1e-14)


def test_weights_of_unlike_size_are_correctly_rounded() -> None:
    """Q = diag(q^2, 0): L = [q, sqrt(2 q)], X = [[q sqrt(2 q), q], [q, sqrt(2 q)]]."""
    q = 2.0**21
    found = riccati.solve(model([[0, 1], [0, 0]], [[0], [1]]), np.diag([q * q, 0]), [[1.0]])
    np.testing.assert_array_equal(found.X, [[q * np.sqrt(2 * q), q], [q, np.sqrt(2 * q)]])


def test_decoupled_axes_stay_decoupled() -> None:
    A, B = scipy.linalg.block_diag([[0, 1], [0, 0]], [[0.5]]), np.array([[0, 0], [1, 0], [0, 1]])
    found = riccati.solve(model(A, B), np.diag([3.0, 1.0, 2.0]), np.eye(2))
    assert not found.X[:2, 2].any() and not found.L[0, 2] and not found.L[1, :2].any()


@pytest.mark.parametrize("time", [CONTINUOUS, SAMPLED])
def test_the_bits_do_not_hang_on_the_start(time: Time, monkeypatch: pytest.MonkeyPatch) -> None:
    c, Q, R, N = random_problem(5, time)
    first, start = riccati.solve(c, Q, R, N), riccati._start
    monkeypatch.setattr(riccati, "_start", lambda *problem: start(*problem) * (1 + 1e-5))
    second = riccati.solve(c, Q, R, N)
    assert first.X.tobytes() == second.X.tobytes() and first.L.tobytes() == second.L.tobytes()


@pytest.mark.parametrize("time", [CONTINUOUS, SAMPLED])
@pytest.mark.parametrize("size", [1e-15, 1e-9, 1e-4])
def test_the_certificate_flags_a_perturbed_solution(time: Time, size: float) -> None:
    c, Q, R, N = random_problem(8, time)
    right = riccati.solve(c, Q, R, N)
    E = np.random.default_rng(0).normal(size=right.X.shape)
    wrong = right.X + size * np.abs(right.X).max() * (E + E.T) / np.abs(E + E.T).max()
    flagged = riccati.certify(c, Q, R, wrong, N)
    again = riccati.certify(c, Q, R, right.X, N)
    assert again.forward_error == right.forward_error <= HALF_BIT < flagged.forward_error
    assert flagged.forward_error == pytest.approx(size, rel=0.5)
    assert flagged.residual > again.residual


def test_the_certificate_shows_the_poles_of_a_solution_that_does_not_stabilise() -> None:
    """x' = x + u, Q = 3, R = 1: X = 3 stabilises, X = -1 solves the equation too."""
    other = riccati.certify(model([[1.0]], [[1.0]]), [[3.0]], [[1.0]], [[-1.0]])
    assert other.residual == 0 and other.poles == pytest.approx([2]) and other.least_eigenvalue == -1
    right = riccati.certify(model([[1.0]], [[1.0]]), [[3.0]], [[1.0]], [[3.0]])
    assert right.residual == 0 and right.forward_error == 0 and right.poles == pytest.approx([-2])


def test_a_start_near_the_other_solution_is_not_shipped(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(riccati, "_start", lambda *_: np.array([[-1.0]]))
    with pytest.raises(ModelError, match=r"leaves the pole 2.*, which does not decay"):
        riccati.solve(model([[1.0]], [[1.0]]), [[3.0]], [[1.0]])
    monkeypatch.setattr(riccati, "_start", lambda *_: np.array([[1.0]]))  # A - B L = 0
    with pytest.raises(ModelError, match="a Newton step of the Riccati equation has no solution"):
        riccati.solve(model([[1.0]], [[1.0]]), [[3.0]], [[1.0]])


def test_unsolvable_problems_name_the_mode() -> None:
    A = np.diag([1.0, -1.0])
    with pytest.raises(ModelError, match=r"not stabilisable: mode 1 in x0 .* inputs u0: actuate x0"):
        riccati.solve(model(A, [[0], [1]]), np.eye(2), [[1.0]])
    with pytest.raises(ModelError, match=r"\(Q, A\) is not detectable: mode 1 in x0"):
        riccati.solve(model(A, [[1], [1]]), np.diag([0.0, 1.0]), [[1.0]])


@pytest.mark.parametrize(
    ("Q", "R", "N", "message"),
    [
        (np.eye(3), np.eye(1), None, r"matrix Q is \(3, 3\): give a finite one of \(2, 2\)"),
        (np.diag([1.0, np.nan]), np.eye(1), None, "matrix Q is"),
        (np.array([[1.0, 2.0], [0.0, 1.0]]), np.eye(1), None, r"Q is not symmetric: \[0, 1\] is 2.0, \[1, 0\] is 0.0"),
        (np.diag([1.0, -1.0]), np.eye(1), None, "eigenvalue -1: the cost must be positive semidefinite"),
        (np.eye(2), np.zeros((1, 1)), None, "weight R has the eigenvalue 0: it must be positive definite"),
        (np.eye(2), np.eye(1), np.ones((1, 2)), r"cross weight N is \(1, 2\)"),
        (np.eye(2), np.eye(1), np.array([[2.0], [0.0]]), "eigenvalue -3"),
    ],
)
def test_weights_that_make_no_cost_are_refused(
    Q: np.ndarray, R: np.ndarray, N: np.ndarray | None, message: str
) -> None:
    with pytest.raises(SignalError, match=message):
        riccati.solve(model([[0, 1], [0, 0]], [[0], [1]]), Q, R, N)
