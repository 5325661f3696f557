"""Handover of direct currents: from the motors along an axis whose position is not measured to those of the other one.

A direct current that repels the platen pushes it sideways, away from the angle of its commutation. At an angle that is
predicted or stale the platen is unstable along the axis: at 2.5 A a displacement grows by e in 55 ms. A thrust current
only loses the cosine of the error. The handover keeps the sum of the direct currents, and takes FADE samples. While it
lasts the sum |i_d| + |i_q| of a motor is limited, without a square root, where otherwise sqrt(i_d^2 + i_q^2) is: beside
a large thrust a direct current is cut in the first sample, at most from 3.5 A to 1.45 A beside 3.5 A.

The direct currents along X also hold theta. Without them its guide spring does, but at small gaps it is weaker than the
magnets, which pull a tilted platen further. There the handover along X waits until the landing has lowered the platen.

    transfer t in -1 .. 1     t > 0: part of the direct currents along X that motors along Z take over, t < 0 vice versa
"""

from collections.abc import Mapping
from dataclasses import replace

import casadi as ca

from designs.maglev.platen import AXES, COMMUTATED, CURRENT, INTERFACE, MOTORS, TIME
from models import maglev_phases
from synth.block import Block, Constant, Exprs, State, Step, build
from synth.law import label
from synth.signals import Signal

FADE = 25  # samples: 2.5 A at the slew rate of 100 A/s
HELD_BY_SPRING = 22e-3  # m: at smaller gaps the guide spring of theta is weaker than the magnets
OF_AXIS = {n: [j for j, along in zip(MOTORS, maglev_phases.ALONG, strict=True) if along == n] for n in "xz"}
TRANSFER = Signal("transfer", "1", -1, 1, "part of their currents that motors hand over: > 0 along X, < 0 along Z")
DIRECT = [INTERFACE.computed_output(f"i_d{j}") for j in MOTORS]
FADE_STEP = Constant("fade_step", 1 / FADE, "1", f"1 / {FADE}: a handover, and a fade, takes {FADE} samples")
CURRENT_LIMIT = Constant(
    "current_limit", CURRENT, "A", "largest |i_d| + |i_q| while a motor hands or takes over: keeps hypot too"
)
NUMBERS = [
    FADE_STEP,
    Constant("held_by_spring", HELD_BY_SPRING, "m", "at smaller gaps theta needs the motors along X"),
    CURRENT_LIMIT,
]
NOTES = [
    "Thrust has priority over lift: an i_d that repels drives the platen along the lost axis, away from an angle that "
    "is predicted or stale, where i_q only loses the cosine of the error. So i_d fades out of the motors along that "
    "axis, and is cut where i_q leaves no room.",
    "Without the direct currents along X the guide spring alone holds theta. At gaps below held_by_spring it is weaker "
    "than the magnets, so there the handover along X waits for the landing to lower the platen.",
    "The limit of |i_d| + |i_q| needs no square root and holds from the first sample on: there i_d may be cut at once, "
    "at most from 3.5 A to 1.45 A beside 3.5 A of thrust.",
]
BALANCED = {s.name: s.name.replace("computed", "balanced") for s in DIRECT}


def next_transfer(transfer: ca.SX, x_lost: ca.SX, z_lost: ca.SX, stays: ca.SX) -> ca.SX:
    """Return the transfer of this sample from that of the sample before, unless it stays."""
    direction = ca.if_else(x_lost, 1, ca.if_else(z_lost, -1, 0))
    target = ca.if_else(stays, transfer, direction)
    label(direction=direction, target=target)
    return ca.fmax(ca.fmin(target, transfer + 1 / FADE), transfer - 1 / FADE)


def parts(transfer: ca.SX) -> dict[str, ca.SX]:
    """Return the part of their direct currents that the motors along each axis hand over."""
    of_x, part = transfer > 0, ca.fabs(transfer)
    label(transfer=transfer, of_x=of_x, part=part)
    return {"x": ca.if_else(of_x, part, 0), "z": ca.if_else(of_x, 0, part)}


def currents_to_take_over(direct: Mapping[int, ca.SX], part: Mapping[str, ca.SX]) -> dict[str, ca.SX]:
    """Return the direct current that each motor along x or z takes over, from the mean of those along the other one."""
    return {n: part[of] / 2 * sum((direct[j] for j in OF_AXIS[of]), start=ca.SX(0)) for n, of in ("xz", "zx")}


def room(quadrature: ca.SX) -> ca.SX:
    """Return the direct current that a motor may have beside a quadrature current."""
    return CURRENT - ca.fabs(quadrature)


def with_taken_over(
    direct: Mapping[int, ca.SX], quadrature: Mapping[int, ca.SX], part: Mapping[str, ca.SX]
) -> dict[int, ca.SX]:
    """Return the direct currents by motor with what is taken over, within the limit beside the quadrature currents."""
    handed, taken = currents_to_take_over(direct, part), {}
    for n in ("x", "z"):
        for j in OF_AXIS[n]:
            taken[j] = ca.fmax(ca.fmin(direct[j] + handed[n], room(quadrature[j])), -room(quadrature[j]))
    label(handed=handed)
    return taken


def block() -> Block:
    """Return the Block that hands direct currents over while x or z is predicted; else they pass unchanged."""
    thrust = [INTERFACE.computed_output(f"u_{n}") for n in COMMUTATED]
    trusted = [Signal(f"{n}_trusted", "1", 0, 1) for n in COMMUTATED]
    height = replace(AXES[0].position, name="y_expected")

    def law(u: Exprs, x: Exprs, k: Exprs) -> Step:
        lost = {n: ca.logic_not(u[s.name]) for n, s in zip(COMMUTATED, trusted, strict=True)}
        active = ca.logic_or(ca.logic_or(*lost.values()), x["transfer"] ** 2 > 0)
        stays = ca.logic_and(lost["x"], ca.logic_or(lost["z"], u[height.name] < HELD_BY_SPRING))
        transfer = next_transfer(x["transfer"], lost["x"], lost["z"], stays)
        direct = {j: u[BALANCED[s.name]] for j, s in zip(MOTORS, DIRECT, strict=True)}
        quadrature = {j: u[f"u_{n}_computed"] for n, motors in OF_AXIS.items() for j in motors}
        part = parts(transfer)
        taken = with_taken_over(direct, quadrature, part)
        remainder = {n: 1 - part[n] for n in OF_AXIS}
        kept = {j: remainder[n] * taken[j] for n, motors in OF_AXIS.items() for j in motors}
        output = {s.name: ca.if_else(active, kept[j], direct[j]) for j, s in zip(MOTORS, DIRECT, strict=True)}
        named = [(replace(TRANSFER, name="faded_transfer"), transfer)]
        for n, handed in currents_to_take_over(direct, part).items():
            named.append((Signal(f"part_{n}", "1", 0, 1, "part that the motors along it hand over"), part[n]))
            named.append((Signal(f"handed_{n}", "A", -CURRENT, CURRENT, "direct current to take over"), handed))
            of_thrust = room(u[f"u_{n}_computed"])
            named.append((Signal(f"room_{n}", "A", 0, CURRENT, "direct current beside the thrust"), of_thrust))
        next = {"transfer": ca.if_else(active, transfer, x["transfer"])}
        label(lost=lost, stays=stays, transfer=transfer, part=part, active=active, remainder=remainder)
        return Step(output, next, named, numbers=NUMBERS, notes=NOTES)

    inputs = [*(_balanced(s) for s in DIRECT), *thrust, *trusted, height]
    states = [State(TRANSFER, 0.0)]
    tag = "direct currents without x or z; meanwhile |i_d| + |i_q| of a motor is limited, at once"
    return build("handover", TIME, law, inputs=inputs, outputs=DIRECT, states=states, tag=tag)


def _balanced(computed: Signal) -> Signal:
    return Signal(BALANCED[computed.name], computed.unit, computed.low, computed.high, computed.about)
