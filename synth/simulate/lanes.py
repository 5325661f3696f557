"""Closed loops side by side: many plants under copies of one controller, one loop in each lane of a vector unit.

The equations are those of `closed_loop`, with two changes: polynomials replace the plant's functions of one variable
(`interpolants`), and the controller runs as a program without branches, with the same bits. A lane that leaves the
range of the polynomials has no result.
"""

import ctypes
from dataclasses import dataclass
from importlib import resources
from typing import Any

import numpy as np

from synth.block import Block
from synth.emit import lanes as lane_code
from synth.emit import pipeline
from synth.emit.lower import Program
from synth.execute import compile as host_compiler
from synth.signals import signal_names
from synth.simulate.interpolants import OUTSIDE, FastPlant

LANES = 8
FLAGS = ("-O3", "-march=native", "-fno-math-errno", "-fno-trapping-math", "-std=c11")
HEADER = """#define LANES {lanes}
#define N_X {x}
#define N_U {u}
#define N_Y {y}
#define N_P {p}
#define N_IN {inputs}
#define N_OUT {outputs}
{functions}
typedef {scalar} scalar;
typedef {counter} counter;
"""


@dataclass(frozen=True, eq=False)
class LaneController:
    """A controller as a program without branches, and the Block that it comes from with rounded constants."""

    block: Block
    program: Program
    scalar: type[np.floating]

    @property
    def rows(self) -> lane_code.Rows:
        """The rows of its arrays."""
        states = self.block.states
        reals, counters = ([s.name for s in states if s.integer == whole] for whole in (False, True))
        return lane_code.Rows(signal_names(self.block.inputs), reals, counters, (), signal_names(self.block.outputs))

    @property
    def code(self) -> str:
        """The C of its step."""
        numbers = {c.name: c.value for c in self.block.constants}
        return lane_code.step("controller_step", self.program, self.rows, numbers, self.scalar)


def controller(block: Block, scalar: type[np.floating], error: float | None = None) -> LaneController:
    """Return a controller for lanes; the arguments are those of `write.emit`, whose C has the same bits.

    Raises EmitError as `write.emit`.
    """
    reduced = pipeline.reduce(block.rounded(scalar), scalar, error=error)
    return LaneController(reduced.block, reduced.program, scalar)


def compile_loop(fast: FastPlant, controller: LaneController, plant: Any) -> ctypes.CDLL:
    """Compile lanes.c with a plant and a controller."""
    states, inputs, outputs = (signal_names(s) for s in (plant.states, plant.inputs, plant.outputs))
    rows = {"inputs": inputs, "reals": states, "parameters": fast.parameters}
    functions = [
        lane_code.SUPPORT,
        lane_code.mathematics({np.float64: [fast.f, fast.h], controller.scalar: [controller.program]}),
        lane_code.map("plant_f", fast.f, lane_code.Rows(**rows, outputs=[*states, OUTSIDE])),
        lane_code.map("plant_h", fast.h, lane_code.Rows(**rows, outputs=outputs)),
        controller.code,
    ]
    header = HEADER.format(
        lanes=LANES,
        x=len(states),
        u=len(inputs),
        y=len(outputs),
        p=max(1, len(fast.parameters)),
        inputs=len(controller.rows.inputs),
        outputs=len(controller.rows.outputs),
        scalar=lane_code.TYPES[controller.scalar][0],
        counter=lane_code.TYPES[controller.scalar][1],
        functions="\n".join(functions),
    )
    loop_c = resources.files("synth.simulate").joinpath("lanes.c").read_text(encoding="utf-8")
    return ctypes.CDLL(str(host_compiler.shared_library({"lanes.c": loop_c, "lanes.h": header}, FLAGS)))


_COUNTS = {"samples", "substeps", "delay", "stride", "stops", "sensors", "commands", "forcing_stride"}
_COUNTS |= {"recorded_states", "recorded_outputs", "recorded_inputs"}
_MEMBERS = (
    *("samples", "substeps", "delay", "stride", "period", "p", "x", "left"),
    *("stops", "stop_position", "stop_velocity", "locked", "stop_low", "stop_high", "impact"),
    *("sensors", "sensor_source", "sensor_input", "gain", "bias", "resolution", "low", "high", "noise", "overridden"),
    *("commands", "command_output", "mixing", "forcing", "forcing_stride", "waiting"),
    *("reals", "counters", "in", "out", "faults"),
    *("recorded_states", "recorded_outputs", "recorded_inputs", "state_rows", "output_rows", "input_rows"),
    *("states", "outputs", "applied"),
)


class _Loop(ctypes.Structure):
    """`loop_t` of lanes.c, with the same members in the same order."""

    _fields_ = [
        (m, ctypes.c_int64 if m in _COUNTS else ctypes.c_double if m == "period" else ctypes.c_void_p) for m in _MEMBERS
    ]
