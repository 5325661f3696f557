"""Matrices in high precision, by ball arithmetic (Arb): computed once, rounded to double once.

A result that is rounded from 200 bits is the same on every machine, whatever linear algebra library it has.
"""

from collections.abc import Iterator
from contextlib import contextmanager

import flint
import numpy as np
from numpy.typing import ArrayLike

from synth.statespace import Array

BITS = 256


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
    """Return the midpoints (n, m), each rounded to the nearest double."""
    return np.array([[float(balls[i, j].mid()) for j in range(balls.ncols())] for i in range(balls.nrows())])


def middle(balls: flint.arb_mat) -> flint.arb_mat:
    """Return the midpoints without their radii."""
    return flint.arb_mat([[balls[i, j].mid() for j in range(balls.ncols())] for i in range(balls.nrows())])


def norm(balls: flint.arb_mat) -> float:
    """Return an upper bound of the largest entry's absolute value."""
    return max(float(abs(v).upper()) for v in balls.entries())


def identity(n: int) -> flint.arb_mat:
    """Return the identity of order n."""
    return matrix(np.eye(n))


def kronecker(P: flint.arb_mat, Q: flint.arb_mat) -> flint.arb_mat:
    """Return P (x) Q: with rows stacked, (P (x) Q) vec(X) = vec(P X Q^T)."""
    rows = [
        [P[i, j] * Q[k, m] for j in range(P.ncols()) for m in range(Q.ncols())]
        for i in range(P.nrows())
        for k in range(Q.nrows())
    ]
    return flint.arb_mat(rows)
