"""The eigenvalues of a matrix given exactly, and which of them decay, by more than rounding error.

Eigenvalues of a matrix of doubles are computed with the bits in force and rounded once: also those of a Jordan block,
which double precision scatters by a root of its precision. What is left to see is what rounding the matrix did.
"""

import flint
import numpy as np
from numpy.typing import NDArray

from synth.analyse import discretise, precise, structure
from synth.statespace import Array, Complex
from synth.timing import Continuous, Time


def ball(values: Array) -> flint.arb_mat:
    """Return the doubles of a matrix, exactly, also of one without rows or columns."""
    return precise.matrix(values) if values.size else flint.arb_mat(*values.shape)


def decays(poles: Complex, time: Time) -> NDArray[np.bool_]:
    """Tell of each pole whether its mode decays, by more than rounding error."""
    if isinstance(time, Continuous):
        return poles.real < -structure.DECAY * np.abs(poles).max(initial=0.0)
    return np.abs(poles) < 1 - structure.DECAY


def lasting(A: Array, time: Time) -> complex | None:
    """Return the eigenvalue of A (n, n) that grows fastest of those that do not decay, None where all do.

    Counted as not decaying is what rounding of A may hold up: Re s >= -DECAY |w|' |A|, w the left eigenvector of length
    1 in units that balance A, so that a slow mode beside fast ones is judged by its own size; |z| >= 1 - DECAY.
    """
    if not len(A):
        return None
    D = discretise.balancing(A)
    balanced = A * D / D[:, None]
    values, w = np.linalg.eig(balanced.T)
    if isinstance(time, Continuous):
        growth = values.real + structure.DECAY * np.linalg.norm(np.abs(w).T @ np.abs(balanced), axis=1)
    else:
        growth = np.abs(values) - 1 + structure.DECAY
    return complex(values[np.argmax(growth)]) if growth.max() >= 0 else None


def of(F: flint.arb_mat) -> Complex:
    """Return the eigenvalues (n,) of a square matrix, sorted, computed in the precision in force, rounded once."""
    if not F.nrows():
        return np.zeros(0, dtype=np.complex128)
    values = flint.acb_mat(F).eig(algorithm="approx")
    return np.sort_complex(np.array([_tidy(complex(v)) for v in values], dtype=np.complex128))


def _tidy(value: complex) -> complex:
    """Return a value without a part that the precision leaves beside the other."""
    least = 1e-30 * abs(value)
    real, imaginary = (v if abs(v) > least else 0.0 for v in (value.real, value.imag))
    return complex(real, imaginary)
