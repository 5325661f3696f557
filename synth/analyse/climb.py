"""Newton's method for a local maximum of the largest singular value of a matrix M(w) with known derivatives.

    sigma' = Re u^H M' v,     sigma'' = Re u^H M'' v + the coupling through M' to the other singular vectors

where u, v are the singular vectors at w.
"""

from collections.abc import Callable

import numpy as np

from synth.statespace import Array, Complex

Derivatives = Callable[[float], tuple[Complex, Complex, Complex]]

STEPS = 8
TINY = 1e-300
MIN_NEWTON_GAIN = 1e-5  # relative gain below which no further step follows: that would gain about its square
CONVERGENCE_TOLERANCE = 1e-9  # relative gain below which the climb ends


def local_maximum(derivatives: Derivatives, w: float) -> tuple[float, float]:
    """Return the local maximum of sigma_max near w and its location; `derivatives(w)` returns M, M', M'' (p, m)."""
    value, step, gain = _newton(derivatives, w)
    for _ in range(STEPS):
        if not gain > CONVERGENCE_TOLERANCE * value:
            break
        if gain < MIN_NEWTON_GAIN * value:
            last = float(np.linalg.svd(derivatives(w + step)[0], compute_uv=False)[0])
            return (last, w + step) if last > value else (value, w)
        other, following, next_gain = _newton(derivatives, w + step)
        if other > value:
            value, w, step, gain = other, w + step, following, next_gain
        else:
            step, gain = step / 4, gain / 4
    return value, w


def _newton(derivatives: Derivatives, w: float) -> tuple[float, float, float]:
    """Return sigma_max at w, the step to its predicted maximum, at most w / 2, and the predicted gain."""
    M, first, second = derivatives(w)
    U, sigma, Vh = np.linalg.svd(M)
    first = U.conj().T @ first @ Vh.conj().T
    slope = float(first[0, 0].real)
    curvature = float((U[:, 0].conj() @ second @ Vh[0].conj()).real) + _coupling(first, sigma)
    if not curvature < 0:
        return float(sigma[0]), float(np.sign(slope)) * w / 8, abs(slope) * w / 8
    step = float(np.clip(-slope / curvature, -w / 2, w / 2))
    return float(sigma[0]), step, slope * step / 2


def _coupling(first: Complex, sigma: Array) -> float:
    """Return the contribution of M' to the second derivative of sigma_1, with `first` = U^H M' V (p, m).

    sigma_1 is an eigenvalue of [[0, M], [M^H, 0]]; the others are -sigma_1, each +-sigma_j, and zeros.
    """
    top, k = max(float(sigma[0]), TINY), len(sigma)
    a, b = first[1:k, 0], first[0, 1:k].conj()
    gaps = np.maximum(top - sigma[1:], 1e-3 * top)
    pairs = np.abs(a + b) ** 2 / gaps + np.abs(a - b) ** 2 / (top + sigma[1:])
    others = (np.abs(first[k:, 0]) ** 2).sum() + (np.abs(first[0, k:]) ** 2).sum()
    return float((first[0, 0].imag ** 2 + others) / top + pairs.sum() / 2)
