"""The affine form is the plant's own equation, and errors name non-affine equations with their inputs."""

import casadi as ca
import numpy as np
import pytest

from models import maglev_stage
from synth.analyse.numerics import box
from synth.analyse.structure import lie
from synth.errors import ModelError, SignalError
from tests import textbook_plants, tolerances

L, U = ca.SX.sym("level"), ca.SX.sym("flow")


def tank(rate: ca.SX) -> lie.Affine:
    return lie.affine(textbook_plants.with_input(ca.Function("rate", [L, U], [rate])))


def test_f_and_G_are_the_plants_own() -> None:
    plant = textbook_plants.aircraft(0.3)
    model = lie.affine(plant, ["pz"])
    parts = ca.Function(
        "parts", [model.x, model.box.constants], [model.f, ca.densify(model.G), model.h, ca.densify(model.E)]
    )
    states, inputs = box.scatter(plant.states, 10, 1), box.scatter(plant.inputs, 10, 2)
    for x, u in zip(states.T, inputs.T, strict=True):
        f, G, h, E = (v.full() for v in parts(x, plant.values))
        np.testing.assert_allclose(f.ravel() + G @ u, plant.f(x, u, plant.values).full().ravel(), atol=1e-14)
        assert h.item() == x[2] and not E.any()


def test_derivatives_along_f_and_G_are_finite_differences() -> None:
    model = lie.affine(textbook_plants.ball_and_beam(0.1))
    e = ca.sin(model.x[0]) * model.x[3] ** 2
    at = ca.Function("at", [model.x], [e, model.along_drift(e), ca.densify(model.along_inputs(e)), model.f, model.G])
    x, step = np.array([0.4, 0.3, 0.2, 0.7]), 1e-6
    _, drift, row, f, G = (v.full().ravel() for v in at(x))
    for slope, way in ((drift, f), (row, G)):
        difference = (at(x + step * way)[0] - at(x - step * way)[0]) / (2 * step)
        assert float(difference) == pytest.approx(slope.item(), rel=1e-8)


@pytest.mark.parametrize(
    "rate", [U**2, U * L * U, ca.fabs(U), ca.sign(U), ca.sin(U), ca.fmin(U, 0.5), L * U + 1e-9 * U**3, ca.exp(U) / L]
)
def test_non_affine_plants_are_refused_with_the_mend(rate: ca.SX) -> None:
    with pytest.raises(ModelError, match=r"'tank' is not affine .*rate of 'level' in flow\. Make flow states, with"):
        tank(rate)


@pytest.mark.parametrize(
    "rate", [U, U * ca.sin(L), (U + 1) ** 2 - U**2, U * L / U, ca.sqrt(L) * (U - 3), (L + U) ** 2 - U * U]
)
def test_plants_that_are_affine_after_simplification_are_accepted(rate: ca.SX) -> None:
    model = tank(rate)
    parts = ca.Function("p", [model.x], [model.f, ca.densify(model.G)])
    expected = ca.Function("e", [L, U], [-L + rate])
    f, G = (float(v) for v in parts(0.9))
    assert f + 0.37 * G == pytest.approx(float(expected(0.9, 0.37)), rel=tolerances.of("double"))


def test_an_output_that_is_not_affine_in_an_input_is_named() -> None:
    plant = textbook_plants.build(
        "tank",
        [textbook_plants.Signal("level", "m", 0.5, 2.0)],
        [textbook_plants.Signal("flow", "m/s", -1, 1)],
        [textbook_plants.Signal("y", "m", 0, 9)],
        [],
        lambda x, u, p: ({"level": u["flow"]}, {"y": u["flow"] ** 2}),
    )
    with pytest.raises(ModelError, match="not affine in its inputs: 'y' in flow"):
        lie.affine(plant)


def test_the_stage_is_not_affine_and_every_equation_is_named() -> None:
    with pytest.raises(ModelError) as caught:
        lie.affine(maglev_stage.plant())
    text = str(caught.value)
    assert "the rate of 'vy' in i_d1, i_d2, i_d3, i_d4, u_x, u_z;" in text
    assert "the rate of 'wphi' in i_d1, i_d3, u_z;" in text and "'wtheta' in i_d2, i_d4, u_x." in text
    assert "'vx'" not in text and "'vz'" not in text
    with pytest.raises(ModelError, match=r"'vy' in u_x, u_z; .*Make u_x, u_z states"):
        lie.affine(maglev_stage.plant(), held=dict.fromkeys(("i_d1", "i_d2", "i_d3", "i_d4"), 0.5))


def test_with_the_thrusts_held_and_one_direct_current_two_equations_are_not_affine() -> None:
    held = dict.fromkeys(("i_d2", "i_d3", "i_d4", "u_x", "u_z"), 0.0)
    with pytest.raises(ModelError, match=r"the rate of 'vy' in i_d1; the rate of 'wphi' in i_d1\. "):
        lie.affine(maglev_stage.plant(), held=held)


@pytest.mark.parametrize(
    ("outputs", "held", "text"),
    [
        (["pq"], {}, "no output 'pq': it has px, pz"),
        (["px", "px"], {}, "each once"),
        ([], {}, "name at least one"),
        (None, {"Q": 1.0}, "no input 'Q' to hold: it has T, M"),
        (None, {"T": np.nan}, "'T' is held at nan"),
        (None, {"T": 1.0, "M": 0.0}, "every input is held"),
    ],
)
def test_wrong_names_are_refused(outputs: list[str] | None, held: dict[str, float], text: str) -> None:
    with pytest.raises(SignalError, match=text):
        lie.affine(textbook_plants.aircraft(0.1), outputs, held)
