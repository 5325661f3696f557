"""Result of an experiment: a simulated run, the signals to plot, measured values and checks."""

from collections.abc import Mapping
from dataclasses import field

import numpy as np
from numpy.typing import NDArray

from synth import check, show
from synth.check import Check
from synth.simulate.scenario import Trajectory


@show.result
class Experiment:
    """One run. `shown` names the columns of the trajectory to plot, `references` their set-points (N,).

    `figures` are measured values without limits, in the unit at the end of each name; `checks` have limits.
    """

    name: str
    title: str
    about: str
    trajectory: Trajectory
    shown: tuple[str, ...]
    references: Mapping[str, NDArray[np.float64]] = field(default_factory=dict)
    figures: Mapping[str, float] = field(default_factory=dict)
    checks: tuple[Check, ...] = ()

    def sheet(self) -> show.Sheet:
        """Return the measured values and the checks."""
        figures = show.Table(("measured", "value"), tuple((name, show.number(v)) for name, v in self.figures.items()))
        run = self.trajectory.sheet()
        tables = tuple(t for t in (figures, check.table(self.checks)) if t.rows)
        return show.Sheet(f"Experiment {self.name}: {self.title}", (run.title,), tables)
