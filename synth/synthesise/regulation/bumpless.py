"""Bumpless transfer: the initial state of the internal model for which a servo regulator starts without a jump of u.

    K_x x + K_xi xi = u,     xi of least norm

for the state x, or its estimate, and the actuators' present values u. A solution exists for every u when K_xi has full
row rank. It has not if there are more actuators than states of the internal model, or if some actuators act alike.

Library: no design uses it yet; docs/library.md has an example.
"""

import numpy as np
from numpy.typing import ArrayLike

from synth import arguments
from synth.errors import ModelError, SignalError
from synth.statespace import Array, readonly
from synth.synthesise.regulation.servo import Servo

COMMAND_ROUNDING = 1e-12  # of the terms of a command: a larger difference is no rounding error


@arguments.checked
def start(regulator: Servo, state: ArrayLike, present: ArrayLike) -> Array:
    """Return the xi (p k,) of least norm for which the first command equals the actuators' `present` values (m,).

    `state` (n,) is the plant's, or its estimate.

    Raises SignalError for wrong sizes, ModelError naming the controls that jump for every xi.
    """
    plant, controls, K_xi = regulator.plant, regulator.controls, regulator.K_xi
    x, u = arguments.real("states", state).ravel(), arguments.real("present inputs", present).ravel()
    if (len(x), len(u)) != (len(plant.A), len(controls)) or not np.isfinite([*x, *u]).all():
        raise SignalError(
            f"a bumpless start from {len(x)} states and {len(u)} present inputs: give {len(plant.A)} finite states "
            f"({', '.join(plant.states)}) and {len(controls)} inputs ({', '.join(controls)})"
        )
    command = u - regulator.K_x @ x
    xi = np.linalg.lstsq(K_xi, command, rcond=None)[0]
    xi = xi + np.linalg.lstsq(K_xi, command - K_xi @ xi, rcond=None)[0]
    jump = K_xi @ xi - command
    terms = np.abs(u) + np.abs(regulator.K_x) @ np.abs(x) + np.abs(K_xi) @ np.abs(xi)
    # Least squares leaves a residual of the size of the largest command, also in a control that others do not touch.
    rounding = np.finfo(float).eps * (np.linalg.norm(command) + np.linalg.norm(K_xi) * np.linalg.norm(xi))
    bumps = np.abs(jump) > COMMAND_ROUNDING * terms + rounding
    if bumps.any():
        named = ", ".join(f"{controls[k]} by {jump[k]:.3g}" for k in np.flatnonzero(bumps))
        raise ModelError(
            f"no state of the internal model makes the first command the present one: {named} would jump, for K_xi has "
            f"rank {np.linalg.matrix_rank(K_xi)} with {len(u)} controls; let these actuators start from values that "
            "the others allow, or regulate as many outputs"
        )
    return readonly(xi)
