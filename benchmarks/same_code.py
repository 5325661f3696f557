"""Whether two versions of generated C compile to the same machine code: `python -m benchmarks.same_code [REVISION]`.

Names and comments may change from the revision (by default HEAD) to the working tree; instructions may not. Each
program is compiled for a Cortex-M4F by gcc and by zig's clang, at -O2 and -Os. Two objects are the same when their
executable and read-only sections have the same bytes and refer to the same places and external names.
"""

import subprocess
import sys
from collections.abc import Iterator, Mapping
from hashlib import sha256
from pathlib import Path
from typing import Any

from elftools.elf.constants import SH_FLAGS
from elftools.elf.elffile import ELFFile

from synth.execute import compile as host_compiler
from synth.execute import cross

CORE = "cortex-m4f"
LEVELS = ("-O2", "-Os")
FOLDER = Path("generated_c")


def differences(before: Mapping[str, str], after: Mapping[str, str]) -> list[str]:
    """Return the compilers and levels at which two versions {file name: text} of a program differ in machine code."""
    return [
        f"{compiler} {level}"
        for compiler in cross.available()
        for level in LEVELS
        if machine_code(before, compiler, level) != machine_code(after, compiler, level)
    ]


def machine_code(sources: Mapping[str, str], compiler: str, level: str) -> str:
    """Return the digest of a program's instructions and constants; raise CompileError when it does not compile."""
    flags = [*cross.FLAGS, level, "-c", "-g0"]
    product = host_compiler.build(sources, flags, "program.o", cross.find_compiler(CORE, compiler))
    with product.open("rb") as file:
        return sha256(repr(list(_loaded_contents(ELFFile(file)))).encode()).hexdigest()


def _loaded_contents(elf: ELFFile) -> Iterator[tuple[object, ...]]:
    """Yield the bytes of each section that is loaded and not written to, and what its relocations refer to."""
    symbols: Any = elf.get_section_by_name(".symtab")
    sections: Any = elf.iter_sections()
    for section in sections:
        if section["sh_flags"] & SH_FLAGS.SHF_ALLOC and not section["sh_flags"] & SH_FLAGS.SHF_WRITE:
            yield section["sh_type"], section.data()
        if section["sh_type"] in ("SHT_REL", "SHT_RELA"):
            for relocation in section.iter_relocations():
                symbol = symbols.get_symbol(relocation["r_info_sym"])
                external = symbol["st_shndx"] == "SHN_UNDEF"
                place = symbol.name if external else (symbol["st_shndx"], symbol["st_value"])
                yield relocation["r_offset"], relocation["r_info_type"], place


def read_revision(revision: str, program: str) -> dict[str, str]:
    """Return the C of a program {file name: text} at a revision, empty where the revision does not have it."""
    names = [f"{program}{suffix}" for suffix in (".c", ".h")]
    shows = {name: _git("show", f"{revision}:{FOLDER}/{program}/{name}") for name in names}
    return {name: text for name, text in shows.items() if text is not None}


def _git(*arguments: str) -> str | None:
    process = subprocess.run(["git", *arguments], capture_output=True, text=True, check=False)
    return process.stdout if process.returncode == 0 else None


def main() -> None:
    """Print a line for each program; exit with 1 when the machine code of one differs."""
    revision = (sys.argv[1:] or ["HEAD"])[0]
    different = False
    for folder in sorted(path.parent for path in FOLDER.glob("*/*.c")):
        after = {
            path.name: path.read_text(encoding="utf-8") for path in folder.iterdir() if path.suffix in (".c", ".h")
        }
        before = read_revision(revision, folder.name)
        verdict = "not in that revision"
        if before:
            changed = differences(before, after)
            different |= bool(changed)
            verdict = f"differs: {', '.join(changed)}" if changed else "same machine code"
        sys.stdout.write(f"{folder.name:<24}{verdict}\n")
    sys.exit(different)


if __name__ == "__main__":
    main()
