"""Elimination of limits that never act, as proved by range analysis or by a certificate of the author."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from synth.emit.passes import fold
from synth.emit.passes.surrogates import Surrogate
from synth.emit.program.lower import Program
from synth.emit.program.operations import LIBM
from synth.emit.proof import ranges
from synth.emit.proof.graph import SELECTIONS


def without_idle(program: Program, bounds: Mapping[str, ranges.Range], scalar: type[np.floating]) -> Program:
    """Return the program without the limits that its ranges prove idle."""
    while idle := find_redundant(program, ranges.analyse(program, bounds, scalar)):
        program = fold.folded(program.substituted(idle))
    return program


def without_certified_limits(program: Program, surrogates: Sequence[Surrogate], scalar: type[np.floating]) -> Program:
    """Return the program with `within` (an assertion) in place of the limits that a certificate proves idle.

    A certificate needs the errors of all functions. It applies only if polynomials have replaced libm, whose errors are
    unknown.
    """
    known = not any(node.op in LIBM - {"sqrt", "fabs"} for node in program.nodes)
    error = max((s.polynomial.max_relative_error for s in surrogates), default=0.0) if known else np.inf
    nodes = list(program.nodes)
    for named, k in program.marks:
        if named.certificate is None or nodes[k].op != "clamp":
            continue
        high = float(scalar(nodes[nodes[k].args[2]].value))
        if named.certificate(float(np.finfo(scalar).eps) / 2, error) <= high:
            nodes[k] = replace(nodes[k], op="within")
    return replace(program, nodes=tuple(nodes))


def find_redundant(program: Program, proved: tuple[ranges.Range, ...]) -> dict[int, int]:
    """Map each min, max, clamp or choice that always equals one of its arguments to that argument.

    Chains of redundant nodes are followed to their end. (a < b) ? a : b is b if either is NaN, and it is the second of
    two zeros of different sign; a tie at 0 therefore never selects the first argument.
    """
    equal: dict[int, int] = {}
    for k in range(len(program.nodes)):
        same = _same(program, k, proved)
        if same is not None:
            equal[k] = equal.get(same, same)
    return equal


def _same(program: Program, k: int, proved: tuple[ranges.Range, ...]) -> int | None:
    node = program.nodes[k]
    if node.op in ("min", "max"):
        return _extreme(node.args, [proved[a] for a in node.args], node.op == "min")
    if node.op == "clamp":
        x, low, high = (proved[a] for a in node.args)
        inside = low.high <= x.low and x.high <= high.low and not (x.nan or low.nan or high.nan)
        return node.args[0] if inside else None
    if node.op in SELECTIONS:
        c = proved[node.args[0]]
        if not c.nan and (c.low > 0 or c.high < 0):
            return node.args[1]
        if not c.nan and c.low == c.high == 0:
            zeros = (z for z, n in enumerate(program.nodes[:k]) if n.op == "literal" and str(n.value) == "0.0")
            return node.args[2] if node.op == "choose" else next(zeros, None)
    return None


def _extreme(args: tuple[int, ...], sides: list[ranges.Range], least: bool) -> int | None:
    a, b = sides if least else [ranges.Range(-r.high, -r.low, r.nan) for r in sides]
    if b.high <= a.low:
        return args[1]
    return args[0] if not (a.nan or b.nan) and _below(a, b) else None


def _below(a: ranges.Range, b: ranges.Range) -> bool:
    return a.high < b.low or a.high == b.low != 0
