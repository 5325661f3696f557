"""Polynomial surrogate of a function of one variable: the cheapest one with a certified relative error.

    |p(x) - f(x)| <= eps |f(x)|    for every x of the scalar type in [low, high], including all rounding

The degree is the smallest for which some centre of expansion gives a certificate. For each degree the candidate centres
are sorted by estimated error (of a sample in float32, of a rounding bound in float64), and the first that is certified
is the result. Odd and even functions become polynomials in x^2.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from decimal import ROUND_CEILING, Context, Decimal

import flint
import numpy as np
from numpy.typing import NDArray

from synth.analyse.numerics.precise import precision
from synth.emit.approx import certificate, enclosure, polynomial
from synth.emit.approx.enclosure import Analytic, Enclosure
from synth.emit.approx.polynomial import Polynomial, Scalars
from synth.errors import EmitError

EPS: dict[type[np.floating], float] = {np.float32: 2e-7, np.float64: 1e-14}
EXPONENTS: dict[type[np.floating], int] = {np.float32: 96, np.float64: 960}  # largest |exponent| of a coefficient
DEGREE = 24
POINTS = 16 * (DEGREE + 1)  # at least 16 in each oscillation of the error
STEPS: dict[type[np.floating], int] = {np.float32: 6, np.float64: 4}  # up to 2^STEPS centres, each of few bits
SAMPLES = (64, 1024)  # pieces of the range, and values in each
NEGLIGIBLE = flint.arb(2) ** -100
FAR = 8
TRIALS = 3  # certificates attempted for one degree: if these fail, the others fail too
ROUNDING = 64  # if the approximation error is below eps / 64 and no certificate holds, more terms do not help


@dataclass(frozen=True, eq=False)
class _Task:
    """An approximation problem: `values` of g at points y in [-1, 1], scaled x or x^2; a sample of x and f at it."""

    low: float
    high: float
    scalar: type[np.floating]
    what: str
    g: Enclosure
    y: Sequence[flint.arb]
    x: Sequence[flint.arb]
    values: Sequence[flint.arb]
    sample: Scalars
    truth: NDArray[np.float64]
    like: Polynomial | None


def fit(
    f: Analytic,
    low: float,
    high: float,
    scalar: type[np.floating],
    eps: float | None = None,
    what: str = "function",
    like: Polynomial | None = None,
) -> Polynomial:
    """Return a polynomial for f, called `what`, on [low, high]; `eps` defaults to 2e-7 in float32, 1e-14 in float64.

    With `like` it is a polynomial in the same t as `like`. f satisfies the contract of `enclosure`.

    Raises EmitError for ends that are not two increasing numbers of the type, if f is not analytic in the range and
    around it or has a zero there other than a simple one at x = 0, and if no degree up to 24 achieves eps.
    """
    allowed = EPS.get(scalar, 0.0) if eps is None else eps
    low, high = float(low), float(high)
    _check(low, high, scalar, allowed, what)
    with precision(enclosure.BITS):
        return _search(_task(f, low, high, scalar, what, like), allowed)


def least_degree(
    f: Analytic, low: float, high: float, scalar: type[np.floating], eps: float | None = None, what: str = "function"
) -> int:
    """Return the smallest degree of a polynomial, without rounding, within `eps` of f; arguments as for `fit`.

    Raises EmitError as `fit`.
    """
    allowed = EPS.get(scalar, 0.0) if eps is None else eps
    _check(low, high, scalar, allowed, what)
    with precision(enclosure.BITS):
        task = _task(f, low, high, scalar, what, None)
        for n in range(_max_terms(task.g)):
            if polynomial.fit(task.y, task.values, n).error <= allowed:
                return (n if task.g.parity == "none" else 2 * n) + task.g.power
    raise EmitError(
        f"{what}: no polynomial of degree up to {DEGREE} comes within {allowed:.2g} of it; "
        "narrow the range or keep the library function"
    )


def _check(low: float, high: float, scalar: type[np.floating], allowed: float, what: str) -> None:
    if scalar not in EPS:
        raise EmitError(f"{what}: found the scalar type {scalar.__name__}, need float32 or float64")
    exact = np.isfinite([low, high]).all() and all(float(scalar(v)) == v for v in (low, high))
    if not exact or not low < high:
        raise EmitError(
            f"{what}: found the range [{low!r}, {high!r}], need two rising ends that are exact in {scalar.__name__}; "
            "round them"
        )
    if not 0 < allowed < 1:
        raise EmitError(f"{what}: found an allowed relative error of {allowed:g}, need one above 0 and below 1")


def _task(f: Analytic, low: float, high: float, scalar: type[np.floating], what: str, like: Polynomial | None) -> _Task:
    g = enclosure.enclose(f, low, high, what)
    y = [-(flint.arb(k) / POINTS).cos_pi().mid() for k in range(POINTS + 1)]
    x = [g.middle + g.radius * v if g.parity == "none" else g.high * ((1 + v) / 2).sqrt() for v in y]
    sample, truth = _sample(g, low, high) if scalar is np.float32 else (np.zeros(0), np.zeros(0))
    return _Task(low, high, scalar, what, g, y, x, [v.mid() for v in g.at(x)], sample, truth, like)


def _sample(g: Enclosure, low: float, high: float) -> tuple[Scalars, NDArray[np.float64]]:
    """Return floats spread over the range, 0 left out, and f there."""
    pieces, count = SAMPLES
    half = (high - low) / (2 * pieces)
    parts = []
    for k in range(pieces):
        middle = low + (2 * k + 1) * half
        x = (middle + half * ((2 * np.arange(count) + 1) / count - 1)).astype(np.float32)
        x = x[x != 0]
        parts.append((x, certificate.reference_values(g, x)[0]))
    return np.concatenate([x for x, _ in parts]), np.concatenate([v for _, v in parts])


def _search(task: _Task, allowed: float) -> Polynomial:
    """Return the first polynomial that is certified, for increasing degrees."""
    approximation, closest = np.inf, Polynomial(task.low, task.high, 0.0, 1.0, "none", (0.0,), task.scalar)
    for n in range(_max_terms(task.g)):
        best = polynomial.fit(task.y, task.values, n)
        approximation = min(approximation, best.error)
        if best.error > allowed:
            continue
        for p in sorted(_candidates(task, best.series), key=lambda p: p.max_relative_error)[:TRIALS]:
            if p.max_relative_error <= allowed:
                p = _certify(p, task.g, allowed)
            if p.max_relative_error <= allowed:
                return p
            closest = min(closest, p, key=lambda p: p.max_relative_error)
        if best.error * ROUNDING < allowed:
            break
    reached = f"; with rounding within {closest.max_relative_error:.3g} (degree {closest.degree})"
    if not np.isfinite(closest.max_relative_error):
        reached = "; their coefficients leave the type" if approximation <= allowed else ""
    raise EmitError(
        f"{task.what} on [{task.low:.9g}, {task.high:.9g}] in {task.scalar.__name__}: polynomials of degree up to "
        f"{DEGREE} come within {approximation:.2g} of it{reached}; need {allowed:.2g}: allow more, narrow the range or "
        "keep the library function"
    )


def _max_terms(g: Enclosure) -> int:
    return (DEGREE - g.power) // (1 if g.parity == "none" else 2) + 1


def _candidates(task: _Task, series: flint.arb_poly) -> list[Polynomial]:
    """Return the rounded polynomial about each centre, with an estimate of its error; the one without centre first."""
    width = task.high - task.low
    # Far from 0 the terms of a polynomial in x itself cancel.
    centres = [0.0] if max(-task.low, task.high) <= FAR * width else []
    if task.g.parity == "none" and not task.g.power:
        # Multiples of a power of two: x - centre is then mostly exact.
        step = 2.0 ** (math.frexp(width)[1] - STEPS[task.scalar])
        steps = range(math.floor(task.low / step), math.ceil(task.high / step) + 1)
        centres += [float(task.scalar(k * step)) for k in steps]
    centres = [task.like.centre] if task.like else centres
    polynomials = [_fit_about_centre(task, series, c) for c in dict.fromkeys(centres)]
    return [_with_error_estimate(p, task) for p in polynomials if p is not None]


def _fit_about_centre(task: _Task, series: flint.arb_poly, centre: float) -> Polynomial | None:
    """Expand the fit about a centre and round it; if coefficients would leave the type's range, scale t to [-1, 1].

    Return None if they leave it even then.
    """
    g, even = task.g, task.g.parity != "none"
    half_width = max(abs(task.low - centre), abs(task.high - centre))
    subset = slice(None, None, POINTS // (2 * (DEGREE + 1)))
    for scale in (task.like.scale,) if task.like else (1.0, 2.0 ** -math.frexp(half_width)[1]):
        # y = shift + slope v, where v is the variable of the program: t or t^2
        shift = flint.arb(-1) if even else (centre - g.middle) / g.radius
        slope = 2 / (g.high * scale) ** 2 if even else 1 / (g.radius * scale)
        v = [(y - shift) / slope for y in task.y[subset]]
        values = [value / scale**g.power for value in task.values[subset]]
        c = [term / scale**g.power for term in series(flint.arb_poly([shift, slope])).coeffs()]
        c = _without_negligible(
            c, flint.arb(half_width * scale) ** (2 if even else 1), max(map(abs, values), key=float)
        )
        if all(_fits(term, task.scalar) for term in c):
            coefficients = polynomial.round_coefficients(c, v, values, task.scalar)
            vanishing = (0.0,) if g.power and not even else ()
            return Polynomial(task.low, task.high, centre, scale, g.parity, vanishing + coefficients, task.scalar)
    return None


def _without_negligible(c: Sequence[flint.arb], bound: flint.arb, largest: flint.arb) -> list[flint.arb]:
    """Return the coefficients with 0 in place of those that are negligible for |v| <= bound."""
    return [flint.arb(0) if abs(term) * bound**k < NEGLIGIBLE * largest else term for k, term in enumerate(c)]


def _fits(c: flint.arb, scalar: type[np.floating]) -> bool:
    return c == 0 or abs(math.frexp(float(c))[1]) <= EXPONENTS[scalar]


def _with_error_estimate(p: Polynomial, task: _Task) -> Polynomial:
    """Return the polynomial with an estimate of its error, to two digits, so that the order decides near ties.

    float32: the largest error in the sample. float64: the largest rounding bound at some of the points.
    """
    if p.scalar is np.float32:
        error = float(np.max(np.abs(p.evaluate(task.sample) / task.truth - 1)))
    else:
        points = list(zip(task.x, task.values, strict=True))[:: POINTS // 20]
        error = max(float(polynomial.rounding_bound(p, x, task.g.power) / abs(v)) for x, v in points)
    return replace(p, max_relative_error=_round_up(error))


def _certify(p: Polynomial, g: Enclosure, allowed: float) -> Polynomial:
    bound = certificate.certify(p, g, allowed)
    error = bound.max_relative_error
    return replace(
        p,
        max_relative_error=min(_round_up(error), allowed) if error <= allowed else error,
        checked_values=bound.checked_values,
    )


def _round_up(value: float) -> float:
    """Round up to two digits; NaN and infinity become inf."""
    if not np.isfinite(value):
        return np.inf
    return float(Context(prec=2, rounding=ROUND_CEILING).create_decimal(Decimal(value)))
