"""Limits that never act: those that ranges prove idle, and those of which an author's certificate proves it."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from synth.emit.lower import LIBM, Program
from synth.emit.passes import fold
from synth.emit.passes.replace import Surrogate
from synth.emit.proof import ranges


def without_idle(program: Program, bounds: Mapping[str, ranges.Range], scalar: type[np.floating]) -> Program:
    """Return the program without the limits that its ranges prove idle."""
    while idle := ranges.redundant(program, ranges.analyse(program, bounds, scalar)):
        program = fold.folded(program.substituted(idle))
    return program


def without_certified(program: Program, surrogates: Sequence[Surrogate], scalar: type[np.floating]) -> Program:
    """Return the program without the limits that a certificate proves idle: what they limit is said to be `within`.

    A certificate counts on polynomials: what libm is left to compute has no error that is known.
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
