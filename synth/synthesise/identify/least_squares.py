"""Linear least squares with confidence intervals, y = Phi theta + e; MATLAB `lscov`, `regress`.

N rows of p outputs, k parameters: y (N, p), Phi (N, p, k), e independent, of standard deviation s w_j in output j. With
rows divided by w_j and stacked, columns divided by their norms c,

    theta = C^-1 V S^-1 U' y,     U S V' = Phi C^-1,     s^2 = |y - Phi theta|^2 / (N p - k),
    cov theta = s^2 C^-1 V S^-2 V' C^-1,       theta_i +- t(N p - k) sqrt(cov_ii),

t the quantile of Student's distribution. For several outputs with unknown w_j, the noise of each is estimated by
restricted maximum likelihood with repeated fits, which widens the intervals. Right singular vectors of
zero singular values are combinations of parameters that the data do not determine.

Variance components of several outputs by restricted maximum likelihood (REML), and their effect on the confidence.

y_j = Phi_j theta + e_j, j = 1..p, N rows each, e_j of standard deviation s_j. U_j (N, k) are the rows of output j in an
orthonormal basis of the range of Phi_j / s_j, stacked, G_j = U_j' U_j, and the sum of G_j is I. The residuals of output
j have f_j degrees of freedom, by restricted maximum likelihood, and log s_j^2 has the covariance W:

    s_j^2 = |e_j|^2 / f_j,     f_j = N - tr G_j,     W = 2 T^-1,     T_ij = (f_i - tr G_i) d_ij + tr(G_i G_j)

Estimated weights increase the variance of the estimate above R R' for known ones, d theta = R d(U'y):

    cov theta = R (I + 2 sum_ij W_ij (d_ij G_i - G_i G_j)) R'          Kenward and Roger 1997
    freedom of theta_i = 2 / (a' W a),     a_j = (R G_j R')_ii / (R R')_ii       Satterthwaite 1946

With parameters of groups of rows, [U, Q] takes the place of U. One output has N - k degrees of freedom. N
must exceed the number of parameters of each output: otherwise s_j -> 0, with a fit through all rows of output j, has
the largest likelihood.

QR and SVD of a block-bordered Jacobian: parameters shared by all rows, and parameters of groups of rows.

    J = [ A_1  B_1           ]      s groups of L rows, p outputs each: A_g (L p, k), B_g (L p, f)
        [ A_2      B_2       ]
        [ ...           ...  ]

The parameters of the groups are eliminated group by group, B_g = Q_g S_g V_g'. The shared parameters are determined by
P = A - Q Q'A = U S V' alone (Frisch, Waugh 1933); [U, Q] is a basis of the range of J. The singular values are those of
J with columns of length 1.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from synth import arguments
from synth.errors import ModelError, SignalError
from synth.statespace import Array, readonly
from synth.synthesise.identify import estimates
from synth.synthesise.identify.estimates import Estimate, Residual


@dataclass(frozen=True, eq=False)
class Confidence:
    """The covariance (k, k) of an estimate and the degrees of freedom (k,) of each of its variances."""

    covariance: Array
    degrees_of_freedom: Array


def noise_deviations(e: Array, U: Array, Q: Array) -> Array:
    """Return the standard deviations (p,) of noise with the residuals e (N, p) of a fit.

    U (N, p, k) and Q (s, L, p, f) are its bases.
    """
    size = np.abs(e).max(axis=0)
    size = np.where(size > 0, size, 1.0)
    freedom = len(e) - (U**2).sum(axis=(0, 2)) - (Q**2).sum(axis=(0, 1, 3))
    return size * np.sqrt(((e / size) ** 2).sum(axis=0) / freedom)


def noise_confidence(U: Array, Q: Array, root: Array) -> Confidence:
    """Return the confidence of theta = root U'y + const, y (N, p) divided by its standard deviations."""
    G, group_gram = np.einsum("npi,npj->pij", U, U), np.einsum("slpf,slpg->psfg", Q, Q)
    between = np.einsum("slpk,slpf->pskf", U.reshape(*Q.shape[:3], U.shape[2]), Q)
    mixed = np.einsum("iab,jbc->ijac", G, G) + np.einsum("isaf,jscf->ijac", between, between)
    trace = np.trace(G, axis1=1, axis2=2) + np.einsum("psff->p", group_gram)
    trace_products = np.einsum("iab,jba->ij", G, G) + np.einsum("isfg,jsgf->ij", group_gram, group_gram)
    T = np.diag(len(U) - 2 * trace) + trace_products + 2 * np.einsum("isaf,jsaf->ij", between, between)
    W = 2 * np.linalg.inv(T)
    correction = 2 * (np.einsum("i,iab->ab", np.diag(W), G) - np.einsum("ij,ijab->ab", W, mixed))
    middle = np.eye(root.shape[1]) + (correction + correction.T) / 2
    a = np.einsum("ka,pab,kb->kp", root, G, root) / (root**2).sum(axis=1)[:, None]
    return Confidence(root @ middle @ root.T, 2 / np.einsum("ki,ij,kj->k", a, W, a))


@dataclass(frozen=True, eq=False)
class Jacobian:
    """The derivatives A (N, p, k) by the shared parameters and B (s, L, p, f) by those of the groups, N = s L."""

    shared: Array
    group: Array

    @property
    def parameters(self) -> int:
        """The number of all parameters, k + s f."""
        return self.shared.shape[2] + self.group.shape[0] * self.group.shape[3]

    def weighted(self, deviation: Array) -> "Jacobian":
        """Return the derivatives of the outputs divided by `deviation` (p,)."""
        return Jacobian(self.shared / deviation[:, None], self.group / deviation[:, None])

    def parameters_per_output(self) -> Array:
        """Return an upper bound of the number of parameters on which each output (p,) depends."""
        each = np.minimum(self.group.shape[1], self.group.any(axis=1).sum(axis=2)).sum(axis=0)
        return np.asarray(self.shared.any(axis=0).sum(axis=1) + each)


@dataclass(frozen=True, eq=False)
class Factors:
    """U (N p, k), sigma (k,), V (k, k) of P; Q (s, L p, f), group_sigma (s, f), group_V (s, f, f) of B; cross = Q'A.

    cross is (s f, k). `size` (k,) and `group_size` (s, f) are the lengths of J's columns; A and B are divided by them.
    """

    U: Array
    sigma: Array
    V: Array
    size: Array
    Q: Array
    group_sigma: Array
    group_V: Array
    group_size: Array
    cross: Array

    def group_components(self, e: Array) -> Array:
        """Return Q'e (s, f) of e (N p,)."""
        return np.einsum("srf,sr->sf", self.Q, e.reshape(self.Q.shape[:2]))

    def outside_range(self, e: Array) -> Array:
        """Return the component of e (N p,) outside the range of J."""
        e = e - np.einsum("srf,sf->sr", self.Q, self.group_components(e)).ravel()
        return e - self.U @ (self.U.T @ e)

    def step(self, e: Array, damping: float, kept: NDArray[np.bool_]) -> tuple[Array, Array]:
        """Return the solution d, (k,) and (s, f), of (J'J + m D^2) d = J'e, D the lengths of the columns of J."""
        faded = np.sqrt(damping / (self.group_sigma**2 + damping)).ravel()
        q = self.group_components(e)
        rows = [
            (self.sigma[:, None] * self.V.T)[kept],
            faded[:, None] * self.cross,
            np.sqrt(damping) * np.eye(len(self.V)),
        ]
        right = [(self.U.T @ e)[kept], faded * q.ravel(), np.zeros(len(self.V))]
        shared = np.linalg.lstsq(np.concatenate(rows), np.concatenate(right), rcond=None)[0]
        left = (q - (self.cross @ shared).reshape(q.shape)) * self.group_sigma / (self.group_sigma**2 + damping)
        return shared / self.size, np.einsum("sfg,sg->sf", self.group_V, left) / self.group_size


def of(J: "Array | Jacobian") -> Jacobian:
    """Return derivatives (N, p, k) by shared parameters as a Jacobian of one group without further parameters."""
    return J if isinstance(J, Jacobian) else Jacobian(np.asarray(J), np.zeros((1, *np.shape(J)[:2], 0)))


def factorise(J: Jacobian) -> Factors:
    """Return the factors of a Jacobian."""
    (groups, length, p, f), k = J.group.shape, J.shared.shape[2]
    A, B = J.shared.reshape(groups * length * p, k), J.group.reshape(groups, length * p, f)
    size, group_size = (_positive(np.linalg.norm(part, axis=-2)) for part in (A, B))
    A = A / size
    Q, group_sigma, group_V = np.linalg.svd(B / group_size[:, None], full_matrices=False)
    cross = np.einsum("srf,srk->sfk", Q, A.reshape(groups, length * p, k))
    U, sigma, V = np.linalg.svd(A - np.einsum("srf,sfk->srk", Q, cross).reshape(A.shape), full_matrices=False)
    group_V = group_V.transpose(0, 2, 1)
    return Factors(U, sigma, V.T, size, Q, group_sigma, group_V, group_size, cross.reshape(groups * f, k))


def _positive(size: Array) -> Array:
    return np.where(size > 0, size, 1.0)


PASSES = 500  # most fits until the outputs' noise converges
CONVERGENCE_TOLERANCE = 1e-6  # relative change of a standard deviation
# Of the rms of an output: lower bound of the residual, which gives an exact fit a finite weight.
MIN_RELATIVE_RESIDUAL = 1e-12
PASSED_THROUGH = 1e-9  # of a residual's variance: below it the fit interpolates the row


@dataclass(frozen=True, eq=False)
class Solution:
    """The solution for fixed standard deviations (p,) of the noise: theta = root U'(y / deviation), residuals e (N, p).

    U (N, p, k) is the basis of the fit. Q (s, L, p, f) is that of the parameters of groups of rows, which are not
    reported.
    """

    theta: Array
    e: Array
    U: Array
    Q: Array
    root: Array
    deviation: Array
    condition: float


@arguments.checked
def solve(
    Phi: ArrayLike,
    y: ArrayLike,
    parameters: Sequence[str],
    outputs: Sequence[str] = ("y",),
    noise: Mapping[str, float] | None = None,
    level: float = 0.95,
    units: Mapping[str, str] | None = None,
    near: ArrayLike | None = None,
) -> Estimate:
    """Return theta of y = Phi theta + e; Phi (N, p, k), y (N, p), or (N, k) and (N,) for one output.

    `noise` gives the outputs' standard deviations up to a common factor. `units` is passed on to the result. Errors
    about undetermined combinations are relative to the values `near` (k,).

    Raises SignalError for wrong shapes, a value that is not finite, naming row and signal, a level or noise out of
    range, or too few rows; ModelError naming combinations of parameters that are not determined, or when the data do
    not determine the outputs' noise.
    """
    parameters, outputs = arguments.distinct("parameters", parameters), arguments.distinct("outputs", outputs)
    Phi, y = _check_shapes(Phi, y, parameters, outputs)
    nominal = None if near is None else arguments.real("values near which to solve", near)
    J = of(Phi)
    check_rows(J, y, parameters, outputs, noise)
    deviation = initial_deviations(noise, outputs, y)
    solution = solve_with_deviations(J, y, deviation, parameters, nominal)
    for _ in range(PASSES if noise is None and len(outputs) > 1 else 0):
        before, deviation = deviation, deviations(solution, y, outputs)
        solution = solve_with_deviations(J, y, deviation, parameters, nominal)
        if np.allclose(before, deviation, rtol=CONVERGENCE_TOLERANCE, atol=0.0):
            break
    else:
        if noise is None and len(outputs) > 1:
            raise ModelError(no_convergence_text(PASSES))
    return estimate(solution, y, parameters, outputs, noise, level, units)


def solve_with_deviations(
    Phi: Jacobian, y: Array, deviation: Array, parameters: Sequence[str], near: Array | None = None
) -> Solution:
    """Return the solution with output j divided by `deviation[j]`; raise ModelError for undetermined parameters."""
    J, b = Phi.weighted(deviation), (y / deviation).ravel()
    factors = factorise(J)
    if not (factors.group_sigma > estimates.RANK).all():
        group = int(factors.group_sigma.min(axis=1).argmin())
        raise ModelError(
            f"the data leave initial states of span {group} undetermined: take longer spans, or measure more signals"
        )
    if not factors.sigma[-1] > estimates.RANK * max(1.0, factors.sigma[0]):
        combinations = estimates.undetermined_combinations(factors.sigma, factors.V, factors.size, parameters, near)
        raise ModelError(
            f"the data leave {' and '.join(combinations)} undetermined: log samples in which the "
            "parameters act independently, or hold one of them at a known value"
        )
    root = factors.V / factors.sigma / factors.size[:, None]
    e, condition = factors.outside_range(b).reshape(y.shape) * deviation, max(1.0, factors.sigma[0]) / factors.sigma[-1]
    return Solution(
        root @ (factors.U.T @ b),
        e,
        factors.U.reshape(Phi.shared.shape),
        factors.Q.reshape(Phi.group.shape),
        root,
        deviation,
        float(condition),
    )


def estimate(
    solution: Solution,
    y: Array,
    parameters: Sequence[str],
    outputs: Sequence[str],
    noise: Mapping[str, float] | None,
    level: float,
    units: Mapping[str, str] | None,
) -> Estimate:
    """Return a solution with its confidence.

    The deviations are the noise up to a factor; for several outputs without `noise` they are the estimated noise.
    """
    arguments.check_level(level)
    freedom, scale = y.size - len(parameters) - solution.Q.shape[0] * solution.Q.shape[3], solution.deviation
    if noise is None and len(outputs) > 1:
        confidence = noise_confidence(solution.U, solution.Q, solution.root)
    else:
        s = float(np.linalg.norm(solution.e / solution.deviation)) / np.sqrt(freedom)
        scale = s * solution.deviation
        degrees_of_freedom = np.full(len(parameters), float(freedom))
        confidence = Confidence(s**2 * solution.root @ solution.root.T, degrees_of_freedom)
    return Estimate(
        tuple(parameters),
        readonly(solution.theta),
        readonly(confidence.covariance),
        dict(zip(outputs, np.sqrt((solution.e**2).mean(axis=0)).tolist(), strict=True)),
        r_squared(y, solution.e, outputs),
        freedom,
        readonly(confidence.degrees_of_freedom),
        solution.condition,
        level,
        _largest_residual(solution, scale, outputs),
        units or {},
    )


def initial_deviations(noise: Mapping[str, float] | None, outputs: Sequence[str], y: Array) -> Array:
    """Return the noise (p,) of the outputs, or their rms without `noise`.

    Raises SignalError for a noise that is missing, not positive or of no output.
    """
    if noise is None:
        return _size(y)
    if not isinstance(noise, Mapping):
        raise SignalError(f"the noise is {noise}: give a standard deviation by output, like {{'{outputs[0]}': 1e-3}}")
    for name in noise:
        if name not in outputs:
            raise SignalError(f"a noise is given for '{name}', which is not one of the outputs {', '.join(outputs)}")
    for name in outputs:
        value = noise.get(name)
        if not isinstance(value, float | int | np.number) or not arguments.SIZES[0] < value < arguments.SIZES[1]:
            raise SignalError(f"the noise of '{name}' is {value}: give a positive standard deviation")
    return np.array([float(noise[name]) for name in outputs])


def deviations(solution: Solution, y: Array, outputs: Sequence[str]) -> Array:
    """Return the standard deviations (p,) of the outputs' noise that fit the residuals.

    Raises ModelError where the fit of one output is exact and others are not: its weight would be infinite.
    """
    floor = MIN_RELATIVE_RESIDUAL * _size(y)
    estimates = noise_deviations(solution.e, solution.U, solution.Q)
    exact, used = estimates <= floor, solution.U.any(axis=(0, 2)) | solution.Q.any(axis=(0, 1, 3))
    if (exact & used).any() and not (exact | ~used).all():
        name = outputs[int(np.flatnonzero(exact & used)[0])]
        raise ModelError(
            f"the fit is exact for '{name}' but not for other outputs, which leaves its noise unknown: give the "
            "`noise` of each output"
        )
    return np.maximum(estimates, floor)


@arguments.checked
def no_convergence_text(passes: int) -> str:
    """Return the error text for output noise that did not converge."""
    return f"the estimated noise of the outputs does not converge in {passes} fits: give the `noise` of each output"


def r_squared(y: Array, e: Array, outputs: Sequence[str]) -> dict[str, float]:
    """Return R^2 of each output: the fraction of its variance that is explained; NaN without variance."""
    variance = ((y - y.mean(axis=0)) ** 2).mean(axis=0)
    fractions = 1 - (e**2).mean(axis=0) / np.where(variance > 0, variance, np.nan)
    return dict(zip(outputs, fractions.tolist(), strict=True))


def check_rows(
    Phi: Jacobian,
    y: Array,
    parameters: Sequence[str],
    outputs: Sequence[str],
    noise: Mapping[str, float] | None,
) -> None:
    """Raise SignalError for too few rows: more than parameters are needed, in each output of unknown noise."""
    short = Phi.parameters + 1 - y.size
    if short > 0:
        raise SignalError(
            f"{y.size} equations are too few for {Phi.parameters} parameters ({', '.join(parameters)}) and their "
            f"errors: log {short} or more in addition"
        )
    for name, acting in zip(outputs, Phi.parameters_per_output(), strict=True):
        if len(y) <= acting and noise is None and len(outputs) > 1:
            raise SignalError(
                f"{len(y)} rows of '{name}', on which {acting} parameters act, do not determine its noise: give the "
                f"`noise` of each output, or log {acting + 1 - len(y)} or more rows in addition"
            )


def _check_shapes(
    Phi: ArrayLike, y: ArrayLike, parameters: Sequence[str], outputs: Sequence[str]
) -> tuple[Array, Array]:
    Phi, y = arguments.real("regressors", Phi), arguments.real("outputs", y)
    if y.ndim == 1 and Phi.ndim == 2:
        Phi, y = Phi[:, None, :], y[:, None]
    shape = (len(y) if y.ndim else 0, len(outputs), len(parameters))
    if y.ndim != 2 or Phi.shape != shape or y.shape != shape[:2]:
        raise SignalError(
            f"the regressors have shape {Phi.shape} and the outputs {y.shape}: {len(outputs)} outputs and "
            f"{len(parameters)} parameters need (N, {len(outputs)}, {len(parameters)}) and (N, {len(outputs)})"
        )
    arguments.check_samples(y, outputs)
    for row, j, i in np.argwhere(~np.isfinite(Phi)):
        raise SignalError(
            f"row {row} of the regressor of '{parameters[i]}' in '{outputs[j]}' is {Phi[row, j, i]}: leave the row out"
        )
    arguments.check_sizes("the regressor of", Phi.reshape(y.size, len(parameters)), parameters)
    return Phi, y


def _largest_residual(solution: Solution, scale: Array, outputs: Sequence[str]) -> Residual:
    """Return the largest residual relative to its standard deviation, the noise times sqrt(1 - leverage)."""
    variance_share = 1 - (solution.U**2).sum(axis=2) - (solution.Q**2).sum(axis=3).reshape(solution.e.shape)
    deviation = scale * np.sqrt(np.where(variance_share > PASSED_THROUGH, variance_share, np.inf))
    size = np.abs(solution.e) / np.where(deviation > 0, deviation, np.inf)
    row, j = divmod(int(size.argmax()), len(outputs))
    return Residual(outputs[j], row, float(size[row, j]), size.size)


def _size(y: Array) -> Array:
    rms = np.sqrt((y**2).mean(axis=0))
    return np.where(rms > 0, rms, 1.0)
