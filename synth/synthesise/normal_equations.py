"""Damped normal equations as expressions: N = H'H + damping, factorised without pivots, for a fixed time in the loop.

    N = L D L',    D_j >= damping_j,    |L_ij| <= (N_ii / damping_j)^(1/2)

What is left of N when unknowns are eliminated is never less than the damping, and no entry of L larger than the root:
both are enforced, which changes nothing but what rounding does, and bounds all that follows.

Source: Golub, Van Loan, "Matrix Computations", section 4.1 (LDL').
"""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from functools import reduce
from math import sqrt
from operator import add

import casadi as ca

from synth.block import clip
from synth.signals import Signal

Chosen = Callable[[int, ca.SX], tuple[ca.SX, ca.SX]]
"""An unknown and the step that is computed for it to where it ends and how far that is."""


@dataclass(frozen=True, eq=False)
class Factors:
    """N = L D L': L below the diagonal by rows, and 1/D."""

    lower: tuple[tuple[ca.SX, ...], ...]
    inverse: tuple[ca.SX, ...]


def factors(rows: Sequence[Sequence[ca.SX]], damping: Sequence[float], most: float) -> Factors:
    """Return L and D of H'H + damping (6,), V^2; no column of H is longer than the root of `most` times its damping."""
    left = [
        [total(r[i] * r[j] for r in rows) + (damping[i] if i == j else 0) for j in range(i + 1)]
        for i in range(len(damping))
    ]
    lower: list[list[ca.SX]] = [[] for _ in damping]
    inverse = []
    for j, least in enumerate(damping):
        inverse.append(1 / ca.fmax(left[j][j], least))
        for i in range(j + 1, len(damping)):
            bound = sqrt((1 + most) * damping[i] / least)
            lower[i].append(clip(left[i][j] * inverse[j], Signal("lower", "1", -bound, bound)))
        for i in range(j + 1, len(damping)):
            for k in range(j + 1, i + 1):
                left[i][k] -= lower[i][j] * left[k][j]
    return Factors(tuple(map(tuple, lower)), tuple(inverse))


def forward(of: Factors, right: Sequence[ca.SX]) -> list[ca.SX]:
    """Return L^-1 right."""
    found: list[ca.SX] = []
    for row, value in zip(of.lower, right, strict=True):
        found.append(reduce(lambda left, term: left - term[0] * term[1], zip(row, found, strict=True), value))
    return found


def backward(of: Factors, forwarded: Sequence[ca.SX], chosen: Chosen) -> list[ca.SX]:
    """Return where L'^-1 D^-1 forwarded leads, coordinate by coordinate from the last on.

    `chosen` says of a coordinate's step where it ends, and how far that is: the others fit what it does.
    """
    n = len(forwarded)
    ends, moved = [ca.SX(0)] * n, [ca.SX(0)] * n
    for i in reversed(range(n)):
        step = forwarded[i] * of.inverse[i]
        for k in range(i + 1, n):
            step -= of.lower[k][i] * moved[k]
        ends[i], moved[i] = chosen(i, step)
    return ends


def variances(of: Factors) -> list[ca.SX]:
    """Return the diagonal of N^-1, 1/V^2: sums of squares of L^-1 by columns."""
    n, found = len(of.inverse), []
    for i in range(n):
        column: list[ca.SX] = [ca.SX(1)]
        for k in range(i + 1, n):
            column.append(-total(of.lower[k][j] * column[j - i] for j in range(i, k)))
        found.append(total(w**2 * d for w, d in zip(column, of.inverse[i:], strict=True)))
    return found


def dot(a: Sequence[ca.SX], b: Sequence[ca.SX]) -> ca.SX:
    """Return a.b."""
    return total(u * v for u, v in zip(a, b, strict=True))


def total(terms: Iterable[ca.SX]) -> ca.SX:
    """Return the sum, 0 without any term."""
    found = list(terms)
    return reduce(add, found) if found else ca.SX(0)
