"""The regulator equations (Francis 1977): the steady state in which the regulated outputs have no error.

    w' = S w        x' = A x + B u + E w        e = C x + D u + F w           (x+ and w+ in discrete time)

    Pi S = A Pi + B Gamma + E,    0 = C Pi + D Gamma + F

for A (n, n), B (n, m), C (p, n), S (q, q), E (n, q), F (p, q). On x = Pi w, u = Gamma w the error is zero. With any K
for which A + B K is stable, u = K x + (Gamma - K Pi) w converges to it from every state (full information).

A solution exists for all E and F when no mode s of S is a transmission zero: the Rosenbrock matrix
[[A - s I, B], [C, D]] must have full row rank n + p. If it has not, its left null vector (v, y) gives the combination
y^H e of the errors that no input affects at s. With more inputs than errors, the solution has the least norm of
Gamma.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import scipy.linalg
from numpy.typing import ArrayLike

from synth import arguments, show
from synth.analyse import staircase, structure
from synth.analyse.equilibrate import equilibrated
from synth.errors import ModelError, SignalError
from synth.statespace import Array, StateSpace, System, of, readonly
from synth.synthesise.regulation import minimal_polynomial
from synth.timing import Continuous, Time

MAX_RESIDUAL = 1e-9  # of the terms of an equation: above this residual there is no solution
TERM_FLOOR = 1e-5  # of the largest term: the size given to an equation whose own terms are smaller, as rounding shows


@show.result
class SteadyState:
    """x = Pi w and u = Gamma w: Pi (n, q), Gamma (m, q); `residual` of both equations is relative to their terms."""

    Pi: Array
    Gamma: Array
    residual: float
    states: tuple[str, ...]
    inputs: tuple[str, ...]

    def feedforward(self, K: ArrayLike) -> Array:
        """Return Gamma - K Pi (m, q), the feedforward gain on w for the state feedback u = K x; K (m, n).

        Raises SignalError for a K of another shape.
        """
        gain = arguments.matrix("K", K)
        if gain.shape != (len(self.inputs), len(self.states)):
            raise SignalError(f"K is {gain.shape}: give {(len(self.inputs), len(self.states))}, inputs by states")
        return readonly(self.Gamma - gain @ self.Pi)

    def sheet(self) -> show.Sheet:
        """Return both matrices by signal."""
        w = tuple(f"w{k + 1}" for k in range(self.Pi.shape[1]))
        tables = (show.matrix("state", self.Pi, self.states, w), show.matrix("input", self.Gamma, self.inputs, w))
        return show.Sheet("Steady state x = Pi w, u = Gamma w", (f"Residual {self.residual:.1e}",), tables)


@arguments.checked
def solve(system: System, S: ArrayLike, E: ArrayLike, F: ArrayLike) -> SteadyState:
    """Return the steady state of a model whose inputs all act and whose outputs are all regulated.

    S (q, q) is in the model's time; w enters the states through E (n, q) and the errors through F (p, q).

    Raises SignalError for matrices of the wrong shape or not finite; ModelError when there is no solution, naming the
    mode and the combination of outputs if a transmission zero is the reason.
    """
    model = of(system)
    S, E, F = _check_matrices(model, S, E, F)
    equations = _equations(model, S, E, F)
    z = equations.solve()
    residual = equations.residual(z)
    if not residual <= MAX_RESIDUAL:
        if len(model.inputs) >= len(model.outputs):
            require_no_zero(model, np.linalg.eigvals(S).tolist())
        raise ModelError(
            f"the regulator equations have no solution: {residual:.0e} of their terms is left; let fewer outputs be "
            f"regulated than {', '.join(model.outputs)}, or more inputs act than {', '.join(model.inputs)}"
        )
    X = (equations.size * z).reshape(len(S), -1).T
    n = len(model.A)
    return SteadyState(readonly(X[:n]), readonly(X[n:]), residual, model.states, model.inputs)


@arguments.checked
def require_solvable(model: StateSpace, modes: Sequence[minimal_polynomial.Mode]) -> None:
    """Raise ModelError, with the reason, unless the model's inputs can regulate all its outputs at all `modes`.

    The conditions are at least as many inputs as outputs, stabilisability, and no transmission zero at a mode of the
    exosystem (in 1/s, also for a sampled model).
    """
    if len(model.inputs) < len(model.outputs):
        raise ModelError(
            f"{len(model.outputs)} outputs ({', '.join(model.outputs)}) cannot be regulated by {len(model.inputs)} "
            f"inputs ({', '.join(model.inputs)}): regulate fewer or add actuators"
        )
    structure.check_stabilisable(model)
    require_no_zero(model, [_point(mode.value, model.time) for mode in modes])


@arguments.checked
def require_no_zero(model: StateSpace, points: Sequence[complex]) -> None:
    """Raise ModelError for a transmission zero at one of the `points`, in 1/s or in z, naming the blocked outputs."""
    for point in points:
        blocked = _blocked_outputs(model, point)
        if blocked is not None:
            raise ModelError(
                f"the plant from {', '.join(model.inputs)} to {', '.join(model.outputs)} has a transmission zero at "
                f"{_mode_text(point, model.time)} of the exosystem: it cannot be regulated there, as no input affects "
                f"{structure.direction_text(blocked)}; drop it, regulate other outputs or change the actuators"
            )


def _point(s: complex, time: Time) -> complex:
    return complex(s) if isinstance(time, Continuous) else complex(np.exp(s * time.period_s))


def _mode_text(point: complex, time: Time) -> str:
    s = point if isinstance(time, Continuous) else np.log(point) / time.period_s
    if abs(s.real) <= 1e-9 * abs(s):
        return f"{abs(s.imag):g} rad/s, a frequency"
    return f"{show.number(s)} 1/s, a mode"


def _blocked_outputs(model: StateSpace, point: complex) -> dict[str, complex] | None:
    """Return the combination of outputs that no input affects at a point, None when there is none."""
    n = len(model.A)
    R, rows, _ = equilibrated(np.block([[model.A - point * np.eye(n), model.B], [model.C, model.D]]))
    U, sigma, _ = np.linalg.svd(R)
    if len(sigma) == len(R) and sigma[-1] > staircase.COUPLING * sigma[0]:
        return None
    return structure.direction(np.asarray((rows * U[:, -1].conj())[n:], dtype=np.complex128), model.outputs)


def _check_matrices(model: StateSpace, S: ArrayLike, E: ArrayLike, F: ArrayLike) -> tuple[Array, Array, Array]:
    matrices = [arguments.matrix(name, value) for name, value in (("S", S), ("E", E), ("F", F))]
    q = len(matrices[0])
    for name, value, shape in zip("SEF", matrices, ((q, q), (len(model.A), q), (len(model.C), q)), strict=True):
        if value.shape != shape or not np.isfinite(value).all():
            raise SignalError(f"{name} is {value.shape}: an exosystem of order {q} needs a finite one of {shape}")
    return matrices[0], matrices[1], matrices[2]


@dataclass(frozen=True, eq=False)
class _Equations:
    """M z = b, scaled; z holds the columns of [Pi; Gamma], stacked and divided by `size`."""

    M: Array
    b: Array
    size: Array
    is_gamma: Array  # of each entry of z

    def solve(self) -> Array:
        """Return z with the least norm of Gamma among the least squares solutions."""
        z = self._least_squares(self.b)
        z = z + self._least_squares(self.b - self.M @ z)
        if self.M.shape[0] < self.M.shape[1]:
            Z = scipy.linalg.null_space(self.M, rcond=staircase.COUPLING)
            scale = self.size[self.is_gamma]
            t = np.linalg.lstsq(scale[:, None] * Z[self.is_gamma], -scale * z[self.is_gamma], rcond=None)[0]
            z = z + Z @ t
        return z

    def residual(self, z: Array) -> float:
        """Return the largest residual of an equation, relative to the sum of its own absolute terms."""
        terms = np.abs(self.M) @ np.abs(z) + np.abs(self.b)
        size = np.maximum(terms, TERM_FLOOR * terms.max(initial=0.0))
        return float((np.abs(self.M @ z - self.b) / np.where(size > 0, size, 1.0)).max(initial=0.0))

    def _least_squares(self, b: Array) -> Array:
        return np.asarray(np.linalg.lstsq(self.M, b, rcond=staircase.COUPLING)[0])


def _equations(model: StateSpace, S: Array, E: Array, F: Array) -> _Equations:
    (n, m), p, q = model.B.shape, len(model.C), len(S)
    shift = np.zeros((n + p, n + m))
    shift[:n, :n] = np.eye(n)
    M = np.kron(np.eye(q), np.block([[model.A, model.B], [model.C, model.D]])) - np.kron(S.T, shift)
    M, rows, columns = equilibrated(M)
    is_gamma = np.tile(np.arange(n + m) >= n, q)
    return _Equations(M, -rows * np.vstack([E, F]).T.ravel(), columns, is_gamma)
