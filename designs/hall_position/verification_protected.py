"""Verification of the C of three and of four sensors against NumPy, CasADi, CasADi's own C, and single precision.

The steps are those of `stimuli`: from the states of the C in double precision along motions with faults, and from the
same states with the pose, its motion and the counters at random. Where a test or a level is within NEAR of its limit,
rounding decides: such steps are counted and left out. So are weak ones, where the C limits a pivot and the reference
does not; that both call them weak is compared. With a sensor excluded where a fault is not detectable, the C limits a
pivot of its rank update: such steps are not valid, and left out, too. Chi-square is a difference of costs of up to 0.3
V^2, of up to 3 V^2 with the worse conditioned three sensors. A level l grows as s^(-1/2) with the separability s of a
fault, in which rounding is absolute, and its relative error as l^2: of three sensors a level above its limit is
compared so.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from designs.hall_position import reference_protected
from designs.hall_position.glsdc import estimator
from designs.hall_position.protected import config, stimuli
from designs.hall_position.reference_glsdc import Setup
from synth.check import Check
from synth.simulate import sampling
from synth.verify import agree, suite
from synth.verify.agree import Agreement, StepResults
from synth.verify.sampling import Columns
from synth.verify.suite import Witnesses

FULL_BODIES, QUICK_BODIES = 120, 12
FLOOR = 1.0  # m, rad, V: differences of outputs are absolute below it
COST_FLOORS = {config.NAME: 0.3, config.THREE: 3.0}  # V^2, of the cost
THREE = config.TUNINGS[config.THREE]
# Above them a level is compared over the square of its excess.
LEVEL_LIMITS = {
    config.NAME: {},
    config.THREE: {"X": THREE.position_limit, "Y": THREE.position_limit, "yaw": THREE.yaw_limit},
}
DECISIONS = ("converged", "weak", "excluded", "doubted", "tracking", "lost", "valid")
MAX_NEAR = 0.005  # share of steps where rounding may decide
NEAR = 1e-7  # relative change of the voltages
SINGLE, SINGLE_YAW, SINGLE_LEVEL, OTHER_DECISIONS = 1e-7, 1e-5, 1e-3, 0.01  # m, rad, relative, share
PERTURBED = {"phase_x": 0.3, "phase_y": 0.3, "yaw": 0.05, "motion_phase_x": 0.1, "motion_phase_y": 0.1}  # rad
COUNTERS = (
    "start_number",
    "missed",
    "age",
    "candidates",
    "excluded",
    "competing",
    "plausible_1",
    "plausible_2",
    "plausible_3",
)


@dataclass(frozen=True, eq=False)
class Steps:
    """Steps: states and inputs (N,) by name."""

    what: str
    states: Columns
    inputs: Columns


def setup(name: str = config.NAME) -> Setup:
    """Return the numbers of the reference."""
    array = config.array(name)
    return Setup(vars(array) | vars(config.TUNINGS[name]) | {"wave_number": array.wave_number})


def witnesses(name: str = config.NAME) -> Witnesses:
    """Return the witnesses of an estimator."""
    step = partial(reference_protected.step, setup(name))
    return suite.witnesses(config.block(name=name), step, estimator.SURROGATE_ERROR)


def verify(progress: Callable[[str], None], whole: bool) -> tuple[list[Agreement], list[Check]]:
    """Compare all witnesses of each estimator over many bodies, or over few."""
    agreements: list[Agreement] = []
    checks: list[Check] = []
    for name in config.PLACES:
        progress(f"{name}: witnesses")
        some_agreements, some = compare(witnesses(name), FULL_BODIES if whole else QUICK_BODIES, progress)
        agreements += some_agreements
        checks += some
    return agreements, checks


def compare(of: Witnesses, bodies: int, progress: Callable[[str], None]) -> tuple[list[Agreement], list[Check]]:
    """Return the agreements and the checks of all witnesses."""
    agreements: list[Agreement] = []
    checks: list[Check] = []
    along = steps_along(of, bodies)
    for steps in (along, perturbed_steps(of, along)):
        progress(steps.what)
        clear = ~near_decision(of, steps)
        share = float(np.mean(~clear))
        first, second = (of.by_name[n](steps.states, steps.inputs).outputs for n in ("reference", "c64"))
        undetectable = [_is_undetectable(of.block.name, each) for each in (first, second)]
        disagreements = float(np.sum((undetectable[0] != undetectable[1]) & clear))
        checks.append(Check(f"{steps.what}: undetectable in one of reference against c64 only", disagreements, 0, "1"))
        clear &= ~undetectable[1]
        differs = float(np.sum((first["weak"] != second["weak"]) & clear))
        checks.append(Check(f"{steps.what}: weak in one of reference against c64 only", differs, 0, "1"))
        clear &= second["weak"] == 0
        checks.append(Check(f"{steps.what}: share where rounding may decide", share, MAX_NEAR, "1"))
        c64 = suite.select(of.by_name["c64"](steps.states, steps.inputs), clear)
        for name in suite.WITNESS_NAMES:
            stepped = suite.select(of.by_name[name](steps.states, steps.inputs), clear)
            pair = (name, _scaled(of, stepped, c64)), ("c64", _scaled(of, c64, c64))
            one = agree.compare(steps.what, *pair, FLOOR, of.block)
            agreements.append(one)
            checks += suite.exact_checks([one], f"max({FLOOR:g}, |y|)")
        checks += _single_checks(of, steps)
    return agreements, checks


def _scaled(of: Witnesses, stepped: StepResults, c64: StepResults) -> StepResults:
    """Return results, chi-square over its floor, levels over the squared excess of those of c64 over a limit."""
    scaled = {"chi_square": stepped.outputs["chi_square"] * _variance(of.block.name) / COST_FLOORS[of.block.name]}
    for axis, limit in LEVEL_LIMITS[of.block.name].items():
        excess = np.maximum(c64.outputs[f"protection_{axis}"] / limit, 1)
        scaled[f"protection_{axis}"] = stepped.outputs[f"protection_{axis}"] / excess**2
    return replace(stepped, outputs={**stepped.outputs, **scaled})


def _is_undetectable(name: str, outputs: Mapping[str, NDArray[Any]]) -> NDArray[np.bool_]:
    """Return whether a sensor is excluded where a fault of some sensor is not detectable: levels are at their ends."""
    end = reference_protected.LEVEL_RANGE * config.TUNINGS[name].yaw_limit
    return np.asarray((outputs["excluded"] > 0) & (outputs["protection_yaw"] >= (1 - NEAR) * end))


def _variance(name: str) -> float:
    return config.array(name).deviation ** 2 + config.TUNINGS[name].model_error ** 2


def steps_along(of: Witnesses, bodies: int) -> Steps:
    """Return the consecutive steps of the C in double precision from init."""
    inputs = stimuli.inputs(bodies, name=of.block.name)
    members, columns = sampling.consecutive_steps(of.c64, inputs)
    return Steps(f"{of.block.name}, motions", {s.name: members[s.name] for s in of.block.states}, columns)


def perturbed_steps(of: Witnesses, along: Steps) -> Steps:
    """Return the steps from perturbed poses and motions, with counters anywhere in their ranges."""
    rng, states = np.random.default_rng(0), {n: v.copy() for n, v in along.states.items()}
    bounds = {s.name: s.signal for s in of.block.states}
    for name, size in PERTURBED.items():
        full = f"estimator_{name}"
        shifted = states[full] + size * rng.uniform(-1, 1, len(states[full]))
        states[full] = np.clip(shifted, bounds[full].low, bounds[full].high)
    for name in COUNTERS:
        full = f"estimator_{name}"
        states[full] = rng.integers(0, int(bounds[full].high) + 1, len(states[full]))
    return Steps(f"{of.block.name}, perturbed steps", states, along.inputs)


def near_decision(of: Witnesses, steps: Steps) -> NDArray[np.bool_]:
    """Return whether a decision of the reference changes when its voltages change by NEAR."""
    rng = np.random.default_rng(1)
    nearby: dict[str, NDArray[np.float64]] = {}
    for n, v in steps.inputs.items():
        change = NEAR * rng.standard_normal(len(v))
        nearby[n] = np.where(v == steps.states[f"screen_last_{n}"], v, v * (1 + change))  # a repeated code stays one
    first, second = (of.by_name["reference"](steps.states, u) for u in (steps.inputs, nearby))
    differs = np.zeros(len(first.faults), bool)
    for name in DECISIONS:
        differs |= first.outputs[name] != second.outputs[name]
    for name in (f"estimator_{n}" for n in COUNTERS):
        differs |= first.states[name] != second.states[name]
    return differs


def _single_checks(of: Witnesses, steps: Steps) -> list[Check]:
    """Compare positions and levels where both precisions take the same decisions, and count the other steps."""
    double, single = suite.in_both_precisions(of, steps.states, steps.inputs)
    same = suite.same_decisions(of.block, double, single)
    for name in DECISIONS:
        same &= double.outputs[name] == single.outputs[name]
    valid = same & (double.outputs["valid"] > 0)
    checks = [Check(f"{steps.what}: decisions that differ in single precision", 1 - same.mean(), OTHER_DECISIONS, "1")]
    for name, limit, unit in (("X", SINGLE, "m"), ("Y", SINGLE, "m"), ("yaw", SINGLE_YAW, "rad")):
        gap = _gap(double, single, name)[valid].max(initial=0.0)
        checks.append(Check(f"{steps.what}: {name}, single less double, where valid", float(gap), limit, unit))
    for name in ("protection_X", "protection_Y", "protection_yaw"):
        gap = (_gap(double, single, name) / double.outputs[name])[valid].max(initial=0.0)
        checks.append(Check(f"{steps.what}: {name}, single less double", float(gap), SINGLE_LEVEL, "of itself"))
    return checks


def _gap(first: StepResults, second: StepResults, name: str) -> NDArray[np.float64]:
    return np.abs(second.outputs[name].astype(np.float64) - first.outputs[name])
