"""Instruction profile of a step by Block: each instruction is attributed to a line of the emitted C and its Block.

    instructions[k] = sum over Blocks and FRAME of parts[block][k]

An instruction belongs to the line of the compiler's line table. Instructions of inlined and called functions belong to
the line of the call. The Block of a line is that of the comment above it, from `trace` of the manifest. The sum is
exact. The shares depend on text and line table: an expression shared by two Blocks is attributed to one of them, and
instructions without a line of a Block, such as saving registers, to the FRAME.
"""

from collections.abc import Mapping
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from synth.emit.write import EmittedCode
from synth.errors import SignalError
from synth.execute import recorder, trace
from synth.verify import baselines, lines, meter
from synth.verify.steps import Steps

FRAME = "frame"


def measure(emitted: EmittedCode, stimulus: Steps, build: meter.Build) -> dict[str, NDArray[np.int64]]:
    """Return the instructions (N,) that each step issues by Block, in the order of the text, FRAME last.

    Raises CompileError as `meter.run`, and SignalError when there is no step.
    """
    if not len(stimulus):
        raise SignalError("parts of a step: found 0 steps, need 1 or more: give steps")
    candidate = baselines.emitted_c(emitted)
    path = meter.link(candidate, build)
    machine = meter.boot(candidate, build, path)
    names, owner = _owners(emitted, machine.code, candidate.entry, path)
    entry = _in_function(machine.code, candidate.entry)
    counted = []
    with recorder.attach(machine.engine) as record:
        arguments = candidate.lay_out(machine, stimulus).arguments
        for k, row in enumerate(arguments, 1):
            machine.calls(candidate.entry, row[np.newaxis])
            record.end_call()
            if record.is_filling or k == len(arguments):
                path_taken = trace.reconstruct_path(machine.code, record.take())
                counted.append(_count_by_owner(path_taken, owner, entry, len(names)))
    counts = np.concatenate(counted)
    return {name: counts[:, k] for k, name in enumerate(names)}


def _count_by_owner(
    path: trace.Trace, owner: NDArray[np.intp], entry: NDArray[np.bool_], size: int
) -> NDArray[np.int64]:
    """Count a trace by call and owner (n, size); outside the entry the last instruction inside it counts."""
    last = np.maximum.accumulate(np.where(entry[path.index], np.arange(len(path.index)), 0))
    call = np.repeat(np.arange(len(path.ends)), path.lengths)
    cells = call * size + owner[path.index[last]]
    return np.bincount(cells, minlength=len(path.ends) * size).reshape(-1, size)


def _in_function(code: trace.Code, function: str) -> NDArray[np.bool_]:
    names = [f.name for f in code.program.functions]
    return np.asarray(code.function == names.index(function))


def _owners(emitted: EmittedCode, code: trace.Code, entry: str, path: Path) -> tuple[list[str], NDArray[np.intp]]:
    """Return the names of the owners, and the index of the owner of each instruction (I,) of an image."""
    source = f"{emitted.manifest['design']}.c"
    blocks = _blocks(emitted.manifest["trace"])
    names = [*dict.fromkeys(blocks.values()), FRAME]
    table, inlined = lines.read(path), lines.calls(path, entry)
    places = [table.at(int(address)) for address in code.address]
    at = np.array([line if name == source else 0 for name, line in places])
    for call in inlined:
        at[(call.low <= code.address) & (code.address < call.high)] = call.line
    return names, np.array([names.index(blocks.get(int(line), FRAME)) for line in at], dtype=np.intp)


def _blocks(runs: Mapping[str, list[list[int]]]) -> dict[int, str]:
    by_line = {line: tag.split(":")[0] for tag, spans in runs.items() for a, b in spans for line in range(a, b + 1)}
    return dict(sorted(by_line.items()))
