"""Linear least squares with confidence: y = Phi theta + e.

N rows of p outputs, k parameters: y (N, p), Phi (N, p, k), e independent, of standard deviation s w_j in output j. With
rows divided by w_j and stacked, columns divided by their norms c,

    theta = C^-1 V S^-1 U' y,     U S V' = Phi C^-1,     s^2 = |y - Phi theta|^2 / (N p - k),
    cov theta = s^2 C^-1 V S^-2 V' C^-1,       theta_i +- t(N p - k) sqrt(cov_ii),

t the quantile of Student's distribution. Where the w_j are not given they are the outputs' residual rms, found by
repeated fits. Right vectors of singular values that are zero are combinations of parameters that no row determines.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
import scipy.stats
from numpy.typing import ArrayLike

from synth import show
from synth.errors import ModelError, SignalError
from synth.statespace import Array, readonly

RANK = 1e-10  # of the largest singular value, columns of length 1: what is below counts as not determined
PASSES = 50  # fits that may be needed until the outputs' weights settle
SETTLED = 1e-6  # relative change of a weight that counts as none
EXACT = 1e-12  # of the rms of an output: a residual below is taken for this, so that an exact fit has a weight


@show.printed
@dataclass(frozen=True, eq=False, repr=False)
class Estimate:
    """Parameters (k,) with their covariance (k, k), and what tells how good they are.

    `rms` and `r_squared` are those of the residual by output, the latter against the outputs' variance, NaN where that
    is zero; `freedom` is N p - k; `condition` that of Phi with columns of length 1; `level` the intervals' probability.
    """

    names: tuple[str, ...]
    values: Array
    covariance: Array
    rms: Mapping[str, float]
    r_squared: Mapping[str, float]
    freedom: int
    condition: float
    level: float
    units: Mapping[str, str] = field(default_factory=dict)

    def __getitem__(self, name: str) -> float:
        """Return the estimate of a parameter."""
        if name not in self.names:
            raise SignalError(f"'{name}' was not estimated: {', '.join(self.names)} were")
        return float(self.values[self.names.index(name)])

    @property
    def by_name(self) -> dict[str, float]:
        """The estimates by name."""
        return dict(zip(self.names, self.values.tolist(), strict=True))

    @property
    def errors(self) -> Array:
        """The standard errors (k,)."""
        return np.sqrt(np.diag(self.covariance))

    @property
    def intervals(self) -> Array:
        """The lower and upper end (k, 2) of each confidence interval."""
        reach = float(scipy.stats.t.ppf((1 + self.level) / 2, self.freedom)) * self.errors
        return np.column_stack([self.values - reach, self.values + reach])

    @property
    def correlation(self) -> Array:
        """The correlation (k, k) of the estimates; zero beside an exact one."""
        size = np.where(self.errors > 0, self.errors, 1.0)
        return self.covariance / size / size[:, None]

    def sheet(self) -> show.Sheet:
        """Return estimates with errors and intervals, their correlation, and the residual of each output."""
        labels = [show.named(name, self.units.get(name, "")) for name in self.names]
        columns = ("parameter", "estimate", "standard error", f"{100 * self.level:.4g} % from", "to")
        rows = tuple(
            (label, *(show.number(v, 6) for v in (value, error, low, high)))
            for label, value, error, (low, high) in zip(
                labels, self.values, self.errors, self.intervals.tolist(), strict=True
            )
        )
        fits = tuple(
            (show.named(n, self.units.get(n, "")), f"{v:.4g}", f"{self.r_squared[n]:.6g}") for n, v in self.rms.items()
        )
        tables = (
            show.Table(columns, rows),
            show.Table(("output", "residual rms", "R^2"), fits),
            show.matrix("correlation", np.round(self.correlation, 4), self.names, self.names),
        )
        line = f"{self.freedom} degrees of freedom, condition number {self.condition:.3g}."
        return show.Sheet("Estimated parameters", (line,), tables)


def solve(
    Phi: ArrayLike,
    y: ArrayLike,
    parameters: Sequence[str],
    outputs: Sequence[str] = ("y",),
    noise: Mapping[str, float] | None = None,
    level: float = 0.95,
    units: Mapping[str, str] | None = None,
) -> Estimate:
    """Return theta of y = Phi theta + e; Phi (N, p, k), y (N, p), or (N, k) and (N,) for one output.

    `noise` gives the outputs' standard deviations, up to a common factor. `units` is carried along.

    Raises SignalError for shapes that do not fit, a value that is not finite, naming row and signal, a level or noise
    out of range, or fewer rows than it takes; ModelError naming combinations of parameters that are not determined.
    """
    Phi, y = _shaped(Phi, y, parameters, outputs)
    rows, k = y.size, len(parameters)
    if not 0 < level < 1:
        raise SignalError(f"the confidence level is {level}: give a probability between 0 and 1, like 0.95")
    if rows <= k:
        raise SignalError(
            f"{rows} equations are too few for {k} parameters ({', '.join(parameters)}) and their errors: "
            f"log {k + 1 - rows} or more in addition"
        )
    weight = weights(noise, outputs, y)
    for _ in range(PASSES):
        theta, covariance, condition = _weighted(Phi, y, weight, parameters)
        e = y - Phi @ theta
        before, weight = weight, residual_weights(e, y) if noise is None else weight
        if len(outputs) == 1 or np.allclose(before, weight, rtol=SETTLED, atol=0.0):
            break
    return Estimate(
        tuple(parameters),
        readonly(theta),
        readonly(covariance),
        dict(zip(outputs, np.sqrt((e**2).mean(axis=0)).tolist(), strict=True)),
        explained(y, e, outputs),
        rows - k,
        condition,
        level,
        units or {},
    )


def undetermined(Phi: Array, parameters: Sequence[str]) -> list[str]:
    """Return the combinations of parameters, as text, that no row of Phi (N, k) determines."""
    size = np.linalg.norm(Phi, axis=0)
    _, sigma, V = np.linalg.svd(Phi / np.where(size > 0, size, 1.0))
    kept = int((sigma > RANK * sigma.max(initial=0.0)).sum())
    null = _sparse(V[kept:]) / np.where(size > 0, size, 1.0)
    return [_combination(v / np.linalg.norm(v), parameters) for v in null]


def _weighted(Phi: Array, y: Array, weight: Array, parameters: Sequence[str]) -> tuple[Array, Array, float]:
    """Return theta, its covariance and the condition of Phi, with output j divided by `weight[j]`."""
    M, b = (Phi / weight[:, None]).reshape(y.size, -1), (y / weight).ravel()
    size = np.linalg.norm(M, axis=0)
    U, sigma, V = np.linalg.svd(M / np.where(size > 0, size, 1.0), full_matrices=False)
    if not sigma[-1] > RANK * sigma[0]:
        found = undetermined(M, parameters)
        raise ModelError(
            f"the data leave {' and '.join(found)} undetermined: log samples in which the parameters act apart, "
            "or hold one of them at a known value"
        )
    theta = V.T @ (U.T @ b / sigma) / size
    root = V.T / sigma / size[:, None]
    e = b - M @ theta
    return theta, float(e @ e) / (len(b) - len(theta)) * (root @ root.T), float(sigma[0] / sigma[-1])


def _shaped(Phi: ArrayLike, y: ArrayLike, parameters: Sequence[str], outputs: Sequence[str]) -> tuple[Array, Array]:
    try:
        Phi, y = np.asarray(Phi, dtype=np.float64), np.asarray(y, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise SignalError(f"the regressors or outputs are no arrays of real numbers ({error})") from error
    if y.ndim == 1 and Phi.ndim == 2:
        Phi, y = Phi[:, None, :], y[:, None]
    wanted = (len(y), len(outputs), len(parameters))
    if y.ndim != 2 or Phi.shape != wanted or y.shape != wanted[:2] or not parameters:
        raise SignalError(
            f"the regressors have shape {Phi.shape} and the outputs {y.shape}: {len(outputs)} outputs and "
            f"{len(parameters)} parameters need (N, {len(outputs)}, {len(parameters)}) and (N, {len(outputs)})"
        )
    for row, j in np.argwhere(~np.isfinite(y)):
        raise SignalError(f"row {row} of '{outputs[j]}' is {y[row, j]}: leave the row out")
    for row, j, i in np.argwhere(~np.isfinite(Phi)):
        raise SignalError(
            f"row {row} of the regressor of '{parameters[i]}' in '{outputs[j]}' is {Phi[row, j, i]}: leave the row out"
        )
    return Phi, y


def weights(noise: Mapping[str, float] | None, outputs: Sequence[str], y: Array) -> Array:
    """Return the noise (p,) of the outputs, their rms where none is given.

    Raises SignalError for a noise that is missing or not positive.
    """
    if noise is None:
        return _size(y)
    for name in outputs:
        if not 0 < noise.get(name, np.nan) < np.inf:
            raise SignalError(f"the noise of '{name}' is {noise.get(name)}: give a positive standard deviation")
    return np.array([float(noise[name]) for name in outputs])


def residual_weights(e: Array, y: Array) -> Array:
    """Return the rms (p,) of residuals (N, p), or what rounding leaves of y (N, p)."""
    return np.maximum(np.sqrt((e**2).mean(axis=0)), EXACT * _size(y))


def explained(y: Array, e: Array, outputs: Sequence[str]) -> dict[str, float]:
    """Return R^2 of each output: the part of its variance that the residuals (N, p) do not have; NaN without any."""
    variance = ((y - y.mean(axis=0)) ** 2).mean(axis=0)
    part = 1 - (e**2).mean(axis=0) / np.where(variance > 0, variance, np.nan)
    return dict(zip(outputs, part.tolist(), strict=True))


def _size(y: Array) -> Array:
    rms = np.sqrt((y**2).mean(axis=0))
    return np.where(rms > 0, rms, 1.0)


def _sparse(basis: Array) -> Array:
    """Return vectors (r, k) that span the same space, each with few components: the row echelon form."""
    found = basis.copy()
    for row in range(len(found)):
        i, j = divmod(int(np.abs(found[row:]).argmax()), found.shape[1])
        found[[row, row + i]] = found[[row + i, row]]
        found[row] /= found[row, j]
        for other in range(len(found)):
            if other != row:
                found[other] -= found[other, j] * found[row]
    return np.where(np.abs(found) > 1e-6, found, 0.0)


def _combination(v: Array, parameters: Sequence[str]) -> str:
    terms = [(c, name) for c, name in zip(v, parameters, strict=True) if c]
    if len(terms) == 1:
        return terms[0][1]
    sign = np.sign(terms[0][0])
    text = " ".join(f"{'-' if c * sign < 0 else '+'} {abs(c):.2g} {name}" for c, name in terms)
    return text.removeprefix("+ ")
