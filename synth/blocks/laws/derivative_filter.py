"""Filtered derivative: the critically damped filter D(s) = s w^2 / (s + w)^2 under a first-order hold (`c2d`, 'foh').

With p the filtered signal and v its rate, dp/dt = v, dv/dt = w^2 (q - p) - 2 w v. Between samples q is assumed to be
linear (first-order hold). With d = q_k - q_{k-1} and x = (p, v) this gives

    x_k = F x_{k-1} + Gamma q_{k-1} + H d,   F = exp(A T), Gamma = (1 - F_11, -F_21)^T.

Both poles lie at lambda = exp(-w T). From the differences d to v this is the cascade

    s_k = lambda s_{k-1} + d_k,    r_k = lambda r_{k-1} + s_k + rho s_{k-1},    v_k = H_2 r_k

with rho H_2 = -(H_2 F_11 + F_21 (1 - H_1)). q enters only by its differences, so single precision loses no digits to
its offset. By induction |s| <= max|d| / (1 - lambda) and |v| <= max|d| / T, so no state needs a limit.
"""

from dataclasses import replace
from math import pi

import casadi as ca

from synth import arguments
from synth.analyse import discretise
from synth.block import Block, Constant, Exprs, State, Step, build
from synth.errors import SignalError
from synth.law import label
from synth.signals import Signal, dimension
from synth.timing import Discrete

SLACK = 1e-4  # relative margin of a state's bound for rounding in single precision


@arguments.checked
def block(name: str, time: Discrete, signal: Signal, rate: Signal, bandwidth: float) -> Block:
    """Return the filter from `signal` to its `rate` with w = `bandwidth` in rad/s.

    The rate stays 0 until the input ``ready`` is 1, so it starts without a jump. The width of the signal's range bounds
    the states.

    Raises SignalError when the bandwidth is not positive or not below the Nyquist frequency, or when the unit of the
    rate is not the signal's per second.
    """
    if dimension(rate.unit) != dimension(f"{signal.unit}/s"):
        raise SignalError(f"the rate '{rate.name}' of '{signal.name}' is in {rate.unit}: it must be in {signal.unit}/s")
    nyquist = pi / time.period_s
    if not 0 < bandwidth < nyquist:
        raise SignalError(f"the filter's bandwidth is {bandwidth} rad/s: it must lie between 0 and {nyquist:.6g} rad/s")
    w, T = bandwidth, time.period_s
    hold = discretise.first_order_hold([[0.0, 1.0], [-w * w, -2 * w]], [[0.0], [w * w]], T)
    F, H = hold.F, hold.H
    fade = F[0, 0] / (1 + w * T)  # F_11 = (1 + w T) exp(-w T)
    values = {"fade": fade, "rho": -F[0, 0] - F[1, 0] * (1 - H[0, 0]) / H[1, 0], "h": H[1, 0]}

    def law(u: Exprs, x: Exprs, k: Exprs) -> Step:
        q = u[signal.name]
        d = ca.if_else(u["ready"], q - x["q_prev"], 0)
        s = k["fade"] * x["s"] + d
        r = k["fade"] * x["r"] + s + k["rho"] * x["s"]
        label(d=d)
        return Step(
            {rate.name: k["h"] * r},
            {"q_prev": q, "s": s, "r": r},
            notes=[f"{rate.name} = h * r_next with h = {values['h']:.6g} 1/s; a gain on it is printed times h."],
        )

    width = signal.high - signal.low
    faded, fastest = (1 + SLACK) * width / (1 - fade), (1 + 2 * SLACK) * width / (T * H[1, 0])
    states = [
        State(replace(signal, name="q_prev", about="signal one sample ago"), min(max(0.0, signal.low), signal.high)),
        State(replace(signal, name="s", low=-faded, high=faded, about="fading sum of the differences"), 0),
        State(replace(signal, name="r", low=-fastest, high=fastest, about="filtered rate over h"), 0),
    ]
    source = f"D(s) = s w^2/(s+w)^2, w = {w:g} rad/s, first-order hold"
    units = {"fade": "1", "rho": "1", "h": "1/s"}
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
