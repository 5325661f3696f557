"""CasADi functions at many columns give what CasADi gives, bit for bit, and what is kept belongs to its function."""

import casadi as ca
import numpy as np

from synth.base import column_maps

X, U = ca.SX.sym("x", 2), ca.SX.sym("u")
F = ca.Function("f", [X, U], [ca.vertcat(X[1], ca.sin(X[0]) + U), ca.vertcat(X[0] * U, 0, ca.exp(X[1]))])
RNG = np.random.default_rng(0)
AT, INPUTS = RNG.normal(size=(2, 7)), RNG.normal(size=(1, 7))


def test_the_results_are_those_of_casadi() -> None:
    for ours, theirs in zip(column_maps.map_columns(F, AT, INPUTS), F(AT, INPUTS), strict=True):
        np.testing.assert_array_equal(ours, np.asarray(theirs))
    start = AT[:, :1]
    for ours, theirs in zip(column_maps.chain_columns(F, start, INPUTS), F.mapaccum(7)(start, INPUTS), strict=True):
        np.testing.assert_array_equal(ours, np.asarray(theirs))


def test_one_column_stands_for_all_and_an_argument_may_be_empty() -> None:
    for first in (AT[:, :1], AT[:, 0]):
        one = column_maps.map_columns(F, first, INPUTS)
        all = column_maps.map_columns(F, np.tile(AT[:, :1], 7), INPUTS)
        assert [r.tolist() for r in one] == [r.tolist() for r in all]
    g = ca.Function("g", [ca.SX.sym("none", 0), U], [2 * U])
    np.testing.assert_array_equal(column_maps.map_columns(g, np.array([]), INPUTS)[0], 2 * INPUTS)


def test_many_columns_are_evaluated_in_parts() -> None:
    n = 2 * column_maps.PART + 3
    at, inputs = RNG.normal(size=(2, n)), RNG.normal(size=(1, n))
    for first in (at, at[:, :1], at[:, 0]):
        expected = F(first, inputs)
        for ours, theirs in zip(column_maps.map_columns(F, first, inputs), expected, strict=True):
            np.testing.assert_array_equal(ours, np.asarray(theirs))


def test_another_function_and_another_number_of_columns_are_computed_again() -> None:
    """What is kept is kept for a function and a number of columns; results are not overwritten by the next ones."""
    before = column_maps.map_columns(F, AT, INPUTS)
    copies = [r.copy() for r in before]
    g = ca.Function("f", [X, U], [X + U, X[0] * ca.DM.ones(3)])
    np.testing.assert_array_equal(column_maps.map_columns(g, AT, INPUTS)[0], AT + INPUTS)
    assert column_maps.map_columns(F, AT[:, :3], INPUTS[:, :3])[0].shape == (2, 3)
    column_maps.map_columns(F, 2 * AT, INPUTS)
    assert all((a == b).all() for a, b in zip(before, copies, strict=True))
