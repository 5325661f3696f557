"""Three-phase windings: phase currents from direct and quadrature currents, and back.

i_d, i_q are rms currents in A, the phase currents are instantaneous, th is the electrical angle in rad:

    i_a = sqrt(2) (i_d cos th - i_q sin th),  i_b the same at th - 2 pi/3,  i_c at th + 2 pi/3.

They sum to zero and have the amplitude sqrt(2) hypot(i_d, i_q), so that a limit of that norm limits every phase.
"""

from dataclasses import dataclass

import casadi as ca


@dataclass(frozen=True, eq=False)
class PhaseCurrents:
    """Instantaneous currents of the three phases, A."""

    a: ca.SX
    b: ca.SX
    c: ca.SX


@dataclass(frozen=True, eq=False)
class AxisCurrents:
    """Direct and quadrature current, A rms."""

    d: ca.SX
    q: ca.SX


def electrical_angle(displacement: ca.SX, tau: ca.SX) -> ca.SX:
    """Return th = pi displacement / tau + pi/2 in rad, for a pole pitch `tau` in m.

    `displacement` in m is that of a magnet of positive polarity from the slot that phase a fills, along the motion. At
    zero the direct axis then lies midway between slots of phase a, so that i_d meets the magnets and i_q their edges.
    """
    return ca.pi * displacement / tau + ca.pi / 2


def phase_currents(i_d: ca.SX, i_q: ca.SX, angle: ca.SX) -> PhaseCurrents:
    """Return the phase currents in A for rms currents `i_d`, `i_q` at the electrical angle in rad (inverse Park)."""
    a, b, c = (ca.sqrt(2) * (i_d * ca.cos(th) - i_q * ca.sin(th)) for th in _axes(angle))
    return PhaseCurrents(a, b, c)


def axis_currents(phases: PhaseCurrents, angle: ca.SX) -> AxisCurrents:
    """Return the rms currents i_d, i_q that phase currents in A make at the electrical angle in rad (Park).

    i_d = sqrt(2)/3 sum_k i_k cos th_k, i_q = -sqrt(2)/3 sum_k i_k sin th_k; a current common to all phases drops out.
    """
    a, b, c = _axes(angle)
    d = phases.a * ca.cos(a) + phases.b * ca.cos(b) + phases.c * ca.cos(c)
    q = phases.a * ca.sin(a) + phases.b * ca.sin(b) + phases.c * ca.sin(c)
    return AxisCurrents(ca.sqrt(2) / 3 * d, -ca.sqrt(2) / 3 * q)


def _axes(angle: ca.SX) -> tuple[ca.SX, ca.SX, ca.SX]:
    return angle, angle - 2 * ca.pi / 3, angle + 2 * ca.pi / 3
