"""The bounds against SLICOT, against matrices whose mu is known, and against determinants that vanish."""

import numpy as np
import pytest
import slycot

from synth.analyse.loops import structured_singular_value as ssv
from tests import tolerances

Complex = np.typing.NDArray[np.complex128]
EXACT = tolerances.of("double")
BOUND = 1e-6  # tolerance of `upper` on the central path


def matrices(count: int, p: int, seed: int = 0) -> Complex:
    rng = np.random.default_rng(seed)
    M = rng.standard_normal((count, p, p)) + 1j * rng.standard_normal((count, p, p))
    return M * np.exp(rng.standard_normal((count, 1, p)))


def least_determinant(M: Complex, delta: Complex) -> float:
    """Return sigma_min(I - M diag(delta)), 0 where the determinant vanishes."""
    return float(np.linalg.svd(np.eye(len(M)) - M * delta, compute_uv=False)[-1])


@pytest.mark.parametrize("p", [1, 2, 3, 4, 6])
def test_the_upper_bound_is_slicots(p: int) -> None:
    """SLICOT's AB13MD stops within some 1e-5 of the least bound over D for four blocks and more, from above."""
    M = matrices(40, p, seed=p)
    structure = np.ones(p, dtype=int), 2 * np.ones(p, dtype=int)
    witness = np.array([slycot.ab13md(m, *structure)[0] for m in M])
    upper = ssv.upper(M)
    assert upper.value == pytest.approx(witness, rel=2 * BOUND)
    assert upper.value == pytest.approx(ssv.gain(M, upper.scaling), rel=EXACT)


@pytest.mark.parametrize("p", [1, 2, 3])
def test_both_bounds_meet_for_up_to_three_channels(p: int) -> None:
    M = matrices(25, p, seed=10 + p)
    upper = ssv.upper(M).value
    lower = np.array([ssv.lower(m).value for m in M])
    assert (lower <= upper * (1 + EXACT)).all() and lower == pytest.approx(upper, rel=BOUND)


@pytest.mark.parametrize("p", [4, 6, 9])
def test_the_bounds_enclose_mu_for_more(p: int) -> None:
    M = matrices(10, p, seed=20 + p)
    upper = ssv.upper(M).value
    lower = np.array([ssv.lower(m).value for m in M])
    assert (lower <= upper * (1 + EXACT)).all() and (lower >= 0.9 * upper).all()


@pytest.mark.parametrize("p", [1, 3, 6])
def test_the_delta_of_the_lower_bound_makes_the_determinant_vanish(p: int) -> None:
    for M in matrices(10, p, seed=30 + p):
        lower = ssv.lower(M)
        assert np.abs(lower.delta) == pytest.approx(1 / lower.value, rel=EXACT)
        assert least_determinant(M, lower.delta) < EXACT
        assert least_determinant(M, 0.99 * lower.delta) > 1e-4  # no zero just inside


def test_matrices_whose_mu_is_known() -> None:
    """mu is rho for a triangular matrix, sum |u_i v_i| for u v^H, and no scaling of a matrix by D changes it."""
    rng = np.random.default_rng(1)
    triangular = np.triu(matrices(1, 4)[0])
    u, v = matrices(1, 4, seed=2)[0][:2]
    rank_one = np.outer(u, v.conj())
    M, d = matrices(1, 4, seed=3)[0], np.exp(3 * rng.standard_normal(4))
    cases = np.stack([triangular, rank_one, M, M * d[:, None] / d])
    bounds = ssv.upper(cases).value
    # The triangular case needs d -> inf; the search goes far enough for 1e-4.
    assert bounds[0] == pytest.approx(np.abs(np.diag(triangular)).max(), rel=1e-4)
    assert bounds[1] == pytest.approx(np.abs(u * v.conj()).sum(), rel=BOUND)
    assert bounds[2] == pytest.approx(bounds[3], rel=1e-4)
    assert [ssv.lower(m).value for m in cases[:2]] == pytest.approx(list(bounds[:2]), rel=1e-4)


def test_a_matrix_that_no_delta_makes_singular_has_no_mu() -> None:
    assert ssv.upper(np.zeros((1, 3, 3), dtype=complex)).value == 0
    lower = ssv.lower(np.zeros((3, 3), dtype=complex))
    assert lower.value == 0 and np.isinf(lower.delta).all()


def test_parts_that_are_not_coupled_have_the_larger_of_their_mus() -> None:
    one, two = matrices(2, 2, seed=4)
    both = np.zeros((1, 4, 4), dtype=complex)
    both[0, :2, :2], both[0, 2:, 2:] = one, 1e-3 * two
    assert ssv.upper(both).value[0] == pytest.approx(ssv.upper(one[None]).value[0], rel=BOUND)
