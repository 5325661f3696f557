"""Three-phase windings: phase currents from direct and quadrature currents, the inverse Park transformation.

i_d, i_q are rms currents in A, the phase currents are instantaneous, th is the electrical angle in rad:

    i_a = sqrt(2) (i_d cos th - i_q sin th),  i_b the same at th - 2 pi/3,  i_c at th + 2 pi/3.

They sum to zero and have the amplitude sqrt(2) hypot(i_d, i_q): a limit on hypot(i_d, i_q) limits every phase.
"""

from collections.abc import Sequence

import casadi as ca


def electrical_angle(displacement: ca.SX, tau: ca.SX) -> ca.SX:
    """Return th = pi displacement / tau + pi/2 in rad, for a pole pitch `tau` in m.

    `displacement` in m is that of a magnet of positive polarity from the slot that phase a fills, along the motion. At
    zero the direct axis then lies midway between slots of phase a, so i_d acts on the magnets and i_q on their edges.
    """
    return ca.pi * displacement / tau + ca.pi / 2


def phase_currents(i_d: ca.SX, i_q: ca.SX, angle: ca.SX) -> dict[str, ca.SX]:
    """Return the currents in A of phases a, b, c for rms currents at the electrical angle in rad (inverse Park)."""
    axes = angle, angle - 2 * ca.pi / 3, angle + 2 * ca.pi / 3
    return {phase: ca.sqrt(2) * (i_d * ca.cos(th) - i_q * ca.sin(th)) for phase, th in zip("abc", axes, strict=True)}


def rotor_currents(phases: Sequence[ca.SX], angle: ca.SX) -> tuple[ca.SX, ca.SX]:
    """Return i_d and i_q in A rms from the currents in A of phases a, b, c at the electrical angle in rad (Park)."""
    a, b, c = phases
    alpha, beta, scale = a - (b + c) / 2, ca.sqrt(3) / 2 * (b - c), ca.sqrt(2) / 3  # 3/2 of Clarke's currents
    cos, sin = ca.cos(angle), ca.sin(angle)
    return scale * (alpha * cos + beta * sin), scale * (beta * cos - alpha * sin)
