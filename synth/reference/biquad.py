"""Biquad in NumPy, its coefficients by mpmath from values of K(s): reference of `blocks.laws.biquad`.

With s = (z - 1) / (h (z + 1)), h = tan(w T / 2) / w at the frequency w of the zeros, else of the poles, and the poles
z = a +- j b, the sampled filter is

    K = gain + c_x (z - 1) (z - a) / P(z) + c_v b (z - 1) / P(z),        P(z) = (z - a)^2 + b^2

of which two values determine c_x and c_v. Real poles p, p_v have (z - p) (z - p_v) for P, p_v for a and 1 - p_v for b.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import mpmath  # type: ignore[import-untyped]
import numpy as np
from numpy.typing import NDArray

Array = NDArray[Any]
Columns = Mapping[str, Array]
DIGITS = 40
PLACES = (2, 3)  # values of z at which K is evaluated, none of them a pole


@dataclass(frozen=True)
class Biquad:
    """The recursion x+ = A x + (d, 0) of two states within +-`bounds`, with the output gain u + c x+."""

    gain: float
    A: Array
    c: Array
    bounds: tuple[float, float]


def biquad(
    poles: Sequence[float], zeros: Sequence[float], gain: float, T: float, bounds: tuple[float, float]
) -> Biquad:
    """Return the filter with these pairs of frequency in rad/s and damping; no zeros make a low-pass.

    `bounds` are the largest magnitudes of its states, as the manifest declares them.
    """
    with mpmath.workdps(DIGITS):
        w, period = mpmath.mpf((zeros or poles)[0]), mpmath.mpf(T)
        h = mpmath.tan(w * period / 2) / w

        def factor(pair: Sequence[float], s: Any) -> Any:
            frequency, damping = map(mpmath.mpf, pair)
            return 1 + 2 * damping * s / frequency + (s / frequency) ** 2

        frequency, damping = map(mpmath.mpf, poles)
        root = mpmath.sqrt(damping**2 - 1)
        p, p_v = ((1 + h * s) / (1 - h * s) for s in (-frequency * (damping + root), -frequency * (damping - root)))
        if damping < 1:
            real, imaginary = p_v.real, p_v.imag
            A = mpmath.matrix([[real, -imaginary], [imaginary, real]])
        else:
            A = mpmath.matrix([[p, 0], [1 - p_v, p_v]])
        rows, values = mpmath.zeros(2), mpmath.zeros(2, 1)
        for k, z in enumerate(PLACES):
            s = (z - 1) / (h * (z + 1))
            P = (z - p) * (z - p_v)
            rows[k, 0], rows[k, 1] = (z - 1) * (z - A[1, 1]) / P, (z - 1) * A[1, 0] / P
            values[k] = gain * (factor(zeros, s) if zeros else 1) / factor(poles, s) - gain
        c = mpmath.lu_solve(rows, values)
        return Biquad(
            gain,
            np.array([[float(mpmath.re(A[i, j])) for j in range(2)] for i in range(2)]),
            np.array([float(mpmath.re(v)) for v in c]),
            bounds,
        )


def step(block: str, k: Biquad, u: Array, ready: Array, state: Columns) -> tuple[Array, dict[str, Array]]:
    """Return the output of the Block called `block` for the input u, and its next states."""
    x, v = state[f"{block}_in_phase"], state[f"{block}_quadrature"]
    d = np.where(ready, u - state[f"{block}_previous"], 0.0)
    x, v = k.A[0, 0] * x + k.A[0, 1] * v + d, k.A[1, 0] * x + k.A[1, 1] * v
    y = k.gain * u + k.c[0] * x + k.c[1] * v
    states = {"in_phase": np.clip(x, -k.bounds[0], k.bounds[0]), "quadrature": np.clip(v, -k.bounds[1], k.bounds[1])}
    return y, {f"{block}_previous": u} | {f"{block}_{name}": value for name, value in states.items()}
