"""Reduced-order LQG regulators of the planar positioner at 800 Hz, Y(26)-(49), as Blocks (MATLAB `lqrd`).

The model is (26) with the integrators of (31): states (x y phi z1 z2 z3 d f v), inputs u = (i_AQ, i_BQ, i_CQ), and K of
(49) by lqrd. The relation

        f_x = k i_C,   f_y = k (i_A + i_B),   m_phi = k a (i_B - i_A),   k = 13.2547 M

turns the currents into forces, for which the allocation also compensates the yaw torque of motor C that (26) neglects.
In these forces K decouples into three axes q'' = b f, with f divided by its scale in `allocation`, in A. Each
axis knows f1, the achieved demand of the sample before, which acts until the next sample. It estimates the rate alone,
with L = (1 - p) / T:

        v^  = x3 + L q,                     x3+ = F x3 + G q + H f1                                        (33), (35)
        q1  = q + T v^ + b T^2/2 f1,        v1  = v^ + b T f1           predictions for the time when f acts
        w   = k1 (q - q1) - k2 v1,          f = w + k (r - q) + I            k = k1 + k3 T
        I+  = (1 - g) I + g (f_a - w),      f1+ = f_a                        g = k3 T / k

f_a is the demand that the motors achieve. While f_a = f this is I+ = I + k3 T (r - q) and f = k1 (r - q1) - k2 v1 + I+.
At a limit I follows f_a with the time constant T/g of some 20 ms (anti-windup). An error is clipped to ERROR, and the
integral then decays: the axis moves at k ERROR / (k1 T + k2), a speed from which the motors can stop it. Until every
measurement has been good once, the platen is assumed to be at rest. The choices of prediction, p and ERROR:
docs/decisions/planar_lqg.md.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cache

import casadi as ca
import numpy as np

from designs.planar_6dof import allocation, interface, motion, vertical
from designs.planar_6dof.allocation import HORIZONTAL
from designs.planar_6dof.sensing.sections import READY
from designs.planar_6dof.vertical import MARGIN, POSITIONS, REFERENCES, Variant
from synth.analyse import discretise
from synth.block import Block, Constant, Exprs, State, Step, build
from synth.blocks.guard import following
from synth.law import label
from synth.plant import Plant
from synth.signals import Signal
from synth.statespace import Array, StateSpace, readonly
from synth.synthesise.feedback import lqr
from synth.synthesise.observers import reduced_observer
from synth.timing import Continuous, Discrete

NAME = "planar_6dof_lqg"
TIME = Discrete(1 / 800)
STATES = ("x", "y", "phi", "z1", "z2", "z3", "d", "f", "v")
CURRENTS = ("i_AQ", "i_BQ", "i_CQ")
PER_AMPERE, YAW_PER_AMPERE = 13.2547, 117.15  # m/s^2/A, rad/s^2/A, (26)
WEIGHTS = (1e4, 1e3, 1e3, 1e10, 1e9, 1e10, 1e2, 1e1, 2e1)  # reproduces (49) in all its digits
PRINTED_WEIGHTS = (1e3, 1e4, 1e3, 1e9, 1e8, 1e8, 1e2, 1e2, 1e2)  # (47), which does not
OBSERVER_POLE = {"x": 0.7, "y": 0.7, "phi": 0.9}
BANDWIDTH = {"x": 48.0, "y": 48.0, "phi": 12.0, "force": 30.0}  # rad/s, of the prediction
RATES = {"x": "d", "y": "f", "phi": "v"}
ERROR = {"x": 1.5e-3, "y": 4e-3}  # m: a larger one counts as this one
LATE = {"x": 27, "y": 28}  # bits of the fault word: an error is beyond ERROR
DECAYS = (
    "While the error of x or y is limited to largest_error the axis moves at a constant speed, and its integral only "
    "decays: the integral of a ramp is a velocity, with which the axis would go on when the set-point turns back."
)
Regulate = Callable[[Plant, "Axis"], Block]
MEASURED = {axis: replace(POSITIONS[axis], name=f"{axis}_raw", about="as measured") for axis in HORIZONTAL}


@dataclass(frozen=True)
class Axis:
    """One axis q'' = b d with its gains in A: d = k1 (r - q) - k2 q' + k3 sum (r - q)."""

    name: str
    b: float
    k1: float
    k2: float
    k3: float


def model(per_ampere: float = PER_AMPERE, yaw_per_ampere: float = YAW_PER_AMPERE, integrals: bool = True) -> StateSpace:
    """Return (31), (32) with the currents as inputs, or (26), (27) without `integrals`."""
    A, B = np.zeros((9, 9)), np.zeros((9, 3))
    A[:3, 6:], A[3:6, :3] = np.eye(3), np.eye(3)
    B[6, 2] = B[7, 0] = B[7, 1] = per_ampere
    B[8, 0], B[8, 1] = -yaw_per_ampere, yaw_per_ampere
    units = dict(zip(STATES, ("m", "m", "rad", "m s", "m s", "rad s", "m/s", "m/s", "rad/s"), strict=True))
    units |= dict.fromkeys(CURRENTS, "A")
    keep = [i for i in range(9) if integrals or i not in (3, 4, 5)]
    A, B, C, states = A[np.ix_(keep, keep)], B[keep], np.eye(3, 9)[:, keep], tuple(STATES[i] for i in keep)
    return StateSpace(A, B, C, np.zeros((3, 3)), states, CURRENTS, STATES[:3], Continuous(), units)


@cache
def gain(weights: Sequence[float] = WEIGHTS) -> lqr.Gain:
    """Return K of (49), u = K x, for the diagonal of Q and R = I at 800 Hz."""
    return lqr.lqrd(model(), weights, np.eye(3), TIME.period_s)


def demand_gain(plant: Plant) -> Array:
    """Return K (3, 9) of the demands f_x, f_y in N and m_phi in N m, by the states of (31)."""
    k, a, K = PER_AMPERE * plant.parameter("M").value, plant.parameter("a").value, gain().K
    return readonly([k * K[2], k * (K[0] + K[1]), k * a * (K[1] - K[0])])


def axes(plant: Plant) -> tuple[Axis, ...]:
    """Return x, y and phi with their gains from positions to demands."""
    k, a, scales = PER_AMPERE * plant.parameter("M").value, plant.parameter("a").value, allocation.scales(plant)
    acceleration = {"x": PER_AMPERE / k, "y": PER_AMPERE / k, "phi": YAW_PER_AMPERE / (k * a)}
    rows = []
    for i, (name, row) in enumerate(zip(HORIZONTAL, -demand_gain(plant), strict=True)):
        k1, k2, k3 = (row[[i, 6 + i, 3 + i]] / scales[name]).tolist()
        rows.append(Axis(name, acceleration[name] * scales[name], k1, k2, k3 * TIME.period_s))
    return tuple(rows)


def fastest(axis: Axis) -> float:
    """Return the speed in m/s at which the axis moves while its error is limited: with no force and no integral."""
    return (axis.k1 + axis.k3) * ERROR[axis.name] / (axis.k1 * TIME.period_s + axis.k2)


def continuous(axis: Axis) -> StateSpace:
    """Return q'' = b f with the states q and its rate."""
    demand, rate, unit = vertical.DEMAND[axis.name], RATES[axis.name], POSITIONS[axis.name].unit
    A, B = np.eye(2, k=1), readonly([[0.0], [axis.b]])
    units, states = {axis.name: unit, rate: f"{unit}/s", demand.name: demand.unit}, (axis.name, rate)
    return StateSpace(A, B, np.eye(1, 2), np.zeros((1, 1)), states, (demand.name,), states[:1], Continuous(), units)


def observer(axis: Axis, pole: float | None = None) -> reduced_observer.ReducedObserver:
    """Return the observer of the rate with L = (1 - p) / T."""
    p = OBSERVER_POLE[axis.name] if pole is None else pole
    held = discretise.zero_order_hold(continuous(axis), TIME.period_s)
    return reduced_observer.from_gain(held, axis.name, [[(1 - p) / TIME.period_s]])


def reduced_order(plant: Plant, axis: Axis) -> Block:
    """Return the regulator of one axis with a reduced-order observer of its rate; x3 is in units of demand."""
    observed, T = observer(axis), TIME.period_s
    q, f1 = MEASURED[axis.name], allocation.achievable_bound(plant)[axis.name]
    rate_gain, achieved_gain = axis.k1 * T + axis.k2, axis.b * T * (axis.k1 * T / 2 + axis.k2)
    F, G, H, L = float(observed.F[0, 0]), *(rate_gain * float(m[0, 0]) for m in (observed.G, observed.H, observed.L))
    x3 = MARGIN * (abs(G) * q.high + abs(H) * f1) / (1 - abs(F))
    per, per_ampere = per_position(axis.name), f"the acceleration of {axis.b:.6g} {POSITIONS[axis.name].unit}/s^2 per A"
    constants = [
        Constant("achieved_gain", achieved_gain, "1", f"(49): T (k1 T / 2 + k2) times {per_ampere}"),
        Constant("L", L, per, "(33): (k1 T + k2) L, L = (1 - p) / T"),
        Constant("F", F, "1", "(35): A22 - L A12"),
        Constant("G", G, per, "(33): (k1 T + k2) (F L + A21 - L A11)"),
        Constant("H", H, "1", "(33): (k1 T + k2) (B2 - L B1)"),
    ]

    def estimate(u: Exprs, x: Exprs, k: Exprs) -> tuple[ca.SX, dict[str, ca.SX]]:
        seen = k["L"] * u[q.name]
        now = ca.if_else(u[READY.name], x["x3"], -seen)
        after = k["F"] * now + k["G"] * u[q.name] + k["H"] * x["achieved"]
        estimated = now + seen + k["achieved_gain"] * x["achieved"]
        label(now=now, seen=seen, estimated=estimated)
        return -estimated, {"x3": after}

    unit = vertical.DEMAND[axis.name].unit
    state = State(Signal("x3", unit, -x3, x3, "estimated rate less L times the position, as a demand"), 0.0)
    return regulator(plant, axis, estimate, [state], constants, x3 + L * q.high + achieved_gain * f1)


Estimate = Callable[[Exprs, Exprs, Exprs], tuple[ca.SX, dict[str, ca.SX]]]


def regulator(
    plant: Plant, axis: Axis, estimate: Estimate, states: list[State], constants: list[Constant], most: float
) -> Block:
    """Return the regulator of one axis for `estimate(u, x, k) -> (w, next states)`, where |w| <= `most`.

    The states get the integral and the achieved demand, which acts until the next sample, in addition.
    """
    q, r = MEASURED[axis.name], REFERENCES[axis.name]
    demand_signal, achieved = vertical.DEMAND[axis.name], vertical.ACHIEVED_DEMAND[axis.name]
    acting = motion.acting(plant, axis.name)
    k, f1 = axis.k1 + axis.k3, allocation.achievable_bound(plant)[axis.name]
    integral, g = MARGIN * (most + f1), axis.k3 / k
    largest_error = ERROR.get(axis.name)
    numbers = (
        [Constant("largest_error", largest_error, q.unit, "a larger error counts as this")] if largest_error else []
    )

    notes = [DECAYS] if axis.name == next(iter(ERROR)) else []

    def law(u: Exprs, x: Exprs, c: Exprs) -> Step:
        w, after = estimate(u, x, c)
        error = u[r.name] - u[q.name]
        decayed = c["integral_decay"] * x["integral"]
        integral = decayed + c["integral_input"] * (u[achieved.name] - w)
        if most := ERROR.get(axis.name):
            is_small = ca.fabs(error) <= most
            error = ca.if_else(is_small, error, ca.if_else(error < 0, -most, most))
            integral = ca.if_else(is_small, integral, decayed)
        demand = c["error_gain"] * error + (w + x["integral"])
        next = after | {"integral": integral, "achieved": u[achieved.name]}
        label(w=w, error=error, after=after, decayed=decayed, demand=demand)
        return Step({demand_signal.name: demand, acting.name: x["achieved"]}, next, numbers=numbers, notes=notes)

    all_constants = [
        Constant("error_gain", k, per_position(axis.name), "(49): k1 + k3 T"),
        Constant("integral_decay", 1 - g, "1", "(49): 1 - k3 T / (k1 + k3 T)"),
        Constant("integral_input", g, "1", "(49): k3 T / (k1 + k3 T)"),
        *constants,
    ]
    all_states = [
        *states,
        State(Signal("integral", demand_signal.unit, -integral, integral, "integral of the error"), 0.0),
        State(
            Signal("achieved", demand_signal.unit, -f1, f1, "achieved demand, which acts until the next sample"), 0.0
        ),
    ]
    inputs, outputs = [q, r, achieved, READY], [demand_signal, acting]
    tag, name = "reduced-order LQG, (28)-(35), (49)", f"lqg_{axis.name}"
    return build(name, TIME, law, inputs=inputs, outputs=outputs, states=all_states, constants=all_constants, tag=tag)


def per_position(axis: str) -> str:
    """Return the unit of a demand over a position."""
    return f"{vertical.DEMAND[axis].unit}/{POSITIONS[axis].unit}"


def law(plant: Plant, variant: Variant = "shipped", regulate: Regulate = reduced_order) -> list[Block]:
    """Return the Blocks from positions and held set-points to computed phase currents."""
    upright = [vertical.block(plant, axis, K, TIME) for axis, K in vertical.loops(TIME, variant).items()]
    motors = (make(plant, TIME, MEASURED["phi"]) for make in (allocation.allocation, allocation.commutation))
    return [*(regulate(plant, axis) for axis in axes(plant)), *upright, *motors]


def sensing_blocks(plant: Plant) -> list[Block]:
    """Return the Blocks from Hall voltages and acting demands to measured positions and their predictions."""
    return motion.sensing_blocks(plant, TIME, BANDWIDTH)


def controller(plant: Plant, variant: Variant = "shipped", regulate: Regulate = reduced_order) -> Block:
    """Return the whole controller, from Hall voltages, distances and set-points to the motors' phase currents."""
    limited = [following.Axis(MEASURED[axis], REFERENCES[axis], most, LATE[axis]) for axis, most in ERROR.items()]
    x, y = (fastest(axis) for axis in axes(plant) if axis.name in ERROR)
    slow = f"With sound sensors the law moves x at {x:.3f} m/s and y at {y:.2f} m/s at most, by largest_error."
    whole = motion.add_braking(plant, TIME, law(plant, variant, regulate), BANDWIDTH, [slow])
    blocks = [*whole, following.block(TIME, limited)]
    return interface.controller(NAME, plant, TIME, sensing_blocks(plant), blocks, interface.BRAKED)
