"""H2 and H-infinity norms of a linear model (`control.norm`, MATLAB `norm` and `hinfnorm`), each with its certificate.

    M(s) = C (s I - A)^-1 B + D

    H-infinity norm = max over w of sigma_max(M(i w))            the largest gain over frequencies and directions
    H2 norm^2 = trace(C P C' + D D') = trace(B'Q B + D'D)        the variance of the outputs under unit white noise

    continuous   A P + P A' + B B' = 0,    A'Q + Q A + C'C = 0          D = 0, otherwise the norm is infinite
    sampled      A P A' - P + B B' = 0,    A'Q A - Q + C'C = 0          w up to pi/T; a sum over samples, without T

Both norms are infinite if a mode of the model does not decay, even an uncontrollable or unobservable one. For the norm
of the transfer function alone, use `realisation.minimal` first.

H2 norm: P is the limit of the doubling P <- P + M P M', M <- M M from P = B B' and M = A (Smith 1968), computed in ball
arithmetic. A continuous model starts from its Cayley transform with a > 0, which has the same P:

    M = (a I - A)^-1 (a I + A),    P = 2 a (a I - A)^-1 B B' (a I - A')^-1

The missing part of trace(C P C') is trace(C M P* M' C'), with the limit P*. It is at least 0 and at most
|C M|_F^2 trace(P) / (1 - |M|_F^2), and the ball of the norm includes it. The proofs for H-infinity are in `modal_peak`
and `bounded_real`.

Library: no design uses it yet; docs/library.md has an example.
"""

from collections.abc import Callable
from typing import TypeVar

import flint
import numpy as np

from synth import arguments, resolvent, show
from synth.analyse import modal, peak_gain, precise, transfer
from synth.errors import ModelError
from synth.statespace import Array, Complex, StateSpace, System, of
from synth.timing import Continuous, Time

MISSING = flint.arb(2) ** -80  # of the norm^2: a missing part this small does not matter for a double
MISSING_OF_ZERO = flint.arb(2) ** -80 * precise.ZERO**2  # of the scale of the norm^2, which cancels to 0
MAX_DOUBLINGS = 80  # a mode that decays by 1e-22 in a step decays within them

Norm = TypeVar("Norm", "NormH2", peak_gain.Peak)


@show.result
class NormH2:
    """The H2 norm `value`, rounded from ball arithmetic, with a bound of its `error`.

    The error is relative; for a `value` of 0 it is absolute. `reason` says why an infinite norm is infinite.
    """

    value: float
    error: float
    time: Time
    reason: str = ""

    def __float__(self) -> float:
        return self.value

    def sheet(self) -> show.Sheet:
        """Return the norm with its error, or the reason why it is infinite."""
        bound = f"{'relative' if self.value else 'absolute'} error at most {show.number(self.error, 2)}"
        line = self.reason or f"{bound}: the Gramian is computed in ball arithmetic and the norm is rounded once"
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

    Raises SignalError as `statespace.of`; ModelError when the norm exceeds what a double holds, or when rounding errors
    of the poles decide whether the model is stable.
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
    return _require_finite(lambda: _rounded_norm_h2(model), "H2")


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


def _infinite_because(poles: Complex, time: Time) -> tuple[str, float]:
    """Return the reason why the norms are infinite, "" if they are finite, and the mode's frequency in rad/s."""
    if transfer.is_stable(poles, time):
        return "", 0.0
    worst = _slowest(poles, time)
    w = abs(worst.imag) if isinstance(time, Continuous) else abs(np.angle(worst)) / time.period_s
    return f"the pole at {show.number(worst)} does not decay: close a loop around it, or leave it out", float(w)


def _slowest(poles: Complex, time: Time) -> complex:
    """Return the pole that decays slowest, or grows fastest."""
    poles = np.sort_complex(poles)
    return complex(poles[int((poles.real if isinstance(time, Continuous) else np.abs(poles)).argmax())])


def _rounded_norm_h2(model: StateSpace) -> NormH2:
    """Return the H2 norm of a stable model, rounded once."""
    A, B, C = resolvent.balanced(model.A, model.B, model.C)
    continuous = isinstance(model.time, Continuous)

    def compute() -> flint.arb_mat:
        square = scale = sum((flint.arb(float(v)) ** 2 for v in model.D.flat), flint.arb(0))
        if min(*B.shape, *C.shape):
            M, P = _cayley(A, B, _shift(model)) if continuous else (precise.matrix(A), _outer(precise.matrix(B)))
            dynamic, size = _output_variance(M, P, precise.matrix(C))
            square, scale = square + dynamic, scale + size
        upper = square.upper().sqrt()
        root = square.sqrt() if square.lower() >= 0 else flint.arb(0, upper)
        return flint.arb_mat([[root, scale.upper().sqrt().mid()]])

    try:
        value, scale = precise.round_correctly(compute, "the H2 norm")[0]
    except precise.BeyondDoubleError as error:
        raise OverflowError(str(error)) from error  # `_require_finite` names the mend
    except ModelError as error:
        raise ModelError(
            "the H2 norm is not determined: rounding errors of the poles decide whether all modes decay; the slowest "
            f"pole is computed as {show.number(_slowest(model.poles, model.time))}; give the model in sections or "
            "modal coordinates, close a loop around that mode, or leave it out"
        ) from error
    error_bound = np.spacing(value) / value if value else float(precise.ZERO) * scale
    return NormH2(float(value), float(error_bound), model.time)


def _shift(model: StateSpace) -> float:
    """Return the power of 2 nearest to the geometric mean of the fastest and the slowest |pole|."""
    sizes = np.log2(np.abs(model.poles))
    return float(2.0 ** np.round((sizes.min() + sizes.max()) / 2))


def _cayley(A: Array, B: Array, a: float) -> tuple[flint.arb_mat, flint.arb_mat]:
    """Return M and the first P of a continuous model."""
    one = precise.identity(len(A))
    inverse = (one * flint.arb(a) - precise.matrix(A)).inv()
    return inverse * flint.arb(2 * a) - one, _outer(inverse * precise.matrix(B)) * flint.arb(2 * a)


def _outer(B: flint.arb_mat) -> flint.arb_mat:
    """Return B B'."""
    return B * B.transpose()


def _output_variance(M: flint.arb_mat, P: flint.arb_mat, C: flint.arb_mat) -> tuple[flint.arb, flint.arb]:
    """Return trace(C P* C') with the limit P* of the doubling, and the scale of its terms.

    Both are NaN if the doubling does not converge in the precision in force.
    """
    for _ in range(MAX_DOUBLINGS):
        size = _frobenius(M).upper()
        if not size < flint.arb(2) ** flint.ctx.prec:
            break
        if size < 0.5:
            square = (C * P * C.transpose()).trace()
            scale = _scale(P, C)
            missing = (_frobenius(C * M) * P.trace() / (1 - size)).upper()
            if missing <= MISSING * square.lower() or missing <= MISSING_OF_ZERO * scale:
                return square + flint.arb(missing / 2, missing / 2), scale
        P, M = P + M * P * M.transpose(), M * M
    return flint.arb.nan(), flint.arb.nan()


def _frobenius(M: flint.arb_mat) -> flint.arb:
    """Return the square of the Frobenius norm."""
    return sum((v * v for v in M.entries()), flint.arb(0))


def _scale(P: flint.arb_mat, C: flint.arb_mat) -> flint.arb:
    """Return a bound of the terms of trace(C P C') for a semidefinite P, the same in all units of the states."""
    deviations = [P[j, j].upper().sqrt() for j in range(P.nrows())]
    rows = (sum((abs(C[i, j]) * d for j, d in enumerate(deviations)), flint.arb(0)) for i in range(C.nrows()))
    return sum((row * row for row in rows), flint.arb(0)).upper()
