"""Derivatives of a model, and the refusal of a kink, where it has none.

    f'(z; d) = lim (f(z + t d) - f(z)) / t,  t > 0, t -> 0

is the derivative of f at z in the direction d. f has a derivative at z only if f'(z; d) is linear in d. CasADi's
derivative of fabs, fmax or a comparison at its switch is the mean of both sides, or that of one.

Method: forward mode of algorithmic differentiation for piecewise smooth functions (Griewank and Walther, Evaluating
Derivatives, section 14.2). Each operation passes on its value and its derivative in each direction d. One that switches
takes the side on which z + 2 NEAR d lies, with its derivatives at z. The directions are both of each signal, of the
length of half its range, and both of a generic one, which shows a kink of |a + b| - |a - b|.

A test of equality takes no side: ca.if_else(a == 0, 1, ca.sin(a) / a) has a derivative. A function that CasADi calls,
such as an interpolant, has CasADi's derivative, unchecked.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache, lru_cache

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from synth import show
from synth.base import column_maps
from synth.block import is_dot
from synth.errors import ModelError
from synth.signals import Signal
from synth.statespace import Array

Values = Array | float  # for each direction (k,), or the same for all

NEAR = 1e-12  # of half the width of a signal's range: a point this close to a kink lies on it, as a trim finds it
WIDEST = 1e6  # of half the width of a range: a wider one stands for any value
LEAST = 1e-7  # of a result's change over half the range of a signal: a smaller change of its slope is none


@dataclass(frozen=True, eq=False)
class _Limit:
    """Value and derivative of an operation at the point, on the side of each direction, and its value there (k,)."""

    value: Values
    slope: Values
    beside: Array

    @property
    def is_constant(self) -> bool:
        return isinstance(self.value, float) and isinstance(self.slope, float)


def _either(condition: NDArray[np.bool_], a: _Limit, b: _Limit) -> tuple[Values, Values]:
    return np.where(condition, a.value, b.value), np.where(condition, a.slope, b.slope)


def _excess(a: _Limit, b: _Limit) -> Array:
    """Return a - b beside the point; where rounding leaves nothing of it, the difference of their slopes."""
    difference = a.beside - b.beside
    return np.where(difference == 0, a.slope - b.slope, difference)


ZERO = _Limit(0.0, 0.0, np.zeros(1))


def _remainder(beside: Array, a: _Limit, b: _Limit) -> tuple[Values, Values]:
    whole = np.round((a.beside - beside) / b.beside)
    return a.value - whole * b.value, a.slope - whole * b.slope


# Of each operation that switches: its value and slope, from its value beside the point and its arguments.
SWITCHES: Mapping[int, Callable[..., tuple[Values, Values]]] = {
    **dict.fromkeys((ca.OP_LT, ca.OP_LE, ca.OP_SIGN, ca.OP_FLOOR, ca.OP_CEIL), lambda beside, *_: (beside, 0.0)),
    ca.OP_FABS: lambda _, a: (np.sign(_excess(a, ZERO)) * a.value, np.sign(_excess(a, ZERO)) * a.slope),
    ca.OP_COPYSIGN: lambda beside, a, _: (np.sign(beside * a.beside) * a.value, np.sign(beside * a.beside) * a.slope),
    ca.OP_FMIN: lambda _, a, b: _either(_excess(a, b) < 0, a, b),
    ca.OP_FMAX: lambda _, a, b: _either(_excess(a, b) > 0, a, b),
    # It jumps by 2 pi where the first is 0 and the second negative.
    ca.OP_ATAN2: lambda beside, a, b: (beside, (b.value * a.slope - a.value * b.slope) / (a.value**2 + b.value**2)),
    ca.OP_FMOD: _remainder,
    ca.OP_REMAINDER: _remainder,
}
SELECTIONS: Mapping[int, Callable[..., tuple[Values, Values]]] = {
    **SWITCHES,
    ca.OP_IF_ELSE_ZERO: lambda _, a, b: (
        np.where(np.equal(a.value, 0), 0.0, b.value),
        np.where(np.equal(a.value, 0), 0.0, b.slope),
    ),
    ca.OP_NOT: lambda _, a: (np.where(np.equal(a.value, 0), 1.0, 0.0), 0.0),
    ca.OP_AND: lambda _, a, b: (np.where(np.logical_and(a.value, b.value), 1.0, 0.0), 0.0),
    ca.OP_OR: lambda _, a, b: (np.where(np.logical_or(a.value, b.value), 1.0, 0.0), 0.0),
    ca.OP_EQ: lambda _, a, b: (np.where(np.equal(a.value, b.value), 1.0, 0.0), 0.0),
    ca.OP_NE: lambda _, a, b: (np.where(np.equal(a.value, b.value), 0.0, 1.0), 0.0),
}
BY_SIGN: Mapping[int, Callable[[ca.SX], ca.SX]] = {  # operations that switch with the sign of a difference
    ca.OP_FABS: lambda term: term.dep(0),
    ca.OP_FMIN: lambda term: term.dep(0) - term.dep(1),
    ca.OP_FMAX: lambda term: term.dep(0) - term.dep(1),
}
SIDES: Mapping[int, Callable[[ca.SX], ca.SX]] = {  # and with their value
    **BY_SIGN,
    **dict.fromkeys((ca.OP_LT, ca.OP_LE, ca.OP_SIGN, ca.OP_FLOOR, ca.OP_CEIL), lambda term: term),
}
FREQUENT: Mapping[int, tuple[np.ufunc, Callable[..., Sequence[Values]]]] = {  # operations and their derivatives
    ca.OP_ADD: (np.add, lambda a, b: (1.0, 1.0)),
    ca.OP_SUB: (np.subtract, lambda a, b: (1.0, -1.0)),
    ca.OP_MUL: (np.multiply, lambda a, b: (b, a)),
}


@dataclass(frozen=True, eq=False)
class _Changes:
    """Changes of f (m, n) for each of n signals that moves by its width, above and below; the limits of f there."""

    widths: Array
    above: Array
    below: Array
    limits: tuple[Array, Array]
    together: Array  # (m,): by how much changes for generic moves differ from the sum of their parts


def linear_model(
    what: str,
    model: ca.Function,
    point: Sequence[Array],
    signals: Sequence[Signal],
    sides: Sequence[tuple[bool, bool]],
    rows: Sequence[str],
) -> tuple[Array, Array, Array, Array]:
    """Return A, B, C, D: derivatives of the two results of `model`, together called `rows`, by its first two arguments.

    `point` has a value of each argument. `sides` tell of each of the `signals` of the first two whether it moves down
    and up. One that moves to one side alone has its derivative on that side; one that does not move, such as a counter,
    or a state between its bounds that only inputs reach that do not move, has CasADi's. A row without a name may have a
    kink.

    Raises ModelError, naming `what`, at a kink where all derivatives of CasADi's are finite.
    """
    of_model = _derivatives(model)
    A, B, C, D = (np.asarray(M) for M in of_model.jacobians.call([ca.DM(v) for v in point]))
    J = np.block([[A, B], [C, D]])
    if not of_model.switches or not np.isfinite(J).all():
        return A, B, C, D
    f = of_model.f
    z, (down, up) = np.concatenate([np.ravel(each) for each in point]), np.reshape(sides, (-1, 2)).T
    moves = down | up
    if not moves[A.shape[1] :].all():  # a state that only held inputs reach stays, too: a prefilter of a set-point
        reached = (B[: len(A)] != 0) @ moves[A.shape[1] :]
        for _ in A:
            reached |= (A != 0) @ reached
        stays = down & up & ~np.concatenate([reached, moves[len(A) :]])
        down, up = down & ~stays, up & ~stays
    widths, first, second, moves_by = _moves(z, signals, down, up)
    if _takes_one_branch(of_model, z, moves_by):
        return A, B, C, D
    changes = _changes(f, z, widths, first, second, moves_by)
    least = _require_derivative(what, f, z, signals, changes, rows)
    wrong = (np.abs(J * changes.widths - changes.above) > least[:, None]) & (down | up)  # CasADi's for two branches
    J = np.where(wrong, changes.above / changes.widths, J)
    n, m = A.shape
    return J[:n, :m], J[:n, m:], J[n:, :m], J[n:, m:]


@dataclass(frozen=True, eq=False)
class _Derivatives:
    """Jacobians of a model, its results as one function f of one argument, and whether operations of f switch.

    `sides` returns for each of these the number whose value, or with `by_sign` whose sign, says which branch it takes;
    it is None where an operation has no such number.
    """

    jacobians: ca.Function
    f: ca.Function
    switches: bool
    sides: ca.Function | None
    by_sign: NDArray[np.bool_]


@lru_cache(maxsize=8)  # a Block or a plant is linearised at many points
def _derivatives(model: ca.Function) -> _Derivatives:
    args = model.sx_in()
    results = model.call(args)
    exprs = [ca.densify(ca.jacobian(result, a)) for result in results for a in args[:2]]
    z = ca.vertcat(*args)
    f = ca.Function("f", [z], [ca.densify(ca.vertcat(*results))])
    operations, terms = [f.instruction_id(k) for k in range(f.n_instructions())], ca.vertsplit(f.instructions_sx())
    switches = [(op, term) for op, term in zip(operations, terms, strict=True) if op in SWITCHES]
    by_sign = np.array([op in BY_SIGN for op, _ in switches], dtype=bool)
    jacobians = ca.Function("jacobians", args, exprs)
    if ca.OP_CALL in operations or not all(op in SIDES for op, _ in switches):
        return _Derivatives(jacobians, f, bool(switches), None, by_sign)
    sides = ca.Function("sides", f.sx_in(), [ca.densify(ca.vcat([SIDES[op](term) for op, term in switches]))])
    return _Derivatives(jacobians, f, bool(switches), sides, by_sign)


@lru_cache(maxsize=8)
def _slopes(sides: ca.Function) -> ca.Function:
    symbol = sides.sx_in()[0]
    return ca.Function("slopes", [symbol], [ca.densify(ca.jacobian(sides(symbol), symbol))])


def _moves(
    z: Array, signals: Sequence[Signal], down: NDArray[np.bool_], up: NDArray[np.bool_]
) -> tuple[Array, Array, Array, Array]:
    """Return the widths (n,), the way up and the way down of each signal (n,), and all moves as columns."""
    widths = np.array([s.high / 2 - s.low / 2 for s in signals])
    widths = np.where((widths <= WIDEST) & (widths > 0), widths, 1.0)
    n = len(signals)
    first, second = np.where(up, 1.0, -1.0 * down), np.where(down, -1.0, 1.0 * up)  # the same where one side is alone
    generic = np.abs(np.cos(np.arange(n)))  # few of its entries add up to zero
    D = np.zeros((len(z), 2 * n + 2))
    D[:n] = widths[:, None] * np.column_stack([np.diag(first), np.diag(second), generic * first, generic * second])
    return widths, first, second, D


def _takes_one_branch(of_model: _Derivatives, z: Array, D: Array) -> bool:
    """Tell whether all operations that switch take one branch, at z and beside it: f has CasADi's derivative there.

    So it has where both branches have one value and one slope.
    """
    if of_model.sides is None:
        return False
    at = z[:, None] + np.column_stack([np.zeros(len(z)), 2 * NEAR * D])
    sides = column_maps.map_columns(of_model.sides, at)[0]
    sides = np.where(of_model.by_sign[:, None], np.sign(sides), sides)
    if (sides != sides[:, :1]).any():
        return False
    tied = of_model.by_sign & (sides[:, 0] == 0)
    # A number that is 0 beside the point, too, may be rounded: its slope decides.
    return not tied.any() or not np.asarray(_slopes(of_model.sides)(z))[tied][:, D.any(axis=1)].any()


def _changes(f: ca.Function, z: Array, widths: Array, first: Array, second: Array, D: Array) -> _Changes:
    n = len(widths)
    ways = D[:n] / widths[:, None]
    with np.errstate(all="ignore"):  # a branch that is not taken may be infinite
        limits, slopes = _directional(f, z, D)
        above, below = slopes[:, :n] * first, slopes[:, n : 2 * n] * second
        together = np.abs(slopes[:, 2 * n :] - above @ ways[:, 2 * n :]).max(axis=1, initial=0.0)
    return _Changes(widths, above, below, (limits[:, :n], limits[:, n : 2 * n]), together)


def _require_derivative(
    what: str, f: ca.Function, z: Array, signals: Sequence[Signal], changes: _Changes, rows: Sequence[str]
) -> Array:
    """Return for each row (m,) the change that counts as none; raise ModelError at a kink."""
    n, number, widths = len(signals), show.number, changes.widths
    moved = z[:, None] + np.eye(len(z), n) * widths
    sizes = np.abs(column_maps.map_columns(f, moved)[0] - column_maps.map_columns(f, z[:, None])[0])
    sizes = np.hstack([sizes, np.abs(changes.above), np.abs(changes.below)])
    least = LEAST * np.where(np.isfinite(sizes), sizes, 0.0).max(axis=1, initial=0.0)
    jumps, slopes = np.abs(changes.limits[0] - changes.limits[1]), np.abs(changes.above - changes.below)
    differences = np.column_stack([np.maximum(jumps, slopes), changes.together])
    for i, k in np.argwhere(differences > least[:, None]).tolist():
        if not rows[i]:
            continue
        if k == n:
            kink, beside = "has a kink where several signals change together", "other values of them"
        else:
            at, step, unit = z[k], 1e-3 * widths[k], signals[k].unit
            high, low = (number(v[i, k]) for v in changes.limits)
            right, left = (number(v[i, k] / widths[k]) for v in (changes.above, changes.below))
            is_jump = jumps[i, k] > least[i]
            kink = f"jumps from {low} to {high} at" if is_jump else f"has the slope {left} below and {right} above"
            kink += f" {signals[k].name} = {number(at)} {unit}"
            beside = f"{number(at - step)} or {number(at + step)} {unit}"
        raise ModelError(
            f"{what} has no derivative at the point: {rows[i]} {kink}. Linearise beside the kink, at {beside}, on each "
            "side on which the stage works"
        )
    return least


def _directional(f: ca.Function, z: Array, D: Array) -> tuple[Array, Array]:
    """Return the limits of f(z + t d) and f'(z; d), both (m, k), for d in the columns of D (n, k)."""
    terms, symbol = f.instructions_sx(), f.sx_in()[0]
    computed = [k for k in range(f.n_instructions()) if f.instruction_id(k) not in (ca.OP_OUTPUT, ca.OP_INPUT)]
    at = z[:, None] + np.column_stack([np.zeros(len(z)), 2 * NEAR * D])
    values = np.zeros((f.n_instructions(), at.shape[1]))
    values[computed] = column_maps.map_columns(ca.Function("terms", [symbol], [terms[computed]]), at)[0]
    limits, slopes = np.zeros((2, f.numel_out(0), D.shape[1]))
    registers: dict[int, _Limit] = {}
    for k in range(f.n_instructions()):
        op, i, o = f.instruction_id(k), f.instruction_input(k), f.instruction_output(k)
        if op == ca.OP_INPUT:
            j = i[1]
            registers[o[0]] = _Limit(float(z[j]), D[j] if D[j].any() else 0.0, at[j, 1:])
            continue
        args, here, beside = [registers[a] for a in i], float(values[k, 0]), values[k, 1:]
        if op == ca.OP_OUTPUT:
            limits[o[1]], slopes[o[1]] = args[0].value, args[0].slope
        elif op == ca.OP_CALL:
            registers |= dict.fromkeys(o, _call(terms[k].which_function(), args))
        elif all(a.is_constant for a in args):
            registers[o[0]] = _Limit(here, 0.0, beside)
        elif op in SELECTIONS:
            value, slope = SELECTIONS[op](beside, *args)
            jumps = np.abs(value - here).max() > LEAST * np.abs(slope).max()
            registers[o[0]] = _Limit(value if jumps else here, _common(slope), beside)
        else:
            registers[o[0]] = _Limit(*_smooth(op, args), beside)
    return limits, slopes


def _call(function: ca.Function, args: Sequence[_Limit]) -> _Limit:
    """Return the limit of a dot product, or of a table of numbers; that of another function is not known, NaN."""
    if is_dot(function):
        n = len(args) // 2
        beside = np.sum([k.beside * x.beside for k, x in zip(args[:n], args[n:], strict=True)], axis=0)
        terms = [_smooth(ca.OP_MUL, pair) for pair in zip(args[:n], args[n:], strict=True)]
        return _Limit(sum(value for value, _ in terms), sum(slope for _, slope in terms), beside)
    if function.jac_sparsity(0, 0).nnz():
        unknown = np.full_like(args[0].beside, np.nan)
        return _Limit(np.nan, unknown, unknown)
    beside = np.asarray(function(args[0].beside[None])).ravel()
    return _Limit(_common(beside), 0.0, beside)


def _common(v: Values) -> Values:
    """Return the number that is the same in all directions, or those of the directions."""
    first = np.ravel(v)[0]
    return float(first) if (v == first).all() else v


def _smooth(op: int, args: Sequence[_Limit]) -> tuple[Values, Values]:
    values = [a.value for a in args]
    if op in FREQUENT:
        ufunc, derivatives = FREQUENT[op]
        value, partials = ufunc(*values), derivatives(*values)
    else:
        same = all(isinstance(v, float) for v in values)
        phi = _operation(op, len(args))(*(values if same else map(np.atleast_2d, np.broadcast_arrays(*values))))
        value, *partials = (float(v) if same else np.asarray(v).ravel() for v in phi)
    moving = ((partial, a.slope) for partial, a in zip(partials, args, strict=True) if not isinstance(a.slope, float))
    return value, sum((partial * slope for partial, slope in moving), start=0.0)


@cache
def _operation(op: int, count: int) -> ca.Function:
    """Return phi, and its derivative by each argument."""
    args = [ca.SX.sym("a"), ca.SX.sym("b")][:count]
    phi = ca.SX.binary(op, *args) if count == 2 else ca.SX.unary(op, *args)
    return ca.Function("phi", args, [phi, *(ca.densify(ca.jacobian(phi, a)) for a in args)])
