"""Partition of a model into measured and unmeasured coordinates, for reduced-order observers.

    x1 = y - D u = C x,   x2 = E x,   [x1; x2] = M x

    x1' = A11 x1 + A12 x2 + B1 u
    x2' = A21 x1 + A22 x2 + B2 u          (x+ in discrete time)

y (p,) are the measured signals, C (p, n) their rows, of full rank. E selects the n - p states that are not pivots of a
QR decomposition of the scaled C, which keeps M well conditioned. Where a measured signal is a state, M only reorders.
The blocks are computed in ball arithmetic and rounded once.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import flint
import numpy as np
import scipy.linalg

from synth import arguments, show
from synth.analyse.numerics import precise
from synth.analyse.structure import staircase, structure
from synth.errors import ModelError, SignalError
from synth.statespace import Array, StateSpace, System, of, readonly
from synth.synthesise.riccati.exact_eigenvalues import ball

# Of the largest coefficient of a dependence between outputs: an output with a smaller one is not named.
MIN_NAMED_COEFFICIENT = 0.1


@dataclass(frozen=True, eq=False)
class Partition:
    """The blocks A11 (p, p), A12, A21, A22 and B1 (p, m), B2; M and its inverse (n, n); D (p, m) of the measured y.

    `condition` is that of M in scaled units.
    """

    model: StateSpace
    measured: tuple[str, ...]
    estimated: tuple[str, ...]
    A11: Array
    A12: Array
    A21: Array
    A22: Array
    B1: Array
    B2: Array
    D: Array
    M: Array
    inverse: Array
    condition: float


def of_model(system: System, measured: Sequence[str] | str) -> Partition:
    """Return a model partitioned by its measured signals: outputs, or states whose name no output has.

    Raises SignalError for an unknown or duplicate name, or for none; ModelError when measured signals are linearly
    dependent, when nothing is left to estimate, as in a model without states, or naming a mode that is not detectable.
    """
    model = of(system)
    if not model.states:
        raise ModelError("the model has no states: nothing is left to estimate")
    names = arguments.as_name_list("measured signals", measured)
    C, D = measurement_rows(model, names)
    indices, condition = _choose_estimated_states(model, names, C)
    M = np.vstack([C, np.eye(len(model.A))[indices]])
    estimated = tuple(model.states[i] for i in indices)
    p = len(names)
    A, B, inverse = (readonly(block) for block in _similarity(model, M))
    A11, A12, A21, A22 = A[:p, :p], A[:p, p:], A[p:, :p], A[p:, p:]
    B1, B2, M = B[:p], B[p:], readonly(M)
    partition = Partition(model, names, estimated, A11, A12, A21, A22, B1, B2, readonly(D), M, inverse, condition)
    _require_detectable(partition)
    return partition


def measurement_rows(model: StateSpace, measured: Sequence[str] | str) -> tuple[Array, Array]:
    """Return C (p, n) and D (p, m) of the measured signals.

    Raises SignalError for an unknown or duplicate name, or for none.
    """
    names = arguments.as_name_list("measured signals", measured)
    if not names or len(set(names)) < len(names):
        raise SignalError(f"the measured signals are {', '.join(names) or 'none'}: name one or more, each once")
    n, m = model.B.shape
    rows_by_name = dict(zip(model.states, np.hstack([np.eye(n), np.zeros((n, m))]), strict=True))
    rows_by_name |= dict(zip(model.outputs, np.hstack([model.C, model.D]), strict=True))
    for name in names:
        if name not in rows_by_name:
            known = ", ".join(dict.fromkeys((*model.outputs, *model.states)))
            raise SignalError(f"the measured signal '{name}' is neither output nor state: take one of {known}")
    both = np.array([rows_by_name[name] for name in names])
    return both[:, :n], both[:, n:]


def _choose_estimated_states(model: StateSpace, names: tuple[str, ...], C: Array) -> tuple[list[int], float]:
    """Return the indices of the states to estimate, in the model's order, and the condition of [C; E], scaled."""
    p, n = C.shape
    part = staircase.scaled(model.A, C=C)
    scaled = part.C / np.maximum(np.linalg.norm(part.C, axis=1, keepdims=True), np.finfo(float).tiny)
    U, sigma, _ = np.linalg.svd(scaled)
    if rank := p - int((sigma > staircase.COUPLING * sigma[0]).sum()):
        share = np.linalg.norm(U[:, p - rank :], axis=1)
        who = [name for name, s in zip(names, share, strict=True) if s > MIN_NAMED_COEFFICIENT * share.max()]
        raise ModelError(_dependence_message(who))
    if p == n:
        raise ModelError(
            f"{', '.join(names)} determine all of {', '.join(model.states)}: nothing is left to estimate; "
            "solve y = C x + D u for x"
        )
    pivots = scipy.linalg.qr(scaled, mode="r", pivoting=True)[1]
    indices = sorted(int(i) for i in pivots[p:])
    return indices, float(np.linalg.cond(np.vstack([scaled, np.eye(n)[indices]])))


def _dependence_message(who: Sequence[str]) -> str:
    if len(who) == 1:
        return f"the measured signal {who[0]} shows no state: its row of C is 0; leave it out"
    return f"the measured signals {', '.join(who)} depend on each other: their rows of C do; leave one of them out"


def _similarity(model: StateSpace, M: Array) -> tuple[Array, Array, Array]:
    """Return M A M^-1, M B and M^-1, each entry rounded once."""

    def inverse() -> flint.arb_mat:
        return ball(M).inv()

    A = precise.round_correctly(lambda: ball(M) * ball(model.A) * inverse(), "the partitioned A")
    B = precise.round_correctly(lambda: ball(M) * ball(model.B), "the partitioned B")
    return A, B, precise.round_correctly(inverse, "the inverse of [C; E]")


def _require_detectable(part: Partition) -> None:
    for mode in structure.uncontrollable_modes(part.A22.T, part.A12.T, part.estimated, part.model.time):
        raise ModelError(
            f"(A12, A22) is not detectable: mode {show.number(mode.value, 4)} in {', '.join(mode.states)} has "
            f"|A12 v| = {mode.measure:.0e} for the measured {', '.join(part.measured)}: measure "
            f"{', '.join(mode.states)} or take it out of the model"
        )
