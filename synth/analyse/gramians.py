"""How strongly inputs reach the states of a linear model and how well outputs show them.

Energy. With Phi(t) = exp(A t), or A^t in discrete time (sums for integrals),

    Wc = int Phi B B' Phi' dt      x' Wc^-1 x: least input energy int u'u dt that takes 0 to x
    Wo = int Phi' C' C Phi dt      x' Wo x: output energy int y'y dt that x gives
    Hankel singular values         sqrt of the eigenvalues of Wc Wo, which no change of states alters

A model with modes that do not decay has none; `over` integrates to a horizon instead. An input's share is its part of
trace(Wc Wo) = sum of squared Hankel values; shares compare inputs in the units that they have.

Library: no design uses it yet; docs/library.md has an example.
"""

import warnings
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from numbers import Real

import numpy as np
import scipy.linalg

from synth import arguments, show
from synth.analyse import discretise, staircase, structure, transfer
from synth.errors import ModelError, TimingError
from synth.statespace import Array, StateSpace, System, of, readonly
from synth.timing import Continuous

BORDER = 1e12  # Gramians of noise as large as each row of scaled A that exceed this come of a mode on the border

Integral = Callable[[Array, Array], Array]


@dataclass(frozen=True, eq=False)
class _Span:
    """W = `integral(F, Q)` of F'^t Q F^t over some time, and the `edge` that F' W + W F, or F' W F - W, must equal."""

    integral: Integral
    edge: Integral
    text: str


@show.result
class Gramians:
    """Wc (n, n), Wo (n, n) in the units of the states, Hankel singular values (n,), largest first, and shares.

    `directions` has the states of each Hankel value; `by_input` and `by_output` are shares that sum to 1; `residual`
    is the larger one of the two Lyapunov equations, over the size of its terms; `span` says over which time.
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
        relative = self.hankel / (self.hankel.max(initial=0.0) or 1.0)  # its square stays within the range of a double
        part = relative**2 / ((relative**2).sum() or 1.0)
        rows = tuple(
            (f"{v:.4g}", f"{share:.2%}", structure.spelled(along) or "none")
            for v, share, along in zip(self.hankel, part, self.directions, strict=True)
        )
        shares = tuple((n, f"{v:.2%}") for part in (self.by_input, self.by_output) for n, v in part.items())
        tables = (show.Table(("Hankel value", "share", "states"), rows), show.Table(("signal", "share"), shares))
        return show.Sheet(f"Gramians {self.span}; residual {self.residual:.1e}", tables=tables)


@arguments.checked
def gramians(system: System) -> Gramians:
    """Return the Gramians of a System over all time.

    Raises SignalError as `statespace.of`; ModelError naming a mode that does not decay, by more than rounding of A.
    """
    model = of(system)
    x = staircase.of_model(model).x
    A = model.A * x / x[:, None]
    continuous = isinstance(model.time, Continuous)
    moved = np.abs(A).sum(axis=1) if continuous else np.ones(len(A))  # what rounding of A moves of each state
    span = _Span(lambda F, Q: _lyapunov(F, Q, continuous), lambda F, Q: -Q, "over all time")
    try:
        noise = span.integral(A.T, np.diag(moved**2)) if transfer.decay(model.poles, model.time) else np.array([np.inf])
    except (np.linalg.LinAlgError, RuntimeWarning) as error:
        raise _lasting(model) from error
    if len(A) and not np.linalg.norm(noise) < BORDER:
        raise _lasting(model)
    return _gramians(model, np.diag(x), span)


@arguments.checked
def over(system: System, horizon_s: float) -> Gramians:
    """Return the Gramians of a System from 0 to `horizon_s`, rounded to whole samples in discrete time.

    Raises SignalError as `statespace.of`; TimingError when the horizon is not positive or shorter than a sample;
    ModelError as `discretise.gramian`.
    """
    model = of(system)
    X = np.diag(staircase.of_model(model).x)
    if not isinstance(horizon_s, Real):
        raise TimingError(f"the horizon is {horizon_s!r}: give a number of seconds")
    if not 0 < horizon_s < np.inf:
        raise TimingError(f"the horizon is {horizon_s} s: give a finite positive time")
    if isinstance(model.time, Continuous):

        def gathered(F: Array, Q: Array) -> tuple[Array, Array]:
            found = discretise.gramian(F, Q, horizon_s) if len(F) else None
            return (found.W, found.M) if found else (Q, F)

        return _gramians(model, X, _over(f"{horizon_s:g} s", gathered))
    samples = round(horizon_s / model.time.period_s)
    if samples < 1:
        raise TimingError(f"the horizon of {horizon_s:g} s is shorter than a sample of {model.time.period_s:g} s")
    return _gramians(model, X, _over(f"{samples} samples", lambda F, Q: _summed(F, Q, samples)))


def _over(span: str, gathered: Callable[[Array, Array], tuple[Array, Array]]) -> _Span:
    """Return the span of which `gathered` gives W and what the state has become at its end."""

    def edge(F: Array, Q: Array) -> Array:
        M = gathered(F, Q)[1]
        return M.T @ Q @ M - Q

    return _Span(lambda F, Q: gathered(F, Q)[0], edge, f"over {span}")


def _lyapunov(F: Array, Q: Array, continuous: bool) -> Array:
    """Return int exp(F' t) Q exp(F t) dt, or the sum over F'^k Q F^k from 0, of a stable F."""
    if not len(F):
        return Q
    with warnings.catch_warnings():
        warnings.simplefilter("error")  # SciPy warns of modes s + s' near 0 and goes on
        if continuous:
            return np.asarray(scipy.linalg.solve_continuous_lyapunov(F.T, -Q))
        return np.asarray(scipy.linalg.solve_discrete_lyapunov(F.T, Q))


def _inverse(T: Array) -> Array:
    return np.asarray(np.linalg.inv(T), dtype=np.float64)


def _summed(F: Array, Q: Array, samples: int) -> tuple[Array, Array]:
    """Return the sum over F'^k Q F^k for k below `samples`, doubling W(a + b) = W(a) + F'^a W(b) F^a, and F^samples."""
    W, power = np.zeros_like(Q), np.eye(len(F))
    for digit in f"{samples:b}":
        W, power = W + power.T @ W @ power, power @ power
        if digit == "1":
            W, power = Q + F.T @ W @ F, power @ F
    return W, power


def _gramians(model: StateSpace, T: Array, span: _Span) -> Gramians:
    """Return the Gramians, integrated in the coordinates T^-1 x."""
    back = _inverse(T)
    A, B, C = back @ model.A @ T, back @ model.B, model.C @ T
    Wc, Wo = span.integral(A.T, B @ B.T), span.integral(A, C.T @ C)
    left, right = _root(Wo), _root(Wc)
    _, hankel, V = np.linalg.svd(left.T @ right)
    along = (T @ right @ V.T).T / staircase.of_model(model).x
    by_input = np.diag(B.T @ span.integral(A, Wo) @ B)
    by_output = np.diag(C @ span.integral(A.T, Wc) @ C.T)
    continuous = isinstance(model.time, Continuous)
    residuals = [_residual(F, Q, W, span, continuous) for F, Q, W in ((A.T, B @ B.T, Wc), (A, C.T @ C, Wo))]
    return Gramians(
        readonly(T @ Wc @ T.T),
        readonly(back.T @ Wo @ back),
        readonly(hankel),
        tuple(structure.direction(v, model.states) for v in along),
        _shares(by_input, model.inputs),
        _shares(by_output, model.outputs),
        max(residuals),
        span.text,
    )


def _residual(F: Array, Q: Array, W: Array, span: _Span, continuous: bool) -> float:
    left, edge = (F.T @ W + W @ F if continuous else F.T @ W @ F - W), span.edge(F, Q)
    size = np.linalg.norm(F.T @ W) + np.linalg.norm(edge)
    return float(np.linalg.norm(left - edge) / (size or 1.0))


def _root(W: Array) -> Array:
    """Return L with L L' = W, W positive semidefinite up to rounding."""
    values, vectors = np.linalg.eigh((W + W.T) / 2)
    return vectors * np.sqrt(np.maximum(values, 0.0))


def _shares(parts: Array, names: Sequence[str]) -> dict[str, float]:
    total = float(parts.sum())
    return {name: float(v) / total if total else 0.0 for name, v in zip(names, parts, strict=True)}


def _lasting(model: StateSpace) -> ModelError:
    roots = structure.poles(model).roots
    rates = structure.rates(np.array([r.value for r in roots]), model.time).real
    k = int(np.argmax(rates))
    hidden = 0 < abs(rates[k]) <= staircase.COUPLING * np.abs(rates).max()
    worst, near = roots[k], ", within rounding of the fastest mode" if hidden else ""
    return ModelError(
        f"the model has no Gramian over all time: mode {structure.pair(worst.value)} in "
        f"{structure.spelled(worst.states)} does not decay{near}; close a loop around it, take it out of the model, or "
        "take `over` a horizon"
    )
