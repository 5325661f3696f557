"""Gain and phase crossings and least distance to -1 of a rational loop, as zeros of polynomials.

With L = N / D on the axis s = i v, u = v^2 and N conj(D) = R(u) + i v F(u),

    |L| = 1            |N|^2 - |D|^2 = 0
    L real             F = 0; L < 0 where R < 0 as well
    |1 + L| least      d/du (|N + D|^2 / |D|^2) = 0, or at an end

Each is a polynomial in u with integer coefficients. All its positive zeros are isolated, so no crossing is missed,
however close it lies to another or to an end. The value of L at a zero is enclosed by a ball. For an order above
MAX_POLYNOMIAL_ORDER, branch and bound gives the least |1 + L| (`zpk.least_distance`). If |L| = 1 or
F = 0 at all frequencies, only the worst crossings are returned.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import flint
import numpy as np
from scipy.optimize import minimize_scalar

from synth.analyse.loops import rational, zpk
from synth.analyse.loops.rational import Polynomial, Rational, on_axis, squared_magnitude
from synth.analyse.numerics import precise
from synth.errors import ModelError
from synth.timing import Continuous

CORRECT_BITS = 53  # bits of a value, at least
ZERO_THRESHOLD = 2.0**-200  # a smaller value counts as 0
MAX_POLYNOMIAL_ORDER = 12  # order up to which the zeros of a polynomial of twice that degree give the least |1 + L|
POINTS = 2000  # of the grid on which an all-pass is searched for its worst crossing


@dataclass(frozen=True)
class Crossing:
    """The value of L at `frequency` rad/s."""

    frequency: float
    L: complex


@dataclass(frozen=True, eq=False)
class Crossings:
    """Crossings of |L| = 1 and of L < 0 in order of frequency, and the peak of |S| = |1/(1 + L)|.

    `ends` maps the frequencies 0 and pi/T or inf to L, if L is finite there.
    """

    gain_crossings: tuple[Crossing, ...]
    phase_crossings: tuple[Crossing, ...]
    ends: Mapping[float, float]
    peak: float
    peak_frequency: float


def of_rational(loop: Rational, low: float, high: float) -> Crossings:
    """Return the crossings of a loop between two frequencies in rad/s, and its `ends` regardless of these limits.

    Raises ModelError if `rational.MAX_BITS` bits do not resolve a value.
    """
    N, D = loop.lowest_terms
    at_ends = ends(loop)
    gain, phase = (
        tuple(c for c in crossings if low <= c.frequency <= high)
        for crossings in (_gain_crossings(loop, N, D), _phase_crossings(loop, N, D))
    )
    distance, frequency = _least_distance(loop, at_ends, low, high)
    return Crossings(gain, phase, at_ends, 1 / distance if distance else np.inf, frequency)


def ends(loop: Rational) -> dict[float, float]:
    """Return L at w = 0 and at Nyquist or infinity, unless it has a pole there."""
    N, D = loop.lowest_terms
    order = max(N.degree(), D.degree())
    last = np.inf if isinstance(loop.time, Continuous) else np.pi / loop.time.period_s
    pairs = {0.0: (N[0], D[0]), last: (N[order], D[order])}
    return {w: int(n) / int(d) for w, (n, d) in pairs.items() if d != 0}


def _gain_crossings(loop: Rational, N: Polynomial, D: Polynomial) -> tuple[Crossing, ...]:
    if is_all_pass(loop):
        return _worst_of_all_pass(loop, N, D)
    return _values_at_zeros(loop, N, D, squared_magnitude(N) - squared_magnitude(D))


def is_all_pass(loop: Rational) -> bool:
    """Tell whether |L| = 1 at all frequencies."""
    N, D = loop.lowest_terms
    return bool(squared_magnitude(N) == squared_magnitude(D))


def _phase_crossings(loop: Rational, N: Polynomial, D: Polynomial) -> tuple[Crossing, ...]:
    R, F = rational.times_conjugate(N, D)
    magnitude = squared_magnitude(D)
    poles_and_zeros = squared_magnitude(N) * magnitude
    if F.degree() >= 0:
        candidates = _values_at_zeros(loop, N, D, _without_common_zeros(F, poles_and_zeros))
    else:  # L is real at all frequencies: |L| is closest to 1 where it is 1 or stationary
        stationary = R.derivative() * magnitude - R * magnitude.derivative()
        unit = squared_magnitude(N) - magnitude
        candidates = _values_at_zeros(loop, N, D, _without_common_zeros(stationary * unit, poles_and_zeros))
    return tuple(c for c in candidates if c.L.real < 0)


def _without_common_zeros(P: Polynomial, factor: Polynomial) -> Polynomial:
    """Return P without the zeros that it shares with `factor`: L is 0 or has a pole there."""
    common = P.gcd(factor)
    while common.degree() > 0 and not P.is_zero():
        P = P // common
        common = P.gcd(common)
    return P


def _least_distance(loop: Rational, ends: Mapping[float, float], low: float, high: float) -> tuple[float, float]:
    """Return the least |1 + L| and its frequency."""
    N, D = loop.lowest_terms
    candidates = [(abs(1 + v), w) for w, v in ends.items()]
    if D.degree() <= MAX_POLYNOMIAL_ORDER:
        P, Q = squared_magnitude(N + D), squared_magnitude(D)
        stationary = _values_at_zeros(loop, N, D, _without_common_zeros(P.derivative() * Q - P * Q.derivative(), Q))
        inside = [c for c in stationary if low <= c.frequency <= high] + _crossings_at_limits(loop, N, D, low, high)
        return min(candidates + [(abs(1 + c.L), c.frequency) for c in inside])
    L = zpk.of_rational(loop)
    slowest = float(np.abs(loop.closed_loop_poles[loop.closed_loop_poles != 0]).min(initial=np.inf))
    start = loop.axis_point(low) if low else min(zpk.lowest_frequency(L), zpk.LOW_ASYMPTOTE * slowest)
    grid = zpk.frequency_grid(L, start, loop.closed_loop_poles)
    top = loop.axis_point(high) if np.isfinite(high) else float(grid[-1])
    distance, v = zpk.least_distance(L, zpk.interval_ends(L, grid, top, turning=False))
    return min([*candidates, (distance, loop.frequency(v))])


def _crossings_at_limits(loop: Rational, N: Polynomial, D: Polynomial, low: float, high: float) -> list[Crossing]:
    """Return L at the limits other than 0 and infinity, unless it has a pole there."""
    limits = [w for w in (low, high) if 0 < loop.axis_point(w) < np.inf]
    with precise.precision(4 * rational.BITS):
        at = [_value(N, D, flint.arb(loop.axis_point(w)) ** 2) for w in limits]
    return [Crossing(w, complex(L)) for w, L in zip(limits, at, strict=True) if L.is_finite()]


def _values_at_zeros(loop: Rational, N: Polynomial, D: Polynomial, P: Polynomial) -> tuple[Crossing, ...]:
    """Return L at the positive zeros of P, enclosed to double precision."""
    bits = rational.BITS
    while bits <= rational.MAX_BITS:
        with precise.precision(bits):
            points = sorted((root.real for root, _ in rational.roots(P) if root.imag == 0 and root.real > 0), key=float)
            values = [_value(N, D, u) for u in points]
            if all(_is_resolved(v) for v in values):
                frequencies = [loop.frequency(float(u.sqrt())) for u in points]
                return tuple(Crossing(w, complex(v)) for w, v in zip(frequencies, values, strict=True))
        bits *= 4
    raise ModelError(
        f"{rational.MAX_BITS} bits do not resolve a crossing of the loop: "
        "leave out modes with a negligible residue in the loop"
    )


def _is_resolved(value: flint.acb) -> bool:
    near = 1 + value
    return all(v.rel_accuracy_bits() >= CORRECT_BITS or abs(v) < ZERO_THRESHOLD for v in (value, near))


def _value(N: Polynomial, D: Polynomial, u: flint.arb) -> flint.acb:
    """Return L = (R + i v F) / |D|^2 at u = v^2."""
    v = u.sqrt()
    n, d = (flint.acb(flint.arb_poly(E)(u), v * flint.arb_poly(O)(u)) for E, O in (on_axis(N), on_axis(D)))
    return n / d


def _worst_of_all_pass(loop: Rational, N: Polynomial, D: Polynomial) -> tuple[Crossing, ...]:
    """Return the crossings with the least phase margin and the least delay margin of an all-pass, |L| = 1."""
    sizes = np.abs(rational.zeros(D))
    at_ends = [Crossing(w, complex(v)) for w, v in ends(loop).items() if w < np.inf]
    at_minus_one = (*_phase_crossings(loop, N, D), *(c for c in at_ends if c.L == -1))
    if not sizes.size:
        return at_minus_one
    v = np.geomspace(1e-3 * sizes[sizes > 0].min(initial=1.0), 1e3 * sizes.max(initial=1.0), POINTS)
    w = np.array([loop.frequency(x) for x in v])

    def angle(at: float) -> float:
        with precise.precision(4 * rational.BITS):
            return float(np.angle(-complex(_value(N, D, flint.arb(loop.axis_point(at)) ** 2))))

    def at(frequency: float) -> Crossing:
        return Crossing(frequency, -complex(np.exp(1j * angle(frequency))))

    worst = at_minus_one or (at(_minimiser(lambda f: abs(angle(f)), w)),)
    if any(c.frequency for c in at_minus_one):
        return worst
    by_delay = [at(_minimiser(lambda f: (angle(f) % (2 * np.pi)) / f, w)), *(c for c in at_ends if c.frequency)]
    return (*worst, min(by_delay, key=lambda c: (float(np.angle(-c.L)) % (2 * np.pi)) / c.frequency))


def _minimiser(f: Callable[[float], float], w: np.ndarray) -> float:
    """Return the minimiser of f near the least of its values on w (k,)."""
    k = int(np.argmin([f(float(v)) for v in w]))
    bounds = (w[max(k - 1, 0)], w[min(k + 1, len(w) - 1)])
    minimum = minimize_scalar(f, bounds=bounds, method="bounded", options={"xatol": 1e-12 * w[k]})
    return float(minimum.x) if minimum.fun <= f(float(w[k])) else float(w[k])
