"""Gain and phase crossings and sensitivity peak of a loop of high order, on a frequency grid (MATLAB `allmargin`).

    |L(j w)| = 1                    gain crossings: zeros of log |L|
    Im L(j w) = 0, Re L < 0         phase crossings: zeros of sin(arg L)
    max 1 / |1 + L(j w)|            sensitivity peak

`transfer.trace` supplies L in double precision on a grid so fine that L changes little from node to node. A change of
sign between two nodes brackets a zero, which Brent's method locates. Two zeros in one interval show as an extremum
between its nodes, which is searched for. A zero between nodes may still be missed, so the caller must verify the
result; `crossings` finds all zeros for loops of low order.

A flat interval is a run of nodes on which log |L| or sin(arg L) is 0 within rounding: |L| = 1 for an all-pass, L real
for an undamped loop. Every frequency in it is a crossing, and only the worst ones are returned.
"""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq, minimize_scalar

from synth.analyse.loops.crossings import Crossing, Crossings
from synth.analyse.loops.transfer import Curve
from synth.analyse.numerics import precise
from synth.errors import ModelError
from synth.statespace import Array, Complex

FLAT = 1e-10  # a smaller log |L| or sin(arg L) counts as 0 in the search for flat intervals
MAX_EXTREMUM = 0.3  # log |L| and sin(arg L) change by at most 0.15 between nodes: a larger extremum stays off 0
MAX_IMAGINARY = 1e-6  # |Im L| / |L| of a phase crossing; where it is larger, Im L changes its sign at a pole


def of_curve(curve: Curve) -> Crossings:
    """Return the crossings of a loop from its frequency response on a grid."""
    gain_frequencies = _unit_gain_frequencies(curve)
    gain = tuple(Crossing(f, complex(curve.L(f)[0])) for f in gain_frequencies)
    real = [Crossing(f, complex(curve.L(f)[0])) for f in _real_frequencies(curve, gain_frequencies)]
    phase = tuple(c for c in real if abs(c.L.imag) <= MAX_IMAGINARY * abs(c.L) and c.L.real < 0)
    return Crossings(gain, phase, curve.ends, *_sensitivity_peak(curve))


def _unit_gain_frequencies(curve: Curve) -> list[float]:
    """Return the frequencies with |L| = 1; of a flat interval, those with the least phase and delay margin."""
    value, w = precise.log_magnitude(curve.value), curve.w
    frequencies = [] if len(w) < 3 else _roots(lambda v: precise.log_magnitude(curve.L(v)), w, value)
    _require_parity(frequencies, value)
    for flat in _flat_intervals(value):
        phase_margin, w_flat = np.angle(-curve.value[flat]), w[flat]  # rad, to either side
        delay_margin = (phase_margin % (2 * np.pi)) / w_flat
        frequencies += [float(w_flat[np.abs(phase_margin).argmin()]), float(w_flat[delay_margin.argmin()])]
    return sorted(set(frequencies))


def _require_parity(crossings: list[float], value: Array) -> None:
    """Raise ModelError if the number of crossings does not fit log |L| at the ends; skipped with flat intervals."""
    if len(value) < 3 or _flat_intervals(value) or (np.abs(value[[0, -1]]) <= FLAT).any():
        return
    first, last = np.exp(value[[0, -1]])
    if len(crossings) % 2 != ((first > 1) != (last > 1)):
        raise ModelError(
            f"{len(crossings)} crossings of |L| = 1 were found, but |L| goes from {first:.3g} to {last:.3g}: the "
            "loop has too many lightly damped modes for double precision; leave some out"
        )


def _real_frequencies(curve: Curve, gain_frequencies: list[float]) -> list[float]:
    """Return the frequencies with L real.

    Of a flat interval, these are the gain crossings in it, or if it has none, the frequency with |L| closest to 1.
    """

    def phase_sine(v: Array | float) -> Array:
        return _phase_sine(curve.L(v))

    value, w = _phase_sine(curve.value), curve.w
    frequencies = _roots(phase_sine, w, value)
    for flat in _flat_intervals(value):
        inside = [f for f in gain_frequencies if w[flat][0] <= f <= w[flat][-1]]
        frequencies += inside or [float(w[flat][np.abs(precise.log_magnitude(curve.value[flat])).argmin()])]
    return sorted(set(frequencies))


def _phase_sine(value: Complex) -> Array:
    """Return sin(arg L)."""
    return np.asarray(value.imag / np.maximum(np.abs(value), 1e-300))


def _flat_intervals(value: Array) -> list[slice]:
    """Return the runs of three or more nodes where `value` is 0 within rounding."""
    is_flat = np.concatenate([[False], np.abs(value) < FLAT, [False]])
    edges = np.flatnonzero(np.diff(is_flat.astype(int)))
    return [slice(a, b) for a, b in zip(edges[::2], edges[1::2], strict=True) if b - a >= 3]


def _roots(f: Callable[[float], NDArray[np.float64]], w: Array, value: Array) -> list[float]:
    """Return the zeros of f, from its `value` on w, except those in flat intervals."""
    w, value = _with_extrema_between_nodes(f, w, value)
    signs = np.sign(value)
    for flat in _flat_intervals(value):
        signs[flat] = np.nan
    roots = [float(v) for v in w[signs == 0]]
    for k in np.flatnonzero(signs[:-1] * signs[1:] < 0):
        roots.append(_root(f, float(w[k]), float(w[k + 1])))
    return sorted(roots)


def _root(f: Callable[[float], NDArray[np.float64]], a: float, b: float) -> float:
    """Return the zero of f between a and b, or the closer end if rounding has moved the zero outside."""
    f_a, f_b = (float(np.ravel(f(v))[0]) for v in (a, b))
    if f_a * f_b >= 0:
        return a if abs(f_a) <= abs(f_b) else b
    return float(brentq(lambda v: float(np.ravel(f(v))[0]), a, b, xtol=1e-12 * a, rtol=1e-13))


def _with_extrema_between_nodes(
    f: Callable[[float], NDArray[np.float64]], w: Array, value: Array
) -> tuple[Array, Array]:
    """Return the grid with a node added at each extremum of f where its sign differs from that of both neighbours."""
    for k in _nodes_near_extrema(w, value):
        sign = np.sign(value[k])
        frequency, least = _bracketed_minimum(_scalar_function(f, sign), w[k - 1], w[k + 1])
        if least < 0:
            at = int(np.searchsorted(w, frequency))
            w, value = np.insert(w, at, frequency), np.insert(value, at, sign * least)
            return _with_extrema_between_nodes(f, w, value)
    return w, value


def _nodes_near_extrema(w: Array, value: Array) -> NDArray[np.int64]:
    """Return the nodes k where |value| is least among its neighbours and f may cross 0 twice beside the node."""
    magnitude, sign = np.abs(value), np.sign(value)
    before, here, after = magnitude[:-2], magnitude[1:-1], magnitude[2:]
    is_candidate = (here <= before) & (here <= after) & (here < MAX_EXTREMUM)
    # Beside its least node a smooth f falls by less than four times the rise to the larger neighbour.
    is_candidate &= here < 4 * (np.maximum(before, after) - here)
    # Closer nodes lie on an undamped pole, where L is only rounding error.
    is_candidate &= w[2:] - w[:-2] > 16 * precise.MIN_SPACING * w[2:]
    is_candidate &= (sign[1:-1] == sign[:-2]) & (sign[1:-1] == sign[2:]) & (here > FLAT)
    return np.flatnonzero(is_candidate) + 1


def _scalar_function(f: Callable[[float], NDArray[np.float64]], factor: float) -> Callable[[float], float]:
    return lambda v: factor * float(np.ravel(f(v))[0])


def _bracketed_minimum(f: Callable[[float], float], a: float, b: float) -> tuple[float, float]:
    """Return the minimiser of f in a bracket, which may be far narrower than a, and its value."""
    minimum = minimize_scalar(lambda t: f(a + (b - a) * t), bounds=(0, 1), method="bounded", options={"xatol": 1e-9})
    return float(a + (b - a) * minimum.x), float(minimum.fun)


def _sensitivity_peak(curve: Curve) -> tuple[float, float]:
    """Return the largest |S| = 1/|1 + L| and its frequency."""
    w, distance = curve.w, np.abs(1 + curve.value)
    candidates = [(abs(1 + v), f) for f, v in curve.ends.items()] + [
        (float(distance.min()), float(w[distance.argmin()]))
    ]
    minima = np.flatnonzero((distance[1:-1] <= distance[:-2]) & (distance[1:-1] <= distance[2:])) + 1
    # |1 + L| changes by less than 20 % from node to node, so only such minima can lie below the least node. Of the many
    # minima of a flat |S| the 20 least are refined.
    low = minima[distance[minima] < 1.2 * distance.min()]
    for k in low[np.argsort(distance[low], kind="stable")[:20]]:
        frequency, least = _bracketed_minimum(lambda v: float(abs(1 + curve.L(v)[0])), w[k - 1], w[k + 1])
        candidates.append((least, frequency))
    least, frequency = min(candidates)
    return (1 / least if least > 0 else np.inf), frequency
