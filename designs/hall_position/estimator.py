"""Where the body is, from the voltages of two or more two-axis Hall sensors: modified GLSDC, with a fixed time.

    V_ax .. --->[ guard ]---> held ---> base: phases, yaw of the last sample ---> n corrections ---> X, Y, yaw ...

From the displacement d_0 = 0 on, n times:

    J(d_i) <= J(best) ?    yes: best = d_i, d_i+1 = best + scale (H'W H + damping)^-1 H'W e, in reach      `correction`
                           no:  d_i+1 = best + (d_i - best) / 4

so that no estimate has a higher cost than where its sample began, however the voltages look. The last of the
corrections counts only if it is `settled`: smaller than a tenth of its standard deviation; else the best of the
displacements that were tried stands, and the sample has not `converged`.

The damping holds to the last sample's estimate what the voltages do not tell: two sensors lose rank at places. There
the estimate stays where it was in one direction, for as long as the place is passed, and is `damped`.

`valid` is an estimate that has converged, is not damped, leaves residuals as small as the field's model does, and rests
on measurements that are all accepted. Positions are absolute in a pitch, and count pitches on from where `init` puts
them; a body that leaves the pitches that are counted is not valid again until then. The voltages are the same when
everything is turned by 90 degrees about a strong block, so that the yaw is known to a quarter turn and continues the
last one.

Source: Kawato, Kim, "Multi-Degree-of-Freedom Precision Position Sensing", section 3.B, Fig. 9.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from math import hypot, log2, pi, sqrt
from string import ascii_lowercase

import casadi as ca

from designs.hall_position import correction
from designs.hall_position.correction import AXES, Displacement, Row, Wave
from designs.hall_position.parameters import Array, Tuning
from synth.block import Block, Constant, Exprs, State, Step, build, clip
from synth.signals import Signal
from synth.timing import Discrete

BACK = 0.25  # of a correction that has raised the cost
SLACK = 0.01  # of deviation^2: so much a cost may rise by rounding
QUARTER = 1.2  # rad: angles whose sine and cosine become polynomials are smaller
LEAST = 1e-30  # V^2

Named = list[tuple[Signal, ca.SX]]


def voltages(array: Array, span: float) -> tuple[Signal, ...]:
    """Return the voltages of sensors a, b, ... in order, each within `span` V."""
    letters = ascii_lowercase[: len(array.positions)]
    return tuple(Signal(f"V_{k}{axis}", "V", -span, span, "Hall sensor and axis") for k in letters for axis in AXES)


OUTPUTS = ("X", "Y", "yaw", "deviation_X", "deviation_Y", "deviation_yaw", "residual")
FLAGS = {
    "converged": "the last correction is small and has not raised the cost",
    "damped": "the voltages do not tell all of the position",
    "valid": "converged, not damped, residual and inputs accepted, inside the pitches that are counted",
}


@dataclass(frozen=True)
class _Sizes:
    """Bounds of a displacement: U and V, T; and how often phases are halved for their polynomials."""

    phase: float
    yaw: float
    halvings: int

    @staticmethod
    def of(array: Array, tuning: Tuning) -> "_Sizes":
        arm = max(abs(x) + abs(y) for x, y in array.arms)
        half = tuning.reach / 2
        yaw = sqrt(1 + 2 * half / arm) - 1  # T + T^2/2 = half / arm
        return _Sizes(half, yaw, max(1, ceil(log2((pi + arm) / QUARTER))))


def estimator(array: Array, time: Discrete, tuning: Tuning = Tuning(), span: float = 5.0) -> Block:
    """Return the Block from held voltages and ``complete`` to X, Y in m, yaw in rad, their deviations and flags."""
    sizes, damping = _Sizes.of(array, tuning), tuning.damping * array.alpha**2
    held = [replace(s, name=f"{s.name}_held") for s in voltages(array, span)]

    def law(u: Exprs, x: Exprs, k: Exprs) -> Step:
        named: Named = []
        heading = _wave(x["yaw"], 2, "yaw", named)
        sensors = [_sensor(array, n, u, x, k, heading, sizes, named) for n in range(len(array.positions))]
        found = _corrected(sensors, _Problem(array, tuning, sizes, damping), named)
        output, next = _placed(found, heading, array, tuning, x, u["complete"], named)
        return Step(output, next, named)

    return build(
        "estimator",
        time,
        law,
        inputs=[*held, COMPLETE],
        outputs=_outputs(array, tuning),
        states=_states(tuning),
        constants=_constants(array),
        tag="GLSDC, Fig. 9",
    )


def _states(tuning: Tuning) -> list[State]:
    phases = [Signal(f"phase_{axis}", "rad", -pi, pi, "of the sensors' centre in its pitch") for axis in AXES]
    yaw = Signal("yaw", "rad", -pi, pi, "of the last sample")
    n = tuning.pitches
    counts = [Signal(f"pitch_{axis}", "1", -n, n, "whole pitches of the sensors' centre") for axis in AXES]
    return [State(s, 0.0) for s in (*phases, yaw, *counts)]


def _constants(array: Array) -> list[Constant]:
    source = "(2), by powers of the sine"
    found = [Constant(f"field_{n}", v, "V", source) for n, v in zip((1, 3, 5), _field(array), strict=True)]
    found += [
        Constant(f"slope_{n - 1}", n * v, "V", f"{source}, derivative by the phase")
        for n, v in zip((1, 3, 5), _field(array), strict=True)
    ]
    return found


def _field(array: Array) -> tuple[float, float, float]:
    """Return the coefficients of sin, sin^3 and sin^5 in alpha sin p + beta sin 5p."""
    return array.alpha + 5 * array.beta, -20 * array.beta, 16 * array.beta


def _wave(angle: ca.SX, halvings: int, name: str, named: Named) -> Wave:
    """Return sine and cosine of an angle from those of a small part of it; both are limited to -1 .. 1."""
    part = angle / 2**halvings
    s, c = ca.sin(part), ca.cos(part)
    for what, value in (("sine", s), ("cosine", c)):
        named.append((Signal(f"{what}_{name}", "1", -1, 1, f"of its {2**halvings}th part"), value))
    for _ in range(halvings):
        s, c = 2 * s * c, 1 - 2 * s**2
    return Wave(clip(s, UNIT), clip(c, UNIT))


def _sensor(
    array: Array, n: int, u: Exprs, x: Exprs, k: Exprs, heading: Wave, sizes: _Sizes, named: Named
) -> correction.Sensor:
    """Return sensor n at the estimate of the last sample."""
    letter, scale, (ax, ay) = ascii_lowercase[n], array.scales[n], array.arms[n]
    s, c = heading.sine, heading.cosine
    place = {"x": c * ax - s * ay, "y": s * ax + c * ay}
    phase = {
        axis: _wave(x[f"phase_{axis}"] + place[axis], sizes.halvings, f"{letter}{axis}", named) for axis in AXES
    }
    vx, vy = (scale * u[f"V_{letter}{axis}_held"] for axis in AXES)
    volts = {"x": c * vx - s * vy, "y": s * vx + c * vy}
    field = [ca.SX(scale * array.c), *(scale * k[f"field_{i}"] for i in (1, 3, 5))]
    return correction.Sensor(phase, place, volts, field, [scale * k[f"slope_{i}"] for i in (0, 2, 4)])
