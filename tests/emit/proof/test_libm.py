"""Intervals of libm's functions against NumPy in double precision, and against a library that errs by four units."""

from collections.abc import Iterator
from math import inf, pi

import numpy as np
import pytest
from scipy.special import erf

from synth.emit.proof import interval, libm
from synth.emit.proof.interval import Interval

F32, F64 = np.float32, np.float64
NUMPY = {"asin": np.arcsin, "acos": np.arccos, "atan": np.arctan, "asinh": np.arcsinh, "erf": erf}
DOMAIN = {"log1p": (-0.9, 10), "log": (1e-30, 50), "asin": (-1, 1), "acos": (-1, 1), "tan": (-1.5, 1.5)}
NAMES = [n for n in libm.FUNCTIONS if n != "atan2"]


@pytest.fixture(autouse=True)
def infinities_are_no_news() -> Iterator[None]:
    with np.errstate(all="ignore"):
        yield


def enclose(name: str, *sides: tuple[float, float], scalar: type[np.floating] = F32, ulps: int = libm.ULPS) -> Interval:
    return libm.transfer(name, [interval.interval(low, high, False, scalar) for low, high in sides], ulps)


@pytest.mark.parametrize("name", NAMES)
def test_intervals_contain_the_values_and_are_tight(name: str) -> None:
    rng, count = np.random.default_rng(1), 200
    low, high = DOMAIN.get(name, (-10, 10))
    ends = np.sort((low + (high - low) * rng.random((2, count))).astype(F32), axis=0)
    y = libm.transfer(name, [Interval(ends[0], ends[1], np.zeros(count, bool))], libm.ULPS)
    points = np.linspace(ends[0], ends[1], 4001, dtype=np.float64)
    exact = NUMPY.get(name) or getattr(np, name)
    values = exact(points)
    unit = np.spacing(np.abs(values).astype(F32)).astype(F64)
    assert (y.low <= (values - 4 * unit).min(axis=0)).all() and ((values + 4 * unit).max(axis=0) <= y.high).all()
    assert not y.nan.any()
    # Nine units beyond the extremes that the 4001 points miss by less than a thousandth of the spread.
    slack = 1e-3 * np.ptp(values, axis=0) + 11 * unit.max(axis=0)
    assert (y.low >= values.min(axis=0) - slack).all() and (y.high <= values.max(axis=0) + slack).all()


@pytest.mark.parametrize("scalar", [F32, F64])
@pytest.mark.parametrize("name", NAMES)
def test_without_error_a_point_gives_the_rounded_value(name: str, scalar: type[np.floating]) -> None:
    y = enclose(name, (0.7, 0.7), scalar=scalar, ulps=0)
    assert y.low == y.high == pytest.approx((NUMPY.get(name) or getattr(np, name))(F64(scalar(0.7))), rel=1e-6)
    wider = enclose(name, (0.7, 0.7), scalar=scalar)
    units = (wider.high[0] - wider.low[0]) / np.spacing(abs(y.low[0]))
    assert 9 <= units <= 36  # nine units to either side, and twice as large ones where the unit changes


@pytest.mark.parametrize(
    ("name", "side", "expected"),
    [
        ("sin", (0, 0), (0, 0, False)),
        ("sinh", (0, 1), (0, np.sinh(1), False)),
        ("log", (1, 2), (0, np.log(2), False)),
        ("log", (-1, 1), (-inf, 0, True)),
        ("exp", (-inf, 100), (0, inf, False)),
        ("exp", (89, 1e38), (3.4028235e38, inf, False)),
        ("sinh", (-1e30, 0), (-inf, 0, False)),
        ("cosh", (-2, 1), (1, np.cosh(2), False)),
        ("tanh", (-inf, inf), (-1, 1, False)),
        ("sin", (1, 2), (np.sin(1), 1, False)),
        ("sin", (0.5, 7), (-1, 1, False)),
        ("cos", (3, 4), (-1, np.cos(4), False)),
        ("cos", (-1e9, 1e9), (-1, 1, False)),
        ("sin", (0, inf), (-1, 1, True)),
        ("tan", (1, 2), (-inf, inf, False)),
        ("tan", (2, 4), (np.tan(2), np.tan(4), False)),
        ("asin", (-2, 0.5), (-pi / 2, np.arcsin(0.5), True)),
        ("acos", (0.5, 1), (0, np.arccos(0.5), False)),
        ("atan", (-inf, 1), (-pi / 2, pi / 4, False)),
    ],
)
def test_ends_extrema_poles_and_domains(
    name: str, side: tuple[float, float], expected: tuple[float, float, bool]
) -> None:
    y = enclose(name, side)
    assert [y.low[0], y.high[0]] == pytest.approx(expected[:2], rel=2e-6) and y.nan[0] == expected[2]


@pytest.mark.parametrize(
    ("y", "x", "expected"),
    [
        ((1, 2), (1, 3), (np.arctan2(1, 3), np.arctan2(2, 1))),
        ((1, 2), (-3, 1), (np.arctan2(1, 1), np.arctan2(1, -3))),
        ((-2, -1), (-3, -1), (np.arctan2(-1, -3), np.arctan2(-2, -1))),
        ((-1, 2), (0.5, 3), (np.arctan2(-1, 0.5), np.arctan2(2, 0.5))),
        ((0, 2), (-3, 1), (-pi, pi)),
        ((-1, 1), (-3, -1), (-pi, pi)),
        ((-1, 1), (0, 1), (-pi, pi)),
    ],
)
def test_the_angle(y: tuple[float, float], x: tuple[float, float], expected: tuple[float, float]) -> None:
    angle = enclose("atan2", y, x)
    assert [angle.low[0], angle.high[0]] == pytest.approx(expected, rel=2e-6)


def test_sines_of_huge_arguments_are_enclosed() -> None:
    # A double there is known to a tenth of a period: whether an extremum lies between is not.
    assert float(enclose("sin", (1e15, 1e15 + 0.5), scalar=F64).high[0]) >= 1
    assert float(enclose("sinh", (1e80, 1e80), scalar=F64).low[0]) == np.finfo(F64).max
    assert float(enclose("exp", (-1e80, 1.0), scalar=F64).low[0]) == 0


def test_a_small_exponential_is_not_exactly_zero() -> None:
    y = enclose("exp", (-200, -200))
    assert y.low[0] == 0 < y.high[0] < 1e-43
