"""A loop as a ratio of polynomials with integer coefficients: nothing is rounded."""

from fractions import Fraction

import control
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from synth.analyse.loops import disk, zpk
from synth.statespace import StateSpace, of
from synth.timing import Discrete

I = complex(0, 1)


def at(polynomial: object, s: Fraction) -> Fraction:
    """Evaluate a polynomial of integers exactly."""
    return sum((Fraction(int(c)) * s**k for k, c in enumerate(polynomial.coeffs())), Fraction(0))  # type: ignore[attr-defined]


def exactly(model: StateSpace, s: Fraction) -> Fraction:
    """L at a rational s, by Gaussian elimination over the rationals."""
    n = len(model.A)
    rows = [[(s if i == j else 0) - Fraction(float(model.A[i, j])) for j in range(n)] for i in range(n)]
    right = [Fraction(float(v)) for v in model.B[:, 0]]
    for i in range(n):
        pivot = next(k for k in range(i, n) if rows[k][i])
        rows[i], rows[pivot], right[i], right[pivot] = rows[pivot], rows[i], right[pivot], right[i]
        for k in range(i + 1, n):
            factor = rows[k][i] / rows[i][i]
            rows[k] = [a - factor * b for a, b in zip(rows[k], rows[i], strict=True)]
            right[k] -= factor * right[i]
    x = [Fraction(0)] * n
    for i in reversed(range(n)):
        x[i] = (right[i] - sum((rows[i][j] * x[j] for j in range(i + 1, n)), Fraction(0))) / rows[i][i]
    return sum((Fraction(float(c)) * v for c, v in zip(model.C[0], x, strict=True)), Fraction(float(model.D[0, 0])))


@settings(derandomize=True, max_examples=20, deadline=None)
@given(st.integers(0, 10**6), st.integers(0, 5), st.booleans())
def test_a_state_space_model_is_converted_without_rounding(seed: int, n: int, sampled: bool) -> None:
    rng = np.random.default_rng(seed)
    arrays = [rng.standard_normal(shape) * 10.0 ** rng.uniform(-3, 3, shape) for shape in ((n, n), (n, 1), (1, n))]
    model = of((*arrays, rng.standard_normal((1, 1)), Discrete(0.1))) if sampled else of((*arrays, [[0.5]]))
    loop, s = zpk.of_system(model), Fraction(7, 5)
    point = (1 + s) / (1 - s) if sampled else s
    assert at(loop.N, s) / at(loop.D, s) == exactly(model, point)


def test_the_coefficients_of_a_transfer_function_stay_exact() -> None:
    """A leading coefficient of 3 does not cause a rounded division."""
    loop = zpk.of_system(control.tf([0.1, 0.7], [3.0, 0.2, 1.0 / 3]))
    s = Fraction(2)
    expected = (Fraction(0.1) * s + Fraction(0.7)) / (3 * s * s + Fraction(0.2) * s + Fraction(1.0 / 3))
    assert at(loop.N, s) / at(loop.D, s) == expected


def test_cancelled_modes_are_closed_loop_poles_but_not_in_the_loop() -> None:
    hidden = of((np.diag([-1.0, -5.0]), [[1.0], [0.0]], [[2.0, 1.0]], [[0.0]]))
    loop = zpk.of_system(hidden)
    assert [p.degree() for p in loop.lowest_terms] == [0, 1]
    assert sorted(loop.closed_loop_poles.real) == pytest.approx([-5.0, -3.0])


def test_a_pole_at_minus_one_is_counted() -> None:
    loop = zpk.of_system(control.tf([1.0], [1.0, 0.0], 0.1))  # z + 1 = 0
    assert np.isinf(loop.closed_loop_poles).all() and not disk.is_stable(loop) and zpk.count_unstable(loop, 1.0) == 1


@pytest.mark.parametrize("factor", [1.0, 0.3, 2.0 * I, 3.0 * np.exp(0.7j)])
def test_unstable_poles_are_counted_as_numpy_counts_them(factor: complex) -> None:
    b, a = [2.0, -3.0, 40.0], [1.0, 2.0, 3.0, 0.5]
    count = int((np.roots(np.polyadd(a, factor * np.array(b))).real > 0).sum())
    assert zpk.count_unstable(zpk.of_system(control.tf(b, a)), factor) == count
