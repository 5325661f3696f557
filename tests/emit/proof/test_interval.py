"""Intervals of single operations: tight ends wherever possible, and correct infinities and NaN."""

from collections.abc import Iterator
from itertools import product
from math import inf, nan

import numpy as np
import pytest

from synth.emit.program.lower import Node, Program
from synth.emit.proof import interval, libm
from synth.emit.proof.interval import EXACT, Interval
from tests.emit.c_arithmetic import compute

F32, F64 = np.float32, np.float64
MONOTONE = ("neg", "fabs", "add", "sub", "mul", "sq", "twice", "min", "max", "sqrt")


@pytest.fixture(autouse=True)
def infinities_are_no_news() -> Iterator[None]:
    with np.errstate(all="ignore"):
        yield


def one(low: float, high: float, no_number: bool = False) -> Interval:
    return interval.interval(low, high, no_number, F32)


def ends(a: Interval) -> tuple[float, float, bool]:
    return float(a.low[0]), float(a.high[0]), bool(a.nan[0])


def boxes(rng: np.random.Generator, count: int, scalar: type[np.floating]) -> Interval:
    a, b = (rng.normal(size=count) * 10.0 ** rng.integers(-3, 4, count) for _ in range(2))
    return Interval(np.minimum(a, b).astype(scalar), np.maximum(a, b).astype(scalar), np.zeros(count, bool))


@pytest.mark.parametrize("scalar", [F32, F64])
@pytest.mark.parametrize("op", MONOTONE)
def test_the_ends_are_values(op: str, scalar: type[np.floating]) -> None:
    """The corners and zeros of the arguments attain both ends exactly, for all intervals at once."""
    rng, count = np.random.default_rng(0), 60
    arity = 2 if op in ("add", "sub", "mul", "min", "max") else 1
    args = [boxes(rng, count, scalar) for _ in range(arity)]
    args = [Interval(abs(a.low), abs(a.low) + a.high - a.low, a.nan) for a in args] if op == "sqrt" else args
    y = EXACT[op](*args)
    program = Program((*(Node("input", name=str(i)) for i in range(arity)), Node(op, tuple(range(arity)))), (), {}, {})
    for i in range(count):
        corners = [[a.low[i], a.high[i], *([0.0] if a.low[i] < 0 < a.high[i] else [])] for a in args]
        points = np.stack(np.meshgrid(*corners), -1).reshape(-1, arity)
        values = [compute(program, {str(j): float(v) for j, v in enumerate(p)}, scalar)[-1] for p in points]
        assert (y.low[i], y.high[i]) == (min(values), max(values))


@pytest.mark.parametrize(
    ("op", "args", "expected"),
    [
        ("mul", [one(0, 1), one(2, inf)], (0, inf, True)),
        ("mul", [one(3, inf), one(0, 1)], (0, inf, True)),
        ("mul", [one(0, 0), one(-5, 7)], (0, 0, False)),
        ("add", [one(1, inf), one(-inf, 3)], (-inf, inf, True)),
        ("sub", [one(inf, inf), one(0, 1)], (inf, inf, False)),
        ("div", [one(1, 2), one(-1, 4)], (-inf, inf, False)),
        ("div", [one(0, 2), one(0, 4)], (-inf, inf, True)),
        ("div", [one(1, inf), one(1, inf)], (0, inf, True)),
        ("div", [one(-6, 3), one(-2, -1)], (-3, 6, False)),
        ("inv", [one(-4, -0.5)], (-2, -0.25, False)),
        ("sqrt", [one(-1, 4)], (0, 2, True)),
        ("min", [one(5, 7, True), one(0, 3)], (0, 3, False)),
        ("min", [one(-5, -4, True), one(0, 3)], (-5, 3, False)),
        ("min", [one(-5, -4), one(0, 3, True)], (-5, -4, True)),
        ("max", [one(5, 7, True), one(0, 3)], (0, 7, False)),
        ("clamp", [one(-inf, inf, True), one(-2, -2), one(2, 2)], (-2, 2, False)),
        ("clamp", [one(-0.5, 0.25), one(-2, -1), one(1, 2)], (-0.5, 0.25, False)),
        ("clamp", [one(-0.5, 0.25), one(-2, 1), one(-1, 2)], (-2, 2, False)),
        ("lt", [one(0, 1), one(1, 2)], (0, 1, False)),
        ("lt", [one(0, 1), one(2, 2)], (1, 1, False)),
        ("lt", [one(0, 1, True), one(2, 2)], (0, 1, False)),
        ("lt", [one(2, 3, True), one(0, 2)], (0, 0, False)),
        ("le", [one(2, 3), one(0, 2)], (0, 1, False)),
        ("eq", [one(2, 2), one(2, 2)], (1, 1, False)),
        ("ne", [one(2, 2), one(3, 4, True)], (1, 1, False)),
        ("ne", [one(2, 2, True), one(2, 2)], (0, 1, False)),
        ("not", [one(0, 0, True)], (0, 1, False)),
        ("and", [one(0, 0), one(nan, nan, True)], (0, 0, False)),
        ("or", [one(1, 2), one(0, 1)], (1, 1, False)),
    ],
)
def test_infinities_and_nan(op: str, args: list[Interval], expected: tuple[float, float, bool]) -> None:
    assert ends(EXACT[op](*args)) == expected


def test_the_enclosure_of_a_polynomial_is_tight_and_includes_rounding() -> None:
    coefficients = (0.25, -1.5, 0.0, 0.75)
    y = interval.polynomial(coefficients, one(-1, 1), True)
    x = np.linspace(-1, 1, 2001)
    values = np.polyval(coefficients[::-1], x)
    assert y.low[0] <= values.min() and values.max() <= y.high[0]
    assert y.high[0] - y.low[0] < 1.05 * np.ptp(values)  # 64 pieces
    assert ends(interval.polynomial(coefficients, one(-inf, 1), True)) == (-inf, inf, True)
    at = interval.polynomial((0.1, 0.3), one(0.7, 0.7), True)
    fused = float(F32(0.1)) + float(F32(0.7)) * float(F32(0.3))  # the product is exact in double
    assert at.low[0] <= F32(fused) <= at.high[0] and at.low[0] < at.high[0]
    apart = interval.polynomial((0.1, 0.3), one(0.7, 0.7), False)
    assert apart.low[0] == apart.high[0] == F32(0.1) + F32(0.7) * F32(0.3)


def test_the_pieces_of_a_polynomial_cover_its_range() -> None:
    rng = np.random.default_rng(2)
    for low, high in np.sort(rng.normal(size=(300, 2)).astype(F32), axis=1):
        y = interval.polynomial((0.0, 1.0), one(low, high), False)
        assert (y.low[0], y.high[0]) == (low, high)


def test_hulls_and_intersections() -> None:
    empty = one(3, 2)
    assert ends(interval.hull(empty, one(0, 1))) == (0, 1, False) == ends(interval.hull(one(0, 1), empty))
    assert ends(interval.hull(one(0, 1), one(4, 5, True))) == (0, 5, True)
    assert (
        interval.intersection(one(0, 1), one(2, 3)).empty[0]
        and not interval.intersection(one(0, 2), one(2, 3)).empty[0]
    )
    assert ends(interval.truth(one(0, 0, True))) == (0, 1, False)


@pytest.mark.parametrize("scalar", [F32, F64])
def test_results_that_are_kept_are_those_of_the_operation(scalar: type[np.floating]) -> None:
    limits = [-inf, -2.5, -1e-30, -0.0, 0.0, 0.1, 3.0, inf]
    pairs = [(a, b) for a in limits for b in limits if a <= b]
    single = [interval.interval(a, b, no_number, scalar) for a, b in pairs for no_number in (False, True)]
    for op in ("add", "mul", "div", "min", "max", "le", "and"):
        for a, b in product(single[::3], single[::2]):
            kept, computed = libm.transfer(op, [a, b], 4), EXACT[op](a, b)
            assert libm.transfer(op, [a, b], 4) is kept
            assert all(x.tobytes() == y.tobytes() for x, y in zip(kept.sides, computed.sides, strict=True))
