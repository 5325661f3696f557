"""Alpha-beta filter with known input for each axis: predicts the motion, without measurements too (dead reckoning).

    q'' = b f      f acts from this sample to the next; with one sample of delay it is the effort of the sample before

With p and s the position and T times the rate that are predicted for this sample, a = b T^2/2 f, and the innovation
e = q - p:

    q^ = p + (1 - r^2) e,   s^ = s + (1 - r)^2 e,   p+ = q^ + (s^ + a),   s+ = (s^ + a) + a

The gains place both poles at z = r (critical damping). An acceleration that differs from b f by d leads to
e = d T^2 / (1 - r)^2, so e tells a measurement that contradicts the motion from a noisy one.

Where an axis has a `disturbance`, d itself is a state, as h = d T^2/2, and a becomes a + h:

    q^ = p + k_p e,  s^ = s + k_s e,  h+ = h + k_h e,   k_h = R^2 S / 2,  k_s = R^2 + 2 R S - k_h,  k_p = 2 R + S - k_s

with R = 1 - r and S = 1 - r_d, for poles at r, r and r_d. A steady force, such as that of a cable, then leaves no
innovation and no error of the rate, and e falls to 0 within some 1/(1 - r_d) samples of a change.

A constant d also leaves the predicted rate behind the true one by

    b T = e ((1 - r^2) + (1 - r)^2 / 2),  and in n samples without measurement d adds n (1 - r)^2 e to it.

Where an axis has a `bias`, its output rate includes b, computed with n and with the mean innovation of measured samples
as e, m+ = m + (1 - r_m) (e - m). The prediction itself stays as it is.

In a sample that is not ``measured``, q is no measurement, e = 0, and f alone moves the prediction: from q, or with a
`bias` from p. For q a source with a bias returns p plus the last or the mean e, which is where the body is; p keeps the
offset of d. Without it the next measurement would correct the rate by less than d changes it, and the errors of samples
that are missing now and then would add up.
`predictor` also estimates d, so its innovation forgets a measurement that contradicts the motion slowly.

Source: Bar-Shalom, Li, Kirubarajan, "Estimation with Applications to Tracking and Navigation", section 6.5.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial

import casadi as ca

from synth import arguments
from synth.block import Block, Constant, Exprs, State, Step, build, clip
from synth.errors import SignalError
from synth.law import label
from synth.signals import Signal, dimension, quotient_unit
from synth.timing import Discrete

READY = Signal("ready", "1", 0, 1, "every measurement was good at once")
MEASURED = Signal("measured", "1", 0, 1, "the positions are measured in this sample")


@arguments.checked
@dataclass(frozen=True)
class RateBias:
    """What a constant disturbance does to a predicted rate.

    pole         r_m of the mean innovation, between 0 and 1
    unmeasured   n, the samples without measurement after which the rate is to be right
    """

    pole: float
    unmeasured: int


@arguments.checked
@dataclass(frozen=True)
class Disturbance:
    """An acceleration that b f leaves out, as a state: its pole r_d, between 0 and 1, and its bound."""

    pole: float
    largest: float


@arguments.checked
@dataclass(frozen=True)
class Axis:
    """One axis q'' = b f of a machine.

    name          prefix of the states and constants of the axis
    measured      the signal q; `predicted` is the one of its prediction, a state, in the same unit
    effort        the achieved effort f that acts from this sample to the next
    acceleration  b, in units of acceleration per unit of f
    fastest       bound of the rate, in the unit of q per s
    pole          r, between 0 and 1
    bias          what to add to the rate for a constant disturbance, None for nothing
    disturbance   a disturbance that is estimated, bounded in the unit of q per s^2, None for none
    """

    name: str
    measured: Signal
    predicted: Signal
    effort: Signal
    acceleration: float
    fastest: float
    pole: float
    bias: RateBias | None = None
    disturbance: Disturbance | None = None

    @property
    def per_effort(self) -> str:
        """The acceleration per unit of effort, as text."""
        unit = f"{self.measured.unit}/s^2"
        return f"the acceleration of {self.acceleration:.6g} {unit} per {self.effort.unit}"

    def advance(self, time: Discrete) -> Signal:
        """Return ``<name>_advance``: T times the rate at the next sample, when the effort of this one begins to act."""
        most = self.fastest * time.period_s
        return Signal(f"{self.name}_advance", self.measured.unit, -most, most, "predicted rate times the sample period")


@arguments.checked
def block(name: str, time: Discrete, axes: Sequence[Axis]) -> Block:
    """Return the Block from positions, efforts and flags to the predicted position and advance of each axis.

    An axis with a bias also outputs the mean innovation, a state.

    The flags are ``ready`` of the guard and ``measured`` of the Block that measures or bridges the positions. The
    prediction is a state, so a Block that measures the position may read it. Until ``ready`` is 1 the machine is
    assumed to be at rest at the measured position.

    Raises SignalError without an axis, for a pole that is not inside 0 .. 1, an acceleration of 0, a bound of the rate
    that is not positive, a negative number of samples, or a prediction whose unit is not that of the position.
    """
    _check(name, axes)

    def law(u: Exprs, x: Exprs, k: Exprs) -> Step:
        output: dict[str, ca.SX] = {}
        next: dict[str, ca.SX] = {}
        named: list[tuple[Signal, ca.SX]] = []
        for axis in axes:
            p, s = (x[f"{axis.name}_{what}"] for what in ("position", "rate"))
            q, h = u[axis.measured.name], x[f"{axis.name}_disturbance"] if axis.disturbance else 0
            a = k[f"{axis.name}_half_step"] * u[axis.effort.name] + h
            corrects = ca.logic_and(u[READY.name], u[MEASURED.name])
            innovation = q - p
            bridged = ca.if_else(u[READY.name], p, q) if axis.bias else q
            corrected = ca.if_else(corrects, p + k[f"{axis.name}_position_gain"] * innovation, bridged)
            rate = ca.if_else(corrects, s + k[f"{axis.name}_rate_gain"] * innovation, s)
            middle = rate + a
            advance = middle + a
            label(corrects=corrects)
            label(axis.name, advance=advance)
            if axis.bias:
                mean = x[f"{axis.name}_mean"]
                learnt = clip(mean + k[f"{axis.name}_mean_gain"] * (innovation - mean), _mean(axis))
                named.append((replace(_mean(axis), name=f"{axis.name}_mean_next"), learnt))
                next[f"{axis.name}_mean"] = ca.if_else(corrects, learnt, mean)
                advance += k[f"{axis.name}_bias_gain"] * mean
                output[_mean(axis).name] = mean
            output |= {axis.predicted.name: p, axis.advance(time).name: advance}
            position = clip(corrected + middle, axis.predicted)
            named.append((Signal(f"{axis.name}_next", axis.measured.unit, *_ends(axis)), position))
            next |= {f"{axis.name}_position": position, f"{axis.name}_rate": middle + a}
            if axis.disturbance:
                learnt_force = clip(h + k[f"{axis.name}_disturbance_gain"] * innovation, _disturbance(axis, time))
                next[f"{axis.name}_disturbance"] = ca.if_else(corrects, learnt_force, h)
                label(axis.name, learnt_force=learnt_force)
            label(axis.name, innovation=innovation, a=a, corrected=corrected, rate=rate, middle=middle)
        certified = {f"{axis.name}_next": partial(_largest, axis, time) for axis in axes}
        certified |= {f"{axis.name}_mean_next": partial(_largest_mean, axis.bias, axis) for axis in axes if axis.bias}
        return Step(output, next, named, certified, [n for axis in axes for n in _numbers(axis, time)])

    inputs = [s for axis in axes for s in (axis.measured, axis.effort)]
    outputs = [s for axis in axes for s in (axis.predicted, axis.advance(time), *([_mean(axis)] if axis.bias else ()))]
    states = [s for axis in axes for s in _states(axis, time)]
    constants = [c for axis in axes for c in _constants(axis, time)]
    tag = "alpha-beta filter, dead reckoning"
    return build(
        name, time, law, inputs=[*inputs, READY, MEASURED], outputs=outputs, states=states, constants=constants, tag=tag
    )


def _ends(axis: Axis) -> tuple[float, float]:
    return axis.predicted.low, axis.predicted.high


def _largest(axis: Axis, time: Discrete, u: float, e: float) -> float:
    """Return a bound on the prediction: that before is at its own, and all that is added at theirs, with rounding u."""
    p, q, effort = (max(abs(s.low), abs(s.high)) for s in (axis.predicted, axis.measured, axis.effort))
    k_p, k_s, _ = _gains(axis)
    h = _disturbance(axis, time).high if axis.disturbance else 0.0
    moved = axis.advance(time).high + k_s * (p + q) + abs(_half_step(axis, time)) * effort + h
    return (max((1 - k_p) * p + k_p * q, q) + moved) * (1 + 16 * u)


def _largest_innovation(measured: Signal, predicted: Signal) -> float:
    return sum(max(abs(s.low), abs(s.high)) for s in (measured, predicted))


@arguments.checked
def mean_innovation(name: str, measured: Signal, predicted: Signal) -> Signal:
    """Return ``<name>_mean``, with room for rounding: a mean of innovations does not exceed the largest one."""
    most = 1.001 * _largest_innovation(measured, predicted)
    return Signal(f"{name}_mean", measured.unit, -most, most, "mean innovation")


def _mean(axis: Axis) -> Signal:
    return mean_innovation(axis.name, axis.measured, axis.predicted)


def _largest_mean(bias: RateBias, axis: Axis, u: float, e: float) -> float:
    r = bias.pole
    return (r * _mean(axis).high + (1 - r) * _largest_innovation(axis.measured, axis.predicted)) * (1 + 16 * u)


def _gains(axis: Axis) -> tuple[float, float, float]:
    """Return k_p, k_s and k_h."""
    if not axis.disturbance:
        return 1 - axis.pole**2, (1 - axis.pole) ** 2, 0.0
    R, S = 1 - axis.pole, 1 - axis.disturbance.pole
    k_h = R**2 * S / 2
    k_s = R**2 + 2 * R * S - k_h
    return 2 * R + S - k_s, k_s, k_h


def _disturbance(axis: Axis, time: Discrete) -> Signal:
    """Return h."""
    assert axis.disturbance is not None
    most = axis.disturbance.largest * time.period_s**2 / 2
    return Signal(f"{axis.name}_disturbance", axis.measured.unit, -most, most, "T^2 / 2 times the disturbance")


def _half_step(axis: Axis, time: Discrete) -> float:
    return axis.acceleration * time.period_s**2 / 2


def _states(axis: Axis, time: Discrete) -> list[State]:
    predicted = replace(axis.predicted, name=f"{axis.name}_position", about="position predicted for this sample")
    rate = replace(axis.advance(time), name=f"{axis.name}_rate")
    states = [State(predicted, min(max(0.0, predicted.low), predicted.high)), State(rate, 0.0)]
    states += [State(_disturbance(axis, time), 0.0)] if axis.disturbance else []
    return [*states, State(_mean(axis), 0.0)] if axis.bias else states


def _constants(axis: Axis, time: Discrete) -> list[Constant]:
    r, per = axis.pole, quotient_unit(axis.measured.unit, axis.effort.unit)
    k_p, k_s, k_h = _gains(axis)
    sources = (f"1 - r^2, r = {r:g}", f"(1 - r)^2, r = {r:g}")
    if axis.disturbance:
        sources = (f"k_p for poles {r:g}, {r:g} and {axis.disturbance.pole:g}", "k_s for the same poles")
    constants = [
        Constant(f"{axis.name}_position_gain", k_p, "1", sources[0]),
        Constant(f"{axis.name}_rate_gain", k_s, "1", sources[1]),
        Constant(f"{axis.name}_half_step", _half_step(axis, time), per, f"T^2 / 2 times {axis.per_effort}"),
    ]
    if axis.disturbance:
        constants.append(Constant(f"{axis.name}_disturbance_gain", k_h, "1", "k_h for the same poles"))
    if not axis.bias:
        return constants
    n, mean_gain = axis.bias.unmeasured, 1 - axis.bias.pole
    gain = 1 - r**2 + (0.5 + n) * (1 - r) ** 2
    source = f"(1 - r^2) + (n + 1/2) (1 - r)^2, r = {r:g}, n = {n} samples without measurement"
    return [
        *constants,
        Constant(f"{axis.name}_mean_gain", mean_gain, "1", f"1 - r_m, r_m = {axis.bias.pole:g}"),
        Constant(f"{axis.name}_bias_gain", gain, "1", f"{source}: a steady innovation is a rate that is not predicted"),
    ]


def _numbers(axis: Axis, time: Discrete) -> list[Constant]:
    unit, advance = axis.measured.unit, axis.advance(time)
    rate = f"{axis.fastest:g} {unit}/s times T: largest rate that is predicted"
    most = [_disturbance(axis, time)] if axis.disturbance else []
    force = "T^2 / 2 times the largest disturbance that is learnt"
    return [
        *(Constant(f"{axis.name}_disturbance_limit", s.high, unit, force) for s in most),
        Constant(f"{axis.name}_position_limit", axis.predicted.high, unit, "largest position that is predicted"),
        Constant(f"{axis.name}_rate_limit", advance.high, unit, rate),
    ]


def _check(name: str, axes: Sequence[Axis]) -> None:
    if not axes:
        raise SignalError(f"'{name}' has no axis: give at least one")
    for axis in axes:
        for pole in (axis.pole, *(part.pole for part in (axis.bias, axis.disturbance) if part)):
            if not 0 < pole < 1:
                raise SignalError(f"a pole of axis '{axis.name}' is {pole}: it must lie between 0 and 1")
        if axis.disturbance and not axis.disturbance.largest > 0:
            raise SignalError(
                f"the disturbance of axis '{axis.name}' is at most {axis.disturbance.largest}: give a bound"
            )
        if axis.bias and axis.bias.unmeasured < 0:
            raise SignalError(f"axis '{axis.name}' is not measured for {axis.bias.unmeasured} samples: give 0 or more")
        if not axis.acceleration:
            raise SignalError(f"effort '{axis.effort.name}' accelerates axis '{axis.name}' by 0: give its acceleration")
        if not axis.fastest > 0:
            raise SignalError(f"the bound of the rate of axis '{axis.name}' is {axis.fastest}: it must be positive")
        if dimension(axis.predicted.unit) != dimension(axis.measured.unit):
            raise SignalError(
                f"'{axis.predicted.name}' is in {axis.predicted.unit}, but '{axis.measured.name}' in "
                f"{axis.measured.unit}: give both one unit"
            )
