"""Phasors: cosine and sine of an angle, computed once and rotated by products; range reduction by angle doubling.

A sine over a large range of angles has zeros, which no polynomial can follow to a relative error. The angle is
therefore divided by 2^m, and m doublings recover its sine and cosine:

    s <- s c,  c <- 1 - s^2/2^(2n+1),   n = m-1 .. 0,   from  s = 2^m sin(angle/2^m),  c = cos(angle/2^m)

The doublings multiply errors by at most 2^m. Every s is limited, the last one to 1 and the others to 2, because
interval arithmetic would otherwise double its bound at each step.
"""

from dataclasses import dataclass
from math import ceil, log2

import casadi as ca

from synth.block import clip
from synth.blocks.glsdc import NamedExpressions
from synth.signals import Signal

MAX_ANGLE = 1.2  # rad: the largest angle whose sine and cosine are approximated by polynomials
UNIT, TWICE = Signal("unit", "1", -1, 1), Signal("twice", "1", -2, 2)


@dataclass(frozen=True, eq=False)
class Phasor:
    """Cosine and sine of an angle, times a length: also a vector in the plane."""

    cosine: ca.SX
    sine: ca.SX

    def times(self, by: "Phasor") -> "Phasor":
        """Return the product with another phasor: this one rotated by its angle."""
        sine = self.sine * by.cosine + self.cosine * by.sine
        return Phasor(self.cosine * by.cosine - self.sine * by.sine, sine)


def of(angle: ca.SX) -> Phasor:
    """Return the phasor of a small angle."""
    return Phasor(ca.cos(angle), ca.sin(angle))


def halvings(limit: float) -> int:
    """Return the number of halvings that bring an angle of up to `limit` rad below MAX_ANGLE, at least 1."""
    return max(1, ceil(log2(limit / MAX_ANGLE)))


def by_range_reduction(angle: ca.SX, halvings: int, name: str, named: NamedExpressions) -> Phasor:
    """Return the phasor of an angle by range reduction; `named` receives cos(angle/2^m) and 2^m sin(angle/2^m)."""
    s, c = 2**halvings * ca.sin(angle / 2**halvings), ca.cos(angle / 2**halvings)
    for function, value in (("sine", s), ("cosine", c)):
        about = f"of 1/{2**halvings} of it" + (f", times {2**halvings}" if function == "sine" else "")
        named.append((Signal(f"{name}_{function}", "1", -(2**halvings), 2**halvings, about), value))
    for left in reversed(range(halvings)):
        s = s if left else clip(s, TWICE)
        s, c = s * c, 1 - s**2 / 2 ** (2 * left + 1)
    return Phasor(c, clip(s, UNIT))
