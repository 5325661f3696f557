"""Cost measurement of a step on an emulated Cortex-M4F: every generator over the same steps, by the same toolchains.

Each step starts from its recorded state. All generators therefore see the same (x_k, u_k), and no rounding difference
accumulates.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from synth.block import Block
from synth.declare.companion import Companion
from synth.emit.write import EmittedCode
from synth.errors import SignalError
from synth.execute import cross, elf, host, image, recorder
from synth.verify import baselines, cost, lines, operations, steps
from synth.verify.baselines import Candidate
from synth.verify.cost import LAW_ALONE, Cost, Coverage, Memory, SequenceCost, StepCost
from synth.verify.steps import Steps

CORE = "cortex-m4f"
COMMON = 500  # closed-loop steps for every generator; CasADi's C takes 60,000 instructions for each
BRIEF_STEPS, BRIEF_COMMON, DRAWN = 500, 25, 4000  # steps for a measurement of a few seconds
NOT_COMPARED = "other compilers and generators, and every decision: by `synth cost`"
FUNCTIONS = 8  # functions that are listed
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
    others = (baselines.casadi(block, shimmed=False), baselines.casadi(block, shimmed=True))
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
    emitted_c = baselines.emitted_c(emitted)
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
        operations.of_program(emitted.program) if emitted.program else operations.of_block(block, np.float32),
        baselines.unmeasured_generators() if others else (NOT_COMPARED,),
    )


def with_law_alone(cost: Cost, law: EmittedCode, inputs: Columns) -> Cost:
    """Return the cost with that of the C of the law without its fault handling, over steps without a fault.

    Raises as `measure`.
    """
    controller, candidate = host.load(law.files, law.manifest), replace(baselines.emitted_c(law), name=LAW_ALONE)
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
        runs = [run(baselines.emitted_c(emitted), sequence, build) for sequence in sequences]
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
    with recorder.attach(machine.engine) as record:
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

    For a decision in an inlined function the text gives the line of the call.
    """
    missing_sites = measured.cost.missing
    table = lines.read(measured.path) if missing_sites else lines.Lines((), ())
    inlined = lines.calls(measured.path, candidate.entry) if missing_sites else ()
    missing = [
        f"{s.function} at {s.address:#x}: `{s.text}` never {s.missing}{_source(candidate, table, inlined, s.address)}"
        for s in missing_sites
    ]
    return Coverage(build.name, len(measured.cost.sites), tuple(missing))


def _source(candidate: Candidate, table: lines.Lines, inlined: Sequence[lines.Call], address: int) -> str:
    name, line = table.at(address)
    line = next((call.line for call in inlined if call.low <= address < call.high), line)
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
