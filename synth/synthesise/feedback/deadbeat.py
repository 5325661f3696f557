"""Deadbeat state feedback u = K x (the sign is inside K): (A + B K)^k = 0 with the least k, in discrete time.

S_j, the states that can be brought to 0 in j samples, grows by S_j = {x: A x in S_{j-1} + im B} from S_0 = {0}. K maps
each S_j into S_{j-1}. k is the first j for which S_j is the whole state space, and the controllability index if A is
regular. The S_j are computed by orthogonal steps in scaled units. With one input, Ackermann's formula in ball
arithmetic places all poles at 0.

Library: no design uses it yet; docs/library.md has an example.
"""

import numpy as np
import scipy.linalg

from synth import arguments, show
from synth.analyse import precise, staircase, structure
from synth.errors import ModelError, TimingError
from synth.statespace import Array, StateSpace, System, of, readonly
from synth.synthesise.feedback import pole_placement
from synth.timing import Continuous, Discrete


@show.result
class Deadbeat:
    """K (m, n) for which every state is 0 after `steps` samples, the least number.

    `remainder` is |(A + B K)^steps| in scaled units.
    """

    K: Array
    steps: int
    remainder: float
    states: tuple[str, ...]
    inputs: tuple[str, ...]
    time: Discrete

    def lines(self) -> tuple[str, ...]:
        """Return the certificate as text."""
        return (f"All poles are 0: after {self.steps} samples {self.remainder:.1e} of a start of 1 is left, scaled",)

    def sheet(self) -> show.Sheet:
        """Return the certificate and K."""
        table = show.feedback(show.matrix("K", self.K, self.inputs, self.states))
        return show.Sheet(f"Deadbeat state feedback in {self.time}", self.lines(), (table,))


@arguments.checked
def feedback(system: System) -> Deadbeat:
    """Return u = K x that brings every state to 0 in the least number of samples.

    Raises TimingError for a continuous model; ModelError when a mode other than 0 is uncontrollable.
    """
    model = of(system)
    if isinstance(model.time, Continuous):
        raise TimingError("no constant gain is deadbeat in continuous time: sample the model, or place fast poles")
    part = staircase.scaled(model.A, model.B)
    split = staircase.controllable_split(part.A, part.B)
    if len(model.inputs) == 1 and len(model.A) and not split.complement.size:
        poles = np.zeros(len(model.A), dtype=np.complex128)
        K, steps = pole_placement.ackermann(part.A, part.B, poles), len(poles)
    else:
        K, steps = _nilpotent(model, part)
    gain = readonly(part.u[:, None] * K / part.x)
    remainder = _remainder(model, part, gain, steps) if steps else 0.0
    return Deadbeat(gain, steps, remainder, model.states, model.inputs, model.time)


def _remainder(model: StateSpace, part: staircase.Scaled, gain: Array, steps: int) -> float:
    with precise.precision():
        power = pole_placement.closed_loop_matrix(model, gain) ** steps
        return float(np.linalg.norm(precise.rounded(power) * part.x / part.x[:, None], 2))


@arguments.checked
def largest_uncontrollable_mode(model: StateSpace) -> tuple[complex, str]:
    """Return the largest uncontrollable mode, with the states that dominate it.

    Raises ModelError where all modes are controllable.
    """
    part = staircase.scaled(model.A, model.B)
    values, vectors = staircase.modes(part.A.T, staircase.controllable_split(part.A, part.B).complement)
    if not len(values):
        raise ModelError(f"the inputs {', '.join(model.inputs)} control every mode: no mode is uncontrollable")
    k = int(np.argmax(np.abs(values)))
    return complex(values[k] * part.rate), ", ".join(structure.direction(vectors[:, k], model.states))


def _nilpotent(model: StateSpace, part: staircase.Scaled) -> tuple[Array, int]:
    """Return the scaled K (m, n) that maps S_j into S_{j-1}, and the number of steps."""
    n, m = part.B.shape
    S, K, steps = np.zeros((n, 0)), np.zeros((m, n)), 0
    size = float(np.linalg.norm(part.A))
    while S.shape[1] < n:
        target, complement = np.hstack([part.B, S]), _complement(S)
        basis = scipy.linalg.orth(target, rcond=staircase.COUPLING)
        _, sigma, V = np.linalg.svd((part.A - basis @ (basis.T @ part.A)) @ complement)
        new = complement @ V[int((sigma > staircase.COUPLING * size).sum()) :].T
        if not new.shape[1]:
            value, who = largest_uncontrollable_mode(model)
            raise ModelError(
                f"mode {show.number(value, 4)} in {who} is not 0 and is uncontrollable from "
                f"{', '.join(model.inputs)}: no gain is deadbeat; actuate {who} or take it out of the model"
            )
        K += np.linalg.lstsq(target, -part.A @ new, rcond=staircase.COUPLING)[0][:m] @ new.T
        S, steps = np.hstack([S, new]), steps + 1
    return K, steps


def _complement(S: Array) -> Array:
    return np.linalg.qr(S, mode="complete")[0][:, S.shape[1] :] if S.shape[1] else np.eye(len(S))
