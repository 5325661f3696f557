"""Discretisation with period T and back (MATLAB `c2d`, `d2c`, python-control `c2d`), and Gramians over a period.

Zero-order hold (u constant between samples):   x+ = F x + G u,        F = exp(A T), G = int_0^T exp(A s) ds B
First-order hold (u linear between samples):    x+ = F x + G u + H (u+ - u),
                                                H = (1/T) int_0^T exp(A s) (T - s) ds B

Each comes from one exponential of a block matrix (Van Loan 1978), computed in ball arithmetic and rounded once; the
inverse of a zero-order hold is its logarithm (inverse scaling and squaring: Higham, Functions of Matrices, 11.5).

Trapezoidal rule (Tustin), exact at the frequency w, which 0 makes the one of Tustin's rule without prewarping:

    s = (1/h) (z - 1) / (z + 1),   h = tan(w T / 2) / w,  T / 2 for w = 0
    F = M (I + h A),   G = 2 h M B,   C M,   D + h C M B,    M = (I - h A)^-1

Likewise the integral of a cost x'Wx over a period of x' = F x, or the covariance of noise of density V (F', V for
F, W):

    M = exp(F T),   W(T) = int_0^T exp(F t)' W exp(F t) dt
"""

from collections.abc import Callable
from dataclasses import dataclass, replace

import flint
import numpy as np
from numpy.typing import ArrayLike
from scipy.linalg import lapack

from synth import arguments
from synth.analyse.numerics import precise
from synth.errors import ModelError, SignalError, TimingError
from synth.statespace import Array, StateSpace, System, of, readonly
from synth.timing import Continuous, Discrete, Time, period

MOST_STATES = 10_000  # of a delayed model, whose A then takes 800 MB
NEGATIVE_AXIS = 1e-9  # relative imaginary part of a pole on the negative real axis in z
LOGARITHM_BITS = 512  # of which the square roots lose one each, and the condition of the matrix some
NEAR_IDENTITY, SERIES_TERMS = 1 / 16, 80  # artanh(x) to x^80 / 80 for |x| <= 1/32: 2^-400
MOST_ROOTS, ROOT_STEPS = 100, 60  # a step halves the logarithm of the error's ratio, then doubles the digits
ROOT_REACHED = 2.0**-400  # relative change of a root in a step
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
def inverse_zero_order_hold(system: System) -> StateSpace:
    """Return the continuous model whose zero-order-hold equivalent is this sampled one, with the same names and units.

    It is the one without a mode beyond the Nyquist frequency: its A is the principal logarithm of the sampled A over T.
    `zero_order_hold` of it with another period resamples the model (MATLAB `d2d`).

    Raises TimingError for a continuous model; ModelError for a pole in z at 0 or on the negative real axis, which no
    continuous model of this order has.
    """
    model = of(system)
    T = period(model.time)
    n, m = model.B.shape
    for z in model.poles:
        if z.real <= 0 and abs(z.imag) <= NEGATIVE_AXIS * abs(z):
            raise ModelError(
                f"the model has a pole at z = {z.real:.4g}, which no continuous model of its order has: take a delay "
                "out of the model, or use `discretise.inverse_tustin`"
            )
    E = np.block([[model.A, model.B], [np.zeros((m, n)), np.eye(m)]])
    with precise.precision(LOGARITHM_BITS):
        log = precise.rounded(_logarithm(precise.matrix(E)) / flint.arb(T))
    return replace(model, A=log[:n, :n], B=log[:n, n:], time=Continuous())


@arguments.checked
def tustin(system: System, period_s: float, frequency: float = 0.0) -> StateSpace:
    """Return the model discretised by the trapezoidal rule, prewarped to be exact at `frequency` in rad/s.

    Names and units stay; the states are those of the sampled recursion, (I - h A) times the continuous ones at constant
    input, so a model that is sampled while it runs starts at other values.

    Raises TimingError when the model is sampled already, the period is not positive or the frequency is not from 0 to
    below Nyquist; ModelError for a pole at 1/h, which the rule maps to infinity.
    """
    model = of(system)
    if not isinstance(model.time, Continuous):
        raise TimingError(f"a model in {model.time} cannot be sampled again: give the continuous model")
    time = _period(period_s)

    def compute() -> flint.arb_mat:
        h, (A, B, C, D) = _half_period(time, frequency), map(precise.matrix, (model.A, model.B, model.C, model.D))
        identity = precise.identity(len(model.A))
        M = (identity - A * h).inv()
        return _stack(M * (identity + A * h), M * B * (2 * h), C * M, D + C * M * B * h)

    return _bilinear(model, time, compute, "1/h, with the half period h of the rule")


@arguments.checked
def inverse_tustin(system: System, frequency: float = 0.0) -> StateSpace:
    """Return the continuous model of which `tustin` with the same `frequency` in rad/s makes this sampled one.

    Raises TimingError for a continuous model or a frequency that is not from 0 to below Nyquist; ModelError for a pole
    at z = -1, which the rule maps to infinity.
    """
    model = of(system)
    time = Discrete(period(model.time))

    def compute() -> flint.arb_mat:
        h, (F, G, H, J) = _half_period(time, frequency), map(precise.matrix, (model.A, model.B, model.C, model.D))
        identity = precise.identity(len(model.A))
        W = (F + identity).inv() * flint.arb(2)
        B = W * G / (2 * h)
        return _stack((F - identity) * W / (2 * h), B, H * W, J - H * B * h)

    return _bilinear(model, Continuous(), compute, "z = -1")


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


def _half_period(time: Discrete, frequency: float) -> flint.arb:
    """Return h of the trapezoidal rule in s."""
    T, w = time.period_s, frequency
    if not 0 <= w * T < np.pi:
        raise TimingError(
            f"the frequency {w:g} rad/s is not from 0 to below Nyquist, {np.pi / T:.6g} rad/s: give one between them"
        )
    return (flint.arb(w) * flint.arb(T) / 2).tan() / flint.arb(w) if w else flint.arb(T) / 2


def _stack(A: flint.arb_mat, B: flint.arb_mat, C: flint.arb_mat, D: flint.arb_mat) -> flint.arb_mat:
    rows = [
        [*left, *right] for pair in ((A, B), (C, D)) for left, right in zip(*(M.tolist() for M in pair), strict=True)
    ]
    return flint.arb_mat(rows)


def _bilinear(model: StateSpace, time: Time, compute: Callable[[], flint.arb_mat], infinite: str) -> StateSpace:
    """Return the model with other matrices [[A, B], [C, D]] and time; `infinite` names the pole that it cannot have."""
    n = len(model.A)
    try:
        S = precise.round_correctly(compute, "the trapezoidal rule") if n else np.array(model.D)
    except ZeroDivisionError as error:
        raise ModelError(
            f"the model has a pole at {infinite}, which the trapezoidal rule maps to infinity: change the period or "
            "the frequency, or take the pole out"
        ) from error
    return replace(model, A=S[:n, :n], B=S[:n, n:], C=S[n:, :n], D=S[n:, n:], time=time)


def _logarithm(E: flint.arb_mat) -> flint.arb_mat:
    """Return the principal logarithm of a matrix without eigenvalues on the closed negative real axis.

    Square roots (Denman and Beavers 1976) until E is near I, then log E = 2 artanh((E - I) (E + I)^-1) by its series.
    """
    identity, roots = precise.identity(E.nrows()), 0
    while (size := E.nrows() * precise.norm(E - identity)) > NEAR_IDENTITY:
        if roots == MOST_ROOTS or not np.isfinite(size):
            raise ModelError("the model's logarithm is not determined by its numbers: give the continuous model")
        X, Y = E, identity
        for _ in range(ROOT_STEPS):
            last, X, Y = X, ((X + Y.inv()) / 2).mid(), ((Y + X.inv()) / 2).mid()
            if precise.norm(X - last) <= ROOT_REACHED * precise.norm(X):
                break
        E, roots = X, roots + 1
    ratio = (E - identity) * (E + identity).inv()
    square, power, total = ratio * ratio, ratio, ratio
    for k in range(3, SERIES_TERMS, 2):
        power = (power * square).mid()
        total += power / k
    return total * flint.arb(2) ** (roots + 1)


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
