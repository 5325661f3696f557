"""Assessment of a loop for its margins: its crossings, and two independent checks of them.

The first check counts the unstable poles of the closed loop after the loop is multiplied by a complex factor. The
second bounds the change that rounding of the loop's coefficients can cause. A rational loop is a ratio of polynomials
and a delayed loop is a sum of logarithms; both are computed without rounding. A loop of many states is traced in
double precision.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from synth.analyse.loops import crossings, disk, grid_crossings, nyquist, transfer, zpk
from synth.analyse.loops.crossings import Crossings
from synth.analyse.loops.disk import Perturbation
from synth.analyse.loops.transfer import Delayed
from synth.errors import ModelError
from synth.statespace import StateSpace, System
from synth.timing import Continuous


@dataclass(frozen=True, eq=False)
class Assessment:
    """The crossings of a loop, whether it is stable, and the two checks of the crossings.

    `is_complete` is true if the range of frequency excludes no crossing. `count_unstable` takes a factor on the loop,
    `disk` takes a frequency in rad/s.
    """

    crossings: Crossings
    stable: bool
    is_complete: bool
    count_unstable: Callable[[complex], float]
    perturbation: Callable[[float], Perturbation]


def of_rational(system: System, low: float | None, high: float | None) -> Assessment:
    """Return the assessment of a scalar System from its numerator and denominator polynomials."""
    loop = zpk.of_system(system)
    if loop.model.D[0, 0] == -1:
        raise ModelError(transfer.ILL_POSED)
    bottom, top = low or 0.0, (high if isinstance(loop.time, Continuous) else None) or np.inf
    return Assessment(
        crossings.of_rational(loop, bottom, top),
        disk.is_stable(loop),
        bottom == 0 and np.isinf(top),
        lambda factor: zpk.count_unstable(loop, factor),
        lambda w: disk.of_rational(loop, w),
    )


def of_delayed_loop(loop: Delayed, low: float | None, high: float | None) -> Assessment:
    """Return the assessment of a loop with an exact delay and hold."""
    model = zpk.of_system(loop.model)
    L = None if model.N.is_zero() else crossings.zero_pole_gain(loop, model).value

    def count_unstable(factor: complex) -> float:
        return nyquist.count_unstable(loop, factor, high, L)

    def sensitivity_to_rounding(w: float) -> Perturbation:
        of_loop = disk.of_rational(model, w).of_loop
        value = abs(L(w)[0]) / abs(1 + L(w)[0]) if L and np.isfinite(w) else 1.0
        return Perturbation(of_loop, of_loop * float(value))

    return Assessment(
        crossings.of_delayed_loop(loop, model, low, high),
        count_unstable(1.0) == 0,
        low is None and high is None,
        count_unstable,
        sensitivity_to_rounding,
    )


def of_many_states(loop: StateSpace | Delayed, low: float | None, high: float | None) -> Assessment:
    """Return the assessment of a loop of many states, traced in double precision."""
    model = loop.model if isinstance(loop, Delayed) else loop

    def count_unstable(factor: complex) -> float:
        if isinstance(loop, Delayed):
            return nyquist.count_unstable(loop, factor, high)
        return int(transfer.not_decaying(transfer.closed_loop_poles(loop, factor), loop.time).sum())

    return Assessment(
        grid_crossings.of_curve(transfer.trace(loop, low, high)),
        count_unstable(1.0) == 0,
        low is None and (high is None or not isinstance(model.time, Continuous)),
        count_unstable,
        lambda w: disk.of_model(model, w),
    )
