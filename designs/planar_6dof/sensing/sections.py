"""Position and yaw from three two-axis Hall sensors, by sections of a pitch, with detection of a failed sensor.

    C o                      sensor A at the platen's centre, B at 3/4 of a pitch along its x, C as far along its y
      |                      t = 2 pi x / l,  D = 3 pi / 2,  S(t) = sin t + harmonics,  C(t) = cos t + harmonics
    A o---o B                phi: the yaw, here to first order

    V_ax =  A S(t_x) + phi A S(t_y)        V_ay = A S(t_y) - phi A S(t_x)
    V_bx = -A C(t_x) + phi A S(t_y)        V_by = V_ay + phi h_1,      h_1 = A (D S'(t_y) + C(t_x) + S(t_x))
    V_cy = -A C(t_y) - phi A S(t_x)        V_cx = V_ax - phi h_2,      h_2 = A (D S'(t_x) + C(t_y) + S(t_y))

With `phi_predicted`, a state of the Kalman filter or the raw yaw of the previous sample, the voltages are rotated back.
Predictions from the forces are not used for that: they depend on the demands, and the yaw on them, so the controller
by itself would have an unstable mode. s and c of each axis are A S(t) and A C(t).

Position, (1)-(5). With r = s c / max(s^2, c^2), which is s/c or c/s, the voltage nearer to zero over the other,

    x = f(r), half a pitch on where c < 0,     if |s| <= |c|, (alpha, beta) = (1, 0)
    x = +- l/4 - f(r) with the sign of s,      if |s| > |c|,  (alpha, beta) = (0, -1)

f combines arctangent and `calibration`. The count of pitches is the one nearest to the predicted position.

Yaw. e_1 = V_by - V_ay and e_2 = V_cx - V_ax are linear in it, but h_1 and h_2 vanish together at isolated places. With
m = s^2 + c^2 of each pair, less its nominal value, m_x - m_y is a third: h_3 = 2 (2 s_x s_y - s_y c_x - s_x c_y). From
r_1 = e_1 - h_1 phi_predicted, r_2 = e_2 + h_2 phi_predicted and r_3 = m_x - m_y,

    phi_raw = phi_predicted + (h_1 r_1 - h_2 r_2 + W h_3 r_3 / A^2) / (h_1^2 + h_2^2 + W h_3^2 / A^2 + R A^2)

where W is EXCESS_WEIGHT and R is REGULARISATION.

Contradictions. m_x, m_y, r_1 and r_2 are near 0 unless a sensor fails. A sample changes neither position nor yaw if the
guard refuses one of its voltages, or if its residual rho of `contradictions` exceeds 1. The residuals of
the first such sample determine the suspects, because no state has followed a wrong value yet. A second one, above
CONFIRMATION and within MEMORY samples, confirms it. From the next sample on the voltages are `suspected`, no sample is
complete, and the guard latches in the fifth.

Frozen channel. Where predictions come `from_forces`, the `innovation_monitor` watches the converters. The first that
is frozen is the only suspect, whatever an earlier contradiction has left. The last innovation is added as
for a refused voltage: what a torque has in it is more than what a frozen channel has added.

Amplitude. The voltages are multiplied by the scale of `calibration`; with a watch it changes between two:
temperature, height and amplifiers change it slowly; a failed sensor changes m_x or m_y at once. A contradiction that
another amplitude of all voltages explains has its own bit and suspects all six.

Motion. With predictions `from_forces`, the raw pose less the predicted one counts in rho, over INNOVATION_BOUND: a
channel that sticks shows a motion that the currents do not explain, long before the voltages contradict each other. An
unmodelled torque shifts the predicted yaw by an almost constant innovation e. So e - LASTING e- counts, with e- of the
sample before: a voltage that jumps shows at once in it, and one that drifts shows once e is large. A sample that is not
complete takes the predicted yaw plus the last innovation, so the yaw does not jump; a contradicted one takes the mean
innovation, or the last one where that is smaller. Both set the innovation to 0.

Errors, noise and undetected failures are listed in docs/decisions/planar_sensing.md and planar_faults.md.

Source: Yu, Kim, section 3.1, Figs. 3 and 4; Kawato, Kim, "A Novel Multi-DOF Precision Positioning Methodology Using
Two-Axis Hall-Effect Sensors".
"""

from dataclasses import dataclass, replace

import casadi as ca

from designs.planar_6dof.sensing import calibration, contradictions, pairs
from designs.planar_6dof.sensing.calibration import SCALE
from models import planar_stage
from synth.block import Block, Constant, Exprs, State, Step, build, clip
from synth.blocks.estimate import dead_reckoning
from synth.blocks.faults import innovation_monitor
from synth.blocks.guard import safety
from synth.fault import Fault
from synth.law import call, label
from synth.plant import Plant
from synth.signals import Signal
from synth.timing import Discrete

HALL = planar_stage.HALL
VOLTAGE = 5.0  # V: 1.7 times the amplitude of 2.93 V
PITCHES = 2  # counted to either side: 2.5 pitches are 127 mm, the travel is 110 mm
MAX_RAW_YAW = 0.025  # rad: the stage rotates by 0.02 at most; a larger raw yaw is clipped
EXCESS_WEIGHT = 0.1  # of m_x - m_y in the yaw: a larger one means less noise and more influence of lift and tilt
# Of A^2, added to the yaw's sum of squares of at least 0.27 A^2 unless a sensor fails.
REGULARISATION, REGULARISATION_FROM_FORCES = 0.01, 2.5e-5  # the latter with predictions from the forces
SQUARE_FLOOR = 1e-6  # of A^2, added to a square of at least A^2/2 unless a sensor fails
CONFIRMATION = 0.5  # of rho, to confirm a contradiction
# Codes in a row with which a channel is frozen. Noise of 3 codes has so many by chance once in 90 years or more; that
# of 13 um is 15 codes.
REPEATS = 14
MEMORY = 4  # samples for which a contradiction is remembered

RAW = {a: Signal(f"{a}_raw", "m", -0.16, 0.16, "from this sample's voltages") for a in "xy"}
RAW["phi"] = Signal("phi_raw", "rad", -MAX_RAW_YAW, MAX_RAW_YAW, "from this sample's voltages")
PREDICTED = {a: Signal(f"{a}_predicted", "m", -0.2, 0.2, "from the samples before") for a in "xy"}
PREDICTED["phi"] = Signal("phi_predicted", "rad", -2 * MAX_RAW_YAW, 2 * MAX_RAW_YAW, "from the samples before")
LARGEST = RAW["phi"].high + PREDICTED["phi"].high
INNOVATION = Signal("innovation_phi", "rad", -LARGEST, LARGEST, "raw yaw of the sample before less the predicted one")
MEAN = dead_reckoning.mean_innovation("phi", RAW["phi"], PREDICTED["phi"])
READ = tuple(Signal(name, "V", -VOLTAGE, VOLTAGE, "Hall sensor and axis") for name in HALL)
HELD = tuple(replace(s, name=f"{s.name}_held") for s in READ)
READY = Signal("ready", "1", 0, 1, "every measurement was good at once")
COMPLETE = Signal("complete", "1", 0, 1, "every voltage is good")
FAR = PITCHES * planar_stage.plant().parameter("l").value
OFFSETS = tuple(Signal(f"offset_{a}", "m", -FAR, FAR, f"whole pitches from the middle, along {a}") for a in "xy")
HALF = FAR / PITCHES / 2
BRIDGED = 2e-3  # m: by which bad samples may leave the pitch that is counted, 14 ms at 0.14 m/s
WITHIN = tuple(
    Signal(f"within_{a}", "m", -HALF - BRIDGED, HALF + BRIDGED, f"raw position along {a}, from the middle of its pitch")
    for a in "xy"
)
RATIOS = tuple(Signal(f"ratio_{a}", "1", -1, 1, "of the smaller voltage of a pair to the larger one") for a in "xy")
RESIDUALS = (
    *(
        Signal(f"m_{a}", "V^2", -1e4, 1e4, f"squared amplitude of the pair of {a}, less that of the field")
        for a in "xy"
    ),
    *(
        Signal(f"r_{i}", "V", -200, 200, f"{difference}, less what the predicted yaw makes of it")
        for i, difference in (("1", "V_by - V_ay"), ("2", "V_cx - V_ax"))
    ),
)
NOTES = (
    f"One voltage is watched at a time, while it repeats its code: with {REPEATS} in a row it is frozen and suspected. "
    "The scale is corrected between two watches alone, so that no sample has the cost of both.",
    "A sample with a refused or suspected voltage takes none of the six: x, y and yaw are predicted. A torque that the "
    "prediction does not know shifts the yaw by a steady innovation, so the first such sample adds the last one, else "
    "the yaw would jump. The prediction goes on from there, and later samples add nothing. A contradicted sample adds "
    "the mean of the innovation instead, if it is smaller, since the wrong voltage may have shifted the last one.",
)
SUSPECTED = Signal(safety.SUSPECTED, "1", 0, 1, "the voltages contradict each other")
AMPLITUDE_BIT = 29
OTHER_AMPLITUDE = Signal("other_amplitude", "1", 0, 1, "all Hall voltages have another amplitude than the field")
AMPLITUDE_FAULTS = (Fault(AMPLITUDE_BIT, OTHER_AMPLITUDE.name, about=OTHER_AMPLITUDE.about),)
SUSPECTS = tuple(Signal(f"suspect_{name}", "1", 0, 1, f"{name} contradicts the others") for name in HALL)


def sensing(plant: Plant, time: Discrete, predicted: bool = True, from_forces: bool = False) -> Block:
    """Return the Block from held voltages to the raw position, the position within the pitch, residuals and suspects.

    Predictions are inputs, or else the raw position of the previous sample. Where they come `from_forces`, the raw
    position less the prediction counts as a residual, too.
    """
    cal = calibration.of(plant)
    A, l = cal.amplitude, cal.pitch
    yaw, regularisation = RAW["phi"].name, REGULARISATION_FROM_FORCES if from_forces else REGULARISATION

    def law(u: Exprs, x: Exprs, k: Exprs) -> Step:
        scale = x["scale"]
        phi = u["phi_predicted"] if predicted and not from_forces else x[yaw]
        # within the pitch that is counted
        expected = {a: u[f"{a}_predicted"] - x[f"offset_{a}"] if predicted else x[f"within_{a}"] for a in "xy"}
        made = call("measurement", _measure, u, x, k, phi, expected, cal, from_forces)
        X, Y, r1, r2, in_pitch, offset = made.X, made.Y, made.r1, made.r2, made.in_pitch, made.offset
        measured, squared, ratio = made.measured, made.squared, made.ratio
        exceeds = ca.logic_or(x["contradiction_left"], squared > (contradictions.RESIDUAL_BOUND * A) ** 2)
        confirms = squared > (CONFIRMATION * contradictions.RESIDUAL_BOUND * A) ** 2
        # Not behind `complete`, unlike its uses: an incomplete sample skips all that is computed from its voltages.
        contradicts = ca.logic_and(u["ready"], ca.logic_and(confirms, exceeds))

        def by_case(accepted: ca.SX, contradicted: ca.SX, incomplete: ca.SX) -> ca.SX:
            return ca.if_else(u["complete"], ca.if_else(contradicts, contradicted, accepted), incomplete)

        left, confirmed, zero = x["contradiction_left"], x["contradiction_confirmed"], ca.SX(0)
        accepted = by_case(ca.SX(1), zero, zero)

        def or_bridge(value: ca.SX, bridge: ca.SX) -> ca.SX:
            return ca.if_else(accepted, by_case(value, zero, zero), bridge)  # the C computes the bridge in bad samples

        last = x[INNOVATION.name] if from_forces else zero  # after a bad sample what was added there
        # In a contradicted sample the mean, if smaller: a wrong channel may have shifted the last innovation.
        mean = ca.fmax(-ca.fabs(last), ca.fmin(u[MEAN.name], ca.fabs(last))) if from_forces else zero
        bridge = _bridge(u, x, phi, by_case(zero, mean, last), predicted, from_forces)
        raw_yaw = or_bridge(measured["phi"], bridge["phi"])
        output = {yaw: clip(raw_yaw, RAW["phi"])}
        next: dict[str, ca.SX] = {}
        residuals = {"m_x": X.m, "m_y": Y.m, "r_1": r1, "r_2": r2}
        for name, value in (residuals | {"s_x": X.s, "s_y": Y.s, "phi": phi}).items():
            first = x[f"first_{name}"]
            next[f"first_{name}"] = by_case(first, ca.if_else(left, first, value), first)
        for axis in in_pitch:
            next[f"offset_{axis}"] = by_case(offset[axis], x[f"offset_{axis}"], x[f"offset_{axis}"])
            passed = clip(bridge[axis] - x[f"offset_{axis}"], WITHIN[0]) if from_forces else x[f"within_{axis}"]
            output[f"within_{axis}"] = or_bridge(in_pitch[axis], passed)
            bridge[axis] = passed + x[f"offset_{axis}"] if from_forces else bridge[axis]
            next |= {} if from_forces else {f"within_{axis}": output[f"within_{axis}"]}
            output[f"{axis}_raw"] = or_bridge(measured[axis], bridge[axis])
            label(axis, passed=passed)
        if from_forces:
            next[INNOVATION.name] = ca.if_else(u["ready"], output[yaw] - u["phi_predicted"], 0)
            output[dead_reckoning.MEASURED.name] = accepted
        next |= {} if predicted and not from_forces else {yaw: output[yaw]}
        gain = ca.if_else(u["ready"], k["scale_gain"], k["first_scale_gain"])
        corrected = calibration.limit_scale(scale - gain * (X.m + Y.m))
        if from_forces:
            corrected = ca.if_else(innovation_monitor.is_between(x, REPEATS), corrected, scale)
        next["scale"] = by_case(corrected, scale, scale)
        next["contradiction_left"] = by_case(ca.if_else(left >= 1, left - 1, left), ca.SX(MEMORY), left)
        noticed = confirmed
        if from_forces:
            watch = innovation_monitor.watch(x, [u[s.name] for s in HELD], REPEATS, u["ready"], confirmed)
            next |= {name: by_case(value, x[name], x[name]) for name, value in watch.next.items()}
            noticed = watch.flag
        next["contradiction_confirmed"] = by_case(noticed, ca.if_else(left, 1, confirmed), confirmed)
        common = contradictions.is_common_amplitude(x, A)
        is_common = ca.logic_and(common, x[innovation_monitor.FROZEN] < 1) if from_forces else common
        output |= {SUSPECTED.name: confirmed, OTHER_AMPLITUDE.name: ca.if_else(confirmed, is_common, 0)}
        unassigned = ca.logic_or(common, contradictions.is_motion_alone(x, A)) if from_forces else common
        for name, flag in contradictions.suspects(x, A, unassigned).items():
            if from_forces:
                number = x[innovation_monitor.FROZEN]
                flag = ca.if_else(number, number == HALL.index(name) + 1, flag)
            output[f"suspect_{name}"] = flag
        named = list(zip(RATIOS, ratio.values(), strict=True))
        certified = {s.name: lambda u, e: RATIOS[0].high for s in RATIOS}
        numbers = [*_numbers(A, l, regularisation), *(_motion_numbers(A) if from_forces else [])]
        label(
            accepted=accepted, X=X, Y=Y, ratio=ratio, in_pitch=in_pitch, expected=expected, mean=mean,
            measured=measured, offset=offset, corrected=corrected, squared=squared, raw_yaw=raw_yaw, gain=gain,
            common=common,
        )  # fmt: skip
        return Step(output | residuals, next, named, certified, numbers, NOTES if from_forces else ())

    inputs = [*HELD, *(PREDICTED.values() if predicted else ()), READY, COMPLETE, *([MEAN] if from_forces else ())]
    outputs = [*RAW.values(), *WITHIN, *RESIDUALS, SUSPECTED, *SUSPECTS, OTHER_AMPLITUDE]
    outputs += [dead_reckoning.MEASURED] if from_forces else []
    states = [*_states(predicted, from_forces), State(SCALE, 1.0)]
    scale_gains = calibration.scale_gains(cal, innovation_monitor.WATCHED if from_forces else 1)
    constants = [*pairs.constants(cal, EXCESS_WEIGHT), *scale_gains]
    tag = "position and yaw, (1)-(5)"
    block = build("sensing", time, law, inputs=inputs, outputs=outputs, states=states, constants=constants, tag=tag)
    return replace(block, faults=AMPLITUDE_FAULTS)


@dataclass(frozen=True, eq=False)
class _Measurement:
    """The pairs of both axes and their ratios, r_1 and r_2, and what follows from the voltages of a sample by axis.

    `squared` is (RESIDUAL_BOUND A rho)^2, V^2.
    """

    X: pairs.Pair
    Y: pairs.Pair
    ratio: dict[str, ca.SX]
    r1: ca.SX
    r2: ca.SX
    in_pitch: dict[str, ca.SX]
    offset: dict[str, ca.SX]
    measured: dict[str, ca.SX]
    squared: ca.SX


def _measure(
    u: Exprs, x: Exprs, k: Exprs, phi: ca.SX, expected: Exprs, cal: calibration.Calibration, from_forces: bool
) -> _Measurement:
    A, l, scale = cal.amplitude, cal.pitch, x["scale"]
    ax, ay, bx, by, cx, cy = (u[s.name] for s in HELD)
    minus_Y_c = scale * (cy + phi * ax)
    X = pairs.pair("x", scale * (ax - phi * ay), scale * (phi * ay - bx), k)
    Y = pairs.pair("y", scale * (ay + phi * ax), -minus_Y_c, k)
    regularisation = REGULARISATION_FROM_FORCES if from_forces else REGULARISATION
    r1, r2, numerator, information = call(
        "yaw", _yaw, X, Y, scale * (by - ay), scale * (cx - ax), phi, k, regularisation * A**2
    )
    ratio = {"x": _ratio(X, A), "y": _ratio(Y, A)}
    in_pitch, offset = dict[str, ca.SX](), dict[str, ca.SX]()
    for axis, pair in (("x", X), ("y", Y)):
        in_pitch[axis] = call(f"place_{axis}", pairs.place, axis, pair, ratio[axis], k, cal)
        offset[axis] = call(f"offset_{axis}", _nearest, axis, in_pitch[axis], x[f"offset_{axis}"], expected[axis], l)
    measured = {a: in_pitch[a] + offset[a] for a in "xy"} | {"phi": phi + numerator / information}
    squared = contradictions.squared_residual(r1, r2, X.m, Y.m, A)
    if from_forces:
        innovation = {a: measured[a] - u[f"{a}_predicted"] for a in "xy"}
        unexpected_yaw = measured["phi"] - (u["phi_predicted"] + contradictions.LASTING * x[INNOVATION.name])
        squared += contradictions.innovation_weight(A) * (innovation["x"] ** 2 + innovation["y"] ** 2)
        squared += information * unexpected_yaw**2
        label(innovation=innovation, unexpected_yaw=unexpected_yaw)
    label(minus_Y_c=minus_Y_c, information=information)
    return _Measurement(X, Y, ratio, r1, r2, in_pitch, offset, measured, squared)


def _yaw(
    X: pairs.Pair, Y: pairs.Pair, by_ay: ca.SX, cx_ax: ca.SX, phi: ca.SX, k: Exprs, least: float
) -> tuple[ca.SX, ca.SX, ca.SX, ca.SX]:
    """Return r_1, r_2, and numerator and denominator of the yaw less the predicted one."""
    h1, h2 = pairs.slope(Y, k) + (X.c + X.s), pairs.slope(X, k) + (Y.c + Y.s)
    r1, r2 = by_ay - h1 * phi, cx_ax + h2 * phi
    numerator, information = pairs.yaw_equation(X, Y, (h1, h2), (r1, r2), k, least)
    label(h1=h1, h2=h2)
    return r1, r2, numerator, information


def _bridge(u: Exprs, x: Exprs, phi: ca.SX, added: ca.SX, predicted: bool, from_forces: bool) -> dict[str, ca.SX]:
    """Return x, y and the yaw of a bad sample: as predicted, with what is `added` to the yaw, or as before."""
    if not predicted:
        return {a: x[f"within_{a}"] + x[f"offset_{a}"] for a in "xy"} | {"phi": phi}
    if not from_forces:
        return {a: clip(u[s.name], RAW[a]) for a, s in PREDICTED.items()}
    predictions = {a: u[s.name] for a, s in PREDICTED.items()}
    label(added=added)
    return predictions | {"phi": predictions["phi"] + added}


def _states(predicted: bool, from_forces: bool) -> list[State]:
    memory = Signal("contradiction_left", "1", 0, MEMORY, "samples for which a contradiction is still remembered")
    confirmed = Signal("contradiction_confirmed", "1", 0, 1, "1 once a second contradiction has confirmed the first")
    first = [
        *RESIDUALS,
        *(Signal(f"s_{axis}", "V", -2 * VOLTAGE, 2 * VOLTAGE, f"sine voltage of {axis}") for axis in "xy"),
    ]
    first.append(replace(PREDICTED["phi"], name="phi", about="predicted yaw"))
    shown = [replace(s, name=f"first_{s.name}", about=f"{s.about}, at the first contradiction") for s in first]
    last = [] if predicted and not from_forces else [replace(RAW["phi"], about="raw yaw of the sample before")]
    watch = innovation_monitor.states(READ, REPEATS) if from_forces else []
    reals = (*shown, *OFFSETS, *([INNOVATION] if from_forces else WITHIN), *last)
    return [*(State(s, 0, True) for s in (memory, confirmed)), *(State(s, 0.0) for s in reals), *watch]


def _numbers(A: float, l: float, regularisation: float) -> list[Constant]:
    """Return the numbers that the C names."""
    return [
        Constant("pitch", l, "m", "pitch of the matrix"),
        Constant("half_pitch", l / 2, "m", "half of the pitch"),
        Constant("quarter_pitch", l / 4, "m", "a quarter of the pitch"),
        *contradictions.numbers(A, CONFIRMATION),
        Constant("memory", MEMORY, "1", "samples for which a contradiction is remembered", ("contradiction",)),
        Constant("least_square", SQUARE_FLOOR * A**2, "V^2", f"{SQUARE_FLOOR:g} V_0^2: keeps a divisor from 0"),
        Constant(
            "least_information", regularisation * A**2, "V^2", f"{regularisation:g} V_0^2: keeps a divisor from 0"
        ),
        Constant("max_yaw", MAX_RAW_YAW, "rad", "limit of the raw yaw"),
        Constant("max_within", WITHIN[0].high, "m", f"half of the pitch, and {BRIDGED:g} m for bad samples in a row"),
        *calibration.scale_numbers(),
    ]


def _motion_numbers(A: float) -> list[Constant]:
    """Return the further numbers where predictions come from the forces."""
    return [*contradictions.innovation_numbers(A), *innovation_monitor.numbers(READ, REPEATS)]


def _nearest(axis: str, within: ca.SX, offset: ca.SX, expected: ca.SX, l: float) -> ca.SX:
    """Return the whole pitches nearest to the prediction, at most one from the offset."""
    off = within - expected
    beyond = ca.fabs(off) > l / 2
    down, up = ca.if_else(offset >= l - FAR, offset - l, offset), ca.if_else(offset <= FAR - l, offset + l, offset)
    label(axis, off=off)
    return ca.if_else(beyond, ca.if_else(off > 0, down, up), offset)


def _ratio(p: pairs.Pair, A: float) -> ca.SX:
    """Return r. The clip is inactive: the rounded product never exceeds the rounded square of the larger factor."""
    return clip(p.s * p.c / (ca.fmax(p.s**2, p.c**2) + SQUARE_FLOOR * A**2), RATIOS[0])
