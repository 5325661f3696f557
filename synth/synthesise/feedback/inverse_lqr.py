"""Inverse LQR: the diagonal weights for which given closed-loop poles, or a given gain, are optimal.

From poles. For one input, u = K x optimal for x'Qx + R u^2, open-loop polynomial d(s) and closed-loop polynomial p(s),

    p(s) p(-s) = d(s) d(-s) + (1/R) sum_i q_i n_i(s) n_i(-s),   n_i(s) = e_i' adj(sI - A) B,  Q = diag(q)

(the symmetric root locus). Both sides are even; the coefficients of s^2 give n linear equations in the n weights. In
discrete time z and 1/z take the place of s and -s, and the left side has a factor r / R, r = R + B'XB: the n + 1
coefficients of z^k + z^-k are linear in the weights and r. The weights are unique when the polynomials n_i(s) n_i(-s)
are linearly independent. Rounded poles, as in print, give weights close to the original ones. LQR never gives poles
that do not decay, and p(s) p(-s) does not distinguish s from -s: such poles are refused, and so are negative weights.

From a gain K (m, n) for which Ac = A + B K is stable. Its cost X for Q = diag(q), R = diag(r) is linear in the weights,

    continuous  Ac'X + X Ac + Q + K'R K = 0        K is optimal when    B'X + R K = 0
    discrete    Ac'X Ac - X + Q + K'R K = 0                             B'X Ac + R K = 0

and optimality gives m n linear equations in q (n,) and r (m,), with r_1 = 1 as the scale.
"""

from collections.abc import Sequence

import numpy as np
import scipy.linalg
from numpy.typing import ArrayLike
from scipy.optimize import nnls

from synth import arguments, show
from synth.errors import ModelError, SignalError
from synth.statespace import Array, Complex, StateSpace, System, of, readonly
from synth.synthesise.feedback import weights
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


@show.result
class GainWeights:
    """The weights q (n,) and r (m,), r_1 = 1, for which a gain is optimal.

    `unique` unless `nullspace` (n + m, k) has columns, which may be added to (q, r) while these stay above zero.
    `residual` is relative.
    """

    q: Array
    r: Array
    unique: bool
    nullspace: Array
    residual: float
    states: tuple[str, ...]
    inputs: tuple[str, ...]

    def sheet(self) -> show.Sheet:
        """Return the weights by name."""
        names, values = (*self.states, *self.inputs), np.concatenate([self.q, self.r])
        return _sheet("Diagonal weights of a gain", names, values, self.nullspace, self.residual)


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


@arguments.checked
def gain_weights(system: System, K: ArrayLike) -> GainWeights:
    """Return diagonal weights for which u = K x, K (m, n), is optimal; the first input's weight is 1.

    Raises SignalError when K has the wrong shape or is not finite; ModelError when A + B K is not stable or K is not
    optimal for any weights q >= 0, r > 0.
    """
    model, K = of(system), arguments.matrix("K", K)
    n, m = model.B.shape
    if not n or not m:
        raise SignalError(f"the model has {n} states and {m} inputs: it needs at least one of each")
    if K.shape != (m, n) or not np.isfinite(K).all():
        raise SignalError(f"the gain K is {K.shape}: {m} inputs and {n} states need a finite one of {(m, n)}")
    closed = model.A + model.B @ K
    _require_stable(model, closed)
    columns = [_optimality_residual(model, closed, K, np.eye(n)[i], np.zeros(m)) for i in range(n)]
    columns += [_optimality_residual(model, closed, K, np.zeros(n), np.eye(m)[j]) for j in range(m)]
    M = np.array(columns).T
    rows = np.abs(M).max(axis=1, keepdims=True)
    M = M / np.where(rows > 0, rows, 1.0)
    free = np.arange(n + m) != n
    size = np.abs(M).max(axis=0)
    size = np.where(size > 0, size, 1.0)
    unit, rhs = (M / size)[:, free], -M[:, n]
    solution, nullspace, residual = _least_squares(unit, rhs)
    if (nullspace.size and solution.min() < 0) or solution.min() < -MAX_RESIDUAL * np.abs(solution).max(initial=1.0):
        solution, misfit = nnls(unit, rhs)
        residual = float(misfit) / _residual_scale(rhs)
    all_weights = np.insert(np.maximum(solution, 0.0) / size[free], n, 1.0)
    if residual > MAX_RESIDUAL or all_weights[n:].min() <= 0:
        raise ModelError(
            f"no diagonal weights Q >= 0, R > 0 make this gain optimal: the equations are missed by {residual:.2g} of "
            "their size; give K with more digits, or it is optimal for weights on products, or for none"
        )
    null = readonly(np.insert(nullspace / size[free][:, None], n, 0.0, axis=0))
    q, r = readonly(all_weights[:n]), readonly(all_weights[n:])
    return GainWeights(q, r, not nullspace.size, null, residual, model.states, model.inputs)


def _require_stable(model: StateSpace, closed: Array) -> None:
    poles = np.linalg.eigvals(closed)
    beyond = poles.real if isinstance(model.time, Continuous) else np.abs(poles) - 1
    if beyond.max() >= 0:
        raise ModelError(
            f"the gain leaves the pole {poles[np.argmax(beyond)]:.4g}, which does not decay: it is optimal for no "
            "weights; u = K x has the sign inside K"
        )


def _optimality_residual(model: StateSpace, closed: Array, K: Array, q: Array, r: Array) -> Array:
    """Return the left side of the optimality condition (m n,) for the weights q, r."""
    cost = np.diag(q) + (K.T * r) @ K
    if isinstance(model.time, Continuous):
        left = model.B.T @ scipy.linalg.solve_continuous_lyapunov(closed.T, -cost)
    else:
        left = model.B.T @ scipy.linalg.solve_discrete_lyapunov(closed.T, cost) @ closed
    return np.asarray(left + r[:, None] * K).ravel()


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
