"""Predictive observer of one coordinate: alpha-beta-gamma filter with a known input (steady-state Kalman filter).

    q'' = g a + d       a: demanded acceleration that acts until the next sample; d: disturbance

    innovation  nu = measured - q
    correction  q+ = q + alpha nu,   v+ = v + beta nu / T,   d+ = d + gamma nu / T^2
    prediction  q' = q+ + T v+ + T^2/2 (g a + d+),   v' = v+ + T (g a + d+)

All three poles of the error are exp(-w T): alpha = 1 - p^3, beta = 3/2 (1 - p)^2 (1 + p), gamma = (1 - p)^3. The
prediction of a sample is a state, so a Block that decides whether to believe a measurement may read it in the same
sample. Where the measurement is replaced by the prediction, nu is 0 and the observer runs open. It
starts at the measurement, at rest: until the flag ``ready`` is set, q is the measurement, v and d are 0.

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
from synth.signals import Signal, dimension
from synth.timing import Discrete

__all__ = ["Gain", "block", "delay"]


@arguments.checked
@dataclass(frozen=True)
class Gain:
    """A learnt gain from demand to acceleration: its bounds, and the rate in s^3/m^2 or the like."""

    low: float
    high: float
    rate: float


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
    trusted: str | None = None,
    gain: Gain | None = None,
) -> Block:
    """Return the observer of `measured` with the poles -`bandwidth` rad/s.

    `demand` is that of the sample before where the loop has a delay of one sample (`delay`). The outputs are
    ``<q>_expected``, the prediction for this sample, and ``<q>_estimate``, ``<q>_rate`` and ``<q>_disturbance`` after
    the correction; q is `name`. `rate` and `disturbance` bound the states v and d. With the flag `trusted` the
    disturbance is 0 and the gain stays in samples in which the flag is 0.

    Raises SignalError for a bandwidth that is not positive or not below 1/T, bounds that are not positive, units of
    measurement and demand that do not fit, or a learnt gain without `trusted` or with bounds that exclude 1.
    """
    T = time.period_s
    _check(name, T, measured, demand, bandwidth, (rate, disturbance), trusted, gain)
    p = math.exp(-bandwidth * T)
    unit, fastest = measured.unit, rate + 1.5 * (1 - p) ** 2 * (1 + p) / T * (measured.high - measured.low)
    source = f"triple pole exp(-w T), w = {bandwidth:g} rad/s"
    constants = [
        Constant("alpha", 1 - p**3, "1", source),
        Constant("beta", 1.5 * (1 - p) ** 2 * (1 + p) / T, "1/s", source),
        Constant("gamma", (1 - p) ** 3 / T**2, "1/s^2", source),
    ]
    expected = Signal(f"{name}_expected", unit, measured.low, measured.high, f"{name} predicted for this sample")
    signals = [
        expected,
        Signal(f"{name}_estimate", unit, measured.low, measured.high, f"{name} after the correction"),
        Signal(f"{name}_rate", f"{unit}/s", -fastest, fastest, f"rate of {name} after the correction"),
        Signal(f"{name}_disturbance", f"{unit}/s^2", -disturbance, disturbance, "acceleration that the demand lacks"),
    ]
    flags = [Signal("ready", "1", 0, 1, "an earlier sample was complete")]
    flags += [Signal(trusted, "1", 0, 1, "the measurement is used")] if trusted else []

    def law(u: Exprs, x: Exprs, k: Exprs) -> Step:
        nu = u[measured.name] - x["q"]
        q, v = x["q"] + k["alpha"] * nu, x["v"] + k["beta"] * nu
        d = clip(x["d"] + k["gamma"] * nu, signals[3])
        d = ca.if_else(u[trusted], d, 0.0) if trusted else d
        q, v, d = (ca.if_else(u["ready"], new, first) for new, first in ((q, u[measured.name]), (v, 0.0), (d, 0.0)))
        a = (x["g"] * u[demand.name] if gain else u[demand.name]) + d
        next = {"q": q + T * (v + T / 2 * a), "v": v + T * a, "d": d}
        if gain:
            next["g"] = x["g"] + gain.rate * T * (u[demand.name] * d)
        return Step(dict(zip((s.name for s in signals), (x["q"], q, v, d), strict=True)), next)

    states = [
        State(Signal("q", unit, measured.low, measured.high, "prediction"), (measured.low + measured.high) / 2),
        State(Signal("v", f"{unit}/s", -rate, rate, "predicted rate"), 0.0),
        State(Signal("d", f"{unit}/s^2", -disturbance, disturbance, "disturbance"), 0.0),
    ]
    states += [State(Signal("g", "1", gain.low, gain.high, "learnt gain"), 1.0)] if gain else []
    return build(
        f"observer_{name}", time, law, inputs=[measured, demand, *flags], outputs=signals, states=states,
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
    trusted: str | None,
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
    if gain and not (trusted and 0 < gain.low <= 1 <= gain.high and gain.rate > 0):
        raise SignalError(
            f"observer '{name}' learns its gain in {gain.low} .. {gain.high} at {gain.rate}: give bounds about 1, a "
            "positive rate and the flag `trusted`"
        )
