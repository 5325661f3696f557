"""Estimated parameters with confidence intervals and measures of the quality of the fit."""

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from scipy.special import ndtri, stdtrit

from synth import show
from synth.errors import SignalError
from synth.statespace import Array


@dataclass(frozen=True)
class Residual:
    """The largest of `count` residuals: its output, its row, and its size in standard deviations of that residual."""

    output: str
    row: int
    deviations: float
    count: int

    @property
    def median_of_largest(self) -> float:
        """The median of the largest of `count` normal residuals."""
        return -float(ndtri((1 - 0.5 ** (1 / self.count)) / 2))

    def __str__(self) -> str:
        return (
            f"The largest residual is that of '{self.output}' in row {self.row}: {self.deviations:.3g} standard "
            f"deviations; normal noise reaches some {self.median_of_largest:.2g} in {self.count} residuals."
        )


@show.result
class Estimate:
    """Parameters (k,) with their covariance (k, k) and measures of the quality of the fit.

    `rms` is the residual of each output, `r_squared` relates it to the output's variance (NaN where that is zero).
    `residual_freedom` is N p - k; `degrees_of_freedom` (k,) are those of each interval, fewer where the noise of
    several outputs is estimated. `condition` is that of the regressor matrix with columns of length 1,
    `level` the probability of the intervals.
    """

    parameters: tuple[str, ...]
    values: Array
    covariance: Array
    rms: Mapping[str, float]
    r_squared: Mapping[str, float]
    residual_freedom: int
    degrees_of_freedom: Array
    condition: float
    level: float
    largest: Residual
    units: Mapping[str, str] = field(default_factory=dict)

    def __getitem__(self, name: str) -> float:
        """Return the estimate of a parameter."""
        if name not in self.parameters:
            raise SignalError(f"'{name}' was not estimated: {', '.join(self.parameters)} were")
        return float(self.values[self.parameters.index(name)])

    @property
    def by_name(self) -> dict[str, float]:
        """The estimates by name."""
        return dict(zip(self.parameters, self.values.tolist(), strict=True))

    @property
    def errors(self) -> Array:
        """The standard errors (k,)."""
        return np.sqrt(np.diag(self.covariance))

    @property
    def intervals(self) -> Array:
        """The lower and upper end (k, 2) of each confidence interval."""
        half_width = stdtrit(self.degrees_of_freedom, (1 + self.level) / 2) * self.errors
        return np.column_stack([self.values - half_width, self.values + half_width])

    @property
    def correlation(self) -> Array:
        """The correlation (k, k) of the estimates; zero for an exact estimate."""
        size = np.where(self.errors > 0, self.errors, 1.0)
        return self.covariance / size / size[:, None]

    def sheet(self) -> show.Sheet:
        """Return estimates with errors and intervals, their correlation, and the residual of each output."""
        labels = [show.with_unit(name, self.units.get(name, "")) for name in self.parameters]
        columns = ("parameter", "estimate", "standard error", f"{100 * self.level:.4g} % from", "to")
        rows = tuple(
            (label, *(show.number(v, 6) for v in (value, error, low, high)))
            for label, value, error, (low, high) in zip(
                labels, self.values, self.errors, self.intervals.tolist(), strict=True
            )
        )
        fits = tuple(
            (show.with_unit(n, self.units.get(n, "")), f"{v:.4g}", f"{self.r_squared[n]:.6g}")
            for n, v in self.rms.items()
        )
        tables = (
            show.Table(columns, rows),
            show.Table(("output", "residual rms", "R^2"), fits),
            show.matrix("correlation", np.round(self.correlation, 4), self.parameters, self.parameters),
        )
        line = f"{self.residual_freedom} degrees of freedom, condition number {self.condition:.3g}."
        if (self.degrees_of_freedom < (1 - 1e-6) * self.residual_freedom).any():
            least = int(self.degrees_of_freedom.argmin())
            freedom = f"{self.degrees_of_freedom[least]:.3g}"
            line += f" '{self.parameters[least]}' has {freedom}, as the outputs' noise is estimated."
        return show.Sheet("Estimated parameters", (line, str(self.largest)), tables)
