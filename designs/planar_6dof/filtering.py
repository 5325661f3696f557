"""Steady-state Kalman filters of the raw positions: one per axis, three states, driven by white jerk.

    q_n+1 = A q_n + Gamma w_n,   y_n = C q_n + v_n      q = (position, velocity, acceleration)      (10)-(12)

        [ 1  T  T^2/2 ]            [ T^3/6 ]
    A = [ 0  1    T   ],   Gamma = [ T^2/2 ],   C = [ 1  0  0 ],   E w^2 = 100, 100, 1e5 (13),   E v^2 = (5e-5)^2
        [ 0  0    1   ]            [   T   ]

    e = y - C q_predicted,   q = q_predicted + K e,   q_predicted <- A q        K = P C' (C P C' + R)^-1 (16)

P is the steady-state covariance of the prediction. It solves the Riccati equation, whose recursion alternates (14) with
the update P <- (I - K C) P. The paper prints (14) alone, under which P grows without bound, K tends to 1 and nothing is
filtered. R is taken as (5e-5 m)^2, for the yaw as (5e-5 rad)^2.

The states (p, s, h) = (position, T velocity, T^2/2 acceleration) are predictions in units of position. The prediction
then needs no products:

    x = p + k_p e,   v = s + k_s e,   a = h + k_h e,     p <- x + (v + a),   s <- (v + a) + a,   h <- a

x is the output. A filter that is not `ready`, or faster than FASTEST, |v + a| + |a| > FASTEST T, restarts at rest at
the raw position. So s and h are bounded, and p is within its range P for every raw position in its range R:
(1 - k_p) P + k_p R + FASTEST T <= P. The position covers the whole travel: single precision then differs from double by
at most 0.04 um over 1e5 samples, a thousandth of the noise. The lead-lag controller works behind these filters; the LQG
controller cannot, and has none.

Source: Yu, Kim, section 3.2, (6)-(16).
"""

from dataclasses import replace
from functools import cache, partial

import casadi as ca
import numpy as np

from designs.planar_6dof.sensing import sections as sensing
from synth.block import Block, Constant, Exprs, State, Step, build, clip
from synth.law import label
from synth.statespace import StateSpace, readonly
from synth.synthesise.observers import kalman
from synth.timing import Discrete

AXES = ("x", "y", "phi")
JERK = {"x": 100.0, "y": 100.0, "phi": 1e5}  # (m/s^3)^2, (rad/s^3)^2: E w^2, (13)
DEVIATION = 5e-5  # m, rad: of a raw position, after (9)
FASTEST = {"x": 4.0, "y": 4.0, "phi": 7.0}  # m/s, rad/s: change of the velocity in a sample included
MARGIN = 1 + 1e-5  # of a state's range over its bound, more than rounding
STATES = ("position", "velocity", "acceleration")


def model(axis: str, time: Discrete) -> StateSpace:
    """Return the model (11), (12) of an axis, from ``jerk`` to ``<axis>_raw``."""
    T, unit = time.period_s, sensing.RAW[axis].unit
    A = readonly(np.array([[1, T, T * T / 2], [0, 1, T], [0, 0, 1]]))
    Gamma = readonly([[T * T * T / 6], [T * T / 2], [T]])
    units = {name: f"{unit}{per}" for name, per in zip(STATES, ("", "/s", "/s^2"), strict=True)}
    units |= {"jerk": f"{unit}/s^3", f"{axis}_raw": unit}
    C, D = readonly([[1, 0, 0]]), readonly([[0]])
    return StateSpace(A, Gamma, C, D, STATES, ("jerk",), (f"{axis}_raw",), time, units)


@cache
def estimator(axis: str, time: Discrete) -> kalman.Estimator:
    """Return the steady-state filter of an axis, exact."""
    noise = {f"{axis}_raw": DEVIATION * DEVIATION}
    return kalman.discrete(model(axis, time), {"jerk": JERK[axis]}, noise, ("jerk",))


def block(axis: str, time: Discrete) -> Block:
    """Return the Block ``filter_<axis>`` from ``<axis>_raw`` and ``ready`` to the filtered and the predicted axis.

    The prediction is a state, so it does not depend on an input of the same sample.
    """
    raw, predicted, T = sensing.RAW[axis], sensing.PREDICTED[axis], time.period_s  # |x| <= max(|raw|, |p|)
    fastest = FASTEST[axis] * T
    gain = estimator(axis, time).M[:, 0] * np.array([1, T, T * T / 2])
    constants = [
        Constant(f"k_{n}", float(v), "1", f"(16), steady: gain on the {what}, in units of position")
        for n, v, what in zip("psh", gain, STATES, strict=True)
    ]

    def law(u: Exprs, x: Exprs, k: Exprs) -> Step:
        e = u[raw.name] - x["p"]
        now, v, a = (x[n] + k[f"k_{n}"] * e for n in "psh")
        prediction = {"p": now + (v + a), "s": (v + a) + a, "h": a}
        limited = [(s, clip(prediction[n], s)) for n, s in limits.items()]
        in_bounds = ca.logic_and(u["ready"], ca.fabs(v + a) + ca.fabs(a) <= fastest)
        restart = {"p": u[raw.name], "s": ca.SX(0), "h": ca.SX(0)}
        next = {n: ca.if_else(in_bounds, value, restart[n]) for n, (_, value) in zip("psh", limited, strict=True)}
        output = {axis: ca.if_else(in_bounds, now, u[raw.name]), predicted.name: x["p"]}
        bound = Constant("fastest", fastest, predicted.unit, "T times the speed beyond which the filter restarts")
        label(e=e, now=now, a=a, next_v=v + a, in_bounds=in_bounds, estimate=output[axis])
        return Step(output, next, limited, certified, [bound])

    about = {"p": "predicted position", "s": "predicted velocity times T", "h": "predicted acceleration times T^2/2"}
    ranges = {"p": predicted.high, "s": MARGIN * fastest, "h": MARGIN * fastest}
    shown = {n: replace(predicted, name=n, low=-ranges[n], high=ranges[n], about=what) for n, what in about.items()}
    limits = {n: replace(s, name=f"prediction_{n}") for n, s in shown.items()}
    largest = (1 - gain[0]) * predicted.high + gain[0] * raw.high + fastest
    bounds = {"p": largest, "s": fastest, "h": fastest}
    certified = {limits[n].name: partial(_with_rounding, bound) for n, bound in bounds.items()}
    states = [State(s, 0.0) for s in shown.values()]
    inputs, outputs = [raw, sensing.READY], [replace(predicted, name=axis, about="filtered"), predicted]
    name, tag = f"filter_{axis}", "Kalman filter, (6)-(16)"
    return build(name, time, law, inputs=inputs, outputs=outputs, states=states, constants=constants, tag=tag)


def _with_rounding(bound: float, u: float, e: float) -> float:
    return bound * (1 + 16 * u)


def blocks(time: Discrete) -> list[Block]:
    """Return the filters of x, y and phi."""
    return [block(axis, time) for axis in AXES]
