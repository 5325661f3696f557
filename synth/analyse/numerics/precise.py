"""Matrices in high precision, by ball arithmetic (Arb), rounded to double once.

A result rounded from hundreds of bits is the same on every machine and with every linear algebra library.

Running error analysis of expressions, and a test for expressions that are identically zero.

An expression is computed by operations v = phi(a, b). If each result has a relative error of eps, the value has, to
first order, an error of at most eps e with

    e(v) = |v| + |dphi/da| e(a) + |dphi/db| e(b),       e = 0 for symbols and constants,

which counts every term at its full size even if terms cancel (running error analysis: Higham, Accuracy and Stability of
Numerical Algorithms, 3.3). An expression is zero if it exceeds this error at no point: sin^2 + cos^2 - 1 is zero, and
1e-30 x is not.

Adaptive refinement of a frequency grid: intervals are halved until the frequency response changes little in each.

    |log L(j w_k+1) - log L(j w_k)| <= MAX_STEP, and the same for 1 + L, with complex logarithms

An interval is halved at the geometric mean of its ends, but not below a relative width of 4 MIN_SPACING.
"""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import cache

import casadi as ca
import flint
import numpy as np
from numpy.typing import ArrayLike, NDArray

from synth.analyse.numerics import nearest_root
from synth.analyse.numerics.nearest_root import Box
from synth.errors import ModelError
from synth.statespace import Array, Complex

Response = Callable[[ArrayLike], Complex]
MIN_SPACING = 1e-9  # least relative spacing of frequencies; L nearer to an undamped pole is only rounding error
MAX_STEP = 0.15  # of log L and of log(1 + L) between neighbours
MAX_ROUNDS = 40  # of halving


def refine(L: Response, w: Array, value: Complex) -> tuple[Array, Complex]:
    """Return the refined frequencies (k,) and L at each; `value` is L at w, and all of w is kept."""
    for _ in range(MAX_ROUNDS):
        wide = (_log_step(value) > MAX_STEP) | (_log_step(1 + value) > MAX_STEP)
        wide &= np.diff(w) > 4 * MIN_SPACING * w[1:]
        if not wide.any():
            break
        midpoints = np.sqrt(w[:-1] * w[1:])[wide]
        order = np.argsort(np.concatenate([w, midpoints]), kind="stable")
        value = np.concatenate([value, L(midpoints)])[order]
        w = np.concatenate([w, midpoints])[order]
    return w, value


def _log_step(value: Complex) -> Array:
    """Return the magnitudes of the differences of the complex logarithm, with phase steps in -pi .. pi."""
    phase_step = np.diff(np.angle(value))
    return np.hypot(np.diff(log_magnitude(value)), (phase_step + np.pi) % (2 * np.pi) - np.pi)


def log_magnitude(value: Complex) -> Array:
    """Return the natural logarithm of |value|, at least that of 1e-300."""
    return np.log(np.maximum(np.abs(value), 1e-300))


BITS = 256
ZERO = flint.arb(2) ** -200  # relative to the largest entry: a smaller entry is the rounding error of a zero
TIE = 1000  # bits that agree with a number halfway between two doubles: it is that number


class BeyondDoubleError(ModelError):
    """A result exceeds what a double holds."""


@contextmanager
def precision(bits: int = BITS) -> Iterator[None]:
    """Compute with `bits` of precision inside the block."""
    before = flint.ctx.prec
    flint.ctx.prec = bits
    try:
        yield
    finally:
        flint.ctx.prec = before


def matrix(values: ArrayLike) -> flint.arb_mat:
    """Return the doubles of a matrix (n, m), exactly."""
    array = np.asarray(values, dtype=np.float64)
    rows, columns = array.shape
    return flint.arb_mat(rows, columns, [flint.arb(float(v)) for v in array.ravel()])


def rounded(balls: flint.arb_mat) -> Array:
    """Return the midpoints (n, m), each rounded to the nearest double; below ZERO of the largest entry they are 0."""
    least = _least(balls)
    values = np.zeros((balls.nrows(), balls.ncols()))
    for i, j in np.ndindex(*values.shape):
        middle = balls[i, j].mid()
        values[i, j] = 0.0 if abs(middle) < least else float(middle)
    return values


def doubles(balls: flint.arb_mat) -> Array | None:
    """Return the doubles (n, m) to which all numbers in the balls round; entries below ZERO of the largest are 0.

    Returns None where a ball leaves its double open. One of TIE bits of accuracy halfway between two doubles counts as
    that tie, which no precision decides, and goes to the even one.
    """
    least = _least(balls)
    values = np.zeros((balls.nrows(), balls.ncols()))
    for i, j in np.ndindex(*values.shape):
        ball = balls[i, j]
        if abs(ball) < least:
            continue
        low, high = float(ball.lower()), float(ball.upper())
        if low != high and not ball.rel_accuracy_bits() >= TIE:
            return None
        values[i, j] = low if low == high else float((flint.arb(low) + flint.arb(high)) / 2)
    return values


def round_correctly(compute: Callable[[], flint.arb_mat], what: str) -> Array:
    """Return `compute()` (n, m), called `what`, rounded; the precision rises until each ball decides its double.

    Raises ModelError when 16 times the usual bits do not suffice, BeyondDoubleError for entries that a double does not
    hold; ZeroDivisionError when `compute` inverts a matrix that may be singular even then.
    """
    for bits in (BITS, 4 * BITS, 16 * BITS):
        with precision(bits):
            try:
                balls = compute()
            except ZeroDivisionError:
                if bits == 16 * BITS:
                    raise
                continue
            values = doubles(balls)
            if values is not None:
                if not np.isfinite(values).all():
                    raise BeyondDoubleError(
                        f"{what} exceeds what a double holds: take a shorter period or leave the mode that grows out "
                        "of the model"
                    )
                return values
    raise ModelError(
        f"{what} is not determined by {16 * BITS} bits: its fastest mode grows or decays too far in one period; "
        "take a shorter period or leave that mode out of the model"
    )


def norm(balls: flint.arb_mat) -> float:
    """Return an upper bound of the largest entry's absolute value, to double precision; inf if one is not known."""
    bounds = [float(abs(v).upper()) for v in balls.entries()]
    return max((np.inf if np.isnan(b) else b for b in bounds), default=0.0)


def _least(balls: flint.arb_mat) -> flint.arb:
    """Return the size below which an entry counts as 0; it is 0 if the size of an entry is unknown."""
    largest = norm(balls)
    return ZERO * largest if np.isfinite(largest) else flint.arb(0)


def identity(n: int) -> flint.arb_mat:
    """Return the identity of order n."""
    return matrix(np.eye(n))


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
        points = np.hstack([nearest_root.scatter(within.signals, POINTS, seed) for seed in SEEDS])
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
