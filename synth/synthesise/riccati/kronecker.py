"""Lyapunov and Stein equations of p copies of a small matrix, I (x) F with F (k, k), in ball arithmetic.

    lyapunov    (I (x) F) Y + Y (I (x) F') = H          stein    (I (x) F) Y (I (x) F') - Y = H

Each block of Y satisfies a separate equation with the same operator. The operator is factored once.
"""

import flint

from synth.analyse import precise

Mat = flint.arb_mat


def lyapunov(F: Mat, H: Mat) -> Mat:
    """Return Y (p k, p k) of F (k, k) and H (p k, p k)."""
    one = precise.identity(F.nrows())
    return _by_blocks(precise.kronecker(F, one) + precise.kronecker(one, F), H)


def stein(F: Mat, H: Mat) -> Mat:
    """Return Y (p k, p k) of F (k, k) and H (p k, p k)."""
    return _by_blocks(precise.kronecker(F, F) - precise.identity(F.nrows() ** 2), H)


def block(F: Mat, p: int) -> Mat:
    """Return I (x) F with p copies."""
    return precise.kronecker(precise.identity(p), F)


def _by_blocks(operator: Mat, H: Mat) -> Mat:
    """Return Y such that the operator (k^2, k^2) maps its blocks (k, k), rows stacked, to the blocks of H."""
    n = H.nrows()
    k = next(k for k in range(1, n + 1) if k * k == operator.nrows())
    p = n // k
    inside = [(i, j) for i in range(k) for j in range(k)]
    blocks = [(a, b) for a in range(p) for b in range(p)]
    columns = operator.solve(Mat([[H[a * k + i, b * k + j] for a, b in blocks] for i, j in inside]))
    return Mat([[columns[i % k * k + j % k, i // k * p + j // k] for j in range(n)] for i in range(n)])
