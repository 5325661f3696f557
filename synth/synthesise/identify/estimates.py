"""Parameter combinations that data do not determine, as text: the null space of a regressor.

v is a direction in which theta can change without a change of Phi theta. Near nominal values the changes are stated
relative to them, v_i / theta_i: "a and b in proportion" where they are equal, "a and 1/b" where they are opposite.

Estimated parameters with confidence intervals and measures of the quality of the fit.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from scipy.special import ndtri, stdtrit

from synth import show
from synth.errors import SignalError
from synth.statespace import Array

RANK = 1e-10  # of the largest singular value, columns of length 1: below it a direction is not determined
ABSENT = 1e-6  # of the largest component of a direction: a smaller one is zero
EQUAL = 1e-3  # relative: tolerance of changes that are stated as proportional


def undetermined_combinations(
    sigma: Array, V: Array, size: Array, parameters: Sequence[str], near: Array | None = None
) -> list[str]:
    """Return the combinations of parameters that a regressor U diag(sigma) V' diag(size) does not determine.

    sigma and `size` are (k,), V is (k, k); `near` (k,) are nominal values.
    """
    null = V[:, sigma <= RANK * max(1.0, sigma.max(initial=0.0))].T
    texts = []
    for v in _row_echelon(null):
        involved = np.flatnonzero(v)
        names = [parameters[int(i)] for i in involved]
        if near is not None and near[involved].all():
            texts.append(_relative_text(v[involved] / size[involved] / near[involved], names))
        else:
            texts.append(_absolute_text(v[involved] / size[involved], names))
    return texts


def _row_echelon(basis: Array) -> Array:
    """Return vectors (r, k) that span the same space, each with few components: the row echelon form."""
    vectors = basis.copy()
    for row in range(len(vectors)):
        i, j = divmod(int(np.abs(vectors[row:]).argmax()), vectors.shape[1])
        vectors[[row, row + i]] = vectors[[row + i, row]]
        vectors[row] /= vectors[row, j]
        for other in range(len(vectors)):
            if other != row:
                vectors[other] -= vectors[other, j] * vectors[row]
    return np.where(np.abs(vectors) > ABSENT, vectors, 0.0)


def _relative_text(change: Array, names: Sequence[str]) -> str:
    change = change / change[np.abs(change).argmax()]
    if len(names) == 1:
        return names[0]
    if (np.abs(np.abs(change) - 1) < EQUAL).all():
        terms = [name if c * change[0] > 0 else f"1/{name}" for c, name in zip(change, names, strict=True)]
        return f"{', '.join(terms[:-1])} and {terms[-1]} in proportion"
    terms = [f"{name} by {100 * c:+.3g} %" for c, name in zip(change, names, strict=True)]
    return f"a change of {', '.join(terms[:-1])} and {terms[-1]}"


def _absolute_text(v: Array, names: Sequence[str]) -> str:
    if len(names) == 1:
        return names[0]
    terms = zip(v / np.linalg.norm(v) * np.sign(v[0]), names, strict=True)
    return " ".join(f"{'-' if c < 0 else '+'} {abs(c):.2g} {name}" for c, name in terms).removeprefix("+ ")


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
            show.Table("", columns, rows),
            show.Table("", ("output", "residual rms", "R^2"), fits),
            show.matrix("correlation", np.round(self.correlation, 4), self.parameters, self.parameters),
        )
        line = f"{self.residual_freedom} degrees of freedom, condition number {self.condition:.3g}."
        if (self.degrees_of_freedom < (1 - 1e-6) * self.residual_freedom).any():
            least = int(self.degrees_of_freedom.argmin())
            freedom = f"{self.degrees_of_freedom[least]:.3g}"
            line += f" '{self.parameters[least]}' has {freedom}, as the outputs' noise is estimated."
        return show.Sheet("Estimated parameters", (line, str(self.largest)), tables)
