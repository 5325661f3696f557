"""From forces and torques on the platen to the phase currents of its three motors, and what the limits leave of them.

    w = T F       w = (f_x, f_y, m_phi, f_z, m_theta, m_psi) in the platen's frame       Table 3 with arms
                  F = (f_Ay, f_By, f_Cx, f_Az, f_Bz, f_Cz), f = K i                      (17)

            x   y  phi  z theta psi        where the motor's centre is along its motion
    f_Ay    0   1  -a   0   0    0         A, at (-a, -b) of the platen:   y - b cos phi - a sin phi
    f_By    0   1   a   0   0    0         B, at ( a, -b):                 y - b cos phi + a sin phi
    f_Cx    1   0  -c   0   0    0         C, at ( 0,  c):                 x - c sin phi
    f_Az    0   0   0   1  -b    a
    f_Bz    0   0   0   1  -b   -a
    f_Cz    0   0   0   1   c    0

Demands f_x, f_y come in the matrix' frame and are turned by phi. K is that of the Lorentz integral; (17) as printed is
pi/3 of it. It is taken at the nominal gap: a lift by z makes the force exp(-gamma z) of the demand, 2.4 % at 0.2 mm.

Limits. Each motor keeps hypot(i_Q, i_D) <= 1.26 A, so that no phase exceeds it. Horizontal currents come first, up to
QUADRATURE of the limit: nothing but them holds x, y and phi, while the air bearings carry the stage and hold z, theta
and psi by their stiffness. What i_Q leaves to i_D is never less than 31 % of the limit, so that the vertical loops stay
closed. `made_*` are the forces and torques that the limited currents make, for anti-windup.

Source: Yu, Kim, section 5.1, (17), Table 3.
"""

from dataclasses import replace
from math import pi, sqrt

import casadi as ca
import numpy as np

from models import lorentz_motor, planar_stage
from synth.block import Block, Constant, Exprs, Step, build, clip
from synth.plant import Plant
from synth.signals import Signal
from synth.statespace import Array, readonly
from synth.timing import Discrete

LIMIT = planar_stage.LIMIT  # A
QUADRATURE = 0.95 * LIMIT  # A: the slope of what it leaves is at most 3.1
REACH = 0.7  # of a pitch: how far the pose may be from the middle of the pitch of the raw position, before clipping
AXES = planar_stage.AXES
HORIZONTAL, VERTICAL = AXES[:3], AXES[3:]
PITCHES = 3  # of the matrix, to either side
BOX = {s.name: s for s in planar_stage.STATES}
UNITS = {"x": "N", "y": "N", "phi": "N m", "z": "N", "theta": "N m", "psi": "N m"}
DEMANDS = tuple(
    Signal(f"{'f' if unit == 'N' else 'm'}_{axis}", unit, -1e5, 1e5, "demanded of the motors")
    for axis, unit in UNITS.items()
)
MADE = tuple(
    replace(s, name=f"made_{axis}", about="by the limited currents") for axis, s in zip(AXES, DEMANDS, strict=True)
)
CURRENTS = tuple(
    Signal(f"i_{motor}{axis}", "A", -bound, bound, f"{what} current of motor {motor}, peak of a phase")
    for axis, bound, what in (("Q", QUADRATURE, "quadrature"), ("D", LIMIT, "direct"))
    for motor in planar_stage.MOTORS
)
PHASES = planar_stage.INPUTS
COMPUTED = tuple(replace(s, name=f"{s.name}_computed") for s in PHASES)
POSE = tuple(BOX[axis] for axis in HORIZONTAL)
PITCH = tuple(
    Signal(f"pitch_{axis}", "1", -PITCHES, PITCHES, f"whole pitches along {axis.upper()} from the middle")
    for axis in "xy"
)


def force_constant(plant: Plant) -> float:
    """Return K in N/A, the Lorentz integral's."""
    return float(lorentz_motor.force_constant({p.name: ca.SX(p.value) for p in plant.parameters}))


def wrench(plant: Plant) -> Array:
    """Return T (6, 6) from f_Ay, f_By, f_Cx, f_Az, f_Bz, f_Cz in N to forces in N and torques in N m on the platen."""
    a, b, c = (plant.parameter(name).value for name in "abc")
    rows: list[list[float]] = [
        [0, 0, 1, 0, 0, 0],
        [1, 1, 0, 0, 0, 0],
        [-a, a, -c, 0, 0, 0],
        [0, 0, 0, 1, 1, 1],
        [0, 0, 0, -b, -b, c],
        [0, 0, 0, a, -a, 0],
    ]
    return readonly(rows)


def shares(plant: Plant) -> Array:
    """Return the inverse of `wrench` (6, 6): the motors' forces for demands in the platen's frame."""
    a, b, c = (plant.parameter(name).value for name in "abc")
    h, front = 1 / (2 * a), c / (2 * (b + c))
    rows: list[list[float]] = [
        [-c * h, 0.5, -h, 0, 0, 0],
        [c * h, 0.5, h, 0, 0, 0],
        [1, 0, 0, 0, 0, 0],
        [0, 0, 0, front, -0.5 / (b + c), h],
        [0, 0, 0, front, -0.5 / (b + c), -h],
        [0, 0, 0, b / (b + c), 1 / (b + c), 0],
    ]
    return readonly(rows)


def authority(plant: Plant) -> dict[str, float]:
    """Return for each axis the force in N or torque in N m that the motors make of it with LIMIT each, and no more."""
    most = force_constant(plant) * LIMIT * np.abs(wrench(plant)).sum(axis=1)
    return dict(zip(AXES, most.tolist(), strict=True))


def allocation(plant: Plant, time: Discrete) -> Block:
    """Return the Block from demands and phi to the motors' limited currents and what these make of each axis."""
    constants, phi = _constants(plant), BOX["phi"]
    a, c = (plant.parameter(name).value for name in "ac")

    def law(u: Exprs, x: Exprs, k: Exprs) -> Step:
        angle = clip(u["phi"], phi)
        cos, sin = ca.cos(angle), ca.sin(angle)
        f_x, f_y, m_phi, f_z, m_theta, m_psi = (u[s.name] for s in DEMANDS)
        wanted_c = k["of_x"] * (cos * f_x + sin * f_y)
        half = k["of_y"] * (cos * f_y - sin * f_x)
        turn = k["of_phi"] * m_phi + (wanted_c if c == 2 * a else c / (2 * a) * wanted_c)
        front, roll = k["front_of_z"] * f_z - k["front_of_theta"] * m_theta, k["of_psi"] * m_psi
        rear = k["rear_of_z"] * f_z + k["rear_of_theta"] * m_theta
        currents = A, B, C, Az, Bz, Cz = _limited(
            [half - turn, half + turn, wanted_c, front + roll, front - roll, rear]
        )
        over_x, over_y = k["force"] * C, k["force"] * (A + B)
        made = (
            cos * over_x - sin * over_y,
            sin * over_x + cos * over_y,
            k["side_arm"] * (B - A) - k["rear_arm"] * C,
            k["force"] * (Az + Bz + Cz),
            k["rear_arm"] * Cz - k["front_arm"] * (Az + Bz),
            k["side_arm"] * (Az - Bz),
        )
        return Step(dict(zip((s.name for s in (*CURRENTS, *MADE)), (*currents, *made), strict=True)))

    inputs, outputs, tag = [*DEMANDS, phi], [*CURRENTS, *MADE], "Table 3, (17), limits"
    return build("allocation", time, law, inputs=inputs, outputs=outputs, constants=constants, tag=tag)


def _constants(plant: Plant) -> list[Constant]:
    """Return the numbers of `shares` over K and of `wrench` times K, each once."""
    K, T = force_constant(plant), wrench(plant) * force_constant(plant)
    S = shares(plant) / K
    per_force, per_torque = (
        (
            ("of_x", S[2, 0], "1/K"),
            ("of_y", S[0, 1], "1/(2 K)"),
            ("front_of_z", S[3, 3], "c/(2 (b + c) K)"),
            ("rear_of_z", S[5, 3], "b/((b + c) K)"),
        ),
        (
            ("of_phi", S[1, 2], "1/(2 a K)"),
            ("of_psi", S[3, 5], "1/(2 a K)"),
            ("front_of_theta", -S[3, 4], "1/(2 (b + c) K)"),
            ("rear_of_theta", S[5, 4], "1/((b + c) K)"),
        ),
    )
    forces = (("force", K, "K"),)
    arms = (("side_arm", T[2, 1], "K a"), ("front_arm", -T[4, 3], "K b"), ("rear_arm", T[4, 5], "K c"))
    units = ((per_force, "A/N"), (per_torque, "A/N/m"), (forces, "N/A"), (arms, "N m/A"))
    return [Constant(n, float(v), unit, f"Table 3, (17): {what}") for group, unit in units for n, v, what in group]


def _limited(wanted: list[ca.SX]) -> list[ca.SX]:
    """Return i_Q of the three motors, then i_D within what i_Q leaves; the root is of 0.15 A^2 or more."""
    i_q = [clip(i, s) for i, s in zip(wanted[:3], CURRENTS[:3], strict=True)]
    room = [ca.sqrt(LIMIT**2 - i**2) for i in i_q]
    return [*i_q, *(ca.fmax(ca.fmin(i, r), -r) for i, r in zip(wanted[3:], room, strict=True))]


def commutation(plant: Plant, time: Discrete) -> Block:
    """Return the Block from the motors' currents, the pose and the whole pitches to the nine phase currents.

    The angle comes from the distance to the middle of the pitch, clipped to REACH: in quarters its sine and cosine have
    no zero but that of the sine at 0, and two doublings make it whole. Motors A and B lie b behind: that many quarters
    of a pitch are turned without arithmetic, and the rest is part of the distance.
    """
    l, a, b, c = (plant.parameter(name).value for name in ("l", "a", "b", "c"))
    turns = round(4 * b / l)

    def law(u: Exprs, x: Exprs, k: Exprs) -> Step:
        phi = clip(u["phi"], BOX["phi"])
        behind = b * ca.cos(phi) - turns * l / 4
        back, named = _angle("back", u["x"] - l * u["pitch_x"] - c * ca.sin(phi), l)
        front, more = _angle("front", u["y"] - l * u["pitch_y"] - behind, l)
        for _ in range(turns):
            front = (front[1], -front[0])
        yaw = 2 * pi / l * a * ca.sin(phi)
        (cos, sin), (cy, sy) = front, (ca.cos(yaw), ca.sin(yaw))
        cc, ss, cs, sc = cos * cy, sin * sy, cos * sy, sin * cy
        angles = {"A": (cc + ss, sc - cs), "B": (cc - ss, sc + cs), "C": back}
        output: dict[str, ca.SX] = {}
        for motor, (cos, sin) in angles.items():
            i_q, i_d = u[f"i_{motor}Q"], u[f"i_{motor}D"]
            alpha, beta = cos * i_q - sin * i_d, sqrt(3) / 2 * (sin * i_q + cos * i_d)
            phases = (alpha, beta - alpha / 2, -beta - alpha / 2)
            output |= {f"i_{motor}{p}_computed": i for p, i in zip(lorentz_motor.OFFSETS, phases, strict=True)}
        return Step(output, named=[*named, *more])

    return build("commutation", time, law, inputs=[*CURRENTS, *POSE, *PITCH], outputs=COMPUTED, tag="(17) inverted")


def _angle(name: str, distance: ca.SX, l: float) -> tuple[tuple[ca.SX, ca.SX], list[tuple[Signal, ca.SX]]]:
    """Return cosine and sine of 2 pi / l times a distance in m, and the functions of the quarter q that make them.

    With h = sin q cos q: cos 4q = 1 - 8 h^2, sin 4q = h (4 - 8 sin^2 q).
    """
    reach = Signal(f"distance_{name}", "m", -REACH * l, REACH * l, "to the middle of the pitch")
    within = clip(distance, reach)
    sin, cos = ca.sin(pi / (2 * l) * within), ca.cos(pi / (2 * l) * within)
    h = sin * cos
    kept = [(Signal(f"{what}_{name}", "1", -1, 1), e) for what, e in (("quarter_sine", sin), ("quarter_cosine", cos))]
    return (1 - 8 * h**2, h * (4 - 8 * sin**2)), [(reach, within), *kept]
