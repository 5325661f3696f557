"""CasADi functions at many columns at once, through buffers: CasADi's own conversions to NumPy are slow.

Functions are mapped or chained for a number of columns once, and then kept: a simulation evaluates them at every step.
CasADi takes a time that grows with the square of that number to make a map, so many columns are evaluated in parts.
"""

from collections.abc import Callable, Iterator, Sequence
from functools import lru_cache
from typing import Any

import casadi as ca
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Evaluation = Callable[..., list[Array]]
KEPT = 16  # functions
PART = 256  # columns that are evaluated at once


def map_columns(function: ca.Function, *arguments: Array) -> list[Array]:
    """Return the results (m, N) of a function at N columns of its arguments (n, N), or one (n,) for all."""
    columns = max(a.shape[1] for a in arguments if a.ndim > 1)
    if columns <= PART:
        return _map(function, columns)(*arguments)
    parts = [map_columns(function, *_part(arguments, k)) for k in range(0, columns, PART)]
    return [np.concatenate(results, axis=1) for results in zip(*parts, strict=True)]


def _part(arguments: Sequence[Array], first: int) -> Iterator[Array]:
    """Yield the arguments of PART columns from the first of them on; one column for all stays."""
    return (a[:, first : first + PART] if a.ndim > 1 and a.shape[1] > 1 else a for a in arguments)


def chain_columns(function: ca.Function, start: Array, inputs: Array) -> list[Array]:
    """Return the results (m, N) over N consecutive columns of inputs; the first one follows itself from `start`."""
    return _chain(function, inputs.shape[1])(start, inputs)


@lru_cache(maxsize=KEPT)
def _map(function: ca.Function, columns: int) -> Evaluation:
    return _evaluation(_dense(function).map(columns))


@lru_cache(maxsize=KEPT)
def _chain(function: ca.Function, columns: int) -> Evaluation:
    return _evaluation(_dense(function).mapaccum(columns))


def _dense(function: ca.Function) -> ca.Function:
    """Return a function whose results have all their zeros."""
    if all(function.sparsity_out(i).is_dense() for i in range(function.n_out())):
        return function
    arguments = function.mx_in()
    return ca.Function("dense", arguments, [ca.densify(each) for each in function.call(arguments)])


def _evaluation(function: ca.Function) -> Evaluation:
    buffer: Any  # CasADi's annotations want a size with the array
    buffer, evaluate = function.buffer()
    shapes = [function.size_in(i) for i in range(function.n_in())]

    # `evaluate` alone does not keep the buffer alive: the default argument does.
    def at(*arguments: Array, _owner: object = buffer) -> list[Array]:
        columns = [_by_columns(a, shape) for a, shape in zip(arguments, shapes, strict=True)]
        results = [np.zeros(function.size_out(i)[::-1]) for i in range(function.n_out())]
        for i, argument in enumerate(columns):
            if argument.size:
                buffer.set_arg(i, argument.data)
        for i, result in enumerate(results):
            if result.size:
                buffer.set_res(i, result.data)
        evaluate()
        return [np.ascontiguousarray(result.T) for result in results]

    return at


def _by_columns(argument: Array, shape: tuple[int, int]) -> Array:
    """Return an argument column after column, as CasADi stores it."""
    each = argument.reshape(-1, 1) if argument.ndim == 1 else argument
    whole = np.broadcast_to(each, shape) if argument.size else np.zeros(shape)
    return np.array(whole.T, dtype=np.float64, order="C")
