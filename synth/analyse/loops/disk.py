"""Disk margins (MATLAB `diskmargin`): simultaneous and independent gain and phase variations of all channels of a loop.

         r --->(+)---> [ f ] ---> [ L ] ---+---> y          f = diag(f_1 .. f_p),  1 + L f = 0 is the closed loop
               -^                          |
                +--------------------------+

    f_i = (1 + (1 - sigma)/2 delta_i) / (1 - (1 + sigma)/2 delta_i),        |delta_i| < alpha, complex

The loop stays stable for all such f exactly when alpha <= 1 / mu(S + (sigma - 1)/2 I) at all frequencies, where
S = 1/(1 + L) and mu is the structured singular value for diag(delta) (Seiler, Packard, Gahinet 2020). The minimum over
w is the disk margin. The skew sigma is 0 for gains that rise and fall by the same factor, 1 for a margin of S, and -1
for a margin of T = L/(1 + L). f covers all gains between two factors and all phases up to an angle.

`of_loop` varies all channels at once (multiloop), `loop_at_a_time` varies one (loop-at-a-time); `least` returns the
least multiloop margin of several loops.
`feedback_loop.close` gives the loop of a plant and a controller, opened at the inputs, the outputs or both. A sampled
loop is evaluated exactly, on z = exp(i w T).

Sensitivity of a loop to rounding of its coefficients (first-order perturbation bound).

Each coefficient is rounded by at most half a unit in the last place. To first order, the relative change of L is at
most EPS times

    sum |b_k| / |N| + sum |a_k| |z|^k / |D|                                 coefficients b, a
    (|c R| (|A| |R b| + |b|) + |c| |R b| + |d|) / |L|,   R = (s I - A)^-1   state space

and there is a similar bound for det(s I - A + b c / (1 + d)), whose zeros are the closed-loop poles.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import flint
import numpy as np
from numpy.typing import NDArray

from synth import arguments, show
from synth.analyse.loops import structured_peak, transfer, zpk
from synth.analyse.loops.zpk import BITS, Rational
from synth.analyse.numerics import magnitude, precise
from synth.errors import ModelError, SignalError
from synth.statespace import Array, Complex, StateSpace, System, of, readonly
from synth.timing import Continuous, Time


@show.result
class DiskMargin:
    """The disk margin of a loop with p channels: it lies between `lower` and `upper`.

    No f with |delta_i| < `lower` destabilises the loop. If `certified`, this is proved for all frequencies, otherwise
    only at the points of the grid. `delta` (p,), of modulus `upper`, puts a closed-loop pole at `frequency` rad/s.
    `curve` (k,) is the margin at each of `frequencies` (k,), which include 0 and infinity or Nyquist: a lower bound,
    tight to about 1 % away from its least values.
    """

    channels: tuple[str, ...]
    skew: float
    time: Time
    lower: float
    upper: float
    certified: bool
    frequency: float
    delta: Complex
    frequencies: Array
    curve: Array

    def __post_init__(self) -> None:
        delta = np.array(self.delta, dtype=np.complex128)
        delta.flags.writeable = False
        object.__setattr__(self, "delta", delta)
        object.__setattr__(self, "frequencies", readonly(self.frequencies))
        object.__setattr__(self, "curve", readonly(self.curve))

    @property
    def alpha(self) -> float:
        """The guaranteed disk margin: `lower`."""
        return self.lower

    @property
    def gain_low(self) -> float:
        """The factor to which all gains may decrease at once; below 0, no positive gain is too low."""
        a, b = _skew_factors(self.skew)
        if b * self.alpha <= -1 or (np.isinf(self.alpha) and b <= 0):
            return -np.inf
        return (1 - a * self.alpha) / (1 + b * self.alpha) if np.isfinite(self.alpha) else -a / b

    @property
    def gain_high(self) -> float:
        """The factor to which all gains may increase at once; inf if no gain is too high."""
        a, b = _skew_factors(self.skew)
        if np.isinf(self.alpha) or b * self.alpha >= 1:
            return np.inf
        return (1 + a * self.alpha) / (1 - b * self.alpha)

    @property
    def phase(self) -> float:
        """The angle in degrees by which all phases may change at once, inf if any change is tolerated."""
        a, b = _skew_factors(self.skew)
        if np.isinf(self.alpha) or self.alpha * abs(self.skew) > 2:
            return np.inf if self.skew else 180.0
        square = self.alpha**2
        cosine = (2 - square * (a * a + b * b)) / (2 * (1 + a * b * square))
        return float(np.degrees(np.arccos(np.clip(cosine, -1.0, 1.0))))

    @property
    def worst(self) -> Mapping[str, complex]:
        """`delta` by channel name."""
        return dict(zip(self.channels, self.delta.tolist(), strict=True))

    @property
    def factors(self) -> Complex:
        """f (p,) for `delta`: the channel factors that make the loop oscillate at `frequency`."""
        a, b = _skew_factors(self.skew)
        with np.errstate(all="ignore"):
            f = (1 + a * self.delta) / (1 - b * self.delta)
        return np.where(np.isfinite(f), f, np.inf)

    def sheet(self) -> show.Sheet:
        """Return the margin, its gains and phase, and the worst factor of each channel."""
        n = show.number
        proof = "proved for all frequencies" if self.certified else "that of a grid, not proved between its points"
        lines = (
            f"{n(self.lower)} <= alpha <= {n(self.upper)}, skew {n(self.skew)}; the lower bound is {proof}",
            f"all gains may change at once by factors from {n(self.gain_low)} to {n(self.gain_high)}, or all phases "
            f"by {n(self.phase)} deg",
            f"the factors f below put a closed-loop pole at {n(self.frequency)} rad/s"
            if np.isfinite(self.upper)
            else "no factors make the loop unstable",
        )
        rows = tuple(
            (name, n(delta), n(abs(f)), n(float(np.degrees(np.angle(f)))))
            for (name, delta), f in zip(self.worst.items(), self.factors.tolist(), strict=True)
        )
        table = show.Table("", ("channel", "delta", "|f|", "arg f [deg]"), rows)
        count = f"{len(self.channels)} channel{'s' * (len(self.channels) > 1)}"
        return show.Sheet(f"Disk margin of {count} in {self.time}: {n(self.alpha)}", lines, (table,))


@arguments.checked
def of_loop(loop: System, skew: float = 0.0, certify: bool = True) -> DiskMargin:
    """Return the multiloop disk margin of L (p, p): all channels vary at once. Channels have the names of L's inputs.

    Without `certify`, the margin is that of a grid refined around its peak, with no claim between the grid points.

    Raises SignalError when L is not square or the skew is not finite; ModelError when 1 + L has no inverse or the
    closed loop is not stable.
    """
    closed = _shifted_sensitivity(of(loop), skew)
    return _margin(closed, structured_peak.over_frequency(closed, certify), skew)


@arguments.checked
def least(loops: Sequence[System], below: float, skew: float = 0.0) -> tuple[int, DiskMargin] | None:
    """Return which of some loops has the least multiloop disk margin `below` a value, and this margin; else None.

    The margins of the other loops are proved to be no smaller; each takes a fraction of the time of `of_loop`.

    Raises as `of_loop`; SignalError unless `below` is above 0.
    """
    if not below > 0:
        raise SignalError(f"the margin to stay below is {below}: it must be above 0, inf for any margin")
    closed = [_shifted_sensitivity(of(loop), skew) for loop in loops]
    largest = structured_peak.largest(closed, 1 / below)
    return (largest[0], _margin(closed[largest[0]], largest[1], skew)) if largest else None


@arguments.checked
def loop_at_a_time(loop: System, skew: float = 0.0) -> Mapping[str, DiskMargin]:
    """Return the loop-at-a-time disk margins: that of each channel, with the others nominal, by name of L's input.

    Raises as `of_loop`.
    """
    model = of(loop)
    closed = _shifted_sensitivity(model, skew)
    return {
        name: _margin(channel, structured_peak.over_frequency(channel), skew)
        for name, output in zip(closed.inputs, closed.outputs, strict=True)
        for channel in [closed.select((output,), (name,))]
    }


def _skew_factors(skew: float) -> tuple[float, float]:
    return (1 - skew) / 2, (1 + skew) / 2


def _shifted_sensitivity(loop: StateSpace, skew: float) -> StateSpace:
    """Return S + (sigma - 1)/2 I of a square loop with a stable closed loop."""
    p = len(loop.inputs)
    if not p or p != len(loop.outputs):
        raise SignalError(
            f"the loop has {p} inputs ({', '.join(loop.inputs)}) and {len(loop.outputs)} outputs "
            f"({', '.join(loop.outputs)}): give it as many outputs as inputs, at least one"
        )
    if not np.isfinite(skew):
        raise SignalError(f"the skew is {skew}: it must be finite; 0 is the balanced one")
    feedthrough = np.eye(p) + loop.D
    if magnitude.is_singular(feedthrough):
        raise ModelError("1 + L has no inverse at infinite frequency, I + D is singular: put a delay into the loop")
    R = np.linalg.inv(feedthrough)
    A = loop.A - loop.B @ R @ loop.C
    _require_decay(A, loop.time)
    return replace(loop, A=A, B=loop.B @ R, C=-R @ loop.C, D=R - _skew_factors(skew)[0] * np.eye(p))


def _require_decay(A: Array, time: Time) -> None:
    poles = np.linalg.eigvals(A).astype(np.complex128)
    lasting = transfer.not_decaying(poles, time)
    if lasting.any():
        listed = ", ".join(show.number(s) for s in poles[lasting & (poles.imag >= 0)].tolist())
        raise ModelError(
            f"the closed loop does not decay: it has poles at {listed}, and so no margin; stabilise the loop first "
            "(the feedback is negative, 1 + L: change the sign if L contains it)"
        )


def _margin(closed: StateSpace, peak: structured_peak.Peak, skew: float) -> DiskMargin:
    with np.errstate(divide="ignore"):
        lower, upper, curve = 1 / np.float64(peak.level), 1 / np.float64(peak.lower), 1 / peak.bounds
    bounds = float(lower), float(upper), peak.certified
    return DiskMargin(
        closed.inputs, float(skew), closed.time, *bounds, peak.frequency, peak.delta, peak.frequencies, curve
    )


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
    if zpk.count_unstable(loop, 1.0) or zpk.count_in_right_half_plane(loop.common, flint.fmpz_poly([])):
        return False
    poles = loop.closed_loop_poles if loop.coefficients else loop.poles_in_double
    hidden = [w for w in map(loop.frequency, np.unique(np.abs(poles))) if of_rational(loop, w).of_closed >= 1]
    if not hidden:
        return True
    if (_decay(loop.closed_loop_poles, loop.time) <= MIN_DECAY).any():
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
