"""Symbolic inverse of a matrix by cofactors, without pivoting and without structurally zero terms.

    M^-1 b = adj(M) b / det M,    adj(M)_ij = (-1)^(i + j) det(M without row j and column i)

Each minor is computed once, and the number of products grows as n^2 2^n, not as n!.
"""

from dataclasses import dataclass, field

import casadi as ca

Places = tuple[int, ...]


@dataclass(frozen=True, eq=False)
class Solution:
    """M^-1 b (n, k) and det M."""

    value: ca.SX
    determinant: ca.SX


def solve(M: ca.SX, b: ca.SX) -> Solution:
    """Return the solution of M y = b for a square M (n, n) and b (n, k); it is not finite where M is singular."""
    n = M.size1()
    minors = _Minors(M)
    everything = tuple(range(n))
    cofactors = ca.SX(n, n)
    for i in everything:
        for j in everything:
            minor = minors.of(_without(everything, j), _without(everything, i))
            if not minor.is_zero():
                cofactors[i, j] = (-1) ** (i + j) * minor
    determinant = minors.of(everything, everything)
    return Solution(ca.mtimes(cofactors, b) / determinant, determinant)


@dataclass(frozen=True, eq=False)
class _Minors:
    M: ca.SX
    minors: dict[tuple[Places, Places], ca.SX] = field(default_factory=dict)

    def of(self, rows: Places, columns: Places) -> ca.SX:
        """Return the determinant of the matrix of these rows and columns, by its first row."""
        if not rows:
            return ca.SX(1)
        if (rows, columns) not in self.minors:
            total = ca.SX(0)
            for place, column in enumerate(columns):
                entry = self.M[rows[0], column]
                if not entry.is_zero():
                    total += (-1) ** place * entry * self.of(rows[1:], _without(columns, column))
            self.minors[rows, columns] = total
        return self.minors[rows, columns]


def _without(places: Places, place: int) -> Places:
    return tuple(p for p in places if p != place)
