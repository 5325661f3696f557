"""Allocation of forces and torques on the platen to its three motors under current limits, and their commutation.

    w = T F       w = (f_x, f_y, m_phi, f_z, m_theta, m_psi) in the platen's frame       Table 3 with arms
                  F = (f_Ay, f_By, f_Cx, f_Az, f_Bz, f_Cz), f = K i                      (17)

            x   y  phi  z theta psi        where the motor's centre is along its motion
    f_Ay    0   1  -a   0   0    0         A, at (-a, -b) of the platen:   y - b cos phi - a sin phi
    f_By    0   1   a   0   0    0         B, at ( a, -b):                 y - b cos phi + a sin phi
    f_Cx    1   0  -c   0   0    0         C, at ( 0,  c):                 x - c sin phi
    f_Az    0   0   0   1  -b    a
    f_Bz    0   0   0   1  -b   -a
    f_Cz    0   0   0   1   c    0

K is that of the Lorentz integral, at the nominal gap; (17) as printed is pi/3 times as large. At a lift z the force is
exp(-gamma z) times the demand, 2.4 % less at 0.2 mm.

The control laws demand currents d = w / scale. What remains of T and K are ratios of arms, most of them 1 or 1/2:

    scale   x, y: K    phi, psi: 2 a K    z: 2 (b + c) K / c    theta: 2 (b + c) K

    i_CQ = d_x',   i_AQ, i_BQ = d_y'/2 -+ (d_phi + c/(2 a) d_x'),   i_AD, i_BD = d_z - d_theta +- d_psi,
    i_CD = 2 b/c d_z + 2 d_theta

d_x, d_y are in the frame of the matrix and are rotated by phi into d_x', d_y' of the platen.

Limits. Each motor keeps |i_Q| <= QUADRATURE and |i_D| <= DIRECT. Then hypot(i_Q, i_D) <= 1.26 A, and no phase exceeds
1.26 A. DIRECT suffices to hold theta and psi at 2 mrad against their springs at the same time. i_CQ is limited first,
to QUADRATURE less |d_phi| but at least to half of QUADRATURE, because A and B must compensate the torque of C. If less
were reserved for the yaw, the platen would keep turning while C is at its limit. If more were, yaw noise would limit C.
The limited i_CQ replaces d_x' in the currents of A and B. There the yaw has priority over y: a platen that turns too
far loses its position measurement, a platen that lags behind does not. `achieved_*` are the demands that the limited
currents achieve, for anti-windup.

Source: Yu, Kim, section 5.1, (17), Table 3.
"""

from dataclasses import replace
from math import hypot, pi, sqrt

import casadi as ca
import numpy as np

from designs.planar_6dof.sensing import sections
from models import lorentz_motor, planar_stage
from models.planar_stage import force_constant, wrench
from synth.block import Block, Constant, Exprs, Step, build, clip
from synth.law import label
from synth.plant import Plant
from synth.signals import Signal
from synth.timing import Discrete

LIMIT = planar_stage.LIMIT  # A
QUADRATURE = 0.9 * LIMIT  # A
ROUNDING_MARGIN = 3e-5  # of LIMIT: what rounding and polynomials may add to a phase, see `_phase`
DIRECT = sqrt(((1 - ROUNDING_MARGIN) * LIMIT) ** 2 - QUADRATURE**2)  # A
AXES = planar_stage.AXES
HORIZONTAL, VERTICAL = AXES[:3], AXES[3:]
ROUNDING = 1e-14  # largest deviation of a ratio of arms that counts as 1
BOX = {s.name: s for s in planar_stage.STATES}
YAW = replace(BOX["phi"], low=-0.075, high=0.075)  # rad: range of the filtered yaw for raw yaws within 0.025
DEMANDS = tuple(Signal(f"d_{axis}", "A", -1e5, 1e5, f"demand of {axis} over its scale") for axis in AXES)
ACHIEVED = tuple(
    replace(s, name=f"achieved_{axis}", about="demand that the limited currents achieve")
    for axis, s in zip(AXES, DEMANDS, strict=True)
)
CURRENTS = tuple(
    Signal(f"i_{motor}{axis}", "A", -bound, bound, f"{what} current of motor {motor}, peak of a phase")
    for axis, bound, what in (("Q", QUADRATURE, "quadrature"), ("D", DIRECT, "direct"))
    for motor in planar_stage.MOTORS
)
PHASES = planar_stage.INPUTS
COMPUTED = tuple(replace(s, name=f"{s.name}_computed") for s in PHASES)
PITCH = planar_stage.plant().parameter("l").value
WITHIN = sections.WITHIN


def scales(plant: Plant) -> dict[str, float]:
    """Return the force in N or torque in N m of a demand of 1 A, by axis."""
    a, b, c = (plant.parameter(name).value for name in "abc")
    side, lever = 2 * a, 2 * (b + c)
    arms = {"x": 1.0, "y": 1.0, "phi": side, "z": lever / c, "theta": lever, "psi": side}
    return {axis: force_constant(plant) * arm for axis, arm in arms.items()}


def authority(plant: Plant) -> dict[str, float]:
    """Return the largest demand in A that the motors can meet, each with LIMIT, by axis."""
    most = force_constant(plant) * LIMIT * np.abs(wrench(plant)).sum(axis=1)
    return {axis: float(w) / scale for w, (axis, scale) in zip(most, scales(plant).items(), strict=True)}


def achievable_bound(plant: Plant) -> dict[str, float]:
    """Return a bound in A on the achieved demand of each axis, for every yaw within YAW."""
    most = authority(plant)
    return most | {"x": most["x"] + YAW.high * most["y"], "y": most["y"] + YAW.high * most["x"]}


def allocation(plant: Plant, time: Discrete, phi: Signal = YAW) -> Block:
    """Return the Block from demands and the yaw `phi` to limited currents and the demands that these achieve."""
    a, b, c = (plant.parameter(name).value for name in "abc")
    across, rear = c / (2 * a), 2 * b / c
    constants = [
        Constant("psi_share", 0.5, "1", "Table 3: 1/2, of i_AD - i_BD in d_psi"),
        Constant("two", 2.0, "1", "Table 3: both motors"),
        plant.constant("z_share", "1", lambda p: p["c"] / (2 * (p["b"] + p["c"]))),
        plant.constant("rear_share", "1", lambda p: p["c"] / (2 * (p["b"] + p["c"]))),
        plant.constant("front_share", "1", lambda p: p["b"] / (2 * (p["b"] + p["c"]))),
    ]
    notes = [
        "allocation_z_share, c / (2 (b + c)), and allocation_psi_share, 1/2, make the achieved d_z and d_psi of the "
        "direct currents. Factors that are 1 with these arms are left out: c / (2 a) of i_CQ in d_phi, and 2 b / c of "
        "d_z in i_CD. The 2 of d_theta there stands for both motors at the front."
    ]

    def law(u: Exprs, x: Exprs, k: Exprs) -> Step:
        angle = clip(u[phi.name], YAW)
        cos, sin = ca.cos(angle), ca.sin(angle)
        d_x, d_y, d_phi, d_z, d_theta, d_psi = (u[s.name] for s in DEMANDS)
        demand_c = cos * d_x + sin * d_y
        y_current = (cos * d_y - sin * d_x) / 2
        limit_c = ca.fmax(QUADRATURE - ca.fabs(d_phi), QUADRATURE / 2)
        C = ca.fmax(ca.fmin(demand_c, limit_c), -limit_c)
        yaw_current = clip(d_phi + _product(across, C), CURRENTS[0])
        limit_y = QUADRATURE - ca.fabs(yaw_current)
        y_current = ca.fmax(ca.fmin(y_current, limit_y), -limit_y)
        front_current, rear_current = d_z - d_theta, _product(rear, d_z) + 2 * d_theta
        Az, Bz, Cz = (clip(i, CURRENTS[3]) for i in (front_current + d_psi, front_current - d_psi, rear_current))
        currents = y_current - yaw_current, y_current + yaw_current, C, Az, Bz, Cz
        y_currents, lifts = k["two"] * y_current, Az + Bz
        achieved = (
            cos * C - sin * y_currents,
            sin * C + cos * y_currents,
            yaw_current - _product(across, C),
            k["z_share"] * (lifts + Cz),
            k["rear_share"] * Cz - k["front_share"] * lifts,
            k["psi_share"] * (Az - Bz),
        )
        output = dict(zip((s.name for s in (*CURRENTS, *ACHIEVED)), (*currents, *achieved), strict=True))
        label(
            angle=angle, y_current=y_current, limit_c=limit_c, C=C, yaw_current=yaw_current, limit_y=limit_y,
            front_current=front_current, rear_current=rear_current, y_currents=y_currents, lifts=lifts,
        )  # fmt: skip
        return Step(output, numbers=_current_limits(), notes=notes)

    inputs, outputs, tag = [*DEMANDS, phi], [*CURRENTS, *ACHIEVED], "motor currents, Table 3, (17)"
    return build("allocation", time, law, inputs=inputs, outputs=outputs, constants=constants, tag=tag)


def _current_limits() -> list[Constant]:
    return [
        Constant("quadrature_limit", QUADRATURE, "A", f"largest quadrature current of a motor, 0.9 of {LIMIT:g} A"),
        Constant("half_quadrature_limit", QUADRATURE / 2, "A", "what the yaw leaves to motor C"),
        Constant(
            "direct_limit", DIRECT, "A", f"largest direct current of a motor: both together stay below {LIMIT:g} A"
        ),
    ]


def _product(ratio: float, value: ca.SX) -> ca.SX:
    """Return ratio * value; a ratio of 1, as for the printed arms, costs no operation."""
    return value if abs(ratio - 1) < ROUNDING else ratio * value


def commutation(plant: Plant, time: Discrete, phi: Signal = YAW) -> Block:
    """Return the Block from the motors' currents, the place within the pitch and the yaw `phi` to nine phase currents.

    The electrical angle follows from the distance to the middle of the pitch. A quarter of it is at most 50 degrees,
    for which cos = sqrt(1 - sin^2); two angle doublings give the whole angle. Motors A and B lie b behind the centre.
    Whole quarter pitches of b are rotations by 90 degrees, which cost no operation; the remainder is added to the
    distance.
    """
    l, a, b, c = (plant.parameter(name).value for name in ("l", "a", "b", "c"))
    turns = round(4 * b / l)
    numbers = [
        *(plant.constant(name) for name in "bc"),
        Constant("quarter_pitch", l / 4, "m", "a quarter of the pitch"),
        Constant("whole_quarters", turns * l / 4, "m", "whole quarters of the pitch in b"),
    ]

    def law(u: Exprs, x: Exprs, k: Exprs) -> Step:
        angle = clip(u[phi.name], YAW)
        behind = b * ca.cos(angle) - turns * l / 4
        back, named = _cos_sin("rear", u["within_x"] - c * ca.sin(angle), l)
        front, named_front = _cos_sin("front", u["within_y"] - behind, l)
        for _ in range(turns):
            front = (front[1], -front[0])
        aside = 2 * pi / l * a * ca.sin(angle)
        (cos, sin), (cos_aside, sin_aside) = front, (ca.cos(aside), ca.sin(aside))
        cc, ss, cs, sc = cos * cos_aside, sin * sin_aside, cos * sin_aside, sin * cos_aside
        angles = {"A": (cc + ss, sc - cs), "B": (cc - ss, sc + cs), "C": back}
        output: dict[str, ca.SX] = {}
        for motor, (cos, sin) in angles.items():
            i_q, i_d = u[f"i_{motor}Q"], u[f"i_{motor}D"]
            alpha, beta = clip(cos * i_q - sin * i_d, PHASES[0]), sqrt(3) / 2 * (sin * i_q + cos * i_d)
            middle = k["minus_half"] * alpha
            phases = (alpha, clip(middle + beta, PHASES[0]), clip(middle - beta, PHASES[0]))
            output |= {f"i_{motor}{p}_computed": i for p, i in zip(lorentz_motor.PHASE_OFFSETS, phases, strict=True)}
            label(motor, cos=cos, sin=sin, beta=beta, middle=middle)
        certified = dict.fromkeys(output, _phase_bound)
        label(behind=behind, cos_aside=cos_aside, sin_aside=sin_aside, cc=cc, cs=cs)
        return Step(output, named=[*named, *named_front], certified=certified, numbers=numbers)

    return build(
        "commutation",
        time,
        law,
        inputs=[*CURRENTS, *WITHIN, phi],
        outputs=COMPUTED,
        constants=[Constant("minus_half", -0.5, "1", "(17): cos 120 degrees")],
        tag="phase currents, (17) inverted",
    )


def _phase_bound(u: float, e: float) -> float:
    """Return a bound on a phase current in A, for a relative rounding error u and a relative error e of the sines.

    The two doublings make a unit vector of any sine, so its error e only affects the angle. Rounding changes the length
    of this vector by at most 18 u while 1 - sin^2 >= 0.4. The vector of the yaw is longer by at most e, its product
    with the other by 3 u, i_Q and i_D by 2 u. A current vector of length R has phases of at most R (1 + 6 u).
    """
    return hypot(QUADRATURE, DIRECT) * (1 + e) * (1 + 32 * u)


def _cos_sin(name: str, distance: ca.SX, l: float) -> tuple[tuple[ca.SX, ca.SX], list[tuple[Signal, ca.SX]]]:
    """Return cosine and sine of 4 q = 2 pi / l times a distance in m, and the named expressions of the quarter angle q.

    With h = sin q cos q: cos 4q = 1 - 8 h^2, sin 4q = h (4 - 8 sin^2 q).
    """
    quarter_sine = ca.sin(pi / (2 * l) * distance)
    h = quarter_sine * ca.sqrt(1 - quarter_sine**2)
    cosine, sine = 1 - 8 * h**2, h * (4 - 8 * quarter_sine**2)
    named = [
        (Signal(f"distance_{name}", "m", -l, l, "distance to the middle of the pitch"), distance),
        (Signal(f"quarter_sine_{name}", "1", -1, 1), quarter_sine),
    ]
    label(name, h=h, cos=cosine, sin=sine)
    return (cosine, sine), named
