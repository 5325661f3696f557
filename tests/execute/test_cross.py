"""Cross-compiled code is for the named core, contains only reachable functions, and reveals double arithmetic."""

import shutil
from pathlib import Path

import pytest

from synth.errors import CompileError, SynthError
from synth.execute import compile as host_compiler
from synth.execute import cross, elf
from tests import tools

SUM = "float f(float x, float y);\nfloat f(float x, float y) { return %s; }\n"
MATH = "#include <math.h>\n" + SUM


@pytest.mark.parametrize("compiler", tools.CROSS_COMPILERS)
@pytest.mark.parametrize(
    ("text", "symbols"),
    [
        (SUM % "(float)(x * 2.0 + y)", {"__aeabi_f2d", "__aeabi_dadd", "__aeabi_d2f"}),
        (SUM % "(float)(x * 0.1)", {"__aeabi_f2d", "__aeabi_dmul", "__aeabi_d2f"}),
        (MATH % "(float)sin(x)", {"__aeabi_f2d", "sin", "__aeabi_d2f"}),
        (SUM % "x > 0.1 ? x : y", {"__aeabi_f2d", "__aeabi_dcmpgt"}),
        ("double f(int x);\ndouble f(int x) { return x; }\n", {"__aeabi_i2d"}),
        ("#include <math.h>\ndouble f(double x);\ndouble f(double x) { return sqrt(x); }\n", {"sqrt"}),
    ],
)
def test_double_arithmetic_is_detected(text: str, symbols: set[str], compiler: str) -> None:
    assert set(cross.double_symbols({"f.c": text}, compiler)) == symbols


@pytest.mark.parametrize("compiler", tools.CROSS_COMPILERS)
def test_single_precision_has_none(compiler: str) -> None:
    singles = "sinf(x) + sqrtf(fabsf(y)) * 2.0f + logf(x) + atan2f(x, y) + (float)(long long)x"
    texts = {"f.c": MATH % singles, "g.c": "unsigned g(unsigned x);\nunsigned g(unsigned x) { return x / 7u; }\n"}
    assert cross.double_symbols(texts, compiler) == ()


def test_a_product_narrowed_without_a_trace_is_a_warning() -> None:
    """Twice a float has the same bits in either precision, so a compiler may narrow it; -Wdouble-promotion warns."""
    text = SUM % "(float)(x * 2.0) + y"
    assert cross.double_symbols({"f.c": text}) == ()
    with pytest.raises(CompileError, match="double-promotion"):
        host_compiler.check({"f.c": text})


@pytest.mark.parametrize(
    ("name", "double"),
    [
        *(
            (n, True)
            for n in ("__adddf3", "__extendsfdf2", "__aeabi_cdcmple", "__aeabi_ui2d", "__muldc3", "lround", "erfc")
        ),
        *(
            (n, False)
            for n in ("__addsf3", "__aeabi_fadd", "__aeabi_i2f", "__floatdisf", "sinf", "lroundf", "memcpy", "f")
        ),
    ],
)
def test_names_of_double_arithmetic(name: str, double: bool) -> None:
    text = f"int {name}();\nint caller(void);\nint caller(void) {{ return {name}(); }}\n"
    flags = ("-fno-builtin", "-w")
    assert cross.double_symbols({"f.c": text}, flags=flags) == ((name,) if double else ())


@pytest.mark.parametrize("compiler", tools.CROSS_COMPILERS)
@pytest.mark.parametrize(("core", "in_hardware"), [("cortex-m4f", False), ("cortex-m7", True)])
def test_the_core_decides_what_is_hardware(core: str, in_hardware: bool, compiler: str) -> None:
    text = "double f(double x, double y);\ndouble f(double x, double y) { return x * y; }\n"
    needed = set().union(*(elf.undefined_symbols(path) for path in cross.objects({"f.c": text}, core, compiler)))
    assert ("__aeabi_dmul" in needed) is not in_hardware
    # Neither core falls back to software for a float.
    single = {"f.c": SUM % "x * y"}
    assert not any(
        n.startswith("__aeabi_f") for p in cross.objects(single, core, compiler) for n in elf.undefined_symbols(p)
    )


@pytest.mark.parametrize("compiler", tools.CROSS_COMPILERS)
def test_an_image_contains_only_reachable_functions(compiler: str) -> None:
    text = """#include <math.h>
    float reached(float x); float unreached(float x); float entry(float x);
    float __attribute__((noinline)) reached(float x) { return tanhf(x); }
    float unreached(float x) { return cbrtf(x); }
    float entry(float x) { return 2.0f * reached(x); }
    """
    program = elf.read(cross.link({"f.c": text}, ["entry"], "cortex-m4f", compiler))
    names = {function.name for function in program.functions}
    assert {"entry", "reached", "tanhf"} <= names and not {"unreached", "cbrtf", "main", "_start"} & names
    assert cross.functions({"f.c": text}, "cortex-m4f", compiler) == {"entry", "reached", "unreached"}
    with pytest.raises(CompileError, match="no function 'absent'"):
        program.address("absent")


def test_products_are_cached_by_their_inputs() -> None:
    plain = cross.link({"f.c": SUM % "x * y"}, ["f"], "cortex-m4f")
    built = plain.stat().st_mtime_ns
    assert cross.link({"f.c": SUM % "x * y"}, ["f"], "cortex-m4f") == plain and plain.stat().st_mtime_ns == built
    others = [
        cross.link({"f.c": SUM % "x * y"}, ["f"], "cortex-m4f", flags=["-DUNUSED"]),
        cross.link({"f.c": SUM % "x * y"}, ["f"], "cortex-m7"),
        cross.link({"f.c": SUM % "x + y"}, ["f"], "cortex-m4f"),
    ]
    assert len({plain, *others}) == 4
    assert code_of(others[0]) == code_of(plain) != code_of(others[2])


@pytest.mark.parametrize("compiler", tools.CROSS_COMPILERS)
def test_later_flags_override(compiler: str) -> None:
    sources = {"f.c": "int f(void);\nint f(void) { typeof(1) x = 2; return x; }\n"}
    with pytest.raises(CompileError, match="typeof"):  # no keyword of C99
        cross.objects(sources, "cortex-m4f", compiler)
    assert cross.objects(sources, "cortex-m4f", compiler, ["-std=gnu11"])


def code_of(path: Path) -> bytes:
    return b"".join(region.content for region in elf.read(path).regions)


def test_a_refused_source_says_why() -> None:
    with pytest.raises(CompileError, match=r"(?s)f\.c:1.*undeclared"):
        cross.link({"f.c": "int f(void) { return nothing; }\n"}, ["f"], "cortex-m4f")


def test_unknown_cores_and_absent_compilers_are_named(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    with pytest.raises(CompileError, match=r"core: found 'cortex-m3', need one of cortex-m4f, cortex-m7"):
        cross.find_compiler("cortex-m3", "zig")
    with pytest.raises(CompileError, match="found no 'clang'"):
        cross.find_compiler("cortex-m4f", "clang")
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(CompileError, match=r"found no 'gcc'.*installed: zig"):
        cross.find_compiler("cortex-m4f", "gcc")


def test_a_c_library_is_built_where_a_function_calls_it(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """It takes most of a minute: an image that calls none of its functions but memset gets none."""
    monkeypatch.setenv("SYNTH_CACHE", str(tmp_path))
    monkeypatch.setenv("ZIG_GLOBAL_CACHE_DIR", str(tmp_path / "zig"))
    clear = "#include <string.h>\nvoid g(char *x, unsigned n);\nvoid g(char *x, unsigned n) { memset(x, 0, n); }\n"
    sources = {"f.c": SUM % "x + y * (float)(2.0 * x)", "g.c": clear}
    assert elf.read(cross.link(sources, ["f"], "cortex-m7")).size().code < 48
    assert elf.read(cross.link(sources, ["f", "g"], "cortex-m4f")).size().code > 200
    assert not list((tmp_path / "zig").rglob("libc.a"))


def test_installed_compilers() -> None:
    assert cross.available() == (("zig", "gcc") if shutil.which("arm-none-eabi-gcc") else ("zig",))


@pytest.mark.parametrize("mode", [1 << 24, 1 << 25, 1 << 22, 1 << 23, 1 << 26])
def test_changed_float_modes_are_refused(mode: int) -> None:
    cross.require_plain_floats("a core", 0xF800009F)  # conditions and what has happened: no modes
    with pytest.raises(SynthError, match=f"mode bits {mode:#x}"):
        cross.require_plain_floats("a core", 0x60000010 | mode)
