"""The LQR cost of one period under zero-order hold, with the input delayed by (d + f) T, 0 <= f < 1.

In the period k the plant of `analyse.loop.sampled` has the input h = u[k-d-1] for the first f T, then v = u[k-d]:

    int_0^T (x'Qx + u'Ru + 2 x'Nu) dt = [x; h; v]' W [x; h; v],   W = W_1(f T) + M' W_2((1-f) T) M

W_1 weights (x, h), W_2 weights (x, v), and M maps (x, h, v) to (x, v) at f T; for f = 0 there is no h. The cost of the
periods k .. k+d-1 is fixed before u[k] is chosen. u[k] is therefore weighted by the period k+d in which it acts. There
(x, h) follows from the delayed inputs as P z[k], with the state z of the delayed model and the rows P of x and h of its
A^d. The sum

    sum_k [P z[k]; u[k]]' W [P z[k]; u[k]]

is the integral from d T on. Its optimal gain is that of the model without the d samples of delay, applied to P z.
"""

from dataclasses import dataclass, replace

import numpy as np
import scipy.linalg

from synth.analyse import discretise
from synth.analyse.loops import loop
from synth.analyse.numerics import precise
from synth.statespace import Array, StateSpace
from synth.timing import Discrete


@dataclass(frozen=True, eq=False)
class PeriodCost:
    """The sampled model and the weight W (n + m, n + m) on its states and inputs."""

    model: StateSpace
    W: Array


def over_period(plant: StateSpace, W: Array, period_s: float, delay_s: float) -> PeriodCost:
    """Return the sampled plant with hold and delay, and its equivalent of the weight W (n + m, n + m) on (x, u).

    Each step is rounded once, from ball arithmetic.

    Raises TimingError and ModelError as `loop.sampled` and `discretise.gramian`.
    """
    (n, m), F = plant.B.shape, _input_matrix(plant)
    if isinstance(delay_s, float | int) and delay_s == 0:
        held = discretise.gramian(F, W, period_s)
        model = replace(plant, A=held.M[:n, :n], B=held.M[:n, n:], time=Discrete(float(period_s)))
        return PeriodCost(model, held.W)
    delayed = loop.sampled(plant, period_s, delay_s)
    whole, fraction = _whole_and_fraction(delay_s / period_s)
    period_weight = _weight_of_period(F, W, m, period_s, fraction)
    if not whole:
        return PeriodCost(delayed, period_weight)
    P = _power(delayed.A, whole)[: len(period_weight) - m]
    return PeriodCost(delayed, _congruence(scipy.linalg.block_diag(P, np.eye(m)), period_weight))


def _input_matrix(plant: StateSpace) -> Array:
    n, m = plant.B.shape
    return np.vstack([np.hstack([plant.A, plant.B]), np.zeros((m, n + m))])


def _weight_of_period(F: Array, W: Array, m: int, period_s: float, fraction: float) -> Array:
    """Return the weight on (x, h, v), or (x, v) without a fraction."""
    if not fraction:
        return discretise.gramian(F, W, period_s).W
    first = discretise.gramian(F, W, fraction * period_s)
    second = discretise.gramian(F, W, (1 - fraction) * period_s).W
    M = scipy.linalg.block_diag(first.M, np.eye(m))
    M = np.delete(M, np.s_[len(F) - m : len(F)], axis=0)  # h no longer acts
    return scipy.linalg.block_diag(first.W, np.zeros((m, m))) + _congruence(M, second)


def _whole_and_fraction(samples: float) -> tuple[int, float]:
    """Return a delay as whole samples and a fraction of one, as `loop.sampled` does."""
    whole = round(samples)
    return (whole, 0.0) if abs(samples - whole) < loop.DELAY_ROUNDING else (int(samples), samples - int(samples))


def _power(A: Array, k: int) -> Array:
    return precise.round_correctly(lambda: precise.matrix(A) ** k, "the delayed model over its delay")


def _congruence(M: Array, W: Array) -> Array:
    """Return M' W M, symmetric."""
    balls = precise.matrix(M)
    product = precise.round_correctly(lambda: balls.transpose() * precise.matrix(W) * balls, "the weight")
    return np.asarray((product + product.T) / 2)
