"""What drives the verification of the emitted C: random steps in operation over the whole range of poses.

Most random steps do not saturate the motors, because a limit hides differences. Edge steps have states anywhere in
their bounds. Recorded inputs of closed loops are replayed from `init`, and 60 s of tracking in single precision are
compared with double. The states of a law are drawn by a function of its design, for each axis from its position and
its tracking error.
"""

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from designs.maglev import motions, platen, reference_faults, reference_stage
from synth.block import Block
from synth.check import Check
from synth.declare.companion import Reference
from synth.fault import LATCH_BIT
from synth.simulate.rig import Rig
from synth.simulate.scenario import Override, Trajectory, sample_times
from synth.verify import agree, sampling
from synth.verify.sampling import Columns
from synth.verify.standard import Stimuli

QUICK_REPLAY, WHOLE_REPLAY = 5.0, 60.0  # s of a closed loop that the reference replays
SEED = 20_090_901
CORNER = 0.98  # of the limit of i_d: there the limit sqrt(C^2 - i_d^2) of i_q has the slope -5, closer to it up to -70
RARE = 0.01  # share of excluded encoders, of unanswered probes and of landings
INSIDE = 1e-8  # m, rad: distance from the ends of a range, which differ between single and double precision
# A: edge steps demand up to 1e3 A of a motor, which is limited. Where such demands cancel, the error of the
# polynomials, up to 1e-14 of each term, stays: 1e-11 A, which is the tolerance of 1e-12 relative to this floor.
EDGE_FLOOR = 10.0
POINTWISE = {"y": 1e-7, "x": 1e-7, "z": 1e-7, "phi": 5e-7, "theta": 5e-7}  # m, rad: single and double, ideal sensing
LawStates = Callable[[np.random.Generator, str, NDArray[np.float64], NDArray[np.float64]], Columns]
MEANS = {"y": 1e-7, "x": 1e-7, "z": 1e-7, "phi": 2e-7, "theta": 2e-7}  # m, rad: mean errors, with encoders
STEPS = 1000  # of the test vectors
BAD, BAD_SET_POINT = slice(700, 703), slice(800, 810)  # samples with the x encoder or y_ref out of range


def stimuli(law_states: LawStates, reference: Reference) -> Stimuli:
    """Return what drives the verification; `law_states` draws states of the law."""
    return Stimuli(
        seed=SEED,
        random=lambda block, n: random_steps(block, reference, law_states, n),
        random_checks=share_checks,
        runs=replays,
        path_checks=single_against_double,
        vectors=vectors,
        floor=platen.CURRENT_FLOOR,
        edge_floor=EDGE_FLOOR,
        unit="A",
    )


def share_checks(states: Columns, results: agree.StepResults) -> list[Check]:
    """Return the check that limits hide few differences of the random steps."""
    return [Check("share of random steps at a limit", float(np.mean(is_saturated(results.outputs))), 0.5, "1")]


def random_steps(block: Block, reference: Reference, law_states: LawStates, n: int) -> tuple[Columns, Columns]:
    """Draw n independent (states, inputs) over the domain; the platen is near its set-points, and few motors saturate.

    A step that latches is left to the edge steps.

    The last currents are those that hold a level platen at each motor's gap, within half an ampere. Steps with a direct
    current close below its limit, where the limit of i_q falls steeply, are left to the edge steps.
    """
    states, inputs = _in_operation(block, law_states, n + n // 4)
    _, outputs, faults = reference(states, inputs)
    size = np.abs([outputs[f"i_d{j}"] for j in platen.MOTORS])
    near_limit = np.any((size > CORNER * platen.DIRECT) & (size < platen.DIRECT), axis=0)
    chosen = np.flatnonzero(~near_limit & (faults >> LATCH_BIT == 0))[:n]
    return {s: v[chosen] for s, v in states.items()}, {s: v[chosen] for s, v in inputs.items()}


def _in_operation(block: Block, law_states: LawStates, n: int) -> tuple[Columns, Columns]:
    rng = np.random.default_rng(SEED)
    states, inputs = sampling.anywhere(block, rng, n)
    bounds = {a.name: (a.reference.low + INSIDE, a.reference.high - INSIDE) for a in platen.AXES}
    pose = {name: rng.uniform(*ends, n) for name, ends in bounds.items()}
    r = reference_stage.Parameters().r
    tilt, roll = r * np.sin(pose["phi"]), r * np.sin(pose["theta"])
    inputs |= {"y1": pose["y"] - tilt, "y3": pose["y"] + tilt, "y2": pose["y"] + roll, "y4": pose["y"] - roll}
    inputs |= {"x": pose["x"], "z": pose["z"]}
    for name in bounds:
        error = rng.uniform(-1, 1, n) * 10.0 ** rng.uniform(-6, -3.3, n)
        asked = platen.INTERFACE.signals[f"{name}_ref"]
        inputs[f"{name}_ref"] = np.clip(pose[name] - error, asked.low + INSIDE, asked.high - INSIDE)
        states |= law_states(rng, name, pose[name], error)
    states |= {"guard_ready": (rng.uniform(size=n) < 0.98).astype(float), "guard_latched": np.zeros(n)}
    states |= _fault_handling(rng, n, inputs, {s.signal.name: round(s.signal.high) for s in block.states if s.integer})
    inputs["missed_calls"] = np.where(rng.uniform(size=n) < 0.5, inputs["missed_calls"], 0.0)
    for name in ("y1", "x", "z"):
        inputs[name] = inputs[name] + np.where(rng.uniform(size=n) < RARE, rng.uniform(-1e-3, 1e-3, n), 0.0)
    for s in platen.CURRENTS:
        held = holding_current(inputs[f"y{s.name[-1]}"]) if s.name.startswith("i_d") else 0.0
        last = held + rng.uniform(-0.5, 0.5, n)
        states[f"safe_output_last_{s.name}"] = np.clip(last, s.low + INSIDE, s.high - INSIDE)
    return states, inputs


def _fault_handling(rng: np.random.Generator, n: int, inputs: Columns, most: Mapping[str, int]) -> Columns:
    """Return states of the fault handling near the readings: few encoders are excluded, few platens land."""
    states: Columns = {}
    readings: Any = np.array([inputs[name] for name in reference_faults.NAMES])
    for s, q in zip(reference_stage.AXES, reference_stage.pose(readings, reference_stage.Parameters().r), strict=True):
        states[f"observer_{s}_q"] = q + rng.normal(0, 1e-5, n)
        states[f"observer_{s}_v"], states[f"observer_{s}_d"] = rng.normal(0, 0.02, n), rng.normal(0, 0.5, n)
        states[f"delay_{reference_faults.DEMANDS[s]}_last"] = rng.normal(0, 0.5, n)
    codes, excluded = (reference_faults.SENSING.states(of) for of in ("code", "excluded"))
    for code, out, y in zip(codes, excluded, readings, strict=True):
        states[code] = np.where(rng.uniform(size=n) < 0.5, y, _neighbours(rng, y))
        states[out] = (rng.uniform(size=n) < RARE).astype(float)
    for name in "xz":
        states[f"{name}_monitor_doubts"] = np.where(rng.uniform(size=n) < RARE, rng.integers(0, 11, n), 0)
        states[f"{name}_monitor_before"] = states[f"observer_{name}_q"] + rng.normal(0, 5e-6, n)
        states[f"probe_{name}_sample"] = np.where(
            rng.uniform(size=n) < 0.5, 0, rng.integers(0, most[f"probe_{name}_sample"] + 1, n)
        )
        attempts = most[f"probe_{name}_attempt"]
        states[f"probe_{name}_attempt"] = np.where(rng.uniform(size=n) < RARE, attempts, rng.integers(0, attempts, n))
    states["redundancy_degraded"] = (rng.uniform(size=n) < RARE).astype(float)
    for flag in ("undecided", "stuck"):
        states[f"redundancy_{flag}_0"] = (rng.uniform(size=n) < RARE).astype(float)
    states["handover_transfer"] = np.where(rng.uniform(size=n) < RARE, rng.uniform(-1, 1, n), 0.0)
    states["landing_landing"] = (rng.uniform(size=n) < RARE).astype(float)
    for s in ("y", "x", "z"):
        states[f"landing_r_{s}"] = states[f"observer_{s}_q"] + rng.normal(0, 1e-4, n)
        states[f"landing_dr_{s}"] = rng.uniform(-0.05, 0.05, n)
    states["landing_r_y"] = np.minimum(states["landing_r_y"], platen.GAP[1])
    return states


def _neighbours(rng: np.random.Generator, y: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return readings one count from y."""
    return np.asarray(y + np.where(rng.uniform(size=len(y)) < 0.5, -1e-5, 1e-5))


def holding_current(gap: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the direct current in A with which a motor at a gap in m carries a quarter of the platen, F(2)."""
    p = reference_stage.Parameters()
    m = reference_stage.motor(gap, p)
    load = m.a - p.M_y * p.G / 4
    return 2 * load / (m.b + np.sqrt(m.b**2 - 4 * m.c * load))


def is_saturated(outputs: agree.Columns) -> NDArray[np.bool_]:
    """Return for each sample whether a motor is at its limit."""
    motors = [np.hypot(outputs[f"i_d{j}"], outputs[f"i_q{j}"]) for j in platen.MOTORS]
    return np.max(motors, axis=0) > platen.DIRECT * (1 - 1e-9)


def replays(rig: Rig, whole: bool) -> dict[str, Trajectory]:
    """Record the 4-DOF tracking with encoders, a saturated step, and faults up to the latch.

    Single samples of y2 and x_ref are bad, then four in a row of x, and finally z permanently, which latches.
    """
    time, replay_s = sample_times(2.0, rig.period_s), WHOLE_REPLAY if whole else QUICK_REPLAY
    masks = {"y2": time % 0.25 < 1e-9, "x_ref": time % 0.3 < 1e-9, "x": (time > 0.8) & (time < 0.8045), "z": time > 1.5}
    bad = {name: Override(mask, np.full(len(time), np.nan)) for name, mask in masks.items()}
    return {
        f"replay of {replay_s:g} s": motions.tracking(rig, True, replay_s)[0],
        "replay of a saturated step": motions.step(rig, "x", -0.0499, 0.0499, gap=0.030, after=2.0).trajectory,
        "replay of faults": rig.run(2.0, overrides=bad),
    }


def single_against_double(double: Rig, single: Rig) -> list[Check]:
    """Compare 60 s of 4-DOF tracking in both types: point by point with ideal sensing, by mean errors with encoders."""
    checks, units = [], motions.UNITS
    one, two = (motions.tracking(rig.ideal, True)[0] for rig in (single, double))
    for axis, limit in POINTWISE.items():
        worst = float(np.max(np.abs(one[axis] - two[axis])))
        checks.append(Check(f"single less double, {axis}", worst, limit, units[axis], "60 s, ideal sensing"))
    means = [motions.mean_errors(*motions.tracking(rig, True)) for rig in (single, double)]
    for axis, limit in MEANS.items():
        gap = abs(means[0][axis] - means[1][axis])
        checks.append(Check(f"mean error, single less double, {axis}", gap, limit, units[axis], "60 s, encoders"))
    return checks


def vectors(rig: Rig) -> Mapping[str, Any]:
    """Return a lift-off from the stop with moves in x, z and theta, three bad encoder samples and a bad set-point."""
    time = sample_times(STEPS * rig.period_s, rig.period_s)
    wave = np.sin(platen.OMEGA0 * time)
    references = {"y_ref": platen.AXES[0].reference.high - 0.006 * time, "x_ref": 0.005 * wave, "z_ref": -0.005 * wave}
    references["theta_ref"] = 0.001 * wave
    references["y_ref"][BAD_SET_POINT] = 0.05
    bad = Override(np.isin(np.arange(STEPS), np.r_[BAD]), np.full(STEPS, 0.2))
    return rig.run(time[-1] + rig.period_s, {"y": 0.031}, references, overrides={"x": bad}).measured
