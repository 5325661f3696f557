"""The lead-lag controller of the planar positioner, one step of 1 ms: NumPy reference of the generated C.

    sensing and filters: `reference_sensing`
    guard, six compensators (21)-(25), prediction, braking, motors and phases: `reference_control`

Every function takes scalars or columns (n,) of n independent controllers. Lengths in m, angles in rad, currents in A.
"""

from collections.abc import Mapping
from fractions import Fraction
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from designs.planar_6dof import reference_control as shared
from designs.planar_6dof import reference_sensing as sensing
from designs.planar_6dof.reference_control import AXES
from synth.reference import dead_reckoning, guard, lead_lag

Array = NDArray[Any]
Columns = Mapping[str, Array]

PERIOD = Fraction(1, 1000)  # s
GAIN = {"x": "15000", "y": "15000", "phi": "35"}  # (21), (22)
GAIN_SHARE = {"x": "0.4", "y": "0.4", "phi": "0.5"}  # factor on it in the shipped controller
LEAD = {"x": "0.11", "y": "0.11", "phi": "0.12"}  # s
BANDWIDTH = {"x": 48.0, "y": 48.0, "phi": 8.0, "force": 16.0}  # rad/s, of the prediction
LAG, RESET = Fraction("0.00088"), Fraction("0.1")  # s


@cache
def compensators() -> dict[str, lead_lag.Compensator]:
    """Return the six compensators. (21)-(25)."""
    sampled = {}
    for axis in GAIN:
        lead = Fraction(LEAD[axis])
        gain = Fraction(GAIN_SHARE[axis]) * Fraction(GAIN[axis]) * lead * RESET / LAG
        sampled[axis] = lead_lag.tustin(gain, (1 / lead, 1 / RESET), 1 / LAG, PERIOD)
    return sampled | {axis: shared.vertical(axis, PERIOD) for axis in shared.VERTICAL}


def initial_state() -> dict[str, Array]:
    """Return the state after init, by name."""
    filters = sensing.initial_filter_state() | {f"delay_{axis}": np.array(0.0) for axis in GAIN}
    return shared.initial_state(AXES) | sensing.initial_state_with_innovation() | filters


def sense(state: Columns, v: Columns, complete: Array) -> tuple[dict[str, Array], dict[str, Array]]:
    """Return the pose with raw and filtered positions, and the next states of sensing and filters."""
    k, ready, predicted = (
        sensing.constants(float(PERIOD)),
        np.asarray(state["guard_ready"]),
        dead_reckoning.predicted_pose(state, GAIN),
    )
    raw, after = sensing.sense(state, v, (ready, complete), predicted, k, True)
    filtered, after_filters = sensing.filter_positions(state, raw, ready, k)
    return raw | filtered | shared.vertical_kinematics(v), after | after_filters


def sample(state: Columns, pose: Columns) -> dead_reckoning.Sample:
    """Return what a sample tells about the motion; the demands achieved in the sample before act until the next one."""
    measured = {axis: pose[f"{axis}_raw"] for axis in GAIN}
    acting = {axis: state[f"delay_{axis}"] for axis in GAIN}
    return shared.sample(state, measured, pose["measured"], acting, float(PERIOD), BANDWIDTH)


def step(state: Columns, inputs: Columns) -> tuple[dict[str, Array], dict[str, Array], Array]:
    """Return (next state, phase currents, fault word) of one sample, columns by name."""
    guarded = shared.guard_inputs(state, inputs)
    values, after, word = guarded.values, guarded.after, guarded.word
    pose, after_sensing = sense(state, values, guarded.complete)
    now = sample(state, pose)
    after |= after_sensing | dead_reckoning.next_state(state, now)
    e = {axis: values[f"{axis}_ref"] - pose[axis] for axis in AXES}
    k = compensators()
    demand = {axis: shared.demand(axis, k[axis], e[axis], state) for axis in AXES}
    demand = guard.begun(state, demand, guarded.complete)
    demand |= shared.brake({axis: demand[axis] for axis in GAIN}, state, now, guarded.braked)
    currents, achieved = shared.allocate(demand, pose["phi"])
    for axis in AXES:
        after |= shared.next_compensator_state(axis, k[axis], e[axis], achieved[axis], state)
    after |= {f"delay_{axis}": achieved[axis] / shared.scales()[axis] for axis in GAIN}
    next_state, out = shared.finish_step(state, after, shared.phases(currents, pose), PERIOD)
    return next_state, out, word
