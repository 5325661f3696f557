"""Matrix equilibration: rows and columns scaled to similar size, which makes a rank independent of units."""

from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from synth.statespace import Array

Matrix = TypeVar("Matrix", Array, NDArray[np.complex128])

PASSES = 5


def equilibrated(M: Matrix) -> tuple[Matrix, Array, Array]:
    """Return diag(r) M diag(c) with rows and columns of similar size, r and c."""
    r, c = np.ones(len(M)), np.ones(M.shape[1])
    for _ in range(PASSES):
        for axis, factor in ((1, r), (0, c)):
            size = np.sqrt(np.abs(r[:, None] * M * c).max(axis=axis, initial=0.0))
            factor /= np.where(size > 0, size, 1.0)
    return r[:, None] * M * c, r, c


def is_singular(M: Matrix) -> bool:
    """Tell whether a square M is singular within rounding, in any units; an empty M is not."""
    return bool(M.size and np.linalg.cond(equilibrated(M)[0]) > 1 / np.finfo(float).eps)
