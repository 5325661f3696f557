"""The sensors where a sample begins: sines and cosines, computed once, and the voltages turned into the field's axes.

A sine of a large angle has zeros that no polynomial can follow to a relative error: angles are divided by 2^m, and

    s <- s c,  c <- 1 - s^2/2^(2n+1),   n = m-1 .. 0,   from  s = 2^m sin(angle/2^m),  c = cos(angle/2^m)

lead back, which multiplies errors by 2^m at most. Last but one s is limited to 2, as it would otherwise be taken to
grow twofold each time, and the last to 1: bounds of the places of sensors and of all that is computed are those of the
sines.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from string import ascii_lowercase

import casadi as ca

from designs.hall_position.glsdc.correction import AXES, Sensor, Wave
from designs.hall_position.glsdc.descent import Named, Problem
from designs.hall_position.glsdc.parameters import Array
from synth.block import Constant, Exprs, clip
from synth.signals import Signal

UNIT, TWICE = Signal("unit", "1", -1, 1), Signal("twice", "1", -2, 2)
POWERS = (1, 3, 5)  # of the sine, in alpha sin p + beta sin 5p


def constants(array: Array) -> list[Constant]:
    """Return the coefficients of the field by powers of the sine, and of its derivative by the phase."""
    values = dict(zip(POWERS, (array.alpha + 5 * array.beta, -20 * array.beta, 16 * array.beta), strict=True))
    about = "alpha sin p + beta sin 5p by powers of the sine"
    field = [Constant(f"field_{n}", v, "V", about) for n, v in values.items()]
    return [*field, *(Constant(f"slope_{n - 1}", n * v, "V", f"derivative of {about}") for n, v in values.items())]


def wave(angle: ca.SX, halvings: int, name: str, named: Named) -> Wave:
    """Return sine and cosine of an angle; the cosine of its 2^halvings-th part and 2^halvings its sine are `named`."""
    s, c = 2**halvings * ca.sin(angle / 2**halvings), ca.cos(angle / 2**halvings)
    for what, value in (("sine", s), ("cosine", c)):
        about = f"of 1/{2**halvings} of it" + (f", times {2**halvings}" if what == "sine" else "")
        named.append((Signal(f"{name}_{what}", "1", -(2**halvings), 2**halvings, about), value))
    for left in reversed(range(halvings)):
        s = s if left else clip(s, TWICE)
        s, c = s * c, 1 - s**2 / 2 ** (2 * left + 1)
    return Wave(clip(s, UNIT), c)


def heading(yaw: ca.SX, named: Named) -> Wave:
    """Return sine and cosine of the yaw."""
    return wave(yaw, 2, "yaw_part", named)


@dataclass(frozen=True, eq=False)
class Base:
    """What a sample begins with: inputs, the expected pose and constants by name, its yaw's wave, sensors left out."""

    u: Exprs
    pose: Exprs
    k: Exprs
    heading: Wave
    left_out: Sequence[ca.SX] | None


def sensors(base: Base, of: Problem, named: Named) -> list[Sensor]:
    """Return the sensors at the base, the root of its weight on what each reads; one left out reads 0 in no field.

    It does so by a product with 0: CasADi would pass a choice on into every correction.
    """
    return [_sensor(base, of, n, named) for n in range(len(of.array.positions))]


def _sensor(base: Base, of: Problem, n: int, named: Named) -> Sensor:
    s, c = base.heading.sine, base.heading.cosine
    letter, scale, (ax, ay) = ascii_lowercase[n], of.array.scales[n], of.array.arms[n]

    def kept(value: ca.SX) -> ca.SX:
        return scale * (value if base.left_out is None else (1 - base.left_out[n]) * value)

    place = {"x": c * ax - s * ay, "y": s * ax + c * ay}
    phase = {a: wave(base.pose[f"phase_{a}"] + place[a], of.halvings, "phase_part", named) for a in AXES}
    vx, vy = (kept(base.u[f"V_{letter}{a}_held"]) for a in AXES)
    volts = {"x": c * vx - s * vy, "y": s * vx + c * vy}
    field = [kept(ca.SX(of.array.c)), *(kept(base.k[f"field_{i}"]) for i in POWERS)]
    return Sensor(phase, place, volts, field, [kept(base.k[f"slope_{i - 1}"]) for i in POWERS])
