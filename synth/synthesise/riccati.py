"""Algebraic Riccati equations with a certificate.

    continuous  A'X + XA - (XB + N) R^-1 (B'X + N') + Q = 0,          L = R^-1 (B'X + N'),             A - B L stable
    discrete    A'XA - X - (A'XB + N) S^-1 (B'XA + N') + Q = 0,       L = S^-1 (B'XA + N'),            A - B L stable
                                             S = R + B'XB

for A (n, n), B (n, m), Q (n, n), R (m, m) > 0, N (n, m) and a cost [Q, N; N', R] >= 0. By default in double precision:
states and inputs are balanced by powers of 2, doubling gives a start, and Newton's method with a residual of twice the
precision ends within rounding. What comes out is taken when its own certificate holds. Else the start is a gain for
more moderate weights, then SciPy's Schur method; then ball arithmetic takes over, for 12 states or fewer. With `exact`
ball arithmetic rounds X and L correctly, alike on every machine.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import scipy.linalg
from numpy.typing import ArrayLike, NDArray

from synth import arguments, show
from synth.errors import ModelError, SignalError
from synth.statespace import Array, StateSpace, System, of, readonly
from synth.synthesise import doubling, exact_riccati, newton, solvability, weights
from synth.synthesise.equation import Equation, Solution, decays
from synth.timing import Continuous, Time

TRUSTED = 1e-8  # forward error up to which a solution in double precision is taken
BALLS = 12  # states up to which ball arithmetic is tried


@show.printed
@dataclass(frozen=True, eq=False, repr=False)
class Riccati:
    """The stabilising solution X (n, n) and L (m, n), u = -L x, for the weights Q, R, N, with its certificate.

    `poles` (n,) are those of A - B L, in 1/s or in z. `defect` and `step` (n, n) hold the absolute entries of the
    equation's left side at X and of the further Newton step from X, an estimate of X's error; from them

    `residual`       the largest entry of the left side at X, each beside the sum of the absolute terms it is left of
    `forward_error`  the largest error of X_ij over sqrt(X_ii X_jj); infinite where A - B L is not stable
    `condition`      the factor from relative changes of the equation's terms to those of sqrt(X_ii X_jj), at most

    so that units do not matter; `least_eigenvalue` is that of X_ij over sqrt(X_ii X_jj).
    """

    X: Array
    L: Array
    Q: Array
    R: Array
    N: Array
    poles: NDArray[np.complex128]
    residual: float
    forward_error: float
    condition: float
    least_eigenvalue: float
    defect: Array
    step: Array
    states: tuple[str, ...]
    inputs: tuple[str, ...]
    time: Time

    def sheet(self) -> show.Sheet:
        """Return the certificate and the tables of L, X and the poles."""
        n, m = len(self.states), len(self.inputs)
        tables = (
            show.matrix("L", self.L, self.inputs, self.states),
            show.matrix("X", self.X, self.states, self.states),
            modes(self.poles, self.time),
        )
        return show.Sheet(f"Riccati solution in {self.time}: {n} states, {m} inputs", self.lines(), tables)

    def lines(self) -> tuple[str, ...]:
        """Return the certificate in words."""
        return (
            f"residual {self.residual:.1e}, error of X {self.forward_error:.1e}, condition {self.condition:.1e}, "
            f"least eigenvalue of X, its diagonal made 1, {self.least_eigenvalue:.3g}",
        )


def modes(poles: NDArray[np.complex128], time: Time) -> show.Table:
    """Return a table of poles in 1/s or in z with their natural frequency in Hz and their damping."""
    z = np.where(poles == 0, np.finfo(float).tiny, poles)
    s = poles if isinstance(time, Continuous) else np.log(z) / time.period_s
    rows = (
        (show.number(p), show.number(abs(v) / (2 * np.pi)), show.number(-v.real / abs(v) if v else np.nan))
        for p, v in zip(poles, s, strict=True)
    )
    return show.Table(("pole [1/s]" if isinstance(time, Continuous) else "pole, z", "f [Hz]", "damping"), tuple(rows))


@arguments.checked
def solve(
    system: System, Q: weights.Weight, R: weights.Weight, N: ArrayLike | None = None, exact: bool = False
) -> Riccati:
    """Solve the Riccati equation of a model's A, B in its own time; Q (n, n), R (m, m), N (n, m), zero if left out.

    Q weights the states, R the inputs, as matrix, diagonal or {name: weight}. `exact` rounds each entry of X and L
    correctly, at a cost that grows with n^6.

    Raises SignalError for weights that do not fit, an asymmetric Q or R, an indefinite cost or an R that is not
    positive definite; ModelError when (A, B) is not stabilisable or (Q, A) not detectable, naming the mode and its
    states, or when no stabilising solution is found.
    """
    model = of(system)
    return solved(model, *checked_weights(model, Q, R, N), exact)


def solved(model: StateSpace, Q: Array, R: Array, N: Array, exact: bool) -> Riccati:
    """Do as `solve` for weights that `checked_weights` returned."""
    stated = _stated(model, Q, R, N)
    balance = _Balance.of(stated)
    certified = _solution(model, stated, balance)
    found = balance.back(certified.solution)
    if exact:
        found = exact_riccati.solve(stated, found.X)
        certified = balance.certified(found)
    result = _result(model, stated, found, certified)
    solvability.prove(model, stated, balance.scaled, result.poles)
    return result


@arguments.checked
def certify(
    system: System,
    Q: weights.Weight,
    R: weights.Weight,
    X: ArrayLike,
    N: ArrayLike | None = None,
    exact: bool = False,
) -> Riccati:
    """Return a symmetric X (n, n) of any origin with its L and its certificate; arguments else as for `solve`.

    Raises SignalError as `solve`, or when X does not fit; ModelError when S = R + B'XB is not positive definite.
    """
    model = of(system)
    stated = _stated(model, *checked_weights(model, Q, R, N))
    X = weights.symmetric("X", X, model.states)
    balance = _Balance.of(stated)
    found = exact_riccati.certify(stated, X) if exact else balance.back(_evaluated(X, balance))
    return _result(model, stated, found, balance.certified(found))


@arguments.checked
def checked_weights(
    system: System, Q: weights.Weight, R: weights.Weight, N: ArrayLike | None
) -> tuple[Array, Array, Array]:
    """Return the weights as arrays (n, n), (m, m), (n, m).

    Raises SignalError for weights that do not fit, an asymmetric Q or R, an R that is not positive definite, or a cost
    that is not positive semidefinite.
    """
    model = of(system)
    Q, R = weights.symmetric("Q", Q, model.states), weights.definite("R", R, model.inputs)
    N = weights.cross("N", N, model.states, model.inputs)
    joint = weights.joined(Q, R, N) if N.any() else Q
    if not weights.is_above(joint, -weights.ROUNDING):
        what = "Q - N R^-1 N'" if N.any() else "Q"
        lowest = weights.lowest_eigenvalue(Q - N @ np.linalg.solve(R, N.T))
        raise SignalError(
            f"{what} has the eigenvalue {lowest:.3g}: the cost must be positive semidefinite; raise Q or lower N"
        )
    return Q, R, N


def _stated(model: StateSpace, Q: Array, R: Array, N: Array) -> Equation:
    if not model.states or not model.inputs:
        raise SignalError(f"the model has {len(model.states)} states and {len(model.inputs)} inputs: it needs of each")
    return Equation(model.A, model.B, Q, R, N, isinstance(model.time, Continuous))


@dataclass(frozen=True, eq=False)
class _Balance:
    """The scaled equation, the scales D (n,), E (m,) of states and inputs, and the map that doubling takes."""

    scaled: Equation
    D: Array
    E: Array
    bilinear: doubling.Bilinear

    @staticmethod
    def of(stated: Equation) -> "_Balance":
        D, E = stated.scales()
        scaled = stated.scaled(D, E)
        return _Balance(scaled, D, E, doubling.fitting(scaled))

    def back(self, found: Solution) -> Solution:
        """Return a solution of the scaled equation as that of the equation itself."""
        return found.scaled(1 / self.D, 1 / self.E)

    def certified(self, found: Solution) -> newton.Certified:
        """Return the certificate of a solution of the equation itself."""
        return newton.certified(self.scaled, found.scaled(self.D, self.E), self.bilinear)


def _solution(model: StateSpace, stated: Equation, balance: _Balance) -> newton.Certified:
    """Return the first solution of the balanced equation whose certificate holds."""
    scaled, nearest = balance.scaled, np.inf
    for start in _starts(model, stated, balance):
        found = None if start is None else newton.refined(scaled, start, balance.bilinear)
        if found is not None and decays(found.poles, scaled.continuous):
            nearest = found.error
            if nearest <= TRUSTED:
                return found
    n, hardly = len(model.states), solvability.hardly_moved(model, scaled)
    if n > BALLS:
        left = f"an error of {nearest:.1e} of X is left" if np.isfinite(nearest) else "no loop that decays was found"
        raise ModelError(
            f"the Riccati equation has no stabilising solution that double precision resolves: {left}, and the weight "
            f"R has the condition {np.linalg.cond(scaled.R):.1e}; {hardly} weight inputs and states more alike, or "
            f"leave out modes that hardly move; {BALLS} states or fewer are left to ball arithmetic, not {n}"
        )
    try:
        return newton.certified(scaled, exact_riccati.solve(scaled), balance.bilinear)
    except ModelError as error:
        raise ModelError(f"{error}; {hardly} actuate it, or take it out of the model") from error


def _starts(model: StateSpace, stated: Equation, balance: _Balance) -> Iterator[Array | None]:
    """Yield X of the scaled equation: by doubling; from a moderate gain; by SciPy.

    After the first a mode that prevents every solution is named.
    """
    scaled = balance.scaled
    yield doubling.solution(scaled, balance.bilinear)
    solvability.search(model, stated)
    moderate = scaled.moderate()
    X = doubling.solution(moderate, doubling.fitting(moderate))
    yield None if X is None else newton.evaluated(scaled, moderate.gain(X), balance.bilinear)
    solver = scipy.linalg.solve_continuous_are if scaled.continuous else scipy.linalg.solve_discrete_are
    try:
        yield solver(scaled.A, scaled.B, scaled.Q, scaled.R, s=scaled.N)
    except np.linalg.LinAlgError:
        return


def _evaluated(X: Array, balance: _Balance) -> Solution:
    """Return the solution of the balanced equation to which a symmetric X (n, n) amounts."""
    X, scaled = X * balance.D * balance.D[:, None], balance.scaled
    try:
        defect, L = scaled.residual(X)
    except np.linalg.LinAlgError as error:
        raise ModelError("R + B'XB is not positive definite: this X is far from any that stabilises") from error
    closed = scaled.A - scaled.B @ L
    decay = doubling.decay(closed, balance.bilinear)
    step = np.full_like(X, np.inf) if decay is None else decay.gathered(defect)
    return Solution(X, L, closed, defect, step)


def _result(model: StateSpace, stated: Equation, found: Solution, certified: newton.Certified) -> Riccati:
    return Riccati(
        X=readonly(found.X),
        L=readonly(found.L),
        Q=readonly(stated.Q),
        R=readonly(stated.R),
        N=readonly(stated.N),
        poles=certified.poles,
        residual=certified.residual,
        forward_error=certified.forward_error,
        condition=certified.condition,
        least_eigenvalue=float(np.linalg.eigvalsh(weights.unit_diagonal(found.X))[0]),
        defect=readonly(np.abs(found.defect)),
        step=readonly(np.abs(found.step)),
        states=model.states,
        inputs=model.inputs,
        time=model.time,
    )
