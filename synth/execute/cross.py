"""Cross-compile C for a Cortex-M core, with the clang of the ziglang wheel (musl) or arm-none-eabi-gcc (newlib).

    cortex-m4f    Armv7E-M, FPv4-SP: float in hardware, double in software
    cortex-m7     Armv7E-M, FPv5-D16: float and double in hardware

An image is linked from its entry points alone, without start-up code: what they do not reach is dropped. All products
lie in the cache of `compile`. The first image that zig links for a core also builds musl, in zig's own cache, and does
so again for flags that change how a library is built, such as -O0 or -s.
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
# One section a function, so that the linker can drop each; unwinding tables would keep more than the C needs.
SECTIONS = ("-ffunction-sections", "-fdata-sections", "-fno-unwind-tables", "-fno-asynchronous-unwind-tables")
# Rounding, flush to zero, default NaN, half-precision format, vector length, traps: all that changes a result.
FPSCR_MODES = 0x07FF9F00
# zig by itself asks for checks and frame pointers, which neither clang nor gcc does at -O2.
_ZIG_TARGET = ("-target", "thumb-linux-musleabihf", "-fno-sanitize=undefined", "-fomit-frame-pointer")
# gcc predicates both sides of a short choice, which are fetched either way: branches issue 2 to 6 % fewer instructions.
_GCC_TARGET = ("-mthumb", "-mfloat-abi=hard", "-fno-if-conversion2", "-nostartfiles", "--specs=nosys.specs")

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
    """A processor core: its name, and the flags by which each cross compiler builds for it."""

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
    """Return which of the cross compilers "zig" and "gcc" are installed."""
    found = {"zig": host_compiler.zig_compiler() is not None, "gcc": shutil.which("arm-none-eabi-gcc") is not None}
    return tuple(name for name in found if found[name])


def find_core(name: str) -> Core:
    """Return the core of that name; raise CompileError when there is none."""
    if name not in CORES:
        raise CompileError(f"core: found '{name}', need one of {', '.join(CORES)}: correct the name")
    return CORES[name]


def find_compiler(core: str, name: str) -> host_compiler.Compiler:
    """Return the cross compiler "zig" or "gcc" for a core.

    Raises CompileError when core or compiler is not known or the compiler is not installed.
    """
    chosen = find_core(core)
    if name == "zig" and (zig := host_compiler.zig_compiler()):
        return host_compiler.Compiler(zig.command, zig.identity, (*_ZIG_TARGET, *chosen.zig))
    if name == "gcc" and shutil.which("arm-none-eabi-gcc"):
        flags = (*_GCC_TARGET, *chosen.gcc)
        return host_compiler.identified(("arm-none-eabi-gcc",), "reinstall gcc-arm-none-eabi", flags)
    raise CompileError(
        f"cross compiler: found no '{name}', need 'zig' (pip install ziglang) or 'gcc' (arm-none-eabi-gcc with newlib "
        f"on the PATH); installed: {', '.join(available()) or 'neither'}"
    )


def require_plain_floats(where: str, fpscr: int) -> None:
    """Raise SynthError when a core's FPSCR has left the state after reset, but for the flags of what happened."""
    if fpscr & FPSCR_MODES:
        raise SynthError(
            f"floating point on {where}: FPSCR has the mode bits {fpscr & FPSCR_MODES:#x}, 0 is needed (round to "
            "nearest, no flush to zero): keep the code from changing them"
        )


def link(
    sources: Mapping[str, str], entries: Sequence[str], core: str, compiler: str = "zig", flags: Sequence[str] = ()
) -> Path:
    """Link all `.c` of `{filename: text}` with libm into an image that holds what the functions `entries` reach.

    `flags` follow FLAGS and so override them.

    Raises CompileError when core or compiler is not there, or when it refuses the sources.
    """
    roots = [f"-Wl,-e,{entries[0]}", *(f"-Wl,-u,{entry}" for entry in entries[1:])]
    options = [*FLAGS, *SECTIONS, *flags, "-static", "-Wl,--gc-sections", *roots]
    return host_compiler.build(sources, options, "image.elf", find_compiler(core, compiler), libraries=("-lm",))


def prepare(core: str) -> None:
    """Let zig build its library for a core: most of a minute, the first time on a machine.

    Raises CompileError as `link` does.
    """
    link({"empty.c": "void empty(void);\nvoid empty(void) {}\n"}, ["empty"], core)


def objects(
    sources: Mapping[str, str], core: str, compiler: str = "zig", flags: Sequence[str] = ()
) -> tuple[Path, ...]:
    """Compile each `.c` of `{filename: text}` to an object of its own; raise CompileError as `link` does."""
    options = [*FLAGS, *SECTIONS, *flags, "-c"]
    chosen = find_compiler(core, compiler)
    units = sorted(name for name in sources if name.endswith(".c"))
    return tuple(host_compiler.build(sources, options, f"{unit}.o", chosen, units=[unit]) for unit in units)


def functions(
    sources: Mapping[str, str], core: str, compiler: str = "zig", flags: Sequence[str] = ()
) -> frozenset[str]:
    """Return the names of the functions that the sources define, static ones included.

    Raises CompileError as `link` does.
    """
    return frozenset().union(*(elf.defined(path) for path in objects(sources, core, compiler, flags)))


def double_symbols(sources: Mapping[str, str], compiler: str = "zig", flags: Sequence[str] = ()) -> tuple[str, ...]:
    """Return what the sources call for double arithmetic on a core without it, the Cortex-M4F: none, if all is float.

    These are the undefined symbols of the unlinked objects that name a run-time function of double arithmetic or
    conversion (`__aeabi_dadd`, `__aeabi_f2d`, `__adddf3`) or a double function of libm (`sin`, and `sinl`, which is the
    same there). Not among them: a `sinf` that computes in double inside, as some libraries have it, and a product that
    the compiler narrows since the bits come out the same, as in `(float)(x * 2.0)`; of that -Wdouble-promotion warns.

    Raises CompileError as `link` does.
    """
    found = frozenset().union(*(elf.undefined(path) for path in objects(sources, "cortex-m4f", compiler, flags)))
    return tuple(sorted(s for s in found if _DOUBLE_RUNTIME.fullmatch(s) or _DOUBLE_MATH.fullmatch(s)))
