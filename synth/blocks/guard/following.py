"""Status bit for set-points that a machine follows late: an error beyond the one that its law corrects at full speed.

    late = |r_i - q_i| > e_i for an axis i        r: set-point, q: position, e: largest error that counts as such

A law that clips its error moves the axis at a bounded speed, so a set-point that is faster, or jumps, is followed late.
That is ordinary use and no fault: the bit is a `status` of the fault word, and no alarm counts it. It is 0 while the
machine brakes and after a latch, when nothing is followed.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import casadi as ca

from synth import arguments
from synth.block import LATCH_BIT, Block, Constant, Exprs, Fault, Step, build
from synth.blocks.guard.safety import BRAKES
from synth.errors import SignalError
from synth.law import label
from synth.signals import Signal, dimension
from synth.timing import Discrete

LATCHED = Signal("latched", "1", 0, 1, "latched until init")


@arguments.checked
@dataclass(frozen=True)
class Axis:
    """A position that follows a set-point, its largest error in the unit of both, and its bit of the fault word."""

    position: Signal
    set_point: Signal
    largest: float
    bit: int

    @property
    def late(self) -> Signal:
        """The flag."""
        about = f"the {self.set_point.about or self.set_point.name} is followed late"
        return Signal(f"late_{self.position.name}", "1", 0, 1, about)


@arguments.checked
def block(time: Discrete, axes: Sequence[Axis]) -> Block:
    """Return the Block ``following`` that sets a status bit while an axis is behind its set-point.

    Its inputs are also ``latched`` and ``brakes`` of a guard that brakes.

    Raises SignalError for a bit that the fault word does not have, that reports the latch or that two axes share,
    without an axis, for an error that is not positive, or for a set-point in another unit than its position.
    """
    _check(axes)

    def law(u: Exprs, x: Exprs, k: Exprs) -> Step:
        late = {}
        for axis, a in by_position.items():
            is_close = ca.fabs(u[a.set_point.name] - u[axis]) <= a.largest
            is_late = ca.if_else(u[BRAKES.name], 0, ca.logic_not(is_close))
            late[a.late.name] = ca.if_else(u[LATCHED.name], 0, is_late)
            label(axis, is_close=is_close, is_late=is_late)
        return Step(late, numbers=numbers)

    by_position = {a.position.name: a for a in axes}
    numbers = [
        Constant(f"largest_{a.position.name}", a.largest, a.position.unit, "a larger error is late") for a in axes
    ]
    inputs = [LATCHED, BRAKES, *(s for axis in axes for s in (axis.position, axis.set_point))]
    outputs, tag = [a.late for a in axes], "set-points that are followed late"
    made = build("following", time, law, inputs=inputs, outputs=outputs, tag=tag)
    return replace(made, faults=tuple(Fault(a.bit, a.late.name, about=a.late.about, status=True) for a in axes))


def _check(axes: Sequence[Axis]) -> None:
    if not axes:
        raise SignalError("'following' has no axis: give at least one")
    bits = [axis.bit for axis in axes]
    for axis in axes:
        if bits.count(axis.bit) > 1:
            raise SignalError(f"two axes of 'following' set bit {axis.bit}: give each its own")
        if not 0 <= axis.bit < LATCH_BIT:
            raise SignalError(
                f"the bit of '{axis.late.name}' is {axis.bit}: give one from 0 to {LATCH_BIT - 1} that is free"
            )
        if not 0 < axis.largest < float("inf"):
            raise SignalError(f"the largest error of '{axis.position.name}' is {axis.largest}: give a positive one")
        if dimension(axis.set_point.unit) != dimension(axis.position.unit):
            raise SignalError(
                f"'{axis.set_point.name}' is in {axis.set_point.unit}, but '{axis.position.name}' in "
                f"{axis.position.unit}: give both one unit"
            )
