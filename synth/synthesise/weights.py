"""Weights and covariances by name: a symmetric matrix (n, n), its diagonal (n,), or {signal: diagonal entry}."""

from collections.abc import Mapping, Sequence

import numpy as np
import scipy.linalg
from numpy.typing import ArrayLike

from synth.errors import SignalError
from synth.statespace import Array

Weight = ArrayLike | Mapping[str, float]

ROUNDING = 1e-12  # of the largest eigenvalue: an eigenvalue this far below zero is the rounding error of a zero


def symmetric(what: str, value: Weight, names: Sequence[str]) -> Array:
    """Return the weight called `what` on the signals `names` (n,) as a symmetric matrix (n, n).

    A mapping gives the diagonal by name, 0 where a name is left out.

    Raises SignalError for a name that is not known, a wrong shape, an entry that is not finite, or an asymmetric
    matrix.
    """
    if isinstance(value, Mapping):
        if unknown := [name for name in value if name not in names]:
            raise SignalError(f"the weight {what} names '{unknown[0]}', which is not one of {', '.join(names)}")
        value = [float(value.get(name, 0.0)) for name in names]
    matrix = np.asarray(value, dtype=np.float64)
    n = len(names)
    if matrix.shape == (n,):
        matrix = np.diag(matrix)
    if matrix.shape != (n, n):
        raise SignalError(f"the matrix {what} is {matrix.shape}: give {(n, n)}, its diagonal or a weight by name")
    if not np.isfinite(matrix).all():
        i, j = np.argwhere(~np.isfinite(matrix))[0]
        raise SignalError(f"the matrix {what} has {matrix[i, j]} for {names[i]}, {names[j]}: give finite numbers")
    if not np.array_equal(matrix, matrix.T):
        i, j = np.argwhere(matrix != matrix.T)[0]
        raise SignalError(
            f"the matrix {what} is not symmetric: [{i}, {j}] is {matrix[i, j]}, [{j}, {i}] is {matrix[j, i]}; "
            "give (M + M') / 2"
        )
    return matrix


def semidefinite(what: str, value: Weight, names: Sequence[str]) -> Array:
    """Return the weight as `symmetric` does; raise SignalError, too, when it has an eigenvalue below 0."""
    matrix = symmetric(what, value, names)
    lowest, size = _lowest(matrix)
    if lowest < -ROUNDING * size:
        raise SignalError(f"the matrix {what} has the eigenvalue {lowest:.3g}: it must be positive semidefinite")
    return matrix


def definite(what: str, value: Weight, names: Sequence[str]) -> Array:
    """Return the weight as `symmetric` does; raise SignalError, too, when it has an eigenvalue of 0 or below."""
    matrix = symmetric(what, value, names)
    lowest, _ = _lowest(matrix)
    if lowest <= 0:
        raise SignalError(
            f"the matrix {what} has the eigenvalue {lowest:.3g}: it must be positive definite; weight each of "
            f"{', '.join(names)}"
        )
    return matrix


def _lowest(matrix: Array) -> tuple[float, float]:
    """Return the lowest eigenvalue of a symmetric matrix and the largest absolute one."""
    values = scipy.linalg.eigvalsh(matrix) if len(matrix) else np.zeros(1)
    return float(values[0]), float(np.abs(values).max())
