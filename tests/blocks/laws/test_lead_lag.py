"""The loop's Block is the compensator while its demand is achieved; its integral stops where the demand is limited."""

from dataclasses import replace

import numpy as np
import scipy.signal

from synth.block import Block
from synth.blocks.laws import lead_lag as loop
from synth.signals import Signal
from synth.synthesise.classical import lead_lag
from synth.timing import Discrete
from tests import tolerances

T = 1e-3
K = lead_lag.tustin(lead_lag.Compensator(40.0, (-30.0, -2.0), (-900.0, 0.0)), T, 60.0)
POSITION, SET_POINT = Signal("z", "m", -1, 1), Signal("z_ref", "m", -1, 1)
DEMAND, ACHIEVED = Signal("force", "N", -500, 500), Signal("force_achieved", "N", -100, 100)
LOOP = loop.Loop(POSITION, SET_POINT, DEMAND, ACHIEVED, 2.0, 100.0)


def demands(block: Block, errors: np.ndarray, limit: float) -> np.ndarray:
    """Return the demand of each sample (n,), of which `limit` is achieved at most."""
    step, x, values = block.function(), block.initial, list[float]()
    assert [s.name for s in block.inputs] == ["z", "z_ref", "force_achieved"]
    for e in errors:
        demand = float(np.asarray(step(x, [-e, 0.0, 0.0])[1]).ravel()[0])
        x = np.asarray(step(x, [-e, 0.0, np.clip(demand, -limit, limit)])[0]).ravel()
        values.append(demand)
    return np.array(values)


def test_an_achieved_demand_is_that_of_the_compensator_over_the_scale() -> None:
    errors = np.random.default_rng(0).uniform(-1, 1, 400)
    zeros, poles = (np.array([v.real for v in values]) for values in (K.zeros, K.poles))
    b, a = scipy.signal.zpk2tf(zeros, poles, K.gain / LOOP.scale)
    exact = scipy.signal.lfilter(b, a, errors)
    made = demands(loop.block("loop_z", Discrete(T), K, LOOP, "(21)"), errors, 1e9)
    np.testing.assert_allclose(made, exact, rtol=0, atol=tolerances.of("settled") * np.abs(exact).max())


def test_the_integral_follows_the_achieved_demand_to_its_limit() -> None:
    """After a long saturation the demand leaves the limit at once: it exceeds it by the proportional part alone."""
    block = loop.block("loop_z", Discrete(T), K, LOOP, "(21)")
    made = demands(block, np.concatenate([np.full(20_000, 0.5), np.zeros(50)]), 10.0)
    assert made[19_999] > 10.0
    assert np.all(np.abs(made[20_010:]) <= 10.0)


def test_the_states_stay_in_their_ranges_where_position_and_set_point_have_other_ranges() -> None:
    """A constant error of 11 m, and achieved demands that alternate, at a zero of the integral below 0."""
    position, set_point = Signal("z", "m", -10, 1), Signal("z_ref", "m", -1, 1)
    K_negative = replace(K, zeros=(K.zeros[0], -0.5 + 0j))
    block = loop.block("loop_z", Discrete(T), K_negative, replace(LOOP, position=position, set_point=set_point), "(21)")
    step, x, reached = block.function(), block.initial, np.zeros(2)
    for k in range(2000):
        x = np.asarray(step(x, [-10.0, 1.0, 100.0 * (-1) ** k])[0]).ravel()
        reached = np.maximum(reached, np.abs(x))
    high = np.array([s.signal.high for s in block.states])
    assert np.all(reached <= high) and np.all(reached > 0.9 * high)
