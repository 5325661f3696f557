"""A lost place is searched: every PATIENCE samples with large residuals the next one begins elsewhere in the pitch.

Starts fill the pitch evenly, however many they are: Roberts' sequence, a pitch divided by g and by g^2, g^3 = g + 1.
"""

from dataclasses import dataclass
from math import pi

import casadi as ca

from synth.block import Exprs
from synth.signals import Signal

PATIENCE = 5  # samples
AGAIN = {
    "x": -2 * pi * (1 - 0.7548776662466927),
    "y": -2 * pi * (1 - 0.5698402909980532),
}  # downwards: one end is passed
ASTRAY = Signal("astray", "1", 0, PATIENCE, "samples in a row with large residuals")
SEARCHING = Signal("searching", "1", 0, 1, "its place is not known")
RESTARTED = Signal("restarted", "1", 0, 1, "it has looked for its place again")


@dataclass(frozen=True, eq=False)
class Restart:
    """Whether the next sample begins elsewhere, and how many in a row have been astray."""

    again: ca.SX
    astray: ca.SX


def counted(astray: ca.SX, x: Exprs) -> Restart:
    """Return what a sample that is `astray` or not makes of the state."""
    impatient = x["astray"] >= PATIENCE - 1
    count = ca.if_else(astray, ca.if_else(impatient, 0, x["astray"] + 1), 0)
    return Restart(ca.logic_and(astray, impatient), count)


def phases(again: ca.SX, pose: Exprs, x: Exprs) -> dict[str, ca.SX]:
    """Return the next phases and starts: those of the pose, or of the next start."""
    next: dict[str, ca.SX] = {}
    for axis, step in AGAIN.items():
        start = x[f"start_{axis}"] + step
        start = ca.if_else(start < -pi, start + 2 * pi, start)
        next[f"start_{axis}"] = ca.if_else(again, start, x[f"start_{axis}"])
        next[f"phase_{axis}"] = ca.if_else(again, start, pose[f"phase_{axis}"])
    return next


def wrapped(angle: ca.SX) -> tuple[ca.SX, ca.SX]:
    """Return an angle in -2 pi .. 2 pi within half a turn, and the whole turns that are taken off."""
    above = angle > pi
    angle, turns = ca.if_else(above, angle - 2 * pi, angle), ca.if_else(above, 1, 0)
    below = angle < -pi
    return ca.if_else(below, angle + 2 * pi, angle), ca.if_else(below, -1, turns)
