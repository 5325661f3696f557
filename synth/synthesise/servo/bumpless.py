"""Bumpless start: the internal model's state for which a servo regulator takes over without a jump.

    K_x x + K_xi xi = u,     xi of least norm

for the state x, or its estimate, and what the actuators do, u. It can be solved for every u when K_xi has full row
rank: not with more actuators than the internal model has states, nor with actuators of which some act alike.

Library: no design uses it yet; docs/library.md has an example.
"""

import numpy as np
from numpy.typing import ArrayLike

from synth import arguments
from synth.errors import ModelError, SignalError
from synth.statespace import Array, readonly
from synth.synthesise.servo.servo import Servo

BUMP = 1e-12  # of the terms of a command: a difference above it is no rounding error


@arguments.checked
def start(regulator: Servo, state: ArrayLike, present: ArrayLike) -> Array:
    """Return the least xi (p k,) for which the first command equals the actuators' `present` values (m,).

    `state` (n,) is the plant's, or its estimate.

    Raises SignalError for sizes that do not fit, ModelError naming the controls that no xi keeps from a jump.
    """
    plant, controls, K_xi = regulator.plant, regulator.controls, regulator.K_xi
    x, u = arguments.real("states", state).ravel(), arguments.real("present inputs", present).ravel()
    if (len(x), len(u)) != (len(plant.A), len(controls)) or not np.isfinite([*x, *u]).all():
        raise SignalError(
            f"a bumpless start from {len(x)} states and {len(u)} present inputs: give {len(plant.A)} finite states "
            f"({', '.join(plant.states)}) and {len(controls)} inputs ({', '.join(controls)})"
        )
    wanted = u - regulator.K_x @ x
    xi = np.linalg.lstsq(K_xi, wanted, rcond=None)[0]
    xi = xi + np.linalg.lstsq(K_xi, wanted - K_xi @ xi, rcond=None)[0]
    jump = K_xi @ xi - wanted
    bumps = np.abs(jump) > BUMP * (np.abs(u) + np.abs(regulator.K_x) @ np.abs(x) + np.abs(K_xi) @ np.abs(xi))
    if bumps.any():
        named = ", ".join(f"{controls[k]} by {jump[k]:.3g}" for k in np.flatnonzero(bumps))
        raise ModelError(
            f"no state of the internal model makes the first command the present one: {named} would jump, for K_xi has "
            f"rank {np.linalg.matrix_rank(K_xi)} with {len(u)} controls; let these actuators start from values that "
            "the others allow, or regulate as many outputs"
        )
    return readonly(xi)
