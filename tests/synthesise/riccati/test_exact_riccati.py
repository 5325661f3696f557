"""Correctly rounded Riccati solutions against closed forms, the Hamiltonian matrix's eigenvectors and SLICOT.

The enclosure holds mpmath's solution, from near and from far; a wrong last bit and a ball that is off are detected.
"""

from time import process_time

import flint
import mpmath
import numpy as np
import pytest
import scipy.linalg
import slycot
from hypothesis import given, settings
from hypothesis import strategies as st

from synth.analyse.numerics import precise
from synth.errors import ModelError
from synth.synthesise.riccati import exact, riccati
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
        solution = riccati.solve(([[a]], [[b]], time), [[q]], [[r]])
        assert (solution.X[0, 0], solution.L[0, 0]) == (X, L)


def test_the_double_integrator_is_correctly_rounded() -> None:
    """Q = I, R = 1: X = [[sqrt 3, 1], [1, sqrt 3]], L = [1, sqrt 3]."""
    solution = riccati.solve(([[0, 1], [0, 0]], [[0], [1]]), np.eye(2), [[1.0]])
    np.testing.assert_array_equal(solution.X, [[np.sqrt(3), 1], [1, np.sqrt(3)]])
    np.testing.assert_array_equal(solution.L, [[1, np.sqrt(3)]])
    np.testing.assert_allclose(solution.poles, [-np.sqrt(3) / 2 - 0.5j, -np.sqrt(3) / 2 + 0.5j], rtol=1e-14)


def test_weights_of_different_size_are_correctly_rounded() -> None:
    """Q = diag(q^2, 0): L = [q, sqrt(2 q)], X = [[q sqrt(2 q), q], [q, sqrt(2 q)]]."""
    q = 2.0**21
    solution = riccati.solve(([[0, 1], [0, 0]], [[0], [1]]), np.diag([q * q, 0]), [[1.0]])
    np.testing.assert_array_equal(solution.X, [[q * np.sqrt(2 * q), q], [q, np.sqrt(2 * q)]])


def test_decoupled_axes_stay_decoupled() -> None:
    A, B = scipy.linalg.block_diag([[0, 1], [0, 0]], [[0.5]]), np.array([[0, 0], [1, 0], [0, 1]])
    solution = riccati.solve((A, B), np.diag([3.0, 1.0, 2.0]), np.eye(2))
    assert not solution.X[:2, 2].any() and not solution.L[0, 2] and not solution.L[1, :2].any()


@pytest.mark.parametrize("time", [CONTINUOUS, SAMPLED])
@pytest.mark.parametrize("size", [1e-15, 1e-9, 1e-6])
def test_the_certificate_flags_a_perturbed_solution(time: Time, size: float) -> None:
    system, Q, R = random_problem(8, time)
    right = riccati.solve(system, Q, R)
    E, unit = np.random.default_rng(0).normal(size=right.X.shape), np.sqrt(np.diag(right.X))
    wrong = right.X + size * (E + E.T) / np.abs(E + E.T).max() * unit * unit[:, None]
    wrong = (wrong + wrong.T) / 2
    flagged = riccati.certify(system, Q, R, wrong)
    again = riccati.certify(system, Q, R, right.X)
    assert again.forward_error == pytest.approx(right.forward_error, rel=1e-6)
    assert right.forward_error <= HALF_BIT < flagged.forward_error
    assert flagged.forward_error == pytest.approx(size, rel=0.5)
    assert flagged.residual > again.residual


def test_more_bits_are_taken_where_the_first_ones_do_not_suffice(monkeypatch: pytest.MonkeyPatch) -> None:
    """R is 1e-14 of the scale, and one output is weighted: 64 bits do not resolve it, and 256 do."""
    rng = np.random.default_rng(22)
    n, m, _ = rng.integers(1, 7), rng.integers(1, 3), rng.integers(2)
    A, B = rng.normal(size=(n, n)), rng.normal(size=(n, m))
    C = rng.normal(size=(rng.integers(1, n + 1), n))
    Q, R = C.T @ C, 1e-14 * np.eye(m)
    Q = (Q + Q.T) / 2
    solution = riccati.solve((A, B), Q, R)
    assert solution.forward_error <= 1e-12 and solution.residual <= HALF_BIT
    equation = Equation(A, B, Q, R, np.zeros(B.shape), True)
    for bits in ((64, precise.BITS), (64,)):
        monkeypatch.setattr(exact, "BITS", bits)
        if len(bits) > 1:
            np.testing.assert_array_equal(exact.solve(equation).L, solution.L)
    with pytest.raises(ModelError, match="does not converge within 64 bits"):
        exact.solve(equation)


def test_what_no_input_stabilises_is_refused() -> None:
    """x' = x + u: X = 1 gives A - B L = 0, which has no step."""
    one = np.ones((1, 1))
    equation = Equation(one, one, 3 * one, one, 0 * one, True)
    assert exact.solve(equation).X == 3 and np.isinf(exact.certify(equation, one).step)
    with pytest.raises(ModelError, match="does not converge within 1024 bits, or its loop is not stable"):
        exact.solve(Equation(one, 0 * one, 3 * one, one, 0 * one, True))
    with pytest.raises(ModelError, match=r"R \+ B'XB is singular: this X has no gain"):
        exact.certify(Equation(one, one, one, one, 0 * one, False), -one)


@pytest.mark.parametrize("time", [CONTINUOUS, SAMPLED])
@pytest.mark.parametrize("bits", [40, 52, 80])
def test_a_limit_that_is_off_gives_no_wrong_bit(monkeypatch: pytest.MonkeyPatch, time: Time, bits: int) -> None:
    """The first precision returns a centre that is off by 2^-bits of X; the enclosure leaves that to the second."""
    e, limit, centres = cross_weighted(1, time), exact._doubling_limit, []
    right = exact.solve(e)

    def off(problem: exact._Problem, X0: flint.arb_mat) -> flint.arb_mat | None:
        centre = limit(problem, X0)
        assert centre is not None
        centres.append(centre * (1 + flint.arb(2) ** -bits) if flint.ctx.prec == precise.BITS else centre)
        return centres[-1].mid()

    monkeypatch.setattr(exact, "_doubling_limit", off)
    solution = exact.solve(e)
    assert solution.X.tobytes() == right.X.tobytes() and solution.L.tobytes() == right.L.tobytes()
    assert (len(centres) > 1) == (bits < 80)


# The enclosure


def mpmath_solution(e: Equation) -> tuple[mpmath.matrix, mpmath.matrix]:
    """X and L from the stable eigenvectors of the Hamiltonian or the symplectic matrix (Laub 1979), in 80 digits."""
    A, B, Q, R, N = (mpmath.matrix(M.tolist()) for M in (e.A, e.B, e.Q, e.R, e.N))
    n, W = A.rows, mpmath.inverse(R)
    A, G, Q = A - B * W * N.T, B * W * B.T, Q - N * W * N.T
    M = mpmath.zeros(2 * n)
    if e.continuous:
        M[:n, :n], M[:n, n:], M[n:, :n], M[n:, n:] = A, -G, -Q, -A.T
    else:
        inverse = mpmath.inverse(A.T)
        M[:n, :n], M[:n, n:], M[n:, :n], M[n:, n:] = A + G * inverse * Q, -G * inverse, -inverse * Q, inverse
    s, V = mpmath.eig(M)
    stable = [i for i in range(2 * n) if (mpmath.re(s[i]) < 0 if e.continuous else abs(s[i]) < 1)]
    U = mpmath.matrix([[V[i, j] for j in stable] for i in range(2 * n)])
    X = (U[n:, :] * mpmath.inverse(U[:n, :])).apply(mpmath.re)
    P = B.T * X if e.continuous else B.T * X * mpmath.matrix(e.A.tolist())
    return X, mpmath.inverse(R if e.continuous else R + B.T * X * B) * (P + N.T)


def to_mpmath(value: flint.arb) -> mpmath.mpf:
    mantissa, exponent = value.mid().man_exp()
    return mpmath.mpf(int(mantissa)) * mpmath.mpf(2) ** int(exponent)


def contains(balls: flint.arb_mat, X: mpmath.matrix) -> bool:
    """Whether each ball holds its entry of X to 60 digits."""
    return all(
        abs(to_mpmath(balls[i, j]) - X[i, j]) <= to_mpmath(balls[i, j].rad()) + abs(X[i, j]) * mpmath.mpf(10) ** -60
        for i in range(X.rows)
        for j in range(X.cols)
    )


def cross_weighted(seed: int, time: Time) -> Equation:
    (A, B, _), Q, R = random_problem(seed, time)
    return Equation(A, B, Q, R, 0.1 * B, time is CONTINUOUS)


@pytest.mark.parametrize("time", [CONTINUOUS, SAMPLED])
@pytest.mark.parametrize("seed", range(8))
def test_random_problems_are_correctly_rounded_and_a_wrong_last_bit_is_detected(time: Time, seed: int) -> None:
    e = cross_weighted(seed, time)
    solution = exact.solve(e)
    with mpmath.workdps(80):
        X, L = mpmath_solution(e)
        np.testing.assert_array_equal(solution.X, np.array(X.tolist(), dtype=float))
        np.testing.assert_array_equal(solution.L, np.array(L.tolist(), dtype=float))
    wrong = solution.X.copy()
    wrong[-1, -1] = np.nextafter(wrong[-1, -1], np.inf)
    assert not np.array_equal(wrong, np.array(X.tolist(), dtype=float))
    right, flagged = exact.certify(e, solution.X), exact.certify(e, wrong)
    unit = np.spacing(solution.X[-1, -1])
    assert right.step[-1, -1] <= unit * 0.51 and flagged.step[-1, -1] >= unit * 0.49
    assert solution.step[-1, -1] == pytest.approx(right.step[-1, -1], rel=1e-6, abs=1e-8 * unit)


@pytest.mark.parametrize("time", [CONTINUOUS, SAMPLED])
@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("off", [1e-50, 1e-30, 1e-16, 1e-10])
def test_the_enclosure_holds_the_solution_and_a_ball_that_is_off_does_not(time: Time, seed: int, off: float) -> None:
    """The centre is off: the radius covers that, within 1e7 times as much, and leaves open to which double X rounds."""
    e = cross_weighted(seed, time)
    E = np.random.default_rng(seed).normal(size=e.A.shape)
    with precise.precision(), mpmath.workdps(80):
        problem, X = exact._problem(e), mpmath_solution(e)[0]
        centre = exact._doubling_limit(problem, precise.matrix(np.zeros_like(e.A)))
        assert centre is not None
        tight = problem.enclosure(centre)
        balls = problem.enclosure(centre + precise.matrix(E + E.T) * off)
        assert tight is not None and balls is not None
        assert contains(tight, X) and contains(balls, X) and not contains(tight + precise.matrix(E + E.T) * off, X)
        assert max(float(v.rad()) for v in balls.entries()) <= 1e7 * off
        np.testing.assert_array_equal(precise.doubles(tight), np.array(X.tolist(), dtype=float))
        assert (precise.doubles(balls) is None) == (off >= 1e-16)


@pytest.mark.parametrize("time", [CONTINUOUS, SAMPLED])
def test_another_solution_and_a_centre_too_far_off_have_no_enclosure(time: Time) -> None:
    """b = q = r = 1: the negative root of X^2 = 2 a X + 1, or X^2 = a^2 X + 1, leaves the loop unstable."""
    one, a = np.ones((1, 1)), 1.0 if time is CONTINUOUS else 2.0
    h = a if time is CONTINUOUS else a * a / 2
    with precise.precision():
        problem = exact._problem(Equation(a * one, one, one, one, 0 * one, time is CONTINUOUS))
        root = (flint.arb(h) ** 2 + 1).sqrt()
        stabilising, other = flint.arb_mat([[h + root]]), flint.arb_mat([[h - root]])
        assert problem.enclosure(stabilising.mid()) is not None and problem.enclosure(other.mid()) is None
        assert problem.enclosure(stabilising.mid() * 1.5) is None


def driven_masses(count: int) -> Equation:
    """Masses in a row, springs between them and to the walls, each driven, with the integral of its position."""
    one, zero = np.eye(count), np.zeros((count, count))
    K = 1e3 * (2 * one - np.eye(count, k=1) - np.eye(count, k=-1))
    A = np.block([[zero, one, zero], [-K, -1e-4 * K, zero], [one, zero, zero]])
    B = np.vstack([zero, one, zero])
    Q = np.diag(np.repeat([1e4, 1.0, 1e6], count))
    return Equation(A, B, Q, one, np.zeros(B.shape), True)


@pytest.mark.parametrize("continuous", [True, False])
def test_a_chain_of_twelve_states_agrees_with_slicot_and_scipy(continuous: bool) -> None:
    e = driven_masses(4)
    if not continuous:
        step = scipy.linalg.expm(1e-2 * np.block([[e.A, e.B], [np.zeros((4, 16))]]))
        e = Equation(step[:12, :12], step[:12, 12:], e.Q, e.R, 0.1 * e.N, False)
    X = exact.solve(e).X
    solver = scipy.linalg.solve_continuous_are if continuous else scipy.linalg.solve_discrete_are
    slicots = slycot.sb02od(12, 4, e.A.copy(), e.B.copy(), e.Q.copy(), e.R.copy(), "C" if continuous else "D")[0]
    for other in (solver(e.A, e.B, e.Q, e.R), slicots):
        np.testing.assert_allclose(X, other, rtol=0, atol=tolerances.of("pencil") * np.abs(X).max())


def test_twenty_four_states_take_less_than_a_second() -> None:
    """A method of order n^6 took more than 20 s."""
    e = driven_masses(8)
    begun = process_time()
    exact.solve(e)
    assert process_time() - begun < 1.0


@pytest.mark.parametrize(("time", "a", "X"), [(CONTINUOUS, 1.0, 1 - 2**0.5), (SAMPLED, 2.0, 2 - 5**0.5)])
def test_another_solution_than_the_stabilising_one_is_reported(time: Time, a: float, X: float) -> None:
    """b = q = r = 1: X^2 = 2 a X + 1, or X^2 = a^2 X + 1, has a negative root, too, which leaves the loop unstable."""
    solution = riccati.certify(([[a]], [[1.0]], time), [1.0], [1.0], [[X]])
    assert solution.forward_error == solution.condition == np.inf and solution.residual <= tolerances.of("double")
    assert solution.poles.real > 0 if time is CONTINUOUS else abs(solution.poles) > 1


@pytest.mark.parametrize("apart", [1e-6, 1e-8, 1e-10])
def test_nearly_unstabilisable_pairs_are_solved(apart: float) -> None:
    """Modes 1 and 1 + e under one input: the poles tend to -1 and -sqrt 3, seen in mpmath on the rounded L."""
    A = np.diag([1, 1 + apart])
    solution = riccati.solve((A, [[1], [1]]), [1.0, 1.0], [1.0])
    np.testing.assert_allclose(solution.poles, [-np.sqrt(3), -1], rtol=2 * apart)
    assert solution.forward_error <= HALF_BIT
    with mpmath.workdps(60):
        closed = mpmath.matrix(A.tolist()) - mpmath.matrix([[1], [1]]) * mpmath.matrix(solution.L.tolist())
        poles = sorted(float(mpmath.re(s)) for s in mpmath.eig(closed)[0])
    np.testing.assert_allclose(poles, [-np.sqrt(3), -1], rtol=1e-4)  # the last bit of L, 1e-17 of 5e10, is 1e-5
