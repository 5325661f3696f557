"""Static feedback linearisation: choose v so that the accelerations become w.

For accelerations q'' = a(q, ...) + D(q, ...) v, affine in the n inputs v,

    v = D^-1 (w - a)    gives    q'' = w,    n decoupled double integrators.

D^-1 is written out by cofactors: zeros of D vanish from it, and no pivot is chosen at run time. Source: F(11)-(13).
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import permutations

import casadi as ca
import numpy as np

from synth.errors import ModelError


@dataclass(frozen=True, eq=False)
class Law:
    """The decoupling law: `drift` a (n,), `decoupling` D (n, n), its determinant, and `inputs` v by name."""

    drift: ca.SX
    decoupling: ca.SX
    determinant: ca.SX
    inputs: dict[str, ca.SX]


def linearise(acceleration: Sequence[ca.SX], inputs: Mapping[str, ca.SX], w: Sequence[ca.SX]) -> Law:
    """Solve `acceleration` (n expressions) = `w` (n) for the n `inputs` (name to symbol).

    Raises ModelError when the counts differ, when the model is not affine in an input, or when the decoupling matrix
    is singular everywhere; where it is singular at points only, check it over the domain.
    """
    v, q = ca.vcat(list(inputs.values())), ca.vcat(list(acceleration))
    if v.numel() != q.numel() or q.numel() != len(w):
        raise ModelError(
            f"{q.numel()} accelerations and {len(w)} demands meet {v.numel()} inputs ({', '.join(inputs)}): "
            "static feedback linearisation needs as many of each; combine or drop inputs"
        )
    D = ca.simplify(ca.jacobian(q, v))
    for name, symbol in inputs.items():
        if ca.depends_on(D, symbol):
            raise ModelError(f"the model is not affine in '{name}': drop or invert the terms of higher order first")
    drift = ca.substitute(q, v, ca.SX.zeros(v.numel()))
    adjugate = _adjugate(D)
    determinant = ca.dot(D[0, :].T, adjugate[:, 0])
    if _vanishes(determinant, D):
        raise ModelError(f"the decoupling matrix of ({', '.join(inputs)}) is singular everywhere: choose other inputs")
    solved = ca.mtimes(adjugate, ca.vcat(list(w)) - drift) / determinant
    return Law(drift, D, determinant, dict(zip(inputs, ca.vertsplit(solved), strict=True)))


def _vanishes(determinant: ca.SX, D: ca.SX) -> bool:
    """Tell whether det D is rounding error beside the permanent of |D| wherever it is sampled."""
    symbols = ca.symvar(D)
    at = ca.Function("at", [ca.vcat(symbols)], [determinant, D])
    for point in np.random.default_rng(1).uniform(0.1, 1.0, (8, len(symbols))):
        value, matrix = at(point)
        magnitude = np.abs(matrix.full())
        rows = range(len(magnitude))
        permanent = sum(np.prod(magnitude[rows, columns]) for columns in permutations(rows))
        if not abs(float(value)) <= 1e-12 * permanent:
            return False
    return True


def _adjugate(M: ca.SX) -> ca.SX:
    n = M.size1()
    if n == 1:
        return ca.SX.ones(1, 1)
    rows = []
    for i in range(n):
        row = []
        for j in range(n):
            minor = M[[r for r in range(n) if r != j], [c for c in range(n) if c != i]]
            row.append((-1) ** (i + j) * _determinant(minor))
        rows.append(ca.hcat(row))
    return ca.vcat(rows)


def _determinant(M: ca.SX) -> ca.SX:
    if M.size1() == 1:
        return M[0, 0]
    cofactors = _adjugate(M)[:, 0]
    return ca.dot(M[0, :].T, cofactors)
