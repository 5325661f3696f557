"""Fit of plant parameters to trajectories with a check of the integration error.

The fit is repeated with twice the Runge-Kutta steps, starting from the last result, until no parameter changes by more
than a tenth of its standard error, or 1e-7 of its value; the last fit is the result. Each doubling divides the
fourth-order integration error by about 16.

Library: no design uses it yet; docs/library.md has an example.
"""

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from synth import show
from synth.errors import ModelError
from synth.statespace import Array
from synth.synthesise.identify import gauss_newton
from synth.synthesise.identify.estimate import Estimate
from synth.synthesise.identify.trajectory import Problem

# Standard errors by which twice the steps may change a parameter: widens an interval of 95 % by 0.5 %.
MAX_PARAMETER_SHIFT = 0.1
RELATIVE_TOLERANCE = 1e-7  # of a parameter: alternative tolerance, as a log without noise has no standard errors
DOUBLINGS = 6  # of the Runge-Kutta steps, before a plant counts as too fast for its sample period


@show.result
class TrajectoryFit:
    """A fit (`gauss_newton.Fit`) with its number of Runge-Kutta steps per period.

    `shift` is the largest change of a parameter, in standard errors, at the last doubling of the steps. `estimate` has
    the parameters and, without spans, the initial states; those of spans are estimated but not reported.
    """

    estimate: Estimate
    steps: int
    optimality: float
    substeps: int
    shift: float

    def sheet(self) -> show.Sheet:
        """Return the sheet of the fit with its integration error."""
        sheet = gauss_newton.Fit(self.estimate, self.estimate.values, self.steps, self.optimality).sheet()
        line = (
            f"{self.substeps} Runge-Kutta steps a period; half as many change a parameter by at most "
            f"{self.shift:.1e} standard errors."
        )
        return replace(sheet, lines=(*sheet.lines, line))


def refine_steps(
    problem: Callable[[int], Problem],
    minimise: Callable[[Problem, Array], gauss_newton.Fit],
    start: Array,
    parameters: Sequence[str],
    substeps: int,
) -> TrajectoryFit:
    """Return the fit of ``problem(substeps)`` by ``minimise(problem, start)`` with enough Runge-Kutta steps.

    Raises ModelError where the integration error of one of the `parameters` does not become negligible.
    """
    fit, steps = minimise(problem(substeps), start), 0
    for _ in range(DOUBLINGS):
        before, steps, substeps = fit, steps + fit.steps, 2 * substeps
        fit = minimise(problem(substeps), before.theta)
        change = np.array([fit.estimate[name] - before.estimate[name] for name in parameters])
        shift = _in_standard_errors(fit, change, parameters)
        negligible = RELATIVE_TOLERANCE * np.abs([fit.estimate[name] for name in parameters])
        if ((shift <= MAX_PARAMETER_SHIFT) | (np.abs(change) <= negligible)).all():
            most = float(shift.max())
            return TrajectoryFit(fit.estimate, steps + fit.steps, fit.optimality, substeps, most)
    worst = int(shift.argmax())
    raise ModelError(
        f"with {substeps} Runge-Kutta steps a period instead of {substeps // 2} '{parameters[worst]}' still changes by "
        f"{shift[worst]:.2g} standard errors: the plant is too fast for the log's period; resample the log, or start "
        "with more substeps"
    )


def _in_standard_errors(fit: gauss_newton.Fit, change: Array, parameters: Sequence[str]) -> Array:
    """Return changes of parameters in standard errors; infinite where an exact parameter changes."""
    errors = dict(zip(fit.estimate.parameters, fit.estimate.errors, strict=True))
    error = np.array([errors[name] for name in parameters])
    return np.where(error > 0, np.abs(change) / np.where(error > 0, error, 1.0), np.where(change == 0, 0.0, np.inf))
