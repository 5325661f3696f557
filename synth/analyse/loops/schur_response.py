"""Frequency response at many frequencies, from the Schur form A = U T U' of the balanced A (`synth.resolvent`).

    M(s) = C U (s I - T)^-1 U' B + D

Unlike eigenvectors, U is well conditioned for every A. For a sampled model, the bilinear transformation
s = (z - 1)/(z + 1) maps z = exp(i w T) exactly to s = i tan(w T / 2):

    A -> (A + I)^-1 (A - I),   B -> sqrt(2) (A + I)^-1 B,   C -> sqrt(2) C (A + I)^-1,   D -> D - C (A + I)^-1 B

`error` gives the rounding error of M, from solutions with residuals in extended precision.
"""

from dataclasses import dataclass

import numpy as np

from synth import resolvent
from synth.statespace import Array, Complex, StateSpace
from synth.timing import Continuous


@dataclass(frozen=True, eq=False)
class Response:
    """A, B, C, D after the bilinear transformation and balancing, the Schur `form` of A, and the original `model`.

    Frequencies are those of s: w in rad/s for a continuous model, tan(w T / 2) for a sampled one.
    """

    A: Array
    B: Array
    C: Array
    D: Array
    form: resolvent.Schur
    model: StateSpace

    @property
    def poles(self) -> Complex:
        """Eigenvalues of A."""
        return self.form.poles

    @property
    def size(self) -> float:
        """The largest modulus of a pole, 1 without poles."""
        return float(np.abs(self.poles).max(initial=0.0)) or 1.0

    def at(self, frequencies: Array) -> Complex:
        """Return M (k, p, m) at frequencies (k,) of s, which may include inf."""
        w, U = np.where(np.isinf(frequencies), 0.0, frequencies), self.form.U
        Z = self.form.solve(1j * w, (U.T @ self.B)[:, :, None])
        strictly_proper = np.tensordot(self.C @ U, Z, 1).transpose(2, 0, 1)
        return np.asarray(self.D + np.where(np.isinf(frequencies)[:, None, None], 0.0, strictly_proper))

    def unwarped(self, frequencies: Array) -> Array:
        """Return w in rad/s for frequencies of s."""
        if isinstance(self.model.time, Continuous):
            return frequencies
        return np.asarray(2 / self.model.time.period_s * np.arctan(frequencies))

    def error(self, frequency: float) -> Complex:
        """Return the error of M (p, m) at a frequency of s, relative to the original model."""
        A, B, C, D = (getattr(self.model, letter).astype(np.longdouble) for letter in "ABCD")
        continuous = isinstance(self.model.time, Continuous)
        if not len(A) or (continuous and np.isinf(frequency)):
            return np.zeros(D.shape, dtype=np.complex128)
        s = 1j * np.longdouble(frequency) if np.isfinite(frequency) else np.clongdouble(0)
        point = s if continuous else (1 + s) / (1 - s) if np.isfinite(frequency) else np.clongdouble(-1)
        pencil = point * np.eye(len(A)) - A
        inverse = np.linalg.inv(pencil.astype(np.complex128))
        X = np.zeros(B.shape, dtype=np.clongdouble)
        for _ in range(4):
            X = X + inverse @ (B - pencil @ X).astype(np.complex128)
        return np.asarray(self.at(np.array([frequency]))[0] - (C @ X + D), dtype=np.complex128)


def of(model: StateSpace) -> Response:
    """Return the response of a model without a pole at z = -1."""
    A, B, C, D = model.A, model.B, model.C, model.D
    if not isinstance(model.time, Continuous):
        A, B, C, D = bilinear(*resolvent.balanced(A, B, C), D)
    A, B, C = resolvent.balanced(A, B, C)
    return Response(A, B, C, D, resolvent.schur(A), model)


def bilinear(A: Array, B: Array, C: Array, D: Array) -> tuple[Array, Array, Array, Array]:
    """Return A, B, C, D in s = (z - 1)/(z + 1) from those in z, which have no pole at z = -1."""
    one, root = np.eye(len(A)), np.sqrt(2)
    inverse = np.linalg.inv(A + one)
    return inverse @ (A - one), root * inverse @ B, root * C @ inverse, D - C @ inverse @ B
