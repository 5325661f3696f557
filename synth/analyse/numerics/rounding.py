"""Running error analysis of expressions, and a test for expressions that are identically zero.

An expression is computed by operations v = phi(a, b). If each result has a relative error of eps, the value has, to
first order, an error of at most eps e with

    e(v) = |v| + |dphi/da| e(a) + |dphi/db| e(b),       e = 0 for symbols and constants,

which counts every term at its full size even if terms cancel (running error analysis: Higham, Accuracy and Stability of
Numerical Algorithms, 3.3). An expression is zero if it exceeds this error at no point: sin^2 + cos^2 - 1 is zero, and
1e-30 x is not.
"""

from functools import cache

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from synth.analyse.numerics import box
from synth.analyse.numerics.box import Box

LIMIT = 64 * float(np.finfo(float).eps)  # of e(v): covers the errors of rounded constants and library functions as well
SEEDS = (1, 2, 3)
POINTS = 16  # for each seed


def error_bound(exprs: ca.SX) -> ca.SX:
    """Return e(v) for each entry of a dense `exprs`, as an expression of the same shape."""
    symbols = ca.vcat(ca.symvar(exprs))
    f = ca.Function("f", [symbols], [ca.densify(exprs)])
    value: dict[int, ca.SX] = {}
    error: dict[int, ca.SX] = {}
    errors = ca.SX.zeros(*exprs.shape)
    for k in range(f.n_instructions()):
        op, i, o = f.instruction_id(k), f.instruction_input(k), f.instruction_output(k)
        if op == ca.OP_OUTPUT:
            errors[o[1]] = error[i[0]]
        elif op in (ca.OP_INPUT, ca.OP_CONST):
            value[o[0]] = symbols[i[1]] if op == ca.OP_INPUT else ca.SX(f.instruction_constant(k))
            error[o[0]] = ca.SX(0)
        else:
            value[o[0]], error[o[0]] = _step(op, [value[a] for a in i], [error[a] for a in i])
    return errors


def vanish(exprs: ca.SX, within: Box) -> NDArray[np.bool_]:
    """Tell for each entry of `exprs` (k, l) whether it is zero on the whole box, as (k, l).

    An entry is zero by its structure, or if it is zero at each of 48 random points. For an analytic expression this
    decides with probability 1; one with branches may be nonzero where no point lies.

    Raises ModelError if an entry is not finite.
    """
    zero = np.ones(exprs.shape, dtype=bool)
    rows, columns = (np.array(places, dtype=int) for places in exprs.sparsity().get_triplet())
    if len(rows):
        points = np.hstack([box.scatter(within.signals, POINTS, seed) for seed in SEEDS])
        nonzeros = ca.vec(exprs).nz[:]
        value, error = within.evaluate(ca.horzcat(nonzeros, error_bound(nonzeros)), points).transpose(1, 0, 2)
        zero[rows, columns] = (np.abs(value) <= LIMIT * error).all(axis=1)
    return zero


def without_zeros(exprs: ca.SX, within: Box) -> ca.SX:
    """Return `exprs` with structural zeros for the entries that `vanish`."""
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
