"""Figures of simulated records for the audit: noise at rest, steps, spectra, and their comparison with the print."""

from dataclasses import dataclass

import numpy as np
from scipy import ndimage, signal

from designs.planar_6dof import experiments
from designs.planar_6dof.loop import measured_positions, simulate
from designs.planar_6dof.paper import axis_loop
from designs.planar_6dof.paper.axis_loop import Margin, Step
from synth.report.audit import Printed
from synth.simulate.rig import Rig
from synth.statespace import Array

FIGURE_8 = {"x": 20e-6, "y": 100e-6, "phi": 0.01 * np.pi / 180}  # m, rad
STEP = 50e-6  # m, of x in Fig. 10
RECORD = 20.0  # s, of x whose spectrum is taken, after a second in which its step settles
DOMINANT = 10.0  # dB by which a dominant line exceeds the median of its neighbours
SEGMENTS = 16  # averaged for the spectrum
NEIGHBOURS = 31  # lines


def noise_at_rest(loop: Rig, duration_s: float) -> dict[str, float]:
    """Return the rms of x and y in m after the filter (6)-(16), which the lead-lag controller uses."""
    shown = measured_positions(loop, simulate(loop, duration_s, {}, {}))
    return {axis: float(np.std(experiments.after_settling(loop, shown[axis]))) for axis in "xy"}


def recorded_step(loop: Rig, axis: str, printed: float) -> Step:
    """Return the figures of a measured step of Fig. 8, with its size in m or rad as printed."""
    run = experiments.step(loop, axis, FIGURE_8[axis])
    return of_record(run.time, run.response / printed)


def of_record(time: Array, y: Array) -> Step:
    """Return the figures of a step from 0 to 1, with a band at least as wide as the noise in the last quarter."""
    return axis_loop.of_response(time, y, max(axis_loop.SETTLING_BAND, float(np.abs(y[-len(y) // 4 :] - 1).max())))


def meets(margin: Margin, crossover: Printed, phase: Printed) -> bool:
    """Return whether crossover and phase margin agree with the print."""
    return crossover.agrees(margin.crossover) and phase.agrees(margin.phase)


def in_bounds(step: Step, rise: Printed, settling: Printed) -> bool:
    """Return whether a step is as fast as printed, ms."""
    return 1e3 * step.rise < rise.value and 1e3 * step.settling < settling.value


@dataclass(frozen=True)
class Line:
    """The most prominent line of a spectrum: its frequency in Hz and its height above its neighbours in dB."""

    frequency: float
    above: float

    @property
    def dominant(self) -> bool:
        """Whether it exceeds DOMINANT."""
        return self.above >= DOMINANT


def of_step(loop: Rig) -> Line:
    """Return the most prominent line of the measured x, over RECORD after its step has settled."""
    run = experiments.step(loop, "x", STEP, 1.0 + RECORD)
    return prominent_line(run.measured[run.sample + round(1.0 / loop.period_s) :], loop.period_s)


def prominent_line(x: Array, period_s: float) -> Line:
    """Return the most prominent line of a record x (N,)."""
    frequency, power = signal.welch(x, 1 / period_s, nperseg=2 * len(x) // (SEGMENTS + 1), detrend="linear")
    around = ndimage.median_filter(power, NEIGHBOURS, mode="nearest")
    above = 10 * np.log10(power[1:] / around[1:])  # without the mean
    most = int(above.argmax())
    return Line(float(frequency[1 + most]), float(above[most]))
