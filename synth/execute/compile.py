"""Turn C texts into a file of machine code, once: a shared library for this machine, or what a cross compiler makes.

The product is a function of its sources, its flags, its compiler and the kind of processor:

    path = cache / SHA-256(texts, flags, compiler, processor) / product

so a path that exists holds the right code and is never built again, unless SYNTH_FRESH names another run. Contraction of
a*b + c into one rounding is off unless a flag turns it on: with it, the last bits depend on the processor.
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

from synth import cache
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
    "-Werror",
)


@dataclass(frozen=True)
class Compiler:
    """A C compiler: the words that call it, what it says it is, and the flags that name the machine to build for."""

    command: tuple[str, ...]
    identity: str
    machine_flags: tuple[str, ...] = ()


def find_compiler() -> Compiler:
    """Find the host's C compiler: `$CC`, else `cc`, else the ziglang wheel.

    Raises CompileError if `$CC` cannot be run, or if there is none of the three.
    """
    if chosen := shlex.split(os.environ.get("CC", "")):
        return identified(tuple(chosen), "set CC to a C compiler, or unset it")
    if shutil.which("cc"):
        return identified(("cc",), "mend it, or set CC to another C compiler")
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
    # Left alone, zig builds for the very processor it runs on, and a shared cache would hold code that others trap on.
    return identified(command, "reinstall the wheel: `pip install --force-reinstall ziglang`", ("-mcpu=baseline",))


def shared_library(sources: Mapping[str, str], flags: Sequence[str] = (), compiler: Compiler | None = None) -> Path:
    """Compile `{filename: text}` into one shared library and return its path.

    All `.c` files are compiled and linked with libm; other files (headers) stand beside them for `#include "..."`.
    `flags` follow LIBRARY_FLAGS and so override them.

    Raises CompileError if a name is no plain file name, if there is no `.c` file, if the cache cannot be written, or
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

    `options` follow the compiler's own `machine_flags`, and `libraries` stand last on the command line.

    Raises CompileError as `shared_library` does.
    """
    named = _units(sources)
    command = [*compiler.machine_flags, *options, *(units or named), "-o", product, *libraries]
    folder = cache.folder() / _key(sources, command, compiler)
    if _is_built(folder, product):
        return folder / product
    with _work_folder(cache.folder()) as work:
        built = Path(work)
        _write(sources, built)
        _run([*compiler.command, *command], built)
        folder.mkdir(exist_ok=True)
        # Each file moves whole and the product last: a process that sees it sees all of it, whoever built it.
        (built / RUN).write_text(cache.run_name(), encoding="utf-8")
        for name in [*sources, product, RUN]:
            os.replace(built / name, folder / name)
    return folder / product


def _is_built(folder: Path, product: str) -> bool:
    """Whether the product is there; to a run with a name of its own, one that it has built itself."""
    run, made_by = cache.run_name(), folder / RUN
    with suppress(OSError):
        return (folder / product).exists() and (not run or made_by.read_text(encoding="utf-8") == run)
    return False


def check(sources: Mapping[str, str], flags: Sequence[str] = STRICT_FLAGS, compiler: Compiler | None = None) -> None:
    """Compile every `.c` of `{filename: text}` to an object that is thrown away; silence means no warning.

    Raises CompileError as `shared_library` does, and with STRICT_FLAGS for every warning.
    """
    units = _units(sources)
    compiler = compiler or find_compiler()
    with tempfile.TemporaryDirectory() as work:
        _write(sources, Path(work))
        for unit in units:
            _run([*compiler.command, *compiler.machine_flags, *flags, "-c", unit, "-o", "object.o"], Path(work))


def identified(command: tuple[str, ...], mend: str, machine_flags: tuple[str, ...] = ()) -> Compiler:
    """Return the compiler that `command` calls, with what it says of itself.

    Raises CompileError, with the `mend`, when the command cannot be run.
    """
    try:
        said = subprocess.run([*command, "--version"], capture_output=True, text=True, check=True).stdout
    except (OSError, subprocess.CalledProcessError) as error:
        raise CompileError(f"C compiler: `{shlex.join(command)} --version` fails ({error}); {mend}") from error
    return Compiler(command, said.strip(), machine_flags)


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
