"""Jerk-limited motion to a target that may change at any time (S-curve; Simulink Trapezoidal Velocity Profile, Ruckig).

    minimise the time to rest at the target,   |v| <= V, |a| <= A, |j| <= J,   j constant in each sample of length T

    a+ = a + j T,    v+ = v + (a + a+) T / 2,    p+ = p + v T + (2 a + a+) T^2 / 6                       exactly

In each sample a+ is the largest acceleration towards the target from which the motion can still stop at it. With
S(v, a) the displacement of a stop and the remaining distance r = target - p, that is r+ >= S(v+, a+), where S grows
with a+; a target before the stop is the same, mirrored. From rest to rest this is the profile of seven segments, of
six, five or four where a limit is not reached, to within the sampling.

The stop is that of whole samples, with v, a and S in units of J T^2, J T and J T^3. With y = v + a/2 a sample is

    y+ = y + a+,    p+ = p + y + (a+ - a) / 6,    so that S = sum of all y, less a / 6

and a+ = -m(y), limited to a - 1 .. a + 1 and -A .. A, where m(y) = n + f for y = (n + 1) (n / 2 + f): from there a
falls to f by 1 a sample, then to 0, and y with it (Zanasi, Lo Bianco, Tonielli 2000). This takes k samples down to
that curve or to -A, h samples at -A, and n + 1 samples on the curve, whose y add up to

    k (y + a (k - 1) / 2 - (k^2 - 1) / 6)  +  h (y_k - A (h - 1) / 2)  +  (n + 2) (y_h / 2 - n (n + 1) / 12)

and the same mirrored where the curve lies above. The stop is itself a choice of the next sample, which leaves r - S as
it is: so r >= S holds in all samples once it holds in one, and the motion does not pass its target. Between the stop's
a+ and the limit, one chord finds a larger a+, which is taken where it keeps r+ >= S. The velocity keeps its limit by
a+ <= m(V - y), likewise.
"""

import casadi as ca
import numpy as np

from synth import arguments
from synth.block import Block, Constant, Exprs, State, Step, build, clip
from synth.errors import SignalError
from synth.law import label
from synth.signals import Signal, dimension, per_second
from synth.timing import Discrete

LEAST = 1e-6  # of J T^3: a distance that keeps a division from 0
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
    is followed from the velocity and acceleration of that moment. A move passes no target at which it can still stop;
    its last step, which ends at rest at the target, is at most J T^3 long.

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
    for _ in range(2):
        units.append(per_second(units[-1]))
    A, J = acceleration, jerk
    samples = A / (J * T)
    most_samples = np.ceil(samples) + 1
    braked = (np.floor(samples) + 1) * (samples - np.floor(samples) / 2)
    values = {
        "V": (velocity, units[1], "limit of the velocity"),
        "T": (T, "s", "period"),
        "JT": (J * T, units[2], "largest change of the acceleration in a sample"),
        "JTT": (J * T * T, units[1], "J T^2"),
        "JTTT": (J * T**3, units[0], "J T^3"),
        "samples": (samples, "1", "A / J T, of the limit A of the acceleration"),
        "braked": (braked, "1", "y from which a stop is held at -A"),
    }
    constants = [Constant(n, v, unit, source) for n, (v, unit, source) in values.items()]

    def whole(y: ca.SX) -> ca.SX:
        """Return n of a y >= 0 on the curve."""
        return ca.floor(ca.fmax(0.5 * (ca.sqrt(1 + 8 * y) - 1), 0))

    def ceil(x: ca.SX) -> ca.SX:
        """Return the samples of a duration, 0 where it is negative; of a whole one either neighbour gives one stop."""
        return ca.if_else(x > 0, ca.floor(ca.fmax(x, 0)) + 1, 0)

    def most(y: ca.SX) -> ca.SX:
        """Return the acceleration m(y) in J T."""
        size = ca.fabs(y)
        n = whole(size)
        alpha = 0.5 * n + size / (n + 1)
        return ca.if_else(y >= 0, alpha, -alpha)

    def curve(alpha: ca.SX) -> ca.SX:
        """Return y with m(y) = alpha."""
        size = ca.fabs(alpha)
        n = ca.floor(size)
        y = (n + 1) * (size - 0.5 * n)
        return ca.if_else(alpha >= 0, y, -y)

    def total(y: ca.SX, a: ca.SX, k: Exprs) -> ca.SX:
        """Return the sum of all y of a stop, from y and the acceleration a in J T."""
        A = k["samples"]
        sign = ca.if_else(y >= -curve(a), 1, -1)
        y, a = sign * y, sign * a
        rise = 1 - a
        n = ca.floor(ca.fmax(rise + most_samples, 0)) - most_samples
        down = ceil(ca.sqrt(ca.fmax(y - (n + 1) * (rise - 0.5 * n) + rise * rise, 0)) - rise)
        down = ca.if_else(y <= curve(rise), 0, ca.fmin(down, ceil(A - rise)))
        first = down * (y + 0.5 * a * (down - 1) - (down * down - 1) / 6)
        y = y + down * (a - 0.5 * (down + 1))
        hold = ceil((y - k["braked"]) / A)
        held = hold * (y - 0.5 * A * (hold - 1))
        y = y - hold * A
        size = ca.fabs(y)
        n = whole(size)
        last = (n + 2) * (0.5 * size - n * (n + 1) / 12)
        return sign * (first + held + ca.if_else(y >= 0, last, -last))

    def law(u: Exprs, x: Exprs, k: Exprs) -> Step:
        goal, v, a = u[target.name], x["rate"], x["change"]
        start = ca.if_else(u["ready"], x["goal"] - x["left"], u[measured.name])
        left = ca.if_else(u["ready"], x["left"] + (goal - x["goal"]), goal - u[measured.name])
        T, JT = k["T"], k["JT"]

        def stop(y: ca.SX, alpha: ca.SX) -> ca.SX:
            return k["JTTT"] * (total(y, alpha, k) - alpha / 6)

        y, alpha = v / k["JTT"] + 0.5 * a / JT, a / JT
        beyond = left - stop(y, alpha)
        sign = ca.if_else(beyond >= 0, 1, -1)
        y, alpha, distance = sign * y, sign * alpha, sign * left
        moved = k["JTTT"] * (y - alpha / 6)

        def slack(new: ca.SX) -> ca.SX:
            return distance - moved - k["JTTT"] / 6 * new - stop(y + new, new)

        braking = ca.fmin(ca.fmax(-most(y), alpha - 1), alpha + 1)
        braking = ca.fmax(ca.fmin(braking, k["samples"]), -k["samples"])
        fastest = ca.fmax(ca.fmin(ca.fmin(alpha + 1, k["samples"]), most(k["V"] / k["JTT"] - y)), alpha - 1)
        fastest = ca.fmax(fastest, -k["samples"])
        lacking = ca.fmax(-slack(fastest), 0)
        label(goal=goal, start=start, left=left, beyond=beyond, sign=sign, y=y, alpha=alpha, moved=moved)
        label(to_go=distance, braking=braking, fastest=fastest, lacking=lacking)
        chord = braking + (fastest - braking) * ca.fabs(beyond) / (ca.fabs(beyond) + lacking + LEAST * k["JTTT"])
        chord = ca.fmax(ca.fmin(chord, k["samples"]), -k["samples"])
        new = ca.if_else(lacking <= 0, fastest, ca.if_else(slack(chord) >= 0, chord, braking))
        new = sign * JT * new
        distance, rate = left - T * (v + T / 6 * (2 * a + new)), v + 0.5 * T * (a + new)
        arrived = ca.fabs(distance) <= k["JTTT"]
        arrived = ca.logic_and(arrived, ca.logic_and(ca.fabs(rate) <= k["JTT"], ca.fabs(a) <= JT))
        rests = ca.logic_or(arrived, ca.logic_not(u["ready"]))
        label(chord=chord, new=new, distance=distance, rate=rate, arrived=arrived, rests=rests)
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
