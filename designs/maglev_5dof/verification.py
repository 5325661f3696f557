"""Verification of the emitted C: NumPy reference, CasADi, CasADi's own C, and the C in double and in single precision.

Random steps start from states and inputs drawn near operation over the whole range of poses, each sample independent;
most leave the motors unsaturated, so that a difference is not hidden by a limit. Edge steps draw states anywhere in
their bounds and put every input on the ends of its range, beyond them, and on values that are no numbers. Recorded
inputs of closed loops are replayed from `init`.
"""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from designs.maglev_5dof import control, experiments, reference
from designs.maglev_5dof.loop import Loop, compiled
from synth.block import Block
from synth.check import Check
from synth.execute import host
from synth.plant import Plant
from synth.simulate.scenario import Trajectory, sample_times
from synth.simulate.sensors import Override
from synth.verify import agree
from synth.verify.evidence import Evidence

Columns = dict[str, NDArray[np.float64]]
RANDOM_STEPS = 100_000
EDGE_STEPS = 20_000
SEED = 20_090_901
CORNER = 0.98  # of the limit of i_d: there the room sqrt(C^2 - i_d^2) of i_q has the slope -5, further on up to -70
NEAR = 0.003  # of a bound: internal models whose part of the demand is what a motor can do
INSIDE = 1e-8  # m, rad: a range ends at another number in single than in double precision
FLOOR = 1.0  # A
# A: edge steps demand up to 1e3 A of a motor, which the limit cuts. Where such demands cancel to less, the error of the
# polynomials, up to 1e-14 of each term, counts a thousandfold: these currents are held against the limit.
EDGE_FLOOR = control.CURRENT
EXACT = 1e-12  # of max(floor, |i|): float64 C against the reference
POINTWISE = {
    "y": 1e-7,
    "x": 1e-7,
    "z": 1e-7,
    "phi": 5e-7,
    "theta": 5e-7,
}  # m, rad: single against double, ideal sensing
MEANS = {"y": 1e-7, "x": 1e-7, "z": 1e-7, "phi": 2e-7, "theta": 2e-7}  # m, rad: mean errors, with encoders
SPECIAL = (np.nan, np.inf, -np.inf, 5e-324, -5e-324, 1e-40, -0.0, 0.0, 1e300, -1e300)


def random_steps(block: Block, n: int) -> tuple[Columns, Columns]:
    """Draw n independent (states, inputs) over the domain; the platen is near its set-points, so that few saturate.

    The last currents are those that hold a level platen at each motor's gap, within half an ampere. Steps with a direct
    current in the corner are left to `edge_steps`.
    """
    states, inputs = _in_operation(block, n + n // 4)
    kept = np.flatnonzero(~_cornered(reference.step(states, inputs)[1]))[:n]
    return {s: v[kept] for s, v in states.items()}, {s: v[kept] for s, v in inputs.items()}


def _cornered(outputs: agree.Columns) -> NDArray[np.bool_]:
    """Tell for each sample whether some i_d is near its limit but not at it, where the room of i_q falls steeply."""
    size = np.abs([outputs[f"i_d{j}"] for j in range(1, 5)])
    return np.any((size > CORNER * control.DIRECT) & (size < control.DIRECT), axis=0)


def _in_operation(block: Block, n: int) -> tuple[Columns, Columns]:
    rng = np.random.default_rng(SEED)
    states, inputs = _anywhere(block, rng, n)
    bounds = {a.name: (a.reference.low + INSIDE, a.reference.high - INSIDE) for a in control.AXES}
    pose = {name: rng.uniform(*ends, n) for name, ends in bounds.items()}
    r = reference.Parameters().r
    tilt, roll = r * np.sin(pose["phi"]), r * np.sin(pose["theta"])
    inputs |= {"y1": pose["y"] - tilt, "y3": pose["y"] + tilt, "y2": pose["y"] + roll, "y4": pose["y"] - roll}
    inputs |= {"x": pose["x"], "z": pose["z"]}
    for a in control.AXES:
        error = rng.uniform(-1, 1, n) * 10.0 ** rng.uniform(-6, -3.3, n)
        inputs[f"{a.name}_ref"] = np.clip(pose[a.name] - error, *bounds[a.name])
        states[f"filter_{a.name}_q_prev"] = error + rng.normal(0, 1e-6, n)
        states[f"filter_{a.name}_s"] = rng.normal(0, 5e-6, n)
        states[f"filter_{a.name}_r"] = rng.normal(0, 1e-5, n)
        for name, bound in zip(reference.ETA, a.eta_bounds, strict=True):
            states[f"regulator_{a.name}_{name}"] = rng.normal(0, NEAR * bound, n)
    states |= {"guard_ready": (rng.uniform(size=n) < 0.98).astype(float), "guard_latched": np.zeros(n)}
    for s in control.CURRENTS:
        held = holding(inputs[f"y{s.name[-1]}"]) if s.name.startswith("i_d") else 0.0
        last = held + rng.uniform(-0.5, 0.5, n)
        states[f"safe_output_last_{s.name}"] = np.clip(last, s.low + INSIDE, s.high - INSIDE)
    return states, inputs


def holding(gap: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the direct current in A with which a motor at a gap in m carries a quarter of the platen, F(2)."""
    p = reference.Parameters()
    m = reference.motor(gap, p)
    missing = m.a - p.M_y * p.G / 4
    return 2 * missing / (m.b + np.sqrt(m.b**2 - 4 * m.c * missing))


def edge_steps(block: Block, n: int) -> tuple[Columns, Columns]:
    """Draw n independent (states, inputs) anywhere in the declared bounds, with inputs on ends and on no numbers."""
    rng = np.random.default_rng(SEED + 1)
    states, inputs = _anywhere(block, rng, n)
    for s in block.inputs:
        ends = (s.low, s.high, np.nextafter(s.low, -1), np.nextafter(s.high, 1), *SPECIAL)
        chosen = rng.integers(0, 4 * len(ends), n)
        inputs[s.name] = np.where(chosen < len(ends), np.take(ends, chosen % len(ends)), inputs[s.name])
    return states, inputs


def _anywhere(block: Block, rng: np.random.Generator, n: int) -> tuple[Columns, Columns]:
    states = {}
    for s in block.states:
        low, high = s.signal.low, s.signal.high
        whole = rng.integers(int(low), int(high) + 1, n).astype(float) if s.integer else rng.uniform(low, high, n)
        states[s.name] = whole
    return states, {s.name: rng.uniform(s.low, s.high, n) for s in block.inputs}


def saturated(outputs: agree.Columns) -> NDArray[np.bool_]:
    """Tell for each sample whether some motor stands at its limit."""
    motors = [np.hypot(outputs[f"i_d{j}"], outputs[f"i_q{j}"]) for j in range(1, 5)]
    return np.max(motors, axis=0) > control.DIRECT * (1 - 1e-9)


def verify(plant: Plant, told: Callable[[str], None], replay_s: float = 60.0) -> Evidence:
    """Compare all witnesses; `replay_s` is how much of the recorded closed loop the reference replays, in s."""
    block = control.controller(plant)
    c64, c32 = compiled(plant, np.float64), compiled(plant, np.float32)
    witnesses = {
        "reference": agree.reference(reference.step),
        "casadi": agree.casadi(block),
        "casadi_c": agree.casadi_own_c(block),
        "c64": agree.emitted(c64),
    }
    agreements: list[agree.Agreement] = []
    checks: list[Check] = []
    for what, (states, inputs), floor in (
        ("random", random_steps(block, RANDOM_STEPS), FLOOR),
        ("edge", edge_steps(block, EDGE_STEPS), EDGE_FLOOR),
    ):
        told(f"{what} steps")
        found = {name: witness(states, inputs) for name, witness in witnesses.items()}
        compared = [
            agree.compare(f"{what} steps", (name, found[name]), ("c64", found["c64"]), floor, block)
            for name in ("reference", "casadi", "casadi_c")
        ]
        agreements += compared
        checks += _exact(compared, floor)
        if what == "random":
            share = float(np.mean(saturated(found["c64"].outputs)))
            checks.append(Check("share of random steps at a limit", share, 0.5, "1"))
            agreements.append(_single(block, c32, c64, states, inputs))
    told("replays of closed loops")
    agreements += (compared := replays(Loop(plant, c64), block, replay_s))
    checks += _exact(compared, FLOOR)
    told("single against double over 60 s")
    checks += single_against_double(plant, c32, c64)
    return Evidence(control.NAME, tuple(agreements), tuple(checks))


def _exact(compared: list[agree.Agreement], floor: float) -> list[Check]:
    checks, unit = [], f"max({floor:.3g} A, |i|)"
    for a in compared:
        about = f"worst of {a.samples} steps, {a.signal}"
        checks.append(Check(f"{a.what}: {a.first} against {a.second}", a.worst, EXACT, unit, about))
        checks.append(
            Check(f"{a.what}: next states of {a.first} and {a.second}", a.state_worst, EXACT, "of range", a.state)
        )
        checks.append(Check(f"{a.what}: fault words of {a.first} and {a.second} unlike", a.faults_differ, 0, "1"))
    return checks


def _single(
    block: Block, c32: host.Controller, c64: host.Controller, states: Columns, inputs: Columns
) -> agree.Agreement:
    """Compare single with double on the same bits: what is drawn is rounded to single first."""
    x, u = ({n: v.astype(np.float32) for n, v in columns.items()} for columns in (states, inputs))
    double = agree.emitted(c64)(x, u)
    single = agree.emitted(c32)(x, u)
    return agree.compare("random steps", ("c64", double), ("c32", single), FLOOR, block, np.float32)


def replays(loop: Loop, block: Block, replay_s: float) -> list[agree.Agreement]:
    """Replay recorded inputs from `init`: the 4-DOF tracking with encoders, a saturated step, faults to the latch."""
    tracking, _ = experiments.tracking(loop, True, replay_s)
    saturated = experiments.step(loop, "x", -0.05, 0.05, gap=0.030, after=2.0).trajectory
    faulty = loop.run(2.0, {"y": 0.025}, {}, overrides=_bad_samples())
    runs = {f"replay of {replay_s:g} s": tracking, "replay of a saturated step": saturated, "replay of faults": faulty}
    return [a for what, run in runs.items() for a in _replayed(what, loop, block, run)]


def _bad_samples() -> dict[str, Override]:
    """Single bad samples of y2 and a set-point, four in a row of x, and in the end z for ever, which latches."""
    time = sample_times(2.0, control.TIME.period_s)
    masks = {"y2": time % 0.25 < 1e-9, "x_ref": time % 0.3 < 1e-9, "x": (time > 0.8) & (time < 0.8045), "z": time > 1.5}
    return {name: Override(mask, np.full(len(time), np.nan)) for name, mask in masks.items()}


def _replayed(what: str, loop: Loop, block: Block, run: Trajectory) -> list[agree.Agreement]:
    inputs = run.measured
    c64 = ("c64", agree.replayed(loop.controller, inputs))
    start = {s.name: s.initial for s in block.states}
    witnesses = {
        "reference": agree.reference(reference.step),
        "casadi": agree.casadi(block),
        "casadi_c": agree.casadi_own_c(block),
    }
    return [
        agree.compare(what, (name, agree.recorded(witness, start, inputs)), c64, FLOOR, block)
        for name, witness in witnesses.items()
    ]


def single_against_double(plant: Plant, c32: host.Controller, c64: host.Controller) -> list[Check]:
    """Compare 60 s of 4-DOF tracking in both types: point by point with ideal sensing, by mean errors with encoders."""
    checks = []
    ideal = [_tracked(plant, c, 0.0) for c in (c32, c64)]
    for axis, limit in POINTWISE.items():
        worst = float(np.max(np.abs(ideal[0][0][axis] - ideal[1][0][axis])))
        checks.append(Check(f"single less double, {axis}", worst, limit, _unit(axis), "60 s, ideal sensing"))
    means = [experiments.mean_errors(*_tracked(plant, c)) for c in (c32, c64)]
    for axis, limit in MEANS.items():
        gap = abs(means[0][axis] - means[1][axis])
        checks.append(Check(f"mean error, single less double, {axis}", gap, limit, _unit(axis), "60 s, encoders"))
    return checks


def _tracked(
    plant: Plant, controller: host.Controller, resolution: float | None = None
) -> tuple[Trajectory, dict[str, NDArray[np.float64]]]:
    loop = Loop(plant, controller)
    return experiments.tracking(loop if resolution is None else replace(loop, resolution=resolution), True)


def _unit(axis: str) -> str:
    return "rad" if axis in ("phi", "theta") else "m"
