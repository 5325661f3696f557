"""Interface contract of emitted C, read from its manifest: type and bounds of every scalar struct member.

    init:  state_0 in S,        step:  S x (every bit pattern of input) -> S x Y x faults

S and Y are boxes with one interval per member. Each bound is representable in the type of the member, which makes its
C literal exact.
"""

import math
import shutil
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from synth.errors import CompileError, DesignError

_TYPES = {"float": np.float32, "double": np.float64, "uint32_t": np.uint32, "int32_t": np.int32}


@dataclass(frozen=True)
class Member:
    """One scalar of a struct: `path` is the C expression after the struct name; low <= value <= high."""

    path: str
    ctype: str
    low: float
    high: float

    @property
    def is_real(self) -> bool:
        """Whether the member is a float or a double."""
        return self.ctype in ("float", "double")

    def literal(self, value: float) -> str:
        """Return a value of the member's type as a C literal with the same bits."""
        if not self.is_real:
            return f"{int(value)}u" if self.ctype == "uint32_t" else f"({int(value)})"
        return f"({float(value).hex()}{'f' if self.ctype == 'float' else ''})"

    def next_below(self) -> float:
        """Return the largest number of the real type below the low bound."""
        return self._next_number(self.low, -np.inf)

    def next_above(self) -> float:
        """Return the smallest number of the real type above the high bound."""
        return self._next_number(self.high, np.inf)

    def _next_number(self, value: float, towards: float) -> float:
        if self.ctype == "float":
            return float(np.nextafter(np.float32(value), np.float32(towards)))
        return float(np.nextafter(value, towards))


def members(manifest: Mapping[str, Any], role: str) -> tuple[Member, ...]:
    """Return every scalar of the struct `role` (input, output or state); an array gives one for each element.

    Raises DesignError when the manifest has no such struct, or a bound that is not finite, out of order or not
    representable in the type of the member.
    """
    try:
        return tuple(member for field in manifest["structs"][role]["fields"] for member in _elements(role, field))
    except (KeyError, TypeError) as error:
        raise DesignError(
            f"manifest, struct '{role}': {type(error).__name__} {error}; each field needs name, count, ctype, low and "
            "high: emit the C again"
        ) from error


def headers(files: Mapping[str, str]) -> tuple[str, ...]:
    """Return the names of the headers among emitted files; raise DesignError when there is none."""
    return _files_with_suffix(files, ".h")


def units(files: Mapping[str, str]) -> tuple[str, ...]:
    """Return the names of the C sources among emitted files; raise DesignError when there is none."""
    return _files_with_suffix(files, ".c")


def find_tool(command: str, package: str) -> str:
    """Return the path of a program.

    Raises CompileError, naming the Debian package that provides it, when it is not on the PATH.
    """
    if path := shutil.which(command):
        return path
    raise CompileError(f"{command}: not on the PATH, needed for the proofs: run `apt-get install {package}`")


def _elements(role: str, field: Mapping[str, Any]) -> list[Member]:
    name, count, ctype = field.get("path", field["name"]), field["count"], field["ctype"]
    if ctype not in _TYPES:
        raise DesignError(f"manifest, {role} '{name}': found the ctype {ctype!r}, need one of {', '.join(_TYPES)}")
    paths = [name] if count == 1 else [f"{name}[{k}]" for k in range(count)]
    lows, highs = (np.broadcast_to(np.asarray(field[end], dtype=np.float64), count) for end in ("low", "high"))
    elements = [Member(path, ctype, float(a), float(b)) for path, a, b in zip(paths, lows, highs, strict=True)]
    for member in elements:
        _require_bounds(role, member)
    return elements


def _require_bounds(role: str, member: Member) -> None:
    low, high = member.low, member.high
    # NaN and infinity never equal their conversion to an integer type; a value that overflows float32 is rejected.
    with np.errstate(invalid="ignore", over="ignore"):
        exact = all(math.isfinite(v) and float(np.float64(v).astype(_TYPES[member.ctype])) == v for v in (low, high))
    if not (exact and low <= high):
        raise DesignError(
            f"manifest, {role} '{member.path}': found the bounds {low!r} .. {high!r}, need two finite numbers of type "
            f"{member.ctype} in ascending order: round them when the C is emitted"
        )


def _files_with_suffix(files: Mapping[str, str], suffix: str) -> tuple[str, ...]:
    matching = tuple(sorted(name for name in files if name.endswith(suffix)))
    if not matching:
        raise DesignError(f"emitted C: found {sorted(files)}, need a file that ends in {suffix}: add it")
    return matching
