"""One step of Blocks from many states: by CasADi, and by the C of many Blocks in one library."""

import ctypes
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from synth.block import Block
from synth.emit.write import EmittedCode, emit
from synth.execute import compile as compiler
from synth.execute import host
from tests.emit import dyadic

Change = Callable[[str], str]


@dataclass(frozen=True)
class StepResult:
    """The results of one step for each sample: next states and outputs (samples,) by name, and the fault words."""

    next: Mapping[str, NDArray[Any]]
    outputs: Mapping[str, NDArray[Any]]
    word: NDArray[np.uint32]

    def differences(self, other: "StepResult", rtol: float = 0.0) -> list[str]:
        """Return the names of next states and outputs that differ by more than rtol max(1, |value|), and "faults"."""
        pairs = [(f"next {n}", v, other.next[n]) for n, v in self.next.items()]
        pairs += [(n, v, other.outputs[n]) for n, v in self.outputs.items()]
        differing = [n for n, v, w in pairs if not (np.abs(v - w) <= rtol * np.maximum(1, np.abs(w))).all()]
        return differing + ([] if np.array_equal(self.word, other.word) else ["faults"])


def by_casadi(block: Block, x: NDArray[np.float64], u: NDArray[np.float64]) -> StepResult:
    """Evaluate CasADi's function of a Block in states (states, n) with inputs (inputs, n); flags become the word."""
    next, y = (m.full() for m in block.function()(x, u))
    outputs = {s.name: y[i] for i, s in enumerate(block.outputs)}
    word = np.zeros(x.shape[1], np.uint32)
    for f in block.faults:
        word |= (outputs[f.output] != 0).astype(np.uint32) << np.uint32(f.bit)
    return StepResult({s.name: next[i] for i, s in enumerate(block.states)}, outputs, word)


def by_c(
    library: ctypes.CDLL, block: Block, made: EmittedCode, x: NDArray[np.float64], u: NDArray[np.float64]
) -> StepResult:
    """Take one step of a Block's C from each state."""
    count = x.shape[1]
    state, inputs, out = (np.zeros(count, host.dtype(role, made.manifest)) for role in ("state", "input", "output"))
    for records, rows, names in (
        (state, x, [s.name for s in block.states]),
        (inputs, u, [s.name for s in block.inputs]),
    ):
        for name, row in zip(names, rows, strict=True):
            records[name] = row
    step = library[made.manifest["functions"]["step"]]
    step.restype, step.argtypes = ctypes.c_uint32, [ctypes.c_void_p] * 3
    word = [step(*(a.ctypes.data + k * a.itemsize for a in (state, inputs, out))) for k in range(count)]
    next = {s.name: state[s.name].astype(np.float64) for s in block.states}
    return StepResult(next, {s.name: out[s.name].astype(np.float64) for s in block.outputs}, np.array(word, np.uint32))


def compile_together(made: Sequence[EmittedCode], change: Change = str) -> ctypes.CDLL:
    """Compile the C of designs with unique names into one library; warnings are errors. `change` plants a defect."""
    files = {name: text for e in made for name, text in host.code(e.files).items()}
    files = {name: change(text) if name.endswith(".c") else text for name, text in files.items()}
    return ctypes.CDLL(str(compiler.shared_library(files, ["-O1", *compiler.STRICT_FLAGS])))


def differing_from_casadi(
    blocks: Sequence[Block], scalar: type[np.floating], count: int = 200, rtol: float = 0.0, **options: Any
) -> dict[str, list[str]]:
    """Emit, compile and step Blocks from dyadic samples; return the differences from CasADi by Block."""
    made = [emit(b, scalar, **options) for b in blocks]
    library, differing = compile_together(made), {}
    for b, e in zip(blocks, made, strict=True):
        x, u = dyadic.samples(b, count)
        if different := by_c(library, b, e, x, u).differences(by_casadi(b, x, u), rtol):
            differing[b.name] = different
    return differing
