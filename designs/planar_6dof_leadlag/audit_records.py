"""Audit of what only the whole loop with its sensors shows, from the records of a simulation or an experiment.

Nothing here runs a simulation: records are columns of samples, SI units, one row of the audit for each function.
"""

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from designs.planar_6dof_leadlag import audit_axes, audit_loops
from synth.report.audit import Published, Row, judge, row

Array = NDArray[np.float64]

UNITS = {"x": 1e-6, "y": 1e-6, "phi": np.pi / 180}  # of the printed steps, SI


def noise(printed: Published, records: Mapping[str, Array]) -> Row:
    """Y-34: recompute the position noise from records x and y (N,), m, of the stage at rest under its controller."""
    found = {n: 1e6 * float(np.std(records[n])) for n in ("x", "y")}
    why = "Rule: the rms about the mean within one unit of the last printed digit, in x and in y."
    agree = all(printed[n].agrees(value) for n, value in found.items())
    return row(printed, [(f"rms, {n}", value, "um") for n, value in found.items()], judge(agree), why)


def steps(published: Mapping[str, Published], printed: Published, time: Array, records: Mapping[str, Array]) -> Row:
    """Y-35: recompute Fig. 8 from records x, y, phi (N,), m and rad, of the printed steps from 0, made at time[0] s."""
    found = {}
    for n, unit in UNITS.items():
        y = np.asarray(records[n]) / (printed[n].value * unit)
        band = max(audit_axes.BAND, float(np.abs(y[-len(y) // 4 :] - 1).max()))
        found[n] = audit_axes.measured(time, y, band)
    figures = [(f"rise, {n}", 1e3 * s.rise, "ms") for n, s in found.items()]
    figures += [(f"overshoot, {n}", s.overshoot, "%") for n, s in found.items()]
    figures += [(f"last time outside its band, {n}", 1e3 * s.settled, "ms") for n, s in found.items()]
    why = (
        "Rule: the bounds of Y-9 and an overshoot within a quarter of Y-9b's, in all three axes. The band is 2 % of "
        "the step, or where noise is larger the greatest deviation in the last quarter of the record."
    )
    bounds, wanted = published["Y-9"], published["Y-9b"]
    agree = all(audit_loops.within(s, bounds) and audit_loops.around(s, wanted) for s in found.values())
    return row(printed, figures, judge(agree), why, tuple(f"{printed.id}.{n}" for n in UNITS))
