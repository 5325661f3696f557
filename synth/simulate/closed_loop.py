"""Closed-loop simulation of a continuous-time plant under compiled, sampled-time control; the whole loop runs in C.

    dx/dt = f(x, u(t), p) + d(x, t)                   by `substeps` steps of RK4 in each period
    m_k = sensor(h(x(kT), u_{k-1}, p) + noise_k)      or the sample of the override
    c_k = step(state, m_k, references_k)              then the steps of the drive, see `drive`
    u(t) = M c_{k-delay} + forcing(t)                 for kT <= t < (k+1)T, with c_j = hold for j < 0

`faulty` states what faults of sensors, actuators and calls change in these equations.

Forcing is held over each substep at its value in the middle of the substep. A hard stop is inelastic: after each
substep the position is limited to the stop, and the velocity into the stop is set to 0. A locked coordinate keeps its
position and velocity.
"""

import ctypes
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from itertools import chain
from typing import Any

import casadi as ca
import numpy as np
from numpy.typing import ArrayLike, NDArray

from synth.errors import SignalError, WiringError
from synth.execute import host
from synth.plant import Plant
from synth.signals import Signal, dimension, signal_names
from synth.simulate import faulty, forcing, plant_code
from synth.simulate.drive import DriveBlock, connect
from synth.simulate.scenario import Array, Scenario, Trajectory, sample_times
from synth.simulate.sensors import Analogue, Encoder

__all__ = ["Scenario", "Trajectory", "sample_times", "simulate"]

Arrays = dict[str, NDArray[Any]]

_COUNTS = (
    *("samples", "substeps", "delay", "stops", "sensors", "commands", "single", "in_size", "out_size"),
    *("drive_blocks", "last_out_size"),
)
_MEMBERS = (
    *("samples", "substeps", "delay", "period", "p", "x", "locked"),
    *("stops", "stop_position", "stop_velocity", "stop_low", "stop_high", "impact"),
    *("sensors", "sensor_source", "sensor_offset", "sensor_gain", "sensor_bias", "sensor_resolution"),
    *("sensor_low", "sensor_high", "noise", "overridden", "sensor_lag", "readings"),
    *("word_low", "word_step", "flipped", "set_bits", "cleared"),
    *("commands", "command_offset", "mixing", "forcing", "waiting", "input_gain", "input_bias", "missed"),
    *("single", "step", "state", "in_size", "out_size", "in", "out", "faults"),
    *("drive_blocks", "drive", "last_out", "last_out_size", "states", "outputs", "applied"),
)


class _Loop(ctypes.Structure):
    """`loop_t` of closed_loop.c, with the same members in the same order."""

    _fields_ = [
        (m, ctypes.c_int64 if m in _COUNTS else ctypes.c_double if m == "period" else ctypes.c_void_p) for m in _MEMBERS
    ]


def simulate(
    plant: Plant,
    controller: host.Controller,
    scenario: Scenario,
    disturbance: ca.Function | None = None,
    flags: Sequence[str] = (),
    drive: Sequence[host.Controller] = (),
) -> Trajectory:
    """Run the scenario from `controller.init()`; `disturbance(x, t)` (n,) is added to dx/dt, in state units per s.

    With a `drive` the commands are the outputs of its last Block.

    The plant's parameters enter at run time: one compilation, with `flags`, serves every `plant.with_parameters(...)`.

    Raises SignalError for an invalid name or value, and WiringError for an invalid connection.
    """
    if controller.base is not None:
        raise WiringError(
            f"a variant of controller '{controller.manifest['design']}' has no C of its own and runs in lanes alone: "
            "compile its Block with build.compile_block"
        )
    time = sample_times(scenario.duration_s, controller.period_s)
    arrays = (
        plant_arrays(plant, scenario)
        | controller_arrays(controller, scenario, len(time))
        | sensor_arrays(plant, controller, scenario, len(time))
        | actuator_arrays(plant, drive[-1] if drive else controller, scenario, time)
        | faulty.arrays(plant, scenario, len(time))
    )
    every_sample = (len(time), *arrays["forcing"].shape[1:])
    arrays["forcing"] = np.ascontiguousarray(np.broadcast_to(arrays["forcing"], every_sample))
    records = connect(controller, arrays["in"], arrays["out"], drive)
    drive_blocks = (DriveBlock * len(records))(*(block.struct for block in records))
    last = records[-1].outputs if records else arrays["out"]
    counts = {
        "samples": len(time),
        "substeps": scenario.substeps,
        "delay": scenario.delay,
        "stops": len(scenario.stops),
        "sensors": len(scenario.sensors),
        "commands": len(arrays["command_offset"]),
        "single": int(controller.scalar is np.float32),
        "in_size": controller.inputs.itemsize,
        "out_size": controller.outputs.itemsize,
        "drive_blocks": len(records),
        "last_out_size": last.itemsize,
    }
    signals = {"states": plant.states, "outputs": plant.outputs, "applied": plant.inputs}
    arrays |= {name: np.zeros((len(time), len(group))) for name, group in signals.items()}
    addresses = {name: array.ctypes.data for name, array in arrays.items()}
    addresses |= {"drive": ctypes.addressof(drive_blocks), "last_out": last.ctypes.data}
    loop = _Loop(**counts, **addresses, period=controller.period_s, step=controller.step_address)
    plant_code.compile_loop(plant, disturbance, flags)(ctypes.byref(loop))
    groups = {g: dict(zip(signal_names(s), arrays[g].T.copy(), strict=True)) for g, s in signals.items()}
    groups |= {"measured": host.columns(arrays["in"]), "commands": host.columns(arrays["out"])}
    groups["driven"] = {name: column for block in records for name, column in host.columns(block.outputs).items()}
    for column in chain(*(columns.values() for columns in groups.values())):
        column.flags.writeable = False
    impacts = dict(zip(scenario.stops, arrays["impact"].tolist(), strict=True))
    blocks = controller, *(block.controller for block in records)
    drive_faults = {block.name: block.faults & ~block.controller.status_mask for block in records}
    units, mask = column_units(plant, blocks), controller.status_mask
    return replace(trajectory(units, mask, time, groups, arrays["faults"], impacts), drive_faults=drive_faults)


def trajectory(
    units: Mapping[str, str],
    status_mask: np.uint32,
    time: Array,
    groups: Mapping[str, Mapping[str, NDArray[Any]]],
    words: NDArray[np.uint32],
    impacts: dict[str, float],
) -> Trajectory:
    """Return a trajectory, whose columns are read-only; `words` are those of the controller, with bits of a status."""
    faults, status = words & ~status_mask, words & status_mask
    time.flags.writeable = faults.flags.writeable = status.flags.writeable = False
    return Trajectory(time=time, faults=faults, status=status, impacts=impacts, units=units, **groups)


def column_units(plant: Plant, blocks: Sequence[host.Controller]) -> dict[str, str]:
    """Return the units of the plant's and the Blocks' signals by name."""
    structs = [block.manifest["structs"][role] for block in blocks for role in ("input", "output")]
    members = {field["name"]: field["unit"] for struct in structs for field in struct["fields"]}
    return members | {s.name: s.unit for s in (*plant.inputs, *plant.outputs, *plant.states)}


def plant_arrays(plant: Plant, scenario: Scenario) -> Arrays:
    """Return the members of `loop_t` for the plant and its stops."""
    states, start = [s.name for s in plant.states], _initial_states(plant, scenario)
    velocity = scenario.velocities
    _require_known("velocities", chain(velocity.keys(), velocity.values()), states)
    _require_known("stops", scenario.stops, velocity)
    _require_known("locked", scenario.locked, velocity)
    for q, (low, high) in scenario.stops.items():
        if not low <= start[q] <= high:
            raise SignalError(f"'{q}' starts at {start[q]}, not within its stops {low} .. {high}: start between them")
    locked = {*scenario.locked, *(velocity[q] for q in scenario.locked)}
    bounds = np.array(list(scenario.stops.values()), dtype=np.float64).reshape(-1, 2)
    return {
        "p": plant.values.astype(np.float64),
        "x": np.array([start[s] for s in states], dtype=np.float64),
        "locked": np.array([s in locked for s in states], dtype=np.uint8),
        "stop_position": np.array([states.index(q) for q in scenario.stops], dtype=np.int64),
        "stop_velocity": np.array([states.index(velocity[q]) for q in scenario.stops], dtype=np.int64),
        "stop_low": bounds[:, 0].copy(),
        "stop_high": bounds[:, 1].copy(),
        "impact": np.zeros(len(bounds)),
    }


def _initial_states(plant: Plant, scenario: Scenario) -> dict[str, float]:
    _require_known("initial plant states x0", scenario.x0, [s.name for s in plant.states])
    for s in plant.states:
        if s.name not in scenario.x0 and not s.low <= 0 <= s.high:
            raise SignalError(f"x0 leaves out '{s.name}', whose range {s.low} .. {s.high} {s.unit} excludes 0: give it")
    return {s.name: float(scenario.x0.get(s.name, 0.0)) for s in plant.states}


def controller_arrays(controller: host.Controller, scenario: Scenario, n: int) -> Arrays:
    """Return the state of the controller, and its inputs, outputs and faults over n samples."""
    require_sources(controller, scenario)
    inputs = np.zeros(n, controller.inputs)
    for name, values in scenario.references.items():
        host.fill(inputs, name, values)
    for name, override in scenario.overrides.items():
        host.fill(inputs, name, override.values, mask(name, override.mask, n))
    outputs, faults = np.zeros(n, controller.outputs), np.zeros(n, np.uint32)
    return {"state": controller.init(), "in": inputs, "out": outputs, "faults": faults}


def require_sources(controller: host.Controller, scenario: Scenario) -> None:
    """Raise SignalError for the name of an unknown input, and WiringError for an input without one source."""
    known, wired = controller.inputs.names or (), (*scenario.sensors, *scenario.references)
    _require_known("sensors and references", wired, known)
    _require_known("overrides", scenario.overrides, known)
    for name in known:
        if wired.count(name) != 1:
            raise WiringError(
                f"controller input '{name}' has {wired.count(name)} sources: name it in one of sensors and references"
            )


def sensor_arrays(plant: Plant, controller: host.Controller, scenario: Scenario, n: int) -> Arrays:
    """Return the members of `loop_t` for the sensors; noise and overridden samples (n, sensors) where there are any."""
    sensors, outputs = scenario.sensors, {s.name: s for s in plant.outputs}
    _require_known("sensors", sensors.values(), outputs)
    _require_known("encoders", scenario.encoders, sensors)
    _require_known("noise", scenario.noise, sensors)
    for name, source in sensors.items():
        _require_matching_signal(controller, "input", name, outputs[source])
    models = [scenario.encoders.get(name, Encoder()) for name in sensors]
    arrays: Arrays = {}
    if any(name in scenario.overrides for name in sensors):
        masks = [scenario.overrides[name].mask if name in scenario.overrides else np.zeros(n) for name in sensors]
        arrays["overridden"] = np.array(masks, dtype=np.uint8).T.copy()
    if any(isinstance(model, Analogue) for model in models) or scenario.noise:
        columns = [model.noise_of(n, i) for i, model in enumerate(models)]
        noises = [_noise(name, scenario.noise[name], n) if name in scenario.noise else 0.0 for name in sensors]
        arrays["noise"] = np.array(
            [c + more for c, more in zip(columns, noises, strict=True)], dtype=np.float64
        ).T.copy()
    chains = np.array([model.chain for model in models], dtype=np.float64).reshape(-1, 5).T.copy()
    gain, bias, resolution, low, high = chains
    return arrays | {
        "sensor_source": np.array([[*outputs].index(s) for s in sensors.values()], dtype=np.int64),
        "sensor_offset": np.array([_offset(controller.inputs, name) for name in sensors], dtype=np.int64),
        "sensor_gain": gain,
        "sensor_bias": bias,
        "sensor_resolution": resolution,
        "sensor_low": low,
        "sensor_high": high,
    }


def actuator_arrays(plant: Plant, controller: host.Controller, scenario: Scenario, time: Array) -> Arrays:
    """Return the members of `loop_t` for the actuators; constant forcing has one row for all samples."""
    inputs, known = {s.name: s for s in plant.inputs}, controller.outputs.names or ()
    rows = {name: {w: 1.0} if isinstance(w, str) else dict(w) for name, w in scenario.actuators.items()}
    commands = tuple(dict.fromkeys(chain(*rows.values())))
    _require_known("actuators and forcing", chain(rows, scenario.forcing), inputs)
    _require_known("actuators", commands, known)
    _require_known("hold", scenario.hold, known)
    for name, signal in inputs.items():
        if name not in rows and name not in scenario.forcing:
            raise WiringError(f"plant input '{name}' has no source: name it in actuators or in forcing")
        for command in rows.get(name, {}):
            _require_matching_signal(controller, "output", command, signal)
    hold = np.array([scenario.hold.get(c, 0.0) for c in commands], dtype=np.float64)
    return {
        "command_offset": np.array([_offset(controller.outputs, c) for c in commands], dtype=np.int64),
        "mixing": np.array([[rows.get(u, {}).get(c, 0.0) for c in commands] for u in inputs], dtype=np.float64),
        "forcing": forcing.columns(inputs, scenario, time),
        "waiting": np.tile(hold, (max(scenario.delay, 1), 1)),
    }


def _offset(struct: np.dtype[np.void], name: str) -> int:
    assert struct.fields is not None
    return int(struct.fields[name][1])


def mask(name: str, samples: NDArray[np.bool_], n: int) -> NDArray[np.bool_]:
    """Return the mask of an override; raise SignalError unless it has n booleans."""
    flags = np.asarray(samples)
    if flags.dtype != np.bool_ or flags.shape != (n,):
        raise SignalError(f"override mask of '{name}' is {flags.dtype} {flags.shape}: give {n} booleans, one a sample")
    return flags


def _noise(name: str, values: ArrayLike, n: int) -> Array:
    samples = np.asarray(values, dtype=np.float64)
    if samples.shape != (n,) or not np.isfinite(samples).all():
        raise SignalError(f"noise of '{name}' is {samples.shape}: give {n} finite numbers, one a sample")
    return samples


def _require_known(what: str, requested: Iterable[str], known: Iterable[str]) -> None:
    valid = tuple(known)
    for name in requested:
        if name not in valid:
            raise SignalError(f"{what}: '{name}' is not one of {', '.join(valid) or '(none)'}: correct the name")


def _require_matching_signal(controller: host.Controller, role: str, name: str, signal: Signal) -> None:
    """Raise WiringError for a connection of different units, or to a member that is not one real number."""
    field = next(f for f in controller.manifest["structs"][role]["fields"] if f["name"] == name)
    real = (field["ctype"], field["count"]) == ("float" if controller.scalar is np.float32 else "double", 1)
    if not real or dimension(field["unit"]) != dimension(signal.unit):
        raise WiringError(
            f"controller {role} '{name}' is {field['count']} {field['ctype']} in {field['unit']}, plant signal "
            f"'{signal.name}' one real number in {signal.unit}: wire like to like"
        )
