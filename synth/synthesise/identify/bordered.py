"""QR and SVD of a block-bordered Jacobian: parameters shared by all rows, and parameters of groups of rows.

    J = [ A_1  B_1           ]      s groups of L rows, p outputs each: A_g (L p, k), B_g (L p, f)
        [ A_2      B_2       ]
        [ ...           ...  ]

The parameters of the groups are eliminated group by group, B_g = Q_g S_g V_g'. The shared parameters are determined by
P = A - Q Q'A = U S V' alone (Frisch, Waugh 1933); [U, Q] is a basis of the range of J. The singular values are those of
J with columns of length 1.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from synth.statespace import Array


@dataclass(frozen=True, eq=False)
class Jacobian:
    """The derivatives A (N, p, k) by the shared parameters and B (s, L, p, f) by those of the groups, N = s L."""

    shared: Array
    group: Array

    @property
    def parameters(self) -> int:
        """The number of all parameters, k + s f."""
        return self.shared.shape[2] + self.group.shape[0] * self.group.shape[3]

    def weighted(self, deviation: Array) -> "Jacobian":
        """Return the derivatives of the outputs divided by `deviation` (p,)."""
        return Jacobian(self.shared / deviation[:, None], self.group / deviation[:, None])

    def parameters_per_output(self) -> Array:
        """Return an upper bound of the number of parameters on which each output (p,) depends."""
        each = np.minimum(self.group.shape[1], self.group.any(axis=1).sum(axis=2)).sum(axis=0)
        return np.asarray(self.shared.any(axis=0).sum(axis=1) + each)


@dataclass(frozen=True, eq=False)
class Factors:
    """U (N p, k), sigma (k,), V (k, k) of P; Q (s, L p, f), group_sigma (s, f), group_V (s, f, f) of B; cross = Q'A.

    cross is (s f, k). `size` (k,) and `group_size` (s, f) are the lengths of J's columns; A and B are divided by them.
    """

    U: Array
    sigma: Array
    V: Array
    size: Array
    Q: Array
    group_sigma: Array
    group_V: Array
    group_size: Array
    cross: Array

    def group_components(self, e: Array) -> Array:
        """Return Q'e (s, f) of e (N p,)."""
        return np.einsum("srf,sr->sf", self.Q, e.reshape(self.Q.shape[:2]))

    def outside_range(self, e: Array) -> Array:
        """Return the component of e (N p,) outside the range of J."""
        e = e - np.einsum("srf,sf->sr", self.Q, self.group_components(e)).ravel()
        return e - self.U @ (self.U.T @ e)

    def step(self, e: Array, damping: float, kept: NDArray[np.bool_]) -> tuple[Array, Array]:
        """Return the solution d, (k,) and (s, f), of (J'J + m D^2) d = J'e, D the lengths of the columns of J."""
        faded = np.sqrt(damping / (self.group_sigma**2 + damping)).ravel()
        q = self.group_components(e)
        rows = [
            (self.sigma[:, None] * self.V.T)[kept],
            faded[:, None] * self.cross,
            np.sqrt(damping) * np.eye(len(self.V)),
        ]
        right = [(self.U.T @ e)[kept], faded * q.ravel(), np.zeros(len(self.V))]
        shared = np.linalg.lstsq(np.concatenate(rows), np.concatenate(right), rcond=None)[0]
        left = (q - (self.cross @ shared).reshape(q.shape)) * self.group_sigma / (self.group_sigma**2 + damping)
        return shared / self.size, np.einsum("sfg,sg->sf", self.group_V, left) / self.group_size


def of(J: "Array | Jacobian") -> Jacobian:
    """Return derivatives (N, p, k) by shared parameters as a Jacobian of one group without further parameters."""
    return J if isinstance(J, Jacobian) else Jacobian(np.asarray(J), np.zeros((1, *np.shape(J)[:2], 0)))


def factors(J: Jacobian) -> Factors:
    """Return the factors of a Jacobian."""
    (groups, length, p, f), k = J.group.shape, J.shared.shape[2]
    A, B = J.shared.reshape(groups * length * p, k), J.group.reshape(groups, length * p, f)
    size, group_size = (_positive(np.linalg.norm(part, axis=-2)) for part in (A, B))
    A = A / size
    Q, group_sigma, group_V = np.linalg.svd(B / group_size[:, None], full_matrices=False)
    cross = np.einsum("srf,srk->sfk", Q, A.reshape(groups, length * p, k))
    U, sigma, V = np.linalg.svd(A - np.einsum("srf,sfk->srk", Q, cross).reshape(A.shape), full_matrices=False)
    group_V = group_V.transpose(0, 2, 1)
    return Factors(U, sigma, V.T, size, Q, group_sigma, group_V, group_size, cross.reshape(groups * f, k))


def _positive(size: Array) -> Array:
    return np.where(size > 0, size, 1.0)
