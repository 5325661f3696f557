"""The servo of a voice coil axis: errors at its modes vanish for a wrong plant, and a step causes no kick."""

import re
from math import pi
from typing import Any

import numpy as np

from synth.block import Block
from synth.blocks.estimate import predictor
from synth.blocks.laws import predictive_servo
from synth.blocks.laws.axis_regulator import internal_weights
from synth.emit.write import emit
from synth.signals import Signal
from synth.statespace import Array, StateSpace
from synth.synthesise.feedback import lqr
from synth.synthesise.regulation import internal_model
from synth.timing import Continuous, Discrete

TIME, HUM = Discrete(1 / 2000), 2 * pi * 5
T = TIME.period_s
X = Signal("x_held", "m", -5e-3, 5e-3)
R, W = Signal("x_ref_held", "m", -2e-3, 2e-3), Signal("w_x", "m/s^2", -50.0, 50.0)
MODES = {0.0: 8.0, HUM: 6.0}
LIMITS = predictive_servo.Limits(5e-5, 0.05, 1.0)


def gain(modes: dict[float, float] = MODES) -> lqr.Gain:
    axis = StateSpace([[0, 1], [0, 0]], [[0], [1]], [[1, 0]], [[0]], ("e", "de"), ("w",), ("e",), Continuous())
    model, Q = internal_model.augmented(axis, list(modes)), np.zeros((5, 5))
    Q[0, 0], Q[1, 1] = 1e7, 2e4
    Q[2:, 2:] = internal_weights(modes, 1e7)
    return lqr.lqr(model, Q, np.eye(1))


def servo(limits: predictive_servo.Limits = LIMITS, modes: dict[float, float] = MODES, **changed: Any) -> Block:
    options: dict[str, Any] = {"measured": X, "reference": R, "demand": W, "cancelled": 0.8, "disturbance": 20.0}
    return predictive_servo.block("x", TIME, gain(modes), list(modes), limits=limits, **(options | changed))


def observer() -> Block:
    before = Signal("w_x_before", "m/s^2", -50.0, 50.0)
    return predictor.block("x", TIME, X, before, bandwidth=600.0, rate=1.0, disturbance=20.0, ahead=True)


def run(law: Block, references: Array, disturbance: Array, true_gain: float = 0.9) -> tuple[Array, Array]:
    """Return positions and demands of x'' = g w + d, one sample late, with an encoder of 20 nm."""
    look, act = observer(), law
    f, g = look.function(), act.function()
    states, memory, x, v, late = look.initial, act.initial, float(references[0]), 0.0, 0.0
    states[0] = x
    positions, demands = [], []
    for k, (r, d) in enumerate(zip(references, disturbance, strict=True)):
        measured, ready = round(x / 2e-8) * 2e-8, float(k > 0)
        inputs = {"x_held": measured, "w_x_before": late, "ready": ready, "x_ref_held": r}
        states, y = (np.asarray(v).ravel() for v in f(states, [inputs[s.name] for s in look.inputs]))
        inputs |= dict(zip((s.name for s in look.outputs), y.tolist(), strict=True))
        memory, w = (np.asarray(v).ravel() for v in g(memory, [inputs[s.name] for s in act.inputs]))
        positions.append(x)
        demands.append(float(w[0]))
        a = true_gain * late + float(d)
        x, v, late = x + T * v + T**2 / 2 * a, v + T * a, float(w[0])
    return np.array(positions), np.array(demands)


def residual(law: Block) -> float:
    time = np.arange(6000) * T
    references = 1e-3 * np.sin(HUM * time)
    x, _ = run(law, references, 0.5 + 0.2 * np.sin(HUM * time))
    return float(np.abs(x - references)[-1000:].max())


def test_errors_at_the_modes_vanish_for_a_wrong_plant() -> None:
    assert residual(servo()) < 3e-7


def test_a_mode_at_another_frequency_leaves_an_error() -> None:
    assert residual(servo(modes={0.0: 8.0, 1.2 * HUM: 6.0})) > 1e-6


def test_a_step_causes_no_kick_and_does_not_wind_up() -> None:
    references = np.where(np.arange(4000) * T < 0.1, 0.0, 1e-3)
    still = np.zeros(4000)
    x, w = run(servo(), references, still)
    K = gain().K[0]
    assert np.abs(w).max() < 1.01 * abs(K[0]) * 1e-3
    free, _ = run(servo(predictive_servo.Limits(1.0, 0.05, 1.0)), references, still)
    assert x.max() - 1e-3 < 0.25 * (free.max() - 1e-3)
    assert abs(x[-1] - 1e-3) < 1e-6


def test_internal_models_stay_as_they_are_at_the_limit_of_their_norm() -> None:
    most = 4e-4
    law, free = servo(predictive_servo.Limits(5e-5, 0.05, most)), servo(predictive_servo.Limits(5e-5, 0.05, 1.0))
    eta = [k for k, s in enumerate(law.states) if s.signal.name != "r"]
    assert len(eta) == 3
    inputs = [3e-5 if s.name == X.name else 0.0 for s in law.inputs]
    bounded, unbounded, stayed = law.initial, free.initial, 0
    for _ in range(40):
        before = bounded
        bounded, _ = (np.asarray(v).ravel() for v in law.function()(before, inputs))
        unbounded, _ = (np.asarray(v).ravel() for v in free.function()(unbounded, inputs))
        unlimited, _ = (np.asarray(v).ravel() for v in free.function()(before, inputs))
        fits = np.linalg.norm(unlimited[eta]) <= most
        assert (bounded[eta] == (unlimited if fits else before)[eta]).all()
        stayed += not fits
    assert 10 < stayed < 40
    assert np.linalg.norm(bounded[eta]) <= most < np.linalg.norm(unbounded[eta])


def test_the_c_states_the_bounds_that_the_norm_implies() -> None:
    text = emit(servo(), np.float32).files["servo_x.c"]
    for name in ("sum_next", "p1_next", "q1_next"):
        assert re.search(
            rf"if \(.* <= 1\.0f\) {{\n(?: +/\*@.*\n)* +/\*@ admit -1\.0+\d*f <= {name} <= 1\.0+\d*f; \*/", text
        )


def test_a_set_point_at_its_end_leaves_the_last_one_inside_its_bounds() -> None:
    law = servo()
    by_name = dict(zip((s.name for s in law.inputs), [0.0] * len(law.inputs), strict=True))
    (last,) = [s.signal for s in law.states if s.signal.name == "r"]
    for end in (R.low, R.high):
        after, _ = law.function()(law.initial, list((by_name | {R.name: end}).values()))
        r = float(np.asarray(after).ravel()[-1])
        assert r == end
        assert max(last.low - r, r - last.high) < -0.1 * (R.high - R.low)


def test_the_prediction_ahead_is_the_next_position() -> None:
    look = observer()
    f, states = look.function(), look.initial
    ahead = 0.0
    for k in range(400):
        x = 1e-3 * np.sin(20 * k * T)
        error = x - ahead
        before = -0.4 * np.sin(20 * (k + 0.5) * T)
        states, y = (np.asarray(v).ravel() for v in f(states, [x, before, float(k > 0)]))
        ahead = dict(zip((s.name for s in look.outputs), y.tolist(), strict=True))["x_ahead"]
    assert abs(error) < 1e-9
