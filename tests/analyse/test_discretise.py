"""Sampling against SciPy, python-control, quadrature, an ODE solver, closed forms and mpmath, independent of Arb."""

from dataclasses import replace

import control
import mpmath
import numpy as np
import pytest
import scipy.integrate
import scipy.linalg
import scipy.signal
from hypothesis import given, settings
from hypothesis import strategies as st

from synth.analyse import discretise
from synth.analyse.numerics import precise
from synth.errors import ModelError, SignalError, TimingError
from synth.reference import gains as reference_gains
from synth.statespace import StateSpace, of
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
def test_first_order_hold_matches_scipy(seed: int) -> None:
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


def test_a_double_integrator_has_its_closed_form() -> None:
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
    assert (double != exact).any()  # an exponential in double is not correctly rounded, and the test detects it


def test_decoupled_axes_stay_decoupled() -> None:
    A = scipy.linalg.block_diag([[0, 1], [-30, -2]], [[-5.0]])
    held = discretise.zero_order_hold(model(A, [[0, 0], [1, 0], [0, 1]]), T)
    assert not held.A[:2, 2].any() and not held.A[2, :2].any() and not held.B[:2, 1].any() and held.B[2, 0] == 0


def test_a_mode_that_needs_more_bits_gets_them_and_one_that_needs_too_many_is_refused() -> None:
    # exp(-a T) beside exp(+a T) in one matrix: a T = 300 costs 870 bits of cancellation, a T = 10^4 some 30 000.
    def cancelling(a: float) -> precise.flint.arb_mat:
        E = (precise.matrix([[-a, 1.0], [0.0, a]])).exp()
        return precise.flint.arb_mat([[E[1, 1] * E[0, 0] + E[0, 1] - E[0, 1]]])

    assert precise.round_correctly(lambda: cancelling(300.0), "the product")[0, 0] == 1
    with pytest.raises(ModelError, match=r"the product is not determined by 4096 bits: .* shorter period"):
        precise.round_correctly(lambda: cancelling(1e4), "the product")


def test_a_matrix_that_more_bits_show_regular_is_inverted_and_a_singular_one_is_not() -> None:
    def inverse(gap: float) -> precise.flint.arb_mat:
        entries = [[1, 1], [1, 1 + gap * precise.flint.arb(2) ** -500]]
        return precise.flint.arb_mat(entries).inv() * (precise.flint.arb(2) ** -500)

    np.testing.assert_array_equal(precise.round_correctly(lambda: inverse(1.0), "the inverse"), [[1, -1], [-1, 1]])
    with pytest.raises(ZeroDivisionError):
        precise.round_correctly(lambda: inverse(0.0), "the inverse")


def test_the_norm_of_an_unbounded_ball_is_infinite() -> None:
    assert precise.norm(precise.flint.arb_mat([[precise.flint.arb(1), precise.flint.arb("nan")]])) == np.inf


@pytest.mark.parametrize("samples", [0, 1, 3])
def test_a_delay_multiplies_the_response_by_a_power_of_z(samples: int) -> None:
    held = discretise.zero_order_hold(random_model(7), T)
    late = discretise.delay_samples(held, samples)
    z = np.exp(1j * np.array([0.1, 1.0, 3.0]))
    np.testing.assert_allclose(
        late.response(z), held.response(z) * z[:, None, None] ** -samples, rtol=1e3 * tolerances.of("double")
    )
    assert late.states[len(held.states) :] == tuple(f"{u}_late{k + 1}" for k in range(samples) for u in held.inputs)


def random_case(seed: int, spread: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """F, W >= 0 of low rank and the scaling D^-1 F D, D W D with D of different powers of 10."""
    rng = np.random.default_rng(seed)
    n = int(rng.integers(1, 7))
    F, root = rng.normal(size=(n, n)) * 10.0 ** rng.uniform(-1, 2), rng.normal(size=(n, int(rng.integers(1, n + 1))))
    D = 10.0 ** rng.uniform(-spread, spread, n)
    W = root @ root.T * D * D[:, None]
    return F * D / D[:, None], (W + W.T) / 2, D


def off(computed: np.ndarray, exact: np.ndarray, D: np.ndarray) -> float:
    """The largest error of a quadratic form over its largest entry, both in the units before scaling."""
    computed, exact = (v / D / D[:, None] for v in (computed, exact))
    return float(np.abs(computed - exact).max() / np.abs(exact).max())


@settings(derandomize=True, max_examples=10, deadline=None)
@given(st.integers(0, 10**6), st.sampled_from([0.0, 3.0, 6.0]), st.floats(1e-4, 0.3))
def test_gramian_over_a_period_agrees_with_sixty_digits(seed: int, spread: float, period_s: float) -> None:
    F, W, D = random_case(seed, spread)
    propagation = discretise.gramian(F, W, period_s)
    with mpmath.workdps(60):
        flow, integral = reference_gains.gramian(mpmath.matrix(F.tolist()), mpmath.matrix(W.tolist()), period_s)
    flow, integral = (np.array(v.tolist(), dtype=np.float64) for v in (flow, integral))
    growth = max(1.0, np.abs(F * D[:, None] / D).sum(axis=1).max() * period_s)
    assert off(propagation.W, integral, D) <= tolerances.of("folded") * growth
    M, E = propagation.M * D[:, None] / D, flow * D[:, None] / D
    assert np.abs(M - E).max() <= tolerances.of("folded") * growth * max(1.0, np.abs(E).max())
    np.testing.assert_array_equal(propagation.W, propagation.W.T)
    values = np.linalg.eigvalsh(propagation.W / D / D[:, None])
    assert values[0] >= -tolerances.of("folded") * values[-1]


def test_gramian_over_a_period_agrees_with_quadrature() -> None:
    F, W, _ = random_case(3, 0.0)
    nodes, weights = np.polynomial.legendre.leggauss(24)
    flows = [scipy.linalg.expm(F * T / 2 * (v + 1)) for v in nodes]
    integral = T / 2 * sum(w * M.T @ W @ M for w, M in zip(weights, flows, strict=True))
    propagation = discretise.gramian(F, W, T)
    np.testing.assert_allclose(
        propagation.W, integral, rtol=0, atol=tolerances.of("quadrature") * np.abs(integral).max()
    )
    np.testing.assert_allclose(propagation.M, scipy.linalg.expm(F * T), rtol=0, atol=tolerances.of("double"))
    transposed = discretise.gramian(F.T, W, T).W  # a different integral unless F is symmetric
    assert np.abs(transposed - integral).max() > 1e-3 * np.abs(integral).max()


def test_a_slow_mode_beside_a_fast_one_keeps_its_digits() -> None:
    """Modes a_i: W_ij = (exp((a_i + a_j) T) - 1) / (a_i + a_j); one block exponential in double overflows."""
    a, period_s = np.array([-1e6, -1e-3, 1e-3, -40.0]), 1.0
    propagation = discretise.gramian(np.diag(a), np.ones((4, 4)), period_s)
    rate = a + a[:, None]
    known = np.where(rate == 0, period_s, np.expm1(rate * period_s) / np.where(rate == 0, 1, rate))
    np.testing.assert_allclose(propagation.W, known, rtol=tolerances.of("folded"))
    np.testing.assert_allclose(np.diag(propagation.M)[1:3], np.exp(a[1:3]), rtol=tolerances.of("folded"))
    with np.errstate(all="ignore"):
        block = scipy.linalg.expm(np.block([[-np.diag(a), np.ones((4, 4))], [np.zeros((4, 4)), np.diag(a)]]))
        assert not np.isfinite(block).all()


def test_decayed_modes_keep_their_relative_precision() -> None:
    propagation = discretise.gramian(np.diag([-300.0, -200.0]), np.eye(2), 1.0)
    np.testing.assert_allclose(np.diag(propagation.M), np.exp([-300.0, -200.0]), rtol=1e3 * tolerances.of("folded"))


def test_the_gramian_of_a_chain_of_integrators_has_its_closed_form() -> None:
    """x_i' = x_i+1 with a cost of x_1: W_ij = T^(i+j+1) / (i! j! (i+j+1)), from 0."""
    n = 5
    W, i = np.zeros((n, n)), np.arange(n)
    W[0, 0] = 1
    propagation = discretise.gramian(np.diag(np.ones(n - 1), 1), W, T)
    factorial = np.array([1.0, 1, 2, 6, 24])
    known = T ** (i + i[:, None] + 1) / (factorial * factorial[:, None] * (i + i[:, None] + 1))
    np.testing.assert_allclose(propagation.W, known, rtol=1e2 * tolerances.of("last_bit"))
    np.testing.assert_allclose(propagation.M, scipy.linalg.expm(np.diag(np.ones(n - 1), 1) * T), rtol=1e-14, atol=1e-25)


def test_the_gramian_is_zero_without_weight_or_without_states() -> None:
    still = discretise.gramian(np.zeros((2, 2)), np.eye(2), T)
    np.testing.assert_array_equal(still.M, np.eye(2))
    np.testing.assert_array_equal(still.W, T * np.eye(2))
    assert not discretise.gramian([[1.0]], [[0.0]], T).W.any()


def test_sampling_and_delay_carry_units() -> None:
    units = {"x": "m", "v": "m/s", "f": "N", "y": "m"}
    c = StateSpace([[0, 1], [0, 0]], [[0], [1]], [[1, 0]], [[0]], ("x", "v"), ("f",), ("y",), Continuous(), units)
    late = discretise.delay_samples(discretise.zero_order_hold(c, T), 2)
    assert late.units == {**units, "f_late1": "N", "f_late2": "N"}


def test_models_without_states_are_sampled_without_warnings(capfd: pytest.CaptureFixture[str]) -> None:
    empty = np.zeros((0, 0))
    assert discretise.gramian(empty, empty, 0.1).W.shape == (0, 0)
    assert discretise.balancing(empty).shape == (0,)
    assert capfd.readouterr() == ("", "")  # LAPACK prints illegal values itself


def test_periods_and_arrays_are_accepted_or_refused() -> None:
    single = discretise.zero_order_hold(([[0.0]], [[1.0]]), np.float32(0.5))
    assert single.B == 0.5 and type(single.time.period_s) is float
    with pytest.raises(SignalError, match="they are complex"):
        discretise.first_order_hold([[1j]], [[1.0]], 0.1)
    with pytest.raises(SignalError, match=r"A is \(1, 1\) and B is \(2, 1\): give B 1 rows"):
        discretise.first_order_hold([[1.0]], [[1.0], [1.0]], 0.1)
    with pytest.raises(TimingError, match=r"`samples` of .* is 1\.5: give a whole number"):
        discretise.delay_samples(([[1.0]], [[1.0]], Discrete(0.1)), 1.5)


@pytest.mark.parametrize("horizon", [0.3, 0.8, 1.5, 10.0])
def test_the_integral_of_a_weight_that_does_not_see_a_growing_mode(horizon: float) -> None:
    """Of x'' = 400 x the row c sees exp(-20 t) alone: W = (1 - exp(-40 T)) / 40 c'c."""
    A, c = np.array([[0.0, 1.0], [400.0, 0.0]]), np.array([[20.0, -1.0]])
    W = discretise.gramian(A, c.T @ c, horizon).W
    np.testing.assert_allclose(W, (1 - np.exp(-40 * horizon)) / 40 * c.T @ c, rtol=1e-13)


def full_model(seed: int) -> StateSpace:
    rng = np.random.default_rng(seed)
    n, m, p = rng.integers(1, 6), rng.integers(1, 4), rng.integers(1, 4)
    A, B, C, D = (rng.normal(size=shape) for shape in ((n, n), (n, m), (p, n), (p, m)))
    return StateSpace(
        30 * A, B, C, D, *(tuple(f"{k}{i}" for i in range(c)) for k, c in (("x", n), ("u", m), ("y", p))), Continuous()
    )


def assert_same(ours: StateSpace, theirs: StateSpace, tolerance: float) -> None:
    for M, N in ((ours.A, theirs.A), (ours.B, theirs.B), (ours.C, theirs.C), (ours.D, theirs.D)):
        np.testing.assert_allclose(M, N, rtol=0, atol=tolerance * max(1.0, np.abs(N).max(initial=0.0)))


@settings(derandomize=True, max_examples=15, deadline=None)
@given(st.integers(0, 10**6), st.sampled_from([0.0, 5.0, 100.0]))
def test_the_trapezoidal_rule_is_that_of_python_control_and_has_its_inverse(seed: int, w: float) -> None:
    c = full_model(seed)
    ours = discretise.tustin(c, T, w)
    theirs = control.c2d(c.to_control(), T, "bilinear", **({"prewarp_frequency": w} if w else {}))
    assert_same(ours, of(theirs), 1e3 * tolerances.of("double"))
    np.testing.assert_allclose(ours.response(np.exp(1j * w * T)), c.response(1j * w), rtol=tolerances.of("frequency"))
    assert_same(discretise.inverse_tustin(ours, w), c, 1e3 * tolerances.of("double"))
    assert (ours.states, ours.inputs, ours.outputs, ours.time) == (c.states, c.inputs, c.outputs, Discrete(T))


@settings(derandomize=True, max_examples=15, deadline=None)
@given(st.integers(0, 10**6))
def test_a_zero_order_hold_has_its_inverse(seed: int) -> None:
    c = full_model(seed)
    c = replace(c, A=c.A * min(1.0, 2.5 / T / np.abs(c.poles).max()))  # no mode beyond the Nyquist frequency
    held = discretise.zero_order_hold(c, T)
    back = discretise.inverse_zero_order_hold(held)
    log = scipy.linalg.logm(np.block([[held.A, held.B], [np.zeros_like(held.B.T), np.eye(held.B.shape[1])]])) / T
    assert_same(back, c, 1e3 * tolerances.of("double"))
    np.testing.assert_allclose(back.A, log[: len(c.A), : len(c.A)], rtol=0, atol=1e-9 * np.abs(log).max())
    resampled = discretise.zero_order_hold(back, T / 3)
    assert_same(resampled, discretise.zero_order_hold(c, T / 3), 1e3 * tolerances.of("double"))


@pytest.mark.parametrize("units", [1.0, 1e6])
def test_a_defective_model_in_any_units_comes_back_from_its_hold(units: float) -> None:
    """Three integrators and a mode of 1 in 10,000 samples, in states that differ by 10^6 in size."""
    D = units ** np.array([0.0, 1.0, 0.0, 0.0, 1.0])
    c = model(D[:, None] * scipy.linalg.block_diag(np.eye(3, k=1), [[0.0, 1.0], [-400.0, -1.0]]) / D, np.ones((5, 1)))
    back = discretise.inverse_zero_order_hold(discretise.zero_order_hold(c, 5e-5))
    np.testing.assert_allclose(back.A, c.A, rtol=1e-9, atol=1e-9 * units)
    np.testing.assert_allclose(back.B, c.B, rtol=1e-9)


def test_a_model_without_states_or_inputs_or_outputs_is_sampled_both_ways() -> None:
    gain = StateSpace(np.zeros((0, 0)), np.zeros((0, 1)), np.zeros((1, 0)), [[2.0]], (), ("u",), ("y",), Continuous())
    alone = StateSpace([[-1.0]], np.zeros((1, 0)), [[1.0]], np.zeros((1, 0)), ("x",), (), ("y",), Continuous())
    blind = StateSpace([[-1.0]], [[1.0]], np.zeros((0, 1)), np.zeros((0, 1)), ("x",), ("u",), (), Continuous())
    for c in (gain, alone, blind):
        assert_same(discretise.inverse_tustin(discretise.tustin(c, T)), c, tolerances.of("double"))
        assert_same(discretise.inverse_zero_order_hold(discretise.zero_order_hold(c, T)), c, tolerances.of("double"))
