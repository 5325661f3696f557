"""Poles as a table of modes: frequency |s| / (2 pi) and damping -Re s / |s|, with s = log(z) / T where sampled."""

import numpy as np
from numpy.typing import NDArray

from synth import show
from synth.timing import Discrete, Time

DEADBEAT = 2.0**-42  # a single pole |z| below it is the rounding error of 0


def table(poles: NDArray[np.complex128], time: Time) -> show.Table:
    """Return a table of poles in 1/s or in z with their natural frequency in Hz and their damping.

    A pole at z = 0 is deadbeat and has no frequency; a constant, s = 0 or z = 1, has no damping. Rounding scatters k
    poles at z = 0 by the k-th root of its size; such a cluster is also deadbeat.
    """
    sampled = isinstance(time, Discrete)
    radius = _deadbeat_radius(poles) if sampled else -1.0
    rows = ((show.number(p), *(("deadbeat", "-") if abs(p) <= radius else _shape(p, time))) for p in poles)
    return show.Table(("pole, z" if sampled else "pole [1/s]", "f [Hz]", "damping"), tuple(rows))


def _deadbeat_radius(poles: NDArray[np.complex128]) -> float:
    sizes = np.sort(np.abs(poles))
    radius = DEADBEAT ** (1 / np.arange(1, len(sizes) + 1))
    return float(radius[sizes <= radius].max(initial=0.0))


def _shape(pole: complex, time: Time) -> tuple[str, str]:
    s = np.log(complex(pole)) / time.period_s if isinstance(time, Discrete) else pole
    return show.number(abs(s) / (2 * np.pi)), show.number(-s.real / abs(s)) if s else "-"
