"""Where a rational loop crosses |L| = 1 and L < 0, and where it comes nearest to -1, as zeros of polynomials.

With L = N / D on the axis s = i v, u = v^2 and N conj(D) = R(u) + i v F(u),

    |L| = 1            |N|^2 - |D|^2 = 0
    L real             F = 0, where R < 0 it is negative
    |1 + L| least      d/du (|N + D|^2 / |D|^2) = 0, or at an end

Each is a polynomial in u with integer coefficients. All its positive zeros are isolated, so that no crossing is missed
however close it lies to another or to an end, and a value at a zero is enclosed by a ball. The least |1 + L| of
an order above SMALL is found by branch and bound (`factors.nearest`). Where |L| = 1 or F = 0 at
all frequencies, the crossings returned are the worst of them.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import flint
import numpy as np
from scipy.optimize import minimize_scalar

from synth.analyse import factors, precise, rational
from synth.analyse.rational import Polynomial, Rational, on_axis, square
from synth.errors import ModelError
from synth.timing import Continuous

RESOLVED = 53  # bits of a value, at least
NOTHING = 2.0**-200  # a value below it is 0
SMALL = 12  # order up to which the least |1 + L| is found by the zeros of a polynomial of twice that degree
POINTS = 2000  # on which the worst of a stretch with |L| = 1 is sought


@dataclass(frozen=True)
class Crossing:
    """L at `frequency` rad/s."""

    frequency: float
    L: complex


@dataclass(frozen=True, eq=False)
class Course:
    """Crossings of |L| = 1 and of L < 0, by rising frequency, L at the `ends` where it is finite, and max |1/(1 + L)|.

    `ends` maps 0 and pi/T or inf to L.
    """

    unit: tuple[Crossing, ...]
    negative: tuple[Crossing, ...]
    ends: Mapping[float, float]
    peak: float
    peak_frequency: float


def of_rational(loop: Rational, low: float, high: float) -> Course:
    """Return the course of a loop between two frequencies in rad/s, of which `ends` lie outside.

    Raises ModelError where a value is not resolved by `rational.MOST_BITS` bits.
    """
    N, D = loop.reduced
    at_ends = ends(loop)
    unit, negative = _unit(loop, N, D), _negative(loop, N, D)
    inside = [tuple(c for c in found if low <= c.frequency <= high) for found in (unit, negative)]
    least, where = _nearest(loop, at_ends, low, high)
    return Course(inside[0], inside[1], at_ends, 1 / least if least else np.inf, where)


def ends(loop: Rational) -> dict[float, float]:
    """Return L at w = 0 and at Nyquist or infinity, where it has no pole there."""
    N, D = loop.reduced
    order = max(N.degree(), D.degree())
    last = np.inf if isinstance(loop.time, Continuous) else np.pi / loop.time.period_s
    pairs = {0.0: (N[0], D[0]), last: (N[order], D[order])}
    return {w: int(n) / int(d) for w, (n, d) in pairs.items() if d != 0}


def _unit(loop: Rational, N: Polynomial, D: Polynomial) -> tuple[Crossing, ...]:
    difference = square(N) - square(D)
    if difference.degree() >= 0:
        return _resolved(loop, N, D, difference)
    return _worst_of_all_pass(loop, N, D)


def _negative(loop: Rational, N: Polynomial, D: Polynomial) -> tuple[Crossing, ...]:
    R, F = rational.product(N, D)
    magnitude = square(D)
    if F.degree() >= 0:
        found = _resolved(loop, N, D, _without(F, square(N) * magnitude))
    else:  # L is real all along: where its size is 1 or turns
        turning = R.derivative() * magnitude - R * magnitude.derivative()
        found = _resolved(loop, N, D, _without(turning * (square(N) - magnitude), square(N) * magnitude))
    return tuple(c for c in found if c.L.real < 0)


def _without(P: Polynomial, factor: Polynomial) -> Polynomial:
    """Return P without the zeros that it has in common with a factor: there L is 0 or has a pole."""
    common = P.gcd(factor)
    while common.degree() > 0 and not P.is_zero():
        P = P // common
        common = P.gcd(common)
    return P


def _nearest(loop: Rational, ends: Mapping[float, float], low: float, high: float) -> tuple[float, float]:
    """Return the least |1 + L| and where it is."""
    N, D = loop.reduced
    candidates = [(abs(1 + v), w) for w, v in ends.items()]
    if D.degree() <= SMALL:
        P, Q = square(N + D), square(D)
        turning = _resolved(loop, N, D, _without(P.derivative() * Q - P * Q.derivative(), Q))
        found = [c for c in turning if low <= c.frequency <= high] + _limits(loop, N, D, low, high)
        return min(candidates + [(abs(1 + c.L), c.frequency) for c in found])
    L = factors.of_rational(loop)
    slowest = float(np.abs(loop.closed[loop.closed != 0]).min(initial=np.inf))
    start = loop.position(low) if low else min(factors.start(L), factors.BELOW * slowest)
    grid = factors.grid(L, start, loop.closed)
    top = loop.position(high) if np.isfinite(high) else float(grid[-1])
    least, v = factors.nearest(L, factors.nodes(L, grid, top, turning=False))
    return min([*candidates, (least, loop.frequency(v))])


def _limits(loop: Rational, N: Polynomial, D: Polynomial, low: float, high: float) -> list[Crossing]:
    """Return L at limits other than 0 and infinity where it has no pole."""
    limits = [w for w in (low, high) if 0 < loop.position(w) < np.inf]
    with precise.precision(4 * rational.BITS):
        at = [_value(N, D, flint.arb(loop.position(w)) ** 2) for w in limits]
    return [Crossing(w, complex(L)) for w, L in zip(limits, at, strict=True) if L.is_finite()]


def _resolved(loop: Rational, N: Polynomial, D: Polynomial, P: Polynomial) -> tuple[Crossing, ...]:
    """Return L at the positive zeros of P, enclosed to double precision."""
    bits = rational.BITS
    while bits <= rational.MOST_BITS:
        with precise.precision(bits):
            points = sorted((root.real for root, _ in rational.roots(P) if root.imag == 0 and root.real > 0), key=float)
            values = [_value(N, D, u) for u in points]
            if all(_is_resolved(v) for v in values):
                frequencies = [loop.frequency(float(u.sqrt())) for u in points]
                return tuple(Crossing(w, complex(v)) for w, v in zip(frequencies, values, strict=True))
        bits *= 4
    raise ModelError(
        f"a crossing of the loop is not resolved by {rational.MOST_BITS} bits: leave out modes that the loop hardly "
        "shows"
    )


def _is_resolved(value: flint.acb) -> bool:
    near = 1 + value
    return all(v.rel_accuracy_bits() >= RESOLVED or abs(v) < NOTHING for v in (value, near))


def _value(N: Polynomial, D: Polynomial, u: flint.arb) -> flint.acb:
    """Return L = (R + i v F) / |D|^2 at u = v^2."""
    v = u.sqrt()
    n, d = (flint.acb(flint.arb_poly(E)(u), v * flint.arb_poly(O)(u)) for E, O in (on_axis(N), on_axis(D)))
    return n / d


def _worst_of_all_pass(loop: Rational, N: Polynomial, D: Polynomial) -> tuple[Crossing, ...]:
    """Return where a loop with |L| = 1 all along has the least phase and the least delay margin."""
    sizes = np.abs(rational.zeros(D))
    nyquist = [Crossing(w, complex(v)) for w, v in ends(loop).items() if v == -1 and 0 < w < np.inf]
    at_minus_one = (*_negative(loop, N, D), *nyquist)
    if at_minus_one or not sizes.size:
        return at_minus_one
    v = np.geomspace(1e-3 * sizes[sizes > 0].min(initial=1.0), 1e3 * sizes.max(initial=1.0), POINTS)
    w = np.array([loop.frequency(x) for x in v])

    def angle(at: float) -> float:
        with precise.precision(4 * rational.BITS):
            return float(np.angle(-complex(_value(N, D, flint.arb(loop.position(at)) ** 2))))

    phase = _least(lambda at: abs(angle(at)), w)
    delay = _least(lambda at: (angle(at) % (2 * np.pi)) / at, w)
    return tuple(Crossing(f, -np.exp(1j * angle(f))) for f in sorted({phase, delay}))


def _least(f: Callable[[float], float], w: np.ndarray) -> float:
    """Return where f is least, near the least of its values on w (k,)."""
    k = int(np.argmin([f(float(v)) for v in w]))
    bounds = (w[max(k - 1, 0)], w[min(k + 1, len(w) - 1)])
    found = minimize_scalar(f, bounds=bounds, method="bounded", options={"xatol": 1e-12 * w[k]})
    return float(found.x) if found.fun <= f(float(w[k])) else float(w[k])
