"""Memory layout of the structs: members sorted by size, no padding, the same on every target.

The states of each Block with functions are a struct of their own within that of the states. With 8-byte scalars an
explicit member `reserved` follows an odd number of 4-byte members of a struct.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np

from synth.block import Block
from synth.errors import EmitError
from synth.signals import Signal

CTYPES: dict[type[np.floating], str] = {np.float32: "float", np.float64: "double"}
_SIZE = {"float": 4, "double": 8, "uint32_t": 4}


@dataclass(frozen=True)
class Member:
    """One member; `low` and `high` are rounded to the scalar type, and the step enforces them in that form."""

    name: str
    offset: int
    ctype: str
    unit: str
    low: float
    high: float
    about: str
    part: str = ""

    @property
    def path(self) -> str:
        """What C writes after the struct's name: the member, in the struct of its Block where that has one."""
        return f"{self.part}.{self.name.removeprefix(f'{self.part}_')}" if self.part else self.name

    def comment(self, digits: int = 6) -> str:
        """Return unit, range and meaning, for the header; 9 digits read back to the bits of a float, 17 of a double."""
        return f"{self.unit}, {self.low:.{digits}g} .. {self.high:.{digits}g}" + (
            f": {self.about}" if self.about else ""
        )


@dataclass(frozen=True)
class Struct:
    """A struct of kind input, output or state."""

    kind: str
    type: str
    size: int
    fields: tuple[Member, ...]

    @property
    def tag(self) -> str:
        """The name of the struct that the type stands for."""
        return self.type.removesuffix("_t")


@dataclass(frozen=True)
class Layout:
    """The scalar type and the structs; `parameters` are those of a Block whose constants may change."""

    scalar: type[np.floating]
    input: Struct
    output: Struct
    state: Struct
    parameters: Struct | None = None

    @property
    def ctype(self) -> str:
        """The scalar's name in C."""
        return CTYPES[self.scalar]

    @property
    def digits(self) -> int:
        """Decimal digits that read back to the bits of the scalar."""
        return 9 if self.scalar is np.float32 else 17

    @property
    def structs(self) -> tuple[Struct, ...]:
        """Input, output, state, and parameters where there are any."""
        return (self.input, self.output, self.state, *([self.parameters] if self.parameters else []))


def layout(block: Block, scalar: type[np.floating], parts: Mapping[str, str] = MappingProxyType({})) -> Layout:
    """Return the layout of a Block's structs for a scalar type; `parts` gives by state the Block that has a struct.

    Raises EmitError for a type that is neither float32 nor float64, for a Block without input or output, and for a
    bound that the type cannot represent.
    """
    if scalar not in CTYPES:
        raise EmitError(f"scalar type {scalar} cannot be emitted: choose numpy.float32 or numpy.float64")
    real, whole = CTYPES[scalar], "uint32_t"
    states = [(s.signal, whole if s.integer else real) for s in block.states]
    tunable = [(s.signal, real) for s in block.states if s.name in block.tunable]
    parameters = _struct(block.name, "parameters", [*tunable, (_CHECK, whole)], scalar) if tunable else None
    return Layout(
        scalar,
        _struct(block.name, "input", [(s, real) for s in block.inputs], scalar),
        _struct(block.name, "output", [(s, real) for s in block.outputs], scalar),
        _struct(block.name, "state", states or [(_EMPTY, whole)], scalar, parts),
        parameters,
    )


def _rounded_bound(value: float, signal: Signal, scalar: type[np.floating]) -> float:
    with np.errstate(over="ignore"):
        bound = float(scalar(value))
    if not np.isfinite(bound):
        raise EmitError(f"signal '{signal.name}' has the bound {value:g}, too large for {CTYPES[scalar]}: narrow it")
    return bound


_CHECK = Signal("check", "1", 0, 2**32 - 1, "of the bits of the others")
_EMPTY = Signal("reserved", "1", 0, 1, "C knows no empty struct")


def _struct(
    name: str,
    kind: str,
    members: Sequence[tuple[Signal, str]],
    scalar: type[np.floating],
    parts: Mapping[str, str] = MappingProxyType({}),
) -> Struct:
    if not members:
        raise EmitError(f"block '{name}' has no {kind}, and C knows no empty struct: give it at least one")
    widest = max(_SIZE[c] for _, c in members)
    fields, offset = [], 0
    for part in dict.fromkeys(sorted((parts.get(s.name, "") for s, _ in members), key=bool, reverse=True)):
        ordered = sorted((m for m in members if parts.get(m[0].name, "") == part), key=lambda m: -_SIZE[m[1]])
        if sum(_SIZE[c] for _, c in ordered) % widest:
            filler = f"{part}_reserved" if part else "reserved"
            ordered.append((Signal(filler, "1", 0, 1, "fills the struct up"), "uint32_t"))
        for s, c in ordered:
            low, high = (_rounded_bound(end, s, scalar if c != "uint32_t" else np.float64) for end in (s.low, s.high))
            fields.append(Member(s.name, offset, c, s.unit, low, high, s.about, part))
            offset += _SIZE[c]
    return Struct(kind, f"{name}_{kind}_t", offset, tuple(fields))
