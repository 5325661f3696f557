"""Bounded-real lemma: a matrix X that proves stability and a bound of the frequency response at all frequencies.

    continuous   H = - [ A'X + X A + C'C    X B + C'D      ]
                       [ B'X + D'C          D'D - g^2 I    ]

    sampled      H = - [ A'X A - X + C'C    A'X B + C'D            ]
                       [ B'X A + D'C        B'X B + D'D - g^2 I    ]

If X > 0 and H > 0, all modes decay and sigma_max(M) < g on the whole axis or circle (Zhou, Doyle, Glover 1996,
corollary 13.24 and theorem 21.12): x'Xx is a storage function for the supply rate g^2 |u|^2 - |y|^2. `is_proof` decides
both rigorously in floating point. It computes H with a bound of its rounding errors, subtracts a bound of the errors of
the Cholesky factorisation from the diagonal, and factorises: success proves positive definiteness (Rump 2006).

`solve` computes X from the stable eigenvectors of the Hamiltonian (Boyd, Balakrishnan, Kabamba 1989)

    [  F   G  ]       F = A + B R^-1 D'C,     G = B R^-1 B',     Q = C'(I + D R^-1 D')C + W,     R = g^2 I - D'D
    [ -Q  -F' ]

The Schur complement of H is then W > 0. With W = 0 the Hamiltonian has the eigenvalue i w where g is a singular value
of the response M(i w). The bilinear transformation of `schur_response` keeps X, so X also serves a sampled model.
"""

from dataclasses import dataclass

import numpy as np

from synth.analyse import twofold
from synth.statespace import Array, Complex

Matrices = tuple[Array, Array, Array, Array]

EPS = float(np.finfo(float).eps)  # twice the largest error of a rounding


@dataclass(frozen=True, eq=False)
class Solution:
    """X (n, n), None if the stable eigenvectors give no basis, and the `eigenvalues` (2 n,) of the Hamiltonian."""

    X: Array | None
    eigenvalues: Complex


def hamiltonian(model: Matrices, level: float, weights: Array | float = 0.0) -> Array:
    """Return the Hamiltonian (2 n, 2 n) of A, B, C, D for a level g above sigma_max(D), W = diag(weights)."""
    A, B, C, D = model
    n = len(A)
    K = np.linalg.solve(level**2 * np.eye(B.shape[1]) - D.T @ D, np.hstack([D.T @ C, B.T]))
    F, G, Q = A + B @ K[:, :n], B @ K[:, n:], C.T @ (C + D @ K[:, :n]) + weights * np.eye(n)
    return np.block([[F, G], [-Q, -F.T]])


def solve(model: Matrices, level: float, weights: Array) -> Solution:
    """Return X for a continuous model, a level g and W = diag(weights) > 0; `is_proof` must confirm it."""
    n = len(model[0])
    if not n:
        return Solution(np.zeros((0, 0)), np.zeros(0, dtype=np.complex128))
    values, vectors = np.linalg.eig(hamiltonian(model, level, weights))
    stable = vectors[:, np.argsort(values.real)[:n]]
    try:
        X = np.linalg.solve(stable[:n].T, stable[n:].T).real
    except np.linalg.LinAlgError:
        return Solution(None, values)
    return Solution((X + X.T) / 2 if np.isfinite(X).all() else None, values)


def is_proof(X: Array, model: Matrices, level: float, continuous: bool) -> bool:
    """Tell whether a symmetric X (n, n) proves, despite rounding, that A, B, C, D is stable and below the level."""
    with np.errstate(all="ignore"):
        H, error = _inequality(X, model, level, continuous)
        return is_positive_definite(X, np.zeros_like(X)) and is_positive_definite(H, error)


def is_positive_definite(H: Array, error: Array) -> bool:
    """Tell whether all symmetric matrices within `error` (n, n), entry by entry, of H (n, n) are positive definite."""
    diagonal, n = np.diagonal(H), len(H)
    if not (np.isfinite(H).all() and np.isfinite(error).all() and (diagonal > 0).all()):
        return False
    scale = 2.0 ** -np.round(np.log2(diagonal) / 2)  # powers of two: nothing is rounded
    H, error = scale[:, None] * H * scale, scale[:, None] * error * scale
    lowered = 2 * (n + 3) * EPS * np.trace(H) + float(error.sum(axis=1).max(initial=0.0)) * (1 + n * EPS)
    try:
        np.linalg.cholesky(H - lowered * np.eye(n))
    except np.linalg.LinAlgError:
        return False
    return True


def _inequality(X: Array, model: Matrices, level: float, continuous: bool) -> tuple[Array, Array]:
    """Return H (n + m, n + m) and a bound of the rounding in each of its entries."""
    A, B, C, D = model
    n, m = B.shape
    J, Y, one = np.hstack([A, B]), np.hstack([C, D]), np.eye(n + m)[:, n:]
    XJ, products = twofold.product(X, J), twofold.product(Y.T, Y) - twofold.product(level * one, level * one.T)
    size = _largest(X, J)
    if continuous:
        upper = twofold.Twofold(_pad_rows(XJ.high, m), _pad_rows(XJ.low, m))
        change, size = upper + upper.T, _pad_rows(size, m) + _pad_rows(size, m).T
    else:
        change = twofold.product(J.T, XJ) - _pad_rows(_pad_rows(X, m).T, m)
        size = 2 * n * np.outer(np.abs(J).max(axis=0, initial=0.0), size.max(axis=0, initial=0.0))
    H = -(change + products).rounded()
    size = size + _largest(Y.T, Y) + level**2 * (one @ one.T)
    terms = max(n, len(Y))
    return (H + H.T) / 2, 2 * EPS * np.abs(H) + 16 * (terms + 4) * EPS * twofold.relative_rounding(terms) * size


def _pad_rows(M: Array, rows: int) -> Array:
    return np.vstack([M, np.zeros((rows, M.shape[1]))])


def _largest(P: Array, Q: Array) -> Array:
    """Return a bound of |P| |Q|: the count of terms times the largest factors."""
    return P.shape[1] * np.outer(np.abs(P).max(axis=1, initial=0.0), np.abs(Q).max(axis=0, initial=0.0))
