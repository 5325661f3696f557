"""With the law in place the outputs' derivatives are the demands, and models that it cannot serve are refused."""

from collections.abc import Callable
from dataclasses import replace

import casadi as ca
import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.linalg import expm

from models import maglev_stage
from synth.analyse import operating_points
from synth.analyse.numerics import nearest_root, precise
from synth.analyse.structure import singularity
from synth.errors import ModelError, SignalError
from synth.plant import Plant, Symbols
from synth.synthesise.nonlinear import feedback_linearisation
from synth.synthesise.nonlinear.feedback_linearisation import Linearisation, linearise
from tests import textbook_plants, tolerances
from tests.textbook_plants import with_integrators

Q = ca.SX.sym("q", 3)
V = ca.SX.sym("v", 4)


def inputs(n: int) -> dict[str, ca.SX]:
    return {f"v{i}": V[i] for i in range(n)}


def demands(n: int) -> list[ca.SX]:
    return [ca.SX.sym(f"w{i}") for i in range(n)]


def random_model(n: int, seed: int) -> list[ca.SX]:
    """Random drift and decoupling, smooth in q, well away from singular."""
    rng = np.random.default_rng(seed)
    drift = [ca.sin(ca.dot(rng.normal(size=3), Q)) * rng.normal() for _ in range(n)]
    D = rng.normal(size=(n, n)) + 4 * np.eye(n)[rng.permutation(n)]
    scale = [ca.exp(0.1 * ca.dot(rng.normal(size=3), Q)) for _ in range(n)]
    return [drift[i] + scale[i] * sum(D[i, j] * V[j] for j in range(n)) for i in range(n)]


@pytest.mark.parametrize("n", [1, 2, 3, 4])
@pytest.mark.parametrize("seed", range(3))
def test_accelerations_become_the_demands(n: int, seed: int) -> None:
    q2, w = random_model(n, seed), demands(n)
    law = linearise(q2, inputs(n), w)
    closed = ca.substitute(ca.vcat(q2), V[:n], ca.vcat(list(law.inputs.values())))
    assert list(law.inputs) == [f"v{i}" for i in range(n)]
    f = ca.Function("f", [Q, ca.vcat(w)], [closed, law.decoupling, law.drift, law.determinant])
    open_loop = ca.Function("g", [Q, V], [ca.vcat(q2)])
    rng = np.random.default_rng(seed)
    for _ in range(20):
        q, demanded, v = rng.uniform(-1, 1, 3), rng.uniform(-1, 1, n), rng.normal(size=4)
        reached, D, drift, determinant = (m.full() for m in f(q, demanded))
        np.testing.assert_allclose(reached.ravel(), demanded, rtol=0, atol=1e-12)
        # NumPy's factorisation and the open loop know nothing of cofactors.
        np.testing.assert_allclose(determinant.item(), np.linalg.det(D), rtol=1e-10)
        np.testing.assert_allclose(drift.ravel() + D @ v[:n], open_loop(q, v).full().ravel(), rtol=0, atol=1e-12)


def test_a_perturbed_law_misses_the_demands() -> None:
    q2, w = random_model(2, 0), demands(2)
    v = [1.001 * e for e in linearise(q2, inputs(2), w).inputs.values()]
    closed = ca.Function("f", [Q, ca.vcat(w)], [ca.substitute(ca.vcat(q2), V[:2], ca.vcat(v))])
    assert np.abs(closed([0.1, 0.2, 0.3], [1, -1]).full().ravel() - [1, -1]).max() > 1e-12


def test_a_constant_model_and_one_of_different_scales_are_fitted() -> None:
    w = demands(2)
    law = linearise([3 * V[0] - 1, 1e-20 * V[0] + 2e-20 * V[1]], inputs(2), w)
    f = ca.Function("f", [ca.vcat(w)], list(law.inputs.values()))
    np.testing.assert_allclose([float(v) for v in f([5, 4e-20])], [2, 1], rtol=1e-15)


def test_zeros_of_the_decoupling_matrix_vanish_from_the_law() -> None:
    w = demands(2)
    law = linearise([Q[0] * V[0], Q[1] * V[1] + Q[2]], inputs(2), w)
    assert not ca.depends_on(law.inputs["v0"], ca.vertcat(w[1], Q[2]))


@pytest.mark.parametrize("element", [lambda q: q, lambda q: q - 0.5, lambda q: ca.sin(7 * q)])
def test_a_model_singular_at_points_is_served(element: Callable[[ca.SX], ca.SX]) -> None:
    law = linearise([element(Q[0]) * V[0]], inputs(1), demands(1))
    assert not law.determinant.is_zero()


def full_stage() -> Plant:
    """The platen with every quadratic term and an integrator before each current: 16 states."""
    return with_integrators(maglev_stage.plant(), [s.name for s in maglev_stage.INPUTS])


def lawful(name: str) -> Linearisation:
    plants: dict[str, Callable[[], Plant]] = {
        "ball_and_beam": lambda: textbook_plants.ball_and_beam(0.1),
        "flexible_joint": textbook_plants.flexible_joint,
        "aircraft": lambda: textbook_plants.aircraft(0.3),
        "flat aircraft": lambda: with_integrators(with_integrators(textbook_plants.aircraft(0.0), ["T"]), ["T_rate"]),
        "unicycle": lambda: with_integrators(textbook_plants.unicycle(0.2), ["v"]),
    }
    return feedback_linearisation.of_plant(plants[name]())


LAWFUL = ["ball_and_beam", "flexible_joint", "aircraft", "flat aircraft", "unicycle"]


@pytest.mark.parametrize("name", LAWFUL)
def test_the_normal_form_holds_and_planted_defects_do_not_pass(name: str) -> None:
    law = lawful(name)
    assert law.check().passed
    model = law.degree.model
    if law.degree.drift.nnz():
        sign = ca.solve(ca.densify(law.degree.decoupling), law.w + law.degree.drift)  # the drift with the wrong sign
        assert not replace(law, u=sign).check().passed
    for change in (-1, 1):
        degrees = tuple(max(r + change * (i == 0), 0) for i, r in enumerate(law.degree.degrees))
        assert not replace(law, degree=replace(law.degree, degrees=degrees)).check().passed
    assert not replace(law, u=law.u * (1 + 1e-9)).check().passed
    assert list(law.inputs) == [s.name for s in model.inputs]


def test_a_degree_read_too_low_for_want_of_a_bound_on_rounding_does_not_pass(monkeypatch: pytest.MonkeyPatch) -> None:
    """What is read as an input is rounding error, and so is the law: the check refuses it or does not pass."""
    a, b = ca.SX.sym("a"), ca.SX.sym("b")
    nothing = ca.sin(a + b) - ca.sin(a) * ca.cos(b) - ca.cos(a) * ca.sin(b)
    plant = textbook_plants.hidden(ca.Function("e", [a, b], [nothing]))
    right = feedback_linearisation.of_plant(plant)
    assert right.degree.degrees == (3,) and right.check().passed
    with monkeypatch.context() as planted:
        planted.setattr(precise, "LIMIT", 0.0)
        planted.setattr(singularity, "CONDITION_LIMIT", np.inf)
        with pytest.raises(ModelError, match="rounding error of constants"):
            feedback_linearisation.of_plant(plant)
        planted.setattr(feedback_linearisation, "AUTHORITY", 0.0)
        law = feedback_linearisation.of_plant(plant)
    assert law.degree.degrees == (1,)
    try:
        assert not law.check().passed
    except ModelError as error:
        assert "the law is not finite" in str(error)


def chain(law: Linearisation, x: np.ndarray) -> np.ndarray:
    """Return the outputs and their derivatives below the degrees at a state."""
    chains = ca.Function("chains", [law.x], [ca.densify(ca.vertcat(*law.degree.chains))])
    return chains(x).full().ravel()


def companion(law: Linearisation, pole: float) -> tuple[np.ndarray, np.ndarray]:
    """Return K and A + B K of the integrator chains with every pole at -pole."""
    order = law.degree.degrees
    K, closed, row = np.zeros((len(order), sum(order))), np.zeros((sum(order), sum(order))), 0
    for i, r in enumerate(order):
        K[i, row : row + r] = -np.poly(np.full(r, -pole))[:0:-1]
        closed[row : row + r - 1, row + 1 : row + r] = np.eye(r - 1)
        closed[row + r - 1] = K[i]
        row += r
    return K, closed


def chain_error(law: Linearisation, x0: np.ndarray, pole: float, seconds: float, sign: float = 1.0) -> float:
    """Simulate the nonlinear plant under w = K (chain); return how far its chain is from exp(A t) of the first one."""
    K, closed = companion(law, pole)
    chains = ca.vertcat(*law.degree.chains)
    u = sign * ca.substitute(law.u, law.w, ca.mtimes(ca.SX(K), chains))
    loop = ca.Function("loop", [law.x], [law.plant.f(law.x, u, law.plant.values)])
    times = np.linspace(0, seconds, 5)
    run = solve_ivp(
        lambda t, x: loop(x).full().ravel(), (0, seconds), x0, t_eval=times, method="DOP853", rtol=1e-11, atol=1e-12
    )
    first = chain(law, x0)
    reached = np.array([chain(law, x) for x in run.y.T])
    expected = np.array([expm(closed * t) @ first for t in run.t])
    return float((np.abs(reached - expected) / np.abs(expected).max(axis=0)).max())


STARTS = {
    "flexible_joint": ([0.6, 0.3, 0.5, -0.2], 6.0, 1.0),
    "unicycle": ([0.5, -0.4, 0.3, 0.8], 0.3, 0.8),
    "flat aircraft": ([0.3, 0.0, -0.2, 0.1, 0.2, 0.1, 1.1, 0.05], 1.0, 1.0),
    "ball_and_beam": ([0.5, 0.2, 0.1, 0.4], 0.8, 0.2),
}


@pytest.mark.parametrize("name", STARTS)
def test_the_nonlinear_plant_follows_the_linear_chain(name: str) -> None:
    start, pole, seconds = STARTS[name]
    law = lawful(name)
    assert chain_error(law, np.array(start), pole, seconds) < tolerances.of("ode")
    assert chain_error(law, np.array(start), pole, seconds, sign=1.001) > 1e-5


@pytest.mark.slow
def test_the_levitated_stage_follows_fifteen_integrators() -> None:
    """All quadratic terms of the currents are in the plant, and no term is dropped from the law."""
    stage = full_stage()
    point = operating_points.trim(stage, {"y": 0.025}, ["i_d1", "i_d2", "i_d3", "i_d4"])
    law = feedback_linearisation.of_plant(stage, list(maglev_stage.RATE), point=point, weight=np.eye(6))
    assert law.degree.degrees == (3,) * 5 and law.zeros is not None and law.zeros.is_consistent
    assert law.check().passed
    assert law.zeros.order == 1 and law.zeros.verdict == "not hyperbolic"  # the sixth current, at rest
    x0 = np.array(point.x)
    names = [s.name for s in stage.states]
    for state, value in {"y": 2e-4, "x": 1e-3, "z": -1e-3, "phi": 2e-4, "theta": -1e-3}.items():
        x0[names.index(state)] += value
    origin = ca.DM(chain(law, np.array(point.x)).tolist())
    ends = np.cumsum([0, *law.degree.degrees])
    centred = tuple(c - origin[i:j] for c, i, j in zip(law.degree.chains, ends, ends[1:], strict=False))
    about = replace(law, degree=replace(law.degree, chains=centred))
    assert chain_error(about, x0, 40.0, 0.05) < 1e-6


def test_zero_dynamics_come_with_a_point() -> None:
    plant = textbook_plants.aircraft(0.1)
    law = feedback_linearisation.of_plant(plant, point=operating_points.trim(plant, {}, ["T"]))
    assert law.zeros is not None and law.zeros.verdict == "not minimum phase"
    text = repr(law)
    assert "Zero dynamics of order 2: not minimum phase" in text
    assert "normal form: holds" in text and "demands d^2 px/dt^2 [m/s^2], d^2 pz/dt^2 [m/s^2]" in text
    assert "DOES NOT HOLD" in repr(replace(law, u=-law.u))


def test_spare_inputs_share_the_work_by_their_weight() -> None:
    """Two thrusters in line: u'Wu is least where u_j goes as 1/w_j, about the operating point."""
    plant = textbook_plants.build(
        "sledge",
        [textbook_plants.Signal("x", "m", -1, 1), textbook_plants.Signal("v", "m/s", -1, 1)],
        [textbook_plants.Signal(n, "m/s^2", -5, 5) for n in ("fine", "coarse")],
        [textbook_plants.Signal("y", "m", -1, 1)],
        [],
        lambda x, u, p: ({"x": x["v"], "v": u["fine"] + 2 * u["coarse"] - 3 * x["v"]}, {"y": x["x"]}),
    )
    with pytest.raises(ModelError, match=r"2 inputs \(fine, coarse\) serve 1 outputs \(y\): hold 1 of them, or give"):
        feedback_linearisation.of_plant(plant)
    law = feedback_linearisation.of_plant(plant, weight={"fine": 4.0, "coarse": 1.0})
    sent = law.law([0.0, 0.5], [6.0]).full().ravel()  # 6 + 1.5 = fine + 2 coarse, fine / coarse = (1/4) / (2/1)
    np.testing.assert_allclose(sent, 7.5 / 4.25 * np.array([0.25, 2.0]), rtol=1e-12)
    assert law.check().passed
    held = feedback_linearisation.of_plant(plant, held={"coarse": 1.0})
    assert held.check().passed and held.law([0.0, 0.0], [6.0]).full().item() == pytest.approx(4.0)
    biased = operating_points.OperatingPoint([0, 0], [2.0, -1.0], [], 0.0, ("x", "v"), ("fine", "coarse"))
    about = feedback_linearisation.of_plant(plant, weight=[4.0, 1.0], point=biased)
    np.testing.assert_allclose(about.law([0, 0], [0.0]).full().ravel(), [2.0, -1.0], rtol=1e-12)
    with pytest.raises(SignalError, match="input weight"):
        feedback_linearisation.of_plant(plant, weight=[1.0, -1.0])


def sliding(coefficient: float, reach: float = 1.0) -> Plant:
    """x1' = 4 x2 + c u, x2' = u, y = x1, |x2| <= 1 and |u| <= reach: the inputs over the drift are c reach / 4."""
    states = [textbook_plants.Signal("x1", "m", -1, 1), textbook_plants.Signal("x2", "m/s", -1, 1)]
    inputs = [textbook_plants.Signal("u", "m/s^2", -reach, reach)]

    def physics(x: Symbols, u: Symbols, p: Symbols) -> tuple[dict[str, ca.SX], dict[str, ca.SX]]:
        return {"x1": 4 * x["x2"] + coefficient * u["u"], "x2": u["u"]}, {"y": x["x1"]}

    return textbook_plants.build("sliding", states, inputs, [textbook_plants.Signal("y", "m", -1, 1)], [], physics)


def test_an_input_that_enters_by_a_folded_rounding_error_is_refused() -> None:
    """0.1 + 0.2 - 0.3 is 5.6e-17 before the plant sees it; left out, the degree is 2."""
    with pytest.raises(
        ModelError, match=r"derivative 1 of 'y' by 1.4e-17 of the drift's share .* rounding error of cons"
    ):
        feedback_linearisation.of_plant(sliding(0.1 + 0.2 - 0.3))
    assert feedback_linearisation.of_plant(sliding(0.0)).degree.degrees == (2,)
    weak = feedback_linearisation.of_plant(sliding(1e-9, reach=0.5))
    # the farthest of 48 scattered points is near an end of the range
    assert weak.degree.degrees == (1,) and weak.degree.authority["y"] == pytest.approx(1e-9 * 0.5 / 4, rel=0.1)
    assert weak.check().passed and "inputs over drift" in repr(weak) and "1.25e-10" in repr(weak)


def test_the_aircrafts_law_by_hand() -> None:
    """[T, M] = D^-1 (w - [0, -1])."""
    law = lawful("aircraft")
    for x in nearest_root.scatter(law.plant.states, 10, 3).T:
        c, s = np.cos(x[4]), np.sin(x[4])
        D = np.array([[-s, 0.3 * c], [c, 0.3 * s]])
        sent = law.law(x, [0.4, -0.7]).full().ravel()
        np.testing.assert_allclose(sent, np.linalg.solve(D, [0.4, 0.3]), rtol=1e-12)


def test_a_chain_bears_the_names_of_the_plants_states_where_a_derivative_is_one() -> None:
    """x and z of the aircraft have their velocities for states; the flexible joint's acceleration is no state."""
    joint = feedback_linearisation.of_plant(textbook_plants.flexible_joint()).chain("y")
    assert joint.model.states == ("q1", "w1", "y_d2", "y_d3") and joint.model.inputs == ("w_y",)
    assert [joint.model.unit(n) for n in ("y", "q1", "w1", "y_d2", "w_y")] == [
        "rad",
        "rad",
        "rad/s",
        "rad/s^2",
        "rad/s^4",
    ]
    np.testing.assert_array_equal(joint.model.A, np.eye(4, k=1))
    assert joint.law.degree.outputs == ("y",)


def test_terms_that_cancel_are_affine() -> None:
    a, b, c = map(ca.SX.sym, "abc")
    made = feedback_linearisation.linearise([(a + b) ** 2 - a * a - b * b], {"b": b}, [c])
    assert float(ca.Function("b", [a, c], [made.inputs["b"]])(0.5, 3.0)) == 3.0  # c / 2 a
    with pytest.raises(ModelError, match="there are no inputs"):
        feedback_linearisation.linearise([], {}, [])
