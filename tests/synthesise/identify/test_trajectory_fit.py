"""Parameters come out of trajectories, whatever the logged start states and the integration are worth."""

import numpy as np
import pytest
import scipy.linalg
import scipy.optimize

from synth.errors import ModelError
from synth.plant import Plant
from synth.synthesise.identify import identify
from synth.synthesise.identify.logs import Log
from tests.synthesise.mass_spring import run, stage


def test_a_trajectory_gives_mass_damping_spring_and_the_start() -> None:
    truth = {"m": 1.8, "d": 3.6, "k": 47.0}
    log = run(truth, [0.05, -0.1], 3, 1e-3)
    fit = identify.fit_trajectory(stage(), log, tuple(truth), ("s",), initial={"x": 0.0, "v": 0.0}, free=("x", "v"))
    expected = np.array([*truth.values(), 0.05, -0.1])
    low, high = fit.estimate.intervals.T
    assert ((low < expected) & (expected < high)).all() and fit.estimate.parameters == ("m", "d", "k", "x_0", "v_0")
    assert fit.estimate.units["v_0"] == "m/s" and fit.steps < 15
    assert fit.estimate.rms["s"] == pytest.approx(1e-3, rel=0.15)
    np.testing.assert_allclose(fit.estimate.values, scipy_fit(log), rtol=2e-4, atol=1e-5)


def scipy_fit(log: Log) -> np.ndarray:
    """Return the same parameters by SciPy from the exact sampled model of the linear stage."""

    def residual(v: np.ndarray) -> np.ndarray:
        m, d, k, x, s = v
        M = scipy.linalg.expm(np.array([[0, 1, 0], [-k / m, -d / m, 1 / m], [0, 0, 0]]) * 0.01)
        state, outputs = np.array([x, s]), []
        for f in log.samples["f"]:
            outputs.append(state[0])
            state = M[:2, :2] @ state + M[:2, 2] * f
        return np.array(outputs) - log.samples["s"]

    return scipy.optimize.least_squares(residual, [2, 3, 40, 0, 0], x_scale=[1, 1, 10, 0.1, 0.1], xtol=1e-12).x


def test_an_unstable_stage_is_followed_over_short_spans() -> None:
    truth = {"m": 1.8, "d": 3.6, "k": 47.0}
    log = run(truth, [0.05, -0.1], 4, 1e-6, unstable=True)
    fit = identify.fit_trajectory(stage(unstable=True), log, ("m", "d", "k"), ("x", "v"), span=5)
    np.testing.assert_allclose(fit.estimate.values, list(truth.values()), rtol=2e-3)
    with pytest.raises(ModelError, match="not finite at the start"):
        long = Log(log.samples, 1.0)
        identify.fit_trajectory(stage(unstable=True), long, ("m",), ("x",))


@pytest.mark.parametrize("span", [9, 50, 100, 150, 199])
def test_spans_use_the_whole_log(span: int) -> None:
    """Spans of the given length alone would leave up to half of the rows out."""
    log = run({"m": 2.0, "d": 3.0, "k": 40.0}, [0.05, -0.1], 2, 1e-6)
    rows, spans = len(log), -(-len(log) // (span + 1))
    fit = identify.fit_trajectory(stage(), log, ("m", "d", "k"), ("x", "v"), span=span)
    assert fit.estimate.residual_freedom == 2 * (rows - rows % spans) - 3 - 2 * spans


def test_parameters_that_act_together_are_named() -> None:
    """Without force d / m and k / m alone act."""
    log = run({"m": 2.0, "d": 3.0, "k": 40.0}, [0.05, 0.0], 6, 0.0, push=0.0)
    start = {"x": 0.05, "v": 0.0}
    with pytest.raises(ModelError, match=r"the data leave m, d and k in proportion undetermined"):
        identify.fit_trajectory(stage(), log, ("m", "d", "k"), ("s",), initial=start)
    assert identify.fit_trajectory(stage(), log, ("d", "k"), ("s",), initial=start).estimate.by_name == pytest.approx(
        {"d": 3, "k": 40}, rel=1e-6
    )


TRAVEL = {"m": 1.8, "d": 3.6, "k": 47.0}


def coverage(logs: int, measured: tuple[str, ...], span: int | None, fixed: bool = False) -> float:
    """Return the share of 95 % intervals that hold the truth; v is logged with more noise than x and s."""
    hits = []
    for seed in range(logs):
        log = run(TRAVEL, [0.05, -0.1], seed, 1e-3)
        v = log.samples["v"] + 2e-2 * np.random.default_rng(1000 + seed).normal(size=len(log))
        noisy = Log({name: values[:150] for name, values in (dict(log.samples) | {"v": v}).items()}, 0.01)
        initial = {name: float(noisy.samples[name][0]) for name in ("x", "v")} if fixed else None
        estimate = identify.fit_trajectory(
            stage(), noisy, ("m", "d", "k"), measured, span, initial, substeps=1
        ).estimate
        low, high = estimate.intervals[:3].T
        hits.append((low < list(TRAVEL.values())) & (list(TRAVEL.values()) < high))
    return float(np.mean(hits))


@pytest.mark.slow
@pytest.mark.parametrize(("measured", "span"), [(("s",), None), (("x", "v"), 24)])
def test_noisy_start_states_leave_intervals_true(measured: tuple[str, ...], span: int | None) -> None:
    """12 logs, three intervals each, which go together at worst: a standard deviation of at most 6.3 %."""
    assert coverage(12, measured, span) > 0.8


def coarse(seed: int) -> tuple[Plant, Log]:
    """Return a stage of 7 Hz and its log at 50 Hz, noise a thousandth of the travel."""
    truth = {"m": 2.0, "d": 3.0, "k": 4000.0}
    rng, T, state, rows = np.random.default_rng(seed), 0.02, np.zeros(2), []
    M = scipy.linalg.expm(np.array([[0, 1, 0], [-truth["k"] / 2, -1.5, 0.5], [0, 0, 0]]) * T)
    f = rng.choice([-5.0, 5.0], 200)
    for force in f:
        rows.append(state[0])
        state = M[:2, :2] @ state + M[:2, 2] * force
    s = np.array(rows)
    s += 1e-3 * s.std() * rng.normal(size=len(s))
    return stage().with_parameters(**truth), Log({"f": f, "s": s}, T)


def test_the_integration_error_is_made_smaller_than_the_noise(monkeypatch: pytest.MonkeyPatch) -> None:
    plant, log = coarse(1)
    start, truth = {"x": 0.0, "v": 0.0}, [3.0, 4000.0]
    fit = identify.fit_trajectory(plant, log, ("d", "k"), ("s",), initial=start)
    assert (np.abs(fit.estimate.values - truth) < 3.5 * fit.estimate.errors).all()
    assert fit.substeps > 8 and fit.shift < identify.MAX_PARAMETER_SHIFT
    assert f"{fit.substeps} Runge-Kutta steps a period; half as many change a parameter by at most" in str(fit)
    with (
        monkeypatch.context() as planted,
        pytest.raises(ModelError, match=r"8 Runge-Kutta .* instead of 4 '[dk]' still"),
    ):
        planted.setattr(identify, "DOUBLINGS", 1)
        identify.fit_trajectory(plant, log, ("d", "k"), ("s",), initial=start)
    monkeypatch.setattr(identify, "MAX_PARAMETER_SHIFT", np.inf)
    wrong = identify.fit_trajectory(plant, log, ("d", "k"), ("s",), initial=start, substeps=2).estimate
    assert (np.abs(wrong.values - truth) > 5 * wrong.errors).any(), "planted: twice the steps count unchecked"


def test_an_outlier_is_named_by_its_row_of_the_log() -> None:
    log = run(TRAVEL, [0.05, -0.1], 3, 1e-3)
    x = log.samples["x"].copy()
    x[157] += 0.05
    fit = identify.fit_trajectory(stage(), Log(log.samples | {"x": x}, 0.01), ("m", "d", "k"), ("x", "v"), span=9)
    assert (fit.estimate.largest.output, fit.estimate.largest.row) == ("x", 157)
    assert "row 157" in str(fit)
    s = log.samples["s"].copy()
    s[50] += 10
    with pytest.raises(ModelError, match=r"largest for 's' in row 50, \d+.* times the rms"):
        identify.fit_trajectory(stage(), Log(dict(log.samples) | {"s": s}, 0.01), ("m", "d", "k"), ("s",))
