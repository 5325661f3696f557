"""Units form the free abelian group over the base units; names and ranges are refused where they mean nothing."""

import math
from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st

from synth.errors import SignalError
from synth.signals import Parameter, Signal, dimension, identifier, product_unit, quotient_unit, signal_names

BASE = ("A", "K", "kg", "m", "rad", "s")


@pytest.mark.parametrize(
    ("unit", "exponents"),
    [
        ("1", {}),
        ("m", {"m": 1}),
        ("kg m^2/s^2", {"kg": 1, "m": 2, "s": -2}),
        ("1/s", {"s": -1}),
        ("m^-1", {"m": -1}),
        ("rad/rad", {}),
        ("rad", {"rad": 1}),
        ("N", {"kg": 1, "m": 1, "s": -2}),
        ("N^2/N", {"kg": 1, "m": 1, "s": -2}),
        ("V A", {"kg": 1, "m": 2, "s": -3}),
        ("H A^2/J", {}),
        ("T", {"kg": 1, "s": -2, "A": -1}),
        ("V/ohm", {"A": 1}),
        ("Hz s", {}),
    ],
)
def test_a_unit_is_a_product_of_base_units(unit: str, exponents: dict[str, int]) -> None:
    assert dict(dimension(unit)) == {name: Fraction(e) for name, e in exponents.items()}


@given(st.lists(st.tuples(st.sampled_from(BASE), st.integers(-9, 9)), max_size=8))
def test_exponents_add_up_in_any_order(factors: list[tuple[str, int]]) -> None:
    total = {name: sum(e for n, e in factors if n == name) for name in BASE}
    unit = " ".join(["1", *(f"{name}^{e}" for name, e in factors)])
    assert dict(dimension(unit)) == {name: e for name, e in total.items() if e}


@pytest.mark.parametrize(
    ("unit", "named"),
    [("", "empty"), ("mm", "'mm'"), ("m s)", "')'"), ("m^0.5", "'.5'"), ("/s", "'/s'"), ("m ", "' '"), ("m*s", "'*s'")],
)
def test_an_unreadable_unit_is_refused_at_the_place(unit: str, named: str) -> None:
    with pytest.raises(SignalError, match="unit") as caught:
        dimension(unit)
    assert named in str(caught.value)


@pytest.mark.parametrize("name", ["", "2x", "x-y", "_x", "x y", "double", "for", "ä"])
def test_a_name_that_c_refuses_is_refused(name: str) -> None:
    with pytest.raises(SignalError, match="no identifier of C"):
        Signal(name, "1", 0, 1)
    with pytest.raises(SignalError, match=f"constant name '{name}'"):
        identifier("constant", name)


@pytest.mark.parametrize(("low", "high"), [(1, 1), (1, 0), (math.nan, 1), (0, math.nan), (-math.inf, 1), (0, math.inf)])
def test_a_range_is_finite_and_not_empty(low: float, high: float) -> None:
    with pytest.raises(SignalError, match=r"'gap' has the range .* below high"):
        Signal("gap", "m", low, high)


@pytest.mark.parametrize(("value", "tolerance"), [(math.nan, 0), (math.inf, 0), (1, -0.1), (1, math.nan)])
def test_a_parameter_is_finite_with_a_tolerance(value: float, tolerance: float) -> None:
    with pytest.raises(SignalError, match="parameter 'mass'"):
        Parameter("mass", value, "kg", tolerance, "scale")


def test_names_stand_once_and_in_order() -> None:
    a, b = Signal("a", "1", 0, 1), Signal("b", "m", 0, 1)
    assert signal_names([b, a]) == ("b", "a")
    with pytest.raises(SignalError, match="'a' is declared 2 times"):
        signal_names([a, b, a])


@pytest.mark.parametrize(
    ("first", "second", "product"),
    [("1/s", "1/s", "1/s^2"), ("1", "1", "1"), ("m/A", "1", "m/A"), ("kg m/s^2", "m", "kg m^2/s^2"), ("m/s", "s", "m")],
)
def test_the_unit_of_a_product_has_each_factor_once(first: str, second: str, product: str) -> None:
    assert product_unit(first, second) == product


@pytest.mark.parametrize(
    ("first", "second", "quotient"),
    [("m", "A", "m/A"), ("A", "m", "A/m"), ("m/s^2", "N", "m/s^2/N"), ("m", "N m", "1/N")],
)
def test_the_unit_of_a_quotient_has_each_factor_once(first: str, second: str, quotient: str) -> None:
    assert quotient_unit(first, second) == quotient
