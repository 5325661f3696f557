"""Reduced-order filters against closed forms, SciPy's full-order filter, Lyapunov equations and simulated noise."""

from dataclasses import replace

import numpy as np
import pytest
import scipy.linalg
from hypothesis import given, settings
from hypothesis import strategies as st

from synth.analyse import discretise
from synth.errors import ModelError, SignalError
from synth.statespace import Array, StateSpace
from synth.synthesise.observers import reduced_noise, reduced_observer
from synth.synthesise.observers.reduced_observer import ReducedObserver
from synth.timing import Continuous, Discrete, Time
from tests import tolerances

T = 1 / 800
CART = StateSpace([[0, 1], [0, 0]], [[0], [13]], [[1, 0]], [[0]], ("x", "v"), ("i",), ("x",), Continuous())
HELD = discretise.zero_order_hold(CART, T)
GATHERED = discretise.gramian(CART.A.T, np.diag([0, 1.0]), T).W  # of an acceleration of density 1 m^2/s^3


def noisy(seed: int, n: int = 4, p: int = 2, time: Time | None = None) -> tuple[StateSpace, Array, Array]:
    """Return a stable model with full W and V."""
    rng = np.random.default_rng(seed)
    A, B, C = rng.normal(size=(n, n)), rng.normal(size=(n, 1)), rng.normal(size=(p, n))
    g, h = rng.normal(size=(n, n + 1)), rng.normal(size=(p, p + 1))
    labels = [tuple(f"{letter}{i}" for i in range(k)) for letter, k in (("x", n), ("u", 1), ("y", p))]
    A = 0.9 * A / np.abs(np.linalg.eigvals(A)).max()
    model = StateSpace(A, B, C, rng.normal(size=(p, 1)), *labels, time or Discrete(0.1))
    W, V = g @ g.T, h @ h.T
    return model, (W + W.T) / 2, (V + V.T) / 2


def noise_filter(observer: ReducedObserver) -> reduced_noise.Filter:
    assert isinstance(observer.certificate, reduced_noise.Filter)
    return observer.certificate


def after_sample(model: StateSpace, W: Array, V: Array) -> Array:
    """Return the covariance of x - x^ of the full-order filter that has used the sample of its own instant."""
    P = scipy.linalg.solve_discrete_are(model.A.T, model.C.T, W, V)
    return P - P @ model.C.T @ np.linalg.solve(model.C @ P @ model.C.T + V, model.C @ P)


def of_error(observer: ReducedObserver, W: Array, V: Array) -> Array:
    """Return the covariance (n, n) of x^ - x of plant and observer side by side, by one Lyapunov equation."""
    model, o = observer.model, observer.state_space()
    p, n, q = len(observer.measured_signals), len(model.A), len(observer.estimated_states)
    from_y, through = o.B[:, :p], o.D[:, :p]
    F = np.block([[model.A, np.zeros((n, q))], [from_y @ model.C, o.A]])
    G = np.block([[np.eye(n), np.zeros((n, p))], [np.zeros((q, n)), from_y]])
    joint = scipy.linalg.solve_discrete_lyapunov(F, G @ scipy.linalg.block_diag(W, V) @ G.T)
    E = np.hstack([through @ model.C - np.eye(n), o.C])
    return E @ joint @ E.T + through @ V @ through.T


def test_an_acceleration_gathered_over_the_period_puts_the_pole_at_root_3_minus_2() -> None:
    """With W = q [[T^3/3, T^2/2], [T^2/2, T]] the Riccati equation gives P = q T / (2 root 3), L = (3 - root 3) / T."""
    observer = reduced_observer.by_riccati(HELD, "x", GATHERED)
    np.testing.assert_allclose(observer.L, [[(3 - np.sqrt(3)) / T]], rtol=tolerances.of("double"))
    np.testing.assert_allclose(observer.poles, [np.sqrt(3) - 2], rtol=tolerances.of("settled"))
    np.testing.assert_allclose(
        noise_filter(observer).covariance, [[T / (2 * np.sqrt(3))]], rtol=tolerances.of("double")
    )


def test_noise_of_the_speed_alone_asks_for_the_whole_difference() -> None:
    """x+ - x = T v exactly: L = 1 / T, and what is left is the noise of one sample."""
    observer = reduced_observer.by_riccati(HELD, "x", {"v": 0.25})
    np.testing.assert_allclose(observer.L, [[1 / T]], rtol=tolerances.of("double"))
    assert noise_filter(observer).deviations["v"] == pytest.approx(0.5)


def test_a_continuous_filter_has_its_closed_form() -> None:
    """P = sqrt(w1 w2), L = sqrt(w2 / w1)."""
    observer = reduced_observer.by_riccati(CART, "x", {"x": 4e-6, "v": 9.0})
    np.testing.assert_allclose(observer.L, [[1500]], rtol=tolerances.of("double"))
    np.testing.assert_allclose(noise_filter(observer).covariance, [[6e-3]], rtol=tolerances.of("double"))


@pytest.mark.parametrize("seed", range(3))
def test_it_is_the_limit_of_the_full_order_filter_after_its_sample(seed: int) -> None:
    model, W, V = noisy(seed)
    observer = reduced_observer.by_riccati(model, model.outputs, W)
    part = observer.partition
    q = slice(len(model.outputs), None)
    off = []
    for small in (1e-4, 1e-6):
        full = part.M @ after_sample(model, W, small * V) @ part.M.T
        off.append(np.abs(full[q, q] - noise_filter(observer).covariance).max() / np.abs(full[q, q]).max())
    assert off[1] < 1e-4
    assert off[1] < 0.02 * off[0]  # in proportion to V


def test_before_its_sample_the_full_order_filter_knows_less() -> None:
    """The one-sample structure: the reduced filter is not the limit of the prediction."""
    P = scipy.linalg.solve_discrete_are(HELD.A.T, HELD.C.T, GATHERED, [[1e-20]])
    assert P[1, 1] > 3 * noise_filter(reduced_observer.by_riccati(HELD, "x", GATHERED)).covariance[0, 0]


@pytest.mark.parametrize("seed", range(3))
def test_a_continuous_filter_is_the_limit_of_the_full_order_one(seed: int) -> None:
    model, W, V = noisy(seed, time=Continuous())
    observer = reduced_observer.by_riccati(model, model.outputs, W)
    P = scipy.linalg.solve_continuous_are(model.A.T, model.C.T, W, 1e-8 * V)
    M = observer.partition.M
    np.testing.assert_allclose(
        (M @ P @ M.T)[2:, 2:], noise_filter(observer).covariance, rtol=1e-2, atol=1e-3 * np.abs(P).max()
    )


@given(seed=st.integers(0, 10**6), n=st.integers(2, 4), p=st.integers(1, 3))
@settings(derandomize=True, max_examples=20, deadline=None)
def test_the_covariance_stated_is_that_of_the_error_and_no_gain_nearby_has_less(seed: int, n: int, p: int) -> None:
    model, W, V = noisy(seed, n, min(p, n - 1))
    V = 0 * V
    observer = reduced_observer.by_riccati(model, model.outputs, W)
    result = noise_filter(observer)
    M, q = observer.partition.M, slice(len(model.outputs), None)
    transformed = M @ of_error(observer, W, V) @ M.T
    np.testing.assert_allclose(transformed[q, q], result.covariance, rtol=1e-7, atol=1e-9 * np.abs(transformed).max())
    weight = np.linalg.inv(result.covariance)
    rng = np.random.default_rng(seed)
    for _ in range(4):
        turn = 1e-3 * np.abs(observer.L).max() * rng.normal(size=observer.L.shape)
        near = reduced_observer.from_gain(model, model.outputs, observer.L + turn)
        cost = np.trace(weight @ (M @ of_error(near, W, V) @ M.T)[q, q])
        assert cost > np.trace(weight @ result.covariance) * (1 - tolerances.of("settled"))


def test_simulated_noise_leaves_the_variance_stated() -> None:
    """4,000 runs of 40 samples from rest, each step from the observer's own state-space form."""
    rng, runs = np.random.default_rng(7), 4000
    root = np.linalg.cholesky(GATHERED)
    observer = reduced_observer.by_riccati(HELD, "x", GATHERED)
    form = observer.state_space()
    x, x3 = np.zeros((2, runs)), np.zeros((1, runs))
    for _ in range(40):
        u = rng.normal(size=(1, runs))
        seen = np.vstack([x[:1], u])
        estimate = form.C @ x3 + form.D @ seen
        error = estimate[1] - x[1]
        x3, x = form.A @ x3 + form.B @ seen, HELD.A @ x + HELD.B @ u + root @ rng.normal(size=(2, runs))
    stated = noise_filter(observer).covariance[0, 0]
    assert abs(error.var() / stated - 1) < 5 * np.sqrt(2 / runs)
    assert abs(error.var() / (1.5 * stated) - 1) > 5 * np.sqrt(2 / runs)  # a variance half as large again is seen


def test_units_do_not_matter() -> None:
    model, W, _ = noisy(4)
    size = 2.0 ** np.array([-20, 3, 0, 24])
    other = replace(model, A=model.A * size / size[:, None], B=model.B / size[:, None], C=model.C * size)
    measured, left = ("x0", "x2"), [1, 3]
    first = reduced_observer.by_riccati(model, measured, W)
    second = reduced_observer.by_riccati(other, measured, W / size / size[:, None])
    np.testing.assert_allclose(size[left][:, None] * second.L / size[[0, 2]], first.L, rtol=1e-5)


def test_noise_held_over_the_period_leaves_no_steady_filter() -> None:
    """W = b q b' reaches v by no other way than x: the best gain 2 / T has its pole at z = -1."""
    b = HELD.B / 13
    with pytest.raises(ModelError, match="excites mode -1 of the error in v at most through x"):
        reduced_observer.by_riccati(HELD, "x", np.outer(b, b) * 3)
    for W in ({"x": 1.0}, {}):
        with pytest.raises(ModelError, match="excites mode 1 of the error in v"):
            reduced_observer.by_riccati(HELD, "x", W)


def test_a_growing_mode_that_noise_does_not_excite_is_mirrored() -> None:
    """In closed form: the error mode z = 1.5 goes to 2/3, with P = z^2 - 1; s = 1 goes to -1, with P = 2 s."""
    g = np.array([[1.0], [-0.6]])
    sampled = reduced_observer.by_riccati(([[0.5, 1], [0, 0.9]], [[1], [1]], [[1, 0]], [[0]], 1e-3), ["y1"], g @ g.T)
    np.testing.assert_allclose(sampled.L, [[0.9 - 2 / 3]], rtol=1e-12)
    np.testing.assert_allclose(sampled.poles, [2 / 3], rtol=1e-12)
    np.testing.assert_allclose(noise_filter(sampled).covariance, [[1.25]], rtol=1e-12)
    g = np.array([[1.0], [-1.0]])
    continuous = reduced_observer.by_riccati(([[-1, 1], [0, 0]], [[1], [1]], [[1, 0]], [[0]]), ["y1"], g @ g.T)
    np.testing.assert_allclose(continuous.L, [[1.0]], rtol=1e-12)
    np.testing.assert_allclose(noise_filter(continuous).covariance, [[2.0]], rtol=1e-12)


def test_a_late_input_is_known_exactly_and_takes_no_part() -> None:
    late, W = discretise.delay_samples(HELD), np.zeros((3, 3))
    W[:2, :2] = GATHERED
    plain, with_input = (reduced_observer.by_riccati(m, "x", w) for m, w in ((HELD, GATHERED), (late, W)))
    np.testing.assert_allclose(with_input.L, [plain.L[0], [0]], rtol=1e-6)
    assert noise_filter(with_input).deviations["i_late1"] == 0


@pytest.mark.parametrize(
    ("system", "W", "kind", "text"),
    [
        (CART, {"v": 1.0}, ModelError, "W has no part on x: its rate shows the estimated states exactly"),
        (HELD, [1.0, -1.0], SignalError, "W has the eigenvalue -1"),
        (HELD, [[1.0, 0.5], [0.2, 1.0]], SignalError, "W is not symmetric"),
        (HELD, [1.0, np.nan], SignalError, "W has nan for v, v"),
        (HELD, {"y": 1.0}, SignalError, "W names 'y', which is not one of x, v"),
    ],
)
def test_noise_that_has_no_filter(system: StateSpace, W: object, kind: type[Exception], text: str) -> None:
    with pytest.raises(kind, match=text):
        reduced_observer.by_riccati(system, "x", W)  # type: ignore[arg-type]


def test_two_signals_that_show_the_same_without_noise() -> None:
    A = np.array([[0.5, 0, 1], [0, 0.5, 1], [0, 0, 0.9]])
    with pytest.raises(ModelError, match=r"no steady-state gain, as noise-free signals .* leave such a signal out"):
        reduced_observer.by_riccati((A, np.zeros((3, 1)), np.eye(3), np.zeros((3, 1)), 0.1), ("x1", "x2"), {"x3": 1.0})


def test_the_result_states_its_deviations() -> None:
    assert "Standard deviation of the error: v 0.019\n" in repr(reduced_observer.by_riccati(HELD, "x", GATHERED))
