"""With the law in place the accelerations are the demands, and models that it cannot serve are refused."""

from collections.abc import Callable, Sequence

import casadi as ca
import numpy as np
import pytest

from synth.errors import ModelError
from synth.synthesise.feedback_linearisation import linearise

Q = ca.SX.sym("q", 3)
V = ca.SX.sym("v", 4)


def inputs(n: int) -> dict[str, ca.SX]:
    return {f"v{i}": V[i] for i in range(n)}


def demands(n: int) -> list[ca.SX]:
    return [ca.SX.sym(f"w{i}") for i in range(n)]


def random_model(n: int, seed: int) -> list[ca.SX]:
    """Random drift and decoupling, smooth in q, well away from singular."""
    rng = np.random.default_rng(seed)
    drift = [ca.sin(ca.dot(rng.normal(size=3), Q)) * rng.normal() for _ in range(n)]
    D = rng.normal(size=(n, n)) + 4 * np.eye(n)[rng.permutation(n)]
    scale = [ca.exp(0.1 * ca.dot(rng.normal(size=3), Q)) for _ in range(n)]
    return [drift[i] + scale[i] * sum(D[i, j] * V[j] for j in range(n)) for i in range(n)]


@pytest.mark.parametrize("n", [1, 2, 3, 4])
@pytest.mark.parametrize("seed", range(3))
def test_accelerations_become_the_demands(n: int, seed: int) -> None:
    q2, w = random_model(n, seed), demands(n)
    law = linearise(q2, inputs(n), w)
    closed = ca.substitute(ca.vcat(q2), V[:n], ca.vcat(list(law.inputs.values())))
    assert list(law.inputs) == [f"v{i}" for i in range(n)]
    f = ca.Function("f", [Q, ca.vcat(w)], [closed, law.decoupling, law.drift, law.determinant])
    open_loop = ca.Function("g", [Q, V], [ca.vcat(q2)])
    rng = np.random.default_rng(seed)
    for _ in range(20):
        q, wanted, v = rng.uniform(-1, 1, 3), rng.uniform(-1, 1, n), rng.normal(size=4)
        reached, D, drift, determinant = (m.full() for m in f(q, wanted))
        np.testing.assert_allclose(reached.ravel(), wanted, rtol=0, atol=1e-12)
        # NumPy's factorisation and the open loop know nothing of cofactors.
        np.testing.assert_allclose(determinant.item(), np.linalg.det(D), rtol=1e-10)
        np.testing.assert_allclose(drift.ravel() + D @ v[:n], open_loop(q, v).full().ravel(), rtol=0, atol=1e-12)


def test_a_perturbed_law_misses_the_demands() -> None:
    q2, w = random_model(2, 0), demands(2)
    v = [1.001 * e for e in linearise(q2, inputs(2), w).inputs.values()]
    closed = ca.Function("f", [Q, ca.vcat(w)], [ca.substitute(ca.vcat(q2), V[:2], ca.vcat(v))])
    assert np.abs(closed([0.1, 0.2, 0.3], [1, -1]).full().ravel() - [1, -1]).max() > 1e-12


def test_a_constant_model_and_one_of_unlike_scales_are_served() -> None:
    w = demands(2)
    law = linearise([3 * V[0] - 1, 1e-20 * V[0] + 2e-20 * V[1]], inputs(2), w)
    f = ca.Function("f", [ca.vcat(w)], list(law.inputs.values()))
    np.testing.assert_allclose([float(v) for v in f([5, 4e-20])], [2, 1], rtol=1e-15)


def test_zeros_of_the_decoupling_matrix_vanish_from_the_law() -> None:
    w = demands(2)
    law = linearise([Q[0] * V[0], Q[1] * V[1] + Q[2]], inputs(2), w)
    assert not ca.depends_on(law.inputs["v0"], ca.vertcat(w[1], Q[2]))


@pytest.mark.parametrize(
    ("acceleration", "n", "w", "text"),
    [
        ([V[0]], 2, 1, r"1 accelerations and 1 demands meet 2 inputs \(v0, v1\).*combine or drop"),
        ([V[0], V[1]], 2, 1, "2 accelerations and 1 demands meet 2 inputs"),
        ([V[0] + V[1] ** 2, V[1]], 2, 2, "not affine in 'v1'.*drop or invert"),
        ([V[0] * V[1], V[1]], 2, 2, "not affine in 'v[01]'"),
        ([ca.sin(V[0]), V[1]], 2, 2, "not affine in 'v0'"),
        ([V[0], Q[0] * V[0]], 2, 2, r"\(v0, v1\) is singular everywhere: choose other inputs"),
        ([Q[0] * (V[0] + 2 * V[1]), Q[1] * (V[0] + 2 * V[1])], 2, 2, "singular everywhere"),
        ([ca.sin(Q[0]) * V[0], ca.cos(Q[0]) * V[0] + 0 * V[1]], 2, 2, "singular everywhere"),
        ([Q[0], Q[1] * V[1]], 2, 2, "singular everywhere"),
    ],
)
def test_a_model_without_a_law_is_refused(acceleration: Sequence[ca.SX], n: int, w: int, text: str) -> None:
    with pytest.raises(ModelError, match=text):
        linearise(acceleration, inputs(n), demands(w))


@pytest.mark.parametrize("element", [lambda q: q, lambda q: q - 0.5, lambda q: ca.sin(7 * q)])
def test_a_model_singular_at_points_is_served(element: Callable[[ca.SX], ca.SX]) -> None:
    law = linearise([element(Q[0]) * V[0]], inputs(1), demands(1))
    assert not law.determinant.is_zero()
