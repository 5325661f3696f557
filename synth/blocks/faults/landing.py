"""Controlled landing of a levitated body: ramps of the set-points and a state feedback that follows them.

From the sample on in which ``regular`` is lost for `patience` samples in a row, or too often (`safety`), the
demands w of all coordinates are

    w = -p^2 (q - r) - 2 p (v - r') + r'' - d            q, v, d: estimates of a predictive observer (`predictor`)

    descent   r' -> max(min(speed, touch + (end - r)/time), press) with |r''| <= acceleration
    braking   r' -> 0 with |r''| <= acceleration
    levelling r = 0
    release   w = -k q with the coordinate q that the laws behind read: k is the spring that they compensate

in place of the tracking demands. Each r starts at the estimate, with the rate of the estimate. No integrator takes
part, and the history of the tracking has no influence: the observer's disturbance d does the work of an integrator.
The landing is over, ``landed``, when r is `beyond` the end, wherever the body is; it ``rests`` on its stop while q, the
coordinate as the laws read it, is beyond `rests_beyond`. It never returns to tracking; `init` does. Until the latch
a status bit of the fault word says that the machine lands, ``lands``: all readings may be good again meanwhile.

Courses of the coordinates in a landing: descent to the stop, braking, levelling, release to a spring.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import casadi as ca

from synth import arguments
from synth.block import Block, Constant, Exprs, State, Step, build, clip
from synth.blocks.guard import safety
from synth.errors import SignalError
from synth.fault import BRAKING_BIT, Failure, Fault, enumeration
from synth.law import label
from synth.signals import Signal
from synth.timing import Discrete


@arguments.checked
@dataclass(frozen=True)
class Descent:
    """To the stop at `end`: speed, touch and press in m/s, acceleration in m/s^2, `beyond` in m, p in rad/s.

    `bound` in m bounds the set-point below 0. A body that has landed rests on its stop while it is farther than
    `rests_beyond`, in m.
    """

    coordinate: str
    end: float
    speed: float
    touch: float
    press: float
    acceleration: float
    beyond: float
    pole: float
    bound: float
    rests_beyond: float


@arguments.checked
@dataclass(frozen=True)
class Braking:
    """To rest within +-`bound`, with at most `acceleration`; the poles are at -`pole` rad/s."""

    coordinate: str
    acceleration: float
    pole: float
    bound: float


@arguments.checked
@dataclass(frozen=True)
class Levelling:
    """To zero, with the poles at -`pole` rad/s, or -`predicted_pole` without a measurement.

    A fast motion along predictions alone excites what the model does not know.
    """

    coordinate: str
    pole: float
    predicted_pole: float


@arguments.checked
@dataclass(frozen=True)
class Release:
    """To its guide spring: `spring` in 1/s^2, with a name for the C, is the part of it that the laws compensate."""

    coordinate: str
    spring: Constant


Course = Descent | Braking | Levelling | Release


LANDS = Signal("lands", "1", 0, 1, "lands until it latches")
_FLAGS = [
    Signal(safety.LANDED, "1", 0, 1, "the ramp is at its end, wherever the body is"),
    Signal(safety.RESTS, "1", 0, 1, "has landed, and lies on its stop"),
    LANDS,
]

__all__ = ["Braking", "Descent", "Levelling", "Release", "block"]


@arguments.checked
def block(
    time: Discrete, courses: Sequence[Course], demands: Sequence[Signal], patience: int, good_samples: int = 0
) -> Block:
    """Return the Block from the tracking demands ``<w>_tracking`` to the demands ``<w>``, ``landed`` and ``rests``.

    `demands` are those of the `courses`, in the same order. For each coordinate q the Block reads ``<q>_estimate``,
    ``<q>_rate`` and ``<q>_disturbance``, for one that is levelled ``<q>_measured`` and for one that is released
    or descends ``<q>``; further ``regular``, ``ready`` and ``latched``. It sets the status bit BRAKING_BIT while the
    machine lands.

    Raises SignalError without exactly one descent, for a different number of demands, or for values that are not
    positive or below 0 for `good_samples`, of which so many make up for one without ``regular``.
    """
    _check(courses, demands, patience)
    safety.check(good_samples)
    T, moving = time.period_s, [c for c in courses if isinstance(c, Descent | Braking)]

    def law(u: Exprs, x: Exprs, k: Exprs) -> Step:
        waiting = ca.logic_and(ca.logic_not(u["regular"]), u["ready"])
        left = safety.next_count(ca.logic_not(waiting), x["left"], patience, good_samples)
        due = ca.logic_and(waiting, safety.is_due(x["left"], good_samples))
        landing = ca.if_else(due, 1, x["landing"])
        named: list[tuple[Signal, ca.SX]] = []
        output, next = {LANDS.name: ca.if_else(u["latched"], 0, landing)}, {"left": left, "landing": landing}
        for c, w in zip(courses, demands, strict=True):
            if isinstance(c, Release):
                released = -c.spring.value * u[c.coordinate]
                output[w.name] = ca.if_else(landing, clip(released, w), u[f"{w.name}_tracking"])
                continue
            q, v, d = (u[f"{c.coordinate}_{of}"] for of in ("estimate", "rate", "disturbance"))
            if isinstance(c, Levelling):
                levelling_pole = ca.if_else(u[f"{c.coordinate}_measured"], c.pole, c.predicted_pole)
                label(c.coordinate, levelling_pole=levelling_pole)
                damping = 2 * levelling_pole * v
                named.append((Signal(f"damping_{c.coordinate}", w.unit, w.low, w.high, "part by the rate"), damping))
                demand = -(levelling_pole * levelling_pole * q + damping + d)
            else:
                p = c.pole
                position, rate = (state.signal for state in _states(c))
                r = ca.if_else(x["landing"], x[position.name], clip(q, position))
                dr = ca.if_else(x["landing"], x[rate.name], clip(v, rate))
                target = _descent_rate(c, r) if isinstance(c, Descent) else ca.SX(0)
                ddr = ca.fmax(ca.fmin((target - dr) / T, c.acceleration), -c.acceleration)
                dr_next = ca.fmax(ca.fmin(target, dr + T * c.acceleration), dr - T * c.acceleration)
                ahead = ca.if_else(x["landing"], clip(r + T / 2 * (dr + dr_next), position), r)
                label(c.coordinate, ahead=ahead)
                next[position.name] = ca.if_else(landing, ahead, x[position.name])
                next[rate.name] = ca.if_else(landing, dr_next, x[rate.name])
                values = zip(_ramp(c), (r, dr, target, dr_next), strict=True)
                named += [(signal, value) for signal, value in values if not value.is_constant()]
                demand = p * p * (r - q) + 2 * p * (dr - v) + (ddr - d)
            output[w.name] = ca.if_else(landing, clip(demand, w), u[f"{w.name}_tracking"])
            if isinstance(c, Descent):
                at_end = x[f"r_{c.coordinate}"] >= c.end + c.beyond
                output["landed"] = ca.if_else(ca.logic_and(x["landing"], at_end), 1, 0)
                output[safety.RESTS] = ca.logic_and(output["landed"], u[c.coordinate] >= c.rests_beyond)
        label(waiting=waiting, landing=landing)
        return Step(
            output,
            next,
            named,
            numbers=[*_numbers(time, patience, good_samples), *(n for c in courses for n in _of_course(c, T))],
            notes=["No integrator takes part, so nothing winds up: the disturbance of the observer does its work."],
        )

    states = [
        safety.state(patience, good_samples, "samples until it lands"),
        State(Signal("landing", "1", 0, 1, "lands until init"), 0, True),
    ]
    for c in moving:
        states += _states(c)
    made = build(
        safety.LANDING, time, law, inputs=_inputs(courses, demands),
        outputs=[*demands, *_FLAGS],
        states=states, tag="ramps and state feedback",
    )  # fmt: skip
    faults = (Fault(BRAKING_BIT, LANDS.name, about=LANDS.about, status=True),)
    return replace(made, faults=faults, failures=(_row(courses, safety.rule(patience, good_samples)),))


def _row(courses: Sequence[Course], patience: str) -> Failure:
    """Return the row of the header's table on a landing, which begins after `patience`."""
    d = next(c for c in courses if isinstance(c, Descent))
    braked = [f"{c.coordinate} at {c.acceleration:g} m/s^2" for c in courses if isinstance(c, Braking)]
    course = f"{d.coordinate} sinks to {d.end:g} m with at most {d.speed:g} m/s and {d.acceleration:g} m/s^2, "
    course += f"{d.touch:g} m/s at the stop"
    course += f"; brakes {enumeration(braked, 'and')}" if braked else ""
    leaving = (("levels {} with the motors that are left", Levelling), ("leaves {} to its guide spring", Release))
    for what, kind in leaving:
        coordinates = [c.coordinate for c in courses if isinstance(c, kind)]
        course += f"; {what.format(enumeration(coordinates, 'and'))}" if coordinates else ""
    over = f"over, and latches, when the ramp of {d.coordinate}, not the body, is at {d.end + d.beyond:g} m; rests on "
    over += f"the stop while {d.coordinate} is beyond {d.rests_beyond:g} m"
    return Failure(
        "landing",
        "a coordinate that is not measured, in all rows above that say `lands`",
        f"status bit {BRAKING_BIT}; in {patience}",
        "estimates of the observers",
        f"{course}; {over}; good readings do not end it; without sufficient ones it latches in flight",
    )


def _ramp(c: Descent | Braking) -> tuple[Signal, ...]:
    """Return the signals of the set-point of a coordinate, its rate and the rate that it approaches."""
    q = c.coordinate
    return (
        Signal(f"ramp_{q}", "m", -WIDE, WIDE, "set-point of the landing"),
        Signal(f"ramp_rate_{q}", "m/s", -WIDE, WIDE, "its rate"),
        Signal(f"ramp_target_{q}", "m/s", -WIDE, WIDE, "rate that the set-point approaches"),
        Signal(f"ramp_rate_next_{q}", "m/s", -2 * WIDE, 2 * WIDE, "rate of the set-point one sample later"),
    )


def _numbers(time: Discrete, patience: int, good_samples: int) -> list[Constant]:
    T = time.period_s
    return [
        *safety.numbers(
            "landing_patience", patience, good_samples, "samples in a row with a prediction until it lands"
        ),
        Constant("half_T", T / 2, "s", "half the sample period"),
        Constant("inverse_T", 1 / T, "1/s", "1 / sample period"),
    ]


def _of_course(c: Course, T: float) -> list[Constant]:
    """Return the numbers of a course that the C names."""
    n = c.coordinate
    if isinstance(c, Release):
        return [c.spring]
    if isinstance(c, Levelling):
        return [
            Constant(f"pole_{n}", c.pole, "1/s", "levelling by measurements"),
            Constant(f"predicted_pole_{n}", c.predicted_pole, "1/s", "levelling by predictions"),
        ]
    numbers = [
        Constant(f"stiffness_{n}", c.pole**2, "1/s^2", f"p^2, p = {c.pole:g} 1/s"),
        Constant(f"damping_{n}", 2 * c.pole, "1/s", f"2 p, p = {c.pole:g} 1/s"),
        Constant(f"acceleration_step_{n}", T * c.acceleration, "m/s", f"T times {c.acceleration:g} m/s^2 of the ramp"),
        Constant(f"bound_{n}", c.bound, "m", "of the ramp: wider than any estimate"),
        Constant(f"acceleration_{n}", c.acceleration, "m/s^2", "largest one of the ramp"),
        Constant(f"ramp_rate_bound_{n}", WIDE, "m/s", "bound of the ramp's rate: wider than any estimate"),
    ]
    if isinstance(c, Descent):
        numbers += [
            Constant("stop", c.end, "m", "gap of the stop on which it lands"),
            Constant("rests_beyond", c.rests_beyond, "m", "beyond it, once landed, the body lies on the stop"),
            Constant(
                "landed_at", c.end + c.beyond, "m", "end of the ramp, behind the stop: landed, wherever the body is"
            ),
            Constant("ramp_end", c.end + 4 * c.beyond, "m", "bound of the ramp: it is over before"),
            Constant("largest_speed", c.speed, "m/s", "largest speed of the ramp"),
            Constant("touch_speed", c.touch, "m/s", "speed of the ramp at the stop"),
            Constant("press_speed", c.press, "m/s", "least speed of the ramp, behind the stop"),
            Constant("approach", c.acceleration / c.speed, "1/s", "acceleration over largest speed"),
        ]
    return numbers


def _descent_rate(c: Descent, r: ca.SX) -> ca.SX:
    """Return the speed at r: an exponential approach of the end, decelerated by at most the acceleration.

    It passes the end at `touch` and falls on to `press`.
    """
    approach = c.touch + c.acceleration / c.speed * (c.end - r)
    return ca.fmax(ca.fmin(approach, c.speed), c.press)


WIDE = 10.0  # m or rad, m/s or rad/s: bound of estimates and rates


def _states(c: Descent | Braking) -> list[State]:
    high = c.end + 4 * c.beyond if isinstance(c, Descent) else c.bound  # it is over at end + beyond
    return [
        State(Signal(f"r_{c.coordinate}", "m", -c.bound, high, "set-point of the landing"), 0.0),
        State(Signal(f"dr_{c.coordinate}", "m/s", -WIDE, WIDE, "its rate"), 0.0),
    ]


def _inputs(courses: Sequence[Course], demands: Sequence[Signal]) -> list[Signal]:
    inputs = []
    for c, w in zip(courses, demands, strict=True):
        unit = w.unit.removesuffix("/s^2")
        if isinstance(c, Release):
            inputs.append(Signal(c.coordinate, unit, -WIDE, WIDE))
        else:
            inputs.append(Signal(f"{c.coordinate}_estimate", unit, -WIDE, WIDE))
            inputs.append(Signal(f"{c.coordinate}_rate", f"{unit}/s", -WIDE, WIDE))
            inputs.append(Signal(f"{c.coordinate}_disturbance", w.unit, w.low, w.high))
        if isinstance(c, Descent):
            inputs.append(Signal(c.coordinate, unit, -WIDE, WIDE))
        if isinstance(c, Levelling):
            inputs.append(Signal(f"{c.coordinate}_measured", "1", 0, 1))
        inputs.append(Signal(f"{w.name}_tracking", w.unit, w.low, w.high))
    return [*inputs, *(Signal(flag, "1", 0, 1) for flag in ("regular", "ready", "latched"))]


def _check(courses: Sequence[Course], demands: Sequence[Signal], patience: int) -> None:
    descents = [c for c in courses if isinstance(c, Descent)]
    if len(descents) != 1 or len(demands) != len(courses):
        raise SignalError(
            f"{len(descents)} of {len(courses)} courses descend, for {len(demands)} demands: give one descent, and a "
            "demand for each course"
        )
    d = descents[0]
    moving = [c for c in courses if isinstance(c, Descent | Braking)]
    values = [
        *(c.spring.value if isinstance(c, Release) else c.pole for c in courses),
        *(v for c in moving for v in (c.acceleration, c.bound)),
    ]
    values += [c.predicted_pole for c in courses if isinstance(c, Levelling)]
    values += [d.touch, d.press, d.beyond, d.speed - d.touch, d.end - d.rests_beyond, float(patience)]
    if not min(values) > 0:
        raise SignalError(
            f"the least value of the landing is {min(values)}: give positive poles, springs, accelerations, speeds and "
            "samples, a touch slower than the descent, and a rests_beyond before the end"
        )
