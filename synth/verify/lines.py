"""Line table of a linked image: source file and line of a machine address, from the DWARF data of -g (`addr2line`).

For inlined code the line table names the line in the inlined function. `calls` gives the lines of the outermost calls
that were inlined into a function.
"""

from bisect import bisect_right
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from elftools.dwarf.compileunit import CompileUnit
from elftools.dwarf.die import DIE
from elftools.dwarf.dwarfinfo import DWARFInfo
from elftools.dwarf.ranges import BaseAddressEntry
from elftools.elf.elffile import ELFFile


@dataclass(frozen=True)
class Lines:
    """Rows of the line table in order of address; each row is valid up to the next. `read` returns one."""

    addresses: tuple[int, ...]
    places: tuple[tuple[str, int], ...]

    def at(self, address: int) -> tuple[str, int]:
        """Return file name and line, from 1, of an address; ("", 0) if no row covers it."""
        k = bisect_right(self.addresses, address) - 1
        return self.places[k] if k >= 0 else ("", 0)


def read(path: Path) -> Lines:
    """Read the line table of a linked image; it is empty without -g."""
    by_address: dict[int, tuple[str, int]] = {}
    with path.open("rb") as file:
        elf = ELFFile(file)
        if elf.has_dwarf_info():
            info = elf.get_dwarf_info()
            for unit in info.iter_CUs():
                name = Path(unit.get_top_DIE().get_full_path()).name
                program = info.line_program_for_CU(unit)
                rows = [entry.state for entry in program.get_entries() if entry.state] if program else []
                by_address |= {row.address: (name, row.line) for row in rows if not row.end_sequence}
    ordered = sorted(by_address)
    return Lines(tuple(ordered), tuple(by_address[a] for a in ordered))


@dataclass(frozen=True)
class Call:
    """An inlined call: addresses low <= a < high, and the line of the call in the caller."""

    low: int
    high: int
    line: int


def calls(path: Path, function: str) -> tuple[Call, ...]:
    """Return the calls that were inlined into a function; empty without -g."""
    with path.open("rb") as file:
        elf = ELFFile(file)
        if not elf.has_dwarf_info():
            return ()
        info = elf.get_dwarf_info()
        return tuple(
            Call(low, high, die.attributes["DW_AT_call_line"].value)
            for unit in info.iter_CUs()
            for top in unit.get_top_DIE().iter_children()
            if top.tag == "DW_TAG_subprogram" and _name(top) == function
            for die in _inlined_calls(top)
            for low, high in _ranges(info, unit, die)
            if low < high
        )


def _name(die: DIE) -> str:
    attribute = die.attributes.get("DW_AT_name")
    return attribute.value.decode() if attribute else ""


def _inlined_calls(die: DIE) -> Iterator[DIE]:
    """Yield the outermost inlined calls below an entry."""
    for child in die.iter_children():
        if child.tag == "DW_TAG_inlined_subroutine":
            yield child
        elif child.tag == "DW_TAG_lexical_block":
            yield from _inlined_calls(child)


def _ranges(info: DWARFInfo, unit: CompileUnit, die: DIE) -> Iterator[tuple[int, int]]:
    if "DW_AT_low_pc" in die.attributes:
        low, high = die.attributes["DW_AT_low_pc"].value, die.attributes["DW_AT_high_pc"]
        yield low, high.value if high.form == "DW_FORM_addr" else low + high.value
    elif "DW_AT_ranges" in die.attributes:
        start = unit.get_top_DIE().attributes.get("DW_AT_low_pc")
        base = start.value if start else 0
        lists = info.range_lists()
        assert lists is not None, "ranges without their section"
        for entry in lists.get_range_list_at_offset(die.attributes["DW_AT_ranges"].value, cu=unit):
            if isinstance(entry, BaseAddressEntry):
                base = entry.base_address
            else:
                shift = 0 if entry.is_absolute else base
                yield entry.begin_offset + shift, entry.end_offset + shift
