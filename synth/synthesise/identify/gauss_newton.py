"""Nonlinear least squares with confidence, y = g(theta) + e; MATLAB `nlinfit`, SciPy `curve_fit`.

    minimise  sum_j |y_j - g_j(theta)|^2 / w_j^2

with the standard deviation w_j of output j, up to a common factor. The steps are d in (J'J + mu I) d = J' e, for
J = dg/dtheta and e = y - g, both divided by w, and columns of J scaled to length 1. The Levenberg-Marquardt damping mu
grows until a step descends. The iteration ends when the projection of e onto the range of J is below OPTIMALITY |e|.
The confidence intervals are those of the problem linearised at the minimum (`least_squares`). If the noise of several
outputs is unknown, it is estimated from the residuals, and the minimisation is repeated until the noise converges.

Library: no design uses it yet; docs/library.md has an example.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike

from synth import arguments, show
from synth.errors import ModelError, SignalError
from synth.statespace import Array, readonly
from synth.synthesise.identify import estimates, least_squares
from synth.synthesise.identify.estimates import Estimate

Model = Callable[[Array], tuple[Array, Array | least_squares.Jacobian]]
"""Maps theta (k,) to g (N, p) and dg/dtheta (N, p, k). In theta, shared parameters precede those of groups of rows."""

STEPS = 100  # most steps of a minimisation
OPTIMALITY = 1e-6  # at the minimum: |projection of e onto the range of J| / |e|, about 1e-6 standard errors
MIN_RELATIVE_RESIDUAL = 1e-3  # |e| counts as at least this fraction of |y|: an exact fit, e = 0, also meets OPTIMALITY
PASSES = 200  # most minimisations, with the noise estimated after each


@show.result
class Fit:
    """The estimate, the number of steps and the optimality of the minimum.

    `theta` is the argument of the model at the minimum. `optimality` is the first-order optimality, |projection of e
    onto the range of J| / |e|, which is 0 at an exact minimum.
    """

    estimate: Estimate
    theta: Array
    steps: int
    optimality: float

    def sheet(self) -> show.Sheet:
        """Return the estimate's sheet with the convergence."""
        sheet = self.estimate.sheet()
        line = f"Converged after {self.steps} steps; first-order optimality {self.optimality:.1e}."
        return replace(sheet, lines=(*sheet.lines, line))


@dataclass(frozen=True, eq=False)
class _Point:
    """The model at theta: residual e = y - g, Jacobian J, and the outputs' standard deviations, which divide both."""

    theta: Array
    e: Array
    J: least_squares.Jacobian
    deviation: Array

    @property
    def cost(self) -> float:
        with np.errstate(over="ignore", invalid="ignore"):
            cost = float(np.linalg.norm(self.e / self.deviation))
        finite = np.isfinite(self.J.shared).all() and np.isfinite(self.J.group).all()
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
    """Return the fit of y = g(theta) + e, with theta (k,) and y (N, p), found from a start.

    `noise` gives the outputs' standard deviations up to a common factor; without it they are estimated.
    `level` is that of the confidence intervals.

    Raises as `least_squares.solve`; SignalError for a start of another length or that is not finite; ModelError when
    the model is not finite at the start or no minimum is found.
    """
    parameters, outputs = arguments.distinct("parameters", parameters), arguments.distinct("outputs", outputs)
    arguments.check_level(level)
    y = arguments.real("outputs", y)
    theta = arguments.real("start values", start)
    _check_shapes(model, y, theta, parameters, outputs)
    arguments.check_samples(y, outputs)
    deviation, steps = least_squares.initial_deviations(noise, outputs, y), 0
    estimated = noise is None and len(outputs) > 1
    for _ in range(PASSES):
        point, new_steps, optimality = _minimum(model, y, theta, deviation, outputs)
        theta, steps = point.theta, steps + new_steps
        J, values = point.J, theta[: len(parameters)]
        least_squares.check_rows(J, y, parameters, outputs, noise)
        try:
            linear = least_squares.solve_with_deviations(J, point.e + J.shared @ values, deviation, parameters, values)
        except ModelError as error:
            raise ModelError(f"{error}; the residual is {_largest_residual(point.e / deviation, outputs)}") from error
        previous_deviation = deviation
        deviation = least_squares.deviations(linear, y, outputs) if estimated else deviation
        if np.allclose(previous_deviation, deviation, rtol=least_squares.CONVERGENCE_TOLERANCE, atol=0.0):
            break
    else:
        raise ModelError(least_squares.no_convergence_text(PASSES))
    estimate = least_squares.estimate(linear, y, parameters, outputs, noise, level, units)
    return Fit(estimate, readonly(theta), steps, optimality)


def _check_shapes(model: Model, y: Array, theta: Array, parameters: Sequence[str], outputs: Sequence[str]) -> None:
    k, output_shape = len(parameters), (len(y) if y.ndim else 0, len(outputs))
    if theta.ndim != 1 or len(theta) < k or not np.isfinite(theta[:k]).all():
        raise SignalError(
            f"the start has the shape {theta.shape} or is not finite: give {k} values, one for each parameter"
        )
    try:
        point = _evaluate(model, np.zeros(()), theta, np.ones(()))
    except (TypeError, ValueError, IndexError) as error:
        raise ModelError(
            f"the model fails at the start, {theta.tolist()} ({error}): give one that takes {len(theta)} values and "
            "returns the outputs and their derivative"
        ) from error
    shapes = y.shape, point.e.shape, point.J.shared.shape
    if shapes != (output_shape, output_shape, (*output_shape, k)) or point.J.parameters != len(theta):
        raise SignalError(
            f"the outputs have the shape {shapes[0]}, the model's {shapes[1]}, its derivative {shapes[2]}, the start "
            f"{theta.shape}: for {len(outputs)} outputs and {k} parameters give outputs and a model of {output_shape}, "
            f"a derivative of {(*output_shape, k)} and a start of {(k,)}"
        )


def _minimum(
    model: Model, y: Array, theta: Array, deviation: Array, outputs: Sequence[str]
) -> tuple[_Point, int, float]:
    """Return the minimum for fixed standard deviations, the number of steps and the first-order optimality."""
    point, damping = _evaluate(model, y, theta, deviation), 1e-3
    if not point.cost < np.inf:
        raise ModelError("the model is not finite at the start: start nearer to the truth, or simulate shorter spans")
    y_norm = float(np.linalg.norm(y / deviation)) or 1.0
    for step in range(STEPS):
        J, e = point.J.weighted(deviation), (point.e / deviation).ravel()
        factors = least_squares.factorise(J)
        determined = factors.sigma > estimates.RANK * max(1.0, factors.sigma.max(initial=0.0))
        projection = np.concatenate([(factors.U.T @ e)[determined], factors.group_components(e).ravel()])
        optimality = float(np.linalg.norm(projection)) / max(float(np.linalg.norm(e)), MIN_RELATIVE_RESIDUAL * y_norm)
        if optimality <= OPTIMALITY:
            return point, step, optimality
        while damping < 1e12:
            shared_step, group_step = factors.step(e, damping, determined)
            trial = _evaluate(model, y, point.theta + np.concatenate([shared_step, group_step.ravel()]), deviation)
            if trial.cost < point.cost:
                point, damping = trial, damping / 10
                break
            damping *= 10
        else:
            break
    raise ModelError(
        f"no minimum was found in {step + 1} steps: a fraction {optimality:.1e} of the residual is still in the range "
        f"of the Jacobian; the residual is {_largest_residual(point.e / deviation, outputs)}: start nearer "
        "to the truth, leave outliers out, simulate shorter spans or estimate fewer parameters"
    )


def _evaluate(model: Model, y: Array, theta: Array, deviation: Array) -> _Point:
    with np.errstate(all="ignore"):
        g, J = model(theta)
    return _Point(theta, y - g, least_squares.of(J), deviation)


def _largest_residual(e: Array, outputs: Sequence[str]) -> str:
    """Describe the largest weighted residual (N, p), which may be an outlier."""
    if not e.any():
        return "0 in all rows"
    row, j = divmod(int(np.abs(e).argmax()), len(outputs))
    return f"largest for '{outputs[j]}' in row {row}, {np.abs(e[row, j]) / np.sqrt((e**2).mean()):.3g} times the rms"
