"""The NumPy references of the fault handling agree with its Blocks, and each planted difference is detected."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from synth.analyse.structure.parity import Relation
from synth.block import Block
from synth.blocks.estimate import predictor as predictor_block
from synth.blocks.faults import innovation_monitor
from synth.blocks.faults import landing as landing_block
from synth.blocks.faults import probe as probe_block
from synth.blocks.faults import redundancy as redundancy_block
from synth.composition import compose
from synth.reference import fault_handling
from synth.signals import Signal, signal_names
from synth.timing import Discrete
from synth.verify import agree, sampling

T, N = 1e-3, 5000
TIME = Discrete(T)
Columns = dict[str, Any]
X = Signal("x", "m", -0.1, 0.1)
W = Signal("w_x", "m/s^2", -1e4, 1e4)
TOLERANCE = 1e-12  # of a range


def whole(*blocks: Block) -> Block:
    """Return the Blocks as a controller, whose states have their names in front."""
    made = [name for b in blocks for name in signal_names(b.outputs)]
    read = dict.fromkeys(name for b in blocks for name in signal_names(b.inputs) if name not in made)
    return compose("whole", blocks, inputs=[*read], outputs=made)


def draw(block: Block, seed: int = 0) -> tuple[Columns, Columns]:
    rng = np.random.default_rng(seed)
    x, u = sampling.anywhere(block, rng, N)
    return x, {n: np.round(v) if n in FLAGS or n.startswith(("fault_", "suspect_")) else v for n, v in u.items()}


FLAGS = ("ready", "complete", "regular", "free", "latched", "x_trusted", "x_unanswered", "theta_measured", "y_measured")


def differs(block: Block, x: Columns, u: Columns, states: Columns, outputs: Columns) -> list[str]:
    """Return the next states and outputs that differ from those of the Block by more than rounding."""
    casadi = agree.casadi(block)(x, u)
    ranges = {s.signal.name: s.signal for s in block.states} | {s.name: s for s in block.outputs}
    pairs = [(n, casadi.states[n], v) for n, v in states.items()] + [
        (n, casadi.outputs[n], v) for n, v in outputs.items()
    ]
    return [n for n, a, b in pairs if np.max(np.abs(a - b)) > TOLERANCE * max(ranges[n].high - ranges[n].low, 1e-300)]


SENSORS = [Signal(n, "m", -1.0, 1.0) for n in ("a", "b", "c", "x")]
DECISION = redundancy_block.Decision(
    {"x": 1e-3}, {"x": (-0.9, 0.9)}, at_rest=50, jump={"x": 2e-3}, wide_jump={"x": 5e-3}, wide_frozen={"x": 3e-3},
    frozen={"x": 1.5e-3},
)  # fmt: skip
MISSED = Signal("missed_calls", "1", 0, 40)
OF = fault_handling.Sensors(
    {"a": 1.0, "b": -1.0, "c": 1.0}, 1e-3, 2.0, 1.8e-3, ["x"],
    gate=1e-3, frozen=1.5e-3, jump=2e-3, wide_jump=5e-3, wide_frozen=3e-3, travel=0.9, longest=50,
    low=np.full(4, -1.0), high=np.full(4, 1.0),
)  # fmt: skip


def redundancy_differs(of: fault_handling.Sensors = OF) -> list[str]:
    block = whole(
        innovation_monitor.block(TIME, SENSORS[-1], DECISION, MISSED),
        redundancy_block.block(TIME, SENSORS, [Relation(dict(OF.signs), 1e-3, 2.0, 1.8e-3)], DECISION),
    )
    x, u = draw(block)
    rng = np.random.default_rng(1)
    u["missed_calls"] = rng.choice((0.0, 0.0, 3.0, -1.0, np.nan), N)
    x["x_monitor_doubts"] = np.where(rng.uniform(size=N) < 0.5, 0.0, x["x_monitor_doubts"])
    x["x_monitor_before"] = np.clip(u["x_accepted"] + rng.choice((0, 0.02), N), -1, 1)
    u["b_accepted"] = np.clip(u["a_accepted"] + u["c_accepted"] + rng.choice((0, 5e-4, 1.4e-3, 0.01), N), -1, 1)
    for s, code in zip(SENSORS, of.states("code"), strict=True):
        off = rng.choice((0.0, 5e-4, 0.02), N) * rng.choice((-1, 1), N)
        u[f"{s.name}_expected"] = np.clip(u[f"{s.name}_accepted"] + off, -1, 1)
        moved = rng.choice((0.0, 0.0, 0.01, 0.5), N)
        x[code] = np.clip(u[f"{s.name}_accepted"] + moved, -1, 1)
        u[f"fault_{s.name}"] = (rng.uniform(size=N) < 0.1).astype(float)
    u["complete"] = (np.sum([u[f"fault_{s.name}"] for s in SENSORS], axis=0) == 0).astype(float)
    latched = (rng.uniform(size=N) < 0.2).astype(float)
    u["judging"] = u["ready"] * (1 - latched)
    read = x | {"guard_ready": u["ready"], "guard_latched": latched, "probe_x_attempt": u["x_unanswered"]}
    y, expected = (np.array([u[f"{s.name}_{n}"] for s in SENSORS]) for n in ("accepted", "expected"))
    good = np.array([u[f"fault_{s.name}"] == 0 for s in SENSORS])
    value, suspects, flags, after = fault_handling.readings(read, y, good, expected, 1, u["missed_calls"], of)
    outputs = {f"{s.name}_held": v for s, v in zip(SENSORS, value, strict=True)}
    outputs |= {f"suspect_{s.name}": v.astype(float) for s, v in zip(SENSORS, suspects, strict=True)}
    outputs |= {n: flags[n].astype(float) for n in ("regular", "determined", "sufficient")}
    outputs |= {f"x_{n}": flags[n][0].astype(float) for n in ("trusted", "frozen")}
    return differs(block, x, u, {n: np.asarray(v, float) for n, v in after.items()}, outputs)


def predictor_differs(bandwidth: float = 60.0) -> list[str]:
    flags = predictor_block.Flags("x_trusted", "x_unchanged", "suspect_x")
    block = predictor_block.block(
        "x", TIME, X, replace(W, name="w_before"), bandwidth=60.0, rate=2.0, disturbance=20.0, flags=flags,
        gain=predictor_block.Gain(0.8, 1.2, 30.0),
    )  # fmt: skip
    block = whole(block)
    x, u = draw(block)
    u["x_unchanged"] = np.round(u["x_unchanged"])
    of = fault_handling.Observers(
        {"x": fault_handling.Axis(bandwidth, -0.1, 0.1, 2.0, 20.0, True)}, T, 30.0, (0.8, 1.2)
    )
    trusted, frozen = (np.array([u[n] > 0]) for n in ("x_trusted", "suspect_x"))
    still, ready = np.array([u["x_unchanged"]]), u["ready"] > 0
    q, v, d, after = fault_handling.observe(
        x, np.array([u["x"]]), np.array([u["w_before"]]), trusted, frozen, still, ready, of
    )
    return differs(block, x, u, after, {"x_estimate": q[0], "x_rate": v[0], "x_disturbance": d[0]})


def probe_differs(quarter: int = 3) -> list[str]:
    settings = probe_block.Probe(quiet=40, quarter=3, step=4.2e-6, attempts=5)
    block = whole(probe_block.block(TIME, "x", Signal("e_x", "m", -0.2, 0.2), W, settings))
    x, u = draw(block)
    u["x_unchanged"] = np.round(u["x_unchanged"])
    by = fault_handling.Probe(40, quarter, 4.2e-6, 5, T)
    e, w, still = (np.array([u[n]]) for n in ("e_x", "w_x_unprobed", "x_unchanged"))
    demand, after = fault_handling.probe("x", w, e, x, still, u["free"] > 0, by)
    return differs(block, x, u, {n: np.asarray(v, float) for n, v in after.items()}, {"w_x": demand[0]})


def landing_differs(descent: float = 2.0, good_samples: int = 4, rest: float = 0.0305) -> list[str]:
    y = replace(W, name="w_y")
    courses = [
        landing_block.Descent("y", 0.031, 0.08, 5e-3, 1e-3, 2.0, 0.4e-3, 60.0, 0.5, 0.0305),
        landing_block.Braking("x", 4.0, 30.0, 0.5),
    ]
    block = whole(landing_block.block(TIME, courses, [y, W], 5, 4))
    x, u = draw(block)
    u["latched"], u["y"] = np.zeros(N), np.random.default_rng(2).uniform(0.03, 0.031, N)
    x["landing_r_y"] = np.where(u["y"] > 0.0303, 0.032, x["landing_r_y"])
    poles = {"y": 60.0, "x": 30.0}
    of = fault_handling.Landing(poles, poles, 0.031, 0.4e-3, 0.08, 5e-3, 1e-3, descent, (4.0,), 5, good_samples, T)
    estimate = tuple(np.array([u[f"{q}_{n}"] for q in "yx"]) for n in ("estimate", "rate", "disturbance"))
    read = x | {"guard_ready": u["ready"]}
    w, lands, after = fault_handling.demand(read, estimate, u["regular"] > 0, np.ones(N, bool), of)  # type: ignore[arg-type]
    landed = after.pop("landed")
    tracking = np.array([u["w_y_tracking"], u["w_x_tracking"]])
    demand = np.where(lands, np.clip(w, -of.most, of.most), tracking)
    rests = (landed & (u["y"] >= rest)).astype(float)
    outputs = {"w_y": demand[0], "w_x": demand[1], "landed": landed.astype(float), "rests": rests}
    return differs(block, x, u, {n: np.asarray(v, float) for n, v in after.items()}, outputs)


@pytest.mark.parametrize("of", [redundancy_differs, predictor_differs, probe_differs, landing_differs])
def test_a_reference_agrees_with_its_block(of: Callable[[], list[str]]) -> None:
    assert of() == []


@pytest.mark.parametrize(
    "of",
    [
        lambda: redundancy_differs(replace(OF, threshold=0.02)),
        lambda: redundancy_differs(replace(OF, gate=0.05)),
        lambda: redundancy_differs(replace(OF, gain=3.0)),
        lambda: redundancy_differs(replace(OF, largest=1.7e-3)),
        lambda: redundancy_differs(replace(OF, frozen=0.05)),
        lambda: redundancy_differs(replace(OF, jump=0.03)),
        lambda: redundancy_differs(replace(OF, wide_jump=0.03)),
        lambda: redundancy_differs(replace(OF, wide_frozen=0.03)),
        lambda: predictor_differs(61.0),
        lambda: probe_differs(4),
        lambda: landing_differs(2.1),
        lambda: landing_differs(rest=0.0304),
        lambda: landing_differs(good_samples=3),
    ],
)
def test_a_planted_defect_is_detected(of: Callable[[], list[str]]) -> None:
    assert of()


def test_missed_calls_count_from_0_to_the_limit() -> None:
    assert fault_handling.misses_calls([0.0, 40.0, 41.0, -1.0, np.nan], 40).tolist() == [False, False, True, True, True]
