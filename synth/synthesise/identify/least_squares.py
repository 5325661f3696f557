"""Linear least squares with confidence intervals, y = Phi theta + e; MATLAB `lscov`, `regress`.

N rows of p outputs, k parameters: y (N, p), Phi (N, p, k), e independent, of standard deviation s w_j in output j. With
rows divided by w_j and stacked, columns divided by their norms c,

    theta = C^-1 V S^-1 U' y,     U S V' = Phi C^-1,     s^2 = |y - Phi theta|^2 / (N p - k),
    cov theta = s^2 C^-1 V S^-2 V' C^-1,       theta_i +- t(N p - k) sqrt(cov_ii),

t the quantile of Student's distribution. For several outputs with unknown w_j, the noise of each is estimated by
restricted maximum likelihood with repeated fits, which widens the intervals (`variances`). Right singular vectors of
zero singular values are combinations of parameters that the data do not determine.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from synth import arguments
from synth.errors import ModelError, SignalError
from synth.statespace import Array, readonly
from synth.synthesise.identify import bordered, identifiability, variances
from synth.synthesise.identify.estimate import Estimate, Residual

PASSES = 500  # most fits until the outputs' noise converges
CONVERGENCE_TOLERANCE = 1e-6  # relative change of a standard deviation
# Of the rms of an output: lower bound of the residual, which gives an exact fit a finite weight.
MIN_RELATIVE_RESIDUAL = 1e-12
PASSED_THROUGH = 1e-9  # of a residual's variance: below it the fit interpolates the row


@dataclass(frozen=True, eq=False)
class Solution:
    """The solution for fixed standard deviations (p,) of the noise: theta = root U'(y / deviation), residuals e (N, p).

    U (N, p, k) is the basis of the fit. Q (s, L, p, f) is that of the parameters of groups of rows, which are not
    reported.
    """

    theta: Array
    e: Array
    U: Array
    Q: Array
    root: Array
    deviation: Array
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

    `noise` gives the outputs' standard deviations up to a common factor. `units` is passed on to the result. Errors
    about undetermined combinations are relative to the values `near` (k,).

    Raises SignalError for wrong shapes, a value that is not finite, naming row and signal, a level or noise out of
    range, or too few rows; ModelError naming combinations of parameters that are not determined, or when the data do
    not determine the outputs' noise.
    """
    parameters, outputs = arguments.distinct("parameters", parameters), arguments.distinct("outputs", outputs)
    Phi, y = _check_shapes(Phi, y, parameters, outputs)
    nominal = None if near is None else arguments.real("values near which to solve", near)
    J = bordered.of(Phi)
    check_rows(J, y, parameters, outputs, noise)
    deviation = initial_deviations(noise, outputs, y)
    solution = solve_with_deviations(J, y, deviation, parameters, nominal)
    for _ in range(PASSES if noise is None and len(outputs) > 1 else 0):
        before, deviation = deviation, deviations(solution, y, outputs)
        solution = solve_with_deviations(J, y, deviation, parameters, nominal)
        if np.allclose(before, deviation, rtol=CONVERGENCE_TOLERANCE, atol=0.0):
            break
    else:
        if noise is None and len(outputs) > 1:
            raise ModelError(no_convergence_text(PASSES))
    return estimate(solution, y, parameters, outputs, noise, level, units)


def solve_with_deviations(
    Phi: bordered.Jacobian, y: Array, deviation: Array, parameters: Sequence[str], near: Array | None = None
) -> Solution:
    """Return the solution with output j divided by `deviation[j]`; raise ModelError for undetermined parameters."""
    J, b = Phi.weighted(deviation), (y / deviation).ravel()
    factors = bordered.factors(J)
    if not (factors.group_sigma > identifiability.RANK).all():
        group = int(factors.group_sigma.min(axis=1).argmin())
        raise ModelError(
            f"the data leave initial states of span {group} undetermined: take longer spans, or measure more signals"
        )
    if not factors.sigma[-1] > identifiability.RANK * max(1.0, factors.sigma[0]):
        combinations = identifiability.undetermined_combinations(
            factors.sigma, factors.V, factors.size, parameters, near
        )
        raise ModelError(
            f"the data leave {' and '.join(combinations)} undetermined: log samples in which the "
            "parameters act independently, or hold one of them at a known value"
        )
    root = factors.V / factors.sigma / factors.size[:, None]
    e, condition = factors.outside_range(b).reshape(y.shape) * deviation, max(1.0, factors.sigma[0]) / factors.sigma[-1]
    return Solution(
        root @ (factors.U.T @ b),
        e,
        factors.U.reshape(Phi.shared.shape),
        factors.Q.reshape(Phi.group.shape),
        root,
        deviation,
        float(condition),
    )


def estimate(
    solution: Solution,
    y: Array,
    parameters: Sequence[str],
    outputs: Sequence[str],
    noise: Mapping[str, float] | None,
    level: float,
    units: Mapping[str, str] | None,
) -> Estimate:
    """Return a solution with its confidence.

    The deviations are the noise up to a factor; for several outputs without `noise` they are the estimated noise.
    """
    arguments.check_level(level)
    freedom, scale = y.size - len(parameters) - solution.Q.shape[0] * solution.Q.shape[3], solution.deviation
    if noise is None and len(outputs) > 1:
        confidence = variances.confidence(solution.U, solution.Q, solution.root)
    else:
        s = float(np.linalg.norm(solution.e / solution.deviation)) / np.sqrt(freedom)
        scale = s * solution.deviation
        degrees_of_freedom = np.full(len(parameters), float(freedom))
        confidence = variances.Confidence(s**2 * solution.root @ solution.root.T, degrees_of_freedom)
    return Estimate(
        tuple(parameters),
        readonly(solution.theta),
        readonly(confidence.covariance),
        dict(zip(outputs, np.sqrt((solution.e**2).mean(axis=0)).tolist(), strict=True)),
        r_squared(y, solution.e, outputs),
        freedom,
        readonly(confidence.degrees_of_freedom),
        solution.condition,
        level,
        _largest_residual(solution, scale, outputs),
        units or {},
    )


def initial_deviations(noise: Mapping[str, float] | None, outputs: Sequence[str], y: Array) -> Array:
    """Return the noise (p,) of the outputs, or their rms without `noise`.

    Raises SignalError for a noise that is missing, not positive or of no output.
    """
    if noise is None:
        return _size(y)
    if not isinstance(noise, Mapping):
        raise SignalError(f"the noise is {noise}: give a standard deviation by output, like {{'{outputs[0]}': 1e-3}}")
    for name in noise:
        if name not in outputs:
            raise SignalError(f"a noise is given for '{name}', which is not one of the outputs {', '.join(outputs)}")
    for name in outputs:
        value = noise.get(name)
        if not isinstance(value, float | int | np.number) or not arguments.SIZES[0] < value < arguments.SIZES[1]:
            raise SignalError(f"the noise of '{name}' is {value}: give a positive standard deviation")
    return np.array([float(noise[name]) for name in outputs])


def deviations(solution: Solution, y: Array, outputs: Sequence[str]) -> Array:
    """Return the standard deviations (p,) of the outputs' noise that fit the residuals.

    Raises ModelError where the fit of one output is exact and others are not: its weight would be infinite.
    """
    floor = MIN_RELATIVE_RESIDUAL * _size(y)
    estimates = variances.deviations(solution.e, solution.U, solution.Q)
    exact, used = estimates <= floor, solution.U.any(axis=(0, 2)) | solution.Q.any(axis=(0, 1, 3))
    if (exact & used).any() and not (exact | ~used).all():
        name = outputs[int(np.flatnonzero(exact & used)[0])]
        raise ModelError(
            f"the fit is exact for '{name}' but not for other outputs, which leaves its noise unknown: give the "
            "`noise` of each output"
        )
    return np.maximum(estimates, floor)


@arguments.checked
def no_convergence_text(passes: int) -> str:
    """Return the error text for output noise that did not converge."""
    return f"the estimated noise of the outputs does not converge in {passes} fits: give the `noise` of each output"


def r_squared(y: Array, e: Array, outputs: Sequence[str]) -> dict[str, float]:
    """Return R^2 of each output: the fraction of its variance that is explained; NaN without variance."""
    variance = ((y - y.mean(axis=0)) ** 2).mean(axis=0)
    fractions = 1 - (e**2).mean(axis=0) / np.where(variance > 0, variance, np.nan)
    return dict(zip(outputs, fractions.tolist(), strict=True))


def check_rows(
    Phi: bordered.Jacobian,
    y: Array,
    parameters: Sequence[str],
    outputs: Sequence[str],
    noise: Mapping[str, float] | None,
) -> None:
    """Raise SignalError for too few rows: more than parameters are needed, in each output of unknown noise."""
    short = Phi.parameters + 1 - y.size
    if short > 0:
        raise SignalError(
            f"{y.size} equations are too few for {Phi.parameters} parameters ({', '.join(parameters)}) and their "
            f"errors: log {short} or more in addition"
        )
    for name, acting in zip(outputs, Phi.parameters_per_output(), strict=True):
        if len(y) <= acting and noise is None and len(outputs) > 1:
            raise SignalError(
                f"{len(y)} rows of '{name}', on which {acting} parameters act, do not determine its noise: give the "
                f"`noise` of each output, or log {acting + 1 - len(y)} or more rows in addition"
            )


def _check_shapes(
    Phi: ArrayLike, y: ArrayLike, parameters: Sequence[str], outputs: Sequence[str]
) -> tuple[Array, Array]:
    Phi, y = arguments.real("regressors", Phi), arguments.real("outputs", y)
    if y.ndim == 1 and Phi.ndim == 2:
        Phi, y = Phi[:, None, :], y[:, None]
    shape = (len(y) if y.ndim else 0, len(outputs), len(parameters))
    if y.ndim != 2 or Phi.shape != shape or y.shape != shape[:2]:
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


def _largest_residual(solution: Solution, scale: Array, outputs: Sequence[str]) -> Residual:
    """Return the largest residual relative to its standard deviation, the noise times sqrt(1 - leverage)."""
    variance_share = 1 - (solution.U**2).sum(axis=2) - (solution.Q**2).sum(axis=3).reshape(solution.e.shape)
    deviation = scale * np.sqrt(np.where(variance_share > PASSED_THROUGH, variance_share, np.inf))
    size = np.abs(solution.e) / np.where(deviation > 0, deviation, np.inf)
    row, j = divmod(int(size.argmax()), len(outputs))
    return Residual(outputs[j], row, float(size[row, j]), size.size)


def _size(y: Array) -> Array:
    rms = np.sqrt((y**2).mean(axis=0))
    return np.where(rms > 0, rms, 1.0)
