"""The internal model of an exosystem: poles at 0 and +-i w_k make constants and sines of those frequencies vanish.

    xi' = Phi xi + N e,   Phi in companion form of s^m prod_k (s^2 + w_k^2),  N = (0, .., 0, 1)^T

with m = 1 when the frequency 0 is among them. By the internal model principle a stable loop around a copy of it has
e -> 0 for every reference and input disturbance of those frequencies. Source: F(14), (15), after Davison (1976) and
Francis and Wonham (1976).
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from synth.analyse import discretise, structure
from synth.errors import ModelError, SignalError
from synth.statespace import Array, StateSpace, readonly
from synth.timing import Continuous, Discrete, common


@dataclass(frozen=True, eq=False)
class InternalModel:
    """Phi (n, n) and N (n, 1), continuous."""

    Phi: Array
    N: Array


@dataclass(frozen=True, eq=False)
class DiscreteInternalModel:
    """Phi (n, n), N (n, 1) and E (n, 1) over one period, exactly; E is zero where none was asked for."""

    Phi: Array
    N: Array
    E: Array


def exosystem(frequencies: Sequence[float]) -> InternalModel:
    """Return the companion form for distinct `frequencies` >= 0 in rad/s; frequency 0 gives one integrator.

    Raises SignalError for none, a negative, an infinite or a repeated frequency.
    """
    w = [float(f) for f in frequencies]
    if not w or any(not np.isfinite(f) or f < 0 for f in w) or len(set(w)) < len(w):
        raise SignalError(f"exosystem frequencies {w} rad/s: give distinct finite numbers >= 0, at least one")
    polynomial = np.array([1.0])
    for f in w:
        polynomial = np.convolve(polynomial, [1.0, 0.0, f * f] if f else [1.0, 0.0])
    n = len(polynomial) - 1
    Phi = np.diag(np.ones(n - 1), 1)
    Phi[-1] = -polynomial[:0:-1] + 0.0
    return InternalModel(readonly(Phi), readonly(np.eye(n)[:, -1:]))


def discrete(frequencies: Sequence[float], period_s: float, E: ArrayLike | None = None) -> DiscreteInternalModel:
    """Return the internal model over one period, with e and the anti-windup input E (n,) constant in between.

    Raises SignalError as `exosystem`, for a frequency at or above Nyquist's, and for an E of another size; TimingError
    when the period is not positive.
    """
    model = exosystem(frequencies)
    n, nyquist = len(model.Phi), np.pi / Discrete(period_s).period_s
    if max(frequencies) >= nyquist:
        raise SignalError(f"exosystem frequency {max(frequencies)} rad/s: it must lie below {nyquist:.6g} rad/s")
    column = np.zeros((n, 1)) if E is None else np.asarray(E, dtype=np.float64).reshape(-1, 1)
    if column.shape != (n, 1):
        raise SignalError(f"the anti-windup gain has {column.size} entries, the internal model {n} states: give {n}")
    held = discretise.first_order_hold(model.Phi, np.hstack([model.N, column]), period_s)
    return DiscreteInternalModel(held.F, readonly(held.G[:, :1]), readonly(held.G[:, 1:]))


def augmented(plant: StateSpace, frequencies: Sequence[float]) -> StateSpace:
    """Return a continuous plant with the internal model driven by its one output, states (plant's, xi1, xi2, ..).

    All states are outputs.

    Raises TimingError for a sampled plant; SignalError as `exosystem`, or when the plant has another count of outputs
    than one; ModelError when a transmission zero of the plant at an exosystem mode makes the problem unsolvable.
    """
    common(Continuous(), plant.time)
    if len(plant.outputs) != 1:
        raise SignalError(f"the plant has outputs {', '.join(plant.outputs)}: give the one whose error is regulated")
    model = exosystem(frequencies)
    for w in frequencies:
        if structure.has_transmission_zero(plant, 1j * w):
            raise ModelError(
                f"the plant from {', '.join(plant.inputs)} to {plant.outputs[0]} has a transmission zero at {w:g} "
                "rad/s, a frequency of the exosystem: it cannot be regulated there; drop it or change the actuators"
            )
    n, k = len(plant.A), len(model.Phi)
    A = np.block([[plant.A, np.zeros((n, k))], [model.N @ plant.C, model.Phi]])
    B = np.vstack([plant.B, model.N @ plant.D])
    states = plant.states + tuple(f"xi{i + 1}" for i in range(k))
    D = np.zeros((n + k, plant.B.shape[1]))
    return StateSpace(A, B, np.eye(n + k), D, states, plant.inputs, states, plant.time)
