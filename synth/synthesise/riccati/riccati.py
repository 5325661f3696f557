"""Algebraic Riccati equations with a certificate; MATLAB `icare`, `idare`, python-control `care`, `dare`.

    continuous  A'X + XA - (XB + N) R^-1 (B'X + N') + Q = 0,          L = R^-1 (B'X + N'),             A - B L stable
    discrete    A'XA - X - (A'XB + N) S^-1 (B'XA + N') + Q = 0,       L = S^-1 (B'XA + N'),            A - B L stable
                                             S = R + B'XB

for A (n, n), B (n, m), Q (n, n), R (m, m), N (n, m); R > 0 in continuous time, S regular in discrete time. The cost
[Q, N; N', R] need not be positive semidefinite. With R > 0, or S > 0, completing the square

    sum of x'Qx + u'Ru + 2 x'Nu  =  x0'X x0 + sum of (u + L x)' S (u + L x)         for inputs that bring x to rest

shows that x0'X x0 is the least cost of bringing x0 to rest (Willems 1971). It is the least cost of all inputs where the
cost is positive semidefinite and each mode that does not decay is observable in it.

Ball arithmetic (module `exact`) rounds each entry of X and L correctly, so the result is the same on every
machine.
"""

import numpy as np
from numpy.typing import ArrayLike

from synth import arguments, show
from synth.analyse.structure import structure
from synth.errors import ModelError, SignalError
from synth.statespace import Array, Complex, StateSpace, System, of, readonly
from synth.synthesise.riccati import exact, solvability, weights
from synth.synthesise.riccati.equation import Balance, Certificate, Equation, Solution
from synth.timing import Continuous, Time

MAX_CONDITION = 1e13  # condition above which the modes are searched: the equation is close to unsolvable


@show.result
class Riccati:
    """The stabilising solution X (n, n) and L (m, n), u = -L x, for the weights Q, R, N, with its certificate.

    `poles` (n,) are those of A - B L, in 1/s or in z. `defect` and `step` (n, n) hold the absolute entries of the
    equation's left side at X and of the error of X, or, for an X of any origin, of Newton's step from it; from them

    `residual`       the largest entry of the left side at X, relative to the sum of the absolute values of its terms
    `forward_error`  the largest error of X_ij over sqrt(X_ii X_jj); infinite where A - B L is not stable
    `condition`      bound of the change of X_ij over sqrt(X_ii X_jj) per relative change of the equation's terms

    None of them depends on units. `least_eigenvalue` is that of X_ij over sqrt(X_ii X_jj), 0 where the error of X is
    larger. For a state without cost within rounding, sqrt(X_ii) has a floor at the rounding error.

    `marginal` poles decay for the given entries of A, B, Q, but by less than the rounding of these entries. `mirrored`
    modes, in 1/s or in z, do not decay and are not observable in the cost: the loop has their mirror image, -conj(s) or
    1 / conj(s), and leaving them unstable would cost less. `cost_eigenvalue` and `weight_eigenvalue` are the least
    eigenvalues of [Q, N; N', R] and of R or S, scaled to a unit diagonal: below 0 the cost is indefinite, or X is a
    saddle and no minimum.
    """

    X: Array
    L: Array
    Q: Array
    R: Array
    N: Array
    poles: Complex
    residual: float
    forward_error: float
    condition: float
    least_eigenvalue: float
    marginal: tuple[complex, ...]
    mirrored: tuple[complex, ...]
    cost_eigenvalue: float
    weight_eigenvalue: float
    defect: Array
    step: Array
    states: tuple[str, ...]
    inputs: tuple[str, ...]
    time: Time

    def sheet(self) -> show.Sheet:
        """Return the certificate and the tables of L, X and the poles."""
        n, m = len(self.states), len(self.inputs)
        tables = (
            show.feedback(show.matrix("L", self.L, self.inputs, self.states), sign=-1),
            show.matrix("X", self.X, self.states, self.states),
            weights.table(self.poles, self.time),
        )
        return show.Sheet(f"Riccati solution in {self.time}: {n} states, {m} inputs", self.lines(), tables)

    def lines(self) -> tuple[str, ...]:
        """Return the certificate as text."""
        return (
            f"residual {self.residual:.1e}, error of X {self.forward_error:.1e}, condition {self.condition:.1e}, "
            f"smallest eigenvalue of X scaled to a unit diagonal {self.least_eigenvalue:.3g}",
            *self.remarks(),
        )

    @property
    def is_resolved(self) -> bool:
        """Tell whether the loop is stable with L in double precision; if not, the last bits of L matter."""
        return bool(np.isfinite(self.condition) or not np.isfinite(self.forward_error))

    def remarks(self) -> tuple[str, ...]:
        """Return the sense in which X is the least cost, where it is not the least of all inputs."""
        remarks, least = [], "X is the least cost of bringing the state to rest"
        if self.weight_eigenvalue < 0:
            return (f"R + B'XB has the eigenvalue {self.weight_eigenvalue:.3g}: X is a saddle of the cost, no minimum",)
        if not self.is_resolved:
            remarks.append(
                "the last bits of A and L decide whether this loop is stable: rounded to double precision L may not "
                "stabilise; take weights that differ by less"
            )
        if self.marginal:
            listed = ", ".join(show.number(s) for s in self.marginal)
            remarks.append(
                f"the poles {listed} decay by less than the rounding of the model's entries: do not rely on it"
            )
        if self.mirrored:
            image = "-conj(s)" if isinstance(self.time, Continuous) else "1 / conj(z)"
            listed = ", ".join(structure.pair(s) for s in self.mirrored if s.imag >= 0)
            remarks.append(
                f"the weights do not see the mode {listed}, which does not decay: the loop mirrors it to {image}; "
                f"{least}, and leaving that mode alone would cost less"
            )
        if self.cost_eigenvalue < 0:
            remarks.append(
                f"[Q, N; N', R] has the eigenvalue {self.cost_eigenvalue:.3g}: the cost is indefinite, and {least}"
            )
        return tuple(remarks)


@arguments.checked
def solve(system: System, Q: weights.Weight, R: weights.Weight, N: ArrayLike | None = None) -> Riccati:
    """Solve the Riccati equation of a model's A, B in its own time; Q (n, n), R (m, m), N (n, m), zero if left out.

    Q weights the states, R the inputs, as matrix, diagonal or {name: weight}. Q may be indefinite and in discrete time
    R singular or indefinite; the result states in what sense X is the least cost.

    Raises SignalError for weights of the wrong shape, an asymmetric Q or R, or in continuous time an R that is not
    positive definite; ModelError when (A, B) is not stabilisable or a mode on the stability boundary is not observable
    in the cost, naming the mode and its states, or when no stabilising solution is found.
    """
    model = of(system)
    return solve_matrices(model, *weight_matrices(model, Q, R, N))


def solve_matrices(model: StateSpace, Q: Array, R: Array, N: Array) -> Riccati:
    """Solve as `solve` does, for weights that `weight_matrices` returned."""
    equation = _equation(model, Q, R, N)
    balance = Balance.of(equation)
    solution = _stabilising_solution(model, equation, balance.scaled)
    certificate = balance.certify(solution)
    rigid = certificate.condition > MAX_CONDITION
    marginal = solvability.marginal_poles(model, equation, solution.poles(), rigid)
    X = solution.X * balance.D * balance.D[:, None]
    solvability.require_unique_gain(model, balance.scaled.weight(X))
    return _with_certificate(model, equation, solution, certificate, balance, marginal)


@arguments.checked
def certify(
    system: System,
    Q: weights.Weight,
    R: weights.Weight,
    X: ArrayLike,
    N: ArrayLike | None = None,
) -> Riccati:
    """Return any symmetric X (n, n) with its L and its certificate; other arguments as for `solve`.

    Raises SignalError as `solve`, or when X has the wrong shape; ModelError when S = R + B'XB is singular.
    """
    model = of(system)
    stated = _equation(model, *weight_matrices(model, Q, R, N))
    X = weights.symmetric("X", X, model.states)
    balance = Balance.of(stated)
    solution = exact.certify(stated, X)
    return _with_certificate(
        model, stated, solution, balance.certify(solution), balance, np.zeros(0, dtype=np.complex128)
    )


@arguments.checked
def weight_matrices(
    system: System, Q: weights.Weight, R: weights.Weight, N: ArrayLike | None
) -> tuple[Array, Array, Array]:
    """Return the weights as arrays (n, n), (m, m), (n, m).

    Raises SignalError for weights of the wrong shape, an asymmetric Q or R, or in continuous time an R that is not
    positive definite.
    """
    model = of(system)
    check = weights.definite if isinstance(model.time, Continuous) else weights.symmetric
    Q, R = weights.symmetric("Q", Q, model.states), check("R", R, model.inputs)
    return Q, R, weights.cross("N", N, model.states, model.inputs)


def _equation(model: StateSpace, Q: Array, R: Array, N: Array) -> Equation:
    if not model.states or not model.inputs:
        raise SignalError(
            f"the model has {len(model.states)} states and {len(model.inputs)} inputs: it needs at least one of each"
        )
    return Equation(model.A, model.B, Q, R, N, isinstance(model.time, Continuous))


def _stabilising_solution(model: StateSpace, stated: Equation, scaled: Equation) -> Solution:
    """Return the solution, or raise the ModelError that names the cause where there is none."""
    try:
        return exact.solve(stated)
    except ModelError as error:
        hidden = solvability.hidden_mode_error(model, stated)
        if hidden is not None:
            raise hidden from error
        cost = weights.joint_weight(scaled.Q, scaled.R, scaled.N)
        if not weights.is_above(cost, -weights.ROUNDING):
            solvability.require_clear_boundary(scaled)
        least = weights.lowest_eigenvalue(cost)
        hint = f"; balanced, [Q, N; N', R] has the eigenvalue {least:.1e}, which slow modes magnify: raise Q"
        raise ModelError(
            f"{error}; {solvability.least_stabilisable_mode(model, scaled)} actuate it, or take it out of the model"
            f"{hint if least < 0 else ''}"
        ) from error


def _with_certificate(
    model: StateSpace,
    stated: Equation,
    solution: Solution,
    certificate: Certificate,
    balance: Balance,
    marginal: Complex,
) -> Riccati:
    scaled = balance.scaled
    X = solution.X * balance.D * balance.D[:, None]
    return Riccati(
        X=readonly(solution.X),
        L=readonly(solution.L),
        Q=readonly(stated.Q),
        R=readonly(stated.R),
        N=readonly(stated.N),
        poles=solution.poles(),
        residual=certificate.residual,
        forward_error=certificate.forward_error,
        condition=certificate.condition,
        least_eigenvalue=balance.least_eigenvalue(solution.X, certificate.forward_error),
        marginal=tuple(complex(s) for s in marginal),
        mirrored=solvability.mirrored_modes(model, stated, scaled, solution.poles()),
        cost_eigenvalue=weights.least_eigenvalue(weights.joint_weight(scaled.Q, scaled.R, scaled.N)),
        weight_eigenvalue=weights.least_eigenvalue(scaled.weight(X)),
        defect=readonly(np.abs(solution.defect)),
        step=readonly(np.abs(solution.step)),
        states=model.states,
        inputs=model.inputs,
        time=model.time,
    )
