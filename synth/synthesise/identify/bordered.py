"""Derivatives of N rows by parameters that all rows share, and by those that only a group of rows has.

    J = [ A_1  B_1           ]      s groups of L rows, p outputs each: A_g (L p, k), B_g (L p, f)
        [ A_2      B_2       ]
        [ ...           ...  ]

The groups' own parameters are taken out group by group: B_g = Q_g S_g V_g', and the shared ones are determined by
P = A - Q Q'A alone, of which P = U S V' (Frisch, Waugh 1933); [U, Q] is a basis of J's range. All singular values are
those of columns of J of length 1.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from synth.statespace import Array


@dataclass(frozen=True, eq=False)
class Jacobian:
    """The derivatives A (N, p, k) by what is shared and B (s, L, p, f) by what each of the groups has, N = s L."""

    shared: Array
    own: Array

    @property
    def parameters(self) -> int:
        """The number of all parameters, k + s f."""
        return self.shared.shape[2] + self.own.shape[0] * self.own.shape[3]

    def weighted(self, weight: Array) -> "Jacobian":
        """Return the derivatives of the outputs divided by `weight` (p,)."""
        return Jacobian(self.shared / weight[:, None], self.own / weight[:, None])

    def acting(self) -> Array:
        """Return how many parameters at most determine each output (p,)."""
        each = np.minimum(self.own.shape[1], self.own.any(axis=1).sum(axis=2)).sum(axis=0)
        return np.asarray(self.shared.any(axis=0).sum(axis=1) + each)


@dataclass(frozen=True, eq=False)
class Factors:
    """U (N p, k), sigma (k,), V (k, k) of P; Q (s, L p, f), own_sigma (s, f), own_V (s, f, f) of B; cross = Q'A.

    cross is (s f, k). `size` (k,) and `own_size` (s, f) are the lengths of J's columns; A and B are divided by them.
    """

    U: Array
    sigma: Array
    V: Array
    size: Array
    Q: Array
    own_sigma: Array
    own_V: Array
    own_size: Array
    cross: Array

    def along(self, e: Array) -> Array:
        """Return Q'e (s, f) of e (N p,)."""
        return np.einsum("srf,sr->sf", self.Q, e.reshape(self.Q.shape[:2]))

    def rest(self, e: Array) -> Array:
        """Return what of e (N p,) is outside the range of J."""
        e = e - np.einsum("srf,sf->sr", self.Q, self.along(e)).ravel()
        return e - self.U @ (self.U.T @ e)

    def step(self, e: Array, damping: float, kept: NDArray[np.bool_]) -> tuple[Array, Array]:
        """Return the d, shared (k,) and own (s, f), that solves (J'J + m D^2) d = J'e, D the lengths of J's columns."""
        faded = np.sqrt(damping / (self.own_sigma**2 + damping)).ravel()
        q = self.along(e)
        rows = [
            (self.sigma[:, None] * self.V.T)[kept],
            faded[:, None] * self.cross,
            np.sqrt(damping) * np.eye(len(self.V)),
        ]
        right = [(self.U.T @ e)[kept], faded * q.ravel(), np.zeros(len(self.V))]
        shared = np.linalg.lstsq(np.concatenate(rows), np.concatenate(right), rcond=None)[0]
        left = (q - (self.cross @ shared).reshape(q.shape)) * self.own_sigma / (self.own_sigma**2 + damping)
        return shared / self.size, np.einsum("sfg,sg->sf", self.own_V, left) / self.own_size


def of(J: "Array | Jacobian") -> Jacobian:
    """Return derivatives (N, p, k) by shared parameters alone as a Jacobian of one group without its own."""
    return J if isinstance(J, Jacobian) else Jacobian(np.asarray(J), np.zeros((1, *np.shape(J)[:2], 0)))


def factors(J: Jacobian) -> Factors:
    """Return the factors of a Jacobian."""
    (groups, length, p, f), k = J.own.shape, J.shared.shape[2]
    A, B = J.shared.reshape(groups * length * p, k), J.own.reshape(groups, length * p, f)
    size, own_size = (_positive(np.linalg.norm(part, axis=-2)) for part in (A, B))
    A = A / size
    Q, own_sigma, own_V = np.linalg.svd(B / own_size[:, None], full_matrices=False)
    cross = np.einsum("srf,srk->sfk", Q, A.reshape(groups, length * p, k))
    U, sigma, V = np.linalg.svd(A - np.einsum("srf,sfk->srk", Q, cross).reshape(A.shape), full_matrices=False)
    own_V = own_V.transpose(0, 2, 1)
    return Factors(U, sigma, V.T, size, Q, own_sigma, own_V, own_size, cross.reshape(groups * f, k))


def _positive(size: Array) -> Array:
    return np.where(size > 0, size, 1.0)
