"""Missed-call counter (watchdog, deadline monitor): a fault bit when the caller has missed too many calls.

    fault_k = not (0 <= n_k <= limit)        n_k: calls that the caller has missed since its last one

A step does not see time: between two calls the outputs stay, and after a gap the state is that of the last call. Only
the caller knows, from the count of a timer or from an overrun flag of its scheduler. It passes 0 normally. NaN and a
negative count set the bit, too: a broken counter is reported like a gap. The bit belongs to its sample and never
latches, and no law depends on the count, so a wrong one does no harm and needs no guard; but fault detection takes a
gap that is not counted for a jump of a sensor.

The limit is the largest number of missed calls that the machine tolerates, which a fault campaign measures.
"""

from dataclasses import replace

import casadi as ca

from synth import arguments
from synth.block import LATCH_BIT, Block, Constant, Exprs, Fault, Step, build
from synth.errors import SignalError
from synth.fault import Failure
from synth.law import label
from synth.signals import Signal
from synth.timing import Discrete

__all__ = ["MISSED_CALLS", "block", "signal"]

MISSED_CALLS = "missed_calls"  # name of the Block and of the input


@arguments.checked
def signal(limit: float) -> Signal:
    """Return the controller input of the count, which tolerates up to `limit` missed calls.

    Raises SignalError for a limit that is not finite and positive.
    """
    if not 0 < limit < float("inf"):
        raise SignalError(
            f"missed_calls tolerates {limit} calls: give a finite number above 0, such as 0.5 to report each missed one"
        )
    return Signal(MISSED_CALLS, "1", 0, limit, "calls missed since the last one, 0 if none")


@arguments.checked
def block(time: Discrete, count: Signal, bit: int) -> Block:
    """Return the Block that sets a fault bit while `count`, which is from `signal`, is outside its range or NaN.

    Raises SignalError for a bit that the fault word does not have or that reports the latch.
    """
    if not 0 <= bit < LATCH_BIT:
        raise SignalError(f"the bit of missed calls is {bit}: give one from 0 to {LATCH_BIT - 1} that is free")
    most = Constant("most_missed_calls", count.high, "1", "calls that may be missing before the next one")
    flag = Signal(f"fault_{count.name}", "1", 0, 1, "too many calls are missing")

    def law(u: Exprs, x: Exprs, k: Exprs) -> Step:
        tolerated = ca.logic_and(u[count.name] >= count.low, u[count.name] <= count.high)
        label(tolerated=tolerated)
        return Step({flag.name: ca.logic_not(tolerated)}, numbers=[most])

    made = build(MISSED_CALLS, time, law, inputs=[count], outputs=[flag], tag="missed calls")
    about = f"more than {count.high:g} calls missed, or a count that is negative or NaN"
    row = Failure(
        MISSED_CALLS,
        about,
        "at the next call, where the caller counts them",
        "the last outputs act until then",
        "nothing: the caller must stop the motion",
        (count.name,),
    )
    return replace(made, faults=(Fault(bit, flag.name, count.name, about=about),), failures=(row,))
