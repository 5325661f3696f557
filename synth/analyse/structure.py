"""Structure of a linear model: which modes the inputs move and the outputs show (Popov, Belevitch, Hautus).

(A, B) is stabilisable when w^H B != 0 for each left eigenvector w^H A = s w^H of a mode s that does not decay;
(A, C) is detectable when C v != 0 for each right eigenvector of such a mode.

The modes with w^H B = 0 are those of A on the complement of the least subspace that contains B and that A maps into
itself (Kalman). It is built up by orthonormal steps, so that no test hangs on an eigenvalue of A: those of a chain of
integrators scatter by far more than the precision of A.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import scipy.linalg
from numpy.typing import ArrayLike, NDArray

from synth.errors import ModelError
from synth.statespace import Array, StateSpace
from synth.timing import Continuous, Time

COUPLING = 1e-11  # of the balanced matrices' size: what is weaker counts as rounding error and moves nothing
DECAY = 1e-12  # of the size of balanced A: what decays slower counts as not decaying


@dataclass(frozen=True)
class Mode:
    """A mode (eigenvalue) with the norm of w^H B or C v, and the states that dominate its direction."""

    value: complex
    measure: float
    states: tuple[str, ...]


def unmoved(A: ArrayLike, B: ArrayLike, states: Sequence[str], time: Time) -> list[Mode]:
    """Return the modes that do not decay and that no input moves; A (n, n), B (n, m)."""
    A, B = np.asarray(A, dtype=float), np.asarray(B, dtype=float)
    balanced, moved, scaling = _scaled(A, B)
    unreached = scipy.linalg.null_space(_reached(balanced, moved).T)
    values, vectors = np.linalg.eig(unreached.T @ balanced.T @ unreached)
    size = float(np.linalg.norm(balanced))
    found = []
    for s, v in zip(values, vectors.T, strict=True):
        decays = s.real < -DECAY * size if isinstance(time, Continuous) else abs(s) < 1 - DECAY
        if not decays:
            w = (unreached @ v) / scaling
            w /= np.linalg.norm(w)
            found.append(Mode(complex(s), float(np.linalg.norm(w @ B)), _dominant(w, states)))
    return found


def _scaled(A: Array, B: Array) -> tuple[Array, Array, Array]:
    """Return D^-1 A D, D^-1 B E and the diagonal of D: powers of 2 for which entries differ least (Curtis, Reid 1972).

    What is reached must not depend on the units of states, inputs and time: the logarithms of the entries are brought
    together in the least squares sense, those of A at one common rate. Powers of 2 round nothing.
    """
    n, m = B.shape
    both = np.abs(np.hstack([A, B]))
    np.fill_diagonal(both, 0.0)
    rows, columns = np.nonzero(both)
    k = np.arange(len(rows))
    equations = np.zeros((len(rows), n + m + 1))
    equations[k, columns] = 1.0
    equations[k, rows] -= 1.0
    equations[k[columns < n], -1] = -1.0
    exponents = np.round(np.linalg.lstsq(equations, -np.log2(both[rows, columns]), rcond=None)[0])
    D, E = 2.0 ** exponents[:n], 2.0 ** exponents[n:-1]
    return A * D / D[:, None], B * E / D[:, None], D


def require_stabilisable(A: ArrayLike, B: ArrayLike, states: Sequence[str], inputs: Sequence[str], time: Time) -> None:
    """Raise ModelError naming the first mode that does not decay and that none of the `inputs` moves."""
    for mode in unmoved(A, B, states, time):
        who = ", ".join(mode.states)
        raise ModelError(
            f"(A, B) is not stabilisable: mode {_number(mode.value)} in {who} has |w^H B| = {mode.measure:.0e} "
            f"for the inputs {', '.join(inputs)}: actuate {who} or take it out of the model"
        )


def require_detectable(A: ArrayLike, C: ArrayLike, states: Sequence[str], what: str, time: Time) -> None:
    """Raise ModelError naming the first mode that does not decay and that C (p, n), called `what`, does not show."""
    for mode in unmoved(np.asarray(A, dtype=float).T, np.asarray(C, dtype=float).T, states, time):
        who = ", ".join(mode.states)
        raise ModelError(
            f"({what}, A) is not detectable: mode {_number(mode.value)} in {who} has |C v| = {mode.measure:.0e}: "
            f"weight or measure {who}, or take it out of the model"
        )


def has_transmission_zero(model: StateSpace, s: complex) -> bool:
    """Tell whether the Rosenbrock matrix [[A - s I, B], [C, D]] loses row rank at s."""
    rosenbrock = np.block([[model.A - s * np.eye(len(model.A)), model.B], [model.C, model.D]])
    rows, columns = rosenbrock.shape
    if rows > columns:
        return True
    # Rows and columns of like size leave the rank as it is and make the test independent of units.
    for axis in (1, 0) * 5:
        size = np.sqrt(np.abs(rosenbrock).max(axis=axis, keepdims=True))
        rosenbrock = rosenbrock / np.where(size > 0, size, 1.0)
    values = np.linalg.svd(rosenbrock, compute_uv=False)
    return bool(values[-1] <= COUPLING * values[0])


def connected(model: StateSpace) -> StateSpace:
    """Return the model without the states that no input reaches or that reach no output, told by zeros of A, B, C.

    The response is the same function.
    """
    moves = model.A != 0
    reached, seen = (model.B != 0).any(axis=1), (model.C != 0).any(axis=0)
    for _ in range(len(model.A)):
        reached, seen = reached | moves[:, reached].any(axis=1), seen | moves[seen].any(axis=0)
    keep = np.flatnonzero(reached & seen)
    states = tuple(model.states[i] for i in keep)
    return replace(model, A=model.A[np.ix_(keep, keep)], B=model.B[keep], C=model.C[:, keep], states=states)


def _reached(A: Array, B: Array) -> Array:
    """Return an orthonormal basis (n, k) of the least subspace that contains B and that A maps into itself."""
    size = np.linalg.norm(B, axis=0)
    basis = new = _range(B[:, size > 0] / size[size > 0])
    step = A / (np.linalg.norm(A) or 1.0)
    while new.shape[1] and basis.shape[1] < len(A):
        new = step @ new
        for _ in range(2):  # once more for what rounding left
            new = new - basis @ (basis.T @ new)
        new = _range(new)
        basis = np.hstack([basis, new])
    return basis


def _range(M: Array) -> Array:
    U, sigma, _ = np.linalg.svd(M, full_matrices=False)
    return U[:, sigma > COUPLING]


def _dominant(vector: NDArray[np.complex128], states: Sequence[str]) -> tuple[str, ...]:
    size = np.abs(vector)
    return tuple(states[i] for i in np.argsort(-size, kind="stable") if size[i] > 0.1 * size.max())


def _number(value: complex) -> str:
    return f"{value.real:.4g}" if abs(value.imag) < 1e-9 else f"{value.real:.4g}{value.imag:+.4g}i"
