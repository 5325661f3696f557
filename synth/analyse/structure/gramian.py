"""Controllability and observability Gramians, Hankel singular values (MATLAB `gram`, `hsvd`).

With Phi(t) = exp(A t), or A^t in discrete time (sums for integrals),

    Wc = int Phi B B' Phi' dt      x' Wc^-1 x: least input energy int u'u dt from 0 to x
    Wo = int Phi' C' C Phi dt      x' Wo x: output energy int y'y dt from x(0) = x
    Hankel singular values         sqrt of the eigenvalues of Wc Wo, the same in all coordinates

The unstable part of A = T diag(As, Au) T^-1 is integrated backward in time: with -Au, or the inverse of Au. A mode on
the stability boundary has no such integral; `over_horizon` integrates to a horizon instead. The share of an input is
its part of trace(Wc Wo) = sum of squared Hankel values. Shares depend on the units of the inputs.
"""

import warnings
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from numbers import Real

import numpy as np
import scipy.linalg

from synth import arguments, show
from synth.analyse import discretise
from synth.analyse.structure import staircase, structure
from synth.errors import ModelError, TimingError
from synth.statespace import Array, StateSpace, System, of, readonly
from synth.timing import Continuous

# For noise of the size of each row of scaled A; a larger Gramian indicates a mode on the stability boundary.
MAX_GRAMIAN = 1e12
MAX_RESIDUAL = 1e-4  # of the terms of the Lyapunov equation: a larger one belongs to a meaningless Gramian
EPS = float(np.finfo(float).eps)
OFF_BORDER = 1e-4  # of a pole's distance from the border of stability: a smaller shift leaves it clearly on its side
BETTER_COORDINATES = (
    "give the model in modal coordinates or in a cascade of them (blocks [[a, b], [-b, a]] for the poles a +- ib), or "
    "the continuous model"
)

Integral = Callable[[Array, Array], Array]


@dataclass(frozen=True, eq=False)
class _Span:
    """W = `integral(F, Q)` of F'^t Q F^t over a time, and the `boundary` that F' W + W F, or F' W F - W, must equal."""

    integral: Integral
    boundary: Integral
    text: str


@show.result
class Gramians:
    """Wc (n, n), Wo (n, n) in the units of the states, Hankel singular values (n,), largest first, and shares.

    `directions` has the states of each Hankel value; `by_input` and `by_output` are shares that sum to 1; `residual`
    is the larger residual of the two Lyapunov equations, relative to its terms; `span` is the time of integration.
    """

    Wc: Array
    Wo: Array
    hankel: Array
    directions: tuple[structure.Direction, ...]
    by_input: Mapping[str, float]
    by_output: Mapping[str, float]
    residual: float
    span: str

    def sheet(self) -> show.Sheet:
        """Return the Hankel singular values with their states, and the shares."""
        relative = self.hankel / (self.hankel.max(initial=0.0) or 1.0)  # its square does not overflow
        part = relative**2 / ((relative**2).sum() or 1.0)
        rows = tuple(
            (f"{v:.4g}", f"{share:.2%}", structure.direction_text(along) or "none")
            for v, share, along in zip(self.hankel, part, self.directions, strict=True)
        )
        shares = tuple((n, f"{v:.2%}") for part in (self.by_input, self.by_output) for n, v in part.items())
        tables = (
            show.Table("", ("Hankel value", "share", "states"), rows),
            show.Table("", ("signal", "share"), shares),
        )
        return show.Sheet(f"Gramians {self.span}; residual {self.residual:.1e}", tables=tables)


@arguments.checked
def gramians(system: System) -> Gramians:
    """Return the Gramians of a System over all time, backward in time for its unstable part.

    Raises SignalError as `statespace.of`; ModelError with the mode that lies on the border of stability.
    """
    model = of(system)
    x = staircase.of_model(model).x
    A = model.A * x / x[:, None]
    continuous = isinstance(model.time, Continuous)
    noise_size = np.abs(A).sum(axis=1) if continuous else np.ones(len(A))  # the effect of rounding of A on each state
    try:
        T, k = _stable_first(A, continuous)
        span = _over_all_time(len(A), k, continuous)
        inverse = _inverse(T)
        noise = T @ span.integral((inverse @ A @ T).T, (inverse * noise_size) @ inverse.T) @ T.T
    except (np.linalg.LinAlgError, RuntimeWarning) as error:
        raise _border_error(model) from error
    if len(A) and not np.linalg.norm(noise) < MAX_GRAMIAN:
        raise _border_error(model)
    return _gramians(model, x[:, None] * T, span)


@arguments.checked
def over_horizon(system: System, horizon_s: float) -> Gramians:
    """Return the Gramians of a System from 0 to `horizon_s`, rounded to whole samples in discrete time.

    Raises SignalError as `statespace.of`; TimingError when the horizon is not positive or shorter than a sample;
    ModelError as `discretise.gramian`, or when rounding errors exceed the Gramian.
    """
    model = of(system)
    X = np.diag(staircase.of_model(model).x)
    if not isinstance(horizon_s, Real):
        raise TimingError(f"the horizon is {horizon_s!r}: give a number of seconds")
    if not 0 < horizon_s < np.inf:
        raise TimingError(f"the horizon is {horizon_s} s: give a finite positive time")
    if isinstance(model.time, Continuous):

        def propagate(F: Array, Q: Array) -> tuple[Array, Array]:
            propagation = discretise.gramian(F, Q, horizon_s) if len(F) else None
            return (propagation.W, propagation.M) if propagation else (Q, F)

        over = _gramians(model, X, _finite_span(f"{horizon_s:g} s", propagate))
        return _require_small_residual(over, "take a shorter horizon, in which no mode grows that far")
    samples = round(horizon_s / model.time.period_s)
    if samples < 1:
        raise TimingError(f"the horizon of {horizon_s:g} s is shorter than a sample of {model.time.period_s:g} s")
    with np.errstate(over="ignore", invalid="ignore"):
        sums = _gramians(model, X, _finite_span(f"{samples} samples", lambda F, Q: _gramian_sum(F, Q, samples)))
    return _require_small_residual(sums, BETTER_COORDINATES)


def _require_small_residual(over: Gramians, mend: str) -> Gramians:
    """Return Gramians over a horizon; raise ModelError where rounding errors exceed them."""
    if not over.residual < MAX_RESIDUAL:
        raise ModelError(
            f"the Gramian {over.span} is not determined in double precision: the residual of its Lyapunov equation is "
            f"{over.residual:.1e} of the terms, and less than {MAX_RESIDUAL:.0e} is needed; {mend}"
        )
    return over


def _stable_first(A: Array, continuous: bool) -> tuple[Array, int]:
    """Return T with T^-1 A T block diagonal, and the order of its first block, which has the stable modes."""
    R, U, k = scipy.linalg.schur(A, sort="lhp" if continuous else "iuc") if len(A) else (A, A, 0)
    T = np.eye(len(A))
    if 0 < k < len(A):
        T[:k, k:] = scipy.linalg.solve_sylvester(R[:k, :k], -R[k:, k:], -R[:k, k:])
    return U @ T, k


def _over_all_time(n: int, k: int, continuous: bool) -> _Span:
    """Return the span with the first k of n coordinates forward in time and the others backward."""
    sign = np.where(np.arange(n) < k, -1.0, 1.0)

    def integral(F: Array, Q: Array) -> Array:
        forward = _lyapunov(F[:k, :k], Q[:k, :k], continuous)
        F, Q = F[k:, k:], Q[k:, k:]
        if continuous:
            return np.asarray(scipy.linalg.block_diag(forward, _lyapunov(-F, Q, continuous)))
        inverse = _inverse(F)
        return np.asarray(scipy.linalg.block_diag(forward, _lyapunov(inverse, inverse.T @ Q @ inverse, continuous)))

    def boundary(F: Array, Q: Array) -> Array:
        return np.where(sign == sign[:, None], sign * Q, 0.0)

    text = "over all time" if k == n else "forward in time for stable modes, backward for unstable ones"
    return _Span(integral, boundary, text)


def _finite_span(span: str, propagate: Callable[[Array, Array], tuple[Array, Array]]) -> _Span:
    """Return the span for which `propagate` gives W and the transition matrix M."""

    def boundary(F: Array, Q: Array) -> Array:
        M = propagate(F, Q)[1]
        return M.T @ Q @ M - Q

    return _Span(lambda F, Q: propagate(F, Q)[0], boundary, f"over {span}")


def _lyapunov(F: Array, Q: Array, continuous: bool) -> Array:
    """Return int exp(F' t) Q exp(F t) dt, or the sum over F'^k Q F^k from 0, for a stable F."""
    if not len(F):
        return Q
    with warnings.catch_warnings():
        warnings.simplefilter("error")  # SciPy only warns of modes with s + s' near 0
        if continuous:
            return np.asarray(scipy.linalg.solve_continuous_lyapunov(F.T, -Q))
        return np.asarray(scipy.linalg.solve_discrete_lyapunov(F.T, Q))


def _inverse(T: Array) -> Array:
    return np.asarray(np.linalg.inv(T), dtype=np.float64)


def _gramian_sum(F: Array, Q: Array, samples: int) -> tuple[Array, Array]:
    """Return the sum of F'^k Q F^k for k below `samples`, by W(a + b) = W(a) + F'^a W(b) F^a, and F^samples."""
    W, power = np.zeros_like(Q), np.eye(len(F))
    for digit in f"{samples:b}":
        W, power = W + power.T @ W @ power, power @ power
        if digit == "1":
            W, power = Q + F.T @ W @ F, power @ F
    return W, power


def _gramians(model: StateSpace, T: Array, span: _Span) -> Gramians:
    """Return the Gramians, computed in the coordinates T^-1 x."""
    inverse = _inverse(T)
    A, B, C = inverse @ model.A @ T, inverse @ model.B, model.C @ T
    Wc, Wo = span.integral(A.T, B @ B.T), span.integral(A, C.T @ C)
    continuous = isinstance(model.time, Continuous)
    residuals = [_residual(F, Q, W, span, continuous) for F, Q, W in ((A.T, B @ B.T, Wc), (A, C.T @ C, Wo))]
    left, right = _root(Wo), _root(Wc)
    _, hankel, V = np.linalg.svd(left.T @ right)
    directions = (T @ right @ V.T).T / staircase.of_model(model).x
    by_input = np.diag(B.T @ span.integral(A, Wo) @ B)
    by_output = np.diag(C @ span.integral(A.T, Wc) @ C.T)
    return Gramians(
        readonly(T @ Wc @ T.T),
        readonly(inverse.T @ Wo @ inverse),
        readonly(hankel),
        tuple(structure.direction(v, model.states) for v in directions),
        _fractions(by_input, model.inputs),
        _fractions(by_output, model.outputs),
        max(residuals),
        span.text,
    )


def _residual(F: Array, Q: Array, W: Array, span: _Span, continuous: bool) -> float:
    left, boundary = (F.T @ W + W @ F if continuous else F.T @ W @ F - W), span.boundary(F, Q)
    size = np.linalg.norm(F.T @ W) + np.linalg.norm(boundary)
    return float(np.linalg.norm(left - boundary) / (size or 1.0))


def _root(W: Array) -> Array:
    """Return L with L L' = W, W positive semidefinite up to rounding."""
    values, vectors = np.linalg.eigh((W + W.T) / 2)
    return vectors * np.sqrt(np.maximum(values, 0.0))


def _fractions(parts: Array, names: Sequence[str]) -> dict[str, float]:
    total = float(parts.sum())
    return {name: float(v) / total if total else 0.0 for name, v in zip(names, parts, strict=True)}


def _border_error(model: StateSpace) -> ModelError:
    """Return the reason why the Gramian over all time is not determined, and the mend."""
    roots = structure.poles(model).roots
    rates = structure.rates(np.array([r.value for r in roots]), model.time).real
    k = int(np.argmin(np.abs(rates)))
    worst, hint = roots[k], ", within rounding of the fastest mode" if rates[k] and len(rates) > 1 else ""
    mode = f"mode {structure.pair(worst.value)} in {structure.direction_text(worst.states)}"
    if _is_off_the_border(model):
        return ModelError(
            f"the Gramian over all time is not determined in double precision: {mode} is off the border of stability, "
            f"but rounding errors of {EPS:.0e} in the coefficients may change the Gramian by more than its own size; "
            f"{BETTER_COORDINATES}"
        )
    return ModelError(
        f"the model has no Gramian over all time: {mode} lies on the border of stability{hint}; close a loop around "
        "it, take it out of the model, or integrate over a horizon with `over_horizon`"
    )


def _is_off_the_border(model: StateSpace) -> bool:
    """Tell whether rounding of A moves no pole by more than OFF_BORDER of its distance from the border of stability."""
    x = staircase.of_model(model).x
    A = model.A * x / x[:, None]
    values, w, v = scipy.linalg.eig(A, left=True)
    continuous = isinstance(model.time, Continuous)
    distance = np.abs(values.real if continuous else 1 - np.abs(values))
    with np.errstate(divide="ignore", invalid="ignore"):  # a double pole has w'v = 0 and moves without bound
        shifts = EPS * np.abs(w).T @ np.abs(A).sum(axis=1) / np.abs((w.conj() * v).sum(axis=0))
    return bool((shifts < OFF_BORDER * distance).all())
