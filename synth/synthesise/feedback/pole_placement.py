"""State feedback u = K x (the sign is inside K) that gives A + B K the poles asked for.

One input has one solution (Ackermann 1972), computed in ball arithmetic. With r independent inputs and no pole over r
times, the eigenvectors are made as orthogonal as they can be (Tits, Yang 1996, in SciPy). Else poles are placed one
after the other: (A - s I) v + B u = 0 is solved with the least |u| / |v|, v is split off by an orthonormal step, and
the rest is placed on what is left (Miminis, Paige 1988); of a multiple real pole up to r are taken in one step.

All steps are taken in scaled units, so that those of the signals matter by no more than a power of 2. Poles attained
are those of the rounded K, computed in ball arithmetic: what separates them from those asked for is the rounding of K.
"""

import warnings
from collections.abc import Iterator, Sequence

import flint
import numpy as np
import scipy.signal
from numpy.typing import ArrayLike
from scipy.optimize import linear_sum_assignment

from synth import arguments, show
from synth.analyse import precise, staircase, structure
from synth.errors import ModelError, SignalError
from synth.statespace import Array, Complex, StateSpace, System, of, readonly
from synth.synthesise.riccati import spectrum
from synth.timing import Continuous, Discrete, Time

PAIR = 1e-9  # of a pole's size: what differs less is a conjugate
CLOSE = 1e-8  # of the poles' size: the robust choice of eigenvectors is kept when it comes as near as this
CHEAP = 1e-2  # of the largest v beside its u: an eigenvector that asks for 100 times the gain is not taken
TURNS = 30  # of the robust choice over all pairs of poles; beyond EASY poles, a turn growing as their cube, fewer
EASY = 15
LISTED = 6  # poles that a message lists
MISSED = 1e-2  # of the poles' size: further off is refused; K's rounding moves a sixfold pole by 2e-3


@show.result
class Placement:
    """K (m, n) with the poles asked for and those attained, in 1/s or in z.

    `fixed` are the poles that no input moves. `error` is the largest distance between a pole asked for and its
    counterpart; a change dF of A + B K (scaled units) moves poles by at most `condition` |dF| (Bauer, Fike), which is
    huge where the poles of a Jordan block scatter by a root of |dF|.
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
        """Return the certificate in sentences."""
        fixed = f"; {_listed(self.fixed)} cannot be moved" if len(self.fixed) else ""
        return (
            f"Poles asked for: {_listed(self.requested)}{fixed}",
            f"Poles attained within {self.error:.1e}; condition of the eigenvectors {self.condition:.3g}",
        )

    def sheet(self) -> show.Sheet:
        """Return the certificate and K."""
        table = show.feedback(show.matrix("K", self.K, self.inputs, self.states))
        return show.Sheet(f"State feedback by poles in {self.time}", self.lines(), (table,))


@arguments.checked
def place(system: System, poles: Sequence[complex] | ArrayLike) -> Placement:
    """Return u = K x with the given poles of A + B K, (n,) less the modes that no input moves.

    Raises SignalError for poles that are not finite, too few or many, or without their conjugates; ModelError when one
    does not decay, when a mode that does not decay is moved by no input, or when double precision does not resolve K.
    """
    model = of(system)
    structure.require_stabilisable(model.A, model.B, model.states, model.inputs, model.time)
    part = staircase.scaled(model.A, model.B)
    split = staircase.split(part.A, part.B)
    fixed = staircase.modes(part.A.T, split.outside)[0] * part.rate
    wanted = _requested(poles, split.inside.shape[1], fixed, model)
    size = _size(wanted, model.time)
    found = (_placement(model, K, wanted, fixed) for K in _candidates(part, split.inside, wanted))
    best = next(found)
    while best.error > CLOSE * size and (other := next(found, None)):
        best = min(best, other, key=lambda p: p.error)
    if best.error > MISSED * size or not spectrum.decays(best.poles, model.time).all():
        raise ModelError(_missed(best))
    return best


def _requested(poles: Sequence[complex] | ArrayLike, count: int, fixed: Complex, model: StateSpace) -> Complex:
    """Return the poles with exact conjugates, reals first and then each pair."""
    try:
        given = np.atleast_1d(np.asarray(poles, dtype=np.complex128))
    except (TypeError, ValueError) as error:
        raise SignalError(f"the poles are no list of numbers ({error}): give real or complex ones") from error
    if given.ndim != 1 or not np.isfinite(given).all():
        raise SignalError(f"the poles are {given.tolist()}: give a list of finite numbers")
    if len(given) != count:
        stay = f", as {_listed(fixed)} cannot be moved" if len(fixed) else ""
        raise SignalError(
            f"the number of poles for {', '.join(model.states)} is {len(given)}: give {count}{stay}, each with its "
            "conjugate"
        )
    if not (good := spectrum.decays(given, model.time)).all():
        bound = "a negative real part" if isinstance(model.time, Continuous) else "|z| < 1"
        raise ModelError(f"the pole {show.number(given[~good][0])} does not decay: ask for poles with {bound}")
    return _paired(given)


def _paired(poles: Complex) -> Complex:
    near = np.abs(poles.imag) <= PAIR * np.abs(poles)
    real, upper = np.sort(poles[near].real), poles[~near & (poles.imag > 0)]
    lower = list(poles[~near & (poles.imag < 0)])
    for p in upper:
        match = next((q for q in lower if abs(np.conj(q) - p) <= PAIR * abs(p)), None)
        if match is None:
            raise SignalError(f"the pole {show.number(p)} stands without its conjugate: give both")
        lower.remove(match)
    if lower:
        raise SignalError(f"the pole {show.number(lower[0])} stands without its conjugate: give both")
    return np.concatenate([real.astype(np.complex128), *([p, np.conj(p)] for p in np.sort_complex(upper))])


def _missed(found: Placement) -> str:
    """Say how far the pole is off that is attained worst, and what to do."""
    wanted = np.concatenate([found.requested, found.fixed])
    distance = np.abs(found.poles[:, None] - wanted)
    there, asked = linear_sum_assignment(distance)
    k = int(np.argmax(distance[there, asked]))
    worst, pole = wanted[asked[k]], found.poles[there[k]]
    return (
        f"the poles {_listed(found.requested, LISTED)} are attained only within {found.error:.1e}, "
        f"{show.number(worst, 6)} as {show.number(pole, 6)}, as double precision does not resolve the gain: spread the "
        "poles, ask for slower ones or use the Riccati equation"
    )


def _candidates(part: staircase.Scaled, inside: Array, poles: Complex) -> Iterator[Array]:
    """Give gains (m, n) in the model's units, each computed when asked for; of two the robust one comes first."""
    A, wanted = inside.T @ part.A @ inside, poles / part.rate
    B, inward = _independent(inside.T @ part.B)
    rank = B.shape[1]

    def outward(K: Array) -> Array:
        return np.asarray(part.u[:, None] * (inward @ K @ inside.T) / part.x)

    if not len(A):
        yield outward(np.zeros((rank, 0)))
    elif rank == 1:
        yield outward(ackermann(A, B, wanted))
    else:
        if max(np.sum(wanted == p) for p in wanted) <= rank:
            yield outward(_robust(A, B, wanted))
        yield outward(_deflated(A, B, list(wanted[wanted.imag >= 0])))


def _independent(B: Array) -> tuple[Array, Array]:
    """Return B E of full column rank and E (m, r), orthonormal; one input stays as it is."""
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

    return precise.resolved(compute, "the gain")


def _robust(A: Array, B: Array, poles: Complex) -> Array:
    """Return U X^-1 for SciPy's eigenvectors X, each brought to where (A - s I) x + B u = 0 holds to rounding."""
    n = len(A)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UserWarning)  # of slow convergence: the certificate tells what was attained
        found = scipy.signal.place_poles(A, B, poles, maxiter=max(1, int(TURNS * min(1.0, EASY / n) ** 3)))
    X, U = np.zeros((n, n), dtype=np.complex128), np.zeros((B.shape[1], n), dtype=np.complex128)
    for k, s in enumerate(found.requested_poles):
        null = _null(A, B, complex(s))
        share = np.linalg.lstsq(null[:n], found.X[:, k], rcond=None)[0]
        X[:, k], U[:, k] = null[:n] @ share, null[n:] @ share
    return np.asarray(np.linalg.lstsq(X.T, U.T, rcond=None)[0].T.real, dtype=np.float64)


def _deflated(A: Array, B: Array, poles: list[complex]) -> Array:
    """Return K (m, n) that places the poles, those with a positive imaginary part for their pairs, step by step."""
    if not poles:
        return np.zeros((B.shape[1], 0))
    s = poles[-1]
    V, U = _pair(A, B, s) if s.imag else _eigenvectors(A, B, s, poles.count(s))
    width = V.shape[1]
    rest = poles[: len(poles) - (1 if s.imag else width)]
    Q, R = np.linalg.qr(V, mode="complete")
    first, free = Q[:, :width], Q[:, width:]
    K = np.linalg.solve(R[:width].T, U.T).T
    return K @ first.T + _deflated(free.T @ A @ free, free.T @ B, rest) @ free.T


def _eigenvectors(A: Array, B: Array, s: complex, most: int) -> tuple[Array, Array]:
    """Return V (n, k) and U (m, k) with A V + B U = s V, k <= `most`: of a multiple pole all that cost little."""
    null = _null(A, B, s)
    _, sigma, turn = np.linalg.svd(null[: len(A)])
    count = min(most, int((sigma > CHEAP * sigma[0]).sum()))
    w = null @ turn[:count].T
    return w[: len(A)], w[len(A) :]


def _pair(A: Array, B: Array, s: complex) -> tuple[Array, Array]:
    """Return V (n, 2) and U (m, 2) with A V + B U = V S, S having the pole s and its conjugate."""
    n, null = len(A), _null(A, B, s)
    w = null @ np.linalg.svd(null[:n])[2].conj().T  # the least |u| / |v| first
    # Real and imaginary part must span a plane; where the first choice is nearly real another one does.
    choices = [w[:, 0], *(w[:, 0] + f * w[:, k] for k in range(1, w.shape[1]) for f in (1.0, 1.0j))]
    best = max(choices, key=lambda c: _flatness(c[:n]))
    return np.column_stack([best[:n].real, best[:n].imag]), np.column_stack([best[n:].real, best[n:].imag])


def _null(A: Array, B: Array, s: complex) -> Complex:
    """Return an orthonormal basis (n + m, m) of the (v, u) with (A - s I) v + B u = 0, real for a real s."""
    pencil = np.hstack([A - (s if s.imag else s.real) * np.eye(len(A)), B])
    return np.linalg.svd(pencil)[2][len(A) :].conj().T


def _flatness(v: Complex) -> float:
    sigma = np.linalg.svd(np.column_stack([v.real, v.imag]), compute_uv=False)
    return float(sigma[1] / sigma[0]) if sigma[0] else 0.0


def closed(model: StateSpace, K: Array) -> flint.arb_mat:
    """Return A + B K without rounding, in the precision in force."""
    return spectrum.ball(model.A) + spectrum.ball(model.B) * spectrum.ball(K)


def _placement(model: StateSpace, K: Array, requested: Complex, fixed: Complex) -> Placement:
    with precise.precision():
        loop = closed(model, K)
        poles, F = spectrum.of(loop), precise.rounded(loop)
    distance = np.abs(poles[:, None] - np.concatenate([requested, fixed]))
    error = float(distance[linear_sum_assignment(distance)].max(initial=0.0))
    part = staircase.scaled(model.A, model.B)
    vectors = np.linalg.eig(F * part.x / part.x[:, None])[1]
    condition = float(np.linalg.cond(vectors)) if len(vectors) else 1.0
    return Placement(readonly(K), requested, fixed, poles, error, condition, model.states, model.inputs, model.time)


def _size(poles: Complex, time: Time) -> float:
    return 1.0 if isinstance(time, Discrete) else float(np.abs(poles).max(initial=0.0))


def _listed(poles: Complex, most: int | None = None) -> str:
    more = [f"and {len(poles) - most} more"] if most is not None and len(poles) > most else []
    return ", ".join([*(show.number(p, 6) for p in poles[:most]), *more])
