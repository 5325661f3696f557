"""Singular points are found and named; no sample is worse than the worst; maps have the right condition numbers."""

import casadi as ca
import numpy as np
import pytest

from designs.maglev_5dof.paper import polynomial
from models import maglev_stage
from synth.analyse.numerics import magnitude, nearest_root
from synth.analyse.structure import singularity
from synth.errors import ModelError
from synth.signals import Signal

X = ca.SX.sym("x", 6)
BOX = (Signal("a", "m", -1.0, 2.0), Signal("b", "rad", 0.1, 1.0), Signal("c", "s", -0.3, 0.7))
WIDE = (*BOX, *(Signal(n, "1", -1.0, 1.5) for n in "def"))
INPUTS = (Signal("u1", "N", -2.0, 2.0), Signal("u2", "A", -0.1, 0.3))


def of(matrix: ca.SX, signals: tuple[Signal, ...] = BOX, inputs: tuple[Signal, ...] = INPUTS) -> singularity.Scaled:
    labels = [f"y{k + 1}" for k in range(matrix.size1())]
    return singularity.scaled(matrix, X[: len(signals)], signals, inputs[: matrix.size2()], labels)


def matrix_of_determinant(a: ca.SX, b: ca.SX) -> ca.SX:
    """Return a matrix of determinant a."""
    return ca.vertcat(ca.horzcat(ca.cos(b), -a * ca.sin(b)), ca.horzcat(ca.sin(b), a * ca.cos(b)))


def test_a_determinant_that_changes_sign_names_the_one_signal() -> None:
    worst = singularity.worst(of(matrix_of_determinant(X[0] - 0.3217, X[1])))
    assert worst.singular and np.isinf(worst.condition)
    assert worst.at["a"] == pytest.approx(0.3217, abs=1e-12)
    assert worst.where == "a = 0.3217 m"


def test_a_zero_without_a_change_of_sign_is_found_off_the_grid() -> None:
    worst = singularity.worst(of(matrix_of_determinant((X[0] - 0.3217) ** 2 + (X[2] - 0.111) ** 2, X[1])))
    assert worst.singular
    assert (worst.at["a"], worst.at["c"]) == (pytest.approx(0.3217, abs=1e-4), pytest.approx(0.111, abs=1e-4))
    assert not singularity.worst(of(matrix_of_determinant(1e-3 + (X[0] - 0.3217) ** 2, X[1]))).singular


def test_a_row_that_vanishes_where_both_entries_do() -> None:
    worst = singularity.worst(of(ca.horzcat(X[0] - 0.3217, X[1] - 0.456)))
    assert worst.singular and worst.at["b"] == pytest.approx(0.456, abs=1e-8)
    assert worst.where == "a = 0.3217 m, b = 0.456 rad"


def test_six_signals_are_searched() -> None:
    worst = singularity.worst(of(matrix_of_determinant(ca.sum1(X) - 2.0, X[1] * X[5]), WIDE))
    assert worst.singular and sum(worst.at.values()) == pytest.approx(2.0, abs=1e-9)
    far = singularity.worst(of(matrix_of_determinant(9.0 - ca.sum1(X[[0, 3, 4, 5]]), X[1] + X[2]), WIDE))
    assert not far.singular
    assert [far.at[n] for n in "adef"] == [2.0, 1.5, 1.5, 1.5]  # the determinant is least at this vertex


def bumpy() -> tuple[float, float]:
    """Return the worst condition of a matrix, and the worst of many samples."""
    matrix = of(matrix_of_determinant(1.2 + ca.sin(3 * X[0]) * X[1], X[2]) + 0.1 * X[0] * X[1])
    return singularity.worst(matrix).condition, float(
        matrix.condition(nearest_root.scatter(matrix.box, 20000, 5)).max()
    )


def test_no_sample_is_worse() -> None:
    worst, sampled = bumpy()
    assert 0.8 * worst < sampled <= worst * (1 + 1e-9)


def test_the_condition_does_not_depend_on_units() -> None:
    matrix = matrix_of_determinant(X[0] + 2.0, X[1])
    here = singularity.worst(of(matrix)).condition
    in_other_units = ca.diag(ca.SX([1e6, 1e-3])) @ matrix @ ca.diag(ca.SX([1e-3, 1e4]))
    inputs = (Signal("u1", "N", -2e3, 2e3), Signal("u2", "A", -1e-5, 3e-5))
    assert singularity.worst(of(in_other_units, inputs=inputs)).condition == pytest.approx(here, rel=1e-9)


def test_the_stage_agrees_with_the_magnitudes() -> None:
    """Where rows and columns have size 1 the condition number is the other module's, up to that of the strongest."""
    model = polynomial.simplified(polynomial.input_polynomial(maglev_stage.nominal()))
    states = tuple(s for s in maglev_stage.STATES if s.name in ("y", "phi", "theta"))
    symbols = {s.name: model.x[s.name] for s in states}
    D = ca.densify(model.decoupling())
    inputs = tuple(Signal(n, "A", -1.0, 1.0) for n in polynomial.TRANSFORMED)
    scaled = singularity.scaled(D, ca.vcat(list(symbols.values())), states, inputs, ("y", "phi", "theta"))
    rows = ca.mtimes(ca.diag(ca.SX(1 / scaled.rows)), D)
    other = magnitude.conditioning(rows, symbols, states)
    here = singularity.worst(scaled)
    at = scaled.at(np.array([list(other.cond_at.values())]).T)[0]
    assert np.linalg.cond(at) == pytest.approx(other.max_cond, rel=1e-6)
    assert not here.singular and other.min_abs_det > 0
    assert other.max_cond <= here.condition * (1 + 1e-6)  # S is at least the largest singular value at that point


def test_a_constant_matrix_and_a_pole() -> None:
    worst = singularity.worst(of(ca.SX([[1.0, 2.0], [3.0, 4.0]])))
    assert worst.where == "every point" and worst.condition > 1
    with pytest.raises(ModelError, match=r"has a pole near a = 0\.\d+ m.*changes sign without a zero; shrink"):
        singularity.worst(of(matrix_of_determinant(1 / (X[0] - 0.3217), X[1])))
    with pytest.raises(ModelError, match="row of 'y2' is zero on the whole domain"):
        of(ca.vertcat(ca.horzcat(X[0], 1), ca.SX.zeros(1, 2)))
    with pytest.raises(ModelError, match="not finite at a = 0 m: shrink"):
        of(ca.horzcat(1 / X[0], X[0]), (Signal("a", "m", -1.0, 1.0),))
