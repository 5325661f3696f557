"""Proof obligations of operations: a nonzero denominator, a nonnegative argument of a root, and so on."""

from collections.abc import Callable
from dataclasses import dataclass
from math import inf

import numpy as np

from synth.emit.proof.interval import Array, Interval, Mask

Test = Callable[[Interval, list[Interval]], Mask]  # of an operation's result and arguments (n,)


@dataclass(frozen=True)
class Obligation:
    """A condition that an operation needs: `holds` and `fails` are both certain, otherwise it is undecided.

    `value` must not vanish and, if `signed`, must not change its sign. `watched` are the positions of the arguments on
    which the condition depends.
    """

    need: str
    quantity: str
    watched: tuple[int, ...]
    holds: Test
    fails: Test
    value: Callable[[list[Interval]], Array]
    signed: bool = False
    mend: str = (
        "narrow the ranges of the signals named, limit the argument (fmax, fmin), or write the expression in another "
        "form"
    )


def _middle(a: Interval) -> Array:
    return np.where(a.nan, np.nan, a.low + (a.high - a.low) / 2)


def _division(watched: int) -> Obligation:
    def holds(q: Interval, args: list[Interval]) -> Mask:
        below = args[-1]
        return ~below.zero & ~below.nan & (q.finite | ~args[0].finite)

    def fails(q: Interval, args: list[Interval]) -> Mask:
        below = args[-1]
        zero = (below.low == 0) & (below.high == 0) & ~below.nan
        return zero | (args[0].finite & ((q.low == inf) | (q.high == -inf)))

    need = "its denominator must exclude 0 and leave the quotient finite"
    return Obligation(need, "the denominator", (watched,), holds, fails, lambda args: _middle(args[-1]), True)


def _inside(low: float, high: float, need: str, quantity: str, value: Callable[[Array], Array]) -> Obligation:
    return Obligation(
        need,
        quantity,
        (0,),
        lambda y, args: (args[0].low >= low) & (args[0].high <= high) & ~args[0].nan,
        lambda y, args: (args[0].high < low) | (args[0].low > high),
        lambda args: value(_middle(args[0])),
    )


_UNIT = _inside(-1, 1, "its argument must lie in -1 .. 1", "1 - |argument|", lambda x: 1 - np.abs(x))

_OF: dict[str, Obligation] = {
    "div": _division(1),
    "inv": _division(0),
    "floor": _inside(
        0, 2.0**31, "its argument must lie in 0 .. 2^31, because C truncates it in 32 bits", "the argument", lambda x: x
    ),
    "sqrt": _inside(0, inf, "its argument must not be negative", "the argument", lambda x: x),
    "log": Obligation(
        "its argument must be positive",
        "the argument",
        (0,),
        lambda y, args: (args[0].low > 0) & ~args[0].nan,
        lambda y, args: args[0].high <= 0,
        lambda args: _middle(args[0]),
    ),
    "asin": _UNIT,
    "acos": _UNIT,
    "tan": Obligation(
        "its argument must stay away from the poles",
        "the cosine of the argument",
        (0,),
        lambda y, args: y.finite,
        lambda y, args: np.zeros_like(y.nan),
        lambda args: np.cos(_middle(args[0])),
        True,
    ),
    "atan2": Obligation(
        "its arguments must not both be 0",
        "the arguments' distance from (0, 0)",
        (0, 1),
        lambda y, args: ~(args[0].zero & args[1].zero) & ~args[0].nan & ~args[1].nan,
        lambda y, args: np.logical_and.reduce([(a.low == 0) & (a.high == 0) for a in args]),
        lambda args: np.hypot(_middle(args[0]), _middle(args[1])),
    ),
}


def of(op: str, size: int) -> Obligation | None:
    """Return the obligation of an operation, or None; `size` is the number of values of a table."""
    if op == "table":
        need = f"its index must lie in 0 .. {size - 1}"
        return _inside(
            0, size - 1, need, "the distance of the index from the nearer end", lambda x: np.minimum(x, size - 1 - x)
        )
    return _OF.get(op)


FINITE = Obligation(
    "it must be a finite number",
    "its reciprocal",
    (),
    lambda y, args: y.finite,
    lambda y, args: (y.low == inf) | (y.high == -inf),
    lambda args: 1 / _middle(args[0]),
)


def between(low: float, high: float, unit: str) -> Obligation:
    """Return the obligation that a result itself, in `unit`, lies in low .. high."""

    def holds(y: Interval, args: list[Interval]) -> Mask:
        return (y.low >= low) & (y.high <= high) & ~y.nan

    def fails(y: Interval, args: list[Interval]) -> Mask:
        return (y.low > high) | (y.high < low)

    return Obligation(
        f"it must stay in its declared range {low:.9g} .. {high:.9g} {unit}",
        "it",
        (),
        holds,
        fails,
        lambda sides: _middle(sides[0]),
        mend="limit it in the law, as block.clip(y, signal) does, declare the range that it has, or, only to look at "
        "it on the host, take block.unranged",
    )
