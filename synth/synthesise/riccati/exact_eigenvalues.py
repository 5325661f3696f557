"""Eigenvalues of an exactly given matrix in ball arithmetic, and the stability of its modes beyond rounding error.

The eigenvalues of a matrix of doubles are computed in the precision in force and rounded once. This includes those of a
Jordan block, which double precision scatters by a root of its precision. The only error left is that of rounding the
matrix itself.
"""

import flint
import numpy as np
from numpy.typing import NDArray

from synth.analyse import discretise
from synth.analyse.numerics import precise
from synth.analyse.structure import structure
from synth.statespace import Array, Complex
from synth.timing import Continuous, Time


def ball(values: Array) -> flint.arb_mat:
    """Return the doubles of a matrix, exactly, also of one without rows or columns."""
    return precise.matrix(values) if values.size else flint.arb_mat(*values.shape)


def decays(poles: Complex, time: Time) -> NDArray[np.bool_]:
    """Tell for each pole whether its mode decays by more than rounding error."""
    if isinstance(time, Continuous):
        return poles.real < -structure.DECAY * np.abs(poles).max(initial=0.0)
    return np.abs(poles) < 1 - structure.DECAY


def unstable_pole(A: Array, time: Time) -> complex | None:
    """Return the fastest growing eigenvalue of A (n, n) of those that do not decay, None where all decay.

    An eigenvalue counts as not decaying if rounding of A may stop its decay: Re s >= -DECAY |w|' |A|, with the unit
    left eigenvector w of the balanced A, or |z| >= 1 - DECAY. A slow mode is thus not compared with the fast ones.
    """
    if not len(A):
        return None
    D = discretise.balancing(A)
    balanced = A * D / D[:, None]
    values, w = np.linalg.eig(balanced.T)
    return _fastest_growing(values, w, balanced, time)


def exact_unstable_pole(F: flint.arb_mat, time: Time) -> complex | None:
    """Return the pole of `unstable_pole`, computed in the precision in force."""
    if not F.nrows():
        return None
    A = precise.rounded(F)
    D = discretise.balancing(A)
    balanced = precise.matrix(np.diag(1 / D)) * F * precise.matrix(np.diag(D))
    values, left = flint.acb_mat(balanced).eig(left=True, algorithm="approx")
    w = np.array([[complex(v) for v in row] for row in left.tolist()]).T
    poles = np.array([_without_rounding(complex(v)) for v in values])
    return _fastest_growing(poles, _with_unit_columns(w), A * D / D[:, None], time)


def _with_unit_columns(w: Complex) -> Complex:
    """Return unit columns, and ones, which no unit vector exceeds, for a column that a Jordan block leaves open."""
    with np.errstate(invalid="ignore", over="ignore", divide="ignore"):
        unit = w / np.linalg.norm(w, axis=0)
    return np.where(np.isfinite(unit).all(axis=0), unit, 1.0 + 0j)


def _fastest_growing(values: Complex, w: Complex, balanced: Array, time: Time) -> complex | None:
    """Return the value that grows fastest, None where all decay; w (n, n) has the unit left eigenvectors as columns."""
    if isinstance(time, Continuous):
        growth = values.real + structure.DECAY * np.linalg.norm(np.abs(w).T @ np.abs(balanced), axis=1)
    else:
        growth = np.abs(values) - 1 + structure.DECAY
    return complex(values[np.argmax(growth)]) if growth.max() >= 0 else None


def eigenvalues(F: flint.arb_mat) -> Complex:
    """Return the eigenvalues (n,) of a square matrix, sorted, computed in the precision in force, rounded once."""
    if not F.nrows():
        return np.zeros(0, dtype=np.complex128)
    values = flint.acb_mat(F).eig(algorithm="approx")
    return np.sort_complex(np.array([_without_rounding(complex(v)) for v in values], dtype=np.complex128))


def _without_rounding(value: complex) -> complex:
    """Return a value whose real or imaginary part is 0 where it is rounding error of the other."""
    least = 1e-30 * abs(value)
    real, imaginary = (v if abs(v) > least else 0.0 for v in (value.real, value.imag))
    return complex(real, imaginary)
