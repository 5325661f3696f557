"""Content digests: equal values have the same SHA-256, on every machine and in every process.

    numbers, texts, types, sequences, mappings     their type and their content, bit by bit; a mapping's order counts
    arrays                                         type, shape and bytes
    dataclasses                                    the class with its slice (the source it depends on), all fields
    CasADi's expressions and functions             their serialised form; symbols count by name and place
    functions                                      their slice, bytecode, defaults and closures

A value of another kind has no digest.

Strict JSON (RFC 8259): null for the numbers that JSON does not have, infinities and NaN.
"""

import dataclasses
import functools
import hashlib
import inspect
import json
import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from collections.abc import Set as AbstractSet
from dataclasses import dataclass
from enum import Enum
from functools import partial
from pathlib import PurePath
from types import CodeType
from typing import Any

import casadi as ca
import numpy as np

from synth.base import slices
from synth.errors import ContentError


def dumps(document: Any) -> str:
    """Return a document as JSON with null for a number that JSON does not have."""
    return json.dumps(_finite(document), indent=1, allow_nan=False)


def _finite(value: Any) -> Any:
    if isinstance(value, Mapping):
        return {k: _finite(v) for k, v in value.items()}
    if isinstance(value, list | tuple):
        return [_finite(v) for v in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value


_NUMBERS = (float, int, bool, type(None))


def digest(*values: Any) -> str:
    """Return the digest of values, in order; raise ContentError for a value that has none."""
    reader = _Reader([], {})
    try:
        text = b"".join(reader.content(v) for v in values)
        return hashlib.sha256(text + reader.joint_function()).hexdigest()
    except (TypeError, ValueError, AttributeError, RuntimeError) as error:  # of values that violate their type
        raise ContentError(f"content: found {error}, need values that can be read: give plain data") from error


@dataclass(frozen=True, eq=False)
class _Reader:
    """A reader of values, which gathers their SX expressions: a symbol in two of them counts as one.

    The source of each class and function is read once, since thousands of nodes of a program share a few classes, and
    the signals of a design a few functions.
    """

    expressions: list[ca.SX]
    sources: dict[tuple[str, str, type | CodeType], bytes]

    def content(self, value: Any) -> bytes:
        """Return the content of a value as bytes that no other value has."""
        kind, body = self._common(value) or self._simple(value) or self._compound(value) or self._code(value)
        text = body if isinstance(body, bytes) else b"".join(self.content(part) for part in body)
        return f"{kind}:{len(text)}:".encode() + text

    def joint_function(self) -> bytes:
        """Return all expressions as one function of all symbols in them."""
        if not self.expressions:
            return b""
        symbols = ca.symvar(ca.veccat(*self.expressions))
        return str(ca.Function("content", symbols, self.expressions).serialize()).encode()

    def _common(self, value: Any) -> tuple[str, bytes | Iterable[Any]] | None:
        """Return kind and content of what most parts of a program are, which the other tests take longer to tell."""
        kind: Any = type(value)
        if kind is str:
            return "str", value.encode()
        if kind in _NUMBERS:
            return kind.__name__, repr(value).encode()
        if kind is tuple or kind is list:
            return kind.__name__, value
        if kind is dict:
            return "mapping", value.items()
        if (names := _field_names(kind)) is not None:
            return "dataclass", (kind, *((name, getattr(value, name)) for name in names))
        return None

    def _simple(self, value: Any) -> tuple[str, bytes | Iterable[Any]] | None:
        kind = type(value).__name__
        if value is None or isinstance(value, bool | int | float | complex):
            return kind, repr(value).encode()
        if isinstance(value, bytes):
            return kind, value
        if isinstance(value, Enum):
            return "enum", (type(value), value.name)
        if isinstance(value, str | PurePath):
            return kind, str(value).encode()
        if isinstance(value, np.ndarray | np.generic):
            return "array", _array(np.asarray(value))
        if isinstance(value, ca.SX):
            self.expressions.append(value)
            return "SX", str(len(self.expressions)).encode()
        if isinstance(value, ca.DM | ca.Function):
            return kind, str(value.serialize()).encode()
        return None

    def _compound(self, value: Any) -> tuple[str, bytes | Iterable[Any]] | None:
        if isinstance(value, Mapping):
            return "mapping", value.items()
        if isinstance(value, AbstractSet):
            return "set", b"".join(sorted(self.content(v) for v in value))
        if isinstance(value, Sequence):
            return type(value).__name__, value
        if isinstance(value, partial):
            return "partial", (value.func, value.args, value.keywords)
        if inspect.ismethod(value):
            return "method", (value.__self__, value.__func__)
        return None

    def _code(self, value: Any) -> tuple[str, bytes | Iterable[Any]]:
        if isinstance(value, type):
            return "type", self._source(value, value)
        inner = inspect.unwrap(value) if callable(value) else value
        if inspect.isfunction(inner):
            free = inspect.getclosurevars(inner).nonlocals.items()
            closure = [(name, v) for name, v in free if v is not value]
            bytecode = _bytecode(inner.__code__)  # of several lambdas in one statement the slice is the same
            source = self._source(inner, inner.__code__)
            return "function", (source, bytecode, inner.__defaults__, inner.__kwdefaults__, closure)
        if inspect.isbuiltin(inner):
            return "builtin", f"{inner.__module__}.{inner.__qualname__}".encode()
        raise ContentError(
            f"content of a {type(value).__module__}.{type(value).__qualname__}: found no way to compare it, need "
            "numbers, texts, arrays, dataclasses, expressions or functions of these: give those"
        )

    def _source(self, value: Callable[..., Any] | type, of: type | CodeType) -> bytes:
        """Return the name of a class or function, and the digest of its slice where its source counts."""
        place = value.__module__, value.__qualname__, of
        if place not in self.sources:
            followed = slices.digest(value) if slices.is_followed(value) else ""
            self.sources[place] = f"{value.__module__}.{value.__qualname__} {followed}".encode()
        return self.sources[place]


@functools.cache
def _field_names(kind: Any) -> tuple[str, ...] | None:
    """Return the names of the fields of a dataclass, None for another class."""
    return tuple(f.name for f in dataclasses.fields(kind)) if dataclasses.is_dataclass(kind) else None


def _array(value: np.ndarray[Any, Any]) -> tuple[Any, ...]:
    if value.dtype.hasobject:
        raise ContentError("content of an array: found objects in it, need numbers: give it a type of numbers")
    return str(value.dtype.descr), value.shape, np.ascontiguousarray(value).tobytes()


def _bytecode(code: CodeType) -> tuple[Any, ...]:
    """Return bytecode, names and constants of a function; a set among the constants is sorted."""
    constants = [
        _bytecode(c) if isinstance(c, CodeType) else sorted(map(repr, c)) if isinstance(c, frozenset) else repr(c)
        for c in code.co_consts
    ]
    return code.co_code, code.co_names, code.co_freevars, constants
