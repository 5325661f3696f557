"""Compile C with a build cache: a shared library for this machine, or the product of a cross compiler.

The product is a function of its sources, its flags, its compiler and the kind of processor:

    path = cache / SHA-256(texts, flags, compiler, processor) / product

An existing path therefore holds the right code and is not built again, unless SYNTH_FRESH names another run.
Contraction of a*b + c into one rounding is off unless a flag turns it on, because it makes the last bits depend on the
processor.
"""

import hashlib
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

from synth.base import store
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
    """Find the host's C compiler: `$CC`, else `cc`, else the clang of the ziglang wheel.

    Raises CompileError if that compiler cannot be run.
    """
    if chosen := shlex.split(os.environ.get("CC", "")):
        return identify_compiler(tuple(chosen), "set CC to a C compiler, or unset it")
    if shutil.which("cc"):
        return identify_compiler(("cc",), "mend it, or set CC to another C compiler")
    return zig_compiler()


def zig_compiler() -> Compiler:
    """Return the clang of the ziglang wheel; raise CompileError if it cannot be run."""
    command = (sys.executable, "-m", "ziglang", "cc")
    # By default zig builds for the processor it runs on; code in a shared cache would then trap on other processors.
    mend = (
        "where it names its cache, set SYNTH_CACHE to a folder that can be written, otherwise reinstall the wheel: "
        "`pip install --force-reinstall ziglang`"
    )
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

    `options` come after the `machine_flags` of the compiler; `libraries` come last on the command line.

    Raises CompileError as `shared_library` does.
    """
    sources_to_build = c_files(sources)
    return _product(sources, [*options, *(units or sources_to_build)], product, compiler, libraries)


def link(
    objects: Sequence[Path], options: Sequence[str], product: str, compiler: Compiler, libraries: Sequence[str] = ()
) -> Path:
    """Call the compiler on objects that `build` has compiled; return the path of `product`.

    The path of an object names its content, so the product is a function of the paths. Raises CompileError as
    `shared_library` does.
    """
    return _product({}, [*options, *map(str, objects)], product, compiler, libraries)


def _product(
    sources: Mapping[str, str], arguments: Sequence[str], product: str, compiler: Compiler, libraries: Sequence[str]
) -> Path:
    """Return the path of a product in the cache, built by the compiler where it is not there."""
    command = [*compiler.machine_flags, *arguments, "-o", product, *libraries]
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
    units = c_files(sources)
    compiler = compiler or find_compiler()
    with tempfile.TemporaryDirectory() as work:
        _write(sources, Path(work))
        for unit in units:
            _run([*compiler.command, *compiler.machine_flags, *flags, "-c", unit, "-o", "object.o"], Path(work))


def identify_compiler(command: tuple[str, ...], mend: str, machine_flags: tuple[str, ...] = ()) -> Compiler:
    """Return the compiler that `command` calls, with the version text that it prints.

    Raises CompileError, with the compiler's own message and the `mend`, when the command cannot be run.
    """
    asked = [*command, "--version"]
    try:
        done = subprocess.run(asked, capture_output=True, text=True, env=_environment())
    except OSError as error:
        raise CompileError(f"C compiler: `{shlex.join(asked)}` cannot be run ({error}); {mend}") from error
    if done.returncode != 0:
        raise CompileError(
            f"C compiler: `{shlex.join(asked)}` ends with status {done.returncode}, 0 is needed; {mend}\n"
            f"{done.stderr.strip()}"
        )
    return Compiler(command, done.stdout.strip(), machine_flags)


def c_files(sources: Mapping[str, str]) -> list[str]:
    """Return the sorted names of the `.c` files; raise CompileError for a name with a folder, or if there is none."""
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


def _environment() -> dict[str, str]:
    """Return the environment of a compiler: zig keeps a cache of its own beside the products, or where it is set."""
    return {"ZIG_GLOBAL_CACHE_DIR": str(store.folder() / "zig"), **os.environ}


def _run(command: Sequence[str], folder: Path) -> None:
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, env=_environment())
    if done.returncode != 0:
        raise CompileError(
            f"C source: the compiler refused it with status {done.returncode}, 0 is needed; mend the lines it names\n"
            f"{shlex.join(command)}\n{done.stderr.strip()}"
        )
