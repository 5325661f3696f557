"""What the simulated lead-lag loop records, for the audit's formulas: its noise at rest and the steps of Fig. 8."""

import numpy as np
from numpy.typing import NDArray

from designs.planar_6dof import experiments
from designs.planar_6dof.paper import axes
from designs.planar_6dof.paper.axes import Step
from synth.simulate.rig import Rig

Array = NDArray[np.float64]

FIGURE_8 = {"x": 20e-6, "y": 100e-6, "phi": 0.01 * np.pi / 180}  # m, rad


def noise_at_rest(loop: Rig, duration_s: float) -> dict[str, float]:
    """Return the rms of x and y in m as filtered, which is what the lead-lag controller acts on."""
    return {axis: float(np.std(y)) for axis, y in experiments.filtered_at_rest(loop, duration_s).items()}


def recorded_step(loop: Rig, axis: str, printed: float) -> Step:
    """Return a step of Fig. 8 as the sensors show it, its size in m or rad as printed."""
    run = experiments.step(loop, axis, FIGURE_8[axis])
    return of_record(run.time, run.response / printed)


def of_record(time: Array, y: Array) -> Step:
    """Return the figures of a step from 0 to 1, its band as wide as the noise of the last quarter of the record."""
    return axes.measured(time, y, max(axes.BAND, float(np.abs(y[-len(y) // 4 :] - 1).max())))
