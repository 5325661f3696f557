"""Which Hall voltages are suspected once the residuals of `sections` contradict each other.

    rho = ((m_x^2 + m_y^2) / (EXCESS_BOUND A^2)^2 + (r_1^2 + r_2^2) / (RESIDUAL_BOUND A)^2)^(1/2)

m_x and m_y are the squared amplitudes of the two pairs less the nominal one, r_1 and r_2 the differences of parallel
voltages less what the predicted yaw makes of them, s_x and s_y the sine voltages, A the amplitude (V_0 in the C, where
A is the ampere).

A residual is significant if it exceeds the fraction SIGNIFICANT of its bound. If the first rho exceeds JUMP, a voltage
has jumped. An error -r_2 of V_ax reduces s_x^2 by d_x = r_2 (2 s_x + r_2), and a wrong V_bx shows in r_2 through h_2.
Therefore these are suspected, and the other three likewise with r_1, m_y, s_y:

    V_ax, V_ay   if r_2 is significant, and m_x is not nearly zero or d_x is small
    V_bx, V_cy   if |m_x| exceeds |d_x| by more than NEARLY_ZERO A^2
    V_cx, V_by   if r_2 is significant, and m_x is nearly zero

Otherwise the error has grown slowly and the yaw has followed it, which distributes the error of one sensor over r_1 and
r_2. Then the four voltages of r_1 and r_2 are all suspected, and V_ax and V_bx by m_x, V_ay and V_cy by m_y. All six
are suspected if both m_x and m_y are significant, or if the yaw is beyond MAX_KNOWN_YAW.

Common amplitude. Where m_x and m_y are significant and differ by less than MAX_SPREAD of their sum, and r_1 and r_2 are
not significant, no single voltage explains the contradiction: the amplitude of all voltages differs from that of the
field. All six are suspected: every cause of a latch is in the fault word.

Motion alone. Where innovations of predictions from the forces raise rho above 1 and the four residuals do not, all six
are suspected: residuals within their bounds do not tell which voltage is wrong.

Source: Yu, Kim, section 3.1, which detects no failures.
"""

import casadi as ca

from synth.block import Constant, Exprs
from synth.law import label

# Noise of 5e-5 m rms in a position is 0.62 % of A in a voltage, 1.0 % in r_1, r_2 and 1.1 % in m_x, m_y.
RESIDUAL_BOUND = 0.08  # of A: six times the noise, and 2 % for unequal sensors and heights
EXCESS_BOUND = 0.15  # of A^2: five times the noise, 5 % for a lift by 0.2 mm and 4 % for the sensors' height
SIGNIFICANT = {"m": 0.2, "r": 0.3}  # of EXCESS_BOUND and of RESIDUAL_BOUND
JUMP = 1.5  # of rho: a larger one at once means that a voltage jumped
NEARLY_ZERO, SMALL_CHANGE = 0.1, 0.3  # of A^2: of m, and of the change of s^2 that r explains
MAX_SPREAD = 0.25  # of the sum of m_x and m_y: their difference where the amplitude of all voltages is off
MAX_KNOWN_YAW = 0.01  # rad
INNOVATION_BOUND = 6e-4  # m, of x and y
# The part of the yaw's last innovation that is expected again. What is unexpected, times the root of the yaw's sum of
# squares, has the bound of r_1 and r_2, and a steady innovation 0.4 A: rated amplifiers at rest lead to 0.3 to 0.4 A.
LASTING = 0.8


def numbers(A: float, confirmation: float) -> list[Constant]:
    """Return the numbers that the C names, for the amplitude A in V and the rho that confirms a contradiction."""
    least_m, least_r = SIGNIFICANT["m"] * EXCESS_BOUND, SIGNIFICANT["r"] * RESIDUAL_BOUND
    ratio, bound = RESIDUAL_BOUND / (EXCESS_BOUND * A), RESIDUAL_BOUND * A
    weight = f"({RESIDUAL_BOUND:g} / ({EXCESS_BOUND:g} V_0))^2, V_0 = {A:.6g} V: amplitude of the Hall voltages"
    limit = f"({RESIDUAL_BOUND:g} V_0)^2: rho^2 is the weighted sum of the squared residuals over this"
    return [
        Constant("m_weight", ratio**2, "1/V^2", weight),
        Constant("squared_residual_limit", bound**2, "V^2", limit),
        Constant("squared_confirmation", (confirmation * bound) ** 2, "V^2", f"rho = {confirmation:g}"),
        Constant("squared_jump", (JUMP * bound) ** 2, "V^2", f"rho = {JUMP:g}: a voltage jumped"),
        Constant("significant_m", least_m * A**2, "V^2", f"{least_m:g} V_0^2: a larger excess m is significant"),
        Constant("significant_r", least_r * A, "V", f"{least_r:g} V_0: a larger residual r is significant"),
        Constant(
            "nearly_zero_m", NEARLY_ZERO * A**2, "V^2", f"{NEARLY_ZERO:g} V_0^2: a smaller excess m is nearly zero"
        ),
        Constant(
            "small_m",
            SMALL_CHANGE * A**2,
            "V^2",
            f"{SMALL_CHANGE:g} V_0^2: largest change of a squared sine voltage that is small",
        ),
        Constant("max_known_yaw", MAX_KNOWN_YAW, "rad", "beyond it every voltage is suspected"),
    ]


def innovation_numbers(A: float) -> list[Constant]:
    """Return the numbers of the innovations that the C names, for the amplitude A in V."""
    weight = f"({RESIDUAL_BOUND:g} V_0 / {INNOVATION_BOUND:g} m)^2"
    return [
        Constant("innovation_weight", innovation_weight(A), "V^2/m^2", weight),
        Constant("lasting", LASTING, "1", "part of the last innovation of the yaw that is expected again"),
    ]


def innovation_weight(A: float) -> float:
    """Return the weight of the squared innovations of x and y, V^2/m^2, beside the residuals of voltages."""
    return (RESIDUAL_BOUND * A / INNOVATION_BOUND) ** 2


def squared_residual(r1: ca.SX, r2: ca.SX, m_x: ca.SX, m_y: ca.SX, A: float) -> ca.SX:
    """Return (RESIDUAL_BOUND A rho)^2, V^2."""
    return r1**2 + r2**2 + (RESIDUAL_BOUND / (EXCESS_BOUND * A)) ** 2 * (m_x**2 + m_y**2)


def is_common_amplitude(x: Exprs, A: float) -> ca.SX:
    """Return whether another amplitude of all voltages explains the first contradiction, 0 or 1."""
    m_x, m_y, r_1, r_2 = (x[f"first_{name}"] for name in ("m_x", "m_y", "r_1", "r_2"))
    least_m, least_r = SIGNIFICANT["m"] * EXCESS_BOUND * A**2, SIGNIFICANT["r"] * RESIDUAL_BOUND * A
    both_m_exceed = ca.logic_and(ca.fabs(m_x) > least_m, ca.fabs(m_y) > least_m)
    no_r_exceeds = ca.logic_and(ca.fabs(r_1) <= least_r, ca.fabs(r_2) <= least_r)
    are_similar = ca.fabs(m_x - m_y) < MAX_SPREAD * ca.fabs(m_x + m_y)
    label(both_m_exceed=both_m_exceed)
    return ca.if_else(ca.logic_and(ca.logic_and(both_m_exceed, no_r_exceeds), are_similar), 1, 0)


def is_motion_alone(x: Exprs, A: float) -> ca.SX:
    """Return whether the voltages of the first contradiction agree, so that only the motion contradicts, 0 or 1."""
    m_x, m_y, r_1, r_2 = (x[f"first_{name}"] for name in ("m_x", "m_y", "r_1", "r_2"))
    return squared_residual(r_1, r_2, m_x, m_y, A) <= (RESIDUAL_BOUND * A) ** 2


def suspects(x: Exprs, A: float, unassigned: ca.SX) -> dict[str, ca.SX]:
    """Return for each voltage whether it is suspected, from the residuals that first showed a contradiction.

    `unassigned` says whether the contradiction cannot be assigned to single voltages: then all six are suspected.
    """
    m, r = {a: x[f"first_m_{a}"] for a in "xy"}, {"x": x["first_r_2"], "y": x["first_r_1"]}
    size = {a: ca.fabs(m[a]) for a in "xy"}
    m_exceeds = {a: size[a] > SIGNIFICANT["m"] * EXCESS_BOUND * A**2 for a in "xy"}
    r_exceeds = {a: ca.fabs(r[a]) > SIGNIFICANT["r"] * RESIDUAL_BOUND * A for a in "xy"}
    any_r_exceeds = ca.logic_or(r_exceeds["x"], r_exceeds["y"])
    first_squared = squared_residual(r["y"], r["x"], m["x"], m["y"], A)
    is_jump = first_squared > (JUMP * RESIDUAL_BOUND * A) ** 2
    both_m_exceed = ca.logic_and(ca.logic_and(m_exceeds["x"], m_exceeds["y"]), ca.logic_not(is_jump))
    is_ambiguous = ca.logic_or(ca.fabs(x["first_phi"]) > MAX_KNOWN_YAW, both_m_exceed)
    is_any = ca.logic_or(is_ambiguous, unassigned)
    flags: dict[str, ca.SX] = {}
    for a, (s, c, other) in (("x", ("V_ax", "V_bx", "V_cx")), ("y", ("V_ay", "V_cy", "V_by"))):
        nearly_zero, change = size[a] < NEARLY_ZERO * A**2, ca.fabs(r[a] * (2 * x[f"first_s_{a}"] + r[a]))
        explains = ca.logic_or(ca.logic_not(nearly_zero), change < SMALL_CHANGE * A**2)
        after_jump = {
            s: ca.logic_and(r_exceeds[a], explains),
            c: size[a] > change + NEARLY_ZERO * A**2,
            other: ca.logic_and(r_exceeds[a], nearly_zero),
        }
        after_drift = {s: ca.logic_or(any_r_exceeds, m_exceeds[a]), c: m_exceeds[a], other: any_r_exceeds}
        for name, flag in after_jump.items():
            fits = ca.if_else(is_jump, flag, after_drift[name])
            flags[name] = ca.logic_or(fits, is_any)
            label(name, fits=fits)
        label(a, nearly_zero=nearly_zero, change=change)
    label(
        both_m_exceed=both_m_exceed, any_r_exceeds=any_r_exceeds, first_squared=first_squared, is_jump=is_jump,
        is_any=is_any, size=size, m_exceeds=m_exceeds, r_exceeds=r_exceeds,
    )  # fmt: skip
    return flags
