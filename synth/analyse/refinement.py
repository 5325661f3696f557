"""Adaptive refinement of a frequency grid until a response changes little from point to point."""

from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike

from synth.statespace import Array, Complex

Response = Callable[[ArrayLike], Complex]
NARROW = 1e-9  # of a frequency: least spacing of nodes; closer to an undamped pole L is rounding error


def refine(L: Response, w: Array, value: Complex) -> tuple[Array, Complex]:
    """Return frequencies (k,) and L there, such that log L and log(1 + L) change little between neighbours.

    They include w, at which L is `value`.
    """
    for _ in range(40):
        wide = (_step(value) > 0.15) | (_step(1 + value) > 0.15)
        wide &= np.diff(w) > 4 * NARROW * w[1:]
        if not wide.any():
            break
        between = np.sqrt(w[:-1] * w[1:])[wide]
        order = np.argsort(np.concatenate([w, between]), kind="stable")
        value = np.concatenate([value, L(between)])[order]
        w = np.concatenate([w, between])[order]
    return w, value


def _step(value: Complex) -> Array:
    turn = np.diff(np.angle(value))
    return np.hypot(np.diff(log(value)), (turn + np.pi) % (2 * np.pi) - np.pi)


def log(value: Complex) -> Array:
    """Return log |value|, at least log 1e-300."""
    return np.log(np.maximum(np.abs(value), 1e-300))
