"""The lead-lag controller of the planar positioner, one step of 1 ms: NumPy reference of the generated C.

    guard, sensing and filters, six compensators (21)-(25), motors and phases: `reference_sensing`, `reference_control`

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
from designs.planar_6dof.reference_control import AXES, Compensator

Array = NDArray[Any]
Columns = Mapping[str, Array]

PERIOD = Fraction(1, 1000)  # s
GAIN = {"x": "15000", "y": "15000", "phi": "35"}  # (21), (22)
GAIN_SHARE = {"x": "0.4", "y": "0.4", "phi": "0.5"}  # factor on it in the shipped controller
LEAD = {"x": "0.11", "y": "0.11", "phi": "0.12"}  # s
LAG, RESET = Fraction("0.00088"), Fraction("0.1")  # s


@cache
def compensators() -> dict[str, Compensator]:
    """Return the six compensators. (21)-(25)."""
    sampled = {}
    for axis in GAIN:
        lead = Fraction(LEAD[axis])
        gain = Fraction(GAIN_SHARE[axis]) * Fraction(GAIN[axis]) * lead * RESET / LAG
        sampled[axis] = shared.tustin(gain, (1 / lead, 1 / RESET), 1 / LAG, PERIOD)
    return sampled | {axis: shared.vertical(axis, PERIOD) for axis in shared.VERTICAL}


def initial_state() -> dict[str, Array]:
    """Return the state after init, by name."""
    return shared.initial_state(AXES) | sensing.initial_state() | sensing.initial_filter_state()


def step(state: Columns, inputs: Columns) -> tuple[dict[str, Array], dict[str, Array], Array]:
    """Return (next state, phase currents, fault word) of one sample, columns by name."""
    guarded = shared.guard(state, inputs)
    values, after, word = guarded.values, guarded.after, guarded.word
    flags = np.asarray(state["guard_ready"]), guarded.complete
    pose, after_sensing = sensing.step(state, values, flags, sensing.constants(float(PERIOD)))
    pose |= shared.vertical_kinematics(values)
    e = {axis: values[f"{axis}_ref"] - pose[axis] for axis in AXES}
    k = compensators()
    demand = {axis: shared.demand(axis, k[axis], e[axis], state) for axis in AXES}
    currents, achieved = shared.allocate(demand, pose["phi"])
    for axis in AXES:
        after |= shared.next_compensator_state(axis, k[axis], e[axis], achieved[axis], state)
    next_state, out = shared.finish_step(state, after | after_sensing, shared.phases(currents, pose), PERIOD)
    return next_state, out, word
