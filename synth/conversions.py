"""Conversion of plain arrays and of models of python-control and scipy.signal to A, B, C, D, names and time."""

from collections.abc import Sequence
from fractions import Fraction
from typing import Any

import numpy as np
from numpy.typing import NDArray

from synth import arguments
from synth.errors import SignalError
from synth.timing import Continuous, Discrete, Time

Array = NDArray[np.float64]
Names = tuple[str, ...]
StateSpaceFields = tuple[Array, Array, Array, Array, Names, Names, Names, Time]
"""A, B, C, D, states, inputs, outputs, time."""


@arguments.checked
def coefficients(system: Any) -> tuple[Array, Array] | None:
    """Return numerator and denominator of a scalar transfer function, highest powers first; None for another System."""
    if not all(hasattr(system, name) for name in ("num", "den", "dt")):
        return None
    b, a = (v[0][0] if isinstance(v, list) else v for v in (system.num, system.den))
    return arguments.matrix("numerator", [b])[0], arguments.matrix("denominator", [a])[0]


def from_fractions(system: Any) -> StateSpaceFields:
    """Return python-control's transfer functions, each in companion form, without pole-zero cancellation."""
    p, m = len(system.num), len(system.num[0])
    parts = [[_companion(system.num[i][j], system.den[i][j]) for j in range(m)] for i in range(p)]
    order = sum(len(part[0]) for row in parts for part in row)
    A, B, C, D = np.zeros((order, order)), np.zeros((order, m)), np.zeros((p, order)), np.zeros((p, m))
    first = 0
    for i, j in np.ndindex(p, m):
        a, b, c, D[i, j] = parts[i][j]
        states = slice(first, first + len(a))
        A[states, states], B[states, j], C[i, states] = a, b, c
        first = states.stop
    labels = (tuple(system.input_labels), tuple(system.output_labels))
    return A, B, C, D, _numbered_names("x", order), *labels, time_of(system.dt)


def _companion(numerator: Any, denominator: Any) -> tuple[Array, Array, Array, float]:
    """Return A (n, n), B (n,), C (n,) and D of numerator over denominator, highest powers first."""
    quotient = [arguments.matrix(name, [v])[0] for name, v in (("numerator", numerator), ("denominator", denominator))]
    if not all(np.isfinite(v).all() for v in quotient):
        raise SignalError(
            f"the transfer function {quotient[0]} / {quotient[1]} is not finite: give finite coefficients"
        )
    b, a = (np.trim_zeros(v, "f") for v in quotient)
    if not len(a) or len(b) > len(a):
        raise SignalError(
            f"the transfer function {quotient[0]} / {quotient[1]} has no state-space form: its denominator must "
            "not be 0, and its degree must be at least that of the numerator"
        )
    n = len(a) - 1
    exact = [[Fraction(float(v)) for v in part] for part in (a, np.concatenate([np.zeros(len(a) - len(b)), b]))]
    a, b = ([v / exact[0][0] for v in part] for part in exact)
    A = np.eye(n, k=-1)
    A[:1] = [-float(v) for v in a[1:]]
    C = np.array([float(v - b[0] * u) for v, u in zip(b[1:], a[1:], strict=True)])
    return A, np.eye(n, 1)[:, 0], C, float(b[0])


def from_scipy(system: Any) -> StateSpaceFields:
    """Return a system of scipy.signal; those in continuous time have no `dt`, or None for it."""
    try:
        model = system.to_ss()
    except ValueError as error:
        raise SignalError(f"the scipy.signal system has no state-space form ({error}): give A, B, C, D") from error
    dt = getattr(model, "dt", None)
    return from_arrays((model.A, model.B, model.C, model.D, 0 if dt is None else dt))


def from_arrays(arrays: Sequence[Any]) -> StateSpaceFields:
    """Return arrays (A, B), (A, B, C) or (A, B, C, D), with or without a time after them."""
    matrices, time = list(arrays), _time_argument(arrays)
    if len(matrices) == 5 or (matrices and isinstance(matrices[-1], Continuous | Discrete)):
        matrices.pop()
    if len(matrices) not in (2, 3, 4):
        raise SignalError(f"{len(matrices)} arrays make no linear model: give (A, B), (A, B, C) or (A, B, C, D)")
    A, B, *rest = (arguments.matrix(name, value) for name, value in zip("ABCD", matrices, strict=False))
    states, inputs = _numbered_names("x", len(A)), _numbered_names("u", B.shape[1])
    C = rest[0] if rest else np.eye(len(A))
    D = rest[1] if len(rest) > 1 else np.zeros((len(C), B.shape[1]))
    return A, B, C, D, states, inputs, _numbered_names("y", len(C)) if rest else states, time


def _time_argument(arrays: Sequence[Any]) -> Time:
    last = arrays[-1] if arrays else None
    if isinstance(last, Continuous | Discrete):
        return last
    if len(arrays) < 5:
        return Continuous()
    return time_of(last)


def time_of(dt: Any) -> Time:
    """Return the Time of a `dt`: 0 is continuous, another number a period in seconds."""
    value = dt.item() if isinstance(dt, np.ndarray | np.generic) and dt.size == 1 and not np.ndim(dt) else dt
    if not isinstance(value, int | float) or value is True:
        raise SignalError(f"there is no sample period, dt is {dt!r}: give 0 for continuous time or a period in seconds")
    return Discrete(float(value)) if value else Continuous()


def _numbered_names(letter: str, count: int) -> tuple[str, ...]:
    return tuple(f"{letter}{k + 1}" for k in range(count))
