"""Identities are zero however they are written, small terms are not, and the bound holds against exact arithmetic."""

from fractions import Fraction

import casadi as ca
import numpy as np
import pytest

from synth.analyse.numerics import nearest_root, precise
from synth.errors import ModelError
from synth.signals import Signal

X = ca.SX.sym("x", 2)
A, B = X[0], X[1]
P = ca.SX.sym("p", 3)
BOX = nearest_root.Box(X, (Signal("a", "m", -1.0, 2.0), Signal("b", "s", 0.1, 1.0)), P, np.array([0.1, 0.2, 0.3]))

ZEROS = {
    "itself": A - A,
    "circle": ca.sin(A) ** 2 + ca.cos(A) ** 2 - 1,
    "binomial": (A + B) ** 3 - A**3 - 3 * A**2 * B - 3 * A * B**2 - B**3,
    "decimals": 0.1 * 3 * A - 0.3 * A,
    "inverse": ca.exp(ca.log(B)) - B,
    "large terms": (1e8 + A) - 1e8 - A,
    "addition": ca.sin(A + B) - ca.sin(A) * ca.cos(B) - ca.cos(A) * ca.sin(B),
    "branch": ca.if_else(A > 0, A, -A) - ca.fabs(A),
    "parameters": (P[0] + P[1] - P[2]) * A,
}
OTHERS = {
    "small": 1e-30 * A,
    "nearly the circle": ca.sin(A) ** 2 + ca.cos(A) ** 2 - 1 + 1e-10 * B,
    "power": A**3,
    "one branch": ca.if_else(A > 1.5, B, 0),
    "constant": ca.SX(1e-300),
    "product": 1e-9 * A * (A - B),
}


@pytest.mark.parametrize("name", ZEROS)
def test_zeros_are_found(name: str) -> None:
    assert precise.vanish(ZEROS[name], BOX).all()


@pytest.mark.parametrize("name", OTHERS)
def test_nonzero_expressions_stay(name: str) -> None:
    assert not precise.vanish(OTHERS[name], BOX).any()


def test_a_matrix_keeps_its_shape_and_loses_its_zeros() -> None:
    M = ca.vertcat(ca.horzcat(A, ZEROS["circle"], 0), ca.horzcat(ZEROS["binomial"], 2, B))
    assert precise.vanish(M, BOX).tolist() == [[False, True, True], [True, False, False]]
    kept = precise.without_zeros(M, BOX)
    assert kept.nnz() == 3 and kept.shape == (2, 3)
    assert precise.vanish(ca.SX(2, 3), BOX).all()


def exactly(terms: list[tuple[float, int, int]], a: float, b: float) -> Fraction:
    x, y = Fraction(a), Fraction(b)
    return sum((Fraction(c) * x**i * y**j for c, i, j in terms), Fraction(0))


def errors(seed: int) -> tuple[np.ndarray, np.ndarray]:
    """Return the errors of a polynomial with cancelling terms, found in rational arithmetic, and their bounds."""
    rng = np.random.default_rng(seed)
    terms = [
        (float(c), int(i), int(j)) for c, i, j in zip(rng.normal(size=8), *rng.integers(0, 5, (2, 8)), strict=True)
    ]
    terms += [(-c * (1 + 1e-9), i, j) for c, i, j in terms]
    expr = sum((c * A**i * B**j for c, i, j in terms), ca.SX(0))
    points = nearest_root.scatter(BOX.signals, 20, seed)
    values = BOX.evaluate(ca.horzcat(expr, precise.error_bound(expr)), points)[0]
    exact = [exactly(terms, *point) for point in points.T.tolist()]
    off = [abs(float(Fraction(v) - e)) for v, e in zip(values[0].tolist(), exact, strict=True)]
    return np.array(off), np.finfo(float).eps * values[1]


@pytest.mark.parametrize("seed", range(5))
def test_the_error_of_a_polynomial_stays_within_its_bound(seed: int) -> None:
    error, bound = errors(seed)
    assert (error <= bound).all()
    assert error.max() > 1e-3 * bound.max()  # and the bound is not far too large


def test_a_value_that_is_not_finite_is_refused_with_its_place() -> None:
    with pytest.raises(ModelError, match=r"not finite at a = -0\.\d+ m, b = 0\.\d+ s: shrink the ranges"):
        precise.vanish(ca.sqrt(A), BOX)


def test_without_signals_constants_are_zero_or_nonzero() -> None:
    assert not precise.vanish(ca.SX(2.0), nearest_root.Box(ca.SX(0, 1), ())).any()
