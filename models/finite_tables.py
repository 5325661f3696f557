"""Low-rank interpolation of functions of two coordinates from a grid, for CasADi: adaptive cross approximation.

    w_c(x, y) = sum_i u_ci(x) v_ci(y)       c = 1 .. m

Each term is a cross: a row and a column of the remainder of the terms before it, through its largest entry. Terms are
added until the remainder is within a bound on the whole grid. Each factor is a cubic spline through its values. Outside
the grid the value at the nearest point of its edge holds.
"""

from collections.abc import Sequence

import casadi as ca
import numpy as np
from scipy import interpolate

from models.finite_matrix import Array

DEGREE = 3


def function(name: str, points: Array, values: Array, bounds: Sequence[float]) -> ca.Function:
    """Return (x, y) -> w (m,) for values (m, n, n) on points x points, each within its bound of them on the grid."""
    terms = [_terms(v, bound) for v, bound in zip(values, bounds, strict=True)]
    rows = [c for c, pair in enumerate(terms) for _ in range(pair[0].shape[1])]
    adding = ca.DM.triplet(rows, list(range(len(rows))), ca.DM.ones(len(rows)), len(terms), len(rows))
    arguments = ca.MX.sym("x"), ca.MX.sym("y")
    inside = [ca.fmax(ca.fmin(q, points[-1]), points[0]) for q in arguments]
    factors = [_spline(q, points, np.hstack([pair[i] for pair in terms])) for i, q in enumerate(inside)]
    return ca.Function(name, arguments, [adding @ (factors[0] * factors[1])], {"never_inline": True})


def _spline(argument: ca.MX, points: Array, values: Array) -> ca.MX:
    spline = interpolate.make_interp_spline(points, values, k=DEGREE)
    return ca.bspline(argument, spline.c.ravel(), [spline.t.tolist()], [DEGREE], values.shape[1], {})


def _terms(values: Array, bound: float) -> tuple[Array, Array]:
    """Return factors (n, r) whose sum of products is within `bound` of values (n, n), by full pivoting."""
    remainder, rows, columns = values.copy(), [], []
    for _ in range(len(values)):
        i, j = np.unravel_index(np.argmax(np.abs(remainder)), remainder.shape)
        if np.abs(remainder[i, j]) <= bound:
            break
        columns.append(remainder[:, j] / remainder[i, j])
        rows.append(remainder[i].copy())
        remainder -= np.outer(columns[-1], rows[-1])
    return np.array(columns).reshape(-1, len(values)).T, np.array(rows).reshape(-1, len(values)).T
