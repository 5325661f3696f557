"""Arrays of the closed loop in C: those of plant, controller, sensors and actuators, from a scenario.

They are the members of `loop_t` in closed_loop.c; `faulty` has those of faults.
"""

from collections.abc import Iterable
from itertools import chain
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from synth.errors import SignalError, WiringError
from synth.execute import host
from synth.plant import Plant
from synth.signals import Signal, dimension
from synth.simulate import conditions
from synth.simulate.scenario import Analogue, Array, Encoder, Scenario

Arrays = dict[str, NDArray[Any]]


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
    return {"state": controller.init(scenario.state), "in": inputs, "out": outputs, "faults": faults}


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
    chains = np.array([model.chain for model in models], dtype=np.float64).reshape(-1, 6).T.copy()
    gain, bias, resolution, low, high, span = chains
    return arrays | {
        "sensor_source": np.array([[*outputs].index(s) for s in sensors.values()], dtype=np.int64),
        "sensor_offset": np.array([_offset(controller.inputs, name) for name in sensors], dtype=np.int64),
        "sensor_gain": gain,
        "sensor_bias": bias,
        "sensor_resolution": resolution,
        "sensor_low": low,
        "sensor_high": high,
        "sensor_span": span,
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
        "forcing": conditions.columns(inputs, scenario, time),
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
        shape_and_values = (
            f"has the shape {samples.shape} and {np.count_nonzero(~np.isfinite(samples))} values that are not finite"
        )
        raise SignalError(f"noise of '{name}' {shape_and_values}: give {n} finite numbers, one a sample")
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
