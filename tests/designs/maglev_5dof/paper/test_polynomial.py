"""The polynomial forms of the five-axis model against the model, and the law (12) that inverts one of them."""

from collections.abc import Mapping

import casadi as ca
import numpy as np
import pytest

from designs.maglev_5dof.paper import polynomial
from models import maglev_stage
from synth.errors import ModelError
from tests.models.test_maglev_stage import VALUES, force_factors, printed_accelerations, random_points, random_v


def evaluate(model: polynomial.InputPolynomial, exprs: list[ca.SX], point: Mapping[str, float]) -> np.ndarray:
    symbols = {**model.x, **model.u, **model.v}
    f = ca.Function("f", [ca.vcat(list(symbols.values()))], [ca.vcat(exprs)])
    return np.asarray(f([point[n] for n in symbols])).ravel()


@pytest.mark.parametrize("lv3", ["csch2", "coth2"])
def test_the_polynomial_sums_to_the_full_model(lv3: str) -> None:
    model = polynomial.input_polynomial(maglev_stage.nominal(), lv3)
    for at in random_v(20):
        values = evaluate(model, list(model.accelerations().values()), at)
        u = at | {n: float(i) for n, i in maglev_stage.input_transformation(at).items()}
        assert np.abs(values - printed_accelerations(at, u, lv3)).max() < 1e-11


def test_the_simplified_model_is_the_full_one_without_the_dropped_terms() -> None:
    full = polynomial.input_polynomial(maglev_stage.nominal())
    kept = polynomial.simplified(full)
    assert set(full.coefficients) - set(kept.coefficients) == set(polynomial.NEGLIGIBLE)
    for at in random_v(10):
        c = dict(zip(full.coefficients, evaluate(full, list(full.coefficients.values()), at), strict=True))
        vy, vphi, vtheta = (at[n] for n in polynomial.TRANSFORMED)
        y = c["a4"] * vphi * vy + c["a5"] * vphi**2 + c["a6"] * vy**2 + c["a8"] * vy * vtheta + c["a9"] * vtheta**2
        phi = c["b4"] * vphi * vy + c["b5"] * vphi**2 + c["b6"] * vy**2
        theta = c["c4"] * vy * vtheta + c["c5"] * vtheta**2 + c["c6"] * vy**2
        whole, rest = (evaluate(m, list(m.accelerations().values()), at) for m in (full, kept))
        assert np.allclose(whole - rest, [y, 0, 0, phi, theta], rtol=0, atol=1e-11)
        matrix = evaluate(kept, [ca.vec(kept.decoupling().T)], at).reshape(3, 3)
        expected = [[c["a3"], c["a2"], c["a7"]], [c["b3"], c["b2"], 0], [c["c3"], 0, c["c2"]]]
        assert np.allclose(matrix, expected, rtol=1e-12)
        assert matrix[1, 1] < 0 and matrix[2, 2] < 0


def test_coefficients_depend_on_what_is_printed_in_their_brackets() -> None:
    model = polynomial.input_polynomial(maglev_stage.nominal())
    both, by_phi, by_theta = {"y", "phi", "theta"}, {"y", "phi"}, {"y", "theta"}
    printed_arguments = {"a1": both | {"u_x", "u_z"}, "a3": both, "a6": both, "h_x": by_theta, "h_z": by_phi}
    printed_arguments |= dict.fromkeys(("a2", "a4", "a5", "b2", "b3", "b4", "b5", "b6"), by_phi)
    printed_arguments |= dict.fromkeys(("a7", "a8", "a9", "c2", "c3", "c4", "c5", "c6"), by_theta)
    printed_arguments |= {"b1": by_phi | {"u_z"}, "c1": by_theta | {"u_x"}}
    assert {n: {s.name() for s in ca.symvar(e)} for n, e in model.coefficients.items()} == printed_arguments


def test_unknown_names_are_refused() -> None:
    model = polynomial.input_polynomial(maglev_stage.nominal())
    with pytest.raises(ModelError, match="a10"):
        polynomial.simplified(model, ["a10"])
    with pytest.raises(ModelError, match="h_x"):
        polynomial.simplified(model, ["h_x"])


def test_parameters_may_stay_symbols() -> None:
    p = maglev_stage.parameter_symbols()
    model = polynomial.input_polynomial(p)
    f = ca.Function("a3", [ca.vcat(list(model.x.values())), ca.vcat(list(p.values()))], [model.coefficients["a3"]])
    at_rest = [0.025, 0.0, 0.0]
    slope = force_factors(0.025, "csch2")["v2"]
    for mass in (6.9, 7.0):
        expected = 2 * slope / mass  # v_y / 2 into each of four motors
        assert float(f(at_rest, list((VALUES | {"M_y": mass}).values()))) == pytest.approx(expected, rel=1e-12)


def reached(flip: str = "") -> float:
    """Return the largest error of (11) under (12), with the sign of one current changed."""
    model = polynomial.simplified(polynomial.input_polynomial(maglev_stage.nominal()))
    axes, rng, worst = tuple(maglev_stage.RATE), np.random.default_rng(11), 0.0
    second = list(model.accelerations().values())
    for x, _ in random_points(20):
        at = {n: x[n] for n in ("y", "phi", "theta")}
        w = dict(zip(axes, rng.uniform(-10, 10, 5), strict=True))
        position = {n: ca.SX(v) for n, v in at.items()}
        law = polynomial.inverse(model, {n: ca.SX(v) for n, v in w.items()})
        currents = {n: -e if n == flip else e for n, e in law.items()}
        old, new = (ca.vcat([d[n] for n in model.x]) for d in (model.x, position))
        v = {n: float(ca.DM(ca.substitute(e, old, new))) for n, e in currents.items()}
        worst = max(worst, float(np.abs(evaluate(model, second, at | v) - list(w.values())).max()))
    return worst


def test_the_law_makes_double_integrators_of_the_simplified_model_and_a_wrong_sign_does_not() -> None:
    assert reached() < 1e-10
    assert all(reached(flip) > 1.0 for flip in ("v_y", "v_phi", "v_theta", "u_x", "u_z"))


def test_without_rotations_the_law_keeps_the_platen_level() -> None:
    """All direct currents are alike, and the first row of (12) alone is met."""
    w = {n: ca.SX(v) for n, v in {"y": 1.0, "x": 0.5, "z": -0.5, "phi": 3.0, "theta": 3.0}.items()}
    law = polynomial.law(maglev_stage.nominal(), "csch2", {"y": ca.SX(0.025)}, w)
    i_d = [float(law[f"i_d{j}"]) for j in range(1, 5)]
    assert max(i_d) - min(i_d) == 0.0
    model = polynomial.simplified(polynomial.input_polynomial(maglev_stage.nominal()))
    at = {"y": 0.025, "phi": 0.0, "theta": 0.0, "v_y": 2 * i_d[0], "v_phi": 0.0, "v_theta": 0.0}
    at |= {n: float(law[n]) for n in ("u_x", "u_z")}
    assert evaluate(model, [model.accelerations()["y"]], at) == pytest.approx([1.0], abs=1e-12)
