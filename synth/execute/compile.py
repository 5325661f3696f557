"""Compile C with a build cache: a shared library for this machine, or the product of a cross compiler.

The product is a function of its sources, its flags, its compiler and the kind of processor:

    path = cache / SHA-256(texts, flags, compiler, processor) / product

An existing path therefore holds the right code and is not built again, unless SYNTH_FRESH names another run.
Contraction of a*b + c into one rounding is off unless a flag turns it on, because it makes the last bits depend on the
processor.
"""

import hashlib
import importlib.util
import json
import os
import platform
import shlex
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

from synth import store
from synth.errors import CompileError

RUN = "run"  # the file that names the run which built a product
LIBRARY_FLAGS = ("-shared", "-fPIC", "-O2", "-std=c99", "-ffp-contract=off")
STRICT_FLAGS = (
    "-std=c99",
    "-Wall",
    "-Wextra",
    "-Wpedantic",
    "-Wconversion",
    "-Wshadow",
    "-Wdouble-promotion",
    "-Wfloat-equal",
    "-Wcast-qual",
    "-Wundef",
    "-Wstrict-prototypes",
    "-Werror",
)


@dataclass(frozen=True)
class Compiler:
    """A C compiler: its command line, the version text that it prints, and the flags that select the target machine."""

    command: tuple[str, ...]
    identity: str
    machine_flags: tuple[str, ...] = ()


def find_compiler() -> Compiler:
    """Find the host's C compiler: `$CC`, else `cc`, else the ziglang wheel.

    Raises CompileError if `$CC` cannot be run, or if none of the three is available.
    """
    if chosen := shlex.split(os.environ.get("CC", "")):
        return identify_compiler(tuple(chosen), "set CC to a C compiler, or unset it")
    if shutil.which("cc"):
        return identify_compiler(("cc",), "mend it, or set CC to another C compiler")
    if zig := zig_compiler():
        return zig
    raise CompileError(
        "C compiler: CC is not set, there is no `cc` on the PATH and no ziglang wheel; one of them is needed: "
        "run `pip install ziglang`, or install a compiler and set CC to it"
    )


def zig_compiler() -> Compiler | None:
    """Return the clang of the ziglang wheel, or None where the wheel is not installed."""
    if importlib.util.find_spec("ziglang") is None:
        return None
    command = (sys.executable, "-m", "ziglang", "cc")
    # By default zig builds for the processor it runs on; code in a shared cache would then trap on other processors.
    mend = "reinstall the wheel: `pip install --force-reinstall ziglang`"
    return identify_compiler(command, mend, ("-mcpu=baseline",))


def shared_library(sources: Mapping[str, str], flags: Sequence[str] = (), compiler: Compiler | None = None) -> Path:
    """Compile `{filename: text}` into one shared library and return its path.

    All `.c` files are compiled and linked with libm; other files (headers) are placed beside them for `#include "..."`.
    `flags` come after LIBRARY_FLAGS and override them.

    Raises CompileError if a name is not a plain file name, if there is no `.c` file, if the cache cannot be written, or
    if the compiler refuses the sources.
    """
    options = [*LIBRARY_FLAGS, *flags]
    return build(sources, options, "library.so", compiler or find_compiler(), libraries=("-lm",))


def build(
    sources: Mapping[str, str],
    options: Sequence[str],
    product: str,
    compiler: Compiler,
    *,
    units: Sequence[str] | None = None,
    libraries: Sequence[str] = (),
) -> Path:
    """Call the compiler on `units`, or on every `.c` file, of `{filename: text}`; return the path of `product`.

    A unit is the name of a source, or the path of an object.
    `options` come after the `machine_flags` of the compiler; `libraries` come last on the command line.

    Raises CompileError as `shared_library` does.
    """
    sources_to_build = _units(sources)
    command = [*compiler.machine_flags, *options, *(units or sources_to_build), "-o", product, *libraries]
    folder = store.folder() / _key(sources, command, compiler)
    if _is_built(folder, product):
        return folder / product
    with _work_folder(store.folder()) as work:
        built = Path(work)
        _write(sources, built)
        _run([*compiler.command, *command], built)
        folder.mkdir(exist_ok=True)
        # Each file is moved atomically and the product last: a process that sees the product sees every file complete.
        (built / RUN).write_text(store.run_name(), encoding="utf-8")
        for name in [*sources, product, RUN]:
            os.replace(built / name, folder / name)
    return folder / product


def _is_built(folder: Path, product: str) -> bool:
    """Return whether the product exists; a named run (SYNTH_FRESH) accepts only a product that it built itself."""
    run, made_by = store.run_name(), folder / RUN
    with suppress(OSError):
        return (folder / product).exists() and (not run or made_by.read_text(encoding="utf-8") == run)
    return False


def check(sources: Mapping[str, str], flags: Sequence[str] = STRICT_FLAGS, compiler: Compiler | None = None) -> None:
    """Compile every `.c` of `{filename: text}` to a temporary object file; no exception means no warning.

    Raises CompileError as `shared_library` does, and with STRICT_FLAGS for every warning.
    """
    units = _units(sources)
    compiler = compiler or find_compiler()
    with tempfile.TemporaryDirectory() as work:
        _write(sources, Path(work))
        for unit in units:
            _run([*compiler.command, *compiler.machine_flags, *flags, "-c", unit, "-o", "object.o"], Path(work))


def identify_compiler(command: tuple[str, ...], mend: str, machine_flags: tuple[str, ...] = ()) -> Compiler:
    """Return the compiler that `command` calls, with the version text that it prints.

    Raises CompileError, with the `mend`, when the command cannot be run.
    """
    try:
        version_text = subprocess.run([*command, "--version"], capture_output=True, text=True, check=True).stdout
    except (OSError, subprocess.CalledProcessError) as error:
        raise CompileError(f"C compiler: `{shlex.join(command)} --version` fails ({error}); {mend}") from error
    return Compiler(command, version_text.strip(), machine_flags)


def _units(sources: Mapping[str, str]) -> list[str]:
    for name in sources:
        if Path(name).name != name or name.startswith("-"):
            raise CompileError(f"C source: found the name {name!r}, need a plain file name; leave the folders out")
    units = sorted(name for name in sources if name.endswith(".c"))
    if not units:
        raise CompileError(f"C source: found {sorted(sources)}, need at least one file that ends in .c; add it")
    return units


def _key(sources: Mapping[str, str], arguments: Sequence[str], compiler: Compiler) -> str:
    built_from = [
        sorted(sources.items()),
        list(arguments),
        [*compiler.command, compiler.identity],
        [platform.system(), platform.machine()],
    ]
    return hashlib.sha256(json.dumps(built_from).encode()).hexdigest()


def _work_folder(where: Path) -> tempfile.TemporaryDirectory[str]:
    try:
        where.mkdir(parents=True, exist_ok=True)
        return tempfile.TemporaryDirectory(prefix="building-", dir=where)
    except OSError as error:
        raise CompileError(
            f"compiler cache: {where} cannot be written ({error}); set SYNTH_CACHE to a folder that can"
        ) from error


def _write(sources: Mapping[str, str], folder: Path) -> None:
    for name, text in sources.items():
        (folder / name).write_text(text, encoding="utf-8", newline="\n")


def _run(command: Sequence[str], folder: Path) -> None:
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True)
    if done.returncode != 0:
        raise CompileError(
            f"C source: the compiler refused it with status {done.returncode}, 0 is needed; mend the lines it names\n"
            f"{shlex.join(command)}\n{done.stderr.strip()}"
        )
