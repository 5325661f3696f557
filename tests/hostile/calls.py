"""Valid calls by function, where the examples of `examples` by argument name do not apply."""

import functools
import tempfile
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import casadi as ca
import numpy as np

from synth.analyse.loops import equilibrium
from synth.analyse.structure import relative_degree
from synth.blocks.estimate import advance
from synth.blocks.guard import safety
from synth.blocks.laws import lookup_table
from synth.signals import Parameter
from synth.synthesise.feedback import lqr
from synth.synthesise.identify import calibration, logs
from synth.synthesise.observers import kalman, square_root_kalman
from synth.synthesise.regulation.regulator_equations import Mode
from synth.timing import Continuous
from tests.hostile import stages, vocabulary
from tests.hostile.examples import (
    GAP,
    RATE,
    TIME,
    Call,
    T,
    U,
    Y,
    example_lead_lag,
    example_linear,
    example_linear_signals,
    example_predictive_servo,
    example_regulator,
    example_resting_loop,
    example_scaled_matrix,
    example_step,
    fields,
    model,
    usual,
)


@functools.cache
def examples() -> Mapping[str, Call]:
    """Return examples by function, where those by argument name do not apply."""
    common = usual()
    maglev, held, stage = common["maglev"], common["sampled"], common["system"]
    x, g, u = ca.SX.sym("x"), ca.SX.sym("g"), ca.SX.sym("u")
    symbols = {"gap": x, "rate": g}
    matrix = ca.vertcat(ca.horzcat(1 + x, g), ca.horzcat(0, 2))
    single = {"plant": maglev}
    log = logs.Log({"a": common["rows"], "b": 2 * common["rows"]}, T)
    calibrating: dict[str, Any] = {
        "h": lambda q, k: {"b": k["gain"] * q["a"]},
        "scan": log,
        "parameters": [Parameter("gain", 1.0, "1", 0.1, "guess")],
        "references": {"a": 1e-3},
        "readings": {"b": 1e-3},
    }
    plant_log = logs.Log({"gap": 0.02 + 0 * common["rows"], "rate": 0 * common["rows"], "current": np.full(12, 4.0)}, T)
    safe = safety.Safety(3, {"y": 0.0}, {"y": 10.0}, "at rest nothing moves")
    white = {"system": held, "W": 1e-4 * np.eye(2)}
    kalman_pair = {"gain": common["gain"], "estimator": common["estimator"]}
    seen = model(held.A, held.B, np.eye(2), np.zeros((2, 1)), held.states, held.inputs, held.states, TIME)
    sum_of = model([[1.0]], [[1.0]], [[1.0]], [[0.0]], ("sum",), ("x",), ("sum",), TIME)
    cut = model(
        [[0.5]], [[1.0, 0.0]], [[0.0], [1.0]], [[0.0, 1.0], [2.0, 0.0]], ("k",), ("x", "s"), ("c", "s_out"), TIME
    )
    slopes = {"deviations": lambda q: 1 / (2 + np.cos(q)), "changes": lambda q, half: half + 0 * q}
    first = square_root_kalman.initial(held, np.eye(2))
    servo = common["servo"]
    resting_loop = example_resting_loop()
    rest = equilibrium.solve(resting_loop, {}, common["point"])
    return {
        **stages.examples(),
        **vocabulary.examples(),
        **{
            f"information.{name}": {"H": np.ones((2, 3, 1)), "sigma": 0.1, "sizes": [1.0]}
            for name in ("accuracy", "largest_deviation")
        },
        "information.jacobians": {"h": ca.Function("h", [x], [ca.sin(x)]), "q": [[0.1], [0.2]]},
        "information.bias": {"H": np.ones((2, 3, 1)), "extra": np.ones((2, 3)), "sizes": [1.0]},
        "information.search": {
            **slopes,
            "low": [0.0],
            "high": [3.0],
            "cells": [2],
            "tolerance": 0.1,
            "most": 10000,
        },
        "information.bound_cells": {**slopes, "q": [[1.0]], "half": [[0.1]]},
        "discretise.gramian": {"F": stage.A, "W": np.eye(2)},
        "discretise.inverse_zero_order_hold": {"system": held},
        "discretise.inverse_tustin": {"system": held},
        "time_response.forced_response": {"inputs": {"f": [0.0, 1.0]}, "interval_s": T, "initial": {"v": 1.0}},
        "discretise.delay_samples": {"system": held, "samples": 2},
        "interconnect.connect": {"models": [stage], "inputs": ["f"], "outputs": ["x"], "wires": {"f": {"f": 1.0}}},
        "relative_degree.affine": single,
        "operating_points.linearise": single,
        "operating_points.require_point": single,
        "loop.cut": {"blocks": [example_step()], "signal": "y"},
        "loop.linearise_block": {"block": example_step(), "state": {"last": 0.0}, "inputs": {"u": 0.0}},
        "loop.open_loop": {
            "controller": cut,
            "signal": "s",
            "sensors": {"x": "x"},
            "actuators": {"f": "c"},
            "delay": 1,
        },
        "disk.least": {"loops": [stage], "below": 1.0},
        "plots.over_time": {"time": [0.0, 0.1], "signals": {"x": [0.0, 1.0]}, "units": {"x": "m"}},
        "equilibrium.SampledLoop": fields(resting_loop),
        "equilibrium.Equilibrium": fields(rest),
        "equilibrium.open_loop": {"rest": rest, "signal": "current"},
        "equilibrium.solve": {"closed": resting_loop, "references": {}, "near": common["point"]},
        "magnitude.magnitudes": {"terms": {"x": x * g}, "symbols": symbols, "box": [RATE], "along": "gap", "held": {}},
        "magnitude.conditioning": {"matrix": matrix, "symbols": symbols},
        "relative_degree.of_plant": single,
        "plant.velocities": single,
        "relative_degree.of_affine": {"model": relative_degree.affine(maglev)},
        "feedback_loop.close": {"controller": ([[-100.0]], [[1.0]], [[10.0]])},
        "feedback_loop.feedback": {"forward": ([[-100.0]], [[1.0]], [[10.0]])},
        "singularity.scaled": {
            "matrix": matrix,
            "symbols": ca.vertcat(x, g),
            "signals": [GAP, RATE],
            "inputs": [U, Y],
            "labels": ["a", "b"],
        },
        "singularity.worst": {"matrix": example_scaled_matrix(matrix, ca.vertcat(x, g))},
        "structure.uncontrollable_modes": {"time": Continuous()},
        "structure.require_stabilisable": {"time": Continuous()},
        "structure.require_detectable": {"time": Continuous(), "what": "Q"},
        "structure.pair": {"value": 1 + 2j},
        "structure.rates": {"values": np.array([-1.0 + 0j])},
        "structure.direction": {"vector": np.array([1.0 + 0j, 2.0]), "names": ["a", "b"]},
        "structure.direction_text": {"direction": {"a": 1 + 0j}},
        "transfer.Delayed": {"model": stage, "delay_s": 0.01, "hold_s": 0.0},
        "transfer.is_stable": {"poles": np.array([-1.0 + 0j]), "time": Continuous()},
        "transfer.check_limits": {"low": 1.0, "high": 2.0},
        "transfer.check_turns": {"late": 1e-3, "top": 10.0},
        "precise.log_magnitude": {"value": np.array([1 + 1j])},
        "operating_points.trim": {"plant": maglev, "fixed": {"gap": 0.02}, "free": ["current"]},
        "operating_points.trim_with_free_states": {"plant": maglev, "fixed": {"gap": 0.02}, "free": ["current"]},
        "zero_dynamics.at_point": {"plant": maglev, "degree": relative_degree.of_plant(maglev)},
        "zero_dynamics.of_linear": {"degrees": [2]},
        "square_root_kalman.initial": {"system": held},
        "square_root_kalman.predict": {"estimate": first, "system": held},
        "square_root_kalman.update": {"estimate": first, "system": held, "y": [0.1]},
        "advance.Position": {"signal": GAP, "speed": 1.0},
        "advance.acting": {"position": GAP, "samples": 1.5},
        "advance.lost": {"position": GAP},
        "advance.block": {"positions": [advance.Position(GAP, 1.0)], "samples": 1.5, "bad_samples": 5},
        "biquad.block": {"signal": GAP, "filtered": "gap_filtered", "poles": [30.0, 0.7], "zeros": [40.0, 0.1]},
        "jerk_limited.block": {
            "target": GAP,
            "measured": replace(GAP, name="gap_measured"),
            "velocity": 1.0,
            "acceleration": 20.0,
            "jerk": 400.0,
        },
        "derivative_filter.block": {"signal": GAP, "rate": RATE, "bandwidth": 30.0},
        "lqg.from_measurement": {"plant": held, "estimator": common["estimator"].predictor()},
        "feedback_linearisation.of_plant": {**single, "point": common["point"]},
        "feedback_linearisation.linearise": {"acceleration": [x + u], "inputs": {"u": u}},
        "gauss_newton.minimise": {
            "model": example_linear,
            "y": np.array([[1.0], [2.0], [3.1]]),
            "start": [0.0, 0.0],
            "parameters": ["a", "b"],
            "outputs": ["y"],
        },
        "calibration.calibrate": calibrating,
        "calibration.assess": {"calibration": calibration.calibrate(**calibrating), "held_out": log},
        "lookup_table.fit": {
            "places": [[0.0, 0.0], [1.0, 0.5], [0.5, 1.0], [1.0, 1.0]],
            "residuals": [[1.0], [2.0], [1.5], [2.5]],
            "grid": lookup_table.square(1.0, 0.5),
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
        "internal_model.exact": {"modes": [Mode(0j, 1)], "time": TIME},
        "inverse_lqr.diagonal_weights": {"poles": [-2.0, -3.0], "R": 1.0},
        "kalman.discrete": white,
        "kalman.steady": {"noisy": kalman.white(held, 1e-4 * np.eye(2), [[1e-6]])},
        "lookup_table.square": {"half_width": 1.0, "spacing": 0.5},
        "lead_lag.block": {**example_lead_lag(), "source": "(21)"},
        "lead_lag.pole": {"K": example_lead_lag()["K"]},
        "lead_lag.Compensator": {"gain": 1.0, "zeros": (-1.0,), "poles": (-10.0,), "time": Continuous()},
        "lead_lag.from_time_constants": {
            "gain": 1.0,
            "numerator_constants_s": [0.1],
            "denominator_constants_s": [0.01],
            "integrators": 0,
        },
        "least_squares.solve": {
            "Phi": [[1.0, 0.0], [1.0, 1.0], [1.0, 2.0]],
            "y": [1.0, 2.0, 3.1],
            "parameters": ["a", "b"],
            "outputs": ["y"],
        },
        "least_squares.no_convergence_text": {"passes": 3},
        "linear_block.block": {"system": ([[0.5]], [[1.0]], [[1.0]], [[0.0]], TIME), **example_linear_signals()},
        **{f"lqg.{name}": kalman_pair for name in ("predictor", "current")},
        "lqg.integrals": {"gain": common["gain"], "model": stage},
        "lqr.cost_ratio": {"gain": lqr.lqr(stage, np.eye(2), np.eye(1))},
        "kalman.stationary": {"A": stage.A, "W": np.eye(2), "time": Continuous()},
        "kalman.white": white,
        "servo.lqr": {"Q": np.eye(3)},
        "servo.lqrd": {"Q": np.eye(3)},
        "interconnect.integrals": {"system": held, "signals": {"x_integral": "x"}},
        "reduced_observer.augmented": {"computed": sum_of},
        "reduced_observer.from_gain": {"system": held, "L": [[1.0]]},
        "predictive_servo.Limits": {"error": 1e-3, "fastest": 0.1, "memory": 1.0},
        "predictive_servo.block": example_predictive_servo(),
        "regulator.block": example_regulator(),
        "regulator_equations.require_solvable": {"modes": [Mode(0j, 1)]},
        "regulator_equations.require_no_zero": {"points": [0j]},
        "riccati.weight_matrices": {"N": None},
        "safety.GuardedInput": {"signal": GAP, "initial": 0.02, "measurement": True, "held": True},
        "fault.Safety": fields(safe),
        "safety.guard": {"inputs": [safety.GuardedInput(GAP, 0.02, True)], "bad_samples": 3},
        "safe_output.block": {"outputs": [Y], "safety": safe},
        "safety.frozen": {"block": safety.guard(TIME, [safety.GuardedInput(GAP, 0.02, True)], 3)},
        "servo.of_gain": {"K": [[-1.0, -1.0, -1.0]]},
        "servo.with_estimator": {"servo": servo, "estimator": common["estimator"].predictor()},
        "servo.split_plant": {"regulated": None, "controls": None},
        "steady_error.evaluate": {"errors": ["x"]},
        "steady_error.with_suffix": {"signals": ["x"], "end": "reference"},
        "steady_error.closed_loop": {
            "plant": held,
            "measured": seen,
            "regulated": ["x"],
            "controls": ["f"],
            "controller": servo.controller,
        },
        "logs.Log": {"samples": {"a": [1.0, 2.0]}, "period_s": T, "times": [0.0, T]},
        "logs.read": {"path": _file("a [m]\n1.0\n"), "required": {"a": "m"}},
        "logs.parse": {"text": "a [m]\n1.0\n", "required": {"a": "m"}, "name": "measurements"},
    }


def _file(text: str) -> str:
    """Return the path of a file that holds a text."""
    path = Path(tempfile.gettempdir()) / "synth_hostile_example.txt"
    path.write_text(text, encoding="utf-8")
    return str(path)
