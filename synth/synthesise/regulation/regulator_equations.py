"""Solvability of the regulator equations (Francis 1977): a steady state in which the regulated outputs have no error.

    w' = S w        x' = A x + B u + E w        e = C x + D u + F w           (x+ and w+ in discrete time)

    Pi S = A Pi + B Gamma + E,    0 = C Pi + D Gamma + F

for A (n, n), B (n, m), C (p, n), S (q, q), E (n, q), F (p, q). On x = Pi w, u = Gamma w the error is zero.

A solution exists for all E and F when no mode s of S is a transmission zero: the Rosenbrock matrix
[[A - s I, B], [C, D]] must have full row rank n + p. If it has not, its left null vector (v, y) gives the combination
y^H e of the errors that no input affects at s.

The minimal polynomial of a real matrix S (q, q): the polynomial prod_j (s - s_j)^k_j of least degree with p(S) = 0.

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

from synth import arguments, show
from synth.analyse.numerics.magnitude import equilibrated
from synth.analyse.structure import staircase, structure
from synth.errors import ModelError, SignalError
from synth.statespace import Array, Complex, StateSpace
from synth.timing import Continuous, Time

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


@arguments.checked
def require_solvable(model: StateSpace, modes: Sequence[Mode]) -> None:
    """Raise ModelError, with the reason, unless the model's inputs can regulate all its outputs at all `modes`.

    The conditions are at least as many inputs as outputs, stabilisability, and no transmission zero at a mode of the
    exosystem (in 1/s, also for a sampled model).
    """
    if len(model.inputs) < len(model.outputs):
        raise ModelError(
            f"{len(model.outputs)} outputs ({', '.join(model.outputs)}) cannot be regulated by {len(model.inputs)} "
            f"inputs ({', '.join(model.inputs)}): regulate fewer or add actuators"
        )
    structure.check_stabilisable(model)
    require_no_zero(model, [_point(mode.value, model.time) for mode in modes])


@arguments.checked
def require_no_zero(model: StateSpace, points: Sequence[complex]) -> None:
    """Raise ModelError for a transmission zero at one of the `points`, in 1/s or in z, naming the blocked outputs."""
    for point in points:
        blocked = _blocked_outputs(model, point)
        if blocked is not None:
            raise ModelError(
                f"the plant from {', '.join(model.inputs)} to {', '.join(model.outputs)} has a transmission zero at "
                f"{_mode_text(point, model.time)} of the exosystem: it cannot be regulated there, as no input affects "
                f"{structure.direction_text(blocked)}; drop it, regulate other outputs or change the actuators"
            )


def _point(s: complex, time: Time) -> complex:
    return complex(s) if isinstance(time, Continuous) else complex(np.exp(s * time.period_s))


def _mode_text(point: complex, time: Time) -> str:
    s = point if isinstance(time, Continuous) else np.log(point) / time.period_s
    if abs(s.real) <= 1e-9 * abs(s):
        return f"{abs(s.imag):g} rad/s, a frequency"
    return f"{show.number(s)} 1/s, a mode"


def _blocked_outputs(model: StateSpace, point: complex) -> dict[str, complex] | None:
    """Return the combination of outputs that no input affects at a point, None when there is none."""
    n = len(model.A)
    R, rows, _ = equilibrated(np.block([[model.A - point * np.eye(n), model.B], [model.C, model.D]]))
    U, sigma, _ = np.linalg.svd(R)
    if len(sigma) == len(R) and sigma[-1] > staircase.COUPLING * sigma[0]:
        return None
    return structure.direction(np.asarray((rows * U[:, -1].conj())[n:], dtype=np.complex128), model.outputs)
