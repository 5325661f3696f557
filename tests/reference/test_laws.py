"""The NumPy lead-lag loop, dead reckoning and braking agree with their Blocks, and each planted defect is detected."""

from dataclasses import replace
from fractions import Fraction
from typing import Any

import numpy as np
import pytest

from synth.block import Block
from synth.blocks.estimate import dead_reckoning as dead_reckoning_block
from synth.blocks.guard import safe_output
from synth.blocks.laws import lead_lag as lead_lag_block
from synth.composition import compose
from synth.reference import dead_reckoning, lead_lag
from synth.signals import Signal, signal_names
from synth.synthesise.classical import lead_lag as synthesis
from synth.timing import Discrete
from synth.verify import agree, sampling

TIME, N = Discrete(1e-3), 2000
T = TIME.period_s
Z, R, D = Signal("z", "m", -1e-3, 1e-3), Signal("z_ref", "m", -1e-3, 1e-3), Signal("d", "A", -1e5, 1e5)
LOOP = lead_lag_block.Loop(Z, R, D, Signal("achieved", "A", -2.0, 2.0), scale=13.0, achievable=2.0)
GAIN, ZEROS = 3.2e5, (102.91, 10.0)


def compensators(pole: float) -> tuple[synthesis.LeadLag, lead_lag.Compensator]:
    continuous = synthesis.Compensator(GAIN, (-ZEROS[0], -ZEROS[1]), (-pole, 0.0))
    exact = lead_lag.tustin(Fraction(GAIN), (Fraction(str(ZEROS[0])), Fraction(10)), Fraction(pole), Fraction(1, 1000))
    return synthesis.tustin(continuous, T, 200.0), exact


def whole(blocks: list[Block], inputs: list[str], outputs: list[str]) -> Block:
    return compose("whole", blocks, inputs=inputs, outputs=outputs)


def gap(block: Block, x: Any, u: Any, states: Any, outputs: Any) -> float:
    casadi = agree.casadi(block)(x, u)
    pairs = [(casadi.states[n], v) for n, v in states.items()] + [(casadi.outputs[n], v) for n, v in outputs.items()]
    return max(float(np.max(np.abs(a - b)) / max(np.max(np.abs(a)), 1e-12)) for a, b in pairs)


def lead_lag_gap(pole: float, z2: float | None = None) -> float:
    K, exact = compensators(pole)
    exact = replace(exact, z2=z2 or exact.z2)
    block = whole([lead_lag_block.block("loop", TIME, K, LOOP, "(1)")], ["z", "z_ref", "achieved"], ["d"])
    x, u = sampling.anywhere(block, np.random.default_rng(0), N)
    e = u["z_ref"] - u["z"]
    after = lead_lag.next_state("loop", exact, e, LOOP.scale * u["achieved"], x, LOOP.scale)
    return gap(block, x, u, after, {"d": lead_lag.demand("loop", exact, e, x, LOOP.scale) / LOOP.scale})


@pytest.mark.parametrize("pole", [776.828, 2000.0])
def test_a_lead_lag_loop_agrees_with_its_block(pole: float) -> None:
    assert lead_lag_gap(pole) < 1e-11
    assert lead_lag_gap(pole, 0.98) > 1e-3


def test_its_integral_ends_at_the_achieved_demand() -> None:
    K, exact = compensators(2000.0)
    state = {"loop_lead": np.array(0.0), "loop_integral": np.array(5.0)}
    for _ in range(2000):
        state = lead_lag.next_state("loop", exact, np.array(0.0), np.array(13.0), state, 13.0)
    assert state["loop_integral"] == pytest.approx(1.0, rel=1e-6)
    assert lead_lag_block.pole(K) == 0


B, BANDWIDTH, INERTIA, REMAINING = 13.0, 48.0, 1.5, 0.5
Q = Signal("q", "m", -0.1, 0.1)
ACTING = Signal("acting_q", "A", -2.0, 2.0)
MEAN, UNMEASURED = 0.99, 28
BIAS = dead_reckoning_block.RateBias(MEAN, UNMEASURED)
PREDICTED = replace(Q, name="q_predicted", low=-0.2, high=0.2)
AXIS = dead_reckoning_block.Axis("q", Q, PREDICTED, ACTING, B, 2.0, 1 - 0.048, BIAS)
DEMANDS = {"q": (replace(D, name="law_q"), replace(D, name="d_q"))}


def reckoning_gap(w: float = BANDWIDTH, remaining: float = REMAINING, unmeasured: int = UNMEASURED) -> float:
    blocks = [
        dead_reckoning_block.block("reckoning", TIME, [AXIS]),
        safe_output.braking_block("braking", TIME, [AXIS], DEMANDS, 1 - REMAINING),
    ]
    open_inputs = [s.name for b in blocks for s in b.inputs if s.name not in signal_names(blocks[0].outputs)]
    block = whole(blocks, list(dict.fromkeys(open_inputs)), ["q_predicted", "d_q"])
    x, u = sampling.anywhere(block, np.random.default_rng(0), N)
    u |= {n: np.round(v) for n, v in u.items() if n in ("ready", "measured", "brakes")}
    now = dead_reckoning.Sample(
        {"q": u["q"]}, u["ready"] > 0, (u["ready"] > 0) & (u["measured"] > 0), {"q": u["acting_q"]}, T,
        {"q": dead_reckoning.Axis(B, w, 2.0, 0.2, MEAN, unmeasured)},
    )  # fmt: skip
    rates, force = dead_reckoning.next_rates(x, now), {"q": u["law_q"] * B * INERTIA}
    demand = dead_reckoning.brake(force, rates, u["brakes"] > 0, T, {"q": INERTIA}, remaining)
    outputs = {"q_predicted": dead_reckoning.predicted_pose(x, "q")["q"], "d_q": demand["q"] / B / INERTIA}
    return gap(block, x, u, dead_reckoning.next_state(x, now), outputs)


def test_dead_reckoning_and_braking_agree_with_their_blocks() -> None:
    assert reckoning_gap() < 1e-11
    assert reckoning_gap(w=50.0) > 1e-4 and reckoning_gap(remaining=0.6) > 1e-4 and reckoning_gap(unmeasured=0) > 1e-4
    states = {f"reckoning_q_{part}" for part in ("position", "rate", "mean")}
    assert set(dead_reckoning.initial_state("q", "q")) == states
