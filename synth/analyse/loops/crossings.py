"""Gain and phase crossings and least distance to -1 of a rational loop, as zeros of polynomials.

With L = N / D on the axis s = i v, u = v^2 and N conj(D) = R(u) + i v F(u),

    |L| = 1            |N|^2 - |D|^2 = 0
    L real             F = 0; L < 0 where R < 0 as well
    |1 + L| least      d/du (|N + D|^2 / |D|^2) = 0, or at an end

Each is a polynomial in u with integer coefficients. All its positive zeros are isolated, so no crossing is missed,
however close it lies to another or to an end. The value of L at a zero is enclosed by a ball. If |L| = 1 or F = 0 at
all frequencies, only the worst crossings are returned.

Gain and phase crossings and least distance to -1 of a loop with an exact delay and hold.

log L is a sum of terms whose slopes have bounds over an interval of frequencies (`zpk`). The mean value theorem
excludes crossings from some intervals. If log |L| or arg L is monotone over an interval, the values at its ends give
the number of crossings. Any other interval is halved, down to MIN_WIDTH of its frequency; if still undecided, it counts
as a crossing.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

import flint
import numpy as np
from scipy.optimize import brentq, minimize_scalar

from synth.analyse.loops import transfer, zpk
from synth.analyse.loops.transfer import Delayed
from synth.analyse.loops.zpk import MIN_WIDTH, Polynomial, Rational, ZeroPoleGain, on_axis, squared_magnitude
from synth.analyse.numerics import precise
from synth.errors import ModelError
from synth.statespace import Array
from synth.timing import Continuous

CORRECT_BITS = 53  # bits of a value, at least
ZERO_THRESHOLD = 2.0**-200  # a smaller value counts as 0
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

    Raises ModelError if `zpk.MAX_BITS` bits do not resolve a value.
    """
    N, D = loop.lowest_terms
    at_ends = rational_ends(loop)
    gain, phase = (
        tuple(c for c in crossings if low <= c.frequency <= high)
        for crossings in (_gain_crossings(loop, N, D), _phase_crossings(loop, N, D))
    )
    distance, frequency = _least_distance(loop, at_ends, low, high)
    return Crossings(gain, phase, at_ends, 1 / distance if distance else np.inf, frequency)


def rational_ends(loop: Rational) -> dict[float, float]:
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
    R, F = zpk.times_conjugate(N, D)
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
    P, Q = squared_magnitude(N + D), squared_magnitude(D)
    stationary = _values_at_zeros(loop, N, D, _without_common_zeros(P.derivative() * Q - P * Q.derivative(), Q))
    inside = [c for c in stationary if low <= c.frequency <= high] + _crossings_at_limits(loop, N, D, low, high)
    return min(candidates + [(abs(1 + c.L), c.frequency) for c in inside])


def _crossings_at_limits(loop: Rational, N: Polynomial, D: Polynomial, low: float, high: float) -> list[Crossing]:
    """Return L at the limits other than 0 and infinity, unless it has a pole there."""
    limits = [w for w in (low, high) if 0 < loop.axis_point(w) < np.inf]
    with precise.precision(4 * zpk.BITS):
        at = [_value(N, D, flint.arb(loop.axis_point(w)) ** 2) for w in limits]
    return [Crossing(w, complex(L)) for w, L in zip(limits, at, strict=True) if L.is_finite()]


def _values_at_zeros(loop: Rational, N: Polynomial, D: Polynomial, P: Polynomial) -> tuple[Crossing, ...]:
    """Return L at the positive zeros of P, enclosed to double precision."""
    bits = zpk.BITS
    while bits <= zpk.MAX_BITS:
        points = zpk.positive_zeros(P, bits)
        with precise.precision(bits):
            values = [_value(N, D, u) for u in points]
            if all(_is_resolved(v) for v in values):
                frequencies = [loop.frequency(float(u.sqrt())) for u in points]
                return tuple(Crossing(w, complex(v)) for w, v in zip(frequencies, values, strict=True))
        bits *= 4
    raise ModelError(
        f"{zpk.MAX_BITS} bits do not resolve a crossing of the loop: "
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
    sizes = np.abs(zpk.polynomial_zeros(D))
    at_ends = [Crossing(w, complex(v)) for w, v in rational_ends(loop).items() if w < np.inf]
    at_minus_one = (*_phase_crossings(loop, N, D), *(c for c in at_ends if c.L == -1))
    if not sizes.size:
        return at_minus_one
    v = np.geomspace(1e-3 * sizes[sizes > 0].min(initial=1.0), 1e3 * sizes.max(initial=1.0), POINTS)
    w = np.array([loop.frequency(x) for x in v])

    def angle(at: float) -> float:
        with precise.precision(4 * zpk.BITS):
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


Bounds = Callable[[Array, Array], tuple[Array, Array, Array, Array]]

ROUNDING = 1e-12  # of log |L| and arg L: a zero this near to the end of an interval may lie on it
MOST_INTERVALS = 500_000
LOBE_POINTS = 100  # of the grid, where only lobes are left
LIMIT_TOLERANCE = 1e-5  # of |L| at infinity: the search ends where |L| stays this close above it


def of_delayed_loop(loop: Delayed, model: Rational, low: float | None, high: float | None) -> Crossings:
    """Return the crossings of a loop, whose rational factor is `model`, between two frequencies in rad/s.

    By default, `low` lies where the loop has reached its asymptote, and `high` lies above all crossings that can decide
    a margin.

    Raises ModelError if the delay is too long to trace the loop.
    """
    last = 0.0 if loop.hold_s else abs(rational_ends(model)[np.inf])
    ends = {w: v for w, v in rational_ends(model).items() if w == 0} | {np.inf: -last}  # L circles there
    if model.N.is_zero():
        return Crossings((), (), ends, 1.0, 0.0)
    L = zero_pole_gain(loop, model)
    grid = _with_lobes(L, zpk.frequency_grid(L, low or zpk.lowest_frequency(L)))
    envelope = _envelope(L, grid)

    def last_above(level: float) -> float:
        above = np.flatnonzero(envelope > level)
        return float(grid[min(above[-1] + 1, len(grid) - 1)]) if above.size else float(grid[0])

    phase, top = _delayed_phase_crossings(L, grid, last_above, last, high)
    if is_all_pass(model) and not L.hold_s:  # |L| = 1 everywhere: only L = -1 matters
        gain = phase
    else:
        rates = grid if L.hold_s else zpk.frequency_grid(replace(L, delay_s=0.0), float(grid[0]))  # |L| has no delay
        gain = _delayed_gain_crossings(L, rates, high or (last_above(0.5) if L.hold_s else float(rates[-1])))
    nearest = zpk.least_distance(L, zpk.interval_ends(L, grid, top, turning=True))
    distance, frequency = min([nearest, *((abs(1 + v), w) for w, v in ends.items())])
    at = {w: Crossing(w, complex(L.value(w)[0])) for w in (*gain, *phase)}
    gain, phase = ([w for w in each if np.isfinite(at[w].L)] for each in (gain, phase))  # a pole is no crossing
    peak = 1 / distance if distance else np.inf
    return Crossings(tuple(at[w] for w in gain), tuple(at[w] for w in phase), ends, peak, frequency)


def zero_pole_gain(loop: Delayed, model: Rational) -> ZeroPoleGain:
    """Return the zero-pole-gain form of a loop other than 0, whose rational factor is `model`."""
    return zpk.of_rational(model, loop.delay_s + loop.hold_s / 2, loop.hold_s)


def _delayed_gain_crossings(L: ZeroPoleGain, grid: Array, top: float) -> list[float]:
    """Return the frequencies of |L| = 1, which do not depend on a delay; the zeros of the hold divide the axis."""
    if L.hold_s:
        transfer.check_turns(L.delay_s, top)
    return _zeros(L.log_gain, _log_gain_bounds(L), zpk.interval_ends(L, grid, top, turning=bool(L.hold_s)), np.inf)


def _envelope(L: ZeroPoleGain, w: Array) -> Array:
    """Return |L| with the envelope of the hold's lobes in place of the lobes."""
    hold = np.minimum(1.0, 2 / np.maximum(w * L.hold_s, 1e-300))
    return np.asarray(np.exp(np.minimum(replace(L, hold_s=0.0).log_gain(w), 700.0)) * hold)


def _with_lobes(L: ZeroPoleGain, grid: Array) -> Array:
    """Return the grid up to where the hold's lobes stay below |L| = 1/2.

    Above the grid the loop without its hold does not rise any more, and the envelope falls at least as 1/w.
    """
    factor = 2 * float(_envelope(L, grid[-1:])[0])
    if not L.hold_s or factor <= 1 or L.signs.sum() > 0:
        return grid
    return np.concatenate([grid, np.geomspace(grid[-1], factor * grid[-1], LOBE_POINTS)[1:]])


def _delayed_phase_crossings(
    L: ZeroPoleGain, grid: Array, last_above: Callable[[float], float], last: float, high: float | None
) -> tuple[list[float], float]:
    """Return the frequencies of L < 0 and their upper limit; above it |L| stays below its largest value < 1 at them."""
    top = high or max(last_above(last + transfer.LIMIT_TOLERANCE), 4 * np.pi / L.delay_s)
    while True:
        transfer.check_turns(L.delay_s, top)
        nodes = zpk.interval_ends(L, grid, top, turning=True)
        crossings = _zeros(lambda w: L.phase(w) - np.pi, _phase_bounds(L), nodes, 2 * np.pi)
        gains = np.exp(L.log_gain(np.array(crossings))) if crossings else np.zeros(0)
        further = last_above(max(float(gains[gains < 1].max(initial=0.0)), last * (1 + LIMIT_TOLERANCE)))
        if high or further <= top:
            return crossings, top
        top = further


def _log_gain_bounds(L: ZeroPoleGain) -> Bounds:
    def bounds(a: Array, b: Array) -> tuple[Array, Array, Array, Array]:
        slope, range_ = L.log_gain_slope(a, b), L.log_gain_bounds(a, b)
        low, high = _mean_value(L.log_gain((a + b) / 2), (b - a) / 2, *slope)
        return np.maximum(low, range_[0]), np.minimum(high, range_[1]), *slope

    return bounds


def _phase_bounds(L: ZeroPoleGain) -> Bounds:
    def bounds(a: Array, b: Array) -> tuple[Array, Array, Array, Array]:
        slope = L.phase_slope(a, b)
        return *_mean_value(L.phase((a + b) / 2) - np.pi, (b - a) / 2, *slope), *slope

    return bounds


def _mean_value(middle: Array, half: Array, low: Array, high: Array) -> tuple[Array, Array]:
    spread = half * np.maximum(np.abs(low), np.abs(high))
    return middle - spread, middle + spread


def _zeros(f: Callable[[Array], Array], bounds: Bounds, nodes: Array, period: float) -> list[float]:
    """Return the zeros of f modulo `period`, or of f itself if the period is inf, between the nodes."""
    a, b = nodes[:-1], nodes[1:]
    zeros: list[float] = []
    while a.size:
        if len(a) > MOST_INTERVALS:
            raise ModelError(
                "the loop stays so close to |L| = 1 or to the negative axis that its crossings cannot be separated in "
                "double precision: change its gain a little"
            )
        low, high, slope_low, slope_high = bounds(a, b)
        low, high = low - ROUNDING * (1 + np.abs(low)), high + ROUNDING * (1 + np.abs(high))
        may_cross = (low <= 0) & (high >= 0) if np.isinf(period) else np.floor(high / period) >= np.ceil(low / period)
        monotone = (slope_low > 0) | (slope_high < 0)
        narrow = b - a <= MIN_WIDTH * b
        for x, y in zip(a[may_cross & monotone], b[may_cross & monotone], strict=True):
            zeros += _zeros_of_monotone(f, float(x), float(y), period)
        zeros += [float(v) for v in ((a + b) / 2)[may_cross & narrow & ~monotone]]
        a, b = a[may_cross & ~monotone & ~narrow], b[may_cross & ~monotone & ~narrow]
        middle = (a + b) / 2
        a, b = np.concatenate([a, middle]), np.concatenate([middle, b])
    return _distinct(sorted(zeros))


def _zeros_of_monotone(f: Callable[[Array], Array], a: float, b: float, period: float) -> list[float]:
    """Return the zeros modulo `period` of a function that is monotone between a and b.

    The ends are moved just inside, because f may jump there; a zero on an end then shows within ROUNDING of it.
    """
    a, b = a * (1 + 4e-16), b * (1 - 4e-16)
    at_a, at_b = map(float, f(np.array([a, b])))
    slack = ROUNDING * (1 + max(abs(at_a), abs(at_b)))
    low, high = min(at_a, at_b) - slack, max(at_a, at_b) + slack
    levels = [0.0] if np.isinf(period) else period * np.arange(np.ceil(low / period), np.floor(high / period) + 1)
    return [_root(f, a, b, at_a - level, at_b - level, level) for level in levels if low <= level <= high]


def _root(f: Callable[[Array], Array], a: float, b: float, at_a: float, at_b: float, level: float) -> float:
    """Return the point between a and b with f = level, or the closer end if the level lies just beyond it."""
    if at_a * at_b >= 0:
        return a if abs(at_a) <= abs(at_b) else b
    return float(brentq(lambda w: float(f(np.array([w]))[0] - level), a, b, xtol=1e-300, rtol=1e-14))


def _distinct(w: list[float]) -> list[float]:
    """Return sorted frequencies without duplicates of one crossing."""
    return [v for k, v in enumerate(w) if k == 0 or v - w[k - 1] > 4 * MIN_WIDTH * v]
