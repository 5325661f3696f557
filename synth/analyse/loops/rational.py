"""Exact transfer function of a scalar loop: a ratio of two polynomials with integer coefficients.

    L = N(s) / D(s)          continuous,
    L = N(z) / D(z)          sampled, with z = (1 + s) / (1 - s): the circle z = exp(i w T) is s = i tan(w T / 2)

A double is an integer times a power of 2. Therefore nothing is rounded, neither the coefficients of a transfer function
nor, for a state-space model,

    D = det(s I - A),        N = det(s I - A + B C) + (d - 1) det(s I - A).

On the axis s = i v, with u = v^2, a polynomial is P(i v) = E(u) + i v O(u). Its zeros are isolated in ball arithmetic.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from math import gcd
from typing import Any

import flint
import numpy as np

from synth.analyse import discretise
from synth.analyse.numerics import precise
from synth.conversions import coefficients
from synth.errors import ModelError
from synth.statespace import Array, Complex, StateSpace, System, of
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
        finite = np.concatenate([zeros(N + D), zeros(self.common)])
        at_infinity = max(self.N.degree(), self.D.degree()) - len(finite)
        return np.concatenate([finite, np.full(at_infinity, complex(np.inf))])

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
    shift = 1 << _bits(np.concatenate([b, a]))
    return _integer_polynomial(b[::-1], shift), _integer_polynomial(a[::-1], shift)


def _integer_polynomial(values: Array, shift: int) -> Polynomial:
    return flint.fmpz_poly([int(Fraction(float(v)) * shift) for v in values])


def _bits(values: Array) -> int:
    """Return the least k >= 0 for which all values times 2^k are whole."""
    return max((Fraction(float(v)).denominator.bit_length() - 1 for v in values), default=0)


def _determinants(model: StateSpace) -> tuple[Polynomial, Polynomial]:
    """Return N and D of a model, both times one integer."""
    n = len(model.A)
    scale = discretise.balancing(model.A)
    A, b, c = model.A * scale / scale[:, None], model.B[:, 0] / scale, model.C[0] * scale
    k_b, k_c, d = _bits(b), _bits(c), Fraction(float(model.D[0, 0]))
    k = max(_bits(A.ravel()), k_b + k_c)
    A_whole = [[int(Fraction(float(v)) * (1 << k)) for v in row] for row in A]
    b_whole = [int(Fraction(float(v)) * (1 << (k - k_c))) for v in b]
    c_whole = [int(Fraction(float(v)) * (1 << k_c)) for v in c]
    feedback = [[A_whole[i][j] - b_whole[i] * c_whole[j] for j in range(n)] for i in range(n)]
    D, closed = _characteristic(A_whole, k), _characteristic(feedback, k)
    return d.denominator * closed + (d.numerator - d.denominator) * D, d.denominator * D


def _characteristic(M: Sequence[Sequence[int]], k: int) -> Polynomial:
    """Return det(s I - M / 2^k) times 2^(k n), M (n, n)."""
    if not M:
        return flint.fmpz_poly([1])
    return flint.fmpz_poly([c << (k * i) for i, c in enumerate(map(int, flint.fmpz_mat(M).charpoly().coeffs()))])


def _bilinear(P: Polynomial, order: int) -> Polynomial:
    """Return (1 - s)^order P((1 + s) / (1 - s)), as two shifts and a reversal, from z = 2 / (1 - s) - 1."""
    shifted = [int(c) << k for k, c in enumerate(map(int, P(X - 1).coeffs()))]
    padded = shifted + [0] * (order + 1 - len(shifted))
    return flint.fmpz_poly(padded[::-1])(1 - X)


def zeros(P: Polynomial) -> Complex:
    """Return the zeros (n,) of a polynomial, repeated by multiplicity."""
    with precise.precision(BITS):
        repeated = [complex(root) for root, count in roots(P) for _ in range(count)]
    return np.array(repeated, dtype=np.complex128)


def roots(P: Polynomial) -> list[tuple[Any, int]]:
    """Return the zeros of a polynomial as balls, each with its multiplicity, in the current precision."""
    isolated: list[Any] = P.complex_roots() if P.degree() > 0 else []
    return [(root, int(count)) for root, count in isolated]


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
    with precise.precision(BITS):
        if not b:
            return at_infinity + sum(count for root, count in roots(real) if not root.real < 0)
    return at_infinity + sum(not root.real < 0 for root in _complex_roots(real, imaginary))


def _complex_roots(real: Polynomial, imaginary: Polynomial) -> list[flint.acb]:
    """Return the zeros of real + i imaginary, exact coefficients; raise ModelError if they cannot be separated."""
    with precise.precision(max(real.height_bits(), imaginary.height_bits()) + BITS):
        P = flint.acb_poly(real) + flint.acb(0, 1) * flint.acb_poly(imaginary)
        try:
            return list(P.roots(tol=flint.arb(2) ** -(BITS // 2), maxprec=MAX_BITS)) if P.degree() > 0 else []
        except ValueError as error:
            raise ModelError("the poles of the loop closed with a phase change cannot be separated") from error
