"""What the lead-lag loops do, for the audit's formulas: noise at rest, the steps of Fig. 8, what meets the print."""

import numpy as np
from numpy.typing import NDArray

from designs.planar_6dof import experiments
from designs.planar_6dof.loop import seen, simulate
from models import axis_figures
from models.axis_figures import Margin, Step
from synth.report.audit import Printed
from synth.simulate.rig import Rig

Array = NDArray[np.float64]

OVERSHOOT = 0.25  # relative: "around 20 %" is 15 to 25 %
FIGURE_8 = {"x": 20e-6, "y": 100e-6, "phi": 0.01 * np.pi / 180}  # m, rad


def noise_at_rest(loop: Rig, duration_s: float) -> dict[str, float]:
    """Return the rms of x and y in m behind the filter (6)-(16), which is what the lead-lag controller acts on."""
    shown = seen(loop, simulate(loop, duration_s, {}, {}))
    return {axis: float(np.std(experiments.settled(loop, shown[axis]))) for axis in "xy"}


def recorded_step(loop: Rig, axis: str, printed: float) -> Step:
    """Return a step of Fig. 8 as the sensors show it, its size in m or rad as printed."""
    run = experiments.step(loop, axis, FIGURE_8[axis])
    return of_record(run.time, run.response / printed)


def of_record(time: Array, y: Array) -> Step:
    """Return the figures of a step from 0 to 1, its band as wide as the noise of the last quarter of the record."""
    return axis_figures.measured(time, y, max(axis_figures.BAND, float(np.abs(y[-len(y) // 4 :] - 1).max())))


def meets(margin: Margin, crossover: Printed, phase: Printed) -> bool:
    """Return whether crossover and phase margin are those printed."""
    return crossover.agrees(margin.crossover) and phase.agrees(margin.phase)


def in_bounds(step: Step, rise: Printed, settling: Printed) -> bool:
    """Return whether a step is as fast as printed, ms."""
    return 1e3 * step.rise < rise.value and 1e3 * step.settled < settling.value


def overshoots(step: Step, printed: Printed) -> bool:
    """Return whether a step overshoots by about as much as printed."""
    return abs(step.overshoot / printed.value - 1) <= OVERSHOOT
