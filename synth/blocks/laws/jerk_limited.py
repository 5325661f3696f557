"""Jerk-limited motion to a target that may change at any time (S-curve; Simulink Trapezoidal Velocity Profile, Ruckig).

    minimise the time to rest at the target,   |v| <= V, |a| <= A, |j| <= J,   j constant in each sample of length T

    a+ = a + j T,    v+ = v + (a + a+) T / 2,    p+ = p + v T + (2 a + a+) T^2 / 6                       exactly

In each sample a+ is the largest acceleration towards the target from which the motion can still stop at it. With
S(v, a) the displacement of the fastest stop and the remaining distance r = target - p, that is r+ >= S(v+, a+), which
decreases as a+ grows and is solved by bisection. The fastest stop takes a to -a_p, holds it, and takes it to 0:

    a_p = min(A, sqrt(J v + a^2 / 2)),   t_1 = (a + a_p) / J,   t_2 = (J v + a^2 / 2 - a_p^2) / (J A),   t_3 = a_p / J

for v + a |a| / 2 J >= 0, and the same mirrored for < 0. From rest to rest this is the profile of seven segments, of
five or four where a limit is not reached, to within the sampling. The velocity reaches its limit in whole samples:
y = (V - v) / J T^2 allows the acceleration alpha+ J T with y - (alpha + alpha+) / 2 >= phi(alpha+), where phi is the
change of velocity, in J T^2, in which alpha+ falls to 0 by at most 1 a sample; it is n^2/2 at each whole n and linear
between them (Zanasi, Lo Bianco, Tonielli 2000).
"""

import casadi as ca
import numpy as np

from synth import arguments
from synth.block import Block, Constant, Exprs, State, Step, build, clip
from synth.errors import SignalError
from synth.signals import Signal, dimension, per_second, quotient_unit
from synth.timing import Discrete

HALVINGS = 10  # of the interval of a+: 1/1000 of the jerk
MARGIN = 1e-3  # of the ranges of states, for rounding in single precision


@arguments.checked
def block(
    name: str,
    time: Discrete,
    target: Signal,
    measured: Signal,
    *,
    velocity: float,
    acceleration: float,
    jerk: float,
) -> Block:
    """Return the Block from the `target` to ``<name>_position``, ``<name>_velocity`` and ``<name>_acceleration``.

    The limits are in the target's unit per s, s^2 and s^3. Until the input ``ready`` is 1 the position is the
    `measured` one, at rest, so that the first motion starts where the machine stands. A target that changes on the way
    is followed from the velocity and acceleration of that moment. Jerks change at samples alone, so a move may pass its
    target by 6 J T^3, or 0.4 J T^3 where the jerk needs ten samples or more for the acceleration; its last step, which
    ends at rest at the target, is at most J T^3 long.

    Raises SignalError for a limit that is not positive, for an acceleration that the jerk reaches within a sample or a
    velocity that the acceleration reaches within one, and for a measured position in another unit.
    """
    T, limits = time.period_s, {"velocity": velocity, "acceleration": acceleration, "jerk": jerk}
    for quantity, value in limits.items():
        if not 0 < value < np.inf:
            raise SignalError(f"the limit of the {quantity} of '{name}' is {value}: give a finite number above 0")
    for quantity, faster in (("acceleration", "jerk"), ("velocity", "acceleration")):
        if limits[faster] * T > limits[quantity]:
            raise SignalError(
                f"'{name}': the {faster} {limits[faster]:g} reaches the {quantity} {limits[quantity]:g} within a "
                f"sample of {T:g} s: give at most {limits[quantity] / T:g}, or a shorter period"
            )
    if dimension(measured.unit) != dimension(target.unit):
        raise SignalError(
            f"'{measured.name}' is in {measured.unit} and '{target.name}' in {target.unit}: give both one unit"
        )
    units = [target.unit]
    for _ in range(3):
        units.append(per_second(units[-1]))
    A, J = acceleration, jerk
    values = {
        "V": (velocity, units[1], "limit of the velocity"),
        "A": (A, units[2], "limit of the acceleration"),
        "J": (J, units[3], "limit of the jerk"),
        "T": (T, "s", "period"),
        "JT": (J * T, units[2], "largest change of the acceleration in a sample"),
        "per_J": (1 / J, quotient_unit("1", units[3]), "1 / J"),
    }
    constants = [Constant(n, v, unit, source) for n, (v, unit, source) in values.items()]

    def stop(v: ca.SX, a: ca.SX, k: Exprs) -> ca.SX:
        """Return the displacement of the fastest stop."""
        sign = ca.if_else(v + a * ca.fabs(a) * (0.5 * k["per_J"]) >= 0, 1, -1)
        v, a = sign * v, sign * a
        energy = ca.fmax(k["J"] * v + 0.5 * a * a, 0)
        peak = ca.fmin(ca.sqrt(energy), k["A"])
        hold = (energy - peak * peak) * k["per_J"] / k["A"]
        t, last = (a + peak) * k["per_J"], 0.5 * peak * peak * k["per_J"]
        first = t * (v + t * (0.5 * a - k["J"] / 6 * t))
        return sign * (first + hold * (last + 0.5 * peak * hold) + last * peak * k["per_J"] / 3)

    def most(y: ca.SX) -> ca.SX:
        """Return the acceleration alpha+ in J T for which y is left."""
        m = ca.fabs(y)
        n = ca.floor(0.5 * (ca.sqrt(1 + 8 * m) - 1))
        alpha = n + (m - 0.5 * n * (n + 1)) / (n + 1)
        return ca.if_else(y >= 0, alpha, -alpha)

    def law(u: Exprs, x: Exprs, k: Exprs) -> Step:
        goal, v, a = u[target.name], x["rate"], x["change"]
        start = ca.if_else(u["ready"], x["goal"] - x["left"], u[measured.name])
        left = ca.if_else(u["ready"], x["left"] + (goal - x["goal"]), goal - u[measured.name])
        T, JT = k["T"], k["JT"]

        def after(new: ca.SX) -> tuple[ca.SX, ca.SX]:
            return left - T * (v + T / 6 * (2 * a + new)), v + 0.5 * T * (a + new)

        def slack(new: ca.SX) -> ca.SX:
            distance, rate = after(new)
            return distance - stop(rate, new, k)

        above, below = ((end - v) / (JT * T) - 0.5 * a / JT for end in (k["V"], -k["V"]))
        high = ca.fmax(ca.fmin(ca.fmin(a + JT, k["A"]), JT * most(above)), a - JT)
        low = ca.fmin(ca.fmax(ca.fmax(a - JT, -k["A"]), JT * most(below)), a + JT)
        fastest = slack(high) >= 0
        for _ in range(HALVINGS):
            middle = 0.5 * (low + high)
            can_stop = slack(middle) >= 0
            low, high = ca.if_else(can_stop, middle, low), ca.if_else(can_stop, high, middle)
        new = ca.if_else(fastest, high, low)
        distance, rate = after(new)
        arrived = ca.fabs(distance) <= JT * T * T
        arrived = ca.logic_and(arrived, ca.logic_and(ca.fabs(rate) <= JT * T, ca.fabs(a) <= JT))
        rests = ca.logic_or(arrived, ca.logic_not(u["ready"]))
        return Step(
            {
                f"{name}_position": clip(start, outputs[0]),
                f"{name}_velocity": v,
                f"{name}_acceleration": a,
            },
            {
                "goal": goal,
                "left": ca.if_else(u["ready"], ca.if_else(arrived, 0, distance), left),
                "rate": ca.if_else(rests, 0, rate),
                "change": ca.if_else(rests, 0, new),
            },
        )

    low, high = min(target.low, measured.low), max(target.high, measured.high)
    width = (1 + MARGIN) * (high - low)
    v_end, a_end = ((1 + MARGIN) * limit for limit in (velocity, A))
    outputs = [
        Signal(f"{name}_position", target.unit, low, high, f"on the way to {target.name}"),
        Signal(f"{name}_velocity", units[1], -v_end, v_end, f"on the way to {target.name}"),
        Signal(f"{name}_acceleration", units[2], -a_end, a_end, f"on the way to {target.name}"),
    ]
    first = min(max(0.0, target.low), target.high)
    return build(
        name,
        time,
        law,
        inputs=[target, measured, Signal("ready", "1", 0, 1, "every measurement was good at once")],
        outputs=outputs,
        states=[
            State(Signal("goal", target.unit, target.low, target.high, "target one sample ago"), first),
            State(Signal("left", target.unit, -width, width, "distance to the target"), 0.0),
            State(Signal("rate", units[1], -v_end, v_end, "velocity"), 0.0),
            State(Signal("change", units[2], -a_end, a_end, "acceleration"), 0.0),
        ],
        constants=constants,
        tag=f"jerk-limited motion to {target.name}",
    )
