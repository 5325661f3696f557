"""Run-time validation of arguments against the annotations of a function (as `beartype`, `typeguard`).

    @checked
    def with_delay_and_hold(system: System, delay_s: float) -> Delayed

    with_delay_and_hold(S, None) raises TimingError:
        "`delay_s` of `transfer.with_delay_and_hold` is None: give a number of seconds"

`checked` decorates every function and constructor that users call. Internal functions, whose arguments another
function has read already, go without. An annotation says which values pass:

    float, complex    a number, not a bool or a text: of a size up to LARGEST, infinite or NaN
    int               a whole number, not a bool            bool, str     exactly that
    Sequence[T]       a list, tuple or array of T           Mapping[K, V] a mapping of K to V
    Array, ArrayLike  anything but text, None, a mapping or a masked array: `real` and `matrix` read the rest
    a class           an instance of it                     Callable      anything that can be called
    A | B             what passes for A or for B            Any           any value: the function reads it itself

Each function checks further conditions itself (finite, positive, below a Nyquist frequency). Where a checked function
meets a number that double precision cannot represent, or a matrix that it cannot factor, it raises ModelError instead
of the arithmetic errors of NumPy and Python.

Kinds of values: a predicate for each type annotation; `arguments` documents the annotations.
"""

import functools
import inspect
import math
import operator
import reprlib
import types
import typing
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Protocol, TypeVar, Union, get_args, get_origin

import casadi as ca
import numpy as np
from numpy.typing import ArrayLike, NDArray

from synth.errors import ModelError, SignalError, SynthError, TimingError

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


Array = NDArray[np.float64]
Target = TypeVar("Target", bound=Callable[..., Any])

SIZES = (1e-70, 1e70)  # magnitudes whose squares, and the covariances made of them, are numbers in double precision
ARITHMETIC = (np.linalg.LinAlgError, OverflowError, ZeroDivisionError, FloatingPointError)
NOT_FINITE = ("infs or NaNs", "infinity to integer", "NaN to integer", "must be finite")  # in a ValueError of SciPy
SECONDS = " of seconds"
OF_TIME = ("delay", "samples", "time")
UNITS = {"_per_s": " in 1/s", "_s": SECONDS}


def checked(target: Target) -> Target:
    """Return a function, or a class, whose arguments are compared with their annotations at each call.

    The calls raise SignalError for an argument of the wrong kind, TimingError for a time, ModelError where
    arithmetic leaves double precision.
    """
    if inspect.isclass(target):
        setattr(target, "__init__", _with_checks(target.__init__, target.__name__))  # noqa: B010
        return target
    return typing.cast(Target, _with_checks(target, f"{target.__module__.rpartition('.')[2]}.{target.__qualname__}"))


def _with_checks(function: Callable[..., Any], where: str) -> Callable[..., Any]:
    known = functools.cache(lambda: kinds_of(function, where))  # at the first call, when all their names are defined

    @functools.wraps(function)
    def call(*args: Any, **kwargs: Any) -> Any:
        k = known()
        for i, value in enumerate(args):
            name, kind = k.places[i] if i < len(k.places) else k.further
            if kind is not None and not kind.passes(value):
                raise _refusal(where, name, value, kind)
            if kind is not None and kind.plain is not None and (plain := kind.plain(value)) is not value:
                args = (*args[:i], plain, *args[i + 1 :])
        for name, value in kwargs.items():
            kind = k.by_name.get(name, k.others)
            if kind is not None and not kind.passes(value):
                raise _refusal(where, name, value, kind)
            if kind is not None and kind.plain is not None and (plain := kind.plain(value)) is not value:
                kwargs = {**kwargs, name: plain}
        try:
            return function(*args, **kwargs)
        except ARITHMETIC as error:
            raise _overflow(where, error) from error
        except ValueError as error:
            if any(text in str(error) for text in NOT_FINITE):
                raise _overflow(where, error) from error
            raise

    return call


def _overflow(where: str, error: Exception) -> ModelError:
    return ModelError(
        f"`{where}` cannot compute with these numbers in double precision ({error}): choose units in which they are "
        "nearer to 1, or leave out what makes a matrix singular"
    )


def _refusal(where: str, name: str, value: object, kind: ArgumentKind) -> SynthError:
    number = "number" in kind.need and "list" not in kind.need
    unit = next((text for end, text in UNITS.items() if number and name.endswith(end)), "")
    error = TimingError if unit == SECONDS or name in OF_TIME else SignalError
    need = kind.need.replace("a number", f"a number{unit}", 1)
    return error(f"`{name}` of `{where}` is {describe(value)}: give {need}")


def describe(value: object) -> str:
    """Describe a value in a few words, for an error message."""
    if np.ma.isMaskedArray(value):
        return f"a masked array of shape {np.shape(value)}"
    if isinstance(value, np.ndarray) and value.ndim:
        return f"an array of {value.dtype} of shape {value.shape}"
    if isinstance(value, str | bytes | bool | int | float | complex | Sequence | Mapping | np.generic | type(None)):
        text = reprlib.repr(value)
        return text if len(text) <= 80 else f"{text[:77]}..."
    return f"a {type(value).__name__}"


@dataclass(frozen=True)
class Kinds:
    """The kinds of a function's arguments: by place, of further ones (``*args``), by name, of others (``**kwargs``)."""

    places: tuple[tuple[str, ArgumentKind | None], ...]
    further: tuple[str, ArgumentKind | None]
    by_name: Mapping[str, ArgumentKind | None]
    others: ArgumentKind | None


def kinds_of(function: Callable[..., Any], where: str) -> Kinds:
    """Return the kinds of a function's arguments.

    Raises TypeError, calling the function `where`, for an annotation that has no kind, and for a parameter without one.
    """
    hints = typing.get_type_hints(function)
    parameters = inspect.signature(function).parameters.values()
    names = {p.name: None if p.name == "self" else _kind(where, p.name, hints) for p in parameters}
    by_place = (inspect.Parameter.POSITIONAL_ONLY, inspect.Parameter.POSITIONAL_OR_KEYWORD)
    places = tuple((p.name, names[p.name]) for p in parameters if p.kind in by_place)
    further = next(((p.name, names[p.name]) for p in parameters if p.kind is p.VAR_POSITIONAL), ("", None))
    return Kinds(places, further, names, next((names[p.name] for p in parameters if p.kind is p.VAR_KEYWORD), None))


def _kind(where: str, name: str, hints: Mapping[str, Any]) -> ArgumentKind | None:
    if name not in hints:
        raise TypeError(
            f"`{name}` of `{where}` has no annotation, with which `checked` compares it: give it one, or Any"
        )
    try:
        return of(hints[name])
    except TypeError as error:
        raise TypeError(
            f"`checked` cannot read the annotation of `{name}` of `{where}` ({error}): give one that `synth.arguments` "
            "lists, or Any where the function reads the value itself"
        ) from error


def real(what: str, values: ArrayLike) -> Array:
    """Return an array as float64.

    Raises SignalError, calling it `what`, for complex, masked or ragged values, for text, and for a finite number
    beyond LARGEST.
    """
    try:
        if has_mask(values):
            raise ValueError("some are masked: fill them in, or leave their rows out")
        if np.iscomplexobj(values):
            raise ValueError("they are complex")
        if np.asarray(values).dtype.kind in "USO":
            raise ValueError("NumPy does not read them as numbers")
        array = np.asarray(values, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise SignalError(f"the {what} are no real numbers ({error}): give an array of real numbers alone") from error
    size = float(np.abs(array).max(initial=0.0, where=np.isfinite(array)))
    if size > MAX_MAGNITUDE:
        raise SignalError(f"the {what} reach {size:.3g}: choose units in which they are below {MAX_MAGNITUDE:g}")
    return array


def matrix(name: str, values: ArrayLike) -> Array:
    """Return a matrix as float64, a scalar as (1, 1); raise SignalError, calling it `name`, when it is not a matrix."""
    array = real(f"entries of {name}", values)
    array = array.reshape(1, 1) if array.ndim == 0 else array
    if array.ndim != 2:
        raise SignalError(f"{name} has shape {array.shape}: give a matrix with two dimensions")
    return array


def matrix_of_shape(name: str, values: ArrayLike, rows: int, columns: int | None = None) -> Array:
    """Return a finite matrix as float64; raise SignalError for another shape (`columns` None: any), called `name`."""
    array = matrix(name, values)
    expected = (rows, array.shape[1] if columns is None else columns)
    if array.shape != expected or not np.isfinite(array).all():
        shape = f"{rows} rows" if columns is None else f"shape {expected}"
        raise SignalError(f"{name} has shape {array.shape} or is not finite: give a finite matrix of {shape}")
    return array


def as_name_list(what: str, values: object) -> tuple[str, ...]:
    """Return names as a tuple, one text as a tuple of one.

    Raises SignalError, calling them `what`, for a value that is not a list of texts, like a matrix of names.
    """
    if isinstance(values, str):
        return (str(values),)
    listed = tuple(values) if isinstance(values, Iterable) else (None,)
    if not all(isinstance(name, str) for name in listed):
        raise SignalError(f"the {what} are {values!r}: give names of signals, in one list")
    return tuple(str(name) for name in listed)


def distinct(what: str, names: Sequence[str]) -> tuple[str, ...]:
    """Return names as a tuple; raise SignalError for a single text, an empty list or a repeated name."""
    if isinstance(names, str):
        raise SignalError(f"the {what} are the text '{names}': give a list of names, like ['{names}']")
    listed = tuple(names)
    if not listed:
        raise SignalError(f"no {what} are named: give one or more")
    if twice := [name for k, name in enumerate(listed) if name in listed[:k]]:
        raise SignalError(f"'{twice[0]}' is listed twice among the {what}: name it once")
    return listed


def whole(what: str, value: int) -> int:
    """Return a whole number; raise SignalError, calling it `what`, for another value."""
    try:
        return operator.index(value)
    except TypeError as error:
        raise SignalError(f"the {what} is {value}: give a whole number") from error


def check_level(level: float) -> None:
    """Raise SignalError for a confidence level that is not a probability between 0 and 1."""
    if not is_number(level) or not 0 < level < 1:
        raise SignalError(f"the confidence level is {level}: give a probability between 0 and 1, like 0.95")


def check_samples(y: Array, outputs: Sequence[str]) -> None:
    """Raise SignalError for outputs (N, p) that are not finite or too large or small to be squared."""
    for row, j in np.argwhere(~np.isfinite(y)):
        raise SignalError(f"row {row} of '{outputs[j]}' is {y[row, j]}: leave the row out")
    check_sizes("the output", y, outputs)


def check_sizes(what: str, columns: Array, names: Sequence[str]) -> None:
    """Raise SignalError for columns (N, k), calling them `what` and a name, too large or small to be squared."""
    for name, size in zip(names, np.abs(columns).max(axis=0, initial=0.0), strict=True):
        if size and not SIZES[0] <= size <= SIZES[1]:
            raise SignalError(f"{what} '{name}' has the size {size:.3g}: choose units in which it is nearer to 1")
