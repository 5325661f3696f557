"""Response of a model at many frequencies, from the Schur form A = U T U^H of its balanced A.

    M(s) = C U (s I - T)^-1 U^H B + D

Each frequency costs one triangular solution, all of them at once; other than eigenvectors, U is well conditioned for
every A. A sampled model is taken at s = (z - 1)/(z + 1), where z = exp(i w T) becomes s = i tan(w T / 2), exactly:

    A -> (A + I)^-1 (A - I),   B -> sqrt(2) (A + I)^-1 B,   C -> sqrt(2) C (A + I)^-1,   D -> D - C (A + I)^-1 B

`error` tells how far rounding has moved M, from solutions with residuals in extended precision.
"""

from dataclasses import dataclass

import numpy as np
import scipy.linalg
from numpy.typing import NDArray

from synth.statespace import Array, StateSpace
from synth.timing import Continuous

Complex = NDArray[np.complex128]


@dataclass(frozen=True, eq=False)
class Response:
    """A, B, C, D in the warped and balanced states, the Schur form (T, U) of A, and the `model` that they are of.

    Frequencies are those of s: w in rad/s for a continuous model, tan(w T / 2) for a sampled one.
    """

    A: Array
    B: Array
    C: Array
    D: Array
    T: Complex
    U: Complex
    model: StateSpace

    @property
    def poles(self) -> Complex:
        """Eigenvalues of A."""
        return np.asarray(np.diagonal(self.T))

    @property
    def size(self) -> float:
        """The largest modulus of a pole, 1 without poles."""
        return float(np.abs(self.poles).max(initial=0.0)) or 1.0

    def at(self, frequencies: Array) -> Complex:
        """Return M (k, p, m) at frequencies (k,) of s, inf among them."""
        w, n = np.where(np.isinf(frequencies), 0.0, frequencies), len(self.A)
        right, count = self.U.conj().T @ self.B, len(w)
        p, m = self.D.shape
        X = np.empty((n, m, count), dtype=np.complex128)
        for i in range(n - 1, -1, -1):
            carried = (self.T[i, i + 1 :] @ X[i + 1 :].reshape(n - 1 - i, m * count)).reshape(m, count)
            X[i] = (right[i][:, None] + carried) / (1j * w - self.T[i, i])
        moving = ((self.C @ self.U) @ X.reshape(n, m * count)).reshape(p, m, count).transpose(2, 0, 1)
        return np.asarray(self.D + np.where(np.isinf(frequencies)[:, None, None], 0.0, moving))

    def unwarped(self, frequencies: Array) -> Array:
        """Return frequencies of s in rad/s of the model's own time."""
        if isinstance(self.model.time, Continuous):
            return frequencies
        return np.asarray(2 / self.model.time.period_s * np.arctan(frequencies))

    def error(self, frequency: float) -> Complex:
        """Return by how much M (p, m) at a frequency of s differs from that of the model as it was given."""
        A, B, C, D = (getattr(self.model, letter).astype(np.longdouble) for letter in "ABCD")
        continuous = isinstance(self.model.time, Continuous)
        if not len(A) or (continuous and np.isinf(frequency)):
            return np.zeros(D.shape, dtype=np.complex128)
        s = 1j * np.longdouble(frequency) if np.isfinite(frequency) else np.clongdouble(0)
        point = s if continuous else (1 + s) / (1 - s) if np.isfinite(frequency) else np.clongdouble(-1)
        resolvent = point * np.eye(len(A)) - A
        inverse = np.linalg.inv(resolvent.astype(np.complex128))
        X = np.zeros(B.shape, dtype=np.clongdouble)
        for _ in range(4):
            X = X + inverse @ (B - resolvent @ X).astype(np.complex128)
        return np.asarray(self.at(np.array([frequency]))[0] - (C @ X + D), dtype=np.complex128)


def of(model: StateSpace) -> Response:
    """Return the response of a model none of whose poles is at z = -1."""
    A, B, C, D = model.A, model.B, model.C, model.D
    if not isinstance(model.time, Continuous):
        A, B, C = _balanced(A, B, C)
        one, root = np.eye(len(A)), np.sqrt(2)
        inverse = np.linalg.inv(A + one)
        A, B, C, D = inverse @ (A - one), root * inverse @ B, root * C @ inverse, D - C @ inverse @ B
    A, B, C = _balanced(A, B, C)
    if not len(A):
        return Response(A, B, C, D, A.astype(np.complex128), A.astype(np.complex128), model)
    T, U = scipy.linalg.schur(A, output="complex", check_finite=False)
    return Response(A, B, C, D, T, U, model)


def _balanced(A: Array, B: Array, C: Array) -> tuple[Array, Array, Array]:
    """Return A, B, C in states scaled so that rows and columns of A are of like size."""
    if not len(A):
        return A, B, C
    A, (scale, _) = scipy.linalg.matrix_balance(A, permute=False, separate=True)
    return A, B / scale[:, None], C * scale
