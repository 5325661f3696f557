"""Double-double matrix products: each matrix is an unevaluated sum high + low, with low far below high.

A product X Y is split as X = X0 + X1, Y = Y0 + Y1. X0 and Y0 have so few bits that X0 Y0 is exact, in any order of the
operations. The remaining terms are smaller by the same number of bits and are computed in double (Rump, Ogita, Oishi
2008). For sums of n terms, X0 and Y0 keep b = (51 - log2 n) / 2 bits each. An entry of the product has an error of
about 2^(-53 - b) n times the largest entries in its row of X and its column of Y.
"""

from dataclasses import dataclass

import numpy as np

from synth.statespace import Array

DIGITS = 53  # of a double


@dataclass(frozen=True, eq=False)
class Twofold:
    """The matrix high + low (n, m)."""

    high: Array
    low: Array

    @property
    def T(self) -> "Twofold":
        """The transpose."""
        return Twofold(self.high.T, self.low.T)

    def rounded(self) -> Array:
        """Return the matrix in double precision."""
        return self.high + self.low

    def __getitem__(self, part: slice | tuple[slice, slice]) -> "Twofold":
        return Twofold(self.high[part], self.low[part])

    def __add__(self, other: "Twofold | Array") -> "Twofold":
        if isinstance(other, Twofold):
            high, error = _sum(self.high, other.high)
            return Twofold(high, self.low + other.low + error)
        high, error = _sum(self.high, other)
        return Twofold(high, self.low + error)

    def __neg__(self) -> "Twofold":
        return Twofold(-self.high, -self.low)

    def __sub__(self, other: "Twofold | Array") -> "Twofold":
        return self + -other


def product(X: Twofold | Array, Y: Twofold | Array) -> Twofold:
    """Return X Y (n, m) of X (n, k) and Y (k, m)."""
    x, x_low = (X.high, X.low) if isinstance(X, Twofold) else (X, 0.0)
    y, y_low = (Y.high, Y.low) if isinstance(Y, Twofold) else (Y, 0.0)
    bits = _bits(x.shape[1])
    x0, y0 = _leading(x, 1, bits), _leading(y, 0, bits)
    rest = x0 @ ((y - y0) + y_low) + ((x - x0) + x_low) @ y
    return Twofold(*_sum(x0 @ y0, rest))


def _bits(terms: int) -> int:
    return (DIGITS - terms.bit_length()) // 2 - 1


def _leading(values: Array, axis: int, bits: int) -> Array:
    """Return about `bits` leading bits of each entry, counted from the largest entry along the axis."""
    large = np.abs(values).max(axis=axis, keepdims=True, initial=0.0) * 2.0 ** (DIGITS - bits)
    return np.asarray((values + large) - large, dtype=np.float64)  # the sum rounds to the last place of `large`


def _sum(x: Array, y: Array) -> tuple[Array, Array]:
    """Return x + y as its rounded value and the exact error (Knuth)."""
    total = x + y
    second = total - x
    return total, (x - (total - second)) + (y - second)
