"""Staircase reductions of dx/dt = A x + B u, y = C x + D u by orthonormal steps, after scaling.

    scaled     x = X x~, u = U u~, y = Y y~, s = r s~ with diagonal X, U, Y for which entries differ least, so that what
               counts as zero does not depend on units (Curtis, Reid 1972)
    split      the least subspace that contains B and that A maps into itself, and its complement (Kalman)
    deflated   the Rosenbrock pencil [[A - s I, B], [C, D]] without its infinite zeros: a state that y = 0 holds at zero
               leaves, and its derivative, which is zero too, becomes an output; until D has full row rank
               (Emami-Naeini, Van Dooren 1982)

No step hangs on an eigenvalue of A: those of a chain of integrators scatter by far more than the precision of A.
"""

from dataclasses import dataclass

import numpy as np
import scipy.linalg

from synth.errors import SignalError
from synth.statespace import Array, Complex, StateSpace

COUPLING = 1e-11  # of the scaled matrices' size: what is weaker counts as rounding error and moves nothing
LARGEST = 332.0  # of the exponents of 2 of entries and units: cubes of what is larger leave the range of a double
OVERLAP = 1e-7  # of the cosines between what is reached and what is seen: those less are rounding error
RESIDUAL = 1e-9  # of each column of scaled A: what w^H A - s w^H exceeds makes no eigenvector
NOISE = 1e-14  # of the largest entries in its row and column: what is smaller tells nothing about units


@dataclass(frozen=True, eq=False)
class Scaled:
    """The matrices in scaled coordinates; x, u, y hold the units' sizes, `rate` that of A in 1/s, powers of 2 all."""

    A: Array
    B: Array
    C: Array
    D: Array
    x: Array
    u: Array
    y: Array
    rate: float


def scaled(A: Array, B: Array | None = None, C: Array | None = None, D: Array | None = None) -> Scaled:
    """Return the model in units that bring the logarithms of its entries together in the least squares sense.

    Powers of 2 round nothing. Without B, or C, there are no inputs, or outputs; D is 0 where it is left out.

    Raises SignalError for entries or units whose cubes a double does not hold.
    """
    B = np.zeros((len(A), 0)) if B is None else B
    C = np.zeros((0, len(A))) if C is None else C
    (n, m), p = B.shape, len(C)
    D = np.zeros((p, m)) if D is None else D
    M = np.abs(np.block([[A, B], [C, D]]))
    least = np.minimum(M.max(axis=1, initial=0.0)[:, None], M.max(axis=0, initial=0.0))
    row, column = np.nonzero(NOISE * least < M)
    logs = np.log2(M[row, column])
    k = np.arange(len(row))
    equations = np.zeros((len(k), n + m + p + 1))
    equations[k, column] = 1.0
    equations[k, np.where(row < n, row, row + m)] -= 1.0
    equations[k[row < n], -1] = -1.0
    normal, right = equations.T @ equations, -equations.T @ logs  # integers: nothing is lost
    exponents = np.linalg.lstsq(normal, right, rcond=NOISE)[0]
    if max(np.abs(logs).max(initial=0.0), np.abs(exponents).max(initial=0.0)) > LARGEST:
        worst = int(np.argmax(np.abs(logs)))
        raise SignalError(
            f"an entry of the model has the size {M[row[worst], column[worst]]:.1e}: all must lie within some "
            "1e-100 .. 1e100; set it to 0 or take other units"
        )
    sizes = np.exp2(np.round(exponents))
    x, u, y, rate = sizes[:n], sizes[n : n + m], sizes[n + m : -1], float(sizes[-1])
    return Scaled(
        A * x / x[:, None] / rate, B * u / x[:, None] / rate, C * x / y[:, None], D * u / y[:, None], x, u, y, rate
    )


def of_model(model: StateSpace) -> Scaled:
    """Return a model's matrices scaled."""
    return scaled(model.A, model.B, model.C, model.D)


@dataclass(frozen=True)
class Gap:
    """The least singular value that counted as a coupling, and the largest that counted as zero."""

    kept: float
    left: float

    @property
    def ratio(self) -> float:
        """How many times the former is the latter."""
        return self.kept / self.left if self.left else np.inf


@dataclass(frozen=True, eq=False)
class Split:
    """Orthonormal bases: `inside` (n, k) of the subspace that B reaches, `outside` (n, n - k) of its complement.

    A coordinate that lies in one of them is a column of its basis as it stands, before the others.
    """

    inside: Array
    outside: Array
    gap: Gap


def split(A: Array, B: Array, cut: float = COUPLING) -> Split:
    """Split the states of a scaled pair, A (n, n), B (n, m), into what B reaches by more than `cut` and the rest."""
    reached, gap = _reached(A, B, cut)
    rest = _complement(reached)
    return Split(_complement(rest), rest, gap)


def _complement(basis: Array) -> Array:
    """Return an orthonormal basis (n, n - k) of what is orthogonal to `basis` (n, k), coordinates first."""
    n, k = basis.shape
    free = np.abs(basis).max(axis=1, initial=0.0) <= COUPLING
    found = np.zeros((n, n - k))
    alone = int(free.sum())
    found[free, :alone] = np.eye(alone)
    if alone < n:
        found[~free, alone:] = np.linalg.svd(basis[~free])[0][:, k:]
    return found


@dataclass(frozen=True, eq=False)
class Kalman:
    """What is reached and seen: `kept` (n, k), orthonormal, in scaled coordinates; and the modes of the rest.

    `unreached` holds eigenvalues with left vectors w, w^H B = 0, `unseen` those of what is reached with right vectors
    v, C v = 0; each vector is a column (n,). `gap` is the narrowest one of the decisions taken.
    """

    kept: Array
    unreached: tuple[Complex, Complex]
    unseen: tuple[Complex, Complex]
    gap: Gap


def kalman(part: Scaled, cut: float = COUPLING) -> Kalman:
    """Return the part of a scaled model that its response shows, and the modes that are left out.

    What is seen is found apart from what is reached: in the reached part alone rounding has grown by the whole
    staircase and may count as a coupling, while the angles between the two subspaces are right ones or far from it.
    """
    reach, sight = split(part.A, part.B, cut), split(part.A.T, part.C.T, cut)
    _, cosines, V = np.linalg.svd(sight.inside.T @ reach.inside)
    k = int((cosines > OVERLAP).sum())
    rest = _complement(V[:k].T)
    inside = _complement(rest)
    A = reach.inside.T @ part.A @ reach.inside
    unreached, unseen = modes(part.A.T, reach.outside), modes(A, rest)
    gap = min(reach.gap, sight.gap, _gap(cosines, OVERLAP), key=lambda g: g.ratio)
    return Kalman(reach.inside @ inside, unreached, (unseen[0], reach.inside @ unseen[1]), gap)


def _gap(sigma: Array, cut: float) -> Gap:
    """Return the gap about a cut through singular values that are 1 at best."""
    above = sigma > cut
    return Gap(float(sigma[above].min(initial=1.0)), float(sigma[~above].max(initial=0.0)))


def modes(A: Array, basis: Array) -> tuple[Complex, Complex]:
    """Return the eigenvalues (k,) of A (n, n) on an invariant subspace with orthonormal `basis`, and vectors (n, k)."""
    values, vectors = np.linalg.eig(basis.T @ A @ basis)
    return values.astype(np.complex128), (basis @ vectors).astype(np.complex128)


def unreached(part: Scaled) -> tuple[Complex, Complex]:
    """Return scaled modes (k,) that B does not reach, with left eigenvectors (n, k).

    The staircase loses what differs by rounding of the fastest mode, and then leaves combinations that are no
    eigenvectors. In their place come eigenvectors of A itself that B does not reach.
    """
    values, w = modes(part.A.T, split(part.A, part.B).outside)
    w = w / np.linalg.norm(w, axis=0)
    allowed = RESIDUAL * (np.linalg.norm(part.A, axis=0)[:, None] + np.abs(values))
    true = (np.abs(part.A.T @ w - values * w) <= allowed).all(axis=0)
    if true.all():
        return values, w
    every, W = modes(part.A.T, np.eye(len(part.A)))
    size = np.linalg.norm(part.B, axis=0)
    reach = np.abs(W.T @ (part.B / np.where(size > 0, size, 1.0))).max(axis=1, initial=0.0)
    known = np.abs(every[:, None] - values[true]) <= RESIDUAL * (np.abs(every)[:, None] + np.abs(values[true]))
    new = (reach <= COUPLING) & ~known.any(axis=1)
    return np.concatenate([values[true], every[new]]), np.hstack([w[:, true], W[:, new]])


@dataclass(frozen=True, eq=False)
class Zeros:
    """Finite zeros in scaled s (k,), the normal rank of the response, and directions, columns for each zero.

    With `right`, x (n, k) and u (m, k) satisfy (A - s I) x + B u = 0, C x + D u = 0; else, with fewer outputs than
    inputs, u (p, k) weights outputs and the same holds of the transposed matrices. Where the rank is below both numbers
    no direction is defined: x and u are zero.
    """

    values: Complex
    rank: int
    x: Complex
    u: Complex
    right: bool


def zeros(A: Array, B: Array, C: Array, D: Array) -> Zeros:
    """Return the invariant zeros of scaled matrices: where the Rosenbrock matrix has less than its usual rank."""
    right = B.shape[1] <= len(C)
    if not right:
        A, B, C, D = A.T, C.T, B.T, D.T
    size = COUPLING * float(np.linalg.norm(np.block([[A, B], [C, D]])))
    a, b, c, d, basis = deflated(A, B, C, D, size)
    if len(d) == B.shape[1]:
        values, vectors = _finite(a, b, c, d)
        return Zeros(values, len(d), basis @ vectors[: len(a)], vectors[len(a) :], right)
    a, b, c, d, _ = deflated(a.T, c.T, b.T, d.T, size)
    values, _ = _finite(a, b, c, d)
    nothing = np.zeros((len(A), len(values)), dtype=np.complex128)
    return Zeros(values, len(d), nothing, np.zeros((B.shape[1], len(values)), dtype=np.complex128), right)


def deflated(A: Array, B: Array, C: Array, D: Array, size: float) -> tuple[Array, Array, Array, Array, Array]:
    """Return A, B, C, D with the same finite zeros and D of full row rank, and the basis of the states that are left.

    Singular values up to `size` count as zero.
    """
    basis = np.eye(len(A))
    while True:
        U, sigma, _ = np.linalg.svd(D)
        rank = int((sigma > size).sum())
        C, D = U.T @ C, (U.T @ D)[:rank]
        _, sigma, V = np.linalg.svd(C[rank:])
        held = int((sigma > size).sum())
        if not held:
            return A, B, C[:rank], D, basis
        zero, free = V[:held], V[held:].T
        C, D = np.vstack([C[:rank] @ free, zero @ A @ free]), np.vstack([D, zero @ B])
        A, B, basis = free.T @ A @ free, free.T @ B, basis @ free


def _finite(A: Array, B: Array, C: Array, D: Array) -> tuple[Complex, Complex]:
    """Return the zeros (k,) of a square model with regular D and the vectors (x, u) (n + m, k) at which they appear."""
    if not len(A):
        return np.zeros(0, dtype=np.complex128), np.zeros((D.shape[1], 0), dtype=np.complex128)
    quiet = np.linalg.svd(np.hstack([C, D]))[2][len(D) :].T  # the states and inputs for which y = 0
    values, vectors = scipy.linalg.eig(np.hstack([A, B]) @ quiet, quiet[: len(A)])
    return values.astype(np.complex128), (quiet @ vectors).astype(np.complex128)


def _reached(A: Array, B: Array, cut: float) -> tuple[Array, Gap]:
    """Return an orthonormal basis (n, k) of the least subspace that contains B and that A maps into itself."""
    size = np.linalg.norm(B, axis=0)
    new, sigma = _range(B[:, size > COUPLING] / size[size > COUPLING], cut)
    basis, found = new, [sigma]
    step = A / (np.linalg.norm(A) or 1.0)
    while new.shape[1] and basis.shape[1] < len(A):
        new = step @ new
        for _ in range(2):  # once more for what rounding left
            new = new - basis @ (basis.T @ new)
        new, sigma = _range(new, cut)
        basis, found = np.hstack([basis, new]), [*found, sigma]
    return basis, _gap(np.concatenate(found), cut)


def _range(M: Array, cut: float) -> tuple[Array, Array]:
    U, sigma, _ = np.linalg.svd(M, full_matrices=False)
    return U[:, sigma > cut], sigma
