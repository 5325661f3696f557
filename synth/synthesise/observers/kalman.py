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
"""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from synth import arguments, show
from synth.analyse.numerics import precise
from synth.analyse.structure import structure
from synth.errors import ModelError
from synth.statespace import Array, StateSpace, System, of, readonly
from synth.synthesise.observers import noise
from synth.synthesise.riccati import modes, riccati, solvability, weights
from synth.timing import Continuous, Discrete, common, period


@show.result
class Estimator:
    """The gains L and M (n, p) of a filter and its error covariances (n, n), `prior` and `posterior` to a sample.

    `model` has the inputs that the filter knows, and its time; `noise` acts on its states and outputs.
    """

    model: StateSpace
    noise: noise.Noise
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
        tables.append(modes.table(self.poles, model.time))
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
    G: noise.NoiseInput = None,
    S: ArrayLike | None = None,
) -> Estimator:
    """Return the filter of a model in its own time: `continuous` for densities or `discrete` for covariances.

    Arguments and errors as for `continuous`.
    """
    return steady(noise.white(of(system), W, V, G, S))


@arguments.checked
def continuous(
    system: System,
    W: weights.Weight,
    V: weights.Weight,
    G: noise.NoiseInput = None,
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
    return steady(noise.white(model, W, V, G, S))


@arguments.checked
def discrete(
    system: System,
    W: weights.Weight,
    V: weights.Weight,
    G: noise.NoiseInput = None,
    S: ArrayLike | None = None,
) -> Estimator:
    """Return the filter of a sampled model for the covariances W (q, q), V (p, p) and S (q, p) at each sample.

    Arguments and errors as for `continuous`; TimingError for a continuous model.
    """
    model = of(system)
    period(model.time)
    return steady(noise.white(model, W, V, G, S))


@arguments.checked
def kalmd(
    system: System,
    W: weights.Weight,
    V: weights.Weight,
    period_s: float,
    G: noise.NoiseInput = None,
) -> Estimator:
    """Return the discrete filter of a continuous model with w of density W (q, q), sampled with `period_s`.

    V (p, p) is the covariance of each sample. Arguments and errors as for `continuous`; also SignalError when w has a
    direct path to an output.
    """
    return steady(noise.sampled(system, W, V, period_s, G))


@arguments.checked
def steady(noisy: noise.NoisyModel) -> Estimator:
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


def _require_noise_on_boundary(model: StateSpace, e: noise.Noise) -> None:
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
