"""Fits of model (2) to scans above blocks: coefficients, intervals, the residual's map, the gap."""

from dataclasses import replace

import numpy as np
import pytest

from designs.hall_position.paper import scan_fit
from models import concentrated_field as cf
from models.hall_array import HallArray, Sensor
from models.hall_chain import Chain
from synth.errors import ModelError, SignalError
from synth.synthesise.identify import logs
from synth.synthesise.identify.logs import Log

l = 50.8e-3
P = cf.values()
FABRICATED = cf.waves(cf.fabricated_matrix(P["strong"], P["weak"]), cf.orders_on_axes((1, 3, 5, 9)) + cf.CROSS, P)
MODEL = cf.waves_from_amplitudes({1: 0.37502, 5: -0.02146}, 3e-3, P)
MISALIGNED = HallArray((Sensor((0.0, 0.0, 0.0), misalignment=(0.0, 0.0, 0.02)),), volume=(0.0, 0.0, 0.0))
EXACT = replace(MISALIGNED, chain=Chain(noise=0.0))
HEIGHTS = (2e-3, 2.5e-3, 3e-3, 3.5e-3, 4e-3)


def formula(at: dict[str, np.ndarray], k: dict[str, float]) -> np.ndarray:
    w = 2 * np.pi / l
    X, Y = at["X"], at["Y"]
    waves = k["alpha"] * np.sin(w * X) + k["beta"] * np.sin(5 * w * X)
    return k["c"] + waves + k["gamma"] * np.sin(w * Y) + k["delta"] * np.sin(5 * w * Y)


@pytest.mark.parametrize(("channel", "along", "sign"), [("V_ax", "X", 1), ("V_ay", "Y", -1)])
def test_a_turned_sensor_is_the_model_exactly(channel: str, along: str, sign: int) -> None:
    fit = scan_fit.fit(scan_fit.simulate_scan(EXACT, MODEL, scan_fit.places(l, 16), 0), channel, l, along)
    c, s = np.cos(0.02), sign * np.sin(0.02)
    expected = [0.0, 8.4 * 0.37502 * c, -8.4 * 0.02146 * c, 8.4 * 0.37502 * s, -8.4 * 0.02146 * s]
    np.testing.assert_allclose(fit.estimate.values, expected, rtol=0, atol=1e-12)
    assert np.abs(fit.residual).max() < 1e-12


def test_the_residual_above_blocks_is_as_published() -> None:
    aligned = replace(MISALIGNED, sensors=(Sensor((0.0, 0.0, 0.0)),))
    waves = cf.waves(cf.fabricated_matrix(P["strong"], P["weak"]), cf.orders_up_to(5) + cf.orders_on_axes((7, 9)), P)
    fit = scan_fit.fit(scan_fit.simulate_scan(aligned, waves, scan_fit.places(l, 40), 1), "V_ax", l)
    assert abs(fit.estimate["alpha"] - 8.4 * 0.37502) < 1e-3 and abs(fit.estimate["beta"] + 8.4 * 0.02146) < 1e-3
    assert 0.11 < np.abs(fit.residual).max() < 0.2  # V: "less than 200 mV"; of (2, +-1), the 9th and the 3rd
    np.testing.assert_allclose(fit.measured, fit.modelled + fit.residual, rtol=0, atol=1e-15)
    np.testing.assert_allclose(fit.modelled, formula({"X": fit.X, "Y": fit.Y}, fit.estimate.by_name), atol=1e-12)
    assert "The largest residual is" in repr(fit)


def coverage(noise: float, stated: float) -> float:
    """Return the part of intervals, of the level 0.9, that hold the truth."""
    k = {"c": 0.01, "alpha": 3.15, "beta": -0.18, "gamma": 0.03, "delta": -0.002}
    at, inside = scan_fit.places(l, 9), []
    for seed in range(80):
        rng = np.random.default_rng(seed)
        volts = formula(at, k) + noise * rng.standard_normal(81)
        estimate = scan_fit.fit(Log({"X": at["X"], "Y": at["Y"], "V": volts}), "V", l, level=0.9).estimate
        low, high = (estimate.values[:, None] + stated * (estimate.intervals - estimate.values[:, None])).T
        inside.append((low <= list(k.values())) & (list(k.values()) <= high))
    return float(np.mean(inside))


def test_intervals_hold_the_truth_as_often_as_they_say() -> None:
    assert abs(coverage(1e-3, 1.0) - 0.9) < 0.045  # three deviations of 400 draws
    assert coverage(1e-3, 0.7) < 0.85  # intervals too short by a third would be seen


def test_a_line_does_not_tell_the_coefficients_apart() -> None:
    log = scan_fit.simulate_scan(MISALIGNED, MODEL, scan_fit.places(l, 32), 0)
    line = log.samples["Y"] == log.samples["Y"][3]
    with pytest.raises(ModelError, match=r"gamma"):
        scan_fit.fit(Log({name: v[line] for name, v in log.samples.items()}), "V_ax", l)


def by_height(waves: tuple[cf.Wave, ...], noise: float = 1e-3) -> dict[float, scan_fit.Fit]:
    array = replace(MISALIGNED, chain=Chain(noise=noise))
    return {
        z: scan_fit.fit(scan_fit.simulate_scan(array, waves, scan_fit.places(l, 20, (z,)), seed), "V_ax", l)
        for seed, z in enumerate(HEIGHTS)
    }


@pytest.mark.parametrize("coefficient", ["alpha", "beta", "gamma"])
def test_coefficients_decay_by_the_law(coefficient: str) -> None:
    decay = scan_fit.decay(by_height(FABRICATED), coefficient, l)
    low, high = decay.estimate.intervals[1]
    assert low <= decay.law <= high and high - low < 0.1 * decay.law


def test_a_field_that_decays_otherwise_is_seen() -> None:
    slow = tuple(replace(wave, kappa=0.99 * wave.kappa) for wave in MODEL)
    decay = scan_fit.decay(by_height(slow), "alpha", l)
    low, high = decay.estimate.intervals[1]
    assert not low <= decay.law <= high
    assert low <= 0.99 * decay.law <= high


def test_refusals() -> None:
    fits = by_height(MODEL)
    with pytest.raises(SignalError, match="give X or Y"):
        scan_fit.fit(Log(dict.fromkeys("XYV", np.zeros(1))), "V", l, "Z")
    with pytest.raises(SignalError, match="no signal 'V_bx'"):
        scan_fit.fit(scan_fit.simulate_scan(MISALIGNED, MODEL, scan_fit.places(l, 8), 0), "V_bx", l)
    with pytest.raises(SignalError, match="'c' has no decay"):
        scan_fit.decay(fits, "c", l)
    with pytest.raises(SignalError, match="three or more"):
        scan_fit.decay({z: fits[z] for z in HEIGHTS[:2]}, "alpha", l)
    with pytest.raises(SignalError, match="not distinguishable from 0"):
        scan_fit.decay(by_height(MODEL, noise=0.5), "delta", l)


def test_a_scan_goes_through_a_file() -> None:
    log = scan_fit.simulate_scan(MISALIGNED, FABRICATED, scan_fit.places(l, 12), 3)
    rows = log.columns(("X", "Y", "V_ax")).tolist()
    text = "\n".join(["X [m], Y [m], V_ax [V]", *(", ".join(map(repr, row)) for row in rows)])
    read = logs.parse(text, {"X": "m", "Y": "m", "V_ax": "V"})
    np.testing.assert_array_equal(
        scan_fit.fit(read, "V_ax", l).estimate.values, scan_fit.fit(log, "V_ax", l).estimate.values
    )
