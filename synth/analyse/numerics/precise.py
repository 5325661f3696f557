"""Matrices in high precision, by ball arithmetic (Arb), rounded to double once.

A result rounded from hundreds of bits is the same on every machine and with every linear algebra library.
"""

from collections.abc import Callable, Iterator
from contextlib import contextmanager

import flint
import numpy as np
from numpy.typing import ArrayLike

from synth.errors import ModelError
from synth.statespace import Array

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
    return flint.arb_mat([[flint.arb(float(v)) for v in row] for row in array])


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
