"""Safe output of a controller: once latched, its outputs slew to declared values.

    latched    y+ = max(min(s, y + r T), y - r T)    s: safe value, r: slew rate
    else       y+ = the computed value, limited to the range of the output

The output y of the previous sample is a state. Where a machine brakes before each latch and no law reads this output,
y is stored only in samples after which it may latch, and once it has latched.

What lets a body down in flight may drive it sideways on the stop on which it has landed. While ``rests`` is 1, outputs
in ``landed_output`` of the `Safety` have its value s.

Rate feedback that stops a machine before a latch: efforts that bring the predicted rates of its axes to 0.

    q'' = b f,   v+ = v + b T f      f = effort of the law, or while it `brakes`:   f = - share v / (b T)

so that v+ = (1 - share) v within the limits of f, which stay behind this Block; b is the acceleration per effort. v is
the rate at the moment when f begins to act, as `dead_reckoning` predicts it, so no measurement is needed. An axis that
is faster than the limits allow stops with the largest deceleration.
"""

import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace
from itertools import takewhile
from typing import TypeVar

import casadi as ca

from synth import arguments
from synth.block import Block, Constant, Exprs, Safety, State, Step, build, clip
from synth.blocks.estimate.dead_reckoning import Axis
from synth.blocks.guard import safety as guarding
from synth.blocks.guard.safety import BRAKES
from synth.errors import SignalError
from synth.law import label
from synth.signals import Signal, dimension, quotient_unit, signal_names
from synth.timing import Discrete


@arguments.checked
def braking_block(
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


K = TypeVar("K")


@arguments.checked
def block(time: Discrete, outputs: Sequence[Signal], safety: Safety, unread: Collection[str] = ()) -> Block:
    """Return the Block that passes ``<name>_computed`` on as ``<name>`` and, once latched, slews to the safe output.

    The computed value is limited to the output's range; the slew from there to the safe output stays inside the range.
    With a ``landed_output`` it reads ``rests`` of `landing`. ``<name>_before`` is the output of the previous sample.
    With `braking` there is none of the outputs `unread`, for which it reads ``may_latch`` of the guard.

    Raises SignalError when a safe output or a rate is missing, a rate is not positive, or a safe value lies outside its
    range.
    """
    _check(outputs, safety)
    values, landed = safety.safe_output, safety.landed_output
    changed = [s for s in outputs if landed.get(s.name, values[s.name]) != values[s.name]]
    stored_seldom = [s.name for s in outputs if safety.braking and s.name in unread]

    def law(u: Exprs, x: Exprs, k: Exprs) -> Step:
        target = {s.name: ca.SX(values[s.name]) for s in outputs}
        named = []
        for group in _alike(changed, {n: (values[n], v) for n, v in landed.items()}).values():
            s = group[0]
            of_group = ca.if_else(u[guarding.RESTS], landed[s.name], values[s.name])
            target |= dict.fromkeys(signal_names(group), of_group)
            named.append((replace(s, name=f"target_{_together(group)}", about="once latched"), of_group))
        value, next = {}, {}
        for s in outputs:
            step, last = safety.slew_per_s[s.name] * time.period_s, x[f"last_{s.name}"]
            slewed = ca.fmax(ca.fmin(target[s.name], last + step), last - step)
            computed = clip(u[f"{s.name}_computed"], s)
            value[s.name] = ca.if_else(u["latched"], slewed, computed)
            stored = ca.if_else(u[guarding.MAY_LATCH.name], computed, last) if s.name in stored_seldom else computed
            next[f"last_{s.name}"] = ca.if_else(u["latched"], slewed, stored)
            label(s.name, slewed=slewed)
        before = {f"{s.name}_before": x[f"last_{s.name}"] for s in outputs if s.name not in stored_seldom}
        return Step(value | before, next, named, numbers=_numbers(time, outputs, safety))

    last = "last output"
    read = [Signal("latched", "1", 0, 1, "latched until init")]
    read += [Signal(guarding.RESTS, "1", 0, 1, "lies on the stop")] if changed else []
    read += [guarding.MAY_LATCH] if stored_seldom else []
    read += [replace(s, name=f"{s.name}_computed") for s in outputs]
    before = [s for s in outputs if s.name not in stored_seldom]
    made = build(
        guarding.SAFE_OUTPUT, time, law, inputs=read, tag="slew to the safe output once latched",
        outputs=[*outputs, *(replace(s, name=f"{s.name}_before", about="one sample ago") for s in before)],
        states=[State(replace(s, name=f"last_{s.name}", about=last), safety.safe_output[s.name]) for s in outputs],
    )  # fmt: skip
    safe, rates = ({s.name: of[s.name] for s in outputs} for of in (values, safety.slew_per_s))
    return replace(made, safety=replace(safety, safe_output=safe, slew_per_s=rates))


def _numbers(time: Discrete, outputs: Sequence[Signal], safety: Safety) -> list[Constant]:
    """Return the safe values and the largest changes in a sample, each once under a name of its outputs."""
    values, rates = (_alike(outputs, of) for of in (safety.safe_output, safety.slew_per_s))
    return [
        *(Constant(f"safe_{_together(group)}", v, group[0].unit, "safe output") for v, group in values.items()),
        *(
            Constant(
                "slew_step" if len(rates) == 1 else f"slew_{_together(group)}",
                rate * time.period_s,
                group[0].unit,
                f"{rate:g} {group[0].unit}/s times {time.period_s:g} s",
            )
            for rate, group in rates.items()
        ),
    ]


def _alike(outputs: Sequence[Signal], of: Mapping[str, K]) -> dict[K, list[Signal]]:
    groups: dict[K, list[Signal]] = {}
    for s in outputs:
        groups.setdefault(of[s.name], []).append(s)
    return groups


def _together(group: Sequence[Signal]) -> str:
    """Return the beginning that the names of several signals share, else the first name."""
    alike = takewhile(lambda letters: len(set(letters)) == 1, zip(*(s.name for s in group), strict=False))
    shared = "".join(letters[0] for letters in alike).rstrip("_0123456789")
    return shared if shared and len(group) > 1 else group[0].name


def _check(outputs: Sequence[Signal], safety: Safety) -> None:
    for s in outputs:
        if s.name not in safety.safe_output or s.name not in safety.slew_per_s:
            raise SignalError(f"output '{s.name}' has no safe value or no rate: declare both")
        for value in (safety.safe_output[s.name], safety.landed_output.get(s.name, safety.safe_output[s.name])):
            if not s.low <= value <= s.high:
                raise SignalError(
                    f"the safe output {value} of '{s.name}' is outside {s.low} .. {s.high}: choose one inside"
                )
        if not 0 < safety.slew_per_s[s.name] < math.inf:
            raise SignalError(
                f"output '{s.name}' slews at {safety.slew_per_s[s.name]} {s.unit} per second: "
                "the rate must be finite and positive"
            )
    known = [s.name for s in outputs]
    if unknown := [n for n in safety.landed_output if n not in known]:
        raise SignalError(f"'{unknown[0]}' has a value once landed but is no output: name one of {', '.join(known)}")
