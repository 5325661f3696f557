"""A Riccati equation in balanced coordinates x = D z, u = E v, with diagonal D (n, n), E (m, m) of powers of 2.

In these coordinates R has a unit diagonal and A, B R^-1 B' and Q are of similar size. What counts as rounding error
therefore does not depend on the units of the signals.
"""

from dataclasses import dataclass

import numpy as np

from synth.statespace import Array
from synth.synthesise.riccati import doubling
from synth.synthesise.riccati.equation import Equation, Solution, sizes


@dataclass(frozen=True)
class Certificate:
    """What `riccati.Riccati` reports of a solution; the condition is infinite where its loop is not stable."""

    residual: float
    forward_error: float
    condition: float


@dataclass(frozen=True, eq=False)
class Balance:
    """The scaled equation, the scales D (n,), E (m,) of states and inputs, and the bilinear map for doubling."""

    scaled: Equation
    D: Array
    E: Array
    bilinear: doubling.Bilinear

    @staticmethod
    def of(equation: Equation) -> "Balance":
        D, E = equation.scales()
        scaled = equation.scaled(D, E)
        return Balance(scaled, D, E, doubling.bilinear_map(scaled))

    @np.errstate(all="ignore")
    def certify(self, solution: Solution) -> Certificate:
        """Return the certificate of any solution of the original equation."""
        solution = solution.scaled(self.D, self.E)
        T, decay = self.scaled.terms(solution.X), doubling.stable_map(solution.closed, self.bilinear)
        size = sizes(solution.X)
        condition = np.inf if decay is None else _condition(T, size, decay)
        forward_error = float((np.abs(solution.step) / size / size[:, None]).max())
        return Certificate(_relative_residual(solution.defect, T), forward_error, condition)

    def least_eigenvalue(self, X: Array, forward_error: float) -> float:
        """Return the least eigenvalue of balanced X over its states' sizes; 0 if the error of X exceeds it."""
        X = X * self.D * self.D[:, None]
        size = sizes(X)
        least = float(np.linalg.eigvalsh(X / size / size[:, None])[0])
        known = len(X) * max(forward_error, 2.0**-52)
        return 0.0 if np.isfinite(known) and abs(least) <= known else least


def _relative_residual(defect: Array, T: Array) -> float:
    """Return the largest |d_ij| over the greater of T_ij and sqrt(T_ii T_jj).

    T_ii has a floor, as the terms of a state without cost are rounding errors of zero.
    """
    root = sizes(T)
    return float((np.abs(defect) / np.maximum(T, root * root[:, None])).max())


def _condition(T: Array, size: Array, decay: doubling.StableMap) -> float:
    """Return the largest change of X_ij / (s_i s_j), sizes s, for relative changes |dT_ij| <= T_ij of the terms.

    They give dT <= diag(s_i sum_j T_ij / s_j), and the linear equation of Newton's step preserves that order.
    """
    changed = decay.gramian(np.diag(size * (T / size).sum(axis=1)))
    return float((changed.diagonal() / (size * size)).max())
