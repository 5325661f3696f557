"""A Riccati equation in balanced coordinates x = D z, u = E v, with diagonal D (n, n), E (m, m) of powers of 2.

In these coordinates R has a unit diagonal and A, B R^-1 B' and Q are of similar size. What counts as rounding error
therefore does not depend on the units of the signals.
"""

from dataclasses import dataclass

import numpy as np

from synth.errors import ModelError
from synth.statespace import Array
from synth.synthesise.riccati import doubling, newton
from synth.synthesise.riccati.equation import Equation, Solution, sizes


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

    def unscale(self, solution: Solution) -> Solution:
        """Return the solution of the original equation for a solution of the scaled one."""
        return solution.scaled(1 / self.D, 1 / self.E)

    def certify(self, solution: Solution) -> newton.CertifiedSolution:
        """Return the certificate of a solution of the original equation."""
        return newton.certify(self.scaled, solution.scaled(self.D, self.E), self.bilinear)

    def evaluate(self, X: Array) -> Solution:
        """Return a symmetric X (n, n) of the original equation as a solution of the balanced one.

        Raises ModelError when R + B'XB is singular.
        """
        X = X * self.D * self.D[:, None]
        try:
            defect, L = self.scaled.residual(X)
        except np.linalg.LinAlgError as error:
            raise ModelError("R + B'XB is singular: this X has no gain; certify one that stabilises") from error
        closed = self.scaled.A - self.scaled.B @ L
        decay = doubling.stable_map(closed, self.bilinear)
        step = np.full_like(X, np.inf) if decay is None else decay.gramian(defect)
        return Solution(X, L, closed, defect, step)

    def least_eigenvalue(self, X: Array, forward_error: float) -> float:
        """Return the least eigenvalue of balanced X over its states' sizes; 0 if the error of X exceeds it."""
        X = X * self.D * self.D[:, None]
        size = sizes(X)
        least = float(np.linalg.eigvalsh(X / size / size[:, None])[0])
        known = len(X) * max(forward_error, 2.0**-52)
        return 0.0 if np.isfinite(known) and abs(least) <= known else least
