"""No demand before the first complete sample: until then nothing is known of where the machine is.

    passed = demand   if ready or complete, else 0

`ready` of the guard says that every measurement was good at once in a sample before, `complete` that those that a law
compares are good in this one. A law whose first measurement is missing would act on the position after `init`.
"""

from collections.abc import Mapping

import casadi as ca

from synth import arguments
from synth.block import Block, Exprs, Step, build
from synth.blocks.estimate.dead_reckoning import READY
from synth.errors import SignalError
from synth.law import label
from synth.signals import Signal, dimension
from synth.timing import Discrete

COMPLETE = Signal("complete", "1", 0, 1, "every measurement that is compared is good")


@arguments.checked
def block(time: Discrete, demands: Mapping[Signal, Signal]) -> Block:
    """Return the Block ``start`` from each demand to the signal under which it is passed on.

    Its inputs are also ``ready`` and ``complete`` of the guard.

    Raises SignalError without a demand, and for one that is passed on in another unit.
    """
    if not demands:
        raise SignalError("'start' has no demand: give at least one")
    for demand, passed in demands.items():
        if dimension(demand.unit) != dimension(passed.unit):
            raise SignalError(f"'start' passes '{demand.name}' in {demand.unit} on in {passed.unit}: give one unit")

    def law(u: Exprs, x: Exprs, k: Exprs) -> Step:
        begun = ca.logic_or(u[READY.name], u[COMPLETE.name])
        label(begun=begun)
        return Step({passed.name: ca.if_else(begun, u[demand.name], 0) for demand, passed in demands.items()})

    tag = "no demand before the first complete sample"
    return build("start", time, law, inputs=[READY, COMPLETE, *demands], outputs=list(demands.values()), tag=tag)
