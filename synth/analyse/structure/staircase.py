"""Staircase algorithms for controllability, observability and zeros (SLICOT AB01ND, AB08ND), after scaling.

    scaled     x = X x~, u = U u~, y = Y y~, s = r s~ with diagonal X, U, Y that make the entries most alike; tests for
               zero then do not depend on units (Curtis, Reid 1972)
    split      the controllable subspace of (A, B) and its orthogonal complement (Kalman)
    deflated   the Rosenbrock pencil [[A - s I, B], [C, D]] without its infinite zeros: a state that y = 0 forces to
               zero is removed, and its derivative, also zero, becomes an output; until D has full row rank
               (Emami-Naeini, Van Dooren 1982)

All steps are orthonormal and none uses an eigenvalue of A: the computed eigenvalues of a chain of integrators have
errors far above the precision of A.
"""

from dataclasses import dataclass

import numpy as np
import scipy.linalg

from synth.errors import SignalError
from synth.statespace import Array, Complex, StateSpace

COUPLING = 1e-11  # of the scaled matrices' size: a weaker coupling counts as rounding error
LARGEST = 332.0  # of the exponents of 2 of entries and units: cubes of larger ones overflow
OVERLAP = 1e-7  # of the cosines between controllable and observable subspaces: smaller ones are rounding
RESIDUAL = 1e-9  # of each column of scaled A: w is an eigenvector if w^H A - s w^H does not exceed it
NOISE = 1e-14  # a smaller entry does not influence the scaling: of its row and column, or of the rates if diagonal


@dataclass(frozen=True, eq=False)
class Scaled:
    """The matrices in scaled coordinates; x, u, y are the scales, `rate` is that of s in 1/s, all powers of 2."""

    A: Array
    B: Array
    C: Array
    D: Array
    x: Array
    u: Array
    y: Array
    rate: float


def scaled(A: Array, B: Array | None = None, C: Array | None = None, D: Array | None = None) -> Scaled:
    """Return the model in units that make the logarithms of its entries equal in the least-squares sense.

    Scales are powers of 2, which cause no rounding. By default there are no inputs, no outputs, and D is 0.

    Raises SignalError for entries or units whose cubes overflow.
    """
    B = np.zeros((len(A), 0)) if B is None else B
    C = np.zeros((0, len(A))) if C is None else C
    (n, m), p = B.shape, len(C)
    D = np.zeros((p, m)) if D is None else D
    M = np.abs(np.block([[A, B], [C, D]]))
    least = np.minimum(M.max(axis=1, initial=0.0)[:, None], M.max(axis=0, initial=0.0))
    diagonal = np.arange(n)
    least[diagonal, diagonal] = np.maximum(least[diagonal, diagonal], _rate(M[:n, :n]))
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


def _rate(size: Array) -> float:
    """Return the spectral radius of |A| (n, n), which no scales of the states change; a diagonal entry is a rate."""
    return float(np.abs(np.linalg.eigvals(size)).max(initial=0.0))


def of_model(model: StateSpace) -> Scaled:
    """Return a model's matrices scaled."""
    return scaled(model.A, model.B, model.C, model.D)


@dataclass(frozen=True)
class Gap:
    """The least singular value counted as a coupling, and the largest counted as zero."""

    kept: float
    neglected: float

    @property
    def ratio(self) -> float:
        """The least kept over the largest neglected."""
        return self.kept / self.neglected if self.neglected else np.inf


@dataclass(frozen=True, eq=False)
class Split:
    """Orthonormal bases: `basis` (n, k) of the controllable subspace, `complement` (n, n - k) of its complement.

    A coordinate axis that lies in one of them is a column of its basis; such columns come first.
    """

    basis: Array
    complement: Array
    gap: Gap


def controllable_split(A: Array, B: Array, cut: float = COUPLING) -> Split:
    """Return the controllable subspace of a scaled pair, A (n, n), B (n, m), and its complement; tolerance `cut`."""
    reached, gap = _controllable_subspace(A, B, cut)
    rest = _complement(reached)
    return Split(_complement(rest), rest, gap)


def _complement(basis: Array) -> Array:
    """Return an orthonormal basis (n, n - k) of the complement of `basis` (n, k), coordinate axes first."""
    n, k = basis.shape
    free = np.abs(basis).max(axis=1, initial=0.0) <= COUPLING
    complement = np.zeros((n, n - k))
    alone = int(free.sum())
    complement[free, :alone] = np.eye(alone)
    if alone < n:
        complement[~free, alone:] = np.linalg.svd(basis[~free])[0][:, k:]
    return complement


@dataclass(frozen=True, eq=False)
class Kalman:
    """The controllable and observable part, basis `kept` (n, k), orthonormal, scaled; and the modes outside it.

    `uncontrollable` holds eigenvalues with left vectors w, w^H B = 0; `unobservable` holds the controllable but
    unobservable ones with right vectors v, C v = 0; each vector is a column (n,). `gap` is the least of all decisions.
    """

    kept: Array
    uncontrollable: tuple[Complex, Complex]
    unobservable: tuple[Complex, Complex]
    gap: Gap


def kalman(model: Scaled, cut: float = COUPLING) -> Kalman:
    """Return the Kalman decomposition of a scaled model: its minimal part, and the other modes.

    The observable subspace is computed from the full model, not from the controllable part: there rounding has grown
    over the whole staircase and may count as a coupling. The angles between the two subspaces, in contrast, are either
    right angles or far from it.
    """
    controllable, observable = controllable_split(model.A, model.B, cut), controllable_split(model.A.T, model.C.T, cut)
    _, cosines, V = np.linalg.svd(observable.basis.T @ controllable.basis)
    k = int((cosines > OVERLAP).sum())
    rest = _complement(V[:k].T)
    inside = _complement(rest)
    A = controllable.basis.T @ model.A @ controllable.basis
    uncontrollable, unobservable = modes(model.A.T, controllable.complement), modes(A, rest)
    gap = min(controllable.gap, observable.gap, _gap(cosines, OVERLAP), key=lambda g: g.ratio)
    return Kalman(
        controllable.basis @ inside,
        uncontrollable,
        (unobservable[0], controllable.basis @ unobservable[1]),
        gap,
    )


def _gap(sigma: Array, cut: float) -> Gap:
    """Return the gap around `cut` in singular values, 1 at best."""
    above = sigma > cut
    return Gap(float(sigma[above].min(initial=1.0)), float(sigma[~above].max(initial=0.0)))


def modes(A: Array, basis: Array) -> tuple[Complex, Complex]:
    """Return the eigenvalues (k,) of A (n, n) on an invariant subspace with orthonormal `basis`, and vectors (n, k)."""
    values, vectors = np.linalg.eig(basis.T @ A @ basis)
    return values.astype(np.complex128), (basis @ vectors).astype(np.complex128)


def uncontrollable_modes(model: Scaled) -> tuple[Complex, Complex]:
    """Return the uncontrollable scaled modes (k,), with left eigenvectors (n, k).

    The staircase cannot resolve modes that differ by rounding of the fastest mode; it then gives combinations that are
    not eigenvectors. Eigenvectors of A itself with w^H B = 0 replace them.
    """
    values, w = modes(model.A.T, controllable_split(model.A, model.B).complement)
    w = w / np.linalg.norm(w, axis=0)
    allowed = RESIDUAL * (np.linalg.norm(model.A, axis=0)[:, None] + np.abs(values))
    accurate = (np.abs(model.A.T @ w - values * w) <= allowed).all(axis=0)
    if accurate.all():
        return values, w
    candidates, W = modes(model.A.T, np.eye(len(model.A)))
    size = np.linalg.norm(model.B, axis=0)
    coupling = np.abs(W.T @ (model.B / np.where(size > 0, size, 1.0))).max(axis=1, initial=0.0)
    known = np.abs(candidates[:, None] - values[accurate]) <= RESIDUAL * (
        np.abs(candidates)[:, None] + np.abs(values[accurate])
    )
    new = (coupling <= COUPLING) & ~known.any(axis=1)
    return np.concatenate([values[accurate], candidates[new]]), np.hstack([w[:, accurate], W[:, new]])


@dataclass(frozen=True, eq=False)
class Zeros:
    """Finite zeros in scaled s (k,), the normal rank of the response, and directions, columns for each zero.

    With `right`, x (n, k) and u (m, k) satisfy (A - s I) x + B u = 0, C x + D u = 0. Otherwise there are fewer outputs
    than inputs: u (p, k) weights outputs, with the same equations for the transposed matrices. If the rank is below
    both numbers, no direction is defined: x and u are zero.
    """

    values: Complex
    rank: int
    x: Complex
    u: Complex
    right: bool


def zeros(A: Array, B: Array, C: Array, D: Array) -> Zeros:
    """Return the invariant zeros of scaled matrices: where the Rosenbrock matrix is below its normal rank."""
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
    undefined = np.zeros((len(A), len(values)), dtype=np.complex128)
    return Zeros(values, len(d), undefined, np.zeros((B.shape[1], len(values)), dtype=np.complex128), right)


def deflated(A: Array, B: Array, C: Array, D: Array, size: float) -> tuple[Array, Array, Array, Array, Array]:
    """Return A, B, C, D with the same finite zeros and D of full row rank, and a basis of the remaining states.

    Singular values up to `size` count as zero.
    """
    basis = np.eye(len(A))
    while True:
        U, sigma, _ = np.linalg.svd(D)
        rank = int((sigma > size).sum())
        C, D = U.T @ C, (U.T @ D)[:rank]
        _, sigma, V = np.linalg.svd(C[rank:])
        forced = int((sigma > size).sum())
        if not forced:
            return A, B, C[:rank], D, basis
        zero, free = V[:forced], V[forced:].T
        C, D = np.vstack([C[:rank] @ free, zero @ A @ free]), np.vstack([D, zero @ B])
        A, B, basis = free.T @ A @ free, free.T @ B, basis @ free


def _finite(A: Array, B: Array, C: Array, D: Array) -> tuple[Complex, Complex]:
    """Return the zeros (k,) of a square model with regular D, and their vectors (x, u) (n + m, k)."""
    if not len(A):
        return np.zeros(0, dtype=np.complex128), np.zeros((D.shape[1], 0), dtype=np.complex128)
    quiet = np.linalg.svd(np.hstack([C, D]))[2][len(D) :].T  # states and inputs with y = 0
    values, vectors = scipy.linalg.eig(np.hstack([A, B]) @ quiet, quiet[: len(A)])
    return values.astype(np.complex128), (quiet @ vectors).astype(np.complex128)


def _controllable_subspace(A: Array, B: Array, cut: float) -> tuple[Array, Gap]:
    """Return an orthonormal basis (n, k) of the controllable subspace of (A, B)."""
    size = np.linalg.norm(B, axis=0)
    new, sigma = _range(B[:, size > COUPLING] / size[size > COUPLING], cut)
    basis, sigmas = new, [sigma]
    step = A / (np.linalg.norm(A) or 1.0)
    while new.shape[1] and basis.shape[1] < len(A):
        new = step @ new
        for _ in range(2):  # twice: reorthogonalisation against rounding
            new = new - basis @ (basis.T @ new)
        new, sigma = _range(new, cut)
        basis, sigmas = np.hstack([basis, new]), [*sigmas, sigma]
    return basis, _gap(np.concatenate(sigmas), cut)


def _range(M: Array, cut: float) -> tuple[Array, Array]:
    U, sigma, _ = np.linalg.svd(M, full_matrices=False)
    return U[:, sigma > cut], sigma
