"""Gains of reduced-order observers for white noise: w on the states, v on the measured signals.

    x1+ = A11 x1 + A12 x2 + B1 u + w1,   x2+ = A21 x1 + A22 x2 + B2 u + w2,   y = x1 + v + D u
    E w w' = W = [[W11, W12], [W21, W22]],   E v v' = V,   w, v white and independent of each other

Without v. At sample k + 1 the measurement m = x1+ - A11 x1 - B1 u = A12 x2 + w1 of x2 at sample k is known exactly.
With its noise w1, the process noise w2 and their covariance W21, the Kalman filter that predicts x2 at k + 1 from the m
up to k has, by the Riccati equation of its error covariance P,

    L = (A22 P A12' + W21) (A12 P A12' + W11)^-1,   P = A22 P A22' + W22 - L (A12 P A22' + W12)

and x3 + L x1 is this prediction: with y up to k + 1 it is the estimate at k + 1 itself, the limit of the full-order
filter after its sample as V -> 0. In continuous time m = x1' - A11 x1 - B1 u, W is a density, W11 > 0 and

    L = (P A12' + W21) W11^-1,   A22 P + P A22' + W22 - L W11 L' = 0

With v the best filter of this order is found by `reduced_variance`.
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
from synth.timing import Continuous, Time

SINGULAR = 1e-12  # of a covariance scaled to a diagonal of 1: an eigenvalue below it counts as zero


@dataclass(frozen=True, eq=False)
class Filter:
    """L with the covariance of x2 - x2^ (n - p, n - p), in time or at each sample, and its `bound`, of full order.

    `residual` is that of the Riccati equation over W22, or with measurement noise the relative slope of the cost at L.
    """

    L: Array
    covariance: Array
    bound: Array
    excess: float
    residual: float
    estimated: tuple[str, ...]
    noisy: bool

    @property
    def deviations(self) -> dict[str, float]:
        """The standard deviation of each estimate's error, in the state's unit."""
        return dict(zip(self.estimated, np.sqrt(np.diag(self.covariance)).tolist(), strict=True))

    def lines(self) -> tuple[str, ...]:
        """Return the certificate in sentences."""
        sizes = ", ".join(f"{name} {size:.4g}" for name, size in self.deviations.items())
        if not self.noisy:
            return (
                f"Standard deviation of the error: {sizes}",
                f"Least for noise-free measurements; Riccati equation solved to {self.residual:.1e}",
            )
        least = ", ".join(f"{np.sqrt(v):.4g}" for v in np.diag(self.bound))
        return (
            f"Standard deviation of the error: {sizes}; of the Kalman filter of full order: {least}",
            f"Weighted variance {self.excess:.4g} times that of full order; slope at L {self.residual:.1e}",
        )


@dataclass(frozen=True, eq=False)
class Noise:
    """W (n, n) of w1 and w2 with its blocks W11 (p, p), W12 (p, n - p), W22, and V (p, p) of v."""

    W11: Array
    W12: Array
    W22: Array
    W: Array
    V: Array


@dataclass(frozen=True, eq=False)
class Steady:
    """P of a predicting filter with its gain and the relative residual of its equation."""

    P: Array
    L: Array
    residual: float


def of(part: Partition, W: Weight, V: Weight | None = None) -> Noise:
    """Return process noise W (n, n) on the states and measurement noise V (p, p) on the measured signals, partitioned.

    Raises SignalError for a W or V that does not fit, is not finite, asymmetric or indefinite.
    """
    p = len(part.measured)
    process = weights.semidefinite("W", W, part.model.states)
    V = np.zeros((p, p)) if V is None else weights.semidefinite("V", V, part.measured)
    moved = part.M @ process @ part.M.T
    moved = (moved + moved.T) / 2
    return Noise(*(readonly(m) for m in (moved[:p, :p], moved[:p, p:], moved[p:, p:], moved, V)))


def noise_free(part: Partition, noise: Noise) -> Filter:
    """Return the optimal filter without measurement noise.

    Raises ModelError when no steady filter exists: W does not reach a lasting mode of the error, or in continuous time
    the rate of a measured signal has no noise.
    """
    _require_steady(part, noise)
    found = steady(part.A22, part.A12, noise.W22, noise.W11, noise.W12.T, part.estimated, part.model.time)
    P = readonly(found.P)
    return Filter(readonly(found.L), P, P, 1.0, found.residual, part.estimated, False)


def steady(A: Array, C: Array, Q: Array, R: Array, S: Array, states: tuple[str, ...], time: Time) -> Steady:
    """Return the predicting filter of x' = A x + w, y = C x + v with E w w' = Q, E v v' = R, E w v' = S.

    In discrete time R may be singular. Raises ModelError when no steady filter exists.
    """
    if _kernel(R).shape[1] == 0:
        n, p = C.T.shape
        inputs = tuple(f"e{k + 1}" for k in range(p))
        dual = StateSpace(A.T, C.T, np.eye(n), np.zeros((n, p)), states, inputs, states, time)
        found = riccati.solve(dual, Q, R, S)
        return Steady(found.X, found.L.T, found.residual)
    try:
        P = scipy.linalg.solve_discrete_are(A.T, C.T, Q, R, s=S)
        L = np.linalg.solve(R + C @ P @ C.T, (A @ P @ C.T + S).T).T
    except (np.linalg.LinAlgError, ValueError) as error:
        raise ModelError(
            f"the filter of {', '.join(states)} has no steady gain, as signals without noise show the same or noise "
            f"reaches too little ({error}): leave such a signal out, or give W a part on each state"
        ) from error
    miss = A @ P @ A.T + Q - L @ (C @ P @ A.T + S.T) - P
    return Steady(P, L, float(np.abs(miss).max() / (np.abs(Q).max() or 1.0)))


def _kernel(R: Array) -> Array:
    """Return the combinations (p, k) of signals that have no noise, R (p, p) scaled to a diagonal of 1."""
    values, vectors = np.linalg.eigh(weights.unit_diagonal(R))
    return np.asarray(vectors[:, values <= SINGULAR])


def _require_steady(part: Partition, noise: Noise) -> None:
    """Refuse noise that leaves a lasting mode of the error alone, or a rate without noise in continuous time."""
    silent, lasting, rest = _kernel(noise.W11), part.A22, noise.W22
    if not silent.shape[1]:
        q = len(part.estimated)
        shown = np.linalg.solve(noise.W11, np.hstack([noise.W12, part.A12]))
        rest, lasting = rest - noise.W12.T @ shown[:, :q], lasting - noise.W12.T @ shown[:, q:]
    elif isinstance(part.model.time, Continuous):
        share = np.linalg.norm(silent, axis=1)
        who = ", ".join(n for n, s in zip(part.measured, share, strict=True) if s > 0.1 * share.max())
        raise ModelError(
            f"the process noise W has no part on {who}: its rate shows the estimated states exactly and the best "
            f"gain has no bound; give W a part on {who}, or sample the model"
        )
    size = np.sqrt(np.diag(noise.W22))
    rest = np.where(np.abs(rest) > SINGULAR * size * size[:, None], rest, 0.0)
    for mode in structure.unmoved(lasting, rest, part.estimated, part.model.time):
        raise ModelError(
            f"the process noise W does not reach mode {show.number(mode.value, 4)} of the error in "
            f"{', '.join(mode.states)} but through {', '.join(part.measured)}: the filter has no steady gain; give W "
            "a part of its own there (sampled noise: what gathers over the period, discretise.gramian)"
        )
