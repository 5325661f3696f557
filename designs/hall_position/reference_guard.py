"""Reference of the guarded estimator in plain NumPy: acceptance of voltages, hold, latch and fault word.

A voltage V is accepted if |V| <= 5, so NaN is refused. While it is refused, the last accepted one is held. The fifth
consecutive sample with a refused voltage sets the latch. N bodies advance one sample at a time.
"""

from string import ascii_lowercase

import numpy as np

from designs.hall_position import reference
from designs.hall_position.reference_glsdc import Array, Columns, Setup

PREFIX = "estimator_"
SPAN, BAD_SAMPLES, LATCH = 5.0, 5, np.uint32(1 << 31)


def channels(setup: Setup) -> list[str]:
    """Return the names of the voltages, sensor by sensor."""
    return [f"V_{letter}{axis}" for letter in ascii_lowercase[: len(setup.positions)] for axis in "xy"]


def hold_voltages(setup: Setup, states: Columns, inputs: Columns) -> tuple[Array, Array]:
    """Return the held voltages and which were refused, (N, sensors, 2) both."""
    now = np.stack([np.asarray(inputs[n], dtype=np.float64) for n in channels(setup)], axis=1)
    last = np.stack([np.asarray(states[f"guard_last_{n}"], dtype=np.float64) for n in channels(setup)], axis=1)
    with np.errstate(invalid="ignore"):
        refused = ~(np.abs(now) <= SPAN)
    shape = (len(now), len(setup.positions), 2)
    return np.where(refused, last, now).reshape(shape), refused.reshape(shape)


def estimator_states(states: Columns) -> dict[str, Array]:
    """Return the states of the estimator, without their prefix."""
    return {n.removeprefix(PREFIX): np.asarray(v, dtype=np.float64) for n, v in states.items() if n.startswith(PREFIX)}


def step(setup: Setup, states: Columns, inputs: Columns) -> tuple[dict[str, Array], dict[str, Array], Array]:
    """Return next states, outputs and fault words (N,), states by their names in the C."""
    held, refused = hold_voltages(setup, states, inputs)
    outputs, after = reference.step(setup, estimator_states(states), held, refused)
    next, word = advance(setup, states, held, refused)
    return next | {f"{PREFIX}{n}": v for n, v in after.items()}, outputs, word


def advance(setup: Setup, states: Columns, held: Array, refused: Array) -> tuple[dict[str, Array], Array]:
    """Return the next states of the guard, and the fault words (N,)."""
    flat, names = refused.reshape(len(refused), -1), channels(setup)
    bad, left = np.any(flat, axis=1), np.asarray(states["guard_left"], dtype=np.int64)
    latched = (np.asarray(states["guard_latched"]) > 0) | (bad & (left <= 1))
    next = {f"guard_last_{n}": v for n, v in zip(names, held.reshape(len(held), -1).T, strict=True)}
    next |= {"guard_left": np.where(bad, np.maximum(left - 1, 1), BAD_SAMPLES), "guard_latched": 1 * latched}
    next |= {"guard_ready": np.where(bad, states["guard_ready"], 1)}
    word = (flat * (1 << np.arange(len(names)))).sum(axis=1).astype(np.uint32) | np.where(latched, LATCH, 0)
    return next, word.astype(np.uint32)
