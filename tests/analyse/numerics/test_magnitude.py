"""Maxima over boxes against closed forms, sampling and figures for the stage; singular matrices are found."""

import casadi as ca
import numpy as np
import pytest

from designs.maglev_5dof.paper import polynomial
from models import maglev_stage
from synth.analyse.numerics import magnitude
from synth.errors import SignalError
from synth.signals import Signal

STATES = {s.name: s for s in maglev_stage.STATES}
ANGLES = (STATES["phi"], STATES["theta"])
LEVEL = {"u_x": 0.0, "u_z": 0.0}
X, Y, T = ca.SX.sym("X"), ca.SX.sym("Y"), ca.SX.sym("T")
SYMBOLS = {"X": X, "Y": Y, "T": T}
BOX = (Signal("X", "m", -1.0, 2.0), Signal("Y", "rad", 0.0, 1.0))


def of_stage(lv3: str) -> magnitude.Magnitudes:
    model = polynomial.input_polynomial(maglev_stage.nominal(), lv3)
    return magnitude.magnitudes(model.coefficients, {**model.x, **model.u}, ANGLES, "y", [0.02, 0.03], LEVEL)


FIGURES = [
    ("csch2", {"a6": 0.068848, "a8": 0.04312, "a9": 0.037865, "a5": 0.030983}, {"a2": 0.10141, "a6": 0.021986}),
    ("coth2", {"a2": 0.2305, "a3": 5.7708, "a7": 1.1545, "a6": 0.27736}, {}),
]


@pytest.mark.parametrize(("lv3", "at_20", "at_30"), FIGURES)
def test_figures_at_20_and_30_mm(lv3: str, at_20: dict[str, float], at_30: dict[str, float]) -> None:
    magnitudes = of_stage(lv3)
    for k, figures in enumerate((at_20, at_30)):
        for term, figure in figures.items():
            assert magnitudes.of(term)[k] == pytest.approx(figure, rel=5e-5), term


def dominates(magnitudes: magnitude.Magnitudes) -> bool:
    kept = ("a2", "a3", "a7")
    dropped = [n for n in polynomial.NEGLIGIBLE if n.startswith("a")]
    return min(magnitudes.of(n)[0] for n in kept) > max(magnitudes.of(n)[0] for n in dropped)


def test_the_kept_terms_dominate_with_csch2_alone() -> None:
    assert dominates(of_stage("csch2"))
    assert not dominates(of_stage("coth2"))


@pytest.mark.parametrize(("mm", "figure"), [(20, -17.501), (25, -5.2261), (30, 1.3445)])
def test_a1_when_level(mm: int, figure: float) -> None:
    model = polynomial.input_polynomial(maglev_stage.nominal())
    f = ca.Function("a1", [ca.vcat(list({**model.x, **model.u}.values()))], [model.coefficients["a1"]])
    assert float(f([mm * 1e-3, 0, 0, 0, 0])) == pytest.approx(figure, abs=6e-4)


def test_no_sample_exceeds_a_maximum() -> None:
    model = polynomial.input_polynomial(maglev_stage.nominal())
    magnitudes = of_stage("csch2")
    symbols = {**model.x, **model.u}
    f = ca.Function("f", [ca.vcat(list(symbols.values()))], [ca.vcat(list(model.coefficients.values()))])
    rng = np.random.default_rng(1)
    angles = np.array([rng.uniform(s.low, s.high, 5000) for s in ANGLES])
    rows = np.vstack([np.full(5000, 0.02), angles, np.zeros((2, 5000))])
    assert (np.abs(np.asarray(f(rows))).max(axis=1) <= magnitudes.maxima[0] * (1 + 1e-12)).all()
    at_worst = [f([0.02, *magnitudes.worst[0, j], 0, 0])[j] for j in range(len(magnitudes.terms))]
    assert np.abs(np.array(at_worst, dtype=float).ravel()) == pytest.approx(magnitudes.maxima[0], rel=1e-12)


def test_interior_and_vertex_maxima_of_known_functions() -> None:
    terms = {
        "peak": T * ca.exp(-(((X - 0.3141) / 0.2) ** 2) - (Y - 0.7183) ** 2),
        "trough": -T / (1 + (X - 1.234) ** 2 + (Y - 0.111) ** 2),
        "corner": X * (1 + Y) * T,
        "nothing": ca.SX(0),
    }
    magnitudes = magnitude.magnitudes(terms, SYMBOLS, BOX, "T", [1.0, 3.0], {})
    assert magnitudes.maxima == pytest.approx(np.array([[1, 1, 4, 0], [3, 3, 12, 0]]), rel=1e-9)
    assert magnitudes.worst[1, 0] == pytest.approx([0.3141, 0.7183], abs=1e-5)
    assert magnitudes.worst[0, 2] == pytest.approx([2.0, 1.0])
    with pytest.raises(SignalError, match="no term 'a1'"):
        magnitudes.of("a1")


def test_decoupling_of_the_stage_over_its_range() -> None:
    model = polynomial.simplified(polynomial.input_polynomial(maglev_stage.nominal()))
    conditioning = magnitude.conditioning(model.decoupling(), model.x, (STATES["y"], *ANGLES))
    assert conditioning.min_abs_det == pytest.approx(134.09, abs=5e-3)
    assert conditioning.max_cond == pytest.approx(3.6821, abs=5e-5)
    assert conditioning.det_at["y"] == pytest.approx(0.031)
    assert conditioning.cond_at["y"] == pytest.approx(0.018)


def test_a_change_of_sign_between_grid_points_is_found() -> None:
    matrix = ca.vertcat(ca.horzcat(X - 0.777, 0), ca.horzcat(0, 1 + Y))
    conditioning = magnitude.conditioning(matrix, SYMBOLS, BOX)
    assert conditioning.min_abs_det == 0.0
    assert conditioning.det_at["X"] == pytest.approx(0.777, abs=1e-9)


def test_a_determinant_that_only_touches_zero_is_found() -> None:
    touches = (X - 0.777) ** 2 + (Y - 0.333) ** 2
    matrix = ca.vertcat(ca.horzcat(touches, 0), ca.horzcat(0, 1))
    touching = magnitude.conditioning(matrix, SYMBOLS, BOX)
    assert touching.min_abs_det < 1e-9 and touching.det_at == pytest.approx({"X": 0.777, "Y": 0.333}, abs=1e-6)
    lifted = ca.vertcat(ca.horzcat(touches + 0.01, 0), ca.horzcat(0, 1))
    conditioning = magnitude.conditioning(lifted, SYMBOLS, BOX)
    assert conditioning.min_abs_det == pytest.approx(0.01, rel=1e-9)
    assert conditioning.max_cond == pytest.approx(100, rel=1e-6)


def test_the_largest_condition_number_is_met_where_a_row_is_largest() -> None:
    matrix = ca.vertcat(ca.horzcat(1 + Y, 0), ca.horzcat(0, 1))
    conditioning = magnitude.conditioning(matrix, SYMBOLS, BOX)
    assert conditioning.max_cond == pytest.approx(2.0) and conditioning.cond_at["Y"] == pytest.approx(1.0)
