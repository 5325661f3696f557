"""The five-axis model against its printed equations in NumPy, and the currents that invert it."""

from collections.abc import Mapping

import casadi as ca
import numpy as np
import pytest

from designs.maglev_5dof.paper import polynomial
from models import maglev_stage, pmlsm, slotted_field
from synth.errors import ModelError
from synth.plant import Plant
from synth.signals import Signal, signal_names
from synth.synthesise.nonlinear import feedback_linearisation

VALUES = {p.name: p.value for p in maglev_stage.PARAMETERS}


def force_factors(g: float, lv3: str) -> dict[str, float]:
    """Return the eight factors of (3), (4) in NumPy."""
    P = VALUES
    k, kw, D = np.pi / P["tau"], np.sin(np.pi * P["w_c"] / 2 / P["tau"]), P["h_m"] + g
    s = np.sin(np.pi * P["tau_p"] / 2 / P["tau"])
    B = 4 / np.pi * P["mu0"] * P["H_c"] * s * np.sinh(k * P["h_m"]) / np.sinh(k * D)
    beta = P["b0"] / 2 / g
    gamma = 4 / np.pi * (beta * np.arctan(beta) - 0.5 * np.log1p(beta**2))
    Kc = P["t1"] / (P["t1"] - g * gamma)
    lam = 1 - P["b0"] ** 2 / (4 * P["t1"] * (g + P["b0"] / 2 + P["h_m"] / P["mu_rec"]))
    A = P["L_A"] * P["p_m"]
    stress = {"csch2": np.sinh(k * D) ** -2, "coth2": np.tanh(k * D) ** -2}[lv3]
    return {
        "h": 12 * np.sqrt(2) * P["W"] * kw * A * P["H_c"] * P["mu0"] * np.sinh(k * P["h_m"]) * s / np.pi / P["p"]
        * lam / Kc / np.sinh(k * D),
        "v1": A * P["tau"] / 4 / P["mu0"] * lam * B**2,
        "v2": 3 * np.sqrt(2) * A * P["W"] * kw / P["p"] * lam * B / np.tanh(k * D) / Kc,
        "v3": 18 * A * P["W"] ** 2 * kw**2 * P["mu0"] / P["tau"] / P["p"] ** 2 * lam * stress / Kc**2,
    }  # fmt: skip


def printed_accelerations(x: Mapping[str, float], u: Mapping[str, float], lv3: str = "csch2") -> np.ndarray:
    """Return (6), (7) as printed, term by term."""
    P = VALUES
    r = P["r"]
    g1, g2 = x["y"] - r * np.sin(x["phi"]), x["y"] + r * np.sin(x["theta"])
    g3, g4 = x["y"] + r * np.sin(x["phi"]), x["y"] - r * np.sin(x["theta"])
    K1, K2, K3, K4 = (force_factors(g, lv3) for g in (g1, g2, g3, g4))
    u1, u2, u3, u4, ux, uz = (u[n] for n in signal_names(maglev_stage.INPUTS))
    y = -K3["v1"] - K1["v1"] - K2["v1"] - K4["v1"] + K3["v2"] * u3 + K1["v2"] * u1 + K2["v2"] * u2 + K4["v2"] * u4
    y += -(K3["v3"] + K1["v3"]) * uz**2 - K3["v3"] * u3**2 - K1["v3"] * u1**2
    y += -(K2["v3"] + K4["v3"]) * ux**2 - K2["v3"] * u2**2 - K4["v3"] * u4**2
    phi = -K3["v1"] + K3["v2"] * u3 - K3["v3"] * u3**2 + K1["v1"] - K1["v2"] * u1 + K1["v3"] * u1**2
    phi += -(K3["v3"] - K1["v3"]) * uz**2
    theta = -K2["v1"] + K2["v2"] * u2 - K2["v3"] * u2**2 + K4["v1"] - K4["v2"] * u4 + K4["v3"] * u4**2
    theta += -(K2["v3"] - K4["v3"]) * ux**2
    k_rot = r * P["M_y"] / P["I_x"]
    return np.array(
        [
            P["G"] + y / P["M_y"],
            -(K2["h"] + K4["h"]) / P["M_x"] * ux,
            -(K3["h"] + K1["h"]) / P["M_z"] * uz,
            k_rot * phi / P["M_y"] - P["k_s_phi"] * x["phi"],
            k_rot * theta / P["M_y"] - P["k_s_theta"] * x["theta"],
        ]
    )


def random_points(count: int) -> list[tuple[dict[str, float], dict[str, float]]]:
    rng = np.random.default_rng(7)

    def draw(signals: tuple[Signal, ...]) -> dict[str, float]:
        return {s.name: float(rng.uniform(s.low, s.high)) for s in signals}

    return [(draw(maglev_stage.STATES), draw(maglev_stage.INPUTS)) for _ in range(count)]


def worst_difference(plant: Plant, lv3: str) -> float:
    worst = 0.0
    for x, u in random_points(50):
        derivative = np.asarray(plant.f(list(x.values()), list(u.values()), plant.values)).ravel()
        dx = dict(zip(signal_names(plant.states), derivative, strict=True))
        assert all(dx[q] == x[v] for q, v in maglev_stage.RATE.items())
        rates = np.array([dx[v] for v in maglev_stage.RATE.values()])
        worst = max(worst, float(np.abs(rates - printed_accelerations(x, u, lv3)).max()))
    return worst


@pytest.mark.parametrize("lv3", ["csch2", "coth2"])
def test_the_plant_is_what_is_printed(lv3: str) -> None:
    assert worst_difference(maglev_stage.plant(lv3), lv3) < 1e-11


def test_kinematics_invert_the_gaps() -> None:
    for x, _ in random_points(10):
        back = maglev_stage.kinematics(*(float(g) for g in maglev_stage.gaps(x, VALUES)), VALUES["r"])
        assert [float(back[n]) for n in ("y", "phi", "theta")] == pytest.approx([x["y"], x["phi"], x["theta"]])


def test_outputs_are_coordinates_and_gaps_within_their_ranges() -> None:
    plant = maglev_stage.plant()
    for x, u in random_points(50):
        y = np.asarray(plant.h(list(x.values()), list(u.values()), plant.values)).ravel()
        assert np.allclose(y[:5], [x[q] for q in maglev_stage.RATE], atol=0)
        assert np.allclose(y[5:], [float(g) for g in maglev_stage.gaps(x, VALUES)])
        assert all(s.low <= v <= s.high for s, v in zip(plant.outputs, y, strict=True))


def test_an_unknown_reading_is_refused() -> None:
    with pytest.raises(ModelError, match=r"sech2.*csch2"):
        maglev_stage.plant("sech2")


def test_friction_and_cogging_push_as_they_are_written() -> None:
    """At a crest of the cogging, at the gap at which its amplitude is that of the field; the rest does not move."""
    plant = maglev_stage.plant()
    field = slotted_field.forces(maglev_stage.geometry(plant), 0.020, 3)
    guides = maglev_stage.guide_disturbance(plant, {"x": 1.8, "z": 1.3}, 3)
    at = {"y": 0.020, "x": plant.parameter("t1").value / 4, "vx": 1.0, "vz": -1.0}
    states = signal_names(plant.states)
    added = np.asarray(guides([at.get(n, 0.0) for n in states], 0.0)).ravel()
    pushed = dict(zip(states, added, strict=True))
    assert pushed["vx"] == pytest.approx((2 * field.cogging - 1.8) / 10.6, rel=1e-9)
    assert pushed["vz"] == pytest.approx(1.3 / 8.6, rel=1e-9)
    assert {n for n, a in pushed.items() if a} == {"vx", "vz"}


def random_v(count: int) -> list[dict[str, float]]:
    rng = np.random.default_rng(3)
    v = [dict(zip(polynomial.TRANSFORMED, rng.uniform(-5, 5, 3), strict=True)) for _ in range(count)]
    return [x | u | w for (x, u), w in zip(random_points(count), v, strict=True)]


def motors(x: Mapping[str, float]) -> list[pmlsm.ForceLaw]:
    return [pmlsm.force_law(g, VALUES) for g in maglev_stage.gaps(x, VALUES)]


def true_squares(u: Mapping[str, float], with_direct: bool = True) -> list[float]:
    """Return i_d^2 + i_q^2 by motor, or i_q^2 alone."""
    return [
        u[thrust] ** 2 + (u[f"i_d{j}"] ** 2 if with_direct else 0.0)
        for j, thrust in enumerate(maglev_stage.QUADRATURE, 1)
    ]


def inverse_errors(scale: float = 1.0) -> tuple[float, float]:
    """Return how far the inverse misses random currents that keep (8): direct ones and thrusts, A at most.

    Accelerations are the printed (6), (7) in NumPy, and the squares those of the currents, times `scale`.
    """
    worst = np.zeros(2)
    for at in random_v(50):
        u = at | {n: float(i) for n, i in maglev_stage.input_transformation(at).items()}
        w = dict(zip(("y", "x", "z", "phi", "theta"), printed_accelerations(at, u), strict=True))
        squares = [scale * s for s in true_squares(u)]
        direct = maglev_stage.direct_currents(w, at, squares, motors(at), VALUES).currents
        thrust = maglev_stage.thrust_currents(w, motors(at), VALUES)
        missed = [[abs(float(i) - u[n]) for n, i in currents.items()] for currents in (direct, thrust)]
        worst = np.maximum(worst, [max(m) for m in missed])
    return float(worst[0]), float(worst[1])


def test_the_currents_invert_the_full_model_where_their_squares_are_the_true_ones() -> None:
    direct, thrust = inverse_errors()
    assert direct < 1e-12 and thrust < 1e-12
    assert inverse_errors(0.99)[0] > 1e-3  # squares that are off by a hundredth show


def test_without_the_squares_of_the_direct_currents_it_is_12() -> None:
    """The witness: (11) solved for v by cofactors of its decoupling matrix, and (8)."""
    model = polynomial.simplified(polynomial.input_polynomial(maglev_stage.nominal()))
    axes = ("y", "phi", "theta")
    demand = {q: ca.SX.sym(f"w_{q}") for q in axes}
    second = model.accelerations()
    law = feedback_linearisation.linearise([second[q] for q in axes], model.v, [demand[q] for q in axes])
    symbols = [*model.x.values(), *model.u.values(), *demand.values()]
    i_d = maglev_stage.input_transformation(law.inputs)
    witness = ca.Function("witness", [ca.vcat(symbols)], [ca.vcat(list(i_d.values()))])
    rng = np.random.default_rng(5)
    for x, u in random_points(50):
        w = dict(zip(axes, rng.uniform(-10, 10, 3), strict=True))
        currents = maglev_stage.direct_currents(w, x, true_squares(u, with_direct=False), motors(x), VALUES).currents
        point = [*(x[n] for n in model.x), *(u[n] for n in model.u), *w.values()]
        expected = np.asarray(witness(point)).ravel()
        np.testing.assert_allclose([float(i) for i in currents.values()], expected, rtol=0, atol=1e-11)
        assert float(currents["i_d1"] + currents["i_d3"]) == pytest.approx(
            float(currents["i_d2"] + currents["i_d4"]), abs=1e-12
        )
