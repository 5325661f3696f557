"""Sampling against SciPy, quadrature, an ODE solver, closed forms and mpmath, which knows nothing of Arb."""

import mpmath
import numpy as np
import pytest
import scipy.integrate
import scipy.linalg
import scipy.signal
from hypothesis import given, settings
from hypothesis import strategies as st

from synth.analyse import discretise, precise
from synth.errors import ModelError, TimingError
from synth.statespace import StateSpace
from synth.timing import Continuous, Discrete
from tests import tolerances

T = 0.02


def model(A: object, B: object, C: object = None) -> StateSpace:
    A, B = np.atleast_2d(np.asarray(A, float)), np.atleast_2d(np.asarray(B, float))
    C = np.eye(len(A)) if C is None else np.atleast_2d(np.asarray(C, float))
    names = tuple(tuple(f"{k}{i}" for i in range(n)) for k, n in (("x", len(A)), ("u", B.shape[1]), ("y", len(C))))
    return StateSpace(A, B, C, np.zeros((len(C), B.shape[1])), *names, Continuous())


def random_model(seed: int) -> StateSpace:
    rng = np.random.default_rng(seed)
    n, m = rng.integers(1, 6), rng.integers(1, 3)
    return model(rng.normal(size=(n, n)) * 10.0 ** rng.uniform(0, 1.5), rng.normal(size=(n, m)))


@settings(derandomize=True, max_examples=15, deadline=None)
@given(st.integers(0, 10**6))
def test_zero_order_hold_agrees_with_scipy_and_with_quadrature(seed: int) -> None:
    c = random_model(seed)
    held = discretise.zero_order_hold(c, T)
    F, G, *_ = scipy.signal.cont2discrete((c.A, c.B, c.C, c.D), T)
    nodes, weights = np.polynomial.legendre.leggauss(16)
    integral = sum(
        T / 2 * w * scipy.linalg.expm(c.A * T / 2 * (v + 1)) @ c.B for v, w in zip(nodes, weights, strict=True)
    )
    assert held.time == Discrete(T)
    np.testing.assert_allclose(held.A, F, rtol=0, atol=tolerances.of("double") * np.abs(F).max())
    np.testing.assert_allclose(held.B, G, rtol=0, atol=tolerances.of("double") * np.abs(G).max())
    np.testing.assert_allclose(held.B, integral, rtol=0, atol=tolerances.of("quadrature") * np.abs(G).max())


@settings(derandomize=True, max_examples=15, deadline=None)
@given(st.integers(0, 10**6))
def test_first_order_hold_has_the_response_of_scipys(seed: int) -> None:
    c = random_model(seed)
    ramp = discretise.first_order_hold(c.A, c.B, T)
    A, B, C, D, _ = scipy.signal.cont2discrete((c.A, c.B, c.C, c.D), T, method="foh")
    for z in np.exp(1j * np.linspace(0.3, 3.0, 5)):
        ours = np.linalg.solve(z * np.eye(len(A)) - ramp.F, ramp.G + (z - 1) * ramp.H)
        theirs = C @ np.linalg.solve(z * np.eye(len(A)) - A, B) + D
        np.testing.assert_allclose(ours, theirs, rtol=0, atol=1e3 * tolerances.of("double") * np.abs(theirs).max())


def test_first_order_hold_is_the_solution_for_a_linear_input() -> None:
    A, B = np.array([[0.0, 1.0], [-40.0, -3.0]]), np.array([[0.2], [5.0]])
    x0, u0, u1 = np.array([0.3, -0.7]), 1.5, -0.4
    ramp = discretise.first_order_hold(A, B, T)
    solved = scipy.integrate.solve_ivp(
        lambda t, x: A @ x + B[:, 0] * (u0 + (u1 - u0) * t / T), (0, T), x0, rtol=1e-11, atol=1e-13
    ).y[:, -1]
    ours = ramp.F @ x0 + ramp.G[:, 0] * u0 + ramp.H[:, 0] * (u1 - u0)
    np.testing.assert_allclose(ours, solved, rtol=tolerances.of("ode"))
    assert np.abs(ramp.F @ x0 + ramp.G[:, 0] * u0 - solved).max() > 1e3 * tolerances.of("ode")  # H left out


def test_a_double_integrator_comes_out_as_its_closed_form() -> None:
    held = discretise.zero_order_hold(model([[0, 1], [0, 0]], [[0], [1]]), T)
    ramp = discretise.first_order_hold([[0, 1], [0, 0]], [[0], [1]], T)
    exact = mpmath.mpf(T)
    np.testing.assert_array_equal(held.A, [[1, T], [0, 1]])
    np.testing.assert_array_equal(held.B, [[float(exact**2 / 2)], [T]])
    np.testing.assert_array_equal(ramp.H, [[float(exact**2 / 6)], [float(exact / 2)]])


def test_each_entry_is_rounded_once() -> None:
    c = random_model(4)
    held = discretise.zero_order_hold(c, T)
    n, m = c.B.shape
    with mpmath.workdps(60):
        M = mpmath.matrix(np.block([[c.A, c.B], [np.zeros((m, n + m))]]).tolist()) * mpmath.mpf(T)
        E = mpmath.expm(M)
        exact = np.array([[float(E[i, j]) for j in range(n + m)] for i in range(n)])
    np.testing.assert_array_equal(np.hstack([held.A, held.B]), exact)
    double = scipy.linalg.expm(np.block([[c.A, c.B], [np.zeros((m, n + m))]]) * T)[:n]
    assert (double != exact).any()  # an exponential in double is not rounded right, and the test sees it


def test_decoupled_axes_stay_decoupled() -> None:
    A = scipy.linalg.block_diag([[0, 1], [-30, -2]], [[-5.0]])
    held = discretise.zero_order_hold(model(A, [[0, 0], [1, 0], [0, 1]]), T)
    assert not held.A[:2, 2].any() and not held.A[2, :2].any() and not held.B[:2, 1].any() and held.B[2, 0] == 0


def test_a_mode_that_needs_more_bits_gets_them_and_one_that_needs_too_many_is_refused() -> None:
    # exp(-a T) beside exp(+a T) in one matrix: a T = 300 costs 870 bits of cancellation, a T = 10^4 some 30 000.
    def cancelling(a: float) -> precise.flint.arb_mat:
        E = (precise.matrix([[-a, 1.0], [0.0, a]])).exp()
        return precise.flint.arb_mat([[E[1, 1] * E[0, 0] + E[0, 1] - E[0, 1]]])

    assert precise.resolved(lambda: cancelling(300.0), "the product")[0, 0] == 1
    with pytest.raises(ModelError, match=r"the product is not determined by 4096 bits: .* shorter period"):
        precise.resolved(lambda: cancelling(1e4), "the product")


def test_an_unknown_ball_is_larger_than_any_number() -> None:
    assert precise.norm(precise.flint.arb_mat([[precise.flint.arb(1), precise.flint.arb("nan")]])) == np.inf


@pytest.mark.parametrize("samples", [0, 1, 3])
def test_a_delay_multiplies_the_response_by_a_power_of_z(samples: int) -> None:
    held = discretise.zero_order_hold(random_model(7), T)
    late = discretise.with_delay(held, samples)
    z = np.exp(1j * np.array([0.1, 1.0, 3.0]))
    np.testing.assert_allclose(
        late.response(z), held.response(z) * z[:, None, None] ** -samples, rtol=1e3 * tolerances.of("double")
    )
    assert late.states[len(held.states) :] == tuple(f"{u}_late{k + 1}" for k in range(samples) for u in held.inputs)


def test_time_is_not_mixed() -> None:
    c = random_model(1)
    held = discretise.zero_order_hold(c, T)
    with pytest.raises(TimingError, match=r"discrete time of 0.02 s was given to be sampled"):
        discretise.zero_order_hold(held, T)
    for period in (0.0, -1.0, np.nan):
        with pytest.raises(TimingError, match="finite and positive"):
            discretise.first_order_hold(c.A, c.B, period)
    with pytest.raises(TimingError, match="sample the model"):
        discretise.with_delay(c)
    with pytest.raises(TimingError, match="delay of -1 samples"):
        discretise.with_delay(held, -1)
