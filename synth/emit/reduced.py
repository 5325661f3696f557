"""Reduction: a Block as the program that is printed: lowered, folded, its functions replaced, its idle limits dropped.

Each step keeps what is computed, to rounding or to a surrogate's certificate. The ranges of the result are proved: no
division by zero, no root of a negative number, and every next state and output inside its declared range.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from synth.block import Block, Constant
from synth.emit import fold, lower, printer, ranges, safe, wording
from synth.emit import replace as surrogates
from synth.emit.lower import Program
from synth.emit.replace import Surrogate
from synth.errors import EmitError


@dataclass(frozen=True, eq=False)
class Reduced:
    """What is printed: the Block with the constants that folding made, its program, and the program's surrogates."""

    block: Block
    program: Program
    surrogates: tuple[Surrogate, ...]


def reduce(block: Block, scalar: type[np.floating], libm: bool = False, error: float | None = None) -> Reduced:
    """Reduce a Block with rounded constants; there are no surrogates where `libm` is to compute.

    `error` is the relative error allowed to a surrogate, that of `surrogate.fit` when it is left out.

    Raises EmitError for an operation without a form in C, for one that is not proved safe, and for a state or
    an output that may leave its declared range.
    """
    program = fold.folded(lower.program(block))
    bounds = ranges.bounds(block, scalar)
    safe.require_safe(program, ranges.analyse(program, bounds, scalar), block, scalar)
    found: tuple[Surrogate, ...] = ()
    if not libm:
        program, found = surrogates.replaced(program, bounds, scalar, error)
    while idle := ranges.redundant(program, ranges.analyse(program, bounds, scalar)):
        program = fold.folded(program.substituted(idle))
    program = _certified(fold.gathered(program), found, scalar)
    block = replace(block, constants=(*block.constants, *_products(block, program, scalar)))
    bounds = ranges.bounds(block, scalar)
    proved = ranges.analyse(program, bounds, scalar)
    narrowed = safe.require_safe(program, proved, block, scalar)
    ranges.inductive(program, proved, block, scalar)
    safe.require_declared(program, narrowed, block, scalar)
    _require_whole(program, proved)
    return Reduced(block, program, found)


def _certified(program: Program, surrogates: Sequence[Surrogate], scalar: type[np.floating]) -> Program:
    """Return the program without the limits that a certificate proves idle: what they limit is said to be `within`.

    A certificate counts on polynomials: what libm is left to compute has no error that is known.
    """
    known = not any(node.op in printer.LIBM - {"sqrt", "fabs"} for node in program.nodes)
    error = max((s.polynomial.max_relative_error for s in surrogates), default=0.0) if known else np.inf
    nodes = list(program.nodes)
    for named, k in program.marks:
        if named.certificate is None or nodes[k].op != "clamp":
            continue
        high = float(scalar(nodes[nodes[k].args[2]].value))
        if named.certificate(float(np.finfo(scalar).eps) / 2, error) <= high:
            nodes[k] = replace(nodes[k], op="within")
    return replace(program, nodes=tuple(nodes))


def _products(block: Block, program: Program, scalar: type[np.floating]) -> list[Constant]:
    """Return the products that folding made of the Block's constants, rounded once."""
    by_name = {c.name: c for c in block.constants}
    pairs = {name: (by_name[first], by_name[second]) for name, (first, second) in program.products.items()}
    return [
        Constant(name, float(scalar(a.value * b.value)), f"{a.unit} {b.unit}", f"{a.source}; times {b.name}")
        for name, (a, b) in pairs.items()
    ]


def _require_whole(program: Program, proved: Sequence[ranges.Range]) -> None:
    """Raise EmitError where what C holds in 32 bits without a sign may exceed them.

    One that may be below 0 reaches nothing but an integer state, through choices: if taken it is what that state holds.
    """
    for k, kind in enumerate(printer.kinds(program)):
        if kind == "integer" and not proved[k].high < 2**32:
            raise EmitError(
                f"{wording.signal(program, k)}: the count {wording.expression(program, k)} is {proved[k].low:.9g} .. "
                f"{proved[k].high:.9g}, but a uint32_t holds 0 .. 4294967295: limit it"
            )
