"""The affine form is the plant's own equation, and errors name non-affine equations with their inputs."""

import casadi as ca
import numpy as np
import pytest

from models import maglev_stage
from synth.analyse.numerics import nearest_root
from synth.analyse.structure import relative_degree
from synth.errors import ModelError
from tests import textbook_plants, tolerances

L, U = ca.SX.sym("level"), ca.SX.sym("flow")


def tank(rate: ca.SX) -> relative_degree.Affine:
    return relative_degree.affine(textbook_plants.with_input(ca.Function("rate", [L, U], [rate])))


def test_f_and_G_are_the_plants_own() -> None:
    plant = textbook_plants.aircraft(0.3)
    model = relative_degree.affine(plant, ["pz"])
    parts = ca.Function(
        "parts", [model.x, model.box.constants], [model.f, ca.densify(model.G), model.h, ca.densify(model.E)]
    )
    states, inputs = nearest_root.scatter(plant.states, 10, 1), nearest_root.scatter(plant.inputs, 10, 2)
    for x, u in zip(states.T, inputs.T, strict=True):
        f, G, h, E = (v.full() for v in parts(x, plant.values))
        np.testing.assert_allclose(f.ravel() + G @ u, plant.f(x, u, plant.values).full().ravel(), atol=1e-14)
        assert h.item() == x[2] and not E.any()


def test_derivatives_along_f_and_G_are_finite_differences() -> None:
    model = relative_degree.affine(textbook_plants.ball_and_beam(0.1))
    e = ca.sin(model.x[0]) * model.x[3] ** 2
    at = ca.Function("at", [model.x], [e, model.along_drift(e), ca.densify(model.along_inputs(e)), model.f, model.G])
    x, step = np.array([0.4, 0.3, 0.2, 0.7]), 1e-6
    _, drift, row, f, G = (v.full().ravel() for v in at(x))
    for slope, way in ((drift, f), (row, G)):
        difference = (at(x + step * way)[0] - at(x - step * way)[0]) / (2 * step)
        assert float(difference) == pytest.approx(slope.item(), rel=1e-8)


@pytest.mark.parametrize(
    "rate", [U, U * ca.sin(L), (U + 1) ** 2 - U**2, U * L / U, ca.sqrt(L) * (U - 3), (L + U) ** 2 - U * U]
)
def test_plants_that_are_affine_after_simplification_are_accepted(rate: ca.SX) -> None:
    model = tank(rate)
    parts = ca.Function("p", [model.x], [model.f, ca.densify(model.G)])
    expected = ca.Function("e", [L, U], [-L + rate])
    f, G = (float(v) for v in parts(0.9))
    assert f + 0.37 * G == pytest.approx(float(expected(0.9, 0.37)), rel=tolerances.of("double"))


def test_the_stage_is_not_affine_and_every_equation_is_named() -> None:
    with pytest.raises(ModelError) as caught:
        relative_degree.affine(maglev_stage.plant())
    text = str(caught.value)
    assert "the rate of 'vy' in i_d1, i_d2, i_d3, i_d4, u_x, u_z;" in text
    assert "the rate of 'wphi' in i_d1, i_d3, u_z;" in text and "'wtheta' in i_d2, i_d4, u_x." in text
    assert "'vx'" not in text and "'vz'" not in text
    with pytest.raises(ModelError, match=r"'vy' in u_x, u_z; .*Make u_x, u_z states"):
        relative_degree.affine(maglev_stage.plant(), held=dict.fromkeys(("i_d1", "i_d2", "i_d3", "i_d4"), 0.5))
