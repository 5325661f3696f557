"""Parity relations: found from the kinematics, exact where the sensors are redundant, none where they are not."""

import casadi as ca
import numpy as np
import pytest

from models import maglev_stage
from synth.analyse.structure import parity
from synth.plant import Plant, build
from synth.signals import Signal

GAPS = {f"y{j}": f"g{j}" for j in (1, 2, 3, 4)}


def tolerances(names: object, resolution: float = 1e-5, offset: float = 7e-6) -> dict[str, parity.Tolerance]:
    return dict.fromkeys(names, parity.Tolerance(resolution, offset))  # type: ignore[call-overload, no-any-return]


def bent(curvature: float, unit: str = "m") -> Plant:
    """Return a plant with two sensors of one position, the second one curved."""
    q = Signal("q", "m", -1.0, 1.0)
    outputs = [Signal("a", "m", -2.0, 2.0), Signal("b", unit, -2.0, 2.0)]

    def physics(x, u, p):  # type: ignore[no-untyped-def]
        return {"q": ca.SX(0)}, {"a": x["q"], "b": x["q"] + curvature * x["q"] ** 2}

    return build("bent", [q], [], outputs, [], physics)


def test_the_gap_encoders_of_the_maglev_stage_are_redundant_and_x_and_z_are_not() -> None:
    sensors = {**GAPS, "x": "x", "z": "z"}
    (relation,) = parity.relations(maglev_stage.plant(), sensors, tolerances(sensors))
    assert relation.weights == {"y1": 1.0, "y2": -1.0, "y3": 1.0, "y4": -1.0}  # F(5)
    assert relation.threshold == pytest.approx(4 * (5e-6 + 7e-6), rel=1e-9)  # exact at every angle: no nonlinearity
    pose = {"y": 0.025, "phi": 0.003, "theta": -0.013}
    outputs = maglev_stage.plant().output_values(pose)
    assert abs(sum(w * float(outputs[GAPS[n]][0]) for n, w in relation.weights.items())) < 1e-16


def test_noise_raises_the_threshold_by_the_mean_squared_change_of_the_residual() -> None:
    """White noise of one count, rounded to counts: the mean square measures it, and few samples are beyond."""
    K, chance = 3.290527, 1e-3
    known = dict.fromkeys(GAPS, parity.Tolerance(1e-5, 7e-6, noise=1e-5))
    (relation,) = parity.relations(maglev_stage.plant(), GAPS, known, chance)
    assert relation.threshold == pytest.approx(48e-6)  # of a quiet machine, as without noise
    rng, signs = np.random.default_rng(1), np.array([*relation.weights.values()])
    places = rng.uniform(-0.5, 0.5, (4, 1))  # counts
    r = signs @ (1e-5 * (np.round(places + rng.normal(0.0, 1.0, (4, 400_000))) - places)) + 28e-6
    bound = relation.threshold**2 + relation.gain * np.mean(np.diff(r) ** 2)
    assert np.sqrt(bound) == pytest.approx(relation.largest, rel=0.01)
    beyond = np.mean(r > relation.largest)
    assert 0 < beyond < chance / 2  # of both ends; the offsets are at one
    assert np.mean(r > relation.threshold) > 100 * beyond  # the planted defect: a threshold without the noise
    s = np.linspace(0.0, 50e-6, 1001)
    excess = np.sqrt(relation.threshold**2 + relation.gain * 2 * s**2) - (28e-6 + K * s)
    assert excess.min() == pytest.approx(0.0, abs=1e-9) and excess[0] == pytest.approx(20e-6)


def test_without_one_gap_encoder_no_relation_is_left() -> None:
    three = {n: GAPS[n] for n in ("y1", "y2", "y3")}
    assert parity.relations(maglev_stage.plant(), three, tolerances(three)) == ()


def test_a_curved_sensor_raises_the_threshold_by_its_nonlinearity() -> None:
    sensors = {"a": "a", "b": "b"}
    (straight,) = parity.relations(bent(0.0), sensors, tolerances(sensors, 0.0, 0.0))
    (curved,) = parity.relations(bent(0.1), sensors, tolerances(sensors, 0.0, 0.0))
    assert straight.threshold < 1e-12 and curved.threshold == pytest.approx(0.1)
    assert curved.weights == {"a": 1.0, "b": -1.0}


def test_three_sensors_of_one_position_have_two_relations_that_are_independent() -> None:
    sensors = {"a": "g1", "b": "g1", "c": "g1"}
    relations = parity.relations(maglev_stage.plant(), sensors, tolerances(sensors))
    rows = np.array([[r.weights.get(n, 0.0) for n in "abc"] for r in relations])
    assert rows.shape == (2, 3) and np.linalg.matrix_rank(rows) == 2
    np.testing.assert_allclose(rows.sum(axis=1), 0.0, atol=1e-12)
