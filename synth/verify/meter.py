"""Cost measurement of a step on an emulated Cortex-M4F: every generator over the same steps, by the same toolchains.

Each step starts from its recorded state. All generators therefore see the same (x_k, u_k), and no rounding difference
accumulates.

Baselines for the cost of a step: the same step from several C code generators, prepared for an emulated core.

    synth             faults = step(state, in, out), the C that synth emits; it updates the state in place
    casadi            (x, u) -> (x', y) by CasADi's CodeGenerator with casadi_real=float, after ca.cse, unchanged
    casadi, float     the same C with a float shim: sin becomes sinf, .., every double literal becomes a float literal

With `casadi_real=float` CasADi declares floats, but its C still calls the double functions of libm and contains double
literals. The shim changes the C itself and therefore works with every compiler; -fsingle-precision-constant exists only
in gcc. Literals get the suffix f, and macros after `#include <math.h>` rename the functions. fmin and fmax become
comparisons, as CasADi prints them for compilers before C99, because a call of fminf would cost more.

CasADi's function has no fault word, and its results must not overlap its arguments. Its state memory therefore counts
twice, for x and x'.
"""

import importlib.util
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, NamedTuple

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from synth.block import Block
from synth.declare.companion import Companion
from synth.emit.c import expressions
from synth.emit.write import EmittedCode
from synth.errors import EmitError, SignalError
from synth.execute import cross, elf, host, image, trace
from synth.execute.image import Image
from synth.verify import cost, steps
from synth.verify.cost import LAW_ALONE, SYNTH, Cost, Coverage, Memory, SequenceCost, StepCost
from synth.verify.steps import Steps

CASADI, CASADI_FLOAT = "casadi", "casadi, float"
# Generators of an earlier comparison; they are not among the pinned packages, and no code here runs them.
UNSUPPORTED = ("symforce", "archimedes")
_LITERAL = re.compile(r"(?<![\w.])(\d+\.\d*(?:[eE][+-]?\d+)?|\d+[eE][+-]?\d+)(?![\w.])")
_WORK_SIZE = re.compile(r"if \(sz_w\) \*sz_w = (\d+);")  # number of floats of work memory
_FUNCTIONS = (
    *("sin", "cos", "tan", "asin", "acos", "atan", "atan2", "sinh", "cosh", "tanh", "asinh", "acosh", "atanh"),
    *("exp", "log", "expm1", "log1p", "pow", "sqrt", "hypot", "floor", "ceil", "fmod", "copysign", "erf"),
)
_SHIM = """#include <math.h>
static inline float synth_fmin(float x, float y) { return x < y ? x : y; }
static inline float synth_fmax(float x, float y) { return x > y ? x : y; }
#define fmin synth_fmin
#define fmax synth_fmax
#define fabs fabsf
"""
_SHIM += "".join(f"#define {name} {name}f\n" for name in _FUNCTIONS)


class CallLayout(NamedTuple):
    """The data of N calls in the memory of a core: the n arguments of each, (N, n), and a function that reads outputs.

    `outputs` returns a column (N,) for each output after the calls.
    """

    arguments: NDArray[np.int64]
    outputs: Callable[[], host.Columns]


@dataclass(frozen=True, eq=False)
class Candidate:
    """The C of one generator; `lay_out(image, steps)` prepares the arguments with which its function `entry` is called.

    A caller keeps `state_bytes` for the state and `signal_bytes` for inputs and outputs.
    """

    name: str
    files: Mapping[str, str]
    entry: str
    state_bytes: int
    signal_bytes: int
    lay_out: Callable[[Image, Steps], CallLayout]


def emitted_source(code: EmittedCode) -> Candidate:
    """Return the C that synth emits as a candidate."""
    manifest = code.manifest
    output_struct = host.dtype("output", manifest)
    state_size, input_size, output_size = (manifest["structs"][role]["size"] for role in ("state", "input", "output"))

    def lay_out(image: Image, steps: Steps) -> CallLayout:
        n = len(steps)
        states, inputs = image.place(steps.states), image.place(steps.inputs)
        outputs = image.reserve(n * output_struct.itemsize)
        pointers = _call_arguments(n, (states, state_size), (inputs, input_size), (outputs, output_size))
        return CallLayout(pointers, lambda: host.columns(_read_array(image, outputs, n, output_struct)))

    return Candidate(
        SYNTH, host.code(code.files), manifest["functions"]["step"], state_size, input_size + output_size, lay_out
    )


def casadi(block: Block, shimmed: bool) -> Candidate:
    """Return CasADi's C of a Block with casadi_real=float, unchanged or with the float shim.

    Raises EmitError when the shim cannot be inserted.
    """
    # Constants are rounded once, as in synth's C: all generators compute with the same numbers.
    f = _casadi_function(block.rounded(np.float32))
    generator = ca.CodeGenerator(f.name(), {"with_header": False, "casadi_real": "float"})
    generator.add(f)
    text = generator.dump()
    n_x, n_u, n_y = (len(signals) for signals in (block.states, block.inputs, block.outputs))
    work = sum(map(int, _WORK_SIZE.findall(text)))
    return Candidate(
        CASADI_FLOAT if shimmed else CASADI,
        {f"{f.name()}.c": with_float_shim(text) if shimmed else text},
        f.name(),
        4 * (2 * n_x + work),
        4 * (n_u + n_y),
        lambda image, steps: _lay_out_casadi(block, f, image, steps),
    )


def with_float_shim(text: str) -> str:
    """Return CasADi's C with float literals and with the float functions of libm.

    Raises EmitError when the C does not include <math.h>: the macros are inserted after that line.
    """
    if "#include <math.h>\n" not in text:
        raise EmitError(
            "CasADi's C: found no `#include <math.h>`, need it to insert the float shim after it: adapt the shim"
        )
    return _LITERAL.sub(r"\1f", text).replace("#include <math.h>\n", _SHIM, 1)


def unmeasured_generators() -> tuple[str, ...]:
    """Return one line for each unsupported generator: its name and why it is not measured."""
    installed = {name: importlib.util.find_spec(name) is not None for name in UNSUPPORTED}
    reasons = {True: "installed, but not supported here", False: "not installed"}
    return tuple(f"{name}: {reasons[is_installed]}; not measured" for name, is_installed in installed.items())


def _casadi_function(block: Block) -> ca.Function:
    f = block.function()
    x, u = f.sx_in()
    results = ca.cse([ca.densify(e) for e in f.call([x, u])])
    return ca.Function(f"{block.name}_casadi", [x, u], results, ["x", "u"], ["x_next", "y"])


def _lay_out_casadi(block: Block, f: ca.Function, image: Image, steps: Steps) -> CallLayout:
    """Prepare calls of `int f(const float **arg, float **res, casadi_int *iw, float *w, int mem)`."""
    n = len(steps)
    n_x, n_y = len(block.states), len(block.outputs)
    x = image.place(_matrix(steps.states, [s.name for s in block.states]))
    u = image.place(_matrix(steps.inputs, [s.name for s in block.inputs]))
    x_next, y = image.reserve(4 * n * n_x), image.reserve(4 * n * n_y)
    arg = _pointers(image, n, f.sz_arg(), (x, 4 * n_x), (u, 4 * len(block.inputs)))
    res = _pointers(image, n, f.sz_res(), (x_next, 4 * n_x), (y, 4 * n_y))
    iw, w, mem = (image.reserve(8 * f.sz_iw()), 0), (image.reserve(4 * f.sz_w()), 0), (0, 0)  # the same in all calls

    def outputs() -> host.Columns:
        values = _read_array(image, y, n * n_y, np.dtype(np.float32)).reshape(n, n_y)
        return {s.name: values[:, k] for k, s in enumerate(block.outputs)}

    return CallLayout(_call_arguments(n, arg, res, iw, w, mem), outputs)


def _matrix(records: host.Records, names: list[str]) -> NDArray[np.float32]:
    return np.stack([records[name].astype(np.float32) for name in names], axis=1)


def _pointers(image: Image, n: int, size: int, *arrays: tuple[int, int]) -> tuple[int, int]:
    """Write n tables of `size` pointers; those of the k-th table point to the k-th rows of arrays (address, row bytes).

    Returns the address of the first table and the bytes from one to the next.
    """
    table = np.zeros((n, size), np.uint32)
    for column, (address, stride) in enumerate(arrays):
        table[:, column] = address + stride * np.arange(n)
    return image.place(table), 4 * size


def _call_arguments(n: int, *arguments: tuple[int, int]) -> NDArray[np.int64]:
    """Return the arguments of n calls, (n, len(arguments)).

    Each argument is given by its value in the first call and its increase from call to call: for a pointer, an address
    and a stride in bytes.
    """
    k = np.arange(n, dtype=np.int64)
    return np.stack([first + increase * k for first, increase in arguments], axis=1)


def _read_array(image: Image, address: int, n: int, dtype: np.dtype[Any]) -> NDArray[Any]:
    return np.frombuffer(image.read(address, n * dtype.itemsize), dtype)


CORE = "cortex-m4f"
COMMON = 500  # closed-loop steps for every generator; CasADi's C takes 60,000 instructions for each
BRIEF_STEPS, BRIEF_COMMON, DRAWN = 500, 25, 4000  # steps for a measurement of a few seconds
NOT_COMPARED = "other compilers and generators, and every decision: by `synth cost`"
FUNCTIONS = 8  # functions that are listed
ONE_OPERATION = tuple(f"_{name}" for name in (*expressions.HELPERS, *expressions.GUARDS, "polynomial"))
_LINES = ("-g1",)  # adds lines and inlined calls; the code is unchanged. Tables of variables take as long as the code


Columns = Mapping[str, NDArray[Any]]


class Build(NamedTuple):
    """A toolchain: a compiler and its flags after those of `cross.FLAGS`."""

    name: str
    compiler: str
    flags: tuple[str, ...] = ()


BUILDS = (
    Build("gcc, newlib", "gcc"),
    Build("gcc, newlib, small", "gcc", ("-Os",)),
    Build("gcc, newlib, contracted", "gcc", cross.CONTRACTED),
    Build("zig, musl", "zig"),
)


class Run(NamedTuple):
    """Measurement of one candidate over N steps by one build: cost, outputs, size and path of the image."""

    cost: image.Cost
    outputs: host.Columns
    size: elf.Size
    path: Path


def builds() -> tuple[Build, ...]:
    """Return the builds whose compilers are installed."""
    installed = cross.available()
    return tuple(b for b in BUILDS if b.compiler in installed)


def measure(
    emitted: EmittedCode,
    block: Block,
    sequences: Sequence[Steps],
    progress: Callable[[str], None],
    common: int = COMMON,
) -> Cost:
    """Measure the float32 C of a Block over all sequences, and every generator over `common` steps of closed loops.

    The common steps exclude steps with a fault, because a latched step skips the control law and distorts the ratio.

    Raises CompileError when no cross compiler is installed or one refuses a source, and SignalError when no sequence
    comes from a closed loop, when one has no steps or when two have one name.
    """
    others = (casadi(block, shimmed=False), casadi(block, shimmed=True))
    return _measure(emitted, block, sequences, progress, common, others, builds())


def brief(emitted: EmittedCode, block: Block, inputs: Columns) -> Cost:
    """Measure in a few seconds, by the one toolchain that is on every machine, without the other generators.

    The steps are some of one closed loop, and random states for the coverage of decisions.

    Raises CompileError and SignalError as `measure`.
    """
    controller = host.load(emitted.files, emitted.manifest)
    sequences = [brief_loop(controller, inputs), steps.random_steps(controller, DRAWN)]
    return _measure(emitted, block, sequences, lambda _: None, BRIEF_COMMON, (), BUILDS[-1:])


def of_companion(emitted: EmittedCode, companion: Companion, inputs: Columns) -> Cost:
    """Measure the C of a companion as `measure` does, over recorded inputs and the sequences that it declares.

    Raises CompileError and SignalError as `measure`.
    """
    controller = host.load(emitted.files, emitted.manifest)
    drawn = companion.sequences or (lambda of: [steps.random_steps(of, DRAWN)])
    sequences = [brief_loop(controller, inputs), *drawn(controller)]
    return measure(emitted, companion.block, sequences, lambda _: None, BRIEF_COMMON)


def brief_loop(controller: host.Controller, inputs: Columns) -> Steps:
    """Return some of the steps of a controller over recorded inputs of a closed loop."""
    return steps.thinned(steps.record(controller, "closed loop", inputs, closed_loop=True), BRIEF_STEPS)


def _measure(
    emitted: EmittedCode,
    block: Block,
    sequences: Sequence[Steps],
    progress: Callable[[str], None],
    common: int,
    others: Sequence[Candidate],
    toolchains: Sequence[Build],
) -> Cost:
    controller = host.load(emitted.files, emitted.manifest)
    loops = steps.concatenate("closed loops", [s for s in sequences if s.closed_loop])
    shared = replace(steps.thinned(steps.without_faults(controller, loops), common), name="closed loops without faults")
    for sequence in (*sequences, shared):
        if not len(sequence):
            raise SignalError(
                f"cost of '{block.name}': found no steps in the sequence '{sequence.name}', need at least one: give "
                "stimuli that reach what it selects, or leave it out"
            )
    names = [s.name for s in sequences]
    if twice := sorted({name for name in names if names.count(name) > 1}):
        raise SignalError(
            f"cost of '{block.name}': found several sequences named {', '.join(map(repr, twice))}, need one row of the "
            "table each: rename or concatenate them"
        )
    emitted_c = emitted_source(emitted)
    compared, measured, coverages = [], [], []
    for build in toolchains:
        for candidate in (emitted_c, *others):
            progress(f"{candidate.name} by {build.name}: {len(shared)} steps")
            compared.append(step_cost(candidate, shared, build, controller))
        progress(f"{emitted_c.name} by {build.name}: {sum(map(len, sequences))} steps")
        whole = run(emitted_c, steps.concatenate("all", sequences), build)
        measured += _by_sequence(whole.cost.instructions, sequences, build)
        coverages.append(coverage(emitted_c, whole, build))
    return Cost(
        block.name,
        CORE,
        block.time.period_s,
        tuple(compared),
        tuple(measured),
        tuple(coverages),
        cost.of_program(emitted.program) if emitted.program else cost.of_block(block, np.float32),
        unmeasured_generators() if others else (NOT_COMPARED,),
    )


def with_law_alone(cost: Cost, law: EmittedCode, inputs: Columns) -> Cost:
    """Return the cost with that of the C of the law without its fault handling, over steps without a fault.

    Raises as `measure`.
    """
    controller, candidate = host.load(law.files, law.manifest), replace(emitted_source(law), name=LAW_ALONE)
    inputs = {name: column for name, column in inputs.items() if name in (controller.inputs.names or ())}
    recorded = steps.without_faults(controller, steps.record(controller, "law alone", inputs))
    shared = steps.thinned(recorded, cost.compared[0].steps)
    toolchains = [b for b in BUILDS if b.name in {c.build for c in cost.compared}]
    alone = [step_cost(candidate, shared, build, controller) for build in toolchains]
    return replace(cost, compared=(*cost.compared, *alone))


class Instructions(NamedTuple):
    """Instructions of a step by one build: those of each sequence (N,), and how many of its output values differ.

    They are compared with those of the C on the host, bit by bit; a build with contraction rounds otherwise by
    intention.
    """

    build: str
    counts: tuple[NDArray[np.int64], ...]
    values: int
    differing: int


def instructions(emitted: EmittedCode, sequences: Sequence[Steps]) -> list[Instructions]:
    """Return the instructions of a step of emitted C over some sequences, for each installed compiler."""
    controller, rows = host.load(emitted.files, emitted.manifest), []
    expected = [steps.evaluate(controller, sequence).outputs for sequence in sequences]
    for build in builds():
        runs = [run(emitted_source(emitted), sequence, build) for sequence in sequences]
        pairs = [(v, r.outputs[n]) for outputs, r in zip(expected, runs, strict=True) for n, v in outputs.items()]
        differing = sum(
            int(np.count_nonzero(v.view(np.uint32) != w.astype(np.float32).view(np.uint32))) for v, w in pairs
        )
        counts = tuple(r.cost.instructions for r in runs)
        rows.append(Instructions(build.name, counts, sum(len(v) for v, _ in pairs), differing))
    return rows


def run(candidate: Candidate, sequence: Steps, build: Build) -> Run:
    """Measure a candidate over a sequence of steps."""
    path = link(candidate, build)
    machine = boot(candidate, build, path)
    layout = candidate.lay_out(machine, sequence)
    measured = machine.measure(candidate.entry, layout.arguments).cost
    return Run(measured, layout.outputs(), machine.program.size(), path)


def count_instructions(candidate: Candidate, sequence: Steps, build: Build) -> NDArray[np.int64]:
    """Count the executed instructions of each step (N,), without those that are predicated false."""
    machine = boot(candidate, build, link(candidate, build))
    arguments = candidate.lay_out(machine, sequence).arguments
    counts = []
    with trace.attach(machine.engine) as record:
        for row in arguments:
            machine.calls(candidate.entry, row[np.newaxis])
            record.end_call()
            if record.is_filling:
                counts.append(np.diff(record.take().ends, prepend=0))
        counts.append(np.diff(record.take().ends, prepend=0))
    return np.concatenate(counts)


def step_cost(candidate: Candidate, sequence: Steps, build: Build, controller: host.Controller) -> StepCost:
    """Measure a candidate over a sequence and compare its outputs with those of the emitted C on the host."""
    measured = run(candidate, sequence, build)
    machine_cost, size = measured.cost, measured.size
    assert machine_cost.cycles is not None
    mean = {name: float(n.mean()) for name, n in list(machine_cost.by_function.items())[:FUNCTIONS]}
    memory = Memory(
        code=size.code,
        constants=size.constants + size.literals,
        data=size.data,
        state=candidate.state_bytes,
        signals=candidate.signal_bytes,
        stack=machine_cost.stack_bytes,
    )
    return StepCost(
        generator=candidate.name,
        build=build.name,
        steps=len(sequence),
        issued=cost.summarise(machine_cost.instructions),
        executed=cost.summarise(count_instructions(candidate, sequence, build)),
        cycles=(cost.summarise(machine_cost.cycles.low), cost.summarise(machine_cost.cycles.high)),
        functions=mean,
        memory=memory,
        doubles=len(cross.double_symbols(candidate.files, build.compiler, (*build.flags, *_LINES))),
        difference=_difference(controller, sequence, measured.outputs),
    )


def coverage(candidate: Candidate, measured: Run, build: Build) -> Coverage:
    """Return the decision coverage of a run in the functions of a candidate, with a text for each missing outcome.

    For a decision in an inlined function of one operation, such as a limit, the text gives the line of the call.
    """
    missing_sites = measured.cost.missing
    table = cost.read(measured.path) if missing_sites else cost.Lines((), ())
    inlined = cost.calls(measured.path, candidate.entry) if missing_sites else ()
    missing = [
        f"{s.function} at {s.address:#x}: `{s.text}` never {s.missing}{_source(candidate, table, inlined, s.address)}"
        for s in missing_sites
    ]
    return Coverage(build.name, len(measured.cost.sites), tuple(missing))


def _source(candidate: Candidate, table: cost.Lines, inlined: Sequence[cost.Call], address: int) -> str:
    name, line = table.at(address)
    around = [call for call in inlined if call.low <= address < call.high]
    line = next((call.line for call in around if call.function.endswith(ONE_OPERATION)), line)
    text = candidate.files.get(name, "").splitlines()
    return f"; {name}:{line}: {text[line - 1].strip()}" if 0 < line <= len(text) else ""


def link(candidate: Candidate, build: Build) -> Path:
    """Link the image of a candidate by a build, with its line table, and return its path."""
    return cross.link(candidate.files, [candidate.entry], CORE, build.compiler, (*build.flags, *_LINES))


def boot(candidate: Candidate, build: Build, path: Path) -> image.Image:
    """Load the linked image of a candidate into a core after reset."""
    covered_functions = cross.functions(candidate.files, CORE, build.compiler, (*build.flags, *_LINES))
    return image.boot(elf.read(path), CORE, covered_functions)


def _by_sequence(instructions: NDArray[np.int64], sequences: Sequence[Steps], build: Build) -> list[SequenceCost]:
    ends = np.cumsum([len(s) for s in sequences])[:-1]
    parts = np.split(instructions, ends)
    return [
        SequenceCost(s.name, build.name, len(s), cost.summarise(part)) for s, part in zip(sequences, parts, strict=True)
    ]


def _difference(controller: host.Controller, sequence: Steps, outputs: Columns) -> float:
    """Return the worst difference of an output from the emitted C on the host, relative to the range of the output."""
    expected = steps.evaluate(controller, sequence).outputs
    widths = {f["name"]: f["high"] - f["low"] for f in controller.manifest["structs"]["output"]["fields"]}
    gaps = [np.max(np.abs(outputs[n].astype(float) - v.astype(float))) / widths[n] for n, v in expected.items()]
    return float(max(gaps))
