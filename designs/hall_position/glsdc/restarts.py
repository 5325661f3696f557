"""Restart of a lost search: every PATIENCE samples with large residuals the next one begins elsewhere in the pitch.

Starts fill the pitch evenly, however many they are: Roberts' sequence, a pitch divided by g and by g^2, g^3 = g + 1.
"""

from math import pi

import casadi as ca

from synth.block import Exprs, State
from synth.blocks.glsdc import Vector
from synth.signals import Signal

PATIENCE = 5  # samples
PARTS = {"x": 0.7548776662466927, "y": 0.5698402909980532}  # of a pitch: 1/g, 1/g^2
ASTRAY = Signal("astray", "1", 0, PATIENCE, "samples in a row with large residuals")
SEARCHING = Signal("searching", "1", 0, 1, "its place is not known")
RESTARTED = Signal("restarted", "1", 0, 1, "it has looked for its place again")


def states(reals: list[Signal], counts: list[Signal]) -> list[State]:
    """Return the states after `init`: 0 and searching."""
    return [*(State(s, 0.0) for s in reals), *(State(s, int(s is SEARCHING), True) for s in counts)]


def count(residual_fault: ca.SX, x: Exprs) -> tuple[ca.SX, ca.SX]:
    """Return whether the next sample begins elsewhere, and how many residual faults there were in a row."""
    impatient = x["astray"] >= PATIENCE - 1
    faults = ca.if_else(residual_fault, ca.if_else(impatient, 0, x["astray"] + 1), 0)
    return ca.logic_and(residual_fault, impatient), faults


def unless_held(residual_fault: ca.SX, names: tuple[str, ...], at: Vector, x: Exprs) -> dict[str, ca.SX]:
    """Return the correction of a pose by name: none after a residual fault of a body whose place is known."""
    held = ca.logic_and(residual_fault, ca.logic_not(x["searching"]))
    return {name: ca.if_else(held, 0, d) for name, d in zip(names, at, strict=True)}


def phases(again: ca.SX, pose: Exprs, x: Exprs) -> dict[str, ca.SX]:
    """Return the next phases and starts: those of the pose, or of the next start."""
    next: dict[str, ca.SX] = {}
    for axis, part in PARTS.items():
        start = x[f"start_{axis}"] + -2 * pi * (1 - part)  # downwards: one end is passed
        start = ca.if_else(start < -pi, start + 2 * pi, start)
        next[f"start_{axis}"] = ca.if_else(again, start, x[f"start_{axis}"])
        next[f"phase_{axis}"] = ca.if_else(again, start, pose[f"phase_{axis}"])
    return next


def wrap(angle: ca.SX) -> tuple[ca.SX, ca.SX]:
    """Return an angle in -2 pi .. 2 pi within half a turn, and the whole turns that are taken off."""
    above = angle > pi
    angle, turns = ca.if_else(above, angle - 2 * pi, angle), ca.if_else(above, 1, 0)
    below = angle < -pi
    return ca.if_else(below, angle + 2 * pi, angle), ca.if_else(below, -1, turns)
