"""Time of optimal gains compared with plain SciPy: Riccati solutions with certificate, and lqrd.

    CARE, DARE   riccati.solve beside solve_continuous_are, solve_discrete_are
    lqrd         lqr.lqrd beside the exponential of Van Loan's block matrix, solve_discrete_are and one linear solve

Both run in turn on one core, and times are medians. Residuals are those of `riccati.certify`, for SciPy's X too: sums
in twice double precision, each entry relative to the sum of its absolute terms. The stiff model has poles from
1e-2 to 1e5 1/s, one of ten unstable. At n = 200 the solutions are sensitive to their data because few inputs move many
unstable modes.
"""

import os
import sys
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from statistics import median
from time import perf_counter

import numpy as np
import scipy.linalg

from synth.statespace import Array
from synth.synthesise.feedback import lqr
from synth.synthesise.riccati import riccati
from synth.timing import Continuous, Discrete, Time

PERIOD = 1e-3  # s
ONE_CORE = {"OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1", "MKL_NUM_THREADS": "1"}


@dataclass(frozen=True, eq=False)
class Problem:
    """A model x' = A x + B u, or x+, with weights Q, R, N."""

    A: Array
    B: Array
    Q: Array
    R: Array
    N: Array
    time: Time

    @property
    def system(self) -> tuple[Array, Array, Time]:
        """The model as arrays."""
        return self.A, self.B, self.time


@dataclass(frozen=True)
class Comparison:
    """Median seconds of ours and of SciPy's, the residuals of both, and the certificate of ours."""

    ours_s: float
    scipy_s: float
    residual: float
    scipy_residual: float
    forward_error: float
    condition: float


def dense(n: int, m: int, time: Time, crossed: bool = False) -> Problem:
    """Return a random model with half of its modes unstable, and random definite weights."""
    rng = np.random.default_rng(n + m)
    A = rng.normal(size=(n, n)) / (1.0 if isinstance(time, Continuous) else 0.9 * np.sqrt(n))
    W = rng.normal(size=(n + m, n + m))
    W = W @ W.T / (n + m) + 0.1 * np.eye(n + m)
    N = W[:n, n:] if crossed else np.zeros((n, m))
    return Problem(A, rng.normal(size=(n, m)), W[:n, :n], W[n:, n:], N, time)


def stiff(n: int, m: int) -> Problem:
    """Return a random model with time constants over seven decades."""
    rng = np.random.default_rng(n)
    rates = 10.0 ** rng.uniform(-2, 5, n) * rng.choice([-1.0, 1.0], n, p=[0.9, 0.1])
    V, C = rng.normal(size=(n, n)), rng.normal(size=(m, n))
    return Problem(
        np.linalg.solve(V, rates[:, None] * V),
        rng.normal(size=(n, m)),
        C.T @ C,
        np.eye(m),
        np.zeros((n, m)),
        Continuous(),
    )


def compare_riccati(p: Problem, runs: int) -> Comparison:
    """Solve the Riccati equation in both ways."""
    solver = scipy.linalg.solve_continuous_are if isinstance(p.time, Continuous) else scipy.linalg.solve_discrete_are
    cross = p.N if p.N.any() else None

    def plain() -> Array:
        return np.asarray(solver(p.A, p.B, p.Q, p.R, s=cross))

    ours, theirs = _median_times(lambda: riccati.solve(p.system, p.Q, p.R, p.N), plain, runs)
    return _comparison(p, riccati.solve(p.system, p.Q, p.R, p.N), plain(), ours, theirs)


def compare_lqrd(p: Problem, runs: int) -> Comparison:
    """Compute the gain for a held input in both ways."""
    ours, theirs = _median_times(lambda: lqr.lqrd(p.system, p.Q, p.R, PERIOD, p.N), lambda: _plain_lqrd(p), runs)
    cost = lqr.sampled_cost(p.system, p.Q, p.R, PERIOD, p.N)
    held = Problem(cost.model.A, cost.model.B, cost.Q, cost.R, cost.N, Discrete(PERIOD))
    X, _ = _plain_lqrd(p)
    return _comparison(held, lqr.lqrd(p.system, p.Q, p.R, PERIOD, p.N).certificate, X, ours, theirs)


def _plain_lqrd(p: Problem) -> tuple[Array, Array]:
    """Return X and K computed with SciPy alone."""
    n, m = p.B.shape
    F = np.block([[p.A, p.B], [np.zeros((m, n + m))]])
    W = np.block([[p.Q, p.N], [p.N.T, p.R]])
    E = scipy.linalg.expm(np.block([[-F.T, W], [np.zeros_like(F), F]]) * PERIOD)
    M = E[n + m :, n + m :]
    W = M.T @ E[: n + m, n + m :]
    W = (W + W.T) / 2
    A, B, Q, R, N = M[:n, :n], M[:n, n:], W[:n, :n], W[n:, n:], W[:n, n:]
    X = scipy.linalg.solve_discrete_are(A, B, Q, R, s=N)
    return X, -np.linalg.solve(R + B.T @ X @ B, B.T @ X @ A + N.T)


def _median_times(ours: Callable[[], object], theirs: Callable[[], object], runs: int) -> tuple[float, float]:
    """Return the median seconds of each, run in turn."""
    spent: tuple[list[float], list[float]] = ([], [])
    for _ in range(runs):
        for run, times in zip((ours, theirs), spent, strict=True):
            start = perf_counter()
            run()
            times.append(perf_counter() - start)
    return median(spent[0]), median(spent[1])


def _comparison(p: Problem, ours: riccati.Riccati, X: Array, ours_s: float, scipy_s: float) -> Comparison:
    theirs = riccati.certify(p.system, p.Q, p.R, (X + X.T) / 2, p.N)
    return Comparison(ours_s, scipy_s, ours.residual, theirs.residual, ours.forward_error, ours.condition)


CASES: dict[str, Callable[[], Comparison]] = {
    "lqrd, n = 10, m = 3": lambda: compare_lqrd(dense(10, 3, Continuous()), 201),
    "CARE, n = 10, m = 3": lambda: compare_riccati(dense(10, 3, Continuous()), 201),
    "DARE, n = 10, m = 3": lambda: compare_riccati(dense(10, 3, Discrete(PERIOD)), 201),
    "CARE, n = 50, m = 5": lambda: compare_riccati(dense(50, 5, Continuous()), 5),
    "CARE, n = 80, m = 8, stiff": lambda: compare_riccati(stiff(80, 8), 3),
    "CARE, n = 80, m = 8, cross weight": lambda: compare_riccati(dense(80, 8, Continuous(), crossed=True), 3),
    "DARE, n = 80, m = 8": lambda: compare_riccati(dense(80, 8, Discrete(PERIOD)), 3),
}


def table() -> Iterator[str]:
    """Yield the table's lines, each when it has been measured."""
    names = ("ours, ms", "SciPy, ms", "ratio", "residual", "SciPy's", "error of X", "condition")
    width = max(map(len, CASES))
    yield "  ".join((" " * width, *names))
    for case, measure in CASES.items():
        c = measure()
        cells = (
            *(f"{1e3 * c.ours_s:.2f}", f"{1e3 * c.scipy_s:.2f}", f"{c.ours_s / c.scipy_s:.2f}"),
            *(f"{v:.1e}" for v in (c.residual, c.scipy_residual, c.forward_error, c.condition)),
        )
        row = (cell.rjust(len(name)) for cell, name in zip(cells, names, strict=True))
        yield "  ".join((case.ljust(width), *row))


if __name__ == "__main__":
    if any(os.environ.get(name) != count for name, count in ONE_CORE.items()):
        # NumPy and SciPy bring a BLAS each, whose threads wait for one another; they read these when they are loaded.
        os.execve(sys.executable, [sys.executable, "-m", "benchmarks.synthesis"], {**os.environ, **ONE_CORE})
    for line in table():
        sys.stdout.write(f"{line}\n")
        sys.stdout.flush()
