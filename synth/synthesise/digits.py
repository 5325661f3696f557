"""Rounding to significant digits, for documents that are the same on every machine despite differing last bits."""

import math

import numpy as np

from synth.synthesise.riccati import riccati


def significant(value: float, digits: int) -> float:
    """Return `value` rounded to a number of significant digits (MATLAB `round(x, n, 'significant')`)."""
    return float(f"{value:.{digits}g}")


def round_up(value: float) -> float:
    """Return a value of 0 or more rounded up to two digits."""
    if value == 0:
        return 0.0
    scale = 10.0 ** (math.floor(math.log10(value)) - 1)
    return significant(math.ceil(value / scale) * scale, 2)


def pole(value: complex) -> str:
    """Return a pole in six digits; an imaginary part below 1e-9 is omitted."""
    return f"{value.real:.6g}{value.imag:+.6g}i" if abs(value.imag) > 1e-9 else f"{value.real:.6g}"


def certificate(solution: riccati.Riccati) -> dict[str, float]:
    """Return a Riccati solution's residual relative to its largest weight, and error relative to its largest entry."""
    weight = max(float(np.abs(solution.Q).max()), float(np.abs(solution.R).max()))
    return {
        "relative_residual_below": round_up(float(solution.defect.max()) / weight),
        "relative_forward_error_estimate": round_up(float((solution.step / np.abs(solution.X).max()).max())),
    }
