"""Kinds of values: a predicate for each type annotation; `arguments` documents the annotations."""

import functools
import inspect
import math
import types
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Protocol, Union, get_args, get_origin

import casadi as ca
import numpy as np
from numpy.typing import ArrayLike, NDArray

MAX_MAGNITUDE = 1e100  # three factors of such a size have a product in double precision
EXACT_INTEGERS = 1 << 53  # below it double precision holds every whole number
# What a union holds of ArrayLike: its members up to Python 3.11, the alias itself later, when the union keeps scalars.
ARRAY_MEMBERS = frozenset(get_args(ArrayLike) or {ArrayLike})
SCALARS = frozenset({bool, int, float, complex, str, bytes})
ARRAYS = (np.ndarray, get_origin(NDArray[np.float64]))  # the latter is an alias of its own from NumPy 2.5 on
NO_LISTS = (str, bytes, Mapping, np.ndarray, ca.SX, ca.DM, ca.MX)
NO_ARRAYS = (str, bytes, bool, Mapping, set, frozenset, type(None))


@dataclass(frozen=True)
class ArgumentKind:
    """The values that pass for an annotation, and the text that asks for such a value."""

    passes: Callable[[Any], bool]
    need: str
    plain: Callable[[Any], Any] | None = None  # the same value as Python's own number or list


@functools.cache
def of(annotation: Any) -> ArgumentKind | None:
    """Return the kind of an annotation, None where it is Any or object, for which every value passes.

    Raises TypeError for an annotation that is none of those that `arguments` lists.
    """
    if annotation in KINDS:
        return KINDS[annotation]
    origin, inner = get_origin(annotation), get_args(annotation)
    if origin in (Union, types.UnionType):
        return _union(set(inner))
    if origin in ARRAYS:
        return ARRAY_LIKE
    if origin is type:
        return ArgumentKind(inspect.isclass, "a type")
    if origin is tuple and inner[-1:] != (...,):
        return _tuple(tuple(map(of, inner)))
    if origin is Callable:
        return ArgumentKind(callable, "a function")
    if inspect.isclass(origin) and issubclass(origin, Mapping):
        return _mapping(*map(of, inner))
    if inspect.isclass(origin) and (issubclass(list, origin) or issubclass(tuple, origin)):
        return _sequence(of(inner[0]), once=origin is Iterable)
    if origin is None and inspect.isclass(annotation) and Protocol not in annotation.__bases__:
        return ArgumentKind(lambda value: isinstance(value, annotation), f"a {annotation.__name__}")
    raise TypeError(f"the annotation {annotation} has no kind of values")


def _union(members: set[Any]) -> ArgumentKind | None:
    kinds = [ARRAY_LIKE] if members >= ARRAY_MEMBERS else []
    if kinds and Sequence[str] in members:
        kinds.append(TEXT)
    for kind in list(map(of, members - ARRAY_MEMBERS - SCALARS if kinds else members)):
        if kind is None:
            return None
        kinds.append(kind)
    kinds.sort(key=lambda kind: (kind is NONE, kind.need))
    need = " or ".join(kind.need for kind in kinds)
    numbers = [kind for kind in kinds if kind.plain is not None]
    return ArgumentKind(
        lambda value: any(kind.passes(value) for kind in kinds),
        need,
        numbers[0].plain if numbers == kinds[:1] and ARRAY_LIKE not in kinds else None,
    )


def _tuple(kinds: tuple[ArgumentKind | None, ...]) -> ArgumentKind:
    def passes(values: Any) -> bool:
        return (
            _is_listed(values)
            and len(values) == len(kinds)
            and all(kind is None or kind.passes(value) for kind, value in zip(kinds, values, strict=True))
        )

    return ArgumentKind(
        passes, f"{len(kinds)} of them: {', '.join(kind.need if kind else 'anything' for kind in kinds)}"
    )


def _sequence(kind: ArgumentKind | None, once: bool) -> ArgumentKind:
    """Return the kind of a list; the entries of an iterator that can be read only `once` are not checked."""

    def passes(values: Any) -> bool:
        if not _is_listed(values):
            return once and isinstance(values, Iterable) and not isinstance(values, NO_LISTS)
        return kind is None or all(map(kind.passes, values))

    entry = " of names" if kind is TEXT else f", each entry {kind.need}" if kind else ""
    return ArgumentKind(
        passes, f"a list{entry}", lambda values: list(values) if isinstance(values, np.ndarray) else values
    )


def _is_listed(values: Any) -> bool:
    if isinstance(values, np.ndarray):
        return bool(values.ndim) and not isinstance(values, np.ma.MaskedArray)
    return isinstance(values, Sequence) and not isinstance(values, str | bytes)


def _mapping(key: ArgumentKind | None, value: ArgumentKind | None) -> ArgumentKind:
    def passes(values: Any) -> bool:
        return (
            isinstance(values, Mapping)
            and (key is None or all(map(key.passes, values.keys())))
            and (value is None or all(map(value.passes, values.values())))
        )

    names = " to ".join(kind.need if kind else "anything" for kind in (key, value))
    return ArgumentKind(passes, f"a mapping from {names}")


def is_number(value: Any) -> bool:
    """Tell whether a value is a real number, not a bool; a finite one is no larger than MAX_MAGNITUDE."""
    if isinstance(value, np.ndarray):  # one without dimensions, as NumPy's functions return
        if value.ndim or value.dtype.kind not in "fiu" or isinstance(value, np.ma.MaskedArray):
            return False
    elif not isinstance(value, float | int | np.floating | np.integer) or isinstance(value, bool):
        return False
    size = abs(value) if isinstance(value, int) else float(abs(value))
    return size <= MAX_MAGNITUDE or size == math.inf or size != size


def _float(value: Any) -> Any:
    if value is None or isinstance(value, float) or (isinstance(value, int) and abs(value) < EXACT_INTEGERS):
        return value
    return float(value)


def _is_array_like(value: Any) -> bool:
    return not isinstance(value, NO_ARRAYS) and not callable(value) and not has_mask(value)


ARRAY_LIKE = ArgumentKind(_is_array_like, "an array of numbers without a mask")
NONE = ArgumentKind(lambda value: value is None, "None")
TEXT = ArgumentKind(lambda value: isinstance(value, str), "a text")
KINDS: dict[Any, ArgumentKind | None] = {
    Any: None,
    object: None,
    type(None): NONE,
    ArrayLike: ARRAY_LIKE,
    float: ArgumentKind(is_number, "a number", _float),
    complex: ArgumentKind(
        lambda v: is_number(abs(v) if isinstance(v, complex | np.complexfloating) else v), "a number"
    ),
    int: ArgumentKind(
        lambda v: isinstance(v, int | np.integer) and not isinstance(v, bool),
        "a whole number",
        lambda v: v if v is None or isinstance(v, int) else int(v),
    ),
    bool: ArgumentKind(lambda value: isinstance(value, bool | np.bool), "True or False"),
    str: TEXT,
    ca.SX: ArgumentKind(
        lambda v: isinstance(v, ca.SX | ca.DM) or is_number(v),
        "an expression of CasADi (SX)",
        lambda v: v if v is None or isinstance(v, ca.SX) else ca.SX(v),
    ),
}


def has_mask(values: object) -> bool:
    """Tell whether any entry is masked in a NumPy masked array, or in one of a list of them."""
    if isinstance(values, list | tuple):
        return any(map(has_mask, values))
    return bool(np.ma.is_masked(values))
