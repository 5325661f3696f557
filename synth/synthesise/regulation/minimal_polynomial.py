"""The minimal polynomial of a real matrix S (q, q): the polynomial prod_j (s - s_j)^k_j of least degree with p(S) = 0.

k_j is the order of the largest Jordan block of s_j. Further copies of a mode add nothing; a ramp, or a sine with an
amplitude proportional to t, has the multiplicity 2.

The eigenvalues of a block of order k scatter by the k-th root of the precision; their mean scatters far less.
Eigenvalues close together are therefore taken as one mode, with their mean s_j, if S - s_j I is nilpotent on their
invariant subspace. The widest neighbourhood for which this holds for all modes is taken, and k_j is the least power
that is zero. S is scaled first and split into its strongly connected components.
"""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import flint
import numpy as np
import scipy.linalg
import scipy.sparse.csgraph
from numpy.typing import ArrayLike

from synth import arguments
from synth.analyse.structure import staircase
from synth.errors import SignalError
from synth.statespace import Array, Complex

NEIGHBOURHOODS = (3e-4, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-10, 1e-12)  # of the size of a part of S
EQUAL_MODES_TOLERANCE = 1e-9  # relative: modes of different components of S within this distance are equal
ENTRY_ROUNDING = 1e-13  # of the size of S to its power: a smaller entry is rounding error


@dataclass(frozen=True)
class Mode:
    """A root of the polynomial in 1/s; a root with a positive imaginary part also represents its conjugate."""

    value: complex
    multiplicity: int

    @property
    def order(self) -> int:
        """The degree of its factor of the polynomial."""
        return self.multiplicity * (2 if self.value.imag else 1)


def roots(S: ArrayLike) -> tuple[Mode, ...]:
    """Return the roots of the minimal polynomial of S (q, q), sorted by |s|.

    Raises SignalError for an S that is not square, is empty or not finite, or whose modes are not resolved in double
    precision.
    """
    matrix = arguments.matrix("S", S)
    if matrix.shape[0] != matrix.shape[1] or not matrix.size or not np.isfinite(matrix).all():
        raise SignalError(f"the exosystem matrix S is {matrix.shape}: give a square matrix of finite numbers")
    q = len(matrix)
    scaled = staircase.scaled(matrix)
    values = _distinct(value for part in _strong_components(scaled.A) for value in _distinct_eigenvalues(part))
    modes = [Mode(v * scaled.rate, _jordan_index(scaled.A, v, values) or q) for v in values if v.imag >= 0]
    return tuple(sorted(modes, key=lambda m: (abs(m.value), m.value.imag)))


def polynomial(modes: Iterable[Mode]) -> flint.arb_poly:
    """Return the real polynomial with these roots, in balls of the precision in force."""
    polynomial = flint.arb_poly([1])
    for mode in modes:
        a, b = flint.arb(mode.value.real), flint.arb(mode.value.imag)
        polynomial *= flint.arb_poly([a * a + b * b, -2 * a, 1] if mode.value.imag else [-a, 1]) ** mode.multiplicity
    return polynomial


def modal_matrix(modes: Sequence[Mode], chain: flint.arb | float = 1.0) -> flint.arb_mat:
    """Return T (n, n) of the real Jordan form Phi = T J T^-1 of the companion form Phi of the polynomial, in balls.

    J has a block for each mode. The columns of T are 1, s, s^2, .. at the modes and their derivatives times powers of
    `chain`. exp(Phi t) has the same T.
    """
    n = sum(mode.order for mode in modes)
    columns = []
    for mode in modes:
        s = flint.acb(mode.value.real, mode.value.imag)
        for j in range(mode.multiplicity):
            v = [s ** (i - j) * math.comb(i, j) * flint.arb(chain) ** j if i >= j else flint.acb(0) for i in range(n)]
            columns += [[x.real for x in v], [x.imag for x in v]] if mode.value.imag else [[x.real for x in v]]
    return flint.arb_mat(columns).transpose()


def _strong_components(S: Array) -> list[Array]:
    """Return the diagonal blocks of the strongly connected components of S."""
    count, label = scipy.sparse.csgraph.connected_components(S != 0, directed=True, connection="strong")
    return [S[np.ix_(label == k, label == k)] for k in range(count)]


def _distinct_eigenvalues(part: Array) -> list[complex]:
    """Return the distinct eigenvalues of a component."""
    values, size = np.linalg.eigvals(part).astype(np.complex128), _size(part)
    for width in NEIGHBOURHOODS:
        means = _cluster_means(values, width * size)
        if all(_jordan_index(part, value, means) for value in means):
            return means
    raise SignalError(
        "the modes of the exosystem matrix S are not determined in double precision: give frequencies, or S in blocks "
        "of one mode each"
    )


def _cluster_means(values: Complex, width: float) -> list[complex]:
    """Return the means of clusters with gaps up to `width`; a real or imaginary part below `width` becomes 0."""
    remaining, means = list(values), []
    while remaining:
        group = [remaining.pop()]
        for near in group:
            group += [v for v in remaining if abs(v - near) <= width]
            remaining = [v for v in remaining if abs(v - near) > width]
        mean = complex(np.mean(group))
        means.append(complex(*(0.0 if abs(x) <= width else x for x in (mean.real, mean.imag))))
    return means


def _distinct(values: Iterable[complex]) -> list[complex]:
    """Return the values without duplicates."""
    distinct: list[complex] = []
    for value in values:
        if not any(abs(value - other) <= EQUAL_MODES_TOLERANCE * abs(other) for other in distinct):
            distinct.append(value)
    return distinct


def _jordan_index(S: Array, value: complex, values: Sequence[complex]) -> int:
    """Return the least power of S - value I that is zero on the subspace of the eigenvalues nearest to `value`.

    Return 0 when there is none, as the subspace belongs to several modes.
    """

    def nearest(v: complex) -> bool:
        return min(values, key=lambda other: abs(v - other)) == value

    T, _, count = scipy.linalg.schur(S, output="complex", sort=nearest)
    N, power, size = T[:count, :count] - value * np.eye(count), np.eye(count), _size(S)
    for k in range(1, count + 1):
        power = power @ N
        if np.abs(power).max() <= ENTRY_ROUNDING * size**k:
            return k
    return 0


def _size(S: Array) -> float:
    return float(np.abs(S).max())
