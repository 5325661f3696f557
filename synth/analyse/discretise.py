"""Exact discretisation with period T (MATLAB `c2d`, python-control `sample_system`), and Gramians over a period.

Zero-order hold (u constant between samples):   x+ = F x + G u,        F = exp(A T), G = int_0^T exp(A s) ds B
First-order hold (u linear between samples):    x+ = F x + G u + H (u+ - u),
                                                H = (1/T) int_0^T exp(A s) (T - s) ds B

Each comes from one exponential of a block matrix (Van Loan 1978), computed in ball arithmetic and rounded once.
Likewise the integral of a cost x'Wx over a period of x' = F x, or the covariance of noise of density V (F', V for
F, W):

    M = exp(F T),   W(T) = int_0^T exp(F t)' W exp(F t) dt
"""

from dataclasses import dataclass, replace

import flint
import numpy as np
from numpy.typing import ArrayLike
from scipy.linalg import lapack

from synth import arguments
from synth.analyse.numerics import precise
from synth.errors import SignalError, TimingError
from synth.statespace import Array, StateSpace, System, of, readonly
from synth.timing import Continuous, Discrete

MOST_STATES = 10_000  # of a delayed model, whose A then takes 800 MB
LINK = 2.0**-40  # of the largest balanced entry: replaces zeros when rows or columns of zeros are scaled


@dataclass(frozen=True, eq=False)
class FirstOrderHold:
    """x+ = F x + G u + H (u+ - u): F (n, n), G (n, m), H (n, m)."""

    F: Array
    G: Array
    H: Array


@dataclass(frozen=True, eq=False)
class Propagation:
    """M = exp(F T) (n, n) and W = int_0^T exp(F t)' W exp(F t) dt (n, n), symmetric."""

    M: Array
    W: Array


@arguments.checked
def gramian(F: ArrayLike, W: ArrayLike, period_s: float) -> Propagation:
    """Return exp(F T) and the integral of exp(F t)' W exp(F t) over a period; F (n, n), W (n, n) symmetric.

    The integral has W's unit times s. Both are computed in ball arithmetic and each entry is rounded once.

    Raises SignalError for shapes that do not fit, entries that are not finite or an asymmetric W; TimingError when the
    period is not positive; ModelError as `precise.round_correctly`.
    """
    F, W = _square("F", F), _square("W", W)
    if F.shape != W.shape:
        raise SignalError(f"F is {F.shape} and W is {W.shape}: give two matrices of one order")
    if not np.array_equal(W, W.T):
        i, j = np.argwhere(W != W.T)[0]
        raise SignalError(f"W is not symmetric: [{i}, {j}] is {W[i, j]}, [{j}, {i}] is {W[j, i]}; give (W + W') / 2")
    T = _period(period_s).period_s
    M, W = _van_loan(F, W, T)
    return Propagation(readonly(M), readonly(W))


@arguments.checked
def zero_order_hold(system: System, period_s: float) -> StateSpace:
    """Return the zero-order-hold equivalent of the model, with the same names and units.

    Raises TimingError when the model is sampled already or the period is not positive; ModelError as
    `precise.round_correctly`.
    """
    model = of(system)
    if not isinstance(model.time, Continuous):
        raise TimingError(f"a model in {model.time} cannot be sampled again: give the continuous model")
    time = _period(period_s)
    n, m = model.B.shape
    E = _exponential(np.block([[model.A, model.B], [np.zeros((m, n + m))]]), time.period_s)
    return replace(model, A=E[:n, :n], B=E[:n, n:], time=time)


@arguments.checked
def first_order_hold(A: ArrayLike, B: ArrayLike, period_s: float) -> FirstOrderHold:
    """Return the exact response over one period to an input that is linear between samples; A (n, n), B (n, m).

    Raises SignalError for shapes that do not fit or entries that are not finite; TimingError when the period is not
    positive; ModelError as `precise.round_correctly`.
    """
    A, B, T = _square("A", A), arguments.matrix("B", B), _period(period_s).period_s
    if len(B) != len(A) or not np.isfinite(B).all():
        raise SignalError(f"A is {A.shape} and B is {B.shape}: give B {len(A)} rows of finite numbers")
    n, m = B.shape
    M = np.zeros((n + 2 * m, n + 2 * m))
    M[:n, :n], M[:n, n : n + m], M[n : n + m, n + m :] = A, B, np.eye(m)
    E = _exponential(M, T, columns_over_T=m)
    return FirstOrderHold(*(readonly(E[:n, part]) for part in (slice(n), slice(n, n + m), slice(n + m, None))))


@arguments.checked
def delay_samples(system: System, samples: int = 1) -> StateSpace:
    """Return a sampled model whose inputs arrive `samples` periods late; each delay is a state ``<input>_late<k>``.

    Such a state has the unit of its input.

    Raises TimingError for a continuous model, or a count that is negative, not whole or makes too many states.
    """
    model = of(system)
    if isinstance(model.time, Continuous) or samples < 0:
        raise TimingError(f"a delay of {samples} samples in {model.time}: sample the model and delay it by 0 or more")
    (n, m), added = model.B.shape, samples * len(model.inputs)
    if n + added > MOST_STATES:
        raise TimingError(f"a delay of {samples} samples makes {n + added} states of {n}: take at most {MOST_STATES}")
    if not added:
        return model
    A = np.block([[model.A, model.B, np.zeros((n, added - m))], [np.zeros((added, n)), np.eye(added, k=m)]])
    B = np.vstack([np.zeros((n + added - m, m)), np.eye(m)])
    C, D = np.hstack([model.C, model.D, np.zeros((len(model.C), added - m))]), np.zeros_like(model.D)
    names = [(f"{name}_late{k + 1}", name) for k in range(samples) for name in model.inputs]
    units = {**model.units, **{new: model.units[name] for new, name in names if name in model.units}}
    return replace(model, A=A, B=B, C=C, D=D, states=(*model.states, *(new for new, _ in names)), units=units)


def balancing(M: Array) -> Array:
    """Return powers of 2 (n,), D, that give rows and columns of D^-1 M D similar sizes; M (n, n).

    A row or column of zeros leaves its scale undetermined: a small entry LINK then links it to all others.
    """
    if not len(M):
        return np.ones(0)
    size = np.abs(M)
    first = lapack.dgebal(size, scale=1, permute=0)[3]
    size = size * first / first[:, None]
    return np.asarray(first * lapack.dgebal(size + LINK * size.max(), scale=1, permute=0)[3], dtype=np.float64)


def _van_loan(F: Array, W: Array, period_s: float) -> tuple[Array, Array]:
    """Return M and W(T), each entry rounded once."""
    n = len(F)
    H = np.block([[-F.T, W], [np.zeros((n, n)), F]])

    def compute() -> flint.arb_mat:
        E = (precise.matrix(H) * flint.arb(period_s)).exp()
        M = flint.arb_mat([[E[n + i, n + j] for j in range(n)] for i in range(n)])
        G = flint.arb_mat([[E[i, n + j] for j in range(n)] for i in range(n)])
        return M.transpose() * G

    integral = precise.round_correctly(compute, f"the integral over {period_s:g} s")
    return _exponential(F, period_s), (integral + integral.T) / 2


def _period(period_s: float) -> Discrete:
    return Discrete(float(Discrete(period_s).period_s))


def _square(name: str, values: ArrayLike) -> Array:
    matrix = arguments.matrix(name, values)
    if matrix.shape[0] != matrix.shape[1] or not np.isfinite(matrix).all():
        raise SignalError(f"{name} is {matrix.shape}: give a square matrix of finite numbers")
    return matrix


def _exponential(M: Array, period_s: float, columns_over_T: int = 0) -> Array:
    """Return exp(M T), its last columns divided by T, each entry rounded once."""
    first = len(M) - columns_over_T

    def compute() -> flint.arb_mat:
        T = flint.arb(period_s)
        scale = flint.arb_mat(np.eye(len(M)).tolist())
        for j in range(first, len(M)):
            scale[j, j] = 1 / T
        return (precise.matrix(M) * T).exp() * scale

    return precise.round_correctly(compute, f"the exponential over {period_s:g} s")
