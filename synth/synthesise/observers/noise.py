"""White noise on a linear model: x' = A x + B u + G w, y = C x + D u + F w + v (x+ in discrete time).

With E w w' = W, E v v' = V and E w v' = S (densities in continuous time, covariances at each sample in discrete time)
the noise on states and outputs has

    W_x = G W G',    V_y = V + F W F' + F S + S' F',    S_xy = G (W F' + S)

A continuous model whose inputs are held over T has W_T = int_0^T exp(A s) G W G' exp(A' s) ds over one period.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import scipy.linalg
from numpy.typing import ArrayLike

from synth import arguments, show
from synth.analyse import discretise
from synth.analyse.numerics import precise
from synth.errors import ModelError, SignalError
from synth.statespace import Array, StateSpace, System, of, readonly
from synth.synthesise.riccati import exact_lyapunov, weights
from synth.timing import Continuous, Time

NoiseInput = ArrayLike | Sequence[str] | None
"""Where w enters: a matrix G (n, q); names of inputs, which are then noise; None for one noise on each state."""

EIGENVALUE_ROUNDING = 1e-12  # of a covariance scaled to a diagonal of 1: an eigenvalue below it counts as zero
DOUBLINGS = 80  # of the time span of the sum; the slowest decay in discrete time needs 2^40
DECAYED = 2.0**-60  # of the largest power of A so far: a smaller power ends the sum
# The squares of variances in it, times those of a model, stay finite in double precision.
VARIANCE_RANGE = (1e-100, 1e100)


@dataclass(frozen=True, eq=False)
class Noise:
    """Covariances or densities of the noise on the states, W (n, n), on the outputs, V (p, p), and across, S (n, p)."""

    W: Array
    V: Array
    S: Array


@dataclass(frozen=True, eq=False)
class NoisyModel:
    """A model, all of its inputs known, with its noise."""

    model: StateSpace
    noise: Noise


@dataclass(frozen=True, eq=False)
class _NoiseInputs:
    """A model without its noise inputs, the input matrices G (n, q), F (p, q) of w and the names of w."""

    model: StateSpace
    G: Array
    F: Array
    inputs: tuple[str, ...]


@arguments.checked
def white(
    system: System, W: weights.Weight, V: weights.Weight, G: NoiseInput = None, S: ArrayLike | None = None
) -> NoisyModel:
    """Return a model in its own time with w of W (q, q), v of V (p, p) and E w v' = S (q, p).

    Raises SignalError for arguments of the wrong shape, not finite, asymmetric or indefinite; ModelError when a
    combination of outputs has no noise.
    """
    entered = _split_inputs(of(system), G)
    outputs = entered.model.outputs
    W, V = weights.semidefinite("W", W, entered.inputs), weights.semidefinite("V", V, outputs)
    S = np.zeros((len(W), len(V))) if S is None else arguments.matrix("S", S)
    if S.shape != (len(W), len(V)) or not np.isfinite(S).all():
        raise SignalError(f"S is {S.shape}: {len(W)} noises and {len(V)} outputs need a finite {(len(W), len(V))}")
    if _least_eigenvalue(np.block([[W, S], [S.T, V]]))[0] < -EIGENVALUE_ROUNDING:
        raise SignalError("S is larger than W and V allow: [[W, S], [S', V]] must be positive semidefinite; lower S")
    with precise.precision():
        g, f, w, v, s = (precise.matrix(part) for part in (entered.G, entered.F, W, V, S))
        ft = f.transpose()
        states, measured = g * w * g.transpose(), v + f * w * ft + f * s + s.transpose() * ft
        noise = Noise(*(readonly(precise.rounded(part)) for part in (states, measured, g * (w * ft + s))))
    _require_size(noise, entered.model)
    _require_measurement(noise.V, outputs)
    return NoisyModel(entered.model, noise)


@arguments.checked
def sampled(system: System, W: weights.Weight, V: weights.Weight, period_s: float, G: NoiseInput = None) -> NoisyModel:
    """Return a continuous model with w of density W (q, q) held over `period_s`; each sample has V (p, p).

    Each entry of the process noise is rounded once, with the same result on every machine.

    Raises TimingError for a sampled model or a period that is not positive; SignalError as `white`, and for a w with a
    direct path to an output, whose samples have no finite covariance; ModelError as `white` and `discretise.gramian`.
    """
    entered = _split_inputs(of(system), G)
    model = entered.model
    if entered.F.any():
        j = int(np.flatnonzero(entered.F.any(axis=1))[0])
        raise SignalError(
            f"white noise has a direct path to {model.outputs[j]}, whose samples have no finite covariance: put the "
            "sensor's bandwidth into the model"
        )
    held = discretise.zero_order_hold(model, period_s)
    W = weights.semidefinite("W", W, entered.inputs)
    with precise.precision():
        g = precise.matrix(entered.G)
        density = precise.rounded(g * precise.matrix(W) * g.transpose())
    process = discretise.gramian(model.A.T, density, period_s).W
    V = weights.semidefinite("V", V, model.outputs)
    noise = Noise(process, readonly(V), readonly(np.zeros(model.C.T.shape)))
    _require_size(noise, model)
    _require_measurement(V, model.outputs)
    return NoisyModel(held, noise)


@arguments.checked
def stationary(A: ArrayLike, W: ArrayLike, time: Time) -> Array:
    """Return the stationary covariance X (n, n) of x' = A x + w, or x+ = A x + w, for white w of W (n, n).

        A X + X A' + W = 0,     A X A' + W = X

    Each entry of X is rounded once, from ball arithmetic.

    Raises ModelError naming a pole that does not decay by more than rounding error, or as `precise.round_correctly`.
    """
    A = arguments.matrix("A", A)
    A, W = arguments.matrix_of_shape("A", A, len(A), len(A)), arguments.matrix_of_shape("W", W, len(A), len(A))
    if (pole := exact_lyapunov.unstable_pole(A, time)) is not None:
        raise ModelError(
            f"the pole {show.number(pole)} does not decay, and the covariance is unbounded: stabilise it or take "
            "it out of the model"
        )
    if not len(A):
        return readonly(W)
    F, balls, continuous = precise.matrix(A.T), precise.matrix(W), isinstance(time, Continuous)
    X = precise.round_correctly(lambda: exact_lyapunov.solution(F, balls, continuous), "the stationary covariance")
    return readonly((X + X.T) / 2)


def _split_inputs(model: StateSpace, G: NoiseInput) -> _NoiseInputs:
    n, p = len(model.states), len(model.outputs)
    if not n or not p:
        raise SignalError(f"the model has {n} states and {p} outputs: a filter needs one of each at least")
    if G is None:
        return _NoiseInputs(model, np.eye(n), np.zeros((p, n)), model.states)
    if names := _noise_names(G):
        noisy = model.select(model.outputs, names)
        known = tuple(name for name in model.inputs if name not in names)
        return _NoiseInputs(model.select(model.outputs, known), noisy.B, noisy.D, names)
    G = arguments.matrix("G", G)
    if len(G) != n or not G.size or not np.isfinite(G).all():
        raise SignalError(f"G is {G.shape}: {n} states need a finite matrix of {n} rows, or names of inputs")
    return _NoiseInputs(model, G, np.zeros((p, G.shape[1])), tuple(f"w{k + 1}" for k in range(G.shape[1])))


def _noise_names(G: NoiseInput) -> tuple[str, ...]:
    if isinstance(G, str):
        return (G,)
    entries = tuple(G) if isinstance(G, Sequence) else ()
    return tuple(str(name) for name in entries) if all(isinstance(name, str) for name in entries) else ()


def _least_eigenvalue(covariance: Array) -> tuple[float, Array]:
    """Return the least eigenvalue of a covariance scaled to a diagonal of 1, and its direction."""
    values, vectors = scipy.linalg.eigh(weights.unit_diagonal(covariance))
    return float(values[0]), vectors[:, 0]


def _require_size(noise: Noise, model: StateSpace) -> None:
    """Raise SignalError for a nonzero variance whose square overflows or underflows."""
    sizes = np.concatenate([np.diag(noise.W), np.diag(noise.V)])
    for name, size in zip((*model.states, *model.outputs), sizes, strict=True):
        if size and not VARIANCE_RANGE[0] <= size <= VARIANCE_RANGE[1]:
            raise SignalError(
                f"the noise on {name} has the size {size:.3g}: a filter needs 0 or "
                f"{VARIANCE_RANGE[0]:.0e} .. {VARIANCE_RANGE[1]:.0e}; "
                "choose units in which it is nearer to 1, or take 0 for a negligible noise"
            )


def _require_measurement(V: Array, outputs: Sequence[str]) -> None:
    least, direction = _least_eigenvalue(V)
    if least < EIGENVALUE_ROUNDING:
        part = np.abs(direction) > 0.1 * np.abs(direction).max()
        who = ", ".join(name for name, takes_part in zip(outputs, part, strict=True) if takes_part)
        raise ModelError(
            f"the measurement of {who} has no white noise in some direction: V, scaled to a diagonal of 1, has the "
            f"eigenvalue {least:.1e}; give each output a white noise of its own, or take what is measured without it "
            "as known and estimate the other states by a reduced-order observer"
        )
