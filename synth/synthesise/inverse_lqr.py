"""The inverse problem of LQR: which diagonal weights give the closed-loop poles that somebody published?

For one input, u = K x optimal for x'Qx + R u^2, open-loop polynomial d(s) and closed-loop polynomial p(s),

    p(s) p(-s) = d(s) d(-s) + (1/R) sum_i q_i n_i(s) n_i(-s),   n_i(s) = e_i' adj(sI - A) B,  Q = diag(q)

(the symmetric root locus). Both sides are even; comparing powers of s^2 gives n linear equations in the n weights. They
are unique when the even polynomials n_i(s) n_i(-s) are linearly independent. Published poles are rounded, so the
weights come out near, not on, the numbers that were used: `reproduces` tells whether given weights round to the print.
LQR never gives poles on the right, and p(s) p(-s) cannot tell s from -s: such poles are refused, and so are weights
below zero.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike
from scipy.optimize import nnls

from synth.errors import ModelError, SignalError
from synth.statespace import Array, StateSpace, readonly
from synth.synthesise import lqr
from synth.timing import Continuous


@dataclass(frozen=True, eq=False)
class DiagonalWeights:
    """The weights q (n,) for R; `unique` unless `nullspace` (n, k) has columns; `residual` is relative."""

    q: Array
    R: float
    unique: bool
    nullspace: Array
    residual: float


def diagonal_weights(model: StateSpace, poles: Sequence[complex], R: float = 1.0) -> DiagonalWeights:
    """Return the diagonal weights whose optimal loop has `poles` (n,) in rad/s, for a continuous model of one input.

    Raises SignalError for a sampled model, several inputs, a wrong count of poles, poles that are not in conjugate
    pairs or an R <= 0; ModelError when no diagonal weights >= 0 give the poles.
    """
    n, m = model.B.shape
    if not isinstance(model.time, Continuous) or m != 1 or len(poles) != n:
        raise SignalError(f"need a continuous model of 1 input and {n} poles: found {model.time}, {m} and {len(poles)}")
    p = _characteristic(poles)
    if R <= 0:
        raise SignalError(f"the weight R is {R}: it must be positive")
    columns = np.array([_even(row) for row in _numerators(model)]).T
    wanted = R * (_even(p) - _even(np.asarray(np.poly(model.A), dtype=np.float64)))[1:]
    scale = np.maximum(np.abs(columns).max(axis=1), np.abs(wanted))
    scale[scale == 0] = 1.0
    U, sigma, Vt = np.linalg.svd(columns / scale[:, None])
    rank = int(np.sum(sigma > 1e-10 * sigma[0]))
    q = Vt[:rank].T @ ((U[:, :rank].T @ (wanted / scale)) / sigma[:rank])
    residual = float(np.linalg.norm((columns @ q - wanted) / scale) / np.linalg.norm(wanted / scale))
    if residual > 1e-8:
        raise ModelError(
            f"no diagonal weights give the poles {list(poles)}: the symmetric root locus is missed by {residual:.2g} "
            "of its size; weight products of states too, or check the poles"
        )
    effect = q * np.abs(columns / scale[:, None]).max(axis=0)
    if effect.min() < -1e-9 and rank < n:
        q, missed = nnls(columns / scale[:, None], wanted / scale)
        effect = np.where(missed <= 1e-8 * np.linalg.norm(wanted / scale), 0.0, effect)
    if effect.min() < -1e-9:
        i = int(np.argmin(effect))
        raise ModelError(
            f"the poles {list(poles)} need the weight {q[i]:.4g} on {model.states[i]}, but LQR takes none below 0: "
            "check the poles, or give them with more digits where that weight should be 0"
        )
    return DiagonalWeights(readonly(q), R, rank == n, readonly(Vt[rank:].T), residual)


def reproduces(
    model: StateSpace, q: ArrayLike, poles: Sequence[complex], digits: Sequence[int], R: float = 1.0
) -> bool:
    """Tell whether the weights give each of `poles` once its parts are rounded to its count of decimals in `digits`."""
    found = list(lqr.lqr(model, np.diag(np.asarray(q, dtype=float)), R * np.eye(1)).poles)
    for pole, places in zip(poles, digits, strict=True):
        nearest = min(found, key=lambda s, at=pole: abs(s - at))  # type: ignore[misc]
        found.remove(nearest)
        half = 0.5 * 10.0**-places * (1 + 1e-9)
        if abs(nearest.real - complex(pole).real) > half or abs(nearest.imag - complex(pole).imag) > half:
            return False
    return True


def _characteristic(poles: Sequence[complex]) -> Array:
    """Return prod (s - pole), highest power first."""
    given = np.asarray(poles, dtype=np.complex128)
    if (given.real >= 0).any():
        raise ModelError(
            f"no weights give the pole {given[given.real >= 0][0]:.4g}: an optimal loop has none with Re >= 0"
        )
    if not np.array_equal(np.sort_complex(given), np.sort_complex(given.conj())):
        raise SignalError(f"the poles {list(poles)} are not in conjugate pairs: give both of each pair")
    return np.real(np.poly(given))


def _numerators(model: StateSpace) -> list[Array]:
    """Return n_i(s), highest power first, length n, from the Faddeev-LeVerrier recursion for adj(sI - A) B."""
    n = len(model.A)
    M, columns = np.eye(n), [model.B[:, 0]]
    for k in range(1, n):
        AM = model.A @ M
        M = AM - np.trace(AM) / k * np.eye(n)
        columns.append(M @ model.B[:, 0])
    return list(np.array(columns).T)


def _even(polynomial: Array) -> Array:
    """Return the coefficients of p(s) p(-s) as a polynomial in s^2, highest power first."""
    mirrored = polynomial * (-1.0) ** np.arange(len(polynomial) - 1, -1, -1)
    return np.convolve(polynomial, mirrored)[::2]
