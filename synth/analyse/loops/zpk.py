"""Zero-pole-gain form of a scalar loop on the frequency axis, with bounds of log L over intervals.

With the zeros and poles r of a rational loop, its gain k, a delay tau and a hold T,

    log L(i w) = log k +- sum log(i w - r) - i w (tau + T/2) + log(sin(w T/2) / (w T/2)).

Each term and its slope have closed-form bounds over an interval of w. With them, branch and bound finds the least
|1 + L|: on an interval of half width h around w it is at least |1 + L(i w)| - h max |L'|.

Exact transfer function of a scalar loop: a ratio of two polynomials with integer coefficients.

    L = N(s) / D(s)          continuous,
    L = N(z) / D(z)          sampled, with z = (1 + s) / (1 - s): the circle z = exp(i w T) is s = i tan(w T / 2)

A double is an integer times a power of 2. Therefore nothing is rounded, neither the coefficients of a transfer function
nor, for a state-space model,

    D = det(s I - A),        N = det(s I - A + B C) + (d - 1) det(s I - A).

On the axis s = i v, with u = v^2, a polynomial is P(i v) = E(u) + i v O(u). Its zeros are isolated in ball arithmetic.
"""

from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property
from math import gcd
from typing import Any

import flint
import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.optimize import minimize_scalar

from synth.analyse import discretise
from synth.analyse.loops import transfer
from synth.analyse.numerics import precise, sturm
from synth.errors import ModelError
from synth.statespace import Array, Complex, StateSpace, System, coefficients, of
from synth.timing import Continuous, Time

Polynomial = flint.fmpz_poly

BITS = 128  # of each zero; increased if they do not resolve a value
MAX_BITS = 1 << 14
X = flint.fmpz_poly([0, 1])


@dataclass(frozen=True, eq=False)
class Rational:
    """L = N / D in s, without cancellation, with the `model` of the same loop.

    `coefficients` are those of a transfer function, highest powers first; None for a state-space model.
    """

    N: Polynomial
    D: Polynomial
    model: StateSpace
    coefficients: tuple[Array, Array] | None

    @property
    def time(self) -> Time:
        """The model's time."""
        return self.model.time

    @cached_property
    def common(self) -> Polynomial:
        """The common divisor of N and D: the modes that cancel in L."""
        return self.N.gcd(self.D)

    @cached_property
    def lowest_terms(self) -> tuple[Polynomial, Polynomial]:
        """N and D without their common divisor."""
        return self.N // self.common, self.D // self.common

    @cached_property
    def closed_loop_poles(self) -> Complex:
        """The closed-loop poles (n,) in s, including those that cancel in L; inf for a pole at z = -1."""
        N, D = self.lowest_terms
        finite = np.concatenate([polynomial_zeros(N + D), polynomial_zeros(self.common)])
        at_infinity = max(self.N.degree(), self.D.degree()) - len(finite)
        return np.concatenate([finite, np.full(at_infinity, complex(np.inf))])

    @property
    def poles_in_double(self) -> Complex:
        """The closed-loop poles (n,) in s as eigenvalues in double precision, inf for a pole at z = -1."""
        poles = transfer.closed_loop_poles(self.model)
        if isinstance(self.time, Continuous):
            return poles
        at_infinity = poles == -1
        return np.where(at_infinity, np.inf, (poles - 1) / np.where(at_infinity, 1, poles + 1))

    def frequency(self, v: float) -> float:
        """Return w in rad/s of s = i v."""
        return v if isinstance(self.time, Continuous) else 2 / self.time.period_s * float(np.arctan(v))

    def axis_point(self, w: float) -> float:
        """Return v, s = i v, of w in rad/s: inf for Nyquist."""
        if isinstance(self.time, Continuous):
            return w
        nyquist = np.pi / self.time.period_s
        return float(np.tan(w * self.time.period_s / 2)) if w < nyquist else np.inf


def of_system(system: System) -> Rational:
    """Return the exact transfer function of a scalar System; raise SignalError as `statespace.of`."""
    model, fraction = of(system), coefficients(system)
    N, D = _integer_coefficients(*fraction) if fraction else _determinants(model)
    if not isinstance(model.time, Continuous):
        order = max(N.degree(), D.degree())
        N, D = _bilinear(N, order), _bilinear(D, order)
    common = gcd(int(N.content()), int(D.content())) or 1
    N, D = N // common, D // common
    return Rational(N, D, model, fraction)


def _integer_coefficients(b: Array, a: Array) -> tuple[Polynomial, Polynomial]:
    """Return polynomials with coefficients b and a, highest powers first, both times one power of 2."""
    bits = _bits(np.concatenate([b, a]))
    return flint.fmpz_poly(_whole(b[::-1], bits)), flint.fmpz_poly(_whole(a[::-1], bits))


def _bits(values: Array) -> int:
    """Return the least k >= 0 for which all values times 2^k are whole."""
    mantissa, exponent = _mantissas(values)
    lowest = np.frexp((mantissa & -mantissa).astype(np.float64))[1] - 1  # the place of the last 1
    return max(0, int((-exponent - lowest)[mantissa != 0].max(initial=0)))


def _mantissas(values: Array) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Return whole numbers m and exponents e, values = m 2^e."""
    fraction, exponent = np.frexp(values)
    return (fraction * 2.0**53).astype(np.int64), exponent.astype(np.int64) - 53


def _whole(values: Array, k: int) -> list[int]:
    """Return values times 2^k, which are whole."""
    pairs = zip(*(part.ravel().tolist() for part in _mantissas(values)), strict=True)
    return [m << (e + k) if e + k >= 0 else m >> -(e + k) for m, e in pairs]


def _determinants(model: StateSpace) -> tuple[Polynomial, Polynomial]:
    """Return N and D of a model, both times one integer."""
    n = len(model.A)
    scale = discretise.balancing(model.A)
    A, b, c = model.A * scale / scale[:, None], model.B[:, 0] / scale, model.C[0] * scale
    k_b, k_c, d = _bits(b), _bits(c), Fraction(float(model.D[0, 0]))
    k = max(_bits(A.ravel()), k_b + k_c)
    A_whole = flint.fmpz_mat(n, n, _whole(A, k))
    feedback = A_whole - flint.fmpz_mat(n, 1, _whole(b, k - k_c)) * flint.fmpz_mat(1, n, _whole(c, k_c))
    D, closed = _characteristic(A_whole, k), _characteristic(feedback, k)
    return d.denominator * closed + (d.numerator - d.denominator) * D, d.denominator * D


def _characteristic(M: flint.fmpz_mat, k: int) -> Polynomial:
    """Return det(s I - M / 2^k) times 2^(k n), M (n, n)."""
    return flint.fmpz_poly([c << (k * i) for i, c in enumerate(map(int, M.charpoly().coeffs()))])


def _bilinear(P: Polynomial, order: int) -> Polynomial:
    """Return (1 - s)^order P((1 + s) / (1 - s)), as two shifts and a reversal, from z = 2 / (1 - s) - 1."""
    shifted = [int(c) << k for k, c in enumerate(map(int, P(X - 1).coeffs()))]
    padded = shifted + [0] * (order + 1 - len(shifted))
    return flint.fmpz_poly(padded[::-1])(1 - X)


def polynomial_zeros(P: Polynomial) -> Complex:
    """Return the zeros (n,) of a polynomial, repeated by multiplicity."""
    with precise.precision(BITS):
        repeated = [complex(root) for root, count in roots(P) for _ in range(count)]
    return np.array(repeated, dtype=np.complex128)


def roots(P: Polynomial) -> list[tuple[Any, int]]:
    """Return the zeros of a polynomial as balls, each with its multiplicity, in the current precision."""
    isolated: list[Any] = P.complex_roots() if P.degree() > 0 else []
    return [(root, int(count)) for root, count in isolated]


def positive_zeros(P: Polynomial, bits: int) -> list[flint.arb]:
    """Return the distinct positive zeros of a polynomial in rising order as balls, of `bits` or a little less."""
    if (separated := sturm.positive_zeros(P, bits)) is not None:
        return separated
    with precise.precision(bits):
        return sorted((root.real for root, _ in roots(P) if root.imag == 0 and root.real > 0), key=float)


def on_axis(P: Polynomial) -> tuple[Polynomial, Polynomial]:
    """Return E and O, P(i v) = E(u) + i v O(u), u = v^2."""
    c = P.coeffs()
    E, O = (flint.fmpz_poly([-v if k % 2 else v for k, v in enumerate(c[first::2])]) for first in (0, 1))
    return E, O


def squared_magnitude(P: Polynomial) -> Polynomial:
    """Return |P(i v)|^2 in u."""
    E, O = on_axis(P)
    return E * E + X * O * O


def times_conjugate(N: Polynomial, D: Polynomial) -> tuple[Polynomial, Polynomial]:
    """Return the real part of N conj(D) in u, and the imaginary part over v."""
    (En, On), (Ed, Od) = on_axis(N), on_axis(D)
    return En * Ed + X * On * Od, On * Ed - En * Od


def count_unstable(loop: Rational, factor: complex) -> int:
    """Count the zeros of D + (a + i b) N in the closed right half-plane, after cancellation of common factors.

    In a sampled loop each degree below the order is a zero at z = -1, on the boundary.
    """
    N, D = loop.lowest_terms
    order = max(N.degree(), D.degree())
    a, b = Fraction(factor.real), Fraction(factor.imag)
    shift = max(a.denominator, b.denominator)
    real, imaginary = shift * D + int(a * shift) * N, int(b * shift) * N
    at_infinity = 0 if isinstance(loop.time, Continuous) else order - max(real.degree(), imaginary.degree())
    return at_infinity + count_in_right_half_plane(real, imaginary)


def count_in_right_half_plane(real: Polynomial, imaginary: Polynomial) -> int:
    """Return the number of zeros of real + i imaginary in the closed right half-plane."""
    count = sturm.count_right_half_plane(real, imaginary)
    if count is not None:
        return count
    if imaginary.degree() >= 0:
        return sum(not root.real < 0 for root in _complex_roots(real, imaginary))
    with precise.precision(BITS):
        return sum(count for root, count in roots(real) if not root.real < 0)


def _complex_roots(real: Polynomial, imaginary: Polynomial) -> list[flint.acb]:
    """Return the zeros of real + i imaginary, exact coefficients; raise ModelError if they cannot be separated."""
    with precise.precision(max(real.height_bits(), imaginary.height_bits()) + BITS):
        P = flint.acb_poly(real) + flint.acb(0, 1) * flint.acb_poly(imaginary)
        try:
            return list(P.roots(tol=flint.arb(2) ** -(BITS // 2), maxprec=MAX_BITS)) if P.degree() > 0 else []
        except ValueError as error:
            raise ModelError("the poles of the loop closed with a phase change cannot be separated") from error


MIN_WIDTH = 1e-12  # of a frequency: the least width of an interval
BOUND_TOLERANCE = 1e-5  # of the least |1 + L|: tolerance of branch and bound
LOW_ASYMPTOTE = 1e-3  # of the least of all rates: below it the loop is its asymptote
HIGH_ASYMPTOTE = 1e3  # times the largest of all rates: above it the loop is its asymptote
GRID = 400  # intervals to begin with


@dataclass(frozen=True, eq=False)
class ZeroPoleGain:
    """log L: zeros (sign +1) and poles (sign -1) `roots` (m,), their `signs` (m,), log |k|, arg k, and times in s."""

    roots: NDArray[np.complex128]
    signs: Array
    log_k: float
    arg_k: float
    delay_s: float
    hold_s: float

    def log_gain(self, w: Array) -> Array:
        """Return log |L| at frequencies (k,)."""
        with np.errstate(divide="ignore"):
            distance = np.log(np.abs(1j * w[:, None] - self.roots))
            held = np.log(np.abs(np.sinc(w * self.hold_s / (2 * np.pi))))
        return np.asarray(self.log_k + distance @ self.signs + held)

    def phase(self, w: Array) -> Array:
        """Return arg L at frequencies (k,), continuous except at roots on the axis and zeros of the hold."""
        c, x = -self.roots.real, w[:, None] - self.roots.imag
        acute = np.arctan2(x, np.abs(c))
        angles = np.where(c < 0, np.pi - acute, acute)
        lobes = np.floor(w * self.hold_s / (2 * np.pi))
        return np.asarray(self.arg_k + angles @ self.signs - w * self.delay_s + np.pi * lobes)

    def value(self, frequencies: ArrayLike) -> NDArray[np.complex128]:
        """Return L at frequencies (k,)."""
        w = np.atleast_1d(np.asarray(frequencies, dtype=np.float64))
        return np.asarray(np.exp(self.log_gain(w) + 1j * self.phase(w)))

    def phase_slope(self, a: Array, b: Array) -> tuple[Array, Array]:
        """Return bounds (k,) of d arg L / dw over intervals a .. b."""
        c, near, far = -self.roots.real, *self._distances(a, b)
        with np.errstate(divide="ignore", invalid="ignore"):
            ends = [np.where(c == 0, 0.0, self.signs * c / (c * c + x * x)) for x in (near, far)]
        low, high = np.minimum(*ends).sum(axis=1), np.maximum(*ends).sum(axis=1)
        return low - self.delay_s, high - self.delay_s

    def log_gain_slope(self, a: Array, b: Array) -> tuple[Array, Array]:
        """Return bounds (k,) of d log |L| / dw over intervals a .. b that have no root on the axis inside."""
        c, x = np.abs(self.roots.real), np.stack([v[:, None] - self.roots.imag for v in (a, b)])
        with np.errstate(divide="ignore", invalid="ignore"):
            ends = np.where((c == 0) & (x == 0), np.array([np.inf, -np.inf])[:, None, None], x / (c * c + x * x))
            turn = np.where(c > 0, 1 / (2 * c), np.inf)
        low, high = ends.min(axis=0), ends.max(axis=0)
        high = np.where((x[0] < c) & (c < x[1]), turn, high)
        low = np.where((x[0] < -c) & (-c < x[1]), -turn, low)
        rising, falling = self.signs > 0, self.signs < 0
        below = low[:, rising].sum(axis=1) - high[:, falling].sum(axis=1)
        above = high[:, rising].sum(axis=1) - low[:, falling].sum(axis=1)
        held = self._hold_slope(a, b)
        return below + held[0], above + held[1]

    def log_gain_bounds(self, a: Array, b: Array) -> tuple[Array, Array]:
        """Return bounds (k,) of log |L| over intervals a .. b, from a bound of each factor."""
        near, far = self._distances(a, b)
        c = self.roots.real
        with np.errstate(divide="ignore"):
            low, high = (np.log(np.hypot(c, x)) for x in (near, far))
        rising, falling = self.signs > 0, self.signs < 0
        below = low[:, rising].sum(axis=1) - high[:, falling].sum(axis=1)
        above = high[:, rising].sum(axis=1) - low[:, falling].sum(axis=1)
        held = self._hold_bounds(a, b)
        return self.log_k + below + held[0], self.log_k + above + held[1]

    def _distances(self, a: Array, b: Array) -> tuple[Array, Array]:
        low, high = a[:, None] - self.roots.imag, b[:, None] - self.roots.imag
        near = np.where(low > 0, low, np.where(high < 0, -high, 0.0))
        return near, np.maximum(np.abs(low), np.abs(high))

    def _hold_slope(self, a: Array, b: Array) -> tuple[Array, Array]:
        """Return bounds of d log |sin x / x| / dw: cot x falls over each lobe; no interval extends over two lobes."""
        if not self.hold_s:
            return np.zeros(len(a)), np.zeros(len(a))
        x, y = self._inside_lobe(a, b)
        with np.errstate(divide="ignore", invalid="ignore"):
            low = np.where(y % np.pi == 0, -np.inf, 1 / np.tan(y)) - 1 / x
            high = 1 / np.tan(x) - 1 / y
        return low * self.hold_s / 2, high * self.hold_s / 2

    def _hold_bounds(self, a: Array, b: Array) -> tuple[Array, Array]:
        if not self.hold_s:
            return np.zeros(len(a)), np.zeros(len(a))
        x, y = self._inside_lobe(a, b)
        top = (np.floor(x / np.pi) + 0.5) * np.pi
        largest = np.where((x < top) & (top < y), 1.0, np.maximum(np.abs(np.sin(x)), np.abs(np.sin(y))))
        with np.errstate(divide="ignore"):
            low = np.log(np.minimum(np.abs(np.sin(x)), np.abs(np.sin(y))) / y)
            return low, np.minimum(np.log(largest / x), 0.0)

    def _inside_lobe(self, a: Array, b: Array) -> tuple[Array, Array]:
        return a * self.hold_s / 2 * (1 + 1e-15), b * self.hold_s / 2 * (1 - 1e-15)


def of_rational(loop: Rational, delay_s: float = 0.0, hold_s: float = 0.0) -> ZeroPoleGain:
    """Return the zero-pole-gain form of a rational loop other than 0.

    `delay_s` is its total delay, including half of its hold of `hold_s` seconds.
    """
    N, D = loop.lowest_terms
    zeros, poles = polynomial_zeros(N), polynomial_zeros(D)
    k = int(N[N.degree()]) / int(D[D.degree()])
    signs = np.concatenate([np.ones(len(zeros)), -np.ones(len(poles))])
    return ZeroPoleGain(np.concatenate([zeros, poles]), signs, float(np.log(abs(k))), np.pi * (k < 0), delay_s, hold_s)


def lowest_frequency(L: ZeroPoleGain) -> float:
    """Return a frequency below which the loop is its asymptote and |L| does not cross 1."""
    sizes = np.abs(L.roots)
    rates = [float(sizes[sizes > 0].min(initial=np.inf)), 1 / L.delay_s if L.delay_s else np.inf]
    lowest = LOW_ASYMPTOTE * (min(rates) if np.isfinite(min(rates)) else 1.0)
    slope = float(L.signs[sizes == 0].sum())
    if not slope:
        return lowest
    return min(lowest, lowest * float(np.exp(-L.log_gain(np.array([lowest]))[0] / slope)) / 10)


def frequency_grid(L: ZeroPoleGain, low: float) -> Array:
    """Return frequencies from `low` up to one above which the loop without its hold is its asymptote and |L| != 1."""
    sizes = np.abs(L.roots)
    top = max(
        HIGH_ASYMPTOTE * float(sizes.max(initial=0.0)),
        HIGH_ASYMPTOTE / L.delay_s if L.delay_s else 0.0,
        HIGH_ASYMPTOTE * low,
    )
    slope = float(L.signs.sum())
    if slope:
        size = float(replace(L, hold_s=0.0).log_gain(np.array([top]))[0])
        top *= max(1.0, 10 * float(np.exp(-size / slope)))
    peaks = L.roots.imag[(L.roots.imag > low) & (L.roots.imag < top)]
    return np.unique(np.concatenate([np.geomspace(low, top, GRID), peaks]))


def interval_ends(L: ZeroPoleGain, grid: Array, top: float, turning: bool) -> Array:
    """Return the ends of intervals: the grid, steps of the delay, roots on the axis and zeros of the hold."""
    on_axis = L.roots.imag[(L.roots.real == 0) & (L.roots.imag > 0)]
    ends = [grid, on_axis, np.array([top])]
    if turning:
        ends.append(np.arange(grid[0], top, 0.3 / L.delay_s))
    if L.hold_s and turning:
        ends.append(2 * np.pi / L.hold_s * np.arange(1, int(top * L.hold_s / (2 * np.pi)) + 1))
    w = np.unique(np.concatenate(ends))
    return np.asarray(w[(w >= grid[0]) & (w <= top)])


def least_distance(L: ZeroPoleGain, nodes: Array) -> tuple[float, float]:
    """Return the least |1 + L| between the nodes and its frequency, to a relative tolerance of BOUND_TOLERANCE."""
    least, where, width = np.inf, float(nodes[0]), 0.0
    a, b = nodes[:-1], nodes[1:]
    while a.size:
        middle, half = (a + b) / 2, (b - a) / 2
        distance = np.abs(1 + L.value(middle))
        if distance.min() < least:
            k = int(distance.argmin())
            least, where, width = float(distance[k]), float(middle[k]), float(half[k])
        slopes = np.maximum(*(np.maximum(*np.abs(s)) for s in (L.phase_slope(a, b), L.log_gain_slope(a, b))))
        low, high = np.exp(np.minimum(L.log_gain_bounds(a, b), 700.0))
        with np.errstate(invalid="ignore"):
            lipschitz = np.nan_to_num(distance - half * np.sqrt(2) * slopes * high, nan=-np.inf)
        bound = np.maximum(lipschitz, np.maximum(low - 1, 1 - high))
        kept = (bound < least * (1 - BOUND_TOLERANCE)) & (b - a > MIN_WIDTH * b)
        a, b, middle = a[kept], b[kept], middle[kept]
        a, b = np.concatenate([a, middle]), np.concatenate([middle, b])
    return _refine_minimum(L, least, where, width)


def _refine_minimum(L: ZeroPoleGain, least: float, where: float, width: float) -> tuple[float, float]:
    """Return the local minimum of |1 + L| within a width of `where`."""

    def distance(t: float) -> float:
        return float(np.abs(1 + L.value(np.array([where + width * t])))[0])

    minimum = minimize_scalar(distance, bounds=(-1, 1), method="bounded", options={"xatol": 1e-9})
    return (float(minimum.fun), float(where + width * minimum.x)) if minimum.fun < least else (least, where)
