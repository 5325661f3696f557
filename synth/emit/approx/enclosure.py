"""Chebyshev enclosure (Taylor-model-like): a polynomial and a proved bound of its distance from a function.

    f(x) = x^m g(x),    |g(x) - G(z)| <= error,    z = (x - middle) / radius,    low <= x <= high

m = 1 where f vanishes at 0 and 0 is in the range, else m = 0; g has no zero. G interpolates g in N + 1 Chebyshev
points. If f is analytic and |g| <= M inside the Bernstein ellipse with foci -1, 1 (in z) and half axes
(rho +- 1/rho) / 2, the interpolant is within 4 M rho^-N / (rho - 1) of g (Trefethen, Approximation Theory and
Approximation Practice, theorem 8.2). M comes from ball arithmetic on boxes that cover the ellipse.

Contract of f: for a ball it returns a ball that contains all its values. The result is real for a real argument, and
not finite if f is not analytic on the whole ball. python-flint's `log(analytic=True)` and `sqrt(analytic=True)` satisfy
it, and with them atan(w) = (log(1 + iw) - log(1 - iw)) / 2i and asin(w) = -i log(iw + sqrt(1 - w^2)); python-flint's
inverse functions do not. `check_bound` tests it halfway between the interpolation points.
"""

import functools
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Literal

import flint

from synth.errors import EmitError

Analytic = Callable[[flint.acb], flint.acb]
Parity = Literal["none", "even", "odd"]

BITS = 384  # expanding G about another point costs 1.3 bits for each of at most MAX_POINTS coefficients
MAX_POINTS = 160
ACCURACY = flint.arb(2) ** -72  # required distance of G from g, relative to the smallest |g|
ELLIPSES = (32, 16, 8, 6, 4.75, 4, 3.5, 3, 2.5, 2, 1.75, 1.5)
SQUARES = 600  # limit of the squares that cover an ellipse; beyond it f counts as singular inside
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
    """Enclose f, called `what`, on [low, high]; with a parity, on the smallest symmetric range that contains it.

    The last enclosures are kept: the search of the degree and the fit of a function need the same one.

    Raises EmitError if f is not analytic in or close to the range, is known too coarsely, or has a zero there other
    than a simple one at x = 0.
    """
    return _enclose(f, low, high, what, flint.ctx.prec)


@functools.lru_cache(maxsize=64)
def _enclose(f: Analytic, low: float, high: float, what: str, bits: int) -> Enclosure:
    """Enclose f as `enclose` does; `bits`, the precision of ball arithmetic, is only part of the key."""
    vanishes = low <= 0 <= high and f(flint.acb(0)).is_zero()
    parity = _parity(f, low, high, vanishes)
    ends = (low, high) if parity == "none" else (-max(-low, high), max(-low, high))
    enclosure = _interpolate(f, flint.arb(ends[0]), flint.arb(ends[1]), int(vanishes), parity, what)
    check_bound(enclosure, f, what)
    _check_nonzero(enclosure, what)
    return enclosure


def one_norm(coefficients: Sequence[flint.arb]) -> flint.arb:
    """Return the sum of the absolute values, which bounds a polynomial for |w| <= 1."""
    return sum((abs(c) for c in coefficients), flint.arb(0))


def check_bound(enclosure: Enclosure, f: Analytic, what: str) -> None:
    """Compare with f at the ends and halfway between the interpolation points, where the distance is largest.

    Raises EmitError if the bound does not hold: then f violates its contract, or the bound is wrong.
    """
    length = enclosure.series.length()
    count = length + length % 2  # an even number of points; the last coefficient may be 0
    points = [enclosure.middle + enclosure.radius * (flint.arb(j) / count).cos_pi().mid() for j in range(count + 1)]
    for x, inside in zip(points, enclosure.at(points), strict=True):
        if x == 0 and enclosure.power:
            continue
        distance = abs(f(flint.acb(x)).real / x**enclosure.power - inside)
        if not distance.lower() <= enclosure.error:
            raise EmitError(
                f"{what}: at {float(x):.9g} its enclosing polynomial is {float(distance):.2g} away, the bound is "
                f"{float(enclosure.error):.2g}; the function must return a ball that is not finite where it is not "
                "analytic"
            )


def _parity(f: Analytic, low: float, high: float, vanishes: bool) -> Parity:
    """Guess the parity from values at +-x. A wrong guess is safe: the terms that it drops from G count as error."""
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
        raise EmitError(f"{_describe(what, low, high)} is 0, not finite or not known to a digit somewhere; {_MEND}")
    count, error = _point_count(f, low, high, power, least, what)
    nodes = [(flint.arb(2 * j + 1) / (2 * count)).cos_pi() for j in range(count)]
    balls = flint.arb_poly.interpolate(nodes, [g(z) for z in nodes], "newton").coeffs()
    left_out = [c for k, c in enumerate(balls) if k % 2 and parity != "none"]
    coefficients = [flint.arb(0) if k % 2 and parity != "none" else c.mid() for k, c in enumerate(balls)]
    error = (error + one_norm(left_out) + one_norm([c.rad() for c in balls])).upper()
    if not error < 4 * ACCURACY * least:
        raise EmitError(
            f"{_describe(what, low, high)} is enclosed to {float(error / least):.2g} of its least value, need "
            f"{float(4 * ACCURACY):.2g}; give its constants exactly, not as wide balls"
        )
    return Enclosure(low, high, power, parity, flint.arb_poly(coefficients), error)


def _point_count(
    f: Analytic, low: flint.arb, high: flint.arb, power: int, least: flint.arb, what: str
) -> tuple[int, flint.arb]:
    """Return the number of points that suffices by the best of the ellipses, and the error bound for it."""
    best = (MAX_POINTS + 1, flint.arb(0))
    for rho in map(flint.arb, ELLIPSES):
        largest = _bound_on_ellipse(f, (low + high) / 2, (high - low) / 2, rho)
        if largest is None:
            continue
        # On the ellipse |x| is at least `far`, and |f / x| attains its maximum there.
        far = (high - low) / 2 * ((rho + 1 / rho) / 2 - 1)
        factor = 4 * largest / far**power / (rho - 1)
        for count in range(2, best[0], 2):
            if (bound := factor / rho ** (count - 1)) < ACCURACY * least:
                best = (count, bound)
                break
    if best[0] > MAX_POINTS:
        raise EmitError(
            f"{_describe(what, low, high)} is not analytic in the range, has a singularity close by or varies too "
            f"much; {_MEND}"
        )
    return best


def _bound_on_ellipse(f: Analytic, middle: flint.arb, radius: flint.arb, rho: flint.arb) -> flint.arb | None:
    """Return a bound of |f| inside the ellipse; None if f is not finite on some square, however small.

    The upper half suffices: f is real on the axis, so its values below are the conjugates of those above.
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
                f"{_describe(what, enclosure.low, enclosure.high)} is 0, or too close to it, near {float(x):.6g}"
                f"{beside}: no relative error can be held; keep the library function, or exclude the place from the "
                "range"
            )
        pieces += [(x - half / 2, half / 2), (x + half / 2, half / 2)]


def _describe(what: str, low: flint.arb, high: flint.arb) -> str:
    return f"{what} on [{float(low):.9g}, {float(high):.9g}]"
