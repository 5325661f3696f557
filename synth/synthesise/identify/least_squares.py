"""Linear least squares with confidence: y = Phi theta + e.

N rows of p outputs, k parameters: y (N, p), Phi (N, p, k), e independent, of standard deviation s w_j in output j. With
rows divided by w_j and stacked, columns divided by their norms c,

    theta = C^-1 V S^-1 U' y,     U S V' = Phi C^-1,     s^2 = |y - Phi theta|^2 / (N p - k),
    cov theta = s^2 C^-1 V S^-2 V' C^-1,       theta_i +- t(N p - k) sqrt(cov_ii),

t the quantile of Student's distribution. Where several outputs have no w_j given, each one's noise is estimated by
restricted maximum likelihood, found by repeated fits, and the intervals are wider by what that costs (`variances`).
Right vectors of singular values that are zero are combinations of parameters that no row determines.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from synth import arguments
from synth.errors import ModelError, SignalError
from synth.statespace import Array, readonly
from synth.synthesise.identify import bordered, undetermined, variances
from synth.synthesise.identify.estimate import Estimate, Residual

PASSES = 500  # fits that may be needed until the outputs' noise settles
SETTLED = 1e-6  # relative change of a deviation that counts as none
EXACT = 1e-12  # of the rms of an output: a residual below is taken for this, so that an exact fit has a weight
PASSED_THROUGH = 1e-9  # of a residual's variance: below it the fit passes through the row, whatever was measured


@dataclass(frozen=True, eq=False)
class Solution:
    """The solution for given weights (p,): theta = root U'(y / weight), residuals e (N, p), the bases U, Q of the fit.

    U is (N, p, k); Q (s, L, p, f) spans what groups of rows fit by parameters of their own, which are not shown.
    """

    theta: Array
    e: Array
    U: Array
    Q: Array
    root: Array
    weight: Array
    condition: float


@arguments.checked
def solve(
    Phi: ArrayLike,
    y: ArrayLike,
    parameters: Sequence[str],
    outputs: Sequence[str] = ("y",),
    noise: Mapping[str, float] | None = None,
    level: float = 0.95,
    units: Mapping[str, str] | None = None,
    near: ArrayLike | None = None,
) -> Estimate:
    """Return theta of y = Phi theta + e; Phi (N, p, k), y (N, p), or (N, k) and (N,) for one output.

    `noise` gives the outputs' standard deviations, up to a common factor. `units` is carried along. What is not
    determined is told in changes relative to the values `near` (k,).

    Raises SignalError for shapes that do not fit, a value that is not finite, naming row and signal, a level or noise
    out of range, or fewer rows than it takes; ModelError naming combinations of parameters that are not determined,
    or when the outputs' noise cannot be told from the data.
    """
    parameters, outputs = arguments.distinct("parameters", parameters), arguments.distinct("outputs", outputs)
    Phi, y = _shaped(Phi, y, parameters, outputs)
    about = None if near is None else arguments.real("values near which to solve", near)
    J = bordered.of(Phi)
    check_rows(J, y, parameters, outputs, noise)
    weight = weights(noise, outputs, y)
    found = weighted(J, y, weight, parameters, about)
    for _ in range(PASSES if noise is None and len(outputs) > 1 else 0):
        before, weight = weight, deviations(found, y, outputs)
        found = weighted(J, y, weight, parameters, about)
        if np.allclose(before, weight, rtol=SETTLED, atol=0.0):
            break
    else:
        if noise is None and len(outputs) > 1:
            raise ModelError(unsettled(PASSES))
    return estimate(found, y, parameters, outputs, noise, level, units)


def weighted(
    Phi: bordered.Jacobian, y: Array, weight: Array, parameters: Sequence[str], near: Array | None = None
) -> Solution:
    """Return the solution with output j divided by `weight[j]`; raise ModelError naming what is not determined."""
    J, b = Phi.weighted(weight), (y / weight).ravel()
    parts = bordered.factors(J)
    if not (parts.own_sigma > undetermined.RANK).all():
        group = int(parts.own_sigma.min(axis=1).argmin())
        raise ModelError(
            f"the data leave start states of span {group} undetermined: take longer spans, or measure more signals"
        )
    if not parts.sigma[-1] > undetermined.RANK * max(1.0, parts.sigma[0]):
        found = undetermined.combinations(parts.sigma, parts.V, parts.size, parameters, near)
        raise ModelError(
            f"the data leave {' and '.join(found)} undetermined: log samples in which the parameters act apart, "
            "or hold one of them at a known value"
        )
    root = parts.V / parts.sigma / parts.size[:, None]
    e, condition = parts.rest(b).reshape(y.shape) * weight, max(1.0, parts.sigma[0]) / parts.sigma[-1]
    return Solution(
        root @ (parts.U.T @ b),
        e,
        parts.U.reshape(Phi.shared.shape),
        parts.Q.reshape(Phi.own.shape),
        root,
        weight,
        float(condition),
    )


def estimate(
    found: Solution,
    y: Array,
    parameters: Sequence[str],
    outputs: Sequence[str],
    noise: Mapping[str, float] | None,
    level: float,
    units: Mapping[str, str] | None,
) -> Estimate:
    """Return a solution with its confidence; the weights are the noise up to a factor, or for several outputs without
    a `noise` that is given the noise itself, estimated.
    """
    arguments.check_level(level)
    freedom, scale = y.size - len(parameters) - found.Q.shape[0] * found.Q.shape[3], found.weight
    if noise is None and len(outputs) > 1:
        known = variances.confidence(found.U, found.Q, found.root)
    else:
        s = float(np.linalg.norm(found.e / found.weight)) / np.sqrt(freedom)
        scale = s * found.weight
        freedoms = np.full(len(parameters), float(freedom))
        known = variances.Confidence(s**2 * found.root @ found.root.T, freedoms)
    return Estimate(
        tuple(parameters),
        readonly(found.theta),
        readonly(known.covariance),
        dict(zip(outputs, np.sqrt((found.e**2).mean(axis=0)).tolist(), strict=True)),
        explained(y, found.e, outputs),
        freedom,
        readonly(known.freedoms),
        found.condition,
        level,
        _largest(found, scale, outputs),
        units or {},
    )


def weights(noise: Mapping[str, float] | None, outputs: Sequence[str], y: Array) -> Array:
    """Return the noise (p,) of the outputs, their rms where none is given.

    Raises SignalError for a noise that is missing, not positive or of no output.
    """
    if noise is None:
        return _size(y)
    if not isinstance(noise, Mapping):
        raise SignalError(f"the noise is {noise}: give a standard deviation by output, like {{'{outputs[0]}': 1e-3}}")
    for name in noise:
        if name not in outputs:
            raise SignalError(f"a noise is given for '{name}', which is none of the outputs {', '.join(outputs)}")
    for name in outputs:
        value = noise.get(name)
        if not isinstance(value, float | int | np.number) or not arguments.SIZES[0] < value < arguments.SIZES[1]:
            raise SignalError(f"the noise of '{name}' is {value}: give a positive standard deviation")
    return np.array([float(noise[name]) for name in outputs])


def deviations(found: Solution, y: Array, outputs: Sequence[str]) -> Array:
    """Return the standard deviations (p,) of the outputs' noise that fit the residuals.

    Raises ModelError where one output is met exactly and others are not, so that its weight would have no bound.
    """
    floor = EXACT * _size(y)
    found_now = variances.deviations(found.e, found.U, found.Q)
    exact, used = found_now <= floor, found.U.any(axis=(0, 2)) | found.Q.any(axis=(0, 1, 3))
    if (exact & used).any() and not (exact | ~used).all():
        name = outputs[int(np.flatnonzero(exact & used)[0])]
        raise ModelError(
            f"the fit meets '{name}' exactly and the other outputs not, which leaves its noise unknown: give the "
            "`noise` of each output"
        )
    return np.maximum(found_now, floor)


@arguments.checked
def unsettled(passes: int) -> str:
    """Return what to tell when the outputs' noise did not settle."""
    return f"the estimated noise of the outputs does not settle in {passes} fits: give the `noise` of each output"


def explained(y: Array, e: Array, outputs: Sequence[str]) -> dict[str, float]:
    """Return R^2 of each output: the part of its variance that the residuals (N, p) do not have; NaN without any."""
    variance = ((y - y.mean(axis=0)) ** 2).mean(axis=0)
    part = 1 - (e**2).mean(axis=0) / np.where(variance > 0, variance, np.nan)
    return dict(zip(outputs, part.tolist(), strict=True))


def check_rows(
    Phi: bordered.Jacobian,
    y: Array,
    parameters: Sequence[str],
    outputs: Sequence[str],
    noise: Mapping[str, float] | None,
) -> None:
    """Raise SignalError for fewer rows than it takes: more than parameters, in each output whose noise is not given."""
    short = Phi.parameters + 1 - y.size
    if short > 0:
        raise SignalError(
            f"{y.size} equations are too few for {Phi.parameters} parameters ({', '.join(parameters)}) and their "
            f"errors: log {short} or more in addition"
        )
    for name, acting in zip(outputs, Phi.acting(), strict=True):
        if len(y) <= acting and noise is None and len(outputs) > 1:
            raise SignalError(
                f"{len(y)} rows of '{name}', on which {acting} parameters act, do not tell its noise: give the `noise` "
                f"of each output, or log {acting + 1 - len(y)} or more rows in addition"
            )


def _shaped(Phi: ArrayLike, y: ArrayLike, parameters: Sequence[str], outputs: Sequence[str]) -> tuple[Array, Array]:
    Phi, y = arguments.real("regressors", Phi), arguments.real("outputs", y)
    if y.ndim == 1 and Phi.ndim == 2:
        Phi, y = Phi[:, None, :], y[:, None]
    wanted = (len(y) if y.ndim else 0, len(outputs), len(parameters))
    if y.ndim != 2 or Phi.shape != wanted or y.shape != wanted[:2]:
        raise SignalError(
            f"the regressors have shape {Phi.shape} and the outputs {y.shape}: {len(outputs)} outputs and "
            f"{len(parameters)} parameters need (N, {len(outputs)}, {len(parameters)}) and (N, {len(outputs)})"
        )
    arguments.check_samples(y, outputs)
    for row, j, i in np.argwhere(~np.isfinite(Phi)):
        raise SignalError(
            f"row {row} of the regressor of '{parameters[i]}' in '{outputs[j]}' is {Phi[row, j, i]}: leave the row out"
        )
    arguments.check_sizes("the regressor of", Phi.reshape(y.size, len(parameters)), parameters)
    return Phi, y


def _largest(found: Solution, scale: Array, outputs: Sequence[str]) -> Residual:
    """Return the largest residual over its own standard deviation, that of the noise times sqrt(1 - leverage)."""
    left = 1 - (found.U**2).sum(axis=2) - (found.Q**2).sum(axis=3).reshape(found.e.shape)
    deviation = scale * np.sqrt(np.where(left > PASSED_THROUGH, left, np.inf))
    size = np.abs(found.e) / np.where(deviation > 0, deviation, np.inf)
    row, j = divmod(int(size.argmax()), len(outputs))
    return Residual(outputs[j], row, float(size[row, j]), size.size)


def _size(y: Array) -> Array:
    rms = np.sqrt((y**2).mean(axis=0))
    return np.where(rms > 0, rms, 1.0)
