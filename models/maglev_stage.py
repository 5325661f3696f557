"""Equations of motion of a platen levitated below four linear motors: three translations, two rotations.

                    ^ Z                     y  gap of the centre, positive down; x, z horizontal
                 [motor 3]                  phi, theta  rotations about X and Z
                                            (5) g1 = y - r sin phi,  g2 = y + r sin theta,
    [motor 4]    platen    [motor 2] --> X      g3 = y + r sin phi,  g4 = y - r sin theta
                                            u_x  quadrature current of motors 2 and 4
                 [motor 1]                  u_z  quadrature current of motors 1 and 3

With the forces F_H, F_V of `models.pmlsm` at each gap, the full model is

    (6) y''     = G + sum_j F_V(g_j) / M_y
        x''     = (F_H(g2) + F_H(g4)) / M_x,            z'' = (F_H(g1) + F_H(g3)) / M_z
    (7) phi''   = r (F_V(g3) - F_V(g1)) / I_x - k_s_phi phi
        theta'' = r (F_V(g2) - F_V(g4)) / I_z - k_s_theta theta

The last terms of (6) read -C_v3 (L_v3(g1) + L_v3(g3)) u_z^2 - C_v3 (L_v3(g2) + L_v3(g4)) u_x^2. Currents are rms.

Source: Fulford, Maggiore, Apkarian, "Control of a 5DOF Magnetically Levitated Positioning Stage", (5)-(8), (12).
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields
from math import pi, sqrt

import casadi as ca

from models import pmlsm, slotted_field
from synth.block import Constant
from synth.errors import ModelError
from synth.law import label
from synth.plant import Plant, build, symbols
from synth.signals import Parameter, Signal

Exprs = Mapping[str, ca.SX]

PEAK = 7 / sqrt(2)  # A rms: 7 A peak
SLIP = 1e-3  # m/s, the velocity scale of the guide friction's change of sign
TABLE = pmlsm.TABLE
PARAMETERS = (
    *pmlsm.PARAMETERS,
    Parameter("motor_separation", 0.4, "m", 1.25e-3, "Table I; enters no equation"),
    Parameter("M_x", 10.6, "kg", 5e-3, TABLE),
    Parameter("M_z", 8.6, "kg", 6e-3, TABLE),
    Parameter("M_y", 6.9, "kg", 8e-3, TABLE),
    Parameter("r", 0.397, "m", 1.3e-3, TABLE),
    Parameter("I_x", 0.5268, "kg m^2/rad", 1e-4, TABLE),
    Parameter("I_z", 0.5268, "kg m^2/rad", 1e-4, TABLE),
    Parameter("k_s_phi", 15000.0, "1/s^2", 0.3, "not printed: chosen below 35719, at which 5 A still reach 3 mrad"),
    Parameter("k_s_theta", 3000.0, "1/s^2", 0.3, "not printed: chosen below 9818, at which 5 A still reach 14 mrad"),
    Parameter("G", 9.81, "m/s^2", 3e-3, "standard gravity to three digits"),
)
STATES = (
    Signal("y", "m", 0.018, 0.031, "gap at the centre, x1"),
    Signal("vy", "m/s", -0.5, 0.5, "x2"),
    Signal("x", "m", -0.05, 0.05, "x3"),
    Signal("vx", "m/s", -1.0, 1.0, "x4"),
    Signal("z", "m", -0.05, 0.05, "x5"),
    Signal("vz", "m/s", -1.0, 1.0, "x6"),
    Signal("phi", "rad", -0.003, 0.003, "rotation about X, x7"),
    Signal("wphi", "rad/s", -0.5, 0.5, "x8"),
    Signal("theta", "rad", -0.014, 0.014, "rotation about Z, x9"),
    Signal("wtheta", "rad/s", -1.0, 1.0, "x10"),
)
RATE = {"y": "vy", "x": "vx", "z": "vz", "phi": "wphi", "theta": "wtheta"}
INPUTS = (
    *(Signal(f"i_d{j}", "A", -PEAK, PEAK, f"direct current of motor {j}, rms") for j in (1, 2, 3, 4)),
    *(Signal(f"u_{n}", "A", -PEAK, PEAK, f"thrust current along {n.upper()}, rms") for n in "xz"),
)
GAP_1_3, GAP_2_4 = (
    (0.0168, 0.0322),
    (0.0124, 0.0366),
)  # m: gaps of motors 1 and 3, 2 and 4, over the ranges of y and angles
OUTPUTS = (
    *(signal for signal in STATES if signal.name in RATE),
    *(Signal(f"g{j}", "m", *ends, f"gap of motor {j}") for j, ends in enumerate(2 * (GAP_1_3, GAP_2_4), 1)),
)
QUADRATURE = ("u_z", "u_x", "u_z", "u_x")  # of motors 1 to 4


def nominal(plant: Plant | None = None) -> dict[str, ca.SX]:
    """Return the parameters of `plant`, or the published ones, by name as constant expressions."""
    return {p.name: ca.SX(p.value) for p in (plant.parameters if plant else PARAMETERS)}


def gaps(x: Exprs, p: Exprs) -> tuple[ca.SX, ca.SX, ca.SX, ca.SX]:
    """Return g1..g4 in m from y in m and phi, theta in rad. Source: (5)."""
    phi, theta = p["r"] * ca.sin(x["phi"]), p["r"] * ca.sin(x["theta"])
    return x["y"] - phi, x["y"] + theta, x["y"] + phi, x["y"] - theta


def kinematics(y1: ca.SX, y2: ca.SX, y3: ca.SX, y4: ca.SX, r: ca.SX) -> dict[str, ca.SX]:
    """Return y in m and phi, theta in rad from the heights at the four motors in m; the inverse of (5).

    y = mean(y1..y4), sin phi = (y3 - y1)/(2 r), sin theta = (y2 - y4)/(2 r).
    """
    return {
        "y": (y1 + y2 + y3 + y4) / 4,
        "phi": ca.asin((y3 - y1) / (2 * r)),
        "theta": ca.asin((y2 - y4) / (2 * r)),
    }


def input_transformation(v: Exprs) -> dict[str, ca.SX]:
    """Return i_d1..i_d4 in A from v_y, v_phi, v_theta in A. Source: (8)."""
    return {
        "i_d1": (v["v_y"] + v["v_phi"]) / 2,
        "i_d2": (v["v_y"] - v["v_theta"]) / 2,
        "i_d3": (v["v_y"] - v["v_phi"]) / 2,
        "i_d4": (v["v_y"] + v["v_theta"]) / 2,
    }


def accelerations(x: Exprs, u: Exprs, p: Exprs, variant: pmlsm.Variant = pmlsm.STRESS) -> dict[str, ca.SX]:
    """Return y'', x'', z'' in m/s^2 and phi'', theta'' in rad/s^2 from y, phi, theta and the six currents.

    Source: (6), (7), with every quadratic term.
    """
    return motor_accelerations(x, [(u[f"i_d{j}"], u[name]) for j, name in enumerate(QUADRATURE, 1)], p, variant)


def motor_accelerations(
    x: Exprs, currents: Sequence[tuple[ca.SX, ca.SX]], p: Exprs, variant: pmlsm.Variant = pmlsm.STRESS
) -> dict[str, ca.SX]:
    """Return the `accelerations` from i_d and i_q of each of the four motors, in A rms."""
    motors = [(g, *pair) for g, pair in zip(gaps(x, p), currents, strict=True)]
    F_V = [pmlsm.normal_force(gap, i_d, i_q, p, variant) for gap, i_d, i_q in motors]
    F_H = [pmlsm.thrust(gap, i_q, p, variant) for gap, _, i_q in motors]
    return platen_accelerations(x, F_H, F_V, p)


def platen_accelerations(x: Exprs, F_H: Sequence[ca.SX], F_V: Sequence[ca.SX], p: Exprs) -> dict[str, ca.SX]:
    """Return the `accelerations` from thrust and normal force of each of the four motors, in N."""
    return {
        "y": p["G"] + sum(F_V) / p["M_y"],
        "x": (F_H[1] + F_H[3]) / p["M_x"],
        "z": (F_H[0] + F_H[2]) / p["M_z"],
        "phi": p["r"] * (F_V[2] - F_V[0]) / p["I_x"] - p["k_s_phi"] * x["phi"],
        "theta": p["r"] * (F_V[1] - F_V[3]) / p["I_z"] - p["k_s_theta"] * x["theta"],
    }


def factors(x: Exprs, u: Exprs, p: Exprs) -> dict[str, ca.SX]:
    """Return the factors of (1)-(4) and the normal forces F_V by motor, as `accelerations` has them; h = K_h L_h."""
    K = pmlsm.constants(p)
    named = {"k_w1": pmlsm.winding_factor(p), "K_v1": K.K_v1, "K_v3": K.K_v3, "K_h": K.K_h}
    for j, (g, thrust) in enumerate(zip(gaps(x, p), QUADRATURE, strict=True), 1):
        named |= {f"lambda_{j}": pmlsm.permeance_factor(g, p), f"K_c{j}": pmlsm.carter_coefficient(g, p)}
        named |= {f"B_{j}": pmlsm.magnet_field(g, p), f"F_V{j}": pmlsm.normal_force(g, u[f"i_d{j}"], u[thrust], p)}
        named[f"h_{j}"] = K.K_h * pmlsm.coefficients(g, p).L_h
    return named


def plant(lv3: str = "csch2") -> Plant:
    """Return the full model (5)-(7): ten states, six currents, outputs y, x, z, phi, theta and the motors' gaps.

    `lv3` is "csch2" or, as printed, "coth2".

    Raises ModelError for another `lv3`.
    """
    variant = force_variant(lv3)

    def physics(x: Exprs, u: Exprs, p: Exprs) -> tuple[dict[str, ca.SX], dict[str, ca.SX]]:
        return motion(x, accelerations(x, u, p, variant), p)

    return build("maglev_stage", STATES, INPUTS, OUTPUTS, PARAMETERS, physics)


@dataclass(frozen=True, eq=False)
class DirectCurrents:
    """The direct currents in A by name, and halves of the forces in N that they make: n, d, e, f_1 + f_3, f_2 + f_4."""

    currents: dict[str, ca.SX]
    half_forces: dict[str, ca.SX]


def motion(x: Exprs, second: Exprs, p: Exprs) -> tuple[dict[str, ca.SX], dict[str, ca.SX]]:
    """Return the derivatives by state and the outputs by name, from the accelerations of `accelerations`."""
    derivative = {q: x[v] for q, v in RATE.items()} | {v: second[q] for q, v in RATE.items()}
    return derivative, {q: x[q] for q in RATE} | {f"g{j}": g for j, g in enumerate(gaps(x, p), 1)}


def numbers(plant: Plant, compensated: Mapping[str, float]) -> list[Constant]:
    """Return the numbers of the currents that the C names; `compensated` are the parts of the springs in the law."""
    half_forces = {
        "half_M_y": ("kg", lambda p: p["M_y"] / 2),
        "half_I_x_over_r": ("kg m/rad", lambda p: p["I_x"] / (2 * p["r"])),
        "half_I_z_over_r": ("kg m/rad", lambda p: p["I_z"] / (2 * p["r"])),
    }
    springs = {f"compensated_{n}": ("1/s^2", lambda p, n=n, part=part: part * p[n]) for n, part in compensated.items()}
    return [
        *(plant.constant(name) for name in ("M_x", "M_z", "G")),
        *(plant.constant(name, unit, formula) for name, (unit, formula) in (half_forces | springs).items()),
    ]


def inverse_masses(plant: Plant) -> list[Constant]:
    """Return 1 / M_x and 1 / M_z, which the C of `thrust_accelerations` names."""
    return [
        plant.constant("inverse_M_x", "1/kg", lambda p: 1 / p["M_x"]),
        plant.constant("inverse_M_z", "1/kg", lambda p: 1 / p["M_z"]),
    ]


def direct_currents(
    w: Exprs, x: Exprs, squares: Sequence[ca.SX], motors: Sequence[pmlsm.ForceLaw], p: Exprs
) -> DirectCurrents:
    """Return i_d1..i_d4 in A for which y'', phi'', theta'' = `w`, by (8) and (12) with given `squares` i_d^2 + i_q^2.

    With the forces f_j = b_j i_dj, which carry the loads a_j + c_j (i_d^2 + i_q^2)_j and accelerate,

        f_1 + f_2 + f_3 + f_4 = n,    f_3 - f_1 = d,    f_2 - f_4 = e,    i_d1 + i_d3 = i_d2 + i_d4

    where the last is (8). This is one linear equation in f_1 + f_3. The code computes halves of all forces. `w` holds
    y, phi and theta in m/s^2 and rad/s^2, `x` holds phi and theta in rad, `squares` and `motors` go by motor.
    """
    half = [m.half_a + m.half_c * square for m, square in zip(motors, squares, strict=True)]  # of the loads
    s1, s2, s3, s4 = (1 / m.b for m in motors)
    forces = half_forces(w, x, half, (s1, s2, s3, s4), p)
    _, d, e, odd, even = forces.values()
    currents = {"i_d1": s1 * (odd - d), "i_d2": s2 * (even + e), "i_d3": s3 * (odd + d), "i_d4": s4 * (even - e)}
    label(d=d, s1=s1, s2=s2, s3=s3, s4=s4, e=e, half=half)
    return DirectCurrents(currents, forces)


def half_forces(w: Exprs, x: Exprs, half: Sequence[ca.SX], shares: Sequence[ca.SX], p: Exprs) -> dict[str, ca.SX]:
    """Return the halves of n, d, e, f_1 + f_3 and f_2 + f_4 in N of `direct_currents`, from the halves of the loads.

    `shares` are the s_j by motor under which s_1 f_1 + s_3 f_3 = s_2 f_2 + s_4 f_4.
    """
    s1, s2, s3, s4 = shares
    n = p["M_y"] / 2 * (w["y"] - p["G"]) + (half[0] + half[1] + half[2] + half[3])
    d = p["I_x"] / (2 * p["r"]) * (w["phi"] + p["k_s_phi"] * x["phi"]) + (half[2] - half[0])
    e = p["I_z"] / (2 * p["r"]) * (w["theta"] + p["k_s_theta"] * x["theta"]) + (half[1] - half[3])
    odd = ((s2 + s4) * n + (s2 - s4) * e - (s3 - s1) * d) / (s1 + s3 + (s2 + s4))
    even = n - odd
    label(s1=s1, s2=s2, s3=s3, s4=s4)
    return {
        "half_force": n,
        "half_force_phi": d,
        "half_force_theta": e,
        "half_force_1_3": odd,
        "half_force_2_4": even,
    }


def thrust_currents(w: Exprs, motors: Sequence[pmlsm.ForceLaw], p: Exprs) -> dict[str, ca.SX]:
    """Return u_x, u_z in A for which x'', z'' = `w` in m/s^2. Source: (12)."""
    h = [m.h for m in motors]
    h_x, h_z = h[1] + h[3], h[0] + h[2]
    label(h_x=h_x, h_z=h_z)
    return {"u_x": -p["M_x"] * w["x"] / h_x, "u_z": -p["M_z"] * w["z"] / h_z}


def thrust_accelerations(u: Exprs, motors: Sequence[pmlsm.ForceLaw], p: Exprs) -> dict[str, ca.SX]:
    """Return x'', z'' in m/s^2 by the thrust currents u_x, u_z in A, by axis. Source: (6)."""
    h = [m.h for m in motors]
    return {"x": -u["u_x"] * (h[1] + h[3]) / p["M_x"], "z": -u["u_z"] * (h[0] + h[2]) / p["M_z"]}


def parameter_symbols() -> dict[str, ca.SX]:
    """Return one symbol for each parameter, by name."""
    return symbols(PARAMETERS)


def force_variant(lv3: str) -> pmlsm.Variant:
    """Return the variant with the factor "csch2" or "coth2" in L_v3; raise ModelError for another name."""
    if lv3 == "csch2":
        return pmlsm.Variant("csch2")
    if lv3 == "coth2":
        return pmlsm.Variant("coth2")
    raise ModelError(f"the factor in L_v3 is named '{lv3}': choose 'csch2', or 'coth2' as printed")


def geometry(plant: Plant) -> slotted_field.Geometry:
    """Return a motor of the slotted field from the plant's parameters."""
    known = [f.name for f in fields(slotted_field.Geometry)]
    shared = {p.name: p.value for p in plant.parameters if p.name in known}
    return slotted_field.Geometry(poles=plant.parameter("p").value, **shared)


def guide_disturbance(plant: Plant, friction: Mapping[str, float], cells: int) -> ca.Function:
    """Return the accelerations (10,) by guide friction and cogging as a function of the state (10,) and t in s.

    F_s = -F_c tanh(v_s/SLIP) + 2 A(y) sin(2 pi s/t1), s = x, z, with F_c in N by axis; A is the geometric
    interpolation of the cogging of the slotted field at 20 and 25 mm, on a grid of `cells`.
    """
    names = [s.name for s in plant.states]
    x, t = ca.SX.sym("x", len(names)), ca.SX.sym("t")
    state = dict(zip(names, ca.vertsplit(x), strict=True))
    at_20, at_25 = (slotted_field.forces(geometry(plant), g, cells).cogging for g in (0.020, 0.025))
    amplitude = at_20 * (at_25 / at_20) ** ((state["y"] - 0.020) / 0.005)
    added = dict.fromkeys(names, ca.SX(0))
    for axis, force in friction.items():
        wave = ca.sin(2 * pi * state[axis] / plant.parameter("t1").value)
        total = -force * ca.tanh(state[f"v{axis}"] / SLIP) + 2 * amplitude * wave
        added[f"v{axis}"] = total / plant.parameter(f"M_{axis}").value
    return ca.Function("guides", [x, t], [ca.vcat(list(added.values()))])
