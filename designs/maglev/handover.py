"""Handover of direct currents: from the motors along an axis whose position is not measured to those of the other one.

A direct current that repels the platen pushes it sideways, away from the angle of its commutation. At an angle that is
predicted or stale the platen is unstable along the axis: at 2.5 A a displacement grows by e in 55 ms. A thrust current
only loses the cosine of the error. The handover keeps the sum of the direct currents, and takes FADE samples.

    transfer t in -1 .. 1     t > 0: part of the direct currents along X that motors along Z take over, t < 0 vice versa
"""

from collections.abc import Mapping

import casadi as ca

from designs.maglev.platen import COMMUTATED, CURRENT, INTERFACE, MOTORS, TIME
from models import maglev_phases
from synth.block import Block, Constant, Exprs, State, Step, build
from synth.signals import Signal

FADE = 25  # samples: 2.5 A at the slew rate of 100 A/s
OF_AXIS = {n: [j for j, along in zip(MOTORS, maglev_phases.ALONG, strict=True) if along == n] for n in "xz"}
TRANSFER = Signal("transfer", "1", -1, 1, "part of their currents that motors hand over: > 0 along X, < 0 along Z")
DIRECT = [INTERFACE.computed_output(f"i_d{j}") for j in MOTORS]
NUMBERS = [
    Constant("fade_step", 1 / FADE, "1", f"1 / {FADE}: the handover takes {FADE} samples"),
    Constant("current_limit", CURRENT, "A", "largest hypot(i_d, i_q) of a motor, rms"),
]
BALANCED = {s.name: s.name.replace("computed", "balanced") for s in DIRECT}


def next_transfer(transfer: ca.SX, x_lost: ca.SX, z_lost: ca.SX) -> ca.SX:
    """Return the transfer of this sample from that of the sample before; it stays while both positions are lost."""
    both = ca.logic_and(x_lost, z_lost)
    direction = ca.if_else(x_lost, 1, ca.if_else(z_lost, -1, 0))
    target = ca.if_else(both, transfer, direction)
    return ca.fmax(ca.fmin(target, transfer + 1 / FADE), transfer - 1 / FADE)


def parts(transfer: ca.SX) -> dict[str, ca.SX]:
    """Return the part of their direct currents that the motors along each axis hand over."""
    of_x, part = transfer > 0, ca.fabs(transfer)
    return {"x": ca.if_else(of_x, part, 0), "z": ca.if_else(of_x, 0, part)}


def with_taken_over(
    direct: Mapping[int, ca.SX], quadrature: Mapping[int, ca.SX], part: Mapping[str, ca.SX]
) -> dict[int, ca.SX]:
    """Return the direct currents by motor with what is taken over, within the limit beside the quadrature currents."""
    taken = {}
    for n, giver in (("x", "z"), ("z", "x")):
        handed = part[giver] / 2 * sum((direct[j] for j in OF_AXIS[giver]), start=ca.SX(0))
        for j in OF_AXIS[n]:
            room = CURRENT - ca.fabs(quadrature[j])
            taken[j] = ca.fmax(ca.fmin(direct[j] + handed, room), -room)
    return taken


def block() -> Block:
    """Return the Block that hands direct currents over while x or z is predicted; else they pass unchanged."""
    thrust = [INTERFACE.computed_output(f"u_{n}") for n in COMMUTATED]
    trusted = [Signal(f"{n}_trusted", "1", 0, 1) for n in COMMUTATED]

    def law(u: Exprs, x: Exprs, k: Exprs) -> Step:
        lost = [ca.logic_not(u[s.name]) for s in trusted]
        active = ca.logic_or(ca.logic_or(*lost), x["transfer"] ** 2 > 0)
        transfer = next_transfer(x["transfer"], *lost)
        direct = {j: u[BALANCED[s.name]] for j, s in zip(MOTORS, DIRECT, strict=True)}
        quadrature = {j: u[f"u_{n}_computed"] for n, motors in OF_AXIS.items() for j in motors}
        part = parts(transfer)
        taken = with_taken_over(direct, quadrature, part)
        remainder = {n: 1 - part[n] for n in OF_AXIS}
        kept = {j: remainder[n] * taken[j] for n, motors in OF_AXIS.items() for j in motors}
        output = {s.name: ca.if_else(active, kept[j], direct[j]) for j, s in zip(MOTORS, DIRECT, strict=True)}
        return Step(output, {"transfer": ca.if_else(active, transfer, x["transfer"])}, numbers=NUMBERS)

    inputs = [*(_balanced(s) for s in DIRECT), *thrust, *trusted]
    states, tag = [State(TRANSFER, 0.0)], "direct currents without x or z"
    return build("handover", TIME, law, inputs=inputs, outputs=DIRECT, states=states, tag=tag)


def _balanced(computed: Signal) -> Signal:
    return Signal(BALANCED[computed.name], computed.unit, computed.low, computed.high, computed.about)
