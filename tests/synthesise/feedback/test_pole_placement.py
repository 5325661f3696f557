"""Placed poles against python-control, NumPy's eigenvalues and closed forms, and what cannot be placed."""

import control
import numpy as np
import pytest
import scipy.linalg
import scipy.signal
from hypothesis import given, settings
from hypothesis import strategies as st

from synth.errors import ModelError, SignalError
from synth.statespace import Array, StateSpace
from synth.synthesise.feedback import pole_placement
from synth.timing import Continuous, Discrete, Time
from tests import tolerances

POLES = [-1.0, -2.0, -3 + 1j, -3 - 1j, -5.0]


def pair(seed: int, n: int = 5, m: int = 2) -> tuple[Array, Array]:
    rng = np.random.default_rng(seed)
    return rng.normal(size=(n, n)), rng.normal(size=(n, m))


def model(A: object, B: object, time: Time | None = None) -> StateSpace:
    A, B = np.asarray(A, dtype=float), np.asarray(B, dtype=float)
    states, inputs = tuple("pqrst"[: len(A)]), tuple("fgh"[: B.shape[1]])
    zero = np.zeros((len(A), B.shape[1]))
    return StateSpace(A, B, np.eye(len(A)), zero, states, inputs, states, time or Continuous())


def largest_error(poles: object, expected: object) -> float:
    """Return the largest distance between poles, each list sorted."""
    return float(np.abs(np.sort_complex(np.asarray(poles)) - np.sort_complex(np.asarray(expected))).max())


def eigenvalues(A: Array, B: Array, placement: pole_placement.Placement) -> object:
    return np.linalg.eigvals(A + B @ placement.K)


def test_a_double_integrator_has_the_textbook_gain() -> None:
    """(s + 2)(s + 3) = s^2 + 5 s + 6 asks u = -6 x - 5 v."""
    placement = pole_placement.place(([[0, 1], [0, 0]], [[0], [1]]), [-2, -3])
    np.testing.assert_array_equal(placement.K, [[-6, -5]])
    assert placement.error == 0
    np.testing.assert_array_equal(placement.poles, [-3, -2])


def test_one_input_agrees_with_ackermann_in_python_control() -> None:
    A, B = pair(1, m=1)
    placement = pole_placement.place((A, B), POLES)
    np.testing.assert_allclose(placement.K[0], -np.ravel(control.acker(A, B, POLES)), rtol=tolerances.of("placed"))
    assert largest_error(eigenvalues(A, B, placement), POLES) < tolerances.of("placed")


def test_several_inputs_attain_what_python_control_attains_with_a_like_condition() -> None:
    A, B = pair(2)
    placement = pole_placement.place((A, B), POLES)
    theirs = A - B @ np.asarray(control.place(A, B, POLES))
    assert largest_error(eigenvalues(A, B, placement), POLES) < tolerances.of("placed")
    assert placement.error < tolerances.of("placed")
    assert placement.condition < 2 * np.linalg.cond(np.linalg.eig(theirs)[1])


@pytest.mark.parametrize(
    "expected", [[-1.0] * 5, [-1 + 1j, -1 - 1j] * 2 + [-2.0], [-1.0, -1.0, -1.0, -2 + 1j, -2 - 1j]]
)
def test_poles_more_often_than_there_are_inputs(expected: list[complex]) -> None:
    A, B = pair(3)
    placement = pole_placement.place((A, B), expected)
    with pytest.raises(ValueError, match="repeated"):
        control.place(A, B, [-1.0] * 5)
    np.testing.assert_allclose(np.poly(A + B @ placement.K), np.poly(expected), rtol=tolerances.of("placed"))
    assert placement.error < 1e-4


def test_three_pairs_at_one_place_for_two_inputs() -> None:
    A, B = pair(3, 6)
    expected = [-1 + 1j, -1 - 1j] * 3
    placement = pole_placement.place((A, B), expected)
    np.testing.assert_allclose(np.poly(A + B @ placement.K), np.poly(expected), rtol=tolerances.of("placed"))


def test_a_pair_whose_first_eigenvector_is_real() -> None:
    """Where every v is allowed, those are that the axes give; a pair needs a plane."""
    for n in (2, 4, 5):
        expected = [-1 + 1j, -1 - 1j] * (n // 2) + [-3.0] * (n % 2)
        placement = pole_placement.place((np.zeros((n, n)), np.eye(n)), expected)
        np.testing.assert_allclose(np.poly(placement.K), np.poly(expected), rtol=tolerances.of("placed"))


def test_a_multiple_pole_within_the_number_of_inputs_is_no_jordan_block() -> None:
    A, B = pair(4, 4)
    placement = pole_placement.place((A, B), [-1, -1, -2, -2])
    assert placement.condition < 1e3
    assert placement.error < tolerances.of("placed")


def test_a_pair_of_real_pole_chains_that_no_eigenvectors_span() -> None:
    """Chains of 3 and 1 integrators allow no two eigenvectors for each of two double poles (Rosenbrock)."""
    A = np.diag([1.0, 1.0, 0.0], 1)
    B = np.array([[0.0, 0], [0, 0], [1, 0], [0, 1]])
    placement = pole_placement.place((A, B), [-1, -1, -2, -2])
    np.testing.assert_allclose(np.poly(A + B @ placement.K), np.poly([-1, -1, -2, -2]), rtol=tolerances.of("placed"))


def test_poles_attained_are_those_of_the_gain_as_rounded() -> None:
    A, B = pair(5)
    placement = pole_placement.place((A, B), POLES)
    np.testing.assert_allclose(
        np.sort_complex(placement.poles), np.sort_complex(eigenvalues(A, B, placement)), rtol=tolerances.of("placed")
    )
    assert placement.error == pytest.approx(largest_error(placement.poles, POLES), rel=1e-6)


def test_units_of_states_and_inputs_do_not_matter() -> None:
    """Powers of 2 round nothing: both come to one scaled model."""
    A, B = pair(6)
    x, u = 2.0 ** np.array([-20, 3, 0, 12, -5]), 2.0 ** np.array([10, -14])
    plain = pole_placement.place((A, B), [-1.0] * 5).K
    scaled = pole_placement.place((A * x / x[:, None], B * u / x[:, None]), [-1.0] * 5).K
    np.testing.assert_allclose(u[:, None] * scaled / x, plain, rtol=tolerances.of("double"))


@given(seed=st.integers(0, 10**6), n=st.integers(1, 5), m=st.integers(1, 3), sampled=st.booleans())
@settings(derandomize=True, max_examples=40, deadline=None)
def test_random_pairs(seed: int, n: int, m: int, sampled: bool) -> None:
    rng = np.random.default_rng(seed)
    A, B = rng.normal(size=(n, n)), rng.normal(size=(n, m))
    upper = rng.uniform(0.1, 0.6, n // 2) * np.exp(1j * rng.uniform(0.3, 2.8, n // 2))
    expected = np.concatenate([upper, upper.conj(), rng.uniform(-0.7, 0.7, n % 2)])
    expected = expected if sampled else expected - 2
    placement = pole_placement.place(model(A, B, Discrete(0.1) if sampled else Continuous()), expected)
    np.testing.assert_allclose(np.poly(A + B @ placement.K), np.poly(expected), rtol=1e-6, atol=1e-6)


def test_a_mode_that_no_input_moves_stays_if_it_decays() -> None:
    A = np.array([[0.0, 1, 0], [0, 0, 0], [0, 0, -7]])
    placement = pole_placement.place(model(A, [[0], [1], [0]]), [-1, -2])
    np.testing.assert_allclose(placement.fixed, [-7])
    assert largest_error(placement.poles, [-7, -2, -1]) < tolerances.of("double")
    assert "uncontrollable: -7" in repr(placement)
    with pytest.raises(
        SignalError, match=r"poles for p, q, r is 3: give 2 without the uncontrollable -7, each with its conjugate"
    ):
        pole_placement.place(model(A, [[0], [1], [0]]), [-1, -2, -3])
    with pytest.raises(ModelError, match="not stabilisable: mode 7 in r"):
        pole_placement.place(model(np.abs(A), [[0], [1], [0]]), [-1, -2])


def test_a_slow_uncontrollable_mode_is_named_as_the_cause() -> None:
    """-1e-7 decays by no more than the rounding errors of DECAY beside -1e5."""
    system = (np.diag([-1e-7, 1.0]), [[0.0], [1.0]])
    with pytest.raises(
        ModelError, match=r"^the uncontrollable mode -1e-07 does not decay .* beside the pole -100000, "
    ):
        pole_placement.place(system, [-1e5])
    assert pole_placement.place(system, [-1.0]).fixed.tolist() == [-1e-7]


def test_an_uncontrollable_pole_of_rounding_errors_is_printed_as_zero() -> None:
    A = scipy.linalg.block_diag([[0.5, 1.0], [0.0, 0.2]], [[0.0]])
    for seed in range(8):
        V = np.linalg.qr(np.random.default_rng(seed).normal(size=(3, 3)))[0]
        with pytest.raises(SignalError, match=r"give 2 without the uncontrollable 0, each with its conjugate"):
            pole_placement.place(model(V @ A @ V.T, V @ [[0.0], [1.0], [0.0]], Discrete(0.1)), [0.1])


def test_poles_that_double_precision_does_not_resolve_are_refused() -> None:
    A, B = pair(9, 5, 1)
    steep = np.linalg.matrix_power(A, 3) * 1e3
    with pytest.raises(ModelError, match="attained only within"):
        pole_placement.place((steep, B), [-1.0] * 5)
    with pytest.raises(ModelError, match=r"within 1\.\de-02, -1 as -"):  # stable, and 1 % off
        pole_placement.place(pair(16, 7, 1), [-1.0] * 7)


def test_many_poles_take_few_turns_and_the_better_gain_is_kept(monkeypatch: pytest.MonkeyPatch) -> None:
    """With 24 states a turn over all pairs costs (24 / 15)^3 of one with 15; placing step by step misses by far."""
    A, B = pair(0, 24, 3)
    expected = -1 - 2 * np.random.default_rng(1).random(24)
    turns = []
    place_poles = scipy.signal.place_poles

    def counted(*args: object, maxiter: int) -> object:
        turns.append(maxiter)
        return place_poles(*args, maxiter=maxiter)

    monkeypatch.setattr(scipy.signal, "place_poles", counted)
    names = tuple(f"x{k}" for k in range(24))
    system = StateSpace(A, B, np.eye(24), np.zeros((24, 3)), names, ("f", "g", "h"), names, Continuous())
    assert pole_placement.place(system, expected).error < 1e-3
    assert len(turns) == 1
    assert turns[0] * (24 / 15) ** 3 <= 30
    pole_placement.place((A[:5, :5], B[:5]), expected[:5])
    assert turns[1] == 30


def test_a_refusal_of_many_poles_is_short() -> None:
    A, B = pair(0, 24, 1)
    with pytest.raises(ModelError, match=r"and 18 more are attained only within .* as .*: spread the poles") as caught:
        pole_placement.place((A, B), -1 - 2 * np.random.default_rng(1).random(24))
    assert len(str(caught.value)) < 350
