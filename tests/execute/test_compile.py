"""Compiled code must correspond to its source, and a refused source must give the reason."""

import ctypes
import shlex
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest

from synth.base import store
from synth.errors import CompileError, SynthError
from synth.execute import compile as host
from tests import tools

HEADER = {"gain.h": "#define GAIN 3.0\ndouble amplify(double u);\n"}
AMPLIFY = HEADER | {"amplify.c": '#include "gain.h"\ndouble amplify(double u) { return GAIN * u; }\n'}
SEVERAL = AMPLIFY | {
    "root.c": '#include <math.h>\n#include "gain.h"\ndouble root(double u);\n'
    "double root(double u) { return sqrt(amplify(u)); }\n"
}
# (1 + e)(1 - e) - 1 is -e^2 when contracted and 0 when the product is rounded first, for e = 2^-30.
RESIDUE = {
    "residue.c": "double residue(double a, double b);\ndouble residue(double a, double b) { return a * b - 1.0; }\n"
}
CPU = Path("/proc/cpuinfo")
needs_fma = pytest.mark.skipif(
    not CPU.exists() or "fma" not in CPU.read_text().split(), reason="the processor has no fused multiply-add by -mfma"
)


@pytest.fixture(autouse=True)
def cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("SYNTH_CACHE", str(tmp_path / "cache"))
    monkeypatch.delenv("CC", raising=False)
    return tmp_path / "cache"


@pytest.fixture(scope="module", params=tools.HOST_COMPILERS)
def compiler(request: pytest.FixtureRequest) -> host.Compiler:
    return tools.host_compiler(request.param)


def call(library: Path, name: str, *arguments: float) -> float:
    function = getattr(ctypes.CDLL(str(library)), name)
    function.restype, function.argtypes = ctypes.c_double, [ctypes.c_double] * len(arguments)
    return function(*arguments)


def test_several_units_become_one_library(compiler: host.Compiler) -> None:
    library = host.shared_library(SEVERAL, ("-Wl,--no-undefined",), compiler)
    assert call(library, "root", 12.0) == 6.0


@needs_fma
def test_products_are_rounded_before_they_are_added(compiler: host.Compiler) -> None:
    e = 2.0**-30
    assert call(host.shared_library(RESIDUE, ("-mfma",), compiler), "residue", 1 + e, 1 - e) == 0.0


@needs_fma
def test_code_runs_on_every_processor_of_the_architecture(compiler: host.Compiler) -> None:
    e = 2.0**-30
    assert call(host.shared_library(RESIDUE, ("-ffp-contract=fast",), compiler), "residue", 1 + e, 1 - e) == 0.0


@needs_fma
def test_a_later_flag_overrides_and_is_another_library() -> None:
    e = 2.0**-30
    plain, fused = host.shared_library(RESIDUE), host.shared_library(RESIDUE, ("-ffp-contract=fast", "-mfma"))
    assert plain != fused
    assert call(fused, "residue", 1 + e, 1 - e) == -(e**2)


def test_the_cache_is_used_and_never_stale(compiler: host.Compiler) -> None:
    library = host.shared_library(AMPLIFY, compiler=compiler)
    built = library.stat().st_mtime_ns
    assert host.shared_library(dict(reversed(AMPLIFY.items())), compiler=compiler) == library
    assert library.stat().st_mtime_ns == built
    changed = host.shared_library(AMPLIFY | {"gain.h": HEADER["gain.h"].replace("3.0", "5.0")}, compiler=compiler)
    assert (call(library, "amplify", 2.0), call(changed, "amplify", 2.0)) == (6.0, 10.0)


def test_the_key_tells_names_texts_flags_and_compilers_apart() -> None:
    first = host.Compiler(("cc",), "cc 1")
    kinds = [
        host._key(*arguments)
        for arguments in (
            ({"a.c": "bc"}, (), first),
            ({"b.c": "bc"}, (), first),
            ({"a.cb": "c"}, (), first),
            ({"a.c": "bc"}, ("-g",), first),
            ({"a.c": "bc"}, (), host.Compiler(("cc",), "cc 2")),
            ({"a.c": "bc"}, (), host.Compiler(("gcc",), "cc 1")),
        )
    ]
    assert len(set(kinds)) == len(kinds)


def test_builders_at_the_same_time_agree_and_leave_nothing_behind(cache: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    compiler = host.find_compiler()
    # The usual place for temporary files may be another disk, from which no file moves whole.
    monkeypatch.setattr(tempfile, "tempdir", str(cache / "absent"))
    with ThreadPoolExecutor(4) as pool:
        libraries = set(pool.map(lambda _: host.shared_library(AMPLIFY, compiler=compiler), range(8)))
    assert len(libraries) == 1 and call(libraries.pop(), "amplify", 1.0) == 3.0
    assert not list(cache.glob("building-*"))


def test_a_refused_source_leaves_no_library_and_says_why(cache: Path, compiler: host.Compiler) -> None:
    with pytest.raises(CompileError, match=r"(?s)-std=c99.*bad\.c:1.*undeclared"):
        host.shared_library({"bad.c": "int f(void) { return nothing; }\n"}, compiler=compiler)
    assert not list(cache.rglob("*.so")) and not list(cache.glob("building-*"))


@pytest.mark.parametrize(
    ("text", "warning"),
    [
        ("float f(float u);\nfloat f(float u) { return (float)(u * 2.0); }\n", "double-promotion"),
        ("int f(double u);\nint f(double u) { return u; }\n", "conversion"),
        ("int f(int u);\nint f(int u) { { int u = 1; (void)u; } return u; }\n", "shadow"),
        ("int f(int u);\nint f(int u) { return 0; }\n", "unused"),
        ("int f(void);\nint f(void) { return 0; };\n", "pedantic|extra-semi"),
    ],
)
def test_every_warning_is_an_error(text: str, warning: str, compiler: host.Compiler) -> None:
    with pytest.raises(CompileError, match=warning):
        host.check({"f.c": text}, compiler=compiler)


def test_clean_sources_pass_the_check(compiler: host.Compiler) -> None:
    host.check(SEVERAL, compiler=compiler)


@pytest.mark.parametrize("sources", [{}, HEADER, {"../a.c": ""}, {"sub/a.c": ""}, {"-o.c": ""}])
def test_names_that_cannot_be_compiled_are_refused(sources: dict[str, str]) -> None:
    with pytest.raises(CompileError, match="C source: found"):
        host.shared_library(sources)


def test_cc_comes_first_then_cc_then_zig(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("CC", shlex.quote(sys.executable) + " -m ziglang cc")
    assert host.find_compiler().command == (sys.executable, "-m", "ziglang", "cc")
    monkeypatch.delenv("CC")
    monkeypatch.setenv("PATH", str(tmp_path))
    assert host.find_compiler() == host.zig_compiler()


def test_a_compiler_that_cannot_start_says_why(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """Zig needs a folder for its cache; that one is a file."""
    (tmp_path / "file").write_text("")
    monkeypatch.setenv("ZIG_GLOBAL_CACHE_DIR", str(tmp_path / "file"))
    with pytest.raises(CompileError, match=r"(?s)status 1, 0 is needed.*set SYNTH_CACHE.*wheel.*`\n.*error"):
        host.zig_compiler()


@pytest.mark.parametrize("command", ["no-such-compiler", "false"])
def test_a_wrong_cc_is_named(command: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("CC", command)
    with pytest.raises(CompileError, match=f"{command} --version.*unset"):
        host.find_compiler()


def test_the_cache_follows_the_environment(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.delenv("SYNTH_CACHE")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    assert store.folder() == tmp_path / "synth"
    monkeypatch.setenv("XDG_CACHE_HOME", "")
    monkeypatch.setenv("HOME", str(tmp_path / "home"))
    assert store.folder() == tmp_path / "home" / ".cache" / "synth"


def test_without_a_home_zig_has_a_cache_and_a_missing_one_is_named(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    for name in ("HOME", "XDG_CACHE_HOME", "ZIG_GLOBAL_CACHE_DIR"):
        monkeypatch.delenv(name, raising=False)
    assert host.zig_compiler().identity and (tmp_path / "cache" / "zig").is_dir()
    monkeypatch.delenv("SYNTH_CACHE")

    def unknown() -> Path:
        raise RuntimeError("Could not determine home directory.")  # as of a user without an entry in the password file

    monkeypatch.setattr(Path, "home", unknown)
    with pytest.raises(SynthError, match=r"cache: HOME is not set.*set SYNTH_CACHE"):
        host.zig_compiler()


def test_a_cache_that_cannot_be_written_is_named(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    monkeypatch.setenv("SYNTH_CACHE", str(tmp_path / "file" / "cache"))
    with pytest.raises(CompileError, match="set SYNTH_CACHE"):
        host.shared_library(AMPLIFY)
