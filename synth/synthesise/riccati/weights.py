"""Weights and covariances by name: a symmetric matrix (n, n), its diagonal (n,), or {signal: diagonal entry}.

Definiteness must not depend on units: M is tested as D M D, whose diagonal is 1 where that of M is above 0.

Poles as a table of modes: frequency |s| / (2 pi) and damping -Re s / |s|, with s = log(z) / T where sampled.
"""

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from synth import arguments, show
from synth.errors import SignalError
from synth.statespace import Array
from synth.timing import Discrete, Time

DEADBEAT = 2.0**-42  # a single pole |z| below it is the rounding error of 0


def table(poles: NDArray[np.complex128], time: Time) -> show.Table:
    """Return a table of poles in 1/s or in z with their natural frequency in Hz and their damping.

    A pole at z = 0 is deadbeat and has no frequency; a constant, s = 0 or z = 1, has no damping. Rounding scatters k
    poles at z = 0 by the k-th root of its size; such a cluster is also deadbeat.
    """
    sampled = isinstance(time, Discrete)
    radius = _deadbeat_radius(poles) if sampled else -1.0
    rows = ((show.number(p), *(("deadbeat", "-") if abs(p) <= radius else _shape(p, time))) for p in poles)
    return show.Table("", ("pole, z" if sampled else "pole [1/s]", "f [Hz]", "damping"), tuple(rows))


def _deadbeat_radius(poles: NDArray[np.complex128]) -> float:
    sizes = np.sort(np.abs(poles))
    radius = DEADBEAT ** (1 / np.arange(1, len(sizes) + 1))
    return float(radius[sizes <= radius].max(initial=0.0))


def _shape(pole: complex, time: Time) -> tuple[str, str]:
    s = np.log(complex(pole)) / time.period_s if isinstance(time, Discrete) else pole
    return show.number(abs(s) / (2 * np.pi)), show.number(-s.real / abs(s)) if s else "-"


Weight = ArrayLike | Mapping[str, float]

ROUNDING = 1e-12  # of the unit diagonal: an eigenvalue this far below zero is the rounding error of zero
ASYMMETRY = 2.0**-50  # of M_ij and sqrt(M_ii M_jj), times n: a smaller M_ij - M_ji is the rounding error of a product
# Of the unit diagonal, times n: an eigenvalue below it may be the rounding error of zero.
EIGENVALUE_ROUNDING = 2.0**-50


def symmetric(what: str, value: Weight, names: Sequence[str]) -> Array:
    """Return the weight called `what` on the signals `names` (n,) as a symmetric matrix (n, n).

    A mapping gives the diagonal by name, 0 for missing names. An asymmetry within rounding, as of a product C'WC, is
    removed by taking the mean.

    Raises SignalError for an unknown name, a wrong shape, an entry that is not finite, or an asymmetric matrix.
    """
    matrix = (
        _by_name(what, value, names)
        if isinstance(value, Mapping)
        else arguments.real(f"entries of the weight {what}", value)
    )
    n = len(names)
    if matrix.shape == (n,):
        matrix = np.diag(matrix)
    if matrix.shape != (n, n):
        raise SignalError(f"the matrix {what} is {matrix.shape}: give {(n, n)}, its diagonal or a weight by name")
    if not np.isfinite(matrix).all():
        i, j = np.argwhere(~np.isfinite(matrix))[0]
        raise SignalError(f"the matrix {what} has {matrix[i, j]} for {names[i]}, {names[j]}: give finite numbers")
    matrix = _without_rounding(matrix)
    if not np.array_equal(matrix, matrix.T):
        i, j = np.argwhere(matrix != matrix.T)[0]
        raise SignalError(
            f"the matrix {what} is not symmetric: [{i}, {j}] is {matrix[i, j]}, [{j}, {i}] is {matrix[j, i]}; "
            "give (M + M') / 2"
        )
    return matrix


def semidefinite(what: str, value: Weight, names: Sequence[str]) -> Array:
    """Return the weight as `symmetric` does; also raise SignalError when it has an eigenvalue below 0."""
    matrix = symmetric(what, value, names)
    if not is_above(matrix, -ROUNDING):
        lowest = lowest_eigenvalue(matrix)
        raise SignalError(f"the matrix {what} has the eigenvalue {lowest:.3g}: it must be positive semidefinite")
    return matrix


def definite(what: str, value: Weight, names: Sequence[str]) -> Array:
    """Return the weight as `symmetric` does; also raise SignalError when it has an eigenvalue of 0 or below.

    An eigenvalue that is 0 within rounding is also refused.
    """
    matrix = symmetric(what, value, names)
    if not is_above(matrix, EIGENVALUE_ROUNDING * len(matrix)):
        lowest = lowest_eigenvalue(matrix)
        raise SignalError(
            f"the matrix {what} has the eigenvalue {lowest:.3g}: it must be positive definite beyond rounding; weight "
            f"each of {', '.join(names)}"
        )
    return matrix


def cross(what: str, value: ArrayLike | None, rows: Sequence[str], columns: Sequence[str]) -> Array:
    """Return a cross weight (n, m) between two lists of signals, 0 for None.

    Raises SignalError for another shape or an entry that is not finite.
    """
    shape = (len(rows), len(columns))
    matrix = np.zeros(shape) if value is None else arguments.real(f"entries of the weight {what}", value)
    if matrix.shape != shape or not np.isfinite(matrix).all():
        raise SignalError(
            f"the cross weight {what} is {matrix.shape}: {shape[0]} states and {shape[1]} inputs need a finite one of "
            f"{shape}"
        )
    return matrix


def joint_weight(Q: Array, R: Array, N: Array) -> Array:
    """Return [Q, N; N', R] (n + m, n + m) of Q (n, n), R (m, m), N (n, m)."""
    return np.concatenate([np.concatenate([Q, N], axis=1), np.concatenate([N.T, R], axis=1)])


def is_above(matrix: Array, least: float) -> bool:
    """Tell whether all eigenvalues of a symmetric matrix (n, n), scaled to a unit diagonal, are above `least`."""
    scaled = unit_diagonal(matrix)
    scaled.flat[:: len(scaled) + 1] -= least
    try:
        np.linalg.cholesky(scaled)
    except np.linalg.LinAlgError:
        return False
    return True


def lowest_eigenvalue(matrix: Array) -> float:
    """Return the lowest eigenvalue; if it is within rounding of 0, that of the matrix with unit diagonal."""
    values = np.linalg.eigvalsh(matrix)
    if abs(values[0]) > ROUNDING * np.abs(values).max():
        return float(values[0])
    return float(np.linalg.eigvalsh(unit_diagonal(matrix))[0])


def least_eigenvalue(matrix: Array) -> float:
    """Return the least eigenvalue of a symmetric matrix scaled to a unit diagonal, 0 if it is rounding error."""
    least = float(np.linalg.eigvalsh(unit_diagonal(matrix))[0])
    return 0.0 if abs(least) <= ROUNDING else least


def unit_diagonal(matrix: Array) -> Array:
    """Return D M D of a symmetric M (n, n); its diagonal is the sign of that of M."""
    diagonal = np.abs(np.diag(matrix))
    root = np.sqrt(np.where(diagonal > 0, diagonal, 1.0))
    return np.asarray(matrix / root / root[:, None])


def is_regular(matrix: Array) -> bool:
    """Tell whether a symmetric matrix (n, n), scaled to a unit diagonal, is regular beyond rounding error."""
    return bool(np.abs(np.linalg.eigvalsh(unit_diagonal(matrix))).min() > EIGENVALUE_ROUNDING * len(matrix))


def _without_rounding(matrix: Array) -> Array:
    """Return a square matrix with the mean of M_ij and M_ji where they differ by no more than rounding error."""
    root = np.sqrt(np.abs(np.diag(matrix)))
    largest = np.maximum(np.abs(matrix), root * root[:, None])
    close = np.abs(matrix - matrix.T) <= ASYMMETRY * len(matrix) * np.maximum(largest, largest.T)
    return np.where(close & (matrix != matrix.T), matrix / 2 + matrix.T / 2, matrix)


def _by_name(what: str, value: Mapping[str, float], names: Sequence[str]) -> Array:
    """Return the diagonal (n,)."""
    if unknown := [name for name in value if name not in names]:
        raise SignalError(f"the weight {what} names '{unknown[0]}', which is not one of {', '.join(names)}")
    diagonal = np.zeros(len(names))
    for k, name in enumerate(names):
        entry = arguments.real(f"entries of the weight {what} of '{name}'", value.get(name, 0.0))
        if entry.ndim:
            raise SignalError(f"the weight {what} of '{name}' has shape {entry.shape}: give a number")
        diagonal[k] = entry
    return diagonal
