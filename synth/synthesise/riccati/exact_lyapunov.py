"""Lyapunov and Stein equations of a stable matrix A in ball arithmetic, with balls that contain the solution.

    continuous  Omega(Y) = A'Y + Y A = -W,     discrete  Omega(Y) = A'Y A - Y = -W

They are solved by squaring the bilinear image of A (Smith 1968, module `doubling`). Its powers are balls: where one is
below 1, A is stable. Omega^-1 then reverses the order of symmetric matrices, and an H with Omega(H) <= -S < 0 bounds
what a defect V adds to Y:

    -e S <= V <= e S     implies     -e H <= Omega^-1(V) <= e H,     |Omega^-1(V)_ij| <= e sqrt(H_ii H_jj)
"""

from collections.abc import Sequence
from dataclasses import dataclass

import flint
import numpy as np

from synth.analyse.numerics import precise
from synth.statespace import Array
from synth.synthesise.riccati.doubling import Bilinear
from synth.synthesise.riccati.equation import sizes

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
