"""Correctly rounded Riccati solutions against closed forms in mpmath; more bits are taken where 256 do not tell."""

import mpmath
import numpy as np
import pytest
import scipy.linalg
from hypothesis import given, settings
from hypothesis import strategies as st

from synth.analyse import precise
from synth.errors import ModelError
from synth.synthesise.riccati import exact_riccati, riccati
from synth.synthesise.riccati.equation import Equation
from synth.timing import Continuous, Discrete, Time
from tests import tolerances

CONTINUOUS, SAMPLED = Continuous(), Discrete(1e-3)
HALF_BIT = tolerances.of("half_bit")
positive = st.floats(0.01, 100)


def random_problem(seed: int, time: Time) -> tuple[tuple[np.ndarray, np.ndarray, Time], np.ndarray, np.ndarray]:
    rng = np.random.default_rng(seed)
    n, m = rng.integers(1, 5), rng.integers(1, 3)
    C = rng.normal(size=(n, n))
    return (rng.normal(size=(n, n)), rng.normal(size=(n, m)), time), C @ C.T + 0.1 * np.eye(n), np.eye(m)


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
        solution = riccati.solve(([[a]], [[b]], time), [[q]], [[r]], exact=True)
        assert (solution.X[0, 0], solution.L[0, 0]) == (X, L)


def test_the_double_integrator_is_correctly_rounded() -> None:
    """Q = I, R = 1: X = [[sqrt 3, 1], [1, sqrt 3]], L = [1, sqrt 3]."""
    solution = riccati.solve(([[0, 1], [0, 0]], [[0], [1]]), np.eye(2), [[1.0]], exact=True)
    np.testing.assert_array_equal(solution.X, [[np.sqrt(3), 1], [1, np.sqrt(3)]])
    np.testing.assert_array_equal(solution.L, [[1, np.sqrt(3)]])
    np.testing.assert_allclose(solution.poles, [-np.sqrt(3) / 2 - 0.5j, -np.sqrt(3) / 2 + 0.5j], rtol=1e-14)


def test_weights_of_different_size_are_correctly_rounded() -> None:
    """Q = diag(q^2, 0): L = [q, sqrt(2 q)], X = [[q sqrt(2 q), q], [q, sqrt(2 q)]]."""
    q = 2.0**21
    solution = riccati.solve(([[0, 1], [0, 0]], [[0], [1]]), np.diag([q * q, 0]), [[1.0]], exact=True)
    np.testing.assert_array_equal(solution.X, [[q * np.sqrt(2 * q), q], [q, np.sqrt(2 * q)]])


def test_decoupled_axes_stay_decoupled() -> None:
    A, B = scipy.linalg.block_diag([[0, 1], [0, 0]], [[0.5]]), np.array([[0, 0], [1, 0], [0, 1]])
    solution = riccati.solve((A, B), np.diag([3.0, 1.0, 2.0]), np.eye(2), exact=True)
    assert not solution.X[:2, 2].any() and not solution.L[0, 2] and not solution.L[1, :2].any()


@pytest.mark.parametrize("time", [CONTINUOUS, SAMPLED])
def test_the_bits_do_not_depend_on_the_start(time: Time) -> None:
    (A, B, _), Q, R = random_problem(5, time)
    equation = Equation(A, B, Q, R, np.zeros(B.shape), time is CONTINUOUS)
    start = riccati.solve((A, B, time), Q, R).X
    first, second = (exact_riccati.solve(equation, start * scale) for scale in (1.0, 1 + 1e-5))
    assert first.X.tobytes() == second.X.tobytes() and first.L.tobytes() == second.L.tobytes()


@pytest.mark.parametrize("time", [CONTINUOUS, SAMPLED])
@pytest.mark.parametrize("size", [1e-15, 1e-9, 1e-6])
def test_the_certificate_flags_a_perturbed_solution(time: Time, size: float) -> None:
    system, Q, R = random_problem(8, time)
    right = riccati.solve(system, Q, R, exact=True)
    E, unit = np.random.default_rng(0).normal(size=right.X.shape), np.sqrt(np.diag(right.X))
    wrong = right.X + size * (E + E.T) / np.abs(E + E.T).max() * unit * unit[:, None]
    wrong = (wrong + wrong.T) / 2
    flagged = riccati.certify(system, Q, R, wrong, exact=True)
    again = riccati.certify(system, Q, R, right.X, exact=True)
    assert again.forward_error == right.forward_error <= HALF_BIT < flagged.forward_error
    assert flagged.forward_error == pytest.approx(size, rel=0.5)
    assert flagged.residual > again.residual


def test_more_bits_are_taken_where_the_usual_ones_do_not_suffice(monkeypatch: pytest.MonkeyPatch) -> None:
    """At 256 bits this problem's Newton steps wander by 3 %: R is 1e-14 of the scale, and one output is weighted."""
    rng = np.random.default_rng(22)
    n, m, _ = rng.integers(1, 7), rng.integers(1, 3), rng.integers(2)
    A, B = rng.normal(size=(n, n)), rng.normal(size=(n, m))
    C = rng.normal(size=(rng.integers(1, n + 1), n))
    Q, R = C.T @ C, 1e-14 * np.eye(m)
    Q = (Q + Q.T) / 2
    solution = riccati.solve((A, B), Q, R, exact=True)
    assert solution.forward_error <= 1e-12 and solution.residual <= HALF_BIT
    monkeypatch.setattr(exact_riccati, "BITS", (precise.BITS,))
    equation = Equation(A, B, Q, R, np.zeros(B.shape), True)
    with pytest.raises(ModelError, match="does not converge within 256 bits"):
        exact_riccati.solve(equation, solution.X)


def test_a_start_without_a_newton_step_is_refused() -> None:
    """x' = x + u: X = 1 gives A - B L = 0; the solution, X = 3, is found without it."""
    one = np.ones((1, 1))
    equation = Equation(one, one, 3 * one, one, 0 * one, True)
    assert exact_riccati.solve(equation, one).X == 3
    with pytest.raises(ModelError, match="does not converge within 4096 bits, or a step has no solution"):
        exact_riccati.solve(Equation(one, 0 * one, 3 * one, one, 0 * one, True), one)
    with pytest.raises(ModelError, match=r"has no solution: its closed loop has poles s \+ s' = 0"):
        exact_riccati.certify(equation, one)


@pytest.mark.parametrize(("time", "a", "X"), [(CONTINUOUS, 1.0, 1 - 2**0.5), (SAMPLED, 2.0, 2 - 5**0.5)])
@pytest.mark.parametrize("exact", [False, True])
def test_another_solution_than_the_stabilising_one_is_reported(time: Time, a: float, X: float, exact: bool) -> None:
    """b = q = r = 1: X^2 = 2 a X + 1, or X^2 = a^2 X + 1, has a negative root, too, which leaves the loop unstable."""
    solution = riccati.certify(([[a]], [[1.0]], time), [1.0], [1.0], [[X]], exact=exact)
    assert solution.forward_error == solution.condition == np.inf and solution.residual <= tolerances.of("double")
    assert solution.poles.real > 0 if time is CONTINUOUS else abs(solution.poles) > 1


@pytest.mark.parametrize("time", [CONTINUOUS, SAMPLED])
def test_from_no_start_or_from_one_near_another_solution_doubling_leads_to_the_same(time: Time) -> None:
    (A, B, _), Q, R = random_problem(5, time)
    equation = Equation(A, B, Q, R, 0.1 * B, time is CONTINUOUS)
    right = riccati.solve((A, B, time), Q, R, 0.1 * B, exact=True)
    for start in (None, -right.X, 0 * right.X):
        solution = exact_riccati.solve(equation, start)
        assert solution.X.tobytes() == right.X.tobytes() and solution.L.tobytes() == right.L.tobytes()
    closed = np.sort_complex(np.linalg.eigvals(A - B @ right.L))
    np.testing.assert_allclose(solution.poles(), closed, rtol=tolerances.of("folded"))


@pytest.mark.parametrize("apart", [1e-6, 1e-8, 1e-10])
@pytest.mark.parametrize("exact", [False, True])
def test_nearly_unstabilisable_pairs_are_left_to_ball_arithmetic(apart: float, exact: bool) -> None:
    """Modes 1 and 1 + e under one input: the poles tend to -1 and -sqrt 3, seen in mpmath on the rounded L."""
    A = np.diag([1, 1 + apart])
    solution = riccati.solve((A, [[1], [1]]), [1.0, 1.0], [1.0], exact=exact)
    np.testing.assert_allclose(solution.poles, [-np.sqrt(3), -1], rtol=2 * apart)
    assert solution.forward_error <= HALF_BIT
    with mpmath.workdps(60):
        closed = mpmath.matrix(A.tolist()) - mpmath.matrix([[1], [1]]) * mpmath.matrix(solution.L.tolist())
        poles = sorted(float(mpmath.re(s)) for s in mpmath.eig(closed)[0])
    np.testing.assert_allclose(poles, [-np.sqrt(3), -1], rtol=1e-4)  # the last bit of L, 1e-17 of 5e10, is 1e-5
