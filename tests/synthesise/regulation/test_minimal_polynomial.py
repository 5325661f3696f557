"""Minimal polynomials of matrices with known Jordan blocks, in coordinates and units that hide them."""

import numpy as np
import pytest
import scipy.linalg
from hypothesis import given, settings
from hypothesis import strategies as st

from synth.analyse.numerics import precise
from synth.errors import SignalError
from synth.synthesise.regulation import internal_model, regulator_equations
from tests import tolerances


def jordan(mode: complex, order: int) -> np.ndarray:
    """Return a real Jordan block."""
    core = [[mode.real, mode.imag], [-mode.imag, mode.real]] if mode.imag else [[mode.real]]
    return np.kron(np.eye(order), core) + np.kron(np.eye(order, k=1), np.eye(len(core)))


def multiplicities(S: object) -> dict[complex, int]:
    return {complex(np.round(m.value, 6)): m.multiplicity for m in regulator_equations.roots(S)}


@pytest.mark.parametrize(
    ("S", "expected"),
    [
        (np.zeros((3, 3)), {0: 1}),
        (jordan(0, 2), {0: 2}),
        (scipy.linalg.block_diag(jordan(2j, 1), jordan(2j, 1)), {2j: 1}),
        (scipy.linalg.block_diag(jordan(2j, 2), jordan(2j, 1), jordan(0, 1)), {0: 1, 2j: 2}),
        (scipy.linalg.block_diag(jordan(-1, 1), jordan(0.5 + 3j, 1)), {-1: 1, 0.5 + 3j: 1}),
        ([[0, 1e-14], [0, 0]], {0: 2}),
        ([[0, 1], [-1e6, 0]], {1000j: 1}),
        (scipy.linalg.block_diag(jordan(3000j, 1), jordan(0.001j, 1), jordan(0, 2)), {0: 2, 0.001j: 1, 3000j: 1}),
        ([[-1e-5, 1], [-1, -1e-5]], {-1e-5 + 1j: 1}),
    ],
)
def test_known_cases(S: object, expected: dict[complex, int]) -> None:
    assert multiplicities(S) == expected


def test_order_counts_degrees() -> None:
    assert [m.order for m in regulator_equations.roots(scipy.linalg.block_diag(jordan(0, 3), jordan(2j, 2)))] == [3, 4]


@settings(derandomize=True, max_examples=60, deadline=None)
@given(st.integers(0, 10**6))
def test_blocks_are_found_in_any_orthogonal_coordinates_and_units(seed: int) -> None:
    rng = np.random.default_rng(seed)
    modes = [0j, *(1j * rng.uniform(0.5, 2, 2) * (1, 5))]
    orders = rng.integers(1, 3, 3)
    blocks = [jordan(s, k) for s, k in zip(modes, orders, strict=True)]
    S = scipy.linalg.block_diag(*blocks, jordan(modes[1], 1))
    Q = np.linalg.qr(rng.normal(size=S.shape))[0]
    units = 2.0 ** rng.integers(-20, 20, len(S))
    roots = regulator_equations.roots(units[:, None] * (Q @ S @ Q.T) / units)
    assert [m.multiplicity for m in roots] == orders.tolist()
    np.testing.assert_allclose([m.value for m in roots], modes, atol=tolerances.of("lyapunov"))


def test_the_polynomial_vanishes_at_the_matrix_and_none_of_lower_degree_does() -> None:
    rng = np.random.default_rng(4)
    S = scipy.linalg.block_diag(jordan(2j, 2), jordan(0, 2), jordan(0, 1))
    Q = np.linalg.qr(rng.normal(size=S.shape))[0]
    S = Q @ S @ Q.T
    p = [float(c) for c in regulator_equations.polynomial(regulator_equations.roots(S)).coeffs()]
    powers = [np.linalg.matrix_power(S, k) for k in range(len(p))]
    left = sum(c * M for c, M in zip(p, powers, strict=True))
    np.testing.assert_allclose(left, 0, atol=tolerances.of("double") * max(np.abs(M).max() for M in powers))
    assert np.linalg.matrix_rank(np.array([M.ravel() for M in powers[:-1]])) == len(p) - 1


def test_modes_that_are_not_nilpotent_on_any_group_are_not_guessed(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(regulator_equations, "ENTRY_ROUNDING", -1.0)
    with pytest.raises(SignalError, match="not determined in double precision: give frequencies"):
        regulator_equations.roots(jordan(2j, 2))


@pytest.mark.parametrize("chain", [1.0, 7.0])
def test_the_modal_matrix_leads_to_the_real_jordan_form(chain: float) -> None:
    """One block for each mode, with the chain's factor beside it."""
    model = internal_model.exosystem({0.0: 2, 3.0: 2})
    T = regulator_equations.modal_matrix(model.modes, chain)
    J = precise.rounded(T.inv() * precise.matrix(model.Phi) * T)
    turn = np.array([[0.0, 3.0], [-3.0, 0.0]])
    expected = scipy.linalg.block_diag([[0, chain], [0, 0]], np.block([[turn, chain * np.eye(2)], [0 * turn, turn]]))
    np.testing.assert_allclose(J, expected, rtol=0, atol=tolerances.of("double"))
