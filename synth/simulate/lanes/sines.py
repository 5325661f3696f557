"""Sine and cosine of any argument without a branch, for plants in lanes.

    k = nearest whole number to a/(2 pi),   r = a - 2 pi k in -pi .. pi
    sin a -> r S(r^2),   cos a -> C(r^2)        S, C of the least degree with at most a given error

2 pi is subtracted in two parts by products and sums that are rounded once in C, so the reduction costs no digit while k
is below 2^20 or so. Cody and Waite, Software Manual for the Elementary Functions, 1980, chapter 8.
"""

from collections.abc import Callable
from functools import cache
from typing import Protocol

import numpy as np
from numpy.polynomial import chebyshev
from numpy.typing import NDArray

Array = NDArray[np.float64]

DEGREES = range(3, 14)
TURN = 2 * np.pi
TURN_LOW = 2.4492935982947064e-16  # 2 pi less its double
MAGIC = 1.5 * 2.0**52  # a + MAGIC - MAGIC is the whole number nearest to a
_SQUARE = np.pi**2


class Place(Protocol):
    """Append a node to a program, and return its number."""

    def __call__(self, op: str, *args: int, value: float = 0.0, name: str = "") -> int:
        """Return the number of the node."""
        ...


def place_sine(place: Place, op: str, argument: int, error: float) -> int:
    """Append the nodes of the "sin" or "cos" of a node, and return the last; both of one node share their reduction."""
    turns = place("mul", argument, place("literal", value=1 / TURN))
    magic = place("literal", value=MAGIC)
    k = place("sub", place("add", turns, magic), magic)
    r = place("fma", k, place("literal", value=-TURN), argument)
    r = place("fma", k, place("literal", value=-TURN_LOW), r)
    square = place("sq", r)
    *lower, last = coefficients(op, error)
    value = place("literal", value=last)
    for c in reversed(lower):
        value = place("fma", square, value, place("literal", value=c))
    return place("mul", r, value) if op == "sin" else value


@cache
def coefficients(op: str, error: float) -> tuple[float, ...]:
    """Return S or C, lowest power first, by Chebyshev interpolation in r^2."""
    function = _sine_over_angle if op == "sin" else _cosine
    square = np.linspace(0.0, _SQUARE, 1001)
    scale = np.sqrt(square) if op == "sin" else 1.0
    for degree in DEGREES:
        c = _interpolate(function, degree)
        if np.abs(scale * (np.polynomial.polynomial.polyval(square, c) - function(square))).max() <= error:
            break
    return tuple(c.tolist())


def _interpolate(function: Callable[[Array], Array], degree: int) -> Array:
    series = chebyshev.Chebyshev.interpolate(function, degree, domain=(0.0, _SQUARE))
    return np.asarray(series.convert(kind=np.polynomial.Polynomial).coef)


def _sine_over_angle(square: Array) -> Array:
    return np.asarray(np.sinc(np.sqrt(square) / np.pi))


def _cosine(square: Array) -> Array:
    return np.asarray(np.cos(np.sqrt(square)))
