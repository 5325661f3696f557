"""Position and yaw from three two-axis Hall sensors, by sections of a pitch, with detection of a failed sensor.

    C o                      sensor A at the platen's centre, B at 3/4 of a pitch along its x, C as far along its y
      |                      t = 2 pi x / l,  D = 3 pi / 2,  S(t) = sin t + harmonics,  C(t) = cos t + harmonics
    A o---o B                phi: the yaw, here to first order

    V_ax =  A S(t_x) + phi A S(t_y)        V_ay = A S(t_y) - phi A S(t_x)
    V_bx = -A C(t_x) + phi A S(t_y)        V_by = V_ay + phi h_1,      h_1 = A (D S'(t_y) + C(t_x) + S(t_x))
    V_cy = -A C(t_y) - phi A S(t_x)        V_cx = V_ax - phi h_2,      h_2 = A (D S'(t_x) + C(t_y) + S(t_y))

With `phi_predicted`, a state of the Kalman filter or the raw yaw of the previous sample, the voltages are rotated back:
s and c of each axis are A S(t) and A C(t).

Position, (1)-(5). With r = s c / max(s^2, c^2), which is s/c or c/s, the voltage nearer to zero over the other,

    x = f(r), half a pitch on where c < 0,     if |s| <= |c|, (alpha, beta) = (1, 0)
    x = +- l/4 - f(r) with the sign of s,      if |s| > |c|,  (alpha, beta) = (0, -1)

f combines arctangent and calibration (`models.hall_calibration`). The count of pitches is the one nearest to the
predicted position.

Yaw. e_1 = V_by - V_ay and e_2 = V_cx - V_ax are linear in it, but h_1 and h_2 vanish together at isolated places. With
m = s^2 + c^2 of each pair, less its nominal value, m_x - m_y is a third: h_3 = 2 (2 s_x s_y - s_y c_x - s_x c_y). From
r_1 = e_1 - h_1 phi_predicted, r_2 = e_2 + h_2 phi_predicted and r_3 = m_x - m_y,

    phi_raw = phi_predicted + (h_1 r_1 - h_2 r_2 + W h_3 r_3 / A^2) / (h_1^2 + h_2^2 + W h_3^2 / A^2 + R A^2)

where W is EXCESS_WEIGHT and R is REGULARISATION.

Contradictions. m_x, m_y, r_1 and r_2 are near 0 unless a sensor fails. A sample changes neither position nor yaw if the
guard refuses one of its voltages, or if its residual exceeds 1:

    rho = ((m_x^2 + m_y^2) / (EXCESS_BOUND A^2)^2 + (r_1^2 + r_2^2) / (RESIDUAL_BOUND A)^2)^(1/2)

The residuals of the first such sample determine the suspects, because no state has followed a wrong value yet. A second
one, above CONFIRMATION and within MEMORY samples, confirms it. From the next sample on the voltages are `suspected`, no
sample is complete, and the guard latches in the fifth.

A residual is significant if it exceeds the fraction SIGNIFICANT of its bound. If the first rho exceeds JUMP, a voltage
has jumped. An error -r_2 of V_ax reduces s_x^2 by d_x = r_2 (2 s_x + r_2), and a wrong V_bx shows in r_2 through h_2.
Therefore these are suspected, and the other three likewise with r_1, m_y, s_y:

    V_ax, V_ay   if r_2 is significant, and m_x is not nearly zero or d_x is small
    V_bx, V_cy   if |m_x| exceeds |d_x| by more than NEARLY_ZERO A^2
    V_cx, V_by   if r_2 is significant, and m_x is nearly zero

Otherwise the error has grown slowly and the yaw has followed it, which distributes the error of one sensor over r_1 and
r_2. Then the four voltages of r_1 and r_2 are all suspected, and V_ax and V_bx by m_x, V_ay and V_cy by m_y. All six
are suspected if both m_x and m_y are significant, or if the yaw is beyond MAX_KNOWN_YAW. Errors, noise and undetected
failures are listed in docs/decisions/planar_sensing.md.

Source: Yu, Kim, section 3.1, Figs. 3 and 4; Kawato, Kim, "A Novel Multi-DOF Precision Positioning Methodology Using
Two-Axis Hall-Effect Sensors".
"""

from dataclasses import dataclass, replace

import casadi as ca

from models import hall_calibration, planar_stage
from synth.block import Block, Constant, Exprs, State, Step, build, clip
from synth.blocks import safety
from synth.plant import Plant
from synth.signals import Signal
from synth.timing import Discrete

HALL = planar_stage.HALL
VOLTAGE = 5.0  # V: 1.7 times the amplitude of 2.93 V
PITCHES = 2  # counted to either side: 2.5 pitches are 127 mm, the travel is 110 mm
MAX_RAW_YAW = 0.025  # rad: the stage rotates by 0.02 at most; a larger raw yaw is clipped
EXCESS_WEIGHT = 0.1  # of m_x - m_y in the yaw: a larger one means less noise and more influence of lift and tilt
REGULARISATION = 0.01  # of A^2, added to the yaw's sum of squares of at least 0.27 A^2
SQUARE_FLOOR = 1e-6  # of A^2, added to a square of at least A^2/2 unless a sensor fails
# Noise of 5e-5 m rms in a position is 0.62 % of A in a voltage, 1.0 % in r_1, r_2 and 1.1 % in m_x, m_y.
RESIDUAL_BOUND = 0.08  # of A: six times the noise, and 2 % for unequal sensors and heights
EXCESS_BOUND = 0.15  # of A^2: five times the noise, 5 % for a lift by 0.2 mm and 4 % for the sensors' height
SIGNIFICANT = {"m": 0.2, "r": 0.3}  # of EXCESS_BOUND and of RESIDUAL_BOUND
JUMP = 1.5  # of rho: a larger one at once means that a voltage jumped
NEARLY_ZERO, SMALL_CHANGE = 0.1, 0.3  # of A^2: of m, and of the change of s^2 that r explains
MAX_KNOWN_YAW = 0.01  # rad
CONFIRMATION = 0.5  # of rho, to confirm a contradiction
MEMORY = 4  # samples for which a contradiction is remembered

RAW = {a: Signal(f"{a}_raw", "m", -0.16, 0.16, "from this sample's voltages") for a in "xy"}
RAW["phi"] = Signal("phi_raw", "rad", -MAX_RAW_YAW, MAX_RAW_YAW, "from this sample's voltages")
PREDICTED = {a: Signal(f"{a}_predicted", "m", -0.2, 0.2, "from the samples before") for a in "xy"}
PREDICTED["phi"] = Signal("phi_predicted", "rad", -2 * MAX_RAW_YAW, 2 * MAX_RAW_YAW, "from the samples before")
HELD = tuple(Signal(f"{name}_held", "V", -VOLTAGE, VOLTAGE, "Hall sensor and axis") for name in HALL)
READY = Signal("ready", "1", 0, 1, "every measurement was good at once")
COMPLETE = Signal("complete", "1", 0, 1, "every voltage is good")
FAR = PITCHES * planar_stage.plant().parameter("l").value
OFFSETS = tuple(Signal(f"offset_{a}", "m", -FAR, FAR, f"whole pitches from the middle, along {a}") for a in "xy")
HALF = FAR / PITCHES / 2
WITHIN = tuple(
    Signal(f"within_{a}", "m", -HALF, HALF, f"raw position along {a}, from the middle of its pitch") for a in "xy"
)
RATIOS = tuple(Signal(f"ratio_{a}", "1", -1, 1, "of the smaller voltage of a pair to the larger one") for a in "xy")
RESIDUALS = (
    *(
        Signal(f"m_{a}", "V^2", -1000, 1000, f"squared amplitude of the pair of {a}, less that of the field")
        for a in "xy"
    ),
    *(
        Signal(f"r_{i}", "V", -50, 50, f"{difference}, less what the predicted yaw makes of it")
        for i, difference in (("1", "V_by - V_ay"), ("2", "V_cx - V_ax"))
    ),
)
SUSPECTED = Signal(safety.SUSPECTED, "1", 0, 1, "the voltages contradict each other")
SUSPECTS = tuple(Signal(f"suspect_{name}", "1", 0, 1, f"{name} contradicts the others") for name in HALL)


@dataclass(frozen=True, eq=False)
class _Pair:
    """One axis' voltages with the yaw turned back, s = A S and c = A C, and the excess m of s^2 + c^2."""

    s: ca.SX
    c: ca.SX
    m: ca.SX


def sensing(plant: Plant, time: Discrete, predicted: bool = True) -> Block:
    """Return the Block from held voltages to the raw position, the position within the pitch, residuals and suspects.

    Predictions are inputs, or else the raw position of the previous sample.
    """
    cal = hall_calibration.of(plant)
    A, l = cal.amplitude, cal.pitch
    yaw = RAW["phi"].name

    def law(u: Exprs, x: Exprs, k: Exprs) -> Step:
        ax, ay, bx, by, cx, cy = (u[s.name] for s in HELD)
        phi = u["phi_predicted"] if predicted else x[yaw]
        # within the pitch that is counted
        expected = {a: u[f"{a}_predicted"] - x[f"offset_{a}"] if predicted else x[f"within_{a}"] for a in "xy"}
        X, Y = _pair(ax, -bx, ay, phi, k), _pair(ay, -cy, -ax, phi, k)
        h1, h2 = _slope(Y, k) + (X.c + X.s), _slope(X, k) + (Y.c + Y.s)
        r1, r2 = by - ay - h1 * phi, cx - ax + h2 * phi
        ratio = {"x": _ratio(X, A), "y": _ratio(Y, A)}
        within = {axis: _place(pair, ratio[axis], k, cal) for axis, pair in (("x", X), ("y", Y))}
        offset = {axis: _nearest(at, x[f"offset_{axis}"], expected[axis], l) for axis, at in within.items()}
        known, squared = ca.logic_and(u["ready"], u["complete"]), _squared_residual(r1, r2, X.m, Y.m, A)
        exceeds = ca.logic_or(x["contradiction_left"], squared > (RESIDUAL_BOUND * A) ** 2)
        contradicts = ca.if_else(known, ca.logic_and(squared > (CONFIRMATION * RESIDUAL_BOUND * A) ** 2, exceeds), 0)
        accept = ca.logic_and(ca.logic_not(contradicts), u["complete"])
        output = {yaw: clip(phi + ca.if_else(accept, _yaw_correction(X, Y, (h1, h2), (r1, r2), k, A), 0), RAW["phi"])}
        next: dict[str, ca.SX] = {}
        first = ca.logic_and(contradicts, ca.logic_not(x["contradiction_left"]))
        residuals = {"m_x": X.m, "m_y": Y.m, "r_1": r1, "r_2": r2}
        for name, value in (residuals | {"s_x": X.s, "s_y": Y.s, "phi": phi}).items():
            next[f"first_{name}"] = ca.if_else(first, value, x[f"first_{name}"])
        for axis, at in within.items():
            next[f"offset_{axis}"] = ca.if_else(accept, offset[axis], x[f"offset_{axis}"])
            next[f"within_{axis}"] = ca.if_else(accept, at, x[f"within_{axis}"])
            held = u[f"{axis}_predicted"] if predicted else x[f"within_{axis}"] + x[f"offset_{axis}"]
            output[f"{axis}_raw"] = ca.if_else(accept, at + offset[axis], held)
            output[f"within_{axis}"] = next[f"within_{axis}"]
        next |= {} if predicted else {yaw: output[yaw]}
        confirmed = ca.logic_and(contradicts, x["contradiction_left"])
        remembered = ca.if_else(
            ca.logic_and(accept, x["contradiction_left"]), x["contradiction_left"] - 1, x["contradiction_left"]
        )
        next |= {
            "contradiction_left": ca.if_else(contradicts, MEMORY, remembered),
            "contradiction_confirmed": ca.if_else(confirmed, 1, x["contradiction_confirmed"]),
        }
        output |= {f"suspect_{name}": one for name, one in _suspects(x, A).items()} | {
            SUSPECTED.name: x["contradiction_confirmed"]
        }
        named = list(zip(RATIOS, ratio.values(), strict=True))
        certified = {s.name: lambda u, e: RATIOS[0].high for s in RATIOS}
        return Step(output | residuals, next, named, certified, _numbers(A, l))

    inputs = [*HELD, *(PREDICTED.values() if predicted else ()), READY, COMPLETE]
    outputs = [*RAW.values(), *WITHIN, *RESIDUALS, SUSPECTED, *SUSPECTS]
    states, constants, tag = _states(predicted), _constants(cal), "position and yaw, (1)-(5)"
    return build("sensing", time, law, inputs=inputs, outputs=outputs, states=states, constants=constants, tag=tag)


def _states(predicted: bool) -> list[State]:
    memory = Signal("contradiction_left", "1", 0, MEMORY, "samples for which a contradiction is still remembered")
    confirmed = Signal("contradiction_confirmed", "1", 0, 1, "1 once a second contradiction has confirmed the first")
    first = [
        *RESIDUALS,
        *(Signal(f"s_{axis}", "V", -2 * VOLTAGE, 2 * VOLTAGE, f"sine voltage of {axis}") for axis in "xy"),
    ]
    first.append(replace(PREDICTED["phi"], name="phi", about="predicted yaw"))
    shown = [replace(s, name=f"first_{s.name}", about=f"{s.about}, at the first contradiction") for s in first]
    last = [] if predicted else [replace(RAW["phi"], about="raw yaw of the sample before")]
    reals = (*shown, *OFFSETS, *WITHIN, *last)
    return [*(State(s, 0, True) for s in (memory, confirmed)), *(State(s, 0.0) for s in reals)]


def _constants(cal: hall_calibration.Calibration) -> list[Constant]:
    position = [(f"position_{2 * n + 1}", v, "m") for n, v in enumerate(cal.position)]
    slope = [(f"slope_{n}", v, f"1/V^{2 * n + 2}") for n, v in enumerate(cal.slope)]
    power = [(f"power_{n}", v, unit) for n, (v, unit) in enumerate(zip(cal.power, _POWERS, strict=True))]
    fits = [
        Constant(name, v, unit, f"fit of the {name.partition('_')[0]} in the calculated field")
        for name, v, unit in (*position, *slope, *power)
    ]
    return [*fits, Constant("amplitude_weight", 2 * EXCESS_WEIGHT / cal.amplitude**2, "1/V^2", "2 W / A^2")]


def _numbers(A: float, l: float) -> list[Constant]:
    """Return the numbers that the C names."""
    amplitude, ratio = f"A = {A:.6g} V", RESIDUAL_BOUND / (EXCESS_BOUND * A)
    least_m, least_r = SIGNIFICANT["m"] * EXCESS_BOUND, SIGNIFICANT["r"] * RESIDUAL_BOUND
    return [
        Constant("pitch", l, "m", "pitch of the matrix"),
        Constant("half_pitch", l / 2, "m", "half of the pitch"),
        Constant("quarter_pitch", l / 4, "m", "a quarter of the pitch"),
        Constant("m_weight", ratio**2, "1/V^2", f"({RESIDUAL_BOUND:g} / ({EXCESS_BOUND:g} A))^2, {amplitude}"),
        Constant("squared_residual_limit", (RESIDUAL_BOUND * A) ** 2, "V^2", f"({RESIDUAL_BOUND:g} A)^2: rho = 1"),
        Constant("squared_confirmation", (CONFIRMATION * RESIDUAL_BOUND * A) ** 2, "V^2", f"rho = {CONFIRMATION:g}"),
        Constant("squared_jump", (JUMP * RESIDUAL_BOUND * A) ** 2, "V^2", f"rho = {JUMP:g}: a voltage jumped"),
        Constant("significant_m", least_m * A**2, "V^2", f"{least_m:g} A^2"),
        Constant("significant_r", least_r * A, "V", f"{least_r:g} A"),
        Constant("nearly_zero_m", NEARLY_ZERO * A**2, "V^2", f"{NEARLY_ZERO:g} A^2"),
        Constant("small_m", SMALL_CHANGE * A**2, "V^2", f"{SMALL_CHANGE:g} A^2"),
        Constant("least_square", SQUARE_FLOOR * A**2, "V^2", f"{SQUARE_FLOOR:g} A^2: keeps a divisor from 0"),
        Constant("least_information", REGULARISATION * A**2, "V^2", f"{REGULARISATION:g} A^2: keeps a divisor from 0"),
        Constant("max_known_yaw", MAX_KNOWN_YAW, "rad", "beyond it every voltage is suspected"),
        Constant("max_yaw", MAX_RAW_YAW, "rad", "limit of the raw yaw"),
    ]


_POWERS = ("V^2", "1/V^2", "1/V^6")


def _pair(s: ca.SX, c: ca.SX, other: ca.SX, phi: ca.SX, k: Exprs) -> _Pair:
    s, c = s - phi * other, c + phi * other
    product = (s * c) ** 2
    return _Pair(s, c, s**2 + c**2 - (k["power_0"] + product * (k["power_1"] + product * k["power_2"])))


def _slope(p: _Pair, k: Exprs) -> ca.SX:
    """Return 3 pi/2 A S'."""
    return p.c * p.c**2 * (k["slope_0"] + p.s**2 * k["slope_1"])


def _yaw_correction(X: _Pair, Y: _Pair, h: tuple[ca.SX, ca.SX], r: tuple[ca.SX, ca.SX], k: Exprs, A: float) -> ca.SX:
    """Return the yaw less the predicted one, rad; h3 is half of h_3."""
    h3 = X.s * (Y.s - Y.c) + Y.s * (X.s - X.c)
    (h1, h2), (r1, r2) = h, r
    information = h1**2 + h2**2 + 2 * k["amplitude_weight"] * h3**2 + REGULARISATION * A**2
    return (h1 * r1 - h2 * r2 + k["amplitude_weight"] * (h3 * (X.m - Y.m))) / information


def _place(p: _Pair, r: ca.SX, k: Exprs, cal: hall_calibration.Calibration) -> ca.SX:
    """Return the position within the pitch, m, from the ratio r of the pair."""
    l, f = cal.pitch, ca.SX(0)
    for n in reversed(range(len(cal.position))):
        f = k[f"position_{2 * n + 1}"] + r**2 * f
    f = r * f
    near = ca.if_else(p.c < 0, ca.if_else(f > 0, f - l / 2, f + l / 2), f)
    return ca.if_else(p.s**2 <= p.c**2, near, ca.if_else(p.s < 0, -l / 4, l / 4) - f)


def _ratio(p: _Pair, A: float) -> ca.SX:
    """Return r. The clip is inactive: the rounded product never exceeds the rounded square of the larger factor."""
    return clip(p.s * p.c / (ca.fmax(p.s**2, p.c**2) + SQUARE_FLOOR * A**2), RATIOS[0])


def _nearest(within: ca.SX, offset: ca.SX, expected: ca.SX, l: float) -> ca.SX:
    """Return the whole pitches nearest to the prediction, at most one from the offset."""
    off = within - expected
    beyond = ca.fabs(off) > l / 2
    down, up = ca.if_else(offset >= l - FAR, offset - l, offset), ca.if_else(offset <= FAR - l, offset + l, offset)
    return ca.if_else(beyond, ca.if_else(off > 0, down, up), offset)


def _squared_residual(r1: ca.SX, r2: ca.SX, m_x: ca.SX, m_y: ca.SX, A: float) -> ca.SX:
    """Return (RESIDUAL_BOUND A rho)^2."""
    return r1**2 + r2**2 + (RESIDUAL_BOUND / (EXCESS_BOUND * A)) ** 2 * (m_x**2 + m_y**2)


def _suspects(x: Exprs, A: float) -> dict[str, ca.SX]:
    """Return for each voltage whether it is suspected, from the residuals that first showed a contradiction."""
    m, r = {a: x[f"first_m_{a}"] for a in "xy"}, {"x": x["first_r_2"], "y": x["first_r_1"]}
    size = {a: ca.fabs(m[a]) for a in "xy"}
    m_exceeds = {a: size[a] > SIGNIFICANT["m"] * EXCESS_BOUND * A**2 for a in "xy"}
    r_exceeds = {a: ca.fabs(r[a]) > SIGNIFICANT["r"] * RESIDUAL_BOUND * A for a in "xy"}
    any_r_exceeds = ca.logic_or(r_exceeds["x"], r_exceeds["y"])
    is_jump = _squared_residual(r["y"], r["x"], m["x"], m["y"], A) > (JUMP * RESIDUAL_BOUND * A) ** 2
    both_m_exceed = ca.logic_and(ca.logic_and(m_exceeds["x"], m_exceeds["y"]), ca.logic_not(is_jump))
    is_ambiguous = ca.logic_or(ca.fabs(x["first_phi"]) > MAX_KNOWN_YAW, both_m_exceed)
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
        for name, jumped in after_jump.items():
            flags[name] = ca.logic_or(ca.if_else(is_jump, jumped, after_drift[name]), is_ambiguous)
    return flags
