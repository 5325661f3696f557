"""Closed loops side by side: many plants under copies of one controller, one loop in each lane of a vector unit.

The equations are those of `closed_loop`, with two changes: polynomials replace the plant's functions of one variable
(`interpolants`), and the controller runs as a program without branches, with the same bits. Products and sums are
rounded one by one, so a result depends neither on the width of the processor's vectors nor on the neighbouring lanes.
"""

import ctypes
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from importlib import resources
from typing import Any

import numpy as np
from numpy.typing import NDArray

from synth.emit import lanes as lane_code
from synth.emit import pipeline
from synth.emit.lanes import Rows
from synth.emit.lower import Program
from synth.errors import WiringError
from synth.execute import compile as host_compiler
from synth.execute import host
from synth.plant import Plant
from synth.signals import signal_names
from synth.simulate import closed_loop, interpolants, lane_memory
from synth.simulate.interpolants import OUTSIDE, FastPlant
from synth.simulate.scenario import Scenario, Trajectory, sample_times

Arrays = dict[str, NDArray[Any]]

LANES = 8
ACCURATE = 2.0  # times the error of the corners' polynomials: a plant beyond that has no result
FLAGS = ("-O3", "-march=native", "-fno-math-errno", "-fno-trapping-math", "-std=c11", "-Wno-psabi")
HEADER = """#define LANES {lanes}
#define N_X {x}
#define N_U {u}
#define N_Y {y}
#define N_IN {inputs}
#define N_OUT {outputs}
#define N_POSITIONS {pairs}
#define POSITIONS {positions}
#define VELOCITIES {velocities}
{functions}
typedef {scalar} scalar;
typedef {counter} counter;
"""
_COUNTS = {"samples", "substeps", "delay", "stops", "sensors", "commands", "forcing_stride"}
_MEMBERS = (
    *("samples", "substeps", "delay", "period", "p", "x", "left", "locked"),
    *("stops", "stop_position", "stop_velocity", "stop_low", "stop_high", "impact"),
    *("sensors", "sensor_source", "sensor_input", "sensor_gain", "sensor_bias", "sensor_resolution"),
    *("sensor_low", "sensor_high", "noise", "overridden"),
    *("commands", "command_output", "mixing", "forcing", "forcing_stride", "waiting"),
    *("reals", "counters", "in", "out", "faults", "states", "outputs", "applied"),
)
_SHARED = (
    *("locked", "stop_position", "stop_velocity", "stop_low", "stop_high", "sensor_source"),
    *("mixing", "forcing", "overridden"),
)
_OF_LANE = ("x", "impact", "sensor_gain", "sensor_bias", "sensor_resolution", "sensor_low", "sensor_high", "waiting")


class _Loop(ctypes.Structure):
    """`loop_t` of lanes.c, with the same members in the same order."""

    _fields_ = [
        (m, ctypes.c_int64 if m in _COUNTS else ctypes.c_double if m == "period" else ctypes.c_void_p) for m in _MEMBERS
    ]


@dataclass(frozen=True, eq=False)
class LaneLoop:
    """A plant and a controller compiled for lanes; `simulate` serves plants with other parameters."""

    fast: FastPlant
    controller: host.Controller
    lanes: int
    rows: Rows
    library: ctypes.CDLL

    def simulate(self, plants: Sequence[Plant], scenarios: Sequence[Scenario]) -> list[Trajectory | None]:
        """Return the trajectory of each plant in its scenario, None where it leaves the range of the polynomials.

        The scenarios may differ in their initial states, references, overridden values, noise and sensor errors.

        Raises SignalError and WiringError as `closed_loop.simulate`, and WiringError where the scenarios differ in
        anything else, or have a fault of a sensor, an actuator or a call that only `closed_loop` simulates.
        """
        results: list[Trajectory | None] = []
        for first in range(0, len(plants), self.lanes):
            batch = slice(first, first + self.lanes)
            results += self._batch(list(plants[batch]), list(scenarios[batch]))
        return results

    def _batch(self, plants: list[Plant], scenarios: list[Scenario]) -> list[Trajectory | None]:
        used, spare = len(plants), self.lanes - len(plants)
        plants, scenarios = plants + plants[:1] * spare, scenarios + scenarios[:1] * spare
        time = sample_times(scenarios[0].duration_s, self.controller.period_s)
        lanes = [self._lane(plant, s, time) for plant, s in zip(plants, scenarios, strict=True)]
        _require_alike(scenarios, lanes)
        coefficients = self.fast.coefficients(plants)
        arrays = self._arrays(scenarios[0], lanes, len(time)) | {"p": lane_memory.align(coefficients.values)}
        self._run(arrays, scenarios[0], len(time))
        kept = (coefficients.error <= ACCURATE * self.fast.error) & (arrays["left"][0] == 0)
        return [self._trajectory(plants[i], scenarios[i], time, arrays, i) if kept[i] else None for i in range(used)]

    def _lane(self, plant: Plant, scenario: Scenario, time: NDArray[np.float64]) -> Arrays:
        n = len(time)
        return (
            closed_loop.plant_arrays(plant, scenario)
            | closed_loop.controller_arrays(self.controller, scenario, n)
            | closed_loop.sensor_arrays(plant, self.controller, scenario, n)
            | closed_loop.actuator_arrays(plant, self.controller, scenario, time)
        )

    def _arrays(self, scenario: Scenario, lanes: Sequence[Arrays], n: int) -> Arrays:
        """Return the members of `loop_t` but for the plants' parameters, with the lanes along the last axis."""
        arrays = {name: lane_memory.align(lanes[0][name]) for name in _SHARED if name in lanes[0]}
        arrays |= {name: lane_memory.align(np.stack([lane[name] for lane in lanes], axis=-1)) for name in _OF_LANE}
        arrays |= {"locked": arrays["locked"].astype(np.int64), "left": lane_memory.zeros((1, self.lanes), np.int64)}
        if any("noise" in lane for lane in lanes):
            silent = np.zeros((n, len(scenario.sensors)))
            arrays["noise"] = lane_memory.align(np.stack([lane.get("noise", silent) for lane in lanes], axis=-1))
        plant = self.fast.plant
        signals = {"states": plant.states, "outputs": plant.outputs, "applied": plant.inputs}
        records = {name: lane_memory.zeros((n, len(group), self.lanes), np.float64) for name, group in signals.items()}
        return arrays | self._controller_arrays(scenario, lanes, n) | records

    def _controller_arrays(self, scenario: Scenario, lanes: Sequence[Arrays], n: int) -> Arrays:
        """Return the connections of the controllers, their states, and their inputs, outputs and faults."""
        rows, scalar = self.rows, self.controller.scalar
        width = np.uint32 if scalar is np.float32 else np.uint64
        commands = list(dict.fromkeys(c for row in _weights(scenario) for c in row))
        initial = lanes[0]["state"]
        inputs = lane_memory.zeros((n, len(rows.inputs), self.lanes), scalar)
        for i, lane in enumerate(lanes):
            for row, name in enumerate(rows.inputs):
                inputs[:, row, i] = lane["in"][name]
        return {
            "sensor_input": np.array([rows.inputs.index(name) for name in scenario.sensors], dtype=np.int64),
            "command_output": np.array([rows.outputs.index(name) for name in commands], dtype=np.int64),
            "reals": lane_memory.repeat([initial[name] for name in rows.reals], self.lanes, scalar),
            "counters": lane_memory.repeat([initial[name] for name in rows.counters], self.lanes, width),
            "in": inputs,
            "out": lane_memory.zeros((n, len(rows.outputs), self.lanes), scalar),
            "faults": lane_memory.zeros((n, self.lanes), width),
        }

    def _run(self, arrays: Arrays, scenario: Scenario, n: int) -> None:
        substeps, inputs = arrays["forcing"].shape[1:]
        counts = {
            "samples": n,
            "substeps": scenario.substeps,
            "delay": scenario.delay,
            "stops": len(scenario.stops),
            "sensors": len(scenario.sensors),
            "commands": len(arrays["command_output"]),
            "forcing_stride": substeps * inputs if len(arrays["forcing"]) > 1 else 0,
        }
        addresses = {name: array.ctypes.data for name, array in arrays.items()}
        loop = _Loop(**counts, **addresses, period=self.controller.period_s)
        ctypes.CFUNCTYPE(None, ctypes.c_void_p)(("synth_lanes", self.library))(ctypes.byref(loop))

    def _trajectory(
        self, plant: Plant, scenario: Scenario, time: NDArray[np.float64], arrays: Arrays, lane: int
    ) -> Trajectory:
        members = {"measured": "in", "commands": "out"} | {g: g for g in ("states", "outputs", "applied")}
        names: dict[str, Sequence[str]] = {
            "measured": self.rows.inputs,
            "commands": self.rows.outputs,
            "states": signal_names(plant.states),
            "outputs": signal_names(plant.outputs),
            "applied": signal_names(plant.inputs),
        }
        groups = {g: lane_memory.LaneColumns(names[g], arrays[member][:, :, lane]) for g, member in members.items()}
        impacts = dict(zip(scenario.stops, arrays["impact"][:, lane].tolist(), strict=True))
        faults = arrays["faults"][:, lane].astype(np.uint32)
        return closed_loop.trajectory(plant, (self.controller,), time, groups, faults, impacts)


@lru_cache(maxsize=8)
def compile_loop(
    plant: Plant, controller: host.Controller, error: float = interpolants.ERROR, lanes: int = LANES
) -> LaneLoop:
    """Return the loop of a plant and a controller for a number of lanes; `error` is that of the plant's polynomials.

    The number is a power of 2; 8 fill the vectors of AVX-512, and 1 is the fastest for a single machine.

    Raises EmitError for an operation without a form in C, WiringError for a controller whose Block is not known, and
    CompileError as `host.load`.
    """
    if controller.source is None:
        raise WiringError(
            f"controller '{controller.manifest['design']}' was loaded from C alone: lanes need its Block; "
            "make it with build.compile_block"
        )
    fast = interpolants.fast_plant(plant, error)
    block, libm, surrogate_error = controller.source
    reduced = pipeline.reduce(block.rounded(controller.scalar), controller.scalar, libm, surrogate_error)
    reals, counters = ([s.name for s in block.states if s.integer == whole] for whole in (False, True))
    rows = Rows(signal_names(block.inputs), reals, counters, (), signal_names(block.outputs))
    numbers = {c.name: c.value for c in reduced.block.constants}
    step = lane_code.step("controller_step", reduced.program, rows, numbers, controller.scalar)
    loop_c = resources.files("synth.simulate").joinpath("lanes.c").read_text(encoding="utf-8")
    sources = {"lanes.c": loop_c, "lanes.h": _header(fast, rows, step, reduced.program, controller.scalar, lanes)}
    return LaneLoop(fast, controller, lanes, rows, ctypes.CDLL(str(host_compiler.shared_library(sources, FLAGS))))


def _header(fast: FastPlant, rows: Rows, step: str, program: Program, scalar: type[np.floating], lanes: int) -> str:
    plant = fast.plant
    states, inputs, outputs = (signal_names(s) for s in (plant.states, plant.inputs, plant.outputs))
    functions = [
        lane_code.SUPPORT,
        lane_code.mathematics([(fast.f, np.float64), (fast.h, np.float64), (program, scalar)]),
        lane_code.function("plant_f", fast.f, Rows(inputs, states, (), fast.parameters, (*states, OUTSIDE))),
        lane_code.function("plant_h", fast.h, Rows(inputs, states, (), fast.parameters, outputs)),
        step,
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
        inputs=len(rows.inputs),
        outputs=len(rows.outputs),
        functions="\n".join(functions),
        scalar=reals,
        counter=counters,
    )


def _require_alike(scenarios: Sequence[Scenario], lanes: Sequence[Arrays]) -> None:
    """Raise WiringError for scenarios that one loop cannot run side by side."""
    first = scenarios[0]
    for scenario, lane in zip(scenarios, lanes, strict=True):
        faulty = [name for name in ("lags", "input_faults") if getattr(scenario, name)]
        if faulty or scenario.missed is not None:
            raise WiringError(f"lanes simulate no {faulty[0] if faulty else 'missed'}: use closed_loop.simulate")
        scalars = ("duration_s", "delay", "substeps", "sensors", "actuators", "stops", "locked")
        differing = [name for name in scalars if getattr(scenario, name) != getattr(first, name)]
        differing += [name for name in _SHARED if not _equal(lane.get(name), lanes[0].get(name))]
        if differing:
            raise WiringError(f"scenarios differ in {differing[0]}: lanes need it equal; simulate them in groups")


def _equal(first: NDArray[Any] | None, second: NDArray[Any] | None) -> bool:
    if first is None or second is None:
        return first is second
    return np.array_equal(first, second)


def _weights(scenario: Scenario) -> list[dict[str, float]]:
    return [{wire: 1.0} if isinstance(wire, str) else dict(wire) for wire in scenario.actuators.values()]
