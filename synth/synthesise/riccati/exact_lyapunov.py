"""Lyapunov and Stein equations of a stable matrix A in ball arithmetic, with balls that contain the solution.

    continuous  Omega(Y) = A'Y + Y A = -W,     discrete  Omega(Y) = A'Y A - Y = -W

They are solved by squaring the bilinear image of A (Smith 1968, module `equation`). Its powers are balls: where one is
below 1, A is stable. Omega^-1 then reverses the order of symmetric matrices, and an H with Omega(H) <= -S < 0 bounds
what a defect V adds to Y:

    -e S <= V <= e S     implies     -e H <= Omega^-1(V) <= e H,     |Omega^-1(V)_ij| <= e sqrt(H_ii H_jj)

Eigenvalues of an exactly given matrix in ball arithmetic, and the stability of its modes beyond rounding error.

The eigenvalues of a matrix of doubles are computed in the precision in force and rounded once. This includes those of a
Jordan block, which double precision scatters by a root of its precision. The only error left is that of rounding the
matrix itself.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import flint
import numpy as np
from numpy.typing import NDArray

from synth.analyse import discretise
from synth.analyse.numerics import precise
from synth.analyse.structure import structure
from synth.statespace import Array, Complex
from synth.synthesise.riccati.equation import Bilinear, sizes
from synth.timing import Continuous, Time


def ball(values: Array) -> flint.arb_mat:
    """Return the doubles of a matrix, exactly, also of one without rows or columns."""
    return precise.matrix(values) if values.size else flint.arb_mat(*values.shape)


def decays(poles: Complex, time: Time) -> NDArray[np.bool_]:
    """Tell for each pole whether its mode decays by more than rounding error."""
    if isinstance(time, Continuous):
        return poles.real < -structure.DECAY * np.abs(poles).max(initial=0.0)
    return np.abs(poles) < 1 - structure.DECAY


def unstable_pole(A: Array, time: Time) -> complex | None:
    """Return the fastest growing eigenvalue of A (n, n) of those that do not decay, None where all decay.

    An eigenvalue counts as not decaying if rounding of A may stop its decay: Re s >= -DECAY |w|' |A|, with the unit
    left eigenvector w of the balanced A, or |z| >= 1 - DECAY. A slow mode is thus not compared with the fast ones.
    """
    if not len(A):
        return None
    D = discretise.balancing(A)
    balanced = A * D / D[:, None]
    values, w = np.linalg.eig(balanced.T)
    return _fastest_growing(values, w, balanced, time)


def exact_unstable_pole(F: flint.arb_mat, time: Time) -> complex | None:
    """Return the pole of `unstable_pole`, computed in the precision in force."""
    if not F.nrows():
        return None
    A = precise.rounded(F)
    D = discretise.balancing(A)
    balanced = precise.matrix(np.diag(1 / D)) * F * precise.matrix(np.diag(D))
    values, left = flint.acb_mat(balanced).eig(left=True, algorithm="approx")
    w = np.array([[complex(v) for v in row] for row in left.tolist()]).T
    poles = np.array([_without_rounding(complex(v)) for v in values])
    return _fastest_growing(poles, _with_unit_columns(w), A * D / D[:, None], time)


def _with_unit_columns(w: Complex) -> Complex:
    """Return unit columns, and ones, which no unit vector exceeds, for a column that a Jordan block leaves open."""
    with np.errstate(invalid="ignore", over="ignore", divide="ignore"):
        unit = w / np.linalg.norm(w, axis=0)
    return np.where(np.isfinite(unit).all(axis=0), unit, 1.0 + 0j)


def _fastest_growing(values: Complex, w: Complex, balanced: Array, time: Time) -> complex | None:
    """Return the value that grows fastest, None where all decay; w (n, n) has the unit left eigenvectors as columns."""
    if isinstance(time, Continuous):
        growth = values.real + structure.DECAY * np.linalg.norm(np.abs(w).T @ np.abs(balanced), axis=1)
    else:
        growth = np.abs(values) - 1 + structure.DECAY
    return complex(values[np.argmax(growth)]) if growth.max() >= 0 else None


def eigenvalues(F: flint.arb_mat) -> Complex:
    """Return the eigenvalues (n,) of a square matrix, sorted, computed in the precision in force, rounded once."""
    if not F.nrows():
        return np.zeros(0, dtype=np.complex128)
    values = flint.acb_mat(F).eig(algorithm="approx")
    return np.sort_complex(np.array([_without_rounding(complex(v)) for v in values], dtype=np.complex128))


def _without_rounding(value: complex) -> complex:
    """Return a value whose real or imaginary part is 0 where it is rounding error of the other."""
    least = 1e-30 * abs(value)
    real, imaginary = (v if abs(v) > least else 0.0 for v in (value.real, value.imag))
    return complex(real, imaginary)


Mat = flint.arb_mat

PASSES = 150  # doublings


def operator(A: Mat, Y: Mat, continuous: bool) -> Mat:
    """Return Omega(Y)."""
    YA = Y * A
    return YA + YA.transpose() if continuous else A.transpose() * YA - Y


@dataclass(frozen=True, eq=False)
class StableMap:
    """A stable A, as the powers A_d^1, A_d^2, A_d^4 .. of its bilinear image, with J and g."""

    A: Mat
    powers: Sequence[Mat]
    J: Mat
    g: flint.arb
    continuous: bool

    def gramian(self, W: Mat) -> Mat:
        """Return Y with Omega(Y) = -W for a symmetric W, to the precision in force but without a bound of its error."""
        Y = (self.J.transpose() * W * self.J * self.g).mid()
        for A in self.powers:
            Y = (Y + A.transpose() * Y * A).mid()
        return symmetric(Y)

    def majorant(self, size: Array) -> Mat | None:
        """Return an H for S = diag(size)^2, with powers of 2; None where this precision does not prove it."""
        D = precise.matrix(np.diag(1 / size))
        S = precise.matrix(np.diag(size * size))
        H = self.gramian(S * 2)
        return H if frobenius(D * (operator(self.A, H, self.continuous) + S * 2) * D) < 1 else None


def stable_map(A: Mat, bilinear: Bilinear) -> StableMap | None:
    """Return A as a StableMap, None where this precision does not show that it is stable."""
    one, c, k = precise.identity(A.nrows()), flint.arb(bilinear.c), flint.arb(bilinear.k)
    shift, g = (c, 2 * c) if bilinear.continuous else (k, 1 - k * k)
    try:
        J = (one * c - A if bilinear.continuous else one + A * k).inv()
    except ZeroDivisionError:
        return None
    powers = [(A + one * shift) * J]
    for _ in range(PASSES):
        size = frobenius(powers[-1])
        if size < flint.arb(2) ** (-flint.ctx.prec // 2):
            return StableMap(A, powers, J, g, bilinear.continuous)
        if not size < 1e300:
            break
        powers.append(powers[-1] * powers[-1])
    return None


def solution(A: Mat, W: Mat, continuous: bool) -> Mat:
    """Return balls that contain Y; raise ZeroDivisionError where this precision does not prove that A is stable."""
    decay = stable_map(A, Bilinear(precise.norm(A) if continuous else 1.0, continuous))
    if decay is None:
        raise ZeroDivisionError
    Y = decay.gramian(W)
    size = powers_of_two(Y)
    H, D = decay.majorant(size), precise.matrix(np.diag(1 / size))
    if H is None:
        raise ZeroDivisionError
    return balls(Y, H, frobenius(D * (operator(A, Y, continuous) + W) * D))


def powers_of_two(Y: Mat) -> Array:
    """Return sqrt(Y_ii) (n,) to a power of 2, with a floor."""
    return np.asarray(np.exp2(np.round(np.log2(sizes(precise.rounded(Y))))))


def balls(Y: Mat, H: Mat, e: flint.arb) -> Mat:
    """Return Y_ij with the radius e sqrt(H_ii H_jj)."""
    n, root = Y.nrows(), [H[i, i].sqrt() for i in range(Y.nrows())]
    return Mat([[Y[i, j] + flint.arb(0, (e * root[i] * root[j]).upper()) for j in range(n)] for i in range(n)])


def symmetric(Y: Mat) -> Mat:
    """Return the midpoints of (Y + Y') / 2."""
    return ((Y + Y.transpose()) * flint.arb(0.5)).mid()


def frobenius(M: Mat) -> flint.arb:
    """Return an upper bound of the Frobenius norm, which no eigenvalue exceeds."""
    return sum((abs(v).upper() ** 2 for v in M.entries()), flint.arb(0)).sqrt().upper()
