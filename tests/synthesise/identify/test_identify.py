"""Parameters of models come out of logs with known truth, inside intervals that hold it as often as they say."""

import casadi as ca
import numpy as np
import pytest

from designs.maglev import reference_stage
from models import maglev_stage
from synth.analyse import operating_points
from synth.errors import ModelError, SignalError
from synth.synthesise.identify import identify
from synth.synthesise.identify.logs import Log
from tests.designs.maglev_5dof import full_plant
from tests.synthesise.mass_spring import DAMP, MASS, SPRING, stage

X, U = {"x": ca.SX.sym("x"), "v": ca.SX.sym("v"), "a": ca.SX.sym("a")}, {"f": ca.SX.sym("f")}
P = {p.name: ca.SX.sym(p.name) for p in (MASS, DAMP, SPRING)}
FORCE = P["m"] * X["a"] + P["d"] * X["v"] + P["k"] * ca.sin(X["x"]) - U["f"]


def moves(noise: float, seed: int = 0, rows: int = 60) -> Log:
    rng = np.random.default_rng(seed)
    x, v, a = rng.normal(size=(3, rows))
    return Log({"x": x, "v": v, "a": a, "f": 2 * a + 3 * v + 40 * np.sin(x) + noise * rng.normal(size=rows)})


def test_an_equation_gives_its_parameters_as_numpy_does() -> None:
    log = moves(0.5)
    estimate = identify.fit_linear({"force": FORCE}, X | U, (MASS, DAMP, SPRING), P, log)
    Phi = np.column_stack([log.samples["a"], log.samples["v"], np.sin(log.samples["x"])])
    np.testing.assert_allclose(estimate.values, np.linalg.lstsq(Phi, log.samples["f"], rcond=None)[0], rtol=1e-9)
    low, high = estimate.intervals.T
    assert ((low < [2, 3, 40]) & (high > [2, 3, 40])).all() and estimate.units["k"] == "N/m"
    assert estimate.r_squared["force"] > 0.99 and "k [N/m]" in str(estimate)


def test_a_collinear_regressor_is_caught() -> None:
    """Planted: every move has a = -9 x and v = 0, so that mass and spring cannot be distinguished."""
    x = np.linspace(-0.01, 0.01, 30)
    log = Log({"x": x, "v": 0 * x, "a": -9 * np.sin(x), "f": 22 * np.sin(x)})
    with pytest.raises(
        ModelError, match=r"leave (d and )?a change of m by \+100 % and k by \+45 % (and d )?undetermined"
    ):
        identify.fit_linear({"force": FORCE}, X | U, (MASS, DAMP, SPRING), P, log)


TRUE = {"k_s_theta": 2600.0, "k_s_phi": 17000.0}
ANGLES = np.array([[0.0, -8e-3], [0.0, 6e-3], [2e-3, 3e-3], [-2e-3, -4e-3], [1.5e-3, 0.0], [0.0, 9e-3]])


def holds(noise_A: float, seed: int = 1, each: int = 20) -> Log:
    """Return static holds of a stage with other springs than assumed, each read `each` times with noisy currents."""
    plant = maglev_stage.plant().with_parameters(**TRUE)
    rng, rows = np.random.default_rng(seed), []
    for phi, theta in ANGLES:
        point = operating_points.trim(
            plant, {"y": 0.025, "phi": phi, "theta": theta}, [f"i_d{j}" for j in (1, 2, 3, 4)]
        )
        rows += [np.concatenate([point.x, point.u + noise_A * rng.normal(size=6)]) for _ in range(each)]
    names = [s.name for s in (*plant.states, *plant.inputs)]
    return Log(dict(zip(names, np.array(rows).T, strict=True)))


def test_static_holds_give_the_springs_of_the_stage() -> None:
    log = holds(5e-3)
    estimate = identify.fit_equations(maglev_stage.plant(), log, ("k_s_theta", "k_s_phi"))
    low, high = estimate.intervals.T
    assert ((low < list(TRUE.values())) & (list(TRUE.values()) < high)).all()
    np.testing.assert_allclose(estimate.values, list(TRUE.values()), rtol=0.02)
    for name, row in (("theta", 9), ("phi", 7)):
        expected = by_hand(log, name, row)
        assert estimate[f"k_s_{name}"] == pytest.approx(expected, rel=1e-4), (
            "the reference has csch^2 of other rounding"
        )
    assert set(estimate.rms) == {"wtheta", "wphi"} and "k_s_theta [1/s^2]" in str(estimate)


def by_hand(log: Log, angle: str, row: int) -> float:
    """Return k of 0 = torque - k angle from the NumPy reference's torque without springs, by the mean of products."""
    state = np.array([log.samples[n] for n in ("y", "vy", "x", "vx", "z", "vz", "phi", "wphi", "theta", "wtheta")])
    currents = [log.samples[f"i_d{j}"] for j in (1, 2, 3, 4)] + [log.samples[q] for q in ("u_z", "u_x") * 2]
    loose = reference_stage.Parameters(k_s_phi=0.0, k_s_theta=0.0)
    torque, at = full_plant.plant(state, np.array(currents), loose)[row], log.samples[angle]
    return float(at @ torque / (at @ at))


def test_intervals_of_static_holds_hold_the_truth_as_often_as_they_say() -> None:
    clean = holds(0.0, each=2)
    plant, rng, hits = maglev_stage.plant(), np.random.default_rng(2), []
    for _ in range(40):
        noisy = {
            n: v + (4e-3 * rng.normal(size=len(v)) if n.startswith("i_d") else 0) for n, v in clean.samples.items()
        }
        low, high = identify.fit_equations(plant, Log(noisy), ("k_s_theta", "k_s_phi")).intervals.T
        hits.append((low < list(TRUE.values())) & (list(TRUE.values()) < high))
    assert abs(np.mean(hits) - 0.95) < 0.06, "80 intervals: the share has a standard deviation of 2.4 %"


def test_equations_that_divide_by_a_parameter_are_multiplied_out() -> None:
    """The mass divides the motors' forces: M (y'' - G) = sum of F."""
    log, plant = holds(0.0), maglev_stage.plant().with_parameters(**TRUE)
    estimate = identify.fit_equations(plant, log, ("M_y",))
    assert estimate["M_y"] == pytest.approx(6.9, rel=1e-6)
    with pytest.raises(ModelError, match=r"the data leave .* undetermined"):
        identify.fit_equations(plant, log, ("M_x", "k_s_theta"))


def test_points_without_use_are_refused_by_name() -> None:
    log, plant = holds(1e-3, each=2), maglev_stage.plant()
    level = Log({n: 0 * v if n == "theta" else v for n, v in log.samples.items()})
    with pytest.raises(ModelError, match="leave k_s_theta undetermined"):
        identify.fit_equations(plant, level, ("k_s_theta", "k_s_phi"))
    with pytest.raises(SignalError, match="the log has no signal 'i_d2'"):
        identify.fit_equations(plant, Log({n: v for n, v in log.samples.items() if n != "i_d2"}), ("k_s_theta",))
    short = Log({n: v for n, v in log.samples.items() if n not in ("x", "vx", "z", "vz", "vy", "wphi", "wtheta")})
    identify.fit_equations(plant, short, ("k_s_theta",))
    with pytest.raises(SignalError, match=r"no equation of plant .* contains motor_separation"):
        identify.fit_equations(plant, log, ("motor_separation",))
    with pytest.raises(SignalError, match="has no parameter 'k_s'"):
        identify.fit_equations(plant, log, ("k_s",))
    with pytest.raises(SignalError, match="'theta_rate' is not a state"):
        identify.fit_equations(plant, log, ("k_s_theta",), rates={"theta_rate": "x"})


def test_rates_make_the_equations_those_of_motion() -> None:
    rng = np.random.default_rng(8)
    x, v, a = rng.normal(size=(3, 40))
    log = Log({"x": x, "v": v, "acc": a, "f": 1.8 * a + 3.6 * v + 47 * x + 0.01 * rng.normal(size=40)})
    estimate = identify.fit_equations(stage(), log, ("m", "d", "k"), rates={"v": "acc"})
    np.testing.assert_allclose(estimate.values, [1.8, 3.6, 47.0], rtol=0.01)
