"""Reduced-order observers against the true states, whatever the input; what cannot be observed; planted defects."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from synth.analyse import discretise
from synth.errors import ModelError
from synth.statespace import Array, StateSpace
from synth.synthesise.observers import reduced_observer
from synth.synthesise.observers.reduced_observer import ReducedObserver
from synth.timing import Continuous, Discrete, Time
from tests import tolerances
from tests.synthesise.observers.models import by_poles

T = 1e-2
UNITS = {"x": "m", "v": "m/s", "i": "A"}
CART = StateSpace([[0, 1], [0, 0]], [[0], [13]], [[1, 0]], [[0]], ("x", "v"), ("i",), ("x",), Continuous(), UNITS)
HELD = discretise.zero_order_hold(CART, T)


def random_model(seed: int, n: int = 5, m: int = 2, p: int = 2, time: Time | None = None) -> StateSpace:
    """Return a model with D != 0, outputs that mix the states, and the slowest sampled pole at |z| = 0.9."""
    rng = np.random.default_rng(seed)
    A, B, C, D = (rng.normal(size=shape) for shape in ((n, n), (n, m), (p, n), (p, m)))
    labels = [tuple(f"{letter}{i}" for i in range(k)) for letter, k in (("x", n), ("u", m), ("y", p))]
    return StateSpace(0.9 * A / np.abs(np.linalg.eigvals(A)).max(), B, C, D, *labels, time or Discrete(T))


def misses(observer: ReducedObserver, steps: int = 60, seed: int = 0) -> Array:
    """Run plant and observer from two states under a random input; return x^ - x (steps, n) over the size of x."""
    model, model_of_observer = observer.model, observer.state_space()
    rng = np.random.default_rng(seed)
    rows = dict(zip(model.states, np.hstack([np.eye(len(model.A)), 0 * model.B]), strict=True))
    rows |= dict(zip(model.outputs, np.hstack([model.C, model.D]), strict=True))
    both = np.array([rows[name] for name in observer.measured_signals])
    x, x3, estimates, size = rng.normal(size=len(model.A)), np.zeros(len(observer.estimated_states)), [], 0.0
    for _ in range(steps):
        u = rng.normal(size=len(model.inputs))
        w = np.concatenate([both @ np.concatenate([x, u]), u])
        estimates.append(model_of_observer.C @ x3 + model_of_observer.D @ w - x)
        x3 = model_of_observer.A @ x3 + model_of_observer.B @ w
        size = max(size, float(np.abs(x).max()))
        x = model.A @ x + model.B @ u
    return np.array(estimates) / size


def defects(observer: ReducedObserver) -> dict[str, ReducedObserver]:
    """Return the observer with wrong recursions of x3."""
    part, L, F = observer.partition, observer.L, observer.F
    return {
        "sign of L A11": replace(observer, G=F @ L + part.A21 + L @ part.A11),
        "sign of F L": replace(observer, G=-F @ L + part.A21 - L @ part.A11),
        "A21 left out": replace(observer, G=F @ L - L @ part.A11),
        "B2 + L B1": replace(observer, H=part.B2 + L @ part.B1),
        "sign of L A12": replace(observer, F=part.A22 + L @ part.A12),
        "y for y - D u": replace(observer, partition=replace(part, D=0 * part.D)),
    }


def spread_poles(count: int) -> list[float]:
    return [0.1 + 0.1 * k for k in range(count)]


def test_the_cart_has_the_observer_worked_by_hand() -> None:
    """x+ = x + T v + b T^2/2 i, v+ = v + b T i and L = (1 - p) / T give F = p, G = -L^2 T, H = b T (1 + p) / 2."""
    p, b = 0.3, 13.0
    observer = by_poles(HELD, "x", [p])
    L = (1 - p) / T
    for value, expected in (
        (observer.L, L),
        (observer.F, p),
        (observer.G, -(L**2) * T),
        (observer.H, b * T * (1 + p) / 2),
    ):
        np.testing.assert_allclose(value, [[expected]], rtol=tolerances.of("double"))
    np.testing.assert_allclose(observer.poles, [p], rtol=tolerances.of("double"))


@pytest.mark.parametrize("measured", [("y0", "y1"), ("y1",), ("x3", "y0"), ("x0", "x4", "x1")])
def test_estimates_converge_to_the_states_as_the_poles_say(measured: Sequence[str]) -> None:
    model = random_model(1)
    count = 5 - len(measured)
    observer = by_poles(model, measured, spread_poles(count))
    error = misses(observer)
    assert np.abs(error[0]).max() > 1e-3
    assert np.abs(error[-1]).max() < tolerances.of("settled")
    np.testing.assert_allclose(np.sort(observer.poles.real), spread_poles(count), rtol=tolerances.of("placed"))


@pytest.mark.parametrize("seed", range(3))
def test_a_continuous_observer_follows_every_input_without_error(seed: int) -> None:
    """From u the estimates respond as the states do, at every s; the error alone decays with the poles."""
    model = random_model(seed, time=Continuous())
    expected = [-1.0, -2 + 1j, -2 - 1j]
    design = by_poles(model, ("y0", "y1"), expected)
    s = np.array([0.3j, 2 + 1j, 40j])
    state = replace(model, C=np.eye(5), D=np.zeros((5, 2)), outputs=model.states).response(s)

    def followed(observer: ReducedObserver) -> Array:
        through = observer.state_space().response(s)
        return np.abs(through[:, :, :2] @ model.response(s) + through[:, :, 2:] - state) / np.abs(state).max()

    assert followed(design).max() < tolerances.of("pencil")
    assert min(followed(wrong).max() for wrong in defects(design).values()) > 1e-3
    np.testing.assert_allclose(np.poly(design.F), np.poly(expected), rtol=tolerances.of("placed"))


@given(seed=st.integers(0, 10**6), n=st.integers(2, 5), p=st.integers(1, 4), m=st.integers(0, 2))
@settings(derandomize=True, max_examples=30, deadline=None)
def test_random_models(seed: int, n: int, p: int, m: int) -> None:
    p = min(p, n - 1)
    model = random_model(seed, n, m, p)
    observer = by_poles(model, model.outputs, spread_poles(n - p))
    assert np.abs(misses(observer, 120)[-1]).max() < 1e-6


def test_measured_states_pass_through_exactly_and_keep_their_units() -> None:
    form = by_poles(HELD, "x", [0.5]).state_space()
    assert (form.inputs, form.outputs, form.states) == (("x", "i"), ("x_estimate", "v_estimate"), ("v_x3",))
    assert [form.unit(n) for n in (*form.outputs, *form.states, *form.inputs)] == ["m", "m/s", "m/s", "m", "A"]
    np.testing.assert_array_equal(form.D[0], [1, 0])
    np.testing.assert_array_equal(form.C[0], [0])


def test_coordinates_are_as_well_conditioned_in_any_units() -> None:
    """The scaled condition is all but that of good units, though that of M itself is lost."""
    model, size = random_model(9), 2.0 ** np.array([-20, 3, 0, 12, -5])
    other = replace(model, A=model.A * size / size[:, None], B=model.B / size[:, None], C=model.C * size)
    first, second = (reduced_observer.of_model(m, model.outputs) for m in (model, other))
    assert second.condition < 4 * first.condition < 40
    assert np.linalg.cond(second.M) > 1e3
    np.testing.assert_allclose(first.M @ first.inverse, np.eye(5), atol=tolerances.of("double"))


def test_a_mode_that_is_not_shown_is_named() -> None:
    A = np.array([[0.9, 0.1, 0.1], [0, 0.5, 0], [0, 0, 1.0]])
    C = np.array([[1.0, 0, 0], [0, 0, 1]])
    model = StateSpace(A.T, np.zeros((3, 1)), C, np.zeros((2, 1)), ("p", "q", "r"), ("f",), ("p", "r"), Discrete(T))
    with pytest.raises(
        ModelError, match=r"\(A12, A22\) is not detectable: mode 1 in r .* for the measured p: measure r"
    ):
        by_poles(model, "p", [0.1, 0.2])
    stays = by_poles(model, ("p", "r"), [])
    np.testing.assert_array_equal(stays.poles, [0.5])


def test_a_given_gain_in_continuous_time() -> None:
    assert reduced_observer.from_gain(CART, "x", 5).poles == [-5]
    with pytest.raises(ModelError, match="has the poles 2: its error does not decay, which needs Re s < 0"):
        reduced_observer.from_gain(CART, "x", -2)


def test_a_late_input_is_estimated_or_measured() -> None:
    late = discretise.delay_samples(HELD)
    observer = by_poles(late, "x", [0.2, 0.3])
    known = by_poles(late, ("x", "i_late1"), [0.3])
    assert (observer.estimated_states, known.estimated_states) == (("v", "i_late1"), ("v",))
    assert max(np.abs(misses(o)[-1]).max() for o in (observer, known)) < tolerances.of("settled")


@pytest.mark.parametrize("g", [1e3, 1e6])
def test_a_slow_mode_beside_a_fast_one_is_accepted(g: float) -> None:
    """The poles are -g and -1 / g: the second is slow beside the first, and exact."""
    model = ([[0, g, 0], [0, -1e-3, 1 / g], [0, 0, 0]], [[0], [1], [0]], [[1, 0, 0]], [[0]])
    poles = reduced_observer.from_gain(model, ["x1"], [[1.0], [1.0]]).poles
    assert poles.real == pytest.approx([-g, -1 / g], rel=2e-3)
