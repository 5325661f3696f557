"""What is believed of the state of a sampled model, x+ = A x + B u + w, y = C x + D u + v, w and v white.

A belief is a mean x and a covariance P = S S', kept as its root S, so that P is symmetric and semidefinite whatever is
rounded (Kaminski, Bryson, Schmidt 1971). With orthogonal factors on the left that make the right side triangular

    predict    [S' A'; W^1/2']                     ->  S'                        x <- A x + B u
    update     [V^1/2', 0; S' C', S']              ->  [E', J'; 0, S'],          x <- x + J E^-1 (y - C x - D u)

Each belief is a new one. A sample that is missing is no update; several sensors at unlike rates are one update each.
"""

from collections.abc import Mapping, Sequence
from dataclasses import field, replace

import numpy as np
import scipy.linalg
from numpy.typing import ArrayLike

from synth import arguments, show
from synth.errors import ModelError, SignalError
from synth.statespace import Array, StateSpace, System, of, readonly
from synth.synthesise.feedback import weights
from synth.timing import period

Values = ArrayLike | Mapping[str, float]
"""One number for each signal, as an array or by name."""


@show.result
class Belief:
    """The mean x (n,) of named states and a root (n, n) of its covariance P = root root'."""

    x: Array
    root: Array
    states: tuple[str, ...]
    units: Mapping[str, str] = field(default_factory=dict)

    @property
    def P(self) -> Array:
        """The covariance (n, n)."""
        return readonly(self.root @ self.root.T)

    def sheet(self) -> show.Sheet:
        """Return each state with its standard deviation."""
        values = np.column_stack([self.x, np.linalg.norm(self.root, axis=1)])
        rows = [show.named(name, self.units.get(name, "")) for name in self.states]
        table = show.matrix("state", values, rows, ("mean", "deviation"))
        return show.Sheet(f"Belief of {len(rows)} states", tables=(table,))


@arguments.checked
def initial(system: System, P: weights.Weight, x: Values | None = None) -> Belief:
    """Return the belief before the first sample: covariance P (n, n) and mean x (n,), 0 if left out.

    Raises SignalError for what does not fit, is not finite, asymmetric or indefinite.
    """
    model = of(system)
    mean = np.zeros(len(model.states)) if x is None else _vector("x", x, model.states)
    root = _root(weights.semidefinite("P", P, model.states))
    return Belief(readonly(mean), readonly(root), model.states, model.units)


@arguments.checked
def predict(belief: Belief, system: System, W: weights.Weight, u: Values | None = None) -> Belief:
    """Return the belief one sample later; W (n, n) is the covariance on the states, u (m,) the input, 0 if left out.

    For a plant in continuous time `noise.sampled` gives the model and W.

    Raises TimingError for a continuous model; SignalError for what does not fit, is not finite, asymmetric or
    indefinite.
    """
    model = _matching(belief, system)
    W = _root(weights.semidefinite("W", W, model.states))
    n = len(model.states)
    root = _triangular(np.vstack([(model.A @ belief.root).T, W.T]))
    moved = np.zeros(n) if u is None else model.B @ _vector("u", u, model.inputs)
    return replace(belief, x=readonly(model.A @ belief.x + moved), root=readonly(root.T))


@arguments.checked
def update(belief: Belief, system: System, V: weights.Weight, y: Values, u: Values | None = None) -> Belief:
    """Return the belief after a sample y of all outputs (p,), or of some by name; V (p, p) is its covariance.

    Raises TimingError for a continuous model; SignalError for what does not fit, is not finite, asymmetric or
    indefinite, and when an output depends on an input that is not given; ModelError when a combination of outputs is
    known without noise already.
    """
    model = _matching(belief, system)
    names = tuple(y) if isinstance(y, Mapping) else model.outputs
    if not names:
        return belief
    part = model.select(names, model.inputs)
    if u is None and part.D.any():
        raise SignalError(f"{', '.join(names)} depend on {', '.join(model.inputs)} at once: give u")
    rows = [model.outputs.index(name) for name in names]
    V = _root(weights.semidefinite("V", V, model.outputs)[np.ix_(rows, rows)])
    S, p, n = belief.root, len(names), len(model.states)
    R = _triangular(np.block([[V.T, np.zeros((p, n))], [(part.C @ S).T, S.T]]))
    E, J = R[:p, :p].T, R[:p, p:].T
    sizes = np.sqrt((E**2).sum(axis=1))
    if (np.abs(np.diag(E)) <= 1e-14 * sizes).any() or not sizes.all():
        raise ModelError(
            f"a combination of {', '.join(names)} is known without noise before it is measured: give each output noise "
            "in V, or leave out what is known"
        )
    through = np.zeros(p) if u is None else part.D @ _vector("u", u, model.inputs)
    e = _vector("y", y, names) - part.C @ belief.x - through
    x = belief.x + J @ scipy.linalg.solve_triangular(E, e, lower=True)
    return replace(belief, x=readonly(x), root=readonly(R[p:, p:].T))


def _matching(belief: Belief, system: System) -> StateSpace:
    model = of(system)
    period(model.time)
    if model.states != belief.states:
        raise SignalError(f"the belief is of {', '.join(belief.states)}, the model of {', '.join(model.states)}")
    return model


def _vector(what: str, values: Values, names: Sequence[str]) -> Array:
    if isinstance(values, Mapping):
        if unlike := sorted(set(values) ^ set(names)):
            raise SignalError(
                f"{what} is given for {', '.join(values)}: '{unlike[0]}' is not in {', '.join(names)} too"
            )
        values = [values[name] for name in names]
    vector = arguments.real(f"values of {what}", values)
    if vector.shape != (len(names),) or not np.isfinite(vector).all():
        raise SignalError(
            f"{what} is {vector}: give finite numbers for {', '.join(names)}; leave out a sample that is missing"
        )
    return vector


def _root(P: Array) -> Array:
    """Return S (n, n) with S S' = P; P is scaled to a diagonal of 1, so that small entries keep their digits."""
    size = np.sqrt(np.diag(P))
    d = np.where(size > 0, size, 1.0)
    values, vectors = scipy.linalg.eigh(P / d / d[:, None])
    return np.asarray(d[:, None] * vectors * np.sqrt(np.maximum(values, 0.0)), dtype=np.float64)


def _triangular(M: Array) -> Array:
    """Return the triangular factor R (n, n) of M (k, n), k >= n: R'R = M'M.

    The largest rows come first, so that reflections do not lose the small ones (Powell, Reid 1969).
    """
    order = np.argsort(-np.abs(M).max(axis=1, initial=0.0), kind="stable")
    return np.asarray(scipy.linalg.qr(M[order], mode="economic")[1], dtype=np.float64)
