"""Time-domain performance metrics of a response y(t) to a set-point r, as MATLAB `stepinfo`; error e = y - r.

    overshoot     max over t of (y - r) s / |r - y0|, at least 0, with s the sign of the step r - y0
    rise time     from the first sample beyond 10 % of the step to the first beyond 90 %, between samples linearly
    settling      the least t_j - t_0 with |e_k| <= band for all k >= j
    mean error    the mean of |e_k| over start <= t_k <= stop

A time is infinite when the record does not contain the event: a response that is outside its band at the last sample
has not settled. A NaN sample lies outside every band. The record should continue well beyond the settling time. The
paper's t_s is the settling time for 0.1 mm or 0.1 mrad. Its t_enc, "the time it takes for the tracking error to reach
encoder resolution", is computed as the stricter settling time for 10 um or 20 urad.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from synth.errors import SignalError
from synth.statespace import Array


@dataclass(frozen=True)
class StepResponse:
    """Metrics of one step: overshoot as a fraction of the step; times in seconds from the step, inf if never."""

    overshoot: float
    t_s: float
    t_enc: float


def step_response(
    time: ArrayLike, y: ArrayLike, start: float, target: float, band: float, resolution: float
) -> StepResponse:
    """Return the metrics of a step from `start` to `target` at time[0]; time and y are (N,).

    t_s is for `band`; t_enc is for `resolution`; both in the unit of y.

    Raises SignalError when the step is 0, when the shapes of the arrays differ or when a band is not positive.
    """
    error = np.asarray(y, dtype=np.float64) - target
    return StepResponse(
        overshoot=overshoot(y, start, target),
        t_s=settling_time(time, error, band),
        t_enc=settling_time(time, error, resolution),
    )


def overshoot(y: ArrayLike, start: float, target: float) -> float:
    """Return the overshoot of y (N,) beyond `target`, as a fraction of the step from `start`.

    Raises SignalError when the step is 0 or there is no sample.
    """
    values, step = np.asarray(y, dtype=np.float64), target - start
    if step == 0 or not np.isfinite(step):
        raise SignalError(f"step from {start} to {target}: overshoot needs a finite step other than 0; give another")
    if values.size == 0:
        raise SignalError("response: found no sample, overshoot needs at least one; simulate longer")
    return float(np.maximum(0.0, np.max((values - target) / step)))


def rise_time(time: ArrayLike, y: ArrayLike, start: float, target: float) -> float:
    """Return the seconds between the first crossings of 10 and 90 % of the step; inf if 90 % is never reached.

    Raises SignalError when the step is 0.
    """
    step = target - start
    if step == 0 or not np.isfinite(step):
        raise SignalError(f"step from {start} to {target}: a rise time needs a finite step other than 0; give another")
    t, values = _series(time, y)
    fraction = (values - start) / step
    ends = [_crossing_time(t, fraction, level) for level in (0.1, 0.9)]
    return ends[1] - ends[0] if np.isfinite(ends[1]) else np.inf


def _crossing_time(t: Array, fraction: Array, level: float) -> float:
    """Return the time of the first crossing of `level` by `fraction` (N,), linear between samples; inf if never."""
    above = np.flatnonzero(fraction >= level)
    if not above.size:
        return np.inf
    k = int(above[0])
    return float(np.interp(level, fraction[k - 1 : k + 1], t[k - 1 : k + 1])) if k else float(t[0])


def settling_time(time: ArrayLike, error: ArrayLike, band: float) -> float:
    """Return the seconds from time[0] after which |error| stays at or below `band`; inf if it ends outside."""
    t, inside = _inside(time, error, band)
    if not inside[-1]:
        return np.inf
    outside = np.flatnonzero(~inside)
    return float(t[outside[-1] + 1] - t[0]) if outside.size else 0.0


def mean_absolute(time: ArrayLike, error: ArrayLike, start: float = -np.inf, stop: float = np.inf) -> float:
    """Return the mean of |error| over the samples with start <= time <= stop, seconds, in the unit of `error`.

    Raises SignalError when the window holds no sample.
    """
    t, e = _series(time, error)
    window = (t >= start) & (t <= stop)
    if not window.any():
        raise SignalError(
            f"mean error: no sample in {start:g} .. {stop:g} s, the record spans {t[0]:g} .. {t[-1]:g} s: "
            "give a window that holds one"
        )
    return float(np.mean(np.abs(e[window])))


def first_exit(time: ArrayLike, y: ArrayLike, low: float, high: float) -> float:
    """Return the first time, seconds, at which y (N,) is not in low .. high; inf if it stays."""
    t, values = _series(time, y)
    outside = ~((values >= low) & (values <= high))
    return float(t[np.argmax(outside)]) if outside.any() else np.inf


def _inside(time: ArrayLike, error: ArrayLike, band: float) -> tuple[Array, NDArray[np.bool_]]:
    if not band > 0:
        raise SignalError(f"error band is {band}: it must be positive; give it in the unit of the error")
    t, e = _series(time, error)
    return t, np.abs(e) <= band


def _series(time: ArrayLike, values: ArrayLike) -> tuple[Array, Array]:
    t, v = np.asarray(time, dtype=np.float64), np.asarray(values, dtype=np.float64)
    if t.ndim != 1 or t.shape != v.shape or t.size == 0:
        raise SignalError(f"response has times {t.shape} and values {v.shape}: give one value for each of N >= 1 times")
    return t, v
