"""Inverse LQR: the diagonal weights for which given closed-loop poles are optimal.

For one input, u = K x optimal for x'Qx + R u^2, open-loop polynomial d(s) and closed-loop polynomial p(s),

    p(s) p(-s) = d(s) d(-s) + (1/R) sum_i q_i n_i(s) n_i(-s),   n_i(s) = e_i' adj(sI - A) B,  Q = diag(q)

(the symmetric root locus). Both sides are even; the coefficients of s^2 give n linear equations in the n weights. In
discrete time z and 1/z take the place of s and -s, and the left side has a factor r / R, r = R + B'XB: the n + 1
coefficients of z^k + z^-k are linear in the weights and r. The weights are unique when the polynomials n_i(s) n_i(-s)
are linearly independent. Rounded poles, as in print, give weights close to the original ones. LQR never gives poles
that do not decay, and p(s) p(-s) does not distinguish s from -s: such poles are refused, and so are negative weights.
"""

from collections.abc import Sequence

import numpy as np
from scipy.optimize import nnls

from synth import arguments, show
from synth.errors import ModelError, SignalError
from synth.statespace import Array, Complex, StateSpace, System, of, readonly
from synth.synthesise.riccati import weights
from synth.synthesise.riccati.equation import decays
from synth.timing import Continuous

RANK = 1e-10  # of the largest singular value: a smaller one is the rounding error of zero
MAX_RESIDUAL = 1e-8  # of the size of the equations: a larger residual means that there are no weights
MIN_EQUATION_SIZE = 1e-5  # of the terms: the least size of the equations, below which it is rounding error
NEGATIVE = 1e-9  # of the terms: a negative weight that adds less is the rounding error of zero


@show.result
class DiagonalWeights:
    """The weights q (n,) for R; `unique` unless `nullspace` (n, k) has columns; `residual` is relative."""

    q: Array
    R: float
    unique: bool
    nullspace: Array
    residual: float
    states: tuple[str, ...]

    def sheet(self) -> show.Sheet:
        """Return the weights by name."""
        return _sheet(f"Diagonal weights for R = {self.R:g}", self.states, self.q, self.nullspace, self.residual)


def _sheet(title: str, names: Sequence[str], values: Array, nullspace: Array, residual: float) -> show.Sheet:
    free = [f"free {k + 1}" for k in range(nullspace.shape[1])]
    uniqueness = "they are unique" if not free else f"{len(free)} combinations of them change nothing"
    table = show.matrix("", np.column_stack([values, nullspace]), names, ["weight", *free])
    return show.Sheet(title, (f"The equations are missed by {residual:.1e} of their size; {uniqueness}.",), (table,))


@arguments.checked
def diagonal_weights(system: System, poles: Sequence[complex], R: float = 1.0) -> DiagonalWeights:
    """Return the diagonal weights whose optimal loop has `poles` (n,), in rad/s or in z, for a model of one input.

    Raises SignalError for no state, several inputs, a wrong number of poles, non-numeric poles or poles that are not in
    conjugate pairs, or R <= 0; ModelError when no diagonal weights >= 0 give the poles.
    """
    model = of(system)
    closed_loop_poles, R = _check_poles(model, poles), _input_weight(R)
    M, rhs, size = _root_locus_equations(model, closed_loop_poles, R)
    solution, nullspace, residual = _least_squares(M, rhs)
    if residual > MAX_RESIDUAL:
        raise ModelError(
            f"no diagonal weights give the poles {_text(closed_loop_poles)}: the symmetric root locus is missed by "
            f"{residual:.2g} of its size; weight products of states too, or check the poles"
        )
    n, lowest = len(model.states), -NEGATIVE * np.abs(solution).max(initial=1.0)
    if solution.min() < lowest and nullspace.size:
        nonnegative, misfit = nnls(M, rhs)
        solution = nonnegative if misfit <= MAX_RESIDUAL * _residual_scale(rhs) else solution
    q, null = solution[:n] / size[:n], nullspace[:n] / size[:n, None]
    if solution[:n].min() < lowest:
        i = int(np.argmin(solution[:n]))
        raise ModelError(
            f"the poles {_text(closed_loop_poles)} need the weight {q[i]:.4g} on {model.states[i]}, but LQR takes "
            "none below 0: check the poles, or give them with more digits where that weight should be 0"
        )
    null = null / np.linalg.norm(null, axis=0)
    return DiagonalWeights(readonly(np.maximum(q, 0.0)), R, not null.size, readonly(null), residual, model.states)


def _root_locus_equations(model: StateSpace, poles: Complex, R: float) -> tuple[Array, Array, Array]:
    """Return the equations M v = w, relative to their absolute terms, and the sizes s with v = s (q, r).

    r is an unknown in discrete time only.
    """
    continuous = isinstance(model.time, Continuous)
    p, d = (np.real(np.poly(v)) for v in (poles, np.linalg.eigvals(model.A)))
    after, before = _symmetric_product(p, continuous), _symmetric_product(d, continuous)
    columns = np.array([_symmetric_product(row, continuous) for row in _numerators(model)]).T
    terms = R * sum(_symmetric_product(np.abs(v), continuous, 1.0) for v in (p, d))
    if not continuous:
        columns, after = np.column_stack([columns, -after]), np.zeros_like(after)
    terms = np.where(terms > 0, terms, R)
    M = columns / terms[:, None]
    size = np.abs(M).max(axis=0)
    size[size == 0] = 1.0
    if not np.isfinite(terms).all():
        raise ModelError("the characteristic polynomials overflow: choose a unit of time in which the poles are near 1")
    return M / size, R * (after - before) / terms, size


def _least_squares(columns: Array, rhs: Array) -> tuple[Array, Array, float]:
    """Return the least-squares solution, the null space and the relative residual."""
    U, sigma, Vt = np.linalg.svd(columns)
    rank = int(np.sum(sigma > RANK * sigma[0]))
    solution = Vt[:rank].T @ ((U[:, :rank].T @ rhs) / sigma[:rank])
    return solution, Vt[rank:].T, float(np.linalg.norm(columns @ solution - rhs)) / _residual_scale(rhs)


def _residual_scale(rhs: Array) -> float:
    """Return the size to which the residual of the equations is relative."""
    return max(float(np.linalg.norm(rhs)), MIN_EQUATION_SIZE)


def _check_poles(model: StateSpace, poles: Sequence[complex]) -> Complex:
    """Return the poles (n,) as an array; raise an error if no optimal loop of one input can have them."""
    n, m = model.B.shape
    try:
        array = np.asarray(poles, dtype=np.complex128)
    except (TypeError, ValueError) as error:
        raise SignalError(f"the poles are not numbers ({error}): give a list of {n}") from error
    if m != 1 or not n or array.shape != (n,) or not np.isfinite(array).all():
        raise SignalError(
            f"need a model of 1 input, with states, and {n} finite poles: found {m} inputs and poles "
            f"{_text(array.ravel())}"
        )
    continuous = isinstance(model.time, Continuous)
    for s in array:
        if not decays(np.array([s]), continuous):
            beyond = "Re >= 0" if continuous else "|z| >= 1"
            raise ModelError(f"no weights give the pole {s:.4g}: an optimal loop has none with {beyond}")
    if not np.array_equal(np.sort_complex(array), np.sort_complex(array.conj())):
        raise SignalError(f"the poles {_text(array)} are not in conjugate pairs: give both of each pair")
    return array


def _text(poles: Complex) -> str:
    return f"[{', '.join(show.number(s) for s in poles)}]"


def _input_weight(R: float) -> float:
    """Return the weight of the single input."""
    value = weights.definite("R", [R], ["the input"])
    return float(value[0, 0])


def _numerators(model: StateSpace) -> list[Array]:
    """Return n_i(s), highest power first, length n + 1, from the Faddeev-LeVerrier recursion for adj(sI - A) B."""
    n = len(model.A)
    M, columns = np.eye(n), [np.zeros(n), model.B[:, 0]]
    for k in range(1, n):
        AM = model.A @ M
        M = AM - np.trace(AM) / k * np.eye(n)
        columns.append(M @ model.B[:, 0])
    return list(np.array(columns).T)


def _symmetric_product(polynomial: Array, continuous: bool, sign: float = -1.0) -> Array:
    """Return the coefficients of p(s) p(sign s) as a polynomial in s^2, or of p(z) p(1/z) in z^k + z^-k.

    The highest power comes first.
    """
    if not continuous:
        return np.convolve(polynomial, polynomial[::-1])[: len(polynomial)]
    return np.convolve(polynomial, polynomial * sign ** np.arange(len(polynomial) - 1, -1, -1))[::2]
