"""Riccati, Stein and Lyapunov equations by doubling: each pass takes twice the horizon of the one before.

    X = A'X (I + G X)^-1 A + H      A <- A V,  G <- G + A (I + G H)^-1 G A',  H <- H + A'H V,   V = (I + G H)^-1 A
    Y = A'Y A + W                   Y <- Y + A'Y A,  A <- A^2

H and Y increase to the solutions (Chu, Fan, Lin, Wang 2004; Smith 1968). How many passes that takes is told by the
slowest pole, so that the poles are first moved towards z = 0 by a bilinear map, with which X and Y are the same:

    continuous  z = (c + s) / (c - s)        J = (c I - A)^-1,  A_d = (A + c I) J,  g = 2 c,      k = -1
    discrete    z <- (z + k) / (1 + k z)     J = (I + k A)^-1,  A_d = (A + k I) J,  g = 1 - k^2,  k = (c - 1) / (c + 1)

    B_d = sqrt(g) J B,   Q_d = g J'Q J,   N_d = sqrt(g) J'(N - k Q J B),   R_d = R - k (N'J B + B'J'N) + k^2 B'J'Q J B

and W_d = g J'W J for the linear equations. c is near the geometric mean of the poles' |s|, or |z - 1| / 2.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from synth.statespace import Array
from synth.synthesise.riccati.equation import Equation

PASSES = 60  # doublings: 2^60 periods; what has not settled by then does not
SETTLED = 1e-7  # of H: what is still to come is the square of the last increment, and Newton's method comes after
DECAYED = 1e-2  # of a state: what is left of Y after it is the square of this
FACTORS = (1.0, 2.0, 4.0)  # of the mean rate, to be tried
LARGEST = 10.0  # root mean square of the singular values of c J, or (1 + k) J: far from the eigenvalues of A


@dataclass(frozen=True)
class Bilinear:
    """The map of rate c: in 1/s for continuous time, else a number."""

    c: float
    continuous: bool

    @property
    def k(self) -> float:
        """The map's shift."""
        return -1.0 if self.continuous else (self.c - 1) / (self.c + 1)

    @property
    def g(self) -> float:
        """The map's gain."""
        return 2 * self.c if self.continuous else 4 * self.c / (1 + self.c) ** 2

    def resolvent(self, A: Array) -> Array | None:
        """Return J (n, n), None where A has an eigenvalue that is mapped to infinity."""
        one = np.eye(len(A))
        try:
            return np.asarray(np.linalg.inv(self.c * one - A if self.continuous else one + self.k * A))
        except np.linalg.LinAlgError:
            return None

    def moved(self, A: Array, J: Array) -> Array:
        """Return A_d (n, n)."""
        return A @ J + (self.c if self.continuous else self.k) * J


@dataclass(frozen=True, eq=False)
class Decay:
    """A stable linear map: the powers A_d^1, A_d^2, A_d^4 .. (n, n) of its bilinear image, J and g."""

    powers: Sequence[Array]
    J: Array
    g: float

    def gathered(self, W: Array) -> Array:
        """Return Y (n, n) for a symmetric W (n, n)."""
        Y = self.g * (self.J.T @ W @ self.J)
        for A in self.powers:
            Y = Y + A.T @ Y @ A
        return (Y + Y.T) / 2


@np.errstate(all="ignore")
def decay(A: Array, bilinear: Bilinear) -> Decay | None:
    """Return the decay of dx/dt = A x, or x+ = A x; None when x does not decay."""
    J = bilinear.resolvent(A)
    if J is None:
        return None
    powers = [bilinear.moved(A, J)]
    for _ in range(PASSES):
        size = float(np.vdot(powers[-1], powers[-1]))
        if size < DECAYED * DECAYED:
            return Decay(powers[:-1] or powers, J, bilinear.g)
        if not size < 1e300:
            break
        powers.append(powers[-1] @ powers[-1])
    return None


def solution(equation: Equation, bilinear: Bilinear) -> Array | None:
    """Return X (n, n) of a balanced equation in double precision.

    Returns None when the doubling does not settle, or R or R_d is not positive definite in double precision.
    """
    try:
        discrete = _mapped(equation, bilinear)
        found = _settled(*_standard(_offset(discrete)))
        return None if found is None else found + discrete.Q
    except np.linalg.LinAlgError:
        return None


@np.errstate(all="ignore")
def _settled(A: Array, G: Array, H: Array) -> Array | None:
    """Return the limit of H; raise LinAlgError when I + G H is singular."""
    one = np.eye(len(A))
    for _ in range(PASSES):
        inverse = np.linalg.inv(one + G @ H)
        V = inverse @ A
        step = (H @ A).T @ V
        G = G + (A @ inverse) @ (G @ A.T)
        A = A @ V
        H = H + step
        G, H = (G + G.T) / 2, (H + H.T) / 2
        size = float(np.vdot(H, H))
        if not size < 1e300:
            return None
        if float(np.vdot(step, step)) <= SETTLED * SETTLED * size:
            return H
    return None


def fitting(equation: Equation) -> Bilinear:
    """Return the map for the poles of the optimal loop, its rate moved off the eigenvalues of A."""
    c, tried = _mean(equation), []
    for bilinear in (Bilinear(factor * c, equation.continuous) for factor in FACTORS):
        J = bilinear.resolvent(equation.A)
        unit = bilinear.c if equation.continuous else 1 + bilinear.k
        tried.append(np.inf if J is None else unit * float(np.linalg.norm(J)))
        if tried[-1] < LARGEST * np.sqrt(len(equation.A)):
            return bilinear
    return Bilinear(FACTORS[int(np.argmin(tried))] * c, equation.continuous)


def _mean(e: Equation) -> float:
    """Return the geometric mean of the poles' |s|, or of |z - 1| / 2 but 1 at most, from the pencil's determinant."""
    try:
        (A, G, Q), one = _standard(e), np.eye(len(e.A))
    except np.linalg.LinAlgError:  # R is not positive definite, which only discrete time allows
        return 1.0
    if e.continuous:
        above = _logarithm(A, -G, -Q, -A.T)
        with np.errstate(over="ignore"):
            size = max(float(np.linalg.norm(M)) for M in (A, G, Q))
        largest = np.log(size if np.isfinite(size) else max(float(np.abs(M).max()) for M in (A, G, Q)))
        return float(np.exp(above if above > largest - 30 else largest))
    above = _logarithm(A - one, -G, -Q, one - A.T)
    return float(np.exp(min(max(above, -30.0), np.log(2.0)))) / 2


def _logarithm(*quarters: Array) -> float:
    """Return the mean logarithm of a block matrix' absolute eigenvalues."""
    P, Q, R, S = quarters
    M = np.concatenate([np.concatenate([P, Q], axis=1), np.concatenate([R, S], axis=1)])
    return float(np.linalg.slogdet(M)[1]) / len(M)


def _mapped(e: Equation, bilinear: Bilinear) -> Equation:
    """Return the discrete equation that has the same solution."""
    J, k, root = bilinear.resolvent(e.A), bilinear.k, np.sqrt(bilinear.g)
    if J is None:
        raise np.linalg.LinAlgError("the map takes an eigenvalue to infinity")
    JB = J @ e.B
    QJB, NJB = e.Q @ JB, e.N.T @ JB
    R = e.R - k * (NJB + NJB.T) + k * k * (JB.T @ QJB)
    return Equation(
        bilinear.moved(e.A, J), root * JB, bilinear.g * J.T @ e.Q @ J, R, root * J.T @ (e.N - k * QJB), False
    )


def _offset(e: Equation) -> Equation:
    """Return the discrete equation for X - Q, in which B'QB stands beside R: then R may be as small as it likes."""
    QA, QB = e.Q @ e.A, e.Q @ e.B
    return Equation(e.A, e.B, e.A.T @ QA, e.R + e.B.T @ QB, e.N + e.A.T @ QB, False)


def _standard(e: Equation) -> tuple[Array, Array, Array]:
    """Return A - B R^-1 N', B R^-1 B' and Q - N R^-1 N'."""
    whitened = _whitened(e.R, np.concatenate([e.B.T, e.N.T], axis=1))
    B, N = whitened[:, : len(e.A)], whitened[:, len(e.A) :]
    return e.A - B.T @ N, B.T @ B, e.Q - N.T @ N


def _whitened(R: Array, right: Array) -> Array:
    """Return F^-1 Y, R = F F'; raise LinAlgError when R is not positive definite."""
    return np.asarray(np.linalg.solve(np.linalg.cholesky(R), right), dtype=np.float64)
