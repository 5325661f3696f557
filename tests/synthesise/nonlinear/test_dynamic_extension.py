"""Extended plants are the plants they extend, have the degrees of the textbooks, and hopeless ones are refused."""

from collections.abc import Mapping
from dataclasses import replace

import casadi as ca
import numpy as np
import pytest

from models import maglev_stage
from synth.analyse import box, lie
from synth.errors import ModelError, SignalError
from synth.plant import Plant, build
from synth.signals import Signal, dimension
from synth.synthesise.nonlinear import dynamic_extension
from synth.synthesise.nonlinear.dynamic_extension import Extension
from tests import textbook_plants, tolerances

Array = np.ndarray


def decoupling(extension: Extension, x: Array) -> Array:
    degree = extension.degree
    return ca.Function("D", [degree.model.x], [ca.densify(degree.decoupling)])(x).full()


def values_by_name(plant: Plant, x: Array) -> Mapping[str, float]:
    return dict(zip((s.name for s in plant.states), x, strict=True))


def test_the_unicycle_rides_with_an_integrator_on_its_speed() -> None:
    """[[cos, -v sin], [sin, v cos]], of determinant v."""
    extension = dynamic_extension.extend(textbook_plants.unicycle())
    assert extension.integrators == ("v",) and extension.degree.degrees == (2, 2)
    assert [s.name for s in extension.plant.inputs] == ["v_rate", "turn"]
    for x in box.scatter(extension.plant.states, 10, 1).T:
        at = values_by_name(extension.plant, x)
        c, s, v = np.cos(at["theta"]), np.sin(at["theta"]), at["v"]
        np.testing.assert_allclose(decoupling(extension, x), [[c, -v * s], [s, v * c]], atol=1e-14)
    assert extension.degree.worst.singular and extension.degree.worst.where == "v = 0 m/s"
    with pytest.raises(ModelError, match=r"decoupling matrix of \(px, py\) is singular .* at v = 0 m/s: shrink"):
        extension.degree.require_constant_rank()
    dynamic_extension.extend(textbook_plants.unicycle(0.2)).degree.require_constant_rank()


def test_the_aircraft_flies_flat_with_two_integrators_on_its_thrust() -> None:
    """[[-sin, -T cos], [cos, -T sin]], of determinant T; (4, 4) of 8 states."""
    extension = dynamic_extension.extend(textbook_plants.aircraft(0.0))
    assert extension.integrators == ("T", "T_rate") and extension.degree.degrees == (4, 4)
    assert len(extension.plant.states) == 8
    for x in box.scatter(extension.plant.states, 10, 1).T:
        at = values_by_name(extension.plant, x)
        c, s, T = np.cos(at["theta"]), np.sin(at["theta"]), at["T"]
        np.testing.assert_allclose(decoupling(extension, x), [[-s, -T * c], [c, -T * s]], atol=1e-13)
    extension.degree.require_constant_rank()


def test_two_wheels_share_one_integrator() -> None:
    """What is delayed is the sum of both wheels' speeds: an integrator on each would delay the turn, too."""
    extension = dynamic_extension.extend(textbook_plants.wheels())
    assert extension.degree.degrees == (2, 2) and len(extension.integrators) == 1
    (sum_,) = (s for s in extension.plant.states if s.name not in ("x", "y", "theta"))
    assert sum_.name.endswith("_mixed") and sum_.unit == "m/s" and (sum_.low, sum_.high) == pytest.approx((0.4, 2.0))


def test_without_the_mixture_the_wheels_are_not_served(monkeypatch: pytest.MonkeyPatch) -> None:
    """The planted defect: an integrator on one wheel alone, then on the other, and so on."""
    right = dynamic_extension._mixing
    monkeypatch.setattr(
        dynamic_extension, "_mixing", lambda degree: replace(right(degree), rows=ca.SX(1, len(degree.model.inputs)))
    )
    try:
        extension = dynamic_extension.extend(textbook_plants.wheels())
    except ModelError as error:
        assert "cannot be decoupled" in str(error)
    else:
        assert len(extension.integrators) > 1


def trailer() -> Plant:
    """A unicycle pulls a trailer, 0.8 m behind, whose position is the output: flat, of degree (3, 3)."""
    states = [Signal(n, "m", -1, 1) for n in ("x", "y")]
    states += [Signal("heading", "rad", -1, 1), Signal("trailer", "rad", -0.4, 0.4)]
    inputs = [Signal("v", "m/s", 0.2, 1.0), Signal("turn", "rad/s", -2, 2)]

    def physics(
        x: Mapping[str, ca.SX], u: Mapping[str, ca.SX], p: Mapping[str, ca.SX]
    ) -> tuple[dict[str, ca.SX], dict[str, ca.SX]]:
        rates = {"x": u["v"] * ca.cos(x["heading"]), "y": u["v"] * ca.sin(x["heading"]), "heading": u["turn"]}
        rates["trailer"] = u["v"] * ca.sin(x["heading"] - x["trailer"]) / 0.8
        return rates, {"px": x["x"] - 0.8 * ca.cos(x["trailer"]), "py": x["y"] - 0.8 * ca.sin(x["trailer"])}

    return build("trailer", states, inputs, [Signal("px", "m", -2, 2), Signal("py", "m", -2, 2)], [], physics)


def test_the_trailer_is_flat_by_two_integrators() -> None:
    """Its speed is v cos(heading - trailer), whose rate the turn enters beside v_rate."""
    extension = dynamic_extension.extend(trailer())
    assert extension.integrators == ("v", "v_rate_mixed") and extension.degree.degrees == (3, 3)
    extension.degree.require_constant_rank()


def mismatch(plant: Plant, extension: Extension, sign: float = 1.0) -> float:
    """Return how far the extended plant's rates are from the plant's with the inputs recovered."""
    n, worst = len(plant.states), 0.0
    states, inputs = box.scatter(extension.plant.states, 20, 2), box.scatter(extension.plant.inputs, 20, 3)
    for x, u in zip(states.T, inputs.T, strict=True):
        before = sign * extension.recovered(x, u).full().ravel()
        for whole, part, count in ((extension.plant.f, plant.f, n), (extension.plant.h, plant.h, len(plant.outputs))):
            extended = whole(x, u, extension.plant.values).full().ravel()[:count]
            worst = max(worst, float(np.abs(extended - part(x[:n], before, plant.values).full().ravel()).max()))
    return worst


@pytest.mark.parametrize("name", ["unicycle", "aircraft", "wheels"])
def test_the_extended_plant_is_the_plant_with_the_inputs_recovered(name: str) -> None:
    plant = {
        "unicycle": textbook_plants.unicycle(),
        "aircraft": textbook_plants.aircraft(0.0),
        "wheels": textbook_plants.wheels(),
    }[name]
    extension = dynamic_extension.extend(plant)
    assert mismatch(plant, extension) < tolerances.of("double")
    assert mismatch(plant, extension, sign=-1.0) > 0.1


def test_integrators_hold_what_their_inputs_say() -> None:
    plant = textbook_plants.aircraft(0.0)
    extension = dynamic_extension.extend(plant)
    x, u = box.scatter(extension.plant.states, 1, 5)[:, 0], np.array([0.7, -0.3])
    rates = values_by_name(extension.plant, extension.plant.f(x, u, extension.plant.values).full().ravel())
    at = values_by_name(extension.plant, x)
    assert rates["T"] == at["T_rate"] and rates["T_rate"] == 0.7
    assert extension.recovered(x, u).full().ravel().tolist() == [at["T"], -0.3]
    units = {s.name: s.unit for s in (*extension.plant.states, *extension.plant.inputs)}
    assert units["T_rate"] == "m/s^3" and units["T_rate_rate"] == "m/s^4"


def test_an_input_that_is_held_stays_an_input() -> None:
    """A tow of 0.2 m/s along x beside the unicycle's own speed."""
    without_tow = textbook_plants.unicycle(0.3)
    plant = build(
        "towed",
        without_tow.states,
        [without_tow.inputs[0], Signal("tow", "m/s", -1, 1), without_tow.inputs[1]],
        without_tow.outputs,
        [],
        lambda x, u, p: (
            {
                "x": u["v"] * ca.cos(x["theta"]) + u["tow"],
                "y": u["v"] * ca.sin(x["theta"]),
                "theta": u["turn"] + 0.1 * u["tow"],
            },
            {"px": x["x"], "py": x["y"]},
        ),
    )
    extension = dynamic_extension.extend(plant, held={"tow": 0.2})
    assert extension.integrators == ("v",) and extension.degree.degrees == (2, 2)
    assert [s.name for s in extension.plant.inputs] == ["v_rate", "tow", "turn"]
    assert mismatch(plant, extension) < tolerances.of("double")


def test_nothing_is_added_where_the_degree_is_defined() -> None:
    plant = textbook_plants.aircraft(0.3)
    extension = dynamic_extension.extend(plant)
    assert extension.plant is plant and extension.integrators == () and "none needed" in repr(extension)


def dependent(second: ca.Function) -> Plant:
    """a' = u1, b' = u2, c' = b: outputs a and a function of a."""
    states = [Signal(n, "1", 0.5, 1.5) for n in ("a", "b", "c")]
    return build(
        "pair",
        states,
        [Signal(n, "1", -1, 1) for n in ("u1", "u2")],
        [Signal("one", "1", 0, 2), Signal("other", "1", 0, 4)],
        [],
        lambda x, u, p: ({"a": u["u1"], "b": u["u2"], "c": x["b"]}, {"one": x["a"], "other": second(x["a"])}),
    )


def test_an_output_that_is_a_function_of_another_is_refused() -> None:
    a = ca.SX.sym("a")
    plant = dependent(ca.Function("square", [a], [a**2 + ca.sin(a)]))
    with pytest.raises(
        ModelError, match=r"'pair' cannot be decoupled .*with 3 of them .*'other' on \(one\); .*right inv"
    ):
        dynamic_extension.extend(plant)
    with pytest.raises(ModelError, match="with 1 of them rows"):
        dynamic_extension.extend(plant, bound=1)


def test_a_bound_that_is_too_low_is_reported() -> None:
    with pytest.raises(ModelError, match=r"with 1 of them .* raise the bound"):
        dynamic_extension.extend(textbook_plants.aircraft(0.0), bound=1)


def test_more_outputs_than_inputs_are_refused_at_once() -> None:
    with pytest.raises(ModelError, match=r"2 outputs \(px, pz\) meet 1 inputs \(T\)"):
        dynamic_extension.extend(textbook_plants.aircraft(0.0), held={"M": 0.0})


def test_the_row_that_does_not_vanish_gives_the_mixture() -> None:
    """Both rows are multiples of u1 + 2 u2; the first, sin(a) (u1 + 2 u2), vanishes at a = 0."""
    states = [Signal("a", "1", -1.0, 1.0), Signal("b", "1", -1, 1), Signal("c", "1", 0.5, 1.5)]
    plant = build(
        "mixed",
        states,
        [Signal("u1", "1", -1, 1), Signal("u2", "1", 0.1, 1)],
        [Signal("one", "1", -2, 2), Signal("two", "1", -2, 2)],
        [],
        lambda x, u, p: (
            {
                "a": ca.sin(x["c"]) * (u["u1"] + 2 * u["u2"]),
                "b": ca.cos(x["c"] - 0.5) * (u["u1"] + 2 * u["u2"]),
                "c": u["u2"],
            },
            {"one": x["a"], "two": x["b"]},
        ),
    )
    extension = dynamic_extension.extend(plant)
    assert extension.degree.degrees == (2, 2) and len(extension.integrators) == 1
    assert mismatch(plant, extension) < tolerances.of("double")


def test_integrators_make_the_stage_affine() -> None:
    plant = maglev_stage.plant()
    extended = dynamic_extension.add_integrators(plant, [s.name for s in plant.inputs])
    model = lie.affine(extended, list(maglev_stage.RATE))
    assert len(model.states) == 16 and [s.name for s in model.inputs][-1] == "u_z_rate"
    rate = next(s for s in model.inputs if s.name == "i_d1_rate")
    assert dimension(rate.unit) == dimension("A/s") and rate.high == pytest.approx(2 * maglev_stage.PEAK)
    some = dynamic_extension.add_integrators(plant, ["u_z", "u_x"])
    assert [s.name for s in some.states[10:]] == ["u_x", "u_z"]
    assert [s.name for s in some.inputs] == ["i_d1", "i_d2", "i_d3", "i_d4", "u_x_rate", "u_z_rate"]


def test_integrators_of_the_tank_give_its_flow() -> None:
    L, U = ca.SX.sym("level"), ca.SX.sym("flow")
    plant = textbook_plants.with_input(ca.Function("rate", [L, U], [L * U**2]))
    extension = dynamic_extension.add_integrators(plant, ["flow"])
    rates = extension.f([1.5, 0.5], [0.25], []).full().ravel()
    assert rates.tolist() == [-1.5 + 1.5 * 0.25, 0.25]


@pytest.mark.parametrize("inputs", [["flow"], ["T", "T"]])
def test_integrators_before_what_is_no_input_are_refused(inputs: list[str]) -> None:
    with pytest.raises(SignalError, match=r"name inputs of 'aircraft', T, M, each once"):
        dynamic_extension.add_integrators(textbook_plants.aircraft(0.1), inputs)


def test_a_name_that_is_taken_is_refused() -> None:
    plant = build(
        "taken",
        [Signal("v", "1", -1, 1)],
        [Signal("v", "1", -1, 1)],
        [Signal("y", "1", -1, 1)],
        [],
        lambda x, u, p: ({"v": u["v"]}, {"y": x["v"]}),
    )
    with pytest.raises(SignalError, match="'v' is declared 2 times"):
        dynamic_extension.add_integrators(plant, ["v"])
