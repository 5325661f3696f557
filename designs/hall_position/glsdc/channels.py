"""Voltages of two-axis sensors behind their guard, sensors left out, residuals, and the outputs of an estimate."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import reduce
from math import pi
from string import ascii_lowercase

import casadi as ca

from synth.block import Block, Exprs
from synth.blocks import safety
from synth.blocks.glsdc import Vector
from synth.compose import compose
from synth.signals import Signal, names
from synth.timing import Discrete

SPAN = 5.0  # V, of the converter
BAD_SAMPLES = 5
LEAST = 1e-30  # V^2, in a root: squares are not below 0, which is not seen of products that may not be rounded
COMPLETE = Signal("complete", "1", 0, 1, "every measurement is good")


def outputs(names: Sequence[str], far: float, loose: float, flags: Mapping[str, str]) -> list[Signal]:
    """Return a pose up to `far`, its standard deviations up to `loose`, m, the residual, and flags by their meaning."""
    pose = [_coordinate(name, far) for name in names]
    noise = "standard deviation by the noise of the voltages"
    return [
        *pose,
        *(Signal(f"deviation_{s.name}", s.unit, 0, loose if s.unit == "m" else 1, noise) for s in pose),
        Signal("residual", "V", 0, 1e3, "root mean square by degrees of freedom"),
        Signal("converged", "1", 0, 1, "the last correction is small, and none has raised the cost"),
        *(Signal(name, "1", 0, 1, about) for name, about in flags.items()),
    ]


def _coordinate(name: str, far: float) -> Signal:
    if name in "XY":
        return Signal(name, "m", -far, far, "of the body's origin over the matrix")
    if name == "Z":
        return Signal(name, "m", 0, 1, "of the body's origin above the matrix")
    return Signal(name, "rad", -pi, pi, "of the body over the matrix")


def voltages(sensors: int) -> tuple[Signal, ...]:
    """Return the voltages of sensors a, b, ... in order, each with its two axes."""
    letters = ascii_lowercase[:sensors]
    return tuple(Signal(f"V_{k}{axis}", "V", -SPAN, SPAN, "Hall sensor and axis") for k in letters for axis in "xy")


def held(sensors: int, redundant: bool) -> list[Signal]:
    """Return what the estimator reads: held voltages, and with a redundant sensor which of them are refused."""
    inputs = voltages(sensors)
    faults = [Signal(f"fault_{s.name}", "1", 0, 1, "refused this sample") for s in inputs]
    return [*(replace(s, name=f"{s.name}_held") for s in inputs), *(faults if redundant else [COMPLETE])]


def guarded(name: str, time: Discrete, sensors: int, block: Block, reason: str = "") -> Block:
    """Return an estimator behind the guard of its voltages, which latches after BAD_SAMPLES incomplete samples.

    `reason` says what the latch means to the caller.
    """
    inputs = voltages(sensors)
    guard = safety.guard(time, [safety.Guarded(s, 0.0, True) for s in inputs], BAD_SAMPLES, reason=reason)
    return compose(name, [guard, block], inputs=names(inputs), outputs=names(block.outputs))


def refused(sensors: int, u: Exprs) -> list[ca.SX]:
    """Return of which sensors a voltage is refused."""
    return [ca.logic_or(u[f"fault_V_{k}x"], u[f"fault_V_{k}y"]) for k in ascii_lowercase[:sensors]]


def freedom(sensors: int, unknowns: int, left_out: Vector | None) -> ca.SX:
    """Return how many voltages there are beyond the unknowns; of more than one sensor that is left out one counts."""
    beyond = 2 * sensors - unknowns
    return ca.SX(beyond) if left_out is None else ca.if_else(reduce(ca.logic_or, left_out), beyond - 2, beyond)


def residual(squares: ca.SX, freedom: ca.SX) -> ca.SX:
    """Return the root mean square of squared residuals, V."""
    return ca.sqrt(LEAST + squares / freedom)
