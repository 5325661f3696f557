"""H-infinity norm of a stable model, between a lower and an upper bound.

    M(s) = C (s I - A)^-1 B + D,       peak = max over 0 <= w <= inf of sigma_max(M(i w))

`modal_peak` finds and proves the peak if the eigenvectors of A are far from dependent. Otherwise the search starts at
the frequencies of the poles and climbs by Newton's method. `bounded_real` then tries to prove that g = (1 + e) sigma is
an upper bound, with weights W that use half of e. If it fails, the eigenvalues of the Hamiltonian divide the axis into
intervals. If the response exceeds g anywhere, it does so in the middle of one of them (Boyd, Balakrishnan 1990;
Bruinsma, Steinbuch 1990), and the climb restarts there; otherwise e is raised. The lower bound is the value at w less a
bound of its rounding error.
"""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from synth import resolvent
from synth.analyse import bounded_real, climb, modal, modal_peak, schur_response
from synth.analyse.bounded_real import EPS, Matrices
from synth.analyse.modal import Modes
from synth.analyse.modal_peak import Bound
from synth.statespace import Array, Complex, StateSpace
from synth.timing import Continuous

LEVELS = (1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 1e-1)  # e, relative
TINY = 1e-300
MIN_AMPLITUDE = 1e-4  # of the largest amplitude of a state: the least amplitude used for a weight


@dataclass(frozen=True, eq=False)
class Peak:
    """`lower` <= max sigma_max <= `upper`, which is inf without a proof; `value`, in double, at `frequency`.

    The frequency is in rad/s, or rad per sample.
    """

    lower: float
    value: float
    upper: float
    frequency: float


def peak(model: StateSpace, poles: Complex, V: Array) -> Peak:
    """Return the peak of a stable model, from its poles (n,) and real eigenvectors V (n, n)."""
    continuous = isinstance(model.time, Continuous)
    modes = modal.of(model.A, model.B, model.C, model.D, poles, V, not continuous) if len(poles) else None
    bound = modal_peak.peak(modes) if modes else None
    if modes is None or bound is None:
        return _from_lyapunov(model, continuous)
    by_modes = _from_modes(model, modes, bound)
    if bound.margin == modal_peak.LEVELS[0]:
        return by_modes
    other = _from_lyapunov(model, continuous)
    return other if other.upper - other.lower < by_modes.upper - by_modes.lower else by_modes


def _from_modes(model: StateSpace, modes: Modes, bound: Bound) -> Peak:
    """Return the peak with the upper bound from the modal form."""
    value, w = bound.value, bound.w
    lower = max(0.0, value * (1 - 16 * sum(model.D.shape) * EPS) - modal_peak.error(modes, w))
    if lower < (1 - modal_peak.LEVELS[0] / 4) * value:
        bilinear_w = float(np.tan(w / 2)) if modes.sampled else w
        matrices = *resolvent.balanced(model.A, model.B, model.C), model.D
        lower = max(lower, _lower_bound(matrices, bilinear_w, not modes.sampled))
    return Peak(lower, max(value, lower), (1 + bound.margin) * value, w)


def _from_lyapunov(model: StateSpace, continuous: bool) -> Peak:
    """Return the peak with the upper bound from a Lyapunov matrix."""
    A, B, C = resolvent.balanced(model.A, model.B, model.C)
    matrices = A, B, C, model.D
    if continuous:
        return _prove(matrices, matrices, *_start(matrices))
    form = schur_response.bilinear(*matrices)
    w, states = _start(form)
    if w <= 1:
        peak = _prove(matrices, form, w, states)
        return replace(peak, frequency=2 * float(np.arctan(peak.frequency)))
    # Near Nyquist M(-z) is searched: it maps z = -1 to 1 and s to 1/s, and s near 0 has more digits than near infinity.
    matrices = -A, -B, C, model.D
    form = schur_response.bilinear(*matrices)
    peak = _prove(matrices, form, *_start(form))
    return replace(peak, frequency=np.pi - 2 * float(np.arctan(peak.frequency)))


def _prove(model: Matrices, form: Matrices, w: float, states: Array) -> Peak:
    """Return the peak of `model`, with continuous-time equivalent `form`; search from w, weights from `states` (n,)."""
    continuous, (A, _, C, _) = form is model, form
    value, w = _climb(form, w)
    value = max(value, EPS * float(states.max(initial=0.0)) * float(np.abs(C).max(initial=0.0)))
    for margin in LEVELS if value else ():
        while True:
            level = (1 + margin) * value
            solution = bounded_real.solve(form, level, margin * level**2 / np.maximum(len(A) * states**2, TINY))
            if solution.X is not None and bounded_real.is_proof(solution.X, model, level, continuous):
                return Peak(_lower_bound(model, w, continuous), value, level, w)
            other, frequency = _climb(form, _highest_frequency(form, _interval_midpoints(solution.eigenvalues)))
            if other <= (1 + margin / 4) * value:
                break
            value, w = other, frequency
    return Peak(_lower_bound(model, w, continuous), value, np.inf if value else 0.0, w)


def _start(form: Matrices) -> tuple[float, Array]:
    """Return the best of the poles' frequencies, 0 and infinity, and the largest amplitude of each state (n,) there."""
    A, B, C, D = form
    schur = resolvent.schur(A)
    pairs = schur.poles[schur.poles.imag >= 0]
    resonance_squared = pairs.imag**2 - pairs.real**2  # w^2 at which a pair alone peaks, if positive
    w = np.concatenate([[0.0], np.where(resonance_squared > 0, np.sqrt(np.abs(resonance_squared)), np.abs(pairs))])
    X = np.tensordot(schur.U, schur.solve(1j * w, (schur.U.T @ B)[:, :, None]), 1)
    M = np.tensordot(C, X, 1).transpose(2, 0, 1) + D
    values = np.linalg.svd(np.concatenate([M, D[None]]), compute_uv=False)[:, 0]
    states = np.linalg.norm(X, axis=1).max(axis=1)
    return float(np.append(w, np.inf)[values.argmax()]), np.maximum(states, MIN_AMPLITUDE * states.max(initial=0.0))


def _highest_frequency(form: Matrices, frequencies: Array) -> float:
    """Return the frequency with the largest gain."""
    A, B, C, D = form
    values = np.linalg.svd(resolvent.response(A, B, C, D, (1j * frequencies).astype(np.complex128)), compute_uv=False)[
        :, 0
    ]
    return float(frequencies[values.argmax()])


def _interval_midpoints(eigenvalues: Complex) -> Array:
    """Return a frequency in each interval between 0, the eigenvalues' imaginary parts and infinity."""
    cuts = np.concatenate([[0.0], np.unique(np.abs(eigenvalues.imag))])
    return np.append((cuts[:-1] + cuts[1:]) / 2, 2 * cuts[-1] + 1.0)


def _climb(form: Matrices, w: float) -> tuple[float, float]:
    if np.isinf(w) or not len(form[0]):
        return float(np.linalg.norm(form[3], 2)), w
    return climb.local_maximum(lambda at: _derivatives(form, at), w)


def _derivatives(form: Matrices, w: float) -> tuple[Complex, Complex, Complex]:
    """Return M and its first two derivatives (p, m) at w."""
    A, B, C, D = form
    R = np.asarray(np.linalg.inv(1j * w * np.eye(len(A)) - A), dtype=np.complex128)
    CR, RB = C @ R, R @ B
    return CR @ B + D, -1j * (CR @ RB), -2 * (CR @ (R @ RB))


def _lower_bound(model: Matrices, w: float, continuous: bool) -> float:
    """Return a rigorous lower bound of sigma_max at a frequency w of s.

    With R (v I - A) = I + E, |E| < 1, a residual r of X leaves an error of at most |R| |r| / (1 - |E|). The factors 16
    and 1 + 1e-6 cover the rounding errors of the singular value and of the last norm.
    """
    A, B, C, D = model
    n, (p, m) = len(A), D.shape
    v = complex(0, w) if continuous else (1 + 1j * w) / (1 - 1j * w) if np.isfinite(w) else -1.0
    rounding = 8 * (n + 4) * EPS  # of complex sums of n products, and of v
    X: NDArray[Any] = np.zeros((n, m), dtype=np.complex128)
    error = np.zeros((n, m))
    if n and np.isfinite(v):
        shifted = v * np.eye(n) - A
        R = np.linalg.inv(shifted)
        X = R @ B
        E = R @ shifted - np.eye(n)
        terms = np.abs(B) + (np.abs(A) + abs(v) * np.eye(n)) @ np.abs(X)
        error_norm = np.linalg.norm(E, np.inf) + rounding * np.linalg.norm(np.abs(R) @ np.abs(shifted), np.inf)
        if not error_norm < 0.5:
            return 0.0
        residual = np.abs(B - shifted @ X) + rounding * terms
        first_order = np.abs(R) @ residual
        error = first_order + error_norm / (1 - error_norm) * first_order.max(axis=0) * np.ones((n, 1))
    M = C @ X + D
    uncertain = np.abs(C) @ error + rounding * (np.abs(C) @ np.abs(X) + np.abs(D))
    sigma = float(np.linalg.norm(M, 2))
    return max(0.0, sigma * (1 - 16 * (p + m) * EPS) - float(np.linalg.norm(uncertain)) * (1 + 1e-6))
