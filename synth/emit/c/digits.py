"""Figures for a document that is alike on every machine: cut to digits in which last bits do not show."""

import math


def cut(value: float, digits: int) -> float:
    """Return `value` rounded to so many significant digits."""
    return float(f"{value:.{digits}g}")


def bound(value: float) -> float:
    """Return a value of 0 or more rounded up to two digits."""
    if value == 0:
        return 0.0
    scale = 10.0 ** (math.floor(math.log10(value)) - 1)
    return cut(math.ceil(value / scale) * scale, 2)


def pole(value: complex) -> str:
    """Return a pole in six digits; an imaginary part of less than 1e-9 is none."""
    return f"{value.real:.6g}{value.imag:+.6g}i" if abs(value.imag) > 1e-9 else f"{value.real:.6g}"
