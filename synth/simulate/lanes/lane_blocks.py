"""The discrete Blocks of a loop in lanes: the controller and the Blocks of a drive behind it, one after another.

The outputs and states of all Blocks lie one after another, and each Block has one row of faults. An input of a Block of
the drive is the output with its name of the Block before it or of an earlier one, or else an input of the controller.

Memory of loops in lanes: what a run records, and the columns of each lane by name.

The compiled loop in lanes: lanes.c with the plant and the Blocks, and the call of it with arrays.

Controller inputs of loops in lanes: constants, courses that all lanes share, and courses of single lanes.

A sensor writes its input in every sample that is not overridden; the values of an override come as a course.
"""

import ctypes
import mmap
import threading
import weakref
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import lru_cache, partial
from importlib import resources
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from synth.base import contents
from synth.block import Block
from synth.emit import pipeline
from synth.emit.program.lower import Program
from synth.errors import WiringError
from synth.execute import compile as host_compiler
from synth.execute import host
from synth.signals import signal_names
from synth.simulate import drive as drives
from synth.simulate import loop_arrays
from synth.simulate.lanes import lane_code
from synth.simulate.lanes.interpolants import OUTSIDE, FastPlant
from synth.simulate.lanes.lane_code import Rows
from synth.simulate.scenario import Scenario

LARGE, ALIGNMENT = 2**21, 64  # bytes: of a large page, and of a vector
KEPT = 2**28  # bytes of memory that no array needs and the next loop may use
Name = tuple[str, str]  # the group of a column, as in `Trajectory`, and its name


@dataclass(frozen=True)
class Recording:
    """The columns that a run keeps, None for all, at every `every`-th sample.

    A column that is read and was not kept costs one more run of its loops, which keeps all. `read` collects what is
    read: the right choice for the next run of the same experiment.
    """

    columns: frozenset[Name] | None = None
    every: int = 1
    read: set[Name] = field(default_factory=set, compare=False)

    def choose(self, names: Sequence[Name]) -> list[int]:
        """Return the positions of the names that are kept."""
        return [k for k, name in enumerate(names) if self.columns is None or name in self.columns]


class Record:
    """What a run kept: the column (lanes, frames) of each name. `complete` runs the loops again and keeps all."""

    def __init__(self, columns: Mapping[Name, NDArray[Any]], complete: Callable[[], "Record"]) -> None:
        self._columns, self._complete, self._lock = dict(columns), complete, threading.Lock()

    def column(self, name: Name) -> NDArray[Any]:
        """Return the column (lanes, frames)."""
        with self._lock:
            if name not in self._columns:
                self._columns |= self._complete()._columns
        return self._columns[name]

    def lane(self, group: str, names: Iterable[str], lane: int, read: set[Name]) -> "LaneColumns":
        """Return the columns of a group in one lane; the set `read` collects the names that are read."""
        return LaneColumns(names, partial(self._of_lane, group, lane, read))

    def _of_lane(self, group: str, lane: int, read: set[Name], name: str) -> NDArray[Any]:
        read.add((group, name))
        column = self.column((group, name))[lane]
        column.flags.writeable = False
        return column


class LaneColumns(Mapping[str, NDArray[Any]]):
    """Columns (frames,) by name, each from a function of its name."""

    def __init__(self, names: Iterable[str], column: Callable[[str], NDArray[Any]]) -> None:
        self._names, self._column = dict.fromkeys(names), column

    def __getitem__(self, name: str) -> NDArray[Any]:
        if name not in self._names:
            raise KeyError(name)
        return self._column(name)

    def __contains__(self, name: object) -> bool:
        return name in self._names

    def __iter__(self) -> Iterator[str]:
        return iter(self._names)

    def __len__(self) -> int:
        return len(self._names)


class _Pages:
    """Memory in large pages that loops have used and no array needs any more: the next loop need not clear it again."""

    def __init__(self) -> None:
        self._free: list[mmap.mmap] = []
        self._lock = threading.Lock()

    def take(self, n: int) -> mmap.mmap:
        """Return at least n bytes with any content."""
        size = -(-n // LARGE) * LARGE
        with self._lock:
            for k, pages in enumerate(self._free):
                if len(pages) == size:
                    return self._free.pop(k)
        pages = mmap.mmap(-1, size, flags=mmap.MAP_PRIVATE | mmap.MAP_ANONYMOUS)
        pages.madvise(mmap.MADV_HUGEPAGE)
        return pages

    def give(self, pages: mmap.mmap) -> None:
        """Keep memory for the next loop, unless there is KEPT already."""
        with self._lock:
            if sum(map(len, self._free)) + len(pages) <= KEPT:
                self._free.append(pages)


_PAGES = _Pages()


def empty(shape: tuple[int, ...], scalar: type[np.generic]) -> NDArray[Any]:
    """Return an array with any content at an address that vectors need, in large pages: for what a run records."""
    items = int(np.prod(shape))
    n = max(1, items) * np.dtype(scalar).itemsize
    if n <= LARGE or not hasattr(mmap, "MADV_HUGEPAGE"):
        memory = np.empty(n + ALIGNMENT, np.uint8)
        first = -memory.ctypes.data % ALIGNMENT
        return memory[first : first + n].view(scalar)[:items].reshape(shape)
    pages = _PAGES.take(n)
    array = np.frombuffer(pages, scalar, items)  # every view of it keeps it alive
    weakref.finalize(array, _PAGES.give, pages).atexit = False
    return array.reshape(shape)


def zeros(shape: tuple[int, ...], scalar: type[np.generic]) -> NDArray[Any]:
    """Return zeros as `empty` places them."""
    array = empty(shape, scalar)
    array[...] = 0
    return array


def repeat(values: Sequence[Any], lanes: int, scalar: type[np.generic]) -> NDArray[Any]:
    """Return the values in every lane (values, lanes)."""
    return align(np.repeat(np.array(values, scalar).reshape(-1, 1), lanes, axis=1))


def align(values: NDArray[Any]) -> NDArray[Any]:
    """Return a copy at an address that vectors need."""
    copy = empty(values.shape, values.dtype.type)
    copy[...] = values
    return copy


Arrays = dict[str, NDArray[Any]]


def arrays(controller: host.Controller, scenarios: Sequence[Scenario], n: int) -> Arrays:
    """Return the members of `loop_t` for the inputs over n samples: constants (rows, lanes) and courses.

    Raises SignalError and WiringError as `closed_loop.simulate`.
    """
    rows, scalar = controller.inputs.names or (), controller.scalar
    distinct = {id(scenario): scenario for scenario in scenarios}
    for scenario in distinct.values():
        loop_arrays.require_sources(controller, scenario)
    courses = [_courses(controller, scenarios, name, n) for name in rows]
    constants = zeros((len(rows), len(scenarios)), scalar)
    varying: dict[bool, list[int]] = {True: [], False: []}
    for row, lanes in enumerate(courses):
        if all(len(course) == 1 for course in lanes):
            constants[row] = [course[0] for course in lanes]
        else:
            varying[all(_same_bits(course, lanes[0]) for course in lanes)].append(row)
    common, separate = ([[np.broadcast_to(c, n) for c in courses[row]] for row in varying[k]] for k in (True, False))
    return {
        "in": constants,
        "common_row": np.array(varying[True], dtype=np.int64),
        "separate_row": np.array(varying[False], dtype=np.int64),
        "common": align(np.array([lanes[0] for lanes in common], scalar).reshape(-1, n).T),
        "separate": align(np.array(separate, scalar).reshape(-1, len(scenarios), n).transpose(2, 0, 1)),
    }


def _courses(controller: host.Controller, scenarios: Sequence[Scenario], name: str, n: int) -> list[NDArray[Any]]:
    """Return the samples of an input in each scenario; those of one array, or of one scenario, are one object."""
    keys = [id(s) if name in s.overrides else _key(s.references.get(name)) for s in scenarios]
    by_key = {key: _course(controller, s, name, n) for key, s in dict(zip(keys, scenarios, strict=True)).items()}
    return [by_key[key] for key in keys]


def _key(values: object) -> tuple[type, object]:
    """Return a key that values of the same number and the same array share."""
    return type(values), repr(values) if isinstance(values, float | int) else id(values)


def _course(controller: host.Controller, scenario: Scenario, name: str, n: int) -> NDArray[Any]:
    """Return the samples of an input, (1,) where it is constant."""
    values: ArrayLike = scenario.references.get(name, 0.0)
    override = scenario.overrides.get(name)
    constant = override is None and not np.ndim(values)
    assert controller.inputs.fields is not None
    samples = np.zeros(1 if constant else n, [(name, controller.inputs.fields[name][0])])
    host.fill(samples, name, values)
    if override is not None:
        host.fill(samples, name, override.values, loop_arrays.mask(name, override.mask, n))
    return np.ascontiguousarray(samples[name])


def _same_bits(first: NDArray[Any], second: NDArray[Any]) -> bool:
    return first is second or (first.shape == second.shape and first.tobytes() == second.tobytes())


RUN = """static void run_blocks(
    const {v} *in, const {number} *constants, {v} *out, {v} *x, {u} *counters, {u} *faults) {{
{calls}
}}
"""


@dataclass(frozen=True, eq=False)
class LaneBlock:
    """A Block of the loop: its compiled C, the rows of its arrays, its reduced program and its constants."""

    controller: host.Controller
    rows: Rows
    program: Program
    numbers: dict[str, float]

    @property
    def name(self) -> str:
        """The Block's name."""
        return str(self.controller.manifest["design"])

    def initial(self, changed: Mapping[str, float]) -> tuple[list[float], list[float]]:
        """Return the real states and the counters after `init`, with those in `changed` replaced."""
        state = self.controller.init(changed)
        return [float(state[n]) for n in self.rows.reals], [float(state[n]) for n in self.rows.counters]


def blocks(controller: host.Controller, drive: Sequence[host.Controller]) -> tuple[LaneBlock, ...]:
    """Return the Blocks of a loop.

    Raises WiringError for a Block that is not known, and for a drive as `drive.connect`.
    """
    drives.connect(controller, np.zeros(1, controller.inputs), np.zeros(1, controller.outputs), drive)
    return tuple(_block(each) for each in (controller, *drive))


def _block(controller: host.Controller) -> LaneBlock:
    if controller.source is None:
        raise WiringError(
            f"controller '{controller.manifest['design']}' was loaded from C alone: lanes need its Block; "
            "make it with build.compile_block"
        )
    block = controller.source.block
    program, constants = _variant(controller) or _reduce(controller)
    reals, counters = ([s.name for s in block.states if s.integer == whole] for whole in (False, True))
    rows = Rows(signal_names(block.inputs), reals, counters, (), signal_names(block.outputs), tuple(constants))
    return LaneBlock(controller, rows, program, dict(constants))


@lru_cache(maxsize=8)
def _reduce(controller: host.Controller) -> tuple[Program, Mapping[str, float]]:
    """Return the reduced program of a controller whose Block is known, and its constants, rounded."""
    assert controller.source is not None
    block, libm, error = controller.source
    reduced = pipeline.reduce(block.rounded(controller.scalar), controller.scalar, libm, error)
    return reduced.program, {c.name: c.value for c in reduced.block.constants}


def _variant(controller: host.Controller) -> tuple[Program, Mapping[str, float]] | None:
    """Return the program of the base with the constants of a variant that differs in no more than these.

    What the passes prove of the base's constants alone, such as a limit that never acts, is taken over unproved.
    """
    if controller.base is None or controller.base.source is None or controller.source is None:
        return None
    block = controller.source.block.rounded(controller.scalar)
    if _without_values(block) != _without_values_of(controller.base):
        return None
    program, constants = _reduce(controller.base)
    values = {c.name: c.value for c in block.constants}
    with np.errstate(over="ignore"):
        products = {n: float(controller.scalar(values[a] * values[b])) for n, (a, b) in program.products.items()}
    return program, {name: (values | products)[name] for name in constants}


@lru_cache(maxsize=8)
def _without_values_of(base: host.Controller) -> str:
    assert base.source is not None
    return _without_values(base.source.block.rounded(base.scalar))


def _without_values(block: Block) -> str:
    """Return a digest of the step of a Block but for the values of its constants."""
    names = tuple(c.name for c in block.constants)
    return contents.digest(block.inputs, block.states, names, block.symbol, block.output, block.next, block.faults)


def code(parts: Sequence[LaneBlock], scalar: type[np.floating]) -> str:
    """Return the C of the steps, and of `run_blocks`, which runs all of them on one sample."""
    v, u, _ = lane_code.TYPES[scalar]
    steps = [lane_code.step(f"step_{k}", p.program, p.rows, scalar) for k, p in enumerate(parts)]
    calls = []
    for k, part in enumerate(parts):
        before = parts[:k]
        reals, counters, outputs, constants = (
            sum(len(getattr(p.rows, group)) for p in before) for group in ("reals", "counters", "outputs", "constants")
        )
        sources = ", ".join(_source(parts, k, name) for name in part.rows.inputs)
        inputs = "in" if k == 0 else f"(const {v}[]){{{sources}}}"
        arrays = f"x + {reals}, counters + {counters}, {inputs}, constants + {constants}, out + {outputs}, faults + {k}"
        calls.append(f"    step_{k}({arrays});")
    return "\n".join([*steps, RUN.format(v=v, u=u, number=lane_code.NUMBERS[scalar], calls="\n".join(calls))])


def _source(parts: Sequence[LaneBlock], k: int, name: str) -> str:
    """Return what gives an input of Block k: the latest earlier output, or an input of the controller."""
    for j in range(k - 1, -1, -1):
        if name in parts[j].rows.outputs:
            return f"out[{output_row(parts, j, name)}]"
    return f"in[{parts[0].rows.inputs.index(name)}]"


def output_row(parts: Sequence[LaneBlock], k: int, name: str) -> int:
    """Return the row of an output of Block k among those of all Blocks."""
    return sum(len(p.rows.outputs) for p in parts[:k]) + list(parts[k].rows.outputs).index(name)


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
    *("sensor_low", "sensor_high", "sensor_span", "noise", "overridden"),
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
        code(parts, scalar),
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
