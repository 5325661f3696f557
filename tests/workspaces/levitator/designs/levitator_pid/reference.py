"""The levitator's two PID laws in NumPy: guard, errors, laws, limits, safe output; the independent witness."""

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[Any]
Columns = Mapping[str, Array]

T = 1 / 2000
RANGES = {"z": (-6e-4, 6e-4), "x": (-1e-3, 1e-3), "z_ref": (-5e-4, 5e-4), "x_ref": (-8e-4, 8e-4)}
AXES = {"z": ("i1", 3.0, 1800.0, 3.4e4, 18.0), "x": ("i2", 2.0, 1450.0, 3e4, 10.0)}
FADE, SLEW, BAD = 0.4, 100.0, 4


def guard(x: Columns, u: Columns) -> tuple[dict[str, Array], dict[str, Array], Array]:
    """Return held inputs, the guard's next states, and the fault word."""
    good = {n: (u[n] >= low) & (u[n] <= high) for n, (low, high) in RANGES.items()}
    held = {n: np.where(good[n], u[n], x[f"guard_last_{n}"]) for n in RANGES}
    complete = good["z"] & good["x"]
    left, latched = x["guard_left"], np.asarray(x["guard_latched"]) > 0
    latches = latched | (~complete & (left <= 1))
    after = {f"guard_last_{n}": held[n] for n in RANGES}
    after["guard_left"] = np.where(complete, BAD, np.where(left <= 1, left, left - 1))
    after |= {"guard_latched": latches.astype(float), "guard_ready": np.where(complete, 1.0, x["guard_ready"])}
    word = sum((~good[n]).astype(np.uint32) << i for i, n in enumerate(RANGES))
    return held, after, word | (latches.astype(np.uint32) << 31)


def step(x: Columns, u: Columns) -> tuple[dict[str, Array], dict[str, Array], Array]:
    """Return (next states, outputs, fault words) of one sample, columns by name."""
    held, after, word = guard(x, u)
    latched, out = after["guard_latched"] > 0, {}
    for axis, (current, limit, p, i, d) in AXES.items():
        low = RANGES[f"{axis}_ref"][0] - RANGES[axis][1]
        e = held[f"{axis}_ref"] - held[axis]
        v = FADE * x[f"pid_{axis}_v"] + (1 - FADE) / T * (e - x[f"pid_{axis}_last"]) * x["guard_ready"]
        demand = p * e + x[f"pid_{axis}_integral"] + d * v
        computed = np.clip(demand, -limit, limit)
        integral = x[f"pid_{axis}_integral"] + i * T * e + 0.05 * (computed - demand)
        width = -2 * low / T
        new = {"integral": np.clip(integral, -2 * limit, 2 * limit), "v": np.clip(v, -width, width), "last": e}
        after |= {f"pid_{axis}_{n}": np.where(latched, x[f"pid_{axis}_{n}"], value) for n, value in new.items()}
        last = x[f"safe_output_last_{current}"]
        out[current] = np.where(latched, np.clip(0.0, last - SLEW * T, last + SLEW * T), computed)
        after[f"safe_output_last_{current}"] = out[current]
    return after, out, word
