"""The levitator's two PID laws in NumPy: guard, errors, laws, limits, safe output; the independent witness."""

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from synth.reference import guard

Array = NDArray[Any]
Columns = Mapping[str, Array]

T = 1 / 2000
RANGES = {"z": (-6e-4, 6e-4), "x": (-1e-3, 1e-3), "z_ref": (-5e-4, 5e-4), "x_ref": (-8e-4, 8e-4)}
AXES = {"z": ("i1", 3.0, 1800.0, 3.4e4, 18.0), "x": ("i2", 2.0, 1450.0, 3e4, 10.0)}
VELOCITY_POLE, SLEW, BAD = 0.4, 100.0, 4


def step(x: Columns, u: Columns) -> tuple[dict[str, Array], dict[str, Array], Array]:
    """Return (next states, outputs, fault words) of one sample, columns by name."""
    held, after, word = guard.standard(x, u, RANGES, "zx", BAD)
    latched, computed, law = after["guard_latched"] > 0, {}, {}
    for axis, (current, limit, p, i, d) in AXES.items():
        low = RANGES[f"{axis}_ref"][0] - RANGES[axis][1]
        e = held[f"{axis}_ref"] - held[axis]
        v = (
            VELOCITY_POLE * x[f"pid_{axis}_v"]
            + (1 - VELOCITY_POLE) / T * (e - x[f"pid_{axis}_e_previous"]) * x["guard_ready"]
        )
        demand = p * e + x[f"pid_{axis}_integral"] + d * v
        computed[current] = np.clip(demand, -limit, limit)
        integral = x[f"pid_{axis}_integral"] + i * T * e + 0.05 * (computed[current] - demand)
        width = -2 * low / T
        new = {"integral": np.clip(integral, -2 * limit, 2 * limit), "v": np.clip(v, -width, width), "e_previous": e}
        law |= {f"pid_{axis}_{n}": value for n, value in new.items()}
    out, last = guard.slew(x, computed, latched, SLEW * T)
    return after | guard.frozen(x, law, latched) | last, out, word
