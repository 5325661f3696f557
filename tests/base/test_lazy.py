"""The exported names: each is in its package's table of contents, as the stub says, and costs nothing before use."""

import importlib
import re
import subprocess
import sys
from pathlib import Path

import pytest

import synth
from synth import analyse, synthesise
from synth.base import lazy

PACKAGES = (synth, analyse, synthesise)


def contents(documentation: str) -> set[str]:
    """Return the names at the heads of the indented lines of a docstring."""
    lines = re.findall(r"^    (\w[\w, ]*?)(?:\(| {2,})", documentation, re.MULTILINE)
    return {name.strip() for line in lines for name in line.split(",")}


@pytest.mark.parametrize("package", PACKAGES, ids=lambda p: p.__name__)
def test_the_docstring_is_a_table_of_contents(package: object) -> None:
    assert contents(package.__doc__ or "") == set(package.__all__)  # type: ignore[attr-defined]


@pytest.mark.parametrize("package", PACKAGES, ids=lambda p: p.__name__)
def test_every_exported_name_is_there_and_hides_no_module(package: object) -> None:
    path = Path(package.__file__ or "").parent  # type: ignore[attr-defined]
    for name in package.__all__:  # type: ignore[attr-defined]
        assert getattr(package, name) is not None and name in dir(package)
        is_package = hasattr(getattr(package, name), "__path__")
        assert is_package or (not (path / f"{name}.py").exists() and not (path / name).is_dir())


def test_an_unknown_name_is_refused_with_the_known_ones() -> None:
    with pytest.raises(AttributeError, match=r"'synth.analyse' has no attribute 'margin'.*margins"):
        analyse.margin  # type: ignore[attr-defined]  # noqa: B018


def test_a_stub_of_one_name_exports_it(tmp_path: Path) -> None:
    (tmp_path / "package.pyi").write_text("from math import hypot as length\n")
    sys.modules["package_of_one"] = module = type(sys)("package_of_one")
    try:
        get, names, exported = lazy.exports("package_of_one", str(tmp_path / "package.py"))
        assert exported == ["length"] and "length" in names()
        assert get("length") is importlib.import_module("math").hypot and module.length is get("length")
    finally:
        del sys.modules["package_of_one"]


def test_the_packages_load_nothing_heavy() -> None:
    script = "import sys, synth, synth.analyse, synth.synthesise; print(*sys.modules)"
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    assert not {"numpy", "scipy", "casadi", "control", "matplotlib", "sympy"} & set(done.stdout.split())


def test_a_study_loads_its_statistics_once_it_needs_them() -> None:
    script = "import sys, synth.app.study_command; print(*sys.modules)"
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    assert "synth.simulate.study" in done.stdout.split() and "scipy.stats" not in done.stdout.split()
