"""Pole placement (MATLAB `place`, `acker`): u = K x (the sign is inside K) with the desired poles of A + B K.

One input has one solution (Ackermann 1972), computed in ball arithmetic. With r independent inputs and no pole of
multiplicity above r, the eigenvectors are made as orthogonal as possible (Tits, Yang 1996, in SciPy). Otherwise the
poles are placed one after the other (Miminis, Paige 1988): (A - s I) v + B u = 0 is solved with the least |u| / |v|, an
orthogonal step deflates v, and the remaining poles are placed on the rest. Up to r copies of a multiple real pole are
placed in one step.

All steps are taken in scaled units, which makes the result independent of units up to a power of 2. The attained poles
are those of the rounded K, computed in ball arithmetic: they differ from the desired ones by the rounding of K only.
"""

import warnings
from collections.abc import Iterator, Sequence

import flint
import numpy as np
import scipy.signal
from numpy.typing import ArrayLike
from scipy.optimize import linear_sum_assignment

from synth import arguments, show
from synth.analyse.numerics import precise
from synth.analyse.structure import staircase, structure
from synth.errors import ModelError, SignalError
from synth.statespace import Array, Complex, StateSpace, System, of, readonly
from synth.synthesise.riccati import exact
from synth.timing import Continuous, Discrete, Time

CONJUGATE_TOLERANCE = 1e-9  # of a pole's size: conjugates may differ by this
ROBUST_TOLERANCE = 1e-8  # of the poles' size: below this error the first candidate, with robust eigenvectors, is taken
MIN_STATE_PER_INPUT = 1e-2  # of the largest |v| / |u|: an eigenvector that needs 100 times the gain is not taken
MAX_SWEEPS = 30  # of the robust method over all pairs of poles; fewer beyond SWEPT_POLES poles: the time grows as n^3
SWEPT_POLES = 15
MAX_LISTED = 6  # number of poles that a message lists
MAX_ERROR = 1e-2  # of the poles' size: a larger error is refused; rounding of K shifts a sixfold pole by 2e-3

POLE_ROUNDING = 1e-15  # of |A|: a smaller uncontrollable pole in z is the rounding error of 0


@show.result
class Placement:
    """K (m, n) with the poles asked for and those attained, in 1/s or in z.

    `fixed` are the uncontrollable poles. `error` is the largest distance between a desired pole and its counterpart. A
    change dF of A + B K (scaled units) shifts poles by at most `condition` |dF| (Bauer, Fike); the condition is huge
    for a Jordan block, whose poles scatter by a root of |dF|.
    """

    K: Array
    requested: Complex
    fixed: Complex
    poles: Complex
    error: float
    condition: float
    states: tuple[str, ...]
    inputs: tuple[str, ...]
    time: Time

    def lines(self) -> tuple[str, ...]:
        """Return the certificate as text."""
        fixed = f"; uncontrollable: {_text(self.fixed)}" if len(self.fixed) else ""
        return (
            f"Poles asked for: {_text(self.requested)}{fixed}",
            f"Poles attained within {self.error:.1e}; condition of the eigenvectors {self.condition:.3g}",
        )

    def sheet(self) -> show.Sheet:
        """Return the certificate and K."""
        table = show.feedback(show.matrix("K", self.K, self.inputs, self.states))
        return show.Sheet(f"State feedback by poles in {self.time}", self.lines(), (table,))


@arguments.checked
def place(system: System, poles: Sequence[complex] | ArrayLike) -> Placement:
    """Return u = K x with the desired poles of A + B K, (n,) less the uncontrollable modes.

    Raises SignalError for poles that are not finite, too few or many, or without their conjugates; ModelError when one
    does not decay, when (A, B) is not stabilisable, or when double precision does not resolve K.
    """
    model = of(system)
    structure.require_stabilisable(model.A, model.B, model.states, model.inputs, model.time)
    part = staircase.scaled(model.A, model.B)
    split = staircase.controllable_split(part.A, part.B)
    fixed = staircase.modes(part.A.T, split.complement)[0] * part.rate
    if isinstance(model.time, Discrete):
        fixed = _without_rounding(fixed, POLE_ROUNDING * part.rate * float(np.linalg.norm(part.A)))
    requested = _check_poles(poles, split.basis.shape[1], fixed, model)
    size = _pole_scale(requested, model.time)
    placements = (_placement(model, K, requested, fixed) for K in _candidates(part, split.basis, requested))
    best = next(placements)
    while best.error > ROBUST_TOLERANCE * size and (other := next(placements, None)):
        best = min(best, other, key=lambda p: p.error)
    if best.error > MAX_ERROR * size:
        raise ModelError(_inaccuracy_message(best))
    if not (decays := exact.decays(best.poles, model.time)).all():
        raise ModelError(_decay_message(best, best.poles[~decays]))
    return best


def _without_rounding(poles: Complex, least: float) -> Complex:
    """Return the poles with 0 for real and imaginary parts up to `least`."""
    real, imaginary = (np.where(np.abs(part) > least, part, 0.0) for part in (poles.real, poles.imag))
    return np.asarray(real + 1j * imaginary, dtype=np.complex128)


def _check_poles(poles: Sequence[complex] | ArrayLike, count: int, fixed: Complex, model: StateSpace) -> Complex:
    """Return the poles with exact conjugates, real ones first and then each pair."""
    try:
        array = np.atleast_1d(np.asarray(poles, dtype=np.complex128))
    except (TypeError, ValueError) as error:
        raise SignalError(f"the poles are not a list of numbers ({error}): give real or complex ones") from error
    if array.ndim != 1 or not np.isfinite(array).all():
        raise SignalError(f"the poles are {array.tolist()}: give a list of finite numbers")
    if len(array) != count:
        without = f" without the uncontrollable {_text(fixed)}" if len(fixed) else ""
        raise SignalError(
            f"the number of poles for {', '.join(model.states)} is {len(array)}: give {count}{without}, each with its "
            "conjugate"
        )
    if not (decaying := exact.decays(array, model.time)).all():
        bound = "a negative real part" if isinstance(model.time, Continuous) else "|z| < 1"
        raise ModelError(f"the pole {show.number(array[~decaying][0])} does not decay: ask for poles with {bound}")
    return _paired(array)


def _paired(poles: Complex) -> Complex:
    is_real = np.abs(poles.imag) <= CONJUGATE_TOLERANCE * np.abs(poles)
    real, upper = np.sort(poles[is_real].real), poles[~is_real & (poles.imag > 0)]
    lower = list(poles[~is_real & (poles.imag < 0)])
    for p in upper:
        match = next((q for q in lower if abs(np.conj(q) - p) <= CONJUGATE_TOLERANCE * abs(p)), None)
        if match is None:
            raise SignalError(f"the pole {show.number(p)} has no conjugate: give both")
        lower.remove(match)
    if lower:
        raise SignalError(f"the pole {show.number(lower[0])} has no conjugate: give both")
    return np.concatenate([real.astype(np.complex128), *([p, np.conj(p)] for p in np.sort_complex(upper))])


def _inaccuracy_message(placement: Placement) -> str:
    """Return the error text for the pole with the largest error."""
    requested = np.concatenate([placement.requested, placement.fixed])
    distance = np.abs(placement.poles[:, None] - requested)
    columns_attained, columns_requested = linear_sum_assignment(distance)
    k = int(np.argmax(distance[columns_attained, columns_requested]))
    worst, pole = requested[columns_requested[k]], placement.poles[columns_attained[k]]
    return (
        f"the poles {_text(placement.requested, MAX_LISTED)} are attained only within {placement.error:.1e}, "
        f"{show.number(worst, 6)} as {show.number(pole, 6)}, as double precision does not resolve the gain: spread the "
        "poles, ask for slower ones or use the Riccati equation"
    )


def _decay_message(placement: Placement, lasting: Complex) -> str:
    """Return the error text for poles that do not decay beyond rounding errors."""
    pole = lasting[0]
    least = structure.DECAY * np.abs(placement.poles).max()
    bound = f"{least:.1e} 1/s" if isinstance(placement.time, Continuous) else f"{structure.DECAY:.0e} inside |z| = 1"
    distance = np.abs(pole - placement.fixed)
    if distance.size and distance.min() <= np.abs(pole - placement.requested).min(initial=np.inf):
        return (
            f"the uncontrollable mode {show.number(pole, 6)} does not decay by more than the rounding errors beside "
            f"the pole {show.number(max(placement.poles, key=abs), 6)}, {bound}: actuate that mode, take it out of "
            "the model or ask for slower poles"
        )
    return (
        f"the pole {show.number(pole, 6)} is attained, but does not decay by more than rounding errors, {bound}: ask "
        "for a faster one"
    )


def _candidates(part: staircase.Scaled, basis: Array, poles: Complex) -> Iterator[Array]:
    """Yield gains (m, n) in the model's units, the robust one first."""
    A, scaled_poles = basis.T @ part.A @ basis, poles / part.rate
    B, input_basis = _independent_inputs(basis.T @ part.B)
    rank = B.shape[1]

    def in_model_units(K: Array) -> Array:
        return np.asarray(part.u[:, None] * (input_basis @ K @ basis.T) / part.x)

    if not len(A):
        yield in_model_units(np.zeros((rank, 0)))
    elif rank == 1:
        yield in_model_units(ackermann(A, B, scaled_poles))
    else:
        if max(np.sum(scaled_poles == p) for p in scaled_poles) <= rank:
            yield in_model_units(_place_robustly(A, B, scaled_poles))
        yield in_model_units(_place_by_deflation(A, B, list(scaled_poles[scaled_poles.imag >= 0])))


def _independent_inputs(B: Array) -> tuple[Array, Array]:
    """Return B E of full column rank and E (m, r), orthonormal; a single input is unchanged."""
    if B.shape[1] == 1:
        return B, np.eye(1)
    U, sigma, V = np.linalg.svd(B, full_matrices=False)
    rank = int((sigma > staircase.COUPLING * sigma.max(initial=0.0)).sum())
    return U[:, :rank] * sigma[:rank], V[:rank].T


def ackermann(A: Array, b: Array, poles: Complex) -> Array:
    """Return -e_n' [b, A b, ..]^-1 phi(A) (1, n), phi the polynomial of the poles, rounded once."""
    n = len(A)

    def compute() -> flint.arb_mat:
        a, column, phi, one = precise.matrix(A), precise.matrix(b), precise.identity(n), precise.identity(n)
        columns = []
        for _ in range(n):
            columns.append(column.entries())
            column = a * column
        for p in poles[poles.imag >= 0]:
            s = flint.arb(p.real)
            phi = phi * (a - one * s if not p.imag else (a - one * s) ** 2 + one * flint.arb(p.imag) ** 2)
        last = flint.arb_mat([[flint.arb(-(i == n - 1))] for i in range(n)])
        return flint.arb_mat(columns).solve(last).transpose() * phi

    return precise.round_correctly(compute, "the gain")


def _place_robustly(A: Array, B: Array, poles: Complex) -> Array:
    """Return U X^-1 for SciPy's eigenvectors X, each projected onto (A - s I) x + B u = 0."""
    n = len(A)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UserWarning)  # slow convergence: the certificate states the attained poles
        placed = scipy.signal.place_poles(A, B, poles, maxiter=max(1, int(MAX_SWEEPS * min(1.0, SWEPT_POLES / n) ** 3)))
    X, U = np.zeros((n, n), dtype=np.complex128), np.zeros((B.shape[1], n), dtype=np.complex128)
    for k, s in enumerate(placed.requested_poles):
        null = _null_space(A, B, complex(s))
        coordinates = np.linalg.lstsq(null[:n], placed.X[:, k], rcond=None)[0]
        X[:, k], U[:, k] = null[:n] @ coordinates, null[n:] @ coordinates
    return np.asarray(np.linalg.lstsq(X.T, U.T, rcond=None)[0].T.real, dtype=np.float64)


def _place_by_deflation(A: Array, B: Array, poles: list[complex]) -> Array:
    """Return K (m, n) that places the poles one by one; one with a positive imaginary part represents its pair."""
    if not poles:
        return np.zeros((B.shape[1], 0))
    s = poles[-1]
    V, U = _pair(A, B, s) if s.imag else _eigenvectors(A, B, s, poles.count(s))
    width = V.shape[1]
    remaining = poles[: len(poles) - (1 if s.imag else width)]
    Q, R = np.linalg.qr(V, mode="complete")
    first, free = Q[:, :width], Q[:, width:]
    K = np.linalg.solve(R[:width].T, U.T).T
    return K @ first.T + _place_by_deflation(free.T @ A @ free, free.T @ B, remaining) @ free.T


def _eigenvectors(A: Array, B: Array, s: complex, limit: int) -> tuple[np.ndarray, np.ndarray]:
    """Return V (n, k) and U (m, k) with A V + B U = s V, k <= `limit`: those with moderate |u| / |v|."""
    null = _null_space(A, B, s)
    _, sigma, V = np.linalg.svd(null[: len(A)])
    count = min(limit, int((sigma > MIN_STATE_PER_INPUT * sigma[0]).sum()))
    w = null @ V[:count].T
    return w[: len(A)], w[len(A) :]


def _pair(A: Array, B: Array, s: complex) -> tuple[Array, Array]:
    """Return V (n, 2) and U (m, 2) with A V + B U = V S; S has the poles s and its conjugate."""
    n, null = len(A), _null_space(A, B, s)
    w = null @ np.linalg.svd(null[:n])[2].conj().T  # the least |u| / |v| first
    # Real and imaginary part must span a plane; other choices serve where the first one is nearly real.
    choices = [w[:, 0], *(w[:, 0] + f * w[:, k] for k in range(1, w.shape[1]) for f in (1.0, 1.0j))]
    best = max(choices, key=lambda c: _flatness(c[:n]))
    return np.column_stack([best[:n].real, best[:n].imag]), np.column_stack([best[n:].real, best[n:].imag])


def _null_space(A: Array, B: Array, s: complex) -> Complex:
    """Return an orthonormal basis (n + m, m) of the (v, u) with (A - s I) v + B u = 0, real for a real s."""
    pencil = np.hstack([A - (s if s.imag else s.real) * np.eye(len(A)), B])
    return np.linalg.svd(pencil)[2][len(A) :].conj().T


def _flatness(v: Complex) -> float:
    sigma = np.linalg.svd(np.column_stack([v.real, v.imag]), compute_uv=False)
    return float(sigma[1] / sigma[0]) if sigma[0] else 0.0


def closed_loop_matrix(model: StateSpace, K: Array) -> flint.arb_mat:
    """Return A + B K without rounding, in the precision in force."""
    return exact.ball(model.A) + exact.ball(model.B) * exact.ball(K)


def _placement(model: StateSpace, K: Array, requested: Complex, fixed: Complex) -> Placement:
    with precise.precision():
        loop = closed_loop_matrix(model, K)
        poles, F = exact.eigenvalues(loop), precise.rounded(loop)
    distance = np.abs(poles[:, None] - np.concatenate([requested, fixed]))
    error = float(distance[linear_sum_assignment(distance)].max(initial=0.0))
    part = staircase.scaled(model.A, model.B)
    vectors = np.linalg.eig(F * part.x / part.x[:, None])[1]
    condition = float(np.linalg.cond(vectors)) if len(vectors) else 1.0
    return Placement(readonly(K), requested, fixed, poles, error, condition, model.states, model.inputs, model.time)


def _pole_scale(poles: Complex, time: Time) -> float:
    return 1.0 if isinstance(time, Discrete) else float(np.abs(poles).max(initial=0.0))


def _text(poles: Complex, limit: int | None = None) -> str:
    more = [f"and {len(poles) - limit} more"] if limit is not None and len(poles) > limit else []
    return ", ".join([*(show.number(p, 6) for p in poles[:limit]), *more])
