"""A Riccati equation in balanced coordinates x = D z, u = E v, with diagonal D (n, n), E (m, m) of powers of 2.

There R has a unit diagonal, A, B R^-1 B' and Q are of like size, and what counts as rounding does not depend on units.
"""

from dataclasses import dataclass

import numpy as np

from synth.errors import ModelError
from synth.statespace import Array
from synth.synthesise.riccati import doubling, newton
from synth.synthesise.riccati.equation import Equation, Solution, sizes


@dataclass(frozen=True, eq=False)
class Balance:
    """The scaled equation, the scales D (n,), E (m,) of states and inputs, and the map that doubling takes."""

    scaled: Equation
    D: Array
    E: Array
    bilinear: doubling.Bilinear

    @staticmethod
    def of(stated: Equation) -> "Balance":
        D, E = stated.scales()
        scaled = stated.scaled(D, E)
        return Balance(scaled, D, E, doubling.fitting(scaled))

    def back(self, found: Solution) -> Solution:
        """Return a solution of the scaled equation as that of the equation itself."""
        return found.scaled(1 / self.D, 1 / self.E)

    def certified(self, found: Solution) -> newton.Certified:
        """Return the certificate of a solution of the equation itself."""
        return newton.certified(self.scaled, found.scaled(self.D, self.E), self.bilinear)

    def evaluated(self, X: Array) -> Solution:
        """Return the solution of the balanced equation to which a symmetric X (n, n) of the equation itself amounts.

        Raises ModelError when R + B'XB is singular.
        """
        X = X * self.D * self.D[:, None]
        try:
            defect, L = self.scaled.residual(X)
        except np.linalg.LinAlgError as error:
            raise ModelError("R + B'XB is singular: this X has no gain; certify one that stabilises") from error
        closed = self.scaled.A - self.scaled.B @ L
        decay = doubling.decay(closed, self.bilinear)
        step = np.full_like(X, np.inf) if decay is None else decay.gathered(defect)
        return Solution(X, L, closed, defect, step)

    def of_easier(self, weighted: Equation) -> Array | None:
        """Return the balanced cost of the feedback that is optimal for more moderate weights, None if not found."""
        try:
            moderate = weighted.moderate()
            X = doubling.solution(moderate, doubling.fitting(moderate))
            return None if X is None else newton.evaluated(self.scaled, moderate.gain(X), self.bilinear)
        except np.linalg.LinAlgError:  # R is singular
            return None

    def least_eigenvalue(self, X: Array, forward_error: float) -> float:
        """Return the least eigenvalue of balanced X over its states' sizes; 0 where X's error hides its sign."""
        X = X * self.D * self.D[:, None]
        size = sizes(X)
        least = float(np.linalg.eigvalsh(X / size / size[:, None])[0])
        known = len(X) * max(forward_error, 2.0**-52)
        return 0.0 if np.isfinite(known) and abs(least) <= known else least
