"""Angles as phasors: sine and cosine are computed once, then turned by products; a vector of the plane is one as well.

A sine of a large angle has zeros that no polynomial can follow to a relative error. So angles are divided by 2^m, and

    s <- s c,  c <- 1 - s^2/2^(2n+1),   n = m-1 .. 0,   from  s = 2^m sin(angle/2^m),  c = cos(angle/2^m)

lead back, which multiplies errors by 2^m at most. Every s is limited, to 2 and the last one to 1: intervals would take
it to grow twofold each time.
"""

from dataclasses import dataclass
from math import ceil, log2

import casadi as ca

from synth.block import clip
from synth.blocks.glsdc import Named
from synth.signals import Signal

MAX_ANGLE = 1.2  # rad: angles whose sine and cosine become polynomials are smaller
UNIT, TWICE = Signal("unit", "1", -1, 1), Signal("twice", "1", -2, 2)


@dataclass(frozen=True, eq=False)
class Phasor:
    """Cosine and sine of an angle, times a length."""

    cosine: ca.SX
    sine: ca.SX

    def times(self, by: "Phasor") -> "Phasor":
        """Return the phasor turned by another one's angle."""
        sine = self.sine * by.cosine + self.cosine * by.sine
        return Phasor(self.cosine * by.cosine - self.sine * by.sine, sine)


def of(angle: ca.SX) -> Phasor:
    """Return the phasor of a small angle."""
    return Phasor(ca.cos(angle), ca.sin(angle))


def halvings(limit: float) -> int:
    """Return how often an angle up to a limit in rad is halved before its sine becomes a polynomial."""
    return max(1, ceil(log2(limit / MAX_ANGLE)))


def reduced(angle: ca.SX, halvings: int, name: str, named: Named) -> Phasor:
    """Return the phasor of an angle; the cosine of its 2^halvings-th part and 2^halvings its sine are `named`."""
    s, c = 2**halvings * ca.sin(angle / 2**halvings), ca.cos(angle / 2**halvings)
    for function, value in (("sine", s), ("cosine", c)):
        about = f"of 1/{2**halvings} of it" + (f", times {2**halvings}" if function == "sine" else "")
        named.append((Signal(f"{name}_{function}", "1", -(2**halvings), 2**halvings, about), value))
    for left in reversed(range(halvings)):
        s = s if left else clip(s, TWICE)
        s, c = s * c, 1 - s**2 / 2 ** (2 * left + 1)
    return Phasor(c, clip(s, UNIT))
