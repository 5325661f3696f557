"""Square-root Kalman filter: one prediction or correction per call; `filterpy` SquareRootKalmanFilter.

    x+ = A x + B u + w,  y = C x + D u + v,  w and v white with covariances W and V

The estimate is a mean x and a covariance P = S S'. Only the root S is stored, so P stays symmetric and positive
semidefinite in spite of rounding (Kaminski, Bryson, Schmidt 1971). A QR decomposition makes the right side triangular:

    predict    [S' A'; W^1/2']                     ->  S'                        x <- A x + B u
    update     [V^1/2', 0; S' C', S']              ->  [E', J'; 0, S'],          x <- x + J E^-1 (y - C x - D u)

Each call returns a new estimate. For a missing sample leave the update out; sensors with different rates take one
update each.
"""

from collections.abc import Mapping, Sequence
from dataclasses import field, replace

import numpy as np
import scipy.linalg
from numpy.typing import ArrayLike

from synth import arguments, show
from synth.errors import ModelError, SignalError
from synth.statespace import Array, StateSpace, System, of, readonly
from synth.synthesise.riccati import weights
from synth.timing import period

Values = ArrayLike | Mapping[str, float]
"""One number for each signal, as an array or by name."""


@show.result
class StateEstimate:
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
        rows = [show.with_unit(name, self.units.get(name, "")) for name in self.states]
        table = show.matrix("state", values, rows, ("mean", "deviation"))
        return show.Sheet(f"Estimate of {len(rows)} states", tables=(table,))


@arguments.checked
def initial(system: System, P: weights.Weight, x: Values | None = None) -> StateEstimate:
    """Return the estimate before the first sample: covariance P (n, n) and mean x (n,), 0 if left out.

    Raises SignalError for a P or x of the wrong shape, not finite, asymmetric or indefinite.
    """
    model = of(system)
    mean = np.zeros(len(model.states)) if x is None else _vector("x", x, model.states)
    root = _square_root(weights.semidefinite("P", P, model.states))
    return StateEstimate(readonly(mean), readonly(root), model.states, model.units)


@arguments.checked
def predict(estimate: StateEstimate, system: System, W: weights.Weight, u: Values | None = None) -> StateEstimate:
    """Return the prediction one sample later; W (n, n) is the process noise, u (m,) the input, 0 if left out.

    For a plant in continuous time `kalman.sampled` gives the model and W.

    Raises TimingError for a continuous model; SignalError for a W or u of the wrong shape, not finite, asymmetric or
    indefinite.
    """
    model = _check_states(estimate, system)
    W = _square_root(weights.semidefinite("W", W, model.states))
    n = len(model.states)
    root = _triangular(np.vstack([(model.A @ estimate.root).T, W.T]))
    driven = np.zeros(n) if u is None else model.B @ _vector("u", u, model.inputs)
    return replace(estimate, x=readonly(model.A @ estimate.x + driven), root=readonly(root.T))


@arguments.checked
def update(
    estimate: StateEstimate, system: System, V: weights.Weight, y: Values, u: Values | None = None
) -> StateEstimate:
    """Return the corrected estimate after a sample y of all outputs (p,), or of some by name; V (p, p) is its noise.

    Raises TimingError for a continuous model; SignalError for a V, y or u of the wrong shape, not finite, asymmetric or
    indefinite, and when an output depends on an input that is not given; ModelError when the innovation covariance is
    singular.
    """
    model = _check_states(estimate, system)
    names = tuple(y) if isinstance(y, Mapping) else model.outputs
    if not names:
        return estimate
    part = model.select(names, model.inputs)
    if u is None and part.D.any():
        raise SignalError(f"{', '.join(names)} depend directly on {', '.join(model.inputs)}: give u")
    rows = [model.outputs.index(name) for name in names]
    V = _square_root(weights.semidefinite("V", V, model.outputs)[np.ix_(rows, rows)])
    S, p, n = estimate.root, len(names), len(model.states)
    R = _triangular(np.block([[V.T, np.zeros((p, n))], [(part.C @ S).T, S.T]]))
    E, J = R[:p, :p].T, R[:p, p:].T
    sizes = np.sqrt((E**2).sum(axis=1))
    if (np.abs(np.diag(E)) <= 1e-14 * sizes).any() or not sizes.all():
        raise ModelError(
            f"a combination of {', '.join(names)} is known without noise before it is measured: give each output noise "
            "in V, or leave out what is known"
        )
    direct = np.zeros(p) if u is None else part.D @ _vector("u", u, model.inputs)
    e = _vector("y", y, names) - part.C @ estimate.x - direct
    x = estimate.x + J @ scipy.linalg.solve_triangular(E, e, lower=True)
    return replace(estimate, x=readonly(x), root=readonly(R[p:, p:].T))


def _check_states(estimate: StateEstimate, system: System) -> StateSpace:
    model = of(system)
    period(model.time)
    if model.states != estimate.states:
        raise SignalError(f"the estimate is of {', '.join(estimate.states)}, the model of {', '.join(model.states)}")
    return model


def _vector(what: str, values: Values, names: Sequence[str]) -> Array:
    if isinstance(values, Mapping):
        if different := sorted(set(values) ^ set(names)):
            raise SignalError(
                f"{what} is given for {', '.join(values)}: '{different[0]}' is not in {', '.join(names)} too"
            )
        values = [values[name] for name in names]
    vector = arguments.real(f"values of {what}", values)
    if vector.shape != (len(names),) or not np.isfinite(vector).all():
        raise SignalError(
            f"{what} is {vector}: give finite numbers for {', '.join(names)}; leave out a sample that is missing"
        )
    return vector


def _square_root(P: Array) -> Array:
    """Return S (n, n) with S S' = P; scaling P to a diagonal of 1 keeps the digits of small entries."""
    size = np.sqrt(np.diag(P))
    d = np.where(size > 0, size, 1.0)
    values, vectors = scipy.linalg.eigh(P / d / d[:, None])
    return np.asarray(d[:, None] * vectors * np.sqrt(np.maximum(values, 0.0)), dtype=np.float64)


def _triangular(M: Array) -> Array:
    """Return the triangular factor R (n, n) of M (k, n), k >= n: R'R = M'M.

    The rows are sorted, the largest first, to keep the accuracy of the small ones (Powell, Reid 1969).
    """
    order = np.argsort(-np.abs(M).max(axis=1, initial=0.0), kind="stable")
    return np.asarray(scipy.linalg.qr(M[order], mode="economic")[1], dtype=np.float64)
