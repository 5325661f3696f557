"""Predictive observer of one coordinate: alpha-beta-gamma filter with a known input (steady-state Kalman filter).

    q'' = g a + d       a: demanded acceleration that acts until the next sample; d: disturbance

    innovation  nu = measured - q
    correction  q+ = q + alpha nu,   v+ = v + beta nu / T,   d+ = d + gamma nu / T^2
    prediction  v' = v+ + T (g a + d+),   q' = q+ + T/2 (v+ + v')

All three poles of the error are exp(-w T): alpha = 1 - p^3, beta = 3/2 (1 - p)^2 (1 + p), gamma = (1 - p)^3. The
prediction of a sample is a state, so a Block that decides whether to believe a measurement may read it in the same
sample. Where the measurement is replaced by the prediction, nu is 0 and the observer runs open. It
starts at the measurement, at rest: until the flag ``ready`` is set, q is the measurement, v and d are 0.

A code that stands still says only in which count the coordinate is. Once it is known to be frozen, what the rate learnt
from it since it last changed is taken back, both at once and through the disturbance, which was d_c at the change:

    l = (beta / gamma) T (d - d_c) + T m,   m' = (1 - LEAK) m + d+ - d_c while the code is unchanged;   v+ = v - l

The first term is the sum of beta nu / T since the change, and m the sum of what d gained. A measurement that is refused
was right until then, and nothing is taken back. The leak bounds m without a limit, which would cost more than the
product.

The gain g is 1, or is learnt from the disturbance that moves with the demand, g' = g + rate T a d+ (gradient of d^2),
inside bounds. Without a trusted measurement g stays, and d is 0 where it is `forgotten`: a disturbance that is only the
error of g must not act on when a has changed.

Source: Kalata, "The tracking index: a generalized parameter for alpha-beta and alpha-beta-gamma target trackers", IEEE
Trans. AES 20 (1984); the triple pole is the fading-memory filter of third order of Morrison.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import casadi as ca

from synth import arguments
from synth.block import Block, Constant, Exprs, State, Step, build, clip
from synth.errors import SignalError
from synth.law import label
from synth.signals import Signal, dimension
from synth.timing import Discrete

__all__ = ["Flags", "Gain", "block", "delay"]

LEAK = 1 / 512  # of the sum, in a sample: slow beside the time to notice a frozen code, 2 to 120 samples


@arguments.checked
@dataclass(frozen=True)
class Gain:
    """A learnt gain from demand to acceleration: its bounds, and the rate in s^3/m^2 or the like."""

    low: float
    high: float
    rate: float


@arguments.checked
@dataclass(frozen=True)
class Flags:
    """Names of the inputs that say whether the measurement is used, since when it is unchanged, and if it is frozen."""

    trusted: str
    unchanged: str
    frozen: str


@arguments.checked
def block(
    name: str,
    time: Discrete,
    measured: Signal,
    demand: Signal,
    *,
    bandwidth: float,
    rate: float,
    disturbance: float,
    flags: Flags | None = None,
    gain: Gain | None = None,
    ahead: bool = False,
) -> Block:
    """Return the observer of `measured` with the poles -`bandwidth` rad/s.

    `demand` is that of the sample before where the loop has a delay of one sample (`delay`). The outputs are
    ``<q>_expected``, the prediction for this sample, and ``<q>_estimate``, ``<q>_rate`` and ``<q>_disturbance`` after
    the correction; q is `name`. `rate` and `disturbance` bound the states v and d. With `flags`, in samples in which
    the measurement is not trusted, the disturbance is 0 and the gain stays, and where it is frozen, the rate that was
    learnt since it last changed is taken back. With `ahead` the prediction for the next sample, when a command with a
    delay of one sample acts, is given too, as ``<q>_ahead`` and ``<q>_rate_ahead``.

    Raises SignalError for a bandwidth that is not positive or not below 1/T, bounds that are not positive, units of
    measurement and demand that do not fit, or a learnt gain without `flags` or with bounds that exclude 1.
    """
    T = time.period_s
    _check(name, T, measured, demand, bandwidth, (rate, disturbance), flags, gain)
    p = math.exp(-bandwidth * T)
    beta = 1.5 * (1 - p) ** 2 * (1 + p) / T
    unit, largest = measured.unit, beta * (measured.high - measured.low)  # of the change of the rate in a sample
    bound = 2.02 * disturbance / LEAK  # with room for rounding
    gained = Signal("gained", f"{unit}/s^2", -bound, bound, "sum of what d gained since the code changed")
    learnt = beta * T**2 / (1 - p) ** 3 * 2 * disturbance + T * bound
    fastest = rate + (max(1.01 * learnt, largest) if flags else largest)
    source = f"triple pole exp(-w T), w = {bandwidth:g} rad/s"
    constants = [
        Constant("alpha", 1 - p**3, "1", source),
        Constant("beta", beta, "1/s", source),
        Constant("gamma", (1 - p) ** 3 / T**2, "1/s^2", source),
    ]
    numbers = [
        Constant("T", T, "s", "sample period"),
        Constant("half_T", T / 2, "s", "half the sample period"),
        Constant("largest_rate", rate, f"{measured.unit}/s", "bound of the predicted rate"),
        Constant("largest_disturbance", disturbance, f"{measured.unit}/s^2", "bound of the disturbance"),
    ]
    if measured.low == -measured.high:
        numbers.append(Constant("largest_position", measured.high, measured.unit, "bound of the prediction"))
    else:
        ends = {"least_position": measured.low, "largest_position": measured.high}
        numbers += [Constant(n, v, unit, "bound of the prediction") for n, v in ends.items() if v]
    numbers += [Constant("gained_decay", 1 - LEAK, "1", "part of the sum that stays")] if flags else []
    if gain:
        numbers += [
            Constant("learning_step", gain.rate * T, "s^4/m^2", f"{gain.rate:g} times T"),
            Constant("least_gain", gain.low, "1", "bound of the learnt gain"),
            Constant("largest_gain", gain.high, "1", "bound of the learnt gain"),
        ]
    expected = Signal(f"{name}_expected", unit, measured.low, measured.high, f"{name} predicted for this sample")
    signals = [
        expected,
        Signal(f"{name}_estimate", unit, measured.low, measured.high, f"{name} after the correction"),
        Signal(f"{name}_rate", f"{unit}/s", -fastest, fastest, f"rate of {name} after the correction"),
        Signal(f"{name}_disturbance", f"{unit}/s^2", -disturbance, disturbance, "acceleration that the demand lacks"),
    ]
    if ahead:
        signals.append(Signal(f"{name}_ahead", unit, measured.low, measured.high, f"{name} one sample later"))
        signals.append(Signal(f"{name}_rate_ahead", f"{unit}/s", -rate, rate, f"rate of {name} one sample later"))
    inputs = [measured, demand, Signal("ready", "1", 0, 1, "an earlier sample was complete")]
    if flags:
        inputs.append(Signal(flags.trusted, "1", 0, 1, "the measurement is used"))
        inputs.append(Signal(flags.frozen, "1", 0, 1, "the code stands still although the coordinate moves"))
        inputs.append(Signal(flags.unchanged, "1", 0, 1e6, "samples without a change of the code"))

    def law(u: Exprs, x: Exprs, k: Exprs) -> Step:
        nu = u[measured.name] - x["q"]
        next: dict[str, ca.SX] = {}
        q, v, d = x["q"] + k["alpha"] * nu, x["v"] + k["beta"] * nu, clip(x["d"] + k["gamma"] * nu, signals[3])
        if flags:
            trusted = u[flags.trusted]
            learnt = k["beta"] / k["gamma"] * (x["d"] - x["d_at_change"]) + T * x["gained"]
            taken_back = ca.if_else(u[flags.frozen], learnt, 0.0)
            v = ca.if_else(trusted, v, x["v"] - taken_back)
            d = ca.if_else(trusted, d, 0.0)
            label(learnt=learnt, taken_back=taken_back)
        q, v, d = (ca.if_else(u["ready"], new, first) for new, first in ((q, u[measured.name]), (v, 0.0), (d, 0.0)))
        if flags:
            same = ca.logic_and(trusted, u[flags.unchanged] >= 1)
            more = (1 - LEAK) * x["gained"] + (d - x["d_at_change"])
            next |= {"gained": ca.if_else(same, more, 0.0), "d_at_change": ca.if_else(same, x["d_at_change"], d)}
            label(same=same, more=more)
        a = (x["g"] * u[demand.name] if gain else u[demand.name]) + d
        rate_ahead = v + T * a
        position_ahead = q + T / 2 * (v + rate_ahead)
        next |= {"q": position_ahead, "v": rate_ahead, "d": d}
        if gain:
            next["g"] = x["g"] + gain.rate * T * (u[demand.name] * d)
        values = [x["q"], q, v, d]
        values += [clip(position_ahead, states[0].signal), clip(rate_ahead, states[1].signal)] if ahead else []
        label(nu=nu, d=d, a=a, rate_ahead=rate_ahead)
        return Step(dict(zip((s.name for s in signals), values, strict=True)), next, numbers=numbers)

    states = [
        State(Signal("q", unit, measured.low, measured.high, "prediction"), (measured.low + measured.high) / 2),
        State(Signal("v", f"{unit}/s", -rate, rate, "predicted rate"), 0.0),
        State(Signal("d", f"{unit}/s^2", -disturbance, disturbance, "disturbance"), 0.0),
    ]
    if flags:
        states += [
            State(gained, 0.0),
            State(replace(signals[3], name="d_at_change", about="d as its code changed"), 0.0),
        ]
    states += [State(Signal("g", "1", gain.low, gain.high, "learnt gain"), 1.0)] if gain else []
    return build(
        f"observer_{name}", time, law, inputs=inputs, outputs=signals, states=states,
        constants=constants, tag="predictive observer, alpha-beta-gamma",
    )  # fmt: skip


@arguments.checked
def delay(name: str, time: Discrete, signals: Sequence[Signal]) -> Block:
    """Return the Block that delays signals by one sample, ``<s>_before``; they are 0 at first.

    Raises SignalError for a signal whose range excludes 0.
    """

    def law(u: Exprs, x: Exprs, k: Exprs) -> Step:
        return Step(
            {f"{s.name}_before": x[s.name + "_last"] for s in signals}, {s.name + "_last": u[s.name] for s in signals}
        )

    outputs = [replace(s, name=f"{s.name}_before") for s in signals]
    states = [State(replace(s, name=f"{s.name}_last", about=f"{s.name} one sample ago"), 0.0) for s in signals]
    return build(name, time, law, inputs=signals, outputs=outputs, states=states, tag="delay of one sample")


def _check(
    name: str,
    T: float,
    measured: Signal,
    demand: Signal,
    bandwidth: float,
    bounds: tuple[float, float],
    flags: Flags | None,
    gain: Gain | None,
) -> None:
    if not 0 < bandwidth * T < 1:
        raise SignalError(f"observer '{name}' has a bandwidth of {bandwidth} rad/s: give one in 0 .. {1 / T:g}")
    if not all(0 < b < math.inf for b in bounds):
        raise SignalError(f"observer '{name}' bounds rate and disturbance by {bounds}: give positive bounds")
    if dimension(demand.unit) != dimension(f"{measured.unit}/s^2"):
        raise SignalError(
            f"observer '{name}': the demand is in {demand.unit}, but {measured.name} needs {measured.unit}/s^2"
        )
    if gain and not (flags and 0 < gain.low <= 1 <= gain.high and gain.rate > 0):
        raise SignalError(
            f"observer '{name}' learns its gain in {gain.low} .. {gain.high} at {gain.rate}: give bounds about 1, a "
            "positive rate and `flags`"
        )
