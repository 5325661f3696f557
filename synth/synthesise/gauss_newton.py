"""Nonlinear least squares with confidence: y = g(theta) + e.

    minimise  sum_j |y_j - g_j(theta)|^2 / w_j^2      low <= theta <= high

by Gauss and Newton's steps, damped where they do not descend (Levenberg, Marquardt): with J = dg/dtheta and columns of
length 1, (J'J + m I) d = J' e. The minimum is found when next to nothing of e is left that J could explain.
Its confidence is that of the linear problem J theta + e there (`least_squares`). A parameter that ends on a bound is
held there and has none.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from synth import show
from synth.errors import ModelError
from synth.statespace import Array
from synth.synthesise import least_squares

Model = Callable[[Array], tuple[Array, Array]]
"""theta (k,) to g (N, p) and dg/dtheta (N, p, k)."""

STEPS = 100
UNEXPLAINED = 1e-6  # of the length of e: what is left for J to explain at the minimum, some 1e-6 standard errors
EXACT = 1e-3  # of the length of y: an e that is shorter is taken for this, so that an exact fit has a minimum
PASSES = 20  # minima that may be needed until the outputs' weights settle


@show.printed
@dataclass(frozen=True, eq=False, repr=False)
class Fit:
    """The estimate of what is free, the parameters `held` at a bound, the steps taken and what J leaves unexplained.

    `unexplained` is the length of the part of e in the range of J over the length of e.
    """

    estimate: least_squares.Estimate
    held: Mapping[str, float]
    steps: int
    unexplained: float

    @property
    def by_name(self) -> dict[str, float]:
        """All parameters' values by name."""
        return {**self.estimate.by_name, **self.held}

    def sheet(self) -> show.Sheet:
        """Return the estimate's sheet with the convergence."""
        sheet = self.estimate.sheet()
        lines = [f"Converged after {self.steps} steps; unexplained {self.unexplained:.1e}."]
        lines += [f"'{name}' is held at its bound {value:.6g}." for name, value in self.held.items()]
        return replace(sheet, lines=(*sheet.lines, *lines))


@dataclass(frozen=True, eq=False)
class _Point:
    theta: Array
    e: Array
    J: Array
    weight: Array

    @property
    def cost(self) -> float:
        with np.errstate(over="ignore", invalid="ignore"):
            cost = float(np.linalg.norm(self.e / self.weight))
        return cost if np.isfinite(cost) and np.isfinite(self.J).all() else np.inf

    def stacked(self) -> tuple[Array, Array]:
        """Return J (N p, k) and e (N p,), weighted."""
        return (self.J / self.weight[:, None]).reshape(self.e.size, -1), (self.e / self.weight).ravel()


def minimise(
    model: Model,
    y: Array,
    start: ArrayLike,
    parameters: Sequence[str],
    outputs: Sequence[str],
    bounds: tuple[ArrayLike, ArrayLike] = (-np.inf, np.inf),
    noise: Mapping[str, float] | None = None,
    level: float = 0.95,
    units: Mapping[str, str] | None = None,
) -> Fit:
    """Return theta (k,) of y = g(theta) + e, y (N, p), from a start inside the bounds.

    `noise` gives the outputs' standard deviations; where it is left out the residuals' rms are used.

    Raises as `least_squares.solve`; ModelError when the model is not finite at the start or no minimum is found.
    """
    k = len(parameters)
    low, high = (np.broadcast_to(np.asarray(b, dtype=np.float64), (k,)) for b in bounds)
    theta, weight, steps = np.asarray(start, dtype=np.float64), least_squares.weights(noise, outputs, y), 0
    for _ in range(PASSES):
        point, free, taken, left = _minimum(model, y, theta, weight, low, high)
        theta, steps = point.theta, steps + taken
        if noise is not None or len(outputs) == 1:
            break
        before, weight = weight, least_squares.residual_weights(point.e, y)
        if np.allclose(before, weight, rtol=least_squares.SETTLED, atol=0.0):
            break
    if not free.any():
        raise ModelError(
            f"all of {', '.join(parameters)} end on a bound: widen their tolerances or check the log's units"
        )
    names = [name for name, open_ in zip(parameters, free, strict=True) if open_]
    J = point.J[:, :, free]
    known = dict(zip(outputs, point.weight.tolist(), strict=True))
    linear = least_squares.solve(J, point.e + J @ theta[free], names, outputs, known, level, units)
    good = least_squares.explained(y, point.e, outputs)
    held = {name: float(v) for name, v, open_ in zip(parameters, theta, free, strict=True) if not open_}
    return Fit(replace(linear, r_squared=good), held, steps, left)


def _minimum(
    model: Model, y: Array, theta: Array, weight: Array, low: Array, high: Array
) -> tuple[_Point, NDArray[np.bool_], int, float]:
    """Return the minimum for given weights, which parameters are free there, the steps, and what J could explain."""
    point, damping = _at(model, y, theta, weight), 1e-3
    if not point.cost < np.inf:
        raise ModelError("the model is not finite at the start: start nearer to the truth, or simulate shorter spans")
    size = float(np.linalg.norm(y / weight)) or 1.0
    for step in range(STEPS):
        J, e = point.stacked()
        uphill = J.T @ e  # minus the gradient
        free = ~(((point.theta <= low) & (uphill < 0)) | ((point.theta >= high) & (uphill > 0)))
        scale = np.linalg.norm(J, axis=0)
        scale = np.where(scale > 0, scale, 1.0)
        U, sigma, V = np.linalg.svd((J / scale)[:, free], full_matrices=False)
        kept = sigma > least_squares.RANK * sigma.max(initial=0.0)
        shares = U[:, kept].T @ e
        left = float(np.linalg.norm(shares)) / max(float(np.linalg.norm(e)), EXACT * size)
        if left <= UNEXPLAINED:
            return point, free, step, left
        while damping < 1e12:
            move = np.zeros(len(theta))
            move[free] = V[kept].T @ (sigma[kept] / (sigma[kept] ** 2 + damping) * shares)
            trial = _at(model, y, np.clip(point.theta + move / scale, low, high), weight)
            if trial.cost < point.cost:
                point, damping = trial, damping / 10
                break
            damping *= 10
        else:
            break
    raise ModelError(
        f"no minimum was found in {step + 1} steps: {left:.1e} of the residual is still to be explained; start "
        "nearer to the truth, simulate shorter spans or estimate fewer parameters"
    )


def _at(model: Model, y: Array, theta: Array, weight: Array) -> _Point:
    with np.errstate(over="ignore", invalid="ignore"):
        g, J = model(theta)
    return _Point(theta, y - g, J, weight)
