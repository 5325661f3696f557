"""Which expressions are zero: those that nowhere exceed the rounding error of their own evaluation.

An expression is computed by operations v = phi(a, b). When each result is off by one part in 1/eps of itself, the
value is off, to first order, by at most eps e with

    e(v) = |v| + |dphi/da| e(a) + |dphi/db| e(b),       e = 0 for symbols and constants,

which counts every term at its full size where terms cancel (running error analysis: Higham, Accuracy and Stability of
Numerical Algorithms, 3.3). So sin^2 + cos^2 - 1 is zero and 1e-30 x is not.
"""

from functools import cache

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from synth.analyse import box
from synth.analyse.box import Box

LIMIT = 64 * float(np.finfo(float).eps)  # of e(v): above what a rounded constant and a library's function add to it
SEEDS = (1, 2, 3)
POINTS = 16  # for each seed


def bound(exprs: ca.SX) -> ca.SX:
    """Return e(v) for each entry of a dense `exprs`, as an expression of the same shape."""
    symbols = ca.vcat(ca.symvar(exprs))
    f = ca.Function("f", [symbols], [ca.densify(exprs)])
    value: dict[int, ca.SX] = {}
    error: dict[int, ca.SX] = {}
    found = ca.SX.zeros(*exprs.shape)
    for k in range(f.n_instructions()):
        op, i, o = f.instruction_id(k), f.instruction_input(k), f.instruction_output(k)
        if op == ca.OP_OUTPUT:
            found[o[1]] = error[i[0]]
        elif op in (ca.OP_INPUT, ca.OP_CONST):
            value[o[0]] = symbols[i[1]] if op == ca.OP_INPUT else ca.SX(f.instruction_constant(k))
            error[o[0]] = ca.SX(0)
        else:
            value[o[0]], error[o[0]] = _step(op, [value[a] for a in i], [error[a] for a in i])
    return found


def vanish(exprs: ca.SX, within: Box) -> NDArray[np.bool_]:
    """Tell for each entry of `exprs` (k, l) whether it is zero all over the box, as (k, l).

    A zero shows by its structure, or at every one of 48 scattered points. So an analytic expression is judged with
    certainty but for chance; one with branches may be other than zero where no point fell.

    Raises ModelError where an entry is not finite.
    """
    zero = np.ones(exprs.shape, dtype=bool)
    rows, columns = (np.array(places, dtype=int) for places in exprs.sparsity().get_triplet())
    if len(rows):
        points = np.hstack([box.scatter(within.signals, POINTS, seed) for seed in SEEDS])
        nonzeros = ca.vec(exprs).nz[:]
        value, error = within.evaluated(ca.horzcat(nonzeros, bound(nonzeros)), points).transpose(1, 0, 2)
        zero[rows, columns] = (np.abs(value) <= LIMIT * error).all(axis=1)
    return zero


def without_zeros(exprs: ca.SX, within: Box) -> ca.SX:
    """Return `exprs` with the entries that `vanish` finds zero taken out of its structure."""
    zero = vanish(exprs, within)
    kept = ca.SX(*exprs.shape)
    for i, j in np.argwhere(~zero).tolist():
        kept[i, j] = exprs[i, j]
    return kept


def _step(op: int, values: list[ca.SX], errors: list[ca.SX]) -> tuple[ca.SX, ca.SX]:
    binary = len(values) == 2
    v = ca.SX.binary(op, *values) if binary else ca.SX.unary(op, *values)
    e = ca.fabs(v)
    for slope, carried in zip(_slopes(op, binary).call(values), errors, strict=True):
        if not carried.is_zero():
            e += slope * carried
    return v, e


@cache
def _slopes(op: int, binary: bool) -> ca.Function:
    """Return |dphi/da| and, for two arguments, |dphi/db|."""
    args = [ca.SX.sym("a"), ca.SX.sym("b")][: 2 if binary else 1]
    phi = ca.SX.binary(op, *args) if binary else ca.SX.unary(op, *args)
    return ca.Function("slopes", args, [ca.densify(ca.fabs(ca.jacobian(phi, a))) for a in args])
