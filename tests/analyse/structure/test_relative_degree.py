"""Degrees, decoupling matrices and drifts of textbook plants against those derived by hand, and by differences."""

from collections.abc import Callable, Sequence

import casadi as ca
import numpy as np
import pytest
from scipy.integrate import solve_ivp

from designs.maglev_5dof.paper import polynomial
from models import maglev_stage
from synth.analyse.numerics import nearest_root
from synth.analyse.structure import relative_degree
from synth.analyse.structure.relative_degree import RelativeDegree
from synth.errors import ModelError
from synth.plant import Plant, build
from synth.signals import Parameter, Signal
from tests import textbook_plants, tolerances
from tests.textbook_plants import MASS, B, G

Array = np.ndarray
FLOW = tolerances.of("flow")


def evaluate(degree: RelativeDegree, x: Sequence[float]) -> tuple[Array, Array]:
    """Return D (p, m) and the drift (p,) at a state."""
    D, a = ca.Function("D", [degree.model.x], [ca.densify(degree.decoupling), ca.densify(degree.drift)])(x)
    return D.full(), a.full().ravel()


def beam_by_hand(x: Array) -> tuple[list[list[float]], list[float]]:
    r, vr, theta, w = x
    return [[2 * B * r * w]], [B * w * (vr * w - G * np.cos(theta))]


def joint_by_hand(x: Array) -> tuple[list[list[float]], list[float]]:
    q1, w1, q2, _ = x
    MgL, inertia, J, k = MASS.values()
    sway, spring = MgL / inertia, k / inertia
    first = sway * np.sin(q1) * (w1**2 + sway * np.cos(q1) + spring)
    return [[k / (inertia * J)]], [first + spring * (q1 - q2) * (spring + k / J + sway * np.cos(q1))]


def aircraft_by_hand(x: Array) -> tuple[list[list[float]], list[float]]:
    c, s, eps = np.cos(x[4]), np.sin(x[4]), 0.3
    return [[-s, eps * c], [c, eps * s]], [0.0, -1.0]


@pytest.mark.parametrize(
    ("plant", "degrees", "by_hand"),
    [
        (textbook_plants.ball_and_beam(0.1), (3,), beam_by_hand),
        (textbook_plants.flexible_joint(), (4,), joint_by_hand),
        (textbook_plants.aircraft(0.3), (2, 2), aircraft_by_hand),
    ],
)
def test_textbook_plants(
    plant: Plant, degrees: tuple[int, ...], by_hand: Callable[[Array], tuple[list[list[float]], list[float]]]
) -> None:
    degree = relative_degree.of_plant(plant)
    degree.require_constant_rank()
    assert degree.degrees == degrees
    for x in nearest_root.scatter(plant.states, 20, 11).T:
        for here, there in zip(evaluate(degree, x), by_hand(x), strict=True):
            np.testing.assert_allclose(here, there, rtol=tolerances.of("double"), atol=1e-13)


def test_two_masses() -> None:
    plant = textbook_plants.two_masses()
    assert relative_degree.of_plant(plant, ["y1"]).degrees == (4,)
    assert relative_degree.of_plant(plant, ["y2"]).degrees == (2,)
    assert relative_degree.of_plant(textbook_plants.two_masses(0.7), ["y1"]).degrees == (3,)


def from_flow(plant: Plant, output: int, order: int, x0: Array, u: Array) -> float:
    """Return d^order y/dt^order at t = 0 with constant inputs, from simulations to both sides."""
    reach, count = 0.1, 12
    ends = reach * np.cos(np.pi * (np.arange(count) + 0.5) / count)

    def rate(t: float, x: Array) -> Array:
        return plant.f(x, u, plant.values).full().ravel()

    y = np.zeros(count)
    for side in (ends[ends > 0], np.sort(ends[ends < 0])[::-1]):
        times = np.sort(side) if side[0] > 0 else side
        run = solve_ivp(rate, (0, times[-1]), x0, t_eval=times, method="DOP853", rtol=1e-13, atol=1e-14)
        for t, x in zip(run.t, run.y.T, strict=True):
            y[np.argmin(np.abs(ends - t))] = float(plant.h(x, u, plant.values)[output])
    fit = np.polynomial.Chebyshev.fit(ends, y, count - 1, domain=[-reach, reach])
    return float(fit.deriv(order)(0.0))


@pytest.mark.parametrize("name", ["ball_and_beam", "flexible_joint", "aircraft"])
def test_derivatives_along_simulated_flows(name: str) -> None:
    """y^(r) = a + D u, and no lower derivative depends on the input."""
    plant = {
        "ball_and_beam": textbook_plants.ball_and_beam(0.1),
        "flexible_joint": textbook_plants.flexible_joint(),
        "aircraft": textbook_plants.aircraft(0.3),
    }[name]
    degree = relative_degree.of_plant(plant)
    x = nearest_root.scatter(plant.states, 1, 3)[:, 0]
    inputs = nearest_root.scatter(plant.inputs, 2, 4).T
    D, a = evaluate(degree, x)
    for i, r in enumerate(degree.degrees):
        for u in inputs:
            assert from_flow(plant, i, r, x, u) == pytest.approx((a + D @ u)[i], rel=FLOW)
        lower = [from_flow(plant, i, r - 1, x, u) for u in inputs]
        assert lower[0] == pytest.approx(lower[1], rel=FLOW)


X1, X2 = ca.SX.sym("x1"), ca.SX.sym("x2")
NOTHING = [
    ca.sin(X1 + X2) - ca.sin(X1) * ca.cos(X2) - ca.cos(X1) * ca.sin(X2),
    (X1 + X2) ** 2 - X1**2 - 2 * X1 * X2 - X2**2,
    ca.log(X1 * X2) - ca.log(X1) - ca.log(X2),
    1e6 * (ca.tanh(X1) - ca.sinh(X1) / ca.cosh(X1)),
]


@pytest.mark.parametrize("number", range(len(NOTHING)))
def test_a_cancelling_term_does_not_count_as_an_input(number: int) -> None:
    degree = relative_degree.of_plant(textbook_plants.hidden(ca.Function("e", [X1, X2], [NOTHING[number]])))
    assert degree.degrees == (3,) and not degree.worst.singular


def test_a_small_input_is_an_input() -> None:
    degree = relative_degree.of_plant(textbook_plants.hidden(ca.Function("e", [X1, X2], [1e-12 * X1])))
    assert degree.degrees == (1,)


def test_cancelling_parameters_do_not_count_as_an_input() -> None:
    """0.1 + 0.2 - 0.3 in double is 5.6e-17; the terms are 0.3."""
    parameters = [Parameter(n, v, "1", 0.0, "chosen") for n, v in (("a", 0.1), ("b", 0.2), ("c", 0.3))]
    states = [Signal("x1", "m", -1, 1), Signal("x2", "m/s", -1, 1)]
    plant = build(
        "chain",
        states,
        [Signal("u", "m/s^2", -1, 1)],
        [Signal("y", "m", -1, 1)],
        parameters,
        lambda x, u, p: (
            {"x1": x["x2"] + (p["a"] + p["b"] - p["c"]) * u["u"] * x["x1"], "x2": u["u"]},
            {"y": x["x1"]},
        ),
    )
    assert relative_degree.of_plant(plant).degrees == (2,)
    assert relative_degree.of_plant(plant.with_parameters(c=0.31)).degrees == (1,)


def test_an_input_that_enters_the_output_itself() -> None:
    plant = build(
        "direct",
        [Signal("x", "m", -1, 1)],
        [Signal("u", "m", -1, 1)],
        [Signal("y", "m", -1, 1)],
        [],
        lambda x, u, p: ({"x": -x["x"] + u["u"]}, {"y": ca.sin(x["x"]) + 2 * u["u"]}),
    )
    degree = relative_degree.of_plant(plant)
    assert degree.degrees == (0,) and degree.chains[0].shape == (0, 1)
    D, a = evaluate(degree, [0.4])
    assert D.item() == 2.0 and a.item() == np.sin(0.4)


def test_the_beam_at_rest_is_refused_with_the_point() -> None:
    """L_g L_f^2 h = 2 B r w: no degree at r w = 0."""
    degree = relative_degree.of_plant(textbook_plants.ball_and_beam(-1.0))
    assert degree.degrees == (3,) and degree.worst.at["r"] * degree.worst.at["w"] == 0
    with pytest.raises(ModelError, match=r"degree of 'y' is not defined at r = 0 m: no input enters its derivative 3"):
        degree.require_constant_rank()
    assert "decoupling matrix: singular at r = 0 m" in repr(degree)


def test_rows_that_depend_are_named() -> None:
    degree = relative_degree.of_plant(textbook_plants.unicycle())
    assert degree.rows.independent == ("px",) and degree.rows.dependent == {"py": ("px",)}
    with pytest.raises(ModelError, match=r"depend on others everywhere, that of 'py' on 'px'\. Make inputs states of"):
        degree.require_constant_rank()
    assert relative_degree.of_plant(textbook_plants.aircraft(0.0)).rows.dependent == {"pz": ("px",)}
    assert not relative_degree.of_plant(textbook_plants.aircraft(1e-6)).rows.dependent


def test_only_the_rows_that_enter_a_dependence_are_named() -> None:
    states = [Signal(n, "1", 0.5, 1.5) for n in ("a", "b", "c")]
    plant = build(
        "three",
        states,
        [Signal(n, "1", -1, 1) for n in ("u1", "u2", "u3")],
        [Signal(n, "1", -2, 2) for n in ("first", "second", "third")],
        [],
        lambda x, u, p: (
            {
                "a": x["b"] * (u["u1"] + u["u2"]),
                "b": ca.exp(x["c"]) * (u["u1"] - 3 * u["u2"]),
                "c": x["a"] * (u["u1"] + u["u2"]) + x["b"],
            },
            {"first": x["a"], "second": x["b"], "third": x["c"]},
        ),
    )
    assert relative_degree.of_plant(plant).rows.dependent == {"third": ("first",)}


def simplified_stage() -> tuple[Plant, polynomial.InputPolynomial]:
    """The platen with (8) and (11), with the quadrature currents as states and their rates as inputs."""
    values = maglev_stage.nominal()
    model = polynomial.simplified(polynomial.input_polynomial(values))
    of_model = ca.vcat([*model.x.values(), *model.u.values(), *model.v.values()])
    second = ca.Function("second", [of_model], list(model.accelerations().values()))
    currents = [s for s in maglev_stage.INPUTS if s.name in ("u_x", "u_z")]
    inputs = [Signal(n, "A", -10, 10) for n in polynomial.TRANSFORMED]
    inputs += [Signal(f"{s.name}_rate", "A/s", -10, 10) for s in currents]

    def physics(x: textbook_plants.Symbols, u: textbook_plants.Symbols, p: textbook_plants.Symbols) -> tuple:
        point = [x[n] for n in (*model.x, "u_x", "u_z")] + [u[n] for n in polynomial.TRANSFORMED]
        accelerations = dict(zip(maglev_stage.RATE, second(ca.vertcat(*point)), strict=True))
        rates = {q: x[v] for q, v in maglev_stage.RATE.items()}
        rates |= {v: accelerations[q] for q, v in maglev_stage.RATE.items()}
        rates |= {s.name: u[f"{s.name}_rate"] for s in currents}
        return rates, {q: x[q] for q in maglev_stage.RATE}

    outputs = [s for s in maglev_stage.OUTPUTS if s.name in maglev_stage.RATE]
    return build("simplified", [*maglev_stage.STATES, *currents], inputs, outputs, [], physics), model


def test_the_simplified_stage_decouples_as_its_own_model_says() -> None:
    plant, model = simplified_stage()
    degree = relative_degree.of_plant(plant)
    assert dict(zip(degree.outputs, degree.degrees, strict=True)) == {"y": 2, "x": 3, "z": 3, "phi": 2, "theta": 2}
    degree.require_constant_rank()
    model_decoupling = ca.Function("own", [ca.vcat(list(model.x.values()))], [ca.densify(model.decoupling())])
    rows = [degree.outputs.index(n) for n in ("y", "phi", "theta")]
    for x in nearest_root.scatter(plant.states, 10, 4).T:
        at = dict(zip((s.name for s in plant.states), x, strict=True))
        D, _ = evaluate(degree, x)
        expected = model_decoupling([at[n] for n in ("y", "phi", "theta")]).full()
        np.testing.assert_allclose(D[rows, :3], expected, rtol=1e-10, atol=1e-12)
        assert not D[[degree.outputs.index("x"), degree.outputs.index("z")], :3].any()


def test_the_sheet_names_degrees_and_inputs() -> None:
    lines = repr(relative_degree.of_plant(textbook_plants.aircraft(0.3))).splitlines()
    assert lines[0] == "Relative degree of 'aircraft'"
    assert lines[1] == "sum 4 of 6 states: zero dynamics of order 2"
    assert lines[4].split()[:4] == ["px", "2", "T,", "M"]
