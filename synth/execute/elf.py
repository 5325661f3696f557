"""ELF reader: segments, symbols and size of a linked image, as `arm-none-eabi-size` and `nm` report them.

Bytes are counted by memory region. `code` and `literals` share the executable sections; the mapping symbols $t and $d
of the Arm ABI separate them. `constants` are read-only data, `data` is RAM. Unwinding tables (.ARM.exidx, .ARM.extab)
are not counted, because only C++ exceptions read them. `_init` and `_fini` of the C start-up are not counted either,
because zig's linker keeps them for every image.

Layout of the structs of emitted C: compile-time assertions that the headers agree with the manifest.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from elftools.elf.constants import SH_FLAGS
from elftools.elf.elffile import ELFFile
from numpy.typing import NDArray

from synth.errors import CompileError, DesignError

_LAYOUT = """#include <stddef.h>
#include <stdint.h>
{includes}
#pragma GCC diagnostic error "-Wincompatible-pointer-types"
#pragma GCC diagnostic error "-Wpointer-sign"
#define AGREES(claim, holds) typedef char claim[(holds) ? 1 : -1]
{claims}
"""


def assertions(files: Mapping[str, str], manifest: Mapping[str, Any]) -> str:
    """Return compile-time assertions in C that the headers lay out the structs as the manifest states.

    Raises DesignError when there is no header.
    """
    headers = sorted(name for name in files if name.endswith(".h"))
    if not headers:
        raise DesignError(f"emitted C: found {sorted(files)}, need the header beside the source: add the .h file")
    structs = manifest["structs"]
    return _LAYOUT.format(
        includes="\n".join(f'#include "{name}"' for name in headers),
        claims="\n".join(line for role in structs for line in _claims(role, structs[role])),
    )


def _claims(role: str, struct: Mapping[str, Any]) -> list[str]:
    """Return the layout of a struct as compile-time assertions; the compiler prints the name of one that fails."""
    T, size = struct["type"], struct["size"]
    lines = [f"AGREES(manifest_{role}_has_{size}_bytes, sizeof({T}) == {size});"]
    for field in struct["fields"]:
        name, offset, count, ctype = (field[key] for key in ("name", "offset", "count", "ctype"))
        path = field.get("path", name)
        member, address = f"manifest_{role}_{name}", "" if count > 1 else "&"
        lines += [
            f"AGREES({member}_at_{offset}, offsetof({T}, {path}) == {offset});",
            f"AGREES({member}_has_{count}, sizeof((({T} *)0)->{path}) == {count} * sizeof({ctype}));",
            f"static inline const {ctype} *{member}_is_{ctype}(const {T} *s) {{ return {address}s->{path}; }}",
        ]
    return lines


OUTSIDE = "(no function)"
_STARTUP = ("_init", "_fini")
_UNWINDING = ("SHT_ARM_EXIDX", ".ARM.extab")


class Segment(NamedTuple):
    """Bytes to be loaded at an address, padded with zeros."""

    address: int
    content: bytes


class Region(NamedTuple):
    """Bytes of an executable section: Thumb instructions, or literals among them."""

    address: int
    content: bytes
    thumb: bool


class Function(NamedTuple):
    """A function of `size` bytes; `name` is its external name if it has one."""

    name: str
    address: int
    size: int


@dataclass(frozen=True)
class Size:
    """Bytes of an image: `code` is instructions and padding, `literals` are constants in code sections.

    `constants` is .rodata, `data` initialised and zeroed RAM; `functions` gives the bytes of each with its literals.
    """

    code: int
    literals: int
    constants: int
    data: int
    functions: Mapping[str, int]


@dataclass(frozen=True, eq=False)
class Program:
    """A linked image: segments to load, addresses by symbol name, functions and regions sorted by address."""

    segments: tuple[Segment, ...]
    addresses: Mapping[str, int]
    functions: tuple[Function, ...]
    regions: tuple[Region, ...]
    constants: int
    data: int

    def address(self, name: str) -> int:
        """Return the address of a function, without the Thumb bit.

        Raises CompileError when the image has no function of that name.
        """
        if name not in self.addresses:
            raise CompileError(
                f"linked image: found no function '{name}', need one that the sources define and do not make static: "
                "correct the name"
            )
        return self.addresses[name] & ~1

    def function_at(self, addresses: NDArray[np.integer[Any]]) -> NDArray[np.intp]:
        """Return for each address the index of the function that contains it, len(functions) for none."""
        starts = np.array([f.address for f in self.functions], dtype=np.int64)
        ends = np.array([f.address + f.size for f in self.functions], dtype=np.int64)
        index = np.searchsorted(starts, addresses, side="right") - 1
        return np.where((index >= 0) & (addresses < ends[index]), index, len(self.functions))

    def size(self) -> Size:
        """Count the bytes of the image."""
        functions = {f.name: f.size for f in self.functions if f.name not in _STARTUP}
        kept = sum(f.size for f in self.functions if f.name in _STARTUP)
        code, literals = (sum(len(r.content) for r in self.regions if r.thumb is thumb) for thumb in (True, False))
        return Size(code - kept, literals, self.constants, self.data, functions)


def read(path: Path) -> Program:
    """Read a linked image; raise CompileError when the file has no symbols, as after `-s`."""
    with path.open("rb") as file:
        elf = ELFFile(file)
        symbols, sections = _symbols(elf), [s for s in elf.iter_sections() if _is_loaded(s)]
        return Program(
            segments=tuple(_segment(s) for s in elf.iter_segments("PT_LOAD") if s["p_memsz"]),
            addresses={s.name: s["st_value"] for s in symbols if s["st_shndx"] != "SHN_UNDEF" and s.name},
            functions=tuple(_functions(symbols, [s["sh_addr"] + s["sh_size"] for s in sections if _is_executable(s)])),
            regions=tuple(r for s in sections if _is_executable(s) for r in _regions(s, symbols)),
            constants=sum(s["sh_size"] for s in sections if not _is_executable(s) and not _is_writeable(s)),
            data=sum(s["sh_size"] for s in sections if _is_writeable(s)),
        )


def undefined_symbols(path: Path) -> frozenset[str]:
    """Return the undefined symbols of an object file."""
    with path.open("rb") as file:
        return frozenset(s.name for s in _symbols(ELFFile(file)) if s["st_shndx"] == "SHN_UNDEF" and s.name)


def defined_functions(path: Path) -> frozenset[str]:
    """Return the names of the functions in an object file, static ones included."""
    with path.open("rb") as file:
        return frozenset(s.name for s in _symbols(ELFFile(file)) if _is_function(s))


def _symbols(elf: Any) -> list[Any]:
    table = elf.get_section_by_name(".symtab")
    if table is None:
        raise CompileError("machine code: found no symbol table, need one to identify functions: leave out the flag -s")
    return list(table.iter_symbols())


def _segment(segment: Any) -> Segment:
    return Segment(segment["p_vaddr"], segment.data().ljust(segment["p_memsz"], b"\0"))


def _functions(symbols: list[Any], ends: list[int]) -> list[Function]:
    """Return each function once, cut off where the next function begins or the section ends.

    Functions of the run-time libraries overlap; shared bytes count for the function that begins last.
    """
    by_address: dict[int, tuple[tuple[bool, int, str], int]] = {}
    for symbol in filter(_is_function, symbols):
        # Among several names at one address, prefer the external one, then the shortest.
        rank = (symbol["st_info"]["bind"] == "STB_LOCAL", len(symbol.name), symbol.name)
        address = symbol["st_value"] & ~1
        by_address[address] = min(
            by_address.get(address, (rank, 0)), (rank, symbol["st_size"]), key=lambda candidate: candidate[0]
        )
    edges = sorted({*by_address, *ends})
    rooms = {address: edges[edges.index(address) + 1] - address for address in by_address}
    return [
        Function(rank[-1], at, min(size or rooms[at], rooms[at])) for at, (rank, size) in sorted(by_address.items())
    ]


def _regions(section: Any, symbols: list[Any]) -> list[Region]:
    start, content = section["sh_addr"], section.data()
    marks = {
        s["st_value"]: s.name.startswith("$t")
        for s in symbols
        if s.name[:2] in ("$t", "$d") and start <= s["st_value"] < start + len(content)
    }
    edges = sorted({start: False} | marks)
    ends = [*edges[1:], start + len(content)]
    return [Region(a, content[a - start : b - start], marks.get(a, False)) for a, b in zip(edges, ends, strict=True)]


def _is_function(symbol: Any) -> bool:
    return symbol["st_info"]["type"] == "STT_FUNC" and symbol["st_shndx"] != "SHN_UNDEF"


def _is_loaded(section: Any) -> bool:
    unwinding = section["sh_type"] in _UNWINDING or section.name in _UNWINDING
    return bool(section["sh_flags"] & SH_FLAGS.SHF_ALLOC) and not unwinding


def _is_executable(section: Any) -> bool:
    return bool(section["sh_flags"] & SH_FLAGS.SHF_EXECINSTR)


def _is_writeable(section: Any) -> bool:
    return bool(section["sh_flags"] & SH_FLAGS.SHF_WRITE)
