"""Steady-state Kalman filters.

                       w              v
                       |              |
                       v              v
               u -->[plant]--------->(+)--> y         x' = A x + B u + G w,   y = C x + D u + v

    continuous   w, v white of the densities W and V, cross density S
    discrete     x+ in place of x'; W, V and S are covariances at each sample
    sampled      the continuous plant with w of density W, u held over T, y taken each T with the covariance V

P, the covariance of x - x^ before a sample, solves the Riccati equation of the regulator for (A', C') with the weights
G W G', V and G S (duality). With the innovation e = y - C x^ - D u

    predictor    x^' = A x^ + B u + L e,    L = (P C' + G S) V^-1
                 x^+ = A x^ + B u + L e,    L = (A P C' + G S) (C P C' + V)^-1,              A - L C stable
    current      x^ + M e,                  M = P C' (C P C' + V)^-1,  P_after = (I - M C) P (I - M C)' + M V M'

so that the current estimate has used the sample of its own instant, the predictor's only those before. In continuous
time M is 0 and the two are one. Source: Anderson, Moore, Optimal Filtering (1979), chapters 4 and 5.
"""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from synth import arguments, show
from synth.analyse import precise, structure
from synth.errors import ModelError
from synth.statespace import Array, StateSpace, System, of, readonly
from synth.synthesise.feedback import modes, weights
from synth.synthesise.observers import noise
from synth.synthesise.riccati import riccati, solvability
from synth.timing import Continuous, Discrete, common, period


@show.result
class Estimator:
    """The gains L and M (n, p) of a filter and the covariances of its error (n, n), before and after a sample.

    `model` has the inputs that the filter knows, and its time; `noise` is that on its states and outputs.
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
        """Return the filter from u and y to ``<state>_estimate``, which has used the samples before its own."""
        n, p = self.L.shape
        return self._form("estimate", np.eye(n), np.zeros((n, p)))

    def current(self) -> StateSpace:
        """Return the filter from u and y to ``<state>_estimate``, which has used the sample of its own instant."""
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
        """Return the errors to expect with the gains, the innovation and the certificate."""
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
                "The weights are the noises here: none reaches that mode, which the filter knows but for its start",
            )
        title = f"Kalman filter of {', '.join(model.states)} from {', '.join(model.outputs)} in {model.time}"
        return show.Sheet(title, lines, tuple(tables))


@arguments.checked
def continuous(
    system: System,
    W: weights.Weight,
    V: weights.Weight,
    G: noise.Entry = None,
    S: ArrayLike | None = None,
    exact: bool = False,
) -> Estimator:
    """Return the filter of a continuous model for the densities W (q, q), V (p, p) and S (q, p), 0 if left out.

    W and V are matrices, diagonals or {name: density}; W is of the inputs named in G, of the columns w1, w2.. of the
    matrix G (n, q), or of one noise on each state. `exact` rounds each entry of P and L correctly, alike on every
    machine.

    Raises TimingError for a sampled model; SignalError for what does not fit, is not finite, asymmetric or indefinite;
    ModelError when a combination of outputs has no noise, or naming a mode that does not decay and that no output
    shows, or a mode on the stability boundary that no noise reaches.
    """
    model = of(system)
    common(Continuous(), model.time)
    return steady(noise.white(model, W, V, G, S), exact)


@arguments.checked
def discrete(
    system: System,
    W: weights.Weight,
    V: weights.Weight,
    G: noise.Entry = None,
    S: ArrayLike | None = None,
    exact: bool = False,
) -> Estimator:
    """Return the filter of a sampled model for the covariances W (q, q), V (p, p) and S (q, p) at each sample.

    Arguments and errors as for `continuous`; TimingError for a continuous model.
    """
    model = of(system)
    period(model.time)
    return steady(noise.white(model, W, V, G, S), exact)


@arguments.checked
def sampled(
    system: System, W: weights.Weight, V: weights.Weight, period_s: float, G: noise.Entry = None, exact: bool = False
) -> Estimator:
    """Return the filter at samples each `period_s` of a continuous model with w of density W (q, q).

    V (p, p) is the covariance of each sample. Arguments and errors as for `continuous`; SignalError, too, when w
    reaches an output at once.
    """
    return steady(noise.sampled(system, W, V, period_s, G, exact), exact)


@arguments.checked
def steady(noisy: noise.Noisy, exact: bool = False) -> Estimator:
    """Return the filter of a model, in its own time, with its noise. Raises ModelError as `continuous`."""
    model, e = noisy.model, noisy.noise
    n, p = model.C.T.shape
    structure.require_detectable(model.A, model.C, model.states, "C", model.time)
    _require_reached(model, e)
    dual = StateSpace(
        model.A.T, model.C.T, np.eye(n), np.zeros((n, p)), model.states, model.outputs, model.states, model.time
    )
    found = riccati.solve(dual, e.W, e.V, e.S, exact=exact)
    M, posterior = (np.zeros((n, p)), found.X) if isinstance(model.time, Continuous) else _after(found.X, model.C, e.V)
    return Estimator(model, e, readonly(found.L.T), readonly(M), found.X, readonly(posterior), found)


def _require_reached(model: StateSpace, e: noise.Noise) -> None:
    """Raise ModelError naming the first mode on the stability boundary that no noise reaches, w given v."""
    across = np.linalg.solve(e.V, e.S.T)
    A, W = model.A - across.T @ model.C, e.W - e.S @ across
    for mode in solvability.boundary_modes(A.T, W, model.states, model.time):
        who = ", ".join(mode.states)
        raise ModelError(
            f"(A, G W^1/2) is not stabilisable: no noise reaches the mode {show.number(mode.value, 4)} in {who}, which "
            "neither grows nor decays, so that its filter would not settle: give "
            f"{who} noise or take it out of the model"
        )


def _after(P: Array, C: Array, V: Array) -> tuple[Array, Array]:
    """Return M and the covariance after a sample, each entry rounded once."""
    with precise.precision():
        p, c, v = precise.matrix(P), precise.matrix(C), precise.matrix(V)
        cp = c * p
        m = precise.middle((cp * c.transpose() + v).solve(cp).transpose())
        rest = precise.identity(len(P)) - m * c
        after = precise.rounded(rest * p * rest.transpose() + m * v * m.transpose())
        return precise.rounded(m), (after + after.T) / 2
