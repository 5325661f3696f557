"""Cross-compile C for a Cortex-M core, with the clang of the ziglang wheel (musl) or arm-none-eabi-gcc (newlib).

    cortex-m4f    Armv7E-M, FPv4-SP: float in hardware, double in software
    cortex-m7     Armv7E-M, FPv5-D16: float and double in hardware

An image is linked from its entry points alone, without start-up code; the linker drops unreachable functions. Most
emitted C calls the compiler's own run-time library alone, and is linked with no other. All products are stored in the
cache of `compile`. The first image that zig links for a core with libm also builds musl, in the cache of zig, which
takes most of a minute. Flags that change how a library is built, such as -O0 or -s, make zig build musl again.
"""

import re
import shutil
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from synth.errors import CompileError, SynthError
from synth.execute import compile as host_compiler
from synth.execute import elf

FLAGS = ("-O2", "-std=c99", "-ffp-contract=off", "-fno-math-errno")
CONTRACTED = ("-ffp-contract=fast",)  # a b + c may be rounded once
# One section per function lets the linker drop each one; unwinding tables would keep functions that nothing calls.
SECTIONS = ("-ffunction-sections", "-fdata-sections", "-fno-unwind-tables", "-fno-asynchronous-unwind-tables")
# All bits that change a result: rounding, flush to zero, default NaN, half-precision format, vector length, traps.
FPSCR_MODES = 0x07FF9F00
# By default zig enables sanitizer checks and frame pointers; neither clang nor gcc does so at -O2.
_ZIG_TARGET = ("-target", "thumb-linux-musleabihf", "-fno-sanitize=undefined", "-fomit-frame-pointer")
# gcc would predicate both sides of a short branch and fetch both: real branches issue 2 to 6 % fewer instructions.
_GCC_TARGET = ("-mthumb", "-mfloat-abi=hard", "-fno-if-conversion2", "-nostartfiles", "--specs=nosys.specs")

# What zig's own run-time library has beside arithmetic, whose names begin with __. It has functions of libm, too, which
# round otherwise than musl's: it serves images that call none.
_MEMORY = {"memset", "memcpy", "memmove", "memcmp"}
# The run-time functions of double arithmetic: the Arm ABI's names, then those of libgcc and compiler-rt.
_DOUBLE_RUNTIME = re.compile(r"__aeabi_(c?d\w+|(f|h|i|ui|l|ul)2d)|__\w*df\w*|__\w+dc3")
_DOUBLE_MATH = re.compile(
    r"(a?(sin|cos|tan)h?|atan2|exp|exp2|exp10|expm1|log|log2|log10|log1p|logb|ilogb|pow|sqrt|cbrt|hypot|erfc?|[lt]gamma"
    r"|gamma|ceil|floor|trunc|rint|nearbyint|l?lrint|round|l?lround|fmod|remainder|remquo|drem|copysign|nan|nextafter"
    r"|nexttoward|fdim|fmax|fmin|fma|fabs|frexp|ldexp|modf|scalbl?n|scalb|significand|sincos|[jy][01n]|strtod|atof"
    r"|difftime)l?"
)


@dataclass(frozen=True)
class Core:
    """A processor core: its name, and the flags that make each cross compiler build for it."""

    name: str
    zig: tuple[str, ...]
    gcc: tuple[str, ...]


CORES = {
    core.name: core
    for core in (
        Core("cortex-m4f", ("-mcpu=cortex_m4+vfp4d16sp",), ("-mcpu=cortex-m4", "-mfpu=fpv4-sp-d16")),
        Core("cortex-m7", ("-mcpu=cortex_m7+fp_armv8d16",), ("-mcpu=cortex-m7", "-mfpu=fpv5-d16")),
    )
}


def available() -> tuple[str, ...]:
    """Return the installed cross compilers: "zig", and "gcc" where arm-none-eabi-gcc is on the PATH."""
    return ("zig", "gcc") if shutil.which("arm-none-eabi-gcc") else ("zig",)


def find_core(name: str) -> Core:
    """Return the core of that name; raise CompileError when there is none."""
    if name not in CORES:
        raise CompileError(f"core: found '{name}', need one of {', '.join(CORES)}: correct the name")
    return CORES[name]


def find_compiler(core: str, name: str) -> host_compiler.Compiler:
    """Return the cross compiler "zig" or "gcc" for a core.

    Raises CompileError when the core or the compiler is unknown, or when the compiler is not installed.
    """
    chosen = find_core(core)
    if name == "zig":
        zig = host_compiler.zig_compiler()
        return host_compiler.Compiler(zig.command, zig.identity, (*_ZIG_TARGET, *chosen.zig))
    if name == "gcc" and shutil.which("arm-none-eabi-gcc"):
        flags = (*_GCC_TARGET, *chosen.gcc)
        return host_compiler.identify_compiler(("arm-none-eabi-gcc",), "reinstall gcc-arm-none-eabi", flags)
    raise CompileError(
        f"cross compiler: found no '{name}', need 'zig' or 'gcc' (arm-none-eabi-gcc with newlib on the PATH): install "
        f"it, or choose from those installed: {', '.join(available())}"
    )


def require_plain_floats(where: str, fpscr: int) -> None:
    """Raise SynthError when the mode bits of a core's FPSCR differ from reset; exception flags are ignored."""
    if fpscr & FPSCR_MODES:
        raise SynthError(
            f"floating point on {where}: FPSCR has the mode bits {fpscr & FPSCR_MODES:#x}, 0 is needed (round to "
            "nearest, no flush to zero): keep the code from changing them"
        )


def link(
    sources: Mapping[str, str], entries: Sequence[str], core: str, compiler: str = "zig", flags: Sequence[str] = ()
) -> Path:
    """Link all `.c` of `{filename: text}` with libm into an image with all functions that `entries` reach.

    `flags` come after FLAGS and override them.

    Raises CompileError when the core or the compiler is not available, or when the compiler refuses the sources.
    """
    roots = [f"-Wl,-e,{entries[0]}", *(f"-Wl,-u,{entry}" for entry in entries[1:])]
    options = [*FLAGS, *SECTIONS, *flags, "-static", "-Wl,--gc-sections", *roots]
    compiled, chosen = objects(sources, core, compiler, flags), find_compiler(core, compiler)
    called = frozenset().union(*map(elf.undefined_symbols, compiled)).difference(*map(elf.defined_functions, compiled))
    if compiler == "zig" and all(symbol.startswith("__") or symbol in _MEMORY for symbol in called):
        return host_compiler.link(compiled, [*options, "-nostdlib"], "image.elf", chosen, ("-lcompiler_rt",))
    return host_compiler.link(compiled, options, "image.elf", chosen, ("-lm",))


def objects(
    sources: Mapping[str, str], core: str, compiler: str = "zig", flags: Sequence[str] = ()
) -> tuple[Path, ...]:
    """Compile each `.c` of `{filename: text}` to an object of its own, which may include the other files but no `.c`.

    Raises CompileError as `link` does.
    """
    options = [*FLAGS, *SECTIONS, *flags, "-c"]
    chosen = find_compiler(core, compiler)
    units = host_compiler.c_files(sources)
    included = {name: text for name, text in sources.items() if name not in units}
    return tuple(
        host_compiler.build({**included, unit: sources[unit]}, options, f"{unit}.o", chosen, units=[unit])
        for unit in units
    )


def functions(
    sources: Mapping[str, str], core: str, compiler: str = "zig", flags: Sequence[str] = ()
) -> frozenset[str]:
    """Return the names of the functions that the sources define, static ones included.

    Raises CompileError as `link` does.
    """
    return frozenset().union(*(elf.defined_functions(path) for path in objects(sources, core, compiler, flags)))


def double_symbols(sources: Mapping[str, str], compiler: str = "zig", flags: Sequence[str] = ()) -> tuple[str, ...]:
    """Return the symbols of double arithmetic that the sources call on a Cortex-M4F, which has no hardware for it.

    They are the undefined symbols of the unlinked objects that name a run-time function of double arithmetic or
    conversion (`__aeabi_dadd`, `__aeabi_f2d`, `__adddf3`) or a double function of libm (`sin`, and `sinl`, which is
    identical on that core). Two uses of double are not detected: a `sinf` that computes in double internally, as in
    some libraries, and a product that the compiler narrows because the bits are the same, as in `(float)(x * 2.0)`.
    -Wdouble-promotion warns of the latter.

    Raises CompileError as `link` does.
    """
    undefined = frozenset().union(
        *(elf.undefined_symbols(path) for path in objects(sources, "cortex-m4f", compiler, flags))
    )
    return tuple(sorted(s for s in undefined if _DOUBLE_RUNTIME.fullmatch(s) or _DOUBLE_MATH.fullmatch(s)))
