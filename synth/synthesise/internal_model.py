"""The internal model of an exosystem: poles at 0 and +-i w_k make constants and sines of those frequencies vanish.

    xi' = Phi xi + N e,   Phi in companion form of s^m prod_k (s^2 + w_k^2),  N = (0, .., 0, 1)^T

with m = 1 when the frequency 0 is among them. By the internal model principle a stable loop around a copy of it has
e -> 0 for every reference and input disturbance of those frequencies. Source: F(14), (15), after Davison (1976) and
Francis and Wonham (1976).
"""

from collections.abc import Sequence
from dataclasses import dataclass

import flint
import numpy as np
from numpy.typing import ArrayLike

from synth.analyse import precise, structure
from synth.errors import ModelError, SignalError
from synth.statespace import Array, StateSpace, readonly
from synth.timing import Continuous, Discrete, common


@dataclass(frozen=True, eq=False)
class InternalModel:
    """Phi (n, n) and N (n, 1), continuous."""

    Phi: Array
    N: Array


@dataclass(frozen=True, eq=False)
class Leapfrog:
    """The internal model over one period, exactly, in coordinates eta with xi = T eta in which a sample costs least.

        eta_0' = eta_0 + e                                              for the frequency 0
        p' = p + c q,   q' = q - p' + e,   c = 2 - 2 cos(w T)           for each other frequency w

    Each pair turns by w T whatever c is rounded to: its determinant is 1 and its trace 2 - c, so the poles stay on the
    unit circle and only w is rounded. `c` (m,) by rising frequency, `T` (n, n); `E` (n, 1) is what the anti-windup
    input adds to eta_0', p', q' in this order of computation, 0 where none was asked for.
    """

    c: Array
    T: Array
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


def leapfrog(frequencies: Sequence[float], period_s: float, E: ArrayLike | None = None) -> Leapfrog:
    """Return the internal model with e and the anti-windup input E (n,) constant over each period.

    The sampled companion form and the leapfrog form have the same poles and are both driven by e alone, so T takes one
    controllability matrix to the other.

    Raises SignalError as `exosystem`, for a frequency at or above Nyquist's, and for an E of another size; TimingError
    when the period is not positive.
    """
    n, nyquist = len(exosystem(frequencies).Phi), np.pi / Discrete(period_s).period_s
    if max(frequencies) >= nyquist:
        raise SignalError(f"exosystem frequency {max(frequencies)} rad/s: it must lie below {nyquist:.6g} rad/s")
    column = np.zeros(n) if E is None else np.asarray(E, dtype=np.float64).ravel()
    if column.shape != (n,):
        raise SignalError(f"the anti-windup gain has {column.size} entries, the internal model {n} states: give {n}")
    w = sorted(float(f) for f in frequencies if f)

    def compute() -> flint.arb_mat:
        held = (_driven(w, n, column) * flint.arb(period_s)).exp()
        c = [4 * (flint.arb(f) * flint.arb(period_s) / 2).sin() ** 2 for f in w]
        T = _controllability(_part(held, n, 0, n), _part(held, n, n, n + 1)) * _controllability(*_turns(c, n)).inv()
        added = [*T.solve(_part(held, n, n + 1, n + 2)).entries()]
        for q in range(n - 2 * len(c) + 1, n, 2):
            added[q] += added[q - 1]
        padded = [*c, *[flint.arb(0)] * n]
        return flint.arb_mat([[*(T[i, j] for j in range(n)), added[i], padded[i]] for i in range(n)])

    found = precise.resolved(compute, f"the internal model over {period_s:g} s")
    return Leapfrog(readonly(found[: len(w), n + 1]), readonly(found[:, :n]), readonly(found[:, n : n + 1]))


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


def _driven(w: Sequence[float], n: int, E: Array) -> flint.arb_mat:
    """Return [[Phi, N, E], [0, 0, 0]], (n + 2, n + 2), with the exact coefficients of s^m prod (s^2 + w^2)."""
    polynomial = flint.arb_poly([0, 1] if n > 2 * len(w) else [1])
    for f in w:
        polynomial *= flint.arb_poly([flint.arb(f) ** 2, 0, 1])
    M = flint.arb_mat(n + 2, n + 2)
    for i in range(n):
        M[n - 1, i] = -polynomial[i]
        M[i, n + 1] = flint.arb(float(E[i]))
    for i in range(n - 1):
        M[i, i + 1] = flint.arb(1)
    M[n - 1, n] = flint.arb(1)
    return M


def _turns(c: Sequence[flint.arb], n: int) -> tuple[flint.arb_mat, flint.arb_mat]:
    """Return one sample of the leapfrog form of order n as (A, B)."""
    A, B = precise.identity(n), flint.arb_mat(n, 1)
    first = n - 2 * len(c)
    if first:
        B[0, 0] = flint.arb(1)
    for k, step in enumerate(c):
        p, q = first + 2 * k, first + 2 * k + 1
        A[p, q], A[q, p], A[q, q], B[q, 0] = step, flint.arb(-1), 1 - step, flint.arb(1)
    return A, B


def _controllability(A: flint.arb_mat, B: flint.arb_mat) -> flint.arb_mat:
    """Return (B, A B, .., A^(n-1) B), (n, n)."""
    columns = [B]
    for _ in range(A.nrows() - 1):
        columns.append(A * columns[-1])
    return flint.arb_mat([[c[i, 0] for c in columns] for i in range(A.nrows())])


def _part(M: flint.arb_mat, rows: int, first: int, last: int) -> flint.arb_mat:
    """Return the columns first .. last - 1 of the upper `rows`."""
    return flint.arb_mat([[M[i, j] for j in range(first, last)] for i in range(rows)])
