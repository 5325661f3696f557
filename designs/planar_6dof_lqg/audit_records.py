"""Audit of what only the whole loop with its sensors shows, from the records of a simulation or an experiment.

Nothing here runs a simulation: records are columns of samples, SI units, one row of the audit for each function.
"""

from dataclasses import dataclass

import numpy as np
from scipy import ndimage, signal

from designs.planar_6dof_leadlag import audit_records
from designs.planar_6dof_lqg.audit_stage import Array
from synth.report.audit import Published, Row, judge, row

noise = audit_records.noise  # Y-40 as Y-34

DOMINANT = 10.0  # dB by which a dominant line stands above the median of its neighbours
SEGMENTS = 16  # whose spectra are averaged, so that those of noise scatter by less
NEIGHBOURS = 31  # lines


@dataclass(frozen=True)
class Line:
    """The line of a spectrum that stands highest above its neighbours: where, in Hz, and by how much, in dB."""

    frequency: float
    above: float


def prominent(x: Array, period_s: float) -> Line:
    """Return the most prominent line of a record x (N,)."""
    frequency, power = signal.welch(x, 1 / period_s, nperseg=2 * len(x) // (SEGMENTS + 1), detrend="linear")
    around = ndimage.median_filter(power, NEIGHBOURS, mode="nearest")
    above = 10 * np.log10(power[1:] / around[1:])  # without the mean
    most = int(above.argmax())
    return Line(float(frequency[1 + most]), float(above[most]))


def spectrum(printed: Published, x: Array, period_s: float) -> Row:
    """Y-41: recompute Fig. 10(d) from a record x (N,), m, of a step under the controller, once it has settled."""
    line = prominent(x, period_s)
    figures = [("most prominent line", line.frequency, "Hz"), ("above its neighbours", line.above, "dB")]
    why = (
        "Rule: no line of the spectrum, averaged over 16 segments, stands 10 dB or more above the median of its 31 "
        "neighbours, to which the scatter of noise alone comes no nearer than half way."
    )
    return row(printed, figures, judge(line.above < DOMINANT), why)
