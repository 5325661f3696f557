"""Closed-loop simulation of a continuous-time plant under compiled, sampled-time control; the whole loop runs in C.

    dx/dt = f(x, u(t), p) + d(x, t)                   by `substeps` steps of RK4 in each period
    m_k = sensor(h(x(kT), u_{k-1}, p) + noise_k)      or the sample of the override
    c_k = step(state, m_k, references_k)              then the steps of the drive, see `drive`
    u(t) = M c_{k-delay} + forcing(t)                 for kT <= t < (k+1)T, with c_j = hold for j < 0

`faulty` states what faults of sensors, actuators and calls change in these equations.

A run may go on from the first samples of another one, whose scenario differs only in later samples: a `Prefix`.

Forcing is held over each substep at its value in the middle of the substep. A hard stop is inelastic: after each
substep the position is limited to the stop, and the velocity into the stop is set to 0. A locked coordinate keeps its
position and velocity.

Code generation for the plant: its functions by CasADi's code generator, compiled with closed_loop.c.
"""

import ctypes
import os
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from importlib import resources
from itertools import chain
from typing import Any

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from synth.base import store
from synth.emit.c import c_text
from synth.errors import WiringError
from synth.execute import compile as host_compiler
from synth.execute import host
from synth.plant import Plant
from synth.signals import Signal, signal_names
from synth.simulate import faulty, loop_arrays
from synth.simulate.drive import DriveBlock, DriveRecords, connect
from synth.simulate.loop_arrays import Arrays
from synth.simulate.scenario import Array, Scenario, Trajectory, sample_times

# Read with this module: the members of `loop_t` are those that `closed_loop` knows, whatever is edited during a run.
_LOOP_C = resources.files("synth.simulate").joinpath("closed_loop.c").read_text(encoding="utf-8")
HEADER = """#define N_X {x}
#define N_U {u}
#define N_Y {y}
#define SIZE_ARG {arg}
#define SIZE_RES {res}
#define SIZE_IW {iw}
#define SIZE_W {w}
#define HAS_DISTURBANCE {disturbed}
{prototypes}
"""


def compile_loop(plant: Plant, disturbance: ca.Function | None, flags: Sequence[str]) -> Callable[..., None]:
    """Compile closed_loop.c with the plant and return `synth_closed_loop`, which takes a pointer to a `loop_t`.

    The result is kept for further runs of the same functions, since a campaign runs one plant a thousand times.
    """
    return _compile(plant.f, plant.h, disturbance, tuple(flags), _surroundings())


def _surroundings() -> tuple[str, ...]:
    """Return what else decides which library is loaded: the compiler, the cache, and the name of a fresh run."""
    return os.environ.get("CC", ""), str(store.folder()), store.run_name()


@lru_cache(maxsize=16)
def _compile(
    f: ca.Function, h: ca.Function, disturbance: ca.Function | None, flags: tuple[str, ...], _: tuple[str, ...]
) -> Callable[..., None]:
    functions = [_with_dense_results(f, "synth_plant_f"), _with_dense_results(h, "synth_plant_h")]
    if disturbance is not None:
        n = f.size1_in(0)
        shapes = [*map(disturbance.size_in, range(disturbance.n_in())), disturbance.size_out(0)]
        if shapes != [(n, 1), (1, 1), (n, 1)]:
            raise WiringError(f"disturbance has arguments and result of {shapes}: need (x, t) of {(n, 1)}, (1, 1)")
        functions.append(_with_dense_results(disturbance, "synth_plant_disturbance"))
    sources = {"closed_loop.c": _LOOP_C, "plant.h": _header(functions), **c_text.functions(functions, "plant")}
    library = ctypes.CDLL(str(host_compiler.shared_library(sources, flags)))
    return ctypes.CFUNCTYPE(None, ctypes.c_void_p)(("synth_closed_loop", library))


def _with_dense_results(f: ca.Function, name: str) -> ca.Function:
    """Return the function under another name with dense results: structural zeros are stored too."""
    arguments = f.sx_in()
    return ca.Function(name, arguments, ca.cse([ca.densify(result) for result in f.call(arguments)]))


def _header(functions: Sequence[ca.Function]) -> str:
    signature = "(const double **arg, double **res, long long *iw, double *w, int mem);"
    return HEADER.format(
        x=functions[0].size1_in(0),
        u=functions[0].size1_in(1),
        y=functions[1].size1_out(0),
        arg=max(3, *(f.sz_arg() for f in functions)),
        res=max(f.sz_res() for f in functions),
        iw=max(1, *(f.sz_iw() for f in functions)),
        w=max(1, *(f.sz_w() for f in functions)),
        disturbed=int(len(functions) == 3),
        prototypes="\n".join(f"int {f.name()}{signature}" for f in functions),
    )


__all__ = ["Prefix", "Scenario", "Trajectory", "begin", "sample_times", "simulate"]

_COUNTS = (
    *("first", "samples", "substeps", "delay", "stops", "sensors", "commands", "single", "in_size", "out_size"),
    *("drive_blocks", "last_out_size"),
)
_MEMBERS = (
    *("first", "samples", "substeps", "delay", "period", "p", "x", "input", "locked"),
    *("stops", "stop_position", "stop_velocity", "stop_low", "stop_high", "impact"),
    *("sensors", "sensor_source", "sensor_offset", "sensor_gain", "sensor_bias", "sensor_resolution"),
    *("sensor_low", "sensor_high", "sensor_span", "noise", "overridden", "sensor_lag", "readings"),
    *("word_low", "word_step", "flipped", "set_bits", "cleared"),
    *("commands", "command_offset", "mixing", "forcing", "waiting", "input_gain", "input_bias", "missed"),
    *("single", "step", "state", "in_size", "out_size", "in", "out", "faults"),
    *("drive_blocks", "drive", "last_out", "last_out_size", "states", "outputs", "applied"),
)


class _LoopStruct(ctypes.Structure):
    """`loop_t` of closed_loop.c, with the same members in the same order."""

    _fields_ = [
        (m, ctypes.c_int64 if m in _COUNTS else ctypes.c_double if m == "period" else ctypes.c_void_p) for m in _MEMBERS
    ]


@dataclass(frozen=True, eq=False)
class Prefix:
    """The first samples of a run: rows of its arrays, and what the next sample starts from, of each Block as well."""

    samples: int
    rows: Arrays
    present: Arrays
    drive: Sequence[Arrays]


def simulate(
    plant: Plant,
    controller: host.Controller,
    scenario: Scenario,
    disturbance: ca.Function | None = None,
    flags: Sequence[str] = (),
    drive: Sequence[host.Controller] = (),
    prefix: Prefix | None = None,
) -> Trajectory:
    """Run the scenario; `disturbance(x, t)` (n,) is added to dx/dt, in state units per s.

    With a `drive` the commands are the outputs of its last Block. With a `prefix` of the same plant and Blocks, whose
    scenario has the same samples, only those after it are computed.

    The plant's parameters enter at run time: one compilation, with `flags`, serves every `plant.with_parameters(...)`.

    Raises SignalError for an invalid name or value, and WiringError for an invalid connection.
    """
    loop = _prepare(plant, controller, scenario, drive)
    if prefix is not None:
        _restore(loop, prefix)
    _run(loop, disturbance, flags, prefix.samples if prefix else 0, len(loop.time))
    return _trajectory(loop)


def begin(
    plant: Plant,
    controller: host.Controller,
    scenario: Scenario,
    samples: int,
    disturbance: ca.Function | None = None,
    *,
    drive: Sequence[host.Controller] = (),
) -> Prefix:
    """Run the first `samples` of the scenario; raise as `simulate`."""
    loop = _prepare(plant, controller, scenario, drive)
    _run(loop, disturbance, (), 0, samples)
    rows = {name: loop.arrays[name][:samples] for name in _ROWS}
    blocks = [{"in": b.inputs, "out": b.outputs, "faults": b.faults, "state": b.state} for b in loop.records]
    return Prefix(samples, rows, {name: loop.arrays[name] for name in _PRESENT}, blocks)


_ROWS = ("states", "outputs", "applied", "in", "out", "faults")  # one for each sample
_PRESENT = ("x", "input", "waiting", "state", "impact")


@dataclass(frozen=True, eq=False)
class _Loop:
    """A loop in C that is ready to run: its arrays, and the records of the Blocks of its drive."""

    plant: Plant
    controller: host.Controller
    scenario: Scenario
    time: Array
    arrays: Arrays
    records: Sequence[DriveRecords]


def _prepare(plant: Plant, controller: host.Controller, scenario: Scenario, drive: Sequence[host.Controller]) -> _Loop:
    """Return the loop before its first sample."""
    if controller.base is not None:
        raise WiringError(
            f"a variant of controller '{controller.manifest['design']}' has no C of its own and runs in lanes alone: "
            "compile its Block with build.compile_block"
        )
    time = sample_times(scenario.duration_s, controller.period_s)
    arrays = (
        loop_arrays.plant_arrays(plant, scenario)
        | loop_arrays.controller_arrays(controller, scenario, len(time))
        | loop_arrays.sensor_arrays(plant, controller, scenario, len(time))
        | loop_arrays.actuator_arrays(plant, drive[-1] if drive else controller, scenario, time)
        | faulty.arrays(plant, scenario, len(time))
    )
    every_sample = (len(time), *arrays["forcing"].shape[1:])
    arrays["forcing"] = np.ascontiguousarray(np.broadcast_to(arrays["forcing"], every_sample))
    arrays |= {name: np.zeros((len(time), len(group))) for name, group in _signals_to_record(plant).items()}
    arrays["input"] = np.zeros(len(plant.inputs))
    return _Loop(plant, controller, scenario, time, arrays, connect(controller, arrays["in"], arrays["out"], drive))


def _signals_to_record(plant: Plant) -> dict[str, Sequence[Signal]]:
    """Return the signals of the plant that a run records."""
    return {"states": plant.states, "outputs": plant.outputs, "applied": plant.inputs}


def _restore(loop: _Loop, prefix: Prefix) -> None:
    """Write the samples of a prefix into the arrays of a loop.

    What a lagging sensor shows of them is what the controller got: a reading in double rounds to the same value again.
    """
    for name, rows in prefix.rows.items():
        loop.arrays[name][: prefix.samples] = rows
    for name, value in prefix.present.items():
        loop.arrays[name][...] = value
    for block, values in zip(loop.records, prefix.drive, strict=True):
        for rows, name in ((block.inputs, "in"), (block.outputs, "out"), (block.faults, "faults")):
            rows[: prefix.samples] = values[name][: prefix.samples]
        block.state[...] = values["state"]
    if "readings" in loop.arrays:
        measured = [loop.arrays["in"][name][: prefix.samples] for name in loop.scenario.sensors]
        loop.arrays["readings"][: prefix.samples] = np.stack(measured, axis=1)


def _run(loop: _Loop, disturbance: ca.Function | None, flags: Sequence[str], first: int, samples: int) -> None:
    """Compute the samples from the first one up to a number of them."""
    controller, scenario, arrays, records = loop.controller, loop.scenario, loop.arrays, loop.records
    drive_blocks = (DriveBlock * len(records))(*(block.struct for block in records))
    last = records[-1].outputs if records else arrays["out"]
    counts = {
        "first": first,
        "samples": samples,
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
    addresses = {name: array.ctypes.data for name, array in arrays.items()}
    addresses |= {"drive": ctypes.addressof(drive_blocks), "last_out": last.ctypes.data}
    struct = _LoopStruct(**counts, **addresses, period=controller.period_s, step=controller.step_address)
    compile_loop(loop.plant, disturbance, flags)(ctypes.byref(struct))


def _trajectory(loop: _Loop) -> Trajectory:
    """Return what a loop has recorded."""
    plant, controller, arrays, records = loop.plant, loop.controller, loop.arrays, loop.records
    signals = _signals_to_record(plant)
    groups = {g: dict(zip(signal_names(s), arrays[g].T.copy(), strict=True)) for g, s in signals.items()}
    groups |= {"measured": host.columns(arrays["in"]), "commands": host.columns(arrays["out"])}
    groups["driven"] = {name: column for block in records for name, column in host.columns(block.outputs).items()}
    for column in chain(*(columns.values() for columns in groups.values())):
        column.flags.writeable = False
    impacts = dict(zip(loop.scenario.stops, arrays["impact"].tolist(), strict=True))
    blocks = controller, *(block.controller for block in records)
    drive_faults = {block.name: block.faults & ~block.controller.status_mask for block in records}
    units, mask = column_units(plant, blocks), controller.status_mask
    run = trajectory(units, mask, loop.time, groups, arrays["faults"], impacts, loop.scenario.state)
    return replace(run, drive_faults=drive_faults)


def trajectory(
    units: Mapping[str, str],
    status_mask: np.uint32,
    time: Array,
    groups: Mapping[str, Mapping[str, NDArray[Any]]],
    words: NDArray[np.uint32],
    impacts: dict[str, float],
    initial: Mapping[str, float],
) -> Trajectory:
    """Return a trajectory, whose columns are read-only; `words` are those of the controller, with bits of a status."""
    faults, status = words & ~status_mask, words & status_mask
    time.flags.writeable = faults.flags.writeable = status.flags.writeable = False
    return Trajectory(
        time=time, faults=faults, status=status, impacts=impacts, units=units, initial=initial, begun="", **groups
    )


def column_units(plant: Plant, blocks: Sequence[host.Controller]) -> dict[str, str]:
    """Return the units of the plant's and the Blocks' signals by name."""
    structs = [block.manifest["structs"][role] for block in blocks for role in ("input", "output")]
    members = {field["name"]: field["unit"] for struct in structs for field in struct["fields"]}
    return members | {s.name: s.unit for s in (*plant.inputs, *plant.outputs, *plant.states)}
