"""Result of an experiment: a simulated run, the signals to plot, measured values and checks."""

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from synth.check import Check
from synth.simulate.scenario import Trajectory


@dataclass(frozen=True, eq=False)
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
