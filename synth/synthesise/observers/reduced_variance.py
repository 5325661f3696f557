"""The reduced-order observer of least variance where the measured signals are noisy, in discrete time.

With x1, x2, w, W and m of `reduced_noise`, y = x1 + v + D u and E v v' = V, v white and independent of w: the noise of
m = y+ - A11 y - B1 u = A12 x2 + .. is v+ - A11 v + w1, which is not white; the optimal filter has order n. Here L is
the best for an observer of order n - p: with F, G of `reduced_observer` the error e = x2 - x2^ = z - L v, where
z+ = F z + w2 - L w1 - G v, has the covariance

    S(L) = Z + L V L',   Z = F Z F' + [-L, I] W [-L, I]' + G V G'

and L makes tr(K^-1 S(L)) least, K that of the full-order Kalman filter after its sample, on the directions that this
filter does not know exactly. Over their number that is the `excess`, 1 for a filter as good as that one. The descent
(BFGS) starts from the gain that takes the noise of m for white; what it finds is a local least value. A continuous
model passes v straight to x2^, with a variance that has no bound: such noise is refused.
"""

from dataclasses import replace

import numpy as np
import scipy.linalg
import scipy.optimize
from numpy.typing import NDArray

from synth import show
from synth.analyse import structure
from synth.errors import ModelError
from synth.statespace import Array, readonly
from synth.synthesise.observers import reduced_noise
from synth.synthesise.observers.reduced_noise import SINGULAR, Filter, Noise
from synth.synthesise.observers.reduced_partition import Partition
from synth.timing import Continuous

SETTLED = 1e-6  # of the cost: a slope above it is no least value
WORST = 1e100  # what the descent sees where the error does not decay


def least(part: Partition, noise: Noise) -> Filter:
    """Return the filter of least weighted variance for process and measurement noise.

    Raises ModelError for continuous time, where the full-order filter has no steady state, or when the descent does not
    settle.
    """
    if isinstance(part.model.time, Continuous):
        raise ModelError(
            f"the measurement noise V of {', '.join(part.measured)} is white in continuous time and passes straight to "
            "the estimate, with a variance that has no bound: sample the model, or use the Kalman filter of full order"
        )
    bound = _full_order(part, noise)
    d, e = _size(np.diag(bound)), _size(np.maximum(np.diag(noise.V), np.diag(noise.W11)))
    part, noise = _rescaled(part, noise, d, e)
    weight, count = _inverse(bound / d / d[:, None])
    start, free = _white(part, noise), np.diag(bound)[:, None] > 0  # what the full order knows exactly stays as it is

    def cost(flat: Array) -> tuple[float, Array]:
        value, slope = _cost(part, noise, weight, start + flat.reshape(start.shape))
        return value, (free * slope).ravel()

    found = scipy.optimize.minimize(cost, np.zeros(start.size), jac=True, method="BFGS", options={"gtol": 1e-9})
    L = start + found.x.reshape(start.shape)
    slope = float(np.abs(found.jac * L.ravel()).max() / found.fun)
    if slope > SETTLED:
        raise ModelError(
            f"the descent to the least variance stops at a slope of {slope:.1e}: give W and V of likelier sizes, or "
            "use the Kalman filter of full order"
        )
    S = readonly(_covariance(part, noise, L)[0] * d * d[:, None])
    gain = readonly(d[:, None] * L / e)
    return Filter(gain, S, readonly(bound), float(found.fun) / count, slope, part.estimated, True)


def _size(variances: Array) -> Array:
    """Return the powers of 2 next to the standard deviations, 1 where there is none."""
    return np.asarray(np.exp2(np.round(np.log2(np.where(variances > 0, variances, 1.0)) / 2)), dtype=np.float64)


def _rescaled(part: Partition, noise: Noise, d: Array, e: Array) -> tuple[Partition, Noise]:
    """Return the blocks and the noise with x2 in units of d and x1 in units of e."""
    A = {"A11": (e, e), "A12": (e, d), "A21": (d, e), "A22": (d, d)}
    blocks = {name: getattr(part, name) * across / down[:, None] for name, (down, across) in A.items()}
    W11, W12, W22 = noise.W11 / e / e[:, None], noise.W12 / d / e[:, None], noise.W22 / d / d[:, None]
    W = np.block([[W11, W12], [W12.T, W22]])
    return replace(part, **blocks), Noise(W11, W12, W22, W, noise.V / e / e[:, None])


def _inverse(bound: Array) -> tuple[Array, int]:
    """Return the inverse of a scaled covariance on what is not known exactly, and the number of its directions."""
    values, vectors = np.linalg.eigh(bound)
    left = values > SINGULAR
    if not left.any():
        raise ModelError("the Kalman filter of full order knows every state exactly: no noise is left to filter")
    W = vectors[:, left]
    return (W / values[left]) @ W.T, int(left.sum())


def _full_order(part: Partition, noise: Noise) -> Array:
    """Return the covariance of x2 - x2^ of the Kalman filter of order n after a sample."""
    A, p = np.block([[part.A11, part.A12], [part.A21, part.A22]]), len(part.measured)
    names, time = (*part.measured, *part.estimated), part.model.time
    for mode in structure.unmoved(A, noise.W, names, time):
        who = ", ".join(mode.states)
        raise ModelError(
            f"the process noise W does not reach mode {show.number(mode.value, 4)} in {who}: a filter with measurement "
            f"noise trusts it more and more and has no steady gain; give W a part on {who}"
        )
    P = reduced_noise.steady(A, np.eye(p, len(A)), noise.W, noise.V, np.zeros((len(A), p)), names, time).P
    after = P - P[:, :p] @ np.linalg.solve(P[:p, :p] + noise.V, P[:p])
    return (after + after.T)[p:, p:] / 2


def _white(part: Partition, noise: Noise) -> Array:
    """Return the gain that takes w1 + v+ - A11 v for white, and w2 - A21 v with it."""
    R = noise.W11 + noise.V + part.A11 @ noise.V @ part.A11.T
    S = noise.W12.T + part.A21 @ noise.V @ part.A11.T
    Q = noise.W22 + part.A21 @ noise.V @ part.A21.T
    R, Q = (R + R.T) / 2, (Q + Q.T) / 2
    return reduced_noise.steady(part.A22, part.A12, Q, R, S, part.estimated, part.model.time).L


def _covariance(part: Partition, noise: Noise, L: Array) -> tuple[Array, Array, Array, Array]:
    """Return S(L), Z, F and G."""
    F = part.A22 - L @ part.A12
    G = F @ L + part.A21 - L @ part.A11
    N = np.hstack([-L, np.eye(len(L))])
    Z = scipy.linalg.solve_discrete_lyapunov(F, N @ noise.W @ N.T + G @ noise.V @ G.T)
    return (Z + Z.T) / 2 + L @ noise.V @ L.T, Z, F, G


def _cost(part: Partition, noise: Noise, weight: Array, L: Array) -> tuple[float, NDArray[np.float64]]:
    """Return tr(weight S(L)) and its slope (n - p, p)."""
    if not np.isfinite(L).all() or np.abs(np.linalg.eigvals(part.A22 - L @ part.A12)).max() >= 1 - structure.DECAY:
        return WORST, np.zeros(L.shape)
    S, Z, F, G = _covariance(part, noise, L)
    Y = scipy.linalg.solve_discrete_lyapunov(F.T, weight)
    across = noise.W[:, : len(part.measured)]
    slope = F.T @ Y @ G @ noise.V + weight @ L @ noise.V
    slope -= Y @ (
        F @ Z @ part.A12.T
        + across[len(part.measured) :] - L @ across[: len(part.measured)]
        + G @ noise.V @ (part.A12 @ L + part.A11).T
    )  # fmt: skip
    return float(np.trace(weight @ S)), 2 * slope
