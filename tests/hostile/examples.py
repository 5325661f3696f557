"""Valid arguments of the public functions, of which `tests.hostile.search` replaces one at a time.

The example of an argument is that of its function in `calls`, else that of its name in `usual`, else its
default.
"""

import dataclasses
import functools
from collections.abc import Mapping
from typing import Any

import casadi as ca
import control
import numpy as np

from synth.analyse import discretise, operating_points
from synth.analyse.loops import equilibrium
from synth.analyse.structure import singularity
from synth.block import Block, Constant, State, Step
from synth.block import build as block
from synth.blocks.laws import predictive_servo
from synth.blocks.laws.lead_lag import Loop
from synth.plant import build as plant
from synth.signals import Parameter, Signal
from synth.statespace import StateSpace
from synth.synthesise.classical import lead_lag
from synth.synthesise.feedback import lqr
from synth.synthesise.observers import kalman, reduced_observer
from synth.synthesise.regulation import internal_model
from synth.synthesise.regulation import servo as servos
from synth.timing import Continuous, Discrete, Time

Call = Mapping[str, Any]
T = 0.01
UNITS = {"x": "m", "v": "m/s", "f": "N"}
TIME = Discrete(T)
GAP, RATE = Signal("gap", "m", 0.01, 0.03), Signal("rate", "m/s", -1.0, 1.0)
CURRENT = Signal("current", "A", 0.1, 10.0)
U, Y = Signal("u", "1", -1.0, 1.0), Signal("y", "1", -1.0, 1.0)
K = Parameter("k", 30.0, "N/A", 0.1, "measured")
POINTS = {"low": {"gap": 0.012}, "high": {"gap": 0.028}}


def example_physics(x: Any, u: Any, p: Any) -> Any:
    return {"gap": x["rate"], "rate": 9.81 - p["k"] * ca.exp(-x["gap"] / 0.02) * u["current"] / 5.0}, {"gap": x["gap"]}


def example_law(u: Any, x: Any, k: Any) -> Step:
    return Step({"y": k["gain"] * u["u"] + x["last"]}, {"last": u["u"]})


def example_step(name: str = "step") -> Block:
    last = State(Signal("last", "1", -1.0, 1.0), 0.0)
    return block(
        name, TIME, example_law, inputs=[U], outputs=[Y], states=[last], constants=[Constant("gain", 2.0, "1", "given")]
    )


def example_resting_loop() -> equilibrium.SampledLoop:
    """Return the levitated mass under an integrator of its gap, which rests wherever the mass does."""

    def law(u: Any, x: Any, k: Any) -> Step:
        total = x["sum"] + T * (u["seen"] - 0.02)
        return Step({"drive": 4.0 + 50.0 * (u["seen"] - 0.02) + 10.0 * total}, {"sum": total})

    total = State(Signal("sum", "m s", -1.0, 1.0), 0.0)
    drive, seen = Signal("drive", "A", 0.1, 10.0), Signal("seen", "m", 0.01, 0.03)
    controller = block("hold", TIME, law, inputs=[seen], outputs=[drive], states=[total])
    maglev = plant("maglev", [GAP, RATE], [CURRENT], [GAP], [K], example_physics)
    return equilibrium.SampledLoop(maglev, controller, {"seen": "gap"}, {"current": "drive"})


def example_linear(theta: Any) -> Any:
    J = np.array([[1.0, 0.0], [1.0, 1.0], [1.0, 2.0]])
    return (J @ theta)[:, None], J[:, None, :]


def model(A: Any, B: Any, C: Any, D: Any, x: Any, u: Any, y: Any, time: Time, units: Any = None) -> StateSpace:
    """Return a model from lists."""
    return StateSpace(np.array(A), np.array(B), np.array(C), np.array(D), x, u, y, time, units or {})


def fields(instance: Any) -> Call:
    """Return a dataclass's fields by name."""
    return {f.name: getattr(instance, f.name) for f in dataclasses.fields(instance)}


def example_scaled_matrix(matrix: ca.SX, symbols: ca.SX) -> singularity.Scaled:
    return singularity.scaled(matrix, symbols, [GAP, RATE], [U, Y], ["a", "b"])


def example_linear_signals() -> Call:
    state = Signal("x1", "1", -1.0, 1.0)
    return {"inputs": [Signal("u1", "1", -1, 1)], "outputs": [Signal("y1", "1", -1, 1)], "states": [state]}


def example_regulator() -> Call:
    model = internal_model.augmented(
        discretise.zero_order_hold(([[0, 1], [0, 0]], [[0], [1]], [[1, 0]]), T), [0.0, 6.0]
    )
    error, rate, demand = (Signal(n, u, -1.0, 1.0) for n, u in (("e", "m"), ("de", "m/s"), ("w", "m/s^2")))
    gain = lqr.lqr(model, np.eye(5), np.eye(1))
    return {"gain": gain, "error": error, "rate": rate, "demand": demand, "bounds": [1.0, 1.0, 1.0], "time": TIME}


def example_predictive_servo() -> Call:
    measured, reference, demand = (Signal(n, u, -1.0, 1.0) for n, u in (("q", "m"), ("q_ref", "m"), ("w", "m/s^2")))
    signals = {"measured": measured, "reference": reference, "demand": demand}
    limits = predictive_servo.Limits(1e-3, 0.1, 1.0)
    numbers = {"frequencies": [0.0, 6.0], "cancelled": 0.8, "disturbance": 1.0, "limits": limits}
    return {"name": "q", "time": TIME, "gain": example_regulator()["gain"], **signals, **numbers}


@functools.cache
def usual() -> Call:
    """Return examples by the names of arguments."""
    stage = model([[0, 1], [-4, -0.4]], [[0], [1]], [[1, 0]], [[0]], ("x", "v"), ("f",), ("x",), Continuous(), UNITS)
    maglev = plant("maglev", [GAP, RATE], [CURRENT], [GAP], [K], example_physics)
    rest = operating_points.trim(maglev, {"gap": 0.02}, ["current"])
    held = discretise.zero_order_hold(stage, T)
    gain = lqr.lqrd(stage, np.eye(2), np.eye(1), T)
    estimator = kalman.kalmd(stage, 1e-4 * np.eye(2), [[1e-6]], T)
    servo = servos.lqrd(stage, [0.0], np.ones(3), np.eye(1), T)
    rows = np.linspace(0.0, 1.0, 12)
    return {
        **dict.fromkeys(("system", "plant", "model", "loop"), stage),
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
        "exosystem_or_model": [0.0, 6.0],
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
        "block": example_step(),
        "observer": reduced_observer.from_gain(held, ["x"], [[1.0]]),
        "computed": None,
        "frequency": 3.0,
        "w": [ca.SX.sym("w")],
        "controller": servo.controller,
        "transfer": control.tf([1.0], [1.0, 2.0]),
        "maglev": maglev,
        "sampled": held,
        "rows": rows,
        "compensator": example_lead(),
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


def example_lead() -> lead_lag.Compensator:
    return lead_lag.from_time_constants(10.0, [0.1], [0.01])


def example_lead_lag() -> Call:
    """Return a lead-lag loop with integral action."""
    K = lead_lag.tustin(lead_lag.Compensator(10.0, (-10.0, -1.0), (-100.0, 0.0)), TIME.period_s, 3.0)
    set_point = Signal("gap_ref", "m", 0.01, 0.03)
    force, achieved = (Signal(name, "N", -10, 10) for name in ("force", "achieved"))
    return {"K": K, "of": Loop(GAP, set_point, force, achieved, 1.0, 10.0)}
