"""Refusals of synth.blocks: what a guard, a law, an estimator or a decision on faults must have."""

from collections.abc import Mapping
from dataclasses import replace

import casadi as ca
import numpy as np

from benchmarks import beacons
from synth.block import Block
from synth.blocks.estimate import (
    advance,
    dead_reckoning,
    glsdc_estimator,
    glsdc_integrity,
    glsdc_jacobian,
    glsdc_model,
    glsdc_search,
    phasor,
)
from synth.blocks.estimate.glsdc_integrity import Integrity
from synth.blocks.estimate.glsdc_model import Implicit, Phase, RotatedMeasurement, Unknown
from synth.blocks.estimate.glsdc_search import Search
from synth.blocks.estimate.glsdc_solution import Iteration
from synth.blocks.faults import innovation_monitor, landing, probe, redundancy, start
from synth.blocks.faults.redundancy import Decision
from synth.blocks.guard import following, missed_calls, safe_output, safety
from synth.blocks.laws import (
    axis,
    axis_regulator,
    derivative_filter,
    error_map,
    lead_lag,
    linear_block,
    lookup_table,
    predictive_servo,
    regulator,
)
from synth.blocks.laws.lookup_table import Grid
from synth.errors import ModelError, SignalError, TimingError
from synth.fault import Fault
from synth.signals import Signal
from synth.statespace import StateSpace
from synth.timing import Continuous, Discrete
from tests.hostile import search
from tests.refusals.table import call, refusals

TIME = Discrete(1e-3)
Q, F, U, V = (Signal(n, "m", -1.0, 1.0) for n in ("q", "f", "u", "v"))
READING, WISH = safety.GuardedInput(Q, 0.0, True), safety.GuardedInput(U, 0.0, False)
MOVING = search.example("dead_reckoning.block", dead_reckoning.block)["axes"][0]
BRAKING = search.example("safe_output.braking_block", safe_output.braking_block)
FOLLOWING = search.example("following.block", following.block)["axes"][0]
SAFE = search.example("safe_output.block", safe_output.block)["safety"]
LOOP = search.example("lead_lag.block", lead_lag.block)
PREDICTIVE = search.example("predictive_servo.block", predictive_servo.block)
SERVO = search.example("axis.servo", axis.servo)
SUM = redundancy.Relation({"a": 1.0, "b": -1.0}, 1e-3)
DECISION = Decision({"x": 1e-3}, {"x": (-0.9, 0.9)}, persistent=3, undecided=10, at_rest=50)
SENSORS = [Signal(n, "m", -1.0, 1.0) for n in ("a", "b", "x")]
COILS = [Signal(n, "V", -5, 5) for n in ("V_x", "V_y")]
X, LIMITS = beacons.UNKNOWNS["x"], {"x": 5.0, "y": 5.0}
RANGES = {"channels": beacons.ranges(3).channels, "unknowns": [beacons.UNKNOWNS[n] for n in "xy"], "R": np.eye(3)}
BEARINGS = [Signal(f"range_{n}", "rad", -4.0, 4.0) for n in "abc"]
TURN = Unknown(Signal("turn", "rad", -0.5, 0.5), 0.3, 0.2, angle=True)
ROTATED = RotatedMeasurement(lambda q, k: {"V_x": 2 * q["sin_x"], "V_y": 3 * q["cos_x"]}, "yaw", [("V_x", "V_y")])
GRID, PLACES = Grid((-2.0, -1.0), 0.5, (9, 5)), np.random.default_rng(0).uniform(-1, 1, (20, 2)) * [2.0, 1.0]
CORNERS = np.array([[0.0, 0.0], [0.0, 1.0], [1.0, 0.0], [1.0, 1.0]])
MAP = {
    "estimated": np.c_[PLACES, PLACES[:, :1]],
    "reference": np.c_[PLACES, PLACES[:, :1]],
    "grid": GRID,
    "units": np.ones(3),
}
LINEAR = StateSpace(0.5 * np.eye(2), np.eye(2), np.eye(2), np.eye(2), ("q", "f"), ("u", "v"), ("q", "f"), TIME)
SIGNALS = {"system": LINEAR, "inputs": [U, V], "outputs": [Q, F], "states": [Q, F], "tag": "(1)"}
ALONG = np.linspace(-0.9, 0.9, 41)
CENTRE = np.c_[ALONG, 0 * ALONG]


def angle(**changed: object) -> Unknown:
    return replace(TURN, **changed)  # type: ignore[arg-type]


def every(value: object) -> dict[str, object]:
    """Return a measurement of three ranges that all have one value."""
    return {"h": lambda q, k: dict.fromkeys(("range_a", "range_b", "range_c"), value)}


def mixed(q: Mapping[str, ca.SX], y: Mapping[str, ca.SX], k: Mapping[str, ca.SX]) -> dict[str, ca.SX]:
    """Return an implicit measurement that turns two channels into each other."""
    a, b, c = (y[f"range_{n}"] for n in "abc")
    return {"range_a": 0.6 * a - 0.8 * b - q["x"], "range_b": 0.8 * a + 0.6 * b - q["y"], "range_c": c - q["x"]}


def estimator(**changed: object) -> Block:
    h = beacons.measurement(beacons.ranges(3))
    return glsdc_estimator.estimator("estimator", beacons.TIME, **{"h": h, **RANGES, **changed})  # type: ignore[arg-type]


def block_of(channels: int, integrity: Integrity | None = None, R: object = None, **changed: Unknown) -> Block:
    return beacons.block(beacons.ranges(channels), integrity, changed=changed)


def turning(R: object = None, **changed: object) -> glsdc_jacobian.Model:
    unknowns = [Unknown(Signal(n, "rad", -np.pi, np.pi), 1.0, 0.5, periodic=True, prior=1.0) for n in ("x", "yaw")]
    h = replace(ROTATED, **changed)  # type: ignore[arg-type]
    return glsdc_jacobian.model(h, np.eye(2) if R is None else R, COILS, (), unknowns, (), ())


def searching(search: Search, integrity: Integrity | None) -> Block:
    h = beacons.measurement(beacons.ranges(5))
    of = {"channels": beacons.ranges(5).channels, "R": 0.01 * np.eye(5)}
    unknowns = [replace(beacons.UNKNOWNS["x"], periodic=True), beacons.UNKNOWNS["y"]]
    return glsdc_estimator.estimator("e", beacons.TIME, h, **of, unknowns=unknowns, search=search, integrity=integrity)


def synthesised(delay: int = 1, **changed: object) -> axis_regulator.Regulator:
    return axis_regulator.synthesise(axis.servo(**{**SERVO, **changed}).axes[0], TIME, delay)


SIGNAL = [
    *(
        call(
            advance.block,
            "give an advance of 0 or more",
            positions=[advance.Position(Q, speed)],
            samples=samples,
            bad_samples=bad,
        )
        for samples, speed, bad in ((-0.5, 1.0, 5), (1.5, 0.0, 5), (1.5, 1.0, 0))
    ),
    call(safe_output.braking_block, "no demand of axis 'gap'", demands={}),
    call(
        safe_output.braking_block,
        "a demand of 'p', which is no axis",
        demands=BRAKING["demands"] | {"p": BRAKING["demands"]["gap"]},
    ),
    call(
        safe_output.braking_block,
        "in 1 on in N: give one unit",
        demands={"gap": (BRAKING["demands"]["gap"][0], replace(U, unit="N"))},
    ),
    call(safe_output.braking_block, "at most 1", share=1.5),
    *(
        call(dead_reckoning.block, part, axes=[replace(MOVING, **changed)])
        for changed, part in (
            ({"pole": 1.0}, "between 0 and 1"),
            ({"acceleration": 0.0}, "by 0"),
            ({"fastest": 0.0}, "positive"),
            ({"bias": dead_reckoning.RateBias(1.0, 3)}, "between 0 and 1"),
            ({"bias": dead_reckoning.RateBias(0.9, -1)}, "-1 samples"),
            ({"predicted": replace(MOVING.predicted, unit="rad")}, "one unit"),
        )
    ),
    call(dead_reckoning.block, "at least one", axes=[]),
    call(safety.guard, "0 measurements brakes for 4", inputs=[WISH], braking=4),
    call(safety.guard, "brakes for -1", inputs=[READING], braking=-1),
    call(safety.guard, "redundant and brakes for 4 samples: give 0", inputs=[READING], redundant=True, braking=4),
    *(call(safety.guard, "make up for a bad one", good_samples=g, braking=b) for g, b in ((-1, 0), (4, 3))),
    *(
        call(
            safety.guard,
            f"'{s[-1]}' is not a measurement or one is listed twice: name each",
            inputs=[READING, WISH],
            suspected=s,
        )
        for s in (("u",), ("q", "q"), ("nobody",))
    ),
    call(safety.guard, "among no measurements", inputs=[WISH], suspected=("q",)),
    *(
        call(safe_output.block, part, outputs=[Q], safety=safety.Safety(5, safe, slew, "test"))
        for safe, slew, part in (
            ({}, {"q": 1}, "'q' has no safe value or no rate: declare both"),
            ({"q": 0}, {}, "'q' has no safe value or no rate"),
            ({"q": 5}, {"q": 1}, "safe output 5 of 'q' is outside ...: choose one inside"),
            ({"q": np.nan}, {"q": 1}, "safe output nan"),
            ({"q": 0}, {"q": 0}, "'q' slews at 0 m per second: the rate must be finite and positive"),
            ({"q": 0}, {"q": np.inf}, "slews at inf"),
        )
    ),
    call(
        safe_output.block,
        "the safe output 4.0 of 'y' is outside -1.0 .. 1.0",
        safety=replace(SAFE, landed_output={"y": 4.0}),
    ),
    call(safe_output.block, "'i_3' has a value once", safety=replace(SAFE, landed_output={"i_3": 0.0})),
    *(
        call(following.block, part, axes=axes)
        for axes, part in (
            ([], "give at least one"),
            ([replace(FOLLOWING, bit=31)], "give one from 0 to 30"),
            ([replace(FOLLOWING, bit=-1)], "give one from 0 to 30"),
            ([FOLLOWING, replace(FOLLOWING, position=replace(FOLLOWING.position, name="p"))], "two axes of"),
            ([replace(FOLLOWING, largest=0.0)], "give a positive one"),
            ([replace(FOLLOWING, set_point=replace(FOLLOWING.set_point, unit="rad"))], "give both one unit"),
        )
    ),
    *(
        call(Fault, "give what it is about", bit=5, output="late", **{"about": "late", "status": True, **fields})
        for fields in ({"input": "q"}, {"suspect": "q"}, {"about": ""})
    ),
    *(call(missed_calls.signal, "give a finite number above 0", limit=limit) for limit in (0.0, -1.0, np.inf)),
    *(call(missed_calls.block, "give one from 0 to 30", bit=bit) for bit in (-1, 31)),
    *(
        call(redundancy.block, part, sensors=SENSORS, relations=relations, decision=decision)
        for relations, decision, part in (
            ([SUM], replace(DECISION, jump={"x": 1e-4}), "jump of 'x' is above"),
            ([SUM], replace(DECISION, wide_frozen={"x": 1e-4}), "wide gate for frozen codes of 'x' is"),
            ([SUM, SUM], DECISION, "each sensor once"),
            ([SUM], Decision({}, {}), "no gate"),
            ([SUM], Decision({"x": 1.0}, {"x": (-1, 1)}, 3, 2), "undecided"),
            (
                [SUM],
                Decision({**DECISION.gate, "q": 1.0}, DECISION.travel),
                "gate, travel or jump of 'q', and the sensors are",
            ),
        )
    ),
    call(landing.block, "give 0", good_samples=-1),
    call(landing.block, "one descent", courses=[landing.Braking("x", 1.0, 9.0, 1.0)]),
    call(probe.block, "positive step", probe=probe.Probe(10, 4, 0.0, 3)),
    call(innovation_monitor.states, "two channels or more", channels=[Q]),
    call(innovation_monitor.states, "one range about 0", channels=[Q, replace(F, high=6.0)]),
    call(start.block, "'start' has no demand: give at least one", demands={}),
    call(start.block, "passes 'u' in m on in N: give one unit", demands={U: replace(F, unit="N")}),
    *(
        call(estimator, part, **changed)
        for changed, part in (
            ({"angles": ["heading"]}, "angle 'heading' is no channel"),
            ({"h": lambda q, k: {"range_a": q["x"]}}, "missing"),
            ({"h": lambda q, k: dict.fromkeys(("range_a", "range_b", "range_c"), q["z"])}, "no 'z'"),
            ({"unknowns": [X, X]}, "declared 2 times"),
            ({"integrity": Integrity({"z": 1.0})}, "limits are of z"),
            ({"h": lambda q, k: None}, "h returns None"),
            (every(ca.vertcat(1.0, 2.0)), "h gives 'range_a' the value ...shape (2, 1)"),
            (every(ca.MX.sym("w")), "h gives 'range_a' the value a MX"),
            (every("x"), "h gives 'range_a' the value 'x'"),
            (every(ca.SX.sym("w")), "h uses 'w'"),
            ({"phases": [Phase("a", lambda q, k: "x", 1.0, 0.1)]}, "a phase gives 'a' the value 'x'"),
            ({"channels": BEARINGS, "angles": ["range_a"]}, "give one turn, 6.28318531 rad wide"),
            ({"h": Implicit(lambda q, y, k: {"range_a": y["range_a"]})}, "missing"),
        )
    ),
    *(
        call(block_of, "in one group at most", channels=6, integrity=Integrity(LIMITS, groups=groups))
        for groups in ([["range_a", "range_a"]], [["range_a"], ["range_a"]], [["range_z"]], [[]])
    ),
    *(
        call(turning, part, **changed)
        for changed, part in (
            ({"angle": "roll"}, "no unknown angle"),
            ({"pairs": [("V_x", "V_x")]}, "not the channels"),
            ({"pairs": None}, "not the channels"),
            ({"pairs": [("V_x",), ("V_y",)]}, "not the channels"),
            ({"fixed": lambda q, k: {"V_x": 1.0}}, "V_y"),
            ({"fixed": lambda q, k: None}, "h returns"),
        )
    ),
    *(
        call(searching, "searched unknowns are", search=Search(12, agreement, 5), integrity=Integrity({"x": 0.5}))
        for agreement in ({}, {"z": 0.1})
    ),
    *(
        call(
            phasor.within_period,
            "give a positive period",
            position=ca.SX.sym("x"),
            bounds=replace(Q, low=-high, high=high),
            name="x",
            period=p,
        )
        for high, p in ((300.0, 0.1143), (0.1, 0.0), (0.1, -1.0))
    ),
    *(
        call(glsdc_search.screen, "in one group", groups=groups)
        for groups in ([("a",)], [("a",), ("b",), ("b",)], [("a",), ("b",), ()], [("a", "other"), ("b",)])
    ),
    *(
        call(axis.servo, part, **changed)
        for changed, part in (
            ({"modes": {}}, "exosystem frequencies"),
            ({"modes": {0.0: 0.0}}, "speed of a mode"),
            ({"weights": {"rate": 1.0}}, "no weight on 'gap'"),
            ({"weights": {"gap": 1.0, "p": 1.0}}, "'p' is not one of gap, rate"),
            ({"weights": {"gap": -1.0}}, "above 0"),
            ({"command_weight": 0.0}, "command weight"),
            ({"anti_windup": -1.0}, "rate of the anti-windup"),
            ({"set_point_weight": -0.5}, "of the set-point"),
            (
                {"estimator": axis.kalman({"x": 1.0}, {"gap": 1.0})},
                "process noise of the axis: 'x' is not one of gap, rate",
            ),
        )
    ),
    call(axis.kalman, "sensor noise is", sensor={}),
    call(synthesised, "must lie below", modes={7000.0: 5.0}),
    call(synthesised, "the delay is -1 samples", delay=-1),
    *(call(derivative_filter.block, "between 0 and 314.159 rad/s", bandwidth=w) for w in (0.0, -5.0, 314.2, np.inf)),
    call(derivative_filter.block, "the rate 'q' of 'gap' is in m: it must be in m/s", rate=Q),
    *(
        call(
            lead_lag.block,
            "two real zeros, a stable real pole and, last, an integrator",
            K=replace(LOOP["K"], **changed),
        )
        for changed in (
            {"zeros": LOOP["K"].zeros[:1]},
            {"poles": LOOP["K"].poles[::-1]},
            {"poles": (1.5 + 0j, 1.0 + 0j)},
            {"zeros": (0.9 + 0.1j, 0.9 - 0.1j)},
        )
    ),
    call(lead_lag.block, "scale of the loop: found 0", of=replace(LOOP["of"], scale=0.0)),
    call(
        lead_lag.block,
        "the zero of the integral is 1.2 in z",
        K=replace(LOOP["K"], zeros=(LOOP["K"].zeros[0], 1.2 + 0j)),
    ),
    *(
        call(linear_block.block, part, **SIGNALS | changed)
        for changed, part in (
            ({"inputs": [V, U]}, "the inputs given are v, u, but the model's are u, v"),
            ({"states": [Q]}, "the states given are q, but"),
            ({"states": [replace(Q, low=0.5), F]}, "outside its bounds"),
            ({"start": linear_block.Start(np.zeros(2), np.zeros((2, 3)))}, "give finite numbers of (2,) and (2, 2)"),
        )
    ),
    call(predictive_servo.block, "cancels 1.2", cancelled=1.2),
    call(predictive_servo.block, "positive limits", limits=predictive_servo.Limits(0.0, 0.05, 1.0)),
    call(predictive_servo.block, "'w' is in m/s", demand=replace(PREDICTIVE["demand"], unit="m/s")),
    call(predictive_servo.block, "exosystem of order 5", frequencies=[0.0, 6.0, 12.0]),
    *(
        call(regulator.block, part, **changed)
        for changed, part in (
            ({"frequencies": (0.0,)}, "the gain is (1, 5) and 3 bounds are given, but the exosystem of order 1"),
            ({"bounds": (1.0, 1.0)}, "2 bounds are given, but the exosystem of order 3"),
            ({"anti_windup": (Signal("excess", "A", -1, 1), [1.0])}, "has 1 entries, the internal model 3 states"),
            ({"rate": Signal("de", "m", -1, 1)}, "'de' is in m, but the error 'e' needs m/s"),
            ({"demand": Signal("w", "N", -1, 1)}, "'w' is in N, but the error 'e' needs m/s^2"),
            ({"frequencies": (0.0, 700.0)}, "must lie below 314.159 rad/s"),
        )
    ),
]
MODEL = [
    call(angle, "'turn' is an angle", periodic=True),
    call(angle, "'turn' is an angle", signal=Signal("turn", "rad", -1.3, 1.3)),
    *(
        call(function, part, **changed)
        for function, changed, part in (
            (glsdc_model.Unknown, {"largest_deviation": 0}, "largest deviation of 'gap' is 0"),
            (glsdc_model.Unknown, {"step": 6.0}, "step of 'gap' is 6"),
            (glsdc_model.Unknown, {"prior": -1.0}, "prior of 'gap' has the deviation"),
            (glsdc_model.Unknown, {"start": 7.0}, "start of 'gap' is 7"),
            (glsdc_model.Unknown, {"prior_value": 7.0}, "prior value of 'gap' is 7"),
            (glsdc_model.Unknown, {"velocity_gain": 2.0}, "velocity gain of 'gap' is 2"),
            (Phase, {"name": "a", "angle": None, "largest": 4.0, "change": 2.0}, "change of 'a' is 2"),
            (Phase, {"name": "a", "angle": None, "largest": 0.0, "change": 0.1}, "largest value of 'a' is 0"),
            (Iteration, {"corrections": 0}, "corrections is 0"),
            (glsdc_model.covariance, {"noise": [1.0, 0.0]}, "above 0 in each channel"),
            (glsdc_model.covariance, {"noise": [1.0, 1.0], "model_error": [0.0]}, "(2,)...(1,)"),
            (block_of, {"channels": 1}, "give as many"),
            (block_of, {"channels": 3, "x": replace(X, largest_deviation=40.0)}, "resolve"),
            (block_of, {"channels": 3, "integrity": Integrity(LIMITS, exclude=True)}, "exclusion of 1 together 2 more"),
            (block_of, {"channels": 6, "integrity": Integrity(LIMITS, screened=True)}, "needs exclude=True"),
            (
                block_of,
                {"channels": 6, "integrity": Integrity(LIMITS, exclude=True, groups=[[f"range_{k}" for k in "abcd"]])},
                "exclusion of 4 together 5 more",
            ),
            (
                block_of,
                {"channels": 4, "integrity": Integrity(LIMITS), "x": Unknown(X.signal, 1.0, 3.0, prior=0.1)},
                "carries a fault from sample to sample",
            ),
            (Integrity, {"limits": {"x": 0.0}}, "limit of the protection level of 'x' is 0"),
            (Integrity, {"risk": 0.6}, "risk is 0.6"),
            (Integrity, {"false_alarm": 0.0}, "false_alarm is 0"),
            (glsdc_integrity.thresholds, {"freedom": 0}, ""),
            (glsdc_integrity.thresholds, {"false_alarm": 0.0}, ""),
            (glsdc_integrity.thresholds, {"false_alarm": 0.5, "risk": 0.5}, ""),
            (turning, {"R": np.diag([1.0, 2.0])}, "R changes when the pairs turn"),
            (turning, {"R": np.array([[1.0, 0.5], [0.5, 1.0]])}, "R changes when the pairs turn"),
            (searching, {"search": Search(12, {"x": 0.05}, 5), "integrity": None}, "give integrity, too"),
            (
                searching,
                {"search": Search(12, {"x": 0.05}, 5, all_groups=True), "integrity": Integrity({"x": 0.5})},
                "none is ever excluded: omit all_groups",
            ),
            (Search, {"starts": 0}, "number of starts is 0"),
            (Search, {"patience": 0}, "patience is 0"),
            (Search, {"dwell": 0}, "dwell is 0"),
            (Search, {"agreement": {"x": 0.0}}, "agreement of 'x' is 0"),
            (innovation_monitor.states, {"channels": [Q, F], "repeats": 1}, "2"),
            (glsdc_search.screen, {"repeats": 0}, "number of repeats is 0"),
        )
    ),
    *(
        call(estimator, part, **changed)
        for changed, part in (
            ({"R": np.eye(2)}, "R has shape"),
            ({"R": [[1.0, 2.0, 0], [2.0, 1.0, 0], [0, 0, 1]]}, "not positive definite"),
            (every(1.0), "no channel and no prior depends on 'x'"),
            ({"h": Implicit(mixed), "integrity": Integrity({"x": 1.0}, exclude=True)}, "channels of several groups"),
            ({"h": Implicit(lambda q, y, k: {n: 5 * (v - q["x"]) for n, v in y.items()})}, "by 5 m"),
            ({"phases": [Phase("a", lambda q, k: 9 * q["x"], 1.0, 0.1)]}, "'a' is ...largest value is 1"),
        )
    ),
    *(
        call(error_map.fit, part, **MAP | changed)
        for changed, part in (
            ({"grid": lookup_table.square(7.0, 1.0)}, "no samples lie about "),
            ({"estimated": np.full((20, 3), np.nan)}, "estimates have the shape (20, 3), not all finite"),
            ({"estimated": np.zeros((0, 3)), "reference": np.zeros((0, 3))}, "a row or more"),
            ({"estimated": np.zeros((2, 3)), "reference": np.zeros((2, 3))}, "2 samples make no triangle"),
            *(
                (
                    {"estimated": MAP["estimated"] * along},
                    "20 samples make no triangle: measure at three places or more",
                )
                for along in ([1.0, 0.0, 0.0], [0.0, 1.0, 1.0], [0.0, 0.0, 0.0])
            ),
            ({"estimated": np.zeros((1, 3))}, "1 estimates meet 20 references"),
            ({"units": [1e-8, 0.0, 1e-6]}, "give a positive one for each of two or more coordinates"),
            ({"units": [1e-8]}, "give a positive one for each of two or more coordinates"),
        )
    ),
    *(
        call(
            error_map.block,
            f"the map is of {mapped} coordinates: give as many ...not {signals}",
            of=error_map.ErrorMap(GRID, np.zeros((mapped, 9, 5))),
            time=TIME,
            signals=[Q, F, U][:signals],
        )
        for mapped, signals in ((2, 3), (1, 1))
    ),
    *(
        call(error_map.ErrorMap, "give finite ones for its points, (3, 9, 5)", grid=GRID, added=np.zeros(shape))
        for shape in ((3, 9, 6), (3, 5, 9))
    ),
    *(
        call(Grid, part, low=low, spacing=spacing, size=size)
        for low, spacing, size, part in (
            ((0.0, 0.0), 0.0, (3, 3), "spacing is"),
            ((0.0, 0.0), -1e-3, (3, 3), "spacing is"),
            ((0.0, 0.0), 1e-3, (1, 3), "whole number of at least 2"),
            ((0.0, 0.0), 1e-3, (3.5, 3), "whole"),
            ((0.0, 0.0), 1e-3, (2048, 2048), "wider spacing"),
            ((np.nan, 0.0), 1.0, (3, 3), "the low ends"),
            ((0.0, 0.0, 0.0), 1.0, (3, 3), "the low ends"),
        )
    ),
    *(
        call(lookup_table.interpolate_samples, part, at=at, values=values, grid=Grid((0.0, 0.0), 1.0, (2, 2)))
        for at, values, part in (
            (CORNERS, np.ones((3, 1)), "the samples are (3, 1) at positions (4, 2)"),
            (CORNERS * np.nan, np.ones((4, 1)), "give finite numbers"),
            (np.zeros((0, 2)), np.zeros((0, 1)), "give finite numbers"),
        )
    ),
    *(
        call(lookup_table.fit, part, **{"places": PLACES, "residuals": PLACES, "grid": GRID} | changed)
        for changed, part in (
            ({"places": 1.2 * PLACES}, "widen the grid"),
            ({"residuals": PLACES[:9]}, "one for each"),
            ({"smoothing": 0.0}, "smoothing"),
            ({"residuals": np.nan * PLACES}, "the residuals have the shape (20, 2), not all finite"),
            ({"places": CENTRE, "residuals": CENTRE}, "41 places determine 2 of the surfaces"),
            (
                dict.fromkeys(("places", "residuals"), np.r_[CENTRE, CENTRE[:, ::-1]]),
                "82 places determine 3 of the surfaces",
            ),
            (dict.fromkeys(("places", "residuals"), np.c_[ALONG, ALONG]), "41 places determine 3 of the surfaces"),
            (dict.fromkeys(("places", "residuals"), np.array([[0.1, 0.2]])), "1 places determine 1 of the surfaces"),
        )
    ),
]
TIMING = [
    call(lead_lag.block, "discretise it for that", time=Discrete(2e-2)),
    call(linear_block.block, "discretise", **SIGNALS | {"system": replace(LINEAR, time=Continuous())}),
]

test_a_block_raises_a_model_error = refusals(ModelError, MODEL)
test_a_block_raises_a_signal_error = refusals(SignalError, SIGNAL)
test_a_block_raises_a_timing_error = refusals(TimingError, TIMING)
