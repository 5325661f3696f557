"""Lead-lag compensator with integral action in NumPy, sampled by Tustin's rule: reference of `blocks.lead_lag`.

    K(z) = D (z - z1) (z - z2) / ((z - p) (z - 1)),   d = D e + V + I
    V+ = p V + D (p - z1) e,   I+ = I + (1 - z2) (achieved - I)         the integral follows the achieved demand

V and I are kept over a scale, such as the force of one ampere.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

from numpy.typing import NDArray

Array = NDArray[Any]
Columns = Mapping[str, Array]


@dataclass(frozen=True)
class Compensator:
    """K(z) = D (z - z1) (z - z2) / ((z - p) (z - 1))."""

    D: float
    z1: float
    z2: float
    p: float


def tustin(gain: Fraction, zeros: tuple[Fraction, Fraction], pole: Fraction, T: Fraction) -> Compensator:
    """Return gain (s + a) (s + b) / ((s + c) s) with s = (2/T) (z - 1)/(z + 1), exactly."""
    w = 2 / T
    D = gain * (w + zeros[0]) * (w + zeros[1]) / ((w + pole) * w)
    z1, z2, p = ((w - v) / (w + v) for v in (*zeros, pole))
    return Compensator(*(float(v) for v in (D, z1, z2, p)))


def demand(block: str, k: Compensator, e: Array, state: Columns, scale: float) -> Array:
    """Return the demand for the error e, of the Block called `block`."""
    return k.D * e + scale * (state[f"{block}_lead"] + state[f"{block}_integral"])


def next_state(block: str, k: Compensator, e: Array, achieved: Array, state: Columns, scale: float) -> dict[str, Array]:
    """Return the next states; the integral follows the achieved demand."""
    lead = k.p * state[f"{block}_lead"] + k.D * (k.p - k.z1) * e / scale
    integral = state[f"{block}_integral"]
    return {f"{block}_lead": lead, f"{block}_integral": integral + (1 - k.z2) * (achieved / scale - integral)}
