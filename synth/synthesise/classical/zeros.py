"""Zeros, gain and values of scalar models in ball arithmetic, each rounded once."""

from collections.abc import Sequence
from typing import cast

import flint

from synth.analyse import precise
from synth.statespace import Array, StateSpace


def zeros_and_gain(model: StateSpace) -> tuple[float, tuple[complex, ...]]:
    """Return gain and zeros of a scalar model from rational arithmetic, each rounded once."""
    A, B, C, D = (_rational(v) for v in (model.A, model.B, model.C, model.D))
    # det(z I - A + B C) = det(z I - A) (1 + C (z I - A)^-1 B)
    numerator = (A - B * C).charpoly() + (D[0, 0] - 1) * A.charpoly()
    if numerator.degree() < 0:
        return 0.0, ()
    with precise.precision():
        roots_with_multiplicity = cast("list[tuple[flint.acb, int]]", numerator.numer().complex_roots())
        roots = [v for v, times in roots_with_multiplicity for _ in range(times)]
        zeros = tuple(complex(float(v.real.mid()), float(v.imag.mid())) for v in roots)
        return float(flint.arb(numerator[numerator.degree()])), zeros


def _rational(values: Array) -> flint.fmpq_mat:
    rows, columns = values.shape
    return flint.fmpq_mat(rows, columns, [flint.fmpq(*float(v).as_integer_ratio()) for v in values.ravel()])


def balls(values: Sequence[float]) -> list[flint.arb]:
    """Return numbers as balls of radius 0."""
    return [flint.arb(v) for v in values]


def evaluate(gain: flint.arb, zeros: Sequence[flint.arb], poles: Sequence[flint.arb], at: flint.acb) -> flint.acb:
    """Return gain prod (at - z) / prod (at - p)."""
    product = flint.acb(gain)
    for z in zeros:
        product *= at - z
    for p in poles:
        product /= at - p
    return product
