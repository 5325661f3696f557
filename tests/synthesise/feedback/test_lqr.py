"""Gains against a published table, costs against simulation, and the cross term of the held cost."""

from dataclasses import replace

import control
import numpy as np
import pytest
import scipy.linalg
from hypothesis import given, settings
from hypothesis import strategies as st

from synth.errors import ModelError, SignalError, TimingError
from synth.statespace import StateSpace
from synth.synthesise.feedback import lqr, weights
from synth.synthesise.servo import internal_model
from synth.timing import Continuous, Discrete
from tests import tolerances

OMEGA0 = 1.5 * np.pi
# The poles are printed in the paper; weights and gains are recomputed from them: (Q, K, poles, decimals of the poles)
PUBLISHED = {
    "y": (
        (3e4, 3e4, 2.5e9, 2.5e7, 2.5e7),
        ("-1699.7", "-182.75", "-50000", "2725.5", "-7806.8"),
        (-173.2, -2.61 + 5.48j, -2.61 - 5.48j, -2.16 + 1.77j, -2.16 - 1.77j),
        (1, 2, 2, 2, 2),
    ),
    "x, z": (
        (1500, 1500, 4.5e8, 2.25e6, 2.25e6),
        ("-525.33", "-50.504", "-21213", "-1253.6", "-2742.2"),
        (-38.73, -3.2 + 5.89j, -3.2 - 5.89j, -2.69 + 2.23j, -2.69 - 2.23j),
        (2, 1, 1, 2, 2),
    ),
    "theta": (
        (4e4, 4e4, 4e9, 4e7, 4e7),
        ("-2050.0", "-210.00", "-63246", "1910.6", "-9901.3"),
        (-200, -2.81 + 5.58j, -2.81 - 5.58j, -2.19 + 1.82j, -2.19 - 1.82j),
        (0, 2, 2, 2, 2),
    ),
}


def model(A: object, B: object) -> StateSpace:
    A, B = np.atleast_2d(np.asarray(A, float)), np.atleast_2d(np.asarray(B, float))
    states, inputs = tuple(f"x{i}" for i in range(len(A))), tuple(f"u{i}" for i in range(B.shape[1]))
    return StateSpace(A, B, np.eye(len(A)), np.zeros(B.shape), states, inputs, states, Continuous())


def axis() -> StateSpace:
    """A double integrator with the internal model of 0 and OMEGA0, states (e, de, xi1, xi2, xi3)."""
    double = StateSpace([[0, 1], [0, 0]], [[0], [1]], [[1, 0]], [[0]], ("e", "de"), ("w",), ("e",), Continuous())
    return internal_model.augmented(double, (0.0, OMEGA0))


NAMES = ("x", "y", "phi", "d", "f", "v")
UNITS = {"x": "m", "y": "m", "phi": "rad", "d": "m/s", "f": "m/s", "v": "rad/s", "i_A": "A", "i_B": "A", "i_C": "A"}


def positioner() -> StateSpace:
    """Y(26): three masses of a planar stage on three currents, with the integrals of the positions, Y(31)."""
    A = np.block([[np.zeros((3, 3)), np.eye(3)], [np.zeros((3, 6))]])
    B = np.vstack([np.zeros((3, 3)), [[0, 0, 13.2547], [13.2547, 13.2547, 0], [-117.15, 117.15, 0]]])
    C, inputs = np.eye(3, 6), ("i_A", "i_B", "i_C")
    plant = StateSpace(A, B, C, np.zeros((3, 3)), NAMES, inputs, NAMES[:3], Continuous(), UNITS)
    return lqr.integral(plant, NAMES[:3])


# Y(49) with its decimals, columns x y phi, their integrals, d f v; u = -K x.
PRINTED_GAIN = (
    ("0", "507.24", "-472.64", "0", "19975", "-41394", "0", "6.4304", "-2.6962"),
    ("0", "507.24", "472.64", "0", "19975", "41394", "0", "6.4304", "2.6962"),
    ("1757.55", "0", "0", "84872", "0", "0", "18.1556", "0", "0"),
)
# In the same order: what gives the print, and what is printed beside it, Y(47).
USED, STATED = (
    (1e4, 1e3, 1e3, 1e10, 1e9, 1e10, 1e2, 1e1, 2e1),
    (1e3, 1e4, 1e3, 1e9, 1e8, 1e8, 1e2, 1e2, 1e2),
)


def printed_gain(Q: tuple[float, ...], exact: bool = False) -> np.ndarray:
    """-K at 800 Hz for weights in the order of the print."""
    model = positioner()
    order = (*NAMES[:3], *(f"{name}_integral" for name in NAMES[:3]), *NAMES[3:])
    found = lqr.lqrd(model, dict(zip(order, Q, strict=True)), np.eye(3), 1 / 800, exact=exact)
    return -found.K[:, [model.states.index(name) for name in order]]


@pytest.mark.parametrize("exact", [False, True])
def test_the_planar_positioners_gain_comes_out_to_the_printed_digits(exact: bool) -> None:
    """Y-10: nine gains, each within 1.3e-5; figures printed with five digits or six."""
    found = printed_gain(USED, exact)
    for row, texts in zip(found, PRINTED_GAIN, strict=True):
        for value, text in zip(row, texts, strict=True):
            assert value == pytest.approx(float(text), rel=1.4e-5, abs=1e-6)
    continuous = lqr.lqr(positioner(), np.ones(9), np.eye(3)).K
    assert continuous.shape == found.shape
    assert abs(printed_gain((1e4, *USED[1:-1], 2.2e1))[0, 8] / float(PRINTED_GAIN[0][8]) - 1) > 1e-4


def test_the_weights_printed_beside_it_give_another_gain() -> None:
    """Y-11."""
    found = printed_gain(STATED)
    known = [[316.06, 6140.1, 7.8274], [144.24, 3124.6, 3.3136], [898.22, 27793, 14.500]]
    rows = [found[1, [1, 4, 7]], found[1, [2, 5, 8]], found[2, [0, 3, 6]]]
    np.testing.assert_allclose(rows, known, rtol=6e-5)


def test_the_gain_in_double_precision_is_that_of_ball_arithmetic() -> None:
    double, exact = (lqr.lqrd(positioner(), USED_BY_NAME, np.eye(3), 1 / 800, exact=e) for e in (False, True))
    np.testing.assert_allclose(double.K, exact.K, rtol=0, atol=tolerances.of("folded") * np.abs(exact.K).max())
    assert double.certificate.residual < 1e-12 and exact.certificate.forward_error <= tolerances.of("half_bit")


USED_BY_NAME = dict(zip((*NAMES[:3], *(f"{n}_integral" for n in NAMES[:3]), *NAMES[3:]), USED, strict=True))


def test_integrals_are_states_with_names_and_units() -> None:
    model = positioner()
    assert model.states == (*NAMES, "x_integral", "y_integral", "phi_integral")
    assert [model.units[f"{n}_integral"] for n in ("x", "phi")] == ["m s", "rad s"]
    s = np.array([2j, 30j])
    there = model.response(s)
    np.testing.assert_allclose(there[:, 3:], there[:, :3] / s[:, None, None], rtol=tolerances.of("double"))


def test_sampled_integrals_are_sums_and_units_cancel() -> None:
    units = {"v": "m/s", "n": "1", "a": "m/s^2"}
    plant = StateSpace(
        np.diag([0.5, 0.2]),
        [[1], [1]],
        [[1, 0], [0, 1], [1, 1]],
        [[0], [3], [0]],
        ("p", "q"),
        ("u",),
        ("v", "n", "a"),
        Discrete(0.1),
        units,
    )
    held = lqr.integral(plant, ("n", "v", "a"))
    z = np.exp(1j * np.array([0.2, 2.0]))
    there = held.response(z)
    np.testing.assert_allclose(
        there[:, 3:], 0.1 / (z[:, None, None] - 1) * there[:, [1, 0, 2]], rtol=tolerances.of("double")
    )
    assert [held.units[f"{n}_integral"] for n in ("v", "n", "a")] == ["m", "s", "m/s^2 s"]
    with pytest.raises(SignalError, match="a name stands twice among the outputs n, n"):
        lqr.integral(plant, ("n", "n"))
    with pytest.raises(SignalError, match="'z' is not one of v, n, a"):
        lqr.integral(plant, ("z",))


def test_weights_on_outputs_count_what_the_input_adds() -> None:
    rng = np.random.default_rng(5)
    A, B, C, D = (rng.normal(size=shape) for shape in ((3, 3), (3, 2), (2, 3), (2, 2)))
    found = weights.output_weighted((A, B, C, D), [2.0, 5.0], np.diag([0.0, 1.0]))
    x, u = rng.normal(size=3), rng.normal(size=2)
    y = C @ x + D @ u
    told = x @ found.Q @ x + u @ found.R @ u + 2 * x @ found.N @ u
    assert told == pytest.approx(y @ np.diag([2.0, 5.0]) @ y + u[1] ** 2, rel=tolerances.of("double"))
    gain = lqr.lqr((A, B, C, D), found.Q, found.R, found.N)
    K, *_ = control.lqr(A, B, found.Q, found.R, found.N, method="scipy")
    np.testing.assert_allclose(gain.K, -K, rtol=0, atol=tolerances.of("pencil") * np.abs(K).max())
    assert np.abs(lqr.lqr((A, B, C, D), found.Q, found.R).K + K).max() > 1e-3  # the cross weight counts
    assert "[Q, N; N', R]" in repr(found)


def test_dlqr_is_for_sampled_models_alone() -> None:
    c, Q, R = random_problem(2)
    held = lqr.sampled_cost(c, Q, R, 0.1).model
    K, *_ = control.dlqr(held.A, held.B, Q, R, method="scipy")
    np.testing.assert_allclose(lqr.dlqr(held, Q, R).K, -K, rtol=tolerances.of("pencil"))
    np.testing.assert_array_equal(lqr.dlqr(held.to_control(), Q, R).K, lqr.dlqr(held, Q, R).K)
    with pytest.raises(TimingError, match=r"this one is continuous: use lqrd with the period"):
        lqr.dlqr(c, Q, R)


def test_arrays_are_read_and_results_print_names_and_units() -> None:
    c, Q, R = random_problem(2)
    np.testing.assert_array_equal(lqr.lqrd((c.A, c.B), Q, R, 0.1).K, lqr.lqrd(c, Q, R, 0.1).K)
    found = lqr.lqrd(positioner(), USED_BY_NAME, np.eye(3), 1 / 800)
    assert found.units["phi_integral"] == "rad s"
    text = repr(found)
    assert text.startswith("Optimal gain u = K x in discrete time of 0.00125 s: 3 inputs, 9 states\nresidual ")
    assert "phi_integral [rad s]" in text and "i_A [A]" in text and "-507.2" in text and "pole, z" in text
    assert "Cost over one period" in repr(lqr.sampled_cost(c, Q, R, 0.1))


def random_problem(seed: int) -> tuple[StateSpace, np.ndarray, np.ndarray]:
    rng = np.random.default_rng(seed)
    n, m = rng.integers(2, 4), rng.integers(1, 3)
    C = rng.normal(size=(n, n))
    return (
        model(rng.normal(size=(n, n)), rng.normal(size=(n, m))),
        C @ C.T + 0.1 * np.eye(n),
        np.diag(rng.uniform(1, 3, m)),
    )


@pytest.mark.parametrize("name", PUBLISHED)
def test_the_published_gains_and_poles_come_out_to_the_printed_digits(name: str) -> None:
    Q, printed, poles, decimals = PUBLISHED[name]
    found = lqr.lqr(axis(), np.diag(Q), [[1.0]])
    for value, text in zip(found.K[0], printed, strict=True):
        last = 10.0 ** -(len(text.split(".")[1]) if "." in text else 0)
        assert abs(value - float(text)) <= tolerances.of("print_K") * last
    for pole, places in zip(poles, decimals, strict=True):
        nearest = min(found.poles, key=lambda s: abs(s - pole))
        off = max(abs(nearest.real - pole.real), abs(nearest.imag - pole.imag))
        assert off <= tolerances.of("print_K") * 10.0**-places * (1 + 1e-9)
    detuned = lqr.lqr(axis(), np.diag(Q) * 1.01, [[1.0]])
    assert abs(detuned.K[0, 0] - float(printed[0])) > tolerances.of("print_K")


def test_the_sign_is_inside_the_gain_and_the_fields_say_what_was_minimised() -> None:
    c, Q, R = random_problem(2)
    found = lqr.lqr(c, Q, R)
    K, *_ = control.lqr(c.A, c.B, Q, R, method="scipy")
    np.testing.assert_allclose(found.K, -K, rtol=tolerances.of("pencil"))
    np.testing.assert_allclose(np.linalg.eigvals(c.A + c.B @ found.K).real.max(), found.poles.real.max(), rtol=1e-9)
    np.testing.assert_array_equal(found.Q, Q)
    np.testing.assert_array_equal(found.N, np.zeros(c.B.shape))
    assert (found.states, found.inputs, found.time) == (c.states, c.inputs, Continuous())


@settings(derandomize=True, max_examples=10, deadline=None)
@given(st.integers(0, 10**6), st.floats(0.01, 0.5))
def test_the_held_cost_agrees_with_quadrature(seed: int, T: float) -> None:
    c, Q, R = random_problem(seed)
    n, m = c.B.shape
    F, weight = np.block([[c.A, c.B], [np.zeros((m, n + m))]]), scipy.linalg.block_diag(Q, R)

    nodes, weights = np.polynomial.legendre.leggauss(20)
    flows = [scipy.linalg.expm(F * T / 2 * (v + 1)) for v in nodes]
    W = T / 2 * sum(w * M.T @ weight @ M for w, M in zip(weights, flows, strict=True))
    cost = lqr.sampled_cost(c, Q, R, T)
    ours = np.block([[cost.Q, cost.N], [cost.N.T, cost.R]])
    np.testing.assert_allclose(ours, W, rtol=0, atol=tolerances.of("quadrature") * np.abs(W).max())
    assert np.abs(cost.N).max() > 1e-6 * np.abs(W).max()  # a cross term where Q and R have none


@pytest.mark.parametrize("exact", [False, True])
def test_the_held_cost_of_an_integrator_is_its_closed_form(exact: bool) -> None:
    """x' = u, Q = R = 1: W = [[T, T^2/2], [T^2/2, T + T^3/3]]."""
    T = 0.5
    cost = lqr.sampled_cost(model([[0]], [[1]]), [[1]], [[1]], T, exact=exact)
    assert (cost.Q[0, 0], cost.N[0, 0], cost.R[0, 0]) == (T, T * T / 2, T + T**3 / 3)


@pytest.mark.parametrize("a", [-30.0, -300.0])
def test_the_held_cost_of_a_fast_mode_keeps_its_digits(a: float) -> None:
    """x' = a x + u over 1 s: int exp(2 a t) dt; the exponentials inside reach exp(300)."""
    for exact, few in ((True, 1e-15), (False, tolerances.of("folded"))):
        cost = lqr.sampled_cost(model([[a]], [[1]]), [[1]], [[1]], 1.0, exact=exact)
        assert cost.Q[0, 0] == pytest.approx(np.expm1(2 * a) / (2 * a), rel=few)


def simulated_cost(c: StateSpace, K: np.ndarray, Q: np.ndarray, R: np.ndarray, T: float, x: np.ndarray) -> float:
    """The continuous cost of u = K x, held over T, by Gauss quadrature of the flow inside each period."""
    n, m = c.B.shape
    F = np.block([[c.A, c.B], [np.zeros((m, n + m))]])
    nodes, weights = np.polynomial.legendre.leggauss(8)
    flows = [scipy.linalg.expm(F * T * (v + 1) / 2)[:n] for v in nodes]
    over, total = scipy.linalg.expm(F * T)[:n], 0.0
    for _ in range(4000):
        u = K @ x
        inside = [flow @ np.concatenate([x, u]) for flow in flows]
        total += T * (u @ R @ u) + T / 2 * sum(w * (v @ Q @ v) for w, v in zip(weights, inside, strict=True))
        x = over @ np.concatenate([x, u])
        if np.abs(x).max() < 1e-12:
            break
    return float(total)


def simulated_form(c: StateSpace, K: np.ndarray, Q: np.ndarray, R: np.ndarray, T: float) -> np.ndarray:
    """The matrix of the cost as a quadratic form of the start, from starts e_i + e_j."""
    E = np.eye(len(c.A))
    cost = [[simulated_cost(c, K, Q, R, T, a + b) for a in E] for b in E]
    single = np.diag(cost) / 4
    return (np.array(cost) - single[:, None] - single) / 2


def test_a_continuous_cross_weight_is_held_too() -> None:
    """x' = u with 2 n x u beside Q = R = 1: W = [[T, T^2/2 + n T], [., T + T^3/3 + n T^2]]."""
    T, n = 0.5, 0.25
    cost = lqr.sampled_cost(model([[0]], [[1]]), [[1]], [[1]], T, [[n]])
    np.testing.assert_allclose(cost.N, [[T * T / 2 + n * T]], rtol=tolerances.of("double"))
    np.testing.assert_allclose(cost.R, [[T + T**3 / 3 + n * T * T]], rtol=tolerances.of("double"))
    c, Q, R = random_problem(6)
    N = 0.1 * np.ones(c.B.shape)
    fast, limit = lqr.lqrd(c, Q, R, 1e-5, N).K, lqr.lqr(c, Q, R, N).K
    assert np.abs(fast - limit).max() < 0.1 * np.abs(lqr.lqr(c, Q, R).K - limit).max()


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_the_simulated_cost_is_that_of_the_riccati_solution(seed: int) -> None:
    c, Q, R = random_problem(seed)
    T, x = 0.3, np.ones(len(c.A))
    found = lqr.lqrd(c, Q, R, T)
    told = x @ found.certificate.X @ x
    assert found.time == Discrete(T)
    assert simulated_cost(c, found.K, Q, R, T, x) == pytest.approx(told, rel=tolerances.of("quadrature"))
    cost = lqr.sampled_cost(c, Q, R, T)
    crossless = lqr.lqr(cost.model, cost.Q, cost.R)
    assert simulated_cost(c, crossless.K, Q, R, T, x) > told * (1 + 1e-4)
    assert abs(x @ crossless.certificate.X @ x / told - 1) > 1e-3


def test_a_short_period_gives_the_continuous_gain() -> None:
    c, Q, R = random_problem(4)
    slow, fast, limit = lqr.lqrd(c, Q, R, 1e-3).K, lqr.lqrd(c, Q, R, 1e-5).K, lqr.lqr(c, Q, R).K
    assert np.abs(fast - limit).max() < 0.02 * np.abs(slow - limit).max() < 0.02 * np.abs(limit).max()


def test_the_cost_ratio_is_that_of_the_worst_start() -> None:
    c, Q, R = random_problem(3)
    T, gain = 0.3, lqr.lqr(c, Q, R)
    ratio, best = lqr.cost_ratio(c, gain, Q, R, T), lqr.lqrd(c, Q, R, T)
    costs = [simulated_form(c, K, Q, R, T) for K in (gain.K, best.K)]
    assert ratio == pytest.approx(scipy.linalg.eigh(*costs, eigvals_only=True)[-1], rel=tolerances.of("ode"))
    assert ratio > 1.01
    assert lqr.cost_ratio(c, best, Q, R, T) == pytest.approx(1, abs=tolerances.of("pencil"))


def test_a_gain_that_is_unstable_when_held_costs_without_bound() -> None:
    c = model([[0, 1], [0, 0]], [[0], [1]])
    Q, R = np.diag([1e6, 1.0]), np.eye(1)
    assert lqr.cost_ratio(c, lqr.lqr(c, Q, R), Q, R, 0.1) == np.inf
    assert lqr.cost_ratio(c, lqr.lqr(c, Q, R), Q, R, 1e-3) < 1.1


def test_a_state_that_costs_nothing_is_left_aside() -> None:
    c, Q, R = model(np.diag([-1.0, -2.0]), [[1], [0]]), np.diag([1.0, 0.0]), np.eye(1)
    assert lqr.cost_ratio(c, lqr.lqr(c, Q, R), Q, R, 0.1) == pytest.approx(1, abs=1e-2)


def test_what_is_no_cost_or_no_continuous_model_is_refused() -> None:
    c, Q, R = random_problem(1)
    with pytest.raises(TimingError, match="continuous"):
        lqr.lqrd(lqr.sampled_cost(c, Q, R, 0.1).model, Q, R, 0.1)
    lopsided = Q.copy()
    lopsided[0, 1] += 1
    with pytest.raises(SignalError, match="Q is not symmetric"):
        lqr.lqrd(c, lopsided, R, 0.1)
    with pytest.raises(SignalError, match="matrix R is"):
        lqr.lqrd(c, Q, np.eye(len(R) + 1), 0.1)


OSCILLATOR = ([[0, 1], [-1, 0]], [[0], [1]])


def test_the_gain_of_another_model_is_refused() -> None:
    """Of one state it would be added to each of two."""
    c = ([[0, 1], [0, 0]], [[0], [1]])
    other = lqr.lqr(([[1.0]], [[1.0]]), [1], [1])
    with pytest.raises(SignalError, match="the gain is from x1 to u1, the model has the states x1, x2"):
        lqr.cost_ratio(c, other, [1, 1], [1], 0.1)
    right = lqr.lqr(c, [1, 1], [1])
    with pytest.raises(SignalError, match="the gain is from b, a to u1"):
        lqr.cost_ratio(c, replace(right, states=("b", "a")), [1, 1], [1], 0.1)
    for K in (np.ones((1, 1)), np.full((1, 2), np.nan)):
        with pytest.raises(SignalError, match=r"the gain K is .*: this model needs a finite one of \(1, 2\)"):
            lqr.cost_ratio(c, replace(right, K=K), [1, 1], [1], 0.1)


def test_a_cost_of_zero_is_compared_with_nothing() -> None:
    c = ([[-1.0]], [[1.0]])
    with pytest.raises(ModelError, match="the optimal cost is zero from every state"):
        lqr.cost_ratio(c, lqr.lqr(c, [0], [1]), [0], [1], 0.1)


@pytest.mark.filterwarnings("error")
def test_the_cost_ratio_does_not_hang_on_units() -> None:
    """A double integrator, and one whose states are in units over twelve decades."""
    A, B, q = np.array([[0, 1.0], [0, 0]]), np.array([[0], [1.0]]), np.array([1.0, 1.0])
    plain = lqr.cost_ratio((A, B), lqr.lqr((A, B), q, [1]), q, [1], 0.3)
    d = np.array([1e-6, 1e6])
    c = (A * d / d[:, None], B / d[:, None])
    assert plain > 1.01
    assert lqr.cost_ratio(c, lqr.lqr(c, q * d * d, [1]), q * d * d, [1], 0.3) == pytest.approx(plain, rel=1e-8)


def test_a_period_at_which_modes_look_alike_is_told() -> None:
    """An oscillator of 1 rad/s seen every half turn: z = -1 twice, and the input moves one of them."""
    for period in (np.pi, 2 * np.pi):
        with pytest.raises(ModelError, match=r"held over .* take another period, best a shorter one, below 3.142 s"):
            lqr.lqrd(OSCILLATOR, [1, 1], [1], period)
    assert np.abs(lqr.lqrd(OSCILLATOR, [1, 1], [1], 3.0).poles).max() < 1
    with pytest.raises(ModelError, match="actuate x2 or take it out"):  # no period mends this
        lqr.lqrd(([[-1, 0], [0, 1]], [[1], [0]]), [1, 1], [1], 0.1)


@pytest.mark.parametrize("period", ["a", None, 1j, np.array([0.1]), True, 0.0, np.nan])
def test_a_period_is_a_positive_number(period: float) -> None:
    with pytest.raises(TimingError, match=r"the sample period is|`period_s` of .*: give a number of seconds"):
        lqr.lqrd(OSCILLATOR, [1, 1], [1], period)
    with pytest.raises(TimingError, match=r"the sample period is|`period_s` of .*: give a number of seconds"):
        lqr.cost_ratio(OSCILLATOR, lqr.lqr(OSCILLATOR, [1, 1], [1]), [1, 1], [1], period)
