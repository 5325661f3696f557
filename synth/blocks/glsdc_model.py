"""Nonlinear measurement model y = h(q) + v: its unknowns, its covariance, and its whitened residuals and Jacobian.

    v ~ N(0, R),   W R W' = s^2 I,   e(q) = W (y - h(q)),   H(q) = W dh/dq      angles: y - h wrapped to half a turn

with W lower triangular and s = 1, or with W = I and s^2 the common variance of independent measurements, which then
needs no multiplication.

A periodic unknown q_i of period T_i also enters h by the cosine and the sine of a_i = 2 pi q_i / T_i. They are computed
once a sample, at the prediction; a trial rotates them by the small angle of its displacement. By the chain rule

    dh/dq_i = dh/dq_i |c,s + (2 pi / T_i) (c dh/ds - s dh/dc),   c = cos a_i,  s = sin a_i

Source: Bar-Shalom, Li, Kirubarajan, "Estimation with Applications to Tracking and Navigation", section 3.4 (nonlinear
weighted least squares).
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from math import inf, pi

import casadi as ca
import numpy as np
from numpy.typing import ArrayLike

from synth import arguments, numeric
from synth import law as laws
from synth.block import Constant, Exprs, clip
from synth.blocks import phasor
from synth.blocks.glsdc import NamedExpressions, Vector
from synth.blocks.phasor import UNIT, Phasor
from synth.errors import ModelError, SignalError
from synth.signals import Signal, signal_names
from synth.statespace import Array, readonly

Measurement = Callable[[Exprs, Exprs], Exprs]
"""h(q, k): maps unknowns and constants by name to the value of each channel; q also has cos_<name> and sin_<name>."""


@dataclass(frozen=True)
class Unknown:
    """An unknown with its range. Its deviation is resolved up to `largest_deviation`, in the unit of the signal.

    The sum of corrections in a sample is at most `step`. The estimate begins at `start`. The range of a `periodic`
    unknown is one period. `prior` is the standard deviation of a prior, infinite for none, which is about `prior_value`
    or, if this is None, about the prediction. The prediction continues the last motion if the `velocity_gain` is above
    0: motion + velocity_gain * correction.

    Raises ModelError for a value out of its range.
    """

    signal: Signal
    largest_deviation: float
    step: float
    start: float = 0.0
    periodic: bool = False
    prior: float = inf
    prior_value: float | None = None
    velocity_gain: float = 0.0

    def __post_init__(self) -> None:
        s = self.signal
        numeric.positive(f"the largest deviation of '{s.name}'", self.largest_deviation)
        numeric.above(f"the step of '{s.name}'", self.step, 0, self.width / 2)
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
    variances = numeric.positive("the inflation", inflation) ** 2 * (noise**2 + model_error**2)
    if not (np.isfinite(variances).all() and (variances > 0).all() and (noise >= 0).all() and (model_error >= 0).all()):
        raise ModelError(f"the variances are {variances}: give deviations from 0 on, above 0 in each channel")
    return readonly(np.diag(variances))


@dataclass(frozen=True, eq=False)
class Model:
    """A measurement model, whitened: `whitening` W (m, m) and `scale` s of the whitened residuals.

    The residuals of the channels in `angles` are wrapped into half the width of their ranges, which is one turn.
    `function` maps (q (n,), cosines, sines, constants) to h (m,) and W dh/dq (m, n).
    """

    channels: tuple[Signal, ...]
    angles: frozenset[str]
    unknowns: tuple[Unknown, ...]
    whitening: Array
    scale: float
    function: ca.Function

    @property
    def prior_weights(self) -> tuple[float, ...]:
        """s^2 over the variance of each prior, 0 for none."""
        return tuple(0.0 if u.prior == inf else (self.scale / u.prior) ** 2 for u in self.unknowns)

    @property
    def floors(self) -> tuple[float, ...]:
        """The least pivots: s^2 / largest_deviation^2."""
        return tuple((self.scale / u.largest_deviation) ** 2 for u in self.unknowns)

    @property
    def is_diagonal(self) -> bool:
        """Whether the errors of the channels are independent."""
        return not np.tril(self.whitening, -1).any()

    def residuals(self, measured: Vector, values: Vector) -> list[ca.SX]:
        """Return W (y - h) (m,), differences of angles wrapped."""
        differences = []
        for channel, y, h in zip(self.channels, measured, values, strict=True):
            turn, d = channel.high - channel.low, y - h
            if channel.name in self.angles:
                d = ca.if_else(d > turn / 2, d - turn, d)
                d = ca.if_else(d < -turn / 2, d + turn, d)
            differences.append(d)
        return _entries(ca.sparsify(ca.DM(self.whitening)) @ ca.vcat(differences))


def model(
    h: Measurement,
    R: Array,
    channels: Sequence[Signal],
    angles: Sequence[str],
    unknowns: Sequence[Unknown],
    constants: Sequence[Constant],
) -> Model:
    """Return the whitened model.

    Raises ModelError for a covariance that is not positive definite or too few channels, and SignalError for names that
    are repeated, angles that are not channels, and a function that does not return a value for each channel.
    """
    channels, unknowns = tuple(channels), tuple(unknowns)
    _check(R, channels, unknowns)
    if strangers := [n for n in angles if n not in signal_names(channels)]:
        raise SignalError(f"the angle '{strangers[0]}' is no channel: give some of {', '.join(signal_names(channels))}")
    q = {n: ca.SX.sym(n) for n in signal_names([u.signal for u in unknowns])}
    periodic = [u for u in unknowns if u.periodic]
    cosines, sines = ({u.name: ca.SX.sym(f"{f}_{u.name}") for u in periodic} for f in ("cos", "sin"))
    k = {c.name: ca.SX.sym(c.name) for c in constants}
    known = laws.Named(
        "h: the unknowns", q | {f"cos_{n}": v for n, v in cosines.items()} | {f"sin_{n}": v for n, v in sines.items()}
    )
    values = laws.evaluate("h", h, known, laws.Named("h: the constants", k))
    if not isinstance(values, Mapping):
        raise SignalError(f"h returns {arguments.describe(values)}: return a mapping of each channel to its value")
    laws.require_names("h", signal_names(channels), values)
    laws.check_numbers("h", {n: ca.SX(v) for n, v in values.items()}, [*known.values(), *k.values()])
    whitening, scale = _whitening(R)
    y = ca.vcat([ca.SX(values[s.name]) for s in channels])
    columns = []
    for u in unknowns:
        column = ca.jacobian(y, q[u.name])
        if u.periodic:
            c, s = cosines[u.name], sines[u.name]
            column += 2 * pi / u.width * (c * ca.jacobian(y, s) - s * ca.jacobian(y, c))
        columns.append(column)
    H = ca.sparsify(ca.DM(whitening)) @ ca.hcat(columns)
    vectors = [ca.vcat(list(group.values())) for group in (q, cosines, sines, k)]
    function = ca.Function("model", vectors, [y, H])
    return Model(channels, frozenset(angles), unknowns, readonly(whitening), scale, function)


def _check(R: Array, channels: tuple[Signal, ...], unknowns: tuple[Unknown, ...]) -> None:
    m, measured = len(channels), len(channels) + sum(u.prior < inf for u in unknowns)
    if not unknowns or measured < len(unknowns):
        raise ModelError(
            f"{m} channels and the priors are {measured} for {len(unknowns)} unknowns: give as many at least"
        )
    if R.shape != (m, m) or not np.isfinite(R).all() or not np.allclose(R, R.T, rtol=1e-12, atol=0):
        raise ModelError(f"R has shape {R.shape}, or is not finite and symmetric: give a covariance {(m, m)}")
    if np.linalg.eigvalsh(R / np.sqrt(np.outer(R.diagonal(), R.diagonal()))).min() < 1e-12 or (R.diagonal() <= 0).any():
        raise ModelError("R is not positive definite: each channel needs an error of its own")


def _whitening(R: Array) -> tuple[Array, float]:
    """Return W and s with W R W' = s^2 I."""
    variances = R.diagonal()
    if not np.any(R - np.diag(variances)):
        if (variances == variances[0]).all():
            return np.eye(len(R)), float(np.sqrt(variances[0]))
        return np.diag(1 / np.sqrt(variances)), 1.0
    return np.tril(np.linalg.inv(np.linalg.cholesky(R))), 1.0


@dataclass(frozen=True, eq=False)
class Prediction:
    """The predicted unknowns in their ranges, the phasors of the periodic ones that h uses, and the held channels."""

    values: Vector
    phasors: dict[str, Phasor]
    measured: Vector
    constants: ca.SX


def predict(of: Model, values: Vector, measured: Vector, constants: ca.SX, named: NamedExpressions) -> Prediction:
    """Return the prediction of a sample; `named` receives the parts of the phasors."""
    phasors, periodic = {}, [(u, v) for u, v in zip(of.unknowns, values, strict=True) if u.periodic]
    for i, (u, value) in enumerate(periodic):
        if _uses_phasor(of, i):
            rate = 2 * pi / u.width
            halvings = phasor.halvings(rate * max(abs(u.signal.low), abs(u.signal.high)))
            phasors[u.name] = phasor.by_range_reduction(rate * value, halvings, f"{u.name}_fraction", named)
    return Prediction(values, phasors, measured, constants)


def _uses_phasor(of: Model, i: int) -> bool:
    """Return whether the model depends on the cosine or the sine of its i-th periodic unknown."""
    symbols = [ca.SX.sym(name, of.function.size1_in(j)) for j, name in enumerate(("q", "c", "s", "k"))]
    used = {v.element_hash() for v in ca.symvar(of.function(*symbols)[0])}
    return any(symbols[j][i].element_hash() in used for j in (1, 2))


def linearise(of: Model, prediction: Prediction, at: Vector) -> tuple[list[ca.SX], list[list[ca.SX]]]:
    """Return whitened residuals (m,) and Jacobian rows (m, n) at a displacement (n,) from the prediction."""
    values = [
        start + d if u.periodic else clip(start + d, u.signal)
        for u, start, d in zip(of.unknowns, prediction.values, at, strict=True)
    ]
    phasors = [_displaced(u, prediction, d) for u, d in zip(of.unknowns, at, strict=True) if u.periodic]
    cosines, sines = (ca.vcat([getattr(p, part) for p in phasors]) for part in ("cosine", "sine"))
    y, H = of.function(ca.vcat(values), cosines, sines, prediction.constants)
    rows = [[H[i, j] for j in range(len(of.unknowns))] for i in range(len(of.channels))]
    return of.residuals(prediction.measured, _entries(y)), rows


def _displaced(u: Unknown, prediction: Prediction, by: ca.SX) -> Phasor:
    """Return the phasor of a periodic unknown at a displacement; any if the model does not use it."""
    start = prediction.phasors.get(u.name)
    if start is None or by.is_zero():
        return start or Phasor(ca.SX(1), ca.SX(0))
    p = start.times(phasor.of(2 * pi / u.width * by))
    return Phasor(clip(p.cosine, UNIT), clip(p.sine, UNIT))


def _entries(column: ca.SX) -> list[ca.SX]:
    return [column[i] for i in range(column.shape[0])]
