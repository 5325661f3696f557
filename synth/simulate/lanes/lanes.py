"""Closed loops side by side: many plants under copies of one controller, one loop in each lane of a vector unit.

The equations are those of `closed_loop`, with two changes: polynomials replace the plant's functions of one variable
(`interpolants`), and the controller runs as a program without branches, with the same bits. Products and sums are
rounded one by one, so a result depends neither on the width of the processor's vectors nor on the neighbouring lanes.
"""

import ctypes
from collections import ChainMap
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache, partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from synth.errors import WiringError
from synth.execute import host
from synth.plant import Plant
from synth.simulate import closed_loop, loop_arrays
from synth.simulate.lanes import interpolants, lane_blocks
from synth.simulate.lanes.interpolants import Coefficients, FastPlant
from synth.simulate.lanes.lane_blocks import LaneBlock, Name, Record, Recording, output_row
from synth.simulate.scenario import Encoder, Scenario, Trajectory, sample_times

Arrays = dict[str, NDArray[Any]]

LANES = 8
ORDERS = (3, 4, 5)  # of Nystroem's methods, with 2, 3 and 4 stages
ALL = Recording()
ACCURATE = 2.0  # times the error of the corners' polynomials: a plant beyond that has no result
_SHARED = (
    *("locked", "stop_position", "stop_velocity", "stop_low", "stop_high", "sensor_source"),
    *("forcing", "overridden"),
)
_OF_PLANT, _OF_SENSORS = ("x0", "velocities", "stops", "locked"), ("sensors", "encoders", "noise", "overrides")
_OF_ACTUATORS = ("duration_s", "actuators", "hold", "forcing", "delay", "substeps")
_OF_LANE = (
    "x",
    "impact",
    "sensor_gain",
    "sensor_bias",
    "sensor_resolution",
    "sensor_low",
    "sensor_high",
    "sensor_span",
    "waiting",
)


@dataclass(frozen=True, eq=False)
class LaneLoop:
    """A plant and a controller compiled for lanes; `simulate` serves plants with other parameters."""

    fast: FastPlant
    blocks: tuple[LaneBlock, ...]
    lanes: int
    library: ctypes.CDLL

    @property
    def controller(self) -> host.Controller:
        """The first Block."""
        return self.blocks[0].controller

    def simulate(
        self,
        plants: Sequence[Plant],
        scenarios: Sequence[Scenario],
        order: int = ORDERS[-1],
        recording: Recording = ALL,
    ) -> list[Trajectory | None]:
        """Return the trajectory of each plant in its scenario, None where it leaves the range of the polynomials.

        The scenarios may differ in their initial states, references, overridden values, noise and sensor errors.
        `order` is that of Nystroem's method, one of ORDERS. `recording` chooses the columns and their rate; faults
        between two samples of the columns are in the later one.

        Raises SignalError and WiringError as `closed_loop.simulate`, and WiringError where the scenarios differ in
        anything else, or have a fault of a sensor, an actuator or a call that only `closed_loop` simulates.
        """
        results: list[Trajectory | None] = []
        for first in range(0, len(plants), self.lanes):
            batch = slice(first, first + self.lanes)
            results += self._batch(list(plants[batch]), list(scenarios[batch]), order, recording)
        return results

    def _batch(
        self, plants: list[Plant], scenarios: list[Scenario], order: int, recording: Recording
    ) -> list[Trajectory | None]:
        used, spare = len(plants), self.lanes - len(plants)
        plants, scenarios = plants + plants[:1] * spare, scenarios + scenarios[:1] * spare
        time = sample_times(scenarios[0].duration_s, self.controller.period_s)
        coefficients = _coefficients(self.fast, tuple(plants))
        kept = coefficients.error <= ACCURATE * self.fast.error
        run = partial(self._run, plants, scenarios, order, coefficients.values)
        arrays, record = run(recording)
        kept &= arrays["left"][0] == 0
        frames = time[:: recording.every]
        frames.flags.writeable = False
        return [
            self._trajectory(scenarios[i], frames, arrays, record, recording, i) if kept[i] else None
            for i in range(used)
        ]

    def _run(
        self,
        plants: Sequence[Plant],
        scenarios: Sequence[Scenario],
        order: int,
        p: NDArray[np.float64],
        recording: Recording,
    ) -> tuple[Arrays, Record]:
        """Return the arrays of a run, and its record."""
        time = sample_times(scenarios[0].duration_s, self.controller.period_s)
        arrays = self._arrays(plants, scenarios, time) | {"p": lane_blocks.align(p)}
        wide, narrow = (recording.choose(names) for names in self._signals)
        frames, scalar = len(time[:: recording.every]), self.controller.scalar
        width = np.uint32 if scalar is np.float32 else np.uint64
        arrays |= {
            "wide_row": np.array(wide, dtype=np.int64),
            "narrow_row": np.array(narrow, dtype=np.int64),
            "wide": lane_blocks.empty((len(wide), self.lanes, frames), np.float64),
            "narrow": lane_blocks.empty((len(narrow), self.lanes, frames), scalar),
            "faults": lane_blocks.empty((len(self.blocks), self.lanes, frames), width),
        }
        self._call(arrays, scenarios[0], len(time), order, recording.every)
        columns = {self._signals[0][k]: arrays["wide"][i] for i, k in enumerate(wide)}
        columns |= {self._signals[1][k]: arrays["narrow"][i] for i, k in enumerate(narrow)}
        again = partial(self._run, plants, scenarios, order, p, Recording(None, recording.every))
        return arrays, Record(columns, lambda: again()[1])

    @cached_property
    def _signals(self) -> tuple[list[Name], list[Name]]:
        """The columns that C calls wide and narrow, in the order of its rows."""
        plant, (first, *drive) = self.fast.plant, self.blocks
        wide = {"states": plant.states, "outputs": plant.outputs, "applied": plant.inputs}
        narrow = [("measured", n) for n in first.rows.inputs] + [("commands", n) for n in first.rows.outputs]
        narrow += [("driven", n) for block in drive for n in block.rows.outputs]
        return [(group, s.name) for group, signals in wide.items() for s in signals], narrow

    def _arrays(self, plants: Sequence[Plant], scenarios: Sequence[Scenario], time: NDArray[np.float64]) -> Arrays:
        """Return the members of `loop_t` but for the plants' parameters, with the lanes along the last axis."""
        by_scenario: dict[int, tuple[Arrays, ...]] = {}
        for scenario in scenarios:
            if id(scenario) not in by_scenario:
                like = (scenarios[0], by_scenario[id(scenarios[0])]) if by_scenario else None
                by_scenario[id(scenario)] = self._lane(plants[0], scenario, time, like)
        lanes = [ChainMap(*by_scenario[id(s)]) for s in scenarios]
        _require_alike(scenarios, lanes)
        arrays = {name: lane_blocks.align(lanes[0][name]) for name in _SHARED if name in lanes[0]}
        arrays |= {name: lane_blocks.align(np.stack([lane[name] for lane in lanes], axis=-1)) for name in _OF_LANE}
        arrays |= {"locked": arrays["locked"].astype(np.int64), "left": lane_blocks.zeros((1, self.lanes), np.int64)}
        if any("noise" in lane for lane in lanes):
            silent = np.zeros((len(time), len(scenarios[0].sensors)))
            arrays["noise"] = lane_blocks.align(np.stack([lane.get("noise", silent) for lane in lanes], axis=-1))
        inputs = lane_blocks.arrays(self.controller, scenarios, len(time))
        return arrays | inputs | self._controller_arrays(scenarios[0], lanes[0]["mixing"])

    def _lane(
        self,
        plant: Plant,
        scenario: Scenario,
        time: NDArray[np.float64],
        like: tuple[Scenario, tuple[Arrays, ...]] | None,
    ) -> tuple[Arrays, ...]:
        """Return three groups of arrays of a scenario; a group of a scenario `like` it serves again where it can."""
        makers: dict[tuple[str, ...], Callable[[], Arrays]] = {
            _OF_PLANT: lambda: loop_arrays.plant_arrays(plant, scenario),
            _OF_SENSORS: lambda: loop_arrays.sensor_arrays(plant, self.controller, scenario, len(time)),
            _OF_ACTUATORS: lambda: loop_arrays.actuator_arrays(plant, self.blocks[-1].controller, scenario, time),
        }
        if like is None:
            return tuple(make() for make in makers.values())
        return tuple(
            group if all(_is_same(getattr(like[0], f), getattr(scenario, f)) for f in fields) else make()
            for group, (fields, make) in zip(like[1], makers.items(), strict=True)
        )

    def _controller_arrays(self, scenario: Scenario, mixing: NDArray[np.float64]) -> Arrays:
        """Return the connections of the Blocks, their states, and their outputs."""
        scalar = self.controller.scalar
        width = np.uint32 if scalar is np.float32 else np.uint64
        rows, last = self.blocks[0].rows.inputs, len(self.blocks) - 1
        commands = list(dict.fromkeys(c for row in _weights(scenario) for c in row))
        starts = [b.initial(scenario.state if k == 0 else {}) for k, b in enumerate(self.blocks)]
        reals, counters = ([v for start in starts for v in start[k]] for k in (0, 1))
        outputs = sum(len(b.rows.outputs) for b in self.blocks)
        inputs, sources = np.nonzero(mixing)
        return {
            "sensor_input": np.array([rows.index(name) for name in scenario.sensors], dtype=np.int64),
            "command_output": np.array([output_row(self.blocks, last, name) for name in commands], dtype=np.int64),
            "weight_input": inputs.astype(np.int64),
            "weight_command": sources.astype(np.int64),
            "weight": mixing[inputs, sources],
            "constants": np.array([c for b in self.blocks for c in b.numbers.values()] or [0.0], scalar),
            "reals": lane_blocks.repeat(reals, self.lanes, scalar),
            "counters": lane_blocks.repeat(counters, self.lanes, width),
            "out": lane_blocks.zeros((outputs, self.lanes), scalar),
        }

    def _call(self, arrays: Arrays, scenario: Scenario, n: int, order: int, every: int) -> None:
        substeps, inputs = arrays["forcing"].shape[1:]
        counts = {
            "samples": n,
            "substeps": scenario.substeps,
            "delay": scenario.delay,
            "order": order,
            "every": every,
            "stops": len(scenario.stops),
            "sensors": len(scenario.sensors),
            "commands": len(arrays["command_output"]),
            "forcing_stride": substeps * inputs if len(arrays["forcing"]) > 1 else 0,
            "weights": len(arrays["weight"]),
            "commons": len(arrays["common_row"]),
            "separates": len(arrays["separate_row"]),
            "wides": len(arrays["wide_row"]),
            "narrows": len(arrays["narrow_row"]),
        }
        lane_blocks.call(self.library, counts, arrays, self.controller.period_s)

    def _trajectory(
        self,
        scenario: Scenario,
        time: NDArray[np.float64],
        arrays: Arrays,
        record: Record,
        recording: Recording,
        lane: int,
    ) -> Trajectory:
        names: dict[str, list[str]] = {"driven": []}
        for group, name in (*self._signals[0], *self._signals[1]):
            names.setdefault(group, []).append(name)
        groups = {group: record.lane(group, each, lane, recording.read) for group, each in names.items()}
        impacts = dict(zip(scenario.stops, arrays["impact"][:, lane].tolist(), strict=True))
        words = {b.name: arrays["faults"][k, lane].astype(np.uint32) for k, b in enumerate(self.blocks)}
        faults = words.pop(self.blocks[0].name)
        mask = self.blocks[0].controller.status_mask
        trajectory = closed_loop.trajectory(self._units, mask, time, groups, faults, impacts, scenario.state)
        masks = {b.name: ~b.controller.status_mask for b in self.blocks}
        return replace(trajectory, drive_faults={name: word & masks[name] for name, word in words.items()})

    @cached_property
    def _units(self) -> dict[str, str]:
        return closed_loop.column_units(self.fast.plant, [b.controller for b in self.blocks])


@lru_cache(maxsize=4)
def _coefficients(fast: FastPlant, plants: tuple[Plant, ...]) -> Coefficients:
    """Return the polynomials of the plants; the experiments of a study run on the same ones, one after another."""
    return fast.coefficients(plants)


@lru_cache(maxsize=64)  # a study of all experiments returns to each loop with every batch
def compile_loop(
    plant: Plant,
    controller: host.Controller,
    drive: tuple[host.Controller, ...] = (),
    *,
    error: float = interpolants.ERROR,
    lanes: int = LANES,
) -> LaneLoop:
    """Return the loop of a plant, a controller and its drive for a number of lanes.

    `error` is that of the plant's polynomials. The number of lanes is a power of 2: 8 fill the vectors of AVX-512, and
    1 is the fastest for a single machine.

    Raises EmitError for an operation without a form in C, WiringError for a controller whose Block is not known, and
    CompileError as `host.load`.
    """
    parts, fast = lane_blocks.blocks(controller, drive), interpolants.fast_plant(plant, error)
    return LaneLoop(fast, parts, lanes, lane_blocks.compile_loop(fast, parts, lanes))


def _require_alike(scenarios: Sequence[Scenario], lanes: Sequence[Mapping[str, NDArray[Any]]]) -> None:
    """Raise WiringError for scenarios that one loop cannot run side by side."""
    first = scenarios[0]
    for scenario, lane in zip(scenarios, lanes, strict=True):
        faulty = [name for name in ("lags", "input_faults") if getattr(scenario, name)]
        if faulty or scenario.missed is not None:
            raise WiringError(f"lanes simulate no {faulty[0] if faulty else 'missed'}: use closed_loop.simulate")
        scalars = ("duration_s", "delay", "substeps", "sensors", "actuators", "stops", "locked", "state")
        differing = [name for name in scalars if getattr(scenario, name) != getattr(first, name)]
        differing += [name for name in (*_SHARED, "mixing") if not _equal(lane.get(name), lanes[0].get(name))]
        if differing:
            raise WiringError(f"scenarios differ in {differing[0]}: lanes need it equal; simulate them in groups")


def _is_same(first: object, second: object) -> bool:
    """Tell whether two fields of scenarios are the same; False where that takes a comparison of arrays."""
    if first is second:
        return True
    if isinstance(first, Mapping) and isinstance(second, Mapping):
        return first.keys() == second.keys() and all(_is_same(first[k], second[k]) for k in first)
    return isinstance(first, str | float | int | tuple | Encoder) and type(first) is type(second) and first == second


def _equal(first: NDArray[Any] | None, second: NDArray[Any] | None) -> bool:
    if first is None or second is None or first is second:
        return first is second
    return np.array_equal(first, second)


def _weights(scenario: Scenario) -> list[dict[str, float]]:
    return [{wire: 1.0} if isinstance(wire, str) else dict(wire) for wire in scenario.actuators.values()]
