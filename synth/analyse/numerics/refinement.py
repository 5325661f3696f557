"""Adaptive refinement of a frequency grid: intervals are halved until the frequency response changes little in each.

    |log L(j w_k+1) - log L(j w_k)| <= MAX_STEP, and the same for 1 + L, with complex logarithms

An interval is halved at the geometric mean of its ends, but not below a relative width of 4 MIN_SPACING.
"""

from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike

from synth.statespace import Array, Complex

Response = Callable[[ArrayLike], Complex]
MIN_SPACING = 1e-9  # least relative spacing of frequencies; L nearer to an undamped pole is only rounding error
MAX_STEP = 0.15  # of log L and of log(1 + L) between neighbours
MAX_ROUNDS = 40  # of halving


def refine(L: Response, w: Array, value: Complex) -> tuple[Array, Complex]:
    """Return the refined frequencies (k,) and L at each; `value` is L at w, and all of w is kept."""
    for _ in range(MAX_ROUNDS):
        wide = (_log_step(value) > MAX_STEP) | (_log_step(1 + value) > MAX_STEP)
        wide &= np.diff(w) > 4 * MIN_SPACING * w[1:]
        if not wide.any():
            break
        midpoints = np.sqrt(w[:-1] * w[1:])[wide]
        order = np.argsort(np.concatenate([w, midpoints]), kind="stable")
        value = np.concatenate([value, L(midpoints)])[order]
        w = np.concatenate([w, midpoints])[order]
    return w, value


def _log_step(value: Complex) -> Array:
    """Return the magnitudes of the differences of the complex logarithm, with phase steps in -pi .. pi."""
    phase_step = np.diff(np.angle(value))
    return np.hypot(np.diff(log_magnitude(value)), (phase_step + np.pi) % (2 * np.pi) - np.pi)


def log_magnitude(value: Complex) -> Array:
    """Return the natural logarithm of |value|, at least that of 1e-300."""
    return np.log(np.maximum(np.abs(value), 1e-300))
