"""Enclosures: a function of one variable held by a polynomial, with a proved bound of the distance between them.

    f(x) = x^m g(x),    |g(x) - G(z)| <= error,    z = (x - middle) / radius,    low <= x <= high

m = 1 where f vanishes at 0 and 0 is in the range, else m = 0; g has no zero. G interpolates g in N + 1 Chebyshev
points. Where f is analytic and |g| <= M inside the ellipse with foci -1, 1 (in z) and half axes (rho +- 1/rho) / 2, the
interpolant is within 4 M rho^-N / (rho - 1) of g (Trefethen, Approximation Theory and Approximation Practice, theorem
8.2). M comes from ball arithmetic on boxes that cover the ellipse.

What is asked of f: on a ball it returns a ball around all its values, real where the argument is, and one that is not
finite where it is not analytic on all of the ball. python-flint's `log(analytic=True)` and `sqrt(analytic=True)` do so,
and with them atan(w) = (log(1 + iw) - log(1 - iw)) / 2i and asin(w) = -i log(iw + sqrt(1 - w^2)); its own inverse
functions do not. A breach is looked for halfway between the points of interpolation.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Literal

import flint

from synth.errors import EmitError

Analytic = Callable[[flint.acb], flint.acb]
Parity = Literal["none", "even", "odd"]

BITS = 384  # taking G about another point costs 1.3 bits for each of at most MOST coefficients
MAX_POINTS = 160
ACCURACY = flint.arb(2) ** -72  # G is to be this close to g, relative to the least |g|
ELLIPSES = (32, 16, 8, 6, 4.75, 4, 3.5, 3, 2.5, 2, 1.75, 1.5)
SQUARES = 600  # that many are tried to cover an ellipse before f counts as singular in it
_MEND = "narrow the range or keep the library function"


@dataclass(frozen=True, eq=False)
class Enclosure:
    """f(x) = x^power g(x) with |g - G| <= error; G is `series` in z = (x - middle) / radius.

    With a parity, the range is symmetric about 0 and G is even.
    """

    low: flint.arb
    high: flint.arb
    power: int
    parity: Parity
    series: flint.arb_poly
    error: flint.arb

    @property
    def middle(self) -> flint.arb:
        """Return the middle of the range."""
        return (self.low + self.high) / 2

    @property
    def radius(self) -> flint.arb:
        """Return half the length of the range."""
        return (self.high - self.low) / 2

    def at(self, points: Sequence[flint.arb]) -> list[flint.arb]:
        """Return G at points x in the range."""
        return self.series.evaluate([(x - self.middle) / self.radius for x in points], "iter")

    def expansion(self, x: flint.arb, half: flint.arb) -> list[flint.arb]:
        """Return the coefficients b_k of G(x + half w) = sum b_k w^k."""
        return self.series(flint.arb_poly([(x - self.middle) / self.radius, half / self.radius])).coeffs()


def enclose(f: Analytic, low: float, high: float, what: str) -> Enclosure:
    """Enclose f, called `what`, on [low, high]; with a parity, on the smallest symmetric range that holds it.

    Raises EmitError where f is not analytic in or close to the range, is known too coarsely, or has a zero there other
    than a simple one at x = 0.
    """
    vanishes = low <= 0 <= high and f(flint.acb(0)).is_zero()
    parity = _parity(f, low, high, vanishes)
    ends = (low, high) if parity == "none" else (-max(-low, high), max(-low, high))
    enclosure = _interpolate(f, flint.arb(ends[0]), flint.arb(ends[1]), int(vanishes), parity, what)
    check_bound(enclosure, f, what)
    _check_nonzero(enclosure, what)
    return enclosure


def one_norm(coefficients: Sequence[flint.arb]) -> flint.arb:
    """Return the sum of the absolute values: it bounds a polynomial where |w| <= 1."""
    return sum((abs(c) for c in coefficients), flint.arb(0))


def check_bound(enclosure: Enclosure, f: Analytic, what: str) -> None:
    """Compare with f at the ends and halfway between the points of interpolation, where the distance peaks.

    Raises EmitError where the bound does not hold: then f has broken its promise, or the bound is wrong.
    """
    count = (
        enclosure.series.length() + enclosure.series.length() % 2
    )  # an even number of points; the last term may be 0
    points = [enclosure.middle + enclosure.radius * (flint.arb(j) / count).cos_pi().mid() for j in range(count + 1)]
    for x, inside in zip(points, enclosure.at(points), strict=True):
        if x == 0 and enclosure.power:
            continue
        distance = abs(f(flint.acb(x)).real / x**enclosure.power - inside)
        if not distance.lower() <= enclosure.error:
            raise EmitError(
                f"{what}: at {float(x):.9g} its enclosing polynomial is {float(distance):.2g} away, the bound is "
                f"{float(enclosure.error):.2g}; the function must return a ball that is not finite where it is not analytic"
            )


def _parity(f: Analytic, low: float, high: float, vanishes: bool) -> Parity:
    """Guess from values at +-x. No guess is relied on: what is left out of G by it counts as error."""
    if low > 0 or high < 0:
        return "none"
    points = [flint.arb(max(-low, high)) * k / 7 for k in range(1, 8)]
    pairs = [(f(flint.acb(x)).real, f(flint.acb(-x)).real) for x in points]
    if all(abs(a + b) < abs(a) * ACCURACY for a, b in pairs):
        return "odd" if vanishes else "none"
    return "even" if not vanishes and all(abs(a - b) < abs(a) * ACCURACY for a, b in pairs) else "none"


def _interpolate(f: Analytic, low: flint.arb, high: flint.arb, power: int, parity: Parity, what: str) -> Enclosure:
    middle, radius = (low + high) / 2, (high - low) / 2

    def g(z: flint.arb) -> flint.arb:
        x = middle + radius * z
        return f(flint.acb(x)).real / x**power

    least = min((abs(g(z)).lower() for z in (flint.arb(k).sin() for k in range(1, 6))), key=float)
    if not least > 0:
        raise EmitError(f"{_describe(what, low, high)} is not finite, is 0 or not known to a digit somewhere; {_MEND}")
    count, error = _point_count(f, low, high, power, least, what)
    nodes = [(flint.arb(2 * j + 1) / (2 * count)).cos_pi() for j in range(count)]
    balls = flint.arb_poly.interpolate(nodes, [g(z) for z in nodes], "newton").coeffs()
    left_out = [c for k, c in enumerate(balls) if k % 2 and parity != "none"]
    kept = [flint.arb(0) if k % 2 and parity != "none" else c.mid() for k, c in enumerate(balls)]
    error = (error + one_norm(left_out) + one_norm([c.rad() for c in balls])).upper()
    if not error < 4 * ACCURACY * least:
        raise EmitError(
            f"{_describe(what, low, high)} is enclosed to {float(error / least):.2g} of its least value, need "
            f"{float(4 * ACCURACY):.2g}; give its constants exactly, not as wide balls"
        )
    return Enclosure(low, high, power, parity, flint.arb_poly(kept), error)


def _point_count(
    f: Analytic, low: flint.arb, high: flint.arb, power: int, least: flint.arb, what: str
) -> tuple[int, flint.arb]:
    """Return how many points suffice by the best of the ellipses, and the bound with that many."""
    best = (MAX_POINTS + 1, flint.arb(0))
    for rho in map(flint.arb, ELLIPSES):
        largest = _bound_on_ellipse(f, (low + high) / 2, (high - low) / 2, rho)
        if largest is None:
            continue
        # x is at least this far from 0 on the ellipse, and |f / x| is largest on it.
        far = (high - low) / 2 * ((rho + 1 / rho) / 2 - 1)
        factor = 4 * largest / far**power / (rho - 1)
        for count in range(2, best[0], 2):
            if (bound := factor / rho ** (count - 1)) < ACCURACY * least:
                best = (count, bound)
                break
    if best[0] > MAX_POINTS:
        raise EmitError(
            f"{_describe(what, low, high)} is not analytic in the range, has a singularity close by or varies too much; "
            + _MEND
        )
    return best


def _bound_on_ellipse(f: Analytic, middle: flint.arb, radius: flint.arb, rho: flint.arb) -> flint.arb | None:
    """Return a bound of |f| inside the ellipse; None where f is not finite in a square, however small.

    The upper half suffices: f is real on the axis, so that its values below are the conjugates of those above.
    """
    wide, tall = (rho + 1 / rho) / 2, (rho - 1 / rho) / 2
    half = 2.0 ** math.frexp(float(wide))[1] / 16
    squares = [((2 * i + 1) * half, (2 * j + 1) * half, half) for i in range(-8, 8) for j in range(8)]
    largest = flint.arb(0)
    for _ in range(SQUARES):
        if not squares:
            return largest
        x, y, h = squares.pop()
        if (flint.arb(max(abs(x) - h, 0)) / wide) ** 2 + (flint.arb(y - h) / tall) ** 2 > 1:
            continue
        value = abs(f(flint.acb(middle + radius * flint.arb(x, h), radius * flint.arb(y, h)))).upper()
        if value.is_finite():
            largest = value if value > largest else largest
        elif h * 64 < half:
            return None
        else:
            squares += [(x + i * h / 2, y + j * h / 2, h / 2) for i in (-1, 1) for j in (-1, 1)]
    return None


def _check_nonzero(enclosure: Enclosure, what: str) -> None:
    pieces = [(enclosure.middle, enclosure.radius)]
    while pieces:
        x, half = pieces.pop()
        b = enclosure.expansion(x, half)
        if abs(b[0]) > one_norm(b[1:]) + enclosure.error:
            continue
        if half < enclosure.radius / 2**20:
            beside = ", and not just in a simple zero at 0" if enclosure.power else ""
            raise EmitError(
                f"{_describe(what, enclosure.low, enclosure.high)} is 0, or too close to it, near {float(x):.6g}{beside}: no "
                "relative error can be held; keep the library function, or leave the place outside the range"
            )
        pieces += [(x - half / 2, half / 2), (x + half / 2, half / 2)]


def _describe(what: str, low: flint.arb, high: flint.arb) -> str:
    return f"{what} on [{float(low):.9g}, {float(high):.9g}]"
