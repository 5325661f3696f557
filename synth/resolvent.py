"""Frequency response C (v I - A)^-1 B + D at many points v, by the real Schur form of the balanced A.

    S^-1 A S = U T U',      (v I - T) Z = U' S^-1 B,      X = U Z,      M(v) = C S X + D

S is diagonal with powers of two, U is orthogonal, and T is upper triangular but for 2 x 2 blocks, one for each complex
pair of poles. The triangular equations of many points are solved together, a block of rows at a time: products of
matrices take most of the time (Laub 1981 takes the Hessenberg form instead, one point at a time).

U spreads the rounding of the largest entries of A over all others. So the residual R = B - (v I - A) X is compared,
entry by entry, with |B| + |v X| + |A| |X|: where it is small, X is the exact solution for a matrix whose entries
differ from those of A by rounding (backward stability). Elsewhere iterative refinement improves X (Higham, Accuracy
and Stability of Numerical Algorithms, section 12). Where that does not converge, next to a pole, (v I - A) X = B is
solved by elimination. Elimination also serves small models and few points, where it is faster.

For many columns of B the residual takes most of the time. There the response is computed from two Schur forms, of A and
of A in states scaled by other factors, which round differently. C U (v I - T)^-1 U' B, without X, is the response where
both agree; elsewhere X is solved for as above.
"""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import lapack

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]

MAX_ELIMINATION_STATES = 10  # states: below, elimination at each point takes less time than the Schur form
MAX_ELIMINATION_POINTS = 16  # points: below, the same
WORK = 66  # rows of the workspace of LAPACK's dgees, for blocks of 64 reflectors
ROWS = 32  # of T in one block of the triangular solution
ENTRIES = 2**16  # of the states at the points of one chunk: 1 MB, which stays in the processor's cache
REFINED_CHUNKS = 8  # chunks whose inexact solutions are refined together
MATRICES = 2**20  # entries of all matrices v I - A that are held at once: 16 MB
BACKWARD = 2.0**-51  # times n, relative to each entry of A, v and B: the accuracy of elimination
POLE_GROWTH = 1e10  # |A| |X| over |B|: beyond, a point may lie on a pole within rounding
REFINEMENT_TOLERANCE = 1e-3  # a refinement that moves the states by less shows that the point is no pole
STEPS = 2  # of refinement, before elimination
MIN_COLUMNS = 32  # columns of B at all points, over n: from there on two Schur forms take less time than the residual
AGREEMENT = 2.0**-45  # times n, relative to the largest entry in a row and column: two responses that agree


@dataclass(frozen=True, eq=False)
class Schur:
    """T (n, n), quasi-triangular and real, and U (n, n), orthogonal, of A = U T U'.

    `poles` (n,) are the eigenvalues of A in the order of the diagonal of T; `edges` divide its rows into blocks.
    """

    T: Array
    U: Array
    poles: Complex
    edges: tuple[int, ...]

    def solve(self, v: Complex, right: NDArray[np.inexact]) -> Complex:
        """Return (v I - T)^-1 R for each point v (k,) and R (n, m, k) or (n, m, 1), as (n, m, k)."""
        n, m, k = len(self.T), right.shape[1], len(v)
        Z = np.empty((n, m, k), dtype=np.complex128)
        flat, (above, below) = Z.view(np.float64).reshape(n, 2 * m * k), np.empty((2, m, k), dtype=np.complex128)
        first, second = self._inverses(v)  # of the diagonal blocks of v I - T
        for start, stop in zip(self.edges[-2::-1], self.edges[:0:-1], strict=True):
            Z[start:stop] = right[start:stop]
            if stop < n:
                flat[start:stop] += self.T[start:stop, stop:] @ flat[stop:]
            i = stop - 1
            while i >= start:
                j = i - 1 if i > start and self.T[i, i - 1] else i
                if i + 1 < stop:
                    flat[j : i + 1] += self.T[j : i + 1, i + 1 : stop] @ flat[i + 1 : stop]
                if j < i:
                    # In place: Z[j], Z[i] = first[j] Z[j] + second[j] Z[i], second[i] Z[j] + first[i] Z[i].
                    np.multiply(second[j], Z[i], out=above)
                    np.multiply(second[i], Z[j], out=below)
                    Z[j : i + 1] *= first[j]
                    Z[j] += above
                    Z[i] += below
                else:
                    Z[i] *= first[i]
                i = j - 1
        return Z

    def _inverses(self, v: Complex) -> tuple[Complex, Complex]:
        """Return the diagonal and the other entries (n, k) of the inverses of the diagonal blocks of v I - T.

        LAPACK leaves equal entries a on the diagonal of a block: with the poles p and p* the inverse of
        [[v - a, -b], [-c, v - a]] is [[v - a, b], [c, v - a]] / ((v - p)(v - p*)), and a = (p + p*) / 2.
        """
        first = v - self.poles[:, None]
        inverse = 1 / (first.real**2 + first.imag**2)  # an overflow spoils the solution, and the residual shows it
        first.real *= inverse
        first.imag *= -inverse
        second = np.zeros_like(first)
        k = np.flatnonzero(np.diagonal(self.T, -1))
        if len(k):
            both = first[k] * first[k + 1]
            second[k], second[k + 1] = self.T[k, k + 1, None] * both, self.T[k + 1, k, None] * both
            first[k] = first[k + 1] = (first[k] + first[k + 1]) / 2
        return first, second


def schur(A: Array) -> Schur:
    """Return the real Schur form of A (n, n)."""
    T, U = _real_schur(A) if len(A) else (A, A)
    poles = np.diagonal(T).astype(np.complex128)
    pairs = np.flatnonzero(np.diagonal(T, -1))
    # LAPACK leaves equal diagonals a in a 2 x 2 block and off-diagonals b c < 0: its poles are a +- i sqrt(-b c).
    rate = np.sqrt(np.abs(T[pairs, pairs + 1])) * np.sqrt(np.abs(T[pairs + 1, pairs]))
    poles[pairs] += 1j * rate
    poles[pairs + 1] -= 1j * rate
    second = set((pairs + 1).tolist())
    edges = [i + (i in second) for i in range(0, len(A), ROWS)]
    return Schur(T, U, poles, (*edges, len(A)))


def _real_schur(A: Array) -> tuple[Array, Array]:
    """Return T and U of A = U T U'; `scipy.linalg.schur`, which takes longer than LAPACK itself for a small A."""
    T, _, _, _, U, _, info = lapack.dgees(lambda *_: 0, A, lwork=WORK * len(A), sort_t=0)
    if info:
        raise np.linalg.LinAlgError("the Schur form was not found: the iteration did not converge")
    return T, U


def balanced(A: Array, B: Array, C: Array) -> tuple[Array, Array, Array]:
    """Return A, B, C in states scaled by powers of two that make the rows and columns of A of similar size."""
    if not len(A):
        return A, B, C
    A, _, _, scale, _ = lapack.dgebal(A, scale=1, permute=0)
    return A, B / scale[:, None], C * scale


def response(A: Array, B: Array, C: Array, D: Array, v: Complex) -> Complex:
    """Return C (v I - A)^-1 B + D at points v (k,) as (k, p, m).

    Raises numpy.linalg.LinAlgError when v I - A is singular at a point.
    """
    p, m = D.shape
    if p < m:
        return response(A.T, C.T, B.T, D.T, v).transpose(0, 2, 1)
    different, places = np.unique(v, return_inverse=True)
    if len(different) < len(v):
        return response(A, B, C, D, different)[places]
    M = np.empty((len(v), p, m), dtype=np.complex128)
    M[:] = D
    if not (len(A) and m):
        return M
    if len(A) < MAX_ELIMINATION_STATES or len(v) < MAX_ELIMINATION_POINTS:
        return M + _direct(A, B, C, v)
    A, B, C = balanced(A, B, C)
    form, left = schur(A), np.arange(len(v))
    if m * len(v) >= MIN_COLUMNS * len(A):
        strictly_proper, agrees = _two_responses(form, A, B, C, v)
        M += strictly_proper
        left = left[~agrees]
        if len(left) < MAX_ELIMINATION_POINTS:
            M[left] = _direct(A, B, C, v[left]) + D
            return M
    for part in _chunks(len(left), REFINED_CHUNKS * ENTRIES // B.size):
        M[left[part]] = _solve_with_refinement(form, A, B, C, v[left[part]]) + D
    return M


def at_points(form: Schur, A: Array, B: Array, C: Array, v: Complex) -> Complex:
    """Return C (v I - A)^-1 B (k, p, m) by the Schur form of A, or at a few points of a small model by elimination."""
    if len(v) <= MAX_ELIMINATION_POINTS and 0 < len(A) <= 2 * MAX_ELIMINATION_STATES:
        return _direct(A, B, C, v)
    return _product(C @ form.U, form.solve(v, (form.U.T @ B)[:, :, None])).transpose(2, 0, 1)


def _two_responses(form: Schur, A: Array, B: Array, C: Array, v: Complex) -> tuple[Complex, NDArray[np.bool_]]:
    """Return C (v I - A)^-1 B (k, p, m) by the Schur form, and where that of scaled states agrees (k,)."""
    scale = 1 + np.arange(len(A)) * (np.sqrt(5) - 1) / 2 % 1  # between 1 and 2, no powers of two
    scaled = schur(A * scale / scale[:, None]), B / scale[:, None], C * scale
    M, agrees = np.empty((len(v), len(C), B.shape[1]), dtype=np.complex128), np.zeros(len(v), dtype=bool)
    with np.errstate(all="ignore"):  # at a pole both are infinite, and do not agree
        for part in _chunks(len(v), ENTRIES // B.size):
            first, second = (
                _product(c @ f.U, f.solve(v[part], (f.U.T @ b)[:, :, None])) for f, b, c in ((form, B, C), scaled)
            )
            size, error = _size(first), _size(first - second)
            largest = np.minimum(size.max(axis=0, keepdims=True), size.max(axis=1, keepdims=True))
            agrees[part] = (error <= len(A) * AGREEMENT * largest).all(axis=(0, 1))
            M[part] = first.transpose(2, 0, 1)
    return M, agrees


def singular(A: Array, v: Complex) -> complex:
    """Return the point among v (k,) at which v I - A is nearest to singular."""
    parts = [v[part] for part in _chunks(len(v), MATRICES // len(A) ** 2)]
    sizes = [np.linalg.slogdet(part[:, None, None] * np.eye(len(A)) - A)[1] for part in parts]
    return complex(v[int(np.concatenate(sizes).argmin())])


def _solve_with_refinement(form: Schur, A: Array, B: Array, C: Array, v: Complex) -> Complex:
    """Return C (v I - A)^-1 B (k, p, m) by the Schur form, refined; where that does not converge, directly."""
    M, places, right = np.empty((len(v), len(C), B.shape[1]), dtype=np.complex128), np.arange(len(v)), form.U.T @ B
    inexact = []
    with np.errstate(all="ignore"):  # at a pole X is infinite; elimination raises the error
        for part in _chunks(len(v), ENTRIES // B.size):
            X = _product(form.U, form.solve(v[part], right[:, :, None]))
            M[part] = _product(C, X).transpose(2, 0, 1)
            size, residual = _size(X), _residual(A, B, v[part], X)
            near = size.max(axis=(0, 1)) * (np.linalg.norm(A, 1) + np.abs(v[part])) > POLE_GROWTH * np.abs(B).max()
            far = ~_is_backward_stable(A, B, v[part], size, residual) | near
            inexact.append((places[part][far], X[:, :, far], residual[:, :, far]))
        left, X, residual = (np.concatenate(each, axis=-1) for each in zip(*inexact, strict=True))
        for _ in range(STEPS):
            if not left.size:
                return M
            change = _product(form.U, form.solve(v[left], _product(form.U.T, residual)))
            X = X + change
            M[left] = _product(C, X).transpose(2, 0, 1)
            size, residual = _size(X), _residual(A, B, v[left], X)
            relative_change = _size(change).max(axis=(0, 1)) / size.max(axis=(0, 1))
            far = ~(_is_backward_stable(A, B, v[left], size, residual) & (relative_change <= REFINEMENT_TOLERANCE))
            left, X, residual = left[far], X[:, :, far], residual[:, :, far]
    M[left] = _direct(A, B, C, v[left])
    return M


def _chunks(count: int, most: int) -> list[slice]:
    """Return the places from 0 to `count` in parts of similar size, each of at most `most`, or of one."""
    parts = -(-count // max(1, most))
    edges = [count * k // max(1, parts) for k in range(parts + 1)]
    return [slice(first, last) for first, last in pairwise(edges)]


def _residual(A: Array, B: Array, v: Complex, X: Complex) -> Complex:
    """Return B - (v I - A) X (n, m, k)."""
    residual = _product(A, X)
    residual -= v * X
    residual += B[:, :, None]
    return residual


def _is_backward_stable(A: Array, B: Array, v: Complex, size: Array, residual: Complex) -> NDArray[np.bool_]:
    """Return for each point (k,) whether the residual of X, of entries of `size` (n, m, k), is rounding error.

    |A| |X| is left out first: the product takes time, and few points need it.
    """
    n, m, _ = size.shape
    left, terms = _size(residual), np.abs(v) * size
    terms += np.abs(B)[:, :, None]
    satisfied = np.asarray((left <= n * BACKWARD * terms).all(axis=(0, 1)))
    far = np.flatnonzero(~satisfied)
    if len(far):
        terms = terms[:, :, far] + (np.abs(A) @ size[:, :, far].reshape(n, m * len(far))).reshape(n, m, len(far))
        satisfied[far] = (left[:, :, far] <= n * BACKWARD * terms).all(axis=(0, 1))
    return satisfied


def _product(P: Array, X: Complex) -> Complex:
    n, m, k = X.shape
    X = np.ascontiguousarray(X)
    return (P @ X.view(np.float64).reshape(n, 2 * m * k)).view(np.complex128).reshape(len(P), m, k)


def _size(X: Complex) -> Array:
    return np.asarray(np.abs(X.real) + np.abs(X.imag), dtype=np.float64)


def _direct(A: Array, B: Array, C: Array, v: Complex) -> Complex:
    """Return C (v I - A)^-1 B (k, p, m) by elimination at each point."""
    parts = [v[part] for part in _chunks(len(v), MATRICES // len(A) ** 2)]
    shifted = (part[:, None, None] * np.eye(len(A)) - A for part in parts)
    responses = [C @ np.linalg.solve(each, np.broadcast_to(B, (len(each), *B.shape))) for each in shifted]
    return np.concatenate(responses) if responses else np.zeros((0, len(C), B.shape[1]), dtype=np.complex128)
