"""What the simulated LQG loop records, for the audit's formulas: the spectrum of its step."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage, signal

from designs.planar_6dof import experiments
from synth.simulate.rig import Rig

Array = NDArray[np.float64]

STEP = 50e-6  # m, of x in Fig. 10
RECORD = 20.0  # s, of x whose spectrum is taken, after a second in which its step settles
DOMINANT = 10.0  # dB by which a dominant line stands above the median of its neighbours
SEGMENTS = 16  # whose spectra are averaged, so that those of noise scatter by less
NEIGHBOURS = 31  # lines


@dataclass(frozen=True)
class Line:
    """The line of a spectrum that stands highest above its neighbours: where, in Hz, and by how much, in dB."""

    frequency: float
    above: float

    @property
    def dominant(self) -> bool:
        """Whether it is a component of its own."""
        return self.above >= DOMINANT


def of_step(loop: Rig) -> Line:
    """Return the most prominent line of x as measured, over RECORD, once its step has settled."""
    run = experiments.step(loop, "x", STEP, 1.0 + RECORD)
    return prominent(run.shown[run.sample + round(1.0 / loop.period_s) :], loop.period_s)


def prominent(x: Array, period_s: float) -> Line:
    """Return the most prominent line of a record x (N,)."""
    frequency, power = signal.welch(x, 1 / period_s, nperseg=2 * len(x) // (SEGMENTS + 1), detrend="linear")
    around = ndimage.median_filter(power, NEIGHBOURS, mode="nearest")
    above = 10 * np.log10(power[1:] / around[1:])  # without the mean
    most = int(above.argmax())
    return Line(float(frequency[1 + most]), float(above[most]))
