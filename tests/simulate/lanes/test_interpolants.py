"""The fast form of a plant: its polynomials against CasADi's evaluation of the plant itself."""

from dataclasses import replace

import casadi as ca
import numpy as np
import pytest

from models import maglev_stage
from synth import plant
from synth.emit.program import lower
from synth.plant import Plant
from synth.signals import Parameter, Signal
from synth.simulate.lanes import interpolants
from synth.simulate.lanes.interpolants import OUTSIDE, FastPlant

STAGE = maglev_stage.plant()
SIGNALS = (*STAGE.states, *STAGE.inputs)


def wrong_plants(n: int) -> list[Plant]:
    """Plants with parameters anywhere within their tolerances."""
    rng = np.random.default_rng(5)
    tolerances = {q.name: (q.value, q.tolerance) for q in STAGE.parameters}
    return [
        STAGE.with_parameters(**{name: v * (1 + t * rng.uniform(-1, 1)) for name, (v, t) in tolerances.items()})
        for _ in range(n)
    ]


def evaluate(fast: FastPlant, values: np.ndarray, z: np.ndarray) -> dict[str, np.ndarray]:
    """Evaluate the program f at the columns of z, states above inputs, with parameters (parameters, columns)."""
    names = [s.name for s in (*fast.plant.states, *fast.plant.inputs)]
    known = {
        k: values[fast.parameters.index(n.name)] if n.op == "parameter" else z[names.index(n.name)]
        for k, n in enumerate(fast.f.nodes)
        if n.op in ("state", "input", "parameter")
    }
    results = lower.evaluate(fast.f, fast.f.outputs.values(), known)
    return {name: np.broadcast_to(results[k], z.shape[1:]) for name, k in fast.f.outputs.items()}


@pytest.fixture(scope="module")
def fast() -> FastPlant:
    return interpolants.fast_plant(STAGE)


def test_accelerations_agree_with_the_plant_for_every_set_of_parameters(fast: FastPlant) -> None:
    rng, plants = np.random.default_rng(1), wrong_plants(40)
    low, high = (np.array([getattr(s, end) for s in SIGNALS])[:, np.newaxis] for end in ("low", "high"))
    z = low + (high - low) * rng.uniform(size=(len(SIGNALS), len(plants)))
    coefficients = fast.coefficients(plants)
    assert coefficients.error.max() < 1e-10
    values = evaluate(fast, coefficients.values, z)
    n = len(STAGE.states)
    truth = np.array([np.asarray(p.f(z[:n, i], z[n:, i], p.values)).ravel() for i, p in enumerate(plants)]).T
    for row, state in zip(truth, STAGE.states, strict=True):
        assert np.abs(values[state.name] - row).max() <= 2e-9 * max(np.abs(row).max(), 1.0)
    assert not values[OUTSIDE].any()


def test_equal_functions_share_their_coefficients(fast: FastPlant) -> None:
    assert len(fast.degrees) == 5, "four functions of each of four gaps, and the sine of two angles"


def test_a_gap_beyond_the_range_is_outside(fast: FastPlant) -> None:
    coefficients = fast.coefficients([STAGE, STAGE, STAGE]).values
    z = np.zeros((len(SIGNALS), 3))
    z[0] = 0.025, 0.05, np.nan
    assert evaluate(fast, coefficients, z)[OUTSIDE].tolist() == [0.0, 1.0, 1.0]


def test_the_same_plant_has_the_same_coefficients_in_every_company(fast: FastPlant) -> None:
    plants = wrong_plants(9)
    together = fast.coefficients(plants).values
    for i in (0, 8):
        assert np.array_equal(fast.coefficients([plants[i]] * 2).values[:, 0], together[:, i])


def oscillator(acceleration: ca.SX, name: str = "oscillator") -> Plant:
    """q' = v, v' = acceleration(q, v, u), by the symbols in the expression."""
    return plant.build(
        name,
        [Signal("q", "m", -1.0, 1.0), Signal("v", "m/s", -1.0, 1.0)],
        [Signal("u", "m/s^2", -1.0, 1.0)],
        [Signal("y", "m", -1.0, 1.0)],
        [Parameter("k", 40.0, "1/s^2", 0.1, "test")],
        lambda x, u, p: (
            {
                "q": x["v"],
                "v": ca.substitute(acceleration, ca.vertcat(Q, V, U, K), ca.vertcat(x["q"], x["v"], u["u"], p["k"])),
            },
            {"y": x["q"]},
        ),
    )


Q, V, U, K = (ca.SX.sym(name) for name in "qvuk")


def test_the_order_of_the_equations_is_recognised() -> None:
    assert interpolants.fast_plant(oscillator(U - K * ca.sin(Q))).second_order == {"q": "v"}
    assert interpolants.fast_plant(oscillator(U - K * Q - V)).second_order == {}, "damped: dv/dt depends on v"
    assert interpolants.fast_plant(STAGE).second_order == maglev_stage.RATE


def test_a_function_that_no_polynomial_approximates_stays() -> None:
    fast = interpolants.fast_plant(oscillator(U - ca.tanh(400 * Q)))
    assert not fast.degrees and [n.op for n in fast.f.nodes].count("tanh") == 1
    value = evaluate(fast, fast.coefficients([fast.plant]).values, np.array([[0.003], [0.0], [0.5]]))["v"]
    assert abs(value[0] - (0.5 - np.tanh(1.2))) < 1e-15


def test_a_function_without_parameters_serves_every_plant() -> None:
    fast = interpolants.fast_plant(oscillator(ca.exp(Q) - K * V))
    plants = [fast.plant.with_parameters(k=k) for k in (38.0, 40.0, 43.0)]
    coefficients = fast.coefficients(plants)
    assert len(fast.degrees) == 1 and coefficients.error.shape == (3,) and coefficients.error.max() < 1e-10
    value = evaluate(fast, coefficients.values, np.array([[0.3] * 3, [0.5] * 3, [0.0] * 3]))["v"]
    assert np.abs(value - (np.exp(0.3) - np.array([19.0, 20.0, 21.5]))).max() < 1e-8


def test_a_sine_of_many_turns_is_one_of_any_argument() -> None:
    fast = interpolants.fast_plant(oscillator(U - ca.sin(400 * Q) + ca.cos(400 * Q)))
    q = np.linspace(-3.0, 3.0, 20001)
    values = evaluate(fast, fast.coefficients([fast.plant]).values, np.array([q, 0 * q, 0 * q]))
    assert not fast.degrees and not {"sin", "cos"} & {n.op for n in fast.f.nodes}
    assert np.abs(values["v"] - np.cos(400 * q) + np.sin(400 * q)).max() < 2e-10
    assert not values[OUTSIDE].any(), "also beyond the range of q"


@pytest.mark.parametrize("op", ["sin", "cos"])
@pytest.mark.parametrize("error", [1e-4, 1e-10])
def test_the_error_of_a_sine_is_the_one_asked_for(op: str, error: float) -> None:
    r = np.linspace(-np.pi, np.pi, 10001)
    shorter = interpolants.coefficients(op, error)[:-1]
    for c, sufficient in ((interpolants.coefficients(op, error), True), (shorter, False)):
        value = np.polynomial.polynomial.polyval(r**2, c) * (r if op == "sin" else 1.0)
        assert (np.abs(value - getattr(np, op)(r)).max() <= error) == sufficient


def test_the_error_that_is_asked_for_decides_the_degree() -> None:
    plain, tight = (interpolants.fast_plant(STAGE, error) for error in (1e-6, 1e-12))
    assert max(plain.degrees) < max(interpolants.fast_plant(STAGE).degrees) < max(tight.degrees)
    assert replace(plain, error=0.0).coefficients([STAGE]).error[0] > 1e-9
