"""Modal form of a stable model's frequency response, with a rigorous bound of its error.

    A V = V L + E,    L = diag(p),    F = V^-1 E
    M(v) = C (v I - A)^-1 B + D = C V (v I - L - F)^-1 V^-1 B + D = sum_k R_k / (v - p_k) + D + error

V and p are computed; E is their residual, so any V and p give a valid bound. Let c_k >= |C V e_k|,
b_k >= |e_k' V^-1 B|, |F_kl| <= f_k and d_k >= |C V e_k e_k' V^-1 B - R_k|, rounding included. For any
a_k >= 1 / |v - p_k| with sum a_k f_k < 1, a Neumann series gives

    error <= sum a_k d_k + (sum a_k c_k f_k) (sum a_k b_k) / (1 - sum a_k f_k)

If sum a_k f_k < 1 on the whole axis or circle, no eigenvalue of L + t F, 0 <= t <= 1, crosses it: A is stable if L is.
|V^-1| is bounded with W V = I - G by (I - G)^-1 W (Rump 1999).
"""

from dataclasses import dataclass

import numpy as np
import scipy.linalg
from numpy.typing import NDArray

from synth.statespace import Array, Complex

EPS = float(np.finfo(float).eps)  # twice the largest error of a rounding
MAX_MAGNITUDE = 1e30  # no number is larger, no pole closer to the axis than its inverse: squares do not overflow
INDEPENDENT = 0.1  # largest |I - W V|: above it the eigenvectors count as dependent
UP = 1 + 1e-9  # covers the rounding of the bounds themselves


@dataclass(frozen=True, eq=False)
class Modes:
    """Poles p (n,), residues R (n, p m) and D (p, m); v is on the circle if `sampled`, otherwise on the axis.

    `sizes` (n,) are |R_k|. The columns of `weights` (n, 4) bound the error: d with the rounding of the sum, f, c f and
    b; `floor` is the rounding of D.
    """

    poles: Complex
    residues: Complex
    D: Array
    sampled: bool
    sizes: Array
    weights: Array
    floor: float

    def response(self, Z: Complex) -> Complex:
        """Return sum_k R_k Z_k + D for Z (k, n) as (k, p, m)."""
        return (Z @ self.residues).reshape(len(Z), *self.D.shape) + self.D

    def error(self, a: Array) -> Array:
        """Return a bound (k,) of the error for sizes a (k, n), rounding of the sum included; inf without a bound."""
        spread, drift, left, right = (a @ self.weights).T
        return np.where(drift < 0.5, (spread + 2 * left * right + self.floor) * UP, np.inf)


def of(A: Array, B: Array, C: Array, D: Array, poles: Complex, V: Array, sampled: bool) -> Modes | None:
    """Return the modes of a model with poles (n,) and eigenvectors V (n, n) as `eigen` gives them.

    Returns None if a pole does not decay, a square would overflow or V is nearly singular.
    """
    decay = float((1 - np.abs(poles) if sampled else -poles.real).min())
    if not (decay > (64 * EPS if sampled else 1 / MAX_MAGNITUDE) and _largest(A, B, C, D) < MAX_MAGNITUDE):
        return None
    try:
        W = np.linalg.inv(V)
    except np.linalg.LinAlgError:
        return None
    n, pairs, paired = len(A), np.arange(len(poles)) + np.sign(poles.imag).astype(np.intp), poles.imag != 0
    rounding = (n + 5) * (EPS / 2) * UP  # of sums of n products and a few more terms
    W_size, V_size, other = np.abs(W), np.abs(V), V[:, pairs]
    G = W @ V
    G.flat[:: n + 1] -= 1
    rows = np.abs(G).sum(axis=1) + rounding * (W_size @ V_size.sum(axis=1))
    if not (rows.max() < INDEPENDENT and _largest(W) < MAX_MAGNITUDE):
        return None
    terms = np.abs(A) @ V_size + V_size * np.abs(poles.real) + np.abs(other * poles.imag)
    E = np.abs(A @ V - V * poles.real + other * poles.imag) + rounding * terms
    F = _inverse_bound(W_size @ np.where(paired, E + E[:, pairs], E), rows)
    F = np.where(paired[:, None], (F + F[pairs]) / 2, F)
    drift = F.max(axis=1) * UP + (16 * EPS if sampled else 0.0)
    b, c = W @ B, C @ V
    b_size = np.abs(b)
    db = _inverse_bound(b_size + rounding * (W_size @ np.abs(B)), rows) - b_size + EPS * b_size
    dc = rounding * (np.abs(C) @ V_size)
    return _modes(poles, pairs, (b, db), (c, dc), D, drift, sampled)


def eigen(A: Array) -> tuple[Complex, Array]:
    """Return the poles (n,) of A and its eigenvectors (n, n); a pair of poles has their real and imaginary parts.

    Raises numpy.linalg.LinAlgError when the QR algorithm does not converge.
    """
    if not len(A):
        return np.zeros(0, dtype=np.complex128), A
    real, imag, _, V, failed = scipy.linalg.lapack.dgeev(A, compute_vl=0)
    if failed:
        raise np.linalg.LinAlgError("the eigenvalues of A did not converge")
    return real + 1j * imag, V


def _largest(*matrices: NDArray[np.floating]) -> float:
    return max(float(np.abs(M).max(initial=0.0)) for M in matrices)


def _inverse_bound(X: Array, rows: Array) -> Array:
    """Return a bound of |(I - G)^-1 x| for all |x| <= X (n, k), where |G| has the sums `rows` (n,)."""
    return (X + rows[:, None] * X.max(axis=0, initial=0.0) / (1 - rows.max(initial=0.0))) * UP


def _modes(
    poles: Complex,
    pairs: NDArray[np.intp],
    inputs: tuple[Array, Array],
    outputs: tuple[Array, Array],
    D: Array,
    drift: Array,
    sampled: bool,
) -> Modes:
    """Return the modes from real V^-1 B (n, m) and C V (p, n), each with its error; forms the complex columns.

    The columns x, y of a pair are x + i y and x - i y; the rows x, y of the inverse are (x - i y)/2 and (x + i y)/2.
    """
    (b, db), (c, dc), n, sign = inputs, outputs, len(poles), np.sign(poles.imag)
    paired = sign != 0
    first = np.where(sign < 0, pairs, np.arange(n))
    second = np.where(sign > 0, pairs, np.arange(n))
    half = np.where(paired, 0.5, 1.0)[:, None]
    bc = half * (b[first] - 1j * sign[:, None] * b[second])
    cc = c[:, first] + 1j * sign * c[:, second]
    db = half * (db[first] + paired[:, None] * db[second])
    dc = dc[:, first] + paired * dc[:, second]
    residues = cc.T[:, :, None] * bc[:, None, :]
    beta, gamma = np.linalg.norm(bc, axis=1), np.linalg.norm(cc, axis=0)
    dbeta, dgamma = np.linalg.norm(db, axis=1), np.linalg.norm(dc, axis=0)
    sizes = beta * gamma * UP
    b_size, c_size = (beta + dbeta) * UP, (gamma + dgamma) * UP
    inexact = gamma * dbeta + dgamma * beta + dgamma * dbeta + (2 * n + 24) * EPS * sizes
    floor = 4 * EPS * float(np.linalg.norm(D))
    weights = np.stack([inexact * UP, drift, c_size * drift, b_size], axis=1)
    return Modes(poles, residues.reshape(n, -1), D, sampled, sizes, weights, floor)
