"""Which line of which source a machine address comes from: the line table that a compiler writes with -g."""

from bisect import bisect_right
from dataclasses import dataclass
from pathlib import Path

from elftools.elf.elffile import ELFFile


@dataclass(frozen=True)
class Lines:
    """Rows of the line table in order of address; a row holds up to the next. `read` makes one."""

    addresses: tuple[int, ...]
    places: tuple[tuple[str, int], ...]

    def at(self, address: int) -> tuple[str, int]:
        """Return file name and line, from 1, of what lies at an address; ("", 0) where no row says."""
        k = bisect_right(self.addresses, address) - 1
        return self.places[k] if k >= 0 else ("", 0)


def read(path: Path) -> Lines:
    """Read the line table of a linked image; it is empty where nothing was compiled with -g."""
    found: dict[int, tuple[str, int]] = {}
    with path.open("rb") as file:
        elf = ELFFile(file)
        if elf.has_dwarf_info():
            info = elf.get_dwarf_info()
            for unit in info.iter_CUs():
                name = Path(unit.get_top_DIE().get_full_path()).name
                program = info.line_program_for_CU(unit)
                rows = [entry.state for entry in program.get_entries() if entry.state] if program else []
                found |= {row.address: (name, row.line) for row in rows if not row.end_sequence}
    ordered = sorted(found)
    return Lines(tuple(ordered), tuple(found[a] for a in ordered))
