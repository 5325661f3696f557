"""The cache finds what has not changed and nothing else: a change in each kind of dependency is planted.

Workspaces are folders of their own, read by processes of their own, as users' are.
"""

import json
import os
import signal
import subprocess
import sys
import textwrap
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from multiprocessing import get_context
from pathlib import Path
from typing import Any

import casadi as ca
import numpy as np
import pytest

from benchmarks import axes
from synth.base import cache, contents, slices, store
from synth.emit import pipeline, write
from synth.errors import ContentError
from synth.execute import compile as host_compiler

pytestmark = pytest.mark.slow

ROOT = Path(__file__).parents[2]
FILES = {
    "models/stage.py": '''
        """A stage."""
        MASS = 2.0
        OTHER = 3.0
        def force(a):
            return MASS * a
        def unused(a):
            return a
        ''',
    "designs/lift/__init__.py": "",
    "designs/lift/reference.py": """
        def step(x):
            return 2.0 * x
        """,
    "designs/lift/control.py": """
        from models import stage
        GAIN = 3.0
        TABLE = {"a": 1.0}
        TABLE["b"] = 2.0
        def law(x):
            return GAIN * stage.force(x)
        """,
    "designs/lift/page.py": """
        def report():
            return "page"
        """,
    "designs/lift/design.py": """
        from designs.lift import control, page
        def verify(x):
            from designs.lift import reference
            return control.law(x) - reference.step(x)
        def report():
            return page.report()
        """,
    "designs/lift/limits.toml": "limit = 1.0",
}
KEYS = """
import json, sys
sys.path.insert(0, sys.argv[1])
from designs.lift import design
from synth.base import cache
print(json.dumps({f.__name__: cache.key(f, data=True) for f in (design.verify, design.report)}))
"""


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("SYNTH_CACHE", str(tmp_path / "cache"))
    monkeypatch.delenv(store.FRESH, raising=False)
    return tmp_path / "cache"


@pytest.fixture
def workspace(tmp_path: Path) -> Path:
    for name, text in FILES.items():
        path = tmp_path / "workspace" / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(textwrap.dedent(text))
    return tmp_path / "workspace"


def keys(root: Path, **environment: str) -> dict[str, str]:
    """Return the keys of both tasks, as another process sees them."""
    around = {**os.environ, "PYTHONPATH": str(ROOT), "PYTHONDONTWRITEBYTECODE": "1", **environment}
    command = [sys.executable, "-c", KEYS, str(root)]
    return dict(json.loads(subprocess.run(command, env=around, capture_output=True, text=True, check=True).stdout))


@pytest.mark.parametrize(
    ("name", "old", "new", "missed"),
    [
        ("models/stage.py", "2.0", "2.5", {"verify"}),
        ("designs/lift/reference.py", "2.0", "2.5", {"verify"}),  # imported inside the function
        ("designs/lift/control.py", "GAIN = 3.0", "GAIN = 4.0", {"verify"}),
        ("designs/lift/control.py", '["b"] = 2.0', '["b"] = 2.5', {"verify", "report"}),  # runs when it is imported
        ("designs/lift/page.py", '"page"', '"other"', {"report"}),
        ("designs/lift/limits.toml", "1.0", "2.0", {"verify", "report"}),
        ("models/stage.py", "OTHER = 3.0", "OTHER = 4.0", set()),
        ("models/stage.py", "return a\n", "return -a\n", set()),
        ("designs/lift/control.py", "GAIN = 3.0", "# of the loop\nGAIN = 3.0", set()),
    ],
)
def test_a_planted_change_is_missed_by_what_depends_on_it(
    workspace: Path, name: str, old: str, new: str, missed: set[str]
) -> None:
    before = keys(workspace)
    path = workspace / name
    assert old in path.read_text()
    path.write_text(path.read_text().replace(old, new))
    after = keys(workspace)
    assert {task for task in before if before[task] != after[task]} == missed


def test_another_kernel_of_linear_algebra_is_another_key(workspace: Path) -> None:
    before, after = (keys(workspace, OPENBLAS_CORETYPE=kernel) for kernel in ("Nehalem", "Prescott"))
    assert all(before[task] != after[task] for task in before)


def test_the_same_is_the_same_in_another_process(workspace: Path) -> None:
    assert keys(workspace, PYTHONHASHSEED="1") == keys(workspace, PYTHONHASHSEED="2")


@dataclass
class Installed:
    """A package that is installed."""

    name: str
    version: str
    requires: Sequence[str] = ()


def environment_of(packages: Sequence[Installed], monkeypatch: pytest.MonkeyPatch) -> str:
    with monkeypatch.context() as patched:
        patched.setattr("importlib.metadata.distributions", lambda: packages)
        cache.environment.cache_clear()
        digest = cache.environment()
    cache.environment.cache_clear()
    return digest


def test_a_package_of_another_version_is_another_key(monkeypatch: pytest.MonkeyPatch) -> None:
    keys = [environment_of([Installed("numpy", version)], monkeypatch) for version in ("2.0", "2.1")]
    assert len({*keys, cache.environment()}) == 3


def test_packages_that_only_tests_of_the_toolkit_need_do_not_count(monkeypatch: pytest.MonkeyPatch) -> None:
    """What a workspace has installed for itself counts, though the toolkit does not require it."""
    toolkit = Installed(
        "synth-stage", "1", ['A_one>=2; python_version > "3"', "b[c]", 'b; extra == "dev"', 'd; extra == "dev"']
    )
    needed = [toolkit, Installed("a.One", "1", ["e"]), Installed("b", "1"), Installed("E", "1")]
    tests = [Installed("d", "1", ["f (>=1)"]), Installed("f", "1", ["e"])]
    plain = environment_of(needed, monkeypatch)
    assert environment_of([*needed, *tests], monkeypatch) == plain
    for package in needed:
        later = [replace(p, version="2") if p is package else p for p in needed]
        assert environment_of([*later, *tests], monkeypatch) != plain
    assert environment_of([*needed, Installed("own", "1")], monkeypatch) != plain


def test_another_compiler_is_another_key(monkeypatch: pytest.MonkeyPatch) -> None:
    from synth.app import tasks

    task = tasks.Task("planted", lambda say: 1.0, (times,))
    before = task.key()
    assert task.key() == before
    monkeypatch.setattr(tasks, "compilers", lambda: [("cc", "cc (of another version)")])
    assert task.key() != before


def test_the_toolkit_itself_counts(monkeypatch: pytest.MonkeyPatch) -> None:
    """A constant of the surrogates' search that is set otherwise, and another function in the place of one."""
    from synth.emit.approx import polynomial, surrogate
    from synth.emit.passes import surrogates

    before = slices.digest(surrogates._fit)
    monkeypatch.setattr(surrogate, "TRIALS", 2)
    assert slices.digest(surrogates._fit) != before
    monkeypatch.undo()
    assert slices.digest(surrogates._fit) == before
    monkeypatch.setattr(polynomial, "fit", lambda *a: None)
    with pytest.raises(ContentError, match=r"in place of synth\.emit\.approx\.polynomial\.fit"):
        slices.digest(surrogates._fit)


def test_what_is_set_inside_a_constant_counts(monkeypatch: pytest.MonkeyPatch) -> None:
    """The same dictionary with another number in it, and a list in a tuple: only what cannot change is read once."""
    from synth.emit.approx import surrogate
    from synth.emit.passes import surrogates

    before = slices.digest(surrogates._fit)
    monkeypatch.setitem(surrogate.EPS, np.float32, 1e-7)
    assert slices.digest(surrogates._fit) != before
    monkeypatch.undo()
    assert slices.digest(surrogates._fit) == before
    sizes = (64, [1024])
    monkeypatch.setattr(surrogate, "SAMPLES", sizes)
    other = slices.digest(surrogates._fit)
    sizes[1].append(1)
    assert len({before, other, slices.digest(surrogates._fit)}) == 3


def test_a_slice_holds_what_runs_and_little_else() -> None:
    from synth.analyse.loops import stability_margins

    modules = {module for module, _ in slices._places(slices._entry(stability_margins.of_loop))}
    assert {"synth.analyse.loops.crossings", "synth.analyse.loops.zpk", "synth.statespace"} <= modules
    assert not any(module.startswith(("synth.emit", "synth.report", "synth.synthesise")) for module in modules)


def design_loop(plant: Any) -> Any:
    import synth
    from synth import analyse, synthesise

    return synth.analyse.margins(synthesise.lqr(analyse.c2d(plant, 1e-3), [1.0], [1.0]))


def test_a_name_that_a_package_imports_once_it_is_used_is_followed() -> None:
    """Left out, a change of `lqr` would not be seen by a design that calls it as `synthesise.lqr`."""
    places = slices._places(slices._entry(design_loop))
    assert ("synth.synthesise.feedback.lqr", "lqr") in places
    assert ("synth.analyse.discretise", "zero_order_hold") in places
    assert ("synth.analyse.loops.stability_margins", "of_loop") in places
    assert ("synth.synthesise.observers.kalman", "kalman") not in places and ("synth.analyse", "*") not in places


def test_every_function_that_runs_is_in_the_slice() -> None:
    """What was called while a loop's margins were computed, against what the syntax trees say may be."""
    from synth.analyse.loops import stability_margins
    from synth.statespace import StateSpace
    from synth.timing import Discrete

    called = set()

    def trace(frame: object, event: str, argument: object) -> None:
        if event == "call":
            code, name = frame.f_code, frame.f_globals.get("__name__", "")  # type: ignore[attr-defined]
            top = code.co_qualname.split(".")[0]
            # A lambda has its text in its statement; the constructor of a dataclass has none.
            if name.startswith("synth.") and top not in ("<lambda>", "__create_fn__"):
                called.add((name, top))

    names = ("x",), ("u",), ("y",)
    loop = StateSpace(np.array([[0.9]]), np.array([[0.1]]), np.array([[1.0]]), np.zeros((1, 1)), *names, Discrete(1e-3))
    sys.setprofile(trace)
    try:
        inner = stability_margins.of_loop.__wrapped__.__wrapped__  # type: ignore[attr-defined]
        inner(loop)
    finally:
        sys.setprofile(None)
    assert called and called <= slices._places(slices._entry(stability_margins.of_loop))


def times(x: float, k: float = 2.0) -> float:
    return k * x


def closed(k: float) -> Callable[[float], float]:
    return lambda x: k * x


SX = ca.SX.sym
UNLIKE = (
    1, 1.0, True, None, "1", b"1", (1,), [1], {"a": 1}, {"b": 1}, {1, 2}, np.float32(1), np.float64(1),
    np.zeros(2), np.zeros(3), np.zeros((2, 1)), -0.0, 0.0, float("nan"), times, closed, closed(1.0), closed(2.0),
    np.float32, float, SX("x"), SX("y"), ca.sin(SX("x")), ca.Function("f", [], []),
)  # fmt: skip


def test_unlike_values_have_unlike_digests() -> None:
    assert len({contents.digest(v) for v in UNLIKE}) == len(UNLIKE)


def test_lambdas_of_one_function_have_unlike_digests() -> None:
    pairs = [lambda x: 2 * x, lambda x: 3 * x, lambda x: x in {1, 2}, lambda x: x in {1, 3}, lambda x: (lambda: x)()]
    assert len({contents.digest(f) for f in pairs}) == len(pairs)


def test_a_symbol_in_two_expressions_is_one() -> None:
    x, other, y = SX("x"), SX("x"), SX("y")
    assert contents.digest([x, x + y]) == contents.digest([other, other + y])
    assert contents.digest([x, x + y]) != contents.digest([x, other + y])


def test_what_cannot_be_compared_is_computed_each_time(folder: Path) -> None:
    count = []

    @cache.cached
    def work(value: object) -> int:
        count.append(value)
        return len(count)

    assert [work(iter(())), work(iter(()))] == [1, 2]
    with pytest.raises(ContentError, match=r"content of a builtins\.tuple_iterator"):
        contents.digest(iter(()))


def test_what_is_kept_is_not_computed_again(folder: Path) -> None:
    assert store.fetch("ab" * 32, lambda: 1) == 1
    assert store.fetch("ab" * 32, lambda: 2) == 1 and store.holds("ab" * 32)
    assert not list((folder / "locks").iterdir()) and not list(folder.rglob(".writing-*"))


def test_the_c_of_a_block_is_printed_once() -> None:
    block, scalar = axes.block(1), np.float32
    plain = pipeline.c_source.__wrapped__  # type: ignore[attr-defined]
    arguments = ((block.rounded(scalar), scalar, False, None), {})
    assert not store.holds(cache.key(plain, *arguments))
    files = write.emit(block, scalar).files
    assert store.holds(cache.key(plain, *arguments)) and write.emit(block, scalar).files == files
    renamed = replace(block, inputs=tuple(replace(s, about="another sensor") for s in block.inputs))
    assert any(write.emit(renamed, scalar).files[name] != text for name, text in files.items())


@pytest.mark.parametrize("damage", ["cut", "empty", "altered", "of another key", "of another class", "a folder"])
def test_a_damaged_entry_counts_as_missing(folder: Path, damage: str) -> None:
    store.fetch("cd" * 32, lambda: list(range(100)))
    store.fetch("ef" * 32, lambda: "another")
    path, other = (folder / "results" / name[:2] / name[2:] for name in ("cd" * 32, "ef" * 32))
    whole = path.read_bytes()
    if damage == "a folder":
        path.unlink()
        path.mkdir()
    else:
        path.write_bytes(
            {
                "cut": whole[: len(whole) // 2],
                "empty": b"",
                "altered": whole[:-20] + bytes([whole[-20] ^ 1]) + whole[-19:],
                "of another key": other.read_bytes(),
                "of another class": _entry(path, b"cno_such_module\nThing\n."),
            }[damage]
        )
    assert not store.holds("cd" * 32)
    assert store.fetch("cd" * 32, lambda: "recomputed") == "recomputed"


def _entry(path: Path, body: bytes) -> bytes:
    return b"\n".join([store.MAGIC.rstrip(b"\n"), store._digest(path, b"", body), b"", body])


def test_a_fresh_run_reads_what_it_made_itself_and_leaves_it(monkeypatch: pytest.MonkeyPatch) -> None:
    key = "12" * 32
    assert store.fetch(key, lambda: "old") == "old"
    with store.fresh_run():
        assert not store.holds(key)
        assert store.fetch(key, lambda: "new") == "new"
        assert store.fetch(key, lambda: "twice") == "new"
    assert store.fetch(key, lambda: "later") == "new"
    monkeypatch.setenv(store.FRESH, "of a name")
    assert store.fetch(key, lambda: "named") == "named"


def test_a_fresh_run_compiles_again() -> None:
    source = {"one.c": "int one(void);\nint one(void) { return 1; }\n"}
    library = host_compiler.shared_library(source)
    first = library.stat().st_ino
    assert host_compiler.shared_library(source).stat().st_ino == first
    with store.fresh_run():
        second = host_compiler.shared_library(source).stat().st_ino
        assert second != first and host_compiler.shared_library(source).stat().st_ino == second


def test_what_is_no_data_or_finds_no_folder_is_computed_all_the_same(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert store.fetch("34" * 32, lambda: closed(3.0))(2.0) == 6.0
    (tmp_path / "file").write_text("")
    monkeypatch.setenv("SYNTH_CACHE", str(tmp_path / "file" / "cache"))
    assert store.fetch("56" * 32, lambda: 7) == 7


def _count(key: str, marks: str, seconds: float) -> None:
    def compute() -> int:
        Path(marks, str(os.getpid())).write_text("")
        time.sleep(seconds)
        return 1

    store.fetch(key, compute)


def test_of_two_processes_at_once_one_computes(tmp_path: Path) -> None:
    marks = tmp_path / "marks"
    marks.mkdir()
    processes = [get_context("fork").Process(target=_count, args=("78" * 32, str(marks), 0.3)) for _ in range(4)]
    for process in processes:
        process.start()
    for process in processes:
        process.join()
    assert [process.exitcode for process in processes] == [0] * 4 and len(list(marks.iterdir())) == 1


def test_a_killed_process_leaves_no_lock_and_no_entry(tmp_path: Path, folder: Path) -> None:
    marks = tmp_path / "marks"
    marks.mkdir()
    process = get_context("fork").Process(target=_count, args=("9a" * 32, str(marks), 60.0))
    process.start()
    while not list(marks.iterdir()):
        time.sleep(0.01)
    os.kill(process.pid or 0, signal.SIGKILL)
    process.join()
    assert store.fetch("9a" * 32, lambda: "after it") == "after it"


def test_what_was_not_used_for_the_longest_time_goes_first(folder: Path) -> None:
    for k in range(4):
        store.fetch(f"{k}" * 64, lambda: "x" * 1000)
        os.utime(folder / "results" / f"{k}{k}" / (f"{k}" * 62), (k, k))
    assert store.holds("0" * 64)  # now the latest in use
    store.trim(2500)
    assert [store.holds(f"{k}" * 64) for k in range(4)] == [True, False, False, True]
