"""Nonlinear least squares with confidence: y = g(theta) + e.

    minimise  sum_j |y_j - g_j(theta)|^2 / w_j^2

by Gauss and Newton's steps, damped where they do not descend (Levenberg, Marquardt): with J = dg/dtheta and columns of
length 1, (J'J + m I) d = J' e. The minimum is found when next to nothing of e is left that J could explain.
Its confidence is that of the linear problem J theta + e there (`least_squares`); so is the noise of several outputs for
which none is given, with which the minimum is sought again until it settles.

Library: no design uses it yet; docs/library.md has an example.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike

from synth import arguments, show
from synth.errors import ModelError, SignalError
from synth.statespace import Array, readonly
from synth.synthesise.identify import bordered, least_squares, undetermined
from synth.synthesise.identify.estimate import Estimate

Model = Callable[[Array], tuple[Array, Array | bordered.Jacobian]]
"""theta (k,) to g (N, p) and dg/dtheta (N, p, k); in theta, parameters that groups of rows have follow those shared."""

STEPS = 100
UNEXPLAINED = 1e-6  # of the length of e: what is left for J to explain at the minimum, some 1e-6 standard errors
EXACT = 1e-3  # of the length of y: an e that is shorter is taken for this, so that an exact fit has a minimum
PASSES = 200  # minima that may be needed until the outputs' noise settles


@show.result
class Fit:
    """The estimate, the steps taken and what J leaves unexplained.

    `theta` is the minimum as the model takes it; `unexplained` the length of the part of e in the range of J over the
    length of e.
    """

    estimate: Estimate
    theta: Array
    steps: int
    unexplained: float

    def sheet(self) -> show.Sheet:
        """Return the estimate's sheet with the convergence."""
        sheet = self.estimate.sheet()
        line = f"Converged after {self.steps} steps; unexplained {self.unexplained:.1e}."
        return replace(sheet, lines=(*sheet.lines, line))


@dataclass(frozen=True, eq=False)
class _Point:
    theta: Array
    e: Array
    J: bordered.Jacobian
    weight: Array

    @property
    def cost(self) -> float:
        with np.errstate(over="ignore", invalid="ignore"):
            cost = float(np.linalg.norm(self.e / self.weight))
        finite = np.isfinite(self.J.shared).all() and np.isfinite(self.J.own).all()
        return cost if np.isfinite(cost) and finite else np.inf


@arguments.checked
def minimise(
    model: Model,
    y: Array,
    start: ArrayLike,
    parameters: Sequence[str],
    outputs: Sequence[str],
    noise: Mapping[str, float] | None = None,
    level: float = 0.95,
    units: Mapping[str, str] | None = None,
) -> Fit:
    """Return theta (k,) of y = g(theta) + e, y (N, p), from a start.

    `noise` gives the outputs' standard deviations, up to a common factor; where it is left out they are estimated.

    Raises as `least_squares.solve`; SignalError for a start of another length or that is not finite; ModelError when
    the model is not finite at the start or no minimum is found.
    """
    parameters, outputs = arguments.distinct("parameters", parameters), arguments.distinct("outputs", outputs)
    arguments.check_level(level)
    y = arguments.real("outputs", y)
    theta = arguments.real("start values", start)
    _check_shapes(model, y, theta, parameters, outputs)
    arguments.check_samples(y, outputs)
    weight, steps, estimated = least_squares.weights(noise, outputs, y), 0, noise is None and len(outputs) > 1
    for _ in range(PASSES):
        point, taken, left = _minimum(model, y, theta, weight, outputs)
        theta, steps = point.theta, steps + taken
        J, values = point.J, theta[: len(parameters)]
        least_squares.check_rows(J, y, parameters, outputs, noise)
        try:
            linear = least_squares.weighted(J, point.e + J.shared @ values, weight, parameters, values)
        except ModelError as error:
            raise ModelError(f"{error}; the residual is {_most(point.e / weight, outputs)}") from error
        before = weight
        weight = least_squares.deviations(linear, y, outputs) if estimated else weight
        if np.allclose(before, weight, rtol=least_squares.SETTLED, atol=0.0):
            break
    else:
        raise ModelError(least_squares.unsettled(PASSES))
    found = least_squares.estimate(linear, y, parameters, outputs, noise, level, units)
    return Fit(found, readonly(theta), steps, left)


def _check_shapes(model: Model, y: Array, theta: Array, parameters: Sequence[str], outputs: Sequence[str]) -> None:
    k, wanted = len(parameters), (len(y) if y.ndim else 0, len(outputs))
    if theta.ndim != 1 or len(theta) < k or not np.isfinite(theta[:k]).all():
        raise SignalError(
            f"the start has the shape {theta.shape} or is not finite: give {k} values, one for each parameter"
        )
    try:
        at = _at(model, np.zeros(()), theta, np.ones(()))
    except (TypeError, ValueError, IndexError) as error:
        raise ModelError(
            f"the model fails at the start, {theta.tolist()} ({error}): give one that takes {len(theta)} values and "
            "returns the outputs and their derivative"
        ) from error
    shapes = y.shape, at.e.shape, at.J.shared.shape
    if shapes != (wanted, wanted, (*wanted, k)) or at.J.parameters != len(theta):
        raise SignalError(
            f"the outputs have the shape {shapes[0]}, the model's {shapes[1]}, its derivative {shapes[2]}, the start "
            f"{theta.shape}: {len(outputs)} outputs and {k} parameters need {wanted} twice, {(*wanted, k)}, {(k,)}"
        )


def _minimum(model: Model, y: Array, theta: Array, weight: Array, outputs: Sequence[str]) -> tuple[_Point, int, float]:
    """Return the minimum for given weights, the steps, and what J could explain."""
    point, damping = _at(model, y, theta, weight), 1e-3
    if not point.cost < np.inf:
        raise ModelError("the model is not finite at the start: start nearer to the truth, or simulate shorter spans")
    size = float(np.linalg.norm(y / weight)) or 1.0
    for step in range(STEPS):
        J, e = point.J.weighted(weight), (point.e / weight).ravel()
        parts = bordered.factors(J)
        kept = parts.sigma > undetermined.RANK * max(1.0, parts.sigma.max(initial=0.0))
        shares = np.concatenate([(parts.U.T @ e)[kept], parts.along(e).ravel()])
        left = float(np.linalg.norm(shares)) / max(float(np.linalg.norm(e)), EXACT * size)
        if left <= UNEXPLAINED:
            return point, step, left
        while damping < 1e12:
            shared, own = parts.step(e, damping, kept)
            trial = _at(model, y, point.theta + np.concatenate([shared, own.ravel()]), weight)
            if trial.cost < point.cost:
                point, damping = trial, damping / 10
                break
            damping *= 10
        else:
            break
    raise ModelError(
        f"no minimum was found in {step + 1} steps: {left:.1e} of the residual is still to be explained, which is "
        f"{_most(point.e / weight, outputs)}; start nearer to the truth, leave outliers out, simulate "
        "shorter spans or estimate fewer parameters"
    )


def _at(model: Model, y: Array, theta: Array, weight: Array) -> _Point:
    with np.errstate(all="ignore"):
        g, J = model(theta)
    return _Point(theta, y - g, bordered.of(J), weight)


def _most(e: Array, outputs: Sequence[str]) -> str:
    """Return where weighted residuals (N, p) are largest, as text: an outlier bends a fit without sense."""
    row, j = divmod(int(np.abs(e).argmax()), len(outputs))
    return f"largest for '{outputs[j]}' in row {row}, {np.abs(e[row, j]) / np.sqrt((e**2).mean()):.3g} times the rms"
