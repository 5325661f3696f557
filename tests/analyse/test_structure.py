"""Modes that are not moved or not shown are found, named and told from weakly moved ones."""

import control
import numpy as np
import pytest
import scipy.linalg
from hypothesis import given, settings
from hypothesis import strategies as st

from synth.analyse import structure
from synth.errors import ModelError
from synth.statespace import StateSpace
from synth.timing import Continuous, Discrete
from tests import tolerances

CONTINUOUS, SAMPLED = Continuous(), Discrete(1e-3)


def named(n: int) -> tuple[str, ...]:
    return tuple(f"x{i}" for i in range(n))


def orthogonal(n: int, rng: np.random.Generator) -> np.ndarray:
    return np.linalg.qr(rng.normal(size=(n, n)))[0]


def test_the_message_names_the_mode_its_states_and_the_inputs() -> None:
    A, B = [[0, 1, 0], [0, 0, 0], [0, 0, 1.5]], [[0], [1], [0]]
    with pytest.raises(ModelError, match=r"not stabilisable: mode 1\.5 in tilt has .* inputs force: actuate tilt or"):
        structure.require_stabilisable(A, B, ("gap", "speed", "tilt"), ("force",), CONTINUOUS)


def test_an_oscillation_is_named_with_both_its_states() -> None:
    A = scipy.linalg.block_diag([[0.0, 2.0], [-2.0, 0.0]], [[-1.0]])
    with pytest.raises(ModelError, match=r"mode 0[+-]2i in (a, b|b, a) has") as caught:
        structure.require_stabilisable(A, [[0], [0], [1]], ("a", "b", "c"), ("u",), CONTINUOUS)
    assert "1e" not in str(caught.value).split("|w^H B| = ")[0]


def test_undetectable_pairs_name_the_weight_and_the_state() -> None:
    Q = np.diag([0.0, 1.0])
    with pytest.raises(ModelError, match=r"\(Q, A\) is not detectable: mode 0 in gap has \|C v\| = 0e\+00: weight or"):
        structure.require_detectable([[0, 1], [0, 0]], Q, ("gap", "speed"), "Q", CONTINUOUS)
    structure.require_detectable([[0, 1], [0, 0]], np.diag([1.0, 0.0]), ("gap", "speed"), "Q", CONTINUOUS)


@pytest.mark.parametrize(("value", "time"), [(-0.1, CONTINUOUS), (0.99, SAMPLED), (-0.99, SAMPLED)])
def test_a_mode_that_decays_needs_no_input(value: float, time: Continuous | Discrete) -> None:
    structure.require_stabilisable([[value]], [[0.0]], ("x",), ("u",), time)


@pytest.mark.parametrize(("value", "time"), [(0.0, CONTINUOUS), (0.1, CONTINUOUS), (1.0, SAMPLED), (-1.0, SAMPLED)])
def test_a_mode_that_does_not_decay_needs_one(value: float, time: Continuous | Discrete) -> None:
    with pytest.raises(ModelError, match="not stabilisable"):
        structure.require_stabilisable([[value]], [[0.0]], ("x",), ("u",), time)
    structure.require_stabilisable([[value]], [[1e-6]], ("x",), ("u",), time)


@pytest.mark.parametrize("seed", range(5))
def test_an_undriven_integrator_beside_driven_ones_is_found_in_any_coordinates(seed: int) -> None:
    """Computed eigenvalues of the three integrators scatter by 1e-8, at which no input vector is orthogonal."""
    U = orthogonal(3, np.random.default_rng(seed))
    A = U @ np.array([[0, 1, 0], [0, 0, 0], [0, 0, 0.0]]) @ U.T
    found = structure.unmoved(A, U @ [[0], [1], [0]], named(3), CONTINUOUS)
    assert [m.value for m in found] == pytest.approx([0], abs=tolerances.of("double"))
    assert found[0].measure < tolerances.of("double")
    assert not structure.unmoved(A, U @ [[0, 0], [1, 0], [0, 1]], named(3), CONTINUOUS)


@settings(derandomize=True, max_examples=25, deadline=None)
@given(st.integers(0, 10**6))
def test_the_modes_planted_out_of_reach_are_those_found(seed: int) -> None:
    rng = np.random.default_rng(seed)
    n, k, m = rng.integers(1, 5), rng.integers(0, 3), rng.integers(1, 3)
    planted = np.sort(rng.uniform(0.1, 3, k))
    A = np.block([[rng.normal(size=(n, n)), rng.normal(size=(n, k))], [np.zeros((k, n)), np.diag(planted)]])
    B = np.vstack([rng.normal(size=(n, m)), np.zeros((k, m))])
    U, units = orthogonal(n + k, rng), 10.0 ** rng.uniform(-3, 3, n + k)
    A, B = units[:, None] * (U @ A @ U.T) / units, units[:, None] * (U @ B)
    found = sorted(mode.value.real for mode in structure.unmoved(A, B, named(n + k), CONTINUOUS))
    assert found == pytest.approx(list(planted), rel=1e-6)
    with_inputs = np.hstack([B, np.linalg.norm(A) * U[:, n:] * units[:, None]])
    assert not structure.unmoved(A, with_inputs, named(n + k), CONTINUOUS)


def test_reach_agrees_with_the_rank_of_the_controllability_matrix() -> None:
    rng = np.random.default_rng(3)
    for _ in range(20):
        A, B = rng.integers(-1, 2, (4, 4)).astype(float), rng.integers(-1, 2, (4, 1)).astype(float)
        out_of_reach = 4 - np.linalg.matrix_rank(control.ctrb(A, B))
        shifted = A + 10 * np.eye(4)  # no mode decays, so that each counts
        assert len(structure.unmoved(shifted, B, named(4), CONTINUOUS)) == out_of_reach


def system(A: object, B: object, C: object) -> StateSpace:
    A, B, C = (np.asarray(M, float) for M in (A, B, C))
    inputs, outputs = tuple(f"u{i}" for i in range(B.shape[1])), tuple(f"y{i}" for i in range(len(C)))
    return StateSpace(A, B, C, np.zeros((len(C), B.shape[1])), named(len(A)), inputs, outputs, CONTINUOUS)


def test_transmission_zeros_are_told_whatever_the_units() -> None:
    w, A = 7.0, [[0, 1, 0], [0, 0, 1], [-1, -3, -3]]
    for scale in (1e-9, 1.0, 1e9):
        plant = system(A, [[0], [0], [scale]], [[w * w * 1e-6, 0, 1e-6]])  # numerator s^2 + w^2
        assert sorted(abs(control.zeros(plant.to_control()))) == pytest.approx([w, w])
        assert structure.has_transmission_zero(plant, 1j * w)
        assert not structure.has_transmission_zero(plant, 1j * w * (1 + 1e-6))
        assert not structure.has_transmission_zero(plant, 0)
    two_outputs = system(A, [[0], [0], [1]], [[1, 0, 0], [0, 1, 0]])
    assert structure.has_transmission_zero(two_outputs, 1.0)  # two outputs cannot follow one input


def test_what_is_not_connected_goes_and_the_response_stays() -> None:
    A = np.array([[-1.0, 0, 0, 0], [1, -2, 0, 0], [0, 0, -3, 0], [0, 1, 0, -4]])
    whole = system(A, [[1], [0], [0], [0]], [[0, 1, 1, 0]])
    part = structure.connected(whole)
    s = 1j * np.array([0.1, 1, 10])
    assert part.states == ("x0", "x1")
    np.testing.assert_allclose(part.response(s), whole.response(s), rtol=tolerances.of("double"))
    through = structure.connected(system([[-1.0]], [[0]], [[1]]))
    assert through.states == () and not through.response(s).any()
