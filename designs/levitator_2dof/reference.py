"""The controller of the levitator in NumPy; of the toolkit it has only `synth.reference`.

Both axes are servos (`synth.reference.servo`). z commands the acceleration w = z'', x the current i2. With the field
f(z) = exp(z / l) at the position a sample ahead, M (w + g) = f (F0 + K i1) gives the current of z.
"""

from collections.abc import Mapping
from math import pi
from typing import Any

import numpy as np
from numpy.typing import NDArray

from synth.reference import guard, servo
from synth.reference.servo import Bounds, Servo

Array = NDArray[Any]
Columns = Mapping[str, Array]

T = 1 / 2000
MAINS, SCAN, WINDUP = 100 * pi, 20 * pi, 30.0
M, F0, K, ELL, G, MASS, COIL, DAMPING, SPRING = 1.5, 14.0, 20.0, 5e-3, 9.81, 0.3, 8.0, 1.0, 400.0
LIMITS = {"z": (-7e-4, 7e-4), "x": (-1.1e-3, 1.1e-3), "z_ref": (-5e-4, 5e-4), "x_ref": (-8e-4, 8e-4)}
STOPS = (-6e-4, 6e-4)  # m, of z: the field is known between them
CURRENTS = {"i1": 3.0, "i2": 2.0}
MADE = 51.0  # m/s^2, of z'': what the coil can make in the box of the stage
SLEW, BAD_SAMPLES = 100.0, 4
Z = Servo(
    "z", ((0, 1), (0, 0)), (0, 1), ((0.0, 25.0), (SCAN, 20.0)), (1e8, 1e3), 1e-2, 3e-5, 1e-14, 0.6, WINDUP, T,
    ("z_predicted", "vz_predicted", "w_z_late1_predicted"),
)  # fmt: skip
X = Servo(
    "x", ((0, 1), (-SPRING / MASS, -DAMPING / MASS)), (0, COIL / MASS), ((0.0, 25.0), (SCAN, 20.0), (MAINS, 20.0)),
    (1e8, 1e2), 1e1, 1e-4, 1e-14, 0.5, WINDUP, T, ("x_predicted", "vx_predicted", "i2_late1_predicted"),
)  # fmt: skip


def initial_state() -> dict[str, Array]:
    """Return the state after init, by name."""
    return guard.initial_state(LIMITS, CURRENTS, BAD_SAMPLES) | servo.initial_state([Z, X])


def step(state: Columns, inputs: Columns, bounds: Bounds) -> tuple[dict[str, Array], dict[str, Array], Array]:
    """Return (next state, outputs, fault word) of one sample, columns by name, with states in their bounds."""
    values, after, word = guard.standard(state, inputs, LIMITS, "zx", BAD_SAMPLES)
    z, x = (servo.command(axis, values[axis.name], values[f"{axis.name}_ref"], state, bounds) for axis in (Z, X))
    field = np.exp(np.clip(z.position, *STOPS) / ELL)
    demand = (M * (z.u + G) / field - F0) / K
    i1, i2 = np.clip(demand, -CURRENTS["i1"], CURRENTS["i1"]), np.clip(x.u, -CURRENTS["i2"], CURRENTS["i2"])
    made = np.clip(field * (F0 + K * i1) / M - G, -MADE, MADE)
    next_states = servo.next_state(Z, z, made, K * field / M * (i1 - demand), bounds)
    next_states |= servo.next_state(X, x, i2, i2 - x.u, bounds)
    latched = after["guard_latched"] > 0
    out, last = guard.slew(state, {"i1": i1, "i2": i2}, latched, SLEW * T)
    return after | guard.frozen(state, next_states, latched) | last, out, word
