"""Rate feedback that stops a machine before a latch: efforts that bring the predicted rates of its axes to 0.

    q'' = b f,   v+ = v + b T f      f = effort of the law, or while it `brakes`:   f = - share v / (b T)

so that v+ = (1 - share) v within the limits of f, which stay behind this Block; b is the acceleration per effort. v is
the rate at the moment when f begins to act, as `dead_reckoning` predicts it, so no measurement is needed. An axis that
is faster than the limits allow stops with the largest deceleration.
"""

from collections.abc import Mapping, Sequence

import casadi as ca

from synth import arguments
from synth.block import Block, Constant, Exprs, Step, build
from synth.blocks.estimate.dead_reckoning import Axis
from synth.blocks.guard.safety import BRAKES
from synth.errors import SignalError
from synth.signals import Signal, dimension, quotient_unit
from synth.timing import Discrete


@arguments.checked
def block(
    name: str,
    time: Discrete,
    axes: Sequence[Axis],
    demands: Mapping[str, tuple[Signal, Signal]],
    share: float,
    notes: Sequence[str] = (),
) -> Block:
    """Return the Block that passes the demand of each axis on, except while the input ``brakes`` of the guard is 1.

    `demands` has the demanded effort of each axis by name, and the signal under which it is passed on.
    ``<axis>_advance`` is from `dead_reckoning.block`; each braking sample removes `share` of it. `notes` are sentences
    that the C has.

    Raises SignalError for a share that is not in 0 .. 1, for an axis without a demand, for a demand of no axis and for
    one that is passed on in another unit.
    """
    if not 0 < share <= 1:
        raise SignalError(f"'{name}' removes {share} of the rates in a sample: give more than 0 and at most 1")
    if missing := [axis.name for axis in axes if axis.name not in demands]:
        raise SignalError(f"'{name}' has no demand of axis '{missing[0]}': give one of each axis")
    if unknown := [name for name in demands if name not in [axis.name for axis in axes]]:
        raise SignalError(f"'{name}' has a demand of '{unknown[0]}', which is no axis of it: correct the name")
    for demand, passed in demands.values():
        if dimension(demand.unit) != dimension(passed.unit):
            raise SignalError(f"'{name}' passes '{demand.name}' in {demand.unit} on in {passed.unit}: give one unit")
    advance = {axis.name: axis.advance(time) for axis in axes}

    def law(u: Exprs, x: Exprs, k: Exprs) -> Step:
        output = {}
        for axis, rate in advance.items():
            demand, passed = demands[axis]
            output[passed.name] = ca.if_else(u[BRAKES.name], k[f"{axis}_gain"] * u[rate.name], u[demand.name])
        return Step(output, notes=notes)

    constants = []
    for axis in axes:
        per = quotient_unit(demands[axis.name][0].unit, axis.measured.unit)
        gain = -share / (axis.acceleration * time.period_s**2)
        source = f"-{share:g} / T^2, over {axis.per_effort}"
        constants.append(Constant(f"{axis.name}_gain", gain, per, source))
    inputs = [*advance.values(), *(demands[axis.name][0] for axis in axes), BRAKES]
    outputs = [demands[axis.name][1] for axis in axes]
    return build(name, time, law, inputs=inputs, outputs=outputs, constants=constants, tag="braking before the latch")
