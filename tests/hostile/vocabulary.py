"""Valid calls of the vocabulary: signals, times, models and Blocks."""

from collections.abc import Mapping

import casadi as ca

from synth.block import Constant, State, table
from synth.signals import Signal
from synth.timing import Continuous
from tests.hostile.examples import (
    CURRENT,
    GAP,
    RATE,
    TIME,
    UNITS,
    Call,
    K,
    T,
    U,
    Y,
    example_law,
    example_physics,
    example_step,
    fields,
    usual,
)


def examples() -> Mapping[str, Call]:
    """Return examples by function, where those by argument name do not apply."""
    common = usual()
    stage, u = common["system"], ca.SX.sym("u")
    return {
        "signals.signal_names": {"signals": [GAP, RATE]},
        "signals.Signal": {"name": "gap", "unit": "m", "low": 0.0, "high": 1.0, "about": "the gap"},
        "signals.Parameter": {"name": "k", "value": 1.0, "unit": "N", "tolerance": 0.1, "source": "measured"},
        "signals.product_unit": {"first": "m/s", "second": "s"},
        "signals.quotient_unit": {"first": "m", "second": "s"},
        "timing.common": {"times": [TIME, TIME]},
        "timing.Discrete": {"period_s": T},
        "plant.Plant": fields(common["maglev"]),
        "plant.symbols": {"signals": [GAP]},
        "plant.build": {
            "name": "maglev",
            "states": [GAP, RATE],
            "inputs": [CURRENT],
            "outputs": [GAP],
            "parameters": [K],
            "physics": example_physics,
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
        "statespace.coefficients": {"system": common["transfer"]},
        "statespace.in_common_time": {"systems": [stage, stage]},
        "statespace.from_control": {"system": stage.to_control()},
        "block.State": {"signal": GAP, "initial": 0.02, "integer": False},
        "block.Constant": {"name": "k", "value": 1.0, "unit": "1", "source": "given"},
        "block.ComputedSignal": {"signal": GAP, "block": "b", "tag": "", "certificate": None},
        "fault.Fault": {"bit": 1, "output": "fault", "input": "gap", "suspect": None},
        "block.Step": {"output": {"y": u}, "next": {"x": u}, "named": [(GAP, u)], "certified": {}},
        "block.Block": fields(example_step()),
        "block.build": {
            "name": "step",
            "time": TIME,
            "law": example_law,
            "inputs": [U],
            "outputs": [Y],
            "states": [State(Signal("last", "1", -1.0, 1.0), 0.0)],
            "constants": [Constant("gain", 2.0, "1", "given")],
        },
        "block.dot": {"coefficients": [u, u], "values": [u, u]},
        "block.is_dot": {"function": table("ramp", [0.0, 1.0])},
        "block.clip": {"expr": u, "bounds": GAP},
        "composition.compose": {"name": "whole", "blocks": [example_step()], "inputs": ["u"], "outputs": ["y"]},
    }
