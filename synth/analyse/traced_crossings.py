"""Gain and phase crossings of a loop of high order, traced on a frequency grid in double precision.

Bracketing between the nodes of `transfer.trace` locates each crossing and the least |1 + L|. A pair of crossings inside
one interval shows as an extremum between them. If |L| = 1 or L < 0 over a whole stretch (an all-pass, an undamped
loop), only the worst crossings of the stretch are returned. A crossing between nodes may be missed, so the caller must
verify the result.
"""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq, minimize_scalar

from synth.analyse import refinement
from synth.analyse.crossings import Crossing, Crossings
from synth.analyse.transfer import Curve
from synth.errors import ModelError
from synth.statespace import Array, Complex

FLAT = 1e-10  # log |L| or sin(arg L) below it at neighbouring nodes counts as 0 on the whole stretch
MAX_EXTREMUM = 0.3  # neighbours differ by at most half of it: an extremum farther from 0 does not reach 0
REAL = 1e-6  # of |L|: a sign change of a larger imaginary part is a pole


def of_curve(curve: Curve) -> Crossings:
    """Return the crossings of a traced loop."""
    unit = _unit_gain_frequencies(curve)
    at = {f: complex(curve.L(f)[0]) for f in _real_axis_frequencies(curve, unit)}
    negative = [Crossing(f, v) for f, v in sorted(at.items()) if abs(v.imag) <= REAL * abs(v) and v.real < 0]
    gain = tuple(Crossing(f, complex(curve.L(f)[0])) for f in unit)
    return Crossings(gain, tuple(negative), curve.ends, *_peak(curve))


def _unit_gain_frequencies(curve: Curve) -> list[float]:
    """Return the frequencies with |L| = 1; for a stretch, those with the least phase and delay margins."""
    value, w = refinement.log_magnitude(curve.value), curve.w
    frequencies = [] if len(w) < 3 else _roots(lambda v: refinement.log_magnitude(curve.L(v)), w, value)
    _require_parity(frequencies, value)
    for run in _stretches(value):
        above = np.angle(-curve.value[run])
        frequencies += [float(w[run][np.abs(above).argmin()]), float(w[run][(above % (2 * np.pi) / w[run]).argmin()])]
    return sorted(set(frequencies))


def _require_parity(crossings: list[float], value: Array) -> None:
    """Raise ModelError if the number of crossings does not fit log |L| at the ends; skipped for stretches of zeros."""
    if len(value) < 3 or _stretches(value) or (np.abs(value[[0, -1]]) <= FLAT).any():
        return
    first, last = np.exp(value[[0, -1]])
    if len(crossings) % 2 != ((first > 1) != (last > 1)):
        raise ModelError(
            f"{len(crossings)} crossings of |L| = 1 were found, but |L| goes from {first:.3g} to {last:.3g}: the "
            "loop has too many lightly damped modes for double precision; leave some out"
        )


def _real_axis_frequencies(curve: Curve, unit: list[float]) -> list[float]:
    """Return the frequencies with L real; for a stretch, those of `unit` (|L| = 1), or where |L| is closest to 1."""

    def sine(v: Array | float) -> Array:
        return _sine(curve.L(v))

    value, w = _sine(curve.value), curve.w
    frequencies = _roots(sine, w, value)
    for run in _stretches(value):
        inside = [f for f in unit if w[run][0] <= f <= w[run][-1]]
        frequencies += inside or [float(w[run][np.abs(refinement.log_magnitude(curve.value[run])).argmin()])]
    return sorted(set(frequencies))


def _sine(value: Complex) -> Array:
    return np.asarray(value.imag / np.maximum(np.abs(value), 1e-300))


def _stretches(value: Array) -> list[slice]:
    """Return the runs of three or more nodes where `value` is 0 within rounding."""
    flat = np.concatenate([[False], np.abs(value) < FLAT, [False]])
    edges = np.flatnonzero(np.diff(flat.astype(int)))
    return [slice(a, b) for a, b in zip(edges[::2], edges[1::2], strict=True) if b - a >= 3]


def _roots(f: Callable[[float], NDArray[np.float64]], w: Array, value: Array) -> list[float]:
    """Return the zeros of f, from its `value` on w, without stretches of zeros."""
    w, value = _with_extrema(f, w, value)
    signs = np.sign(value)
    for run in _stretches(value):
        signs[run] = np.nan
    roots = [float(v) for v in w[signs == 0]]
    for k in np.flatnonzero(signs[:-1] * signs[1:] < 0):
        roots.append(_root(f, float(w[k]), float(w[k + 1])))
    return sorted(roots)


def _root(f: Callable[[float], NDArray[np.float64]], a: float, b: float) -> float:
    """Return the zero of f between a and b, or the closer end if rounding has moved the zero outside."""
    at_a, at_b = (float(np.ravel(f(v))[0]) for v in (a, b))
    if at_a * at_b >= 0:
        return a if abs(at_a) <= abs(at_b) else b
    return float(brentq(lambda v: float(np.ravel(f(v))[0]), a, b, xtol=1e-12 * a, rtol=1e-13))


def _with_extrema(f: Callable[[float], NDArray[np.float64]], w: Array, value: Array) -> tuple[Array, Array]:
    """Return the nodes and each extremum of f between nodes that lies beyond 0."""
    size, sign = np.abs(value), np.sign(value)
    turns = (size[1:-1] <= size[:-2]) & (size[1:-1] <= size[2:]) & (size[1:-1] < MAX_EXTREMUM)
    turns &= size[1:-1] < 4 * (np.maximum(size[:-2], size[2:]) - size[1:-1])  # bound for a smooth extremum
    turns &= w[2:] - w[:-2] > 16 * refinement.MIN_SPACING * w[2:]
    turns &= (sign[1:-1] == sign[:-2]) & (sign[1:-1] == sign[2:]) & (size[1:-1] > FLAT)
    for k in np.flatnonzero(turns) + 1:
        where, least = _bracketed_minimum(_scalar_function(f, sign[k]), w[k - 1], w[k + 1])
        if least < 0:
            at = int(np.searchsorted(w, where))
            w, value = np.insert(w, at, where), np.insert(value, at, sign[k] * least)
            return _with_extrema(f, w, value)
    return w, value


def _scalar_function(f: Callable[[float], NDArray[np.float64]], factor: float) -> Callable[[float], float]:
    return lambda v: factor * float(np.ravel(f(v))[0])


def _bracketed_minimum(f: Callable[[float], float], a: float, b: float) -> tuple[float, float]:
    """Return the minimiser of f in a bracket, which may be far narrower than a, and its value."""
    minimum = minimize_scalar(lambda t: f(a + (b - a) * t), bounds=(0, 1), method="bounded", options={"xatol": 1e-9})
    return float(a + (b - a) * minimum.x), float(minimum.fun)


def _peak(curve: Curve) -> tuple[float, float]:
    """Return the largest 1/|1 + L| and its frequency."""
    w, distance = curve.w, np.abs(1 + curve.value)
    candidates = [(abs(1 + v), f) for f, v in curve.ends.items()] + [
        (float(distance.min()), float(w[distance.argmin()]))
    ]
    falling = np.flatnonzero((distance[1:-1] <= distance[:-2]) & (distance[1:-1] <= distance[2:])) + 1
    near = falling[distance[falling] < 1.2 * distance.min()]  # neighbours differ by less; a flat S has many minima
    for k in near[np.argsort(distance[near], kind="stable")[:20]]:
        where, least = _bracketed_minimum(lambda v: float(abs(1 + curve.L(v)[0])), w[k - 1], w[k + 1])
        candidates.append((least, where))
    least, where = min(candidates)
    return (1 / least if least > 0 else np.inf), where
