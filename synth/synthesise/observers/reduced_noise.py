"""Optimal gain of a reduced-order observer: Kalman filter for white process noise and noise-free measurements.

    x1+ = A11 x1 + A12 x2 + B1 u + w1,   x2+ = A21 x1 + A22 x2 + B2 u + w2,   y = x1 + D u
    E w w' = W = [[W11, W12], [W21, W22]],   w white

At sample k + 1 the measurement m = x1+ - A11 x1 - B1 u = A12 x2 + w1 of x2 at sample k is known exactly. With its noise
w1, the process noise w2 and their covariance W21, the Kalman filter that predicts x2 at k + 1 from the m up to k has

    L = (A22 P A12' + W21) (A12 P A12' + W11)^-1,   P = A22 P A22' + W22 - L (A12 P A22' + W12)

with the error covariance P. x3 + L x1 is this prediction. As it uses y up to k + 1, it is also the estimate at k + 1:
the limit of the full-order filter after its sample as the measurement noise tends to zero. In continuous time
m = x1' - A11 x1 - B1 u, W is a density, W11 > 0 and

    L = (P A12' + W21) W11^-1,   A22 P + P A22' + W22 - L W11 L' = 0

Library: no design uses it yet; docs/library.md has an example.
"""

from dataclasses import dataclass

import numpy as np
import scipy.linalg

from synth import show
from synth.analyse import structure
from synth.errors import ModelError
from synth.statespace import Array, StateSpace, readonly
from synth.synthesise.feedback import weights
from synth.synthesise.feedback.weights import Weight
from synth.synthesise.observers.reduced_partition import Partition
from synth.synthesise.riccati import riccati
from synth.timing import Continuous

EIGENVALUE_ROUNDING = 1e-12  # of a covariance scaled to a diagonal of 1: an eigenvalue below it counts as zero
BOUNDARY = 1e-8  # of |A|, or of 1 for |z|: a mode this close to the boundary of stability counts as on it


@dataclass(frozen=True, eq=False)
class Filter:
    """L with the error covariance (n - p, n - p) of x2^.

    `residual` is that of the Riccati equation relative to W22.
    """

    L: Array
    covariance: Array
    residual: float
    estimated: tuple[str, ...]

    @property
    def deviations(self) -> dict[str, float]:
        """The standard deviation of each estimate's error, in the state's unit."""
        return dict(zip(self.estimated, np.sqrt(np.diag(self.covariance)).tolist(), strict=True))

    def lines(self) -> tuple[str, ...]:
        """Return the certificate in sentences."""
        sizes = ", ".join(f"{name} {size:.4g}" for name, size in self.deviations.items())
        return (
            f"Standard deviation of the error: {sizes}",
            f"Least for noise-free measurements; Riccati equation solved to {self.residual:.1e}",
        )


@dataclass(frozen=True, eq=False)
class Noise:
    """The blocks W11 (p, p), W12 (p, n - p), W22 of the covariance of w1 and w2."""

    W11: Array
    W12: Array
    W22: Array


def partition_noise(part: Partition, W: Weight) -> Noise:
    """Return process noise W (n, n) on the states, partitioned.

    Raises SignalError for a W of the wrong shape, not finite, asymmetric or indefinite.
    """
    p = len(part.measured)
    transformed = part.M @ weights.semidefinite("W", W, part.model.states) @ part.M.T
    transformed = (transformed + transformed.T) / 2
    return Noise(*(readonly(m) for m in (transformed[:p, :p], transformed[:p, p:], transformed[p:, p:])))


def steady_filter(part: Partition, noise: Noise) -> Filter:
    """Return the optimal steady-state filter.

    A mode of the error that grows and that W does not excite is mirrored into the stable region.

    Raises ModelError when none exists: W does not excite a mode of the error on the boundary of stability, or in
    continuous time the rate of a measured signal has no noise.
    """
    _require_steady(part, noise)
    A, C, Q, R, S = part.A22, part.A12, noise.W22, noise.W11, noise.W12.T
    names, time = part.estimated, part.model.time
    if _noise_free_combinations(R).shape[1] == 0:
        n, p = C.T.shape
        inputs = tuple(f"e{k + 1}" for k in range(p))
        dual = StateSpace(A.T, C.T, np.eye(n), np.zeros((n, p)), names, inputs, names, time)
        solution = riccati.solve(dual, Q, R, S)
        return Filter(readonly(solution.L.T), readonly(solution.X), solution.residual, names)
    try:
        P = scipy.linalg.solve_discrete_are(A.T, C.T, Q, R, s=S)
        L = np.linalg.solve(R + C @ P @ C.T, (A @ P @ C.T + S).T).T
    except (np.linalg.LinAlgError, ValueError) as error:
        raise ModelError(
            f"the filter of {', '.join(names)} has no steady-state gain, as noise-free signals are redundant or too "
            f"few states have noise ({error}): leave such a signal out, or give W a part on each state"
        ) from error
    residual = A @ P @ A.T + Q - L @ (C @ P @ A.T + S.T) - P
    return Filter(readonly(L), readonly(P), float(np.abs(residual).max() / (np.abs(Q).max() or 1.0)), names)


def _noise_free_combinations(R: Array) -> Array:
    """Return the combinations (p, k) of signals that have no noise, R (p, p) scaled to a diagonal of 1."""
    values, vectors = np.linalg.eigh(weights.unit_diagonal(R))
    return np.asarray(vectors[:, values <= EIGENVALUE_ROUNDING])


def _require_steady(part: Partition, noise: Noise) -> None:
    """Raise ModelError for a marginal error mode that no noise excites, or in continuous time a noise-free rate."""
    continuous = isinstance(part.model.time, Continuous)
    silent, A_error, W_error = _noise_free_combinations(noise.W11), part.A22, noise.W22
    if not silent.shape[1]:
        q = len(part.estimated)
        shown = np.linalg.solve(noise.W11, np.hstack([noise.W12, part.A12]))
        W_error, A_error = W_error - noise.W12.T @ shown[:, :q], A_error - noise.W12.T @ shown[:, q:]
    elif continuous:
        share = np.linalg.norm(silent, axis=1)
        who = ", ".join(n for n, s in zip(part.measured, share, strict=True) if s > 0.1 * share.max())
        raise ModelError(
            f"the process noise W has no part on {who}: its rate shows the estimated states exactly and the "
            f"optimal gain is infinite; give W a part on {who}, or sample the model"
        )
    size = np.sqrt(np.diag(noise.W22))
    W_error = np.where(np.abs(W_error) > EIGENVALUE_ROUNDING * size * size[:, None], W_error, 0.0)
    near = BOUNDARY * float(np.linalg.norm(A_error)) if continuous else BOUNDARY
    for mode in structure.uncontrollable_modes(A_error, W_error, part.estimated, part.model.time):
        if (mode.value.real if continuous else abs(mode.value) - 1) > near:
            continue  # the stabilising solution exists and mirrors it
        raise ModelError(
            f"the process noise W excites mode {show.number(mode.value, 4)} of the error in "
            f"{', '.join(mode.states)} at most through {', '.join(part.measured)}: the filter has no steady-state "
            "gain; give W a part of its own there "
            "(sampled noise: its covariance over the period, discretise.gramian)"
        )
