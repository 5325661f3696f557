"""Operation counts of the emitted program by kind: arithmetic, comparisons and logic, choices, loads and stores.

A polynomial counts as the products and sums of its evaluation, a limit to +-h as one operation. Both branches of every
choice count, although a step takes only one.
"""

from collections import Counter

import numpy as np

from synth.block import Block
from synth.emit import pipeline
from synth.emit.program.lower import Program

_KINDS = {"sq": "mul", "twice": "mul", "inv": "div", "clamp": "limit", "choose": "choice", "when": "choice"}
_KINDS |= dict.fromkeys(("lt", "le", "eq", "ne"), "compare") | dict.fromkeys(("and", "or", "not", "bit"), "logic")
_KINDS |= {"input": "load input", "state": "load state", "constant": "load constant", "literal": "load constant"}


def of_block(block: Block, scalar: type[np.floating]) -> dict[str, int]:
    """Count the operations of the C of a Block in a scalar type, the most frequent kind first.

    Raises EmitError as `emit`.
    """
    return of_program(pipeline.reduce(block.rounded(scalar), scalar).program)


def of_program(program: Program) -> dict[str, int]:
    """Count the operations of a program."""
    counts = Counter(_KINDS.get(n.op, n.op) for n in program.nodes if n.op != "polynomial")
    for node in program.nodes:
        if node.op == "polynomial":
            c = program.polynomials[node.name].coefficients
            counts += Counter({"mul": len(c) - 1, "add": sum(1 for value in c[:-1] if value)})
    kept = sum(program.nodes[k].op == "state" and program.nodes[k].name == name for name, k in program.next.items())
    counts["store"] = len(program.outputs) + len(program.next) - kept
    return dict(counts.most_common())
