"""The LQG controller on full-order Kalman filters, Y(36)-(46): the reduced order's saving is counted against it.

x^ = x- + M (q - x-),    x-+ = A x^ + B f    position and rate of one axis, white acceleration of PROCESS_NOISE
"""

from collections.abc import Mapping
from dataclasses import replace
from typing import Literal

import casadi as ca

from designs.planar_6dof import lqg, vertical
from designs.planar_6dof.lqg import MEASURED, TIME, Axis, Regulate
from models.hall_sections import READY
from synth.block import Block, Constant, Exprs, State
from synth.plant import Plant
from synth.signals import Signal
from synth.synthesise.observers import kalman

NOISE = {"x": 5e-5, "y": 5e-5, "phi": 1e-3}  # m, rad, of a sample: (9) and (46), that of phi is not printed
PROCESS_NOISE = {"x": 0.3, "y": 0.3, "phi": 3.0}  # m^2/s^3, rad^2/s^3: densities of acceleration
FASTEST = 20.0  # m/s, rad/s, of an estimate
Order = Literal["reduced", "full"]


def estimator(axis: Axis) -> kalman.Estimator:
    """Return the full-order filter of position and rate, pushed by white acceleration."""
    W, V = [PROCESS_NOISE[axis.name]], [NOISE[axis.name] ** 2]
    return kalman.sampled(lqg.continuous(axis), W, V, TIME.period_s, G=[[0.0], [1.0]], exact=True)


def full_order(plant: Plant, axis: Axis) -> Block:
    """Return the regulator of one axis on the Kalman filter of its position and rate."""
    kalman_filter, T, q = estimator(axis), TIME.period_s, MEASURED[axis.name]
    per, force = lqg.per_position(axis.name), vertical.DEMAND[axis.name].unit.replace(" ", "/")
    constants = [
        Constant("on_position", axis.k1, per, "(49): k1"),
        Constant("on_rate", axis.k2, f"{per} s", "(49): k2"),
        Constant("into_position", float(kalman_filter.M[0, 0]), "1", "(40): M"),
        Constant("into_rate", float(kalman_filter.M[1, 0]), "1/s", "(40): M"),
        Constant("period", T, "s", "T"),
        Constant("moved", axis.b * T**2 / 2, f"{q.unit}/{force}", "b T^2 / 2"),
        Constant("sped", axis.b * T, f"{q.unit}/s/{force}", "b T"),
    ]

    def estimate(u: Exprs, x: Exprs, k: Exprs) -> tuple[ca.SX, dict[str, ca.SX]]:
        surprise = ca.if_else(u[READY.name], u[q.name] - x["position"], 0)
        rate = x["rate"] + k["into_rate"] * surprise
        before = ca.if_else(u[READY.name], x["position"], u[q.name])
        position = before + k["into_position"] * surprise + k["period"] * rate + k["moved"] * x["force"]
        after = {"position": position, "rate": rate + k["sped"] * x["force"]}
        return k["on_position"] * (u[q.name] - position) - k["on_rate"] * after["rate"], after

    expected = [Signal("position", q.unit, q.low, q.high), Signal("rate", f"{q.unit}/s", -FASTEST, FASTEST)]
    states = [State(replace(s, about="expected at this sample"), 0.0) for s in expected]
    most = axis.k1 * 4 * q.high + axis.k2 * (FASTEST + 2 * float(kalman_filter.M[1, 0]) * q.high)
    return lqg.regulator(plant, axis, estimate, states, constants, 1.1 * most)


REGULATORS: Mapping[Order, Regulate] = {"reduced": lqg.reduced_order, "full": full_order}
