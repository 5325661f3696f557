"""Riccati equations with weights over many decades: what is solved, what is refused, and what SciPy makes of them.

300 random problems, seeded, a quarter of them in discrete time: 2 to 12 states, stable, unstable, stiff, chains of
integrators and Hilbert matrices, with weights over 14 decades. X and L of either solver, L in double precision, are
right when the loop with L is stable and X, the cost of L and the cost of the next gain in Newton's method differ by
less than 1e-6 of its largest entry, in ball arithmetic.

    python -m benchmarks.riccati [number of problems]
"""

import sys
import warnings
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from time import perf_counter

import numpy as np
import scipy.linalg

from synth.analyse import precise
from synth.errors import SynthError
from synth.statespace import Array
from synth.synthesise.riccati import exact_riccati, riccati, spectrum
from synth.synthesise.riccati.equation import Equation, decays
from synth.timing import Continuous, Discrete, Time

RIGHT = 1e-6  # of the largest entry of X
DECADES = 14
BITS = 512
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
    def equation(self) -> Equation:
        """The Riccati equation."""
        return Equation(self.A, self.B, self.Q, self.R, np.zeros_like(self.B), isinstance(self.time, Continuous))


@dataclass(frozen=True)
class Outcome:
    """What became of a problem: "right", "wrong", "refused" or "raw error", with the seconds that ours took."""

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
    """Tell whether X (n, n) is the stabilising solution and L (m, n) its gain, in ball arithmetic."""
    if not (np.isfinite(X).all() and np.isfinite(L).all()):
        return False
    with precise.precision(BITS):
        exact, gain = exact_riccati._problem(p.equation), precise.matrix(L)
        if not decays(spectrum.of(precise.middle(exact.A - exact.B * gain)), p.equation.continuous):
            return False
        try:
            cost = exact.cost(gain)
            better = exact.newton(precise.middle(cost))
        except ZeroDivisionError:
            return False
        apart = precise.norm(cost - precise.matrix(X)), precise.norm(better - cost)
        return max(apart) <= RIGHT * precise.norm(better)


def outcome(p: Problem) -> Outcome:
    """Solve a problem in both ways."""
    reason, start = "", perf_counter()
    try:
        found = riccati.solve((p.A, p.B, p.time), p.Q, p.R)
        ours = "solved"
    except SynthError as error:
        ours, reason = "refused", str(error)
    except Exception as error:  # the very thing that is counted
        ours, reason = "raw error", f"{type(error).__name__}: {error}"
    seconds = perf_counter() - start
    if ours == "solved":
        ours = (
            "right"
            if is_right(p, found.X, found.L)
            else "wrong"
            if found.is_resolved
            else "gain lost in rounding, told"
        )
    return Outcome(ours, _scipys(p), reason, seconds)


def _scipys(p: Problem) -> str:
    solver = scipy.linalg.solve_continuous_are if p.equation.continuous else scipy.linalg.solve_discrete_are
    with warnings.catch_warnings(), np.errstate(all="ignore"):
        warnings.simplefilter("ignore")
        try:
            X = solver(p.A, p.B, p.Q, p.R)
            X = (X + X.T) / 2
            return "right" if is_right(p, X, p.equation.gain(X)) else "wrong"
        except np.linalg.LinAlgError:
            return "refused"
        except ValueError:
            return "raw error"


def table(count: int) -> Iterator[str]:
    """Yield what is refused or wrong, each when it is known, and the counts in the end."""
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
