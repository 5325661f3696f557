"""Minimax polynomial by the Remez exchange (Sollya `remez`), and rounding of its coefficients to a scalar type.

    minimise  max_i |q(y_i) / g_i - 1|    over q of degree n;    y_i Chebyshev points of [-1, 1], g_i of one sign

At the optimum the error has equal size and alternating sign in n + 2 points (Chebyshev); the Remez exchange finds them.
If each coefficient were rounded on its own, the errors would add up. Here, after each rounding, the coefficients not
yet rounded are fitted again by least squares to compensate. Ball arithmetic makes the result the same on every machine.
"""

import itertools
import operator
from collections.abc import Sequence
from dataclasses import dataclass

import flint
import numpy as np

ROUNDS = 12
LEVEL = 1.02  # the exchange ends when the largest error is within this of the level error


@dataclass(frozen=True, eq=False)
class Fit:
    """A polynomial in y and its largest relative error on the points."""

    series: flint.arb_poly
    error: float


def fit(y: Sequence[flint.arb], g: Sequence[flint.arb], degree: int) -> Fit:
    """Return a near-minimax polynomial of a degree for values g at increasing points y, both exact."""
    last = len(y) - 1
    reference = [round(k * last / (degree + 1)) for k in range(degree + 2)]
    best = Fit(flint.arb_poly([]), np.inf)
    for _ in range(ROUNDS):
        series, level = _solve_on_reference(y, g, reference)
        errors = [float(q / v - 1) for q, v in zip(series.evaluate(list(y), "iter"), g, strict=True)]
        worst = max(map(abs, errors))
        best = Fit(series, worst) if worst < best.error else best
        reference = _peaks(errors, degree + 2)
        if worst <= LEVEL * level or len(reference) < degree + 2:
            break
    return best


def _solve_on_reference(
    y: Sequence[flint.arb], g: Sequence[flint.arb], reference: list[int]
) -> tuple[flint.arb_poly, float]:
    """Solve q(y_i) + (-1)^i e g_i = g_i at the reference points for q and the level error e."""
    count = len(reference) - 1
    rows = [[*_powers(y[i], flint.arb(1), count), g[i] if j % 2 else -g[i]] for j, i in enumerate(reference)]
    solution = flint.arb_mat(rows).solve(flint.arb_mat([[g[i]] for i in reference])).mid().entries()
    return flint.arb_poly(solution[:-1]), abs(float(solution[-1]))


def _peaks(errors: list[float], count: int) -> list[int]:
    """Return the index of the extremum in each interval of one sign; of these, the `count` largest neighbours."""
    peaks: list[int] = []
    for i, e in enumerate(errors):
        if peaks and e * errors[peaks[-1]] > 0:
            peaks[-1] = i if abs(e) > abs(errors[peaks[-1]]) else peaks[-1]
        else:
            peaks.append(i)
    while len(peaks) > count:
        peaks.pop(0 if abs(errors[peaks[0]]) < abs(errors[peaks[-1]]) else -1)
    return peaks


def round_coefficients(
    coefficients: Sequence[flint.arb], v: Sequence[flint.arb], g: Sequence[flint.arb], scalar: type[np.floating]
) -> tuple[float, ...]:
    """Round the coefficients of q(v) to the scalar type, c_0 first, with little change of q / g at the points v.

    With H the inverse of the normal matrix of the free coefficients, a change of c_k by d changes them all by
    H e_k d / H_kk.
    """
    c, n, fixed = list(coefficients), len(coefficients), list[float]()
    basis = flint.arb_mat([_powers(x, 1 / value, n) for x, value in zip(v, g, strict=True)])
    H = (basis.transpose() * basis).inv()
    for k in range(n):
        fixed.append(float(scalar(float(c[k]))))
        pivot, error = H[k, k], fixed[k] - c[k]
        change = [H[j, k] / pivot for j in range(k, n)]
        c[k:] = [a + b * error for a, b in zip(c[k:], change, strict=True)]
        column = flint.arb_mat(n, 1, [flint.arb(0)] * k + change)
        H = (H - column * column.transpose() * pivot).mid()  # c_k is no longer free
    return tuple(fixed)


def _powers(x: flint.arb, first: flint.arb, count: int) -> list[flint.arb]:
    return list(itertools.accumulate([first] + [x] * (count - 1), operator.mul))
