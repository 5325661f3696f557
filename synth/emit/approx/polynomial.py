"""Polynomial evaluation by Horner's rule in one scalar type, with a bound of its rounding error.

    t = (x - centre) scale        centre 0: no subtraction; scale 1: no multiplication
    p = c_0 + t (c_1 + t (... + t c_n))               parity "none"; c_0 = 0: no addition
    p = c_0 + s (c_1 + s (... + s c_n)),  s = t t     parity "even"
    p = t (c_0 + s (c_1 + ... + s c_n))               parity "odd"

Every operation is rounded to nearest, in this order. A compiler may contract each c + v q into a fused multiply-add.
c - x in place of x - c would give the same magnitudes, because rounding to nearest is symmetric.

Minimax polynomial by the Remez exchange (Sollya `remez`), and rounding of its coefficients to a scalar type.

    minimise  max_i |q(y_i) / g_i - 1|    over q of degree n;    y_i Chebyshev points of [-1, 1], g_i of one sign

At the optimum the error has equal size and alternating sign in n + 2 points (Chebyshev); the Remez exchange finds them.
If each coefficient were rounded on its own, the errors would add up. Here, after each rounding, the coefficients not
yet rounded are fitted again by least squares to compensate. Ball arithmetic makes the result the same on every machine.
"""

import itertools
import operator
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import flint
import numpy as np
from numpy.typing import ArrayLike, NDArray

from synth.emit.approx.enclosure import Parity, one_norm

ROUNDS = 12
LEVEL = 1.02  # the exchange ends when the largest error is within this of the level error


@dataclass(frozen=True, eq=False)
class Fit:
    """A polynomial in y and its largest relative error on the points."""

    series: flint.arb_poly
    error: float


def fit(y: Sequence[flint.arb], g: Sequence[flint.arb], degree: int) -> Fit:
    """Return a near-minimax polynomial of a degree for values g at increasing points y, both exact."""
    last = len(y) - 1
    reference = [round(k * last / (degree + 1)) for k in range(degree + 2)]
    best = Fit(flint.arb_poly([]), np.inf)
    for _ in range(ROUNDS):
        series, level = _solve_on_reference(y, g, reference)
        errors = [float(q / v - 1) for q, v in zip(series.evaluate(list(y), "iter"), g, strict=True)]
        worst = max(map(abs, errors))
        best = Fit(series, worst) if worst < best.error else best
        reference = _peaks(errors, degree + 2)
        if worst <= LEVEL * level or len(reference) < degree + 2:
            break
    return best


def _solve_on_reference(
    y: Sequence[flint.arb], g: Sequence[flint.arb], reference: list[int]
) -> tuple[flint.arb_poly, float]:
    """Solve q(y_i) + (-1)^i e g_i = g_i at the reference points for q and the level error e."""
    count = len(reference) - 1
    rows = [[*_powers(y[i], flint.arb(1), count), g[i] if j % 2 else -g[i]] for j, i in enumerate(reference)]
    solution = flint.arb_mat(rows).solve(flint.arb_mat([[g[i]] for i in reference])).mid().entries()
    return flint.arb_poly(solution[:-1]), abs(float(solution[-1]))


def _peaks(errors: list[float], count: int) -> list[int]:
    """Return the index of the extremum in each interval of one sign; of these, the `count` largest neighbours."""
    peaks: list[int] = []
    for i, e in enumerate(errors):
        if peaks and e * errors[peaks[-1]] > 0:
            peaks[-1] = i if abs(e) > abs(errors[peaks[-1]]) else peaks[-1]
        else:
            peaks.append(i)
    while len(peaks) > count:
        peaks.pop(0 if abs(errors[peaks[0]]) < abs(errors[peaks[-1]]) else -1)
    return peaks


def round_coefficients(
    coefficients: Sequence[flint.arb], v: Sequence[flint.arb], g: Sequence[flint.arb], scalar: type[np.floating]
) -> tuple[float, ...]:
    """Round the coefficients of q(v) to the scalar type, c_0 first, with little change of q / g at the points v.

    With H the inverse of the normal matrix of the free coefficients, a change of c_k by d changes them all by
    H e_k d / H_kk.
    """
    c, n, fixed = list(coefficients), len(coefficients), list[float]()
    basis = flint.arb_mat([_powers(x, 1 / value, n) for x, value in zip(v, g, strict=True)])
    H = (basis.transpose() * basis).inv()
    for k in range(n):
        fixed.append(float(scalar(float(c[k]))))
        pivot, error = H[k, k], fixed[k] - c[k]
        change = [H[j, k] / pivot for j in range(k, n)]
        c[k:] = [a + b * error for a, b in zip(c[k:], change, strict=True)]
        column = flint.arb_mat(n, 1, [flint.arb(0)] * k + change)
        H = (H - column * column.transpose() * pivot).mid()  # c_k is no longer free
    return tuple(fixed)


def _powers(x: flint.arb, first: flint.arb, count: int) -> list[flint.arb]:
    return list(itertools.accumulate([first] + [x] * (count - 1), operator.mul))


Scalars = NDArray[np.floating]
MultiplyAdd = Callable[[Scalars, Scalars, np.floating], Scalars]


@dataclass(frozen=True)
class Polynomial:
    """A polynomial approximation of a function on [low, high]; its numbers are exact in `scalar`.

    `coefficients` are c_0 ... c_n. `scale` is a power of two; it is 1 unless the coefficients would leave the type's
    range.

    The value that C computes is within `max_relative_error` of the function at every x of the type in the range at
    which the function is not subnormal. `checked_values` of these x (with a parity, of these |x|) were checked one by
    one; a proof in ball arithmetic covers the others.
    """

    low: float
    high: float
    centre: float
    scale: float
    parity: Parity
    coefficients: tuple[float, ...]
    scalar: type[np.floating]
    max_relative_error: float = np.inf
    checked_values: int = 0

    @property
    def degree(self) -> int:
        """Return the degree in x."""
        n = len(self.coefficients) - 1
        return {"none": n, "even": 2 * n, "odd": 2 * n + 1}[self.parity]

    def evaluate(self, x: ArrayLike) -> Scalars:
        """Return the values that C computes at x (any shape), with separate rounding of products and sums."""
        return run(self, np.asarray(x, self.scalar), multiply_then_add)

    def enclose(self, x: flint.arb) -> flint.arb:
        """Return a ball that contains every value that C may compute for the ball x, contracted or not."""
        first, *others = expansion(self, x.mid(), x.rad())
        return first + flint.arb(0, (one_norm(others) + rounding_bound(self, x)).upper())


def run(p: Polynomial, x: Scalars, multiply_add: MultiplyAdd) -> Scalars:
    """Return the program's values at x (any shape), with `multiply_add(a, b, c)` for c + a b."""
    c = [p.scalar(v) for v in p.coefficients]
    t = x - p.scalar(p.centre) if p.centre else x
    t = t * p.scalar(p.scale) if p.scale != 1 else t
    v = t if p.parity == "none" else t * t
    q = np.asarray(c[-1]) if len(c) > 1 else np.full_like(x, c[-1])
    for term in c[-2::-1]:
        q = multiply_add(v, q, term) if term else v * q
    return t * q if p.parity == "odd" else q


def multiply_then_add(a: Scalars, b: Scalars, c: np.floating) -> Scalars:
    """Return c + a b, with the product rounded before the sum."""
    total: Scalars = a * b
    total += c
    return total


def fused_multiply_add(a: Scalars, b: Scalars, c: np.floating) -> Scalars:
    """Return c + a b in float32, rounded once.

    The product is exact in double. Rounding the sum to double may produce a false tie between two floats; the double is
    then moved off the tie before it is rounded to float32 (correction of double rounding).
    """
    total = a.astype(np.float64)
    total *= b
    total += np.float64(c)
    tie = (total.view(np.int64) & 0x1FFFFFFF) == 0x10000000
    if tie.any():
        a_b, s = a[tie].astype(np.float64) * np.broadcast_to(b, a.shape)[tie], total[tie]
        c_in_s = s - a_b
        error = (a_b - (s - c_in_s)) + (np.float64(c) - c_in_s)  # of the sum: Knuth's TwoSum
        total[tie] = np.where(error == 0, s, np.nextafter(s, np.copysign(np.inf, error)))
    return total.astype(np.float32)


def expansion(p: Polynomial, x: flint.arb, half: flint.arb, power: int = 0) -> list[flint.arb]:
    """Return the coefficients b_k of p(x + half w) / (x + half w)^power = sum b_k w^k, in exact arithmetic.

    The power may be 1 only for a polynomial with the factor t = scale x.
    """
    t = flint.arb_poly([(x - p.centre) * p.scale, half * p.scale])
    terms = p.coefficients[1:] if power and p.parity == "none" else p.coefficients
    q = flint.arb_poly(list(terms))(t if p.parity == "none" else t * t)
    factor = p.scale if power else t if p.parity == "odd" else 1
    return (q * factor).coeffs() or [flint.arb(0)]


def rounding_bound(p: Polynomial, x: flint.arb, power: int = 0) -> flint.arb:
    """Bound |computed - exact| / |x|^power in the ball x, including the underflow of products.

    With power 1 the last operation is the product with t; its underflow is not included.
    """
    tiny = flint.arb(float(np.finfo(p.scalar).tiny))
    t = (x - p.centre) * p.scale
    dt = _half_ulp(t, p.scalar) if p.centre else flint.arb(0)
    v, dv = (t, dt) if p.parity == "none" else (t * t, _half_ulp(t * t, p.scalar) + tiny)
    first = 1 if power and p.parity == "none" else 0
    q, dq = flint.arb(p.coefficients[-1]), flint.arb(0)
    for c in p.coefficients[-2 : first - len(p.coefficients) - 1 : -1]:
        product, error = v * q, abs(v) * dq + (abs(q) + dq) * dv
        error += _half_ulp(abs(product) + error, p.scalar) + tiny
        q, dq = c + product, error + _half_ulp(abs(c + product) + error, p.scalar)
    last = dq + (abs(q) + dq) * float(np.finfo(p.scalar).eps) / 2
    if power:
        nearest = flint.arb(abs(t).lower())
        half_ulp = _half_ulp(abs(t) * (abs(q) + dq), p.scalar)
        return p.scale * (last if nearest <= 0 else last.min(dq + half_ulp / nearest))
    return abs(t) * last + tiny if p.parity == "odd" else dq


def _half_ulp(size: flint.arb, scalar: type[np.floating]) -> flint.arb:
    """Bound the error of rounding a number of at most this size to nearest: half a unit in its last place."""
    if not size.is_finite():
        return flint.arb("inf")
    mantissa, exponent = abs(size).upper().man_exp()
    if mantissa == 0:
        return flint.arb(0)
    return flint.arb(2) ** (int(exponent) + int(mantissa).bit_length() - 2) * float(np.finfo(scalar).eps)
