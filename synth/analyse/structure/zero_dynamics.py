"""Zero dynamics at an equilibrium: the motion of the states while the inputs keep all outputs at zero.

For relative degrees r_i and a linear model dx/dt = A x + B u, y = C x + D u with as many inputs as outputs, the outputs
stay zero on the subspace Z of all x with C_i A^k x = 0, k < r_i, under the input that keeps C_i A^r_i x + D_i u = 0:

    dz/dt = Z^T (A - B D*^-1 C*) Z z,   C*_i = C_i A^r_i,   D*_i = C_i A^(r_i - 1) B,   x = Z z,

of order n - sum r. Its eigenvalues are the transmission zeros of the model: the s at which

    P(s) = [[A - s I, B], [C, D]]

loses rank. Both are computed, one from the chains of derivatives and one from the pencil P, and compared.

Sources: Isidori, Nonlinear Control Systems, 4.3 and 5.1; Rosenbrock, State-space and Multivariable Theory, 1970.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
import scipy.linalg
from numpy.typing import NDArray
from scipy.optimize import linear_sum_assignment

from synth import arguments, show, statespace
from synth.analyse import operating_points
from synth.analyse.numerics import nearest_root
from synth.analyse.operating_points import OperatingPoint
from synth.analyse.structure.relative_degree import RelativeDegree
from synth.errors import ModelError, SignalError, TimingError
from synth.plant import Plant
from synth.signals import signal_names
from synth.statespace import Array, StateSpace, System
from synth.timing import Continuous

Verdict = Literal["none", "minimum phase", "not minimum phase", "not hyperbolic"]

NORM_FLOOR = 1e-6  # of |A|: added to the norm of the zero dynamics, to give a scale for rates where that norm is near 0
AXIS_TOLERANCE = 1e-6  # of an eigenvalue, and at most of that scale: real parts this small count as 0
AXIS_ROUNDING = 1e-10  # of that scale times the eigenvalue's condition: a double eigenvalue scatters by 1e-8
CHAIN_ROUNDING = 1e-9  # of the terms of C A^k B, and of D: an entry below it counts as 0
TOLERANCE = 1e-5  # of that scale: allowed difference of the two methods; eigenvalues of multiplicity 2 or 3 scatter
MAX_CONDITION = 1e8  # condition of D* from which the degree counts as undefined
AT_REST = 1e-6  # of a state's half range per second


@dataclass(frozen=True)
class Mode:
    """An eigenvalue in 1/s, and its dominant states, measured in half ranges."""

    value: complex
    states: tuple[str, ...]


@show.result
class ZeroDynamics:
    """The modes of the zero dynamics, the transmission `zeros` of the pencil, and their distance.

    `distance` is the largest distance of paired values, over the scale of their rates.
    `verdict`: "none" if the order is 0; "minimum phase" if all modes decay; "not minimum phase" if one grows;
    "not hyperbolic" if none grows and one lies on the imaginary axis: the linear model then does not decide.
    """

    modes: tuple[Mode, ...]
    zeros: NDArray[np.complex128]
    distance: float
    verdict: Verdict

    @property
    def order(self) -> int:
        """n - sum r."""
        return len(self.modes)

    @property
    def is_consistent(self) -> bool:
        """Whether the two methods give the same zeros."""
        return self.distance <= TOLERANCE

    def sheet(self) -> show.Sheet:
        """Return the verdict and each mode with its states."""
        if not self.modes:
            return show.Sheet("Zero dynamics: none, the degree is full")
        meaning = {
            "minimum phase": "all modes decay",
            "not minimum phase": "a mode grows while the outputs stay at zero: choose other outputs",
            "not hyperbolic": "a mode on the imaginary axis: the linear model does not decide",
        }
        word = "agree" if self.is_consistent else "DISAGREE"
        lines = (
            meaning[self.verdict],
            f"restricted dynamics and pencil {word}: relative difference {self.distance:.1e}",
        )
        rows = tuple((show.number(mode.value), ", ".join(mode.states)) for mode in self.modes)
        table = show.Table("", ("mode [1/s]", "states"), rows)
        return show.Sheet(f"Zero dynamics of order {self.order}: {self.verdict}", lines, (table,))


@arguments.checked
def at_point(plant: Plant, degree: RelativeDegree, point: OperatingPoint, weight: Array | None = None) -> ZeroDynamics:
    """Return the zero dynamics of the plant's outputs and inputs in `degree` at the equilibrium `point`.

    With more inputs than outputs, `weight` W (m, m) selects the inputs of least u' W u.

    Raises SignalError if the point belongs to another plant; ModelError if it is not an equilibrium, if its held inputs
    differ from those of `degree`, or if the decoupling matrix is singular there.
    """
    model = operating_points.linearise(plant, point).select(degree.outputs, signal_names(degree.model.inputs))
    _require_matching(plant, degree, point)
    if weight is not None:
        weight = arguments.matrix_of_shape("weight", weight, len(model.inputs), len(model.inputs))
        D_star = _highest_derivatives(model, degree.degrees)[1]
        N = np.linalg.solve(weight, D_star.T)
        shares = tuple(f"share_of_{name}" for name in degree.outputs)
        model = replace(model, B=model.B @ N, D=model.D @ N, inputs=shares)
    sizes = dict(zip(model.states, nearest_root.half_widths(plant.states).tolist(), strict=True))
    return of_linear(model, degree.degrees, sizes)


@arguments.checked
def of_linear(system: System, degrees: Sequence[int], sizes: Mapping[str, float] | None = None) -> ZeroDynamics:
    """Return the zero dynamics of a continuous model with relative `degrees` (p,).

    `sizes` gives the half range of each state, by name, by default 1; it is the unit for the dominant states.

    Raises SignalError when the numbers do not fit, TimingError for a sampled model, ModelError for a degree above that
    of its output and when the decoupling matrix is singular.
    """
    model = statespace.of(system)
    n, m = model.B.shape
    if not isinstance(model.time, Continuous):
        raise TimingError(f"the model is in {model.time}: give the continuous one, as degrees count derivatives")
    if not n or not m:
        raise SignalError(f"the model has {n} states and {m} inputs: give one with at least one of each")
    if len(degrees) != len(model.C) or m != len(model.C):
        raise SignalError(f"{len(degrees)} degrees, {len(model.C)} outputs and {m} inputs: give equal numbers of each")
    T = np.array([(sizes or {}).get(name, 1.0) for name in model.states])
    scaled = _scaled(model, T)
    _require_degrees(scaled, degrees)
    C_star, D_star = _highest_derivatives(scaled, degrees)
    _require_regular(D_star, model)
    chains = _chains(scaled, degrees)
    Z = scipy.linalg.null_space(chains / np.linalg.norm(chains, axis=1, keepdims=True)) if len(chains) else np.eye(n)
    if Z.shape[1] != n - len(chains):
        raise ModelError(
            f"the degrees {tuple(degrees)} are not those of this model: the outputs' derivatives of lower order "
            "are linearly dependent; take the degrees from `relative_degree`"
        )
    F = Z.T @ (scaled.A - scaled.B @ np.linalg.solve(D_star, C_star)) @ Z
    values, left, vectors = scipy.linalg.eig(F, left=True)
    order = np.lexsort((values.imag, values.real))
    modes = tuple(Mode(complex(values[k]), _dominant(Z @ vectors[:, k], model.states)) for k in order)
    zeros = _pencil_zeros(scaled, len(modes))
    scale = float(np.linalg.norm(F)) + NORM_FLOOR * float(np.linalg.norm(scaled.A))
    return ZeroDynamics(modes, zeros, _distance(values, zeros, scale), _verdict(values, left, vectors, scale))


def _require_matching(plant: Plant, degree: RelativeDegree, point: OperatingPoint) -> None:
    rates = np.abs(np.asarray(plant.f(point.x, point.u, point.p)).ravel())
    if not (rates <= AT_REST * nearest_root.half_widths(plant.states)).all():
        worst = int(np.argmax(rates / nearest_root.half_widths(plant.states)))
        raise ModelError(
            f"plant '{plant.name}' is not at rest at the point: '{plant.states[worst].name}' changes by "
            f"{rates[worst]:.3g} per s: trim the plant"
        )
    for name, value in degree.model.held.items():
        if not np.isclose(point[name], value, rtol=1e-9, atol=0):
            raise ModelError(f"the input '{name}' is held at {value:g}, but {point[name]:g} at the point: trim with it")
    if not np.array_equal(point.p, plant.values):
        raise ModelError(f"the point was found for other parameters than those of plant '{plant.name}': trim again")


def _scaled(model: StateSpace, T: Array) -> StateSpace:
    """Return the model with states in units of T, and inputs and outputs of size 1."""
    A, B, C = model.A * T / T[:, None], model.B / T[:, None], model.C * T
    columns = np.linalg.norm(np.vstack([B, model.D]), axis=0)
    rows = np.linalg.norm(np.hstack([C, model.D]), axis=1)
    columns, rows = (np.where(size > 0, size, 1.0) for size in (columns, rows))
    D = model.D / columns / rows[:, None]
    return StateSpace(A, B / columns, C / rows[:, None], D, model.states, model.inputs, model.outputs, model.time)


def _chains(model: StateSpace, degrees: Sequence[int]) -> Array:
    rows = [c @ np.linalg.matrix_power(model.A, k) for c, r in zip(model.C, degrees, strict=True) for k in range(r)]
    return np.array(rows).reshape(-1, len(model.A))


def _require_degrees(model: StateSpace, degrees: Sequence[int]) -> None:
    """Raise ModelError for an input that acts on a derivative below the given degree of its output."""
    for i, (c, degree) in enumerate(zip(model.C, degrees, strict=True)):
        row, terms = c, np.abs(c)
        acting = np.abs(model.D[i]) > CHAIN_ROUNDING
        for order in range(degree):
            if acting.any():
                raise ModelError(
                    f"the relative degree of '{model.outputs[i]}' is {order}, but {degree} was given: "
                    f"'{model.inputs[int(acting.argmax())]}' acts on its derivative of order {order}; take the "
                    "degrees from `relative_degree`"
                )
            acting = np.abs(row @ model.B) > CHAIN_ROUNDING * (terms @ np.abs(model.B))
            row, terms = row @ model.A, terms @ np.abs(model.A)


def _highest_derivatives(model: StateSpace, degrees: Sequence[int]) -> tuple[Array, Array]:
    """Return C* and D*."""
    power = np.linalg.matrix_power
    C = np.array([c @ power(model.A, r) for c, r in zip(model.C, degrees, strict=True)])
    parts = zip(model.C, model.D, degrees, strict=True)
    return C, np.array([c @ power(model.A, r - 1) @ model.B if r else d for c, d, r in parts])


def _require_regular(D: Array, model: StateSpace) -> None:
    size = np.linalg.norm(D, axis=1, keepdims=True)
    condition = float(np.linalg.cond(D / size)) if size.all() else np.inf
    if not condition <= MAX_CONDITION:
        raise ModelError(
            f"the relative degree of ({', '.join(model.outputs)}) is not defined at the point: the decoupling matrix "
            f"has the condition {condition:.3g} there (at most {MAX_CONDITION:.3g} is needed): take another point"
        )


def _pencil_zeros(model: StateSpace, count: int) -> NDArray[np.complex128]:
    """Return the `count` least eigenvalues of the pencil P; the other sum r + p eigenvalues are infinite."""
    n, m = model.B.shape
    rate = float(np.linalg.norm(model.A)) or 1.0
    P = np.block([[model.A / rate, model.B], [model.C, model.D]])
    E = scipy.linalg.block_diag(np.eye(n), np.zeros((m, m)))
    alpha, beta = scipy.linalg.eigvals(P, E, homogeneous_eigvals=True)
    with np.errstate(divide="ignore", invalid="ignore"):
        zeros = np.where(beta != 0, rate * alpha / beta, np.inf).astype(np.complex128)
    return np.sort_complex(zeros[np.argsort(np.abs(zeros), kind="stable")[:count]])


def _distance(values: NDArray[np.complex128], zeros: NDArray[np.complex128], scale: float) -> float:
    """Return the largest distance of paired values, over the scale."""
    distances = np.abs(values[:, None] - zeros[None, :])
    if not np.isfinite(distances).all():
        return np.inf
    rows, columns = linear_sum_assignment(distances)
    return float(distances[rows, columns].max(initial=0.0)) / (scale or 1.0)


def _verdict(
    values: NDArray[np.complex128], left: NDArray[np.complex128], right: NDArray[np.complex128], scale: float
) -> Verdict:
    """Return the verdict for eigenvalues with left and right eigenvectors of length 1."""
    if not len(values):
        return "none"
    # Rounding moves an eigenvalue by at most its condition 1 / |w^H v| times the rounding of the matrix.
    rounding = AXIS_ROUNDING / np.maximum(np.abs((left.conj() * right).sum(axis=0)), AXIS_ROUNDING)
    width = np.minimum(rounding, AXIS_TOLERANCE) * scale + AXIS_TOLERANCE * np.abs(values)
    if (values.real > width).any():
        return "not minimum phase"
    return "minimum phase" if (values.real < -width).all() else "not hyperbolic"


def _dominant(vector: NDArray[np.complex128], states: Sequence[str]) -> tuple[str, ...]:
    size = np.abs(vector)
    return tuple(states[i] for i in np.argsort(-size, kind="stable") if size[i] > 0.1 * size.max())
