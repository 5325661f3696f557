"""Zeros, gain and values of scalar models in ball arithmetic, each rounded once."""

from collections.abc import Sequence
from typing import cast

import flint

from synth.analyse import precise
from synth.statespace import Array, StateSpace


def factored(model: StateSpace) -> tuple[float, tuple[complex, ...]]:
    """Return gain and zeros of a scalar model; its doubles are rational numbers, and each result is rounded once."""
    A, B, C, D = (_rational(v) for v in (model.A, model.B, model.C, model.D))
    # det(z I - A + B C) = det(z I - A) (1 + C (z I - A)^-1 B)
    above = (A - B * C).charpoly() + (D[0, 0] - 1) * A.charpoly()
    if above.degree() < 0:
        return 0.0, ()
    with precise.precision():
        found = cast("list[tuple[flint.acb, int]]", above.numer().complex_roots())
        roots = [v for v, times in found for _ in range(times)]
        zeros = tuple(complex(float(v.real.mid()), float(v.imag.mid())) for v in roots)
        return float(flint.arb(above[above.degree()])), zeros


def _rational(values: Array) -> flint.fmpq_mat:
    rows, columns = values.shape
    return flint.fmpq_mat(rows, columns, [flint.fmpq(*float(v).as_integer_ratio()) for v in values.ravel()])


def balls(values: Sequence[float]) -> list[flint.arb]:
    """Return numbers as balls of radius 0."""
    return [flint.arb(v) for v in values]


def value(gain: flint.arb, zeros: Sequence[flint.arb], poles: Sequence[flint.arb], at: flint.acb) -> flint.acb:
    """Return gain prod (at - z) / prod (at - p)."""
    product = flint.acb(gain)
    for z in zeros:
        product *= at - z
    for p in poles:
        product /= at - p
    return product
