"""The discrete Blocks of a loop in lanes: the controller and the Blocks of a drive behind it, one after another.

The outputs and states of all Blocks lie one after another, and each Block has one row of faults. An input of a Block of
the drive is the output with its name of the Block before it or of an earlier one, or else an input of the controller.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np

from synth.base import contents
from synth.block import Block
from synth.emit import lanes as lane_code
from synth.emit import pipeline
from synth.emit.lanes import Rows
from synth.emit.program.lower import Program
from synth.errors import WiringError
from synth.execute import host
from synth.signals import signal_names
from synth.simulate import drive as drives

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

    @cached_property
    def initial(self) -> tuple[list[float], list[float]]:
        """The real states and the counters after `init`."""
        state = self.controller.init()
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
