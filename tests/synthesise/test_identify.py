"""Parameters of models come out of logs with known truth, inside intervals that hold it as often as they say."""

import casadi as ca
import numpy as np
import pytest
import scipy.linalg
import scipy.optimize

from designs.maglev_5dof import reference
from models import maglev_stage
from synth.analyse import trim
from synth.errors import ModelError, SignalError
from synth.plant import Plant, build
from synth.signals import Parameter, Signal
from synth.synthesise import identify
from synth.synthesise.logs import Log

X, U = {"x": ca.SX.sym("x"), "v": ca.SX.sym("v"), "a": ca.SX.sym("a")}, {"f": ca.SX.sym("f")}
MASS, DAMP, SPRING = (
    Parameter(n, v, u, 0.2, "test") for n, v, u in (("m", 2, "kg"), ("d", 3, "kg/s"), ("k", 40, "N/m"))
)
P = {p.name: ca.SX.sym(p.name) for p in (MASS, DAMP, SPRING)}
FORCE = P["m"] * X["a"] + P["d"] * X["v"] + P["k"] * ca.sin(X["x"]) - U["f"]


def moves(noise: float, seed: int = 0, rows: int = 60) -> Log:
    rng = np.random.default_rng(seed)
    x, v, a = rng.normal(size=(3, rows))
    return Log({"x": x, "v": v, "a": a, "f": 2 * a + 3 * v + 40 * np.sin(x) + noise * rng.normal(size=rows)})


def test_an_equation_gives_its_parameters_as_numpy_does() -> None:
    log = moves(0.5)
    found = identify.fit_linear({"force": FORCE}, X | U, (MASS, DAMP, SPRING), P, log)
    Phi = np.column_stack([log.samples["a"], log.samples["v"], np.sin(log.samples["x"])])
    np.testing.assert_allclose(found.values, np.linalg.lstsq(Phi, log.samples["f"], rcond=None)[0], rtol=1e-9)
    low, high = found.intervals.T
    assert ((low < [2, 3, 40]) & (high > [2, 3, 40])).all() and found.units["k"] == "N/m"
    assert found.r_squared["force"] > 0.99 and "k [N/m]" in str(found)


@pytest.mark.parametrize(
    ("equation", "named"),
    [(P["m"] * P["d"] * X["v"] + P["k"] * X["x"], "m, d"), (P["m"] * X["a"] + ca.exp(P["k"] * X["x"]), "k")],
)
def test_an_equation_that_is_not_linear_names_the_parameter(equation: ca.SX, named: str) -> None:
    with pytest.raises(ModelError, match=f"equation 'force' is not linear in {named}: multiply it out"):
        identify.fit_linear({"force": equation}, X | U, (MASS, DAMP, SPRING), P, moves(0.1))


def test_a_strange_symbol_and_a_missing_signal_are_named() -> None:
    with pytest.raises(SignalError, match="the equations hold 'q', which is neither"):
        identify.fit_linear({"force": FORCE + ca.SX.sym("q")}, X | U, (MASS, DAMP, SPRING), P, moves(0.1))
    with pytest.raises(SignalError, match="the log has no signal 'f'"):
        identify.fit_linear({"force": FORCE}, X | U, (MASS, DAMP, SPRING), P, Log({"x": [1.0], "v": [1.0], "a": [1.0]}))


def test_a_collinear_regressor_is_caught() -> None:
    """Planted: every move has a = -9 x and v = 0, so that mass and spring cannot be told apart."""
    x = np.linspace(-0.01, 0.01, 30)
    log = Log({"x": x, "v": 0 * x, "a": -9 * np.sin(x), "f": 22 * np.sin(x)})
    with pytest.raises(
        ModelError, match=r"leave d and 0\.11 m \+ 0\.99 k undetermined|leave 0\.11 m \+ 0\.99 k and d und"
    ):
        identify.fit_linear({"force": FORCE}, X | U, (MASS, DAMP, SPRING), P, log)


TRUE = {"k_s_theta": 2600.0, "k_s_phi": 17000.0}
ANGLES = np.array([[0.0, -8e-3], [0.0, 6e-3], [2e-3, 3e-3], [-2e-3, -4e-3], [1.5e-3, 0.0], [0.0, 9e-3]])


def holds(noise_A: float, seed: int = 1, each: int = 20) -> Log:
    """Return static holds of a stage with other springs than assumed, each read `each` times with noisy currents."""
    plant = maglev_stage.plant().with_parameters(**TRUE)
    rng, rows = np.random.default_rng(seed), []
    for phi, theta in ANGLES:
        point = trim.trim(plant, {"y": 0.025, "phi": phi, "theta": theta}, [f"i_d{j}" for j in (1, 2, 3, 4)])
        rows += [np.concatenate([point.x, point.u + noise_A * rng.normal(size=6)]) for _ in range(each)]
    names = [s.name for s in (*plant.states, *plant.inputs)]
    return Log(dict(zip(names, np.array(rows).T, strict=True)))


def test_static_holds_give_the_springs_of_the_stage() -> None:
    log = holds(5e-3)
    found = identify.fit_equations(maglev_stage.plant(), log, ("k_s_theta", "k_s_phi"))
    low, high = found.intervals.T
    assert ((low < list(TRUE.values())) & (list(TRUE.values()) < high)).all()
    np.testing.assert_allclose(found.values, list(TRUE.values()), rtol=0.02)
    for name, row in (("theta", 9), ("phi", 7)):
        wanted = by_hand(log, name, row)
        assert found[f"k_s_{name}"] == pytest.approx(wanted, rel=1e-4), "the reference has csch^2 of other rounding"
    assert set(found.rms) == {"wtheta", "wphi"} and "k_s_theta [1/s^2]" in str(found)


def by_hand(log: Log, angle: str, row: int) -> float:
    """Return k of 0 = torque - k angle from the NumPy reference's torque without springs, by the mean of products."""
    state = np.array([log.samples[n] for n in ("y", "vy", "x", "vx", "z", "vz", "phi", "wphi", "theta", "wtheta")])
    currents = [log.samples[f"i_d{j}"] for j in (1, 2, 3, 4)] + [log.samples[q] for q in ("u_z", "u_x") * 2]
    loose = reference.Parameters(k_s_phi=0.0, k_s_theta=0.0)
    torque, at = reference.plant(state, np.array(currents), loose)[row], log.samples[angle]
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
    found = identify.fit_equations(plant, log, ("M_y",))
    assert found["M_y"] == pytest.approx(6.9, rel=1e-6)
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
    with pytest.raises(SignalError, match="'theta_rate' is no state"):
        identify.fit_equations(plant, log, ("k_s_theta",), rates={"theta_rate": "x"})


def stage(unstable: bool = False) -> Plant:
    """Return m v' = k x - d v + f, or with -k, seen by an encoder at x + offset."""

    def physics(x: dict, u: dict, p: dict) -> tuple[dict, dict]:
        force = (1 if unstable else -1) * p["k"] * x["x"] - p["d"] * x["v"] + u["f"]
        return {"x": x["v"], "v": force / p["m"]}, {"s": x["x"] + p["offset"]}

    return build(
        "stage",
        (Signal("x", "m", -1, 1), Signal("v", "m/s", -9, 9)),
        (Signal("f", "N", -9, 9),),
        (Signal("s", "m", -1, 1),),
        (MASS, DAMP, SPRING, Parameter("offset", 0.0, "m", 0.0, "test")),
        physics,
    )


def run(
    truth: dict[str, float], start: list[float], seed: int, noise: float, unstable: bool = False, push: float = 3.0
) -> Log:
    """Return 300 rows at 10 ms of the stage under random held forces, by the exponential of the held model."""
    rng, T = np.random.default_rng(seed), 0.01
    f, state, rows = np.repeat(push * rng.uniform(-1, 1, 30), 10), np.array(start), []
    sign = 1 if unstable else -1
    A = np.array([[0, 1, 0], [sign * truth["k"], -truth["d"], 1], [0, 0, 0]]) / [[1], [truth["m"]], [1]]
    M = scipy.linalg.expm(A * T)
    for k in range(len(f)):
        rows.append(state)
        if unstable:  # hold it by feedback, as a logged loop does
            f[k] += -90 * state[0] - 12 * state[1]
        state = M[:2, :2] @ state + M[:2, 2] * f[k]
    x, v = np.array(rows).T
    return Log(
        {
            "f": f,
            "x": x + noise * rng.normal(size=len(x)),
            "v": v + noise * rng.normal(size=len(x)),
            "s": x + truth.get("offset", 0.0) + noise * rng.normal(size=len(x)),
        },
        T,
    )


def test_a_trajectory_gives_mass_damping_spring_and_the_start() -> None:
    truth = {"m": 1.8, "d": 3.6, "k": 47.0}
    log = run(truth, [0.05, -0.1], 3, 1e-3)
    found = identify.fit_trajectory(stage(), log, tuple(truth), ("s",), initial={"x": 0.0, "v": 0.0}, free=("x", "v"))
    wanted = np.array([*truth.values(), 0.05, -0.1])
    low, high = found.estimate.intervals.T
    assert ((low < wanted) & (wanted < high)).all() and found.estimate.names == ("m", "d", "k", "x_0", "v_0")
    assert found.estimate.units["v_0"] == "m/s" and found.steps < 15
    assert found.estimate.rms["s"] == pytest.approx(1e-3, rel=0.15)
    np.testing.assert_allclose(found.estimate.values, scipy_fit(log), rtol=2e-4, atol=1e-5)


def scipy_fit(log: Log) -> np.ndarray:
    """Return the same parameters by SciPy from the exact sampled model of the linear stage."""

    def residual(v: np.ndarray) -> np.ndarray:
        m, d, k, x, s = v
        M = scipy.linalg.expm(np.array([[0, 1, 0], [-k / m, -d / m, 1 / m], [0, 0, 0]]) * 0.01)
        state, found = np.array([x, s]), []
        for f in log.samples["f"]:
            found.append(state[0])
            state = M[:2, :2] @ state + M[:2, 2] * f
        return np.array(found) - log.samples["s"]

    return scipy.optimize.least_squares(residual, [2, 3, 40, 0, 0], x_scale=[1, 1, 10, 0.1, 0.1], xtol=1e-12).x


def test_an_unstable_stage_is_followed_over_short_spans() -> None:
    truth = {"m": 1.8, "d": 3.6, "k": 47.0}
    log = run(truth, [0.05, -0.1], 4, 1e-6, unstable=True)
    found = identify.fit_trajectory(stage(unstable=True), log, ("m", "d", "k"), ("x", "v"), span=5)
    np.testing.assert_allclose(found.estimate.values, list(truth.values()), rtol=2e-3)
    with pytest.raises(ModelError, match="not finite at the start"):
        long = Log(log.samples, 1.0)
        identify.fit_trajectory(stage(unstable=True), long, ("m",), ("x",))


def test_a_tolerance_bounds_a_parameter() -> None:
    log = run({"m": 2.0, "d": 3.0, "k": 60.0}, [0.05, 0.0], 5, 1e-4)
    found = identify.fit_trajectory(
        stage(), log, ("k",), ("s",), initial={"x": 0.05, "v": 0.0}, free=("x",), within_tolerance=True
    )
    assert found.held == {"k": pytest.approx(48.0)} and found.estimate.names == ("x_0",)


def test_parameters_that_act_together_are_named() -> None:
    """Without force d / m and k / m alone act."""
    log = run({"m": 2.0, "d": 3.0, "k": 40.0}, [0.05, 0.0], 6, 0.0, push=0.0)
    start = {"x": 0.05, "v": 0.0}
    with pytest.raises(ModelError, match=r"the data leave 0\.05 m \+ 0\.075 d \+ 1 k undetermined"):
        identify.fit_trajectory(stage(), log, ("m", "d", "k"), ("s",), initial=start)
    assert identify.fit_trajectory(stage(), log, ("d", "k"), ("s",), initial=start).by_name == pytest.approx(
        {"d": 3, "k": 40}, rel=1e-6
    )


def test_rates_make_the_equations_those_of_motion() -> None:
    rng = np.random.default_rng(8)
    x, v, a = rng.normal(size=(3, 40))
    log = Log({"x": x, "v": v, "acc": a, "f": 1.8 * a + 3.6 * v + 47 * x + 0.01 * rng.normal(size=40)})
    found = identify.fit_equations(stage(), log, ("m", "d", "k"), rates={"v": "acc"})
    np.testing.assert_allclose(found.values, [1.8, 3.6, 47.0], rtol=0.01)
