"""Parameters of a plant from trajectories: a fit whose integration error is known and does not matter.

The fit is repeated with twice the Runge-Kutta steps, from where it ended, until that moves no parameter by more than a
tenth of its standard error, or a ten-millionth of itself; the last fit counts. Each doubling divides an error of fourth
order by some 16.

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

SHIFT = 0.1  # standard errors by which twice the steps may move a parameter: widens an interval of 95 % by 0.5 %
NEGLIGIBLE = 1e-7  # of a parameter: what that may be, too, since a log without noise has no standard errors
DOUBLINGS = 6  # of the Runge-Kutta steps, before a plant counts as too fast for its sample period


@show.result
class TrajectoryFit:
    """A fit (`gauss_newton.Fit`) with the Runge-Kutta steps a period that it took.

    `shift` is by how many standard errors the last doubling of the steps moved the parameter that moved most.
    `estimate` holds the parameters and, without spans, the start states; those of spans are estimated and not shown.
    """

    estimate: Estimate
    steps: int
    unexplained: float
    substeps: int
    shift: float

    def sheet(self) -> show.Sheet:
        """Return the sheet of the fit with its integration error."""
        sheet = gauss_newton.Fit(self.estimate, self.estimate.values, self.steps, self.unexplained).sheet()
        line = (
            f"{self.substeps} Runge-Kutta steps a period; half as many move a parameter by at most {self.shift:.1e} "
            "standard errors."
        )
        return replace(sheet, lines=(*sheet.lines, line))


def certified(
    problem: Callable[[int], Problem],
    minimise: Callable[[Problem, Array], gauss_newton.Fit],
    start: Array,
    parameters: Sequence[str],
    substeps: int,
) -> TrajectoryFit:
    """Return the fit of ``problem(steps a period)`` by ``minimise(problem, start)``, its integration error checked.

    Raises ModelError where the integration error of one of the `parameters` does not vanish.
    """
    fit, steps = minimise(problem(substeps), start), 0
    for _ in range(DOUBLINGS):
        before, steps, substeps = fit, steps + fit.steps, 2 * substeps
        fit = minimise(problem(substeps), before.theta)
        change = np.array([fit.estimate[name] - before.estimate[name] for name in parameters])
        shift = _in_errors(fit, change, parameters)
        negligible = NEGLIGIBLE * np.abs([fit.estimate[name] for name in parameters])
        if ((shift <= SHIFT) | (np.abs(change) <= negligible)).all():
            most = float(shift.max())
            return TrajectoryFit(fit.estimate, steps + fit.steps, fit.unexplained, substeps, most)
    worst = int(shift.argmax())
    raise ModelError(
        f"with {substeps} Runge-Kutta steps a period instead of {substeps // 2} '{parameters[worst]}' still moves by "
        f"{shift[worst]:.2g} standard errors: the plant is too fast for the log's period; resample the log, or start "
        "with more substeps"
    )


def _in_errors(fit: gauss_newton.Fit, change: Array, parameters: Sequence[str]) -> Array:
    """Return changes of parameters in standard errors; infinite where an exact one moved."""
    errors = dict(zip(fit.estimate.names, fit.estimate.errors, strict=True))
    error = np.array([errors[name] for name in parameters])
    return np.where(error > 0, np.abs(change) / np.where(error > 0, error, 1.0), np.where(change == 0, 0.0, np.inf))
