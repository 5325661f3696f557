"""Inputs and outputs of the estimators: guarded voltages, residuals, pose and flags."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from math import pi
from string import ascii_lowercase

import casadi as ca

from synth.block import Block
from synth.blocks import safety
from synth.composition import compose
from synth.signals import Signal, signal_names
from synth.timing import Discrete

SPAN = 5.0  # V, of the converter
BAD_SAMPLES = 5
# The range analysis cannot see that the sum of squares is not negative.
ROOT_REGULARISATION = 1e-30  # V^2, added under a root
COMPLETE = Signal("complete", "1", 0, 1, "every voltage of this sample was accepted")


def outputs(names: Sequence[str], max_distance: float, max_deviation: float, flags: Mapping[str, str]) -> list[Signal]:
    """Return pose within `max_distance` m, deviations up to `max_deviation` m, residual, and flags {name: about}."""
    pose = [_coordinate(name, max_distance) for name in names]
    return [
        *pose,
        *(
            Signal(
                f"deviation_{s.name}",
                s.unit,
                0,
                max_deviation if s.unit == "m" else 1,
                f"standard deviation of {s.name} from the voltages' noise",
            )
            for s in pose
        ),
        Signal("residual", "V", 0, 1e3, "rms of the voltage residuals, by degrees of freedom"),
        Signal("converged", "1", 0, 1, "the last correction is small, and no correction raised the cost"),
        *(Signal(name, "1", 0, 1, about) for name, about in flags.items()),
    ]


def _coordinate(name: str, max_distance: float) -> Signal:
    if name in "XY":
        return Signal(
            name, "m", -max_distance, max_distance, f"position of the body's origin along {name} of the magnet matrix"
        )
    if name == "Z":
        return Signal(name, "m", 0, 1, "height of the body's origin above the magnet matrix")
    return Signal(name, "rad", -pi, pi, f"{name} of the body relative to the magnet matrix")


def voltages(sensors: int) -> tuple[Signal, ...]:
    """Return the voltages of sensors a, b, ... in order, each with its two axes."""
    letters = ascii_lowercase[:sensors]
    return tuple(
        Signal(f"V_{k}{axis}", "V", -SPAN, SPAN, f"Hall sensor {k}, axis {axis}") for k in letters for axis in "xy"
    )


def estimator_inputs(sensors: int) -> list[Signal]:
    """Return the inputs: held voltages, and ``complete``."""
    return [*(replace(s, name=f"{s.name}_held") for s in voltages(sensors)), COMPLETE]


def with_guard(name: str, time: Discrete, sensors: int, block: Block, reason: str = "") -> Block:
    """Return an estimator behind the guard of its voltages, which latches after BAD_SAMPLES incomplete samples.

    `reason` tells the caller what the latch means.
    """
    inputs = voltages(sensors)
    guard = safety.guard(time, [safety.GuardedInput(s, 0.0, True) for s in inputs], BAD_SAMPLES, reason=reason)
    return compose(name, [guard, block], inputs=signal_names(inputs), outputs=signal_names(block.outputs))


def freedom(sensors: int, unknowns: int) -> int:
    """Return the degrees of freedom: voltages less unknowns."""
    return 2 * sensors - unknowns


def residual(squares: ca.SX, freedom: int) -> ca.SX:
    """Return the root mean square of squared residuals, V."""
    return ca.sqrt(ROOT_REGULARISATION + squares / freedom)
