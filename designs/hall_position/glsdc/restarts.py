"""Restarts of the search: after PATIENCE residual faults in a row the next sample starts elsewhere in the pitch.

The starts are Roberts' quasirandom sequence with steps of 1/g and 1/g^2 of a pitch, g^3 = g + 1. Any number of them
fills the pitch evenly.
"""

from math import pi

import casadi as ca

from synth.block import Constant, Exprs, State
from synth.blocks.estimate.glsdc import Vector
from synth.law import label
from synth.signals import Signal

PATIENCE = 5  # samples
FRACTIONS = {"x": 0.7548776662466927, "y": 0.5698402909980532}  # of a pitch: 1/g, 1/g^2
RESIDUAL_FAULTS = Signal("residual_faults", "1", 0, PATIENCE, "consecutive samples with a residual fault")
SEARCHING = Signal("searching", "1", 0, 1, "position lock is being searched")
LOCK_LOST = Signal("lock_lost", "1", 0, 1, "position lock has been lost since it was acquired")


def states(reals: list[Signal], counts: list[Signal]) -> list[State]:
    """Return the states after `init`: all 0 except `searching`, which is 1."""
    return [*(State(s, 0.0) for s in reals), *(State(s, int(s is SEARCHING), True) for s in counts)]


def numbers() -> list[Constant]:
    """Return the numbers of the starts that the C names."""
    about = "from one start to the next, in the negative direction"
    return [Constant(f"start_step_{axis}", _step(axis), "rad", about) for axis in FRACTIONS]


def _step(axis: str) -> float:
    """Return the step from one start to the next, rad of phase."""
    return -2 * pi * (1 - FRACTIONS[axis])


def count_faults(residual_fault: ca.SX, x: Exprs) -> tuple[ca.SX, ca.SX]:
    """Return whether the next sample starts elsewhere, and the number of consecutive residual faults."""
    exhausted = x["residual_faults"] >= PATIENCE - 1
    faults = ca.if_else(residual_fault, ca.if_else(exhausted, 0, x["residual_faults"] + 1), 0)
    label(exhausted=exhausted)
    return ca.logic_and(residual_fault, exhausted), faults


def gate_correction(residual_fault: ca.SX, names: tuple[str, ...], at: Vector, x: Exprs) -> dict[str, ca.SX]:
    """Return the correction of a pose by name: 0 on a residual fault, except while searching."""
    rejected = ca.logic_and(residual_fault, ca.logic_not(x["searching"]))
    label(at=at, rejected=rejected)
    return {name: ca.if_else(rejected, 0, d) for name, d in zip(names, at, strict=True)}


def next_phases(restart: ca.SX, pose: Exprs, x: Exprs) -> dict[str, ca.SX]:
    """Return the next phases and starts: those of the pose, or on a restart those of the next start."""
    next: dict[str, ca.SX] = {}
    for axis in FRACTIONS:
        start = x[f"start_{axis}"] + _step(axis)  # in the negative direction, which crosses one end only
        start = ca.if_else(start < -pi, start + 2 * pi, start)
        next[f"start_{axis}"] = ca.if_else(restart, start, x[f"start_{axis}"])
        next[f"phase_{axis}"] = ca.if_else(restart, start, pose[f"phase_{axis}"])
        label(axis, start=start)
    return next


def wrap(name: str, angle: ca.SX) -> tuple[ca.SX, ca.SX]:
    """Return an angle of -2 pi .. 2 pi wrapped to -pi .. pi, and the whole turns that were subtracted."""
    above = angle > pi
    angle, turns = ca.if_else(above, angle - 2 * pi, angle), ca.if_else(above, 1, 0)
    below = angle < -pi
    label(name, angle=angle, below=below, turns=turns)
    return ca.if_else(below, angle + 2 * pi, angle), ca.if_else(below, -1, turns)
