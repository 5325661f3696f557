"""Declaration of a measurement model y = h(q) + v: unknowns with ranges and priors, phases, covariance of the errors.

    h(q, k):   maps unknowns q and constants k by name to the value of each channel; of a periodic unknown q_i and of a
               Phase a there are cos_<name> and sin_<name> besides
    Implicit:  e(q, y, k) maps to the residuals instead, for models that are simpler in other axes than the sensors'
    RotatedMeasurement:
               f(q, k) maps to plane vectors in fixed axes, which a body measures that an unknown angle turns
    R:         covariance of the errors v, f^2 (noise^2 + model_error^2)

Source: Bar-Shalom, Li, Kirubarajan, "Estimation with Applications to Tracking and Navigation", section 3.4 (nonlinear
weighted least squares).

Conditions on the declaration of a measurement model: covariance, angles among the channels, pairs that turn.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from math import inf, pi

import casadi as ca
import numpy as np
from numpy.typing import ArrayLike

from synth import arguments, numeric
from synth.block import Exprs, clip
from synth.blocks.estimate import phasor
from synth.errors import ModelError, SignalError
from synth.signals import Signal, signal_names
from synth.statespace import Array, readonly

Measurement = Callable[[Exprs, Exprs], Exprs]
"""h(q, k): maps unknowns and constants by name to the value of each channel; q also has cos_<name> and sin_<name>."""


@dataclass(frozen=True)
class Implicit:
    """A model by its residuals: maps unknowns, channels and constants by name to a residual for each channel.

    The residuals are the errors of the channels up to signs and rotations among channels of equal variance.
    """

    residual: Callable[[Exprs, Exprs, Exprs], Exprs]


@dataclass(frozen=True)
class RotatedMeasurement:
    """A model of plane vectors in fixed axes, `fixed`(q, k), measured in those of a body at the unknown `angle`, rad.

    The two channels of a vector are one of the `pairs`, of equal variances. In fixed axes, with R(angle) and its
    derivative J R, the residual and the Jacobian of y - R'f are

        e = R y - f,    H = df/dq + J'f on the angle

    A derivative of e would have J'R y, which differs from J'f by the residual: far from a solution these are other
    corrections than those of the measured channels.
    """

    fixed: Measurement
    angle: str
    pairs: Sequence[tuple[str, str]]

    def residual(self, q: Exprs, y: Exprs, k: Exprs) -> Exprs:
        """Return e of each channel."""
        c, s, f = q[f"cos_{self.angle}"], q[f"sin_{self.angle}"], self.fixed(q, k)
        of: dict[str, ca.SX] = {}
        for a, b in self.pairs:
            of |= {a: c * y[a] - s * y[b] - f[a], b: c * y[b] + s * y[a] - f[b]}
        return of

    def turning(self, f: Exprs) -> Exprs:
        """Return J'f of each channel, of vectors f."""
        return {name: v for a, b in self.pairs for name, v in ((a, f[b]), (b, -f[a]))}


@dataclass(frozen=True)
class Phase:
    """An angle (rad) of which h uses cos_<name> and sin_<name>: `angle(q, k)` within +-`largest`, +-`change` a sample.

    Raises ModelError for a value out of its range.
    """

    name: str
    angle: Callable[[Exprs, Exprs], ca.SX]
    largest: float
    change: float

    def __post_init__(self) -> None:
        numeric.positive(f"the largest value of '{self.name}'", self.largest)
        numeric.above(f"the change of '{self.name}'", self.change, 0, phasor.MAX_ANGLE)


@arguments.checked
@dataclass(frozen=True)
class Unknown:
    """An unknown with its range. Its deviation is resolved up to `largest_deviation`, in the unit of the signal.

    The sum of corrections in a sample is at most `step`. The estimate begins at `start`. The range of a `periodic`
    unknown is one period. h also has the cosine and the sine of an `angle`, which is not periodic and within 1.2 rad.
    `prior` is the standard deviation of a prior, infinite for none, which is about `prior_value` or, if this is None,
    about the prediction. The prediction continues the last motion if the `velocity_gain` is above 0: motion +
    velocity_gain * correction.

    Raises ModelError for a value out of its range.
    """

    signal: Signal
    largest_deviation: float
    step: float
    start: float = 0.0
    periodic: bool = False
    angle: bool = False
    prior: float = inf
    prior_value: float | None = None
    velocity_gain: float = 0.0

    def __post_init__(self) -> None:
        s = self.signal
        numeric.positive(f"the largest deviation of '{s.name}'", self.largest_deviation)
        numeric.above(f"the step of '{s.name}'", self.step, 0, self.width / 2)
        if self.angle and (self.periodic or max(abs(s.low), abs(s.high)) > phasor.MAX_ANGLE):
            raise ModelError(
                f"'{s.name}' is an angle, and periodic or beyond {phasor.MAX_ANGLE} rad: give angle=False, its cosine "
                "and sine come with a period"
            )
        if self.prior_value is not None and self.prior == inf:
            raise ModelError(
                f"the prior value of '{s.name}' is {self.prior_value}, and its prior has no deviation: give the prior, "
                "or no prior value"
            )
        if not self.prior > 0:
            raise ModelError(f"the prior of '{s.name}' has the deviation {self.prior}: give a positive one, or inf")
        if not 0 <= numeric.number(f"the velocity gain of '{s.name}'", self.velocity_gain) <= 1:
            raise ModelError(f"the velocity gain of '{s.name}' is {self.velocity_gain}: give a number from 0 to 1")
        for what, value in (("start", self.start), ("prior value", self.prior_value)):
            if value is not None and not s.low <= numeric.number(f"the {what} of '{s.name}'", value) <= s.high:
                raise ModelError(f"the {what} of '{s.name}' is {value}: give one in {s.low} .. {s.high} {s.unit}")

    @property
    def name(self) -> str:
        """The signal's name."""
        return self.signal.name

    @property
    def width(self) -> float:
        """The width of the range: the period of a periodic unknown."""
        return self.signal.high - self.signal.low

    @property
    def rate(self) -> float:
        """The angle of its phasor by the unknown, 0 for none."""
        return 2 * pi / self.width if self.periodic else float(self.angle)

    def wrap(self, value: ca.SX) -> ca.SX:
        """Return a value less than a width out of range brought into the range: wrapped if periodic, else limited."""
        if not self.periodic:
            return clip(value, self.signal)
        value = ca.if_else(value > self.signal.high, value - self.width, value)
        return clip(ca.if_else(value < self.signal.low, value + self.width, value), self.signal)

    def offset(self, value: ca.SX) -> ca.SX:
        """Return how far a prediction in the range is from the prior's value, the short way round; 0 without one."""
        if self.prior == inf or self.prior_value is None:
            return ca.SX(0)
        offset, half = value - self.prior_value, self.width / 2
        if not self.periodic:
            return offset
        offset = ca.if_else(offset > half, offset - self.width, offset)
        return ca.if_else(offset < -half, offset + self.width, offset)


@arguments.checked
def covariance(noise: ArrayLike, model_error: ArrayLike, inflation: float = 1.0) -> Array:
    """Return R = f^2 (noise^2 + model_error^2) (m, m), diagonal; deviations (m,) in the units of the channels.

    `model_error` is what the calibration of the model left; f is the `inflation`.

    Raises ModelError for deviations that are negative, not finite, of different shapes, or both 0.
    """
    noise, model_error = (
        np.atleast_1d(arguments.real("noise", noise)),
        np.atleast_1d(arguments.real("model errors", model_error)),
    )
    if noise.ndim != 1 or noise.shape != model_error.shape:
        raise ModelError(
            f"the noise is {noise.shape} and the model error {model_error.shape}: give one of each a channel"
        )
    for what, deviations in (("noise", noise), ("model error", model_error)):
        if not (np.isfinite(deviations).all() and (deviations >= 0).all()):
            raise ModelError(f"the {what} is {deviations}: give finite deviations from 0 on")
    variances = numeric.positive("the inflation", inflation) ** 2 * (noise**2 + model_error**2)
    if not (variances > 0).all():
        raise ModelError("noise and model error are both 0 in a channel: give deviations above 0 in each channel")
    return readonly(np.diag(variances))


TURNS, ROUNDING = {"rad": 2 * pi, "deg": 360.0}, 1e-6  # width of one turn by unit, relative error of a range


def check(R: Array, channels: tuple[Signal, ...], unknowns: tuple[Unknown, ...]) -> None:
    """Raise ModelError for too few channels, and for an R (m, m) that is no covariance of theirs."""
    m, measured = len(channels), len(channels) + sum(u.prior < inf for u in unknowns)
    if not unknowns or measured < len(unknowns):
        raise ModelError(
            f"{m} channels and the priors are {measured} for {len(unknowns)} unknowns: give as many at least"
        )
    if R.shape != (m, m):
        raise ModelError(f"R has shape {R.shape}: give a covariance {(m, m)}, a row for each channel")
    if not np.isfinite(R).all():
        raise ModelError(f"R has {np.count_nonzero(~np.isfinite(R))} entries that are not finite: give a covariance")
    if not np.allclose(R, R.T, rtol=1e-12, atol=0):
        raise ModelError("R is not symmetric: give a covariance")
    spreads = np.sqrt(np.maximum(R.diagonal(), 0))
    if not spreads.all() or np.linalg.eigvalsh(R / np.outer(spreads, spreads)).min() < 1e-12:
        raise ModelError("R is not positive definite: each channel needs an error of its own")


def check_angles(angles: Sequence[str], channels: Sequence[Signal]) -> None:
    """Raise SignalError for an angle that is no channel, or whose range is not one turn."""
    if strangers := [n for n in angles if n not in signal_names(channels)]:
        raise SignalError(f"the angle '{strangers[0]}' is no channel: give some of {', '.join(signal_names(channels))}")
    for s in (s for s in channels if s.name in angles and s.unit in TURNS):
        if abs(s.high - s.low - TURNS[s.unit]) > ROUNDING * TURNS[s.unit]:
            raise SignalError(
                f"the angle '{s.name}' has the range {s.low:g} .. {s.high:g} {s.unit}: give one turn, "
                f"{TURNS[s.unit]:.9g} {s.unit} wide"
            )


def check_pairs(h: RotatedMeasurement, R: Array, channels: Sequence[Signal], unknowns: Sequence[Unknown]) -> None:
    """Raise SignalError for a turn by no angle and pairs that are not the channels, ModelError for another R."""
    angles, names = [u.name for u in unknowns if u.rate == 1], signal_names(channels)
    if not callable(h.fixed):
        raise SignalError(
            f"the fixed model is {arguments.describe(h.fixed)}: give a function of unknowns and constants"
        )
    if h.angle not in angles:
        known = f"one of {', '.join(angles)}" if angles else "an Unknown with angle=True"
        raise SignalError(f"the body turns by '{h.angle}', which is no unknown angle in rad: give {known}")
    are_pairs = isinstance(h.pairs, Sequence) and all(isinstance(p, Sequence) and len(p) == 2 for p in h.pairs)
    if not are_pairs or sorted(str(n) for pair in h.pairs for n in pair) != sorted(names):
        raise SignalError(f"the pairs {h.pairs!r} are not the channels: each stands in one pair")
    quarter = np.zeros_like(R)
    for a, b in h.pairs:
        quarter[names.index(a), names.index(b)], quarter[names.index(b), names.index(a)] = -1, 1
    if not np.allclose(quarter @ R, R @ quarter, rtol=1e-9, atol=0):
        raise ModelError("R changes when the pairs turn: give both channels of a pair one variance, and no correlation")
