"""Rate of a signal: the critically damped filter D(s) = s w^2 / (s + w)^2, sampled without approximation.

With p the filtered signal and v its rate, dp/dt = v, dv/dt = w^2 (q - p) - 2 w v. Between samples q is taken to be
linear (first-order hold), so that with d = q_k - q_{k-1} and x = (p, v)

    x_k = F x_{k-1} + Gamma q_{k-1} + H d,   F = exp(A T), Gamma = (1 - F_11, -F_21)^T.

The state that is kept is the lag l = q - p and v. They obey

    l_k = F_11 l - F_12 v + (1 - H_1) d,    v_k = -F_21 l + F_22 v + H_2 d,

in which q enters only by its differences: single precision loses nothing.
"""

from dataclasses import replace
from math import pi

import casadi as ca

from synth.analyse import discretise
from synth.block import Block, Constant, Exprs, State, Step, build
from synth.errors import SignalError
from synth.signals import Signal, dimension
from synth.timing import Discrete


def block(name: str, time: Discrete, signal: Signal, rate: Signal, bandwidth: float) -> Block:
    """Return the filter from `signal` to its `rate` with w = `bandwidth` in rad/s.

    It starts without a jump: while the input ``ready`` is 0 the lag and the rate stay 0. The signals' ranges bound the
    kept states; a lag is bounded by the width of the signal's range.

    Raises SignalError when the bandwidth is not positive or not below the Nyquist frequency, or when the unit of the
    rate is not the signal's per second.
    """
    if dimension(rate.unit) != dimension(f"{signal.unit}/s"):
        raise SignalError(f"the rate '{rate.name}' of '{signal.name}' is in {rate.unit}: it must be in {signal.unit}/s")
    nyquist = pi / time.period_s
    if not 0 < bandwidth < nyquist:
        raise SignalError(f"the filter's bandwidth is {bandwidth} rad/s: it must lie between 0 and {nyquist:.6g} rad/s")
    w = bandwidth
    hold = discretise.first_order_hold([[0.0, 1.0], [-w * w, -2 * w]], [[0.0], [w * w]], time.period_s)
    source = f"D(s) = s w^2/(s+w)^2, w = {w:g} rad/s, first-order hold"
    F, H = hold.F, hold.H
    values = {"f11": F[0, 0], "f12": F[0, 1], "f21": F[1, 0], "f22": F[1, 1], "g1": 1 - H[0, 0], "g2": H[1, 0]}
    units = {"f11": "1", "f12": "s", "f21": "1/s", "f22": "1", "g1": "1", "g2": "1/s"}

    def law(u: Exprs, x: Exprs, k: Exprs) -> Step:
        q, l, v, started = u[signal.name], x["lag"], x["v"], u["ready"]
        d = q - x["q_prev"]
        lag_k = ca.if_else(started, k["f11"] * l - k["f12"] * v + k["g1"] * d, 0)
        v_k = ca.if_else(started, k["f22"] * v - k["f21"] * l + k["g2"] * d, 0)
        return Step({rate.name: v_k}, {"q_prev": q, "lag": lag_k, "v": v_k})

    width = signal.high - signal.low
    states = [
        State(replace(signal, name="q_prev", about="signal one sample ago"), min(max(0.0, signal.low), signal.high)),
        State(replace(signal, name="lag", low=-width, high=width, about="signal less filtered signal"), 0),
        State(replace(rate, name="v", about="filtered rate"), 0),
    ]
    return build(
        name,
        time,
        law,
        inputs=[signal, Signal("ready", "1", 0, 1, "every measurement was good at once")],
        outputs=[rate],
        states=states,
        constants=[Constant(n, float(value), units[n], source) for n, value in values.items()],
        tag="derivative filter",
    )
