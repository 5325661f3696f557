"""Structure of a linear model: which modes the inputs move and the outputs show (Popov, Belevitch, Hautus).

(A, B) is stabilisable when w^H B != 0 for each left eigenvector w^H A = s w^H of a mode s that does not decay;
(A, C) is detectable when C v != 0 for each right eigenvector of such a mode.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from synth.errors import ModelError
from synth.statespace import StateSpace
from synth.timing import Continuous, Time

MARGIN = 1e-9  # relative: nearer to zero than this a mode counts as neither moved nor shown, or as not decaying


@dataclass(frozen=True)
class Mode:
    """A mode (eigenvalue) with the norm of w^H B or C v, and the states that dominate its direction."""

    value: complex
    measure: float
    states: tuple[str, ...]


def unmoved(A: ArrayLike, B: ArrayLike, states: Sequence[str], time: Time) -> list[Mode]:
    """Return the modes that do not decay and that no input moves; A (n, n), B (n, m)."""
    A, B = np.asarray(A, dtype=float), np.asarray(B, dtype=float)
    values = np.linalg.eigvals(A)
    scale = max(1.0, float(np.abs(A).max()))
    found = []
    for s in values:
        decays = s.real < -MARGIN * scale if isinstance(time, Continuous) else abs(s) < 1 - MARGIN
        if decays:
            continue
        pencil = np.hstack([A - s * np.eye(len(A)), B])
        U, sigma, _ = np.linalg.svd(pencil)
        if sigma[-1] <= MARGIN * max(1.0, float(sigma[0])) * 1e-3:
            found.append(Mode(complex(s), float(sigma[-1]), _dominant(U[:, -1], states)))
    return found


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


def connected(model: StateSpace) -> StateSpace:
    """Return the model without the states that no input reaches or that reach no output, told by zeros of A, B, C.

    The response stays the same to the last bit.
    """
    moves = model.A != 0
    reached, seen = (model.B != 0).any(axis=1), (model.C != 0).any(axis=0)
    for _ in range(len(model.A)):
        reached, seen = reached | moves[:, reached].any(axis=1), seen | moves[seen].any(axis=0)
    keep = np.flatnonzero(reached & seen)
    states = tuple(model.states[i] for i in keep)
    return replace(model, A=model.A[np.ix_(keep, keep)], B=model.B[keep], C=model.C[:, keep], states=states)


def _dominant(vector: NDArray[np.complex128], states: Sequence[str]) -> tuple[str, ...]:
    size = np.abs(vector)
    return tuple(states[i] for i in np.argsort(-size) if size[i] > 0.1 * size.max())


def _number(value: complex) -> str:
    return f"{value.real:.4g}" if abs(value.imag) < 1e-9 else f"{value.real:.4g}{value.imag:+.4g}i"
