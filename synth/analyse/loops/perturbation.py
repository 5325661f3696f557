"""Sensitivity of a loop to rounding of its coefficients (first-order perturbation bound).

Each coefficient is rounded by at most half a unit in the last place. To first order, the relative change of L is at
most EPS times

    sum |b_k| / |N| + sum |a_k| |z|^k / |D|                                 coefficients b, a
    (|c R| (|A| |R b| + |b|) + |c| |R b| + |d|) / |L|,   R = (s I - A)^-1   state space

and there is a similar bound for det(s I - A + b c / (1 + d)), whose zeros are the closed-loop poles.
"""

from dataclasses import dataclass
from typing import Any

import flint
import numpy as np
from numpy.typing import NDArray

from synth.analyse.loops.rational import BITS, Rational
from synth.analyse.numerics import precise
from synth.errors import ModelError
from synth.statespace import Array, Complex, StateSpace
from synth.timing import Continuous, Time

MIN_DECAY = 1e-14  # of the fastest pole, or of the unit circle: a pole with less decay may be undamped
EPS = 2.0**-53  # the largest relative error of rounding to double


@dataclass(frozen=True)
class Perturbation:
    """Bounds of the relative change of L and of the closed-loop characteristic polynomial by rounding."""

    of_loop: float
    of_closed: float


def of_rational(loop: Rational, frequency: float) -> Perturbation:
    """Return the effect of rounding of the coefficients at `frequency` rad/s, to first order."""
    if not loop.coefficients or np.isinf(frequency):
        return of_model(loop.model, frequency)
    return _perturbation(*_of_coefficients(*loop.coefficients, _point(loop.time, frequency)))


def of_model(model: StateSpace, frequency: float) -> Perturbation:
    """Return the effect of rounding of the entries of A, B, C, D at `frequency` rad/s, to first order."""
    if np.isinf(frequency):
        return Perturbation(2 * EPS, 2 * EPS)
    return _perturbation(*_of_matrices(model, _point(model.time, frequency)))


def _point(time: Time, w: float) -> complex:
    return 1j * w if isinstance(time, Continuous) else complex(np.exp(1j * w * time.period_s))


def _perturbation(of_loop: float, of_closed: float) -> Perturbation:
    return Perturbation(*(EPS * float(v) if np.isfinite(v) else np.inf for v in (of_loop, of_closed)))


@np.errstate(all="ignore")
def _of_coefficients(b: Array, a: Array, point: complex) -> tuple[float, float]:
    with precise.precision(4 * BITS):
        z = flint.acb(point.real, point.imag)
        N, D = (flint.acb_poly([flint.arb(float(v)) for v in part[::-1]])(z) for part in (b, a))
        n, d, closed = (float(abs(v)) for v in (N, D, N + D))
    n_size, d_size = (float(np.polyval(np.abs(part), abs(point))) for part in (b, a))
    return n_size / np.float64(n) + d_size / np.float64(d), (n_size + d_size) / np.float64(closed)


@np.errstate(all="ignore")
def _of_matrices(model: StateSpace, point: complex) -> tuple[float, float]:
    A, b, c, d = model.A, model.B[:, 0], model.C[0], np.float64(model.D[0, 0])
    resolvent, closed = (_inverse(point * np.eye(len(A)) - M) for M in (A, A - np.outer(b, c) / (1 + d)))
    numerator = (
        np.abs(c @ resolvent) @ (np.abs(A) @ np.abs(resolvent @ b) + np.abs(b))
        + np.abs(c) @ np.abs(resolvent @ b)
        + abs(d)
    )
    sizes = np.abs(A) + (2 + abs(d) / abs(1 + d)) * np.abs(np.outer(b, c)) / abs(1 + d)
    return numerator / abs(c @ resolvent @ b + d), float(np.sum(np.abs(closed) * sizes.T)) + abs(d) / abs(1 + d)


def _inverse(M: NDArray[Any]) -> Complex:
    try:
        return np.asarray(np.linalg.inv(M), dtype=np.complex128)
    except np.linalg.LinAlgError:
        return np.full(M.shape, np.inf, dtype=np.complex128)


def is_stable(loop: Rational) -> bool:
    """Tell whether all closed-loop poles are stable, by more than rounding can move them.

    Raises ModelError if rounding of the coefficients hides the answer.
    """
    poles = loop.closed_loop_poles
    if not poles.size:
        return True
    decay = _decay(poles, loop.time)
    if (decay <= 0).any():
        return False
    hidden = [w for w in map(loop.frequency, np.unique(np.abs(poles))) if of_rational(loop, w).of_closed >= 1]
    if not hidden:
        return True
    if (decay <= MIN_DECAY).any():
        return False
    raise ModelError(
        f"rounding of the coefficients hides whether the closed loop is stable: it may move its poles near "
        f"{hidden[0]:.4g} rad/s across the boundary; give the loop as a state-space model (loop.sampled), or sample it "
        "more slowly"
    )


def _decay(poles: Complex, time: Time) -> Array:
    """Return -Re s over the largest |s|, or in z 1 - |z|^2 = -4 Re s / |1 - s|^2, of poles in s."""
    if isinstance(time, Continuous):
        return np.asarray(-poles.real / (np.abs(poles).max() or 1.0))
    finite = np.isfinite(poles)
    s = np.where(finite, poles, 0.0)
    return np.where(finite, -4 * s.real / np.abs(1 - s) ** 2, 0.0)
