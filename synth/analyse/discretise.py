"""Sampling without approximation, period T.

Zero-order hold (u constant between samples):   x+ = F x + G u,        F = exp(A T), G = int_0^T exp(A s) ds B
First-order hold (u linear between samples):    x+ = F x + G u + H (u+ - u),
                                                H = (1/T) int_0^T exp(A s) (T - s) ds B

Each comes from one exponential of a block matrix (Van Loan 1978), computed in ball arithmetic and rounded once.
"""

from dataclasses import dataclass, replace

import flint
import numpy as np
from numpy.typing import ArrayLike

from synth.analyse import precise
from synth.errors import TimingError
from synth.statespace import Array, StateSpace, readonly
from synth.timing import Continuous, Discrete


@dataclass(frozen=True, eq=False)
class Ramp:
    """x+ = F x + G u + H (u+ - u): F (n, n), G (n, m), H (n, m)."""

    F: Array
    G: Array
    H: Array


def zero_order_hold(model: StateSpace, period_s: float) -> StateSpace:
    """Return the model sampled with its inputs held over each period.

    Raises TimingError when the model is sampled already or the period is not positive; ModelError as
    `precise.resolved`.
    """
    if not isinstance(model.time, Continuous):
        raise TimingError(f"a model in {model.time} was given to be sampled: give the continuous model")
    time = Discrete(period_s)
    n, m = model.B.shape
    E = _exponential(np.block([[model.A, model.B], [np.zeros((m, n + m))]]), period_s)
    return replace(model, A=E[:n, :n], B=E[:n, n:], time=time)


def first_order_hold(A: ArrayLike, B: ArrayLike, period_s: float) -> Ramp:
    """Return the exact response over one period to an input that is linear in between; A (n, n), B (n, m).

    Raises TimingError when the period is not positive; ModelError as `precise.resolved`.
    """
    A, B = np.asarray(A, dtype=np.float64), np.asarray(B, dtype=np.float64)
    Discrete(period_s)
    n, m = B.shape
    M = np.zeros((n + 2 * m, n + 2 * m))
    M[:n, :n], M[:n, n : n + m], M[n : n + m, n + m :] = A, B, np.eye(m)
    E = _exponential(M, period_s, columns_over_T=m)
    return Ramp(*(readonly(E[:n, part]) for part in (slice(n), slice(n, n + m), slice(n + m, None))))


def with_delay(model: StateSpace, samples: int = 1) -> StateSpace:
    """Return a sampled model whose inputs arrive `samples` periods late; each delay is a state ``<input>_late<k>``.

    Raises TimingError for a continuous model or a negative count.
    """
    if isinstance(model.time, Continuous) or samples < 0:
        raise TimingError(f"a delay of {samples} samples in {model.time}: sample the model and delay it by 0 or more")
    for k in range(samples):
        n, m = model.B.shape
        A = np.block([[model.A, model.B], [np.zeros((m, n + m))]])
        B = np.vstack([np.zeros((n, m)), np.eye(m)])
        C, D = np.hstack([model.C, model.D]), np.zeros_like(model.D)
        late = tuple(f"{name}_late{k + 1}" for name in model.inputs)
        model = replace(model, A=A, B=B, C=C, D=D, states=model.states + late)
    return model


def _exponential(M: Array, period_s: float, columns_over_T: int = 0) -> Array:
    """Return exp(M T), its last columns divided by T, each entry rounded once."""
    divided = len(M) - columns_over_T

    def compute() -> flint.arb_mat:
        T = flint.arb(period_s)
        scale = flint.arb_mat(np.eye(len(M)).tolist())
        for j in range(divided, len(M)):
            scale[j, j] = 1 / T
        return (precise.matrix(M) * T).exp() * scale

    return precise.resolved(compute, f"the exponential over {period_s:g} s")
