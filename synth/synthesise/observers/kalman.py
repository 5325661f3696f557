"""Steady-state Kalman filter; MATLAB `kalman`, and `kalmd` of a continuous model; python-control `lqe`, `dlqe`.

                       w              v
                       |              |
                       v              v
               u -->[plant]--------->(+)--> y         x' = A x + B u + G w,   y = C x + D u + v

    continuous   w, v white with densities W and V, cross density S
    discrete     x+ in place of x'; W, V and S are covariances at each sample
    sampled      the continuous plant with w of density W, u held over T, y sampled each T with covariance V

P, the covariance of x - x^ before a sample, solves the Riccati equation of the regulator for (A', C') with the weights
G W G', V and G S (duality). With the innovation e = y - C x^ - D u

    predictor    x^' = A x^ + B u + L e,    L = (P C' + G S) V^-1
                 x^+ = A x^ + B u + L e,    L = (A P C' + G S) (C P C' + V)^-1,              A - L C stable
    current      x^ + M e,                  M = P C' (C P C' + V)^-1,  P_after = (I - M C) P (I - M C)' + M V M'

The current estimate uses the sample of the same instant, the predictor only earlier samples. In continuous time M is 0
and the two are equal. Source: Anderson, Moore, Optimal Filtering (1979), chapters 4 and 5.

White noise on a linear model: x' = A x + B u + G w, y = C x + D u + F w + v (x+ in discrete time).

With E w w' = W, E v v' = V and E w v' = S (densities in continuous time, covariances at each sample in discrete time)
the noise on states and outputs has

    W_x = G W G',    V_y = V + F W F' + F S + S' F',    S_xy = G (W F' + S)

A continuous model whose inputs are held over T has W_T = int_0^T exp(A s) G W G' exp(A' s) ds over one period.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import scipy.linalg
from numpy.typing import ArrayLike, NDArray

from synth import arguments, show
from synth.analyse import discretise
from synth.analyse.numerics import precise
from synth.analyse.structure import structure
from synth.errors import ModelError, SignalError
from synth.statespace import Array, StateSpace, System, of, readonly
from synth.synthesise.riccati import exact, riccati, solvability, weights
from synth.timing import Continuous, Discrete, Time, common, period

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
    if (pole := exact.unstable_pole(A, time)) is not None:
        raise ModelError(
            f"the pole {show.number(pole)} does not decay, and the covariance is unbounded: stabilise it or take "
            "it out of the model"
        )
    if not len(A):
        return readonly(W)
    F, balls, continuous = precise.matrix(A.T), precise.matrix(W), isinstance(time, Continuous)
    X = precise.round_correctly(lambda: exact.solution(F, balls, continuous), "the stationary covariance")
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


@show.result
class Estimator:
    """The gains L and M (n, p) of a filter and its error covariances (n, n), `prior` and `posterior` to a sample.

    `model` has the inputs that the filter knows, and its time; `noise` acts on its states and outputs.
    """

    model: StateSpace
    noise: Noise
    L: Array
    M: Array
    prior: Array
    posterior: Array
    certificate: riccati.Riccati

    @property
    def poles(self) -> NDArray[np.complex128]:
        """Eigenvalues of A - L C, in 1/s or in z."""
        return self.certificate.poles

    @property
    def deviations(self) -> dict[str, float]:
        """The standard deviation of each state's error after a sample, in the state's unit."""
        return dict(zip(self.model.states, np.sqrt(np.diag(self.posterior)).tolist(), strict=True))

    def predictor(self) -> StateSpace:
        """Return the filter from u and y to ``<state>_estimate`` that uses only earlier samples."""
        n, p = self.L.shape
        return self._form("estimate", np.eye(n), np.zeros((n, p)))

    def current(self) -> StateSpace:
        """Return the filter from u and y to ``<state>_estimate`` that also uses the sample of the same instant."""
        return self._form("predicted", np.eye(len(self.M)) - self.M @ self.model.C, self.M)

    def _form(self, kind: str, H: Array, M: Array) -> StateSpace:
        model, L = self.model, self.L
        states, estimates = (tuple(f"{name}_{ending}" for name in model.states) for ending in (kind, "estimate"))
        units = dict(model.units)
        for name in set(model.states) & set(model.units):
            units[f"{name}_{kind}"] = units[f"{name}_estimate"] = model.units[name]
        B, D = np.hstack([model.B - L @ model.D, L]), np.hstack([-M @ model.D, M])
        known = (*model.inputs, *model.outputs)
        return StateSpace(model.A - L @ model.C, B, H, D, states, known, estimates, model.time, units)

    def sheet(self) -> show.Sheet:
        """Return the standard deviations of the error with the gains, the innovation and the certificate."""
        model, c = self.model, self.certificate
        sampled = isinstance(model.time, Discrete)
        parts = [("deviation before a sample", self.prior), ("after it", self.posterior)]
        parts = parts if sampled else [("deviation", self.prior)]
        gains = [("L", self.L), ("M", self.M)] if sampled else [("L", self.L)]
        columns = (*(head for head, _ in parts), *(f"{letter} {y}" for letter, _ in gains for y in model.outputs))
        values = np.column_stack([*(np.sqrt(np.diag(P)) for _, P in parts), *(gain for _, gain in gains)])
        tables = [show.matrix("state", values, model.labels(model.states), columns)]
        if sampled:
            size = np.sqrt(np.diag(model.C @ self.prior @ model.C.T + self.noise.V))[:, None]
            tables.append(show.matrix("output", size, model.labels(model.outputs), ("deviation of the innovation",)))
        tables.append(weights.table(self.poles, model.time))
        lines = ("P is the X of the dual Riccati equation:", *c.lines())
        if c.mirrored:
            lines += (
                "The weights are the noises here: none excites that mode, and the filter only lacks its initial value",
            )
        title = f"Kalman filter of {', '.join(model.states)} from {', '.join(model.outputs)} in {model.time}"
        return show.Sheet(title, lines, tuple(tables))


@arguments.checked
def kalman(
    system: System,
    W: weights.Weight,
    V: weights.Weight,
    G: NoiseInput = None,
    S: ArrayLike | None = None,
) -> Estimator:
    """Return the filter of a model in its own time: `continuous` for densities or `discrete` for covariances.

    Arguments and errors as for `continuous`.
    """
    return steady(white(of(system), W, V, G, S))


@arguments.checked
def continuous(
    system: System,
    W: weights.Weight,
    V: weights.Weight,
    G: NoiseInput = None,
    S: ArrayLike | None = None,
) -> Estimator:
    """Return the filter of a continuous model for the densities W (q, q), V (p, p) and S (q, p), 0 if left out.

    W and V are matrices, diagonals or {name: density}; W belongs to the inputs named in G, to the columns w1, w2.. of
    the matrix G (n, q), or to one noise on each state. Inputs named in G are noise alone and not inputs of the filter;
    for noise on a control, give G as its column of B. Each entry of P and L is
    rounded correctly, with the same result on every machine.

    Raises TimingError for a sampled model; SignalError for arguments of the wrong shape, not finite, asymmetric or
    indefinite; ModelError when a combination of outputs has no noise, naming a mode that is not detectable, or a mode
    on the stability boundary that no noise excites.
    """
    model = of(system)
    common(Continuous(), model.time)
    return steady(white(model, W, V, G, S))


@arguments.checked
def discrete(
    system: System,
    W: weights.Weight,
    V: weights.Weight,
    G: NoiseInput = None,
    S: ArrayLike | None = None,
) -> Estimator:
    """Return the filter of a sampled model for the covariances W (q, q), V (p, p) and S (q, p) at each sample.

    Arguments and errors as for `continuous`; TimingError for a continuous model.
    """
    model = of(system)
    period(model.time)
    return steady(white(model, W, V, G, S))


@arguments.checked
def kalmd(
    system: System,
    W: weights.Weight,
    V: weights.Weight,
    period_s: float,
    G: NoiseInput = None,
) -> Estimator:
    """Return the discrete filter of a continuous model with w of density W (q, q), sampled with `period_s`.

    V (p, p) is the covariance of each sample. Arguments and errors as for `continuous`; also SignalError when w has a
    direct path to an output.
    """
    return steady(sampled(system, W, V, period_s, G))


@arguments.checked
def steady(noisy: NoisyModel) -> Estimator:
    """Return the steady-state filter of a model with its noise, in its own time. Raises ModelError as `continuous`."""
    model, e = noisy.model, noisy.noise
    n, p = model.C.T.shape
    structure.require_detectable(model.A, model.C, model.states, "C", model.time)
    _require_noise_on_boundary(model, e)
    dual = StateSpace(
        model.A.T, model.C.T, np.eye(n), np.zeros((n, p)), model.states, model.outputs, model.states, model.time
    )
    solution = riccati.solve(dual, e.W, e.V, e.S)
    M, posterior = (
        (np.zeros((n, p)), solution.X)
        if isinstance(model.time, Continuous)
        else _measurement_update(solution.X, model.C, e.V)
    )
    return Estimator(model, e, readonly(solution.L.T), readonly(M), solution.X, readonly(posterior), solution)


def _require_noise_on_boundary(model: StateSpace, e: Noise) -> None:
    """Raise ModelError naming the first mode on the stability boundary that no noise excites, w given v."""
    across = np.linalg.solve(e.V, e.S.T)
    A, W = model.A - across.T @ model.C, e.W - e.S @ across
    for mode in solvability.unobservable_boundary_modes(A.T, W, model.states, model.time):
        who = ", ".join(mode.states)
        raise ModelError(
            f"(A, G W^1/2) is not stabilisable: no noise excites the mode {show.number(mode.value, 4)} in {who}, which "
            "neither grows nor decays by more than rounding errors of the fastest mode, and the filter would not "
            f"converge: give {who} noise or take it out of the model"
        )


def _measurement_update(P: Array, C: Array, V: Array) -> tuple[Array, Array]:
    """Return M and the posterior covariance (Joseph form), each entry rounded once."""
    with precise.precision():
        p, c, v = precise.matrix(P), precise.matrix(C), precise.matrix(V)
        cp = c * p
        m = (cp * c.transpose() + v).solve(cp).transpose().mid()
        joseph = precise.identity(len(P)) - m * c
        posterior = precise.rounded(joseph * p * joseph.transpose() + m * v * m.transpose())
        return precise.rounded(m), (posterior + posterior.T) / 2
