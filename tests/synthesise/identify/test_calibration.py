"""Calibration of a measurement model: parameters, what noise explains, held-out model error, and drift of gains."""

from collections.abc import Mapping

import casadi as ca
import numpy as np
import pytest

from synth.blocks.estimate import glsdc_model
from synth.errors import ModelError, SignalError
from synth.signals import Parameter
from synth.synthesise.identify import calibration
from synth.synthesise.identify.calibration import Calibration
from synth.synthesise.identify.logs import Log

TRUE = {"gain": 1.1, "offset": 0.2, "place": 0.5}
PARAMETERS = [Parameter(n, v, "1", 0.1, "nominal") for n, v in {"gain": 1.0, "offset": 0.0, "place": 0.4}.items()]
NOISE, REFERENCE = 0.01, 0.02
DEVIATIONS = {"references": {"x": REFERENCE, "y": 0.0}, "readings": {"a": NOISE, "b": NOISE}}


def h(q: Mapping[str, ca.SX], k: Mapping[str, ca.SX]) -> dict[str, ca.SX]:
    return {"a": k["gain"] * q["x"] + k["offset"], "b": ca.sin(q["x"] + k["place"] * q["y"])}


def scan(n: int, seed: int, ripple: float = 0.0) -> Log:
    """Return a scan; the ripple is a model error of channel a, its amplitude."""
    rng = np.random.default_rng(seed)
    x, y = rng.uniform(-1, 1, (2, n))
    a = TRUE["gain"] * x + TRUE["offset"] + ripple * np.sin(40 * x)
    b = np.sin(x + TRUE["place"] * y)
    a, b = (v + NOISE * rng.standard_normal(n) for v in (a, b))
    return Log({"x": x + REFERENCE * rng.standard_normal(n), "y": y, "a": a, "b": b})


def fit(ripple: float = 0.0, free: list[str] | None = None, n: int = 2000) -> Calibration:
    return calibration.calibrate(h, scan(n, 1, ripple), PARAMETERS, free=free, **DEVIATIONS)


def test_the_parameters_are_those_of_the_scan() -> None:
    calibrated = fit()
    for name, value in TRUE.items():
        assert abs(calibrated.values[name] - value) < 5 * calibrated.estimate.errors.max() < 0.02
    assert [c.value for c in calibrated.constants] == list(calibrated.values.values())


def test_what_is_not_free_stays_and_a_stage_starts_from_another() -> None:
    first = fit(free=["gain"])
    assert first.values["offset"] == 0.0 and first.estimate.parameters == ("gain",)
    second = calibration.calibrate(h, scan(2000, 1), first.parameters, free=["offset", "place"], **DEVIATIONS)
    assert second.values["gain"] == first.values["gain"] and abs(second.values["offset"] - 0.2) < 0.01


def test_the_noise_of_the_reference_explains_its_part_of_the_residual() -> None:
    assessed = calibration.assess(fit(), scan(4000, 2))
    assert assessed.explained["a"] == pytest.approx(np.hypot(NOISE, 1.1 * REFERENCE), rel=0.01)
    assert assessed.rms["a"] == pytest.approx(assessed.explained["a"], rel=0.05)
    assert assessed.model_error["a"] < 0.3 * assessed.rms["a"]


def test_a_model_error_that_the_scan_has_is_in_r() -> None:
    """The planted defect: a ripple that h does not have; an assumed 0 would miss it."""
    assessed = calibration.assess(fit(ripple=0.1), scan(4000, 2, ripple=0.1))
    assert 0.1 / np.sqrt(2) < assessed.model_error["a"] < 0.085
    R = glsdc_model.covariance([NOISE] * 2, assessed.budget())
    assert R[0, 0] > 40 * NOISE**2 and R[1, 1] < 2 * NOISE**2


def test_the_residuals_of_the_fit_itself_are_smaller_than_those_held_out() -> None:
    """The planted defect: with few samples the fitted scan looks better than the channels are."""
    flattering, honest = [], []
    for seed in range(30):
        log = scan(6, seed)
        try:
            calibrated = calibration.calibrate(h, log, PARAMETERS, **DEVIATIONS)
        except ModelError:
            continue
        flattering.append(np.mean(calibrated.residuals(log) ** 2))
        honest.append(np.mean(calibrated.residuals(scan(500, 99)) ** 2))
    assert len(honest) > 20 and np.median(honest) > 1.5 * np.median(flattering)


def test_the_budget_grows_with_the_drift_of_gains() -> None:
    assessed = calibration.assess(fit(), scan(1000, 2))
    assert assessed.budget(0.1)[0] == pytest.approx(np.hypot(assessed.model_error["a"], 0.1 * assessed.size["a"]))
    with pytest.raises(ModelError, match=r"drift of gains is -0\.1"):
        assessed.budget(-0.1)


def test_corrections_are_added_to_the_model() -> None:
    log = scan(3000, 2, ripple=0.1)
    ripple = np.column_stack([0.1 * np.sin(40 * log.samples["x"]), np.zeros(3000)])
    without, with_them = (calibration.assess(fit(ripple=0.1), log, c) for c in (None, ripple))
    assert with_them.rms["a"] < 0.9 * without.rms["a"] and with_them.rms["b"] == without.rms["b"]
    with pytest.raises(SignalError, match="one for each residual"):
        calibration.assess(fit(), log, ripple[:5])


def test_a_parameter_that_the_scan_does_not_determine_is_named() -> None:
    log = scan(200, 1)
    still = Log({**log.samples, "y": np.zeros(200)})
    with pytest.raises(ModelError, match="place"):
        calibration.calibrate(h, still, PARAMETERS, **DEVIATIONS)
