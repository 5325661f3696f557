"""The compiled loop in lanes: lanes.c with the plant and the Blocks, and the call of it with arrays."""

import ctypes
from collections.abc import Mapping, Sequence
from importlib import resources
from typing import Any

import numpy as np
from numpy.typing import NDArray

from synth.emit import lanes as lane_code
from synth.emit.lanes import Rows
from synth.execute import compile as host_compiler
from synth.signals import signal_names
from synth.simulate.lanes import lane_blocks
from synth.simulate.lanes.interpolants import OUTSIDE, FastPlant
from synth.simulate.lanes.lane_blocks import LaneBlock

FLAGS = ("-O2", "-march=native", "-fno-math-errno", "-fno-trapping-math", "-std=c11", "-Wno-psabi")
HEADER = """#define LANES {lanes}
#define N_X {x}
#define N_U {u}
#define N_Y {y}
#define N_IN {inputs}
#define N_OUT {outputs}
#define N_BLOCKS {blocks}
#define N_POSITIONS {pairs}
#define POSITIONS {positions}
#define VELOCITIES {velocities}
{functions}
typedef {scalar} scalar;
typedef {counter} counter;
typedef {number} number;
typedef {word} word;
"""
_COUNTS = {"samples", "substeps", "delay", "order", "every", "stops", "sensors", "commands", "forcing_stride"} | {
    *("weights", "commons", "separates", "wides", "narrows"),
}
_MEMBERS = (
    *("samples", "substeps", "delay", "order", "every", "period", "p", "x", "left", "locked"),
    *("stops", "stop_position", "stop_velocity", "stop_low", "stop_high", "impact"),
    *("sensors", "sensor_source", "sensor_input", "sensor_gain", "sensor_bias", "sensor_resolution"),
    *("sensor_low", "sensor_high", "noise", "overridden"),
    *("commands", "command_output", "weights", "weight_input", "weight_command", "weight"),
    *("forcing", "forcing_stride", "waiting"),
    *("reals", "counters", "constants", "in", "out"),
    *("commons", "separates", "common_row", "separate_row", "common", "separate"),
    *("wides", "narrows", "wide_row", "narrow_row", "wide", "narrow", "faults"),
)
_C_TYPES = {np.float32: ("float", "uint32_t"), np.float64: ("double", "uint64_t")}


class _Loop(ctypes.Structure):
    """`loop_t` of lanes.c, with the same members in the same order."""

    _fields_ = [
        (m, ctypes.c_int64 if m in _COUNTS else ctypes.c_double if m == "period" else ctypes.c_void_p) for m in _MEMBERS
    ]


# Read with this module: the members of `loop_t` are those that it knows, whatever is edited during a run.
_LOOP_C = resources.files(__package__).joinpath("lanes.c").read_text(encoding="utf-8")


def compile_loop(fast: FastPlant, parts: Sequence[LaneBlock], lanes: int) -> ctypes.CDLL:
    """Return the compiled loop of a plant and the Blocks of its controller and drive."""
    sources = {"lanes.c": _LOOP_C, "lanes.h": _header(fast, parts, lanes)}
    return ctypes.CDLL(str(host_compiler.shared_library(sources, FLAGS)))


def call(library: ctypes.CDLL, counts: Mapping[str, int], arrays: Mapping[str, NDArray[Any]], period_s: float) -> None:
    """Run the loop; the arrays are members of `loop_t` by name."""
    addresses = {name: array.ctypes.data for name, array in arrays.items()}
    loop = _Loop(**counts, **addresses, period=period_s)
    ctypes.CFUNCTYPE(None, ctypes.c_void_p)(("synth_lanes", library))(ctypes.byref(loop))


def _header(fast: FastPlant, parts: Sequence[LaneBlock], lanes: int) -> str:
    plant, scalar = fast.plant, parts[0].controller.scalar
    states, inputs, outputs = (signal_names(s) for s in (plant.states, plant.inputs, plant.outputs))
    functions = [
        lane_code.SUPPORT,
        lane_code.mathematics([(fast.f, np.float64), (fast.h, np.float64), *((p.program, scalar) for p in parts)]),
        lane_code.function("plant_f", fast.f, Rows(inputs, states, (), fast.parameters, (*states, OUTSIDE)), lanes),
        lane_code.function("plant_h", fast.h, Rows(inputs, states, (), fast.parameters, outputs), lanes),
        lane_blocks.code(parts, scalar),
    ]
    reals, counters, _ = lane_code.TYPES[scalar]
    pairs = fast.second_order
    return HEADER.format(
        pairs=len(pairs),
        positions=", ".join(str(states.index(q)) for q in pairs) or "0",
        velocities=", ".join(str(states.index(v)) for v in pairs.values()) or "0",
        lanes=lanes,
        x=len(states),
        u=len(inputs),
        y=len(outputs),
        inputs=len(parts[0].rows.inputs),
        outputs=sum(len(p.rows.outputs) for p in parts),
        blocks=len(parts),
        functions="\n".join(functions),
        scalar=reals,
        counter=counters,
        number=_C_TYPES[scalar][0],
        word=_C_TYPES[scalar][1],
    )
