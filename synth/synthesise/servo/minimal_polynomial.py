"""The minimal polynomial of a real matrix S (q, q): of all prod_j (s - s_j)^k_j that vanish at S, that of least degree.

k_j is the order of the largest Jordan block of s_j: further copies of a mode add nothing, a ramp or a sine that grows
as t does counts twice.

Eigenvalues of a block of order k scatter by the k-th root of the precision, their mean hardly. So eigenvalues close
together are taken for one mode, their mean s_j, when S - s_j I is nilpotent on their invariant subspace; the widest
neighbourhood for which all are is taken. k_j is the least power that vanishes. Parts of S that act on each other one
way only have eigenvalues of their own; S is scaled first, so that units do not matter.
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
from synth.analyse import staircase
from synth.errors import SignalError
from synth.statespace import Array, Complex

NEIGHBOURHOODS = (3e-4, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-10, 1e-12)  # of the size of a part of S
ALIKE = 1e-9  # relative: modes of separate parts of S this close are one
VANISHING = 1e-13  # of the size of S to its power: what is smaller is rounding error


@dataclass(frozen=True)
class Mode:
    """A root of the polynomial in 1/s; one with an imaginary part above 0 stands for its conjugate, too."""

    value: complex
    multiplicity: int

    @property
    def order(self) -> int:
        """How many degrees of the polynomial it takes."""
        return self.multiplicity * (2 if self.value.imag else 1)


def roots(S: ArrayLike) -> tuple[Mode, ...]:
    """Return the roots of the minimal polynomial of S (q, q), the slowest first.

    Raises SignalError for an S that is not square, is empty or not finite, or whose modes are not told apart in double
    precision.
    """
    matrix = arguments.matrix("S", S)
    if matrix.shape[0] != matrix.shape[1] or not matrix.size or not np.isfinite(matrix).all():
        raise SignalError(f"the exosystem matrix S is {matrix.shape}: give a square matrix of finite numbers")
    q = len(matrix)
    scaled = staircase.scaled(matrix)
    values = _distinct(value for part in _parts(scaled.A) for value in _clustered(part))
    found = [Mode(v * scaled.rate, _index(scaled.A, v, values) or q) for v in values if v.imag >= 0]
    return tuple(sorted(found, key=lambda m: (abs(m.value), m.value.imag)))


def product(modes: Iterable[Mode]) -> flint.arb_poly:
    """Return the real polynomial with these roots, in balls of the present precision."""
    found = flint.arb_poly([1])
    for mode in modes:
        a, b = flint.arb(mode.value.real), flint.arb(mode.value.imag)
        found *= flint.arb_poly([a * a + b * b, -2 * a, 1] if mode.value.imag else [-a, 1]) ** mode.multiplicity
    return found


def modal_matrix(modes: Sequence[Mode], chain: flint.arb | float = 1.0) -> flint.arb_mat:
    """Return T (n, n) of the real Jordan form Phi = T J T^-1 of the companion form Phi of the polynomial, in balls.

    J has a block for each mode. Columns of T are 1, s, s^2, .. at the modes and their derivatives times powers of
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


def _parts(S: Array) -> list[Array]:
    """Return the diagonal blocks of the states that act on each other both ways."""
    count, label = scipy.sparse.csgraph.connected_components(S != 0, directed=True, connection="strong")
    return [S[np.ix_(label == k, label == k)] for k in range(count)]


def _clustered(part: Array) -> list[complex]:
    """Return the distinct eigenvalues of a part."""
    values, size = np.linalg.eigvals(part).astype(np.complex128), _size(part)
    for width in NEIGHBOURHOODS:
        found = _means(values, width * size)
        if all(_index(part, value, found) for value in found):
            return found
    raise SignalError(
        "the modes of the exosystem matrix S are not determined in double precision: give frequencies, or S in blocks "
        "of one mode each"
    )


def _means(values: Complex, width: float) -> list[complex]:
    """Return the means of the groups in which each is within `width` of another; a part within it of 0 is 0."""
    left, found = list(values), []
    while left:
        group = [left.pop()]
        for near in group:
            group += [v for v in left if abs(v - near) <= width]
            left = [v for v in left if abs(v - near) > width]
        mean = complex(np.mean(group))
        found.append(complex(*(0.0 if abs(x) <= width else x for x in (mean.real, mean.imag))))
    return found


def _distinct(values: Iterable[complex]) -> list[complex]:
    """Return the values without those that are alike."""
    found: list[complex] = []
    for value in values:
        if not any(abs(value - other) <= ALIKE * abs(other) for other in found):
            found.append(value)
    return found


def _index(S: Array, value: complex, values: Sequence[complex]) -> int:
    """Return the least power of S - value I that vanishes on the subspace of the eigenvalues nearest to `value`.

    0 when none does: the subspace belongs to several modes.
    """

    def nearest(v: complex) -> bool:
        return min(values, key=lambda other: abs(v - other)) == value

    T, _, count = scipy.linalg.schur(S, output="complex", sort=nearest)
    N, power, size = T[:count, :count] - value * np.eye(count), np.eye(count), _size(S)
    for k in range(1, count + 1):
        power = power @ N
        if np.abs(power).max() <= VANISHING * size**k:
            return k
    return 0


def _size(S: Array) -> float:
    return float(np.abs(S).max())
