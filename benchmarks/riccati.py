"""Riccati equations with weights over many decades: outcomes of the toolkit and of SciPy.

300 random problems, seeded, a quarter of them in discrete time: 2 to 12 states, stable, unstable, stiff, chains of
integrators and Hilbert matrices, with weights over 14 decades. The solution X and gain L of either solver, L in double
precision, are right when the loop with L is stable and X, the cost of L and the cost of the next gain in Newton's
method differ by less than 1e-6 of its largest entry. The check solves the Lyapunov equations of these costs entry by
entry in 512 bits, without the toolkit.

    python -m benchmarks.riccati [number of problems]
"""

import sys
import warnings
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from time import perf_counter

import flint
import numpy as np
import scipy.linalg

from synth.errors import SynthError
from synth.statespace import Array
from synth.synthesise.riccati import riccati
from synth.timing import Continuous, Discrete, Time

RIGHT = 1e-6  # of the largest entry of X
DECADES = 14
BITS = 512  # of the check, which rounds and keeps no bounds
KINDS = ("stable", "unstable", "stiff", "chain", "Hilbert", "Hilbert", "negative Hilbert", "negative Hilbert")


@dataclass(frozen=True, eq=False)
class Problem:
    """A model x' = A x + B u, or x+, with weights Q, R."""

    kind: str
    A: Array
    B: Array
    Q: Array
    R: Array
    time: Time

    @property
    def continuous(self) -> bool:
        """Whether time is continuous."""
        return isinstance(self.time, Continuous)


@dataclass(frozen=True)
class Outcome:
    """The outcomes of a problem: "right", "wrong", "refused" or "raw error", and the seconds of the toolkit."""

    ours: str
    scipy: str
    reason: str
    seconds: float


def problem(seed: int) -> Problem:
    """Return the problem of a seed."""
    rng = np.random.default_rng(seed)
    n, m = int(rng.integers(2, 13)), int(rng.integers(1, 3))
    continuous, kind = bool(seed % 4), KINDS[int(rng.integers(len(KINDS)))]
    A = _dynamics(rng, n, kind)
    if not continuous:
        A = scipy.linalg.expm(A * 0.1 / max(1.0, float(np.linalg.norm(A, 2))))
    B = np.eye(n, m) + (rng.normal(size=(n, m)) if rng.uniform() < 0.5 else np.ones((n, m)))
    size, spread = 10.0 ** rng.uniform(0, DECADES), rng.uniform()
    Q = size * (np.eye(n) if spread < 0.7 else np.diag(10.0 ** rng.uniform(-DECADES, 0, n)))
    if spread > 0.85:
        C = rng.normal(size=(int(rng.integers(1, n + 1)), n))
        Q = size * (C.T @ C)
    R = np.eye(m) / size if spread < 0.5 else np.diag(10.0 ** rng.uniform(-DECADES, 0, m))
    return Problem(kind, A, B, (Q + Q.T) / 2, R, Continuous() if continuous else Discrete(0.1))


def _dynamics(rng: np.random.Generator, n: int, kind: str) -> Array:
    i = np.arange(n)
    if kind in ("Hilbert", "negative Hilbert"):
        hilbert = 1.0 / (i[:, None] + i + 1)
        return hilbert if kind == "Hilbert" else -hilbert
    if kind == "chain":
        return np.diag(np.ones(n - 1), 1)
    if kind == "stiff":
        rates = 10.0 ** rng.uniform(-3, 4, n) * rng.choice([-1.0, 1.0], n, p=[0.8, 0.2])
        V = rng.normal(size=(n, n)) + 2 * np.eye(n)
        return np.asarray(np.linalg.solve(V, rates[:, None] * V))
    A = rng.normal(size=(n, n))
    shift = float(np.linalg.eigvals(A).real.max())
    return A - (shift + 0.1) * np.eye(n) if kind == "stable" else A - (shift - 1.0) * np.eye(n)


def is_right(p: Problem, X: Array, L: Array) -> bool:
    """Return whether X (n, n) is the stabilising solution and L (m, n) its gain, from the problem's data alone."""
    if not (np.isfinite(X).all() and np.isfinite(L).all()):
        return False
    with flint.ctx.workprec(BITS):
        A, B, Q, R, gain = (flint.arb_mat(M.tolist()) for M in (p.A, p.B, p.Q, p.R, L))
        try:
            if not _is_definite(_cost(A - B * gain, _identity(A.nrows()), p.continuous)):
                return False  # Lyapunov: the loop does not decay
            cost = _cost(A - B * gain, Q + gain.transpose() * R * gain, p.continuous)
            held = B.transpose() * cost
            following = (
                R.solve(held) if p.continuous else (R + held * B).solve(held * A)
            ).mid()  # Kleinman's iteration
            better = _cost(A - B * following, Q + following.transpose() * R * following, p.continuous)
        except ZeroDivisionError:
            return False
        return max(_size(cost - flint.arb_mat(X.tolist())), _size(better - cost)) <= RIGHT * _size(better)


def _cost(F: flint.arb_mat, W: flint.arb_mat, continuous: bool) -> flint.arb_mat:
    """Return X of F'X + X F + W = 0, or of F'X F - X + W = 0, one linear equation for each entry."""
    n, f = F.nrows(), F.table()
    places = [(i, j) for i in range(n) for j in range(n)]

    def factor(i: int, j: int, k: int, l: int) -> flint.arb:
        if not continuous:
            return f[k][i] * f[l][j] - (i == k and j == l)
        return f[k][i] * (j == l) + f[l][j] * (i == k)

    equations = flint.arb_mat([[factor(*row, *column) for column in places] for row in places])
    entries = equations.solve(flint.arb_mat([[-W[i, j]] for i, j in places]), algorithm="approx")
    return flint.arb_mat([[entries[n * i + j, 0] for j in range(n)] for i in range(n)])


def _identity(n: int) -> flint.arb_mat:
    return flint.arb_mat([[int(i == j) for j in range(n)] for i in range(n)])


def _is_definite(P: flint.arb_mat) -> bool:
    """Return whether all leading minors of a symmetric matrix are positive."""
    rows = P.table()
    return all(bool(flint.arb_mat([row[:k] for row in rows[:k]]).det() > 0) for k in range(1, len(rows) + 1))


def _size(M: flint.arb_mat) -> float:
    return max(float(abs(v).upper()) for v in M.entries())


def outcome(p: Problem) -> Outcome:
    """Solve a problem in both ways."""
    reason, start = "", perf_counter()
    try:
        solution = riccati.solve((p.A, p.B, p.time), p.Q, p.R)
        ours = "solved"
    except SynthError as error:
        ours, reason = "refused", str(error)
    except Exception as error:  # raw errors are counted
        ours, reason = "raw error", f"{type(error).__name__}: {error}"
    seconds = perf_counter() - start
    if ours == "solved":
        ours = (
            "right"
            if is_right(p, solution.X, solution.L)
            else "wrong"
            if solution.is_resolved
            else "gain lost in rounding, reported"
        )
    return Outcome(ours, _scipys(p), reason, seconds)


def _scipys(p: Problem) -> str:
    solver = scipy.linalg.solve_continuous_are if p.continuous else scipy.linalg.solve_discrete_are
    with warnings.catch_warnings(), np.errstate(all="ignore"):
        warnings.simplefilter("ignore")
        try:
            X = solver(p.A, p.B, p.Q, p.R)
            X = (X + X.T) / 2
            XB = X @ p.B
            L = np.linalg.solve(p.R, XB.T) if p.continuous else np.linalg.solve(p.R + p.B.T @ XB, XB.T @ p.A)
            return "right" if is_right(p, X, L) else "wrong"
        except np.linalg.LinAlgError:
            return "refused"
        except ValueError:
            return "raw error"


def table(count: int) -> Iterator[str]:
    """Yield the problems that are refused or wrong, each when it is known, and finally the counts."""
    outcomes = []
    for seed in range(count):
        p = problem(seed)
        outcomes.append(outcome(p))
        last = outcomes[-1]
        if last.ours != "right" or last.seconds > 1:
            yield (
                f"{seed}: {p.kind}, n = {len(p.A)}, {last.seconds:.1f} s, ours {last.ours}, SciPy's {last.scipy}: "
                + (last.reason[:160])
            )
    yield "ours:    " + ", ".join(f"{k} {v}" for k, v in sorted(Counter(o.ours for o in outcomes).items()))
    yield "SciPy's: " + ", ".join(f"{k} {v}" for k, v in sorted(Counter(o.scipy for o in outcomes).items()))
    missed = sum(o.scipy == "right" and o.ours != "right" for o in outcomes)
    yield f"not right though SciPy's is: {missed}; longest {max(o.seconds for o in outcomes):.1f} s"


if __name__ == "__main__":
    for line in table(int(sys.argv[1]) if len(sys.argv) > 1 else 300):
        sys.stdout.write(f"{line}\n")
        sys.stdout.flush()
