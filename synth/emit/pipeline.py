"""Pass pipeline of the code generator: from a Block to a reduced program, and from that to C.

    ranges.bounds                  declared range of each load
    lower.program                  CasADi expressions to nodes in SSA form, common subexpression elimination
    matrices.with_matrices             rows of constants times the same values: one product with a matrix
    fold.folded                    constant folding, algebraic simplification, shared reciprocals
    fault_flags.simplified         truth values: sums and choices of 0 and 1 become logic
    fault_flags.gather             bits that one side of a condition sets are set on that side
    safe.require_safe              proof on the program as written: no division by 0, no argument outside a domain
    guards.with_shared_guards      a condition for what several arms share, where that proof needs it
    surrogates.replace_functions   surrogates: minimax polynomials for functions of one variable
    guards.without_idle            dead limits by range analysis
    fold.with_constant_products    products of named constants
    guards.without_certified_limits dead limits by a certificate
    safe, ranges, kinds            the same proof on the result; next states and outputs stay in their declared ranges
    guards.guarded                 the guard of an input becomes one call
    guards.slewed                  a rate limit becomes one call
    numbers.with_numbers           a literal that a Block declares becomes a constant with a name
    parts.with_idle_results        what others do not read is not computed
    parts.alike, routine.outlined  each Block becomes a function that the step calls, like Blocks the same one
    law_functions.alike            so does each function that its law calls

Each pass preserves the computed values up to rounding or to a surrogate's certified error.
"""

from dataclasses import dataclass, replace

import numpy as np

from synth.base import cache
from synth.block import Block, Constant
from synth.emit.c import c_text, printer, routine
from synth.emit.c import lines as wrapping
from synth.emit.passes import fault_flags, fold, guards, matrices, numbers, parts, schedule, surrogates
from synth.emit.passes.surrogates import Surrogate
from synth.emit.program import layout, lower
from synth.emit.program.layout import Layout
from synth.emit.program.lower import Program
from synth.emit.proof import ranges, safe
from synth.errors import EmitError
from synth.signals import product_unit


@dataclass(frozen=True, eq=False)
class Reduced:
    """A program ready for printing: the Block with the constants from folding, the program, and its surrogates."""

    block: Block
    program: Program
    surrogates: tuple[Surrogate, ...]


def reduce(block: Block, scalar: type[np.floating], libm: bool = False, error: float | None = None) -> Reduced:
    """Run all passes on a Block with rounded constants; with `libm` there are no surrogates.

    `error` is the relative error allowed for a surrogate, by default that of `surrogate.fit`.

    Raises EmitError for an operation without a form in C, for one that is not proved safe, and for a state or an output
    that may leave its declared range.
    """
    constants, program, polynomials = _run_passes(block, scalar, libm, error)
    return Reduced(replace(block, constants=constants), program, polynomials)


@dataclass(frozen=True, eq=False)
class Source:
    """The lines of <name>.c and what header, manifest and cost are made of.

    `program` is the printed program with its calls, `reduced` the one before them. `numbers` are the constants that
    printing has named, and `of_plant` all that the program reads and that follow from parameters of the plant.
    """

    lines: tuple[printer.Line, ...]
    memory: Layout
    program: Program
    reduced: Program
    numbers: tuple[Constant, ...]
    of_plant: tuple[Constant, ...]
    surrogates: tuple[Surrogate, ...]


@cache.cached
def c_source(block: Block, scalar: type[np.floating], libm: bool, error: float | None) -> Source:
    """Return the C of a Block with rounded constants, whose printing takes most of the time of an emission.

    Raises EmitError as `reduce` and `layout.layout`.
    """
    reduced = reduce(block, scalar, libm, error)
    layout.layout(block, scalar)
    outlined = _outline(reduced, scalar)
    memory = layout.layout(outlined.block, scalar, routine.owners(outlined.program))
    lines = tuple(wrapping.wrapped(source(outlined, memory)))
    gains = {c.name for c in reduced.block.constants}
    named = tuple(c for c in outlined.block.constants if c.name not in gains)
    read = {n.name for n in reduced.program.nodes if n.op == "constant"}
    of_plant = tuple(c for c in outlined.block.constants if c.parameters and (c in named or c.name in read))
    return Source(lines, memory, outlined.program, reduced.program, named, of_plant, reduced.surrogates)


@cache.cached
def _run_passes(
    block: Block, scalar: type[np.floating], libm: bool, error: float | None
) -> tuple[tuple[Constant, ...], Program, tuple[Surrogate, ...]]:
    """Return the constants, the program and the surrogates of a Reduced: its data, which can be cached."""
    bounds = ranges.bounds(block, scalar)
    program = matrices.with_matrices(lower.program(block), block.name, {c.name: c.value for c in block.constants})
    program = fault_flags.simplified(fold.folded(program))
    program = fault_flags.gather(program)
    proved = ranges.analyse(program, bounds, scalar)
    as_written = program
    try:
        safe.require_safe(program, proved, block, scalar)
    except EmitError:
        program = guards.with_shared_guards(program)
    if program is not as_written:
        proved = ranges.analyse(program, bounds, scalar)
        safe.require_safe(program, proved, block, scalar)
    polynomials: tuple[Surrogate, ...] = ()
    if not libm:
        program, polynomials = surrogates.replace_functions(program, proved, scalar, error)
    program = guards.without_idle(program, bounds, scalar)
    program = fold.with_constant_products(program)
    program = guards.without_certified_limits(program, polynomials, scalar)
    block = replace(block, constants=(*block.constants, *_products(block, program))).rounded(scalar)
    proved = ranges.analyse(program, ranges.bounds(block, scalar), scalar)
    narrowed = safe.require_safe(program, proved, block, scalar)
    ranges.require_inductive(program, proved, block, scalar)
    safe.require_output_ranges(program, narrowed, block, scalar)
    ranges.require_whole(program, proved)
    marks = tuple((replace(named, certificate=None), k) for named, k in program.marks)
    return block.constants, replace(program, marks=marks), polynomials


def _outline(reduced: Reduced, scalar: type[np.floating]) -> Reduced:
    """Return what is printed: the program whose Parts are calls."""
    program, block = numbers.with_numbers(guards.slewed(guards.guarded(reduced.program)), reduced.block, scalar)
    program, values = parts.with_idle_results(program), {c.name: c.value for c in block.constants}
    return replace(reduced, block=block, program=routine.outlined(program, values, parts.alike(program)))


def source(reduced: Reduced, memory: Layout) -> list[printer.Line]:
    """Return the lines of <name>.c."""
    body = printer.body(reduced.block, reduced.program, schedule.statements(reduced.program), memory.scalar)
    return c_text.source(reduced.block, reduced.program, reduced.surrogates, memory, body)


def _products(block: Block, program: Program) -> list[Constant]:
    """Return the constants that are products of two of the Block's constants."""
    by_name = {c.name: c for c in block.constants}
    pairs = {name: (by_name[first], by_name[second]) for name, (first, second) in program.products.items()}
    return [
        Constant(
            name,
            a.value * b.value,
            product_unit(a.unit, b.unit),
            f"{a.source}; times {b.name}",
            parameters=tuple(dict.fromkeys((*a.parameters, *b.parameters))),
        )
        for name, (a, b) in pairs.items()
    ]
