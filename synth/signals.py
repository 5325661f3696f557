"""Signals with name, unit and range, and dimensional analysis of units such as ``kg m^2/s^2``.

A unit denotes a point in the free abelian group over the base units (m, kg, s, A, K, rad); two units agree when their
exponents do, so that ``N`` and ``kg m/s^2`` are one unit while ``rad`` and ``1`` are not. There are no prefixes: every
quantity is in SI base scale, and a unit contains no hidden factor of a thousand.
"""

import math
import re
from collections.abc import Iterable
from dataclasses import dataclass
from fractions import Fraction
from functools import lru_cache
from numbers import Real

from synth import arguments
from synth.errors import SignalError

Dimension = tuple[tuple[str, Fraction], ...]

_DERIVED = {
    "N": "kg m/s^2",
    "J": "kg m^2/s^2",
    "W": "kg m^2/s^3",
    "V": "kg m^2/s^3/A",
    "ohm": "kg m^2/s^3/A^2",
    "H": "kg m^2/s^2/A^2",
    "T": "kg/s^2/A",
    "Hz": "1/s",
}
UNBOUNDED = 1e30  # end of the range of a signal between Blocks that is not limited
_BASE = ("m", "kg", "s", "A", "K", "rad")
_KEYWORD = re.compile(
    "auto|break|case|char|const|continue|default|do|double|else|enum|extern|float|for|goto|if|inline|int|long|register|"
    "restrict|return|short|signed|sizeof|static|struct|switch|typedef|union|unsigned|void|volatile|while"
)
_FACTOR = re.compile(r"(?P<op>[ /])?(?P<name>1|[A-Za-z]+)(?:\^(?P<power>-?\d+))?")


@arguments.checked
def dimension(unit: str) -> Dimension:
    """Parse `unit` into sorted (base unit, exponent) pairs.

    Raises SignalError when the text is not a product of known units.
    """
    return _parse(unit)


@lru_cache(maxsize=256)
def _parse(unit: str) -> Dimension:
    exponents: dict[str, Fraction] = {}
    position = 0
    while position < len(unit):
        match = _FACTOR.match(unit, position)
        if match is None or (position > 0) != (match["op"] is not None):
            raise SignalError(f"unit '{unit}' cannot be read at '{unit[position:]}': write it like 'kg m^2/s^2'")
        power = Fraction(match["power"] or 1) * (-1 if match["op"] == "/" else 1)
        for name, exponent in _factor(match["name"], unit):
            exponents[name] = exponents.get(name, Fraction(0)) + power * exponent
        position = match.end()
    if not unit:
        raise SignalError("a unit is empty: write '1' for a number without unit")
    return tuple(sorted((name, e) for name, e in exponents.items() if e))


def _factor(name: str, unit: str) -> Dimension:
    if name == "1":
        return ()
    if name in _BASE:
        return ((name, Fraction(1)),)
    if name in _DERIVED:
        return dimension(_DERIVED[name])
    known = ", ".join((*_BASE, *_DERIVED))
    raise SignalError(f"unit '{unit}' contains '{name}', which is not one of {known}: use SI units without prefix")


@arguments.checked
def per_second(unit: str) -> str:
    """Return a unit over s: "m/s^2" for "m/s"."""
    if match := re.fullmatch(r"(.+)/s(?:\^(\d+))?", unit):
        return f"{match[1]}/s^{int(match[2] or 1) + 1}"
    return f"{unit}/s"


@arguments.checked
def product_unit(first: str, second: str) -> str:
    """Return the unit of a product, with each factor once: "1/s^2" for "1/s" and "1/s", "m/A" for "m/A" and "1"."""
    return _with_each_factor_once((first, 1), (second, 1))


@arguments.checked
def quotient_unit(first: str, second: str) -> str:
    """Return the unit of a quotient, with each factor once: "m/A" for "m" and "A", "m/N/s^2" for "m/s^2" and "N"."""
    return _with_each_factor_once((first, 1), (second, -1))


def _with_each_factor_once(*units: tuple[str, int]) -> str:
    exponents: dict[str, int] = {}
    for unit, sign in units:
        dimension(unit)
        for match in _FACTOR.finditer(unit):
            power = sign * int(match["power"] or 1) * (-1 if match["op"] == "/" else 1)
            exponents[match["name"]] = exponents.get(match["name"], 0) + power
    above, below = (
        [name if abs(n) == 1 else f"{name}^{abs(n)}" for name, n in exponents.items() if sign * n > 0 and name != "1"]
        for sign in (1, -1)
    )
    return "".join([" ".join(above) or "1", *(f"/{factor}" for factor in below)])


@arguments.checked
def identifier(kind: str, name: str) -> None:
    """Raise SignalError when `name` is not an identifier of C for a `kind`."""
    if not re.fullmatch(r"[A-Za-z][A-Za-z0-9_]*", name) or _KEYWORD.fullmatch(name):
        raise SignalError(
            f"{kind} name '{name}' is no identifier of C: use letters, digits and underscores, and no keyword of C"
        )


@arguments.checked
@dataclass(frozen=True)
class Signal:
    """A scalar quantity that is wired by name.

    `low` and `high` bound the values, in `unit`, for which the design holds. The `name` is an identifier of C.
    """

    name: str
    unit: str
    low: float
    high: float
    about: str = ""

    def __post_init__(self) -> None:
        identifier("signal", self.name)
        dimension(self.unit)
        if not (math.isfinite(self.low) and math.isfinite(self.high) and self.low < self.high):
            raise SignalError(
                f"signal '{self.name}' has the range {self.low} .. {self.high} {self.unit}: "
                "both ends must be finite and low below high"
            )


@arguments.checked
@dataclass(frozen=True)
class Parameter:
    """A physical constant: value in `unit`, its tolerance, and the source that states it.

    The tolerance is relative, 0.05 for 5 %, or the two ends of the values in `unit`: (0.0, 3.0) of a payload.
    """

    name: str
    value: float
    unit: str
    tolerance: float | tuple[float, float]
    source: str

    def __post_init__(self) -> None:
        dimension(self.unit)
        if isinstance(self.tolerance, tuple):
            low, high = self.tolerance
            sound = -math.inf < low <= self.value <= high < math.inf
        else:
            is_share = isinstance(self.tolerance, Real) and 0 <= self.tolerance < 1
            sound = math.isfinite(self.value) and is_share
        if not sound:
            raise SignalError(
                f"parameter '{self.name}' has value {self.value} and tolerance {self.tolerance}: give a finite value, "
                f"and a share of it, at least 0 and below 1, 0.05 for 5 %, or both ends in {self.unit}, (low, high), "
                "with the value between them"
            )

    def at(self, z: float) -> float:
        """Return the nominal value for z = 0, the ends of the tolerance for -1 and 1, and linearly between these.

        A value beyond z = -1 or 1 stays at an end that the tolerance gives.
        """
        if isinstance(self.tolerance, tuple):
            low, high = self.tolerance
            return self.value + min(max(z, -1.0), 1.0) * (high - self.value if z > 0 else self.value - low)
        return self.value * (1 + self.tolerance * z)

    @property
    def varies(self) -> bool:
        """Whether the ends of the tolerance differ."""
        return self.at(-1.0) != self.at(1.0)

    @property
    def tolerance_text(self) -> str:
        """The tolerance in %, or both ends in the unit."""
        if isinstance(self.tolerance, tuple):
            return f"{self.tolerance[0]:g} .. {self.tolerance[1]:g} {self.unit}"
        return f"{100 * self.tolerance:g} %"


@arguments.checked
def signal_names(signals: Iterable[Signal | Parameter]) -> tuple[str, ...]:
    """Return the names in order; raise SignalError when one is listed twice."""
    signals = tuple(signals)
    if strangers := [s for s in signals if not isinstance(s, Signal | Parameter)]:
        raise SignalError(f"{arguments.describe(strangers[0])} is no signal: give a list of Signals or Parameters")
    listed = tuple(s.name for s in signals)
    for name in listed:
        if listed.count(name) > 1:
            raise SignalError(
                f"the name '{name}' is declared {listed.count(name)} times: each signal needs its own name"
            )
    return listed
