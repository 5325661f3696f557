"""The minimal realisation keeps the response and possible names, and reports removed modes."""

from dataclasses import replace

import control
import numpy as np
import pytest
import scipy.linalg
from hypothesis import given, settings
from hypothesis import strategies as st

from synth.analyse.structure import realisation, staircase
from synth.errors import ModelError, SignalError
from synth.statespace import StateSpace
from synth.timing import Continuous, Discrete, Time
from tests import tolerances

CONTINUOUS = Continuous()
POINTS = np.array([0.3 + 0.2j, 2j, 5.0, 0.01j])


def model_with_hidden_modes(seed: int, time: Time = CONTINUOUS) -> tuple[StateSpace, list[float], list[float]]:
    """Return a random model in random coordinates and units with uncontrollable and unobservable modes."""
    rng = np.random.default_rng(seed)
    n, r, o, m, p = (int(rng.integers(low, 4)) for low in (1, 0, 0, 1, 1))
    unreached, unseen = np.sort(rng.uniform(0.1, 0.4, r)), np.sort(rng.uniform(0.5, 0.9, o))
    zero = np.zeros
    A = np.block(
        [
            [rng.normal(size=(n, n)) / 3, rng.normal(size=(n, r)), zero((n, o))],
            [zero((r, n)), np.diag(unreached), zero((r, o))],
            [rng.normal(size=(o, n)), rng.normal(size=(o, r)), np.diag(unseen)],
        ]
    )
    B = np.vstack([rng.normal(size=(n, m)), zero((r, m)), rng.normal(size=(o, m))])
    C = np.hstack([rng.normal(size=(p, n + r)), zero((p, o))])
    U = np.linalg.qr(rng.normal(size=(len(A), len(A))))[0]
    x, u, y = (10.0 ** rng.uniform(-3, 3, k) for k in (len(A), m, p))
    A, B, C = (U @ A @ U.T) * x / x[:, None], (U @ B) * u / x[:, None], (C @ U.T) * x / y[:, None]
    labels = tuple(tuple(f"{letter}{k}" for k in range(size)) for letter, size in (("x", len(A)), ("u", m), ("y", p)))
    return StateSpace(A, B, C, rng.normal(size=(p, m)), *labels, time), list(unreached), list(unseen)


@settings(derandomize=True, max_examples=40, deadline=None)
@given(st.integers(0, 10**6))
def test_hidden_modes_are_removed_and_the_response_stays(seed: int) -> None:
    model, unreached, unseen = model_with_hidden_modes(seed, Discrete(1e-3) if seed % 2 else CONTINUOUS)
    minimal = realisation.minimal(model)
    assert sorted(m.value.real for m in minimal.uncontrollable) == pytest.approx(unreached, rel=1e-7)
    assert sorted(m.value.real for m in minimal.unobservable) == pytest.approx(unseen, rel=1e-7)
    assert len(minimal.model.A) == len(model.A) - len(unreached) - len(unseen)
    before, after = model.response(POINTS), minimal.model.response(POINTS)
    np.testing.assert_allclose(after, before, rtol=0, atol=1e-9 * np.abs(before).max(axis=(0, 1), keepdims=True).max())


def test_the_order_is_that_of_slicot() -> None:
    for seed in range(10):
        model, *_ = model_with_hidden_modes(seed)
        part = staircase.of_model(model)  # SLICOT's cut depends on units
        reference = control.minreal(control.ss(part.A, part.B, part.C, part.D), tol=1e-9, verbose=False)
        assert len(realisation.minimal(model).model.A) == reference.nstates


def test_unaffected_states_keep_name_unit_and_rows() -> None:
    """Two equal masses driven by one force: their difference is uncontrollable; the slide stays unchanged."""
    pair = np.kron(np.eye(2), [[0.0, 1.0], [-4.0, -0.1]])
    A = scipy.linalg.block_diag(pair, [[0.0, 1.0], [0.0, -3.0]], [[-7.0]])
    B = np.array([[0.0, 0], [1, 0], [0, 0], [1, 0], [0, 0], [0, 2], [1, 0]])
    C = np.array([[1.0, 0, 1, 0, 0, 0, 0], [0, 0, 0, 0, 1, 0, 0]])
    states = ("a", "va", "b", "vb", "slide", "speed", "heat")
    units = {"slide": "m", "speed": "m/s", "a": "m", "f": "N"}
    model = StateSpace(A, B, C, np.zeros((2, 2)), states, ("f", "g"), ("sum", "part1"), CONTINUOUS, units)
    minimal = realisation.minimal(model)
    assert minimal.model.states == ("slide", "speed", "part2", "part3"), "part1 is an output"
    assert minimal.model.units == {"slide": "m", "speed": "m/s", "f": "N"}
    np.testing.assert_array_equal(minimal.model.A[:2, :2], A[4:6, 4:6])
    np.testing.assert_array_equal(minimal.model.B[:2], B[4:6])
    assert minimal.removed == ("a", "va", "b", "vb", "heat") and minimal.added == ("part2", "part3")
    assert {frozenset(m.states) for m in minimal.uncontrollable} == {frozenset(("a", "va", "b", "vb"))}
    assert [(m.value, m.states) for m in minimal.unobservable] == [(-7, ("heat",))]
    np.testing.assert_allclose(minimal.model.response(POINTS), model.response(POINTS), atol=tolerances.of("double"))
    assert "Minimal model: 4 of 7 states" in str(minimal)
    assert "-0.05 +- 1.9994i" in str(minimal) and "uncontrollable" in str(minimal)


def test_a_minimal_model_stays_unchanged() -> None:
    A, B, C = [[0.0, 1e-3], [-1e5, -0.1]], [[0.0], [3.0]], [[1e6, 0.0]]
    minimal = realisation.minimal((A, B, C, [[0.0]]))
    for letter, original in zip("ABC", (A, B, C), strict=True):
        np.testing.assert_array_equal(getattr(minimal.model, letter), original)
    assert (
        not (minimal.removed or minimal.added or minimal.uncontrollable or minimal.unobservable)
        and minimal.difference == 0
    )


@pytest.mark.parametrize("seed", range(4))
def test_a_chain_of_integrators_in_any_coordinates_is_minimal(seed: int) -> None:
    U = np.linalg.qr(np.random.default_rng(seed).normal(size=(4, 4)))[0]
    A = U @ np.diag(np.ones(3), 1) @ U.T
    minimal = realisation.minimal((A, U @ np.eye(4, 1, -3), np.eye(1, 4) @ U.T))
    assert len(minimal.model.A) == 4 and not minimal.added
    cut = realisation.minimal((A, U @ np.eye(4, 1, -2), np.eye(1, 4) @ U.T))
    assert len(cut.model.A) == 3 and len(cut.uncontrollable) == 1


def test_a_model_without_response_keeps_its_direct_term() -> None:
    minimal = realisation.minimal(([[-1.0]], [[0.0]], [[1.0]], [[2.0]]))
    assert minimal.model.states == () and minimal.model.D == [[2.0]] and minimal.removed == ("x1",)


def test_removal_of_an_active_part_is_detected(monkeypatch: pytest.MonkeyPatch) -> None:
    """Planted: one state too many is removed."""
    whole = staircase.kalman

    def careless(part: staircase.Scaled, cut: float) -> staircase.Kalman:
        decomposition = whole(part, cut)
        return staircase.Kalman(
            decomposition.kept[:, :-1], decomposition.uncontrollable, decomposition.unobservable, decomposition.gap
        )

    model, *_ = model_with_hidden_modes(3)
    monkeypatch.setattr(staircase, "kalman", careless)
    with pytest.raises(ModelError, match="minimal realisation changes the response by"):
        realisation.minimal(model)


def kalman_form(seed: int) -> tuple[tuple[np.ndarray, ...], int]:
    """Return A, B, C without direct term in coordinates far from orthogonal, all four parts of Kalman's form at random.

    The order of the part that is reached and seen comes with it; it may be 0.
    """
    rng = np.random.default_rng(seed)
    sizes, m, p = rng.integers(0, 5, 4), int(rng.integers(1, 3)), int(rng.integers(1, 3))
    kind = np.repeat(range(4), sizes)  # controllable and observable, controllable only, observable only, neither
    n, reached, seen = len(kind), np.isin(kind, (0, 1)), np.isin(kind, (0, 2))
    A = rng.normal(size=(n, n))
    A[np.ix_(~reached, reached)] = 0.0  # controllable states do not drive uncontrollable ones
    A[np.ix_(seen, ~seen)] = 0.0  # unobservable states do not drive observable ones
    B, C = rng.normal(size=(n, m)) * reached[:, None], rng.normal(size=(p, n)) * seen
    T = rng.normal(size=(n, n))
    back, x = np.linalg.inv(T), 10.0 ** rng.uniform(-5, 5, n)
    return ((T @ A @ back) * x / x[:, None], T @ B / x[:, None], (C @ back) * x), int(sizes[0])


def test_the_order_is_found_in_coordinates_far_from_orthogonal() -> None:
    """Also where the response is zero. If the staircase loses more digits than its cut, the result must report it."""
    warnings = 0
    for seed in range(60):
        system, order = kalman_form(seed)
        minimal = realisation.minimal(system)
        if len(minimal.model.A) != order:
            assert (
                minimal.lower_order is not None
                and minimal.lower_order.order == order
                and "may be superfluous" in str(minimal)
            ), seed
            warnings += 1
    assert warnings <= 3


@pytest.mark.parametrize("seed", range(5))
def test_a_response_of_zero_has_no_states(seed: int) -> None:
    U = np.linalg.qr(np.random.default_rng(seed).normal(size=(3, 3)))[0]
    minimal = realisation.minimal((U @ np.diag([-1.0, -2, -3]) @ U.T, U @ np.eye(3, 1), np.array([[0.0, 1, 1]]) @ U.T))
    assert minimal.model.states == () and minimal.gap.kept > 1e-3 and minimal.gap.neglected < 1e-13
    assert "Least coupling kept" in str(minimal) and "uncertain" not in str(minimal)
    near = replace(minimal, gap=staircase.Gap(2e-11, 5e-12))
    assert "they lie so close that the order is uncertain" in str(near)


def test_weak_coupling_above_rounding_is_kept_and_reported() -> None:
    U = np.linalg.qr(np.random.default_rng(0).normal(size=(3, 3)))[0]
    A = U @ np.diag([-1.0, -2, -3]) @ U.T
    minimal = realisation.minimal((A, U @ [[1.0], [1.0], [3e-10]], np.ones((1, 3)) @ U.T))
    assert len(minimal.model.A) == 3 and minimal.lower_order is not None and minimal.lower_order.order == 2
    assert 1e-12 < minimal.lower_order.difference < 1e-9


@pytest.mark.filterwarnings("error")
def test_sizes_at_the_ends_of_the_range_are_refused_or_right() -> None:
    for small in (-1e-310, -1e-200):
        assert [[small]] == realisation.minimal(([[small]], [[1.0]], [[1.0]])).model.A
    for A, B in ((-1e308, 1.0), (-1.0, 1e308), (-1.0, 1e-310)):
        with pytest.raises(SignalError, match=r"an entry of the model has the size|reach 1e\+308"):
            realisation.minimal(([[A]], [[B]], [[1.0]]))
