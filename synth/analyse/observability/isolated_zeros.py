"""All isolated zeros of n periodic equations in n unknowns, each proved by Krawczyk's test in ball arithmetic.

    f(p) = 0,    p in [0, 2 pi)^n,    f of period 2 pi in each unknown

for example det H(p) = 0, where a measurement loses rank. A cell is discarded if a slope bound shows that an equation
has no zero in it; the other cells are halved along each side. Newton's method leads from the remaining cells to zeros.
Krawczyk's test proves for each zero that a cube about it contains exactly one zero. In the end all remaining cells must
lie in such cubes. Zeros are computed to `precise.BITS`, and rounded values are the same on every machine.

Source: Krawczyk, "Newton-Algorithmen zur Bestimmung von Nullstellen mit Fehlerschranken", Computing 4 (1969).
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import product
from math import ceil, pi
from typing import Any

import flint
import numpy as np
from numpy.typing import NDArray

from synth.analyse.numerics import precise
from synth.errors import ModelError
from synth.statespace import Array

Ball = flint.arb
Place = tuple[Ball, ...]

CELLS = 64  # along a turn, at first
MAX_BISECTIONS = 24
NEWTON_START = 3  # bisections before Newton's method is tried
STARTS = 400  # of Newton's method at a bisection
CUBE_HALF_SIDES = (0.05, 0.02, 0.01, 0.005, 0.002)  # rad, of the cubes about zeros, tried in this order
COVERED_FRACTION = 1 - 1e-9  # of a cube: cells inside this part of it count as covered
STEPS = 12  # of Newton's method: each doubles the digits
DISTINCT_DISTANCE = 1e-7  # rad: results of Newton's method closer than this are one zero


@dataclass(frozen=True)
class Equations:
    """n equations f(p) = 0 in n unknowns, and a test for cells that may contain a zero.

    `f` is called on balls, and on power series (`flint.arb_series`) for its slopes. `possible` takes middles (n, N) and
    half a side in rad, and returns (N,).
    """

    n: int
    f: Callable[[Sequence[Any]], Sequence[Any]]
    possible: Callable[[Array, float], NDArray[np.bool_]]

    def values(self, at: Sequence[Ball]) -> flint.arb_mat:
        """Return f (n, 1) at balls."""
        return flint.arb_mat([[value] for value in self.f(at)])

    def slopes(self, at: Sequence[Ball]) -> flint.arb_mat:
        """Return df/dp (n, n) at balls."""
        n = range(self.n)
        columns = [self.f([flint.arb_series([v, int(i == j)], prec=2) for i, v in enumerate(at)]) for j in n]
        return flint.arb_mat([[columns[j][i][1] for j in n] for i in n])


@dataclass(frozen=True, eq=False)
class Cube:
    """A cube about `at`, with half its side `half` in rad, that contains exactly one zero."""

    at: Place
    half: float


def search(equations: Equations) -> list[Cube]:
    """Return a cube about each zero; cells are halved until these cubes cover all. Call it in `precise.precision`.

    Raises ModelError if MAX_BISECTIONS do not suffice, because zeros meet or lie on a line.
    """
    half = pi / CELLS
    cells = grid(equations.n)
    cubes: list[Cube] = []
    for bisection in range(MAX_BISECTIONS):
        cells = cells[:, equations.possible(cells, half)]
        if bisection >= NEWTON_START:
            cells = _uncovered_cells(cubes, cells, half)
            cubes += _new_cubes(equations, cubes, cells)
            cells = _uncovered_cells(cubes, cells, half)
        if not cells.size:
            return cubes
        half /= 2
        cells = np.hstack([cells + half * np.array(corner)[:, None] for corner in product((-1, 1), repeat=equations.n)])
    raise ModelError(f"{_place(cells[:, 0])} zeros meet or lie on a line: change the equations slightly")


def grid(n: int) -> Array:
    """Return the centres (n, CELLS^n) of the initial cells."""
    along = 2 * pi / CELLS * (np.arange(CELLS) + 0.5)
    return np.array([each.ravel() for each in np.meshgrid(*[along] * n, indexing="ij")])


def within_turn(phase: Ball) -> Ball:
    """Return a phase in [0, 2 pi); 0 for a whole number of turns within the precision."""
    turns = (phase / (2 * Ball.pi())).mid()
    nearest = (turns + 0.5).floor().mid()
    if abs(turns - nearest) < precise.ZERO:
        return Ball(0)
    return (turns - turns.floor().mid()) * 2 * Ball.pi()


def _new_cubes(equations: Equations, known: list[Cube], cells: Array) -> list[Cube]:
    """Return a cube about each further zero to which Newton's method leads from the cells (n, N)."""
    cubes: list[Cube] = []
    for start in cells.T[:: ceil(cells.shape[1] / STARTS) or 1]:
        end = newton(equations, start)
        if end is not None and all(_distance(end, c.at) > DISTINCT_DISTANCE for c in (*known, *cubes)):
            cubes.append(_isolate(equations, end))
    return cubes


def newton(equations: Equations, start: Array) -> Place | None:
    """Return the limit of Newton's method from a place (n,), None if it does not converge."""
    at = tuple(Ball(float(v)) for v in start)
    for _ in range(STEPS):
        try:
            step = equations.slopes(at).mid().solve(equations.values(at).mid()).entries()
        except ZeroDivisionError:  # a singular matrix
            return None
        at = tuple((v - d).mid() for v, d in zip(at, step, strict=True))
    return at if max(abs(float(v)) for v in step) < 1e-60 else None


def _isolate(equations: Equations, at: Place) -> Cube:
    """Return the largest of CUBE_HALF_SIDES about a zero that is proved to contain no other."""
    n = equations.n
    inverse = equations.slopes(at).inv().mid()
    offset = inverse * equations.values(at)
    for half in CUBE_HALF_SIDES:
        box = [v + Ball(0, half) for v in at]
        error = flint.arb_mat(n, n, [int(i == j) for i in range(n) for j in range(n)]) - inverse * equations.slopes(box)
        bounds = [abs(offset[i, 0]) + sum((abs(error[i, j]) for j in range(n)), Ball(0)) * half for i in range(n)]
        if all(r < half for r in bounds):
            return Cube(at, half)
    raise ModelError(f"{_place([float(v) for v in at])} two zeros meet or lie on a line: change the equations slightly")


def _uncovered_cells(cubes: list[Cube], cells: Array, half: float) -> Array:
    """Return the cells (n, N) that no cube covers."""
    inside = np.zeros(cells.shape[1], dtype=bool)
    for cube in cubes:
        offset = _within_half_turn(cells - np.array([[float(v)] for v in cube.at]))
        inside |= np.abs(offset).max(axis=0) + half < cube.half * COVERED_FRACTION
    return cells[:, ~inside]


def _distance(a: Place, b: Place) -> float:
    return float(np.abs(_within_half_turn(np.array([float(u - v) for u, v in zip(a, b, strict=True)]))).max())


def _within_half_turn(phase: Array) -> Array:
    return (phase + pi) % (2 * pi) - pi


def _place(phases: Sequence[float] | Array) -> str:
    return "near the phases " + ", ".join(f"{v:.4f}" for v in phases) + " rad"
