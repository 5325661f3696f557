"""Calls that work, one for each public function: `benchmarks.hostile` then spoils one argument at a time.

An argument has the example of its function where `own` has one, else that of its name in `usual`, else its default.
"""

import dataclasses
import functools
from collections.abc import Mapping
from typing import Any

import casadi as ca
import numpy as np

from synth.analyse import discretise, lie, relative_degree, singularity, trim, worst
from synth.block import Block, Constant, State, Step
from synth.block import build as block
from synth.plant import build as plant
from synth.signals import Parameter, Signal
from synth.statespace import StateSpace
from synth.synthesise import (
    belief,
    internal_model,
    kalman,
    lead_lag,
    logs,
    lqg,
    lqr,
    noise,
    optimal_servo,
    reduced_observer,
    safety,
)
from synth.synthesise.minimal_polynomial import Mode
from synth.timing import Continuous, Discrete

Call = Mapping[str, Any]
T = 0.01
UNITS = {"x": "m", "v": "m/s", "f": "N"}
TIME = Discrete(T)
GAP, RATE = Signal("gap", "m", 0.01, 0.03), Signal("rate", "m/s", -1.0, 1.0)
CURRENT = Signal("current", "A", 0.1, 10.0)
U, Y = Signal("u", "1", -1.0, 1.0), Signal("y", "1", -1.0, 1.0)
K = Parameter("k", 30.0, "N/A", 0.1, "measured")
POINTS = {"low": {"gap": 0.012}, "high": {"gap": 0.028}}


def _physics(x: Any, u: Any, p: Any) -> Any:
    return {"gap": x["rate"], "rate": 9.81 - p["k"] * ca.exp(-x["gap"] / 0.02) * u["current"] / 5.0}, {"gap": x["gap"]}


def _law(u: Any, x: Any, k: Any) -> Step:
    return Step({"y": k["gain"] * u["u"] + x["last"]}, {"last": u["u"]})


def _step(name: str = "step") -> Block:
    last = State(Signal("last", "1", -1.0, 1.0), 0.0)
    return block(
        name, TIME, _law, inputs=[U], outputs=[Y], states=[last], constants=[Constant("gain", 2.0, "1", "given")]
    )


def _linear(theta: Any) -> Any:
    J = np.array([[1.0, 0.0], [1.0, 1.0], [1.0, 2.0]])
    return (J @ theta)[:, None], J[:, None, :]


def _loop(values: Mapping[str, float]) -> Any:
    return ([[-values["k"]]], [[values["k"]]], [[1.0]])


def fields(instance: Any) -> Call:
    """Return a dataclass's fields by name."""
    return {f.name: getattr(instance, f.name) for f in dataclasses.fields(instance)}


def _scaled(matrix: ca.SX, symbols: ca.SX) -> singularity.Scaled:
    return singularity.scaled(matrix, symbols, [GAP, RATE], [U, Y], ["a", "b"])


def _linear_signals() -> Call:
    state = Signal("x1", "1", -1.0, 1.0)
    return {"inputs": [Signal("u1", "1", -1, 1)], "outputs": [Signal("y1", "1", -1, 1)], "states": [state]}


def _regulator() -> Call:
    model = internal_model.augmented(
        discretise.zero_order_hold(([[0, 1], [0, 0]], [[0], [1]], [[1, 0]]), T), [0.0, 6.0]
    )
    error, rate, demand = (Signal(n, u, -1.0, 1.0) for n, u in (("e", "m"), ("de", "m/s"), ("w", "m/s^2")))
    gain = lqr.dlqr(model, np.eye(5), np.eye(1))
    return {"gain": gain, "error": error, "rate": rate, "demand": demand, "bounds": [1.0, 1.0, 1.0], "time": TIME}


@functools.cache
def usual() -> Call:
    """Return examples by the names of arguments."""
    stage = StateSpace(
        [[0, 1], [-4, -0.4]], [[0], [1]], [[1, 0]], [[0]], ("x", "v"), ("f",), ("x",), Continuous(), UNITS
    )
    maglev = plant("maglev", [GAP, RATE], [CURRENT], [GAP], [K], _physics)
    rest = trim.trim(maglev, {"gap": 0.02}, ["current"])
    held = discretise.zero_order_hold(stage, T)
    gain = lqr.lqrd(stage, np.eye(2), np.eye(1), T)
    estimator = kalman.sampled(stage, 1e-4 * np.eye(2), [[1e-6]], T)
    servo = optimal_servo.lqrd(stage, [0.0], np.ones(3), np.eye(1), T)
    rows = np.linspace(0.0, 1.0, 12)
    return {
        **dict.fromkeys(("system", "plant", "model", "loop", "shaping"), stage),
        **dict.fromkeys(("time",), TIME),
        "period_s": T,
        "horizon_s": 1.0,
        "delay_s": 0.004,
        "name": "name",
        "kind": "signal",
        "unit": "m/s",
        "A": stage.A,
        "B": stage.B,
        "C": stage.C,
        "E": np.zeros((1, 1)),
        "F": stage.A,
        "Q": np.eye(2),
        "R": np.eye(1),
        "W": 1e-4 * np.eye(2),
        "V": np.array([[1e-6]]),
        "P": np.eye(2),
        "K": np.array([[-1.0, -0.5]]),
        "outputs": ["x"],
        "inputs": ["f"],
        "states": ["x", "v"],
        "measured": ["x"],
        "signals": [GAP, RATE],
        "poles": [-1.0, -2.0],
        "frequencies": [0.0, 6.0],
        "exosystem": [0.0],
        "given": [0.0, 6.0],
        "level": 0.95,
        "values": [1.0, 2.0],
        "labels": ["a"],
        "tag": "",
        "box": [GAP, RATE],
        "points": [0.011, 0.02],
        "held": None,
        "gain": gain,
        "estimator": estimator,
        "servo": servo,
        "regulator": servo,
        "point": rest,
        "block": _step(),
        "observer": reduced_observer.by_poles(held, ["x"], [0.5]),
        "computed": None,
        "at": 3.0,
        "w": [ca.SX.sym("w")],
        "controller": servo.controller,
        "maglev": maglev,
        "sampled": held,
        "rows": rows,
        "compensator": _lead(),
        "qs": [0.0, 1.0],
        "band": (0.1, 10.0),
        "digits": [2, 2],
        "y": [0.1],
        "u": [0.0],
        "x": [0.0, 0.0],
        "X": np.eye(2),
        "references": ["x"],
        "decay_per_s": 3.0,
        "samples": 2,
        "skew": 0.0,
        "certify": True,
    }


def _lead() -> lead_lag.Compensator:
    return lead_lag.from_constants(10.0, [0.1], [0.01])


@functools.cache
def own() -> Mapping[str, Call]:
    """Return examples by function, where those of the names do not serve."""
    common = usual()
    maglev, held, stage = common["maglev"], common["sampled"], common["system"]
    x, g, u = ca.SX.sym("x"), ca.SX.sym("g"), ca.SX.sym("u")
    symbols = {"gap": x, "rate": g}
    matrix = ca.vertcat(ca.horzcat(1 + x, g), ca.horzcat(0, 2))
    single = {"plant": maglev}
    log = logs.Log({"a": common["rows"], "b": 2 * common["rows"]}, T)
    plant_log = logs.Log({"gap": 0.02 + 0 * common["rows"], "rate": 0 * common["rows"], "current": np.full(12, 4.0)}, T)
    safe = safety.Safety(3, {"y": 0.0}, {"y": 10.0}, "at rest nothing moves")
    discrete = {"system": held, "time": TIME}
    white = {"system": held, "W": 1e-4 * np.eye(2)}
    kalman_pair = {"gain": common["gain"], "estimator": common["estimator"]}
    shaping = StateSpace([[-5.0]], [[1.0]], [[5.0]], [[0.0]], ("s1",), ("w",), ("f",), Continuous())
    coloured = StateSpace([[-5.0]], [[1.0]], [[5.0]], [[0.0]], ("s1",), ("w",), ("x",), Continuous())
    weigh = StateSpace([[-5.0]], [[1.0]], [[5.0]], [[0.0]], ("s1",), ("x",), ("z1",), Continuous())
    seen = StateSpace(held.A, held.B, np.eye(2), np.zeros((2, 1)), held.states, held.inputs, held.states, TIME)
    sum_of = StateSpace([[1.0]], [[1.0]], [[1.0]], [[0.0]], ("sum",), ("x",), ("sum",), TIME)
    cut = StateSpace(
        [[0.5]], [[1.0, 0.0]], [[0.0], [1.0]], [[0.0, 1.0], [2.0, 0.0]], ("k",), ("x", "s"), ("c", "s_out"), TIME
    )
    unmoved = StateSpace([[1.0]], [[0.0]], [[1.0]], [[0.0]], ("x1",), ("u1",), ("y1",), TIME)
    first = belief.initial(held, np.eye(2))
    servo = common["servo"]
    return {
        "signals.names": {"signals": [GAP, RATE]},
        "signals.Signal": {"name": "gap", "unit": "m", "low": 0.0, "high": 1.0, "about": "the gap"},
        "signals.Parameter": {"name": "k", "value": 1.0, "unit": "N", "tolerance": 0.1, "source": "measured"},
        "timing.common": {"times": [TIME, TIME]},
        "timing.Discrete": {"period_s": T},
        "plant.Plant": fields(maglev),
        "plant.symbols": {"signals": [GAP]},
        "plant.build": {
            "name": "maglev",
            "states": [GAP, RATE],
            "inputs": [CURRENT],
            "outputs": [GAP],
            "parameters": [K],
            "physics": _physics,
        },
        "statespace.StateSpace": {
            "A": stage.A,
            "B": stage.B,
            "C": stage.C,
            "D": stage.D,
            "states": ("x", "v"),
            "inputs": ("f",),
            "outputs": ("x",),
            "time": Continuous(),
            "units": UNITS,
        },
        "statespace.from_control": {"system": stage.to_control()},
        "block.State": {"signal": GAP, "initial": 0.02, "integer": False},
        "block.Constant": {"name": "k", "value": 1.0, "unit": "1", "source": "given"},
        "block.Named": {"signal": GAP, "block": "b", "tag": "", "certificate": None},
        "block.Fault": {"bit": 1, "output": "fault", "input": "gap", "suspect": None},
        "block.Step": {"output": {"y": u}, "next": {"x": u}, "named": [(GAP, u)], "certified": {}},
        "block.Block": fields(_step()),
        "block.build": {
            "name": "step",
            "time": TIME,
            "law": _law,
            "inputs": [U],
            "outputs": [Y],
            "states": [State(Signal("last", "1", -1.0, 1.0), 0.0)],
            "constants": [Constant("gain", 2.0, "1", "given")],
        },
        "block.clip": {"expr": u, "bounds": GAP},
        "compose.compose": {"name": "whole", "blocks": [_step()], "inputs": ["u"], "outputs": ["y"]},
        "discretise.gramian": {"F": stage.A, "W": np.eye(2)},
        "discretise.with_delay": {"system": held, "samples": 2},
        "interconnect.connect": {"models": [stage], "inputs": ["f"], "outputs": ["x"], "wires": {"f": {"f": 1.0}}},
        "lie.affine": single,
        "linearise.linearise": single,
        "loop.cut": {"blocks": [_step()], "signal": "y"},
        "loop.linearised": {"block": _step(), "state": {"last": 0.0}, "inputs": {"u": 0.0}},
        "loop.opened": {"controller": cut, "signal": "s", "sensors": {"x": "x"}, "actuators": {"f": "c"}, "delay": 1},
        "magnitude.magnitudes": {"terms": {"x": x * g}, "symbols": symbols, "box": [RATE], "along": "gap", "held": {}},
        "magnitude.conditioning": {"matrix": matrix, "symbols": symbols},
        "magnitude.require_invertible": {"matrix": matrix, "symbols": symbols},
        "relative_degree.of_plant": single,
        "relative_degree.of_affine": {"model": lie.affine(maglev)},
        "sensitivity.close": {"controller": ([[-100.0]], [[1.0]], [[10.0]])},
        "singularity.scaled": {
            "matrix": matrix,
            "symbols": ca.vertcat(x, g),
            "signals": [GAP, RATE],
            "inputs": [U, Y],
            "labels": ["a", "b"],
        },
        "singularity.worst": {"matrix": _scaled(matrix, ca.vertcat(x, g))},
        "singularity.mapped": {"matrix": _scaled(matrix, ca.vertcat(x, g)), "down": "gap", "across": "rate"},
        "structure.unmoved": {"time": Continuous()},
        "structure.require_stabilisable": {"time": Continuous()},
        "structure.require_detectable": {"time": Continuous(), "what": "Q"},
        "structure.has_transmission_zero": {"s": 1.0},
        "structure.pair": {"value": 1 + 2j},
        "structure.rates": {"values": np.array([-1.0 + 0j])},
        "structure.direction": {"vector": np.array([1.0 + 0j, 2.0]), "names": ["a", "b"]},
        "structure.spelled": {"direction": {"a": 1 + 0j}},
        "transfer.Delayed": {"model": stage, "delay_s": 0.01, "hold_s": 0.0},
        "transfer.decay": {"poles": np.array([-1.0 + 0j]), "time": Continuous()},
        "transfer.log": {"value": np.array([1 + 1j])},
        "trim.trim": {"plant": maglev, "fixed": {"gap": 0.02}, "free": ["current"]},
        "worst.Figure": {"name": "f", "unit": "1", "of": lambda loop: 1.0, "largest": False},
        "worst.search": {"loop": _loop, "parameters": [K], "figure": worst.PHASE_MARGIN},
        "zero_dynamics.at_point": {"plant": maglev, "degree": relative_degree.of_plant(maglev)},
        "zero_dynamics.of_linear": {"degrees": [2]},
        "anti_windup.of_gain": {"controller": ([[-1.0]], [[1.0]], [[1.0]]), "E": [[-0.5]]},
        "anti_windup.conditioning": {"controller": ([[-1.0]], [[1.0]], [[1.0]], [[1.0]]), "references": ["u1"]},
        "belief.initial": {"system": held},
        "belief.predict": {"belief": first, "system": held},
        "belief.update": {"belief": first, "system": held, "y": [0.1]},
        "bumpless.start": {"state": [0.1, 0.0], "present": [0.2]},
        "coloured.process": {"shaping": shaping},
        "coloured.measurement": {"shaping": coloured},
        "crossover.design": {"crossover": 10.0, "phase_margin": 40.0},
        "deadbeat.feedback": {"system": held},
        "deadbeat.lasting": {"model": unmoved},
        "derivative_filter.block": {"signal": GAP, "rate": RATE, "bandwidth": 30.0},
        "dynamic_extension.integrators": {"plant": maglev, "inputs": ["current"]},
        "dynamic_extension.extend": single,
        "feedback_linearisation.of_plant": {**single, "point": common["point"]},
        "feedback_linearisation.linearise": {"acceleration": [x + u], "inputs": {"u": u}},
        "frequency_weights.shaped": {"filters": [weigh], "Qz": [[1.0]], "R": [[1.0]], "Qx": np.eye(2)},
        "frequency_weights.augmented": {"filters": [weigh]},
        "gauss_newton.minimise": {
            "model": _linear,
            "y": np.array([[1.0], [2.0], [3.1]]),
            "start": [0.0, 0.0],
            "parameters": ["a", "b"],
            "outputs": ["y"],
        },
        "identify.fit_linear": {
            "equations": {"e": x - u * g},
            "signals": {"a": g, "b": x},
            "symbols": {"k": u},
            "log": log,
            "parameters": [Parameter("k", 1.0, "1", 0.1, "guess")],
        },
        "identify.fit_equations": {
            "plant": maglev,
            "log": plant_log,
            "parameters": ["k"],
            "rates": {"gap": "rate", "rate": "rate"},
        },
        "identify.fit_trajectory": {"plant": maglev, "log": plant_log, "parameters": ["k"], "measured": ["gap"]},
        "internal_model.from_matrix": {"S": [[0.0, 2.0], [-2.0, 0.0]]},
        "inverse_lqr.diagonal_weights": {"poles": [-2.0, -3.0], "R": 1.0},
        "inverse_lqr.gain_weights": {"K": common["gain"].K, "system": stage},
        "inverse_lqr.reproduces": {"q": [1.0, 1.0], "R": 1.0},
        "kalman.discrete": white,
        "kalman.steady": {"noisy": noise.white(held, 1e-4 * np.eye(2), [[1e-6]])},
        "lead_lag.Compensator": {"gain": 1.0, "zeros": (-1.0,), "poles": (-10.0,), "time": Continuous()},
        "lead_lag.from_constants": {"gain": 1.0, "numerator_s": [0.1], "denominator_s": [0.01], "integrators": 0},
        "least_squares.solve": {
            "Phi": [[1.0, 0.0], [1.0, 1.0], [1.0, 2.0]],
            "y": [1.0, 2.0, 3.1],
            "parameters": ["a", "b"],
            "outputs": ["y"],
        },
        "least_squares.unsettled": {"passes": 3},
        "linear_block.block": {"system": ([[0.5]], [[1.0]], [[1.0]], [[0.0]], TIME), **_linear_signals()},
        **{f"lqg.{name}": kalman_pair for name in ("predictor", "current")},
        "lqg.expected": {"controller": lqg.current(common["gain"], common["estimator"])},
        "lqg.integrals": {"gain": common["gain"], "model": stage},
        "lqr.dlqr": discrete,
        "lqr.cost_ratio": {"gain": lqr.lqr(stage, np.eye(2), np.eye(1))},
        "lqr.output_weighted": {"Qy": [[1.0]]},
        "noise.stationary": {"A": stage.A, "W": np.eye(2), "time": Continuous()},
        "noise.white": white,
        "optimal_servo.lqr": {"Q": np.eye(3)},
        "optimal_servo.lqrd": {"Q": np.eye(3)},
        "recovery.at_input": {"gain": lqr.lqr(stage, np.eye(2), np.eye(1))},
        "recovery.at_output": {"estimator": kalman.continuous(stage, np.eye(2), [[1e-2]])},
        "reduced_compensator.integrals": {"system": held, "signals": {"x_integral": "x"}},
        "reduced_compensator.augmented": {"computed": sum_of},
        "reduced_observer.from_gain": {"system": held, "L": [[1.0]]},
        "reduced_observer.by_poles": {"system": held, "poles": [0.5]},
        "reduced_observer.by_riccati": {"system": held},
        "reduced_observer.deadbeat": {"system": held},
        "regulator.block": _regulator(),
        "regulator_equations.solve": {"S": [[0.0]], "E": [[0.0], [1.0]], "F": [[1.0]]},
        "regulator_equations.require_solvable": {"modes": [Mode(0j, 1)]},
        "regulator_equations.require_no_zero": {"points": [0j]},
        "riccati.checked_weights": {"N": None},
        "safety.Guarded": {"signal": GAP, "initial": 0.02, "measurement": True, "held": True},
        "safety.Safety": fields(safe),
        "safety.guard": {"inputs": [safety.Guarded(GAP, 0.02, True)], "bad_samples": 3},
        "safety.safe_output": {"outputs": [Y], "safety": safe},
        "safety.frozen": {"block": safety.guard(TIME, [safety.Guarded(GAP, 0.02, True)], 3)},
        "servo.of_gain": {"K": [[-1.0, -1.0, -1.0]]},
        "servo.observed": {"L": [[1.0], [1.0]]},
        "servo.estimated": {"servo": servo, "estimator": common["estimator"].predictor()},
        "servo.parts": {"regulated": None, "controls": None},
        "steady_error.evaluate": {"errors": ["x"]},
        "steady_error.named": {"signals": ["x"], "end": "reference"},
        "steady_error.closed": {
            "plant": held,
            "measured": seen,
            "regulated": ["x"],
            "controls": ["f"],
            "controller": servo.controller,
        },
        "logs.Log": {"samples": {"a": [1.0, 2.0]}, "period_s": T, "times": [0.0, T]},
        "check.Check": {"name": "c", "found": 1.0, "limit": 2.0, "unit": "1", "about": ""},
    }
