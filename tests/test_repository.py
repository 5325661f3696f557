"""What is published: texts that know no machine, a wheel that holds synth alone, and pins for every package."""

import re
import shutil
import subprocess
import sys
import tomllib
import zipfile
from collections import Counter
from pathlib import Path

import pytest
from packaging.requirements import Requirement

ROOT = Path(__file__).parents[1]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
PYTHONS = ("3.11.2", "3.12.0", "3.13.3", "3.14.0", "3.15.0")  # the oldest of each served version
MACHINE = re.compile(
    r"(?<![\w.~$}])/(?:home|root|Users|work|tmp|opt|mnt|srv|builds?)/\w"  # a path that one machine has
    r"|\b[A-Za-z]:\\\\?Users\b"
    r"|https?://(?:\d+\.|[\w-]+[:/\s]|[\w.-]+:\d|[\w.-]+\.(?:local|internal|lan|corp|home)\b)"  # a private host
    r"|\b[\w-]+\.(?:internal|corp|lan)\b"
    r"|--(?:index-url|extra-index-url|find-links|trusted-host)\b"
)


def published_texts() -> dict[str, str]:
    """Return {path: text} of every file that git tracks or would track, without those that hold binary data."""
    files = {name: ROOT / name for name in published_names()}
    data = {name: file.read_bytes() for name, file in files.items() if file.is_file()}
    return {name: content.decode("utf-8", errors="replace") for name, content in data.items() if b"\0" not in content}


def published_names() -> list[str]:
    command = ["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"]
    try:
        listed = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True).stdout
    except (OSError, subprocess.CalledProcessError):  # no git, or an unpacked archive: take the folders of the layout
        tops = [
            ROOT / name for name in ("synth", "models", "designs", "studies", "generated_c", "tests", "docs", ".ci")
        ]
        files = [*ROOT.glob("*.*"), ROOT / "Makefile", *(file for top in tops for file in top.rglob("*"))]
        return [file.relative_to(ROOT).as_posix() for file in files if "__pycache__" not in file.parts]
    return [name for name in listed.split("\0") if name]


def machine_traces(texts: dict[str, str]) -> list[str]:
    return [
        f"{name}:{number}: {line.strip()[:100]}"
        for name, text in texts.items()
        if name != "tests/test_repository.py"  # holds the planted ones
        for number, line in enumerate(text.splitlines(), 1)
        if MACHINE.search(line)
    ]


def unpinned(constraints: str, requirements: list[str]) -> list[str]:
    """Return the lines that are no `name==version`, and the required names without exactly one on each Python."""
    lines = [line for line in constraints.splitlines() if line and not line.startswith("#")]
    loose = [line for line in lines if not re.fullmatch(r"[A-Za-z0-9._-]+==[\w.+!]+( ; .+)?", line)]
    pins = [Requirement(line) for line in lines if line not in loose]
    for python in PYTHONS:
        machine = {"python_full_version": python, "python_version": python.rpartition(".")[0], "sys_platform": "linux"}
        here = Counter(normal(p.name) for p in pins if p.marker is None or p.marker.evaluate(machine))
        loose += [f"{name} on Python {python}" for name in map(normal, requirements) if here[name] != 1]
    return loose


def normal(name: str) -> str:
    return re.sub(r"[-_.]+", "-", re.split(r"[\s<>=!~\[;]", name)[0]).lower()


def wheel_names(tree: Path, out: Path) -> set[str]:
    """Build the wheel of a source tree with the installed backend, without a network, and list its files."""
    build = "import sys; from setuptools import build_meta; print(build_meta.build_wheel(sys.argv[1]))"
    subprocess.run([sys.executable, "-c", build, str(out)], cwd=tree, capture_output=True, text=True, check=True)
    return set(zipfile.ZipFile(next(out.glob("*.whl"))).namelist())


def source_tree(tree: Path) -> Path:
    for name in ("pyproject.toml", "README.md", "LICENSE"):
        shutil.copy(ROOT / name, tree)
    shutil.copytree(ROOT / "synth", tree / "synth", ignore=shutil.ignore_patterns("__pycache__"))
    for name in ("models", "designs", "studies", "tests"):
        (tree / name).mkdir()
        (tree / name / "__init__.py").touch()
    return tree


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> set[str]:
    return wheel_names(source_tree(tmp_path_factory.mktemp("tree")), tmp_path_factory.mktemp("out"))


def test_texts_know_no_machine() -> None:
    texts = published_texts()
    assert {"pyproject.toml", "synth/errors.py"} <= set(texts)
    assert not machine_traces(texts)


@pytest.mark.parametrize(
    "line",
    [
        "data = open('/home/ann/field.csv')",
        "cache: /tmp/x1",
        "include C:\\Users\\ann\\gcc",
        "see http://buildbox/log",
        "http://10.0.0.3/simple",
        "mirror.corp is down",
        "--extra-index-url https://pypi.example.org/simple",
    ],
)
def test_a_planted_trace_is_found(line: str) -> None:
    assert machine_traces({"README.md": f"first\n{line}\n"})[0].startswith("README.md:2")


@pytest.mark.parametrize("line", ["#!/usr/bin/env bash", "https://doi.org/10.1109/TMECH", "~/.cache/synth", "a/work/b"])
def test_public_addresses_and_relative_paths_pass(line: str) -> None:
    assert not machine_traces({"README.md": line})


def tops(wheel: set[str]) -> set[str]:
    return {name.split("/")[0] for name in wheel}


@pytest.mark.slow
def test_the_wheel_holds_synth_alone(wheel: set[str]) -> None:
    assert tops(wheel) == {"synth", "synth_stage-0.1.0.dist-info"}


def test_a_wheel_that_holds_more_is_found(tmp_path: Path) -> None:
    project = source_tree(tmp_path) / "pyproject.toml"
    project.write_text(project.read_text().replace('include = ["synth", ', 'include = ["models", "synth", '))
    assert "models" in tops(wheel_names(tmp_path, tmp_path / "out"))


@pytest.mark.slow
def test_the_wheel_holds_all_of_synth(wheel: set[str]) -> None:
    files = [file for file in (ROOT / "synth").rglob("*") if file.is_file() and "__pycache__" not in file.parts]
    assert {file.relative_to(ROOT).as_posix() for file in files} == {n for n in wheel if n.startswith("synth/")}
    assert "synth_stage-0.1.0.dist-info/licenses/LICENSE" in wheel


def test_every_package_is_pinned() -> None:
    extras = PROJECT["optional-dependencies"]
    assert not unpinned((ROOT / "constraints.txt").read_text(), sum(extras.values(), PROJECT["dependencies"]))


def test_a_missing_or_loose_pin_is_found() -> None:
    loose = unpinned("# note\nnumpy==2.0\nscipy>=1.0\n", ["numpy>=2", "python-flint"])
    assert loose == ["scipy>=1.0", *(f"python-flint on Python {python}" for python in PYTHONS)]


def test_a_pin_that_some_python_lacks_or_has_twice_is_found() -> None:
    pins = "numpy==2.4 ; python_full_version < '3.12'\nnumpy==2.5 ; python_full_version >= '3.12'\n"
    assert not unpinned(pins, ["numpy"])
    assert unpinned(pins.replace(">=", ">"), ["numpy"]) == ["numpy on Python 3.12.0"]
    assert unpinned(pins + "numpy==2.6 ; python_full_version >= '3.15'\n", ["numpy"]) == ["numpy on Python 3.15.0"]


def test_the_served_pythons_are_named_alike() -> None:
    oldest, newest = PYTHONS[0].replace(".", ", "), PYTHONS[-1].replace(".0", "").replace(".", ", ")
    assert f"OLDEST, NEWEST = ({oldest}), ({newest})" in (ROOT / ".ci/served.py").read_text(encoding="utf-8")
    assert PROJECT["requires-python"] == f">={PYTHONS[0]},!=3.13.0,!=3.13.1,!=3.13.2"
    assert f"pythons=({' '.join(PYTHONS)})" in (ROOT / ".ci/constraints").read_text(encoding="utf-8")


def test_the_version_stands_once() -> None:
    assert f'__version__ = "{PROJECT["version"]}"' in (ROOT / "synth/__init__.py").read_text()
