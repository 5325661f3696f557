"""H2 and H-infinity norms of a linear model (`control.norm`, MATLAB `norm` and `hinfnorm`), each with its certificate.

    M(s) = C (s I - A)^-1 B + D

    H-infinity norm = max over w of sigma_max(M(i w))            the largest gain over frequencies and directions
    H2 norm^2 = trace(C P C' + D D') = trace(B'Q B + D'D)        the variance of the outputs under unit white noise

    continuous   A P + P A' + B B' = 0,    A'Q + Q A + C'C = 0          D = 0, otherwise the norm is infinite
    sampled      A P A' - P + B B' = 0,    A'Q A - Q + C'C = 0          w up to pi/T; a sum over samples, without T

Both norms are infinite if a mode of the model does not decay, even an uncontrollable or unobservable one. For the norm
of the transfer function alone, use `realisation.minimal` first.

Computed P and Q leave residuals Rp and Rq, evaluated in twice the precision. For any P the norm^2 is exactly
trace(C P C' + D D') + trace(Q* Rp) with the true Q*. With Q in place of Q*, the error is at most
|Q* - Q| |Rp|_* <= |H| |Rq| sqrt(n) |Rp|, where H is the Gramian of C = I. The proofs for H-infinity are in `modal_peak`
and `bounded_real`.

Library: no design uses it yet; docs/library.md has an example.
"""

import warnings
from collections.abc import Callable
from dataclasses import dataclass
from typing import TypeVar

import numpy as np
import scipy.linalg
from numpy.typing import NDArray

from synth import arguments, resolvent, show
from synth.analyse import modal, peak_gain, transfer, twofold
from synth.errors import ModelError
from synth.statespace import Array, StateSpace, System, of
from synth.timing import Continuous, Time

EPS = float(np.finfo(float).eps)


@dataclass(frozen=True)
class _Square:
    """The square of an H2 norm, and a bound of its error."""

    value: float
    error: float


Norm = TypeVar("Norm", _Square, peak_gain.Peak)


@show.result
class NormH2:
    """The H2 norm `value` with a bound of its relative `error`; `reason` says why an infinite norm is infinite."""

    value: float
    error: float
    time: Time
    reason: str = ""

    def __float__(self) -> float:
        return self.value

    def sheet(self) -> show.Sheet:
        """Return the norm with its error, or the reason why it is infinite."""
        line = self.reason or f"relative error below {show.number(self.error, 2)}, from the Lyapunov residuals"
        return show.Sheet(f"H2 norm in {self.time}: {show.number(self.value, 8)}", (line,))


@show.result
class NormHinf:
    """The H-infinity norm: `lower` <= norm <= `upper`, and the value `peak` in double precision at `frequency` rad/s.

    The response at `frequency` is at least `lower`, despite rounding. `upper` and the stability of the model are proved
    by a bound of the modal sum or by a Lyapunov matrix, including all rounding; without a proof `upper` is infinite. If
    the norm is infinite, `reason` says why, and `frequency` is that of the undamped or unstable mode.
    """

    peak: float
    frequency: float
    lower: float
    upper: float
    time: Time
    reason: str = ""

    @property
    def certified(self) -> bool:
        """Whether an upper bound was proved, or the norm is infinite."""
        return bool(self.upper < np.inf or self.reason)

    def __float__(self) -> float:
        return self.peak

    def sheet(self) -> show.Sheet:
        """Return the norm, its frequency and its bounds, or the reason why it is infinite."""
        n = show.number
        proof = "" if self.certified else ": no upper bound was proved"
        bounds = f"{n(self.lower, 10)} <= norm <= {n(self.upper, 10)}{proof}"
        title = f"H-infinity norm in {self.time}: {n(self.peak, 8)} at {n(self.frequency)} rad/s"
        return show.Sheet(title, (self.reason or bounds,))


@arguments.checked
def norm_h2(system: System) -> NormH2:
    """Return the H2 norm of a System: the root mean square of its outputs under white noise of unit density.

    It is infinite if a mode does not decay, or if D of a continuous model is not 0. Its unit is that of outputs over
    inputs, per root of a second for a continuous model.

    Raises SignalError as `statespace.of`; ModelError when the numbers exceed what a double holds.
    """
    model = of(system)
    reason = _infinite_because(model.poles, model.time)[0]
    if not reason and isinstance(model.time, Continuous) and model.D.any():
        i, j = np.argwhere(model.D)[0]
        reason = (
            f"D[{model.outputs[i]}, {model.inputs[j]}] is {show.number(model.D[i, j])}: white noise passes it with "
            "infinite variance; filter that output, or sample the model"
        )
    if reason:
        return NormH2(np.inf, 0.0, model.time, reason)
    square = _require_finite(lambda: _square(model), "H2")
    error = square.error / (2 * square.value) + 4 * EPS if square.value else square.error
    return NormH2(float(np.sqrt(square.value)), error, model.time)


@arguments.checked
def norm_hinf(system: System) -> NormHinf:
    """Return the H-infinity norm of a System: the largest gain over all frequencies and directions.

    `upper` exceeds `peak` by 1e-6, relative; if rounding prevents that proof, by the least of 1e-5, 1e-4 .. 0.1 that
    can be proved. `lower` is below `peak` by at most a quarter of 1e-6, or by the rounding errors. The frequency is inf
    for a continuous model with its peak at infinity, pi/T for a sampled model with its peak at Nyquist.

    Raises SignalError as `statespace.of`; ModelError when the numbers exceed what a double holds.
    """
    model = of(system)
    poles, V = modal.eigen(model.A)
    reason, w = _infinite_because(poles, model.time)
    if reason:
        return NormHinf(np.inf, w, np.inf, np.inf, model.time, reason)
    if not model.D.size:
        return NormHinf(0.0, 0.0, 0.0, 0.0, model.time)
    peak = _require_finite(lambda: peak_gain.peak(model, poles, V), "H-infinity")
    w = peak.frequency
    if not isinstance(model.time, Continuous):
        w = w / model.time.period_s
    return NormHinf(peak.value, w, peak.lower, peak.upper, model.time)


def _require_finite(compute: Callable[[], Norm], name: str) -> Norm:
    """Return `compute()`; raise ModelError when its numbers overflow double precision."""
    try:
        with np.errstate(all="ignore"):
            norm = compute()
        if np.isfinite(norm.value):
            return norm
        cause: Exception | None = None
    except (OverflowError, ValueError, np.linalg.LinAlgError) as error:
        cause = error
    raise ModelError(
        f"the {name} norm needs numbers that exceed what a double holds: scale the units of inputs, outputs or time"
    ) from cause


def _infinite_because(poles: NDArray[np.complex128], time: Time) -> tuple[str, float]:
    """Return the reason why the norms are infinite, "" if they are finite, and the mode's frequency in rad/s."""
    if transfer.is_stable(poles, time):
        return "", 0.0
    poles = np.sort_complex(poles)
    if isinstance(time, Continuous):
        worst = poles[int(poles.real.argmax())]
        w = abs(worst.imag)
    else:
        worst = poles[int(np.abs(poles).argmax())]
        w = abs(np.angle(worst)) / time.period_s
    return f"the pole at {show.number(worst)} does not decay: close a loop around it, or leave it out", float(w)


def _square(model: StateSpace) -> _Square:
    """Return the square of the H2 norm of a stable model, and a bound of its error."""
    A, B, C = resolvent.balanced(model.A, model.B, model.C)
    continuous, n = isinstance(model.time, Continuous), len(A)
    direct = float((model.D**2).sum())
    if not n:
        return _Square(direct, 4 * model.D.size * EPS * direct)
    P, Q, H = (_gramian(F, W, continuous) for F, W in ((A.T, B @ B.T), (A, C.T @ C), (A, np.eye(n))))
    Rp, Rq = _residual(A.T, B.T, P, continuous), _residual(A, C, Q, continuous)
    shown = twofold.product(twofold.product(C, P), C.T).rounded()
    square = float(np.trace(shown)) + direct + float((Q * Rp).sum())
    left = np.linalg.norm(H, 2) * np.linalg.norm(Rq) * np.sqrt(n) * np.linalg.norm(Rp)
    rounding = EPS * float(np.abs(np.diagonal(shown)).sum() + direct + np.abs(Q * Rp).sum()) * (n + len(C) + 4)
    return _Square(max(square, 0.0), float(left) + rounding)


def _gramian(F: Array, W: Array, continuous: bool) -> Array:
    """Return a symmetric solution X of F'X + X F + W = 0, or F'X F - X + W = 0; its accuracy is not guaranteed."""
    solve = scipy.linalg.solve_continuous_lyapunov if continuous else scipy.linalg.solve_discrete_lyapunov
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)  # SciPy warns of low accuracy; the residual bounds it
        X = np.asarray(solve(F.T, -W if continuous else W), dtype=np.float64)
    return (X + X.T) / 2


def _residual(F: Array, V: Array, X: Array, continuous: bool) -> Array:
    """Return F'X + X F + V'V, or F'X F - X + V'V, for a symmetric X, computed in twice the precision."""
    XF = twofold.product(X, F)
    change = XF + XF.T if continuous else twofold.product(F.T, XF) - X
    return (change + twofold.product(V.T, V)).rounded()
