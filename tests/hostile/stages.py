"""Valid calls of the functions on a declared stage: its controller, its loops, its control axes."""

from collections.abc import Mapping
from dataclasses import replace

import casadi as ca

from synth import stage
from synth.analyse.loops import robustness
from synth.analyse.structure import parity
from synth.block import Constant
from synth.blocks.estimate import dead_reckoning, glsdc_estimator
from synth.blocks.estimate.glsdc_model import Unknown
from synth.blocks.faults import landing, probe, redundancy
from synth.blocks.guard import following, missed_calls
from synth.blocks.laws import axis
from synth.plant import Plant
from synth.signals import Signal
from synth.synthesise.nonlinear import feedback_linearisation
from synth.timing import Discrete
from tests.hostile.examples import GAP, Call, U, fields, usual

POINTS = {"middle": {"gap": 0.02}}


def examples() -> Mapping[str, Call]:
    """Return examples by function: the levitated mass under one axis at 1 kHz."""
    maglev = usual()["maglev"]
    noise = {"process": {"rate": 1e-2}, "sensor": {"gap": 1e-10}}
    asked: Call = {
        "model": feedback_linearisation.of_plant(maglev).chain("gap"),
        "modes": {0.0: 5.0},
        "weights": {"gap": 1.0},
        "command_weight": 1e-8,
        "anti_windup": 5.0,
        "estimator": axis.kalman(noise["process"], noise["sensor"]),
    }
    interface = stage.interface(
        maglev,
        sensors=[stage.Sensor("gap")],
        set_points=[stage.SetPoint("gap_ref", "gap", 0.012, 0.028)],
        actuators=[stage.Actuator("current", 4.0, 10.0)],
    )
    controller = stage.controller("held", Discrete(1e-3), interface, [axis.servo(**asked)])
    loops = robustness.of_controller(controller, maglev, POINTS)
    opened = robustness.open_loops(loops)
    place = robustness.LoopsAt("middle", ["current"], ["current"], lambda _: opened[0].L)
    moving = dead_reckoning.Axis("gap", GAP, replace(GAP, name="predicted"), U, 0.5, 1.0, 0.9)
    behind = following.Axis(GAP, replace(GAP, name="gap_ref"), 1e-3, 5)
    angle = Unknown(Signal("angle", "rad", -1, 1), largest_deviation=0.5, step=0.5)
    coils = [Signal(name, "V", -2, 2) for name in ("a", "b")]
    resolver: Call = {
        "name": "resolver",
        "time": Discrete(1e-3),
        "h": lambda q, k: {"a": ca.cos(q["angle"]), "b": ca.sin(q["angle"])},
        "R": [[1e-4, 0.0], [0.0, 1e-4]],
        "channels": coils,
        "unknowns": [angle],
    }
    guarded = {"block": glsdc_estimator.estimator(**resolver), "name": "pose", "channels": coils, "bad_samples": 3}
    return {
        "safe_output.braking_block": {"axes": [moving], "demands": {"gap": (replace(U, name="law"), U)}, "share": 0.5},
        "dead_reckoning.Axis": fields(moving),
        "dead_reckoning.RateBias": {"pole": 0.99, "unmeasured": 28},
        "dead_reckoning.Disturbance": {"pole": 0.97, "largest": 5.0},
        "start.block": {"demands": {replace(U, name="law"): U}},
        "innovation_monitor.states": {"channels": coils, "repeats": 6},
        "innovation_monitor.numbers": {"channels": coils, "repeats": 6},
        "innovation_monitor.longest": {"channels": 6, "repeats": 14},
        "unwrap.block": {
            "reading": GAP,
            "position": replace(GAP, name="position", low=-10.0, high=10.0),
            "span": 3.0,
            "speed": 20.0,
            "bad_samples": 3,
        },
        "following.Axis": fields(behind),
        "following.block": {"time": Discrete(1e-3), "axes": [behind]},
        "dead_reckoning.block": {"axes": [moving]},
        "dead_reckoning.mean_innovation": {"measured": GAP, "predicted": GAP},
        "glsdc_estimator.estimator": resolver,
        "glsdc_estimator.guarded": guarded,
        "glsdc_model.Unknown": {"signal": GAP, "largest_deviation": 1e-3, "step": 1e-3, "start": 0.02},
        "glsdc_integrity.Integrity": {"limits": {"angle": 0.1}, "false_alarm": 1e-3, "risk": 1e-3},
        "glsdc_search.Search": {"starts": 6, "agreement": {"angle": 0.1}, "patience": 5},
        "glsdc_model.covariance": {"noise": [1e-3, 1e-3], "model_error": [1e-3, 0.0]},
        "glsdc_integrity.thresholds": {"freedom": 4, "false_alarm": 1e-3, "risk": 1e-3, "together": 2},
        "glsdc_search.screen": {"time": Discrete(1e-3), "channels": coils, "groups": [("a",), ("b",)], "repeats": 3},
        "axis.kalman": noise,
        "axis.servo": asked,
        "axis.decouple": {"axes": [axis.servo(**asked)]},
        "peak_bounds.state_bounds": {"system": ([[0.5]], [[1.0]], [[1.0]], [[0.0]], Discrete(1e-3)), "inputs": [1.0]},
        "safety.without_latch": {"block": controller.block},
        **_redundancy(maglev),
        "robustness.of_controller": {"controller": controller, "plant": maglev, "points": POINTS},
        "robustness.of_stage": {"stage": stage.design(controller, maglev, operating_points=POINTS)},
        "robustness.corners": {"plant": maglev, "parameters": ["k"]},
        "robustness.equilibrium_at": {"loops": loops, "point": "middle"},
        "robustness.open_loops": {"loops": loops},
        "robustness.equilibria": {"loops": loops},
        "robustness.survey": {"loops": loops},
        "robustness.closed_loops": {"loops": loops},
        "robustness.closed_loops_at": {"places": [place]},
        "robustness.disk_margins": {"loops": loops, "point": "middle"},
        "robustness.checks": {"loops": opened, "require": {"phase_margin": 10.0}},
    }


def _redundancy(maglev: Plant) -> Mapping[str, Call]:
    """Return examples of the Blocks that replace readings and that land."""
    time = Discrete(1e-3)
    q, w = Signal("position", "m", -1.0, 1.0), Signal("w", "m/s^2", -10.0, 10.0)
    descent = landing.Descent("q", 0.5, 0.08, 5e-3, 1e-3, 2.0, 1e-3, 60.0, 1.0, 0.49)
    decision = {"gate": {"q": 1e-3}, "travel": {"q": (-0.9, 0.9)}}
    tried, e = probe.Probe(100, 4, 1e-5, 3), Signal("e", "m", -1.0, 1.0)
    return {
        "parity.Tolerance": {"resolution": 1e-5, "offset": 0.0},
        "parity.Relation": {"weights": {"a": 1.0, "b": -1.0}, "threshold": 1e-5},
        "parity.relations": {
            "plant": maglev,
            "sensors": {"a": "gap", "b": "gap"},
            "tolerances": dict.fromkeys("ab", parity.Tolerance(1e-5, 0.0)),
        },
        "predictor.Gain": {"low": 0.8, "high": 1.2, "rate": 1.0},
        "predictor.Flags": {"trusted": "q_trusted", "unchanged": "q_unchanged", "frozen": "q_frozen"},
        "predictor.block": {
            "name": "q",
            "time": time,
            "measured": q,
            "demand": w,
            "bandwidth": 50.0,
            "rate": 1.0,
            "disturbance": 5.0,
        },
        "predictor.delay": {"name": "before", "time": time, "signals": [w]},
        "redundancy_decision.Decision": decision,
        "innovation_monitor.block": {
            "time": time,
            "sensor": Signal("q", "m", -1.0, 1.0),
            "decision": redundancy.Decision({"q": 1e-3}, {"q": (-0.9, 0.9)}),
        },
        "redundancy.block": {
            "time": time,
            "sensors": [Signal("q", "m", -1.0, 1.0)],
            "relations": [],
            "decision": redundancy.Decision({"q": 1e-3}, {"q": (-0.9, 0.9)}),
        },
        "landing.Descent": vars(descent),
        "landing.Braking": {"coordinate": "q", "acceleration": 1.0, "pole": 30.0, "bound": 1.0},
        "redundancy_decision.jump_gate": {"gate": 4e-5, "acceleration": 50.0, "resolution": 1e-5, "period": 1e-3},
        "redundancy_decision.frozen_gate": {"gate": 4e-5, "resolution": 1e-5, "noise": 1e-5},
        "landing.Levelling": {"coordinate": "q", "pole": 30.0, "predicted_pole": 20.0},
        "landing.Release": {"coordinate": "q", "spring": Constant("spring_q", 50.0, "1/s^2", "given")},
        "landing.block": {"time": time, "courses": [descent], "demands": [w], "patience": 5},
        "missed_calls.signal": {"limit": 40.0},
        "missed_calls.block": {"time": time, "count": missed_calls.signal(40.0), "bit": 3},
        "probe.Probe": {"quiet": 100, "quarter": 4, "step": 1e-5, "attempts": 3},
        "probe.block": {"time": time, "sensor": "q", "error": e, "demand": w, "probe": tried},
    }
