"""Modal controllability and observability do not depend on units; weakly coupled modes are named."""

import control
import numpy as np
import pytest
import scipy.linalg
from hypothesis import given, settings
from hypothesis import strategies as st

from synth.analyse import modal_controllability, realisation, staircase
from synth.errors import SignalError
from synth.statespace import StateSpace, of
from synth.timing import Continuous, Discrete
from tests import tolerances


def axes(eps: float) -> StateSpace:
    """Return a driven mass on a spring, and another one coupled to force and encoder by `eps` only."""
    A = scipy.linalg.block_diag([[0.0, 1.0], [-4.0, -0.1]], [[0.0, 1.0], [-9.0, -0.2]])
    B, C = [[0.0, 0.0], [1.0, 0.0], [0.0, 0.0], [eps, 1.0]], [[1.0, 0.0, eps, 0.0], [0.0, 0.0, 1.0, 0.0]]
    return StateSpace(A, B, C, np.zeros((2, 2)), ("gap", "speed", "tilt", "rate"), ("f", "g"), ("y", "z"), Continuous())


def test_weakly_coupled_modes_are_named_with_their_best_input() -> None:
    whole = modal_controllability.modal_measures(axes(1e-6))
    assert not whole.weakly_controllable and not whole.weakly_observable
    slow, fast = whole.modes[0], whole.modes[2]
    assert (
        slow.by_input["f"] > 0.1 > 1e-6 > slow.by_input["g"] and fast.by_input["g"] > 0.05 > 1e-3 > fast.by_input["f"]
    )
    assert slow.by_output["y"] > 0.1 and slow.by_output["z"] < 1e-6
    alone = modal_controllability.modal_measures(axes(1e-9).select(("y",), ("f",)))
    weak = alone.weakly_controllable + alone.weakly_observable
    assert weak and all(m.value.imag**2 > 8 and set(m.states) <= {"tilt", "rate"} for m in weak)
    assert "Weakly controllable: mode -0.1 +- 2.9983i in" in str(alone) and "best input" in str(alone)


@settings(derandomize=True, max_examples=25, deadline=None)
@given(st.integers(0, 10**6))
def test_measures_are_the_same_in_other_units(seed: int) -> None:
    """Powers of 4 in each unit: the scaling, rounded to powers of 2, comes to the same matrices up to a factor of 2."""
    rng = np.random.default_rng(seed)
    n, m, p = (int(rng.integers(1, k)) for k in (6, 4, 4))
    A, B, C = rng.normal(size=(n, n)), rng.normal(size=(n, m)), rng.normal(size=(p, n))
    x, u, y = (4.0 ** rng.integers(-5, 6, k) for k in (n, m, p))
    one = modal_controllability.modal_measures((A, B, C))
    other = modal_controllability.modal_measures((A * x / x[:, None], B * u / x[:, None], C * x / y[:, None]))
    for a, b in zip(one.modes, other.modes, strict=True):
        assert b.value == pytest.approx(a.value, rel=1e-9)
        assert (
            a.controllability / 4 <= b.controllability <= 4 * a.controllability
            and a.observability / 4 <= b.observability <= 4 * a.observability
        )


def test_an_uncontrollable_mode_has_measure_zero_and_is_not_in_the_minimal_model() -> None:
    U = np.linalg.qr(np.random.default_rng(1).normal(size=(3, 3)))[0]
    A, B, C = U @ np.diag([-1.0, -2.0, -3.0]) @ U.T, U @ [[1.0], [0.0], [1.0]], np.eye(3) @ U.T
    measures = modal_controllability.modal_measures((A, B, C))
    assert [m.value for m in measures.weakly_controllable] == pytest.approx([-2])
    assert measures.weakly_controllable[0].controllability < tolerances.of("double")
    assert [m.value for m in realisation.minimal((A, B, C)).uncontrollable] == pytest.approx([-2])


def test_one_input_cannot_control_two_modes_of_one_eigenvalue() -> None:
    measures = modal_controllability.modal_measures(control.ss(-np.eye(2), [[1.0], [1.0]], np.eye(2), 0, 1e-3))
    assert measures.time == Discrete(1e-3)
    assert all(m.controllability < tolerances.of("double") and m.observability > 0.5 for m in measures.modes)


@pytest.mark.slow
def test_the_measures_of_a_large_model_are_the_least_singular_values() -> None:
    """Above SMALL states inverse iteration takes the place of a decomposition for each mode, input and output."""
    rng = np.random.default_rng(4)
    n = modal_controllability.MAX_SVD_STATES + 10
    A, B, C = rng.normal(size=(n, n)), rng.normal(size=(n, 2)), rng.normal(size=(1, n))
    part = staircase.of_model(of((A, B, C)))
    b, c = part.B / np.linalg.norm(part.B, axis=0), part.C / np.linalg.norm(part.C)
    modes = modal_controllability.modal_measures((A, B, C)).modes
    assert {m.value.imag > 0 for m in modes} == {True, False}, "both of a pair"
    for mode in modes[::16]:
        shifted = part.A - mode.value / part.rate * np.eye(n)
        stacks = (np.hstack([shifted, b]), np.hstack([shifted, b[:, 1:]]), np.vstack([shifted, c]))
        least = [np.linalg.svd(M, compute_uv=False)[-1] for M in stacks]
        assert [mode.controllability, mode.by_input["u2"], mode.observability] == pytest.approx(least, rel=1e-3)
        assert mode.observability == mode.by_output["y1"]


def test_a_long_chain_of_integrators_does_not_overflow() -> None:
    n = modal_controllability.MAX_SVD_STATES + 10
    measures = modal_controllability.modal_measures((np.diag(np.ones(n - 1), 1), np.eye(n, 1, -n // 2), np.eye(1, n)))
    assert all(
        m.controllability < tolerances.of("double") and m.observability == pytest.approx(1) for m in measures.modes
    )


@pytest.mark.filterwarnings("error")
def test_sizes_at_the_ends_of_the_range_are_refused_or_right() -> None:
    assert modal_controllability.modal_measures(([[-1e-310]], [[1.0]], [[1.0]])).modes[
        0
    ].controllability == pytest.approx(1)
    with pytest.raises(SignalError, match=r"the entries of A reach 1e\+308: choose units"):
        modal_controllability.modal_measures(([[-1e308]], [[1.0]], [[1.0]]))


def test_a_model_without_inputs_is_uncontrollable() -> None:
    measures = modal_controllability.modal_measures(([[-1.0]], np.zeros((1, 0)), [[1.0]]))
    assert (
        measures.modes[0].controllability == 0
        and measures.modes[0].by_input == {}
        and "Weakly controllable: mode -1" in str(measures)
    )
