"""Channels of the estimators: voltages of the sensors, and the residual of their fit."""

from string import ascii_lowercase

import casadi as ca

from synth.law import label
from synth.signals import Signal

SPAN = 5.0  # V, of the converter
BAD_SAMPLES = 5
# The range analysis cannot see that the sum of squares is not negative.
ROOT_REGULARISATION = 1e-30  # V^2, added under a root


def voltages(sensors: int) -> tuple[Signal, ...]:
    """Return the voltages of sensors a, b, ... in order, each with its two axes."""
    letters = ascii_lowercase[:sensors]
    return tuple(
        Signal(f"V_{k}{axis}", "V", -SPAN, SPAN, f"Hall sensor {k}, axis {axis}") for k in letters for axis in "xy"
    )


def freedom(sensors: int, unknowns: int) -> int:
    """Return the degrees of freedom: voltages less unknowns."""
    return 2 * sensors - unknowns


def residual(squares: ca.SX, freedom: int) -> ca.SX:
    """Return the root mean square of squared residuals, V."""
    label(squares=squares)
    return ca.sqrt(ROOT_REGULARISATION + squares / freedom)
